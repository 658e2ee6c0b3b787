//! Random literals that a port accepts: within its range, and at its ends.

use crate::random::Random;
use mipless::{PortSpec, Type};
use serde_json::{Value, json};

/// Pictures beside the graphs.
const PICTURES: [&str; 3] = [
    "images/granite.png",
    "images/moss.png",
    "images/azulejo.png",
];

/// Sorted stops, sometimes two in one place, sometimes all of one value.
pub(super) fn stops(random: &mut Random, colors: bool) -> Value {
    let count = 1 + random.below(6);
    let mut places: Vec<f64> = (0..count)
        .map(|_| rounded(random.within(-1.0, 1.0)))
        .collect();
    places.sort_by(f64::total_cmp);
    if count > 2 && random.happens(0.2) {
        places[1] = places[0];
    }
    let stop = |&at: &f64| {
        let mut unit = || rounded(random.unit());
        let value = if colors {
            json!([unit(), unit(), unit()])
        } else {
            json!(unit())
        };
        json!({ "at": at, "value": value })
    };
    places.iter().map(stop).collect()
}

/// A literal of a type, in the range of a port.
pub(super) fn literal(random: &mut Random, port: &PortSpec, ty: Type) -> Value {
    match ty {
        Type::Boolean => json!(random.happens(0.5)),
        Type::Filename => json!(random.choose(&PICTURES)),
        Type::String => json!(""),
        Type::Integer => json!(number(random, port).round() as i64),
        Type::Color3 if random.happens(0.3) => json!(format!("#{:06x}", random.bits() >> 40)),
        _ if ty.components() <= 1 || random.happens(0.2) => json!(number(random, port)),
        _ => (0..ty.components()).map(|_| number(random, port)).collect(),
    }
}

/// A number that the port accepts: mostly from its slider, sometimes one of its ends or a round
/// number, seldom one that nobody wants.
fn number(random: &mut Random, port: &PortSpec) -> f64 {
    let range = port.range;
    let (low, high) = (f64::from(range.soft_min), f64::from(range.soft_max));
    let (least, most) = (f64::from(range.min), f64::from(range.max));
    let x = match random.below(100) {
        0..6 => low,
        6..12 => high,
        12..20 => *random.choose(&[0.0, 1.0, -1.0, 0.5, 2.0]),
        20..22 if least.abs() < 1e6 => least,
        22..24 if most.abs() < 1e6 => most,
        24 => *random.choose(&[1e-6, 1e6, -1e6, 1e-30, 16_777_217.0]),
        25..30 => rounded(random.within(10.0 * low - 9.0 * high, 10.0 * high - 9.0 * low)),
        _ => rounded(random.within(low, high)),
    };
    let x = x.clamp(least, most);
    if range.nonzero && x.abs() < 1e-3 {
        high.max(1.0)
    } else {
        x
    }
}

/// A number that can be read: to four digits.
pub(super) fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().expect("a number")
}
