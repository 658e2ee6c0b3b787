//! Views: which part of the texture each pixel of a picture sees.
//!
//! A view gives every pixel its position in texture space and the exact derivatives of that
//! position, so that a footprint never comes from differences between neighbouring pixels. All of
//! it is computed in f64 and rounded once, when it becomes a [`Footprint`].
//!
//! Pixel coordinates are continuous: the centre of the pixel in column i and row j is
//! (i + ½, j + ½), and row 0 is the top one.

mod flat;
mod plane;
mod sphere;

pub use flat::Flat;
pub use plane::Plane;
pub(crate) use plane::clear_sky;
pub use sphere::Sphere;

use mipless_codegen::cpu::{Footprint, Position};

use crate::image::Image;
pub use crate::size::{Part, Size};

/// What a ray through one point of the picture meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The position in texture space.
    pub uv: [f64; 2],
    /// The change of uv for one pixel to the right.
    pub du: [f64; 2],
    /// The change of uv for one pixel down.
    pub dv: [f64; 2],
    /// The position in space: x to the right, y up and z towards the viewer of the plane and the
    /// sphere; (u, v, 0) in the flat view.
    pub position: [f64; 3],
    /// The change of the position for one pixel to the right.
    pub dx: [f64; 3],
    /// The change of the position for one pixel down.
    pub dy: [f64; 3],
    /// What the view multiplies a colour by (Lambert's cosine law), from 0 to 1; dimensionless.
    pub shade: f64,
    /// The share of the pixel that the surface covers, above 0 and at most 1.
    pub coverage: f64,
    /// Unit vectors of space along u, along v, and along the normal of the surface.
    pub frame: [[f64; 3]; 3],
    /// The unit vector towards the eye, in space.
    pub eye: [f64; 3],
}

impl Hit {
    /// The footprint: the whole part of the position apart from its fraction, so that the fraction
    /// keeps its digits far from the origin.
    ///
    /// `None` where a number is not finite as f32.
    pub fn footprint(&self) -> Option<Footprint> {
        let places = self.uv.map(split);
        let footprint = Footprint {
            cell: places.map(|(cell, _)| cell),
            uv: places.map(|(_, rest)| rest),
            du: self.du.map(|x| x as f32),
            dv: self.dv.map(|x| x as f32),
        };
        let Footprint { uv, du, dv, .. } = footprint;
        let finite = [uv, du, dv].as_flattened().iter().all(|x| x.is_finite());
        finite.then_some(footprint)
    }

    /// The position in space, the whole part apart from its fraction.
    ///
    /// `None` where a number is not finite as f32.
    pub fn space(&self) -> Option<Position> {
        let places = self.position.map(split);
        let position = Position {
            cell: places.map(|(cell, _)| cell),
            xyz: places.map(|(_, rest)| rest),
            dx: self.dx.map(|x| x as f32),
            dy: self.dy.map(|x| x as f32),
        };
        let Position { xyz, dx, dy, .. } = position;
        let finite = [xyz, dx, dy].as_flattened().iter().all(|x| x.is_finite());
        finite.then_some(position)
    }
}

/// A coordinate as its whole part and the rest. What is so near to 0 that the rest would be rounded to
/// 1, or so far away that an integer does not hold it, is the rest alone.
fn split(x: f64) -> (i32, f32) {
    let cell = x.floor();
    let rest = (x - cell) as f32;
    if rest < 1.0 && cell.abs() < f64::from(i32::MAX) {
        (cell as i32, rest)
    } else if x.abs() < 1.0 || cell.abs() >= f64::from(i32::MAX) {
        (0, x as f32)
    } else {
        (cell as i32 + 1, 0.0)
    }
}

/// A way to look at a texture.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// A rectangle of texture space, straight on.
    Flat(Flat),
    /// An endless plane in perspective, to the horizon.
    Plane(Plane),
    /// A lit unit sphere.
    Sphere(Sphere),
}

