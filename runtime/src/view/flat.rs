//! A rectangle of texture space, seen straight on.

use super::{Hit, Size};

/// The window (x₀, y₀, x₁, y₁) of texture space fills the picture: pixel (i, j) of W×H is centred
/// on u = x₀ + (i + ½)(x₁ − x₀)/W, v = y₀ + (j + ½)(y₁ − y₀)/H.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat {
    /// x₀, y₀, x₁, y₁, in units of texture space.
    pub window: [f64; 4],
}

impl Default for Flat {
    fn default() -> Self {
        Self {
            window: [0.0, 0.0, 1.0, 1.0],
        }
    }
}

impl Flat {
    pub(super) fn hit(&self, size: Size, [x, y]: [f64; 2]) -> Hit {
        let [x0, y0, x1, y1] = self.window;
        let step = [
            (x1 - x0) / f64::from(size.width),
            (y1 - y0) / f64::from(size.height),
        ];
        Hit {
            uv: [x0 + x * step[0], y0 + y * step[1]],
            du: [step[0], 0.0],
            dv: [0.0, step[1]],
            position: [x0 + x * step[0], y0 + y * step[1], 0.0],
            dx: [step[0], 0.0, 0.0],
            dy: [0.0, step[1], 0.0],
            shade: 1.0,
            coverage: 1.0,
            frame: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            eye: [0.0, 0.0, 1.0],
        }
    }
}
