//! The noises against dense numerical truth.

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
    let out = eval_program::<f64>(&program, footprints, &[]);
    (0..footprints.len())
        .map(|i| [out[0][i], out.get(1).map_or(0.0, |v| v[i])])
        .collect()
}

/// A small deterministic stream of uniform numbers.
fn positions(count: usize) -> Vec<[f64; 2]> {
    (0..count)
        .map(|i| {
            [
                (i as f64 * 0.754_877_666).fract() * 40.0 + 3.0,
                (i as f64 * 0.569_840_29).fract() * 40.0 + 7.0,
            ]
        })
        .collect()
}

/// Mean and variance of the point function over the footprint, on a grid of ±4.5σ.
fn truth(json: &str, at: [f64; 2], axes: [[f64; 2]; 2]) -> [f64; 2] {
    let n = 61;
    let mut weights = Vec::new();
    let mut footprints = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let z = [i, j].map(|k| 9.0 * (k as f64 + 0.5) / n as f64 - 4.5);
            weights.push((-0.5 * (z[0] * z[0] + z[1] * z[1])).exp());
            let p = [0, 1].map(|k| at[k] + axes[0][k] * z[0] + axes[1][k] * z[1]);
            let cell = p.map(|x| x.floor() as i32);
            let uv = [0, 1].map(|k| (p[k] - p[k].floor()) as f32);
            footprints.push(Footprint {
                cell,
                uv,
                du: [0.0; 2],
                dv: [0.0; 2],
            });
        }
    }
    let values = evaluate(json, Method::Point, &footprints);
    let total: f64 = weights.iter().sum();
    let mean = values
        .iter()
        .zip(&weights)
        .map(|(v, w)| v[0] * w)
        .sum::<f64>()
        / total;
    let variance = values
        .iter()
        .zip(&weights)
        .map(|(v, w)| (v[0] - mean).powi(2) * w)
        .sum::<f64>()
        / total;
    [mean, variance]
}

const NOISE: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"noise2d","inputs":{"amplitude":4}}},"outputs":{"out":{"node":"n"}}}"#;
const SPECTRAL: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"spectralnoise2d","inputs":{"amplitude":4}}},"outputs":{"out":{"node":"n"}}}"#;

#[test]
fn noise_has_its_standard_deviation() {
    for json in [NOISE, SPECTRAL] {
        let footprints: Vec<Footprint> = (0..40_000)
            .map(|i| Footprint {
                cell: [(i % 200) * 3, (i / 200) * 3],
                uv: [
                    (i as f32 * 0.754_877_7).fract(),
                    (i as f32 * 0.569_840_3).fract(),
                ],
                du: [0.0; 2],
                dv: [0.0; 2],
            })
            .collect();
        let values = evaluate(json, Method::Point, &footprints);
        let n = values.len() as f64;
        let mean = values.iter().map(|v| v[0]).sum::<f64>() / n;
        let variance = values.iter().map(|v| v[0] * v[0]).sum::<f64>() / n;
        println!("mean {mean} variance {variance}");
    }
}

#[test]
fn filtered() {
    for (name, json, unit) in [("noise", NOISE, 1.53), ("spectral", SPECTRAL, 1.0)] {
        for s in [0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0] {
            for (ratio, angle) in [(1.0, 0.0f64), (8.0, 0.0), (8.0, 20.0), (8.0, 45.0)] {
                let (sin, cos) = angle.to_radians().sin_cos();
                let (minor, major) = (s * unit, s * unit * ratio);
                let axes = [[major * cos, major * sin], [-minor * sin, minor * cos]];
                let at = positions(40);
                let footprints: Vec<Footprint> = (at.iter())
                    .map(|p| Footprint {
                        cell: p.map(|x| x.floor() as i32),
                        uv: p.map(|x| (x - x.floor()) as f32),
                        du: axes[0].map(|x| x as f32),
                        dv: axes[1].map(|x| x as f32),
                    })
                    .collect();
                let truths: Vec<[f64; 2]> = at.iter().map(|&p| truth(json, p, axes)).collect();
                let mut line = format!("{name} s {s} {ratio}:1 at {angle}:");
                for method in [Method::Ensemble, Method::Local, Method::Quad] {
                    let values = evaluate(json, method, &footprints);
                    let n = at.len() as f64;
                    let mean = (values
                        .iter()
                        .zip(&truths)
                        .map(|(v, t)| (v[0] - t[0]).powi(2))
                        .sum::<f64>()
                        / n)
                        .sqrt();
                    let sd: f64 = truths.iter().map(|t| t[1].sqrt()).sum::<f64>() / n;
                    let off = values
                        .iter()
                        .zip(&truths)
                        .map(|(v, t)| (v[1].sqrt() - t[1].sqrt()).abs())
                        .sum::<f64>()
                        / n
                        / sd;
                    line += &format!("  {method} mean {mean:.4} sd {off:.3}");
                }
                println!("{line}");
            }
        }
    }
}
