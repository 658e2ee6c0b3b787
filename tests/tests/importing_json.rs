//! Material Maker's and glTF's documents, small ones of our own.

use mipless_import::Format;
use mipless_tests::document::{at, close, read, said, wrapped};

#[test]
fn a_material_maker_document_is_read_from_its_material() {
    let text = r#"{ "type": "graph", "nodes": [
        { "name": "Material", "type": "material", "parameters": {} },
        { "name": "wave", "type": "pattern", "parameters": { "mix": 0, "x_wave": 3, "x_scale": 2, "y_wave": 4, "y_scale": 1 } },
        { "name": "moved", "type": "translate", "parameters": { "translate_x": "0.5 / ($count + 1)", "translate_y": 0 } },
        { "name": "inner", "type": "graph", "parameters": { "param0": 0.25 },
          "nodes": [
            { "name": "gen_parameters", "type": "remote", "parameters": { "param0": 1 }, "widgets": [
              { "type": "linked_control", "name": "param0", "linked_widgets": [ { "node": "grey", "widget": "color" } ] } ] },
            { "name": "grey", "type": "uniform_greyscale", "parameters": { "color": 1 } },
            { "name": "gen_inputs", "type": "ios" }, { "name": "gen_outputs", "type": "ios" },
            { "name": "blend", "type": "blend", "parameters": { "blend_type": 2, "amount": 1 } } ],
          "connections": [
            { "from": "gen_inputs", "from_port": 0, "to": "blend", "to_port": 0 },
            { "from": "grey", "from_port": 0, "to": "blend", "to_port": 1 },
            { "from": "blend", "from_port": 0, "to": "gen_outputs", "to_port": 0 } ] },
        { "name": "gen_parameters", "type": "remote", "parameters": { "count": 1 }, "widgets": [] } ],
      "connections": [
        { "from": "wave", "from_port": 0, "to": "moved", "to_port": 0 },
        { "from": "moved", "from_port": 0, "to": "inner", "to_port": 0 },
        { "from": "inner", "from_port": 0, "to": "Material", "to_port": 2 },
        { "from": "wave", "from_port": 0, "to": "Material", "to_port": 0 } ] }"#;
    let imported = read(Format::MaterialMaker, text, &[], &[]);
    let names: Vec<&str> = imported
        .outputs
        .iter()
        .map(|output| output.name.as_str())
        .collect();
    assert_eq!(names, ["albedo", "roughness"]);
    let values = at(&imported, [0.4, 0.5]);
    // A saw tooth of .8, as a display shows it; the same moved by 1/4, times what the control sets.
    let linear = ((0.8f32 + 0.055) / 1.055).powf(2.4);
    close(&values, &[linear, linear, linear, 0.25 * 0.3]);
}

#[test]
fn what_material_maker_documents_cannot_have_is_refused_at_its_place() {
    let text = "{ \"nodes\": [\n { \"name\": \"Material\", \"type\": \"material\" },\n { \"name\": \"code\", \"type\": \"shader\" },\n { \"name\": \"loop\", \"type\": \"invert\" } ],\n \"connections\": [\n { \"from\": \"code\", \"from_port\": 0, \"to\": \"Material\", \"to_port\": 0 },\n { \"from\": \"loop\", \"from_port\": 0, \"to\": \"Material\", \"to_port\": 1 },\n { \"from\": \"loop\", \"from_port\": 0, \"to\": \"loop\", \"to_port\": 0 } ] }";
    let imported = read(Format::MaterialMaker, text, &[], &[]);
    assert_eq!(
        said(&imported),
        [
            ("import-foreign-code", 3, "/code"),
            ("import-limit", 4, "/loop")
        ]
    );
}

