//! Random cells in space: layers of rows of cells.
//!
//! Given the layer, the other two coordinates are taken for Gaussian with the mean and the covariance
//! that they have given it, and what they are over a layer is what they are over a plane of cells.

use super::passed::{Passed, passed};
use super::place::declared;
use super::{
    Cells, Content, Lattice, MOST, NARROWEST, Plane, Slice, coincidence, counted, deviation,
    fading, inside, report, row, window,
};
use crate::noise::components::Hash;
use crate::noise::period::wrapped;
use crate::noise::things::{
    Filtered, Sums, attach, channels, declared_ensemble, ensemble, named, weighted,
};
use crate::noise::volume::{Spread, at};
use mipless_codegen::ir::{
    Builder, Float, FunctionRef, Int, Module, Scalar, Scalars, Sym2, Uint, Vec2, dot,
};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Image, Lower, pairs};

/// How far inside its cell the origin lies along each axis: more than the rounding of a place, and less
/// than anyone sees.
const INSIDE: f32 = 1.0 / 1024.0;

/// The filtered cells at a position in space, in cells, for each component of the image that is asked
/// for.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    lattice: Lattice,
) -> Vec<Signal<'b>> {
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
    let (image, parameters) = lower.image();
    let key = format!("cells in space {mode:?} {lattice:?} {}", image.key());
    let function = lower.function(&key, |module| build(module, mode, lattice, &image));
    let places: Vec<(Int<'b>, Float<'b>)> = position.iter().map(Signal::place).collect();
    let captures = mode.filters().then_some(spread);
    let [xx, _, _, yy, _, zz] = *spread.covariance;
    let widest = xx.max(yy).max(zz);
    let ensemble = ensemble(lower, &image, || fading(deviation(widest)[0], MOST).lt(1.0));
    let sums = b.call(&function, (places, parameters, ensemble, captures));
    let (fields, rest) = sums.split_at(sums.len().min(4 * image.channels()));
    let mut signals: Vec<Signal<'b>> = (fields.chunks(4))
        .map(|field| {
            let mut parts = field.to_vec();
            match mode {
                // Slopes, but no bends.
                Mode::Quad => parts.extend([b.float(0.0); 6]),
                Mode::Ensemble => parts.truncate(1),
                _ => {}
            }
            parts.push(b.float(0.0));
            at(lower, position, &parts)
        })
        .collect();
    attach(lower, &image, &mut signals, rest);
    signals
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
    /// What all layers have in common: where their window starts, and the place.
    struct Layers {
        start: Float,
        x: Float,
        y: Float,
        z: Float,
    }
}

passed! {
    /// Which cells these are, the Gaussian along z, and what x and y have by it and given it.
    struct LayersCells {
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

/// Sums over the layers: as over rows, and of the slope along z.
#[derive(Clone, Debug)]
struct LayerSums<'b> {
    rows: Sums<'b>,
    slope_z: Vec<Float<'b>>,
}

impl<'b> Scalars<'b> for LayerSums<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.rows.each(visit);
        self.slope_z.each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        Self {
            rows: self.rows.replaced(next),
            slope_z: self.slope_z.replaced(next),
        }
    }
}

