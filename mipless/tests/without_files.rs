//! Without the feature `files` there is no decoder of pictures.

#![cfg(not(feature = "files"))]

use mipless::{CheckOptions, Files, NoFiles, Texture};
use std::io;

const WALL: &str = r#"{ "version": 1, "name": "wall", "nodes": {
  "wall": { "type": "image", "inputs": { "file": "wall.png" } },
  "sand": { "type": "byexample", "inputs": { "file": "wall.png" } },
  "both": { "type": "multiply", "inputs": { "in1": { "node": "wall" }, "in2": { "node": "sand" } } }
}, "outputs": { "out": { "node": "both" } } }"#;

struct Unasked;

impl Files for Unasked {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        panic!("{name} is read, though nothing could decode it");
    }
}

#[test]
fn a_picture_is_a_located_mistake_that_names_the_feature() {
    let options = CheckOptions::default();
    let mistakes = Texture::with_files(WALL, &options, &Unasked).expect_err("two mistakes");
    let places: Vec<_> = (mistakes.iter())
        .map(|d| (d.code, d.pointer.as_deref(), d.line))
        .collect();
    let wanted = [
        ("feature-off", Some("/nodes/wall/inputs/file"), Some(2)),
        ("feature-off", Some("/nodes/sand/inputs/file"), Some(3)),
    ];
    assert_eq!(places, wanted);
    for mistake in &mistakes {
        assert!(mistake.is_error());
        assert!(mistake.message.contains("`files`"), "{}", mistake.message);
    }
}

#[test]
fn graphs_without_pictures_need_no_feature() {
    let text = r#"{ "version": 1, "nodes": { "n": { "type": "noise2d" } },
        "outputs": { "out": { "node": "n" } } }"#;
    let texture = Texture::with_files(text, &CheckOptions::default(), &NoFiles);
    assert_eq!(texture.expect("no mistakes").name(), "texture");
}
