//! Dense numerical truth: the point function in f64 on a Gaussian-weighted grid.

use crate::footprint::footprint;
use mipless::{Footprint, Method, Options, PixelFilter, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use rayon::prelude::*;

/// A mean and a variance.
pub(crate) type Moments = [f64; 2];

/// How far the grid reaches, in standard deviations.
const REACH: f64 = 4.8;

/// A texture compiled for a method in f64, with one output, in units of the pixel filter's standard
/// deviation.
pub(crate) fn evaluator(texture: &Texture, method: Method) -> Evaluator<f64> {
    let program = texture.compile(&Options {
        method,
        filter: PixelFilter::Gaussian(1.0),
        moments: true,
        ..Options::default()
    });
    Evaluator::of_program(&program)
}

/// Mean and variance of the first output for every footprint.
pub(crate) fn moments(evaluator: &Evaluator<f64>, footprints: &[Footprint]) -> Vec<Moments> {
    (footprints.par_chunks(64))
        .flat_map_iter(|part| {
            let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
            evaluator.evaluate_footprints(&mut scratch, part, &[], &mut outputs);
            let variances = outputs.len() / 2;
            (0..part.len())
                .map(|i| [outputs[0][i], outputs[variances][i]])
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Points that are evaluated at once.
const BATCH: usize = 2048;

/// Mean and variance over a Gaussian footprint at every place. `finest` is the shortest period in
/// the point function: for steps of 1/step = 2/finest + 0.9/σ the rule is exact to 1e-6 for whatever
/// has no higher frequencies (its error is exp(−2π²σ²(1/step − 2/finest)²)).
pub(crate) fn truth(
    point: &Evaluator<f64>,
    places: &[[f64; 2]],
    axes: [[f64; 2]; 2],
    finest: f64,
) -> Vec<Moments> {
    let nodes = axes.map(|axis| {
        let length = axis[0].hypot(axis[1]);
        let step = 1.0 / (2.0 * length / finest + 0.9);
        let half = (REACH / step).ceil() as i32;
        (-half..=half)
            .map(|i| {
                let z = f64::from(i) * step;
                (z, (-0.5 * z * z).exp())
            })
            .collect::<Vec<_>>()
    });
    let grid: Vec<([f64; 2], f64)> = (nodes[0].iter())
        .flat_map(|&(z, w)| nodes[1].iter().map(move |&(y, v)| ([z, y], w * v)))
        .collect();
    let over = |place: &[f64; 2]| {
        let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
        let (mut total, mut mean, mut square) = (0.0, 0.0, 0.0);
        for part in grid.chunks(BATCH) {
            let footprints: Vec<Footprint> = (part.iter())
                .map(|&([z, y], _)| {
                    let at = [0, 1].map(|k| place[k] + axes[0][k] * z + axes[1][k] * y);
                    footprint(at, [[0.0; 2]; 2])
                })
                .collect();
            point.evaluate_footprints(&mut scratch, &footprints, &[], &mut outputs);
            // Weighted sums of deviations by West 1979: no difference of second moments.
            for (&x, &(_, weight)) in outputs[0].iter().zip(part) {
                total += weight;
                let deviation = x - mean;
                mean += deviation * weight / total;
                square += weight * deviation * (x - mean);
            }
        }
        // Of a constant, rounding may leave less than nothing.
        [mean, (square / total).max(0.0)]
    };
    places.par_iter().map(over).collect()
}
