//! Cubic ramps, and bumps that are not monotone.

use super::super::piecewise::Bump;
use super::super::{Knot, Piecewise, Shape, Transfer};
use super::{Case, DEVIATIONS, UNBOUNDED, grid, unit};
use crate::ir::Builder;

const STOPS: [(f32, f32); 6] = [
    (-0.8, 0.1),
    (-0.2, 0.9),
    (0.1, 0.3),
    (0.1, 0.7),
    (0.5, 0.65),
    (0.9, 0.0),
];

fn ramp(b: &Builder) -> Piecewise<'_> {
    let stops = STOPS.map(|(at, y)| (b.float(at), b.float(y)));
    Piecewise::ramp(&stops, Shape::Cubic)
}

/// Steffen's interpolant of the stops, with slope 0 at both ends.
fn steffen(x: f64) -> f64 {
    let stops = STOPS.map(|(at, y)| (f64::from(at), f64::from(y)));
    let Some(i) = stops.iter().rposition(|stop| stop.0 <= x) else {
        return stops[0].1;
    };
    if i + 1 == stops.len() {
        return stops[i].1;
    }
    let secant = |i: usize| {
        let (from, to) = (stops[i], stops[i + 1]);
        let width = to.0 - from.0;
        let slope = if width > 1e-6 {
            (to.1 - from.1) / width
        } else {
            0.0
        };
        (slope, width)
    };
    let tangent = |i: usize| {
        if i == 0 || i + 1 == stops.len() {
            return 0.0;
        }
        let ((s, w), (t, u)) = (secant(i - 1), secant(i));
        let parabola = 0.5 * ((s * u + t * w) / (w + u)).abs();
        (s.signum() + t.signum()) * s.abs().min(t.abs()).min(parabola)
    };
    let (slope, width) = secant(i);
    let t = (x - stops[i].0) / width;
    let (p, q) = (tangent(i) - slope, tangent(i + 1) - slope);
    stops[i].1 + width * (slope * t + t * (1.0 - t) * (p * (1.0 - t) - q * t))
}

#[test]
fn cubic_ramps() {
    Case {
        name: "cubic",
        make: &|b| Box::new(ramp(b)),
        exact: &steffen,
        breaks: STOPS.map(|stop| f64::from(stop.0)).to_vec(),
        points: grid(-2.0, 3.0, &DEVIATIONS),
        reach: 9.0,
        tolerances: [3e-4, 1e-3, 3e-4, 1e-4, 3e-3],
        size: &unit,
    }
    .check();
    let b = &Builder::new("range", "The range of a ramp.");
    let [low, high] = ramp(b).range(UNBOUNDED);
    assert!(
        low > -1e-5 && low <= 0.0 && (0.9..0.90001).contains(&high),
        "{low} {high}"
    );
}

#[test]
fn a_rounded_corner() {
    fn rounded(b: &Builder) -> Piecewise<'_> {
        Piecewise::rounded(b.float(0.5))
    }
    let exact = |x: f64| {
        if x.abs() < 0.5 { x * x + 0.25 } else { x.abs() }
    };
    Case {
        name: "rounded",
        make: &|b| Box::new(rounded(b)),
        exact: &exact,
        breaks: vec![-0.5, 0.5],
        points: grid(-2.0, 3.0, &DEVIATIONS),
        reach: 9.0,
        tolerances: [3e-4, 1e-3, 3e-4, 1e-4, 3e-3],
        size: &|m: f64, sd: f64| 0.5 + m.abs() + sd,
    }
    .check();
    let b = &Builder::new("range", "The range of a rounded corner.");
    let [low, high] = rounded(b).range([-2.0, 1.0]);
    assert!(
        (low - 0.25).abs() < 1e-5 && (high - 2.0).abs() < 1e-5,
        "{low} {high}"
    );
}

#[test]
fn the_range_of_a_bump_that_overshoots() {
    let b = &Builder::new("range", "The range of a bump.");
    let knots = [0.0, 1.0].map(|at| Knot::bend(b.float(at), 0.0));
    let parabola = Piecewise {
        bumps: vec![Bump {
            start: b.float(4.0),
            end: b.float(-4.0),
        }],
        ..Piecewise::straight(b.float(0.0), 0.0, knots.to_vec())
    };
    let [low, high] = parabola.range(UNBOUNDED);
    assert!(
        low.abs() < 1e-5 && (high - 1.0).abs() < 1e-5,
        "{low} {high}"
    );
}