/// One layer of cells, the body of a fold.
fn layer(module: &mut Module, lattice: Lattice, image: &Image) -> FunctionRef {
    let row = row(module, Content::InLayer(lattice), image);
    let b = &Builder::new("cell_layer", "One layer of cells.");
    let index = b.uint_param("index");
    let count = image.channels();
    let sums = LayerSums {
        rows: Sums::declare(b, count),
        slope_z: channels(b, "slope_z", count),
    };
    let layers = Layers::declare(b);
    let centre = channels(b, "centre", count);
    let of_layers = LayersCells::declare(b);
    let parameters = image.declare(b);
    let place = layers.start + index.to_float();
    let slice = Slice::of(place - layers.z, [of_layers.sd_z, of_layers.inverse_sd_z]);

    // x and y given the layer.
    let shear = Vec2([of_layers.shear_x, of_layers.shear_y]);
    let mean = Vec2([layers.x, layers.y]) + shear * slice.moved;
    let own = Sym2([of_layers.s_xx, of_layers.s_xy, of_layers.s_yy]);
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
    let determinant = of_layers.determinant + more;

    let cells = Cells {
        centre,
        origin: [of_layers.cell_x, of_layers.cell_y],
        seed: layer_seed(of_layers.cell_z + place.to_int(), of_layers.seed, lattice),
        fade: of_layers.fade,
        parameters,
    };
    let plane = Plane::of(&row, *mean, (covariance, determinant), &cells);
    let weight = slice.weight;
    let along = |axis: usize| -> Vec<Float<'_>> {
        plane.slopes.iter().map(|slopes| slopes[axis]).collect()
    };
    let slope_z = (sums.slope_z.iter().zip(&plane.first).zip(&plane.slopes)).map(
        |((&sum, &first), &slopes)| {
            let shifted = shear.dot(slopes);
            sum + slice.slope(of_layers.inverse_sd_z, first, shifted)
        },
    );
    let slope_z: Vec<Float<'_>> = slope_z.collect();
    let rows = Sums {
        weight: sums.rows.weight + weight,
        first: weighted(sums.rows.first, weight, &plane.first),
        second: weighted(sums.rows.second, weight, &plane.second),
        slope_x: weighted(sums.rows.slope_x, weight, &along(0)),
        slope_y: weighted(sums.rows.slope_y, weight, &along(1)),
    };
    rows.results(b);
    b.results(named(&[("slope_z", count)]), slope_z);
    b.finish(module)
}

fn build(module: &mut Module, mode: Mode, lattice: Lattice, image: &Image) -> FunctionRef {
    let layer = mode.filters().then(|| layer(module, lattice, image));
    let b = &Builder::new("cells_in_space", "Filtered random cells in space.");
    let (origin, [x, y, z]) = declared::<3>(b);
    let parameters = image.declare(b);
    let [cell_x, cell_y, cell_z] = origin;
    let seed = lattice.scrambled(b, 0x510e_527f);
    let [column, row, own] =
        [(cell_x, x), (cell_y, y), (cell_z, z)].map(|(cell, at)| cell + at.floor().to_int());
    let centre = lattice.in_layer([column, row], layer_seed(own, seed, lattice));
    let centre = image.of(centre, &parameters);
    let Some(layer) = layer else {
        b.results(named(&[("mean", centre.len())]), centre);
        return b.finish(module);
    };
    let ensemble = declared_ensemble(b, image);
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
    let fade = fading(xx.max(yy).max(raised).sqrt(), MOST);
    let [start, layers_in_window] = window(z, sd_z);
    let layers = Layers { start, x, y, z };
    let of_layers = LayersCells {
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
    let zero = b.float(0.0);
    let before = LayerSums {
        rows: Sums::zero(b, image.channels()),
        slope_z: vec![zero; image.channels()],
    };
    let captures = (layers, &centre, of_layers, &parameters);
    let sums = b.fold(&layer, counted(layers_in_window, fade), before, captures);
    let LayerSums { rows, slope_z } = sums;
    let scale = 1.0 / rows.weight.max(1e-6);
    let slopes: Vec<[Float<'_>; 3]> = (rows.slope_x.iter().zip(&rows.slope_y).zip(&slope_z))
        .map(|((&x, &y), &z)| [x, y, z].map(|sum| sum * scale))
        .collect();
    let through: Vec<[Float<'_>; 3]> = (slopes.iter())
        .map(|&slopes| [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| dot(row, slopes)))
        .collect();

    // The two axes of a footprint on a surface.
    let major = spread.size().square();
    let minor = (minor_xx + minor_yy + minor_zz).max(0.0) / (major + NARROWEST);
    let [along, across] = [major, minor].map(coincidence);
    let filtered = Filtered {
        centre,
        first: rows.first.iter().map(|&sum| sum * scale).collect(),
        second: rows.second.iter().map(|&sum| sum * scale).collect(),
        linear: (pairs(slopes.len()).map(|(i, k)| dot(slopes[i], through[k]))).collect(),
        slopes: slopes.iter().map(|slopes| slopes.to_vec()).collect(),
        fade,
        same: along * across,
    };
    filtered.results(b, mode, ensemble.as_ref());
    b.finish(module)
}
