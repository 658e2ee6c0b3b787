//! Which cosines a spectral noise sums.
//!
//! Directions are stratified over the half circle and frequencies over the spectrum, so that a few
//! waves represent both evenly. Three waves of which one nearly is the sum or the difference of the
//! other two lock their phases over long distances, and their sum is not Gaussian (MATH §2); such
//! triads are avoided while drawing.

/// Wave vectors are integers over this.
pub(super) const GRID: i32 = 1024;

/// Of how many candidates a wave is chosen, while there are few enough waves to compare with.
const CANDIDATES: u32 = 12;
const COMPARED: usize = 48;

/// Frequencies of lines lie within this factor of the centre.
pub(crate) const FARTHEST: f32 = 16.0;

/// How the variance is spread over frequencies, in cycles per period.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Density {
    /// Amplitudes fall as f^−falloff for equal octaves: 0 is a band. The octaves lie around 1.
    Power {
        /// How many octaves.
        octaves: f32,
        /// The exponent.
        falloff: f32,
    },
    /// Frequencies with amplitudes.
    Lines(Vec<[f32; 2]>),
}

/// What a spectral noise is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spectrum {
    /// How many cosines; a list of more lines than that has one for each line.
    pub(crate) count: u32,
    /// Their frequencies and amplitudes.
    pub(crate) density: Density,
    /// Selects directions, frequencies and phases.
    pub(crate) seed: i32,
}

/// A cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wave {
    /// Cycles per period, times [`GRID`].
    pub(super) vector: [i32; 2],
    /// Turns.
    pub(super) phase: f32,
    /// Half the sum of the squares of all amplitudes is 1.
    pub(super) amplitude: f32,
}

impl Wave {
    /// Cycles per period.
    pub(super) fn frequency(&self) -> f32 {
        let [x, y] = self.vector.map(|n| n as f32 / GRID as f32);
        x.hypot(y)
    }
}

/// A number of [0, 1) from three integers.
fn uniform(seed: i32, wave: u32, stream: u32) -> f64 {
    let mut x = (seed as u32) ^ wave.wrapping_mul(0x9e37_79b1) ^ stream.wrapping_mul(0x85eb_ca77);
    for _ in 0..2 {
        x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
        x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        x ^= x >> 16;
    }
    f64::from(x) / 4_294_967_296.0
}

/// A stratum that a wave is drawn from: amplitude, frequencies, and directions in half turns.
struct Stratum {
    amplitude: f32,
    frequencies: [f64; 2],
    directions: [f64; 2],
}

impl Density {
    /// One stratum a wave, with amplitudes of any scale. Every seed has strata of its own: waves of
    /// two noises that share them would often coincide.
    fn strata(&self, count: u32, seed: i32) -> Vec<Stratum> {
        let [turned, shifted] = [0, 1].map(|stream| uniform(seed, u32::MAX, stream));
        let turn = |i: u32, n: u32| [f64::from(i) / f64::from(n), f64::from(i + 1) / f64::from(n)];
        match self {
            Self::Power { octaves, falloff } => (0..count)
                .map(|i| {
                    // The golden ratio orders frequencies independently of directions.
                    let order = (f64::from(i) * 0.618_033_988_749_895 + shifted).fract();
                    let start = order * (1.0 - 1.0 / f64::from(count));
                    let share = [start, start + 1.0 / f64::from(count)];
                    let octave = share.map(|s| f64::from(*octaves) * (s - 0.5));
                    let middle = 0.5 * (octave[0] + octave[1]);
                    Stratum {
                        amplitude: (-f64::from(*falloff) * middle).exp2() as f32,
                        frequencies: octave.map(f64::exp2),
                        directions: turn(i, count).map(|t| t + turned),
                    }
                })
                .collect(),
            Self::Lines(lines) => {
                let energy: f32 = lines.iter().map(|line| line[1] * line[1]).sum();
                let mut strata = Vec::new();
                for (k, &[frequency, amplitude]) in lines.iter().enumerate() {
                    // Equal amplitudes of all waves are the most Gaussian.
                    let share = amplitude * amplitude / energy.max(f32::MIN_POSITIVE);
                    let n = (count as f32 * share).round().max(1.0) as u32;
                    let frequency = f64::from(frequency.clamp(1.0 / FARTHEST, FARTHEST));
                    // Lines are turned against one another.
                    let start = turned + (k as f64 * 0.618_033_988_749_895).fract() / f64::from(n);
                    strata.extend((0..n).map(|i| Stratum {
                        amplitude: amplitude / (n as f32).sqrt(),
                        frequencies: [frequency; 2],
                        directions: turn(i, n).map(|t| t + start),
                    }));
                }
                strata
            }
        }
    }
}