/// Deviations of 10⁻⁶ to 10¹² segments.
fn decades() -> Vec<f32> {
    (-6..=12).map(|exponent| 10f32.powi(exponent)).collect()
}

/// Means from far before to far after the segment, in σ and in the segment.
fn far_and_near() -> Vec<(f32, f32)> {
    let mut points = Vec::new();
    for sd in decades() {
        for z in [-6.0, -2.5, -1.0, -0.3, 0.0, 0.4, 1.0, 3.0, 7.0] {
            points.push((z * sd, sd * sd));
            points.push((z * sd + 0.3, sd * sd));
        }
        points.extend([0.0, 0.25, 0.5, 0.9, 1.0].map(|m| (m, sd * sd)));
    }
    points
}

/// A name, what makes the function, its values, and how far its mean may be off.
type Stretched<'a> = (&'a str, super::Make<'a>, &'a dyn Fn(f64) -> f64, f64);

#[test]
fn a_segment_keeps_its_digits_under_any_spread() {
    let clamp = |x: f64| x.clamp(0.0, 1.0);
    let smooth = |x: f64| {
        let t = x.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let several = |x: f64| ramp_of_three(x);
    let cases: [Stretched<'_>; 3] = [
        (
            "clamp",
            &|b| Box::new(Piecewise::clamp(b.float(0.0), b.float(1.0))),
            &clamp,
            1e-5,
        ),
        (
            "smoothstep",
            &|b| Box::new(Piecewise::smoothstep(b.float(0.0), b.float(1.0))),
            &smooth,
            3e-4,
        ),
        ("three stops", &three_stops, &several, 1e-5),
    ];
    for (name, make, exact, tolerance) in cases {
        Case {
            name,
            make,
            exact,
            breaks: vec![0.0, 0.5, 1.0],
            points: far_and_near(),
            reach: 9.0,
            tolerances: [tolerance, 1e-3, 3e-4, 1e-3, 3e-3],
            size: &unit,
        }
        .integrate();
    }
}

const THREE_STOPS: [(f32, f32); 3] = [(0.0, 0.2), (0.5, 1.0), (1.0, 0.4)];

fn number(b: &Builder, at: f32, y: f32) -> (crate::ir::Float<'_>, crate::ir::Float<'_>) {
    (b.float(at), b.float(y))
}

fn three_stops(b: &Builder) -> Box<dyn Transfer<'_> + '_> {
    let stops = THREE_STOPS.map(|(at, y)| number(b, at, y));
    Box::new(Piecewise::ramp(&stops, Shape::Linear))
}

fn ramp_of_three(x: f64) -> f64 {
    if x < 0.5 {
        0.2 + 1.6 * x.max(0.0)
    } else {
        1.0 - 1.2 * (x.min(1.0) - 0.5)
    }
}

#[test]
fn a_ramp_whose_last_stop_is_beyond_the_input_still_rises() {
    // The stop at 2 is beyond the input's range: after the one at 0 the ramp goes on.
    let make: super::Make<'_> = &|b| {
        let stops = [(-1.0, 0.0), (0.0, 0.5), (2.0, 1.0)].map(|(at, y)| number(b, at, y));
        Box::new(Piecewise::ramp(&stops, Shape::Linear))
    };
    let module = super::module(make, [-1.5, 1.5]);
    let points = [(1.0, 1e-6), (1.3, 1e-4), (0.5, 1e-8)];
    for (&(m, _), moments) in points.iter().zip(super::evaluate::<f32>(&module, &points)) {
        let right = 0.5 + 0.25 * f64::from(m);
        assert!((moments[0] - right).abs() < 1e-5, "{moments:?} at {m}");
    }
}

#[test]
fn crossed_bounds_are_a_step_and_no_negative_variance() {
    let make: super::Make<'_> = &|b| Box::new(Piecewise::smoothstep(b.float(1.0), b.float(-0.5)));
    let exact = |x: f64| f64::from(u8::from(x >= -0.5));
    Case {
        name: "crossed",
        make,
        exact: &exact,
        breaks: vec![-0.5],
        points: grid(-2.0, 3.0, &DEVIATIONS),
        reach: 9.0,
        tolerances: [1e-6, 1e-6, 2e-6, 4e-6, 1e-3],
        size: &unit,
    }
    .check();
}
