//! Materials, masks and normals over footprints: against their own formulas in f64, and dense sums.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, compile};
use mipless_graph::{CheckOptions, Graph, check, load};
use serde_json::{Value, json};

fn graph(nodes: &Value, output: &str) -> Graph {
    let document = json!({ "version": 1, "name": "test", "nodes": nodes,
        "outputs": { "out": { "node": output } } });
    let loaded = load(&document.to_string(), &mipless_nodes::specs());
    (loaded.graph).unwrap_or_else(|| panic!("{:?}", loaded.diagnostics))
}

fn evaluated(graph: Graph, method: Method, footprints: &[Footprint]) -> Vec<Vec<f32>> {
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        ..Options::default()
    };
    let program = compile(&checked, mipless_nodes::catalogue(), &options);
    eval_program::<f32>(&program, footprints, &[])
}

/// Parts of the material `surface` by `local`.
fn parts(nodes: &Value, names: &[&str], footprints: &[Footprint]) -> Vec<Vec<f32>> {
    let graph = graph(nodes, "surface");
    let parts = graph.with_parts(&graph.materials[0], names);
    evaluated(parts, Method::Local, footprints)
}

/// Places with footprints of this size, round and 4:1 askew in turns.
fn places(size: f32) -> Vec<Footprint> {
    (0..64)
        .map(|i| {
            let at =
                [0.754_877_7, 0.569_840_3].map(|step: f64| (f64::from(i) * step).fract() * 7.0);
            let long = if i % 2 == 0 { 1.0 } else { 4.0 };
            let (sin, cos) = (0.7 * i as f32).sin_cos();
            Footprint {
                du: [long * size * cos, long * size * sin],
                dv: [-size * sin, size * cos],
                ..Footprint::point(at)
            }
        })
        .collect()
}

/// The root mean square over places of the error of the mean of a node against sums of 1024 points.
fn error(nodes: &Value, output: &str, size: f32) -> f64 {
    let footprints = places(size);
    let found = evaluated(graph(nodes, output), Method::Local, &footprints);
    let truth = evaluated(graph(nodes, output), Method::Supersample(1024), &footprints);
    let (mut sum, mut count) = (0.0, 0.0);
    for (found, truth) in found.iter().flatten().zip(truth.iter().flatten()) {
        sum += f64::from(found - truth).powi(2);
        count += 1.0;
    }
    (sum / count).sqrt()
}

fn hills(scale: f64, model: &str) -> Value {
    json!({
        "hills": { "type": "gabornoise2d", "inputs": { "frequency": 4, "anisotropy": 0.6, "orientation": 25 } },
        "surface": { "type": "surface", "inputs": { "height": { "node": "hills" }, "scale": scale,
            "roughness": 0.3, "occlusion": 0.8, "model": model } }
    })
}

/// The squares of the widths, and twice the angle of the longer, that the moments of the slopes ask for.
fn wanted(slopes: &[Vec<f32>], i: usize, own: f64) -> [f64; 3] {
    let at = |k: usize| f64::from(slopes[k][i]);
    let (m, s) = ([at(0), at(1)], [at(2), at(3), at(4)]);
    let tilt = m[0].hypot(m[1]);
    let up = 1.0 / (1.0 + tilt * tilt);
    let (cos, sin) = if tilt > 0.0 {
        (m[0] / tilt, m[1] / tilt)
    } else {
        (1.0, 0.0)
    };
    // Along and across the tilt, and back.
    let along = s[0] * cos * cos + 2.0 * s[1] * cos * sin + s[2] * sin * sin;
    let across = s[0] * sin * sin - 2.0 * s[1] * cos * sin + s[2] * cos * cos;
    let both = (s[2] - s[0]) * cos * sin + s[1] * (cos * cos - sin * sin);
    let (along, both, across) = (along * up * up, both * up.powf(1.5), across * up);
    let uu = along * cos * cos - 2.0 * both * cos * sin + across * sin * sin;
    let vv = along * sin * sin + 2.0 * both * cos * sin + across * cos * cos;
    let uv = (along - across) * cos * sin + both * (cos * cos - sin * sin);
    let root = (0.5 * (uu - vv)).hypot(uv);
    let middle = 0.5 * (uu + vv);
    [
        own + 2.0 * (middle + root),
        own + 2.0 * (middle - root).max(0.0),
        uv.atan2(0.5 * (uu - vv)),
    ]
}

