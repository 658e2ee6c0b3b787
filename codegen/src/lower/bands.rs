//! Bands of footprints, by their shorter axis: what a texture looks like depends on it.

use super::Arguments;
use crate::ir::{Bool, Float, Vec2};

/// Sizes of pixels that a graph is audited at, in geometric progression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bands {
    /// The first, as log₂ of uv a pixel.
    pub(super) finest: i32,
    /// From one to the next, in octaves.
    pub(super) octaves: i32,
}

impl Bands {
    /// How many there are.
    pub(super) const COUNT: usize = 7;
    /// All of them, as bits.
    pub(super) const ALL: u32 = (1 << Self::COUNT) - 1;

    /// The width of a pixel of a band, in uv.
    pub(super) fn size(self, band: usize) -> f32 {
        ((self.finest + self.octaves * band as i32) as f32).exp2()
    }

    /// From which to which width of a pixel the bands of these bits reach, 0 and infinity where the
    /// first or the last of all is among them: those reach on.
    pub(super) fn sizes(self, bits: u32) -> [f32; 2] {
        let half = (0.5 * self.octaves as f32).exp2();
        let first = bits.trailing_zeros() as usize;
        let last = bits.checked_ilog2().unwrap_or(0) as usize;
        let low = match first {
            0 => 0.0,
            _ => self.size(first) / half,
        };
        let high = match last {
            Self::LAST => f32::INFINITY,
            _ => self.size(last) * half,
        };
        [low, high]
    }

    const LAST: usize = Self::COUNT - 1;

    /// The size of a footprint that is round; √2 times the shorter axis of a long one.
    pub(super) fn shorter<'b>(place: &Arguments<'b>) -> Float<'b> {
        let (right, down) = (place.footprint.right, place.footprint.down);
        let area = (right[0] * down[1] - right[1] * down[0]).abs();
        let squares = Vec2(right).norm2() + Vec2(down).norm2();
        area * std::f32::consts::SQRT_2 / squares.max(1e-30).sqrt()
    }

    /// In which band the footprint lies, counted from 0, as a real number.
    pub(super) fn of<'b>(self, place: &Arguments<'b>) -> Float<'b> {
        let size = Self::shorter(place);
        let octaves = size.clamp(1e-12, 1e12).ln() * std::f32::consts::LOG2_E;
        (octaves - self.finest as f32) * (1.0 / self.octaves as f32)
    }

    /// Whether a footprint's band is one of these bits; what lies beyond the first or the last of all
    /// is theirs.
    pub(super) fn within<'b>(band: Float<'b>, bits: u32) -> Bool<'b> {
        if bits == Self::ALL || bits == 0 {
            return band.builder().literal(bits != 0);
        }
        let nearest = (band + 0.5)
            .clamp(0.0, Self::LAST as f32)
            .to_int()
            .to_uint();
        let b = band.builder();
        ((b.uint(bits) >> nearest) & 1u32).equals(1u32)
    }
}
