//! Nodes that evaluate what is upstream over another footprint, against dense sums.

use super::{dense_components, evaluated, footprints, is_long};
use mipless_codegen::Method;
use serde_json::{Value, json};

/// The slope of a plane is exact, along any coordinates.
#[test]
fn normals_of_planes_are_exact() {
    let nodes = json!({
        "uv": { "type": "texcoord" },
        "turned": { "type": "place2d", "inputs": { "texcoord": { "node": "uv" }, "rotate": 30, "scale": [2, 0.5] } },
        "height": { "type": "extract", "inputs": { "in": { "node": "turned" }, "index": 0 } },
        "x": { "type": "heighttonormal", "inputs": { "in": { "node": "height" }, "scale": 8, "texcoord": { "node": "turned" } } }
    });
    let graph = json!({
        "version": 1, "name": "plane", "nodes": nodes, "outputs": { "out": { "node": "x" } }
    })
    .to_string();
    // A slope of ½ along the first coordinate.
    let length = 1.25f64.sqrt();
    let wanted = [0.5 - 0.25 / length, 0.5, 0.5 + 0.5 / length];
    for method in [Method::Point, Method::Local, Method::Quad] {
        for size in [0.0, 0.01, 10.0] {
            let found = evaluated(&graph, method, &footprints(size, true, 5));
            for (i, wanted) in wanted.iter().enumerate() {
                for (value, variance) in found[i].iter().zip(&found[3 + i]) {
                    assert!(
                        (value - wanted).abs() < 1e-5,
                        "{method} {size}: {value}, not {wanted}"
                    );
                    assert!(*variance < 1e-8, "{method} {size}: {variance}");
                }
            }
        }
    }
}

/// The largest and the root mean square error of the means of all components, and the largest of their
/// standard deviations, over the sizes.
fn errors(nodes: &Value, sizes: &[f32], turned: bool, method: Method) -> [f64; 3] {
    let graph = json!({
        "version": 1, "name": "upstream", "nodes": nodes, "outputs": { "out": { "node": "x" } }
    })
    .to_string();
    let (places, points) = if is_long() { (12, 16_000) } else { (6, 4_000) };
    let (mut worst, mut squares, mut spread, mut count) = (0.0f64, 0.0, 0.0f64, 0.0);
    for &size in sizes {
        let footprints = footprints(size, turned, places);
        let found = evaluated(&graph, method, &footprints);
        for (i, truth) in dense_components(&graph, &footprints, points)
            .iter()
            .enumerate()
        {
            for (place, [mean, variance]) in truth.iter().enumerate() {
                let error = found[i][place] - mean;
                worst = worst.max(error.abs());
                squares += error * error;
                count += 1.0;
                let own = found[found.len() / 2 + i][place];
                spread = spread.max((own.sqrt() - variance.sqrt()).abs());
            }
        }
    }
    [worst, (squares / count).sqrt(), spread]
}

/// Sizes in uv for detail of a wavelength of 0.2.
const SIZES: [f32; 7] = [0.002, 0.01, 0.025, 0.05, 0.1, 0.3, 1.0];

/// Holds the errors of `local` and `quad`.
fn held(what: &str, nodes: &Value, bounds: [f64; 3]) {
    for method in [Method::Local, Method::Quad] {
        for turned in [false, true] {
            let each: Vec<f64> = (SIZES.iter())
                .map(|&size| errors(nodes, &[size], turned, method)[0])
                .collect();
            let found = errors(nodes, &SIZES, turned, method);
            println!("{what} by {method}, turned {turned}: {found:.4?}; by size {each:.3?}");
            for (found, bound) in found.iter().zip(bounds) {
                assert!(*found <= bound, "{what} by {method}: {found} > {bound}");
            }
        }
    }
}

fn normal(height: &Value, scale: f32) -> Value {
    let normal = json!({ "in": { "node": "height" }, "scale": scale });
    json!({ "height": height, "x": { "type": "heighttonormal", "inputs": normal } })
}

fn blur(nodes: &Value, size: f32) -> Value {
    let mut nodes = nodes.clone();
    let inputs = json!({ "in": { "node": "sharp" }, "size": size });
    nodes["x"] = json!({ "type": "blur", "inputs": inputs });
    nodes
}

#[test]
fn normals_of_waves_and_noises() {
    let wave = json!({ "type": "wave", "inputs": { "frequency": 5, "rotate": 30 } });
    held("wave", &normal(&wave, 0.5), [0.01, 0.003, 0.06]);
    let noise = json!({ "type": "noise2d", "inputs": { "frequency": 6, "amplitude": 1 } });
    held("noise", &normal(&noise, 1.0), [0.036, 0.007, 0.11]);
    let noise = json!({ "type": "fractal2d", "inputs": { "frequency": 4, "amplitude": 1 } });
    held("fractal", &normal(&noise, 1.0), [0.04, 0.01, 0.1]);
    let inputs = json!({ "columns": 3, "rows": 6, "mortar": 0.1, "bevel": 0.3 });
    let wall = json!({ "type": "brick", "inputs": inputs });
    held("brick", &normal(&wall, 1.0), [0.09, 0.02, 0.19]);
}

#[test]
fn normals_of_a_map() {
    let noise = json!({ "type": "fractal2d", "inputs": { "frequency": 4, "amplitude": 1 } });
    let of = |steep: f32, scale: f32| {
        let mut nodes = normal(&noise, steep);
        nodes["map"] = nodes["x"].take();
        let inputs = json!({ "in": { "node": "map" }, "scale": scale });
        nodes["x"] = json!({ "type": "normalmap", "inputs": inputs });
        nodes
    };
    // Slopes of standard deviations of 0.35, 0.7 and 1.4.
    held("gentle", &of(0.5, 1.0), [0.024, 0.006, 0.1]);
    held("normal", &of(1.0, 1.0), [0.075, 0.02, 0.18]);
    held("steep", &of(1.0, 2.0), [0.16, 0.05, 0.26]);
}

#[test]
fn blurs_of_patterns_and_noises() {
    let wall = json!({ "type": "brick", "inputs": { "columns": 3, "rows": 6, "mortar": 0.1 } });
    let nodes = json!({ "sharp": wall });
    held("blurred wall", &blur(&nodes, 0.1), [2e-3, 1e-3, 0.3]);
    let noise = json!({ "type": "noise2d", "inputs": { "frequency": 6 } });
    held(
        "blurred noise",
        &blur(&json!({ "sharp": noise }), 0.15),
        [0.05, 0.02, 0.13],
    );
    let step = json!({ "type": "step", "inputs": { "in": { "node": "noise" } } });
    let nodes = json!({ "noise": noise, "sharp": step });
    held("blurred step", &blur(&nodes, 0.15), [0.057, 0.02, 0.13]);
}
