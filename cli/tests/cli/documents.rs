//! Documents of other tools, wherever a graph is wanted.

use crate::folder::Folder;

const MARBLE: &str = r#"<?xml version="1.0"?>
<materialx version="1.39">
  <nodegraph name="veins">
    <input name="scale" type="float" value="4" uimin="1" uimax="9"/>
    <texcoord name="uv" type="vector2"/>
    <multiply name="at" type="vector2">
      <input name="in1" type="vector2" nodename="uv"/>
      <input name="in2" type="float" interfacename="scale"/>
    </multiply>
    <checkerboard name="board" type="color3">
      <input name="texcoord" type="vector2" nodename="at"/>
    </checkerboard>
    <normal name="normal" type="vector3"/>
    <output name="color" type="color3" nodename="board"/>
    <output name="bent" type="vector3" nodename="normal"/>
  </nodegraph>
  <standard_surface name="surface" type="surfaceshader">
    <input name="specular_roughness" type="float" value="0.25"/>
    <input name="base_color" type="color3" nodegraph="veins" output="color"/>
  </standard_surface>
  <surfacematerial name="marble" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="surface"/>
  </surfacematerial>
</materialx>
"#;

#[test]
fn every_verb_takes_them_and_shows_the_colour() {
    let folder = Folder::new();
    folder.write("board.mtlx", MARBLE);
    folder
        .run("render board.mtlx -o a.png --size 16x16 --device cpu --set scale=2")
        .is(0);
    folder.run("check board.mtlx").is(0);
    folder.run("compile board.mtlx --out shaders").is(0);
    assert!(folder.path("shaders/board.wgsl").exists());
}

#[test]
fn import_writes_the_graph_and_says_how_much_loads() {
    let folder = Folder::new();
    folder.write("board.mtlx", MARBLE);
    folder
        .run("import board.mtlx -o board.json")
        .is(0)
        .says("2 of 2 outputs");
    folder.run("check board.json").is(0);
    let json = folder
        .run("--json import board.mtlx --material veins --partial")
        .is(0)
        .json();
    assert_eq!(json["summary"], "1 of 2 outputs");
    assert_eq!(json["diagnostics"][0]["code"], "import-geometry");
    assert_eq!(json["diagnostics"][0]["line"], 13);
}

#[test]
fn what_cannot_be_had_stops_unless_a_part_is_wanted() {
    let folder = Folder::new();
    folder.write("board.mtlx", MARBLE);
    let codes = folder
        .run("--json check board.mtlx --material veins")
        .is(1)
        .codes();
    assert_eq!(codes, ["import-geometry", "import-incomplete"]);
    folder
        .run("check board.mtlx --material veins --partial")
        .is(0);
    folder
        .run("check board.mtlx --material nothing")
        .is(1)
        .says("import-reference");
    folder
        .run("check board.mtlx --library nowhere")
        .is(2)
        .says("--library");
    folder.run("import marble.json").is(2).says(".mtlx");
}

#[test]
fn what_is_approximated_is_refused_where_that_is_asked() {
    let folder = Folder::new();
    let text = MARBLE.replace("<normal name=\"normal\" type=\"vector3\"/>", "")
        .replace("<output name=\"bent\" type=\"vector3\" nodename=\"normal\"/>", "")
        .replace("<texcoord name=\"uv\" type=\"vector2\"/>", "<time name=\"t\" type=\"float\"/><combine2 name=\"uv\" type=\"vector2\"><input name=\"in1\" type=\"float\" nodename=\"t\"/></combine2>");
    folder.write("time.mtlx", text);
    folder
        .run("check time.mtlx")
        .is(0)
        .says("note[import-approximated]");
    folder
        .run("check time.mtlx --strict")
        .is(1)
        .says("error[import-approximated]");
}

#[test]
fn included_files_stay_within_the_root() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("inside")).expect("a folder");
    folder.write("outside.mtlx", MARBLE);
    let include = "<?xml version=\"1.0\"?><materialx version=\"1.39\"><xi:include href=\"../outside.mtlx\"/></materialx>";
    folder.write("inside/a.mtlx", include);
    folder.run("check inside/a.mtlx").is(0);
    folder
        .run("check inside/a.mtlx --root inside")
        .is(1)
        .says("import-include");
}
