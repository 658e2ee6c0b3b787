//! `render` of many pictures, of large ones, and of parts of them.

use crate::folder::{Folder, GRAPH};
use image::GenericImageView;
use std::fs;

const SMALL: &str = "--size 32x18 --device cpu";

#[test]
fn many_graphs_and_outputs_have_names_of_their_own() {
    let folder = Folder::new();
    folder.write("other.json", GRAPH.replace("\"marble\"", "\"other\""));
    folder.write("bad.json", "{");
    let pattern = "-o maps/{graph}/{output}.png";
    let line = format!("render marble.json bad.json other.json --output all {pattern} {SMALL}");
    folder
        .run(&line)
        .is(1)
        .says("bad.json")
        .says("maps/other/height.png");
    for name in [
        "marble/base_color",
        "marble/height",
        "other/base_color",
        "other/height",
    ] {
        assert!(folder.path(&format!("maps/{name}.png")).is_file(), "{name}");
    }
    let one = format!("render marble.json --output height -o one.png {SMALL}");
    folder.run(&one).is(0);
    assert_eq!(
        folder.read("one.png"),
        folder.read("maps/marble/height.png")
    );
    let line = format!("render marble.json other.json --output height -o a.png {SMALL}");
    folder.run(&line).is(2).says("{graph}");
    let line = format!("render marble.json --output all -o a.png {SMALL}");
    folder.run(&line).is(2).says("{output}");
    let line = format!("render marble.json other.json --output height -o {{graph}}.exr {SMALL}");
    let run = folder.run(&format!("{line} --json")).is(0).json();
    assert_eq!(run["rendered"][1]["files"][0], "other.exr");
}

#[test]
fn levels_stand_for_what_the_output_is() {
    let folder = Folder::new();
    let read = |output: &str, more: &str| {
        let line = format!("render marble.json --output {output} -o a.png {SMALL} {more}");
        folder.run(&line).is(0);
        folder.read("a.png")
    };
    let is_srgb = |file: &[u8]| file.windows(4).any(|word| word == b"sRGB");
    assert!(is_srgb(&read("base_color", "")));
    assert!(!is_srgb(&read("height", "")));
    assert!(!is_srgb(&read("base_color", "--colorspace linear")));
    assert!(is_srgb(&read("height", "--colorspace srgb")));
    let exr = format!("render marble.json --output height -o a.exr {SMALL} --colorspace srgb");
    folder.run(&exr).is(0).says("ignored-colorspace");
}

#[test]
fn a_tile_is_to_the_bit_what_the_whole_holds() {
    let folder = Folder::new();
    // The whole is written as it is made, the tiles at once.
    let base = "render marble.json --output base_color --bits 16 --device cpu --method local";
    for view in ["--view flat --window -3,2,9,8", "--view sphere"] {
        let line = format!("{base} --size 1201x903 {view}");
        folder.run(&format!("{line} -o whole.png")).is(0);
        let whole = image::load_from_memory(&folder.read("whole.png")).expect("a PNG");
        assert_eq!(whole.dimensions(), (1201, 903));
        for (tile, left, top) in [("0,0/3x2", 0, 0), ("1,1/3x2", 400, 451)] {
            folder
                .run(&format!("{line} --tile {tile} -o tile_{{tile}}.png"))
                .is(0);
            let name = format!("tile_{}.png", tile[..3].replace(',', "_"));
            let part = image::load_from_memory(&folder.read(&name)).expect("a PNG");
            let (width, height) = part.dimensions();
            let wanted = whole.crop_imm(left, top, width, height);
            assert!(part == wanted, "{view} {tile}");
        }
    }
    folder
        .run("render marble.json --output height -o a.png --size 4x4 --tile 0,2/1x9 --device cpu")
        .is(0);
    folder
        .run("render marble.json --output height -o a.png --size 4x4 --tile 0,0/1x9 --device cpu")
        .is(2)
        .says("no such tile");
    let held = "render marble.json --output height -o a.exr --size 30000x30000 --device cpu";
    folder.run(held).is(2).says("held in memory");
    let left = fs::read_dir(folder.path("")).expect("the folder");
    let hidden = |entry: &fs::DirEntry| entry.file_name().to_string_lossy().starts_with('.');
    assert_eq!(left.flatten().filter(hidden).count(), 0);
}

#[test]
fn each_level_of_a_mip_chain_is_filtered_for_its_own_pixels() {
    let folder = Folder::new();
    let base = "render marble.json --output height --view flat --window 0,0,3,3 --device cpu";
    folder
        .run(&format!("{base} --size 16x8 --mips -o mip_{{level}}.png"))
        .is(0)
        .says("mip_4.png");
    folder.run(&format!("{base} --size 4x2 -o small.png")).is(0);
    assert_eq!(folder.read("small.png"), folder.read("mip_2.png"));
    let last = image::load_from_memory(&folder.read("mip_4.png")).expect("a PNG");
    assert_eq!(last.dimensions(), (1, 1));
    assert!(!folder.path("mip_5.png").exists());
    let line = format!("{base} --size 16x8 --mips -o mip.png");
    folder.run(&line).is(2).says("{level}");
}
