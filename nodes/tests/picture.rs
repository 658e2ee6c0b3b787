//! Pictures and textures by example against dense numerical truth.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, Class, Picture, check, load};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Texels of a side of the picture.
const SIDE: usize = 72;

/// Three correlated channels of waves from 9 to 36 texels long; 72 is no power of two.
fn picture() -> Picture {
    let number = |i: usize, channel: usize| {
        let (x, y) = (
            (i % SIDE) as f64 / SIDE as f64,
            (i / SIDE) as f64 / SIDE as f64,
        );
        let wave = |p: f64, q: f64, phase: f64| (TAU * (p * x + q * y + phase)).sin();
        let waves = [
            wave(2.0, 0.0, 0.1) + wave(5.0, 5.0, 0.7) + wave(-3.0, 7.0, 0.3),
            wave(2.0, 1.0, 0.4) + wave(5.0, 5.0, 0.6) + wave(8.0, 0.0, 0.9),
            wave(0.0, 3.0, 0.2) - wave(-3.0, 7.0, 0.3) + wave(4.0, -4.0, 0.5),
        ];
        (0.5 + 0.12 * waves[channel]) as f32
    };
    let numbers = (0..3 * SIDE * SIDE).map(|i| number(i / 3, i % 3));
    Picture::new((SIDE as u32, SIDE as u32), 3, false, numbers.collect())
}

/// The colour of a node and what a combination of its channels, (r − g)/√2, makes of their
/// covariance: means, then variances.
fn graph(node: &str) -> String {
    format!(
        r#"{{ "version": 1, "name": "test", "nodes": {{
            "source": {node},
            "r": {{ "type": "extract", "inputs": {{ "in": {{ "node": "source" }}, "index": 0 }} }},
            "g": {{ "type": "extract", "inputs": {{ "in": {{ "node": "source" }}, "index": 1 }} }},
            "difference": {{ "type": "subtract", "inputs": {{ "in1": {{ "node": "r" }}, "in2": {{ "node": "g" }} }} }}
        }}, "outputs": {{ "color": {{ "node": "source" }}, "difference": {{ "node": "difference" }} }} }}"#
    )
}

fn evaluate(json: &str, method: Method, filter: PixelFilter, at: &[Footprint]) -> Vec<Vec<f64>> {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(json, &specs);
    let mut graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    for file in &loaded.files {
        graph.images.insert(&*file.name, Arc::new(picture()));
    }
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter,
        moments: true,
        seed: 0,
    };
    eval_program::<f64>(&compile(&checked, catalogue, &options), at, &[])
}

fn footprint([x, y]: [f64; 2], axes: [[f64; 2]; 2]) -> Footprint {
    Footprint {
        cell: [x.floor() as i32, y.floor() as i32],
        uv: [x, y].map(|x| (x - x.floor()) as f32),
        du: axes[0].map(|x| x as f32),
        dv: axes[1].map(|x| x as f32),
    }
}

fn places(count: usize) -> Vec<[f64; 2]> {
    (0..count)
        .map(|i| {
            let i = i as f64;
            [
                (i * 0.754_877_666).fract() * 9.0 - 4.0,
                (i * 0.569_840_29).fract() * 9.0 - 4.0,
            ]
        })
        .collect()
}

/// Axes of a footprint: σ texels wide, so many times as long, turned by an angle in degrees.
fn axes(sigma: f64, ratio: f64, degrees: f64) -> [[f64; 2]; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let (long, wide) = (ratio * sigma / SIDE as f64, sigma / SIDE as f64);
    [[long * cosine, long * sine], [-wide * sine, wide * cosine]]
}

