//! The filtered kernels of four neighbouring lattice points, summed in a frame in which the
//! filtered Gaussian separates.
//!
//! The kernel is (cos θ (∂ₓₓ − ∂ᵧᵧ) + 2 sin θ ∂ₓᵧ) e^{−dᵀT⁻¹d/2}. With y along a row of the loop,
//! t = T₁₂/T₂₂, p = (T⁻¹)₁₁ and q = 1/T₂₂, the Gaussian is e^{−px′²/2} e^{−qy²/2} in x′ = x − ty, and
//! each of its derivatives is a Hermite polynomial of px′ times one of qy. Two sums over the four
//! points a column polynomial (with cos θ and with sin θ) therefore give every derivative.

use super::address::Address;
use crate::noise::hash::direction;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// A sum over lattice points: of cos θ or sin θ, times the derivatives of these orders along x′ and y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    /// With cos θ.
    Cosine(usize, usize),
    /// With sin θ.
    Sine(usize, usize),
}

/// The sums that the noise and its first `derivatives` derivatives need.
pub(super) fn moments(derivatives: usize) -> Vec<Moment> {
    let mut all = Vec::new();
    for order in 2..=2 + derivatives {
        all.extend((0..=order).map(|y| Moment::Cosine(order - y, y)));
        all.extend((0..order).map(|y| Moment::Sine(order - y, y)));
    }
    all
}

/// g₀, g₁, …, gₙ for g₀ = `envelope`: gₙ = (−1)ⁿ ∂ⁿ of a Gaussian of precision `p`, where `v` is
/// p times the offset.
fn derivatives(b: &mut Builder, envelope: Value, v: Value, p: Value, order: usize) -> Vec<Value> {
    let mut all = vec![envelope, b.mul(v, envelope)];
    for n in 2..=order {
        let up = b.mul(v, all[n - 1]);
        let factor = b.scale(p, (n - 1) as f32);
        let down = b.mul(factor, all[n - 2]);
        all.push(b.sub(up, down));
    }
    all
}

/// What the rows of an octave share, in the order of the captures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// The position, relative to the cell.
    pub(super) x: Value,
    /// The offset of the position to the first row.
    pub(super) y: Value,
    /// The lattice, its rows counted from the first one.
    pub(super) address: Address,
    /// t, p, q.
    pub(super) shear: Value,
    pub(super) precisions: [Value; 2],
    /// e^{−p}.
    pub(super) decay: Value,
    /// The row that counts in part only, and the weight of it and of the outermost column.
    pub(super) outer_row: Value,
    pub(super) outer: [Value; 2],
}

impl Frame {
    fn declare(b: &mut Builder, tiles: bool) -> Self {
        Self {
            x: b.param_f32("x"),
            y: b.param_f32("y"),
            address: Address::declare(b, tiles),
            shear: b.param_f32("shear"),
            precisions: [b.param_f32("p"), b.param_f32("q")],
            decay: b.param_f32("decay"),
            outer_row: b.param("outer_row", Type::U32),
            outer: [b.param_f32("outer_x"), b.param_f32("outer_y")],
        }
    }

    pub(super) fn captures(&self) -> Vec<Value> {
        let [p, q] = self.precisions;
        let mut all = vec![self.x, self.y];
        all.extend(self.address.captures());
        all.extend([self.shear, p, q, self.decay, self.outer_row]);
        all.extend(self.outer);
        all
    }
}

/// One lattice row, the body of a fold over rows.
pub(super) fn row(module: &mut Module, count: usize, tiles: bool) -> FunctionRef {
    let moments = moments(count);
    let order = 2 + count;
    let doc = "The filtered kernels of one lattice row.";
    let mut builder = Builder::new("lattice_row", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = (0..moments.len())
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let frame = Frame::declare(b, tiles);
    let [p, q] = frame.precisions;
    let one = b.f32(1.0);

    let number = b.float_u(index);
    let dy = b.sub(frame.y, number);
    let w = b.mul(dy, q);
    // The row's largest envelope lies where x′ is 0.
    let lean = b.mul(frame.shear, dy);
    let centre = b.sub(frame.x, lean);
    let middle = b.floor(centre);
    let x = b.sub(centre, middle);
    let start = b.offset(middle, -1.0);
    let keys = frame.address.keys(b, index, start, 4);

    // The envelopes at x′ = x + 1, x, x − 1 and x − 2: two exponentials, the rest by ratios.
    let v = b.mul(p, x);
    let (along, across) = (b.mul(x, v), b.mul(dy, w));
    let exponent = b.add(along, across);
    let exponent = b.scale(exponent, -0.5);
    let near = b.exp(exponent);
    let is_outer = b.eq_u(index, frame.outer_row);
    let weight = b.select(is_outer, frame.outer[1], one);
    let near = b.mul(near, weight);
    let half = b.scale(p, 0.5);
    let exponent = b.sub(v, half);
    let ratio = b.exp(exponent);
    let next = b.mul(near, ratio);
    let last = b.mul(ratio, frame.decay);
    let last = b.mul(next, last);
    let first = b.div(frame.decay, ratio);
    let first = b.mul(near, first);
    // The nearest three columns count in full, as in the unfiltered noise.
    let rounded = b.offset(x, 0.5);
    let right = b.le(one, rounded);
    let (left_weight, right_weight) = (
        b.select(right, frame.outer[0], one),
        b.select(right, one, frame.outer[0]),
    );
    let envelopes = [
        b.mul(first, left_weight),
        near,
        next,
        b.mul(last, right_weight),
    ];

    let mut columns: [Vec<Value>; 2] = [Vec::new(), Vec::new()];
    let mut v = b.add(v, p);
    for (key, envelope) in keys.into_iter().zip(envelopes) {
        let hash = b.scramble(key);
        let turns = direction(b, hash);
        let polynomials = derivatives(b, envelope, v, p, order);
        for (sums, turn) in columns.iter_mut().zip(turns) {
            let parts: Vec<Value> = polynomials.iter().map(|&g| b.mul(turn, g)).collect();
            *sums = match sums.is_empty() {
                true => parts,
                false => (sums.iter().zip(parts))
                    .map(|(&s, part)| b.add(s, part))
                    .collect(),
            };
        }
        v = b.sub(v, p);
    }
    let rows = derivatives(b, one, w, q, order);
    for (i, (&moment, &sum)) in moments.iter().zip(&sums).enumerate() {
        let (column, row) = match moment {
            Moment::Cosine(x, y) => (columns[0][x], rows[y]),
            Moment::Sine(x, y) => (columns[1][x], rows[y]),
        };
        let part = b.mul(column, row);
        let sum = b.add(sum, part);
        b.result(format!("sum_{i}"), sum);
    }
    builder.finish(module)
}
