//! The noise over any footprint: the window's fit is a polynomial times a Gaussian, and so is its
//! product with the footprint.
//!
//! With T = b²I + Σ and M = b²T⁻¹, the product is a Gaussian of mean μ = Md and covariance
//! C = ΣM, times b²/√det T e^{−d·μ/2b²}; the kernel's mean is the expectation of its polynomial G
//! over that Gaussian. In sums over kernels, with E = e^{−d·μ/2b²}, derivatives are those of d
//! alone, and M is applied once at the end:
//! ∇ = M Σ E(∇G − dG/b²), Hess = M [Σ E(∇²G − (d∇Gᵀ + ∇G dᵀ)/b² + (ddᵀ − T)G/b⁴)] M.

use super::grid::Grid;
use super::profile::{DERIVATIVES, WIDTH, fitted, joint};
use super::{Kind, NAMES};
use crate::noise::hash::corner;
use crate::noise::lattice::parts;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::Mode;

/// What every kernel of an octave needs of the footprint.
pub(super) const CAPTURES: [&str; 13] = [
    "m_xx", "m_xy", "m_yy", "c_xx", "c_yy", "c_1", "c_2", "c_3", "c_4", "c_5", "t_xx", "t_xy",
    "t_yy",
];

/// The captures for Σ and det Σ, with 1/det T.
pub(super) fn captures(
    b: &mut Builder,
    [s_xx, s_xy, s_yy]: [Value; 3],
    determinant: Value,
) -> (Vec<Value>, Value) {
    const AREA: f32 = WIDTH * WIDTH;
    let (t_xx, t_yy) = (b.offset(s_xx, AREA), b.offset(s_yy, AREA));
    // det T = b⁴ + b² tr Σ + det Σ, all positive.
    let trace = b.add(s_xx, s_yy);
    let trace = b.scale(trace, AREA);
    let whole = b.add(trace, determinant);
    let whole = b.offset(whole, AREA * AREA);
    let one = b.f32(1.0);
    let inverse = b.div(one, whole);
    let scaled = b.scale(inverse, AREA);
    let m_xx = b.mul(t_yy, scaled);
    let m_yy = b.mul(t_xx, scaled);
    let m_xy = b.mul(s_xy, scaled);
    // C = b²(b²Σ + det Σ I)/det T.
    let [c_xx, c_yy] = [s_xx, s_yy].map(|s| {
        let s = b.scale(s, AREA);
        let s = b.add(s, determinant);
        b.mul(s, scaled)
    });
    let c_xy = b.scale(m_xy, AREA);
    let m_xy = b.neg(m_xy);
    let mut all = vec![m_xx, m_xy, m_yy, c_xx, c_yy, c_xy];
    let mut power = c_xy;
    for k in 2..=5 {
        let next = b.mul(power, c_xy);
        power = b.scale(next, 1.0 / k as f32);
        all.push(power);
    }
    all.extend([t_xx, s_xy, t_yy]);
    (all, inverse)
}

fn sums(b: &mut Builder, mode: Mode) -> Vec<Value> {
    NAMES[..parts(mode)]
        .iter()
        .map(|name| b.param_f32(format!("sum_{name}")))
        .collect()
}

