//! One octave of the filtered noise.

use super::address::exchanged;
use super::energy::Energy;
use super::row::{Frame, orders, row};
use super::width::WIDTH;
use crate::noise::remainder::share;
use crate::noise::sum::Octave;
use crate::noise::sum::{Octaves, derivatives, footprint_scale};
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Module};
use mipless_codegen::moments::Mode;

/// An octave that keeps less than the first share of the variance of the whole noise has faded to
/// nothing, above the second it has not begun to.
pub(super) const FADE: [f32; 2] = [0.0004, 0.0008];

/// An octave is taken for at least this share of the variance: so it does not fade before the filter
/// has removed 94 % of its own.
pub(super) const LEAST_SHARE: f32 = 0.0133;

/// The spread, in squared cells, up to which the three nearest rows or columns suffice, and from
/// which on a fourth counts in full.
const FOURTH: [f32; 2] = [0.0144, 0.04];

/// Octaves of a smaller share of the variance do without a fourth row: what it adds to the noise is
/// below what others drop.
const MINOR_SHARE: f32 = 0.1;

/// Rows are summed up to this many times √T₂₂ from the position.
const REACH: f32 = 2.3;

/// The most lattice rows that are summed; footprints that need more fade.
const MOST_ROWS: f32 = 32.0;

/// One octave of the filtered noise, the body of a fold.
pub(super) fn octave(module: &mut Module, mode: Mode, octaves: Octaves) -> FunctionRef {
    let count = derivatives(mode);
    let row = row(module, count, octaves.tiles());
    let doc = "One more octave of the filtered noise.";
    let b = &Builder::new("lattice_octave", doc);
    b.uint_param("index");
    let names = &["mean", "dx", "dy", "dxx", "dxy", "dyy"][..(count + 1) * (count + 2) / 2];
    let sums: Vec<Float<'_>> = names.iter().map(|name| b.float_param(*name)).collect();
    let rest = mode.spreads().then(|| b.float_param("rest"));
    let state = Octave::declare(b, octaves);
    let covariance = b.float_params(["s_xx", "s_xy", "s_yy"]);
    let [trace, determinant] = b.float_params(["trace", "determinant"]);

    // The footprint in cells of this octave. The rows are laid along its longer side.
    let area = footprint_scale(state.scale, trace);
    let [s_xx, s_xy, s_yy] = covariance.map(|s| s * area);
    let energy = Energy::new(trace * area, determinant * area.square());
    // Rounding does not turn the rows of a round footprint: what each way drops is not the same.
    let swapped = s_yy.lt(s_xx * (1.0 - 1e-5));
    let (across, along) = (s_xx.min(s_yy), s_xx.max(s_yy));
    let t_yy = along + WIDTH * WIDTH;
    let q = 1.0 / t_yy;
    let shear = s_xy * q;
    let p = t_yy * energy.inverse * WIDTH.powi(-4);

    // How many rows. What is dropped for want of rows or columns is below 0.015 of the noise.
    let across = across - shear * s_xy;
    let outer = [across, along].map(|spread| share(spread, FOURTH[0], FOURTH[1]));
    let needed = t_yy.sqrt() * (2.0 * REACH);
    let power = state.amplitude.square();
    let energy_share = power * (1.0 / octaves.sd().powi(2));
    let is_near = outer[1].le(0.0) | energy_share.lt(MINOR_SHARE);
    let rows = needed.ceil().max(is_near.select(3.0, 4.0)).min(MOST_ROWS);

    // The octave fades to nothing before it is dropped.
    let kept = energy.left * energy_share.max(LEAST_SHARE);
    let by_energy = share(kept, FADE[0], FADE[1]);
    let by_reach = share(needed, MOST_ROWS, MOST_ROWS * 0.8);
    let fade = by_energy * by_reach;
    let row_count = fade.le(0.0).select(0, rows.to_int().to_uint());

    // The position in the rows' frame.
    let [x, y] = exchanged(swapped, state.fractions);
    let start = (y + rows * -0.5).floor() + 1.0;
    let address = state.address().swapped(swapped).rows_counted_from(start);
    // Of four rows the one that is not among the nearest three.
    let right = (y - y.floor() + 0.5).ge(1.0);
    let outer_row = is_near.select(u32::MAX, right.select(0u32, 3u32));
    let sign = swapped.select(-1.0, 1.0);
    let turn = [
        sign * (1.0 - shear.square()),
        sign * shear,
        -sign,
        shear + shear,
    ];
    let frame = Frame {
        x,
        y: y - start,
        address,
        shear,
        turn,
        precisions: [p, q],
        decay: (-p).exp(),
        outer_row,
        outer,
    };
    let zeros = vec![b.float(0.0); orders(count).len()];
    let kernels = b.fold(&row, row_count, zeros, frame.captures());
    let parts = in_lattice(swapped, shear, &kernels);

    // κ = a³/(√π √det T) = a/√(πD).
    let kappa = energy.root * (WIDTH / std::f32::consts::PI.sqrt());
    let weight = kappa * fade * state.amplitude;
    let (steep, bent) = (weight * state.scale, weight * area);
    let weights = [weight, steep, steep, bent, bent, bent];
    for (((name, sum), part), weight) in names.iter().zip(sums).zip(parts).zip(weights) {
        b.result(*name, sum + weight * part);
    }
    if let Some(rest) = rest {
        b.result("rest", rest + power * remainder(mode, &energy, fade));
    }
    state.advance(b, octaves);
    b.finish(module)
}

/// The noise and its derivatives (x, y, xx, xy, yy) in the lattice's frame, from those along x′ and y
/// up to the sign (−1)^{i+j}: ∂ₓ is ∂ₓ′, and ∂ᵧ is ∂ᵧ − t∂ₓ′.
fn in_lattice<'b>(swapped: Bool<'b>, t: Float<'b>, sums: &[Float<'b>]) -> Vec<Float<'b>> {
    let mut parts = vec![sums[0]];
    if let [_, x, y, ..] = *sums {
        parts.extend(exchanged(swapped, [-x, t * x - y]));
    }
    if let [_, _, _, xx, xy, yy] = *sums {
        let mixed = xy - t * xx;
        let yy = yy - (t + t) * xy + t.square() * xx;
        let [xx, yy] = exchanged(swapped, [xx, yy]);
        parts.extend([xx, mixed, yy]);
    }
    parts
}

/// What the filter removed, 1 − F, less what the mode carries of it, plus what fading drops: shares
/// of the octave's variance. V − V₁ is at least V₂; below 6e-7 the difference is rounding.
fn remainder<'b>(mode: Mode, energy: &Energy<'b>, fade: Float<'b>) -> Float<'b> {
    let zero = fade.literal(0.0);
    let (carried, least) = match mode {
        Mode::Local => (energy.first, energy.least),
        Mode::Quad => (energy.first + energy.second, zero),
        _ => (zero, zero),
    };
    let left = (1.0 - energy.left - carried + -6e-7).max(least);
    let uncarried = 1.0 - fade.square();
    let dropped = (1.0 - fade).square() * energy.left;
    left + uncarried * carried + dropped
}
