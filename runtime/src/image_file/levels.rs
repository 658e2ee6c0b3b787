//! Numbers as levels of 8 and 16 bits, to the nearest.
//!
//! The sRGB curve has a power, which for a large picture takes longer than the picture. So a level is
//! found by its bounds: the linear numbers half-way (in sRGB) between neighbouring levels, which are
//! worked out once. A table over the leading bits of the number says where to begin.

use super::Space;
use crate::srgb::linear_in_f64;

/// Bits of an f32 below its sign that the table is by: 8 of the exponent and 7 of the mantissa.
const SHIFT: u32 = 16;
/// The leading bits of 1.
const ONE: usize = (1.0f32.to_bits() >> SHIFT) as usize;

/// Where sRGB levels begin.
#[derive(Debug)]
pub(super) struct Levels {
    eight: Bounds,
    sixteen: Bounds,
}

impl Levels {
    pub(super) fn new() -> Self {
        Self {
            eight: Bounds::new(255),
            sixteen: Bounds::new(65_535),
        }
    }

    /// The level of 0 to 255.
    pub(super) fn eight(&self, space: Space, x: f32) -> u8 {
        match space {
            Space::Srgb => self.eight.level(x) as u8,
            // A NaN converts to 0, as all that is below it does.
            Space::Linear => (x.clamp(0.0, 1.0) * 255.0).round() as u8,
        }
    }

    /// The level of 0 to 65535.
    pub(super) fn sixteen(&self, space: Space, x: f32) -> u16 {
        match space {
            Space::Srgb => self.sixteen.level(x),
            Space::Linear => (x.clamp(0.0, 1.0) * 65_535.0).round() as u16,
        }
    }
}

#[derive(Debug)]
struct Bounds {
    /// The least number of each level; that behind the last is infinite.
    least: Vec<f32>,
    /// For numbers with these leading bits, the level of the least of them.
    starts: Vec<u16>,
}

impl Bounds {
    fn new(levels: u16) -> Self {
        let least: Vec<f32> = (0..=levels)
            .map(|level| match level {
                0 => 0.0,
                _ => linear_in_f64((f64::from(level) - 0.5) / f64::from(levels)) as f32,
            })
            .chain([f32::INFINITY])
            .collect();
        let starts = (0..=ONE).map(|bits| {
            let x = f32::from_bits((bits as u32) << SHIFT);
            (least.partition_point(|bound| *bound <= x) - 1) as u16
        });
        Self {
            starts: starts.collect(),
            least,
        }
    }

    fn level(&self, x: f32) -> u16 {
        // Of a NaN too it is 0.
        let x = if x > 0.0 { x.min(1.0) } else { 0.0 };
        let bits = (x.to_bits() >> SHIFT) as usize;
        let first = usize::from(self.starts[bits]);
        let last = usize::from(self.starts[(bits + 1).min(ONE)]);
        let mut level = first;
        if last - first > 4 {
            // Within a step of the table the curve is so nearly straight that its chord is off by less
            // than a level or two of the finest.
            let low = f32::from_bits((bits as u32) << SHIFT);
            let high = f32::from_bits((bits as u32 + 1) << SHIFT);
            let share = (x - low) / (high - low);
            level = first + (share * (last - first) as f32) as usize;
            while x < self.least[level] {
                level -= 1;
            }
        }
        while x >= self.least[level + 1] {
            level += 1;
        }
        level as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::srgb::srgb_from_linear;

    #[test]
    fn levels_are_the_nearest() {
        let levels = Levels::new();
        let mut numbers: Vec<f32> = (0..=200_000).map(|i| i as f32 / 200_000.0).collect();
        numbers.extend((0..2000).map(|i| (f32::from(i as u16) * -0.02).exp2()));
        for x in numbers {
            let exact = srgb_from_linear(x);
            let (eight, sixteen) = (levels.eight(Space::Srgb, x), levels.sixteen(Space::Srgb, x));
            // What lies half-way to the last digit of an f32 may fall to either side.
            assert!((f32::from(eight) - exact * 255.0).abs() < 0.5001, "{x}");
            assert!((f32::from(sixteen) - exact * 65_535.0).abs() < 0.51, "{x}");
        }
        for (x, level) in [
            (-1.0, 0),
            (f32::NAN, 0),
            (1.0, 65_535),
            (2.0, 65_535),
            (0.0, 0),
        ] {
            assert_eq!(levels.sixteen(Space::Srgb, x), level, "{x}");
            assert_eq!(levels.sixteen(Space::Linear, x), level, "{x}");
        }
        assert_eq!(levels.eight(Space::Srgb, f32::INFINITY), 255);
    }
}
