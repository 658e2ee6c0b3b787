//! The exponential, and functions by their values alone.

use super::super::{Curve, Exponential};
use super::{Case, DEVIATIONS, Make, UNBOUNDED, grid, unit};
use crate::ir::Float;

#[test]
fn the_exponential() {
    Case {
        name: "exponential",
        make: &|_| Box::new(Exponential),
        exact: &f64::exp,
        breaks: Vec::new(),
        points: grid(-2.0, 2.0, &DEVIATIONS[..11]),
        reach: 12.0,
        tolerances: [2e-6, 2e-6, 4e-6, 8e-6, 2e-4],
        size: &|m: f64, sd: f64| (m + sd * sd).exp(),
    }
    .check();
}

/// x e^{−x²/4}, smooth everywhere.
fn bell(x: Float<'_>) -> Float<'_> {
    x * (x.square() * -0.25).clamp(-80.0, 0.0).exp()
}

/// √ of x limited to [0, 1].
fn root(x: Float<'_>) -> Float<'_> {
    x.clamp(0.0, 1.0).sqrt()
}

#[test]
fn curves_with_and_without_kinks() {
    Case {
        name: "smooth curve",
        make: &|_| Box::new(Curve::smooth(bell, UNBOUNDED)),
        exact: &|x| x * (-0.25 * x * x).exp(),
        breaks: Vec::new(),
        points: grid(-2.0, 2.0, &DEVIATIONS[..9]),
        reach: 9.0,
        tolerances: [2e-4, 5e-4, 2e-3, 4e-3, 2e-3],
        size: &unit,
    }
    .check();
    let make: Make<'_> = &|b| {
        let [zero, one] = [0.0, 1.0].map(|x| b.float(x));
        Box::new(Curve {
            function: root,
            kinks: vec![zero, one],
            flat: [Some(zero), Some(one)],
            range: [0.0, 1.0],
        })
    };
    Case {
        name: "curve with kinks",
        make,
        exact: &|x| x.clamp(0.0, 1.0).sqrt(),
        breaks: vec![0.0, 1.0],
        points: grid(-2.0, 2.0, &DEVIATIONS),
        reach: 9.0,
        tolerances: [1e-3, 2e-3, 4e-3, 6e-3, 5e-3],
        size: &unit,
    }
    .check();
}
