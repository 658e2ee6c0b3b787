//! One octave of the noise in space.

use super::kernel::{COUNTS, slice, window};
use super::points::Points;
use super::spread::Spread;
use super::symmetric::{PAIRS, Shape, Symmetric};
use super::{Kind, NAMES, parts, quadrupole, quintic};
use crate::noise::perlin::HANDOVER;
use crate::noise::remainder::{remainder, share};
use crate::noise::sum::Octave;
use crate::noise::sum::Octaves;
use crate::noise::window::start;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, dot};
use mipless_codegen::moments::Mode;

/// Below this share of its amplitude an octave has faded, above the other it has not begun to.
const FADE: [f32; 2] = [0.03, 0.06];

/// A kernel is dropped where its envelope is this small against the unfiltered noise: −2 ln 0.0032.
const NEGLIGIBLE_LN: f32 = 11.5;

/// One octave of the unfiltered noise, the body of a fold.
pub(super) fn point(module: &mut Module, kind: Kind, octaves: Octaves) -> FunctionRef {
    let near = (kind == Kind::Quadrupole).then(|| quadrupole::Point::new(module, octaves.tiles()));
    let doc = "One more octave of the unfiltered noise in space.";
    let b = &Builder::new("volume_octave", doc);
    b.uint_param("index");
    let sum = b.float_param("mean");
    let state = Octave::declare(b, octaves);
    let points = Points::of(&state, kind);
    let kernels = match near {
        Some(near) => near.sum(points, state.fractions),
        None => quintic::point(points, state.fractions, kind),
    };
    b.result("mean", sum + kernels * (state.amplitude * kind.unit()));
    state.advance(b, octaves);
    b.finish(module)
}

/// The lattice points that a footprint needs: the extents (in cells) along z, along y at a z, and along
/// x at a y and z, how far each leans, and how much of the octave there is. What needs more than can be
/// summed fades.
struct Reach<'b> {
    extents: [Float<'b>; 3],
    /// Along y by z, and along x by y and z.
    leans: [Float<'b>; 3],
    fade: Float<'b>,
}

impl<'b> Reach<'b> {
    /// Kernels reach R² = ln F + 11.5, along z, along y at a z, along x at a y and z; `shrink` is
    /// 1/det(I + S).
    fn of(kind: Kind, shape: &Shape<'b>, shrink: Float<'b>, energy: Float<'b>) -> Self {
        let left = energy.max(1e-12);
        let reach = (left.ln() + NEGLIGIBLE_LN).max(1.0).sqrt() * (2.0 * kind.width());
        let [p_xx, p_xy, p_xz, ..] = *shape.inverse;
        let [.., t_yz, t_zz] = *shape.total;
        let along_y = p_xx / (t_zz * shrink);
        let along_x = 1.0 / p_xx;
        let extents = [t_zz, along_y, along_x].map(|variance| variance.sqrt() * reach);
        // The octave fades to nothing before it is dropped.
        let most = extents
            .into_iter()
            .fold(left.literal(0.0), |most, extent| most.max(extent));
        let by_amplitude = share(left.sqrt(), FADE[0], FADE[1]);
        let by_reach = share(most, COUNTS[1], COUNTS[1] * 0.8);
        Self {
            extents,
            leans: [t_yz / t_zz, -(p_xy / p_xx), -(p_xz / p_xx)],
            fade: by_amplitude * by_reach,
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
    let corner = (kind != Kind::Quadrupole).then(|| quintic::corner(module, kind, parts, tiles));
    let slice = slice(module, kind, parts, tiles);
    let doc = "One more octave of the filtered noise in space.";
    let b = &Builder::new("volume_octave", doc);
    b.uint_param("index");
    let sums: Vec<Float<'_>> = NAMES[..parts]
        .iter()
        .map(|name| b.float_param(*name))
        .collect();
    let rest = mode.spreads().then(|| b.float_param("rest"));
    let state = Octave::declare(b, octaves);
    let spread = Spread::declare(b).scaled(state.scale);
    let inverse = spread.inverse();
    let energy = kind.energy(&spread, &inverse);
    let shape = Shape {
        inverse: inverse.matrix,
        total: spread.covariance.raised(),
    };
    let points = Points::of(&state, kind);
    let zeros = vec![b.float(0.0); parts];
    let width = kind.width();

    // Narrow footprints act on the polynomials of the window.
    let (by_kernels, close) = match corner {
        None => (b.float(1.0), None),
        Some(corner) => {
            let [low, high] = HANDOVER.map(|size| size / width);
            let by_kernels = share(spread.size(), low, high);
            let by_corners = 1.0 - by_kernels;
            let turns = by_corners.gt(0.0).select(8u32, 0u32);
            let covariance = spread.covariance.map(|s| s * (width * width));
            let captures = (points, state.fractions, covariance);
            let sums = b.fold(&corner, turns, zeros.clone(), captures);
            (by_kernels, Some((by_corners, sums)))
        }
    };

    // Wider ones are summed over kernels.
    let reach = Reach::of(kind, &shape, inverse.shrink, energy[0]);
    let used = by_kernels * reach.fade;
    let (slices, turns) = window(reach.extents[0], None);
    let turns = used.gt(0.0).select(turns, 0);
    let [x, y, z] = state.fractions;
    let first = start(z, slices);
    let place = [x, y, (z - first) * (1.0 / width)];
    let captures = (
        reach.extents,
        reach.leans,
        place,
        points.moved(2, first),
        shape,
    );
    let kernels = b.fold(&slice, turns, zeros, captures);

    // κ = κ₀/√det(I + S), and P on the sums.
    let root = inverse.shrink.sqrt();
    let weight = match kind {
        Kind::Quadrupole => root,
        // The offset is in units of the width.
        Kind::Quintic | Kind::Materialx(_) => root * width,
    };
    let weight = weight * used;
    let totals = applied(&inverse.matrix, &kernels);
    let amplitude = state.amplitude * kind.unit();
    let area = state.scale.square();
    let factors = [amplitude, state.scale * amplitude, area * amplitude];
    for (at, (name, sum)) in NAMES.into_iter().zip(sums).enumerate() {
        let order = match at {
            0 => 0,
            1..4 => 1,
            _ => 2,
        };
        let mut part = weight * width.powi(-order) * totals[at];
        if let Some((by_corners, sums)) = &close {
            part += *by_corners * sums[at];
        }
        b.result(name, sum + factors[order as usize] * part);
    }
    if let Some(rest) = rest {
        // Narrow footprints do not fade.
        let fade = match &close {
            Some((by_corners, _)) => *by_corners + used,
            None => used,
        };
        let left = remainder(mode, energy, fade);
        b.result("rest", rest + state.amplitude.square() * left);
    }
    state.advance(b, octaves);
    b.finish(module)
}

/// P on the sums: derivatives in units of the kernel's width.
fn applied<'b>(inverse: &Symmetric<'b>, kernels: &[Float<'b>]) -> Vec<Float<'b>> {
    let mut totals = vec![kernels[0]];
    if let Some(&[x, y, z]) = kernels.get(1..4) {
        totals.extend(inverse.times([x, y, z]));
    }
    if let Some(sums) = kernels.get(4..10) {
        let sums = Symmetric(sums.try_into().expect("six numbers"));
        totals.extend(PAIRS.map(|[i, j]| dot(inverse.row(i), sums.times(inverse.row(j)))));
    }
    totals
}
