//! Graphs as MaterialX documents: what is written means what the graph means, and comes back as it
//! was.

use mipless::{CheckOptions, Diagnostic, Folder, Footprint, Method, Options, Texture, specs};
use mipless_import::{Exported, Format, export};
use mipless_tests::document::{mtlx, read, texture};
use mipless_tests::root;

/// A graph of JSON text.
fn graph(text: &str) -> Texture {
    Texture::with_name(
        "g",
        text,
        &CheckOptions::default(),
        &Folder(root().join("graphs")),
    )
    .unwrap_or_else(|mistakes| panic!("{mistakes:#?}\n{text}"))
}

fn exported(texture: &Texture) -> Exported {
    export(texture.checked().graph(), &specs())
}

/// The components of all outputs at places off every edge and centre.
fn values(texture: &Texture) -> Vec<Vec<f32>> {
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let places: Vec<Footprint> = (0..64)
        .map(|i| Footprint {
            uv: [
                0.011 + 0.137 * (i % 8) as f32,
                -0.093 + 0.171 * (i / 8) as f32,
            ],
            ..Footprint::default()
        })
        .collect();
    texture.evaluator(&options).evaluate(&places)
}

/// The largest difference of two graphs.
fn difference(first: &Texture, second: &Texture) -> f32 {
    let (first, second) = (values(first), values(second));
    assert_eq!(first.len(), second.len(), "as many components");
    let pairs = first.iter().flatten().zip(second.iter().flatten());
    pairs
        .map(|(a, b)| (a - b).abs() / b.abs().max(1.0))
        .fold(0.0, f32::max)
}

/// Nodes that MaterialX has not and that are not made of what it has.
const REFUSED: [&str; 23] = [
    "blackbody",
    "blendnormal",
    "brick",
    "byexample",
    "colormap2d",
    "curvature",
    "gabornoise2d",
    "heightmask",
    "multifractal2d",
    "normaltoslope",
    "phasornoise2d",
    "rays",
    "ridged2d",
    "scatter",
    "shape",
    "slope",
    "slopemask",
    "slopetonormal",
    "spectralnoise2d",
    "truchet",
    "valuenoise2d",
    "weave",
    "whitenoise2d",
];