/// Means and variances of the four numbers over footprints of a unit Gaussian filter, densely.
fn truth(json: &str, at: [f64; 2], axes: [[f64; 2]; 2], sides: [usize; 2]) -> Vec<f64> {
    let mut weights = Vec::new();
    let mut points = Vec::new();
    for i in 0..sides[0] {
        for j in 0..sides[1] {
            let z = [(i, sides[0]), (j, sides[1])]
                .map(|(k, n)| 9.0 * (k as f64 + 0.5) / n as f64 - 4.5);
            weights.push((-0.5 * (z[0] * z[0] + z[1] * z[1])).exp());
            let p = [0, 1].map(|k| at[k] + axes[0][k] * z[0] + axes[1][k] * z[1]);
            points.push(footprint(p, [[0.0; 2]; 2]));
        }
    }
    let total: f64 = weights.iter().sum();
    let values = evaluate(json, Method::Point, PixelFilter::Gaussian(1.0), &points);
    let of = |channel: usize| {
        let all = values[channel].iter().zip(&weights);
        let mean = all.clone().map(|(v, w)| v * w).sum::<f64>() / total;
        let spread = all.map(|(v, w)| w * (v - mean).powi(2)).sum::<f64>() / total;
        [mean, spread]
    };
    let moments: Vec<[f64; 2]> = (0..4).map(of).collect();
    let (means, variances): (Vec<f64>, Vec<f64>) = moments.iter().map(|m| (m[0], m[1])).unzip();
    [means, variances].concat()
}

/// The mean error of the means in standard deviations of the picture, and of the standard
/// deviations relative to their mean, over the four numbers.
fn errors(json: &str, shape: [[f64; 2]; 2], sides: [usize; 2], count: usize) -> [f64; 2] {
    let at = places(count);
    let footprints: Vec<Footprint> = at.iter().map(|&p| footprint(p, shape)).collect();
    let found = evaluate(json, Method::Local, PixelFilter::Gaussian(1.0), &footprints);
    let (mut of_mean, mut of_sd, mut sd) = (0.0, 0.0, 0.0);
    for (i, &p) in at.iter().enumerate() {
        let wanted = truth(json, p, shape, sides);
        for k in 0..4 {
            of_mean += (found[k][i] - wanted[k]).abs();
            let (a, b) = (found[4 + k][i].sqrt(), wanted[4 + k].sqrt());
            of_sd += (a - b).abs();
            sd += b;
        }
    }
    // Three waves of 0.12 have this standard deviation.
    let own = 0.12 * 1.5f64.sqrt();
    [of_mean / (4.0 * count as f64) / own, of_sd / sd]
}

const IMAGE: &str = r#"{ "type": "image", "inputs": { "file": "a.exr" } }"#;

#[test]
fn pictures_know_their_moments() {
    let json = graph(IMAGE);
    for (ratio, degrees) in [(1.0, 0.0), (8.0, 0.0), (8.0, 20.0), (8.0, 45.0)] {
        for sigma in [0.2, 0.4, 0.8, 1.5, 3.0, 6.0, 12.0, 20.0] {
            if ratio * sigma > 40.0 {
                continue;
            }
            let step = 0.33f64.max(sigma / 6.0);
            let sides = [
                (9.0 * sigma * ratio / step) as usize + 9,
                (9.0 * sigma / step) as usize + 9,
            ];
            let [mean, sd] = errors(&json, axes(sigma, ratio, degrees), sides, 24);
            println!("{ratio}:1 at {degrees}°, σ = {sigma}: mean {mean:.4}, sd {sd:.4}");
            let most = if ratio > 1.0 { 0.06 } else { 0.02 };
            assert!(
                mean < most,
                "{ratio}:1 at {degrees}°, σ = {sigma}: mean {mean}"
            );
            assert!(sd < 0.08, "{ratio}:1 at {degrees}°, σ = {sigma}: sd {sd}");
        }
    }
}

