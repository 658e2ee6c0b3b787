//! The tiles of a triangle lattice over an example, and how they blend.
//!
//! With p in examples, the lattice is s = (4x − 2y, 4y): integers, so that cells stay exact far from the
//! origin and an integer period of examples is one of the lattice. Its triangles have sides of ¼ and
//! 0.28 examples, nearly those of Heitz & Neyret 2018 (0.289).

use mipless_codegen::ir::{Builder, Value};

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
pub(crate) struct Tile {
    /// Where it reads the example, from 0 to 1.
    pub(crate) place: [Value; 2],
    /// Its weight; the squares of the three are 1.
    pub(crate) weight: Value,
    /// The change of the weight an example along x and y.
    pub(crate) slope: [Value; 2],
}

impl Tiling {
    /// The tiles at an offset, in examples, from the place [cell x, x, cell y, y].
    pub(crate) fn tiles(self, b: &mut Builder, place: &[Value], offset: [Value; 2]) -> [Tile; 3] {
        let [cell_x, x, cell_y, y] = place[..] else {
            panic!("a place is two cells and two fractions")
        };
        let (x, y) = (b.add(x, offset[0]), b.add(y, offset[1]));
        let four = b.scale(x, 4.0);
        let two = b.scale(y, -2.0);
        let first = b.add(four, two);
        let second = b.scale(y, 4.0);
        let (i, j) = (b.floor(first), b.floor(second));
        let (f, g) = (b.sub(first, i), b.sub(second, j));
        let one = b.f32(1.0);
        let both = b.add(f, g);
        let upper = b.lt(one, both);
        // Barycentric coordinates of (0, 0) or (1, 1), (1, 0), (0, 1).
        let (over, under) = (b.offset(both, -1.0), b.sub(one, both));
        let (of_f, of_g) = (b.sub(one, f), b.sub(one, g));
        let shares = [
            b.select(upper, over, under),
            b.select(upper, of_g, f),
            b.select(upper, of_f, g),
        ];
        let minus = b.f32(-1.0);
        let sign = b.select(upper, one, minus);
        let zero = b.f32(0.0);
        // Their changes with s: (±1, ±1), then that of f or of −g, then that of g or of −f.
        let along_f = b.select(upper, zero, one);
        let along_g = b.select(upper, minus, zero);
        let by_s = [[sign, sign], [along_f, along_g], [along_g, along_f]];
        let length = b.dot(&shares, &shares);
        let length = b.sqrt(length);
        let inverse = b.div(one, length);
        let slopes = by_s.map(|[of_first, of_second]| {
            let x = b.scale(of_first, 4.0);
            let (p, q) = (b.scale(of_first, -2.0), b.scale(of_second, 4.0));
            [x, b.add(p, q)]
        });
        let weights = shares.map(|share| b.mul(share, inverse));
        // The change of |b|.
        let growth = [0, 1].map(|axis| b.dot(&weights, &slopes.map(|slope| slope[axis])));
        let (i, j) = (b.trunc_i(i), b.trunc_i(j));
        let (four, two) = (b.i32(4), b.i32(2));
        let (of_x, of_y) = (b.mul_i(cell_x, four), b.mul_i(cell_y, two));
        let whole = b.sub_i(of_x, of_y);
        let i = b.add_i(i, whole);
        let whole = b.mul_i(cell_y, four);
        let j = b.add_i(j, whole);
        let (none, more) = (b.i32(0), b.i32(1));
        let corner = b.select(upper, more, none);
        let corners = [[corner, corner], [more, none], [none, more]];
        [0, 1, 2].map(|k| {
            let vertex = [b.add_i(i, corners[k][0]), b.add_i(j, corners[k][1])];
            let shift = self.shift(b, vertex);
            let place = [(x, shift[0]), (y, shift[1])].map(|(x, shift)| {
                let at = b.add(x, shift);
                let whole = b.floor(at);
                b.sub(at, whole)
            });
            let slope = [0, 1].map(|axis| {
                let shrinks = b.mul(weights[k], growth[axis]);
                let change = b.sub(slopes[k][axis], shrinks);
                b.mul(change, inverse)
            });
            Tile {
                place,
                weight: weights[k],
                slope,
            }
        })
    }

    /// Where a lattice point reads the example, from 0 to 1.
    fn shift(self, b: &mut Builder, [i, j]: [Value; 2]) -> [Value; 2] {
        let [i, j] = self.wrapped(b, [i, j]);
        let (i, j) = (b.cast_u(i), b.cast_u(j));
        let seed = b.u32(self.seed as u32 ^ 0x5bd1_e995);
        let hash = b.xor_u(i, seed);
        let hash = b.scramble(hash);
        let hash = b.xor_u(hash, j);
        let hash = b.scramble(hash);
        let other = b.u32(0x2545_f491);
        let second = b.xor_u(hash, other);
        let second = b.scramble(second);
        [hash, second].map(|hash| {
            let eight = b.u32(8);
            let leading = b.shr_u(hash, eight);
            let number = b.float_u(leading);
            b.scale(number, 1.0 / (1u32 << 24) as f32)
        })
    }

    /// The lattice point within the period that has the same shift: a period of v is 4 rows, and
    /// moves rows by 2.
    fn wrapped(self, b: &mut Builder, [i, j]: [Value; 2]) -> [Value; 2] {
        let [across, down] = self.period;
        let periods = |b: &mut Builder, i: Value, period: f32| {
            let number = b.float_i(i);
            let number = b.offset(number, 0.5);
            let number = b.scale(number, 0.25 / period);
            let number = b.floor(number);
            b.trunc_i(number)
        };
        let (mut i, mut j) = (i, j);
        if down >= 1.0 {
            let count = periods(b, j, down);
            let (rows, columns) = (b.i32(4 * down as i32), b.i32(2 * down as i32));
            let (rows, columns) = (b.mul_i(count, rows), b.mul_i(count, columns));
            (i, j) = (b.add_i(i, columns), b.sub_i(j, rows));
        }
        if across >= 1.0 {
            let count = periods(b, i, across);
            let columns = b.i32(4 * across as i32);
            let columns = b.mul_i(count, columns);
            i = b.sub_i(i, columns);
        }
        [i, j]
    }
}
