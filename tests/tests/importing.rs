//! MaterialX documents, small ones of our own: what each rule makes of them, and what is said of what
//! cannot be had.

use mipless::{CheckOptions, Footprint, Method, NoFiles, Options, Texture};
use mipless_import::{Format, Imported};
use mipless_tests::document::{at, close, mtlx, read, said, texture, value, wrapped};
use std::fmt::Write as _;

const UV: &str = r#"<texcoord name="uv" type="vector2"/>"#;

#[test]
fn angles_turn_and_sides_lie_as_in_materialx() {
    let turned = format!(
        r#"{UV}<rotate2d name="n" type="vector2"><input name="in" type="vector2" nodename="uv"/>
           <input name="amount" type="float" value="90"/></rotate2d>"#
    );
    close(&value(&turned, "vector2", [0.25, 0.5]), &[0.5, -0.25]);
    let ramp =
        r#"<ramptb name="n" type="float"><input name="valuet" type="float" value="1"/></ramptb>"#;
    close(&value(ramp, "float", [0.0, 0.75]), &[0.75]);
    let wave = format!(
        r#"{UV}<extract name="u" type="float"><input name="in" type="vector2" nodename="uv"/></extract>
           <trianglewave name="n" type="float"><input name="in" type="float" nodename="u"/></trianglewave>"#
    );
    let peak = value(&wave, "float", [0.5, 0.0])[0].max(value(&wave, "float", [0.0, 0.0])[0]);
    close(&[peak], &[0.5]);
}