#[test]
fn every_node_of_the_catalogue_comes_back_or_is_refused_at_its_place() {
    let mut wrong = Vec::new();
    for spec in specs() {
        let before = graph(spec.example);
        let Exported { text, diagnostics } = exported(&before);
        let said: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
        let errors: Vec<&Diagnostic> = diagnostics.iter().filter(|one| one.is_error()).collect();
        let Some(text) = text else {
            // What the example has beside the node may be refused as well.
            let own = |error: &&&Diagnostic| error.node.as_deref() == Some(spec.name);
            let known = |code: &str| code == "export-node" || code == "export-port";
            let stray = |error: &&Diagnostic| error.pointer.is_none() || !known(error.code);
            let lacking = errors
                .iter()
                .filter(own)
                .any(|error| error.code == "export-node");
            if errors.is_empty()
                || errors.iter().any(stray)
                || lacking != REFUSED.contains(&spec.name)
            {
                wrong.push(format!("{}: {said:?}", spec.name));
            }
            continue;
        };
        if REFUSED.contains(&spec.name) {
            wrong.push(format!("{} is not refused", spec.name));
            continue;
        }
        let imported = read(Format::MaterialX, &text, &[], &[]);
        if !imported.is_complete() {
            let findings: Vec<String> = (imported.findings.iter())
                .map(|finding| finding.diagnostic.to_string())
                .collect();
            wrong.push(format!(
                "{} does not come back: {findings:?}\n{text}",
                spec.name
            ));
            continue;
        }
        // Other blobs are said.
        if !diagnostics.is_empty() {
            continue;
        }
        let document = imported.document.as_ref().expect("a graph").to_text();
        let after = match Texture::with_name(
            "g",
            &document,
            &CheckOptions::default(),
            &Folder(root().join("graphs")),
        ) {
            Ok(after) => after,
            Err(mistakes) => {
                wrong.push(format!("{}: {mistakes:?}\n{text}\n{document}", spec.name));
                continue;
            }
        };
        let off = difference(&before, &after);
        if off.is_nan() || off > 2e-5 {
            wrong.push(format!("{} is off by {off}\n{text}", spec.name));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn inputs_of_the_graph_are_interfaces() {
    let before = graph(
        r#"{ "version": 1, "name": "bands of a kind",
          "inputs": { "how many": { "type": "float", "value": 3, "min": 1, "max": 9, "soft_max": 5, "doc": "Bands <a unit>." } },
          "nodes": { "bands/1": { "type": "stripes", "inputs": { "frequency": { "input": "how many" } } },
                     "tint": { "type": "multiply", "inputs": { "in1": { "node": "bands/1" }, "in2": [0.5, 0.25, 1] } } },
          "outputs": { "tint": { "node": "tint" } } }"#,
    );
    let text = exported(&before).text.expect("a document");
    assert!(text.contains("interfacename=\"how_many\""), "{text}");
    let imported = read(Format::MaterialX, &text, &[], &[]);
    let input = &imported.document.as_ref().expect("a graph").body.inputs["how_many"];
    assert_eq!(
        (input.min, input.max, input.soft_max),
        (Some(1.0), Some(9.0), Some(5.0))
    );
    assert_eq!(input.doc.as_deref(), Some("Bands <a unit>."));
    let after = texture(&imported);
    assert!(difference(&before, &after) < 1e-6, "{text}");
}

#[test]
fn all_that_is_refused_is_refused_at_once_and_what_follows_from_it_is_not() {
    let refused = exported(&graph(
        r#"{ "version": 1, "name": "wall", "nodes": {
          "wall": { "type": "brick" }, "fog": { "type": "noise2d", "inputs": { "period": 4 } },
          "sum": { "type": "add", "inputs": { "in1": { "node": "wall" }, "in2": { "node": "fog" } } },
          "unread": { "type": "brick" } },
          "outputs": { "out": { "node": "sum" } } }"#,
    ));
    assert!(refused.text.is_none());
    let mut said: Vec<(&str, Option<&str>)> = (refused.diagnostics.iter())
        .filter(|diagnostic| diagnostic.is_error())
        .map(|diagnostic| (diagnostic.code, diagnostic.pointer.as_deref()))
        .collect();
    said.sort_unstable();
    assert_eq!(
        said,
        [
            ("export-node", Some("/nodes/wall")),
            ("export-port", Some("/nodes/fog"))
        ]
    );
}

#[test]
fn materialx_documents_come_back_as_they_were() {
    let bodies = [
        r#"<nodegraph name="g"><input name="scale" type="float" value="2" uimin="1" uimax="9"/>
           <texcoord name="uv" type="vector2"/>
           <multiply name="m" type="vector2"><input name="in1" type="vector2" nodename="uv"/><input name="in2" type="float" interfacename="scale"/></multiply>
           <noise2d name="n" type="color3"><input name="amplitude" type="vector3" value="1, 0.5, 0.25"/><input name="texcoord" type="vector2" nodename="m"/></noise2d>
           <output name="o" type="color3" nodename="n"/></nodegraph>"#,
        r#"<nodegraph name="g"><checkerboard name="c" type="color3"><input name="color1" type="color3" value="1, 0, 0.5"/></checkerboard>
           <ramp4 name="r" type="vector4"><input name="valuetl" type="vector4" value="1, 2, 3, 4"/></ramp4>
           <worleynoise3d name="w" type="vector2"/><ifgreater name="b" type="boolean"><input name="value1" type="float" value="1"/></ifgreater>
           <switch name="s" type="color3"><input name="in2" type="color3" nodename="c"/><input name="which" type="integer" value="1"/></switch>
           <output name="a" type="color3" nodename="s"/><output name="d" type="vector4" nodename="r"/>
           <output name="e" type="vector2" nodename="w"/><output name="f" type="boolean" nodename="b"/></nodegraph>"#,
        r#"<nodegraph name="g"><position name="p" type="vector3"/><convert name="v" type="vector4"><input name="in" type="vector3" nodename="p"/></convert>
           <transformmatrix name="m" type="vector4"><input name="in" type="vector4" nodename="v"/><input name="mat" type="matrix44" value="1,0,0,0, 0,2,0,0, 0,0,1,0, 1,0,0,1"/></transformmatrix>
           <extract name="w" type="float"><input name="in" type="vector4" nodename="m"/><input name="index" type="integer" value="3"/></extract>
           <divide name="q" type="vector4"><input name="in1" type="vector4" nodename="m"/><input name="in2" type="float" nodename="w"/></divide>
           <output name="o" type="vector4" nodename="q"/></nodegraph>"#,
    ];
    for body in bodies {
        let before = texture(&mtlx(body));
        let Exported { text, diagnostics } = exported(&before);
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
        let text = text.expect("a document");
        let imported = read(Format::MaterialX, &text, &[], &[]);
        assert_eq!(imported.findings.len(), 0, "{text}");
        assert_eq!(difference(&before, &texture(&imported)), 0.0, "{text}");
        // The second time nothing changes any more.
        let again = exported(&texture(&imported)).text.expect("a document");
        let third = read(Format::MaterialX, &again, &[], &[]);
        let nodes = |imported: &mipless_import::Imported| {
            imported
                .document
                .as_ref()
                .map(|document| document.body.nodes.len())
        };
        assert_eq!(nodes(&third), nodes(&imported), "{again}");
    }
}

