//! A lit unit sphere, textured by longitude and latitude.

use glam::{DMat3, DVec3};

use super::{Hit, Size};

/// A pinhole camera in front of a unit sphere. u is the longitude and v the latitude (downwards),
/// both in units of `around` per full turn, so that with a whole `around` a texture of period 1
/// has no seam. Longitude 0 faces the camera, so the seam of other textures is at the back.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// How many units of texture space the equator is long.
    pub around: f64,
    /// How far the upper pole leans towards the camera, in degrees.
    pub tilt: f64,
    /// The diameter of the sphere's picture as a share of the picture's smaller side.
    pub fill: f64,
    /// The direction to the light: x to the right, y up, z towards the camera; any length but 0.
    pub light: [f64; 3],
    /// The light that reaches every point of the surface, from 0 to 1.
    pub ambient: f64,
}

impl Default for Sphere {
    fn default() -> Self {
        Self {
            around: 8.0,
            tilt: 25.0,
            fill: 0.86,
            light: [-0.45, 0.6, 0.9],
            ambient: 0.12,
        }
    }
}

/// The distance from the camera to the centre, in radii.
const DISTANCE: f64 = 4.0;

/// The largest derivative, in units of texture space per pixel, which only points on the outline
/// and on the poles reach; any footprint of that size sees the mean of the texture.
const STEEPEST: f64 = 1e6;

impl Sphere {
    /// The size of a pixel at unit distance from the camera.
    fn pixel(&self, size: Size) -> f64 {
        // The outline is the cone whose half-angle has the sine 1/DISTANCE.
        let outline = 1.0 / (DISTANCE * DISTANCE - 1.0).sqrt();
        2.0 * outline / (self.fill * f64::from(size.width.min(size.height)))
    }

    pub(super) fn hit(&self, size: Size, [x, y]: [f64; 2]) -> Option<Hit> {
        let pixel = self.pixel(size);
        let mut at = [
            x - f64::from(size.width) / 2.0,
            f64::from(size.height) / 2.0 - y,
        ];

        // Pixels across the outline blend by the share inside it; their rays are moved just inside.
        let radius = 0.5 * self.fill * f64::from(size.width.min(size.height));
        let from_centre = at[0].hypot(at[1]);
        let coverage = (0.5 + radius - from_centre).min(1.0);
        if coverage <= 0.0 {
            return None;
        }
        let inside = radius * (1.0 - 1e-6);
        if from_centre > inside {
            at = at.map(|c| c * inside / from_centre);
        }

        let eye = DVec3::new(0.0, 0.0, DISTANCE);
        let ray = DVec3::new(at[0] * pixel, at[1] * pixel, -1.0);
        let rest = DISTANCE * DISTANCE - 1.0;
        let discriminant = DISTANCE * DISTANCE - ray.length_squared() * rest;
        let time = rest / (DISTANCE + discriminant.max(0.0).sqrt());
        let point = eye + time * ray;

        // The point stays on the sphere, point · point′ = 0, which gives the derivative of the time.
        let moved = |ray_change: DVec3| {
            let time_change = -time * point.dot(ray_change) / point.dot(ray);
            time_change * ray + time * ray_change
        };
        let (right, down) = (moved(DVec3::X * pixel), moved(DVec3::NEG_Y * pixel));

        let to_object = DMat3::from_rotation_x(-self.tilt.to_radians());
        let [p, right, down] = [point, right, down].map(|vector| to_object * vector);
        let scale = self.around / std::f64::consts::TAU;
        let ring = (p.x * p.x + p.z * p.z).max(1e-18);
        let change = |d: DVec3| {
            let longitude = (p.z * d.x - p.x * d.z) / ring;
            let latitude = d.y / ring.sqrt();
            [longitude * scale, -latitude * scale].map(|c| c.clamp(-STEEPEST, STEEPEST))
        };
        // Better conditioned at the poles than the arc sine of y.
        let latitude = p.y.atan2(ring.sqrt());
        let light = DVec3::from_array(self.light).normalize_or(DVec3::Z);
        let cosine = point.dot(light).max(0.0);
        let along = to_object.transpose() * DVec3::new(p.z, 0.0, -p.x);
        let along = along.normalize_or(DVec3::X);
        Some(Hit {
            uv: [p.x.atan2(p.z) * scale, -latitude * scale],
            du: change(right),
            dv: change(down),
            position: p.to_array(),
            dx: right.to_array().map(|c| c.clamp(-STEEPEST, STEEPEST)),
            dy: down.to_array().map(|c| c.clamp(-STEEPEST, STEEPEST)),
            shade: self.ambient + (1.0 - self.ambient) * cosine,
            coverage,
            frame: [along, along.cross(point), point].map(|axis| axis.to_array()),
            eye: (eye - point).normalize_or(DVec3::Z).to_array(),
        })
    }

    /// A dark backdrop, a little lighter below.
    pub(super) fn backdrop(&self, size: Size, [_, y]: [f64; 2]) -> [f64; 3] {
        let share = y / f64::from(size.height);
        [0.018, 0.021, 0.026].map(|c| c * (1.0 + 2.0 * share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_faces_the_camera_and_the_outline_is_round() {
        let size = Size::new(300, 200);
        let upright = Sphere {
            tilt: 0.0,
            ..Sphere::default()
        };
        let middle = upright.hit(size, [150.0, 100.0]).unwrap();
        assert_eq!(middle.uv, [0.0, 0.0]);
        assert!(middle.du[0] > 0.0 && middle.dv[1] > 0.0, "{middle:?}");
        assert!((middle.du[0] - middle.dv[1]).abs() < 1e-15, "{middle:?}");
        assert!(
            upright
                .hit(size, [150.0, 100.0 - 86.0 + 0.6])
                .unwrap()
                .coverage
                == 1.0
        );
        assert!(upright.hit(size, [150.0, 100.0 - 86.0]).unwrap().coverage == 0.5);
        assert!(upright.hit(size, [150.0, 100.0 - 86.6]).is_none());
    }

    #[test]
    fn the_pole_is_finite() {
        let pole = Sphere {
            tilt: 90.0,
            ..Sphere::default()
        }
        .hit(Size::new(64, 64), [32.0, 32.0]);
        let footprint = pole.unwrap().footprint().expect("a finite footprint");
        assert!(
            footprint
                .du
                .iter()
                .chain(&footprint.dv)
                .all(|x| x.abs() <= 1e6)
        );
    }
}
