//! Transfers against dense numerical integration, and the heat equation.
//!
//! Moments are compared in the units of T: what a slope, a curvature and a third derivative
//! contribute to a signal of spread σ is E[T′]σ, E[T″]σ² and E[T‴]σ³, and the distortion's part is
//! √D. So one tolerance a transfer holds all five over every σ.

mod curves;
mod piecewise;
mod waves;

use super::{
    Gaussian, Knot, Piecewise, Polynomial, RealPower, Reciprocal, Shape, Sine, SquareWave,
    Transfer, spread,
};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::float::Float;
use crate::ir::{Builder, Module};

/// A function whose moments are [mean, slope, curvature, third, distortion] of (m, v).
type Make<'a> = &'a dyn for<'b> Fn(&'b Builder) -> Box<dyn Transfer<'b> + 'b>;

const UNBOUNDED: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

fn module(make: Make<'_>, range: [f32; 2]) -> Module {
    let b = &Builder::new("moments", "The moments of a transfer.");
    let (mean, variance) = (b.float_param("m"), b.float_param("v"));
    let (sd, inverse_sd) = spread(variance);
    let transfer = make(b);
    let moments = transfer.moments(&Gaussian {
        mean,
        variance,
        sd,
        inverse_sd,
        range,
    });
    b.result("mean", moments.mean);
    b.result("slope", moments.slope);
    b.result("curvature", moments.curvature);
    b.result("third", moments.third);
    b.result("distortion", moments.distortion);
    b.result("value", transfer.value(mean));
    let mut module = Module::default();
    b.finish(&mut module);
    module
}

/// Six results a point.
fn evaluate<F: Float + Into<f64>>(module: &Module, points: &[(f32, f32)]) -> Vec<[f64; 6]> {
    let means: Vec<f32> = points.iter().map(|p| p.0).collect();
    let variances: Vec<f32> = points.iter().map(|p| p.1).collect();
    let mut outputs: Vec<Vec<F>> = Vec::new();
    Evaluator::new(module).evaluate(
        &mut Scratch::new(),
        &[Input::Floats(&means), Input::Floats(&variances)],
        points.len(),
        &mut outputs,
    );
    (0..points.len())
        .map(|i| std::array::from_fn(|k| outputs[k][i].into()))
        .collect()
}

/// Five-point Gauss–Legendre on [−1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// [E T, E[T′]σ, E[T″]σ², E[T‴]σ³, √D] by integration between the places where T is not smooth.
fn integrated(t: &dyn Fn(f64) -> f64, breaks: &[f64], m: f64, sd: f64, reach: f64) -> [f64; 5] {
    let mut edges: Vec<f64> = breaks.iter().map(|at| (at - m) / sd).collect();
    edges.retain(|z| z.abs() < reach);
    edges.extend([-reach, reach]);
    edges.sort_by(f64::total_cmp);
    let mut samples = Vec::new();
    for pair in edges.windows(2) {
        let panels = ((pair[1] - pair[0]) * 40.0).ceil().max(1.0);
        let half = (pair[1] - pair[0]) / panels / 2.0;
        for panel in 0..panels as usize {
            let centre = pair[0] + half * (2 * panel + 1) as f64;
            for (node, weight) in GAUSS {
                let z = centre + half * node;
                let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
                samples.push((z, half * weight * density, t(m + sd * z)));
            }
        }
    }
    let total = |f: &dyn Fn(f64, f64) -> f64| samples.iter().map(|&(z, w, y)| w * f(z, y)).sum();
    let mean: f64 = total(&|_, y| y);
    let slope: f64 = total(&|z, y| y * z);
    let distortion: f64 = total(&|z, y| (y - mean - slope * z).powi(2));
    [
        mean,
        slope,
        total(&|z, y| y * (z * z - 1.0)),
        total(&|z, y| y * (z * z - 3.0) * z),
        distortion.sqrt(),
    ]
}

const DEVIATIONS: [f32; 14] = [
    1e-3, 0.01, 0.03, 0.1, 0.19, 0.21, 0.3, 0.5, 0.8, 1.0, 1.3, 2.0, 5.0, 20.0,
];

fn grid(low: f32, high: f32, deviations: &[f32]) -> Vec<(f32, f32)> {
    let means = (0..=48).map(|i| low + (high - low) * i as f32 / 48.0);
    means
        .flat_map(|m| deviations.iter().map(move |sd| (m, sd * sd)))
        .collect()
}

/// What is checked of a transfer.
struct Case<'a> {
    name: &'a str,
    make: Make<'a>,
    exact: &'a dyn Fn(f64) -> f64,
    breaks: Vec<f64>,
    points: Vec<(f32, f32)>,
    /// How far in σ the reference integrates.
    reach: f64,
    /// The largest errors of mean, slope, curvature, third and √D, in units of T.
    tolerances: [f64; 5],
    /// The size of T at m and σ, by which errors are divided: 1 for bounded ones.
    size: &'a dyn Fn(f64, f64) -> f64,
}

