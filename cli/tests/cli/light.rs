//! Materials under a light.

use crate::folder::{Folder, GRAPH};

const SMALL: &str = "--size 24x16 --device cpu";

const STONE: &str = r##"{
    "version": 1,
    "name": "stone",
    "nodes": {
        "noise": { "type": "fractal2d", "inputs": { "frequency": 4 } },
        "color": { "type": "colorramp", "inputs": { "in": { "node": "noise" },
            "stops": [ { "at": -0.5, "value": "#2a2522" }, { "at": 0.5, "value": "#a39a88" } ] } },
        "surface": { "type": "surface", "inputs": { "base_color": { "node": "color" },
            "roughness": 0.3, "height": { "node": "noise" }, "scale": 0.1 } }
    },
    "outputs": { "material": { "node": "surface" } }
}"##;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("stone.json", STONE);
    folder
}

/// The channels of a picture.
fn pixels(folder: &Folder, line: &str) -> Vec<f32> {
    folder
        .run(&format!("render stone.json -o a.exr {SMALL} {line}"))
        .is(0);
    let image = exr::prelude::read_first_flat_layer_from_file(folder.path("a.exr"));
    let channels = image.expect("an EXR").layer_data.channel_data.list;
    assert_eq!(channels.len(), 3, "a colour");
    channels
        .iter()
        .flat_map(|c| c.sample_data.values_as_f32().collect::<Vec<f32>>())
        .collect()
}

#[test]
fn a_material_is_lit_from_where_the_sun_stands() {
    let folder = folder();
    for view in ["plane", "flat", "sphere"] {
        let plain = pixels(&folder, &format!("--view {view}"));
        assert!(
            plain.iter().all(|x| x.is_finite() && *x >= 0.0),
            "{view}: {plain:?}"
        );
        assert!(plain.iter().any(|x| *x > 0.05), "{view} is dark");
        for light in ["30,60", "-150,5", "0,0.01", "90,90"] {
            let other = pixels(&folder, &format!("--view {view} --light {light}"));
            assert!(
                other.iter().all(|x| x.is_finite() && *x >= 0.0),
                "{view} {light}"
            );
            assert_ne!(plain, other, "{view} {light}");
        }
    }
    // A sphere may be lit from below.
    pixels(&folder, "--view sphere --light 0,-40");
}

#[test]
fn lights_that_light_nothing_are_refused() {
    let folder = folder();
    for light in ["10,-5", "10,0", "10,-90"] {
        for view in ["plane", "flat"] {
            let line = format!("render stone.json -o a.png {SMALL} --view {view} --light {light}");
            folder
                .run(&line)
                .is(2)
                .says("light-below-horizon")
                .says("above 0");
        }
    }
    for (more, says) in [
        ("--light 10,91", "at most 90"),
        ("--light 10", "AZIMUTH,ELEVATION"),
        ("--light 10,20 --output base_color", "leave one of them out"),
        ("--moments m.exr", "name a part of it"),
        ("--tolerance 0.1", "name it by `--output`"),
    ] {
        folder
            .run(&format!("render stone.json -o a.png {SMALL} {more}"))
            .is(2)
            .says(says);
    }
    folder.write("plain.json", GRAPH);
    let line = format!("render plain.json -o a.png {SMALL} --light 10,20");
    folder
        .run(&line)
        .is(2)
        .says("no-surface")
        .says("end the graph in a `surface`");
    folder
        .run("compile plain.json --shade --out out")
        .is(2)
        .says("no-surface");
    assert!(!folder.path("a.png").exists());
}

#[test]
fn shading_stands_beside_the_texture_in_every_target() {
    let folder = folder();
    folder
        .run("compile stone.json --shade --out out --target wgsl,glsl,hlsl,msl,spirv")
        .is(0);
    for file in ["stone.wgsl", "stone.frag", "stone.hlsl", "stone.metal"] {
        let text = String::from_utf8_lossy(&folder.read(&format!("out/{file}"))).into_owned();
        for function in ["stone_shade", "stone_shade_sky"] {
            assert!(
                text.contains(&format!("{function}(")),
                "{function} in {file}"
            );
        }
    }
    let manifest = folder.read("out/stone.json");
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).expect("JSON");
    assert_eq!(
        manifest["shading"],
        serde_json::json!(["stone_shade", "stone_shade_sky"])
    );
}

#[test]
fn a_lit_material_is_nearer_to_its_truth_than_points_are() {
    let folder = folder();
    let line = "compare stone.json -o a.png --size 48x32 --device cpu --view flat --window 0,0,8,6 \
                --samples 64 --json";
    let found = folder.run(line).is(0).json();
    let error = |k: usize| found["methods"][k]["error"].as_f64().expect("a number");
    assert!(error(1) < 0.5 * error(0), "{found}");
}