#[test]
fn a_surface_is_a_shader_and_a_material_and_comes_back() {
    for (model, category) in [
        ("standard_surface", "standard_surface"),
        ("open_pbr", "open_pbr_surface"),
        ("gltf", "gltf_pbr"),
    ] {
        let before = graph(
            &r##"{ "version": 1, "name": "tiles", "inputs": { "wear": { "type": "float", "value": 0.25, "min": 0.1, "max": 1 } },
              "nodes": { "u": { "type": "ramplr", "inputs": { "valuer": 1 } }, "bands": { "type": "stripes", "inputs": { "frequency": 3 } },
                "s": { "type": "surface", "inputs": { "base_color": { "node": "bands" }, "roughness": { "input": "wear" },
                  "metallic": 0.5, "height": { "node": "u" }, "scale": 0.5, "emission": [1, 0.5, 0], "opacity": { "node": "u" }, "model": "MODEL" } } },
              "outputs": { "s": { "node": "s" }, "coat_roughness": { "node": "u" } } }"##
                .replace("MODEL", model),
        );
        let Exported { text, diagnostics } = exported(&before);
        // glTF's shader has no coat of that name.
        assert_eq!(
            diagnostics.len(),
            usize::from(model == "gltf"),
            "{diagnostics:?}"
        );
        let text = text.expect("a document");
        assert!(
            text.contains(&format!("<{category} ")) && text.contains("<surfacematerial "),
            "{text}"
        );
        let imported = read(Format::MaterialX, &text, &[], &[]);
        assert!(imported.is_complete(), "{text}");
        let after = texture(&imported);
        for output in before.outputs() {
            // What glTF's shader has not is nothing of its document.
            if model == "gltf" && output.name == "coat_roughness" {
                continue;
            }
            let (one, other) = (
                before.with_outputs(&[&output.name]),
                after.with_outputs(&[&output.name]),
            );
            let off = difference(&one, &other);
            assert!(off < 1e-5, "{model} {}: {off}\n{text}", output.name);
        }
    }
}

#[test]
fn a_material_of_numbers_has_no_nodegraph() {
    let text = exported(&graph(
        r#"{ "version": 1, "nodes": { "s": { "type": "surface", "inputs": { "metallic": 1, "occlusion": 0.5 } } },
             "outputs": { "s": { "node": "s" } } }"#,
    ));
    // MaterialX's shader has no occlusion.
    assert_eq!(text.diagnostics.len(), 1);
    let text = text.text.expect("a document");
    assert!(
        text.contains("metalness") && !text.contains("<nodegraph"),
        "{text}"
    );
}
