//! Combinations of jointly Gaussian signals: blends, smooth maxima, conditions.

use serde_json::{Value, json};

use super::law::{Inputs, Law, TWO};

/// A function of three numbers.
type Blend = fn(f64, f64) -> f64;

fn overlay(x: f64, y: f64) -> f64 {
    if y < 0.5 {
        2.0 * x * y
    } else {
        1.0 - 2.0 * (1.0 - x) * (1.0 - y)
    }
}

/// Foregrounds that stay away from 0 and from 1.
const DIVISORS: &[Inputs<'static>] = &[
    &[(0.4, &[0.05]), (0.5, &[0.0, 0.1])],
    &[(0.5, &[0.08]), (0.3, &[0.05, 0.05])],
];

#[test]
fn blends() {
    let blends: [(&str, Blend, &[Inputs<'_>], [f64; 2]); 13] = [
        ("plus", |f, b| b + f, TWO, [2e-4, 2e-4]),
        ("minus", |f, b| b - f, TWO, [2e-4, 2e-4]),
        ("linearlight", |f, b| b + 2.0 * f - 1.0, TWO, [2e-4, 4e-4]),
        ("difference", |f, b| (b - f).abs(), TWO, [1e-3, 1e-3]),
        (
            "screen",
            |f, b| 1.0 - (1.0 - f) * (1.0 - b),
            TWO,
            [1e-3, 1e-3],
        ),
        ("lighten", f64::max, TWO, [1e-3, 1e-3]),
        ("darken", f64::min, TWO, [1e-3, 1e-3]),
        ("overlay", overlay, TWO, [1e-3, 3e-2]),
        ("hardlight", |f, b| overlay(b, f), TWO, [1e-3, 3e-2]),
        (
            "softlight",
            |f, b| b * b + 2.0 * f * b * (1.0 - b),
            TWO,
            [1e-3, 2e-2],
        ),
        ("dodge", |f, b| b / (1.0 - f), DIVISORS, [1e-3, 1.5e-2]),
        ("burn", |f, b| 1.0 - (1.0 - b) / f, DIVISORS, [1e-3, 1.5e-2]),
        ("mix", |_, b| b, TWO, [2e-4, 2e-4]),
    ];
    for (name, blend, inputs, tolerances) in blends {
        for share in [1.0, 0.6] {
            let (fg, bg) = (json!({ "node": "x0" }), json!({ "node": "x1" }));
            let node = json!({ "type": name, "inputs": { "fg": fg, "bg": bg, "mix": share } });
            let exact = |x: &[f64]| {
                let result = if name == "mix" {
                    x[0]
                } else {
                    blend(x[0], x[1])
                };
                vec![x[1] + share * (result - x[1])]
            };
            Law {
                node,
                exact: &exact,
                inputs,
                tolerances,
            }
            .check();
        }
    }
}

/// Three, correlated.
const THREE: &[Inputs<'static>] = &[
    &[
        (0.3, &[0.1]),
        (0.7, &[0.05, 0.1]),
        (0.2, &[-0.05, 0.0, 0.2]),
    ],
    &[(0.1, &[0.3]), (0.5, &[0.2, 0.1]), (0.4, &[0.1, -0.1, 0.1])],
    &[(-0.5, &[0.4]), (0.5, &[0.4]), (0.4, &[-0.3])],
    &[
        (0.01, &[0.005]),
        (1.0, &[0.0, 0.2]),
        (0.0, &[0.0, 0.1, 0.1]),
    ],
];

#[test]
fn a_mask_takes_the_covariance_with_what_it_masks() {
    let node = |x: usize| json!({ "node": format!("x{x}") });
    let inputs = json!({ "fg": node(1), "bg": node(2), "mix": node(0) });
    Law {
        node: json!({ "type": "mix", "inputs": inputs }),
        exact: &|x| vec![x[2] + x[0] * (x[1] - x[2])],
        inputs: THREE,
        tolerances: [1e-3, 1e-3],
    }
    .check();
    let inputs = json!({ "fg": node(1), "bg": node(2), "mix": node(0) });
    Law {
        node: json!({ "type": "screen", "inputs": inputs }),
        exact: &|x| vec![x[2] + x[0] * (x[1] - x[1] * x[2])],
        // Where all three are one number the result is a cubic of it, far from two products.
        inputs: &THREE[..2],
        tolerances: [5e-3, 2e-2],
    }
    .check();
}

#[test]
fn conditions() {
    let node = |x: usize| json!({ "node": format!("x{x}") });
    for (name, holds) in [
        ("ifgreater", true),
        ("ifgreatereq", true),
        ("ifequal", false),
    ] {
        let inputs = json!({ "value1": node(0), "value2": 0.2, "in1": node(1), "in2": node(2) });
        Law {
            node: json!({ "type": name, "inputs": inputs }),
            exact: &|x| vec![if holds && x[0] > 0.2 { x[1] } else { x[2] }],
            inputs: THREE,
            tolerances: [1e-3, 1e-3],
        }
        .check();
    }
    let inputs = json!({ "value1": node(0), "value2": node(1), "in1": node(1), "in2": node(2) });
    Law {
        node: json!({ "type": "ifgreater", "inputs": inputs }),
        exact: &|x| vec![if x[0] > x[1] { x[1] } else { x[2] }],
        inputs: THREE,
        tolerances: [1e-3, 1e-3],
    }
    .check();
    let which = json!({ "type": "multiply", "inputs": { "in1": node(0), "in2": 4 } });
    let inputs = json!({
        "which": { "node": "which" }, "in1": node(1), "in2": 0.3, "in3": node(2), "in4": node(1)
    });
    Law {
        node: json!({ "type": "switch", "inputs": inputs, "extra_nodes": { "which": which } }),
        exact: &|x| {
            vec![match 4.0 * x[0] {
                w if w < 1.0 => x[1],
                w if w < 2.0 => 0.3,
                w if w < 3.0 => x[2],
                w if w < 4.0 => x[1],
                _ => 0.0,
            }]
        },
        inputs: THREE,
        tolerances: [1e-3, 1e-3],
    }
    .check();
}

#[test]
fn smooth_maxima() {
    let inputs = json!({ "in1": { "node": "x0" }, "in2": { "node": "x1" }, "width": 0.2 });
    let rounded = |d: f64| {
        if d.abs() < 0.2 {
            (d * d + 0.04) / 0.4
        } else {
            d.abs()
        }
    };
    let cases: [(&str, f64); 2] = [("smoothmax", 0.5), ("smoothmin", -0.5)];
    for (name, sign) in cases {
        Law {
            node: json!({ "type": name, "inputs": inputs }),
            exact: &|x: &[f64]| vec![0.5 * (x[0] + x[1]) + sign * rounded(x[0] - x[1])],
            inputs: TWO,
            tolerances: [1e-3, 1e-3],
        }
        .check();
    }
}

#[test]
fn powers_whose_exponent_varies() {
    let inputs: &[Inputs<'static>] = &[
        &[(0.5, &[0.1]), (2.0, &[0.1, 0.3])],
        &[(0.6, &[0.15]), (0.8, &[0.0, 0.2])],
        &[(1.5, &[0.3]), (2.5, &[-0.2, 0.4])],
    ];
    Law {
        node: json!({ "type": "power", "inputs": { "in1": { "node": "x0" }, "in2": { "node": "x1" } } }),
        exact: &|x: &[f64]| vec![x[0].max(0.0).powf(x[1])],
        inputs,
        tolerances: [2e-3, 2e-3],
    }
    .check();
}

#[test]
fn linear_nodes_are_exact() {
    Law {
        node: json!({ "type": "invert", "inputs": { "in": { "node": "x0" }, "amount": 0.7 } }),
        exact: &|x: &[f64]| vec![0.7 - x[0]],
        inputs: TWO,
        tolerances: [1e-5, 1e-5],
    }
    .check();
    let point = json!({ "p": { "type": "combine2", "inputs": { "in1": { "node": "x0" }, "in2": { "node": "x1" } } } });
    let inputs = json!({ "in": { "node": "p" }, "amount": -30 });
    Law {
        node: json!({ "type": "rotate2d", "inputs": inputs, "extra_nodes": point }),
        exact: &|x: &[f64]| {
            let (sine, cosine) = 30f64.to_radians().sin_cos();
            vec![x[0] * cosine - x[1] * sine, x[0] * sine + x[1] * cosine]
        },
        inputs: TWO,
        // What the integration of two numbers errs by.
        tolerances: [2e-4, 2e-4],
    }
    .check();
}

#[test]
fn conditions_without_spread_are_exact() {
    let of = |node: Value| super::moments(json!({ "y": node }), "y").0;
    let condition = |name: &str, value: f64| {
        of(
            json!({ "type": name, "inputs": { "value1": value, "value2": 0.5, "in1": 2, "in2": 3 } }),
        )
    };
    for (name, values) in [
        ("ifgreater", [3.0, 3.0, 2.0]),
        ("ifgreatereq", [3.0, 2.0, 2.0]),
        ("ifequal", [3.0, 2.0, 3.0]),
    ] {
        let found = [0.25, 0.5, 0.75].map(|value| condition(name, value));
        assert_eq!(found, values, "{name}");
    }
    let switch = |which: f64| {
        of(json!({ "type": "switch", "inputs": { "which": which, "in1": 5, "in2": 6, "in4": 7 } }))
    };
    let found = [-1.0, 0.0, 1.5, 2.0, 3.0, 20.0].map(switch);
    assert_eq!(found, [5.0, 5.0, 6.0, 0.0, 7.0, 0.0]);
}
