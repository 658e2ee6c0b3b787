//! Layers with alpha, products and lengths of vectors, angles.

use serde_json::{Value, json};

use super::law::{Inputs, Law};

/// Red in front and its alpha, red behind and its alpha.
const LAYERS: &[Inputs<'static>] = &[
    &[
        (0.3, &[0.05]),
        (0.5, &[0.03, 0.05]),
        (0.6, &[0.0, 0.0, 0.1]),
        (0.7, &[0.0, 0.02, 0.0, 0.05]),
    ],
    &[
        (0.2, &[0.2]),
        (0.6, &[0.1, 0.1]),
        (0.4, &[-0.1, 0.0, 0.1]),
        (0.8, &[0.0, 0.05, 0.05, 0.1]),
    ],
];

fn node(x: usize) -> Value {
    json!({ "node": format!("x{x}") })
}

fn layer(red: usize, alpha: usize) -> Value {
    json!({ "type": "combine4", "inputs": { "in1": node(red), "in2": 0.4, "in3": 0, "in4": node(alpha) } })
}

#[test]
fn layers() {
    type Operation = fn([f64; 2], [f64; 2]) -> [f64; 2];
    let operations: [(&str, Operation, [f64; 2]); 6] = [
        (
            "over",
            |[f, a], [b, c]| [f + b * (1.0 - a), a + c * (1.0 - a)],
            [1e-3, 1e-2],
        ),
        ("in", |[f, a], [_, c]| [f * c, a * c], [1e-3, 1e-2]),
        (
            "out",
            |[f, a], [_, c]| [f * (1.0 - c), a * (1.0 - c)],
            [1e-3, 1e-2],
        ),
        ("mask", |[_, a], [b, c]| [b * a, c * a], [1e-3, 1e-2]),
        (
            "matte",
            |[f, a], [b, c]| [f * a + b * (1.0 - a), a + c * (1.0 - a)],
            [1e-3, 1e-2],
        ),
        (
            "disjointover",
            |[f, a], [b, c]| [f + b * ((1.0 - a) / c).min(1.0), (a + c).min(1.0)],
            [5e-3, 2e-2],
        ),
    ];
    for (name, operation, tolerances) in operations {
        let layers = json!({ "front": layer(0, 1), "back": layer(2, 3) });
        let inputs = json!({ "fg": { "node": "front" }, "bg": { "node": "back" }, "mix": 0.8 });
        Law {
            node: json!({ "type": name, "inputs": inputs, "extra_nodes": layers }),
            exact: &|x| {
                let (front, back) = ([x[0], x[1]], [x[2], x[3]]);
                let mixed = |front: [f64; 2], back: [f64; 2], k: usize| {
                    let result = operation(front, back)[k];
                    back[k] + 0.8 * (result - back[k])
                };
                let green = mixed([0.4, x[1]], [0.4, x[3]], 0);
                let blue = mixed([0.0, x[1]], [0.0, x[3]], 0);
                vec![mixed(front, back, 0), green, blue, mixed(front, back, 1)]
            },
            inputs: LAYERS,
            tolerances,
        }
        .check();
    }
    for (name, divides) in [("premult", false), ("unpremult", true)] {
        let inputs = json!({ "in": { "node": "front" } });
        Law {
            node: json!({
                "type": name, "inputs": inputs, "extra_nodes": { "front": layer(0, 1) }
            }),
            exact: &|x| {
                let scale = |y: f64| if divides { y / x[1] } else { y * x[1] };
                vec![scale(x[0]), scale(0.4), 0.0, x[1]]
            },
            inputs: &LAYERS[..1],
            tolerances: [1e-3, 1e-2],
        }
        .check();
    }
}

/// Two numbers at a distance of the origin of 5, 1 and 0 standard deviations.
const POINTS: &[Inputs<'static>] = &[
    &[(0.8, &[0.1]), (0.6, &[0.05, 0.1])],
    &[(-0.4, &[0.1]), (0.5, &[0.0, 0.05])],
    &[(0.1, &[0.1]), (0.02, &[0.0, 0.1])],
    &[(0.0, &[0.2]), (0.0, &[0.0, 0.2])],
];

fn point(x: usize, y: usize) -> Value {
    json!({ "type": "combine2", "inputs": { "in1": node(x), "in2": node(y) } })
}

