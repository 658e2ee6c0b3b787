//! Random cells in space: layers of rows of cells.
//!
//! Given the layer, the other two coordinates are taken for Gaussian with the mean and the covariance
//! that they have given it, and what they are over a layer is what they are over a plane of cells.

use super::passed::{Passed, passed};
use super::place::declared;
use super::{
    Cells, Filtered, Lattice, NARROWEST, Plane, Slice, coincidence, counted, deviation, fading,
    inside, report, row, window,
};
use crate::noise::components::Hash;
use crate::noise::period::wrapped;
use crate::noise::volume::{Spread, at};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Module, Sym2, Uint, Vec2, dot};
use mipless_codegen::moments::{Mode, Signal};

/// How far inside its cell the origin lies along each axis: more than the rounding of a place, and less
/// than anyone sees.
const INSIDE: f32 = 1.0 / 1024.0;

/// The filtered cells at a position in space, in cells.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    lattice: Lattice,
) -> Signal<'b> {
    let (mode, b) = (lower.mode(), lower.b());
    // A surface at 0, as every flat view is, must not lie on faces of cells: half of a footprint would be
    // in another layer at every size. MaterialX's cells lie where they lie.
    let inside = match lattice.hash {
        Hash::Mipless => INSIDE,
        Hash::Materialx => 0.0,
    };
    let position: Vec<Signal<'b>> = (position.iter()).map(|axis| axis.offset(inside)).collect();
    let position = &position[..];
    let spread = Spread::of(position, 1.0);
    report(lower, spread.size());
    let key = format!("cells in space {mode:?} {lattice:?}");
    let function = lower.function(&key, |module| build(module, mode, lattice));
    let places: Vec<(Int<'b>, Float<'b>)> = position.iter().map(Signal::place).collect();
    let captures = mode.filters().then_some(spread);
    let mut sums = b.call(&function, (places, captures));
    match mode {
        Mode::Quad => {
            // Slopes, but no bends.
            sums.splice(4..4, [b.float(0.0); 6]);
        }
        Mode::Ensemble => {
            sums.drain(1..4);
        }
        _ => {}
    }
    at(lower, position, &sums)
}

/// What the cells of a layer share: its seed, or its number, which MaterialX hashes with theirs.
fn layer_seed<'b>(layer: Int<'b>, seed: Uint<'b>, lattice: Lattice) -> Uint<'b> {
    let layer = wrapped(layer, lattice.period);
    if lattice.hash == Hash::Materialx {
        return layer.to_uint();
    }
    (layer.to_uint() * 0x27d4_eb2f + seed).scramble()
}

passed! {
    /// What all layers have in common: where their window starts, the place, the number at the centre,
    /// the Gaussian along z, and what x and y have by it and given it.
    struct Layers {
        start: Float,
        x: Float,
        y: Float,
        z: Float,
        centre: Float,
        cell_x: Int,
        cell_y: Int,
        cell_z: Int,
        seed: Uint,
        sd_z: Float,
        inverse_sd_z: Float,
        fade: Float,
        shear_x: Float,
        shear_y: Float,
        s_xx: Float,
        s_xy: Float,
        s_yy: Float,
        determinant: Float,
    }
}

passed! {
    /// Sums over the layers: of the weight, of d, of d², and of the slopes of d.
    struct LayerSums {
        weight: Float,
        first: Float,
        second: Float,
        slope_x: Float,
        slope_y: Float,
        slope_z: Float,
    }
}

