//! Angles and distances of uncertain positions.

use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Signal;

/// The arctangent of a number in [0, 1] (Abramowitz & Stegun 4.4.49, error 2e-8), in turns.
const ARCTANGENT: [f64; 9] = [
    1.0,
    -0.333_331_452_8,
    0.199_935_508_5,
    -0.142_088_994_4,
    0.106_562_639_3,
    -0.075_289_640_0,
    0.042_909_613_8,
    -0.016_165_736_7,
    0.002_866_225_7,
];

/// The angle of (x, y) in turns of [0, 1); 0 at the origin.
fn turns_of(b: &mut Builder, x: Value, y: Value) -> Value {
    let (zero, least) = (b.f32(0.0), b.f32(1e-30));
    let (wide, high) = (b.abs(x), b.abs(y));
    let (more, less) = (b.max(wide, high), b.min(wide, high));
    let more = b.max(more, least);
    let t = b.div(less, more);
    let square = b.square(t);
    let mut sum = zero;
    for c in ARCTANGENT.into_iter().rev() {
        sum = b.mul(sum, square);
        sum = b.offset(sum, (c / std::f64::consts::TAU) as f32);
    }
    let octant = b.mul(sum, t);
    let (quarter, half, one) = (b.f32(0.25), b.f32(0.5), b.f32(1.0));
    let steep = b.lt(wide, high);
    let other = b.sub(quarter, octant);
    let angle = b.select(steep, other, octant);
    let left = b.lt(x, zero);
    let other = b.sub(half, angle);
    let angle = b.select(left, other, angle);
    let below = b.lt(y, zero);
    let other = b.sub(one, angle);
    b.select(below, other, angle)
}

/// The angle of the mean of a position, in turns.
pub(crate) fn turns(lower: &mut Lower<'_>, [x, y]: [&Signal; 2]) -> Value {
    let b = lower.b();
    let (x, y) = (x.flat_mean(b), y.flat_mean(b));
    turns_of(b, x, y)
}

/// The angle in turns and the length of a position.
pub(crate) fn polar(lower: &mut Lower<'_>, [x, y]: [&Signal; 2]) -> [Signal; 2] {
    let mode = lower.mode();
    let b = lower.b();
    let (x, y) = (x.flat(b), y.flat(b));
    let angle = turns_of(b, x.mean, y.mean);
    let square = b.dot(&[x.mean, y.mean], &[x.mean, y.mean]);
    if !mode.spreads() || (x.is_certain(b) && y.is_certain(b)) {
        let length = b.sqrt(square);
        return [angle, length].map(|v| Signal::certain(b, v));
    }
    let (vx, vy, c) = (x.variance(b), y.variance(b), x.covariance(b, &y).total);
    let trace = b.add(vx, vy);
    let total = b.add(square, trace);
    let total = b.offset(total, 1e-24);
    // Along and across the direction of the mean.
    let raised = b.offset(square, 1e-24);
    let root = b.sqrt(raised);
    let (ux, uy) = (b.div(x.mean, root), b.div(y.mean, root));
    let (cx, cy) = (b.dot(&[vx, c], &[ux, uy]), b.dot(&[c, vy], &[ux, uy]));
    let along = b.dot(&[ux, uy], &[cx, cy]);
    let across = b.sub(trace, along);
    let zero = b.f32(0.0);
    let across = b.max(across, zero);

    // The variance of the length, from that along the mean to a Rayleigh number's.
    let share = b.div(square, total);
    let one = b.f32(1.0);
    let rest = b.sub(one, share);
    let rayleigh = b.scale(trace, 0.5 * 0.429_203_7);
    let variance = {
        let (near, far) = (b.mul(rayleigh, rest), b.mul(along, share));
        b.add(near, far)
    };
    let mean = b.sub(trace, variance);
    let mean = b.max(mean, zero);
    let mean = b.add(square, mean);
    let raised = b.offset(mean, 1e-24);
    let length_mean = b.sqrt(raised);
    // ∂E[r]/∂m = m/E[r].
    let (rx, ry) = (b.div(x.mean, length_mean), b.div(y.mean, length_mean));
    let of_y = y.scale(b, ry);
    let mut length = x.scale(b, rx).add(b, &of_y);
    let linear = length.variance(b);
    length.mean = length_mean;
    let extra = b.sub(variance, linear);
    let extra = b.max(extra, zero);
    lower.algebra.attach_fresh(&mut length, extra);

    // Var θ = s/(1 + 12 s), of which the linear part is s/(1 + 12 s)².
    let b = lower.b();
    let divisor = b.offset(square, 1e-12);
    let turn = b.scale(divisor, 4.0 * std::f32::consts::PI.powi(2));
    let s = b.div(across, turn);
    let most = b.f32(1e6);
    let s = b.min(s, most);
    let damping = b.scale(s, 12.0);
    let damping = b.offset(damping, 1.0);
    let damping = b.div(one, damping);
    let circle = b.scale(divisor, std::f32::consts::TAU);
    let (ax, ay) = (b.div(y.mean, circle), b.div(x.mean, circle));
    let ax = b.neg(ax);
    let (ax, ay) = (b.mul(ax, damping), b.mul(ay, damping));
    let of_y = y.scale(b, ay);
    let mut angle_signal = x.scale(b, ax).add(b, &of_y);
    let linear = angle_signal.variance(b);
    angle_signal.mean = angle;
    let whole = b.mul(s, damping);
    let extra = b.sub(whole, linear);
    let extra = b.max(extra, zero);
    lower.algebra.attach_fresh(&mut angle_signal, extra);
    lower.algebra.bent = true;
    [angle_signal, length]
}

