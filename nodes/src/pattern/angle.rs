//! Angles and distances of uncertain positions.

use mipless_codegen::Lower;
use mipless_codegen::ir::{Float, Sym2, Vec2};
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
pub(crate) fn turns_of<'b>(x: Float<'b>, y: Float<'b>) -> Float<'b> {
    let (wide, high) = (x.abs(), y.abs());
    let t = wide.min(high) / wide.max(high).max(1e-30);
    let square = t.square();
    let sum = (ARCTANGENT.into_iter().rev()).fold(t.literal(0.0), |sum, c| {
        sum * square + (c / std::f64::consts::TAU) as f32
    });
    let octant = sum * t;
    let angle = wide.lt(high).select(0.25 - octant, octant);
    let angle = x.lt(0.0).select(0.5 - angle, angle);
    y.lt(0.0).select(1.0 - angle, angle)
}

/// The angle of the mean of a position, in turns.
pub(crate) fn turns<'b>([x, y]: [&Signal<'b>; 2]) -> Float<'b> {
    turns_of(x.flat_mean(), y.flat_mean())
}

/// The covariance matrix of two signals.
fn covariance<'b>(x: &Signal<'b>, y: &Signal<'b>) -> Sym2<'b> {
    Sym2([x.variance(), x.covariance(y).total, y.variance()])
}

/// The angle in turns and the length of a position.
pub(crate) fn polar<'b>(lower: &mut Lower<'_, 'b>, [x, y]: [&Signal<'b>; 2]) -> [Signal<'b>; 2] {
    let (x, y) = (x.flat(), y.flat());
    let angle = turns_of(x.mean, y.mean);
    let mean = Vec2([x.mean, y.mean]);
    let square = mean.norm2();
    if !lower.mode().spreads() || (x.is_certain() && y.is_certain()) {
        return [angle, square.sqrt()].map(Signal::certain);
    }

    // Along and across the direction of the mean.
    let covariance = covariance(&x, &y);
    let trace = covariance[0] + covariance[2];
    let root = (square + 1e-24).sqrt();
    let towards = mean.map(|v| v / root);
    let along = towards.dot(covariance.times(towards));
    let across = (trace - along).max(0.0);

    // The variance of the length, from that along the mean to a Rayleigh number's.
    let share = square / (square + trace + 1e-24);
    let variance = trace * (0.5 * 0.429_203_7) * (1.0 - share) + along * share;
    let length_mean = (square + (trace - variance).max(0.0) + 1e-24).sqrt();
    // ∂E[r]/∂m = m/E[r].
    let mut length = &x * (x.mean / length_mean) + &y * (y.mean / length_mean);
    let extra = (variance - length.variance()).max(0.0);
    length.mean = length_mean;
    lower.algebra.attach_fresh(&mut length, extra);

    // Var θ = s/(1 + 12 s), of which the linear part is s/(1 + 12 s)².
    let divisor = square + 1e-12;
    let s = (across / (divisor * (4.0 * std::f32::consts::PI.powi(2)))).min(1e6);
    let damping = 1.0 / (s * 12.0 + 1.0);
    let circle = divisor * std::f32::consts::TAU;
    let (ax, ay) = (-(y.mean / circle) * damping, x.mean / circle * damping);
    let mut turned = &x * ax + &y * ay;
    let extra = (s * damping - turned.variance()).max(0.0);
    turned.mean = angle;
    lower.algebra.attach_fresh(&mut turned, extra);
    lower.algebra.bent = true;
    [turned, length]
}

/// A position turned by `amount` · max(1 − |p|/radius, 0)² degrees.
pub(crate) fn swirled<'b>(
    lower: &mut Lower<'_, 'b>,
    [x, y]: [&Signal<'b>; 2],
    amount: Float<'b>,
    radius: Float<'b>,
) -> [Signal<'b>; 2] {
    let (x, y) = (x.flat(), y.flat());
    let mean = Vec2([x.mean, y.mean]);
    let square = mean.norm2();
    let length = (square + 1e-24).sqrt();
    let left = (1.0 - length / radius).max(0.0);
    let strength = amount * (std::f32::consts::PI / 180.0) * left;
    let angle = strength * left;
    let (sine, cosine) = (angle.sin(), angle.cos());
    let [mx, my] = [
        cosine * x.mean - sine * y.mean,
        sine * x.mean + cosine * y.mean,
    ];
    if !lower.mode().spreads() || (x.is_certain() && y.is_certain()) {
        return [mx, my].map(Signal::certain);
    }
    lower.algebra.bent = true;

    // ∇a = −2 · amount · (1 − r/R)/R · p/r.
    let scale = strength / (length * radius) * -2.0;
    let slope = mean.map(|v| scale * v);
    let covariance = covariance(&x, &y);
    let spread = slope.dot(covariance.times(slope)).max(0.0).min(80.0);
    let damping = (spread * -0.5).exp();

    // J = R(a) + R′(a) p ∇aᵀ, with R′(a) p = (−out_y, out_x).
    let mut out = [([cosine, -sine], -my), ([sine, cosine], mx)]
        .map(|([p, q], side)| &x * (p + side * slope[0]) + &y * (q + side * slope[1]));

    // A rotation keeps distances: E|out|² = |p|² + tr Σ.
    let lost = square * (1.0 - damping.square());
    let allowed = covariance[0] + covariance[2] + lost;
    let found = out[0].variance() + out[1].variance();
    let ratio = (allowed / (found.max(allowed) + 1e-24)).sqrt();
    for (signal, mean) in out.iter_mut().zip([mx, my]) {
        *signal = &*signal * ratio;
        signal.mean = mean * damping;
        signal.cell = None;
    }
    out
}
