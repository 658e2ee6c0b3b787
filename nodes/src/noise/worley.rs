//! Distances to random points, one in every cell of a lattice, and their averages by seven taps.
//!
//! Nothing here has a closed form. Taps at the nodes of the seven-point rule of degree 5 (the centre,
//! and a hexagon of twice the footprint) share one search: the points near them are drawn once. Small
//! footprints are integrated; larger ones alias, so their average is drawn towards the mean of the
//! noise by the regression of the true average on it, whose slope was measured by size (`shape`).
//!
//! What follows the numbers of regions is summed over the regions along lines through the footprint
//! instead (`lines`), and over their points where it holds many (`wide`).

mod lines;
mod shape;
pub(crate) mod space;
mod taps;
mod wide;

pub(crate) use shape::{Output, Worley};

use super::cell::lattice_seed;
use super::cell::place::{called, declared, declared_spread, field, window_start};
use super::components::Hash;
use super::field::Spread;
use super::jenkins;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Int, Module, Uint, Vec2};
use mipless_codegen::moments::{Mode, Signal};
use taps::{Kept, NODES, Nearest, Rows, row};

/// Windows of cells around one place: every point within 1.5 cells is found.
const CELLS: f32 = 4.0;

/// The largest standard deviation of a footprint along an axis, in cells, and where it begins to
/// fade.
const WIDEST: [f32; 2] = [1.2, 1.5];

/// The filtered noise at a position in cells, which lies in a range, for each component of the image
/// that is asked for.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    worley: Worley,
    range: [f32; 2],
) -> Vec<Signal<'b>> {
    let mode = lower.mode();
    let spread = Spread::of(position);
    let size = spread.eigenvalues[0].sqrt();
    lower.source_detail(size, worley.wavenumber());
    if !lower.image().0.is_identity() {
        return lines::filtered(lower, position, &spread, worley);
    }
    let key = format!("worley {mode:?} {worley:?}");
    let function = lower.function(&key, |module| build(module, mode, worley));
    let results = called(lower, &function, (position, &spread), ());
    let field = field(&results[..results.len().min(3)], results.get(3).copied());
    vec![field.at(lower, position).with_range(range)]
}

/// What is nearest to places around (x, y), `reach` = how far they are spread along each axis; nothing
/// unless the condition holds.
fn search<'b>(
    row: &FunctionRef,
    (worley, kept): (Worley, Kept),
    places: &[Vec2<'b>],
    ([cell_x, cell_y], [x, y]): ([Int<'b>; 2], [Float<'b>; 2]),
    reach: [Float<'b>; 2],
    any: Bool<'b>,
) -> Vec<Nearest<'b>> {
    let b = x.builder();
    // MaterialX looks into the nearest nine cells alone.
    let cells = match worley.hash {
        Hash::Mipless => CELLS,
        Hash::Materialx => 3.0,
    };
    let counts = reach.map(|reach| cells - (reach * -2.0).floor());
    let [columns, rows] = counts.map(|count| count.to_int().to_uint());
    let shared = Rows {
        start_y: window_start(y, counts[1]),
        start_x: window_start(x, counts[0]),
        columns,
        cell_x,
        cell_y,
        seed: seed(b, worley),
    };
    let before = vec![Nearest::none(b, kept); places.len()];
    b.fold(row, any.select(rows, 0u32), before, (shared, places))
}

/// What all cells share.
fn seed(b: &Builder, worley: Worley) -> Uint<'_> {
    match worley.hash {
        Hash::Mipless => lattice_seed(b, worley.seed, 0xa54f_f53a),
        Hash::Materialx => b.uint(jenkins::seed(worley.seed)),
    }
}

fn build(module: &mut Module, mode: Mode, worley: Worley) -> FunctionRef {
    let count = if mode.filters() { NODES.len() } else { 1 };
    let kept = Kept::of(worley);
    let row = row(module, worley, kept, count);
    let b = &Builder::new("worley", "Distances to random points over a footprint.");
    let centre = declared::<2>(b);
    let place = Vec2(centre.1);
    if !mode.filters() {
        let found = search(
            &row,
            (worley, kept),
            &[place],
            centre,
            [b.float(0.0); 2],
            b.literal(true),
        );
        b.result("mean", found[0].value(worley));
        return b.finish(module);
    }
    let Spread {
        covariance,
        eigenvalues,
    } = declared_spread(b);
    let [s_xx, s_xy, s_yy] = *covariance;
    let [major, minor] = eigenvalues.map(Float::sqrt);

    // LLᵀ = Σ; a minor axis below 1/50 of the major one is taken for that, so that slopes are.
    let floor = major * 0.02;
    let l11 = s_xx.max(floor.square()).sqrt();
    let l21 = s_xy / l11.max(1e-12);
    let l22 = (s_yy - l21.square()).max(0.0).sqrt().max(floor);

    // How much of the taps' average stands.
    let size = (major + minor) * 0.5;
    let extent = [s_xx, s_yy].map(Float::sqrt);
    let farthest = extent[0].max(extent[1]);
    let fade = (farthest + -WIDEST[1]) * (-1.0 / (WIDEST[1] - WIDEST[0]));
    let fade = fade.clamp(0.0, 1.0);
    let [slope, trust] = worley.slopes(size).map(|slope| slope * fade);

    // The hexagon reaches twice a standard deviation.
    let places: Vec<Vec2<'_>> = (NODES.iter())
        .map(|&[p, q, _]| place + Vec2([l11 * p, l21 * p + l22 * q]))
        .collect();
    let reach = [l11, extent[1]].map(|sd| {
        let sd = sd.max(floor).min(WIDEST[1]);
        sd + sd
    });
    let found = search(&row, (worley, kept), &places, centre, reach, fade.gt(0.0));
    let found: Vec<Float<'_>> = found.iter().map(|nearest| nearest.value(worley)).collect();

    // Deviations from the centre keep their digits.
    let [mut m1, mut m2, mut along, mut across] = [b.float(0.0); 4];
    for (&value, [p, q, weight]) in found.iter().zip(NODES) {
        let d = value - found[0];
        let part = d * weight;
        m1 += part;
        m2 += part * d;
        along += part * p;
        across += part * q;
    }
    let [centre_mean, variance] = worley.moments();
    b.result("mean", centre_mean + (found[0] - centre_mean + m1) * slope);
    // Lᵀ∇ = c.
    let dy = across / l22.max(1e-12);
    let dx = (along - l21 * dy) / l11.max(1e-12);
    let carries = matches!(mode, Mode::Local | Mode::Quad);
    let slopes = Vec2([dx, dy]).map(|d| if carries { d * slope } else { b.float(0.0) });
    b.result("dx", slopes[0]);
    b.result("dy", slopes[1]);
    if mode.spreads() {
        let expected = worley.lost(size) * variance;
        let rest = if carries {
            let taps = m2 - m1.square();
            let local = taps * trust + expected * (1.0 - trust);
            (local - slopes.dot(covariance.times(slopes))).max(0.0)
        } else {
            expected
        };
        b.result("rest", rest);
    }
    b.finish(module)
}