/// The filtered kernel of one lattice point, the body of a fold over columns.
fn kernel(module: &mut Module, kind: Kind, mode: Mode, tiles: bool) -> FunctionRef {
    let doc = "The filtered kernel of one lattice point.";
    let mut b = Builder::new(format!("{}_kernel", kind.name()), doc);
    let index = b.param("index", Type::U32);
    let sums = sums(&mut b, mode);
    let start = b.param_f32("start_x");
    let (x, dy) = (b.param_f32("x"), b.param_f32("dy"));
    let row = b.param("row_word", Type::U32);
    let grid = Grid::declare(&mut b, tiles);
    let footprint = CAPTURES.map(|name| b.param_f32(name));
    let [m_xx, m_xy, m_yy, c_xx, c_yy, ..] = footprint;
    let (powers, t) = (&footprint[5..10], &footprint[10..]);
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let dx = b.sub(x, place);
    let column = grid.word(&mut b, 0, place);
    let hash = corner(&mut b, column, row);
    let d = [dx, dy];
    let means = [b.dot(&[m_xx, m_xy], &d), b.dot(&[m_xy, m_yy], &d)];
    let distance = b.dot(&d, &means);
    let exponent = b.scale(distance, -0.5 / (WIDTH * WIDTH));
    let least = b.f32(-80.0);
    let exponent = b.max(exponent, least);
    let envelope = b.exp(exponent);
    let profiles = [
        fitted(&mut b, means[0], c_xx),
        fitted(&mut b, means[1], c_yy),
    ];
    // G and its derivatives by μ.
    let weights = kind.weights(&mut b, hash);
    let mut g = Vec::new();
    for along in &DERIVATIVES[..sums.len()] {
        let mut sum = b.f32(0.0);
        for (&weight, &[i, j]) in weights.iter().zip(kind.terms()) {
            let part = joint(&mut b, [&profiles[0][i], &profiles[1][j]], *along, powers);
            let part = b.mul(weight, part);
            sum = b.add(sum, part);
        }
        g.push(sum);
    }
    let mut parts = vec![g[0]];
    let lean = b.scale(g[0], -1.0 / (WIDTH * WIDTH));
    if sums.len() > 1 {
        for i in 0..2 {
            let drop = b.mul(d[i], lean);
            parts.push(b.add(g[1 + i], drop));
        }
    }
    if sums.len() > 3 {
        for (at, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let outer = b.dot(&[d[i], d[j]], &[g[1 + j], g[1 + i]]);
            let square = b.mul(d[i], d[j]);
            let square = b.sub(square, t[at]);
            let bent = b.mul(square, lean);
            let both = b.add(outer, bent);
            let both = b.scale(both, -1.0 / (WIDTH * WIDTH));
            parts.push(b.add(g[3 + at], both));
        }
    }
    for ((name, sum), part) in NAMES.into_iter().zip(sums).zip(parts) {
        let part = b.mul(envelope, part);
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

/// The lattice coordinate that a window of `count` (a real) points around `x` starts at.
pub(super) fn start_of(b: &mut Builder, x: Value, count: Value) -> Value {
    let half = b.scale(count, -0.5);
    let start = b.add(x, half);
    let start = b.floor(start);
    b.offset(start, 1.0)
}

/// One lattice row of filtered kernels, the body of a fold over rows.
pub(super) fn row(module: &mut Module, kind: Kind, mode: Mode, tiles: bool) -> FunctionRef {
    let kernel = kernel(module, kind, mode, tiles);
    let doc = "The filtered kernels of one lattice row.";
    let mut b = Builder::new(format!("{}_row", kind.name()), doc);
    let index = b.param("index", Type::U32);
    let sums = sums(&mut b, mode);
    let start = b.param_f32("start_y");
    let (columns, count) = (b.param_f32("columns"), b.param("column_count", Type::U32));
    let shear = b.param_f32("shear");
    let grid = Grid::declare(&mut b, tiles);
    let (x, y) = (b.param_f32("x"), b.param_f32("y"));
    let footprint = CAPTURES.map(|name| b.param_f32(name));
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let dy = b.sub(y, place);
    let word = grid.word(&mut b, 1, place);
    // The row's largest envelope lies where d_x = (T₁₂/T₂₂) d_y.
    let lean = b.mul(shear, dy);
    let centre = b.sub(x, lean);
    let start = start_of(&mut b, centre, columns);
    let mut captures = vec![start, x, dy, word];
    captures.extend(grid.captures());
    captures.extend(footprint);
    let sums = b.fold(&kernel, count, &sums, &captures);
    for (name, sum) in NAMES.into_iter().zip(sums) {
        b.result(name, sum);
    }
    b.finish(module)
}