impl View {
    /// The default view of that name: `plane`, `flat` or `sphere`.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "flat" => Some(Self::Flat(Flat::default())),
            "plane" => Some(Self::Plane(Plane::default())),
            "sphere" => Some(Self::Sphere(Sphere::default())),
            _ => None,
        }
    }

    /// The name that [`View::by_name`] takes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Flat(_) => "flat",
            Self::Plane(_) => "plane",
            Self::Sphere(_) => "sphere",
        }
    }

    /// What the ray through `point` (continuous pixel coordinates) meets; `None` is the background.
    pub fn hit(&self, size: Size, point: [f64; 2]) -> Option<Hit> {
        match self {
            Self::Flat(view) => Some(view.hit(size, point)),
            Self::Plane(view) => view.hit(size, point),
            Self::Sphere(view) => view.hit(size, point),
        }
    }

    /// The footprint of the pixel at `index`, counted along the rows; `None` is the background.
    pub fn footprint(&self, size: Size, index: usize) -> Option<Footprint> {
        self.hit(size, size.centre(index))?.footprint()
    }

    /// The footprint of the pixel at `index` with its position in space; `None` is the background.
    pub fn pixel(&self, size: Size, index: usize) -> Option<(Footprint, Position)> {
        let hit = self.hit(size, size.centre(index))?;
        Some((hit.footprint()?, hit.space()?))
    }

    /// The linear Rec. 709 colour of the background at `point`.
    pub fn background(&self, size: Size, point: [f64; 2]) -> [f64; 3] {
        match self {
            Self::Flat(_) => [0.0; 3],
            Self::Plane(view) => view.sky(size, point),
            Self::Sphere(view) => view.backdrop(size, point),
        }
    }

    /// For each pixel, whether it shows the texture: what an error is measured over.
    pub fn mask(&self, size: Size) -> Vec<bool> {
        (0..size.pixels())
            .map(|index| self.footprint(size, index).is_some())
            .collect()
    }

    /// The unit vector of space towards a distant light: `azimuth` degrees counter-clockwise from the right
    /// as it is seen from above, where 90 is ahead (in the flat view the top of the picture), and
    /// `elevation` degrees above the ground.
    pub fn towards(&self, azimuth: f64, elevation: f64) -> [f64; 3] {
        let ((sin, cos), (up, level)) = (
            azimuth.to_radians().sin_cos(),
            elevation.to_radians().sin_cos(),
        );
        let [right, ahead] = [level * cos, level * sin];
        match self {
            Self::Flat(_) => [right, -ahead, up],
            Self::Plane(_) | Self::Sphere(_) => [right, up, -ahead],
        }
    }

    /// The picture of a surface that is lit already, `image`, a colour, with the background behind it.
    pub fn present_lit(&self, image: &Image) -> Image {
        self.present_lit_part(image, Part::all(image.size()))
    }

    /// The same of a part of a picture.
    pub fn present_lit_part(&self, image: &Image, part: Part) -> Image {
        self.presented(image, part, |_| 1.0)
    }

    /// The picture that people see: `image`, a colour (`R,G,B[,A]`) or a float (`Y`) evaluated over
    /// this view, with the light of the view on it and the background behind it. Other images, such
    /// as vectors, come back as they are.
    pub fn present(&self, image: &Image) -> Image {
        self.present_part(image, Part::all(image.size()))
    }

    /// The same of a part of a picture.
    pub fn present_part(&self, image: &Image, part: Part) -> Image {
        self.presented(image, part, |hit| hit.shade)
    }

    fn presented(&self, image: &Image, part: Part, light: impl Fn(&Hit) -> f64) -> Image {
        let size = part.whole;
        let mut picture = image.clone();
        let lit = match image.names().iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["R", "G", "B"] | ["R", "G", "B", "A"] => 3,
            ["Y"] => 1,
            _ => return picture,
        };
        if matches!(self, Self::Flat(_)) {
            return picture;
        }
        for index in 0..part.size.pixels() {
            let point = size.centre(part.place(index));
            let hit = self
                .hit(size, point)
                .filter(|hit| hit.footprint().is_some());
            let (shade, coverage) = hit.map_or((0.0, 0.0), |hit| (light(&hit), hit.coverage));
            let behind = self.background(size, point);
            let luminance = 0.2126 * behind[0] + 0.7152 * behind[1] + 0.0722 * behind[2];
            let behind = if lit == 1 { [luminance; 3] } else { behind };
            for (channel, data) in picture.channels_mut().iter_mut().enumerate() {
                let (factor, behind) = if channel < lit {
                    (shade, behind[channel])
                } else {
                    (1.0, 1.0)
                };
                let front = f64::from(data[index]) * factor;
                data[index] = (coverage * front + (1.0 - coverage) * behind) as f32;
            }
        }
        picture
    }
}