#[test]
fn each_model_has_the_widths_that_the_removed_slopes_ask_for() {
    let own = 0.3f64.powi(4);
    for size in [0.01, 0.05, 0.3] {
        let footprints = places(size);
        let moments = ["slope_mean", "slope_covariance"];
        let slopes = parts(&hills(0.2, "standard_surface"), &moments, &footprints);
        let names = [
            "specular_roughness",
            "specular_anisotropy",
            "specular_rotation",
            "diffuse_roughness",
            "normal",
        ];
        let standard = parts(&hills(0.2, "standard_surface"), &names, &footprints);
        let names = [
            "specular_roughness",
            "specular_roughness_anisotropy",
            "geometry_tangent",
        ];
        let open = parts(&hills(0.2, "open_pbr"), &names, &footprints);
        let gltf = parts(&hills(0.2, "gltf"), &["roughness"], &footprints);
        for i in 0..footprints.len() {
            let [long, short, doubled] = wanted(&slopes, i, own);
            let near = |what: &str, found: f64, wanted: f64| {
                assert!(
                    (found - wanted).abs() < 2e-3 * (1.0 + wanted.abs()),
                    "{what} at {i}: {found}, not {wanted}"
                );
            };
            let at = |all: &[Vec<f32>], k: usize| f64::from(all[k][i]);
            // `roughness_anisotropy` of MaterialX.
            let (r, a) = (at(&standard, 0), at(&standard, 1));
            let aspect = (1.0 - a).sqrt();
            near("long", r * r / aspect, long.sqrt().min(1.0));
            near("short", r * r * aspect, short.sqrt());
            // `open_pbr_anisotropy`.
            let (r, a) = (at(&open, 0), at(&open, 1));
            let along = r * r * (2.0 / (1.0 + (1.0 - a).powi(2))).sqrt();
            near("long of OpenPBR", along, long.sqrt().min(1.0));
            near("short of OpenPBR", along * (1.0 - a), short.sqrt());
            near(
                "round",
                at(&gltf, 0).powi(4),
                (0.5 * (long + short)).min(1.0),
            );
            if long > 1.05 * short {
                let turns = 2.0 * std::f64::consts::TAU * at(&standard, 2);
                near("cosine", turns.cos(), doubled.cos());
                near("sine", turns.sin(), doubled.sin());
                let (x, y) = (at(&open, 2), at(&open, 3));
                near("tangent", x * x - y * y, doubled.cos());
                near("tangent's sine", 2.0 * x * y, doubled.sin());
            }
            near(
                "diffuse",
                at(&standard, 3),
                (0.25 * (long + short - 2.0 * own)).sqrt().min(1.0),
            );
            let [x, y, z] = [4, 5, 6].map(|k| at(&standard, k));
            near("slope", -x / z, at(&slopes, 0));
            near("slope along v", -y / z, at(&slopes, 1));
            near("length", x * x + y * y + z * z, 1.0);
        }
    }
}

#[test]
fn a_footprint_of_next_to_nothing_changes_no_roughness() {
    let names = [
        "specular_roughness",
        "occlusion",
        "specular_anisotropy",
        "diffuse_roughness",
    ];
    let found = parts(&hills(0.2, "standard_surface"), &names, &places(1e-7));
    for (values, wanted) in found.iter().zip([0.3, 0.8, 0.0, 0.0]) {
        for value in values {
            assert!((value - wanted).abs() < 2e-4, "{value}, not {wanted}");
        }
    }
}

/// Both are level but where |x| < 0.06 of a Gaussian with a deviation of 0.25: 0.19 of the footprint. The
/// crack's derivative is a table, which knows means over parts.
#[test]
fn the_share_of_slopes_is_that_of_a_crack_and_of_a_plateau() {
    let noise = json!({ "type": "noise2d", "inputs": { "frequency": 4 } });
    let surface = |height: &str| {
        json!({ "type": "surface", "inputs": {
        "height": { "node": height }, "scale": 0.01 } })
    };
    let crack = json!({
        "noise": noise,
        "apart": { "type": "absval", "inputs": { "in": { "node": "noise" } } },
        "crack": { "type": "range", "inputs": { "in": { "node": "apart" }, "inhigh": 0.06, "doclamp": true } },
        "surface": surface("crack")
    });
    let plateau = json!({
        "noise": noise,
        "plateau": { "type": "clamp", "inputs": { "in": { "node": "noise" }, "low": -0.06, "high": 0.06 } },
        "surface": surface("plateau")
    });
    let hills = hills(0.2, "gltf");
    for (nodes, wanted, bound) in [
        (crack, 0.19, 0.04),
        (plateau, 0.19, 0.005),
        (hills, 1.0, 1e-3),
    ] {
        for value in &parts(&nodes, &["slope_share"], &places(4.0))[0] {
            assert!((value - wanted).abs() < bound, "{value}, not {wanted}");
        }
    }
}

