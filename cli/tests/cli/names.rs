//! Graphs without a name are called as their files are, and texts may begin with a byte order mark.

use crate::folder::{Folder, GRAPH, Run};
use std::io::Write;
use std::process::Stdio;
use std::time::Duration;

const SMALL: &str = "--size 24x16 --device cpu";

fn nameless() -> String {
    let text = GRAPH.replace("    \"name\": \"marble\",\n", "");
    assert_ne!(text, GRAPH);
    text
}

#[test]
fn shaders_of_a_graph_without_a_name_are_called_as_its_file() {
    let folder = Folder::new();
    let named = [
        ("old wall.json", "old_wall"),
        // No name ends in a digit.
        ("Wall (2).v1.json", "wall_2_v1_value"),
        ("7 tiles", "texture7_tiles"),
        ("while.json", "while_value"),
        // `texture` is a word of HLSL.
        ("стена.json", "texture_value"),
        (".json", "texture_json"),
    ];
    for (file, function) in named {
        folder.write(file, nameless());
        let out = format!("out-{function}");
        let mut command = folder.command("compile --target wgsl,spirv,glsl,hlsl,msl");
        let output = command.arg("--out").arg(&out).arg(file).output();
        Run::new(file, output.expect("the command starts"), Duration::ZERO).is(0);
        for extension in ["wgsl", "spv", "frag", "hlsl", "metal", "json"] {
            let path = folder.path(&format!("{out}/{function}.{extension}"));
            assert!(path.is_file(), "{file}: no {}", path.display());
        }
        let text = folder.read(&format!("{out}/{function}.wgsl"));
        let text = String::from_utf8(text).expect("UTF-8");
        assert!(text.contains(&format!("fn {function}(")), "{text}");
    }
}

#[test]
fn a_name_in_the_document_is_the_name_whatever_the_file() {
    let folder = Folder::new();
    folder.write("other.json", GRAPH);
    folder.run("compile other.json --out out").is(0);
    assert!(folder.path("out/marble.wgsl").is_file());
}

#[test]
fn two_files_of_like_names_do_not_overwrite_each_other() {
    let folder = Folder::new();
    folder.write("a-b.json", nameless());
    folder.write("a_b.json", nameless());
    folder
        .run("compile a-b.json a_b.json --out out")
        .is(2)
        .says("would both write");
}

#[test]
fn standard_input_without_a_name_is_a_texture() {
    let folder = Folder::new();
    let line = "compile - --out out";
    let mut command = folder.command(line);
    command.stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    let mut input = child.stdin.take().expect("a pipe");
    input.write_all(nameless().as_bytes()).expect("a pipe");
    drop(input);
    let output = child.wait_with_output().expect("the command ends");
    Run::new(line, output, Duration::ZERO).is(0);
    assert!(folder.path("out/texture_value.wgsl").is_file());
}

#[test]
fn every_verb_takes_a_nameless_text_with_a_byte_order_mark() {
    let folder = Folder::new();
    folder.write("wall.json", format!("\u{feff}{}", nameless()));
    folder.run("check wall.json").is(0);
    folder
        .run(&format!(
            "render wall.json -o a.png --output height {SMALL}"
        ))
        .is(0);
    folder.run("compile wall.json --out out").is(0);
    assert!(folder.path("out/wall.wgsl").is_file());
    folder.write("plain.json", nameless());
    folder
        .run(&format!(
            "render plain.json -o b.png --output height {SMALL}"
        ))
        .is(0);
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
    // A mistake on the first line stands where an editor shows it.
    folder.write("bad.json", "\u{feff}{ \"version\": 1, \"nodes\": 7 }");
    folder.run("check bad.json").is(1).says("line 1, column 26");
}
