//! A folder of its own for each test, and what running the command in it gave.

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Two inputs, two outputs.
pub(crate) const GRAPH: &str = r##"{
    "version": 1,
    "name": "marble",
    "inputs": {
        "scale": { "type": "float", "value": 4.0, "min": 0.5, "max": 64 },
        "tint": { "type": "color3", "value": [1, 1, 1] }
    },
    "nodes": {
        "noise": { "type": "noise2d", "inputs": { "frequency": { "input": "scale" } } },
        "ramp": { "type": "colorramp", "inputs": {
            "in": { "node": "noise" },
            "stops": [ { "at": -0.3, "value": "#1d1a18" }, { "at": 0.3, "value": "#e0d0c0" } ] } },
        "color": { "type": "multiply", "inputs": {
            "in1": { "node": "ramp" }, "in2": { "input": "tint" } } }
    },
    "outputs": { "base_color": { "node": "color" }, "height": { "node": "noise" } }
}"##;

/// A graph that shows `tile.png`.
pub(crate) const WALL: &str = r#"{
    "version": 1,
    "name": "wall",
    "nodes": { "tile": { "type": "image", "inputs": { "file": "tile.png" } } },
    "outputs": { "out": { "node": "tile" } }
}"#;

pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder"));
        folder.write("marble.json", GRAPH);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path(name), text).expect("a file");
    }

    /// A picture of 2 × 2 pixels of one grey.
    pub(crate) fn write_picture(&self, name: &str, grey: u8) {
        let mut file = Vec::new();
        PngEncoder::new(&mut file)
            .write_image(&[grey; 12], 2, 2, ExtendedColorType::Rgb8)
            .expect("a PNG");
        self.write(name, file);
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of all files, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("the folder");
        let name = |entry: std::io::Result<fs::DirEntry>| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }

    pub(crate) fn run(&self, line: &str) -> Run {
        let begun = Instant::now();
        let output = self.command(line).output().expect("the command starts");
        Run::new(line, output, begun.elapsed())
    }

    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mipless"));
        command
            .current_dir(self.0.path())
            .args(line.split_whitespace())
            .stdin(Stdio::null());
        command
    }
}

pub(crate) struct Run {
    pub(crate) line: String,
    pub(crate) status: i32,
    pub(crate) out: String,
    pub(crate) err: String,
    pub(crate) taken: Duration,
}

impl Run {
    pub(crate) fn new(line: &str, output: Output, taken: Duration) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8 output");
        let run = Self {
            line: line.to_owned(),
            status: output.status.code().unwrap_or(-1),
            out: text(output.stdout),
            err: text(output.stderr),
            taken,
        };
        assert!(!run.err.contains("panicked"), "{line}: {}", run.err);
        run
    }

    #[track_caller]
    pub(crate) fn is(self, status: i32) -> Self {
        assert_eq!(
            self.status, status,
            "{}\n{}\n{}",
            self.line, self.out, self.err
        );
        self
    }

    #[track_caller]
    pub(crate) fn says(self, text: &str) -> Self {
        assert!(
            self.err.contains(text),
            "{}: no `{text}` in\n{}",
            self.line,
            self.err
        );
        self
    }

    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.err, "", "{}", self.line);
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}", self.out))
    }

    /// The codes of the diagnostics of a run with `--json`.
    #[track_caller]
    pub(crate) fn codes(&self) -> Vec<String> {
        let json = self.json();
        let diagnostics = json["diagnostics"].as_array().expect("diagnostics").clone();
        let code = |d: &Value| d["code"].as_str().expect("a code").to_owned();
        diagnostics.iter().map(code).collect()
    }
}
