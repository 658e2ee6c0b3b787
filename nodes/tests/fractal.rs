//! Turbulence, ridges and multifractals against sampled truth.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};

/// Evaluates a one-output graph over footprints: a list of (mean, variance).
fn evaluate(json: &str, method: Method, footprints: &[Footprint]) -> Vec<[f64; 2]> {
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
    let out = eval_program::<f32>(&program, footprints, &[]);
    (0..footprints.len())
        .map(|i| [out[0][i].into(), out.get(1).map_or(0.0, |v| v[i].into())])
        .collect()
}

fn at(p: [f64; 2], size: f64) -> Footprint {
    Footprint {
        cell: p.map(|x| x.floor() as i32),
        uv: p.map(|x| (x - x.floor()) as f32),
        du: [size as f32, 0.0],
        dv: [0.0, size as f32],
    }
}

/// Places along the R2 sequence.
fn positions(count: usize, extent: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|i| {
            [0.754_877_666_246_692_7, 0.569_840_290_998_053_3]
                .map(|step| (i as f64 * step).fract() * extent + 3.0)
        })
        .collect()
}

/// A node of this type with these further inputs, and the same through a map that `o` names.
fn graph(kind: &str, inputs: &str, map: &str) -> String {
    let output = if map.is_empty() { "n" } else { "o" };
    format!(
        r#"{{"version":1,"name":"n","nodes":{{"n":{{"type":"{kind}","inputs":{{{inputs}}}}}{map}}},"outputs":{{"out":{{"node":"{output}"}}}}}}"#
    )
}

/// What a node holds.
struct Claim {
    kind: &'static str,
    octaves: &'static str,
    /// Mean and standard deviation of three octaves.
    mean: f64,
    sd: f64,
    /// max |CDF − Φ| of three octaves.
    deviation: f64,
    /// The wavelength, in cells.
    wavelength: f64,
    /// RMS errors after a smooth step and after a step.
    errors: [f64; 2],
}

const CLAIMS: [Claim; 3] = [
    Claim {
        kind: "turbulence2d",
        octaves: r#""octaves":4"#,
        mean: 0.349_06,
        sd: 0.172_64,
        deviation: 0.06,
        wavelength: 1.53,
        errors: [0.047, 0.077],
    },
    Claim {
        kind: "ridged2d",
        octaves: r#""octaves":3"#,
        mean: 1.1,
        sd: 0.26,
        deviation: 0.05,
        wavelength: 1.53,
        errors: [0.043, 0.071],
    },
    Claim {
        kind: "multifractal2d",
        octaves: r#""octaves":3"#,
        mean: 1.0,
        sd: 0.29,
        deviation: 0.03,
        wavelength: 1.53,
        errors: [0.043, 0.071],
    },
];

/// The mean of the point function over the footprint, from 4096 samples: the R2 sequence warped to
/// a Gaussian.
fn truths(json: &str, places: &[[f64; 2]], size: f64) -> Vec<f64> {
    let offsets: Vec<[f64; 2]> = positions(4096, 1.0)
        .iter()
        .map(|p| {
            let [x, y] = p.map(|x| (x - 3.0 + 0.5 / 4096.0).fract());
            let radius = size * (-2.0 * x.max(1e-9).ln()).sqrt();
            let (sin, cos) = (std::f64::consts::TAU * y).sin_cos();
            [radius * cos, radius * sin]
        })
        .collect();
    places
        .iter()
        .map(|p| {
            let samples: Vec<_> = (offsets.iter())
                .map(|o| at([p[0] + o[0], p[1] + o[1]], 0.0))
                .collect();
            let values = evaluate(json, Method::Point, &samples);
            values.iter().map(|v| v[0]).sum::<f64>() / values.len() as f64
        })
        .collect()
}

#[test]
fn maps_after_fractals_are_filtered() {
    for claim in &CLAIMS {
        let (low, high) = (claim.mean - claim.sd, claim.mean + claim.sd);
        let maps = [
            format!(
                r#","o":{{"type":"smoothstep","inputs":{{"in":{{"node":"n"}},"low":{low},"high":{high}}}}}"#
            ),
            format!(
                r#","o":{{"type":"step","inputs":{{"in":{{"node":"n"}},"edge":{}}}}}"#,
                claim.mean
            ),
        ];
        let places = positions(24, 40.0);
        for (map, bound) in maps.iter().zip(claim.errors) {
            let json = graph(claim.kind, claim.octaves, map);
            let mut squares = [0.0; 3];
            let sizes = [0.03, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0];
            for size in sizes {
                let size = size * claim.wavelength;
                let truth = truths(&json, &places, size);
                let footprints: Vec<_> = places.iter().map(|&p| at(p, size)).collect();
                for (sum, method) in squares.iter_mut().zip([Method::Local, Method::Quad, Method::Naive]) {
                    let found = evaluate(&json, method, &footprints);
                    let square: f64 = found.iter().zip(&truth).map(|(f, t)| (f[0] - t).powi(2)).sum();
                    *sum += square / (places.len() * sizes.len()) as f64;
                }
            }
            println!("{} {:?} bound {bound}", claim.kind, squares.map(f64::sqrt));
        }
    }
}

#[test]
fn statistics() {
    for claim in &CLAIMS {
        let json = graph(claim.kind, "", "");
        let places: Vec<_> = (0..100_000)
            .map(|i| {
                let fraction = [0.754_877_666, 0.569_840_29].map(|step| (i as f64 * step).fract());
                let cell = [7 * (i % 300), 7 * (i / 300)].map(|c| c as f64);
                at([0, 1].map(|k| cell[k] + fraction[k]), 0.0)
            })
            .collect();
        let mut values: Vec<f64> = evaluate(&json, Method::Point, &places).iter().map(|v| v[0]).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
        values.sort_by(f64::total_cmp);
        let mut worst = 0.0f64;
        for (i, v) in values.iter().enumerate().step_by(100) {
            let z = (v - mean) / sd;
            worst = worst.max((phi(z) - (i as f64 + 0.5) / n).abs());
        }
        let far = evaluate(&json, Method::Local, &[at([0.3, 0.4], 1e6)])[0];
        println!("{} mean {mean} sd {sd} dev {worst} far {} {} range {} {}", claim.kind, far[0], far[1].sqrt(), values[0], values[values.len()-1]);
    }
}

/// Φ by Simpson's rule.
fn phi(z: f64) -> f64 {
    let n = 200;
    let h = z / f64::from(n);
    let f = |x: f64| (-0.5 * x * x).exp();
    let sum: f64 = (0..n)
        .map(|i| {
            let x = f64::from(i) * h;
            f(x) + 4.0 * f(x + 0.5 * h) + f(x + h)
        })
        .sum();
    0.5 + sum * h / 6.0 / std::f64::consts::TAU.sqrt()
}
