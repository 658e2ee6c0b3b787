//! Height fields with known slopes.

use super::Torus;
use super::fourier::Complex;
use super::torus::Spectrum;
use crate::random::Random;
use std::f64::consts::TAU;

/// What a height is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Waves of one length, within an eighth, in all directions.
    Band,
    /// Waves of all lengths from 2.9 down to an eighth: amplitude f^−1.75.
    Fractal,
    /// Waves of one length that run one way.
    Directed,
    /// min(|x|/.4, 1) of a band: flat but for cracks along its zeros.
    Cracks,
    /// A band cut off at half of its deviation above and below.
    Plateaus,
    /// 1 − |x| of a band.
    Ridges,
}

/// A height field on a torus.
#[derive(Clone, Debug)]
pub struct Field {
    /// Where.
    pub torus: Torus,
    /// The heights, in wavelengths.
    pub height: Vec<f64>,
    /// Their derivatives.
    pub slopes: [Vec<f64>; 2],
}

/// The amplitude of a wave of this frequency (waves a unit) and direction.
fn amplitude(kind: Kind, [u, v]: [f64; 2]) -> f64 {
    let f = u.hypot(v) / TAU;
    let about = |x: f64, sd: f64| (-0.5 * (x / sd).powi(2)).exp();
    match kind {
        Kind::Fractal if f > 0.35 && f < 8.0 => f.powf(-1.75),
        Kind::Fractal => 0.0,
        Kind::Directed => {
            let angle = v.atan2(u).abs();
            about(f - 1.0, 0.2) * about(angle.min(TAU / 2.0 - angle), 0.3)
        }
        _ => about(f - 1.0, 0.12),
    }
}

impl Field {
    /// A field whose slopes have the deviation `sigma` along each axis, on average over both.
    pub fn new(torus: &Torus, kind: Kind, sigma: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let texels = torus.texels * torus.texels;
        let spectrum: Spectrum = (0..texels)
            .map(|index| {
                let phase = TAU * random.unit();
                match torus.wave(index) {
                    [u, v] if u == 0.0 && v == 0.0 => Complex::default(),
                    wave => Complex::polar(amplitude(kind, wave), phase),
                }
            })
            .collect();
        let noise = torus.field(&spectrum, |_| Complex::real(1.0));
        let variance = noise.iter().map(|x| x * x).sum::<f64>() / texels as f64;
        let noise: Vec<f64> = noise.iter().map(|x| x / variance.sqrt()).collect();
        let slopes = torus.gradient(&noise);
        // The height as a function of the noise, and its derivative.
        let of = |x: f64| match kind {
            Kind::Band | Kind::Fractal | Kind::Directed => (x, 1.0),
            Kind::Cracks if x.abs() < 0.4 => (x.abs() / 0.4, x.signum() / 0.4),
            Kind::Cracks => (1.0, 0.0),
            Kind::Plateaus => (x.clamp(-0.5, 0.5), if x.abs() < 0.5 { 1.0 } else { 0.0 }),
            Kind::Ridges => (1.0 - x.abs(), -x.signum()),
        };
        let height = noise.iter().map(|&x| of(x).0).collect();
        let [u, v] = slopes.map(|slope| {
            let chained = slope.iter().zip(&noise).map(|(s, &x)| s * of(x).1);
            chained.collect::<Vec<f64>>()
        });
        let field = Self {
            torus: torus.clone(),
            height,
            slopes: [u, v],
        };
        let squares = field.slopes.iter().flatten().map(|s| s * s).sum::<f64>();
        field.scaled(sigma / (squares / (2 * texels) as f64).sqrt())
    }

    /// With heights of so many times.
    fn scaled(mut self, by: f64) -> Self {
        let all = self.slopes.iter_mut().flatten().chain(&mut self.height);
        all.for_each(|x| *x *= by);
        self
    }

    /// Every `stride`-th facet of every `stride`-th row: as many means over it are as good as those over all
    /// where facets are much smaller than their waves.
    pub fn thinned(&self, stride: usize) -> Self {
        let n = self.torus.texels;
        let thin = |all: &[f64]| {
            let rows = all.chunks(n).step_by(stride);
            rows.flat_map(|row| row.iter().copied().step_by(stride))
                .collect()
        };
        Self {
            torus: Torus::new(n / stride, self.torus.wavelengths),
            height: thin(&self.height),
            slopes: [thin(&self.slopes[0]), thin(&self.slopes[1])],
        }
    }

    /// A number for each texel, of its height and slope.
    pub fn each(&self, f: impl Fn(f64, [f64; 2]) -> f64) -> Vec<f64> {
        let [u, v] = &self.slopes;
        (0..self.height.len())
            .map(|i| f(self.height[i], [u[i], v[i]]))
            .collect()
    }
}
