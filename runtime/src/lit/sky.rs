//! A small analytic sky, as a polynomial of the second degree.

use crate::view::clear_sky;

/// The radiance of one channel by the sine of the elevation: a + b z + c (z² − ⅓).
#[derive(Clone, Copy, Debug)]
pub(super) struct Zonal([f64; 3]);

/// What the ground beyond the texture sends back.
const GROUND: [f64; 3] = [0.16, 0.15, 0.14];

/// How bright the sky is against the picture of it behind the texture.
const BRIGHTNESS: f64 = 0.8;

impl Zonal {
    /// The clear sky above the ground: the nearest polynomial, by Legendre's.
    pub(super) fn clear() -> [Self; 3] {
        const STEPS: u32 = 2000;
        let mut sums = [[0.0; 3]; 3];
        for step in 0..STEPS {
            let z = (f64::from(step) + 0.5) * 2.0 / f64::from(STEPS) - 1.0;
            let radiance = if z < 0.0 { GROUND } else { clear_sky(z) };
            let legendre = [1.0, z, 1.5 * (z * z - 1.0 / 3.0)];
            for (sums, radiance) in sums.iter_mut().zip(radiance) {
                for (degree, sum) in sums.iter_mut().enumerate() {
                    let share = (degree as f64 + 0.5) * 2.0 / f64::from(STEPS);
                    *sum += share * radiance * legendre[degree] * BRIGHTNESS;
                }
            }
        }
        sums.map(|[a, b, c]| Self([a, b, 1.5 * c]))
    }
}

/// The coefficients of 1, x, y, z, xy, yz, zx, z² − ⅓ and x² − y² in a frame in which up is `up`, each for
/// all channels.
pub(super) fn terms(sky: &[Zonal; 3], [x, y, z]: [f64; 3]) -> [[f32; 3]; 9] {
    let second = [
        2.0 * x * y,
        2.0 * y * z,
        2.0 * z * x,
        1.5 * z * z - 0.5,
        0.5 * (x * x - y * y),
    ];
    std::array::from_fn(|k| {
        sky.map(|Zonal([a, b, c])| match k {
            0 => a as f32,
            1..=3 => (b * [x, y, z][k - 1]) as f32,
            _ => (c * second[k - 4]) as f32,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_does_not_change_the_sky() {
        let sky = Zonal::clear();
        let up = [0.48, -0.6, 0.64];
        let terms = terms(&sky, up);
        for d in [[0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [0.48, 0.64, 0.6]] {
            let [x, y, z] = d;
            let sine: f64 = (0..3).map(|k| d[k] * up[k]).sum();
            let basis = [
                1.0,
                x,
                y,
                z,
                x * y,
                y * z,
                z * x,
                z * z - 1.0 / 3.0,
                x * x - y * y,
            ];
            for c in 0..3 {
                let found: f64 = (0..9).map(|k| f64::from(terms[k][c]) * basis[k]).sum();
                let Zonal([a, b, q]) = sky[c];
                let wanted = a + b * sine + q * (sine * sine - 1.0 / 3.0);
                assert!((found - wanted).abs() < 1e-6, "{d:?}: {found} {wanted}");
            }
        }
    }
}
