//! The noise in space against dense numerical truth.

use mipless_codegen::cpu::{Evaluator, Footprint, Position, Scratch};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};

/// Evaluates a one-output graph at positions: a list of (mean, variance).
fn evaluate(json: &str, method: Method, positions: &[Position]) -> Vec<[f64; 2]> {
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
    let evaluator = Evaluator::<f64>::of_program(&program);
    let footprints = vec![Footprint::default(); positions.len()];
    let mut out = Vec::new();
    evaluator.evaluate_surface(&mut Scratch::new(), &footprints, positions, &[], &mut out);
    (0..positions.len())
        .map(|i| [out[0][i], out.get(1).map_or(0.0, |v| v[i])])
        .collect()
}

fn at(p: [f64; 3], [dx, dy]: [[f64; 3]; 2]) -> Position {
    Position {
        cell: p.map(|x| x.floor() as i32),
        xyz: p.map(|x| (x - x.floor()) as f32),
        dx: dx.map(|x| x as f32),
        dy: dy.map(|x| x as f32),
    }
}

/// A small deterministic stream of positions, along the R3 sequence.
fn positions(count: usize) -> Vec<[f64; 3]> {
    (0..count)
        .map(|i| {
            [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9]
                .map(|step| (i as f64 * step).fract() * 40.0 + 3.0)
        })
        .collect()
}

