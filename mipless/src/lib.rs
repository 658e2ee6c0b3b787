//! Self-filtering procedural texture graphs for tools: load, check, edit, compile, evaluate.
//!
//! This crate needs no graphics device. It has four features, of which the first three are on by
//! default:
//!
//! - `files` decodes the pictures that graphs name ([`Texture::from_file`], [`Texture::with_files`]).
//!   Without it, a graph that names one has a located mistake, `feature-off`.
//! - `render` evaluates pictures on all cores (`render`): views, tiles, coarse first.
//! - `targets` validates shaders and translates them to SPIR-V, GLSL, HLSL and MSL by naga
//!   (`target::validate`, `target::translate`, and all files of a texture, `artifact::Artifact`).
//!   Without it there are WGSL and its [`manifest::Manifest`], and naga is not built.
//! - `import` reads MaterialX, Material Maker and glTF documents into graphs (`import::import`).
//!
//! A tool that only wants WGSL of graphs without pictures says `default-features = false`, and
//! builds in half the time.
//!
//! A tour:
//!
//! # Load and check
//! ```
//! use mipless::Texture;
//!
//! let json = r##"{
//!     "version": 1,
//!     "name": "clouds",
//!     "inputs": { "scale": { "type": "float", "value": 4.0, "min": 0.5, "max": 64 } },
//!     "nodes": {
//!         "noise": { "type": "fractal2d", "inputs": { "frequency": { "input": "scale" } } },
//!         "color": { "type": "colorramp", "inputs": {
//!             "in": { "node": "noise" },
//!             "stops": [ { "at": -0.5, "value": "#2a5f9e" }, { "at": 0.5, "value": "#ffffff" } ] } }
//!     },
//!     "outputs": { "base_color": { "node": "color" } }
//! }"##;
//! let texture = Texture::from_json(json).expect("the graph has no mistakes");
//! assert_eq!(texture.parameters()[0].name, "scale");
//! assert_eq!(texture.outputs()[0].name, "base_color");
//! // What the check says of each signal.
//! assert!(texture.signals().len() >= 2);
//! ```
//!
//! # Mistakes are located, all at once
//! ```
//! # use mipless::Texture;
//! let mistakes = Texture::from_json(r#"{
//!     "version": 1, "name": "oops",
//!     "nodes": { "n": { "type": "nose2d", "inputs": { "seed": 0.5 } } },
//!     "outputs": { "out": { "node": "m" } }
//! }"#).expect_err("two mistakes");
//! assert!(mistakes.len() >= 2);
//! assert!(mistakes.iter().all(|d| d.pointer.is_some()));
//! ```
//!
//! # Set an input, evaluate
//! ```
//! # use mipless::{Footprint, Method, Options, Texture};
//! # let json = r##"{ "version": 1, "name": "clouds",
//! #     "inputs": { "scale": { "type": "float", "value": 4.0, "min": 0.5, "max": 64 } },
//! #     "nodes": { "noise": { "type": "fractal2d", "inputs": { "frequency": { "input": "scale" } } } },
//! #     "outputs": { "height": { "node": "noise" } } }"##;
//! let texture = Texture::from_json(json).expect("the graph has no mistakes");
//! let mut evaluator = texture.evaluator(&Options { method: Method::Local, ..Options::default() });
//! evaluator.set("scale", &[8.0]).expect("scale is a float from 0.5 to 64");
//! let pixel = Footprint { uv: [0.25, 0.5], du: [0.01, 0.0], dv: [0.0, 0.01], ..Footprint::default() };
//! let height = evaluator.evaluate(&[pixel]);
//! assert!(height[0][0].is_finite());
//! ```
//!
//! # List the nodes, edit
//! A node is its spec: ports, types, ranges, defaults and the texts of its page. A [`Document`] is
//! what a file says; edit a copy and load it again, and mistakes are located in its text.
//! ```
//! # use mipless::{Texture, specs};
//! use mipless::{Binding, NodeEntry, Reference};
//!
//! # let texture = Texture::from_json(r##"{ "version": 1, "name": "clouds",
//! #     "nodes": { "noise": { "type": "noise2d" } },
//! #     "outputs": { "height": { "node": "noise" } } }"##).expect("the graph has no mistakes");
//! let clamp = specs().into_iter().find(|spec| spec.name == "clamp").expect("it is in the catalogue");
//! assert!(clamp.inputs.iter().any(|port| port.name == "low"));
//!
//! let mut document = texture.document().clone();
//! let mut node = NodeEntry { ty: clamp.name.to_owned(), ..NodeEntry::default() };
//! node.inputs.insert("in".to_owned(), Binding::Node(Reference::new("noise")));
//! node.inputs.insert("high".to_owned(), Binding::Value(0.25.into()));
//! document.body.nodes.insert("clamped".to_owned(), node);
//! document.body.outputs["height"] = Reference::new("clamped");
//!
//! let edited = Texture::from_json(&document.to_text()).expect("the graph has no mistakes");
//! assert_eq!(edited.document(), &document);
//! ```
//!
//! # Compile
//! ```
//! # use mipless::{Options, Texture, wgsl};
//! # let texture = Texture::from_json(r##"{ "version": 1, "name": "clouds",
//! #     "nodes": { "noise": { "type": "noise2d" } },
//! #     "outputs": { "height": { "node": "noise" } } }"##).expect("the graph has no mistakes");
//! let program = texture.compile(&Options::default());
//! let shader = wgsl::emit(&program, &wgsl::Options::default());
//! assert!(shader.source.contains("fn clouds(footprint: Footprint"));
//! ```
//!
//! # A graph needs no name
//! Without one it is called as its file is, or as you say.
//! ```
//! # use mipless::{CheckOptions, NoFiles, Options, Texture, wgsl};
//! let json = r#"{ "version": 1, "nodes": { "noise": { "type": "noise2d" } },
//!     "outputs": { "height": { "node": "noise" } } }"#;
//! let texture = Texture::from_json(json).expect("the graph has no mistakes");
//! assert_eq!(texture.name(), "texture");
//!
//! let options = CheckOptions::default();
//! let texture = Texture::with_name("Old wall", json, &options, &NoFiles).expect("the same");
//! assert_eq!((texture.name(), &texture.document().name), ("Old wall", &None));
//! let shader = wgsl::emit(&texture.compile(&Options::default()), &wgsl::Options::default());
//! assert!(shader.source.contains("fn old_wall(footprint: Footprint"));
//! ```

