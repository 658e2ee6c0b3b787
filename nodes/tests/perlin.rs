//! The noises with the quintic window against dense numerical truth.

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

fn at(p: [f64; 2], [du, dv]: [[f64; 2]; 2]) -> Footprint {
    Footprint {
        cell: p.map(|x| x.floor() as i32),
        uv: p.map(|x| (x - x.floor()) as f32),
        du: du.map(|x| x as f32),
        dv: dv.map(|x| x as f32),
    }
}

/// A small deterministic stream of positions.
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
fn truth(json: &str, p: [f64; 2], axes: [[f64; 2]; 2]) -> [f64; 2] {
    // Six points a cell and never fewer than 4 a standard deviation.
    let counts = axes.map(|axis| {
        let cells = 9.0 * (axis[0].powi(2) + axis[1].powi(2)).sqrt();
        ((6.0 * cells) as usize).clamp(36, 500)
    });
    let mut weights = Vec::new();
    let mut footprints = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let z = [0, 1].map(|k| 9.0 * ([i, j][k] as f64 + 0.5) / counts[k] as f64 - 4.5);
            weights.push((-0.5 * (z[0] * z[0] + z[1] * z[1])).exp());
            footprints.push(at(
                [0, 1].map(|k| p[k] + axes[0][k] * z[0] + axes[1][k] * z[1]),
                [[0.0; 2]; 2],
            ));
        }
    }
    let values = evaluate(json, Method::Point, &footprints);
    let total: f64 = weights.iter().sum();
    let pairs = || values.iter().zip(&weights);
    let mean = pairs().map(|(v, w)| v[0] * w).sum::<f64>() / total;
    let variance = pairs().map(|(v, w)| (v[0] - mean).powi(2) * w).sum::<f64>() / total;
    [mean, variance]
}

/// Variance 1.
const PERLIN: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"noise2d","inputs":{"amplitude":4,"kernel":"quintic"}}},"outputs":{"out":{"node":"n"}}}"#;
const VALUE: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"valuenoise2d","inputs":{"amplitude":4.42103,"pivot":0}}},"outputs":{"out":{"node":"n"}}}"#;

/// Root mean square error of the mean, and the mean error of the standard deviation relative to it,
/// for each method.
fn errors(json: &str, minor: f64, ratio: f64, degrees: f64, methods: &[Method]) -> Vec<[f64; 2]> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let major = minor * ratio;
    let axes = [[major * cos, major * sin], [-minor * sin, minor * cos]];
    let places = positions(24);
    let footprints: Vec<Footprint> = places.iter().map(|&p| at(p, axes)).collect();
    let truths: Vec<[f64; 2]> = places.iter().map(|&p| truth(json, p, axes)).collect();
    let n = places.len() as f64;
    let sd = truths.iter().map(|t| t[1].sqrt()).sum::<f64>() / n;
    (methods.iter())
        .map(|&method| {
            let values = evaluate(json, method, &footprints);
            let pairs = || values.iter().zip(&truths);
            let mean = pairs().map(|(v, t)| (v[0] - t[0]).powi(2)).sum::<f64>() / n;
            let off = pairs()
                .map(|(v, t)| (v[1].sqrt() - t[1].sqrt()).abs())
                .sum::<f64>()
                / n;
            [mean.sqrt(), off / sd]
        })
        .collect()
}

/// The sizes (the geometric mean of the two standard deviations, in cells) and shapes at which the
/// filtered mean is held.
const SIZES: [f64; 11] = [0.01, 0.03, 0.06, 0.12, 0.2, 0.4, 0.75, 1.2, 2.0, 3.4, 6.3];
const SHAPES: [(f64, f64); 4] = [(1.0, 0.0), (8.0, 0.0), (8.0, 20.0), (8.0, 45.0)];

fn hold_means(name: &str, json: &str, round: f64, long: f64) {
    for (ratio, degrees) in SHAPES {
        for size in SIZES {
            let minor = size / f64::sqrt(ratio);
            let found = errors(json, minor, ratio, degrees, &[Method::Local])[0][0];
            let bound = if ratio > 1.0 { long } else { round };
            println!("{name} {ratio}:1 at {degrees}° at {size}: {found:.4}");
            assert!(
                found <= bound,
                "{name} at {size}, {ratio}:1 at {degrees}°: {found}"
            );
        }
    }
}

#[test]
fn filtered_means_of_perlin_noise_are_those_of_dense_integration() {
    hold_means("noise2d quintic", PERLIN, 0.035, 0.025);
}

/// Variance 1: MaterialX's standard deviation is 0.3191 amplitude.
const MATERIALX: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"noise2d","inputs":{"amplitude":3.1336,"hash":"materialx"}}},"outputs":{"out":{"node":"n"}}}"#;

