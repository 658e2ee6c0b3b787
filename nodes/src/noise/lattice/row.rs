//! The filtered kernels of four neighbouring lattice points, summed in a frame in which the
//! filtered Gaussian separates.
//!
//! The kernel is (cos θ (∂ₓₓ − ∂ᵧᵧ) + 2 sin θ ∂ₓᵧ) e^{−dᵀT⁻¹d/2}. With y along a row of the loop,
//! t = T₁₂/T₂₂, p = (T⁻¹)₁₁ and q = 1/T₂₂, the Gaussian is e^{−px′²/2} e^{−qy²/2} in x′ = x − ty, and
//! each of its derivatives is a Hermite polynomial of px′ times one of qy. As ∂ᵧ is there ∂ᵧ − t∂ₓ′,
//! the kernel is a ∂ₓ′ₓ′ + 2b ∂ₓ′ᵧ − c ∂ᵧᵧ with a = (1 − t²) cos θ − 2t sin θ, b = t cos θ + sin θ and
//! c = cos θ: three sums over the four points a column polynomial give every derivative.

use super::address::Address;
use crate::noise::hash::direction;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// The orders along x′ and y of the noise and its derivatives, up to `most`.
pub(super) fn orders(most: usize) -> Vec<[usize; 2]> {
    let of = |order: usize| (0..=order).map(move |y| [order - y, y]);
    (0..=most).flat_map(of).collect()
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
    /// t.
    pub(super) shear: Value,
    /// ±(1 − t²), ±t and ∓1 for cos θ, and 2t: the lower signs where the rows lie along x.
    pub(super) turn: [Value; 4],
    /// p, q.
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
            turn: ["turn_even", "turn_lean", "turn_level", "turn_steep"]
                .map(|name| b.param_f32(name)),
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
        all.push(self.shear);
        all.extend(self.turn);
        all.extend([p, q, self.decay, self.outer_row]);
        all.extend(self.outer);
        all
    }
}

/// One lattice row, the body of a fold over rows.
pub(super) fn row(module: &mut Module, count: usize, tiles: bool) -> FunctionRef {
    let orders = orders(count);
    let most = 2 + count;
    let doc = "The filtered kernels of one lattice row.";
    let mut builder = Builder::new("lattice_row", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = (0..orders.len())
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

    let [even, lean, minus, twice] = frame.turn;
    let mut columns: [Vec<Value>; 3] = Default::default();
    let mut v = b.add(v, p);
    for (key, envelope) in keys.into_iter().zip(envelopes) {
        let hash = b.scramble(key);
        let [cosine, sine] = direction(b, hash);
        let polynomials = derivatives(b, envelope, v, p, most);
        let (level, slope) = (b.mul(even, cosine), b.mul(twice, sine));
        let across = b.sub(level, slope);
        let level = b.mul(lean, cosine);
        let mixed = b.add(level, sine);
        for (sums, (turn, first)) in
            (columns.iter_mut()).zip([(across, 2), (mixed, 1), (cosine, 0)])
        {
            let parts = polynomials[first..=first + count].iter();
            let parts: Vec<Value> = parts.map(|&g| b.mul(turn, g)).collect();
            *sums = match sums.is_empty() {
                true => parts,
                false => (sums.iter().zip(parts))
                    .map(|(&s, part)| b.add(s, part))
                    .collect(),
            };
        }
        v = b.sub(v, p);
    }
    let rows = derivatives(b, one, w, q, most);
    let [across, mixed, level] = columns;
    for (i, (&[x, y], &sum)) in orders.iter().zip(&sums).enumerate() {
        let double = b.add(rows[y + 1], rows[y + 1]);
        let steep = b.mul(minus, rows[y + 2]);
        let columns = [across[x], mixed[x], level[x]];
        let part = b.dot(&columns, &[rows[y], double, steep]);
        let sum = b.add(sum, part);
        b.result(format!("sum_{i}"), sum);
    }
    builder.finish(module)
}
