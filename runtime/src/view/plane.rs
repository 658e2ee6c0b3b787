//! An endless plane in perspective, to the horizon.

use super::{Hit, Size};

/// A pinhole camera above a textured plane. u grows to the right and v towards the viewer, as in
/// the flat view; the point of the plane below the camera is the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// How far below the top of the picture the horizon lies, as a share of its height.
    pub horizon: f64,
    /// The vertical field of view in degrees, between 0 and 180.
    pub field_of_view: f64,
    /// The height of the camera above the plane, in units of texture space. By default the lower
    /// edge of a 16:9 picture is 2.6 units wide.
    pub height: f64,
}

impl Default for Plane {
    fn default() -> Self {
        Self {
            horizon: 0.3,
            field_of_view: 50.0,
            height: 1.0,
        }
    }
}

/// The direction of a ray, not normalised, with its change for one pixel down.
struct Ray {
    right: f64,
    down: f64,
    forward: f64,
    down_per_row: f64,
    forward_per_row: f64,
    right_per_column: f64,
}

impl Ray {
    fn length(&self) -> f64 {
        (self.right.powi(2) + self.down.powi(2) + self.forward.powi(2)).sqrt()
    }
}

impl Plane {
    fn ray(&self, size: Size, [x, y]: [f64; 2]) -> Ray {
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        let half = (self.field_of_view.to_radians() / 2.0).tan();
        let pixel = 2.0 * half / height;
        // The horizon is where a level ray meets the picture, which fixes the camera's pitch.
        let pitch = ((1.0 - 2.0 * self.horizon) * half).atan();
        let (sin, cos) = pitch.sin_cos();
        let (right, below) = ((x - width / 2.0) * pixel, (y - height / 2.0) * pixel);
        Ray {
            right,
            down: below * cos + sin,
            forward: cos - below * sin,
            down_per_row: pixel * cos,
            forward_per_row: -pixel * sin,
            right_per_column: pixel,
        }
    }

    pub(super) fn hit(&self, size: Size, point: [f64; 2]) -> Option<Hit> {
        let ray = self.ray(size, point);
        // Closer to the horizon than this, f64 itself no longer knows the position to a pixel.
        if ray.down < 1e-9 {
            return None;
        }
        let distance = self.height / ray.down;
        let (u, v) = (ray.right * distance, -ray.forward * distance);
        // The derivative of a/b is (a′ − (a/b) b′)/b.
        let per_row = ray.down_per_row / ray.down;
        let du = [ray.right_per_column * distance, 0.0];
        let dv = [-u * per_row, -ray.forward_per_row * distance - v * per_row];
        Some(Hit {
            uv: [u, v],
            du,
            dv,
            position: [u, 0.0, v],
            dx: [du[0], 0.0, du[1]],
            dy: [dv[0], 0.0, dv[1]],
            shade: 1.0,
            coverage: 1.0,
            frame: [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
            eye: [-ray.right, ray.down, ray.forward].map(|x| x / ray.length()),
        })
    }

    /// A clear sky: pale at the horizon, deeper blue above.
    pub(super) fn sky(&self, size: Size, point: [f64; 2]) -> [f64; 3] {
        let ray = self.ray(size, point);
        clear_sky(-ray.down / ray.length())
    }
}

/// The radiance of a clear sky at this sine of the elevation: pale at the horizon, deeper blue above.
pub(crate) fn clear_sky(sine: f64) -> [f64; 3] {
    let share = (sine.clamp(0.0, 1.0) * 2.5).min(1.0).sqrt();
    let (pale, deep) = ([0.70, 0.78, 0.86], [0.16, 0.32, 0.60]);
    std::array::from_fn(|c| pale[c] + share * (deep[c] - pale[c]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_horizon_is_where_it_was_asked_for() {
        let size = Size::new(200, 100);
        let plane = Plane::default();
        assert!(plane.hit(size, [100.0, 30.0 - 1e-6]).is_none());
        let far = plane.hit(size, [100.0, 30.0 + 1e-6]).unwrap();
        assert!(far.uv[1] < -1e6, "{far:?}");
        let wide = plane.hit(size, [200.0, 100.0]).unwrap().uv[0] * 2.0;
        assert!((wide - 2.91).abs() < 0.01, "{wide}");
    }
}
