//! Evaluation of small graphs, dense numerical truth, and tests of hypotheses.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};

/// The graph of one node, `inputs` being the members of its JSON object.
pub(crate) fn graph(node: &str, inputs: &str) -> String {
    format!(
        r#"{{"version":1,"name":"n","nodes":{{"n":{{"type":"{node}","inputs":{{{inputs}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
    )
}

/// Evaluates a one-output graph over footprints: a list of (mean, variance).
pub(crate) fn evaluate(json: &str, method: Method, footprints: &[Footprint]) -> Vec<[f64; 2]> {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(json, &specs);
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter: PixelFilter::Gaussian(1.0),
        moments: true,
        seed: 0,
    };
    let program = compile(&checked, catalogue, &options);
    let out = eval_program::<f64>(&program, footprints, &[]);
    let variance = out.len() / 2;
    (0..footprints.len())
        .map(|i| [out[0][i], out[variance][i]])
        .collect()
}

/// A footprint at a position.
pub(crate) fn footprint(at: [f64; 2], axes: [[f64; 2]; 2]) -> Footprint {
    Footprint {
        cell: at.map(|x| x.floor() as i32),
        uv: at.map(|x| (x - x.floor()) as f32),
        du: axes[0].map(|x| x as f32),
        dv: axes[1].map(|x| x as f32),
    }
}

/// Places over a square, by the R2 sequence.
pub(crate) fn places(count: usize, extent: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|i| [0.754_877_666, 0.569_840_29].map(|step| (i as f64 * step).fract() * extent + 3.1))
        .collect()
}

/// The axes of a footprint whose longer one is `ratio` times the shorter, of length `minor`.
pub(crate) fn axes(minor: f64, ratio: f64, degrees: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let major = minor * ratio;
    [[major * cos, major * sin], [-minor * sin, minor * cos]]
}

/// Mean and variance of the point function over a footprint, by steps of 1/step = 2/finest + 0.9/σ
/// with `finest` the shortest period: exact to 1e-6 for what has none shorter.
fn dense(json: &str, at: [f64; 2], axes: [[f64; 2]; 2], finest: f64) -> [f64; 2] {
    let nodes = axes.map(|axis| {
        let step = 1.0 / (2.0 * axis[0].hypot(axis[1]) / finest + 0.9);
        let half = (4.8 / step).ceil() as i32;
        (-half..=half)
            .map(|i| f64::from(i) * step)
            .collect::<Vec<_>>()
    });
    let mut weights = Vec::new();
    let mut footprints = Vec::new();
    for &z in &nodes[0] {
        for &y in &nodes[1] {
            weights.push((-0.5 * (z * z + y * y)).exp());
            let p = [0, 1].map(|k| at[k] + axes[0][k] * z + axes[1][k] * y);
            footprints.push(footprint(p, [[0.0; 2]; 2]));
        }
    }
    let values = evaluate(json, Method::Point, &footprints);
    let total: f64 = weights.iter().sum();
    let pairs = || values.iter().map(|v| v[0]).zip(&weights);
    let mean = pairs().map(|(v, w)| v * w).sum::<f64>() / total;
    let variance = pairs().map(|(v, w)| (v - mean).powi(2) * w).sum::<f64>() / total;
    [mean, variance]
}

/// What a method gets wrong.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    /// The root mean square error of the mean.
    pub(crate) mean: f64,
    /// mean |σ̂ − σ| / mean σ.
    pub(crate) deviation: f64,
    /// The mean of σ̂² over that of σ², less 1.
    pub(crate) bias: f64,
}

/// The errors of methods over some places.
pub(crate) fn errors(
    json: &str,
    places: &[[f64; 2]],
    axes: [[f64; 2]; 2],
    finest: f64,
    methods: &[Method],
) -> Vec<Errors> {
    let truths: Vec<[f64; 2]> = places
        .iter()
        .map(|&p| dense(json, p, axes, finest))
        .collect();
    let footprints: Vec<Footprint> = places.iter().map(|&p| footprint(p, axes)).collect();
    let n = places.len() as f64;
    let sd = truths.iter().map(|t| t[1].sqrt()).sum::<f64>() / n;
    let variance = truths.iter().map(|t| t[1]).sum::<f64>() / n;
    (methods.iter())
        .map(|&method| {
            let values = evaluate(json, method, &footprints);
            let pairs = || values.iter().zip(&truths);
            let mean = pairs().map(|(v, t)| (v[0] - t[0]).powi(2)).sum::<f64>() / n;
            let off = pairs()
                .map(|(v, t)| (v[1].sqrt() - t[1].sqrt()).abs())
                .sum::<f64>()
                / n;
            Errors {
                mean: mean.sqrt(),
                deviation: off / sd,
                bias: values.iter().map(|v| v[1]).sum::<f64>() / n / variance - 1.0,
            }
        })
        .collect()
}

/// Values of the point function at places so far apart that they are independent.
pub(crate) fn sample(json: &str, count: usize, apart: f64) -> Vec<f64> {
    let side = (count as f64).sqrt().ceil() as usize;
    let footprints: Vec<Footprint> = (0..count)
        .map(|i| {
            // The places within cells differ from one to the next.
            let jitter = [0.754_877_666, 0.569_840_29].map(|step| (i as f64 * step).fract());
            let at = [i % side, i / side];
            let at = [0, 1].map(|k| apart * at[k] as f64 + jitter[k] * 0.5 * apart);
            footprint(at, [[0.0; 2]; 2])
        })
        .collect();
    let values = evaluate(json, Method::Point, &footprints);
    values.into_iter().map(|v| v[0]).collect()
}

/// Tests that a sample has this mean and variance, at 4.4 standard errors (level 1e-5 each).
pub(crate) fn has_moments(what: &str, sample: &[f64], mean: f64, variance: f64) {
    let n = sample.len() as f64;
    let found = sample.iter().sum::<f64>() / n;
    let power = |k: i32| sample.iter().map(|x| (x - found).powi(k)).sum::<f64>() / n;
    let (square, fourth) = (power(2), power(4));
    let z = (found - mean) / (square / n).sqrt();
    assert!(
        z.abs() < 4.4,
        "{what}: mean {found}, not {mean}: {z:.1} standard errors"
    );
    let z = (square - variance) / ((fourth - square * square) / n).sqrt();
    assert!(
        z.abs() < 4.4,
        "{what}: variance {square}, not {variance}: {z:.1} standard errors"
    );
}

/// max |F − CDF| of a sample, with F a distribution function.
pub(crate) fn distance(sample: &[f64], cdf: impl Fn(f64) -> f64) -> f64 {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    (sorted.iter().enumerate())
        .map(|(i, &x)| {
            let f = cdf(x);
            (f - i as f64 / n).abs().max((f - (i + 1) as f64 / n).abs())
        })
        .fold(0.0, f64::max)
}

/// Φ, by A&S 7.1.26.
pub(crate) fn normal(x: f64) -> f64 {
    let z = x.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * z);
    let poly = [
        1.061_405_429,
        -1.453_152_027,
        1.421_413_741,
        -0.284_496_736,
        0.254_829_592,
    ];
    let tail = 0.5 * poly.iter().fold(0.0, |sum, c| sum * t + c) * t * (-z * z).exp();
    if x < 0.0 { tail } else { 1.0 - tail }
}