#[test]
fn edges_are_clamped_or_mirrored_at_every_footprint() {
    for mode in ["clamp", "mirror"] {
        let node = IMAGE.replace(
            "\"a.exr\"",
            &format!("\"a.exr\", \"uaddressmode\": \"{mode}\", \"vaddressmode\": \"{mode}\""),
        );
        let json = graph(&node);
        for sigma in [0.0, 0.5, 2.0, 7.0] {
            // At an edge, at a corner, outside, inside.
            for p in [
                [0.01, 0.4],
                [1.02, 0.99],
                [-0.2, 0.3],
                [1.3, -0.4],
                [0.4, 0.6],
            ] {
                let shape = axes(sigma, 1.0, 0.0);
                let wanted = truth(&json, p, shape, [41, 41]);
                let footprints = [footprint(p, shape)];
                let found = evaluate(
                    &json,
                    Method::Local,
                    PixelFilter::Gaussian(1.0),
                    &footprints,
                );
                for k in 0..8 {
                    let (found, wanted) = (found[k][0], wanted[k]);
                    let error = if k < 4 {
                        found - wanted
                    } else {
                        found.sqrt() - wanted.sqrt()
                    };
                    assert!(
                        error.abs() < 0.02,
                        "{mode} at {p:?}, σ = {sigma}, {k}: {found} for {wanted}"
                    );
                }
            }
        }
    }
}

#[test]
fn far_fields_are_those_of_the_picture() {
    let example = r#"{ "type": "byexample", "inputs": { "file": "a.exr" } }"#;
    for (node, tolerance) in [(IMAGE, 1e-6), (example, 0.02)] {
        let json = graph(node);
        for method in [Method::Ensemble, Method::Local, Method::Quad] {
            let wide = [footprint([0.3, 0.4], axes(1e5, 1.0, 0.0))];
            let found = evaluate(&json, method, PixelFilter::Gaussian(1.0), &wide);
            for k in 0..3 {
                let (mean, sd) = (found[k][0], found[4 + k][0].sqrt());
                assert!(
                    (mean - 0.5).abs() < tolerance,
                    "{node} {method}: mean {mean}"
                );
                // Between texels a picture varies less than at them.
                assert!((sd - 0.147).abs() < 0.004, "{node} {method}: sd {sd}");
            }
        }
    }
}