/// Two orthogonal directions of a plane that lies askew, turned in it by `degrees`.
fn plane(askew: bool, degrees: f64) -> [[f64; 3]; 2] {
    let [p, q] = if askew {
        [
            [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0],
            [-2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0],
        ]
    } else {
        [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    };
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turned = |a: f64, b: f64| [0, 1, 2].map(|i| a * p[i] + b * q[i]);
    [turned(cos, sin), turned(-sin, cos)]
}

/// Means and variances of the point function over footprints, on a grid of ±4.2σ that is so many
/// times as fine as smooth noises need.
fn truths(json: &str, places: &[[f64; 3]], axes: [[f64; 3]; 2], finer: f64) -> Vec<[f64; 2]> {
    let length = |axis: [f64; 3]| axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Five points a cell and never fewer than 4 a standard deviation.
    let counts = axes.map(|axis| (finer * (5.0 * 8.4 * length(axis)).clamp(34.0, 400.0)) as usize);
    let mut offsets = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let z = [0, 1].map(|k| 8.4 * ([i, j][k] as f64 + 0.5) / counts[k] as f64 - 4.2);
            let weight = (-0.5 * (z[0] * z[0] + z[1] * z[1])).exp();
            offsets.push((
                [0, 1, 2].map(|k| axes[0][k] * z[0] + axes[1][k] * z[1]),
                weight,
            ));
        }
    }
    let total: f64 = offsets.iter().map(|(_, w)| w).sum();
    places
        .chunks(4)
        .flat_map(|places| {
            let samples: Vec<_> = (places.iter())
                .flat_map(|p| {
                    let moved = |o: [f64; 3]| at([0, 1, 2].map(|k| p[k] + o[k]), [[0.0; 3]; 2]);
                    offsets.iter().map(move |&(o, _)| moved(o))
                })
                .collect();
            let values = evaluate(json, Method::Point, &samples);
            let moments = |values: &[[f64; 2]]| {
                let pairs = || values.iter().zip(&offsets);
                let mean = pairs().map(|(v, (_, w))| v[0] * w).sum::<f64>() / total;
                let square = |(v, (_, w)): (&[f64; 2], &([f64; 3], f64))| (v[0] - mean).powi(2) * w;
                [mean, pairs().map(square).sum::<f64>() / total]
            };
            values
                .chunks(offsets.len())
                .map(moments)
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A noise in space of variance 1, and what it holds.
struct Claim {
    kernel: &'static str,
    /// The error of the filtered mean, in standard deviations of the noise: round footprints, 8:1.
    mean: [f64; 2],
    /// max |CDF − Φ|.
    deviation: f64,
    /// The largest value.
    extent: f64,
}

const CLAIMS: [Claim; 2] = [
    Claim {
        kernel: "gaussian",
        mean: [0.018, 0.02],
        deviation: 0.002,
        extent: 5.0,
    },
    Claim {
        kernel: "quintic",
        mean: [0.02, 0.025],
        deviation: 0.016,
        extent: 4.54,
    },
];

impl Claim {
    fn json(&self) -> String {
        graph(&format!(
            r#"{{"type":"noise3d","inputs":{{"amplitude":4,"kernel":"{}"}}}}"#,
            self.kernel
        ))
    }
}

fn graph(node: &str) -> String {
    format!(
        r#"{{"version":1,"name":"n","nodes":{{"n":{node}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
    )
}

/// Root mean square error of the mean, and the mean error of the standard deviation relative to it,
/// for each method; `size` is the geometric mean of the two standard deviations, in cells.
fn errors(
    json: &str,
    (size, ratio): (f64, f64),
    (askew, degrees): (bool, f64),
    methods: &[Method],
) -> Vec<[f64; 2]> {
    errors_by(json, (size, ratio), (askew, degrees), methods, 1.0)
}

/// The same with a finer truth.
fn errors_by(
    json: &str,
    (size, ratio): (f64, f64),
    (askew, degrees): (bool, f64),
    methods: &[Method],
    finer: f64,
) -> Vec<[f64; 2]> {
    let [p, q] = plane(askew, degrees);
    let [major, minor] = [size * ratio.sqrt(), size / ratio.sqrt()];
    let axes = [p.map(|x| x * major), q.map(|x| x * minor)];
    let places = positions(20);
    let pixels: Vec<_> = places.iter().map(|&p| at(p, axes)).collect();
    let truths = truths(json, &places, axes, finer);
    let n = places.len() as f64;
    let sd = truths.iter().map(|t| t[1].sqrt()).sum::<f64>() / n;
    (methods.iter())
        .map(|&method| {
            let values = evaluate(json, method, &pixels);
            let pairs = || values.iter().zip(&truths);
            let mean = pairs().map(|(v, t)| (v[0] - t[0]).powi(2)).sum::<f64>() / n;
            let off = pairs().map(|(v, t)| (v[1].sqrt() - t[1].sqrt()).abs());
            [mean.sqrt(), off.sum::<f64>() / n / sd]
        })
        .collect()
}

#[test]
fn filtered_means_are_those_of_dense_integration() {
    for claim in &CLAIMS {
        let json = claim.json();
        for (ratio, plane) in [
            (1.0, (false, 0.0)),
            (1.0, (true, 0.0)),
            (8.0, (false, 0.0)),
            (8.0, (true, 20.0)),
            (8.0, (true, 75.0)),
        ] {
            let bound = claim.mean[usize::from(ratio > 1.0)];
            for size in [0.02, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.0] {
                let found = errors(&json, (size, ratio), plane, &[Method::Local])[0][0];
                println!(
                    "{} {ratio}:1 on {plane:?} at {size}: {found:.4}",
                    claim.kernel
                );
                assert!(
                    found <= bound,
                    "{} {ratio}:1 on {plane:?} at {size}: {found}",
                    claim.kernel
                );
            }
        }
    }
}

/// Variance 1: MaterialX's standard deviation is 0.2652 amplitude.
const MATERIALX: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"noise3d","inputs":{"amplitude":3.7712,"hash":"materialx"}}},"outputs":{"out":{"node":"n"}}}"#;

/// MaterialX's directions have a sixth more energy along y than along x and z; the filter of the mean
/// takes each as it is.
#[test]
fn filtered_means_of_materialx_noise_are_those_of_dense_integration() {
    for (ratio, plane) in [(1.0, (true, 0.0)), (8.0, (true, 20.0))] {
        for size in [0.1, 0.4, 1.0] {
            let found = errors(MATERIALX, (size, ratio), plane, &[Method::Local])[0][0];
            println!("{ratio}:1 on {plane:?} at {size}: {found:.4}");
            let bound = if ratio > 1.0 { 0.025 } else { 0.02 };
            assert!(found <= bound, "{ratio}:1 on {plane:?} at {size}: {found}");
        }
    }
}

