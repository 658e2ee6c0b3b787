//! The hexcone: hue in turns, saturation, value (Smith 1978, *Color Gamut Transform Pairs*).

use crate::componentwise::composed;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};

/// How much of a full colour is absent from red, by hue: corners of a wave of period 1.
pub(crate) const ABSENCE: [(f32, f32); 4] = [
    (1.0 / 6.0, 0.0),
    (1.0 / 3.0, 1.0),
    (2.0 / 3.0, 1.0),
    (5.0 / 6.0, 0.0),
];

/// Hue, saturation and value of a colour; a grey has hue 0, black and what is below it hue and
/// saturation 0.
fn to_hsv([red, green, blue]: [Float<'_>; 3]) -> [Float<'_>; 3] {
    let (low, high) = (red.min(green).min(blue), red.max(green).max(blue));
    let span = high - low;

    // The hue: a sixth of a turn from channel to channel, from the turn of the largest.
    let inverse = 1.0 / 6.0 / span.max(1e-9);
    let of_red = (green - blue) * inverse;
    let of_green = (blue - red) * inverse + 1.0 / 3.0;
    let of_blue = (red - green) * inverse + 2.0 / 3.0;
    let of_others = green.ge(high).select(of_green, of_blue);
    let hue = red.ge(high).select(of_red, of_others);
    let hue = hue.lt(0.0).select(hue + 1.0, hue);

    let saturation = span / high.max(1e-9);
    [
        (span.gt(1e-9) & high.gt(1e-9)).select(hue, 0.0),
        high.gt(1e-9).select(saturation, 0.0),
        high,
    ]
}

/// The colour of a hue, a saturation, which is at least 0, and a value.
pub(crate) fn to_rgb([hue, saturation, value]: [Float<'_>; 3]) -> [Float<'_>; 3] {
    let chroma = saturation.max(0.0) * value;
    [0.0, -1.0 / 3.0, -2.0 / 3.0].map(|turn| {
        // 1 − (|6 fract(h + turn) − 3| − 1), limited to [0, 1].
        let turned = hue + turn;
        let sector = (turned - turned.floor()) * 6.0;
        let absence = (2.0 - (sector + -3.0).abs()).clamp(0.0, 1.0);
        value - chroma * absence
    })
}

/// [`to_hsv`] as a function of the module.
pub(super) fn to_hsv_function(module: &mut Module) -> FunctionRef {
    let doc = "Hue in turns, saturation and value of a colour.";
    let b = &Builder::new("rgb_to_hsv", doc);
    let hsv = to_hsv(b.float_params(["red", "green", "blue"]));
    b.results(["hue", "saturation", "value"], hsv);
    b.finish(module)
}

/// The colour of (h + amount₁, s · amount₂, v · amount₃), as a function of the module.
fn adjust_function(module: &mut Module) -> FunctionRef {
    let doc = "A colour with its hue turned, its saturation and its value scaled.";
    let b = &Builder::new("hsv_adjust", doc);
    let rgb = b.float_params(["red", "green", "blue"]);
    let [turn, saturate, brighten] = b.float_params(["turn", "saturate", "brighten"]);
    let [hue, saturation, value] = to_hsv(rgb);
    let rgb = to_rgb([hue + turn, saturation * saturate, value * brighten]);
    b.results(["new_red", "new_green", "new_blue"], rgb);
    b.finish(module)
}

/// A colour with its hue turned, its saturation and its value scaled.
pub(super) fn adjusted<'b>(
    lower: &mut Lower<'_, 'b>,
    color: &[Signal<'b>],
    amounts: [Float<'b>; 3],
) -> Bundle<'b> {
    let [turn, saturate, brighten] = amounts;
    if turn.is_zero() {
        if [saturate, brighten].map(Float::as_constant) == [Some(1.0); 2] {
            return color.to_vec();
        }
        // s w = (M − in)/M: the new channel is v (M + s (in − M)).
        return composed(lower, |lower| {
            let largest = lower.algebra.maximum(&color[0], &color[1]);
            let largest = lower.algebra.maximum(&largest, &color[2]);
            let adjusted = |x: &Signal<'b>| ((x - &largest) * saturate + &largest) * brighten;
            color.iter().map(adjusted).collect()
        });
    }
    let b = lower.b();
    let function = lower.function("hsv_adjust", adjust_function);
    let ranges = [[f32::NEG_INFINITY, f32::INFINITY]; 3];
    (lower.algebra).cubature(color, &ranges, |rgb| b.call(&function, (rgb, amounts)))
}
