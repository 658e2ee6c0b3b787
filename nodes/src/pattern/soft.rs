//! Figures whose edge is a ramp of the distance from it.
//!
//! With P the measure of the sharp figure, X the signed distance as a Gaussian along the normal, S a
//! step and R the ramp, the mean is P + E[R(X)] − E[S(X)]. A straight edge has P = E[S(X)], so that the
//! ramp alone is left, which is exact; a footprint that is wide against the ramp has E[R] = E[S], and
//! the measure alone is left, which is exact as well.

use super::measure::Measure;
use super::region::Outline;
use super::separable::rest;
use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Normal};

/// Where the edge is from the mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// The signed distance, positive inside.
    pub(crate) distance: Value,
    /// Its gradient, of length 1.
    pub(crate) normal: [Value; 2],
}

/// No ramp is narrower than this, in units of the position: hinges keep their digits.
const NARROWEST: f32 = 1e-5;

/// The width of a ramp, which divides.
pub(crate) fn width(b: &mut Builder, width: Value) -> Value {
    let least = b.f32(NARROWEST);
    b.max(width, least)
}

impl Edge {
    /// Of a disc around `back`, the centre from the mean.
    pub(crate) fn of_disc(b: &mut Builder, back: [Value; 2], radius: Value) -> Self {
        let square = b.dot(&back, &back);
        let (length, away) = direction(b, back, square);
        Self {
            distance: b.sub(radius, length),
            normal: away,
        }
    }

    /// Of a polygon; its axes as [`Outline::measure`] takes them.
    pub(crate) fn of_polygon(
        lower: &mut Lower<'_>,
        outline: &Outline,
        axes: [[Value; 2]; 4],
    ) -> Self {
        let key = format!("outline distance {outline:?}");
        let function = lower.function(&key, |module| nearest(module, outline));
        let b = lower.b();
        let (far, zero) = (b.f32(f32::MAX), b.f32(0.0));
        let count = b.u32(outline.vertices.len() as u32);
        let captures: Vec<Value> = axes.into_iter().flatten().collect();
        let state = b.fold(&function, count, &[far, zero, zero, zero], &captures);
        // Outside, the distance grows away from the nearest point, and is negative.
        let (length, towards) = direction(b, [state[1], state[2]], state[0]);
        let half = b.f32(0.5);
        let inside = b.lt(half, state[3]);
        let out = b.neg(length);
        let distance = b.select(inside, length, out);
        let normal = towards.map(|v| {
            let away = b.neg(v);
            b.select(inside, away, v)
        });
        Self { distance, normal }
    }
}

/// A vector's length and direction, from its square.
fn direction(b: &mut Builder, vector: [Value; 2], square: Value) -> (Value, [Value; 2]) {
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let length = b.sqrt(square);
    let directed = b.lt(zero, length);
    let guarded = b.select(directed, length, one);
    let [x, y] = vector.map(|v| b.div(v, guarded));
    (length, [b.select(directed, x, one), y])
}

/// The body of a fold over the edges of a polygon: the least squared distance from the origin, the
/// point where it is, and the parity of the edges that a ray meets.
fn nearest(module: &mut Module, outline: &Outline) -> FunctionRef {
    let again = outline.vertices.first();
    let rows: Vec<f32> = (outline.vertices.iter().chain(again))
        .flatten()
        .copied()
        .collect();
    let table = module.table("outline", rows);
    let mut b = Builder::new("outline_distance", "The nearest point of one more edge.");
    let index = b.param("index", Type::U32);
    let [least, near_x, near_y, parity] =
        ["square", "near_x", "near_y", "parity"].map(|name| b.param_f32(name));
    let axes = ["o", "a", "b", "e"]
        .map(|name| [format!("{name}_x"), format!("{name}_y")].map(|name| b.param_f32(name)));
    let three = b.u32(3);
    let first = b.mul_u(index, three);
    let mut vertex = |from: u32| {
        let row = [0, 1, 2].map(|i| {
            let shift = b.u32(from + i);
            let at = b.add_u(first, shift);
            b.load(table, at)
        });
        [0, 1].map(|k| {
            let part = b.dot(&row, &[axes[1][k], axes[2][k], axes[3][k]]);
            b.add(axes[0][k], part)
        })
    };
    let ([x1, y1], [x2, y2]) = (vertex(0), vertex(3));
    let along = [b.sub(x2, x1), b.sub(y2, y1)];
    let square = b.dot(&along, &along);
    let guarded = b.offset(square, 1e-30);
    let share = b.dot(&along, &[x1, y1]);
    let share = b.neg(share);
    let share = b.div(share, guarded);
    let share = b.clamp(share, 0.0, 1.0);
    let place = [(x1, along[0]), (y1, along[1])].map(|(start, along)| {
        let step = b.mul(share, along);
        b.add(start, step)
    });
    let distance = b.dot(&place, &place);
    let nearer = b.lt(distance, least);
    // As of `Outline::holds`.
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let (up, down) = (b.lt(zero, y1), b.lt(zero, y2));
    let (up, down) = (b.select(up, one, zero), b.select(down, one, zero));
    let rises = b.sub(down, up);
    let (p, q) = (b.mul(x1, y2), b.mul(x2, y1));
    let cross = b.sub(p, q);
    let right = b.mul(cross, rises);
    let meets = b.lt(zero, right);
    let other = b.sub(one, parity);
    let results = [
        b.select(nearer, distance, least),
        b.select(nearer, place[0], near_x),
        b.select(nearer, place[1], near_y),
        b.select(meets, other, parity),
    ];
    for (name, value) in ["square", "near_x", "near_y", "parity"]
        .into_iter()
        .zip(results)
    {
        b.result(name, value);
    }
    b.finish(module)
}

