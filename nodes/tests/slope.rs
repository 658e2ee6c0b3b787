//! The slopes of heights over footprints against supersampled truth.

#[path = "slope/truth.rs"]
mod truth;

use mipless_codegen::Method;
use serde_json::{Value, json};
use truth::{Graph, Size, compared, frame_mean};

/// Footprints in wavelengths.
const SIZES: [f64; 5] = [0.02, 0.1, 0.3, 1.0, 8.0];

/// Holds the bias of tr S, averaged over places, at every size, round and 8:1, (8:1) the ratio of the
/// eigenvalues' roots, and the error of the mean slopes over the root of their second moment.
fn held(what: &str, nodes: &Value, wavelength: f64, bounds: [f64; 3]) {
    held_to(what, nodes, [wavelength; 2], bounds);
}

/// The same of a height whose finest wavelength is another one.
fn held_to(what: &str, nodes: &Value, [wavelength, finest]: [f64; 2], bounds: [f64; 3]) {
    let graph = Graph::of_height(nodes);
    let mut worst = [0.0f64; 3];
    for ratio in [1.0, 8.0] {
        let mut line = Vec::new();
        for size in SIZES {
            let minor = size * wavelength / ratio;
            let found = compared(
                &graph,
                Method::Local,
                &Size {
                    minor,
                    ratio,
                    finest,
                },
            );
            line.push(format!(
                "{size}: {:+.3} {:+.3} {:.3}",
                found.bias, found.axes, found.mean
            ));
            worst[0] = worst[0].max(found.bias.abs());
            if ratio > 1.0 {
                worst[1] = worst[1].max(found.axes.abs());
            }
            worst[2] = worst[2].max(found.mean);
        }
        println!("{what:12} {ratio}:1  {}", line.join("  "));
    }
    for (found, bound) in worst.into_iter().zip(bounds) {
        assert!(found <= bound, "{what}: {found} > {bound}");
    }
}

fn noise(kind: &str, more: &Value) -> Value {
    let mut inputs = json!({ "frequency": 4, "amplitude": 1 });
    for (name, value) in more.as_object().expect("inputs") {
        inputs[name] = value.clone();
    }
    json!({ "type": kind, "inputs": inputs })
}

/// The wavelength of the dominant detail of lattice noises of frequency 4.
const LATTICE: f64 = 1.53 / 4.0;

/// The same with kinks.
const KINKED: [f64; 2] = [LATTICE, LATTICE / 4.0];

#[test]
fn noises_lose_the_slopes_of_their_spectrum() {
    let of = |kind: &str, more: Value| json!({ "height": noise(kind, &more) });
    held(
        "noise2d",
        &of("noise2d", json!({})),
        LATTICE,
        [0.03, 0.05, 0.03],
    );
    let quintic = of("noise2d", json!({ "kernel": "quintic" }));
    held("quintic", &quintic, 1.7 / 4.0, [0.04, 0.05, 0.03]);
    held(
        "value",
        &of("valuenoise2d", json!({})),
        3.1 / 4.0,
        [0.06, 0.05, 0.03],
    );
    held(
        "spectral",
        &of("spectralnoise2d", json!({})),
        0.25,
        [0.03, 0.05, 0.03],
    );
    held(
        "gabor",
        &of("gabornoise2d", json!({})),
        0.25,
        [0.03, 0.05, 0.03],
    );
    let brushed = json!({ "anisotropy": 0.8, "orientation": 30 });
    held(
        "brushed",
        &of("gabornoise2d", brushed),
        0.25,
        [0.03, 0.05, 0.03],
    );
    let fractal = of("fractal2d", json!({ "octaves": 5 }));
    held_to(
        "fractal",
        &fractal,
        [LATTICE, LATTICE / 16.0],
        [0.03, 0.05, 0.03],
    );
}

/// A function of one noise.
fn shaped(node: Value) -> Value {
    let noise = noise("noise2d", &json!({}));
    json!({ "noise": noise, "height": node })
}

#[test]
fn functions_of_noises_keep_their_slopes() {
    let input = json!({ "node": "noise" });
    let plateau =
        json!({ "type": "clamp", "inputs": { "in": input, "low": -0.125, "high": 0.125 } });
    held_to("plateau", &shaped(plateau), KINKED, [0.09, 0.12, 0.15]);
    let ridge = json!({ "type": "absval", "inputs": { "in": input } });
    held_to("ridge", &shaped(ridge), KINKED, [0.1, 0.09, 0.16]);
    let mut crack = shaped(json!({
        "type": "range",
        "inputs": { "in": { "node": "apart" }, "inhigh": 0.06, "doclamp": true }
    }));
    crack["apart"] = json!({ "type": "absval", "inputs": { "in": input } });
    held_to(
        "crack",
        &crack,
        [LATTICE, LATTICE / 16.0],
        [0.1, 0.04, 0.08],
    );
    let smooth =
        json!({ "type": "smoothstep", "inputs": { "in": input, "low": -0.3, "high": 0.3 } });
    held("smoothstep", &shaped(smooth), LATTICE, [0.06, 0.07, 0.12]);
    let sine = json!({ "type": "sin", "inputs": { "in": { "node": "more" } } });
    let mut sine = shaped(sine);
    sine["more"] = json!({ "type": "multiply", "inputs": { "in1": input, "in2": 6 } });
    held("sine", &sine, LATTICE, [0.12, 0.08, 0.18]);
}

