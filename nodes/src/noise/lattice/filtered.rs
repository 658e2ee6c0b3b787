//! One octave of the filtered noise.

use super::energy::Energy;
use super::row::{Frame, orders, row};
use super::width::WIDTH;
use crate::noise::octave::Octave;
use crate::noise::sum::{Octaves, derivatives};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
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

/// 0 below `low`, 1 above `high`, linear between.
fn ramp(b: &mut Builder, x: Value, [low, high]: [f32; 2]) -> Value {
    let x = b.offset(x, -low);
    let x = b.scale(x, 1.0 / (high - low));
    b.clamp(x, 0.0, 1.0)
}

/// One octave of the filtered noise, the body of a fold.
pub(super) fn octave(module: &mut Module, mode: Mode, octaves: Octaves) -> FunctionRef {
    let count = derivatives(mode);
    let row = row(module, count, octaves.tiles());
    let doc = "One more octave of the filtered noise.";
    let mut builder = Builder::new("lattice_octave", doc);
    let b = &mut builder;
    b.param("index", Type::U32);
    let names = &["mean", "dx", "dy", "dxx", "dxy", "dyy"][..(count + 1) * (count + 2) / 2];
    let sums: Vec<Value> = names.iter().map(|name| b.param_f32(*name)).collect();
    let rest = mode.spreads().then(|| b.param_f32("rest"));
    let state = Octave::declare(b, octaves);
    let covariance = ["s_xx", "s_xy", "s_yy"].map(|name| b.param_f32(name));
    let (trace, determinant) = (b.param_f32("trace"), b.param_f32("determinant"));
    let (zero, one) = (b.f32(0.0), b.f32(1.0));

    // The footprint in cells of this octave. The rows are laid along its longer side.
    let area = b.square(state.scale);
    let widest = b.f32(1e6);
    let area = b.min(area, widest);
    let [s_xx, s_xy, s_yy] = covariance.map(|s| b.mul(s, area));
    let trace = b.mul(trace, area);
    let area2 = b.square(area);
    let determinant = b.mul(determinant, area2);
    let energy = Energy::new(b, trace, determinant);
    let swapped = b.lt(s_yy, s_xx);
    let (across, along) = (b.min(s_xx, s_yy), b.max(s_xx, s_yy));
    let t_yy = b.offset(along, WIDTH * WIDTH);
    let q = b.div(one, t_yy);
    let shear = b.mul(s_xy, q);
    let p = b.mul(t_yy, energy.inverse);
    let p = b.scale(p, WIDTH.powi(-4));
    let minus = b.neg(p);
    let decay = b.exp(minus);

    // How many rows. What is dropped for want of rows or columns is below 0.015 of the noise.
    let lean = b.mul(shear, s_xy);
    let across = b.sub(across, lean);
    let outer = [ramp(b, across, FOURTH), ramp(b, along, FOURTH)];
    let size = b.sqrt(t_yy);
    let needed = b.scale(size, 2.0 * REACH);
    let (three, four) = (b.f32(3.0), b.f32(4.0));
    let power = b.square(state.amplitude);
    let share = b.scale(power, 1.0 / octaves.sd().powi(2));
    let (is_near, minor) = (b.le(outer[1], zero), b.f32(MINOR_SHARE));
    let is_minor = b.lt(share, minor);
    let is_near = b.or(is_near, is_minor);
    let least = b.select(is_near, three, four);
    let minus = b.neg(needed);
    let floor = b.floor(minus);
    let rows = b.neg(floor);
    let rows = b.max(rows, least);
    let most = b.f32(MOST_ROWS);
    let rows = b.min(rows, most);

    // The octave fades to nothing before it is dropped.
    let least = b.f32(LEAST_SHARE);
    let share = b.max(share, least);
    let kept = b.mul(energy.left, share);
    let by_energy = ramp(b, kept, FADE);
    let by_reach = ramp(b, needed, [MOST_ROWS, MOST_ROWS * 0.8]);
    let fade = b.mul(by_energy, by_reach);
    let gone = b.le(fade, zero);
    let (none, row_count) = (b.u32(0), b.trunc_i(rows));
    let row_count = b.cast_u(row_count);
    let row_count = b.select(gone, none, row_count);

    // The position in the rows' frame.
    let [x, y] = state.fractions;
    let (x, y) = (b.select(swapped, y, x), b.select(swapped, x, y));
    let half = b.scale(rows, -0.5);
    let start = b.add(y, half);
    let start = b.floor(start);
    let start = b.offset(start, 1.0);
    let address = state
        .address(b)
        .swapped(b, swapped)
        .rows_counted_from(b, start);
    // Of four rows the one that is not among the nearest three.
    let (first_row, last_row, no_row) = (b.u32(0), b.u32(3), b.u32(u32::MAX));
    let floor = b.floor(y);
    let fraction = b.sub(y, floor);
    let rounded = b.offset(fraction, 0.5);
    let right = b.le(one, rounded);
    let outer_row = b.select(right, first_row, last_row);
    let outer_row = b.select(is_near, no_row, outer_row);
    let minus = b.f32(-1.0);
    let sign = b.select(swapped, minus, one);
    let square = b.square(shear);
    let even = b.sub(one, square);
    let turn = [
        b.mul(sign, even),
        b.mul(sign, shear),
        b.neg(sign),
        b.add(shear, shear),
    ];
    let frame = Frame {
        x,
        y: b.sub(y, start),
        address,
        shear,
        turn,
        precisions: [p, q],
        decay,
        outer_row,
        outer,
    };
    let zeros = vec![zero; orders(count).len()];
    let kernels = b.fold(&row, row_count, &zeros, &frame.captures());
    let parts = in_lattice(b, swapped, shear, &kernels);

    // κ = a³/(√π √det T) = a/√(πD).
    let kappa = b.scale(energy.root, WIDTH / std::f32::consts::PI.sqrt());
    let faded = b.mul(kappa, fade);
    let weight = b.mul(faded, state.amplitude);
    let steep = b.mul(weight, state.scale);
    let bent = b.mul(weight, area);
    let weights = [weight, steep, steep, bent, bent, bent];
    for (((name, sum), part), weight) in names.iter().zip(sums).zip(parts).zip(weights) {
        let part = b.mul(weight, part);
        let total = b.add(sum, part);
        b.result(*name, total);
    }
    if let Some(rest) = rest {
        let left = remainder(b, mode, &energy, fade);
        let part = b.mul(power, left);
        let rest = b.add(rest, part);
        b.result("rest", rest);
    }
    state.advance(b, octaves);
    builder.finish(module)
}

