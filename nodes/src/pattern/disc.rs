//! The Gaussian measure of discs, integrated along the minor axis of the footprint, chord by chord.

use super::measure::{Measure, NAMES};
use super::touch::Touch;
use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2, dot};
use mipless_codegen::moments::Normal;

/// No footprint is narrower than this, in units of the position: chords are placed to 3e-8, which must
/// be little against it.
const NARROWEST: f32 = 1e-5;

/// How many chords a disc is integrated over.
const CHORDS: u32 = 28;

/// One chord, the body of a fold over them.
fn chord(module: &mut Module) -> FunctionRef {
    let table = module.table("chords", legendre(CHORDS as usize));
    let b = &Builder::new("disc_chord", "One more chord of a disc.");
    let index = b.uint_param("index");
    let state = b.float_params(NAMES);
    let [middle, half, radius] = b.float_params(["middle", "half", "radius"]);
    let [x, y] = b.float_params(["x", "y"]);
    let [inverse_x, inverse_y] = b.float_params(["inverse_x", "inverse_y"]);
    let first = index * 2;
    let (node, weight) = (b.load(table, first), b.load(table, first + 1));
    // u = (15t − 10t³ + 3t⁵)/8, du = 15/8 (1 − t²)² dt.
    let t2 = node.square();
    let u = ((t2 * (3.0 / 8.0) + -10.0 / 8.0) * t2 + 15.0 / 8.0) * node;
    let fall = (1.0 - t2).square() * (15.0 / 8.0);

    // Along the minor axis, from the disc's centre.
    let place = middle + half * u;
    let reach = (radius.square() - place.square()).max(0.0).sqrt();
    let at = Normal::at(place + y, inverse_y);
    let [high, low] = [x + reach, x - reach].map(|end| Normal::at(end, inverse_x));
    let w = weight * fall * half * inverse_y * at.density;
    // Of two upper tails the difference is taken there.
    let span = low
        .z
        .gt(0.0)
        .select(low.above - high.above, high.below - low.below);
    let flow = low.density - high.density;
    let bend = low.z * low.density - high.z * high.density;
    let parts = [
        span,
        flow,
        at.z * span,
        bend,
        at.z * flow,
        (at.z.square() + -1.0) * span,
    ];
    b.sums(NAMES, state, parts.map(|part| w * part));
    b.finish(module)
}

/// The measure of a disc of a radius, whose centre is at an offset from the mean, and its
/// derivatives.
///
/// Along the minor axis of the footprint, over the part of the disc within ±4.8 σ₂, by 28
/// Gauss–Legendre nodes in a variable that is flat at both ends, where chords end like a root.
pub(crate) fn function(module: &mut Module) -> FunctionRef {
    let chord = chord(module);
    let b = &Builder::new("disc", "The measure of a disc.");
    let [x, y, radius] = b.float_params(["x", "y", "radius"]);
    let covariance = Sym2(b.float_params(["xx", "xy", "yy"]));

    // The axes of the footprint: the longer of two equal candidates for its direction.
    let [xx, xy, yy] = *covariance;
    let (mid, tilt) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
    let root = (tilt * tilt + xy * xy).sqrt();
    let (more, less) = (mid + root, (mid - root).max(0.0));
    let wide = tilt.ge(0.0);
    let long = root + tilt.abs();
    let (cx, cy) = (wide.select(long, xy), wide.select(xy, long));
    let length = cx * cx + cy * cy;
    let round = length.le(0.0);
    let length = round.select(1.0, length).sqrt();
    let (c, s) = (round.select(1.0, cx / length), cy / length);
    let (u, v) = (dot([c, s], [x, y]), dot([-s, c], [x, y]));
    let [major, minor] = [more, less].map(|v| (v + NARROWEST * NARROWEST).sqrt());
    let [inverse_x, inverse_y] = [major, minor].map(|sd| 1.0 / sd);

    // The chords within ±4.8 σ of the mean, which is at −v from the centre.
    let reach = minor * 4.8;
    let low = (-v - reach).max(-radius);
    let high = (-v + reach).min(radius);
    let half = (high - low).max(0.0) * 0.5;
    let middle = low + half;
    let touch = Touch::between(x * x + y * y, [radius; 2], covariance);
    let captures = [middle, half, radius, u, v, inverse_x, inverse_y];
    let [value, gu, gv, huu, huv, hvv] =
        b.fold(&chord, touch.turns(CHORDS), [b.float(0.0); 6], captures);

    // Turned back; σ is still in the derivatives.
    let gradient = Vec2([gu * inverse_x, gv * inverse_y]);
    let huu = huu * inverse_x.square();
    let huv = huv * (inverse_x * inverse_y);
    let hvv = hvv * inverse_y.square();
    let (c2, s2, cs) = (c.square(), s.square(), c * s);
    let twice = cs + cs;
    let measure = touch.measure([
        value,
        Vec2([c, -s]).dot(gradient),
        Vec2([s, c]).dot(gradient),
        dot([c2, -twice, s2], [huu, huv, hvv]),
        cs * (huu - hvv) + (c2 - s2) * huv,
        dot([s2, twice, c2], [huu, huv, hvv]),
    ]);
    b.results(NAMES, measure);
    b.finish(module)
}

/// Nodes and weights of Gauss–Legendre on [−1, 1], in pairs, by Newton's method.
fn legendre(n: usize) -> Vec<f32> {
    let mut out = Vec::with_capacity(2 * n);
    for i in 0..n {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..50 {
            let (mut before, mut here) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
            }
            slope = n as f64 * (x * here - before) / (x * x - 1.0);
            x -= here / slope;
        }
        out.extend([x as f32, (2.0 / ((1.0 - x * x) * slope * slope)) as f32]);
    }
    out
}

/// The measure of a disc; `centre` from the mean.
pub(crate) fn disc<'b>(
    lower: &mut Lower<'_, 'b>,
    centre: [Float<'b>; 2],
    radius: Float<'b>,
    spread: &Spread<'b>,
) -> Measure<'b> {
    let function = lower.function("disc", function);
    let results = lower
        .b()
        .call(&function, (centre, radius, spread.covariance));
    results.try_into().expect("a measure")
}