#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "targets")]
pub mod artifact;
mod catalogue;
#[cfg(feature = "targets")]
pub mod conformance;
pub mod define;
mod evaluator;
mod files;
pub mod manifest;
#[cfg(feature = "files")]
mod picture;
#[cfg(feature = "render")]
pub mod render;
mod resource;
pub mod session;
mod texture;

/// Documents of other tools, read into graphs.
#[cfg(feature = "import")]
pub use mipless_import as import;

pub use catalogue::{Catalogue, CatalogueError};
pub use evaluator::{Channel, InputHandle, SetError, TextureEvaluator};
pub use files::{
    Files, Folder, LARGEST_FILE, LARGEST_PICTURE, LARGEST_SIDE, NoFiles, Within, name_of_file,
};
pub use mipless_codegen::cpu::Footprint;
#[cfg(feature = "targets")]
pub use mipless_codegen::form;
pub use mipless_codegen::ir::{Interface, Program};
pub use mipless_codegen::{
    Audit, AuditedBand, AuditedOutput, Method, NodeDef, Options, PixelFilter, Remedy, Replaced,
    target, wgsl,
};
pub use mipless_graph::{
    Binding, Body, CheckOptions, Checked, Diagnostic, Document, InputEntry, Literal, Map,
    NodeEntry, NodeSpec, Output, Parameter, PortSpec, PortType, Reference, Severity, Signal, Type,
    parse_setting, schema,
};
pub use mipless_nodes::catalogue;
pub use texture::{BakeError, FromFileError, Texture, specs};