/// The noise and its derivatives (x, y, xx, xy, yy) in the lattice's frame, from those along x′ and y
/// up to the sign (−1)^{i+j}: ∂ₓ is ∂ₓ′, and ∂ᵧ is ∂ᵧ − t∂ₓ′.
fn in_lattice(b: &mut Builder, swapped: Value, t: Value, sums: &[Value]) -> Vec<Value> {
    let mut parts = vec![sums[0]];
    if let [_, x, y, ..] = *sums {
        let lean = b.mul(t, x);
        let y = b.sub(lean, y);
        let x = b.neg(x);
        parts.extend([b.select(swapped, y, x), b.select(swapped, x, y)]);
    }
    if let [_, _, _, xx, xy, yy] = *sums {
        let lean = b.mul(t, xx);
        let mixed = b.sub(xy, lean);
        let twice = b.add(t, t);
        let square = b.square(t);
        let cross = b.mul(twice, xy);
        let steep = b.mul(square, xx);
        let yy = b.sub(yy, cross);
        let yy = b.add(yy, steep);
        parts.extend([b.select(swapped, yy, xx), mixed, b.select(swapped, xx, yy)]);
    }
    parts
}

/// What the filter removed, 1 − F, less what the mode carries of it, plus what fading drops: shares
/// of the octave's variance. V − V₁ is at least V₂; below 6e-7 the difference is rounding.
fn remainder(b: &mut Builder, mode: Mode, energy: &Energy, fade: Value) -> Value {
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let lost = b.sub(one, energy.left);
    let square = b.square(fade);
    let kept = b.sub(one, fade);
    let dropped = b.square(kept);
    let dropped = b.mul(dropped, energy.left);
    let uncarried = b.sub(one, square);
    let (carried, least) = match mode {
        Mode::Local => (energy.first, energy.least),
        Mode::Quad => (b.add(energy.first, energy.second), zero),
        _ => (zero, zero),
    };
    let left = b.sub(lost, carried);
    let left = b.offset(left, -6e-7);
    let left = b.max(left, least);
    let back = b.mul(uncarried, carried);
    let left = b.add(left, back);
    b.add(left, dropped)
}