#[test]
fn local_deviations_beat_one_variance_per_footprint() {
    for claim in &CLAIMS {
        let json = claim.json();
        for (size, local, quad) in [(0.02, 0.01, 0.005), (0.1, 0.1, 0.02)] {
            let methods = [Method::Ensemble, Method::Local, Method::Quad];
            let found = errors(&json, (size, 1.0), (true, 0.0), &methods);
            println!("{} {size}: {found:?}", claim.kernel);
            let kernel = claim.kernel;
            assert!(
                found[0][1] > 0.2,
                "{kernel} {size}: ensemble {:?}",
                found[0]
            );
            assert!(
                found[1][1] <= local,
                "{kernel} {size}: local {:?}",
                found[1]
            );
            assert!(found[2][1] <= quad, "{kernel} {size}: quad {:?}", found[2]);
        }
    }
}

#[test]
fn the_variance_that_a_footprint_removes_is_the_ensembles() {
    // The spectra of the window are fitted by Gaussians to 6.6 % of what is removed or left.
    for claim in &CLAIMS {
        let json = claim.json();
        let slack = if claim.kernel == "quintic" {
            0.066
        } else {
            0.0
        };
        for (size, ratio) in [(0.1, 1.0), (0.3, 1.0), (0.3, 4.0), (0.7, 1.0)] {
            let [p, q] = plane(true, 30.0);
            let [major, minor] = [size * f64::sqrt(ratio), size / f64::sqrt(ratio)];
            let axes = [p.map(|x| x * major), q.map(|x| x * minor)];
            let places: Vec<_> = apart(2000).into_iter().map(|p| sized(p, axes)).collect();
            let n = places.len() as f64;
            let values = evaluate(&json, Method::Ensemble, &places);
            let left = values.iter().map(|v| v[0] * v[0]).sum::<f64>() / n;
            let removed = values[0][1];
            // The variance of the mean square is about 2/n where the noise is Gaussian.
            let error = left * (2.0 / n).sqrt();
            assert!(
                (left + removed - 1.0).abs() <= 4.5 * error + slack * removed.min(1.0 - removed),
                "{} {size} {ratio}:1: {left} + {removed}",
                claim.kernel
            );
        }
    }
}

/// Independent places: far enough apart that no two share a lattice point, at fractions that fill
/// the cell evenly.
fn apart(count: usize) -> Vec<Position> {
    (0..count)
        .map(|i| {
            let steps = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
            let cells = [7 * (i % 50), 7 * (i / 50 % 50), 7 * (i / 2500)];
            let place = [0, 1, 2].map(|k| cells[k] as f64 + (i as f64 * steps[k]).fract());
            at(place, [[0.0; 3]; 2])
        })
        .collect()
}

/// A position with the footprint of these axes.
fn sized(position: Position, [dx, dy]: [[f64; 3]; 2]) -> Position {
    Position {
        dx: dx.map(|x| x as f32),
        dy: dy.map(|x| x as f32),
        ..position
    }
}

#[test]
fn mean_variance_and_distribution_are_the_stated_ones() {
    // Three tests for each of two noises: at 4.5 standard errors, and Kolmogorov's bound at 1e-5, a
    // false alarm of all is below 5e-5.
    for claim in &CLAIMS {
        let kernel = claim.kernel;
        let mut values: Vec<f64> = evaluate(&claim.json(), Method::Point, &apart(60_000))
            .iter()
            .map(|v| v[0])
            .collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        assert!(mean.abs() <= 4.5 / n.sqrt(), "{kernel}: mean {mean}");
        let moment = |k| values.iter().map(|v| v.powi(k)).sum::<f64>() / n;
        let (variance, fourth) = (moment(2), moment(4));
        let error = ((fourth - variance * variance) / n).sqrt();
        assert!(
            (variance - 1.0).abs() <= 4.5 * error,
            "{kernel}: variance {variance} ± {error}"
        );
        values.sort_by(f64::total_cmp);
        let (least, most) = (values[0], values[values.len() - 1]);
        println!("{kernel}: {least} to {most}");
        assert!(
            least.abs().max(most) <= claim.extent,
            "{kernel}: {least} to {most}"
        );
        let distances = (0..values.len())
            .step_by(100)
            .map(|i| (phi(values[i]) - (i as f64 + 0.5) / n).abs());
        let worst = distances.fold(0.0, f64::max);
        println!("{kernel}: deviation {worst}");
        assert!(
            worst <= claim.deviation + 2.47 / n.sqrt(),
            "{kernel}: deviation {worst}"
        );
    }
}

