//! Figures whose edge is a ramp of the distance from it.
//!
//! With P the measure of the sharp figure, X the signed distance as a Gaussian along the normal, S a
//! step and R the ramp, the mean is P + E[R(X)] − E[S(X)]. A straight edge has P = E[S(X)], so that the
//! ramp alone is left, which is exact; a footprint that is wide against the ramp has E[R] = E[S], and
//! the measure alone is left, which is exact as well. X has the mean and the variance that the distance
//! from the figure's centre gives it, so that a ramp that is wide against figure and footprint, of which
//! the mean of X is left alone, is exact too:
//! there P − E[S] no longer counts.

use super::measure::Measure;
use super::region::{Axes, Outline};
use super::separable::rest;
use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2};
use mipless_codegen::moments::{Mode, Normal};

/// Where the edge is from the mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge<'b> {
    /// The signed distance, positive inside.
    pub(crate) distance: Float<'b>,
    /// Its gradient, of length 1.
    pub(crate) normal: Vec2<'b>,
    /// The distance from the centre of what the edge goes around.
    pub(crate) centre: Float<'b>,
    /// The size of what has corners, against which a ramp must be wide as well; none of a circle.
    pub(crate) size: Option<Float<'b>>,
}

/// No ramp is narrower than this, in units of the position: hinges keep their digits.
const NARROWEST: f32 = 1e-5;

/// The width of a ramp, which divides.
pub(crate) fn width(width: Float<'_>) -> Float<'_> {
    width.max(NARROWEST)
}

impl<'b> Edge<'b> {
    /// Of a disc around `back`, the centre from the mean.
    pub(crate) fn of_disc(back: [Float<'b>; 2], radius: Float<'b>) -> Self {
        let (length, away) = direction(back, Vec2(back).norm2());
        Self {
            distance: radius - length,
            normal: away,
            centre: length,
            size: None,
        }
    }

    /// The mean and the variance of the distance over a footprint, and how much of a step along the normal
    /// the mean follows.
    ///
    /// With c the distance of the footprint from the centre, T its trace, a² its variance along the
    /// normal, the mean of the distance from the centre is √(c² + T − v), v its variance: a² − O(1/c²)
    /// far away (Rice 1945, *Mathematical Analysis of Random Noise*, §3.10), at the centre (1 − π/4) T of a
    /// round footprint and (1 − 2/π) T of a line. Of a round footprint the mean is within 0.013 of its
    /// standard deviation everywhere. Where a long one crosses the centre, and where the edge has corners,
    /// the distance is far from Gaussian: as much of this counts as `wide` says, else the distance is that
    /// from a straight edge.
    fn seen_from(&self, spread: &Spread<'b>, wide: Float<'b>) -> (Float<'b>, Float<'b>, Float<'b>) {
        let [xx, xy, yy] = *spread.covariance;
        let along = self.normal.dot(spread.covariance.times(self.normal));
        // The square of what is added is a normal number in f32: of no footprint nothing is 0/0.
        let total = xx + yy + 1e-18;
        // 1 if round, 0 if a line.
        let round = ((xx * yy - xy.square()) * 4.0 / total.square()).clamp(0.0, 1.0);
        let least = total * (0.363_380_2 - 0.148_778_4 * round);
        let square = (self.centre.square() * 2.0 / total).min(100.0);
        let near = (square * -0.15 - square.square() * 0.261).exp();
        let far = square * 1.141_6 - 1.1 + 2.1 * near;
        let variance = (along - (along - least) / far).max(0.0);
        let mean = (self.centre.square() + (total - variance).max(0.0)).sqrt();
        (
            self.distance + wide * (self.centre - mean),
            along + wide * (variance - along),
            1.0 + wide * ((self.centre / mean).min(1.0) - 1.0),
        )
    }

    /// Of a polygon; its axes as [`Outline::measure`] takes them.
    pub(crate) fn of_polygon(
        lower: &mut Lower<'_, 'b>,
        outline: &Outline,
        axes: Axes<'b>,
        centre: Float<'b>,
    ) -> Self {
        let size = Vec2(axes[1]).norm2().sqrt();
        let key = format!("outline distance {outline:?}");
        let function = lower.function(&key, |module| nearest(module, outline));
        let b = lower.b();
        let count = b.uint(outline.vertices.len() as u32);
        let start = [f32::MAX, 0.0, 0.0, 0.0].map(|x| b.float(x));
        let [square, x, y, parity] = b.fold(&function, count, start, axes);
        // Outside, the distance grows away from the nearest point, and is negative.
        let (length, towards) = direction([x, y], square);
        let inside = parity.gt(0.5);
        Self {
            distance: inside.select(length, -length),
            normal: towards.map(|v| inside.select(-v, v)),
            centre,
            size: Some(size),
        }
    }
}

/// A vector's length and direction, from its square.
fn direction<'b>([x, y]: [Float<'b>; 2], square: Float<'b>) -> (Float<'b>, Vec2<'b>) {
    let length = square.sqrt();
    let directed = length.gt(0.0);
    let guarded = directed.select(length, 1.0);
    let direction = [directed.select(x / guarded, 1.0), y / guarded];
    (length, Vec2(direction))
}

