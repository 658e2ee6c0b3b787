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
    /// Mean and standard deviation of three octaves, and how far the filtered ones of a large
    /// footprint may be from them.
    mean: f64,
    sd: f64,
    closure: [f64; 2],
    /// max |CDF − Φ| of three octaves.
    deviation: f64,
    /// RMS errors of the mean itself, after a smooth step and after a step.
    errors: [f64; 3],
}

const CLAIMS: [Claim; 3] = [
    Claim {
        kind: "turbulence2d",
        octaves: r#""octaves":4"#,
        mean: 0.349_06,
        sd: 0.172_64,
        closure: [1e-3, 1e-3],
        deviation: 0.06,
        errors: [0.023, 0.047, 0.077],
    },
    Claim {
        kind: "ridged2d",
        octaves: r#""octaves":3"#,
        mean: 1.1195,
        sd: 0.312,
        closure: [0.009, 0.015],
        deviation: 0.07,
        errors: [0.043, 0.043, 0.071],
    },
    Claim {
        kind: "multifractal2d",
        octaves: r#""octaves":3"#,
        mean: 1.0,
        sd: 0.288_65,
        closure: [1e-3, 1e-3],
        deviation: 0.025,
        errors: [0.006, 0.015, 0.05],
    },
];

/// The means of the point function over footprints, each from 2048 samples: the R2 sequence warped
/// to a Gaussian.
fn truths(json: &str, places: &[[f64; 2]], size: f64) -> Vec<f64> {
    const SAMPLES: usize = 2048;
    let offsets: Vec<[f64; 2]> = positions(SAMPLES, 1.0)
        .iter()
        .map(|p| {
            let [x, y] = p.map(|x| (x - 3.0 + 0.5 / SAMPLES as f64).fract());
            let radius = size * (-2.0 * x.max(1e-9).ln()).sqrt();
            let (sin, cos) = (std::f64::consts::TAU * y).sin_cos();
            [radius * cos, radius * sin]
        })
        .collect();
    let samples: Vec<_> = (places.iter())
        .flat_map(|p| (offsets.iter()).map(|o| at([p[0] + o[0], p[1] + o[1]], 0.0)))
        .collect();
    evaluate(json, Method::Point, &samples)
        .chunks(SAMPLES)
        .map(|values| values.iter().map(|v| v[0]).sum::<f64>() / SAMPLES as f64)
        .collect()
}

#[test]
fn fractals_and_maps_of_them_are_filtered() {
    for claim in &CLAIMS {
        let (low, high) = (claim.mean - 2.0 * claim.sd, claim.mean + 2.0 * claim.sd);
        let mean = claim.mean;
        let maps = [
            String::new(),
            format!(
                r#","o":{{"type":"smoothstep","inputs":{{"in":{{"node":"n"}},"low":{low},"high":{high}}}}}"#
            ),
            format!(r#","o":{{"type":"step","inputs":{{"in":{{"node":"n"}},"edge":{mean}}}}}"#),
        ];
        let places = positions(24, 40.0);
        for (map, bound) in maps.iter().zip(claim.errors) {
            let json = graph(claim.kind, claim.octaves, map);
            let mut squares = [0.0; 2];
            // In wavelengths of the first octave.
            let sizes = [0.03, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0];
            for size in sizes {
                let size = size * 1.53;
                let truth = truths(&json, &places, size);
                let footprints: Vec<_> = places.iter().map(|&p| at(p, size)).collect();
                for (sum, method) in squares.iter_mut().zip([Method::Local, Method::Quad]) {
                    let found = evaluate(&json, method, &footprints);
                    let pairs = found.iter().zip(&truth);
                    let square: f64 = pairs.map(|(f, t)| (f[0] - t).powi(2)).sum();
                    *sum += square / (places.len() * sizes.len()) as f64;
                }
            }
            let [local, quad] = squares.map(f64::sqrt);
            assert!(local <= bound, "{}{map}: local {local}", claim.kind);
            assert!(quad <= local, "{}{map}: quad {quad}", claim.kind);
        }
    }
}

#[test]
fn statistics_are_the_stated_ones() {
    // Two tests of each of three nodes: at 4.5 standard errors a false alarm of all is below 5e-5.
    for claim in &CLAIMS {
        let json = graph(claim.kind, "", "");
        let places: Vec<_> = (0..60_000)
            .map(|i| {
                let fraction = [0.754_877_666, 0.569_840_29].map(|step| (i as f64 * step).fract());
                let cell = [7 * (i % 300), 7 * (i / 300)].map(|c| c as f64);
                at([0, 1].map(|k| cell[k] + fraction[k]), 0.0)
            })
            .collect();
        let mut values: Vec<f64> = evaluate(&json, Method::Point, &places)
            .iter()
            .map(|v| v[0])
            .collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let moment = |k| values.iter().map(|v| (v - mean).powi(k)).sum::<f64>() / n;
        let (variance, fourth) = (moment(2), moment(4));
        let kind = claim.kind;
        // The figures are rounded to 5e-4.
        let off = (mean - claim.mean).abs();
        assert!(
            off <= 4.5 * (variance / n).sqrt() + 5e-4,
            "{kind}: mean {mean}"
        );
        let sd = variance.sqrt();
        let error = ((fourth - variance * variance) / n).sqrt() / (2.0 * sd);
        assert!(
            (sd - claim.sd).abs() <= 4.5 * error + 5e-4,
            "{kind}: sd {sd} ± {error}"
        );
        // A footprint that removes every octave leaves the mean and the deviation.
        let far = evaluate(&json, Method::Local, &[at([0.3, 0.4], 1e6)])[0];
        assert!(
            (far[0] - claim.mean).abs() <= claim.closure[0],
            "{kind}: {}",
            far[0]
        );
        let off = (far[1].sqrt() - claim.sd).abs();
        assert!(off <= claim.closure[1], "{kind}: {}", far[1].sqrt());

        values.sort_by(f64::total_cmp);
        let worst = (0..values.len()).step_by(100).map(|i| {
            let z = (values[i] - mean) / sd;
            (phi(z) - (i as f64 + 0.5) / n).abs()
        });
        let worst = worst.fold(0.0, f64::max);
        // Kolmogorov's bound at a level of 1e-4 is 2.2/√n.
        assert!(
            worst <= claim.deviation + 2.2 / n.sqrt(),
            "{kind}: deviation {worst}"
        );
    }
}

#[test]
fn a_footprint_of_nothing_gives_the_point() {
    for claim in &CLAIMS {
        for inputs in [r#""octaves":2.5"#, r#""octaves":3,"kernel":"quintic""#] {
            let json = graph(claim.kind, inputs, "");
            let places: Vec<_> = positions(300, 50.0).iter().map(|&p| at(p, 0.0)).collect();
            let points = evaluate(&json, Method::Point, &places);
            for method in [Method::Naive, Method::Local, Method::Quad] {
                for (found, point) in evaluate(&json, method, &places).iter().zip(&points) {
                    let off = (found[0] - point[0]).abs();
                    assert!(off < 1e-5, "{} {inputs} {method}: {off}", claim.kind);
                    assert!(found[1] <= 1e-9, "{method}: variance {}", found[1]);
                }
            }
        }
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