#[test]
fn a_footprint_of_nothing_gives_the_point() {
    let places = apart(300);
    for kernel in ["gaussian", "quintic"] {
        for period in [0, 3] {
            let json = graph(&format!(
                r#"{{"type":"fractal3d","inputs":{{"octaves":2.5,"kernel":"{kernel}","period":{period}}}}}"#
            ));
            let points = evaluate(&json, Method::Point, &places);
            for method in [Method::Naive, Method::Local, Method::Quad] {
                for (found, point) in evaluate(&json, method, &places).iter().zip(&points) {
                    assert!((found[0] - point[0]).abs() < 1e-6, "{kernel} {method}");
                    assert!(found[1] <= 1e-9, "{kernel} {method}: variance {}", found[1]);
                }
            }
        }
    }
}

#[test]
fn a_period_repeats_to_the_bit_and_no_sooner() {
    for (node, period) in [
        (r#"{"type":"noise3d","inputs":{"period":1}}"#, 1),
        (r#"{"type":"noise3d","inputs":{"period":5}}"#, 5),
        (
            r#"{"type":"noise3d","inputs":{"period":4,"kernel":"quintic"}}"#,
            4,
        ),
        (
            r#"{"type":"fractal3d","inputs":{"period":3,"octaves":2.5}}"#,
            3,
        ),
        (
            r#"{"type":"fractal3d","inputs":{"period":4,"octaves":3,"lacunarity":1.5,"kernel":"quintic"}}"#,
            4,
        ),
    ] {
        let json = graph(node);
        let places: Vec<_> = (apart(160).into_iter().enumerate())
            .map(|(i, mut place)| {
                place.cell = place.cell.map(|cell| cell % 9 - 4);
                let size = 0.004 * 2f64.powi((i % 9) as i32);
                let [p, q] = plane(true, 17.0 * i as f64);
                sized(place, [p.map(|x| x * size), q.map(|x| 5.0 * x * size)])
            })
            .collect();
        let moved = |turns: [i32; 3]| -> Vec<Position> {
            (places.iter())
                .map(|place| Position {
                    cell: [0, 1, 2].map(|k| place.cell[k] + turns[k]),
                    ..*place
                })
                .collect()
        };
        for method in [Method::Point, Method::Local, Method::Quad] {
            let here = evaluate(&json, method, &places);
            for turns in [
                [1, 0, 0],
                [0, -1, 0],
                [0, 0, 2],
                [-3, 2, 1],
                [100_000, -100_000, 7],
            ] {
                let there = evaluate(&json, method, &moved(turns.map(|n| n * period)));
                assert_eq!(here, there, "{node} by {method} after {turns:?} periods");
            }
        }
        if period > 1 {
            let here = evaluate(&json, Method::Point, &places);
            let there = evaluate(&json, Method::Point, &moved([0, period - 1, 0]));
            let square: f64 = (here.iter().zip(&there))
                .map(|(a, b)| (a[0] - b[0]).powi(2))
                .sum();
            let rms = (square / here.len() as f64).sqrt();
            // Two independent noises of standard deviation ¼ and more differ by √2/4 and more.
            assert!(rms > 0.28, "{node}: {rms}");
        }
    }
}

#[test]
fn a_period_that_an_octave_cannot_have_is_refused_where_it_stands() {
    let node = r#"{"type":"fractal3d","inputs":{"period":3,"lacunarity":2.5,"octaves":2}}"#;
    let specs = mipless_nodes::specs();
    let graph = load(&graph(node), &specs).graph.expect("resolves");
    let diagnostics = check(graph, &CheckOptions::default()).expect_err("does not fit");
    assert_eq!(diagnostics[0].code, "inputs-disagree");
    assert_eq!(
        diagnostics[0].pointer.as_deref(),
        Some("/nodes/n/inputs/period")
    );
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

#[test]
fn cells_are_filtered_as_those_of_a_plane() {
    let json = graph(r#"{"type":"cellnoise3d"}"#);
    let deviation = (1.0f64 / 12.0).sqrt();
    for (ratio, plane, bounds) in [
        (1.0, (false, 0.0), [0.025, 0.02]),
        (1.0, (true, 0.0), [0.025, 0.02]),
        (8.0, (false, 0.0), [0.04, 0.03]),
        (8.0, (true, 20.0), [0.04, 0.03]),
        (8.0, (true, 75.0), [0.04, 0.03]),
    ] {
        for size in [0.1, 0.3, 1.0] {
            let methods = [Method::Local, Method::Quad];
            for found in errors_by(&json, (size, ratio), plane, &methods, 5.0) {
                println!("{ratio}:1 on {plane:?} at {size}: {found:.4?}");
                assert!(
                    found[0] < bounds[0] * deviation && found[1] < bounds[1],
                    "{ratio}:1 on {plane:?} at {size}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn a_surface_at_0_lies_in_one_layer_of_cells() {
    let json = graph(r#"{"type":"cellnoise3d"}"#);
    let axes = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0]];
    let pixels: Vec<Position> = (positions(200).iter())
        .map(|&[x, y, _]| at([x, y, 0.0], axes))
        .collect();
    let points = evaluate(&json, Method::Point, &pixels);
    for method in [Method::Local, Method::Quad] {
        let found = evaluate(&json, method, &pixels);
        let off = |(found, point): &(&[f64; 2], &[f64; 2])| (found[0] - point[0]).abs() > 1e-3;
        // Within 2.8 σ of an edge along either axis lies a place in nine.
        let count = found.iter().zip(&points).filter(off).count();
        assert!(count < 45, "{count} of 200 by {method}");
    }
}

#[test]
fn cells_are_uniform_and_repeat() {
    let flat = [[0.0; 3]; 2];
    let at_all = |places: &[[f64; 3]], axes| -> Vec<Position> {
        places.iter().map(|&p| at(p, axes)).collect()
    };
    let places: Vec<_> = positions(4000).iter().map(|p| p.map(|x| 3.0 * x)).collect();
    let json = graph(r#"{"type":"cellnoise3d"}"#);
    let mut values: Vec<f64> = (evaluate(&json, Method::Point, &at_all(&places, flat)).iter())
        .map(|v| v[0])
        .collect();
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let off = |(i, x): (usize, &f64)| (x - (i as f64 + 0.5) / n).abs();
    let distance = values.iter().enumerate().map(off).fold(0.0, f64::max);
    // Kolmogorov's 1.95/√n, at a level of 1e-3.
    assert!(distance < 1.95 / n.sqrt(), "{distance}");
    let json = graph(r#"{"type":"cellnoise3d","inputs":{"period":5}}"#);
    let axes = plane(true, 30.0).map(|axis| axis.map(|x| 0.3 * x));
    let of = |offset: f64| {
        let moved: Vec<_> = (positions(40).iter())
            .map(|p| [p[0] + offset, p[1] - offset, p[2] + 2.0 * offset])
            .collect();
        evaluate(&json, Method::Local, &at_all(&moved, axes))
    };
    for (a, b) in of(0.0).iter().zip(of(1_000_000.0)) {
        assert!(
            (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4,
            "{a:?} {b:?}"
        );
    }
}