/// The body of a fold over the edges of a polygon: the least squared distance from the origin, the
/// point where it is, and the parity of the edges that a ray meets.
fn nearest(module: &mut Module, outline: &Outline) -> FunctionRef {
    let table = module.table("outline", outline.rows());
    let b = &Builder::new("outline_distance", "The nearest point of one more edge.");
    let index = b.uint_param("index");
    let names = ["square", "near_x", "near_y", "parity"];
    let [least, near_x, near_y, parity] = names.map(|name| b.float_param(name));
    let axes = Outline::declare_axes(b);
    let first = index * 3;
    let [start, end] = [0, 3].map(|from: u32| {
        let numbers = [0, 1, 2].map(|i: u32| b.load(table, first + (from + i)));
        Vec2(super::region::vertex(numbers, axes))
    });

    // The nearest point of the edge.
    let along = end - start;
    let share = (-along.dot(start) / (along.norm2() + 1e-30)).clamp(0.0, 1.0);
    let place = start + along.map(|x| share * x);
    let distance = place.norm2();
    let nearer = distance.lt(least);

    // As of `Outline::holds`.
    let ([x1, y1], [x2, y2]) = (*start, *end);
    let [up, down] = [y1, y2].map(|y| y.gt(0.0).select(1.0, 0.0));
    let cross = x1 * y2 - x2 * y1;
    let meets = (cross * (down - up)).gt(0.0);
    let results = [
        nearer.select(distance, least),
        nearer.select(place[0], near_x),
        nearer.select(place[1], near_y),
        meets.select(1.0 - parity, parity),
    ];
    b.results(names, results);
    b.finish(module)
}

/// E of a ramp at a distance with this standard deviation, and its first and second derivative:
/// (E[max(x + w/2, 0)] − E[max(x − w/2, 0)])/w and so on.
fn ramp<'b>(at: Float<'b>, width: Float<'b>, [sd, inverse]: [Float<'b>; 2]) -> [Float<'b>; 3] {
    // Narrower ones blur no less, and their hinges lose their digits.
    let width = width.max(sd * 0.02);
    let half = width * 0.5;
    let inverse_width = 1.0 / width;
    let (start, end) = (at + half, at - half);
    let [n, m] = [start, end].map(|place| Normal::at(place, inverse));
    let mean = (n.hinge(start, sd) - m.hinge(end, sd)) * inverse_width;
    // Beyond the ramp two large hinges differ by its width, less their roundings.
    let mean = m.z.gt(6.0).select(1.0, mean);
    [
        mean,
        (n.below - m.below) * inverse_width,
        (n.density - m.density) * inverse * inverse_width,
    ]
}

/// The value of the ramp at a point.
pub(crate) fn value<'b>(edge: &Edge<'b>, width: Float<'b>) -> Float<'b> {
    (edge.distance / width + 0.5).clamp(0.0, 1.0)
}

/// The field of a figure with a ramp, from the measure of the sharp one.
pub(crate) fn field<'b>(
    mode: Mode,
    measure: Measure<'b>,
    edge: &Edge<'b>,
    width: Float<'b>,
    spread: &Spread<'b>,
) -> Field<'b> {
    let Edge { normal, .. } = *edge;
    // 1 where the ramp is wide against the footprint: the sharp figure does not matter then.
    let [xx, _, yy] = *spread.covariance;
    let fourth = |square: Float<'b>| (square / width.square()).min(1e9).square().square();
    let wide = 1.0 / (1.0 + fourth(12.0 * (xx + yy)));
    let wide = (edge.size).map_or(wide, |size| wide / (1.0 + fourth(4.0 * size.square())));
    let sharp = 1.0 - wide;
    let (distance, variance, kept) = edge.seen_from(spread, wide);
    let sd = (variance + 1e-12).sqrt();
    let inverse = 1.0 / sd;
    let step = Normal::at(distance, inverse);
    let soft = ramp(distance, width, [sd, inverse]);

    // What the ramp is more than a step.
    let density = step.density * inverse;
    let slope = kept * (soft[1] - sharp * density);
    let bend = kept.square() * (soft[2] + sharp * step.z * density * inverse);
    let [value, dx, dy, hxx, hxy, hyy] = measure.map(|part| part * sharp);
    let value = value.clamp(0.0, 1.0);
    let zero = value.literal(0.0);
    let mut field = Field {
        mean: (value + (soft[0] - sharp * step.below)).clamp(0.0, 1.0),
        gradient: Vec2::splat(zero),
        hessian: Sym2::splat(zero),
        rest: zero,
    };
    if matches!(mode, Mode::Local | Mode::Quad) {
        field.gradient = Vec2([dx, dy]).zip(normal, |d, n| d + slope * n);
    }
    if mode == Mode::Quad {
        field.hessian = Sym2([hxx, hxy, hyy]).zip(normal.outer(), |h, o| h + bend * o);
    }
    if mode.spreads() {
        // E[R²] = P + E[R²(X)] − E[S(X)]: a squared ramp rises later by w/6, within 0.816 of the
        // spread. Within the ramp its linear response is all there is.
        let later = distance + width * (-1.0 / 6.0);
        let squared = ramp(later, width * 0.816_496_6, [sd, inverse]);
        let second = value + (squared[0] - sharp * step.below);
        let total = second - field.mean.square();
        let left = rest(&mut field, spread, total);
        let share = variance / (variance + width.square() * 0.16 + 1e-12);
        field.rest = left * share;
    }
    field
}
