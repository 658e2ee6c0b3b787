//! Random cells in space: layers of rows of cells.
//!
//! Given the layer, the other two coordinates are taken for Gaussian with the mean and the covariance
//! that they have given it, and what they are over a layer is what they are over a plane of cells.

use super::{
    Filtered, Plane, Slice, coincidence, counted, fading, lattice_seed, number, places, report,
    row, window,
};
use crate::noise::period::wrapped;
use crate::noise::volume::{Spread, at};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};

/// The filtered cells at a position in space, in cells.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    position: &[Signal],
    seed: i32,
    period: i32,
) -> Signal {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position, 1.0);
    let size = spread.size(lower.b());
    report(lower, size);
    let key = format!("cells in space {mode:?} {seed} {period}");
    let function = lower.function(&key, |module| build(module, mode, seed, period));
    let b = lower.b();
    let mut arguments = places(b, position);
    if mode.filters() {
        arguments.extend(spread.captures());
    }
    let mut sums = b.call(&function, &arguments);
    match mode {
        Mode::Quad => {
            // Slopes, but no bends.
            let zero = b.f32(0.0);
            sums.splice(4..4, [zero; 6]);
        }
        Mode::Ensemble => {
            sums.drain(1..4);
        }
        _ => {}
    }
    at(lower, position, &sums)
}

/// The seed of a layer.
fn layer_seed(b: &mut Builder, layer: Value, seed: Value, period: i32) -> Value {
    let layer = wrapped(b, layer, period);
    let layer = b.cast_u(layer);
    let factor = b.u32(0x27d4_eb2f);
    let layer = b.mul_u(layer, factor);
    let layer = b.add_u(layer, seed);
    b.scramble(layer)
}

