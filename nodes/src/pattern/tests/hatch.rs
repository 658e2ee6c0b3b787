//! Lines along the diagonals of cells whose rows alternate, against the definition of the node integrated
//! exactly along x and densely along y.

use super::{STEP, evaluated, masses};
use mipless_codegen::Method;
use mipless_codegen::cpu::Footprint;
use serde_json::{Value, json};

const METHODS: [Method; 2] = [Method::Local, Method::Quad];

/// A graph of lines of a width, which is an input of the graph where it is live, named `lines`.
fn graph(thickness: f32, live: bool, others: Value) -> String {
    let width = if live {
        json!({ "input": "width" })
    } else {
        json!(thickness)
    };
    let inputs = json!({ "thickness": width, "staggered": true });
    let mut nodes = others;
    nodes["lines"] = json!({ "type": "crosshatch", "inputs": inputs });
    json!({
        "version": 1, "name": "hatch",
        "inputs": { "width": { "type": "float", "value": thickness, "min": 0, "max": 1 } },
        "nodes": nodes,
        "outputs": { "out": { "node": if nodes["x"].is_null() { "lines" } else { "x" } } }
    })
    .to_string()
}

fn lines(thickness: f32, live: bool) -> String {
    graph(thickness, live, json!({}))
}

/// Footprints of an area and a ratio of their axes, in several directions.
fn footprints(size: f32, ratio: f32, places: usize) -> Vec<Footprint> {
    (0..places)
        .map(|i| {
            let uv = [0.754_877_67, 0.569_840_3].map(|step: f32| (0.013 + step * i as f32).fract());
            // The first few are along the axes and the diagonals.
            let angle = match i {
                0..4 => std::f32::consts::FRAC_PI_4 * i as f32,
                _ => 0.5 + 0.7 * i as f32,
            };
            let (s, c) = angle.sin_cos();
            let (long, short) = (size * ratio.sqrt(), size / ratio.sqrt());
            Footprint {
                cell: [i as i32 % 3 - 1, i as i32 % 5 - 2],
                uv,
                du: [long * c, long * s],
                dv: [-short * s, short * c],
            }
        })
        .collect()
}

/// The share of a footprint that lies in lines, and its covariances with x and y.
fn truth(table: &[f64], thickness: f32, footprint: &Footprint) -> [f64; 3] {
    let half = f64::from(thickness) / 2f64.sqrt();
    let [du, dv] = [footprint.du, footprint.dv].map(|v| v.map(f64::from));
    let mean = [0, 1].map(|k| f64::from(footprint.cell[k]) + f64::from(footprint.uv[k]));
    let product = |i: usize, k: usize| du[i] * du[k] + dv[i] * dv[k];
    let (high, slope) = (product(1, 1).sqrt(), product(0, 1) / product(1, 1));
    let across = (product(0, 0) - slope * product(0, 1)).max(1e-20).sqrt();
    let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let below = |z: f64| {
        let place = ((z + 6.0) / STEP).clamp(0.0, table.len() as f64 - 1.001);
        let (first, share) = (place.floor() as usize, place.fract());
        table[first] + share * (table[first + 1] - table[first])
    };
    let mut sums = [0.0; 3];
    let ends = [-6.0, 6.0].map(|z| mean[1] + z * high);
    for row in ends[0].floor() as i64..=ends[1].floor() as i64 {
        let (low, top) = (ends[0].max(row as f64), ends[1].min(row as f64 + 1.0));
        let nodes = ((top - low) / high * 300.0).ceil().max(100.0);
        for i in 0..nodes as usize {
            let y = low + (top - low) * (i as f64 + 0.5) / nodes;
            let weight = density((y - mean[1]) / high) * (top - low) / nodes / high;
            let centre = mean[0] + slope * (y - mean[1]);
            let up = (y - row as f64 - 0.5).abs();
            let (near, far) = ((up - half).max(0.0), (up + half).min(0.5));
            if near >= far {
                continue;
            }
            // The middles of cells.
            let shift = 0.5 + 0.5 * (row.rem_euclid(2) as f64);
            let [first, last] = [-6.0, 6.0].map(|z| (centre + z * across - shift).round() as i64);
            for cell in first - 1..=last + 1 {
                let middle = cell as f64 + shift;
                for [from, to] in [[-far, -near], [near, far]] {
                    let [from, to] = [from, to].map(|x| (middle + x - centre) / across);
                    let mass = below(to) - below(from);
                    let moment = across * (density(from) - density(to));
                    sums[0] += weight * mass;
                    sums[1] += weight * (moment + mass * (centre - mean[0]));
                    sums[2] += weight * mass * (y - mean[1]);
                }
            }
        }
    }
    sums
}

