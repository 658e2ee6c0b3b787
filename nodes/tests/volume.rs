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

/// Means and variances of the point function over footprints, on a grid of ±4.2σ.
fn truths(json: &str, places: &[[f64; 3]], axes: [[f64; 3]; 2]) -> Vec<[f64; 2]> {
    let length = |axis: [f64; 3]| axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Five points a cell and never fewer than 4 a standard deviation.
    let counts = axes.map(|axis| ((5.0 * 8.4 * length(axis)) as usize).clamp(34, 400));
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

/// Variance 1.
const NOISE: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"noise3d","inputs":{"amplitude":4}}},"outputs":{"out":{"node":"n"}}}"#;

/// Root mean square error of the mean, and the mean error of the standard deviation relative to it,
/// for each method; `size` is the geometric mean of the two standard deviations, in cells.
fn errors(
    size: f64,
    ratio: f64,
    (askew, degrees): (bool, f64),
    methods: &[Method],
) -> Vec<[f64; 2]> {
    let [p, q] = plane(askew, degrees);
    let [major, minor] = [size * ratio.sqrt(), size / ratio.sqrt()];
    let axes = [p.map(|x| x * major), q.map(|x| x * minor)];
    let places = positions(20);
    let pixels: Vec<_> = places.iter().map(|&p| at(p, axes)).collect();
    let truths = truths(NOISE, &places, axes);
    let n = places.len() as f64;
    let sd = truths.iter().map(|t| t[1].sqrt()).sum::<f64>() / n;
    (methods.iter())
        .map(|&method| {
            let values = evaluate(NOISE, method, &pixels);
            let pairs = || values.iter().zip(&truths);
            let mean = pairs().map(|(v, t)| (v[0] - t[0]).powi(2)).sum::<f64>() / n;
            let off = pairs().map(|(v, t)| (v[1].sqrt() - t[1].sqrt()).abs());
            [mean.sqrt(), off.sum::<f64>() / n / sd]
        })
        .collect()
}

#[test]
fn filtered_means_are_those_of_dense_integration() {
    for (ratio, plane, bound) in [
        (1.0, (false, 0.0), 0.03),
        (1.0, (true, 0.0), 0.03),
        (8.0, (false, 0.0), 0.05),
        (8.0, (true, 20.0), 0.05),
        (8.0, (true, 75.0), 0.05),
    ] {
        for size in [0.02, 0.1, 0.2, 0.4, 0.7, 1.0, 1.5, 2.0] {
            let found = errors(size, ratio, plane, &[Method::Local])[0][0];
            assert!(found <= bound, "{ratio}:1 on {plane:?} at {size}: {found}");
        }
    }
}

#[test]
fn local_deviations_beat_one_variance_per_footprint() {
    for (size, local, quad) in [(0.02, 0.01, 0.005), (0.1, 0.1, 0.02)] {
        let methods = [Method::Ensemble, Method::Local, Method::Quad];
        let found = errors(size, 1.0, (true, 0.0), &methods);
        assert!(found[0][1] > 0.2, "{size}: ensemble {:?}", found[0]);
        assert!(found[1][1] <= local, "{size}: local {:?}", found[1]);
        assert!(found[2][1] <= quad, "{size}: quad {:?}", found[2]);
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

#[test]
fn mean_variance_and_distribution_are_the_stated_ones() {
    let mut values: Vec<f64> = evaluate(NOISE, Method::Point, &apart(60_000))
        .iter()
        .map(|v| v[0])
        .collect();
    let n = values.len() as f64;
    // At 4.5 standard errors a false alarm of both is below 2e-5.
    let mean = values.iter().sum::<f64>() / n;
    assert!(mean.abs() <= 4.5 / n.sqrt(), "mean {mean}");
    let moment = |k| values.iter().map(|v| v.powi(k)).sum::<f64>() / n;
    let (variance, fourth) = (moment(2), moment(4));
    let error = ((fourth - variance * variance) / n).sqrt();
    assert!(
        (variance - 1.0).abs() <= 4.5 * error,
        "variance {variance} ± {error}"
    );
    values.sort_by(f64::total_cmp);
    let distances = (0..values.len())
        .step_by(100)
        .map(|i| (phi(values[i]) - (i as f64 + 0.5) / n).abs());
    let worst = distances.fold(0.0, f64::max);
    // Kolmogorov's bound at a level of 1e-4 is 2.2/√n.
    assert!(worst <= 0.004 + 2.2 / n.sqrt(), "deviation {worst}");
}

#[test]
fn a_footprint_of_nothing_gives_the_point() {
    let places = apart(300);
    let json = r#"{"version":1,"name":"n","nodes":{"n":{"type":"fractal3d","inputs":{"octaves":2.5}}},"outputs":{"out":{"node":"n"}}}"#;
    let points = evaluate(json, Method::Point, &places);
    for method in [Method::Naive, Method::Local, Method::Quad] {
        for (found, point) in evaluate(json, method, &places).iter().zip(&points) {
            assert!((found[0] - point[0]).abs() < 1e-6, "{method}");
            assert!(found[1] <= 1e-9, "{method}: variance {}", found[1]);
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
