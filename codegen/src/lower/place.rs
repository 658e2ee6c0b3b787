//! Where a pixel is: the footprint, and the position in space, as arguments.

use crate::ir::{Bool, Builder, Float, Int, Scalar, Scalars, Type, Uint};
use std::array;

/// The largest change of texture coordinates per pixel that is told apart from an infinite one.
const LARGEST_FOOTPRINT: f32 = 1e9;

/// The farthest rest of a place: integers hold it.
const FARTHEST: f32 = 1e9;

/// Numbers beyond this magnitude are not told apart from infinity.
const LARGEST: f32 = 3e38;

/// A place in as many axes, and how it changes from pixel to pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'b, const AXES: usize> {
    /// The integer parts.
    pub(super) cell: [Int<'b>; AXES],
    /// The rest.
    pub(super) fraction: [Float<'b>; AXES],
    /// The changes to the next pixel to the right.
    pub(super) right: [Float<'b>; AXES],
    /// The changes to the next pixel below.
    pub(super) down: [Float<'b>; AXES],
}

impl<'b, const AXES: usize> Place<'b, AXES> {
    /// The parameters of these names, in the order of the fields.
    pub(super) fn declare(b: &'b Builder, names: &[(&str, Type)]) -> Self {
        let mut names = names.iter().map(|(name, _)| *name);
        let mut next = || names.next().expect("a name for each parameter");
        Self {
            cell: array::from_fn(|_| b.int_param(next())),
            fraction: array::from_fn(|_| b.float_param(next())),
            right: array::from_fn(|_| b.float_param(next())),
            down: array::from_fn(|_| b.float_param(next())),
        }
    }

    /// The origin without a footprint, for what reads neither.
    pub(super) fn origin(b: &'b Builder) -> Self {
        let zeros = [b.float(0.0); AXES];
        Self {
            cell: [b.int(0); AXES],
            fraction: zeros,
            right: zeros,
            down: zeros,
        }
    }

    /// A point without a footprint.
    pub(super) fn at_point(b: &'b Builder, at: [Float<'b>; AXES]) -> Self {
        let whole = at.map(Float::floor);
        Self {
            cell: whole.map(Float::to_int),
            fraction: array::from_fn(|axis| at[axis] - whole[axis]),
            ..Self::origin(b)
        }
    }

    /// Each change through `f`.
    pub(super) fn with_changes(self, f: impl Fn(Float<'b>) -> Float<'b>) -> Self {
        Self {
            right: self.right.map(&f),
            down: self.down.map(&f),
            ..self
        }
    }

    /// With a footprint that is finite: one that is not is taken for the largest, whose filtered values
    /// are the far field's. A rest that is not finite is taken for 0.
    pub(super) fn finite(self) -> Self {
        let within = |x: Float<'b>| x.abs().lt(LARGEST_FOOTPRINT);
        let mut regular: Bool<'b> = self.cell[0].builder().literal(true);
        for change in self.right.into_iter().chain(self.down) {
            regular = regular & within(change);
        }
        // The first axis changes to the right, the second one down.
        let far = |changes: [Float<'b>; AXES], along: usize| {
            array::from_fn(|axis| {
                let far = if axis == along {
                    LARGEST_FOOTPRINT
                } else {
                    0.0
                };
                regular.select(changes[axis], far)
            })
        };
        Self {
            cell: self.cell,
            fraction: (self.fraction).map(|x| {
                x.abs()
                    .lt(LARGEST)
                    .select(x, 0.0)
                    .clamp(-FARTHEST, FARTHEST)
            }),
            right: far(self.right, 0),
            down: far(self.down, 1),
        }
    }

    /// Moved by (x, y) pixels. Pixels may be hundreds of units long: their integer parts join the cell,
    /// and a product with a number of 12 significant bits is made of two exact ones.
    pub(super) fn moved(mut self, pixels: [Float<'b>; 2]) -> Self {
        for axis in 0..AXES {
            for (pixels, length) in pixels.into_iter().zip([self.right[axis], self.down[axis]]) {
                let high = length.high();
                for part in [high, length - high] {
                    let step = pixels * part;
                    let whole = step.floor();
                    self.cell[axis] += whole.to_int();
                    self.fraction[axis] += step - whole;
                }
            }
        }
        self
    }
}

impl<'b> Place<'b, 2> {
    /// A hash of where the pixel is.
    pub(super) fn hashed(self, seed: u32) -> Uint<'b> {
        let ([x, y], [u, v]) = (self.cell, self.fraction);
        let words = [x.to_uint(), y.to_uint(), u.bits(), v.bits()];
        let seed = u.builder().uint(seed);
        (words.into_iter()).fold(seed, |hash, word| (hash ^ word).scramble())
    }
}

/// A place of the unit square that is far from those of other numbers: the R2 sequence (Roberts 2018).
pub(super) fn scattered(number: usize) -> [f64; 2] {
    [0.754_877_666_246_692_8, 0.569_840_290_998_053_2]
        .map(|step| (0.5 + number as f64 * step).fract())
}

impl<'b, const AXES: usize> Scalars<'b> for Place<'b, AXES> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.cell.each(visit);
        [self.fraction, self.right, self.down].each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let cell = self.cell.replaced(next);
        let [fraction, right, down] = [self.fraction, self.right, self.down].replaced(next);
        Self {
            cell,
            fraction,
            right,
            down,
        }
    }
}