impl Default for View {
    fn default() -> Self {
        Self::Plane(Plane::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest difference, over `points`, between the derivatives and central differences of
    /// step `h` pixels, relative to the larger derivative of the point.
    fn difference(view: &View, size: Size, points: &[[f64; 2]], h: f64) -> (f64, usize) {
        let (mut worst, mut checked) = (0.0f64, 0);
        for &[x, y] in points {
            let around = [[x + h, y], [x - h, y], [x, y + h], [x, y - h]];
            let hits = around.map(|point| view.hit(size, point).filter(|hit| hit.coverage == 1.0));
            let (Some(hit), [Some(r), Some(l), Some(d), Some(u)]) = (view.hit(size, [x, y]), hits)
            else {
                continue;
            };
            let length = hit
                .du
                .iter()
                .chain(&hit.dv)
                .fold(0.0f64, |a, b| a.max(b.abs()));
            for axis in 0..2 {
                let du = (r.uv[axis] - l.uv[axis]) / (2.0 * h);
                let dv = (d.uv[axis] - u.uv[axis]) / (2.0 * h);
                worst = worst.max((du - hit.du[axis]).abs() / length);
                worst = worst.max((dv - hit.dv[axis]).abs() / length);
            }
            checked += 1;
        }
        (worst, checked)
    }

    fn grid(size: Size, step: usize) -> Vec<[f64; 2]> {
        (0..size.pixels())
            .step_by(step)
            .map(|index| size.centre(index))
            .collect()
    }

    #[test]
    fn derivatives_are_those_of_the_position() {
        let size = Size::new(320, 180);
        for (view, at_least) in [
            (View::Flat(Flat::default()), 8000),
            (
                View::Flat(Flat {
                    window: [-3.0, 1e6, 5.0, 1e6 + 1.0],
                }),
                8000,
            ),
            (View::Plane(Plane::default()), 5000),
            (View::Sphere(Sphere::default()), 2000),
            (
                View::Sphere(Sphere {
                    tilt: 90.0,
                    ..Sphere::default()
                }),
                2000,
            ),
        ] {
            let (worst, checked) = difference(&view, size, &grid(size, 7), 1e-3);
            assert!(checked >= at_least, "{}: {checked} points", view.name());
            // The central difference is off by the third derivative times h²/6; near the pole and
            // the silhouette that third derivative grows as the inverse square of the distance.
            assert!(worst < 2e-5, "{}: {worst:e}", view.name());
        }
    }

    #[test]
    fn derivatives_hold_at_the_horizon_and_around_the_pole() {
        let size = Size::new(640, 480);
        let plane = Plane::default();
        let horizon = plane.horizon * f64::from(size.height);
        let near: Vec<_> = (0..64)
            .map(|i| {
                [
                    f64::from(i) * 10.0 + 0.5,
                    horizon + 0.01 + f64::from(i) * 0.01,
                ]
            })
            .collect();
        let (worst, checked) = difference(&View::Plane(plane), size, &near, 1e-6);
        assert_eq!(checked, 64);
        assert!(worst < 1e-7, "horizon: {worst:e}");

        let sphere = Sphere {
            tilt: 90.0,
            ..Sphere::default()
        };
        let around: Vec<_> = (1..200)
            .map(|i| {
                let (angle, radius) = (f64::from(i) * 0.7, f64::from(i) * 0.02);
                [320.0 + radius * angle.cos(), 240.0 + radius * angle.sin()]
            })
            .collect();
        let (worst, checked) = difference(&View::Sphere(sphere), size, &around, 1e-6);
        assert_eq!(checked, 199);
        assert!(worst < 1e-7, "pole: {worst:e}");
    }

    #[test]
    fn far_positions_keep_their_fraction() {
        let view = View::Flat(Flat {
            window: [1e9, -1e9, 1e9 + 1.0, -1e9 + 1.0],
        });
        let footprint = view.footprint(Size::new(1000, 1000), 123).unwrap();
        assert_eq!(footprint.cell, [1_000_000_000, -1_000_000_000]);
        assert!((footprint.uv[0] - 0.1235).abs() < 1e-6, "{footprint:?}");
        assert!((footprint.uv[1] - 0.0005).abs() < 1e-6, "{footprint:?}");
    }

    #[test]
    fn every_footprint_is_finite() {
        let size = Size::new(257, 129);
        for name in ["flat", "plane", "sphere"] {
            let view = View::by_name(name).unwrap();
            assert_eq!(view.name(), name);
            let footprints = (0..size.pixels()).filter_map(|index| view.footprint(size, index));
            let mut count = 0;
            for footprint in footprints {
                let Footprint { uv, du, dv, .. } = footprint;
                assert!([uv, du, dv].as_flattened().iter().all(|x| x.is_finite()));
                assert!(uv.iter().all(|x| (0.0..=1.0).contains(x)), "{footprint:?}");
                count += 1;
            }
            assert!(count > size.pixels() / 4, "{name}: {count}");
        }
    }

    #[test]
    fn the_background_is_behind_and_light_dims() {
        let size = Size::new(64, 64);
        let white = Image::new(size, &["R", "G", "B"], vec![vec![1.0; 64 * 64]; 3]);
        let picture = View::Sphere(Sphere::default()).present(&white);
        let at = |x: usize, y: usize| picture.channels()[1][y * 64 + x];
        assert!(at(0, 0) < 0.2, "background {}", at(0, 0));
        assert!(at(26, 22) > 0.9, "the lit side {}", at(26, 22));
        assert!(at(44, 48) < 0.5, "the dark side {}", at(44, 48));
        assert_eq!(View::Flat(Flat::default()).present(&white), white);
    }

    #[test]
    fn positions_in_space_have_the_derivatives_of_their_differences() {
        let size = Size::new(160, 120);
        for name in ["flat", "plane", "sphere"] {
            let view = View::by_name(name).unwrap();
            let mut checked = 0;
            for index in (0..size.pixels()).step_by(331) {
                let [x, y] = size.centre(index);
                let h = 1e-4;
                let around = [[x + h, y], [x - h, y], [x, y + h], [x, y - h]];
                let hits =
                    around.map(|point| view.hit(size, point).filter(|hit| hit.coverage == 1.0));
                let (Some(hit), [Some(r), Some(l), Some(d), Some(u)]) =
                    (view.hit(size, [x, y]), hits)
                else {
                    continue;
                };
                let length = hit
                    .dx
                    .iter()
                    .chain(&hit.dy)
                    .fold(0.0f64, |a, b| a.max(b.abs()));
                for axis in 0..3 {
                    let right = (r.position[axis] - l.position[axis]) / (2.0 * h);
                    let down = (d.position[axis] - u.position[axis]) / (2.0 * h);
                    assert!(
                        (right - hit.dx[axis]).abs() <= 1e-5 * length,
                        "{name}: {hit:?}"
                    );
                    assert!(
                        (down - hit.dy[axis]).abs() <= 1e-5 * length,
                        "{name}: {hit:?}"
                    );
                }
                if name == "sphere" {
                    let radius = hit.position.iter().map(|x| x * x).sum::<f64>();
                    assert!((radius - 1.0).abs() < 1e-9, "{hit:?}");
                }
                let (footprint, position) = view.pixel(size, index).expect("both are finite");
                assert_eq!(Some(footprint), view.footprint(size, index));
                assert!(position.xyz.iter().all(|x| (0.0..=1.0).contains(x)));
                checked += 1;
            }
            assert!(checked > 20, "{name}: {checked}");
        }
    }
}
