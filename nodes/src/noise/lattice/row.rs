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
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Scalar, Scalars, Uint, dot};

/// The orders along x′ and y of the noise and its derivatives, up to `most`.
pub(super) fn orders(most: usize) -> Vec<[usize; 2]> {
    let of = |order: usize| (0..=order).map(move |y| [order - y, y]);
    (0..=most).flat_map(of).collect()
}

/// g₀, g₁, …, gₙ for g₀ = `envelope`: gₙ = (−1)ⁿ ∂ⁿ of a Gaussian of precision `p`, where `v` is
/// p times the offset.
fn derivatives<'b>(
    envelope: Float<'b>,
    v: Float<'b>,
    p: Float<'b>,
    order: usize,
) -> Vec<Float<'b>> {
    let mut all = vec![envelope, v * envelope];
    for n in 2..=order {
        all.push(v * all[n - 1] - p * (n - 1) as f32 * all[n - 2]);
    }
    all
}

/// What the rows of an octave share, in the order of the captures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<'b> {
    /// The position, relative to the cell.
    pub(super) x: Float<'b>,
    /// The offset of the position to the first row.
    pub(super) y: Float<'b>,
    /// The lattice, its rows counted from the first one.
    pub(super) address: Address<'b>,
    /// t.
    pub(super) shear: Float<'b>,
    /// ±(1 − t²), ±t and ∓1 for cos θ, and 2t: the lower signs where the rows lie along x.
    pub(super) turn: [Float<'b>; 4],
    /// p, q.
    pub(super) precisions: [Float<'b>; 2],
    /// e^{−p}.
    pub(super) decay: Float<'b>,
    /// The row that counts in part only, and the weight of it and of the outermost column.
    pub(super) outer_row: Uint<'b>,
    pub(super) outer: [Float<'b>; 2],
}

impl<'b> Frame<'b> {
    fn declare(b: &'b Builder, tiles: bool) -> Self {
        Self {
            x: b.float_param("x"),
            y: b.float_param("y"),
            address: Address::declare(b, tiles),
            shear: b.float_param("shear"),
            turn: b.float_params(["turn_even", "turn_lean", "turn_level", "turn_steep"]),
            precisions: b.float_params(["p", "q"]),
            decay: b.float_param("decay"),
            outer_row: b.uint_param("outer_row"),
            outer: b.float_params(["outer_x", "outer_y"]),
        }
    }

    /// All of it, in the order of the parameters.
    pub(super) fn captures(&self) -> Vec<Scalar<'b>> {
        let place = (self.x, self.y, self.address);
        let shape = (self.shear, self.turn, self.precisions, self.decay);
        (place, shape, (self.outer_row, self.outer)).scalars()
    }
}

/// One lattice row, the body of a fold over rows.
pub(super) fn row(module: &mut Module, count: usize, tiles: bool) -> FunctionRef {
    let orders = orders(count);
    let most = 2 + count;
    let doc = "The filtered kernels of one lattice row.";
    let b = &Builder::new("lattice_row", doc);
    let index = b.uint_param("index");
    let sums: Vec<Float<'_>> = (0..orders.len())
        .map(|i| b.float_param(format!("sum_{i}")))
        .collect();
    let frame = Frame::declare(b, tiles);
    let [p, q] = frame.precisions;

    // The row's largest envelope lies where x′ is 0.
    let dy = frame.y - index.to_float();
    let w = dy * q;
    let centre = frame.x - frame.shear * dy;
    let middle = centre.floor();
    let x = centre - middle;
    let keys = frame.address.keys(index, middle + -1.0, 4);

    // The envelopes at x′ = x + 1, x, x − 1 and x − 2: two exponentials, the rest by ratios.
    let v = p * x;
    let is_outer = index.equals(frame.outer_row);
    let near = ((x * v + dy * w) * -0.5).exp() * is_outer.select(frame.outer[1], 1.0);
    let ratio = (v - p * 0.5).exp();
    let next = near * ratio;
    let last = next * (ratio * frame.decay);
    let first = near * (frame.decay / ratio);
    // The nearest three columns count in full, as in the unfiltered noise.
    let right = (x + 0.5).ge(1.0);
    let envelopes = [
        first * right.select(frame.outer[0], 1.0),
        near,
        next,
        last * right.select(1.0, frame.outer[0]),
    ];

    // Three sums over the columns give every derivative along x′.
    let [even, lean, minus, twice] = frame.turn;
    let mut columns: [Vec<Float<'_>>; 3] = Default::default();
    let mut v = v + p;
    for (key, envelope) in keys.into_iter().zip(envelopes) {
        let [cosine, sine] = direction(key.scramble());
        let polynomials = derivatives(envelope, v, p, most);
        let across = even * cosine - twice * sine;
        let mixed = lean * cosine + sine;
        for (sums, (turn, first)) in
            (columns.iter_mut()).zip([(across, 2), (mixed, 1), (cosine, 0)])
        {
            let parts = polynomials[first..=first + count].iter();
            let parts: Vec<Float<'_>> = parts.map(|&g| turn * g).collect();
            *sums = match sums.is_empty() {
                true => parts,
                false => sums
                    .iter()
                    .zip(parts)
                    .map(|(&sum, part)| sum + part)
                    .collect(),
            };
        }
        v -= p;
    }
    let rows = derivatives(b.float(1.0), w, q, most);
    let [across, mixed, level] = columns;
    for (i, (&[x, y], &sum)) in orders.iter().zip(&sums).enumerate() {
        let columns = [across[x], mixed[x], level[x]];
        let part = dot(
            columns,
            [rows[y], rows[y + 1] + rows[y + 1], minus * rows[y + 2]],
        );
        b.result(format!("sum_{i}"), sum + part);
    }
    b.finish(module)
}