/// One layer of cells, the body of a fold.
fn layer(module: &mut Module, lattice: Lattice) -> FunctionRef {
    let row = row(module, lattice, true);
    let b = &Builder::new("cell_layer", "One layer of cells.");
    let index = b.uint_param("index");
    let sums = LayerSums::declare(b);
    let layers = Layers::declare(b);
    let place = layers.start + index.to_float();
    let slice = Slice::of(place - layers.z, [layers.sd_z, layers.inverse_sd_z]);

    // x and y given the layer.
    let shear = Vec2([layers.shear_x, layers.shear_y]);
    let mean = Vec2([layers.x, layers.y]) + shear * slice.moved;
    let own = Sym2([layers.s_xx, layers.s_xy, layers.s_yy]);
    let swept = shear * slice.within;
    let covariance = own
        + Sym2([
            swept[0] * shear[0],
            swept[0] * shear[1],
            swept[1] * shear[1],
        ]);
    // det (Σ + w ββᵀ) = det Σ + w βᵀ adj(Σ) β, here of the first Σ.
    let adjugate = Sym2([own[2], -own[1], own[0]]);
    let more = swept.dot(adjugate.times(shear)).max(0.0);
    let determinant = layers.determinant + more;

    let cells = Cells {
        centre: layers.centre,
        origin: [layers.cell_x, layers.cell_y],
        seed: layer_seed(layers.cell_z + place.to_int(), layers.seed, lattice),
        fade: layers.fade,
    };
    let plane = Plane::of(&row, *mean, (covariance, determinant), &cells);
    let shifted = shear.dot(plane.slopes);
    let slope_z = slice.slope(layers.inverse_sd_z, plane.first, shifted);
    LayerSums {
        weight: sums.weight + slice.weight,
        first: sums.first + slice.weight * plane.first,
        second: sums.second + slice.weight * plane.second,
        slope_x: sums.slope_x + slice.weight * plane.slopes[0],
        slope_y: sums.slope_y + slice.weight * plane.slopes[1],
        slope_z: sums.slope_z + slope_z,
    }
    .results(b);
    b.finish(module)
}

fn build(module: &mut Module, mode: Mode, lattice: Lattice) -> FunctionRef {
    let layer = mode.filters().then(|| layer(module, lattice));
    let b = &Builder::new("cells_in_space", "Filtered random cells in space.");
    let (origin, [x, y, z]) = declared::<3>(b);
    let [cell_x, cell_y, cell_z] = origin;
    let seed = lattice.scrambled(b, 0x510e_527f);
    let [column, row, own] =
        [(cell_x, x), (cell_y, y), (cell_z, z)].map(|(cell, at)| cell + at.floor().to_int());
    let centre = lattice.in_layer([column, row], layer_seed(own, seed, lattice));
    let Some(layer) = layer else {
        b.result("mean", centre);
        return b.finish(module);
    };
    let spread = Spread::declare(b);
    let [xx, xy, xz, yy, yz, zz] = *spread.covariance;
    let [minor_xx, minor_xy, _, minor_yy, _, minor_zz] = *spread.adjugate;
    let [x, y, z] = [inside(x, xx), inside(y, yy), inside(z, zz)];
    let raised = zz + NARROWEST;
    let [sd_z, inverse_sd_z] = deviation(zz);
    let precision = inverse_sd_z.square();
    // The covariance given z, from the minors of Σ, for Σ₃₃ as it is raised.
    let minors = [
        (minor_yy, xx),
        (-minor_xy, xy),
        (minor_xx, yy),
        (spread.determinant, minor_zz),
    ];
    let [s_xx, s_xy, s_yy, determinant] =
        minors.map(|(minor, own)| (minor + own * NARROWEST) * precision);
    let fade = fading(xx.max(yy).max(raised).sqrt());
    let [start, count] = window(z, sd_z);
    let layers = Layers {
        start,
        x,
        y,
        z,
        centre,
        cell_x,
        cell_y,
        cell_z,
        seed,
        sd_z,
        inverse_sd_z,
        fade,
        shear_x: xz * precision,
        shear_y: yz * precision,
        s_xx,
        s_xy,
        s_yy,
        determinant,
    };
    let sums = b.fold(&layer, counted(count, fade), LayerSums::zero(b), layers);
    let scale = 1.0 / sums.weight.max(1e-6);
    let slopes = [sums.slope_x, sums.slope_y, sums.slope_z].map(|sum| sum * scale);
    let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| dot(row, slopes));

    // The two axes of a footprint on a surface.
    let major = spread.size().square();
    let minor = (minor_xx + minor_yy + minor_zz).max(0.0) / (major + NARROWEST);
    let [along, across] = [major, minor].map(coincidence);
    let filtered = Filtered {
        centre,
        first: sums.first * scale,
        second: sums.second * scale,
        slopes: &slopes,
        linear: dot(slopes, rows),
        fade,
        same: along * across,
    };
    filtered.results(b, mode);
    b.finish(module)
}