/// MaterialX's gradients are another set of the same second moments: the filter is that of the
/// quintic kernel, with the same bounds.
#[test]
fn filtered_means_of_materialx_noise_are_those_of_dense_integration() {
    for (ratio, degrees) in [SHAPES[0], SHAPES[2]] {
        for size in [0.03, 0.12, 0.4, 1.2] {
            let minor = size / f64::sqrt(ratio);
            let methods = [Method::Local, Method::Quad];
            let found = errors(MATERIALX, minor, ratio, degrees, &methods);
            println!("{ratio}:1 at {degrees}° at {size}: {found:.4?}");
            let bound = if ratio > 1.0 { 0.025 } else { 0.035 };
            assert!(found[0][0] <= bound, "{size}, {ratio}:1: {found:?}");
        }
    }
}

#[test]
fn filtered_means_of_value_noise_are_those_of_dense_integration() {
    hold_means("valuenoise2d", VALUE, 0.018, 0.018);
}

#[test]
fn local_deviations_beat_one_variance_per_footprint() {
    for (name, json) in [("noise2d quintic", PERLIN), ("valuenoise2d", VALUE)] {
        for (size, local, quad) in [(0.01, 0.01, 0.001), (0.03, 0.03, 0.003), (0.1, 0.1, 0.04)] {
            let methods = [Method::Ensemble, Method::Local, Method::Quad];
            let found = errors(json, size, 1.0, 0.0, &methods);
            assert!(found[0][1] > 0.2, "{name} at {size}: {:?}", found[0]);
            assert!(found[1][1] <= local, "{name} at {size}: {:?}", found[1]);
            assert!(found[2][1] <= quad, "{name} at {size}: {:?}", found[2]);
        }
    }
}

/// Independent places: far enough apart that no two share a lattice point, at fractions that fill
/// the cell evenly.
fn apart(count: usize) -> Vec<Footprint> {
    (0..count)
        .map(|i| {
            let fraction = [0.754_877_666, 0.569_840_29].map(|step| (i as f64 * step).fract());
            let cell = [5 * (i % 300), 5 * (i / 300)].map(|c| c as f64);
            at([0, 1].map(|k| cell[k] + fraction[k]), [[0.0; 2]; 2])
        })
        .collect()
}

#[test]
fn mean_variance_and_range_are_the_stated_ones() {
    // Two tests for each of two noises: at 4.5 standard errors a false alarm of all is below 3e-5.
    let places = apart(60_000);
    for (name, json, extent) in [("perlin", PERLIN, 3.4), ("value", VALUE, 2.2107)] {
        let values = evaluate(json, Method::Point, &places);
        let n = values.len() as f64;
        let mean = values.iter().map(|v| v[0]).sum::<f64>() / n;
        assert!(mean.abs() <= 4.5 / n.sqrt(), "{name}: mean {mean}");
        let squares = values.iter().map(|v| v[0] * v[0]).sum::<f64>() / n;
        let fourth = values.iter().map(|v| v[0].powi(4)).sum::<f64>() / n;
        let error = ((fourth - squares * squares) / n).sqrt();
        assert!(
            (squares - 1.0).abs() <= 4.5 * error,
            "{name}: variance {squares} ± {error}"
        );
        let largest = values.iter().map(|v| v[0].abs()).fold(0.0, f64::max);
        assert!(largest <= extent, "{name}: {largest}");
    }
}

#[test]
fn a_footprint_of_nothing_gives_the_point() {
    for json in [PERLIN, VALUE] {
        let places = apart(500);
        let points = evaluate(json, Method::Point, &places);
        for method in [Method::Naive, Method::Local, Method::Quad] {
            for (found, point) in evaluate(json, method, &places).iter().zip(&points) {
                assert!((found[0] - point[0]).abs() < 1e-6, "{method}");
                assert!(found[1] <= 1e-9, "{method}: variance {}", found[1]);
            }
        }
    }
}

#[test]
fn the_variance_that_a_footprint_removes_is_the_ensembles() {
    // The spectra of the window are fitted by Gaussians to 6.6 % of what is removed or left.
    for json in [PERLIN, VALUE] {
        for (size, ratio) in [(0.1, 1.0), (0.3, 1.0), (0.3, 4.0), (1.0, 1.0)] {
            let [major, minor] = [size * f64::sqrt(ratio), size / f64::sqrt(ratio)];
            let axes = [[0.6 * major, 0.8 * major], [-0.8 * minor, 0.6 * minor]];
            let places = positions(400);
            let n = places.len() as f64;
            let footprints: Vec<_> = places.iter().map(|&p| at(p, axes)).collect();
            let values = evaluate(json, Method::Ensemble, &footprints);
            let left = values.iter().map(|v| v[0] * v[0]).sum::<f64>() / n;
            let removed = values[0][1];
            // 400 places: the variance of the mean square is about 2/400 where the noise is Gaussian.
            let error = left * (2.0 / n).sqrt();
            assert!(
                (left + removed - 1.0).abs() <= 4.5 * error + 0.066 * removed.min(1.0 - removed),
                "{size} {ratio}:1: {left} + {removed}"
            );
        }
    }
}