/// E of a ramp at a distance with this standard deviation, and its first and second derivative:
/// (E[max(x + w/2, 0)] − E[max(x − w/2, 0)])/w and so on.
fn ramp(b: &mut Builder, at: Value, width: Value, [sd, inverse]: [Value; 2]) -> [Value; 3] {
    // Narrower ones blur no less, and their hinges lose their digits.
    let least = b.scale(sd, 0.02);
    let width = b.max(width, least);
    let half = b.scale(width, 0.5);
    let one = b.f32(1.0);
    let inverse_width = b.div(one, width);
    let (start, end) = (b.add(at, half), b.sub(at, half));
    let (n, m) = (Normal::at(b, start, inverse), Normal::at(b, end, inverse));
    let (up, down) = (n.hinge(b, start, sd), m.hinge(b, end, sd));
    let mean = b.sub(up, down);
    let mean = b.mul(mean, inverse_width);
    // Beyond the ramp two large hinges differ by its width, less their roundings.
    let far = b.f32(6.0);
    let passed = b.lt(far, m.z);
    let mean = b.select(passed, one, mean);
    let slope = b.sub(n.below, m.below);
    let bend = b.sub(n.density, m.density);
    let bend = b.mul(bend, inverse);
    [
        mean,
        b.mul(slope, inverse_width),
        b.mul(bend, inverse_width),
    ]
}

/// The value of the ramp at a point.
pub(crate) fn value(b: &mut Builder, edge: &Edge, width: Value) -> Value {
    let share = b.div(edge.distance, width);
    let share = b.offset(share, 0.5);
    b.clamp(share, 0.0, 1.0)
}

/// The field of a figure with a ramp, from the measure of the sharp one.
pub(crate) fn field(
    lower: &mut Lower<'_>,
    measure: Measure,
    edge: &Edge,
    width: Value,
    spread: &Spread,
) -> Field {
    let mode = lower.mode();
    let b = lower.b();
    let [nx, ny] = edge.normal;
    let [xx, xy, yy] = spread.covariance;
    let (px, py) = (b.dot(&[xx, xy], &[nx, ny]), b.dot(&[xy, yy], &[nx, ny]));
    let variance = b.dot(&[nx, ny], &[px, py]);
    let raised = b.offset(variance, 1e-12);
    let sd = b.sqrt(raised);
    let one = b.f32(1.0);
    let inverse = b.div(one, sd);
    let zero = b.f32(0.0);
    let step = Normal::at(b, edge.distance, inverse);
    let soft = ramp(b, edge.distance, width, [sd, inverse]);
    let mean = b.sub(soft[0], step.below);
    let density = b.mul(step.density, inverse);
    let slope = b.sub(soft[1], density);
    let curved = b.mul(step.z, density);
    let curved = b.mul(curved, inverse);
    let bend = b.add(soft[2], curved);
    let [value, dx, dy, hxx, hxy, hyy] = measure;
    let value = b.clamp(value, 0.0, 1.0);
    let slopes = matches!(mode, Mode::Local | Mode::Quad);
    let bends = mode == Mode::Quad;
    let filtered = b.add(value, mean);
    let mut field = Field {
        mean: b.clamp(filtered, 0.0, 1.0),
        gradient: [zero; 2],
        hessian: [zero; 3],
        rest: zero,
    };
    if slopes {
        field.gradient = [(dx, nx), (dy, ny)].map(|(d, n)| {
            let part = b.mul(slope, n);
            b.add(d, part)
        });
    }
    if bends {
        let outer = [b.square(nx), b.mul(nx, ny), b.square(ny)];
        field.hessian = [(hxx, outer[0]), (hxy, outer[1]), (hyy, outer[2])].map(|(h, o)| {
            let part = b.mul(bend, o);
            b.add(h, part)
        });
    }
    if mode.spreads() {
        // E[R²] = P + E[R²(X)] − E[S(X)]: a squared ramp rises later by w/6, within 0.816 of the
        // spread. Within the ramp its linear response is all there is.
        let later = b.scale(width, -1.0 / 6.0);
        let at = b.add(edge.distance, later);
        let narrower = b.scale(width, 0.816_496_6);
        let squared = ramp(b, at, narrower, [sd, inverse]);
        let beyond = b.sub(squared[0], step.below);
        let second = b.add(value, beyond);
        let square = b.square(field.mean);
        let total = b.sub(second, square);
        let left = rest(b, &mut field, spread, total);
        let wide = b.square(width);
        let wide = b.scale(wide, 0.16);
        let sum = b.add(variance, wide);
        let sum = b.offset(sum, 1e-12);
        let share = b.div(variance, sum);
        field.rest = b.mul(left, share);
    }
    field
}
