//! What a run reads it never writes over, two of its files are never one, and `--root` bounds what is
//! read.

use crate::folder::{Folder, GRAPH, WALL};
use std::fs;

const SMALL: &str = "--size 8x8 --device cpu";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write_picture("tile.png", 90);
    folder.write("wall.json", WALL);
    folder.write("picture.exr", GRAPH);
    folder
}

#[test]
fn no_verb_writes_over_a_file_that_it_reads() {
    let folder = folder();
    let before = ["tile.png", "wall.json", "picture.exr"].map(|name| folder.read(name));
    for command in [
        format!("render wall.json -o tile.png {SMALL}"),
        format!("render wall.json -o ./tile.png {SMALL} --tolerance 0.1"),
        format!("render picture.exr -o picture.exr {SMALL}"),
        format!("render picture.exr -o a.png --moments picture.exr {SMALL}"),
        format!("compare wall.json -o tile.png {SMALL}"),
        "compile wall.json --out .".to_owned(),
    ] {
        folder
            .run(&command)
            .is(2)
            .says("unwritable-file")
            .says("would replace");
    }
    let after = ["tile.png", "wall.json", "picture.exr"].map(|name| folder.read(name));
    assert_eq!(before, after);
    assert!(!folder.path("a.png").exists());
}

#[test]
fn two_options_never_name_one_file() {
    let folder = folder();
    for moments in ["a.exr", "./a.exr", "../{}/a.exr"] {
        let name = folder.path("");
        let name = name.file_name().unwrap_or_default().to_string_lossy();
        let moments = moments.replace("{}", &name);
        folder
            .run(&format!(
                "render wall.json -o a.exr --moments {moments} {SMALL}"
            ))
            .is(2)
            .says("the same file");
    }
    assert!(!folder.path("a.exr").exists());
}

#[test]
fn a_root_refuses_pictures_outside_of_it() {
    let folder = folder();
    fs::create_dir(folder.path("graphs")).expect("a folder");
    folder.write("graphs/wall.json", WALL.replace("tile.png", "../tile.png"));
    folder.run("check graphs/wall.json").is(0);
    folder.run("check graphs/wall.json --root .").is(0);
    for verb in [
        "check graphs/wall.json".to_owned(),
        format!("render graphs/wall.json -o a.png {SMALL}"),
        "compile graphs/wall.json --out out".to_owned(),
    ] {
        folder
            .run(&format!("{verb} --root graphs"))
            .is(1)
            .says("unreadable-file")
            .says("/nodes/tile/inputs/file")
            .says("outside");
    }
    folder
        .run("check wall.json --root missing")
        .is(2)
        .says("--root missing");
}

#[test]
fn a_graph_with_a_name_of_ten_thousand_letters_is_written() {
    let folder = Folder::new();
    folder.write(
        "long.json",
        GRAPH.replace("\"marble\"", &format!("\"{}\"", "n".repeat(10_000))),
    );
    folder
        .run("compile long.json --out out --target wgsl,spirv")
        .is(0);
}
