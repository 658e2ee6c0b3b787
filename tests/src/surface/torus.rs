//! A square that repeats, with Fourier's transform on it.

use super::fourier::{Complex, Roots};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A square of `texels` × `texels` numbers, `wavelengths` long: the unit of length is the wavelength.
#[derive(Clone, Debug)]
pub struct Torus {
    /// Numbers along a side.
    pub texels: usize,
    /// The length of a side.
    pub wavelengths: f64,
    forward: Roots,
    inverse: Roots,
}

/// The coefficients of a field.
pub(super) type Spectrum = Vec<Complex>;

impl Torus {
    /// A torus of this size; the number of texels is a power of two.
    pub fn new(texels: usize, wavelengths: f64) -> Self {
        Self {
            texels,
            wavelengths,
            forward: Roots::new(texels, -1.0),
            inverse: Roots::new(texels, 1.0),
        }
    }

    /// The distance between texels.
    pub fn step(&self) -> f64 {
        self.wavelengths / self.texels as f64
    }

    /// The wave numbers (radians a unit) of a place in a spectrum.
    pub(super) fn wave(&self, index: usize) -> [f64; 2] {
        let n = self.texels;
        let of = |k: usize| {
            let k = if 2 * k < n {
                k as f64
            } else {
                k as f64 - n as f64
            };
            k * TAU / self.wavelengths
        };
        [of(index % n), of(index / n)]
    }

    /// Both passes of a transform: rows, then columns as rows.
    fn passes(&self, data: &mut Spectrum, roots: &Roots) {
        let n = self.texels;
        for _ in 0..2 {
            data.par_chunks_mut(n).for_each(|row| roots.transform(row));
            for y in 0..n {
                for x in 0..y {
                    data.swap(y * n + x, x * n + y);
                }
            }
        }
    }

    /// The spectrum of a field.
    pub(super) fn spectrum(&self, field: &[f64]) -> Spectrum {
        let mut data: Spectrum = field.iter().map(|&x| Complex::real(x)).collect();
        self.passes(&mut data, &self.forward);
        data
    }

    /// The field of a spectrum, each coefficient by a factor.
    pub(super) fn field(
        &self,
        spectrum: &Spectrum,
        factor: impl Fn([f64; 2]) -> Complex,
    ) -> Vec<f64> {
        let by = 1.0 / (self.texels * self.texels) as f64;
        let mut data: Spectrum = (spectrum.iter().enumerate())
            .map(|(index, &c)| c * factor(self.wave(index)) * Complex::real(by))
            .collect();
        self.passes(&mut data, &self.inverse);
        data.into_iter().map(|c| c.re).collect()
    }

    /// A field under a Gaussian of this deviation.
    pub fn filtered(&self, field: &[f64], sd: f64) -> Vec<f64> {
        self.field(&self.spectrum(field), |[u, v]| {
            Complex::real((-0.5 * sd * sd * (u * u + v * v)).exp())
        })
    }

    /// The derivatives of a field along both axes.
    pub fn gradient(&self, field: &[f64]) -> [Vec<f64>; 2] {
        let spectrum = self.spectrum(field);
        [0, 1].map(|axis| {
            self.field(&spectrum, |wave| Complex {
                re: 0.0,
                im: wave[axis],
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_filtered_and_derived_exactly() {
        let torus = Torus::new(64, 3.0);
        let wave: Vec<f64> = (0..64 * 64)
            .map(|i| (TAU * ((i % 64) as f64 / 64.0 * 2.0 + (i / 64) as f64 / 64.0)).cos())
            .collect();
        let [u, v] = [2.0 * TAU / 3.0, TAU / 3.0];
        let kept = (-0.5 * 0.09 * (u * u + v * v)).exp();
        let filtered = torus.filtered(&wave, 0.3);
        let slopes = torus.gradient(&wave);
        for i in 0..wave.len() {
            assert!((filtered[i] - kept * wave[i]).abs() < 1e-12);
            assert!((slopes[0][i] - 2.0 * slopes[1][i]).abs() < 1e-9);
        }
        assert!((slopes[0][24] - u).abs() < 1e-9, "{}", slopes[0][24]);
    }
}