#[test]
fn products_of_vectors() {
    let points = json!({ "p": point(0, 1), "q": point(1, 2) });
    let three: &[Inputs<'_>] = &[&[
        (0.3, &[0.2]),
        (0.7, &[0.05, 0.1]),
        (0.2, &[-0.05, 0.0, 0.2]),
    ]];
    let inputs = json!({ "in1": { "node": "p" }, "in2": { "node": "q" } });
    Law {
        node: json!({ "type": "dotproduct", "inputs": inputs, "extra_nodes": points }),
        exact: &|x| vec![x[0] * x[1] + x[1] * x[2]],
        inputs: three,
        tolerances: [2e-4, 1e-3],
    }
    .check();
    let solid = |of: &str| json!({ "type": "convert", "inputs": { "in": { "node": of }, "to": "vector3" } });
    let vectors = json!({ "p": point(0, 1), "q": point(1, 2), "a": solid("p"), "b": solid("q") });
    let inputs = json!({ "in1": { "node": "a" }, "in2": { "node": "b" } });
    Law {
        node: json!({ "type": "crossproduct", "inputs": inputs, "extra_nodes": vectors }),
        exact: &|x| vec![0.0, 0.0, x[0] * x[2] - x[1] * x[1]],
        inputs: three,
        tolerances: [2e-4, 1e-3],
    }
    .check();
}

#[test]
fn lengths_and_directions() {
    let law = |name: &str, exact: &dyn Fn(f64, f64) -> Vec<f64>, inputs, tolerances| {
        let (ports, points) = match name {
            "atan2" => (json!({ "iny": node(1), "inx": node(0) }), json!({})),
            "distance" => (
                json!({ "in1": { "node": "p" }, "in2": [0.1, 0.2] }),
                json!({ "p": point(0, 1) }),
            ),
            _ => (
                json!({ "in": { "node": "p" } }),
                json!({ "p": point(0, 1) }),
            ),
        };
        Law {
            node: json!({ "type": name, "inputs": ports, "extra_nodes": points }),
            exact: &|x| exact(x[0], x[1]),
            inputs,
            tolerances,
        }
        .check();
    };
    law(
        "magnitude",
        &|x, y| vec![x.hypot(y)],
        &POINTS[..1],
        [1e-3, 5e-3],
    );
    law("magnitude", &|x, y| vec![x.hypot(y)], POINTS, [5e-3, 2e-2]);
    law(
        "distance",
        &|x, y| vec![(x - 0.1).hypot(y - 0.2)],
        POINTS,
        [5e-3, 2e-2],
    );
    let unit = |x: f64, y: f64| vec![x / x.hypot(y), y / x.hypot(y)];
    law("normalize", &unit, &POINTS[..2], [1e-3, 1e-3]);
    law("normalize", &unit, POINTS, [0.1, 0.25]);
    let angle = |x: f64, y: f64| vec![y.atan2(x)];
    law("atan2", &angle, &POINTS[..2], [1e-3, 1e-3]);
    law("atan2", &angle, POINTS, [0.1, 0.6]);
    // Where the angle jumps, half of the footprint is at π and half at −π.
    let jump: &[Inputs<'_>] = &[&[(-0.5, &[0.1]), (0.0, &[0.0, 0.1])]];
    law("atan2", &angle, jump, [1e-3, 5e-3]);
}

/// Colours of a normal map: flat, leaning, and of a footprint whose normals differ much.
const NORMALS: &[Inputs<'static>] = &[
    &[(0.5, &[0.1]), (0.5, &[0.0, 0.1]), (0.95, &[0.0, 0.0, 0.03])],
    &[
        (0.7, &[0.05]),
        (0.35, &[0.05, 0.08]),
        (0.9, &[-0.02, 0.02, 0.02]),
    ],
    &[
        (0.5, &[0.2]),
        (0.6, &[0.1, 0.15]),
        (0.85, &[0.0, 0.0, 0.05]),
    ],
];

#[test]
fn normals_of_a_map() {
    let color =
        json!({ "type": "combine3", "inputs": { "in1": node(0), "in2": node(1), "in3": node(2) } });
    let unit = |[x, y, z]: [f64; 3]| {
        let length = (x * x + y * y + z * z).sqrt();
        vec![x / length, y / length, z / length]
    };
    let map = json!({ "map": color });
    let inputs = json!({ "in": { "node": "map" }, "scale": 1.2 });
    let law = |inputs_of: &[Inputs<'static>], tolerances| {
        Law {
            node: json!({ "type": "normalmap", "inputs": inputs, "extra_nodes": map }),
            exact: &|x| {
                let [x, y, z] = [0, 1, 2].map(|i| 2.0 * x[i] - 1.0);
                unit([1.2 * x, 1.2 * y, z])
            },
            inputs: inputs_of,
            tolerances,
        }
        .check();
    };
    law(&NORMALS[..2], [1e-3, 6e-3]);
    law(NORMALS, [0.02, 0.04]);
    // Two numbers, a vector, and a scale that varies.
    let varying = json!({ "in": { "node": "p" }, "scale": node(2) });
    Law {
        node: json!({ "type": "normalmap", "inputs": varying, "extra_nodes": { "p": point(0, 1) } }),
        exact: &|x| {
            let [x, y] = [0, 1].map(|i| x[2] * (2.0 * x[i] - 1.0));
            unit([x, y, 1.0])
        },
        inputs: &[&[(0.6, &[0.1]), (0.3, &[0.05, 0.1]), (1.0, &[0.0, 0.0, 0.3])]],
        tolerances: [1e-3, 6e-3],
    }
    .check();
}
