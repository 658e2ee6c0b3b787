//! Whole parts: ⌊x⌋ = x − the sawtooth, and what follows from it.

use super::super::{Algebra, Gaussian, Moments, Signal, Transfer, position};
use super::LinearWave;
use crate::ir::{Builder, Value};

/// ⌊x⌋: the moments of x less those of its fraction; the distortion is the fraction's, since
/// ⌊x⌋ − (1 − α)x = −({x} − αx). Exact for a Gaussian.
#[derive(Clone, Debug)]
pub(in super::super) struct Staircase(LinearWave);

impl Default for Staircase {
    fn default() -> Self {
        Self(LinearWave::sawtooth())
    }
}

impl Transfer for Staircase {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        b.floor(x)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let fraction = self.0.moments(b, x);
        let one = b.f32(1.0);
        Moments {
            mean: b.sub(x.mean, fraction.mean),
            slope: b.sub(one, fraction.slope),
            curvature: b.neg(fraction.curvature),
            third: b.neg(fraction.third),
            distortion: fraction.distortion,
        }
    }

    fn range(&self, _: &Builder, input: [f32; 2]) -> [f32; 2] {
        input.map(f32::floor)
    }
}

impl Algebra {
    /// ⌊X⌋, the integer cell of a position being whole already.
    pub fn floor(&mut self, x: &Signal) -> Signal {
        let within = Signal {
            cell: None,
            ..x.clone()
        };
        let mut out = self.transfer(&within, &Staircase::default());
        if x.cell.is_some() {
            let b = &mut self.b;
            let zero = b.f32(0.0);
            (out.cell, out.mean) = position::add(b, (x.cell, zero), (None, out.mean));
            out.range = x.range.map(f32::floor);
        }
        out
    }
}
