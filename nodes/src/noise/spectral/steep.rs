//! The slopes that a footprint removes from a spectral noise, wave by wave.

use super::waves::{GRID, Spectrum};
use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, Sym2, dot};
use mipless_codegen::moments::Signal;
use std::f32::consts::TAU;

/// R(Σ) = Σ ½a² w wᵀ (1 − e^{−q}(1 + q)), q = wᵀΣw, at this position (`noise/steep.rs`).
pub(crate) fn steepness<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    spectrum: &Spectrum,
) -> Sym2<'b> {
    let waves = spectrum.waves();
    let function = lower.function(&format!("spectral steepness {spectrum:?}"), |module| {
        let b = &Builder::new("spectral_steepness", "The slopes that a footprint removes.");
        let covariance: [Float<'_>; 3] = b.float_params(["s_xx", "s_xy", "s_yy"]);
        let mut sums = [b.float(0.0); 3];
        for wave in &waves {
            let [x, y] = wave.vector.map(|n| TAU * n as f32 / GRID as f32);
            let outer = [x * x, x * y, y * y];
            let factors = [outer[0], 2.0 * outer[1], outer[2]].map(|f| b.float(f));
            let q = dot(factors, covariance).clamp(0.0, 40.0);
            let lost = lost(q) * (0.5 * wave.amplitude * wave.amplitude);
            for (sum, factor) in sums.iter_mut().zip(outer) {
                *sum += lost * factor;
            }
        }
        b.results(["uu", "uv", "vv"], sums);
        b.finish(module)
    });
    let covariance = Spread::of(position).covariance;
    let results = lower.b().call(&function, covariance);
    Sym2([results[0], results[1], results[2]])
}

/// 1 − e^{−q}(1 + q), by its series below 0.05, where the difference cancels.
fn lost(q: Float<'_>) -> Float<'_> {
    let series = q.square() * (0.5 - q * (1.0 / 3.0 - q * 0.125));
    let direct = 1.0 - (-q).exp() * (1.0 + q);
    q.lt(0.05).select(series, direct)
}
