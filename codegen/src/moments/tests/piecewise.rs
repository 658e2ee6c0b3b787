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