#[test]
fn a_colour_of_the_slope_varies_with_it() {
    let nodes = json!({
        "hills": { "type": "noise2d", "inputs": { "frequency": 4 } },
        "slope": { "type": "slope", "inputs": { "in": { "node": "hills" } } },
        "u": { "type": "separate2", "inputs": { "in": { "node": "slope" } } },
        "half": { "type": "multiply", "inputs": { "in1": { "node": "u", "output": "outx" }, "in2": 0.5 } },
        "v": { "type": "multiply", "inputs": { "in1": { "node": "u", "output": "outy" }, "in2": -0.25 } },
        "color": { "type": "combine3", "inputs": { "in1": { "node": "half" }, "in2": { "node": "v" }, "in3": 0.2 } },
        "surface": { "type": "surface", "inputs": { "base_color": { "node": "color" },
            "height": { "node": "hills" }, "scale": 0.1 } }
    });
    for size in [0.02, 0.3, 4.0] {
        let names = ["slope_covariance", "cov_color_slope_u", "cov_color_slope_v"];
        let found = parts(&nodes, &names, &places(size));
        for i in 0..found[0].len() {
            let [uu, uv, vv] = [0, 1, 2].map(|k| found[k][i]);
            let wanted = [5.0 * uu, -2.5 * uv, 0.0, 5.0 * uv, -2.5 * vv, 0.0];
            for (k, wanted) in wanted.into_iter().enumerate() {
                let value = found[3 + k][i];
                assert!(
                    (value - wanted).abs() < 0.02 * (uu + vv) * 5.0,
                    "{k} at {size}: {value}, not {wanted}"
                );
            }
        }
    }
}

#[test]
fn masks_and_curvatures_have_the_means_of_their_points() {
    let hills = json!({ "type": "noise2d", "inputs": { "frequency": 4 } });
    let steep = json!({ "hills": hills, "out": { "type": "slopemask", "inputs": {
        "in": { "node": "hills" }, "scale": 0.3 } } });
    let high = json!({ "hills": hills, "out": { "type": "heightmask", "inputs": {
        "in": { "node": "hills" }, "level": 0.1, "width": 0.2 } } });
    let bent = json!({ "hills": hills, "out": { "type": "curvature", "inputs": {
        "in": { "node": "hills" }, "size": 0.1, "scale": 0.01 } } });
    for (what, nodes, bound) in [
        ("slopemask", steep, 0.06),
        ("heightmask", high, 0.06),
        ("curvature", bent, 0.02),
    ] {
        for size in [0.005, 0.05, 0.2] {
            let error = error(&nodes, "out", size);
            println!("{what} at {size}: {error:.4}");
            assert!(error < bound, "{what} at {size}: {error}");
        }
    }
}

#[test]
fn details_on_a_normal_are_those_on_its_height() {
    let normal =
        |height: &str| json!({ "type": "normalmap", "inputs": { "in": { "node": height } } });
    let map = |height: &str| json!({ "type": "heighttonormal", "inputs": { "in": { "node": height }, "scale": 1 } });
    let nodes = json!({
        "hills": { "type": "noise2d", "inputs": { "frequency": 4 } },
        "grain": { "type": "noise2d", "inputs": { "frequency": 9, "amplitude": 0.3, "seed": 5 } },
        "both": { "type": "add", "inputs": { "in1": { "node": "hills" }, "in2": { "node": "grain" } } },
        "map_a": map("hills"), "map_b": map("grain"), "map_c": map("both"),
        "a": normal("map_a"), "b": normal("map_b"), "c": normal("map_c"),
        "out": { "type": "blendnormal", "inputs": { "base": { "node": "a" }, "detail": { "node": "b" } } },
        "slope": { "type": "normaltoslope", "inputs": { "in": { "node": "a" } } }
    });
    let places = places(0.0);
    let [found, wanted] =
        ["out", "c"].map(|name| evaluated(graph(&nodes, name), Method::Point, &places));
    for (found, wanted) in found.iter().flatten().zip(wanted.iter().flatten()) {
        assert!((found - wanted).abs() < 2e-3, "{found}, not {wanted}");
    }
    for size in [0.005, 0.05, 0.2] {
        let [blended, sloped] = ["out", "slope"].map(|name| error(&nodes, name, size));
        println!("blendnormal at {size}: {blended:.4}, normaltoslope {sloped:.4}");
        assert!(
            blended < 0.02 && sloped < 0.02,
            "{size}: {blended} {sloped}"
        );
    }
}
