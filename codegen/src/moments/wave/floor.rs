//! Whole parts: ⌊x⌋ = x − the sawtooth, and what follows from it.

use super::super::{Algebra, Gaussian, Moments, Signal, Transfer, position};
use super::LinearWave;
use crate::ir::{Float, Int};
use std::collections::VecDeque;

/// ⌊x⌋: the moments of x less those of its fraction; the distortion is the fraction's, since
/// ⌊x⌋ − (1 − α)x = −({x} − αx). Exact for a Gaussian.
#[derive(Clone, Debug)]
pub(in super::super) struct Staircase(LinearWave);

impl Default for Staircase {
    fn default() -> Self {
        Self(LinearWave::sawtooth())
    }
}

impl<'b> Transfer<'b> for Staircase {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        x.floor()
    }

    fn is_steep(&self) -> bool {
        true
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let fraction = self.0.moments(x);
        Moments {
            mean: x.mean - fraction.mean,
            slope: 1.0 - fraction.slope,
            curvature: -fraction.curvature,
            third: -fraction.third,
            distortion: fraction.distortion,
        }
    }

    fn range(&self, input: [f32; 2]) -> [f32; 2] {
        input.map(f32::floor)
    }
}

/// What stands for the whole parts of signals.
#[derive(Clone, Debug, Default)]
pub(crate) enum Wholes<'b> {
    /// They themselves.
    #[default]
    Own,
    /// They themselves; the signals are noted.
    Noted(Vec<Signal<'b>>),
    /// These, one after the other, whatever the signals are; whether each is a cell.
    Given(VecDeque<(Int<'b>, bool)>),
}

impl<'b> Algebra<'b> {
    /// ⌊X⌋, the integer cell of a position being whole already.
    pub fn floor(&mut self, x: &Signal<'b>) -> Signal<'b> {
        match &mut self.wholes {
            Wholes::Own => {}
            Wholes::Noted(signals) => signals.push(x.clone()),
            Wholes::Given(wholes) => {
                let (whole, is_cell) = wholes.pop_front().expect("a whole part for each signal");
                if !is_cell {
                    return Signal::certain(whole.to_float());
                }
                return Signal {
                    cell: Some(whole),
                    ..Signal::certain(self.b.float(0.0))
                };
            }
        }
        let within = Signal {
            cell: None,
            ..x.clone()
        };
        let mut out = self.transfer(&within, &Staircase::default());
        if x.cell.is_some() {
            (out.cell, out.mean) = position::add((x.cell, self.b.float(0.0)), (None, out.mean));
            out.range = x.range.map(f32::floor);
        }
        out
    }
}