#[test]
fn a_period_repeats_and_another_seed_does_not() {
    let of = |more: &str, places: &[[f64; 2]]| {
        let node = format!(r#"{{ "type": "byexample", "inputs": {{ "file": "a.exr"{more} }} }}"#);
        let at: Vec<Footprint> = places
            .iter()
            .map(|&p| footprint(p, [[0.0; 2]; 2]))
            .collect();
        evaluate(
            &graph(&node),
            Method::Point,
            PixelFilter::Gaussian(1.0),
            &at,
        )[0]
        .clone()
    };
    let here = places(40);
    let moved: Vec<[f64; 2]> = here.iter().map(|[x, y]| [x + 6.0, y - 6.0]).collect();
    let far = |a: &[f64], b: &[f64]| -> f64 {
        let differences = a.iter().zip(b).map(|(x, y)| (x - y).abs());
        differences.fold(0.0, f64::max)
    };
    let periodic = r#", "period": [3, 2]"#;
    assert!(far(&of(periodic, &here), &of(periodic, &moved)) < 1e-5);
    assert!(far(&of("", &here), &of("", &moved)) > 0.1);
    let other = r#", "seed": 8"#;
    assert!(far(&of("", &here), &of(other, &here)) > 0.1);
}

#[test]
fn textures_by_example_know_their_moments() {
    let json = graph(r#"{ "type": "byexample", "inputs": { "file": "a.exr" } }"#);
    for (ratio, degrees, sigma) in [
        (1.0, 0.0, 0.3),
        (1.0, 0.0, 1.0),
        (1.0, 0.0, 3.0),
        (1.0, 0.0, 10.0),
        (5.0, 20.0, 1.0),
        (5.0, 45.0, 3.0),
    ] {
        let sides = [40.max((3.0 * ratio * sigma) as usize), 40];
        let [mean, sd] = errors(&json, axes(sigma, ratio, degrees), sides, 40);
        println!("{ratio}:1 at {degrees}°, σ = {sigma}: mean {mean:.4}, sd {sd:.4}");
        assert!(
            mean < 0.1,
            "{ratio}:1 at {degrees}°, σ = {sigma}: mean {mean}"
        );
        assert!(sd < 0.15, "{ratio}:1 at {degrees}°, σ = {sigma}: sd {sd}");
    }
}

/// The values of `byexample` in one channel, at independent places.
fn sample(json: &str, count: usize) -> Vec<f64> {
    let at: Vec<_> = (0..count)
        .map(|i| {
            let fraction = [0.754_877_666, 0.569_840_29].map(|step| (i as f64 * step).fract());
            let place = [3 * (i % 200), 3 * (i / 200)].map(|k| k as f64);
            footprint([0, 1].map(|k| place[k] + fraction[k]), [[0.0; 2]; 2])
        })
        .collect();
    evaluate(json, Method::Point, PixelFilter::Gaussian(1.0), &at)[0].clone()
}

#[test]
fn the_check_states_how_far_an_example_is_from_a_gaussian() {
    let node = r#"{ "type": "byexample", "inputs": { "file": "a.png", "signature": "float" } }"#;
    let json = format!(
        r#"{{ "version": 1, "name": "test", "nodes": {{ "n": {node} }}, "outputs": {{ "out": {{ "node": "n" }} }} }}"#
    );
    let specs = mipless_nodes::specs();
    let mut graph = load(&json, &specs).graph.expect("loads");
    graph.images.insert("a.png", Arc::new(picture()));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let Class::Moments { deviation } = checked.signals().last().expect("a signal").class else {
        panic!("an example is not Gaussian");
    };
    let deviation = f64::from(deviation);
    assert!((0.005..0.2).contains(&deviation), "{deviation}");
    // The texture has the example's mean, variance and histogram: three tests, at 4.5 standard
    // errors and Kolmogorov's bound at 1e-5.
    let mut values = sample(&json, 40_000);
    let numbers = picture();
    let texels: Vec<f64> = (numbers.numbers().chunks_exact(3))
        .map(|texel| f64::from(texel[0]))
        .collect();
    let moments = |of: &[f64]| {
        let n = of.len() as f64;
        let mean = of.iter().sum::<f64>() / n;
        let power = |k| of.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / n;
        [mean, power(2), power(4)]
    };
    let ([mean, variance, _], [found, square, fourth]) = (moments(&texels), moments(&values));
    let n = values.len() as f64;
    assert!(
        (found - mean).abs() <= 4.5 * (square / n).sqrt() + 1e-3,
        "{found}, not {mean}"
    );
    let error = ((fourth - square * square) / n).sqrt();
    // Interpolation between texels removes 2 % of the variance.
    assert!(
        (square - variance).abs() <= 4.5 * error + 0.03 * variance,
        "{square}, not {variance}"
    );
    values.sort_by(f64::total_cmp);
    let worst = (values.iter().enumerate())
        .map(|(i, x)| (normal((x - found) / square.sqrt()) - (i as f64 + 0.5) / n).abs())
        .fold(0.0, f64::max);
    println!("{deviation} {worst}");
    assert!(
        (worst - deviation).abs() <= 2.47 / n.sqrt() + 0.01,
        "{worst}, not {deviation}"
    );
}

/// Φ by Simpson's rule.
fn normal(z: f64) -> f64 {
    let n = 200;
    let h = z / f64::from(n);
    let f = |x: f64| (-0.5 * x * x).exp();
    let sum: f64 = (0..n)
        .map(|i| {
            let x = f64::from(i) * h;
            f(x) + 4.0 * f(x + 0.5 * h) + f(x + h)
        })
        .sum();
    0.5 + sum * h / 6.0 / TAU.sqrt()
}
