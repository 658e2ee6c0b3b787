//! No footprint, however extreme, gives anything but finite numbers in the range of the colour map;
//! vanishing footprints give the point value and huge ones the mean of the far field.

use mipless::{Footprint, Literal, Method, Options, Texture};
use mipless_codegen::cpu::eval_program;
use mipless_tests::case::all;
use mipless_tests::random::Random;
use mipless_tests::tolerance::{FAR_FIELD, LEFT_OUT, RANGE, SIGNIFICANCE, VANISHING, p_value};
use mipless_tests::{METHODS, name_of};

/// Methods that filter.
const FILTERS: [Method; 5] = [
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Auto,
    Method::Split(4),
];

fn evaluate(texture: &Texture, method: Method, footprints: &[Footprint]) -> Vec<Vec<f32>> {
    texture
        .evaluator(&Options {
            method,
            moments: true,
            ..Options::default()
        })
        .evaluate(footprints)
}

/// All pairs of extreme positions and extreme footprints.
fn extremes() -> Vec<Footprint> {
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    let places: [([i32; 2], [f32; 2]); 8] = [
        ([0, 0], [0.0, 0.0]),
        ([0, 0], [0.31, 0.77]),
        ([1_000_000, -1_000_000], [0.5, 0.25]),
        ([i32::MAX, i32::MIN], [0.999, 0.0]),
        ([0, 0], [1e6, -1e6]),
        ([3, 4], [1e30, -3e38]),
        ([3, 4], [nan, 0.5]),
        ([3, 4], [0.5, -infinity]),
    ];
    let mut shapes: Vec<([f32; 2], [f32; 2])> = Vec::new();
    for size in [
        0.0, 1e-40, 1e-30, 1e-12, 1e-6, 1e-3, 0.05, 0.4, 2.0, 1e3, 1e9, 1e30, 3e38,
    ] {
        // Round, a line, and a line that is not parallel to an axis.
        shapes.push(([size, 0.0], [0.0, size]));
        shapes.push(([size, 0.0], [0.0, 0.0]));
        shapes.push(([size, -0.7 * size], [-size, 0.7 * size]));
    }
    // A million times longer than wide, straight and turned.
    for length in [1e-3, 1.0, 1e3] {
        let width = 1e-6 * length;
        shapes.push(([length, 0.0], [0.0, width]));
        shapes.push(([0.6 * length, 0.8 * length], [-0.8 * width, 0.6 * width]));
    }
    for odd in [infinity, -infinity, nan] {
        shapes.push(([odd, 0.0], [0.0, odd]));
        shapes.push(([0.1, odd], [0.0, 0.1]));
    }
    (places.iter())
        .flat_map(|&(cell, uv)| {
            shapes
                .iter()
                .map(move |&(du, dv)| Footprint { cell, uv, du, dv })
        })
        .collect()
}

/// For each component of the outputs, in order, the range of the colour map that makes it.
fn ranges(texture: &Texture) -> Vec<Option<[f32; 2]>> {
    let graph = texture.checked().graph();
    (texture.outputs().iter())
        .flat_map(|output| {
            let node = graph.node(output.node);
            let stops = match (node.spec.name, node.inputs.len()) {
                ("colorramp", _) => match node.literal("stops") {
                    Literal::Stops(stops) => Some(stops),
                    other => panic!("{other:?} are no stops"),
                },
                _ => None,
            };
            (0..output.ty.components()).map(move |component| {
                let values = stops?.stops.iter().map(|stop| stop.value[component]);
                let fold = |[low, high]: [f32; 2], x: f32| [low.min(x), high.max(x)];
                Some(values.fold([f32::INFINITY, f32::NEG_INFINITY], fold))
            })
        })
        .collect()
}

