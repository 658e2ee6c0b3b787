//! Graphs that name pictures: every verb finds them beside the graph, and says what is wrong.

use crate::folder::Folder;
use image::{ExtendedColorType, ImageEncoder};
use serde_json::Value;
use std::fs;

const WALL: &str = r#"{
    "version": 1,
    "name": "wall",
    "nodes": {
        "tile": { "type": "image", "inputs": { "file": "pictures/tile.png", "uvtiling": [3, 3] } },
        "stone": { "type": "byexample", "inputs": { "file": "pictures/tile.png" } },
        "both": { "type": "multiply", "inputs": { "in1": { "node": "tile" }, "in2": { "node": "stone" } } }
    },
    "outputs": { "out": { "node": "both" } }
}"#;

const SMALL: &str = "--size 24x16 --device cpu";

fn png() -> Vec<u8> {
    let numbers: Vec<u8> = (0..3 * 64u32).map(|i| (i * i * 37 % 251) as u8).collect();
    let mut file = Vec::new();
    image::codecs::png::PngEncoder::new(&mut file)
        .write_image(&numbers, 8, 8, ExtendedColorType::Rgb8)
        .expect("a PNG");
    file
}

/// A graph in a folder below, with its picture below that.
fn folder() -> Folder {
    let folder = Folder::new();
    fs::create_dir_all(folder.path("graphs/pictures")).expect("folders");
    folder.write("graphs/wall.json", WALL);
    folder.write("graphs/pictures/tile.png", png());
    folder
}

#[test]
fn every_verb_finds_pictures_beside_the_graph() {
    let folder = folder();
    folder.run("check graphs/wall.json").is(0);
    let render = format!("render graphs/wall.json -o a.png {SMALL}");
    folder.run(&render).is(0);
    folder
        .run(&format!("compare graphs/wall.json -o b.png {SMALL}"))
        .is(0);
    folder
        .run(&format!("trade graphs/wall.json --out trade {SMALL}"))
        .is(0);
    folder.run("compile graphs/wall.json --out out").is(0);
    let manifest: Value =
        serde_json::from_slice(&folder.read("out/wall.json")).expect("a manifest");
    assert_eq!(manifest["files"]["tables"], "wall.tables.bin");
    let tables = manifest["tables"].as_array().expect("tables");
    let numbers: u64 = tables.iter().filter_map(|t| t["length"].as_u64()).sum();
    let bytes = folder.read("out/wall.tables.bin");
    assert_eq!(bytes.len() as u64, 4 * numbers, "{tables:?}");
    // Level 0 of the picture's pyramid with its margin: 10 × 10 texels of 3 numbers.
    assert!(numbers > 300, "{tables:?}");
}

#[test]
fn pictures_that_cannot_be_used_are_mistakes_of_the_graph() {
    let folder = folder();
    let place = "/nodes/tile/inputs/file";
    let refused = |code: &str| {
        for verb in [
            "check graphs/wall.json".to_owned(),
            format!("render graphs/wall.json -o a.png {SMALL}"),
            format!("compare graphs/wall.json -o a.png {SMALL}"),
            "compile graphs/wall.json --out out".to_owned(),
        ] {
            folder
                .run(&verb)
                .is(1)
                .says(code)
                .says(place)
                .says("line 5");
        }
        assert!(!folder.path("a.png").exists() && !folder.path("out").exists());
    };
    let tile = folder.path("graphs/pictures/tile.png");
    fs::write(&tile, &png()[..60]).expect("a file");
    refused("bad-image");
    fs::write(&tile, "no picture").expect("a file");
    refused("not-an-image");
    fs::remove_file(&tile).expect("a file");
    refused("missing-file");
    fs::create_dir(&tile).expect("a folder");
    refused("unreadable-file");
}