/// A position turned by `amount` · max(1 − |p|/radius, 0)² degrees.
pub(crate) fn swirled(
    lower: &mut Lower<'_>,
    [x, y]: [&Signal; 2],
    amount: Value,
    radius: Value,
) -> [Signal; 2] {
    let mode = lower.mode();
    let b = lower.b();
    let (x, y) = (x.flat(b), y.flat(b));
    let square = b.dot(&[x.mean, y.mean], &[x.mean, y.mean]);
    let raised = b.offset(square, 1e-24);
    let length = b.sqrt(raised);
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let share = b.div(length, radius);
    let left = b.sub(one, share);
    let left = b.max(left, zero);
    let most = b.scale(amount, std::f32::consts::PI / 180.0);
    let strength = b.mul(most, left);
    let angle = b.mul(strength, left);
    let (sine, cosine) = (b.sin(angle), b.cos(angle));
    let turned = |b: &mut Builder, p: Value, q: Value| {
        let (cp, sq) = (b.mul(cosine, p), b.mul(sine, q));
        let (sp, cq) = (b.mul(sine, p), b.mul(cosine, q));
        [b.sub(cp, sq), b.add(sp, cq)]
    };
    let [mx, my] = turned(b, x.mean, y.mean);
    if !mode.spreads() || (x.is_certain(b) && y.is_certain(b)) {
        return [mx, my].map(|v| Signal::certain(b, v));
    }
    lower.algebra.bent = true;
    let b = lower.b();
    // ∇a = −2 · amount · (1 − r/R)/R · p/r.
    let scale = b.mul(length, radius);
    let scale = b.div(strength, scale);
    let scale = b.scale(scale, -2.0);
    let (dx, dy) = (b.mul(scale, x.mean), b.mul(scale, y.mean));
    let (vx, vy, c) = (x.variance(b), y.variance(b), x.covariance(b, &y).total);
    let (px, py) = (b.dot(&[vx, c], &[dx, dy]), b.dot(&[c, vy], &[dx, dy]));
    let spread = b.dot(&[dx, dy], &[px, py]);
    let spread = b.max(spread, zero);
    let limit = b.f32(80.0);
    let spread = b.min(spread, limit);
    let half = b.scale(spread, -0.5);
    let damping = b.exp(half);
    // J = R(a) + R′(a) p ∇aᵀ, with R′(a) p = (−out_y, out_x).
    let minus_sine = b.neg(sine);
    let minus_my = b.neg(my);
    let rows = [([cosine, minus_sine], minus_my), ([sine, cosine], mx)].map(|([p, q], side)| {
        let (by_x, by_y) = (b.mul(side, dx), b.mul(side, dy));
        [b.add(p, by_x), b.add(q, by_y)]
    });
    let mut out = rows.map(|[p, q]| {
        let (of_x, of_y) = (x.scale(b, p), y.scale(b, q));
        of_x.add(b, &of_y)
    });
    // A rotation keeps distances: E|out|² = |p|² + tr Σ.
    let trace = b.add(vx, vy);
    let shrunk = b.square(damping);
    let lost = b.sub(one, shrunk);
    let lost = b.mul(square, lost);
    let allowed = b.add(trace, lost);
    let found = {
        let (p, q) = (out[0].variance(b), out[1].variance(b));
        b.add(p, q)
    };
    let found = b.max(found, allowed);
    let found = b.offset(found, 1e-24);
    let ratio = b.div(allowed, found);
    let ratio = b.sqrt(ratio);
    for (signal, mean) in out.iter_mut().zip([mx, my]) {
        let mean = b.mul(mean, damping);
        *signal = signal.scale(b, ratio);
        signal.mean = mean;
        signal.cell = None;
    }
    out
}
