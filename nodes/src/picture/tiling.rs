//! The tiles of a triangle lattice over an example, and how they blend.
//!
//! With p in examples, the lattice is s = (4x − 2y, 4y): integers, so that cells stay exact far from the
//! origin and an integer period of examples is one of the lattice. Its triangles have sides of ¼ and
//! 0.28 examples, nearly those of Heitz & Neyret 2018 (0.289).

use mipless_codegen::ir::{Float, Int, Vec2, dot};

/// How tiles are laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tiling {
    /// Whole examples after which all repeats, or 0.
    pub(crate) period: [f32; 2],
    /// Selects the shifts.
    pub(crate) seed: i32,
}

/// One of the three tiles at a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile<'b> {
    /// Where it reads the example, from 0 to 1.
    pub(crate) place: [Float<'b>; 2],
    /// Its weight; the squares of the three are 1.
    pub(crate) weight: Float<'b>,
    /// The change of the weight an example along x and y.
    pub(crate) slope: Vec2<'b>,
}

impl Tiling {
    /// The tiles at an offset, in examples, from a place: a cell and the rest along each axis.
    pub(crate) fn tiles<'b>(
        self,
        [(cell_x, x), (cell_y, y)]: [(Int<'b>, Float<'b>); 2],
        offset: Vec2<'b>,
    ) -> [Tile<'b>; 3] {
        let (x, y) = (x + offset[0], y + offset[1]);
        let (first, second) = (x * 4.0 + y * -2.0, y * 4.0);
        let (i, j) = (first.floor(), second.floor());
        let (f, g) = (first - i, second - j);
        let both = f + g;
        let upper = both.gt(1.0);
        // Barycentric coordinates of (0, 0) or (1, 1), (1, 0), (0, 1).
        let shares = [
            upper.select(both + -1.0, 1.0 - both),
            upper.select(1.0 - g, f),
            upper.select(1.0 - f, g),
        ];
        // Their changes with s: (±1, ±1), then that of f or of −g, then that of g or of −f.
        let sign = upper.select(1.0f32, -1.0);
        let along_f = upper.select(0.0f32, 1.0);
        let along_g = upper.select(-1.0f32, 0.0);
        let slopes = [[sign, sign], [along_f, along_g], [along_g, along_f]]
            .map(|[p, q]| Vec2([p * 4.0, p * -2.0 + q * 4.0]));
        let inverse = 1.0 / dot(shares, shares).sqrt();
        let weights = shares.map(|share| share * inverse);
        // The change of |b|.
        let growth = Vec2([0, 1].map(|axis| dot(weights, slopes.map(|slope| slope[axis]))));

        let i = i.to_int() + (cell_x * 4 - cell_y * 2);
        let j = j.to_int() + cell_y * 4;
        let (none, more) = (i.literal(0), i.literal(1));
        let corner = upper.select(more, none);
        let corners = [[corner, corner], [more, none], [none, more]];
        [0, 1, 2].map(|k| {
            let [shift_x, shift_y] = self.shift([i + corners[k][0], j + corners[k][1]]);
            Tile {
                place: [x + shift_x, y + shift_y].map(|at| at - at.floor()),
                weight: weights[k],
                slope: (slopes[k] - growth * weights[k]) * inverse,
            }
        })
    }

    /// Where a lattice point reads the example, from 0 to 1.
    fn shift<'b>(self, point: [Int<'b>; 2]) -> [Float<'b>; 2] {
        let [i, j] = self.wrapped(point).map(|i| i.to_uint());
        let first = (i ^ (self.seed as u32 ^ 0x5bd1_e995)).scramble();
        let first = (first ^ j).scramble();
        let second = (first ^ 0x2545_f491).scramble();
        [first, second].map(|hash| (hash >> 8).to_float() * (1.0 / (1u32 << 24) as f32))
    }

    /// The lattice point within the period that has the same shift: a period of v is 4 rows, and
    /// moves rows by 2.
    fn wrapped<'b>(self, [mut i, mut j]: [Int<'b>; 2]) -> [Int<'b>; 2] {
        let [across, down] = self.period;
        let periods = |i: Int<'b>, period: f32| {
            let place = (i.to_float() + 0.5) * (0.25 / period);
            place.floor().to_int()
        };
        if down >= 1.0 {
            let count = periods(j, down);
            i += count * (2 * down as i32);
            j -= count * (4 * down as i32);
        }
        if across >= 1.0 {
            i -= periods(i, across) * (4 * across as i32);
        }
        [i, j]
    }
}