#[test]
fn fractions_of_octaves_go_smoothly_from_one_count_to_the_next() {
    let json = |octaves: &str| {
        format!(
            r#"{{"version":1,"name":"n","nodes":{{"n":{{"type":"fractal2d","inputs":{{"amplitude":4,"kernel":"quintic","octaves":{octaves}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
        )
    };
    let axes = [[0.1, 0.02], [0.0, 0.05]];
    let footprints: Vec<_> = positions(50).into_iter().map(|p| at(p, axes)).collect();
    let of = |octaves: &str| evaluate(&json(octaves), Method::Quad, &footprints);
    let [two, quarter, three] = ["2", "2.25", "3"].map(of);
    for i in 0..footprints.len() {
        let expected = two[i][0] + 0.25 * (three[i][0] - two[i][0]);
        assert!((quarter[i][0] - expected).abs() < 1e-5);
    }
}

/// Material Maker's value noise, one octave, as its shader computes it in f32.
#[expect(clippy::approx_constant, reason = "3.14 is Material Maker's number")]
fn material_makers([x, y]: [f32; 2], size: [f32; 2], seed: f32) -> f32 {
    let number = |[x, y]: [f32; 2], [a, b]: [f32; 2]| {
        let phase = x * a + y * b;
        let phase = phase - 3.14 * (phase / 3.14).floor();
        (phase.cos() * 43_758.5).rem_euclid(1.0)
    };
    let (first, second) = ([13.9898, 8.141], [3.4562, 17.398]);
    let start = [seed, 1.0 - seed];
    let start = [number(start, first), number(start, second)];
    let cell = [x.floor(), y.floor()];
    let corner = |i: f32, j: f32| {
        let place = [
            (cell[0] + i).rem_euclid(size[0]) + start[0],
            (cell[1] + j).rem_euclid(size[1]) + start[1],
        ];
        number(place, first)
    };
    let fade = |t: f32| t * t * (3.0 - 2.0 * t);
    let (s, t) = (fade(x - cell[0]), fade(y - cell[1]));
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(
        mix(corner(0.0, 0.0), corner(1.0, 0.0), s),
        mix(corner(0.0, 1.0), corner(1.0, 1.0), s),
        t,
    )
}

#[test]
fn the_hash_of_material_maker_gives_its_values_with_a_period_for_each_axis() {
    for (seed, size) in [
        (0, [4, 4]),
        (1_234, [3, 7]),
        (-27_810, [16, 5]),
        (65_535, [1, 2]),
    ] {
        let json = format!(
            r#"{{"version":1,"name":"n","nodes":{{"n":{{"type":"valuenoise2d","inputs":{{"hash":"materialmaker","seed":{seed},
               "period":{},"period_v":{}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#,
            size[0], size[1]
        );
        let places: Vec<[f64; 2]> = (positions(400).into_iter())
            .map(|[x, y]| [x - 20.0, y - 20.0])
            .collect();
        let footprints: Vec<Footprint> = places.iter().map(|&p| at(p, [[0.0; 2]; 2])).collect();
        let catalogue = mipless_nodes::catalogue();
        let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
        let graph = load(&json, &specs).graph.expect("resolves");
        let checked = check(graph, &CheckOptions::default()).expect("checks");
        let options = Options {
            method: Method::Point,
            ..Options::default()
        };
        let program = compile(&checked, catalogue, &options);
        let values = &eval_program::<f32>(&program, &footprints, &[])[0];
        let mut off: Vec<f32> = (places.iter().zip(values))
            .map(|(&[x, y], value)| {
                let wanted =
                    material_makers([x as f32, y as f32], size.map(|n| n as f32), seed as f32);
                (wanted - value).abs()
            })
            .collect();
        off.sort_by(f32::total_cmp);
        println!("{seed} {size:?}: {:?} {:?}", off[200], off[395]);
        assert!(off[395] <= 0.005, "{seed} {size:?}: {}", off[395]);
    }
}

/// Variance 1: the standard deviation of the cubic window's noise is 0.2144 amplitude.
const CUBIC: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"valuenoise2d","inputs":{"hash":"materialmaker","amplitude":4.6632,"pivot":0}}},"outputs":{"out":{"node":"n"}}}"#;

#[test]
fn filtered_means_of_material_makers_noise_are_those_of_dense_integration() {
    for (ratio, degrees) in [SHAPES[0], SHAPES[2]] {
        for size in [0.01, 0.03, 0.06, 0.12, 0.4, 1.2, 3.4] {
            let minor = size / f64::sqrt(ratio);
            let methods = [Method::Local, Method::Quad];
            let found = errors(CUBIC, minor, ratio, degrees, &methods);
            println!("{ratio}:1 at {degrees}° at {size}: {found:.4?}");
            assert!(found[0][0] <= 0.035, "{size}, {ratio}:1: {found:?}");
        }
    }
}