#[test]
fn defaults_are_those_of_the_definition() {
    close(
        &value(r#"<multiply name="n" type="float"/>"#, "float", [0.5; 2]),
        &[0.0],
    );
    let combined =
        r#"<combine4 name="n" type="color4"><input name="in1" type="float" value="1"/></combine4>"#;
    close(&value(combined, "color4", [0.5; 2]), &[1.0, 0.0, 0.0, 0.0]);
    // The generator reads the surface where a literal is written for its coordinates.
    let ramp = r#"<ramplr name="n" type="float"><input name="valuer" type="float" value="1"/>
        <input name="texcoord" type="vector2" value="0, 0"/></ramplr>"#;
    close(&value(ramp, "float", [0.25, 0.0]), &[0.25]);
}

#[test]
fn numbers_go_to_all_channels_and_conversions_fill_up_with_one() {
    let sum = r#"<add name="n" type="color4"><input name="in1" type="color4" value="0.1, 0.2, 0.3, 0.4"/>
        <input name="in2" type="float" value="0.5"/></add>"#;
    close(&value(sum, "color4", [0.5; 2]), &[0.6, 0.7, 0.8, 0.9]);
    let wide = format!(
        r#"{UV}<convert name="n" type="vector4"><input name="in" type="vector2" nodename="uv"/></convert>"#
    );
    close(
        &value(&wide, "vector4", [0.25, 0.5]),
        &[0.25, 0.5, 0.0, 1.0],
    );
    let grey = format!(
        r#"{UV}<extract name="u" type="float"><input name="in" type="vector2" nodename="uv"/></extract>
           <convert name="n" type="color4"><input name="in" type="float" nodename="u"/></convert>"#
    );
    close(&value(&grey, "color4", [0.25, 0.5]), &[0.25; 4]);
}

#[test]
fn vectors_stay_vectors_and_masks_may_be_colours() {
    let vectors = r#"<add name="n" type="vector3"><input name="in1" type="vector3" value="1, 2, 3"/>
        <input name="in2" type="vector3" value="1, 1, 1"/></add>"#;
    close(&value(vectors, "vector3", [0.5; 2]), &[2.0, 3.0, 4.0]);
    let mixed = r#"<mix name="n" type="color3"><input name="fg" type="color3" value="1, 1, 1"/>
        <input name="mix" type="color3" value="0.1, 0.5, 0.9"/></mix>"#;
    close(&value(mixed, "color3", [0.5; 2]), &[0.1, 0.5, 0.9]);
}

#[test]
fn truth_values_are_numbers() {
    let larger = format!(
        r#"{UV}<extract name="u" type="float"><input name="in" type="vector2" nodename="uv"/></extract>
           <ifgreater name="b" type="boolean"><input name="value1" type="float" nodename="u"/>
           <input name="value2" type="float" value="0.5"/></ifgreater>
           <not name="c" type="boolean"><input name="in" type="boolean" nodename="b"/></not>
           <ifequal name="n" type="float"><input name="value1" type="boolean" nodename="c"/>
           <input name="value2" type="boolean" value="true"/><input name="in1" type="float" value="3"/></ifequal>"#
    );
    close(&value(&larger, "float", [0.25, 0.5]), &[3.0]);
    close(&value(&larger, "float", [0.75, 0.5]), &[0.0]);
}

#[test]
fn layers_without_room_and_without_an_alpha_behind_have_no_colour() {
    let layers = r#"<disjointover name="n" type="color4"><input name="fg" type="color4" value="0.5, 1, 0, 2"/>
        <input name="bg" type="color4" value="0.5, 1, 1, 0"/><input name="mix" type="float" value="0.5"/></disjointover>"#;
    close(&value(layers, "color4", [0.5; 2]), &[0.25, 0.5, 0.5, 0.5]);
}

#[test]
fn matrices_are_literals_that_are_worked_out() {
    let moved = format!(
        r#"{UV}<invertmatrix name="m" type="matrix33"><input name="in" type="matrix33" value="2,0,0, 0,2,0, 0,0,1"/></invertmatrix>
           <transformmatrix name="n" type="vector2"><input name="in" type="vector2" nodename="uv"/>
           <input name="mat" type="matrix33" nodename="m"/></transformmatrix>"#
    );
    close(&value(&moved, "vector2", [0.5, 0.25]), &[0.25, 0.125]);
}

#[test]
fn inputs_of_nodegraphs_are_inputs_of_the_graph() {
    let imported = mtlx(
        r#"<nodegraph name="g"><input name="scale" type="float" value="2" uimin="1" uimax="9" uisoftmax="5" doc="How large."/>
           <texcoord name="uv" type="vector2"/>
           <multiply name="n" type="vector2"><input name="in1" type="vector2" nodename="uv"/>
           <input name="in2" type="float" interfacename="scale"/></multiply>
           <output name="out" type="vector2" nodename="n"/></nodegraph>"#,
    );
    let texture = texture(&imported);
    let scale = &texture.parameters()[0];
    assert_eq!(
        (scale.name.as_str(), scale.min, scale.max),
        ("scale", Some(1.0), Some(9.0))
    );
    let entry = &imported.document.as_ref().expect("a graph").body.inputs["scale"];
    assert_eq!(
        (entry.soft_max, entry.doc.as_deref()),
        (Some(5.0), Some("How large."))
    );
}

#[test]
fn an_input_that_feeds_a_bounded_port_is_bounded_as_it_is() {
    let imported = mtlx(
        r#"<nodegraph name="g"><input name="size" type="float" value="0.5"/><input name="period" type="float" value="2"/>
           <circle name="c" type="float"><input name="radius" type="float" interfacename="size"/></circle>
           <modulo name="n" type="float"><input name="in1" type="float" nodename="c"/>
           <input name="in2" type="float" interfacename="period"/></modulo>
           <output name="out" type="float" nodename="n"/></nodegraph>"#,
    );
    let texture = texture(&imported);
    assert!(texture.parameters()[0].min.is_some_and(|min| min >= 0.0));
    // What may be 0 is no divisor: it is written as the number that it holds, and a note says so.
    assert_eq!(texture.parameters().len(), 1);
    assert!(
        said(&imported)
            .iter()
            .any(|(code, ..)| *code == "import-approximated")
    );
}

#[test]
fn inputs_may_be_written_as_the_numbers_that_they_hold() {
    let imported = mtlx(
        r#"<nodegraph name="g"><input name="size" type="float" value="2"/><texcoord name="uv" type="vector2"/>
           <multiply name="m" type="float"><input name="in1" type="float" interfacename="size"/><input name="in2" type="float" value="2"/></multiply>
           <divide name="n" type="vector2"><input name="in1" type="vector2" nodename="uv"/><input name="in2" type="float" nodename="m"/></divide>
           <output name="out" type="vector2" nodename="n"/></nodegraph>"#,
    );
    let document = imported.without_inputs().expect("it has an input");
    assert!(document.body.inputs.is_empty());
    let checked = Texture::from_json(&document.to_text());
    assert!(checked.is_ok(), "{checked:?}");
}

#[test]
fn functional_nodegraphs_are_expanded_where_they_are_used() {
    let imported = mtlx(
        r#"<nodedef name="ND_twice" node="twice"><input name="in" type="float" value="3"/><output name="out" type="float"/></nodedef>
           <nodegraph name="NG_twice" nodedef="ND_twice">
             <multiply name="m" type="float"><input name="in1" type="float" interfacename="in"/><input name="in2" type="float" value="2"/></multiply>
             <output name="out" type="float" nodename="m"/></nodegraph>
           <nodedef name="ND_four" node="four"><input name="in" type="float" value="5"/><output name="out" type="float"/></nodedef>
           <nodegraph name="NG_four" nodedef="ND_four">
             <twice name="a" type="float"><input name="in" type="float" interfacename="in"/></twice>
             <twice name="b" type="float"><input name="in" type="float" nodename="a"/></twice>
             <output name="out" type="float" nodename="b"/></nodegraph>
           <nodegraph name="g"><twice name="x" type="float"/><four name="y" type="float"/>
             <four name="z" type="float"><input name="in" type="float" value="1"/></four>
             <combine3 name="n" type="color3"><input name="in1" type="float" nodename="x"/>
             <input name="in2" type="float" nodename="y"/><input name="in3" type="float" nodename="z"/></combine3>
             <output name="out" type="color3" nodename="n"/></nodegraph>"#,
    );
    close(&at(&imported, [0.5; 2]), &[6.0, 20.0, 4.0]);
}

#[test]
fn nodes_of_an_installation_are_expanded() {
    let library = wrapped(
        r#"<nodedef name="ND_thrice" node="thrice"><input name="in" type="float" value="1"/><output name="out" type="float"/></nodedef>
           <nodegraph name="NG_thrice" nodedef="ND_thrice">
             <multiply name="m" type="float"><input name="in1" type="float" interfacename="in"/><input name="in2" type="float" value="3"/></multiply>
             <output name="out" type="float" nodename="m"/></nodegraph>"#,
    );
    let text = wrapped(
        r#"<nodegraph name="g"><thrice name="n" type="float"/><output name="out" type="float" nodename="n"/></nodegraph>"#,
    );
    let without = read(Format::MaterialX, &text, &[], &[]);
    assert_eq!(said(&without), [("import-node-missing", 3, "/g/n")]);
    let with = read(Format::MaterialX, &text, &[], &[("stdlib.mtlx", &library)]);
    close(&at(&with, [0.5; 2]), &[3.0]);
}

#[test]
fn the_inputs_of_a_material_s_shader_are_the_outputs() {
    let body = r#"<nodegraph name="g"><constant name="c" type="color3"><input name="value" type="color3" value="1, 0, 0"/></constant>
        <output name="out" type="color3" nodename="c"/></nodegraph>
        <standard_surface name="s" type="surfaceshader"><input name="base_color" type="color3" nodegraph="g" output="out"/>
        <input name="specular_roughness" type="float" value="0.25"/></standard_surface>
        <surfacematerial name="m" type="material"><input name="surfaceshader" type="surfaceshader" nodename="s"/></surfacematerial>"#;
    let imported = mtlx(body);
    let names: Vec<(&str, &str)> = (imported.outputs.iter())
        .map(|output| (output.name.as_str(), output.source.as_str()))
        .collect();
    assert_eq!(
        names,
        [
            ("base_color", "g/out"),
            ("specular_roughness", "s/specular_roughness")
        ]
    );
    // All parts of the model are outputs of the graph.
    let texture = texture(&imported);
    let parts: Vec<&str> = (texture.outputs().iter())
        .map(|output| output.name.as_str())
        .collect();
    assert!(
        parts.contains(&"metalness") && parts.contains(&"normal"),
        "{parts:?}"
    );
    close(&part(&imported, "base_color"), &[1.0, 0.0, 0.0]);
    close(&part(&imported, "specular_roughness"), &[0.25]);
    let two = body.to_owned()
        + &body
            .replace("\"s\"", "\"s2\"")
            .replace("\"m\"", "\"m2\"")
            .replace("name=\"g\"", "name=\"h\"");
    let imported = mtlx(&two);
    assert_eq!(imported.outputs[2].name, "s2_base_color");
    close(&part(&imported, "s2_specular_roughness"), &[0.25]);
}

/// The components of an output in the middle.
fn part(imported: &Imported, name: &str) -> Vec<f32> {
    let texture = texture(imported).with_outputs(&[name]);
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let place = Footprint {
        uv: [0.5; 2],
        ..Footprint::default()
    };
    let values = texture.evaluator(&options).evaluate(&[place]);
    values.into_iter().map(|component| component[0]).collect()
}

/// A document of one shader with its inputs, and of its material.
fn shaded(category: &str, inputs: &str) -> String {
    format!(
        r#"<{category} name="s" type="surfaceshader">{inputs}</{category}>
           <surfacematerial name="m" type="material"><input name="surfaceshader" type="surfaceshader" nodename="s"/></surfacematerial>"#
    )
}

#[test]
fn shaders_are_surfaces_with_their_own_defaults_and_weights() {
    let input = |name: &str, ty: &str, value: &str| {
        format!(r#"<input name="{name}" type="{ty}" value="{value}"/>"#)
    };
    let standard = mtlx(&shaded(
        "standard_surface",
        &(input("base", "float", "0.5")
            + &input("base_color", "color3", "1, 0.5, 0")
            + &input("emission_color", "color3", "1, 0, 0")
            + &input("opacity", "color3", "1, 0.5, 0")),
    ));
    close(&part(&standard, "base_color"), &[0.5, 0.25, 0.0]);
    // The shader's own default, which is not the node's.
    close(&part(&standard, "specular_roughness"), &[0.2]);
    // Nothing shines by a weight of 0.
    close(&part(&standard, "emission_color"), &[0.0; 3]);
    close(&part(&standard, "opacity"), &[0.5]);
    let open = mtlx(&shaded(
        "open_pbr_surface",
        &input("base_metalness", "float", "0.75"),
    ));
    close(&part(&open, "base_metalness"), &[0.75]);
    let gltf = mtlx(&shaded(
        "gltf_pbr",
        &(input("alpha", "float", "0.25")
            + &input("emissive", "color3", "0.5, 0.5, 0.5")
            + &input("emissive_strength", "float", "4")),
    ));
    close(&part(&gltf, "alpha"), &[0.25]);
    close(&part(&gltf, "emissive"), &[2.0; 3]);
    let preview = mtlx(&shaded(
        "UsdPreviewSurface",
        &input("diffuseColor", "color3", "0.1, 0.2, 0.3"),
    ));
    close(&part(&preview, "diffuseColor"), &[0.1, 0.2, 0.3]);
}

#[test]
fn what_a_surface_lacks_is_an_output_of_its_own() {
    let imported = mtlx(&shaded(
        "standard_surface",
        r#"<input name="coat" type="float" value="0.5"/><input name="sheen" type="float" value="0"/>
<input name="specular_rotation" type="float" value="0.125"/><input name="metalness" type="float" value="1"/>"#,
    ));
    assert!(imported.is_complete());
    // What is as it is anyway needs no note.
    assert_eq!(
        said(&imported),
        [
            ("import-approximated", 3, "/s/coat"),
            ("import-approximated", 4, "/s/specular_rotation")
        ]
    );
    close(&part(&imported, "coat"), &[0.5]);
    close(&part(&imported, "specular_rotation_input"), &[0.125]);
    close(&part(&imported, "metalness"), &[1.0]);
}

#[test]
fn a_displacement_is_the_height_of_its_material() {
    let imported = mtlx(
        r#"<nodegraph name="g"><ramplr name="n" type="float"><input name="valuer" type="float" value="1"/></ramplr>
             <output name="out" type="float" nodename="n"/></nodegraph>
           <gltf_pbr name="s" type="surfaceshader"/>
           <displacement name="d" type="displacementshader"><input name="displacement" type="float" nodegraph="g" output="out"/>
             <input name="scale" type="float" value="2"/></displacement>
           <surfacematerial name="m" type="material"><input name="surfaceshader" type="surfaceshader" nodename="s"/>
             <input name="displacementshader" type="displacementshader" nodename="d"/></surfacematerial>"#,
    );
    close(&part(&imported, "displacement"), &[1.0]);
    // A slope of 2 turns the normal.
    let length = 5.0f32.sqrt();
    close(
        &part(&imported, "normal"),
        &[-2.0 / length, 0.0, 1.0 / length],
    );
}

#[test]
fn colours_and_lengths_are_read_in_their_space_and_unit() {
    let encoded = r#"<constant name="n" type="color3"><input name="value" type="color3" value="0.5, 0.5, 0.5" colorspace="srgb_texture"/></constant>"#;
    close(&value(encoded, "color3", [0.5; 2]), &[0.214_041_14; 3]);
    let inherited = r#"<nodegraph name="g" colorspace="g22_rec709"><constant name="n" type="color3"><input name="value" type="color3" value="0.5, 0.5, 0.5"/></constant>
        <output name="out" type="color3" nodename="n"/></nodegraph>"#;
    close(&at(&mtlx(inherited), [0.5; 2]), &[0.5f32.powf(2.2); 3]);
    let length = r#"<constant name="n" type="float"><input name="value" type="float" value="2" unit="inch" unittype="distance"/></constant>"#;
    close(&value(length, "float", [0.5; 2]), &[0.0508]);
    let unknown = mtlx(
        r#"<nodegraph name="g"><constant name="n" type="color3">
<input name="value" type="color3" value="1, 1, 1" colorspace="ACES2065-1"/></constant>
<output name="out" type="color3" nodename="n"/></nodegraph>"#,
    );
    assert_eq!(said(&unknown), [("import-colorspace", 4, "/g/n/value")]);
}

#[test]
fn files_have_their_prefixes_and_are_one_each() {
    let imported = mtlx(
        r#"<nodegraph name="g" fileprefix="a/"><image name="i" type="color3" fileprefix="b/"><input name="file" type="filename" value="c.png" colorspace="srgb_texture"/></image>
           <output name="out" type="color3" nodename="i"/></nodegraph>"#,
    );
    let document = imported.document.expect("a graph").to_text();
    assert!(
        document.contains("\"a/b/c.png\"") && document.contains("srgb_texture"),
        "{document}"
    );
    let pattern = mtlx(
        r#"<nodegraph name="g"><image name="i" type="color3"><input name="file" type="filename" value="c.<UDIM>.png"/></image>
           <output name="out" type="color3" nodename="i"/></nodegraph>"#,
    );
    assert_eq!(said(&pattern)[0].0, "import-image");
}

#[test]
fn documents_include_each_other_but_not_themselves() {
    let include = |name: &str| format!("<xi:include href=\"{name}\"/>");
    let graph = r#"<nodegraph name="g"><constant name="c" type="float"><input name="value" type="float" value="2"/></constant>
        <output name="out" type="float" nodename="c"/></nodegraph>"#;
    let text = wrapped(&include("lib/a.mtlx"));
    let files = [
        ("lib/a.mtlx", wrapped(&include("b.mtlx"))),
        ("lib/b.mtlx", wrapped(graph)),
    ];
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(name, text)| (*name, text.as_str()))
        .collect();
    close(
        &at(&read(Format::MaterialX, &text, &files, &[]), [0.5; 2]),
        &[2.0],
    );

    let circle = wrapped(&(include("a.mtlx") + graph));
    let again = wrapped(&include("a.mtlx"));
    let imported = read(Format::MaterialX, &circle, &[("a.mtlx", &again)], &[]);
    let finding = &imported.findings[0];
    assert_eq!(
        (finding.file.as_str(), finding.diagnostic.code),
        ("a.mtlx", "import-include")
    );
    let missing = read(Format::MaterialX, &circle, &[], &[]);
    assert_eq!(said(&missing), [("import-include", 3, "/include")]);
}

#[test]
fn what_1_38_writes_otherwise_becomes_1_39() {
    let old = |body: &str| {
        let text = wrapped(body).replace("1.39", "1.38");
        read(Format::MaterialX, &text, &[], &[])
    };
    let swizzle = old(r#"<nodegraph name="g"><texcoord name="uv" type="vector2"/>
           <swizzle name="n" type="color3"><input name="in" type="vector2" nodename="uv"/><input name="channels" type="string" value="y1x"/></swizzle>
           <output name="out" type="color3" nodename="n"/></nodegraph>"#);
    close(&at(&swizzle, [0.25, 0.5]), &[0.5, 1.0, 0.25]);
    let channels = old(r#"<nodegraph name="g"><texcoord name="uv" type="vector2"/>
           <absval name="n" type="float"><input name="in" type="float" nodename="uv" channels="y"/></absval>
           <output name="out" type="float" nodename="n"/></nodegraph>"#);
    close(&at(&channels, [0.25, 0.5]), &[0.5]);
    let arc = old(
        r#"<nodegraph name="g"><atan2 name="n" type="float"><input name="in1" type="float" value="1"/><input name="in2" type="float" value="0"/></atan2>
           <output name="out" type="float" nodename="n"/></nodegraph>"#,
    );
    close(&at(&arc, [0.5; 2]), &[std::f32::consts::FRAC_PI_2]);
}

#[test]
fn older_versions_are_refused_with_what_to_do() {
    let imported = read(
        Format::MaterialX,
        &wrapped("").replace("1.39", "1.36"),
        &[],
        &[],
    );
    assert_eq!(said(&imported), [("import-version", 2, "")]);
    assert!(imported.findings[0].diagnostic.help.is_some());
}

#[test]
fn what_a_texture_has_not_is_refused_at_its_place_all_at_once() {
    let mut imported = mtlx(
        r#"<nodegraph name="g">
<normal name="a" type="vector3"/>
<viewdirection name="b" type="vector3"/>
<wobble name="c" type="float"/>
<constant name="d" type="float"/>
<output name="o1" type="vector3" nodename="a"/>
<output name="o2" type="vector3" nodename="b"/>
<output name="o3" type="float" nodename="c"/>
<output name="o4" type="float" nodename="d"/>
<output name="o5" type="float" nodename="e"/>
</nodegraph>"#,
    );
    let wanted = [
        ("import-geometry", 4, "/g/a"),
        ("import-geometry", 5, "/g/b"),
        ("import-node-missing", 6, "/g/c"),
        ("import-reference", 12, "/g/o5"),
    ];
    assert_eq!(said(&imported), wanted);
    assert_eq!(imported.summary(), "1 of 5 outputs");
    assert!(!imported.is_complete());
    imported.findings.clear();
    assert_eq!(texture(&imported).outputs().len(), 1);
}

#[test]
fn foreign_code_is_named() {
    let imported = mtlx(
        r#"<nodedef name="ND_x" node="x"><output name="out" type="float"/></nodedef>
           <implementation name="I" nodedef="ND_x" target="genglsl" file="x.glsl"/>
           <nodegraph name="g"><x name="n" type="float"/><output name="out" type="float" nodename="n"/></nodegraph>"#,
    );
    let diagnostic = &imported.findings[0].diagnostic;
    assert_eq!(diagnostic.code, "import-foreign-code");
    assert!(diagnostic.message.contains("x.glsl") && diagnostic.message.contains("genglsl"));
}

#[test]
fn a_mistake_of_the_graph_stands_where_its_node_comes_from() {
    let imported = mtlx(
        r#"<nodegraph name="g"><texcoord name="uv" type="vector2"/>
<image name="i" type="color3"><input name="file" type="filename" value="none.png"/></image>
<output name="out" type="color3" nodename="i"/></nodegraph>"#,
    );
    let text = imported.document.as_ref().expect("a graph").to_text();
    let mistakes = Texture::with_name("t", &text, &CheckOptions::default(), &NoFiles);
    let mistake = mistakes.expect_err("there is no file").remove(0);
    let found = imported.located(mistake);
    assert_eq!(
        (found.diagnostic.line, found.diagnostic.pointer.as_deref()),
        (Some(4), Some("/g/i"))
    );
}

#[test]
fn circles_and_bombs_end() {
    let circle = mtlx(
        r#"<nodegraph name="g"><absval name="a" type="float"><input name="in" type="float" nodename="b"/></absval>
           <absval name="b" type="float"><input name="in" type="float" nodename="a"/></absval>
           <output name="out" type="float" nodename="a"/></nodegraph>"#,
    );
    assert!(
        said(&circle)
            .iter()
            .any(|(code, ..)| *code == "import-circle")
    );
    let interface = mtlx(
        r#"<nodegraph name="g"><input name="a" type="float" interfacename="b"/><input name="b" type="float" interfacename="a"/>
           <absval name="n" type="float"><input name="in" type="float" interfacename="a"/></absval>
           <output name="out" type="float" nodename="n"/></nodegraph>"#,
    );
    assert!(
        said(&interface)
            .iter()
            .any(|(code, ..)| *code == "import-circle")
    );
    // A nodegraph that is several of itself would branch to the limit of uses, which takes its time.
    let nested = mtlx(
        r#"<nodedef name="D" node="n"><input name="in" type="float" value="0"/><output name="out" type="float"/></nodedef>
           <nodegraph name="G" nodedef="D"><n name="a" type="float"/><n name="b" type="float"/>
           <add name="c" type="float"><input name="in1" type="float" nodename="a"/><input name="in2" type="float" nodename="b"/></add>
           <output name="out" type="float" nodename="c"/></nodegraph>
           <nodegraph name="g"><n name="x" type="float"/><output name="out" type="float" nodename="x"/></nodegraph>"#,
    );
    let codes: Vec<_> = said(&nested).iter().map(|(code, ..)| *code).collect();
    assert!(codes.contains(&"import-circle") && !codes.contains(&"import-limit"));
    let entities = "<?xml version=\"1.0\"?><!DOCTYPE m [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]>\n<materialx version=\"1.39\" name=\"&b;\"/>";
    assert_eq!(
        said(&read(Format::MaterialX, entities, &[], &[]))[0].0,
        "import-syntax"
    );
    // Each node is two of the next: 2⁶⁰ in all.
    let mut bomb = String::new();
    for i in 0..60 {
        write!(
            bomb,
            r#"<nodedef name="D{i}" node="n{i}"><input name="in" type="float" value="0"/><output name="out" type="float"/></nodedef>
               <nodegraph name="G{i}" nodedef="D{i}"><n{next} name="a" type="float"><input name="in" type="float" interfacename="in"/></n{next}>
               <n{next} name="b" type="float"><input name="in" type="float" nodename="a"/></n{next}>
               <output name="out" type="float" nodename="b"/></nodegraph>"#,
            next = i + 1
        )
        .expect("a text grows");
    }
    bomb += r#"<nodegraph name="g"><n0 name="x" type="float"/><output name="out" type="float" nodename="x"/></nodegraph>"#;
    let imported = mtlx(&bomb.replace("n60 ", "absval ").replace("n60>", "absval>"));
    assert!(
        said(&imported)
            .iter()
            .any(|(code, ..)| *code == "import-limit")
    );
}

#[test]
fn long_chains_and_deep_elements_are_ordinary() {
    let mut chain = String::from(
        r#"<nodegraph name="g"><texcoord name="uv" type="vector2"/><absval name="n0" type="vector2"><input name="in" type="vector2" nodename="uv"/></absval>"#,
    );
    let count = 20_000;
    for i in 1..count {
        write!(
            chain,
            r#"<add name="n{i}" type="vector2"><input name="in1" type="vector2" nodename="n{}"/><input name="in2" type="float" value="{i}"/></add>"#,
            i - 1
        )
        .expect("a text grows");
    }
    write!(
        chain,
        r#"<output name="out" type="vector2" nodename="n{}"/></nodegraph>"#,
        count - 1
    )
    .expect("a text grows");
    let imported = mtlx(&chain);
    assert!(imported.is_complete());
    let nodes = imported.document.expect("a graph").body.nodes.len();
    assert_eq!(nodes, count + 1);
    let deep = "<a>".repeat(100_000);
    assert!(!read(Format::MaterialX, &wrapped(&deep), &[], &[]).is_complete());
}