impl Case<'_> {
    /// Compares in f32 and f64.
    fn check(&self) {
        let module = self.integrate();
        self.heat(&module);
    }

    /// Compares with the integrals alone, whatever the spread: differences in f32 need one that is
    /// told apart from the mean.
    fn integrate(&self) -> Module {
        let module = module(self.make, UNBOUNDED);
        self.compare("f32", &evaluate::<f32>(&module, &self.points));
        self.compare("f64", &evaluate::<f64>(&module, &self.points));
        module
    }

    fn compare(&self, bank: &str, results: &[[f64; 6]]) {
        let mut worst = [(0.0f64, (0.0, 0.0), 0.0, 0.0); 5];
        for (&(m, v), result) in self.points.iter().zip(results) {
            let (m, v) = (f64::from(m), f64::from(v));
            let sd = v.sqrt();
            let expected = integrated(self.exact, &self.breaks, m, sd, self.reach);
            assert!(
                result[4] >= 0.0,
                "{}: distortion {} at m {m}, σ {sd}",
                self.name,
                result[4]
            );
            let units = [1.0, sd, v, v * sd];
            for k in 0..5 {
                let actual = if k == 4 {
                    result[4].sqrt()
                } else {
                    result[k] * units[k]
                };
                let error = (actual - expected[k]).abs() / (self.size)(m, sd);
                assert!(
                    error.is_finite(),
                    "{}: {actual} at m {m}, σ {sd}",
                    self.name
                );
                if error > worst[k].0 {
                    worst[k] = (error, (m, sd), actual, expected[k]);
                }
            }
        }
        let names = ["mean", "slope σ", "curvature σ²", "third σ³", "√distortion"];
        for ((name, &(error, (m, sd), actual, expected)), tolerance) in
            names.iter().zip(&worst).zip(self.tolerances)
        {
            assert!(
                error <= tolerance,
                "{} in {bank}: {name} is {actual}, not {expected}, at m {m}, σ {sd}: error {error:e} \
                 of {tolerance:e}",
                self.name
            );
        }
    }

    /// ∂E/∂v = ½E″ and ∂E/∂m = E′, by central differences of the f64 run, in units of T.
    fn heat(&self, module: &Module) {
        let step = 1.0f32 / 512.0;
        let mut shifted = Vec::new();
        for &(m, v) in &self.points {
            let dm = v.sqrt() * step;
            shifted.extend([
                (m, v),
                (m, v * (1.0 + step)),
                (m, v * (1.0 - step)),
                (m + dm, v),
                (m - dm, v),
            ]);
        }
        let results = evaluate::<f64>(module, &shifted);
        for (points, r) in shifted.chunks(5).zip(results.chunks(5)) {
            let (m, v) = (f64::from(points[0].0), f64::from(points[0].1));
            let size = (self.size)(m, v.sqrt());
            let difference = |a: usize, b: usize, x: fn(&(f32, f32)) -> f32| {
                (r[a][0] - r[b][0]) / (f64::from(x(&points[a])) - f64::from(x(&points[b])))
            };
            let by_v = difference(1, 2, |p| p.1);
            let error = (by_v - 0.5 * r[0][2]).abs() * v / size;
            // The differences' own error is step²/6 of a third derivative, and that of erf.
            let tolerance = 2e-3 + 2.0 * self.tolerances[2];
            assert!(
                error < tolerance,
                "{}: ∂E/∂v − ½E″ = {error:e} at m {m}, v {v}",
                self.name
            );
            let by_m = difference(3, 4, |p| p.0);
            let error = (by_m - r[0][1]).abs() * v.sqrt() / size;
            let tolerance = 2e-3 + 2.0 * self.tolerances[1];
            assert!(
                error < tolerance,
                "{}: ∂E/∂m − E′ = {error:e} at m {m}, v {v}",
                self.name
            );
        }
    }
}

fn unit(_: f64, _: f64) -> f64 {
    1.0
}

