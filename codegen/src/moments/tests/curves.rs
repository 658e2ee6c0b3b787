//! The exponential, and functions by their values alone.

use super::super::{Curve, Exponential, Transfer};
use super::{Case, DEVIATIONS, UNBOUNDED, grid, unit};
use crate::ir::{Builder, Value};

#[test]
fn the_exponential() {
    let make = |_: &mut Builder| -> Box<dyn Transfer> { Box::new(Exponential) };
    Case {
        name: "exponential",
        make: &make,
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
fn bell(b: &mut Builder, x: Value) -> Value {
    let square = b.square(x);
    let exponent = b.scale(square, -0.25);
    let exponent = b.clamp(exponent, -80.0, 0.0);
    let bell = b.exp(exponent);
    b.mul(x, bell)
}

/// √ of x limited to [0, 1].
fn root(b: &mut Builder, x: Value) -> Value {
    let x = b.clamp(x, 0.0, 1.0);
    b.sqrt(x)
}

#[test]
fn curves_with_and_without_kinks() {
    let make = |_: &mut Builder| -> Box<dyn Transfer> { Box::new(Curve::smooth(bell, UNBOUNDED)) };
    Case {
        name: "smooth curve",
        make: &make,
        exact: &|x| x * (-0.25 * x * x).exp(),
        breaks: Vec::new(),
        points: grid(-2.0, 2.0, &DEVIATIONS[..9]),
        reach: 9.0,
        tolerances: [2e-4, 5e-4, 2e-3, 4e-3, 2e-3],
        size: &unit,
    }
    .check();
    let make = |b: &mut Builder| -> Box<dyn Transfer> {
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        Box::new(Curve {
            function: root,
            kinks: vec![zero, one],
            flat: [Some(zero), Some(one)],
            range: [0.0, 1.0],
        })
    };
    Case {
        name: "curve with kinks",
        make: &make,
        exact: &|x| x.clamp(0.0, 1.0).sqrt(),
        breaks: vec![0.0, 1.0],
        points: grid(-2.0, 2.0, &DEVIATIONS),
        reach: 9.0,
        tolerances: [1e-3, 2e-3, 4e-3, 6e-3, 5e-3],
        size: &unit,
    }
    .check();
}
