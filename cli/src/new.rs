//! `new`: a small commented graph to start from.

use crate::mistake::Mistake;
use crate::report::Report;
use clap::Args;
use mipless_runtime::image_file::write_whole;
use serde_json::json;
use std::path::PathBuf;

/// The arguments of `new`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The file to write; one that exists is left alone
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

/// JSON has no comments, so the graph explains itself in its `doc` fields. `NAME` is replaced.
const START: &str = r##"{
  "version": 1,
  "name": "NAME",
  "doc": "Clouds on blue. Render it with `mipless render FILE -o clouds.png`, and ask `mipless nodes` what else there is.",
  "inputs": {
    "scale": {
      "type": "float", "value": 4.0, "min": 0.25, "max": 64.0, "soft_min": 1.0, "soft_max": 16.0,
      "doc": "Clouds per unit of texture space. Change it live, or with `--set scale=8`."
    }
  },
  "nodes": {
    "noise": {
      "type": "fractal2d",
      "doc": "Five octaves of noise; its frequency is the graph's input `scale`.",
      "inputs": { "frequency": { "input": "scale" }, "octaves": 5 }
    },
    "color": {
      "type": "colorramp",
      "doc": "A colour for every value of the noise. Colours are #rrggbb or three linear numbers.",
      "inputs": {
        "in": { "node": "noise" },
        "stops": [
          { "at": -0.2, "value": "#3f78b5" },
          { "at": 0.1, "value": "#b9d3e8" },
          { "at": 0.4, "value": "#ffffff" }
        ]
      }
    }
  },
  "outputs": {
    "base_color": { "node": "color" }
  }
}
"##;

/// Writes the graph.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let path = &arguments.file;
    if path.symlink_metadata().is_ok() {
        let message = format!("{} exists and is left as it is", path.display());
        return Err(Mistake::usage("file-exists", message).help("choose another name"));
    }
    let stem = path
        .file_stem()
        .map(|stem| stem.to_string_lossy())
        .unwrap_or_default();
    let file = path
        .file_name()
        .map(|name| name.to_string_lossy())
        .unwrap_or_default();
    let text = START.replace("\"NAME\"", &json!(stem).to_string());
    let quoted = json!(file).to_string();
    let text = text.replace("FILE", quoted.trim_matches('"'));
    write_whole(path, text.as_bytes()).map_err(|error| {
        Mistake::usage("unwritable-file", format!("{}: {error}", path.display()))
    })?;
    report.note(format_args!("{}: a graph to start from", path.display()));
    report.result("files", vec![path.display().to_string()]);
    Ok(())
}