#[test]
fn steps_hinges_and_clamps() {
    let step: Make<'_> = &|b| Box::new(Piecewise::step(b.float(0.25)));
    let absolute: Make<'_> = &|b| Box::new(Piecewise::absolute(b));
    let clamp: Make<'_> = &|b| Box::new(Piecewise::clamp(b.float(-0.5), b.float(0.75)));
    let narrow: Make<'_> = &|b| Box::new(Piecewise::clamp(b.float(0.25), b.float(0.26)));
    let points = grid(-2.0, 3.0, &DEVIATIONS);
    let case = |name, make, exact, breaks: &[f64], tolerances, size| {
        let (breaks, points) = (breaks.to_vec(), points.clone());
        Case {
            name,
            make,
            exact,
            breaks,
            points,
            reach: 9.0,
            tolerances,
            size,
        }
        .check();
    };
    let exact = |x: f64| f64::from(u8::from(x >= 0.25));
    case(
        "step",
        step,
        &exact,
        &[0.25],
        [1e-6, 1e-6, 2e-6, 4e-6, 1e-4],
        &unit,
    );
    let size = |m: f64, sd: f64| m.abs().max(sd);
    case(
        "absolute",
        absolute,
        &f64::abs,
        &[0.0],
        [2e-6, 2e-6, 2e-6, 2e-6, 1e-3],
        &size,
    );
    let exact = |x: f64| x.clamp(-0.5, 0.75);
    case(
        "clamp",
        clamp,
        &exact,
        &[-0.5, 0.75],
        [1e-5, 1e-5, 1e-5, 1e-5, 1e-4],
        &unit,
    );
    let exact = |x: f64| x.clamp(0.25, 0.26);
    let size = |_: f64, _: f64| 0.01;
    let tolerances = [5e-4, 5e-4, 5e-4, 5e-4, 5e-3];
    case(
        "narrow clamp",
        narrow,
        &exact,
        &[0.25, 0.26],
        tolerances,
        &size,
    );
}

/// A ramp through constants, and its values in f64.
fn ramp<'b>(b: &'b Builder, stops: &[(f32, f32)], shape: Shape) -> Box<dyn Transfer<'b> + 'b> {
    let stops: Vec<_> = (stops.iter())
        .map(|&(at, y)| (b.float(at), b.float(y)))
        .collect();
    Box::new(Piecewise::ramp(&stops, shape))
}

fn ramp_at(stops: &[(f32, f32)], shape: Shape, x: f64) -> f64 {
    let stops: Vec<(f64, f64)> = stops.iter().map(|&(a, y)| (a.into(), y.into())).collect();
    let Some(i) = stops.iter().rposition(|s| s.0 <= x) else {
        return stops[0].1;
    };
    let (at, y) = stops[i];
    let Some(&(end, next)) = stops.get(i + 1) else {
        return y;
    };
    let t = (x - at) / (end - at);
    match shape {
        Shape::Constant => y,
        Shape::Linear => y + t * (next - y),
        Shape::Smooth => y + t * t * (3.0 - 2.0 * t) * (next - y),
        Shape::Cubic => panic!("cubic ramps have a test of their own"),
    }
}

#[test]
fn ramps_of_every_shape() {
    let several = [(-0.8, 0.1), (-0.2, 0.9), (0.1, 0.3), (0.1, 0.7), (0.9, 0.0)];
    let short = [(0.0, 0.0), (0.01, 1.0), (0.5, 0.4)];
    let single = [(0.0, 0.0), (1.0, 1.0)];
    for (stops, kind) in [
        (&several[..], "several"),
        (&short[..], "short"),
        (&single[..], "single"),
    ] {
        for shape in [Shape::Constant, Shape::Linear, Shape::Smooth] {
            let make: Make<'_> = &|b| ramp(b, stops, shape);
            let exact = |x: f64| ramp_at(stops, shape, x);
            Case {
                name: &format!("{kind} {shape:?}"),
                make,
                exact: &exact,
                breaks: stops.iter().map(|s| f64::from(s.0)).collect(),
                points: grid(-2.0, 3.0, &DEVIATIONS),
                reach: 9.0,
                tolerances: [3e-4, 1e-3, 3e-4, 1e-4, 3e-3],
                size: &unit,
            }
            .check();
        }
    }
}

#[test]
fn sines_and_square_waves() {
    Case {
        name: "sine",
        make: &|_| Box::new(Sine { phase: 0.0 }),
        exact: &f64::sin,
        breaks: Vec::new(),
        points: grid(-4.0, 4.0, &DEVIATIONS[..13]),
        reach: 9.0,
        tolerances: [1e-6, 2e-6, 2e-6, 5e-6, 1e-3],
        size: &unit,
    }
    .check();
    for width in [0.0f32, 0.05, 0.3, 0.5, 0.95, 1.0] {
        let make: Make<'_> = &|b| {
            Box::new(SquareWave {
                width: b.float(width),
            })
        };
        let exact = |x: f64| f64::from(u8::from(x - x.floor() < f64::from(width)));
        let breaks = (-60..=60).flat_map(|i| [f64::from(i), f64::from(i) + f64::from(width)]);
        Case {
            name: &format!("square wave {width}"),
            make,
            exact: &exact,
            breaks: breaks.collect(),
            points: grid(-1.03, 1.51, &DEVIATIONS[..13]),
            reach: 9.0,
            tolerances: [2e-6, 2e-6, 1e-5, 5e-5, 2e-3],
            size: &unit,
        }
        .check();
    }
}

