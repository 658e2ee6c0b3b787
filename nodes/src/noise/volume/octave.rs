//! One octave of the noise in space.

use super::kernel::{COUNTS, slice, window};
use super::points::Points;
use super::spread::{Inverse, Spread};
use super::{Kind, NAMES, PAIRS, parts, place, quadrupole, quintic};
use crate::noise::octave::Octave;
use crate::noise::perlin::HANDOVER;
use crate::noise::remainder::{remainder, share};
use crate::noise::sum::Octaves;
use crate::noise::window::start;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::Mode;

/// Below this share of its amplitude an octave has faded, above the other it has not begun to.
const FADE: [f32; 2] = [0.03, 0.06];

/// A kernel is dropped where its envelope is this small against the unfiltered noise: −2 ln 0.0032.
const NEGLIGIBLE_LN: f32 = 11.5;

/// One octave of the unfiltered noise, the body of a fold.
pub(super) fn point(module: &mut Module, kind: Kind, octaves: Octaves) -> FunctionRef {
    let near = (kind == Kind::Quadrupole).then(|| quadrupole::Point::new(module, octaves.tiles()));
    let doc = "One more octave of the unfiltered noise in space.";
    let mut builder = Builder::new("volume_octave", doc);
    let b = &mut builder;
    b.param("index", Type::U32);
    let sum = b.param_f32("mean");
    let state = Octave::declare(b, octaves);
    let points = Points::of(b, &state);
    let kernels = match near {
        Some(near) => near.sum(b, points, state.fractions),
        None => quintic::point(b, points, state.fractions),
    };
    let amplitude = b.scale(state.amplitude, kind.unit());
    let part = b.mul(kernels, amplitude);
    let sum = b.add(sum, part);
    b.result("mean", sum);
    state.advance(b, octaves);
    builder.finish(module)
}

/// The lattice points that a footprint needs: the extents (in cells) along z, along y at a z, and along
/// x at a y and z, how far each leans, and how much of the octave there is. What needs more than can be
/// summed fades.
struct Reach {
    extents: [Value; 3],
    /// Along y by z, and along x by y and z.
    leans: [Value; 3],
    fade: Value,
}

impl Reach {
    /// Kernels reach R² = ln F + 11.5, along z, along y at a z, along x at a y and z.
    fn of(
        b: &mut Builder,
        kind: Kind,
        (inverse, total): (&Inverse, &[Value; 6]),
        energy: Value,
    ) -> Self {
        let (zero, one, tiny) = (b.f32(0.0), b.f32(1.0), b.f32(1e-12));
        let left = b.max(energy, tiny);
        let reach = b.ln(left);
        let reach = b.offset(reach, NEGLIGIBLE_LN);
        let reach = b.max(reach, one);
        let reach = b.sqrt(reach);
        let reach = b.scale(reach, 2.0 * kind.width());
        let [p_xx, p_xy, p_xz, ..] = inverse.matrix;
        let whole = b.mul(total[5], inverse.shrink);
        let along_y = b.div(p_xx, whole);
        let along_x = b.div(one, p_xx);
        let mut most = zero;
        let extents = [total[5], along_y, along_x].map(|variance| {
            let size = b.sqrt(variance);
            let needed = b.mul(size, reach);
            most = b.max(most, needed);
            needed
        });
        // The octave fades to nothing before it is dropped.
        let amplitude = b.sqrt(left);
        let by_amplitude = share(b, amplitude, FADE[0], FADE[1]);
        let by_reach = share(b, most, COUNTS[1], COUNTS[1] * 0.8);
        let [lean_y, lean_z] = [p_xy, p_xz].map(|p| {
            let lean = b.div(p, p_xx);
            b.neg(lean)
        });
        Self {
            extents,
            leans: [b.div(total[4], total[5]), lean_y, lean_z],
            fade: b.mul(by_amplitude, by_reach),
        }
    }
}

