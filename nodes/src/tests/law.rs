//! Nodes of jointly Gaussian signals against numerical integration in f64.
//!
//! The inputs are X = μ + L a with independent standard normal a; mean and variance of what `local`
//! gives are compared with those of the function itself over the same Gaussian.

use mipless_codegen::Method;
use mipless_codegen::cpu::{Footprint, eval_program};
use serde_json::{Map, Value, json};
use std::sync::LazyLock;

use super::compiled;

/// Jointly Gaussian inputs named `x0`, `x1`, …: means, and the rows of L.
pub(super) type Inputs<'a> = &'a [(f64, &'a [f64])];

/// Mean and variance of each component of node `y` by `local`.
pub(super) fn filtered(inputs: Inputs<'_>, node: &Value) -> Vec<(f64, f64)> {
    let mut nodes = Map::new();
    for (i, (mean, row)) in inputs.iter().enumerate() {
        let mut sum = json!(mean);
        for (j, factor) in row.iter().enumerate() {
            nodes.insert(format!("a{j}"), json!({ "type": "test_gaussian" }));
            let (part, total) = (format!("x{i}_{j}"), format!("s{i}_{j}"));
            let inputs = json!({ "in1": { "node": format!("a{j}") }, "in2": factor });
            nodes.insert(
                part.clone(),
                json!({ "type": "multiply", "inputs": inputs }),
            );
            let inputs = json!({ "in1": sum, "in2": { "node": part } });
            nodes.insert(total.clone(), json!({ "type": "add", "inputs": inputs }));
            sum = json!({ "node": total });
        }
        let inputs = json!({ "in1": sum, "in2": 0 });
        nodes.insert(format!("x{i}"), json!({ "type": "add", "inputs": inputs }));
    }
    nodes.insert("y".to_owned(), node.clone());
    for (name, extra) in node["extra_nodes"].as_object().into_iter().flatten() {
        nodes.insert(name.clone(), extra.clone());
    }
    if let Some(node) = nodes.get_mut("y").and_then(Value::as_object_mut) {
        node.remove("extra_nodes");
    }
    let outputs = json!({ "out": { "node": "y" } });
    let graph = json!({ "version": 1, "name": "law", "nodes": nodes, "outputs": outputs });
    let program = compiled(&graph.to_string(), Method::Local);
    let results = eval_program::<f64>(&program, &[Footprint::default()], &[]);
    let components = results.len() / 2;
    (0..components)
        .map(|i| (results[i][0], results[components + i][0]))
        .collect()
}

/// The normal quantile (Acklam's rational approximation, relative error 1.2e-9).
fn quantile(p: f64) -> f64 {
    let polynomial = |c: &[f64], x: f64| c.iter().fold(0.0, |sum, c| sum * x + c);
    if p > 0.5 {
        return -quantile(1.0 - p);
    }
    if p < 0.024_25 {
        let q = (-2.0 * p.ln()).sqrt();
        let top = [
            -7.784_894_002_430_293e-3,
            -3.223_964_580_411_365e-1,
            -2.400_758_277_161_838,
            -2.549_732_539_343_734,
            4.374_664_141_464_968,
            2.938_163_982_698_783,
        ];
        let bottom = [
            7.784_695_709_041_462e-3,
            3.224_671_290_700_398e-1,
            2.445_134_137_142_996,
            3.754_408_661_907_416,
            1.0,
        ];
        return polynomial(&top, q) / polynomial(&bottom, q);
    }
    let q = p - 0.5;
    let top = [
        -3.969_683_028_665_376e1,
        2.209_460_984_245_205e2,
        -2.759_285_104_469_687e2,
        1.383_577_518_672_69e2,
        -3.066_479_806_614_716e1,
        2.506_628_277_459_239,
    ];
    let bottom = [
        -5.447_609_879_822_406e1,
        1.615_858_368_580_409e2,
        -1.556_989_798_598_866e2,
        6.680_131_188_771_972e1,
        -1.328_068_155_288_572e1,
        1.0,
    ];
    polynomial(&top, q * q) * q / polynomial(&bottom, q * q)
}

/// How many places of the Gaussian are sampled: the error of a mean is about 1e-4 of its spread.
const SAMPLES: usize = 1 << 18;

/// Independent normals of 1, 2, … numbers (Roberts's R sequence).
static NORMALS: [LazyLock<Vec<f64>>; 4] = [
    LazyLock::new(|| normals(1)),
    LazyLock::new(|| normals(2)),
    LazyLock::new(|| normals(3)),
    LazyLock::new(|| normals(4)),
];

fn normals(dimensions: usize) -> Vec<f64> {
    let mut golden = 2.0f64;
    for _ in 0..60 {
        golden = (1.0 + golden).powf(1.0 / (dimensions as f64 + 1.0));
    }
    let steps: Vec<f64> = (1..=dimensions).map(|i| golden.powi(-(i as i32))).collect();
    (0..SAMPLES)
        .flat_map(|i| {
            steps
                .iter()
                .map(move |step| ((i as f64 + 0.5) * step).fract())
        })
        .map(|p| quantile(p.clamp(1e-12, 1.0 - 1e-12)))
        .collect()
}

/// Mean and variance of each component of the function, by quasi-Monte-Carlo.
pub(super) fn integrated(inputs: Inputs<'_>, f: &dyn Fn(&[f64]) -> Vec<f64>) -> Vec<(f64, f64)> {
    let dimensions = inputs.iter().map(|input| input.1.len()).max().unwrap_or(0);
    let mut sums: Vec<(f64, f64)> = Vec::new();
    for normals in NORMALS[dimensions - 1].chunks(dimensions) {
        let arguments: Vec<f64> = (inputs.iter())
            .map(|(mean, row)| mean + row.iter().zip(normals).map(|(l, a)| l * a).sum::<f64>())
            .collect();
        let values = f(&arguments);
        sums.resize(values.len(), (0.0, 0.0));
        for (sum, y) in sums.iter_mut().zip(values) {
            sum.0 += y;
            sum.1 += y * y;
        }
    }
    let count = SAMPLES as f64;
    sums.iter()
        .map(|(sum, squares)| {
            (
                sum / count,
                (squares / count - (sum / count).powi(2)).max(0.0),
            )
        })
        .collect()
}

/// What is checked of a node over a set of inputs.
pub(super) struct Law<'a> {
    /// The node, which reads `x0`, `x1`, …
    pub(super) node: Value,
    /// The function of the inputs.
    pub(super) exact: &'a dyn Fn(&[f64]) -> Vec<f64>,
    /// The Gaussians to try.
    pub(super) inputs: &'a [Inputs<'a>],
    /// The largest errors of mean and standard deviation.
    pub(super) tolerances: [f64; 2],
}