#[test]
fn powers_and_the_reciprocal() {
    let size = |power: f64| move |m: f64, sd: f64| (m.abs() + sd + 0.01).powf(power);
    for power in 0..=Polynomial::MOST {
        let make: Make<'_> = &|_| Box::new(Polynomial { power });
        let exact = |x: f64| x.powi(power as i32);
        Case {
            name: &format!("polynomial {power}"),
            make,
            exact: &exact,
            breaks: Vec::new(),
            points: grid(-2.0, 2.0, &DEVIATIONS[..12]),
            reach: 12.0,
            tolerances: [1e-5, 1e-5, 1e-4, 1e-4, 1e-4],
            size: &size(f64::from(power)),
        }
        .check();
    }
    for power in [0.5f32, 1.5, 2.2, 3.5] {
        let make: Make<'_> = &|b| {
            Box::new(RealPower {
                power: b.float(power),
            })
        };
        let exact = |x: f64| x.max(0.0).powf(power.into());
        Case {
            name: &format!("real power {power}"),
            make,
            exact: &exact,
            breaks: vec![0.0],
            points: grid(-2.0, 2.0, &DEVIATIONS[..12]),
            reach: 9.0,
            tolerances: [1e-3, 2e-3, 1e-2, 4e-2, 1.5e-2],
            size: &size(power.into()),
        }
        .check();
    }
    let make: Make<'_> = &|_| Box::new(Reciprocal);
    let exact = |x: f64| 1.0 / x;
    let mut points = grid(0.5, 4.0, &[0.001, 0.01, 0.03, 0.08]);
    points.extend(grid(-4.0, -0.5, &[0.01, 0.08]));
    Case {
        name: "reciprocal",
        make,
        exact: &exact,
        breaks: Vec::new(),
        points,
        reach: 5.5,
        tolerances: [2e-5, 2e-5, 2e-5, 1e-4, 1e-3],
        size: &|m: f64, _| 1.0 / m.abs(),
    }
    .check();
}

#[test]
fn a_spread_of_nothing_gives_the_value() {
    let makes: [(&str, Make<'_>); 8] = [
        ("absolute", &|b| Box::new(Piecewise::absolute(b))),
        ("smooth", &|b| {
            ramp(
                b,
                &[(-0.8, 0.1), (-0.2, 0.9), (0.1, 0.3), (0.9, 0.0)],
                Shape::Smooth,
            )
        }),
        ("linear", &|b| {
            ramp(
                b,
                &[(-0.8, 0.1), (-0.2, 0.9), (0.1, 0.3), (0.9, 0.0)],
                Shape::Linear,
            )
        }),
        ("constant", &|b| {
            ramp(
                b,
                &[(-0.81, 0.1), (-0.23, 0.9), (0.13, 0.3)],
                Shape::Constant,
            )
        }),
        ("sine", &|_| Box::new(Sine { phase: 0.5 })),
        ("polynomial", &|_| Box::new(Polynomial { power: 5 })),
        ("reciprocal", &|_| Box::new(Reciprocal)),
        ("square wave", &|b| {
            Box::new(SquareWave {
                width: b.float(0.37),
            })
        }),
    ];
    let points: Vec<(f32, f32)> = (0..41).map(|i| (-1.013 + 0.05 * i as f32, 0.0)).collect();
    for (name, make) in makes {
        for ((m, _), [mean, .., distortion, value]) in points
            .iter()
            .zip(evaluate::<f32>(&module(make, UNBOUNDED), &points))
        {
            let size = value.abs().max(1.0);
            assert!(
                (mean - value).abs() <= 2e-6 * size,
                "{name} at {m}: {mean} for {value}"
            );
            assert!(
                distortion <= 1e-6 * size * size,
                "{name} at {m}: distortion {distortion}"
            );
        }
    }
}

#[test]
fn knots_beyond_the_inputs_range_do_not_matter() {
    let make: Make<'_> = &|b| {
        let zero = b.float(0.0);
        let knots = vec![
            Knot::bend(b.float(-30.0), 1.0),
            Knot {
                at: zero,
                jump: b.float(1.0),
                bend: b.float(-1.0),
            },
        ];
        Box::new(Piecewise::straight(zero, 0.0, knots))
    };
    let points = grid(-1.0, 1.0, &[0.01, 0.1, 0.3]);
    let bounded = evaluate::<f64>(&module(make, [-5.0, 5.0]), &points);
    for (a, b) in bounded
        .iter()
        .zip(evaluate::<f64>(&module(make, UNBOUNDED), &points))
    {
        for k in 0..5 {
            // An erf within 3e-7 times the 30 that the far knot raises.
            assert!(
                (a[k] - b[k]).abs() <= 1e-4 * (1.0 + b[k].abs()),
                "{a:?} {b:?}"
            );
        }
    }
}