/// Sizes in cells, on both sides of where the series takes over.
const SIZES: [f32; 10] = [0.01, 0.04, 0.1, 0.14, 0.17, 0.25, 0.35, 0.45, 0.7, 2.0];

#[test]
fn staggered_lines_are_filtered_exactly_up_to_16_to_1() {
    let table = masses();
    for (ratio, bound) in [
        (1.0, 1e-4),
        (3.0, 3e-4),
        (8.0, 3e-4),
        (16.0, 3e-4),
        (20.0, 3e-3),
        (40.0, 0.12),
    ] {
        let footprints: Vec<Footprint> = (SIZES.iter())
            .flat_map(|&size| footprints(size, ratio, 10))
            .collect();
        for thickness in [0.0, 0.05, 0.25, 0.6, 0.7, 1.0] {
            let truth: Vec<f64> = (footprints.iter())
                .map(|footprint| truth(&table, thickness, footprint)[0])
                .collect();
            for (live, method) in [false, true]
                .into_iter()
                .flat_map(|live| METHODS.map(|method| (live, method)))
            {
                let found = evaluated(&lines(thickness, live), method, &footprints);
                let variances = &found[found.len() / 2];
                let mut worst = [0.0f64; 2];
                for (i, mean) in truth.iter().enumerate() {
                    let errors = [found[0][i] - mean, variances[i] - mean * (1.0 - mean)];
                    worst = [0, 1].map(|k| worst[k].max(errors[k].abs()));
                }
                let what = format!("{thickness}, live {live}, by {method}, {ratio}:1");
                println!("{what}: {worst:.6?}");
                assert!(
                    worst.iter().all(|&error| error <= bound),
                    "{what}: {worst:?}"
                );
            }
        }
    }
}

/// The mean of a product with a coordinate has their covariance, which is that of the gradient.
#[test]
fn gradients_of_staggered_lines_are_exact() {
    let table = masses();
    for (thickness, live) in [(0.05, true), (0.25, false), (0.25, true), (0.6, false)] {
        for axis in 0..2 {
            let others = json!({
                "uv": { "type": "texcoord" },
                "along": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": axis } },
                "x": { "type": "multiply", "inputs": { "in1": { "node": "lines" }, "in2": { "node": "along" } } }
            });
            let text = graph(thickness, live, others);
            for (size, ratio) in [(0.04, 1.0), (0.15, 1.0), (0.3, 1.0), (0.1, 8.0), (0.5, 8.0)] {
                let footprints = footprints(size, ratio, 10);
                let found = &evaluated(&text, Method::Local, &footprints)[0];
                for (found, footprint) in found.iter().zip(&footprints) {
                    let truth = truth(&table, thickness, footprint);
                    let place = footprint.cell[axis] as f32 + footprint.uv[axis];
                    let deviation = footprint.du[axis].hypot(footprint.dv[axis]);
                    let wanted = f64::from(place) * truth[0] + truth[1 + axis];
                    // In standard deviations; the mean is off by 3e-4 of the place.
                    let error = (found - wanted).abs() - 3e-4 * f64::from(place.abs());
                    let error = error / f64::from(deviation);
                    assert!(error <= 2e-3, "{thickness} {live} {size} {ratio}: {error}");
                }
            }
        }
    }
}

/// The definition of the node, at places that are no nearer to an edge than rounding.
#[test]
fn staggered_lines_are_themselves_at_a_point() {
    let places = |count: usize| {
        (0..count).map(|i| Footprint {
            uv: [0.754_877_67, 0.569_840_3].map(|step: f32| (0.5 + step * i as f32).fract()),
            cell: [i as i32 % 5 - 2, i as i32 % 7 - 3],
            ..Footprint::default()
        })
    };
    for thickness in [0.0f32, 0.2, 0.6, 1.0] {
        let distance = |place: &Footprint| {
            let shift = if place.cell[1].rem_euclid(2) == 1 {
                0.5
            } else {
                0.0
            };
            let [x, y] = place.uv.map(f64::from);
            let x = (x - shift).rem_euclid(1.0);
            (x - y).abs().min((x + y - 1.0).abs()) / 2f64.sqrt() - 0.5 * f64::from(thickness)
        };
        let places: Vec<Footprint> = places(400).filter(|p| distance(p).abs() > 1e-4).collect();
        for (live, method) in [
            (false, Method::Point),
            (true, Method::Point),
            (false, Method::Local),
            (true, Method::Quad),
        ] {
            let found = &evaluated(&lines(thickness, live), method, &places)[0];
            for (found, place) in found.iter().zip(&places) {
                let wanted = if distance(place) < 0.0 { 1.0 } else { 0.0 };
                assert!(
                    (found - wanted).abs() < 1e-5,
                    "{thickness} {live} {method} {place:?}: {found}"
                );
            }
        }
    }
}