impl Law<'_> {
    pub(super) fn check(&self) {
        let name = self.node["type"].as_str().unwrap_or_default();
        let mut worst = [0.0f64; 2];
        let mut report = String::new();
        for inputs in self.inputs {
            let truth = integrated(inputs, self.exact);
            for ((mean, variance), truth) in filtered(inputs, &self.node).iter().zip(truth) {
                let errors = [mean - truth.0, variance.sqrt() - truth.1.sqrt()].map(f64::abs);
                for (worst, error) in worst.iter_mut().zip(errors) {
                    *worst = worst.max(error);
                }
                if errors[0] > self.tolerances[0] || errors[1] > self.tolerances[1] {
                    report += &format!(
                        "{inputs:?}: mean {mean}, not {}; standard deviation {}, not {}\n",
                        truth.0,
                        variance.sqrt(),
                        truth.1.sqrt()
                    );
                }
            }
        }
        println!(
            "{name}: mean within {:.1e}, standard deviation within {:.1e}",
            worst[0], worst[1]
        );
        assert!(
            report.is_empty(),
            "{name}: {worst:?} of {:?}\n{report}",
            self.tolerances
        );
    }
}

/// One Gaussian of several means and spreads.
pub(super) const ONE: &[Inputs<'static>] = &[
    &[(0.3, &[0.01])],
    &[(0.3, &[0.1])],
    &[(0.3, &[0.4])],
    &[(-0.2, &[0.3])],
    &[(0.6, &[0.35])],
    &[(0.5, &[1.5])],
];