#[test]
fn combinations_of_noises_keep_their_slopes() {
    let two = |node: Value| {
        json!({
            "x": noise("noise2d", &json!({})),
            "y": noise("noise2d", &json!({ "seed": 7, "pivot": 0.3 })),
            "height": node
        })
    };
    let (x, y) = (json!({ "node": "x" }), json!({ "node": "y" }));
    let sum = json!({ "type": "add", "inputs": { "in1": x, "in2": y } });
    held("sum", &two(sum), LATTICE, [0.04, 0.03, 0.03]);
    let product = json!({ "type": "multiply", "inputs": { "in1": x, "in2": y } });
    held("product", &two(product), LATTICE, [0.09, 0.04, 0.12]);
    let square = json!({ "type": "multiply", "inputs": { "in1": y, "in2": y } });
    held("square", &two(square), LATTICE, [0.08, 0.03, 0.08]);
    let most = json!({ "type": "max", "inputs": { "in1": x, "in2": y } });
    held_to("max", &two(most), KINKED, [0.04, 0.05, 0.08]);
    let mut mix =
        two(json!({ "type": "mix", "inputs": { "bg": x, "fg": y, "mix": { "node": "mask" } } }));
    mix["mask"] = noise("noise2d", &json!({ "seed": 3, "pivot": 0.5 }));
    held("mix", &mix, LATTICE, [0.06, 0.04, 0.08]);
}

#[test]
fn warps_and_patterns_keep_their_slopes() {
    let warped = json!({
        "x": { "type": "noise2d", "inputs": { "frequency": 2, "amplitude": 0.4 } },
        "y": { "type": "noise2d", "inputs": { "frequency": 2, "amplitude": 0.4, "seed": 9 } },
        "by": { "type": "combine2", "inputs": { "in1": { "node": "x" }, "in2": { "node": "y" } } },
        "uv": { "type": "texcoord" },
        "place": { "type": "add", "inputs": { "in1": { "node": "uv" }, "in2": { "node": "by" } } },
        "height": { "type": "noise2d", "inputs": { "frequency": 4, "amplitude": 1, "texcoord": { "node": "place" } } }
    });
    held("warp", &warped, LATTICE, [0.08, 0.03, 0.16]);
    let wave = json!({ "height": { "type": "wave", "inputs": { "frequency": 4, "rotate": 30 } } });
    held("wave", &wave, 0.25, [0.01, 0.01, 0.03]);
}

/// A distance has a gradient of length 1, and the difference of two that of two unit vectors less each
/// other: of wide footprints the slopes are those, whatever the noise varies by. Under narrower ones its
/// kinks are smoothed, and less is said than there is.
#[test]
fn wide_footprints_remove_the_slopes_of_distances() {
    for (output, jitter) in [("F1", 1.0), ("F2", 0.5), ("F2-F1", 1.0), ("F2-F1", 0.75)] {
        let inputs = json!({ "frequency": 4, "output": output, "jitter": jitter });
        let graph = Graph::of_height(&json!({ "height":
            { "type": "worleynoise2d", "inputs": inputs } }));
        for ratio in [1.0, 8.0] {
            let size = Size {
                minor: 0.5,
                ratio,
                finest: 0.25,
            };
            let found = compared(&graph, Method::Local, &size);
            println!("{output} {jitter} {ratio}:1  {:+.3}", found.bias);
            assert!(found.bias.abs() <= 0.05, "{output}: {}", found.bias);
        }
    }
}

/// What the components of a normal share of the slopes that a footprint removed, their product has: of
/// normals by slopes of a standard deviation of 1.6, E[n_x²] is 0.357.
#[test]
fn squares_of_normals_keep_their_variance() {
    let x = json!({ "node": "s", "output": "outx" });
    let squared = json!({
        "hills": { "type": "noise2d", "inputs": { "frequency": 4 } },
        "n": { "type": "heighttonormal", "inputs": { "in": { "node": "hills" }, "scale": 8 } },
        "m": { "type": "normalmap", "inputs": { "in": { "node": "n" } } },
        "s": { "type": "separate3", "inputs": { "in": { "node": "m" } } },
        "o": { "type": "multiply", "inputs": { "in1": x, "in2": x } }
    });
    let found = frame_mean(&squared, "o");
    assert!((found - 0.357).abs() < 0.01, "{found}");
}