impl Spectrum {
    /// The waves. Each is, of a few candidates, the one whose sums and differences with pairs of
    /// earlier ones stay farthest from 0.
    pub(super) fn waves(&self) -> Vec<Wave> {
        let strata = self.density.strata(self.count, self.seed);
        let energy: f32 = strata.iter().map(|s| 0.5 * s.amplitude * s.amplitude).sum();
        let unit = if energy > 0.0 {
            energy.sqrt().recip()
        } else {
            0.0
        };
        let mut waves: Vec<Wave> = Vec::new();
        for (i, stratum) in (0u32..).zip(&strata) {
            let candidate = |attempt: u32| {
                let within = |[low, high]: [f64; 2], stream| {
                    low + (high - low) * uniform(self.seed, i, 3 * attempt + stream)
                };
                let angle = std::f64::consts::PI * within(stratum.directions, 0);
                let octave = within(stratum.frequencies.map(f64::log2), 1);
                let grid = f64::from(GRID) * octave.exp2();
                Wave {
                    vector: [grid * angle.cos(), grid * angle.sin()].map(|x| x.round() as i32),
                    phase: uniform(self.seed, i, 3 * attempt + 2) as f32,
                    amplitude: stratum.amplitude * unit,
                }
            };
            // Beyond this many waves no triad stands out.
            let attempts = if waves.len() < COMPARED {
                CANDIDATES
            } else {
                1
            };
            let best = (0..attempts)
                .map(candidate)
                .max_by_key(|wave| nearest_triad(&waves, wave.vector))
                .expect("there are candidates");
            waves.push(best);
        }
        waves
    }

    /// max |CDF − Φ| of the sum at a random place, from how many waves of equal amplitudes have its
    /// fourth cumulant: n of them are 0.035/n off, few of them 0.044/n (by their characteristic
    /// function).
    pub(crate) fn deviation(&self) -> f32 {
        let powers = (self.density.strata(self.count, self.seed).into_iter())
            .map(|s| s.amplitude * s.amplitude)
            .fold([0.0f32; 2], |[sum, squares], p| [sum + p, squares + p * p]);
        let [sum, squares] = powers;
        if sum == 0.0 {
            return 0.0;
        }
        0.044 * squares / (sum * sum)
    }
}

/// The smallest squared length of a sum ±w ± u ± v over pairs of waves.
fn nearest_triad(waves: &[Wave], w: [i32; 2]) -> i64 {
    let mut least = i64::MAX;
    for (i, u) in waves.iter().enumerate() {
        for v in &waves[..i] {
            for (p, q) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let x = i64::from(w[0] + p * u.vector[0] + q * v.vector[0]);
                let y = i64::from(w[1] + p * u.vector[1] + q * v.vector[1]);
                least = least.min(x * x + y * y);
            }
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spectra(seed: i32) -> Vec<Spectrum> {
        let lines = vec![[0.5, 1.0], [1.0, 0.7], [2.0, 0.5]];
        let power = |octaves, falloff| Density::Power { octaves, falloff };
        [power(1.0, 0.0), power(4.0, 1.0), Density::Lines(lines)]
            .map(|density| Spectrum {
                count: 32,
                density,
                seed,
            })
            .to_vec()
    }

    #[test]
    fn no_three_waves_nearly_close() {
        for spectrum in (0..8).flat_map(spectra) {
            let waves = spectrum.waves();
            let least = (0..waves.len())
                .map(|i| nearest_triad(&waves[..i], waves[i].vector))
                .min();
            // A sum shorter than 0.004 cycles per period locks phases over 250 periods.
            assert!(least.is_some_and(|d| d > 16), "{spectrum:?}: {least:?}");
        }
    }

    /// Over a window of 25 periods the third cumulant of a Gaussian noise is near 0; three waves
    /// that close a triangle have 3/(2√3) · 1/√2 at best, everywhere.
    #[test]
    fn the_sum_is_not_skewed_over_large_windows() {
        for spectrum in (0..8).flat_map(spectra) {
            let waves = spectrum.waves();
            let mut worst = 0.0f64;
            for window in 0..6 {
                let (mut square, mut cube, n) = (0.0, 0.0, 100 * 100);
                for i in 0..n {
                    let p =
                        [i % 100, i / 100].map(|k| 31.7 * f64::from(window) + 0.25 * f64::from(k));
                    let x: f64 = (waves.iter())
                        .map(|w| {
                            let f = w.vector.map(|n| f64::from(n) / f64::from(GRID));
                            let turns = f[0] * p[0] + f[1] * p[1] + f64::from(w.phase);
                            f64::from(w.amplitude) * (std::f64::consts::TAU * turns).cos()
                        })
                        .sum();
                    square += x * x;
                    cube += x * x * x;
                }
                let n = f64::from(n);
                worst = worst.max(((cube / n) / (square / n).powf(1.5)).abs());
            }
            assert!(worst < 0.35, "{spectrum:?}: skewness {worst}");
        }
    }

    #[test]
    fn amplitudes_follow_the_density() {
        for spectrum in spectra(3) {
            let waves = spectrum.waves();
            let energy: f32 = waves.iter().map(|w| 0.5 * w.amplitude * w.amplitude).sum();
            assert!((energy - 1.0).abs() < 1e-5, "{spectrum:?}: {energy}");
            if let Density::Lines(lines) = &spectrum.density {
                let total: f32 = lines.iter().map(|l| l[1] * l[1]).sum();
                for &[frequency, amplitude] in lines {
                    let own: f32 = (waves.iter())
                        .filter(|w| (w.frequency() / frequency - 1.0).abs() < 0.01)
                        .map(|w| 0.5 * w.amplitude * w.amplitude)
                        .sum();
                    let share = amplitude * amplitude / total;
                    assert!(
                        (own - share).abs() < 1e-5,
                        "{frequency}: {own}, not {share}"
                    );
                }
            }
        }
        let silent = Spectrum {
            count: 8,
            density: Density::Lines(vec![[1.0, 0.0]]),
            seed: 0,
        };
        assert!(silent.waves().iter().all(|w| w.amplitude == 0.0));
    }
}
