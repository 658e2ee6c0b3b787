//! Distances to random points, one in every cell of a lattice, and their averages by seven taps.
//!
//! Nothing here has a closed form. Taps at the nodes of the seven-point rule of degree 5 (the centre,
//! and a hexagon of twice the footprint) share one search: the points near them are drawn once. Small
//! footprints are integrated; larger ones alias, so their average is drawn towards the mean of the
//! noise by the regression of the true average on it, whose slope was measured by size (`shape`).

mod shape;
mod taps;

pub(crate) use shape::{Output, Worley};

use super::cell::{lattice_seed, split};
use super::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};
use taps::{NODES, row, window};

/// Windows of cells around one place: every point within 1.5 cells is found.
const CELLS: f32 = 4.0;

/// The largest standard deviation of a footprint along an axis, in cells, and where it begins to
/// fade.
const WIDEST: [f32; 2] = [1.2, 1.5];

/// The filtered noise at a position in cells.
pub(crate) fn filtered(lower: &mut Lower<'_>, position: &[Signal], worley: Worley) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let size = lower.b().sqrt(spread.eigenvalues[0]);
    lower.source_footprint(size);
    let key = format!("worley {mode:?} {worley:?}");
    let function = lower.function(&key, |module| build(module, mode, worley));
    let b = lower.b();
    let mut arguments = Vec::new();
    for axis in position {
        arguments.extend(split(b, axis));
    }
    if mode.filters() {
        arguments.extend(spread.covariance);
        arguments.extend(spread.eigenvalues);
    }
    let results = b.call(&function, &arguments);
    let zero = b.f32(0.0);
    let at = |i: usize| results.get(i).copied().unwrap_or(zero);
    Field {
        mean: at(0),
        gradient: [at(1), at(2)],
        hessian: [zero; 3],
        rest: at(3),
    }
}

/// The values at places around (x, y), `reach` = how far they are spread along each axis.
fn search(
    b: &mut Builder,
    row: &FunctionRef,
    worley: Worley,
    places: &[[Value; 2]],
    centre: [Value; 4],
    reach: [Value; 2],
    any: Value,
) -> Vec<Value> {
    let [cell_x, x, cell_y, y] = centre;
    let seed = lattice_seed(b, worley.seed, 0xa54f_f53a);
    let counts = reach.map(|reach| {
        let minus = b.scale(reach, -2.0);
        let floor = b.floor(minus);
        let more = b.neg(floor);
        b.offset(more, CELLS)
    });
    let start_x = window(b, x, counts[0]);
    let start_y = window(b, y, counts[1]);
    let [columns, rows] = counts.map(|count| {
        let whole = b.trunc_i(count);
        b.cast_u(whole)
    });
    let none = b.u32(0);
    let rows = b.select(any, rows, none);
    let mut captures = vec![start_y, start_x, columns, cell_x, cell_y, seed];
    captures.extend(places.iter().flatten());
    let init: Vec<Value> = (places.iter())
        .flat_map(|_| taps::init(b, worley))
        .collect();
    let state = b.fold(row, rows, &init, &captures);
    (state.chunks(init.len() / places.len()))
        .map(|tap| taps::value(b, worley, tap))
        .collect()
}