/// Two, from independent to nearly the same.
pub(super) const TWO: &[Inputs<'static>] = &[
    &[(0.3, &[0.02]), (0.7, &[0.0, 0.03])],
    &[(0.4, &[0.1]), (0.5, &[0.05, 0.1])],
    &[(0.5, &[0.2]), (0.4, &[-0.1, 0.1])],
    &[(0.6, &[0.15]), (0.6, &[0.15, 0.01])],
    &[(0.3, &[0.3]), (0.8, &[0.0, 0.3])],
];

#[test]
fn waves_and_steps() {
    let x = json!({ "node": "x0" });
    let of = |ty: &str, more: Value| {
        let mut inputs = json!({ "in": x });
        for (key, value) in more.as_object().into_iter().flatten() {
            inputs[key] = value.clone();
        }
        json!({ "type": ty, "inputs": inputs })
    };
    type Wave = fn(f64) -> f64;
    let unary: [(&str, Value, Wave); 9] = [
        ("fract", json!({}), |x| x - x.floor()),
        ("trianglewave", json!({}), |x| (x - (x + 0.5).floor()).abs()),
        ("squarewave", json!({ "width": 0.3 }), |x| {
            f64::from(u8::from(x - x.floor() < 0.3))
        }),
        ("floor", json!({}), f64::floor),
        ("ceil", json!({}), f64::ceil),
        ("round", json!({}), |x| (x + 0.5).floor()),
        ("quantize", json!({ "steps": 3 }), |x| {
            (x * 3.0).floor() / 3.0
        }),
        (
            "sign",
            json!({}),
            |x| if x == 0.0 { 0.0 } else { x.signum() },
        ),
        ("cos", json!({}), f64::cos),
    ];
    for (name, more, exact) in unary {
        Law {
            node: of(name, more),
            exact: &|x| vec![exact(x[0])],
            inputs: ONE,
            tolerances: [2e-4, 3e-4],
        }
        .check();
    }
    Law {
        node: json!({ "type": "modulo", "inputs": { "in1": x, "in2": 0.4 } }),
        exact: &|x| vec![x[0].rem_euclid(0.4)],
        inputs: ONE,
        tolerances: [2e-4, 3e-4],
    }
    .check();
    // What follows a wave is fused over one period of it.
    Law {
        node: json!({
            "type": "smoothstep", "inputs": { "in": { "node": "w" }, "low": 0.1, "high": 0.3 },
            "extra_nodes": { "w": { "type": "modulo", "inputs": { "in1": x, "in2": 0.4 } } }
        }),
        exact: &|x| {
            let t = ((x[0].rem_euclid(0.4) - 0.1) / 0.2).clamp(0.0, 1.0);
            vec![t * t * (3.0 - 2.0 * t)]
        },
        inputs: ONE,
        tolerances: [5e-3, 5e-3],
    }
    .check();
    Law {
        node: json!({ "type": "modulo", "inputs": { "in1": x, "in2": { "node": "x1" } } }),
        exact: &|x| vec![x[0] - x[1] * (x[0] / x[1]).floor()],
        inputs: &[
            &[(0.3, &[0.02]), (0.7, &[0.0, 0.03])],
            &[(0.9, &[0.1]), (0.5, &[0.0, 0.05])],
            &[(0.7, &[0.2]), (0.5, &[0.03, 0.04])],
        ],
        tolerances: [1e-2, 1.5e-2],
    }
    .check();
}

/// Within the domain of a logarithm, four standard deviations and more.
const POSITIVE: &[Inputs<'static>] = &[
    &[(0.3, &[0.01])],
    &[(0.4, &[0.1])],
    &[(1.5, &[0.3])],
    &[(2.0, &[0.5])],
];

