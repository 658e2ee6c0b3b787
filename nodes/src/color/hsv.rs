//! The hexcone: hue in turns, saturation, value (Smith 1978, *Color Gamut Transform Pairs*).

use mipless_codegen::ir::{Builder, FunctionRef, Module, Value};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};

use crate::componentwise::composed;

/// How much of a full colour is absent from red, by hue: corners of a wave of period 1.
pub(crate) const ABSENCE: [(f32, f32); 4] = [
    (1.0 / 6.0, 0.0),
    (1.0 / 3.0, 1.0),
    (2.0 / 3.0, 1.0),
    (5.0 / 6.0, 0.0),
];

/// Hue, saturation and value of a colour; a grey has hue 0, black saturation 0.
fn to_hsv(b: &mut Builder, [red, green, blue]: [Value; 3]) -> [Value; 3] {
    let (low, high) = (b.min(red, green), b.max(red, green));
    let (low, high) = (b.min(low, blue), b.max(high, blue));
    let span = b.sub(high, low);
    let (zero, one, least) = (b.f32(0.0), b.f32(1.0), b.f32(1e-9));
    let guarded = b.max(span, least);
    let sixth = b.f32(1.0 / 6.0);
    let inverse = b.div(sixth, guarded);
    let sector = |b: &mut Builder, from: Value, to: Value, turn: f32| {
        let across = b.sub(to, from);
        let part = b.mul(across, inverse);
        b.offset(part, turn)
    };
    let of_red = sector(b, blue, green, 0.0);
    let of_green = sector(b, red, blue, 1.0 / 3.0);
    let of_blue = sector(b, green, red, 2.0 / 3.0);
    let (is_red, is_green) = (b.le(high, red), b.le(high, green));
    let hue = b.select(is_green, of_green, of_blue);
    let hue = b.select(is_red, of_red, hue);
    let negative = b.lt(hue, zero);
    let around = b.add(hue, one);
    let hue = b.select(negative, around, hue);
    let colored = b.lt(least, span);
    let bright = b.lt(least, high);
    let below = b.max(high, least);
    let saturation = b.div(span, below);
    [
        b.select(colored, hue, zero),
        b.select(bright, saturation, zero),
        high,
    ]
}

/// The colour of a hue, a saturation and a value.
pub(crate) fn to_rgb(b: &mut Builder, [hue, saturation, value]: [Value; 3]) -> [Value; 3] {
    let chroma = b.mul(saturation, value);
    [0.0, -1.0 / 3.0, -2.0 / 3.0].map(|turn| {
        // 1 − (|6 fract(h + turn) − 3| − 1), limited to [0, 1].
        let turned = b.offset(hue, turn);
        let whole = b.floor(turned);
        let part = b.sub(turned, whole);
        let part = b.scale(part, 6.0);
        let part = b.offset(part, -3.0);
        let part = b.abs(part);
        let two = b.f32(2.0);
        let absence = b.sub(two, part);
        let absence = b.clamp(absence, 0.0, 1.0);
        let lost = b.mul(chroma, absence);
        b.sub(value, lost)
    })
}

/// [`to_hsv`] as a function of the module.
pub(crate) fn to_hsv_function(module: &mut Module) -> FunctionRef {
    let doc = "Hue in turns, saturation and value of a colour.";
    let mut b = Builder::new("rgb_to_hsv", doc);
    let rgb = ["red", "green", "blue"].map(|name| b.param_f32(name));
    let hsv = to_hsv(&mut b, rgb);
    for (name, value) in ["hue", "saturation", "value"].into_iter().zip(hsv) {
        b.result(name, value);
    }
    b.finish(module)
}

/// The colour of (h + amount₁, s · amount₂, v · amount₃), as a function of the module.
fn adjust_function(module: &mut Module) -> FunctionRef {
    let doc = "A colour with its hue turned, its saturation and its value scaled.";
    let mut b = Builder::new("hsv_adjust", doc);
    let rgb = ["red", "green", "blue"].map(|name| b.param_f32(name));
    let amounts = ["turn", "saturate", "brighten"].map(|name| b.param_f32(name));
    let [hue, saturation, value] = to_hsv(&mut b, rgb);
    let hue = b.add(hue, amounts[0]);
    let saturation = b.mul(saturation, amounts[1]);
    let value = b.mul(value, amounts[2]);
    let rgb = to_rgb(&mut b, [hue, saturation, value]);
    for (name, value) in ["red", "green", "blue"].into_iter().zip(rgb) {
        b.result(format!("new_{name}"), value);
    }
    b.finish(module)
}

/// A colour with its hue turned, its saturation and its value scaled.
pub(crate) fn adjusted(lower: &mut Lower<'_>, color: &[Signal], amounts: [Value; 3]) -> Bundle {
    let [turn, saturate, brighten] = amounts;
    if lower.b().is_zero(turn) {
        let one = Some(1.0);
        let b = lower.b();
        if b.as_constant(saturate) == one && b.as_constant(brighten) == one {
            return color.to_vec();
        }
        // s w = (M − in)/M: the new channel is v (M + s (in − M)).
        return composed(lower, |lower| {
            let largest = lower.algebra.maximum(&color[0], &color[1]);
            let largest = lower.algebra.maximum(&largest, &color[2]);
            (color.iter())
                .map(|channel| {
                    let b = lower.b();
                    let apart = channel.sub(b, &largest).scale(b, saturate);
                    apart.add(b, &largest).scale(b, brighten)
                })
                .collect()
        });
    }
    let function = lower.function("hsv_adjust", adjust_function);
    let ranges = [[f32::NEG_INFINITY, f32::INFINITY]; 3];
    lower.algebra.cubature(color, &ranges, |b, rgb| {
        let arguments: Vec<Value> = rgb.iter().chain(&amounts).copied().collect();
        b.call(&function, &arguments)
    })
}