fn build(module: &mut Module, mode: Mode, worley: Worley) -> FunctionRef {
    let count = if mode.filters() { NODES.len() } else { 1 };
    let row = row(module, worley, count);
    let mut b = Builder::new("worley", "Distances to random points over a footprint.");
    let cell_x = b.param("cell_x", Type::I32);
    let x = b.param_f32("x");
    let cell_y = b.param("cell_y", Type::I32);
    let y = b.param_f32("y");
    let centre = [cell_x, x, cell_y, y];
    let (zero, one, always) = (b.f32(0.0), b.f32(1.0), b.bool(true));
    if !mode.filters() {
        let found = search(&mut b, &row, worley, &[[x, y]], centre, [zero; 2], always);
        b.result("mean", found[0]);
        return b.finish(module);
    }
    let [s_xx, s_xy, s_yy] = ["s_xx", "s_xy", "s_yy"].map(|name| b.param_f32(name));
    let eigenvalues = [b.param_f32("s_major"), b.param_f32("s_minor")];
    let axes = eigenvalues.map(|v| b.sqrt(v));

    // LLᵀ = Σ; a minor axis below 1/50 of the major one is taken for that, so that slopes are.
    let floor = b.scale(axes[0], 0.02);
    let square = b.square(floor);
    let wide = b.max(s_xx, square);
    let l11 = b.sqrt(wide);
    let tiny = b.f32(1e-12);
    let guarded = b.max(l11, tiny);
    let l21 = b.div(s_xy, guarded);
    let square = b.square(l21);
    let left = b.sub(s_yy, square);
    let left = b.max(left, zero);
    let l22 = b.sqrt(left);
    let l22 = b.max(l22, floor);

    // How much of the taps' average stands.
    let sum = b.add(axes[0], axes[1]);
    let size = b.scale(sum, 0.5);
    let (slope, trust) = worley.slopes(&mut b, size);
    let reach = [s_xx, s_yy].map(|v| b.sqrt(v));
    let farthest = b.max(reach[0], reach[1]);
    let fade = b.offset(farthest, -WIDEST[1]);
    let fade = b.scale(fade, -1.0 / (WIDEST[1] - WIDEST[0]));
    let fade = b.clamp(fade, 0.0, 1.0);
    let (slope, trust) = (b.mul(slope, fade), b.mul(trust, fade));
    let any = b.lt(zero, fade);

    let limit = b.f32(WIDEST[1]);
    let places: Vec<[Value; 2]> = (NODES.iter())
        .map(|[p, q, _]| {
            let dx = b.scale(l11, *p);
            let (first, second) = (b.scale(l21, *p), b.scale(l22, *q));
            let dy = b.add(first, second);
            [b.add(x, dx), b.add(y, dy)]
        })
        .collect();
    // The hexagon reaches twice a standard deviation.
    let reach = [l11, reach[1]].map(|reach| {
        let reach = b.max(reach, floor);
        let reach = b.min(reach, limit);
        b.add(reach, reach)
    });
    let found = search(&mut b, &row, worley, &places, centre, reach, any);

    // Deviations from the centre keep their digits.
    let [mut m1, mut m2, mut c1, mut c2] = [zero; 4];
    for (&value, [p, q, weight]) in found.iter().zip(NODES) {
        let d = b.sub(value, found[0]);
        let part = b.scale(d, weight);
        m1 = b.add(m1, part);
        let square = b.mul(part, d);
        m2 = b.add(m2, square);
        let (along, across) = (b.scale(part, p), b.scale(part, q));
        c1 = b.add(c1, along);
        c2 = b.add(c2, across);
    }
    let [centre_mean, variance] = worley.moments().map(|m| b.f32(m));
    let off = b.sub(found[0], centre_mean);
    let off = b.add(off, m1);
    let off = b.mul(off, slope);
    let mean = b.add(centre_mean, off);
    b.result("mean", mean);
    // Lᵀ∇ = c.
    let guarded = b.max(l22, tiny);
    let dy = b.div(c2, guarded);
    let lean = b.mul(l21, dy);
    let dx = b.sub(c1, lean);
    let guarded = b.max(l11, tiny);
    let dx = b.div(dx, guarded);
    let carries = matches!(mode, Mode::Local | Mode::Quad);
    let slopes = [dx, dy].map(|d| if carries { b.mul(d, slope) } else { zero });
    b.result("dx", slopes[0]);
    b.result("dy", slopes[1]);
    if mode.spreads() {
        let lost = worley.lost(&mut b, size);
        let expected = b.mul(lost, variance);
        let rest = if carries {
            let square = b.square(m1);
            let taps = b.sub(m2, square);
            let kept = b.sub(one, trust);
            let (own, other) = (b.mul(taps, trust), b.mul(expected, kept));
            let local = b.add(own, other);
            let left = b.dot(&[s_xx, s_xy], &slopes);
            let right = b.dot(&[s_xy, s_yy], &slopes);
            let linear = b.dot(&slopes, &[left, right]);
            let rest = b.sub(local, linear);
            b.max(rest, zero)
        } else {
            expected
        };
        b.result("rest", rest);
    }
    b.finish(module)
}
