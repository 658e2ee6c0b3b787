//! What the diagonals of cells leave open, where every other row of cells is shifted by half a cell.
//!
//! Lines of width t leave of a cell four triangles, one at each side, whose height is h = ½ − t/√2. Those
//! at the left and right sides meet those of the next cells, and are diamonds |x| + |y| < h around the
//! middles of these sides. Those above and below lie along the border of the row.
//!
//! Their series is that of the lattice of diamonds with sites (0, 0) and (½, 1). For odd k the integral
//! over one row is that of a diamond and of a triangle at either border, as the rows differ by a factor
//! e^{−πi(k + 2l)} = 1; for even k both rows are alike, and what is left of the series is that of rows
//! that are not shifted, a product of pulses of x − y and x + y.

use super::lattice::Lattice;
use super::rows::{Figure, Shape};
use super::series::{Harmonics, of_size};
use super::{Tiling, highest};
use crate::pattern::region::Outline;
use mipless_codegen::ir::{Bool, Float};
use std::f64::consts::{PI, SQRT_2};

/// The least standard deviation of the minor axis for which there are enough harmonics, in cells: half of
/// that of tiles, as these lines run on across cells, and a long footprint may lie along them.
const THINNEST: f32 = 0.08;

/// The open share of the plane is so much of h².
const SHARE: f64 = 4.0;

/// Lines of a width that is given in cells, at least 0. The origin is in the middle of a row, at the side
/// of a cell.
pub(crate) fn lines(thickness: Float<'_>) -> Tiling<'_> {
    let size = (0.5 - thickness * std::f32::consts::FRAC_1_SQRT_2).max(0.0);
    let known = size.as_constant();
    let diamond = outline(&[[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]);
    // Around the middle of the circle that touches the sides, which is as far from the border.
    let inner = SQRT_2 - 1.0;
    let below = outline(&[[-1.0, inner], [0.0, inner - 1.0], [1.0, inner]]);
    let above = outline(&[[1.0, -inner], [0.0, 1.0 - inner], [-1.0, -inner]]);
    let lattice = Lattice::Staggered;
    Tiling {
        key: "hatch".to_owned(),
        lattice,
        size,
        figures: vec![
            figure(diamond, [0.0, 0.0], 0.0),
            figure(below, [0.5, 0.5], -inner),
            figure(above, [0.5, -0.5], inner),
        ],
        extent: 0.5,
        harmonics: harmonics(lattice, known),
        thinnest: THINNEST,
        inside: Box::new(move |place| is_open(place, size)),
        holes: true,
    }
}

fn outline(corners: &[[f64; 2]]) -> Outline {
    let vertices = corners.iter().map(|&[x, y]| [x as f32, y as f32, 0.0]);
    Outline {
        vertices: vertices.collect(),
    }
}

fn figure(outline: Outline, at: [f64; 2], rise: f64) -> Figure {
    let [_, reach] = outline.distances();
    Figure {
        shape: Shape::Polygon(outline),
        reach: f64::from(reach),
        at,
        rise,
    }
}

/// Of figures of a size that may be known. Those of even k are 4 S(p) S(q) where l is even, and 0 where
/// it is odd. Those of odd k are ∫ = 2 S(p) S(q) of the diamond and
/// −(2 sin πl/πk) ∫₀ʰ sin 2πlt sin 2πk(h − t) dt = −(sin πl/πk)(C(q) S(p) − C(p) S(q)) of the triangles.
/// All are doubled, since half of the frequencies are listed.
fn harmonics(lattice: Lattice, known: Option<f32>) -> Harmonics {
    let rows = lattice.frequencies(highest(THINNEST)).into_iter();
    let rows = rows.filter_map(|[k, l]| {
        if k % 2.0 == 0.0 {
            (l % 2.0 == 0.0).then_some([k, l, 8.0, 0.0])
        } else {
            Some([k, l, 4.0, -2.0 * (PI * l).sin() / (PI * k)])
        }
    });
    match known {
        None => Harmonics::of_size(SHARE, rows.collect()),
        Some(size) => {
            let size = f64::from(size);
            let rows = rows.map(|row| [row[0], row[1], of_size(row, size)]);
            Harmonics::known(SHARE, rows.collect())
        }
    }
}

/// Whether a place lies in the open. With x and y from the middle of its cell, it is ||x| − |y||/√2 away
/// from a diagonal.
fn is_open<'b>([x, y]: [Float<'b>; 2], size: Float<'b>) -> Bool<'b> {
    let row = (y + 0.5).floor();
    let up = y - row;
    let turns = row * 0.5;
    let from = x - (turns - turns.floor());
    let across = from - from.floor() - 0.5;
    (across.abs() - up.abs()).abs().gt(0.5 - size)
}