#[test]
fn smooth_functions() {
    let x = json!({ "node": "x0" });
    let of = |ty: &str, more: Value| {
        let mut inputs = json!({ "in": x });
        for (key, value) in more.as_object().into_iter().flatten() {
            inputs[key] = value.clone();
        }
        json!({ "type": ty, "inputs": inputs })
    };
    let bias = |t: f64, bias: f64| t / ((1.0 / bias - 2.0) * (1.0 - t) + 1.0);
    let gain = |t: f64, gain: f64| {
        if t < 0.5 {
            0.5 * bias(2.0 * t, 1.0 - gain)
        } else {
            1.0 - 0.5 * bias(2.0 - 2.0 * t, 1.0 - gain)
        }
    };
    let unit = |x: f64| x.clamp(0.0, 1.0);
    let levels = |x: f64, gamma: f64| x.signum() * x.abs().powf(1.0 / gamma);
    type Function<'a> = &'a dyn Fn(f64) -> f64;
    type Case<'a> = (&'a str, Value, Function<'a>, &'a [Inputs<'a>], [f64; 2]);
    let cases: [Case<'_>; 16] = [
        ("exp", json!({}), &f64::exp, &ONE[..5], [2e-4, 1e-3]),
        ("sqrt", json!({}), &|x| x.max(0.0).sqrt(), ONE, [1e-3, 1e-3]),
        (
            "ln",
            json!({}),
            &|x| x.max(1e-3).ln(),
            POSITIVE,
            [1e-3, 2e-3],
        ),
        ("ln", json!({}), &|x| x.max(1e-3).ln(), ONE, [0.02, 0.02]),
        ("atan", json!({}), &f64::atan, &ONE[..5], [1e-4, 2e-4]),
        ("atan", json!({}), &f64::atan, ONE, [0.02, 0.02]),
        (
            "asin",
            json!({}),
            &|x| x.clamp(-1.0, 1.0).asin(),
            ONE,
            [2e-3, 5e-3],
        ),
        (
            "acos",
            json!({}),
            &|x| x.clamp(-1.0, 1.0).acos(),
            ONE,
            [2e-3, 5e-3],
        ),
        (
            "bias",
            json!({ "bias": 0.1 }),
            &|x| bias(unit(x), 0.1),
            ONE,
            [1e-3, 2e-3],
        ),
        (
            "bias",
            json!({ "bias": 0.8 }),
            &|x| bias(unit(x), 0.8),
            ONE,
            [1e-3, 2e-3],
        ),
        (
            "gain",
            json!({ "gain": 0.2 }),
            &|x| gain(unit(x), 0.2),
            ONE,
            [1e-3, 2e-3],
        ),
        (
            "gain",
            json!({ "gain": 0.9 }),
            &|x| gain(unit(x), 0.9),
            ONE,
            [1e-3, 2e-3],
        ),
        (
            "contrast",
            json!({ "amount": 1.5 }),
            &|x| 1.5 * x - 0.25,
            ONE,
            [2e-4, 2e-4],
        ),
        (
            "levels",
            json!({ "gamma": 2.5 }),
            &|x| levels(x, 2.5),
            ONE,
            [3e-4, 5e-4],
        ),
        (
            "levels",
            json!({ "gamma": 2.2, "doclamp": true }),
            &|x| levels(unit(x), 2.2),
            ONE,
            [3e-4, 5e-4],
        ),
        (
            "levels",
            json!({ "inlow": 0.2, "inhigh": 0.6, "gamma": 0.5, "outlow": 1, "outhigh": 3, "doclamp": true }),
            &|x| 1.0 + 2.0 * levels(unit((x - 0.2) / 0.4), 0.5),
            ONE,
            [3e-4, 5e-4],
        ),
    ];
    for (name, more, exact, inputs, tolerances) in cases {
        Law {
            node: of(name, more),
            exact: &|x| vec![exact(x[0])],
            inputs,
            tolerances,
        }
        .check();
    }
}
