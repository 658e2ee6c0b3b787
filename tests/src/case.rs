//! The graphs that every suite runs over: those of `graphs/`, the example of every node, and a few more.

use crate::random_graph::of_seed;
use crate::root;
use mipless::{Diagnostic, Folder, Texture};
use mipless_graph::CheckOptions;
use std::fs;

/// One graph.
#[derive(Clone, Debug)]
pub struct Case {
    /// The name of its file without extension, `example_` and the name of the node, or `random_` and
    /// the seed.
    pub name: String,
    /// The JSON text.
    pub text: String,
    /// The graph, checked.
    pub texture: Texture,
}

impl Case {
    /// Loads a graph; the files that it names are those of `graphs/`.
    ///
    /// # Panics
    /// If the graph has mistakes.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let (name, text) = (name.into(), text.into());
        let texture = load(&text).unwrap_or_else(|mistakes| {
            let mistakes: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
            panic!("{name} has mistakes:\n{}", mistakes.join("\n"))
        });
        Self {
            name,
            text,
            texture,
        }
    }

    /// Whether it is a material.
    fn is_material(&self) -> bool {
        !self.texture.checked().graph().materials.is_empty()
    }
}

/// A random graph, as the one of its seed.
///
/// # Panics
/// If no graph of the seed is accepted.
pub fn random(seed: u64) -> Case {
    let (graph, texture) = of_seed(seed);
    Case {
        name: format!("random_{seed}"),
        text: graph.to_string(),
        texture,
    }
}

/// Loads and checks a graph; the files that it names are those of `graphs/`.
///
/// # Errors
/// Every mistake, located.
pub fn load(text: &str) -> Result<Texture, Vec<Diagnostic>> {
    let folder = Folder(root().join("graphs"));
    Texture::with_files(text, &CheckOptions::default(), &folder)
}

/// The graphs of `graphs/` that are no materials, by name.
///
/// # Panics
/// If one cannot be read or has mistakes.
pub fn graphs() -> Vec<Case> {
    let mut graphs = files();
    graphs.retain(|case| !case.is_material());
    graphs
}

/// The materials of `graphs/`, by name.
///
/// # Panics
/// If one cannot be read or has mistakes.
pub fn materials() -> Vec<Case> {
    let mut graphs = files();
    graphs.retain(Case::is_material);
    graphs
}

/// All graphs of `graphs/`, by name.
///
/// # Panics
/// If one cannot be read or has mistakes.
pub fn files() -> Vec<Case> {
    let folder = root().join("graphs");
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("an entry of graphs/").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "json")
        })
        .collect();
    files.sort();
    (files.iter())
        .map(|path| {
            let name = path.file_stem().expect("a name").to_string_lossy();
            let text = fs::read_to_string(path).expect("a readable graph");
            Case::new(name, text)
        })
        .collect()
}

/// The examples of the reference pages, in the order of the catalogue.
///
/// # Panics
/// If one has mistakes.
pub fn examples() -> Vec<Case> {
    let nodes = mipless::catalogue().iter();
    nodes
        .map(|def| Case::new(format!("example_{}", def.spec.name), def.spec.example))
        .collect()
}

/// What no graph and no example has: an input between the bends of a region, an amplitude from one,
/// a colour map from a picture, and staggered lines of a width that is known and of one that is live.
///
/// # Panics
/// If one has mistakes.
pub fn further() -> Vec<Case> {
    let live = r##"{
  "version": 1,
  "name": "live",
  "inputs": { "p": { "type": "float", "value": 1, "min": 0.5, "max": 2 } },
  "nodes": {
    "noise": { "type": "noise2d", "inputs": { "frequency": 5, "amplitude": 4 } },
    "folds": { "type": "absval", "inputs": { "in": { "node": "noise" } } },
    "scaled": { "type": "multiply", "inputs": { "in1": { "node": "folds" }, "in2": { "input": "p" } } },
    "color": { "type": "colorramp", "inputs": { "in": { "node": "scaled" }, "stops": [
      { "at": 0, "value": "#102030" }, { "at": 0.2, "value": "#f0e0a0" }, { "at": 0.4, "value": "#804020" } ] } },
    "grain": { "type": "noise2d", "inputs": { "frequency": 9, "amplitude": { "input": "p" }, "seed": 1 } },
    "ridges": { "type": "absval", "inputs": { "in": { "node": "grain" } } },
    "cracks": { "type": "step", "inputs": { "in": { "node": "ridges" }, "edge": 0.05 } },
    "both": { "type": "multiply", "inputs": { "in1": { "node": "color" }, "in2": { "node": "cracks" } } }
  },
  "outputs": { "out": { "node": "both" } }
}"##;
    let picture = r#"{
  "version": 1,
  "name": "picture",
  "nodes": {
    "x": { "type": "noise2d", "inputs": { "frequency": 3, "pivot": 0.5 } },
    "y": { "type": "noise2d", "inputs": { "frequency": 4, "pivot": 0.5, "seed": 2 } },
    "color": { "type": "colormap2d", "inputs": { "in1": { "node": "x" }, "in2": { "node": "y" },
      "file": "images/moss.png", "addressmode": "periodic" } }
  },
  "outputs": { "out": { "node": "color" } }
}"#;
    let hatches = r#"{
  "version": 1,
  "name": "staggered_crosshatch",
  "inputs": { "width": { "type": "float", "value": 0.3, "min": 0, "max": 1 } },
  "nodes": {
    "known": { "type": "crosshatch", "inputs": { "uvtiling": [7, 9], "thickness": 0.1, "staggered": true } },
    "live": { "type": "crosshatch", "inputs": { "uvtiling": [5, 4], "thickness": { "input": "width" }, "staggered": true } },
    "both": { "type": "mix", "inputs": { "bg": { "node": "known" }, "fg": { "node": "live" }, "mix": 0.4 } }
  },
  "outputs": { "out": { "node": "both" } }
}"#;
    let cases = [
        ("live", live),
        ("picture", picture),
        ("staggered_crosshatch", hatches),
    ];
    cases.map(|(name, text)| Case::new(name, text)).to_vec()
}

/// All graphs, then all examples, then what none of them has.
///
/// # Panics
/// If one cannot be read or has mistakes.
pub fn all() -> Vec<Case> {
    (graphs().into_iter())
        .chain(examples())
        .chain(further())
        .collect()
}

/// The texture without the outputs that are no means of points: a roughness or a normal of a material
/// has no truth among points.
pub fn means(texture: &Texture) -> Texture {
    let graph = texture.checked().graph();
    let means: Vec<&str> = (graph.outputs.iter())
        .filter(|output| graph.node(output.node).is_mean())
        .map(|output| output.name.as_str())
        .collect();
    texture.with_outputs(&means)
}