/// One layer of cells, the body of a fold: sums of the weight, of d, of d², and of the slopes.
fn layer(module: &mut Module, period: i32) -> FunctionRef {
    let row = row(module, period);
    let mut b = Builder::new("cell_layer", "One layer of cells.");
    let index = b.param("index", Type::U32);
    let names = ["weight", "first", "second", "slope_x", "slope_y", "slope_z"];
    let state = names.map(|name| b.param_f32(name));
    let start = b.param_f32("start");
    let [x, y, z] = ["x", "y", "z"].map(|name| b.param_f32(name));
    let centre = b.param_f32("centre");
    let cells = ["cell_x", "cell_y", "cell_z"].map(|name| b.param(name, Type::I32));
    let seed = b.param("seed", Type::U32);
    let [sd, inverse, fade] = ["sd_z", "inverse_sd_z", "fade"].map(|name| b.param_f32(name));
    let shear = ["shear_x", "shear_y"].map(|name| b.param_f32(name));
    let given = ["s_xx", "s_xy", "s_yy", "determinant"].map(|name| b.param_f32(name));
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let low = b.sub(place, z);
    let slice = Slice::of(&mut b, low, [sd, inverse]);
    // x and y given the layer.
    let [x, y] = [(x, shear[0]), (y, shear[1])].map(|(mean, shear)| {
        let shift = b.mul(shear, slice.moved);
        b.add(mean, shift)
    });
    let [xx, xy, yy, determinant] = given;
    let [sx, sy] = shear.map(|shear| b.mul(shear, slice.within));
    let parts = [(sx, shear[0]), (sx, shear[1]), (sy, shear[1])];
    let [xx, xy, yy] = [(xx, parts[0]), (xy, parts[1]), (yy, parts[2])].map(|(own, (p, q))| {
        let spread = b.mul(p, q);
        b.add(own, spread)
    });
    // det (Σ + w ββᵀ) = det Σ + w βᵀ adj(Σ) β, here of the first Σ.
    let [own_xx, own_xy, own_yy, _] = given;
    let minus = b.neg(own_xy);
    let (left, right) = (
        b.dot(&[own_yy, minus], &shear),
        b.dot(&[minus, own_xx], &shear),
    );
    let more = b.dot(&[sx, sy], &[left, right]);
    let zero = b.f32(0.0);
    let more = b.max(more, zero);
    let determinant = b.add(determinant, more);
    let whole = b.trunc_i(place);
    let number = b.add_i(cells[2], whole);
    let seed = layer_seed(&mut b, number, seed, period);
    let covariance = [xx, xy, yy, determinant];
    let from = [centre, cells[0], cells[1], seed, fade];
    let plane = Plane::of(&mut b, &row, [x, y], covariance, from);
    let shifted = b.dot(&shear, &plane.slopes);
    let parts = [
        slice.weight,
        b.mul(slice.weight, plane.first),
        b.mul(slice.weight, plane.second),
        b.mul(slice.weight, plane.slopes[0]),
        b.mul(slice.weight, plane.slopes[1]),
        slice.slope(&mut b, inverse, plane.first, shifted),
    ];
    for ((name, sum), part) in names.into_iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

fn build(module: &mut Module, mode: Mode, seed: i32, period: i32) -> FunctionRef {
    let layer = mode.filters().then(|| layer(module, period));
    let mut b = Builder::new("cells_in_space", "Filtered random cells in space.");
    let mut cells = Vec::new();
    let mut place = Vec::new();
    for axis in ["x", "y", "z"] {
        cells.push(b.param(format!("cell_{axis}"), Type::I32));
        place.push(b.param_f32(axis));
    }
    let seed = lattice_seed(&mut b, seed, 0x510e_527f);
    let inner = [0, 1, 2].map(|i| {
        let whole = b.floor(place[i]);
        let whole = b.trunc_i(whole);
        b.add_i(cells[i], whole)
    });
    let own = layer_seed(&mut b, inner[2], seed, period);
    let (centre, _) = number(&mut b, inner[0], inner[1], own, period);
    let Some(layer) = layer else {
        b.result("mean", centre);
        return b.finish(module);
    };
    let spread = Spread::declare(&mut b);
    let [xx, xy, xz, yy, yz, zz] = spread.covariance;
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let raised = b.offset(zz, NARROWEST);
    let sd = b.sqrt(raised);
    let inverse = b.div(one, sd);
    let square = b.square(inverse);
    let shear = [xz, yz].map(|s| b.mul(s, square));
    // The covariance given z, from the minors of Σ, for Σ₃₃ as it is raised.
    let minors = spread.adjugate;
    let minus = b.neg(minors[1]);
    let given = [
        (minors[3], xx),
        (minus, xy),
        (minors[0], yy),
        (spread.determinant, minors[5]),
    ]
    .map(|(minor, own)| {
        let own = b.scale(own, NARROWEST);
        let sum = b.add(minor, own);
        b.mul(sum, square)
    });
    let wide = b.max(xx, yy);
    let wide = b.max(wide, raised);
    let wide = b.sqrt(wide);
    let fade = fading(&mut b, wide);
    let [start, layers] = window(&mut b, place[2], sd);
    let count = counted(&mut b, layers, fade);
    let mut captures = vec![start, place[0], place[1], place[2], centre];
    captures.extend(&cells);
    captures.extend([seed, sd, inverse, fade]);
    captures.extend(shear);
    captures.extend(given);
    let sums = b.fold(&layer, count, &[zero; 6], &captures);
    let tiny = b.f32(1e-6);
    let total = b.max(sums[0], tiny);
    let scale = b.div(one, total);
    let [first, second, dx, dy, dz] = [1, 2, 3, 4, 5].map(|i| b.mul(sums[i], scale));
    let slopes = [dx, dy, dz];
    let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| b.dot(&row, &slopes));
    // The two axes of a footprint on a surface.
    let size = spread.size(&mut b);
    let major = b.square(size);
    let guarded = b.offset(major, NARROWEST);
    let minor = b.add(minors[0], minors[3]);
    let minor = b.add(minor, minors[5]);
    let minor = b.max(minor, zero);
    let minor = b.div(minor, guarded);
    let shares = [major, minor].map(|v| coincidence(&mut b, v));
    let filtered = Filtered {
        centre,
        first,
        second,
        slopes: &slopes,
        linear: b.dot(&slopes, &rows),
        fade,
        same: b.mul(shares[0], shares[1]),
    };
    filtered.results(&mut b, mode);
    b.finish(module)
}

/// No footprint is narrower, in squared cells.
const NARROWEST: f32 = 1e-12;