/// One octave of the filtered noise, the body of a fold.
pub(super) fn filtered(
    module: &mut Module,
    kind: Kind,
    mode: Mode,
    octaves: Octaves,
) -> FunctionRef {
    let (parts, tiles) = (parts(mode), octaves.tiles());
    let corner = (kind == Kind::Quintic).then(|| quintic::corner(module, parts, tiles));
    let slice = slice(module, kind, parts, tiles);
    let doc = "One more octave of the filtered noise in space.";
    let mut builder = Builder::new("volume_octave", doc);
    let b = &mut builder;
    b.param("index", Type::U32);
    let sums: Vec<Value> = NAMES[..parts]
        .iter()
        .map(|name| b.param_f32(*name))
        .collect();
    let rest = mode.spreads().then(|| b.param_f32("rest"));
    let state = Octave::declare(b, octaves);
    let spread = Spread::declare(b).scaled(b, state.scale);
    let inverse = spread.inverse(b);
    let energy = kind.energy(b, &spread, &inverse);
    let total: [Value; 6] = std::array::from_fn(|at| match at {
        0 | 3 | 5 => b.offset(spread.covariance[at], 1.0),
        _ => spread.covariance[at],
    });
    let reach = Reach::of(b, kind, (&inverse, &total), energy[0]);
    let points = Points::of(b, &state);
    let (zero, one, none) = (b.f32(0.0), b.f32(1.0), b.u32(0));
    let width = kind.width();

    // Narrow footprints act on the polynomials of the window.
    let (by_kernels, close) = match corner {
        None => (one, None),
        Some(corner) => {
            let size = spread.size(b);
            let [low, high] = HANDOVER.map(|size| size / width);
            let by_kernels = share(b, size, low, high);
            let by_corners = b.sub(one, by_kernels);
            let is_near = b.lt(zero, by_corners);
            let eight = b.u32(8);
            let turns = b.select(is_near, eight, none);
            let mut captures = points.captures();
            captures.extend(state.fractions);
            captures.extend(spread.covariance.map(|s| b.scale(s, width * width)));
            let sums = b.fold(&corner, turns, &vec![zero; parts], &captures);
            (by_kernels, Some((by_corners, sums)))
        }
    };
    let used = b.mul(by_kernels, reach.fade);
    let is_used = b.lt(zero, used);
    let [slices, turns] = window(b, reach.extents[0], None);
    let turns = b.select(is_used, turns, none);

    let [x, y, z] = state.fractions;
    let first = start(b, z, slices);
    let mut captures = reach.extents.to_vec();
    captures.extend(reach.leans);
    let dz = b.sub(z, first);
    captures.extend([x, y, b.scale(dz, 1.0 / width)]);
    captures.extend(points.moved(b, 2, first).captures());
    captures.extend(inverse.matrix);
    captures.extend(total);
    let kernels = b.fold(&slice, turns, &vec![zero; parts], &captures);

    // κ = κ₀/√det(I + S), and P on the sums.
    let root = b.sqrt(inverse.shrink);
    let weight = match kind {
        Kind::Quadrupole => root,
        // The offset is in units of the width.
        Kind::Quintic => b.scale(root, width),
    };
    let weight = b.mul(weight, used);
    let totals = applied(b, &inverse, &kernels);
    let amplitude = b.scale(state.amplitude, kind.unit());
    let area = b.square(state.scale);
    let factors = [one, state.scale, area].map(|factor| b.mul(factor, amplitude));
    for (at, (name, sum)) in NAMES.into_iter().zip(sums).enumerate() {
        let order = match at {
            0 => 0,
            1..4 => 1,
            _ => 2,
        };
        let finer = b.scale(weight, width.powi(-order));
        let mut part = b.mul(finer, totals[at]);
        if let Some((by_corners, sums)) = &close {
            part = b.dot(&[finer, *by_corners], &[totals[at], sums[at]]);
        }
        let part = b.mul(factors[order as usize], part);
        let total = b.add(sum, part);
        b.result(name, total);
        if at + 1 == parts {
            break;
        }
    }
    if let Some(rest) = rest {
        // Narrow footprints do not fade.
        let fade = match &close {
            Some((by_corners, _)) => b.add(*by_corners, used),
            None => used,
        };
        let left = remainder(b, mode, energy, fade);
        let power = b.square(state.amplitude);
        let part = b.mul(power, left);
        let rest = b.add(rest, part);
        b.result("rest", rest);
    }
    state.advance(b, octaves);
    builder.finish(module)
}

/// P on the sums: derivatives in units of the kernel's width.
fn applied(b: &mut Builder, inverse: &Inverse, kernels: &[Value]) -> Vec<Value> {
    let row = |i: usize| [0, 1, 2].map(|j| inverse.matrix[place(i, j)]);
    let mut totals = vec![kernels[0]];
    if let Some(sums) = kernels.get(1..4) {
        for i in 0..3 {
            totals.push(b.dot(&row(i), sums));
        }
    }
    if let Some(sums) = kernels.get(4..10) {
        for [i, j] in PAIRS {
            let inner = [0, 1, 2].map(|k| {
                let column = [0, 1, 2].map(|l| sums[place(k, l)]);
                b.dot(&column, &row(j))
            });
            totals.push(b.dot(&row(i), &inner));
        }
    }
    totals
}