#[test]
fn a_gltf_document_is_materialx_in_json() {
    let text = r#"{ "extensions": { "KHR_texture_procedurals": { "procedurals": [ { "name": "g", "nodetype": "nodegraph", "type": "color3",
        "inputs": { "tint": { "nodetype": "input", "type": "color3", "value": [0.5, 0.25, 1] } },
        "nodes": [
          { "name": "uv", "nodetype": "texcoord", "type": "vector2", "inputs": {} },
          { "name": "u", "nodetype": "extract", "type": "float", "inputs": { "in": { "type": "vector2", "node": 0 }, "index": { "type": "integer", "value": [0] } } },
          { "name": "n", "nodetype": "multiply", "type": "color3", "inputs": { "in1": { "type": "color3", "input": "tint" }, "in2": { "type": "float", "node": 1 } } } ],
        "outputs": { "out": { "nodetype": "output", "type": "color3", "node": 2 } } } ] } },
      "materials": [ { "name": "m", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_procedurals": { "index": 0, "output": "out" } } } } } ] }"#;
    let imported = read(Format::Gltf, text, &[], &[]);
    assert_eq!(imported.outputs[0].name, "base_color");
    // The metal and the roughness are those of a material that does not say them.
    let values = at(&imported, [0.5, 0.0]);
    close(&values[..5], &[0.25, 0.125, 0.5, 1.0, 1.0]);
    let tinted = text.replace(
        "\"pbrMetallicRoughness\": {",
        "\"pbrMetallicRoughness\": { \"baseColorFactor\": [1, 0.5, 0, 1], \"metallicFactor\": 0.25,",
    );
    let values = at(&read(Format::Gltf, &tinted, &[], &[]), [0.5, 0.0]);
    close(&values[..4], &[0.25, 0.0625, 0.0, 0.25]);
    let wrong = read(
        Format::Gltf,
        &text.replace("\"node\": 2", "\"node\": 7"),
        &[],
        &[],
    );
    assert_eq!(said(&wrong)[0].0, "import-reference");
}

#[test]
fn every_truncation_of_a_document_is_refused_with_a_place() {
    let documents = [
        (Format::MaterialX, wrapped(r#"<nodegraph name="g"><absval name="n" type="float"/><output name="out" type="float" nodename="n"/></nodegraph>"#)),
        (Format::MaterialX, wrapped(r#"<nodedef name="ND_d" node="d"><input name="in" type="vector2" defaultgeomprop="UV0"/><output name="out" type="color3"/></nodedef>
           <nodegraph name="NG_d" nodedef="ND_d"><noise2d name="n" type="color3"><input name="texcoord" type="vector2" interfacename="in"/></noise2d><output name="out" type="color3" nodename="n"/></nodegraph>
           <nodegraph name="g"><input name="k" type="float" value="2" uimin="1" unit="degree" unittype="angle"/><d name="d" type="color3"/>
           <multiply name="m" type="color3" colorspace="srgb_texture"><input name="in1" type="color3" nodename="d"/><input name="in2" type="float" interfacename="k"/></multiply>
           <output name="out" type="color3" nodename="m"/></nodegraph>
           <standard_surface name="s" type="surfaceshader"><input name="base_color" type="color3" nodegraph="g" output="out"/></standard_surface>
           <surfacematerial name="M" type="material"><input name="surfaceshader" type="surfaceshader" nodename="s"/></surfacematerial>"#)),
        (Format::MaterialMaker, r#"{ "nodes": [ { "name": "Material", "type": "material" } ], "connections": [] }"#.to_owned()),
        (Format::Gltf, r#"{ "extensions": { "KHR_texture_procedurals": { "procedurals": [ { "nodes": [ { "inputs": { "a": {} } } ] } ] } } }"#.to_owned()),
    ];
    for (format, text) in documents {
        for end in 0..text.len() {
            let imported = read(format, &text[..end], &[], &[]);
            assert!(
                !imported.findings.is_empty(),
                "{format:?}: {}",
                &text[..end]
            );
            assert!(
                imported
                    .findings
                    .iter()
                    .all(|finding| finding.diagnostic.line.is_some())
            );
        }
    }
}

#[test]
fn a_shader_that_is_one_expression_is_read_and_layers_lie_by_their_height() {
    let text = r#"{ "type": "graph", "nodes": [
        { "name": "Material", "type": "material", "parameters": {} },
        { "name": "tint", "type": "shader", "parameters": {
            "c1": { "type": "Color", "r": 1, "g": 0, "b": 0.5, "a": 1 }, "c2": { "type": "Color", "r": 0, "g": 1, "b": 0.5, "a": 1 }, "k": 2 },
          "shader_model": { "code": "", "global": [""], "inputs": [ { "name": "in", "type": "f", "default": "$uv.x" } ],
            "outputs": [ { "type": "rgba", "rgba": "mix($c1, $c2, clamp($k * $in($uv) - 0.25, 0.0, 1.0))" } ],
            "parameters": [ { "name": "c1", "type": "color" }, { "name": "c2", "type": "color" }, { "name": "k", "type": "float" } ] } },
        { "name": "slope", "type": "gradient", "parameters": { "repeat": 1, "rotate": 0, "gradient": { "type": "Gradient",
            "points": [ { "pos": 0, "r": 0, "g": 0, "b": 0, "a": 1 }, { "pos": 1, "r": 1, "g": 1, "b": 1, "a": 1 } ] } } },
        { "name": "low", "type": "mwf_create_map", "parameters": { "height": 0.5, "angle": 0 } },
        { "name": "ground", "type": "mwf_map", "parameters": {} },
        { "name": "layers", "type": "mwf_mix", "parameters": {} },
        { "name": "end", "type": "mwf_output", "parameters": { "param0": 1, "param2": 1 } } ],
      "connections": [
        { "from": "tint", "from_port": 0, "to": "ground", "to_port": 1 },
        { "from": "low", "from_port": 0, "to": "ground", "to_port": 0 },
        { "from": "ground", "from_port": 0, "to": "layers", "to_port": 0 },
        { "from": "tint", "from_port": 0, "to": "layers", "to_port": 1 },
        { "from": "slope", "from_port": 0, "to": "layers", "to_port": 5 },
        { "from": "layers", "from_port": 1, "to": "end", "to_port": 1 },
        { "from": "layers", "from_port": 0, "to": "end", "to_port": 0 },
        { "from": "end", "from_port": 0, "to": "Material", "to_port": 0 },
        { "from": "end", "from_port": 6, "to": "Material", "to_port": 6 } ] }"#;
    let imported = read(Format::MaterialMaker, text, &[], &[]);
    assert_eq!(imported.summary(), "2 of 2 outputs");
    let decoded = |x: f32| ((x + 0.055) / 1.055).powf(2.4);
    // At u = .375 the tint is half of both; the ground lies at 1/2, above the slope.
    let middle = decoded(0.5);
    close(&at(&imported, [0.375, 0.2]), &[middle, middle, middle, 0.5]);
    // At u = .75 the slope is higher, and has no colour.
    close(&at(&imported, [0.75, 0.2]), &[0.0, 0.0, 0.0, 0.25]);
}
