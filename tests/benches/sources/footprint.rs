//! Footprints of a given size and shape at places that are spread evenly.

use mipless::Footprint;

/// Standard deviations of the footprints, in wavelengths of the source.
pub(crate) const SIZES: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0];

/// The ratio of the axes, and the direction of the longer one in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    pub(crate) ratio: f64,
    pub(crate) degrees: f64,
}

/// The shapes that are measured.
pub(crate) const SHAPES: [Shape; 4] = [
    Shape::new(1.0, 0.0),
    Shape::new(8.0, 0.0),
    Shape::new(8.0, 20.0),
    Shape::new(8.0, 45.0),
];

impl Shape {
    const fn new(ratio: f64, degrees: f64) -> Self {
        Self { ratio, degrees }
    }

    /// Whether it has no direction.
    pub(crate) fn is_round(self) -> bool {
        self.ratio == 1.0
    }

    /// The axes of a footprint of this shape whose area is that of a round one of `size`.
    pub(crate) fn axes(self, size: f64) -> [[f64; 2]; 2] {
        let (sin, cos) = self.degrees.to_radians().sin_cos();
        let (major, minor) = (size * self.ratio.sqrt(), size / self.ratio.sqrt());
        [[major * cos, major * sin], [-minor * sin, minor * cos]]
    }
}

/// A footprint at a position.
pub(crate) fn footprint(at: [f64; 2], axes: [[f64; 2]; 2]) -> Footprint {
    Footprint {
        cell: at.map(|x| x.floor() as i32),
        uv: at.map(|x| (x - x.floor()) as f32),
        du: axes[0].map(|x| x as f32),
        dv: axes[1].map(|x| x as f32),
    }
}

/// `count` places over a square of side `extent` (the R2 sequence).
pub(crate) fn places(count: usize, extent: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|i| {
            [0.754_877_666_246_69, 0.569_840_290_998_05]
                .map(|step| ((i + 1) as f64 * step).fract() * extent + 0.137 * extent)
        })
        .collect()
}