#[test]
fn extreme_footprints_give_finite_numbers_in_range() {
    let footprints = extremes();
    let mut failures = Vec::new();
    for case in all() {
        let ranges = ranges(&case.texture);
        for method in METHODS {
            let outputs = evaluate(&case.texture, method, &footprints);
            assert_eq!(outputs.len(), 2 * ranges.len(), "means, then variances");
            for (channel, output) in outputs.iter().enumerate() {
                let [low, high] = match ranges.get(channel).copied().flatten() {
                    Some(range) => range.map(f64::from),
                    None if channel < ranges.len() => [f64::from(f32::MIN), f64::from(f32::MAX)],
                    // A variance.
                    None => [0.0, f64::from(f32::MAX)],
                };
                let slack = |bound: f64| RANGE * bound.abs().max(1.0);
                let mut wrong = output.iter().zip(&footprints).filter(|&(&x, _)| {
                    let x = f64::from(x);
                    let loose = if channel < ranges.len() {
                        slack(low)
                    } else {
                        0.0
                    };
                    !(x >= low - loose && x <= high + slack(high) && x.is_finite())
                });
                if let Some((x, footprint)) = wrong.next() {
                    failures.push(format!(
                        "{} by {method}, channel {channel}: {x} outside [{low}, {high}] at \
                         {footprint:?}, and {} more",
                        case.name,
                        wrong.count()
                    ));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The entry turns what overflows into 0; the function that it calls must not need that.
#[test]
fn what_the_entry_calls_is_finite_by_itself() {
    let regular = |x: &&Footprint| {
        x.uv.iter().all(|u| u.abs() <= 1e6) && x.du.iter().chain(&x.dv).all(|d| d.abs() <= 1e9)
    };
    let footprints: Vec<Footprint> = extremes().iter().filter(regular).copied().collect();
    assert!(footprints.len() > 100);
    for case in all() {
        for method in [
            Method::Point,
            Method::Naive,
            Method::Ensemble,
            Method::Local,
            Method::Quad,
        ] {
            let options = Options {
                method,
                moments: true,
                ..Options::default()
            };
            let mut program = case.texture.compile(&options);
            program.module.functions.pop();
            let called = program.module.entry();
            assert_eq!(called.name, method.to_string());
            let defaults = program
                .interface
                .parameters
                .iter()
                .flat_map(|p| p.default.clone());
            let parameters: Vec<f32> = defaults.collect();
            let outputs = eval_program::<f32>(&program, &footprints, &parameters);
            for (channel, output) in outputs.iter().enumerate() {
                if let Some(lane) = output.iter().position(|x| !x.is_finite()) {
                    let (x, at) = (output[lane], footprints[lane]);
                    panic!(
                        "{} by {method}, channel {channel}: {x} at {at:?}",
                        case.name
                    );
                }
            }
        }
    }
}

/// Random positions, none of which lies on a round number.
fn positions(count: usize, spread: f64) -> Vec<Footprint> {
    let mut random = Random::new(11);
    (0..count)
        .map(|_| {
            let [x, y] = random.normal_pair().map(|x| spread * x);
            at(x, y)
        })
        .collect()
}

fn at(x: f64, y: f64) -> Footprint {
    let fraction = |x: f64| (x - x.floor()) as f32;
    Footprint {
        cell: [x.floor() as i32, y.floor() as i32],
        uv: [fraction(x), fraction(y)],
        ..Footprint::default()
    }
}

#[test]
fn a_vanishing_footprint_gives_the_point_value() {
    let points = positions(200, 3.0);
    let mut failures = Vec::new();
    for case in all() {
        let components = ranges(&case.texture).len();
        let wanted = evaluate(&case.texture, Method::Point, &points);
        for method in METHODS {
            for size in [0.0, 1e-30, 1e-12] {
                let shape = |&point: &Footprint| Footprint {
                    du: [size, 0.0],
                    dv: [0.0, size],
                    ..point
                };
                let footprints: Vec<Footprint> = points.iter().map(shape).collect();
                let found = evaluate(&case.texture, method, &footprints);
                for channel in 0..components {
                    let pairs = found[channel].iter().zip(&wanted[channel]);
                    let beyond = |(&a, &b): (&f32, &f32)| {
                        let off = f64::from((a - b).abs());
                        off.is_nan() || off > VANISHING * f64::from(b.abs()).max(1.0)
                    };
                    let wrong: Vec<_> = pairs
                        .zip(&footprints)
                        .filter(|&(pair, _)| beyond(pair))
                        .collect();
                    // Points within a rounding of an edge.
                    if wrong.len() as f64 > LEFT_OUT * points.len() as f64 {
                        let ((a, b), footprint) = wrong[0];
                        failures.push(format!(
                            "{} by {method}, channel {channel}: {a} for {b} at {footprint:?}, and \
                             {} more",
                            case.name,
                            wrong.len() - 1
                        ));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_huge_footprint_gives_the_mean_of_the_far_field() {
    // The pixel filter's standard deviation is half a pixel.
    let spread = 2_000.0;
    let pixel = (2.0 * spread) as f32;
    let points = positions(40_000, spread);
    let huge = [Footprint {
        du: [pixel, 0.0],
        dv: [0.0, pixel],
        ..at(0.0, 0.0)
    }];
    let mut failures = Vec::new();
    let cases = all();
    let channels: usize = cases.iter().map(|case| ranges(&case.texture).len()).sum();
    let level = SIGNIFICANCE / (channels * FILTERS.len()) as f64;
    for case in cases {
        let checked = case.texture.checked();
        let allowed: Vec<Option<f64>> = (case.texture.outputs().iter())
            .flat_map(|output| {
                let allowed = FAR_FIELD + f64::from(checked.signal(output.node).error);
                // A roughness or a normal of a material is no mean of those of points.
                let is_mean = checked.graph().node(output.node).is_mean();
                std::iter::repeat_n(is_mean.then_some(allowed), output.ty.components())
            })
            .collect();
        let samples = evaluate(&case.texture, Method::Point, &points);
        for method in FILTERS {
            let found = evaluate(&case.texture, method, &huge);
            for (channel, allowed) in allowed.iter().enumerate() {
                let Some(allowed) = allowed else { continue };
                let samples = samples[channel].iter().map(|&x| f64::from(x));
                let n = points.len() as f64;
                let mean = samples.clone().sum::<f64>() / n;
                let variance = samples.clone().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
                let range =
                    samples.clone().fold(f64::MIN, f64::max) - samples.fold(f64::MAX, f64::min);
                let off = (f64::from(found[channel][0]) - mean).abs();
                let error = (variance / n).sqrt().max(1e-6 * mean.abs().max(1.0));
                let beyond = (off - allowed * range).max(0.0);
                if p_value(beyond / error) < level {
                    failures.push(format!(
                        "{}_{}, channel {channel}: {} for {mean:.5} ± {error:.1e}",
                        case.name,
                        name_of(method),
                        found[channel][0],
                    ));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
