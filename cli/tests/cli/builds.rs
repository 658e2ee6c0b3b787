//! `compile` as a step of a build: it touches what changes, says what depends on what, and goes on.

use crate::folder::{Folder, GRAPH, WALL};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant, SystemTime};

/// When each file of a folder was written last.
fn times(folder: &Folder, name: &str) -> BTreeMap<String, SystemTime> {
    let entries = fs::read_dir(folder.path(name)).expect("the folder");
    let time = |entry: std::io::Result<fs::DirEntry>| {
        let entry = entry.expect("an entry");
        let time = entry.metadata().and_then(|data| data.modified());
        let name = entry.file_name().to_string_lossy().into_owned();
        (name, time.expect("a time"))
    };
    entries.map(time).collect()
}

/// The names of the files that were written since.
fn written(folder: &Folder, before: &BTreeMap<String, SystemTime>) -> Vec<String> {
    let now = times(folder, "out").into_iter();
    let is_new = |(name, time): &(String, SystemTime)| before.get(name) != Some(time);
    now.filter(is_new).map(|(name, _)| name).collect()
}

fn manifest(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.read(name)).expect("JSON")
}

#[test]
fn what_would_not_change_is_not_touched() {
    let folder = Folder::new();
    let all = "compile marble.json --out out --target wgsl,spirv --method point";
    folder.run(all).is(0).says("marble.spv");
    let before = times(&folder, "out");
    folder.run(all).is(0).says("marble.json: unchanged");
    assert_eq!(written(&folder, &before), [""; 0]);

    // A comment changes the digest of the source, and nothing else.
    let told = GRAPH.replace("\"version\": 1,", "\"version\": 1, \"doc\": \"Stone.\",");
    folder.write("marble.json", &told);
    folder.run(all).is(0);
    assert_eq!(written(&folder, &before), ["marble.json"]);

    // A run with fewer targets says what is there all the same.
    let one = "compile marble.json --out out --method point --entry fragment";
    let before = times(&folder, "out");
    folder.run(one).is(0).says("unchanged");
    assert_eq!(written(&folder, &before), [""; 0]);
    let after = manifest(&folder, "out/marble.json");
    assert_eq!(after["files"]["spirv"], "marble.spv");

    // What another graph has left holds no longer.
    folder.write("marble.json", told.replace("-0.3", "-0.2"));
    folder.run(one).is(0).says("removed out/marble.spv");
    let after = manifest(&folder, "out/marble.json");
    assert!(after["files"]["spirv"].is_null() && after["targets"]["spirv"].is_null());
    assert!(!folder.path("out/marble.spv").exists());

    // What somebody has changed is made again.
    folder.write("out/marble.wgsl", "fn marble() {}");
    folder.run(one).is(0).says("out/marble.wgsl");
    assert!(folder.read("out/marble.wgsl").len() > 500);
    folder
        .run(&format!("{one} --force"))
        .is(0)
        .says("unchanged");
    folder
        .run("compile marble.json --out out --method local")
        .is(0);
    let after = manifest(&folder, "out/marble.json");
    assert_eq!(after["method"], "local");
}

#[test]
fn another_form_of_the_same_graph_stands_beside_it() {
    let folder = Folder::new();
    let base = "compile marble.json --out out --method point";
    folder.run(&format!("{base} --target wgsl")).is(0);
    folder
        .run(&format!("{base} --target hlsl --entry compute --group 2"))
        .is(0);
    let after = manifest(&folder, "out/marble.json");
    assert!(after["targets"]["wgsl"]["entry_point"].is_null());
    assert_eq!(after["targets"]["hlsl"]["entry_point"]["stage"], "compute");
    assert_eq!(
        after["targets"]["hlsl"]["bindings"][0]["place"],
        "register(t0, space2)"
    );
    folder
        .run(&format!("{base} --target wgsl"))
        .is(0)
        .says("unchanged");
}

#[test]
fn a_file_that_the_graph_reads_is_a_part_of_it() {
    let folder = Folder::new();
    folder.write_picture("tile.png", 90);
    folder.write("wall.json", WALL);
    let line = "compile wall.json --out out --method point --depfile out.d";
    folder.run(line).is(0);
    folder.run(line).is(0).says("unchanged");
    let rule = String::from_utf8(folder.read("out.d")).expect("text");
    let (made, needed) = rule.trim().split_once(": ").expect("a rule");
    assert!(
        made.contains("out/wall.wgsl") && made.contains("out/wall.json"),
        "{rule}"
    );
    assert_eq!(needed.replace("./", ""), "wall.json tile.png");
    let first = folder.read("out/wall.tables.bin");
    folder.write_picture("tile.png", 200);
    folder.run(line).is(0).says("out/wall.tables.bin");
    assert_ne!(first, folder.read("out/wall.tables.bin"));
    let source = &manifest(&folder, "out/wall.json")["source"];
    assert_eq!(source["files"][0]["name"], "tile.png");
    folder
        .run("compile wall.json --out out --depfile tile.png")
        .is(2)
        .says("would replace");
}

#[test]
fn inputs_are_baked() {
    let folder = Folder::new();
    let line = "compile marble.json --out out --method local";
    folder.run(line).is(0);
    let live = folder.read("out/marble.wgsl").len();
    folder
        .run(&format!("{line} --bake scale=8 --bake tint=#ffffff"))
        .is(0);
    let baked = manifest(&folder, "out/marble.json");
    assert_eq!(baked["parameters"].as_array().map(Vec::len), Some(0));
    assert!(folder.read("out/marble.wgsl").len() < live);
    folder.run(line).is(0).says("out/marble.wgsl");
    folder
        .run(&format!("{line} --bake scal=8"))
        .is(2)
        .says("did you mean `scale`");
    folder
        .run(&format!("{line} --bake scale=800"))
        .is(2)
        .says("out of range");
    let render = "render marble.json --output base_color --size 16x16 --method point --device cpu";
    let (a, b) = ("--set scale=8 -o a.png", "--bake scale=8 -o b.png");
    folder.run(&format!("{render} {a}")).is(0);
    folder.run(&format!("{render} {b}")).is(0);
    assert!(folder.read("a.png") == folder.read("b.png"));
}

#[test]
fn a_watch_compiles_what_changes() {
    let folder = Folder::new();
    let line = "compile marble.json --out out --method point --watch";
    let mut command = folder.command(line);
    let mut child = command
        .stderr(Stdio::null())
        .spawn()
        .expect("the command starts");
    let wait = |holds: &dyn Fn() -> bool| {
        let begun = Instant::now();
        while !holds() && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(20));
        }
        holds()
    };
    let shader = folder.path("out/marble.wgsl");
    let began = wait(&|| shader.exists());
    // It may not watch yet when the shader is there: the graph is saved until it is seen.
    let turns = std::cell::Cell::new(0);
    let saw = wait(&|| {
        turns.set(turns.get() + 1);
        if turns.get() % 25 == 1 {
            let text = GRAPH.replace("\"tint\"", "\"shade_of_it\"");
            folder.write("marble.json", format!("{text}{}", " ".repeat(turns.get())));
        }
        fs::read_to_string(&shader).is_ok_and(|text| text.contains("shade_of_it"))
    });
    child.kill().expect("it runs until it is stopped");
    child.wait().expect("it ends");
    assert!(began && saw, "began {began}, saw the change {saw}");
    folder
        .run("compile - --out out --watch")
        .is(2)
        .says("standard input");
}
