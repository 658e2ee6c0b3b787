//! Dense numerical truth: the point function in f64 on a Gaussian-weighted grid.

use crate::footprint::footprint;
use mipless::{Footprint, Method, Options, PixelFilter, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use rayon::prelude::*;

/// A mean and a variance.
pub(crate) type Moments = [f64; 2];

/// How far the grid reaches, in standard deviations.
const REACH: f64 = 5.0;

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

/// Mean and variance over a Gaussian footprint at every place. `finest` is the shortest distance
/// over which the point function changes: a step of the grid is at most a third of it, or 0.55
/// standard deviations. For a function without frequencies above 1/finest the rule is exact to
/// about 1e-5 (its error falls with exp(−2π²σ²/step²)).
pub(crate) fn truth(
    point: &Evaluator<f64>,
    places: &[[f64; 2]],
    axes: [[f64; 2]; 2],
    finest: f64,
) -> Vec<Moments> {
    let nodes = axes.map(|axis| {
        let length = axis[0].hypot(axis[1]);
        let step = (finest / 3.0 / length).min(0.55);
        let half = (REACH / step).ceil() as i32;
        (-half..=half)
            .map(|i| {
                let z = f64::from(i) * step;
                (z, (-0.5 * z * z).exp())
            })
            .collect::<Vec<_>>()
    });
    let over = |place: &[f64; 2]| {
        let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
        let (mut total, mut mean, mut square) = (0.0, 0.0, 0.0);
        for &(z, w) in &nodes[0] {
            let row: Vec<Footprint> = (nodes[1].iter())
                .map(|&(y, _)| {
                    let at = [0, 1].map(|k| place[k] + axes[0][k] * z + axes[1][k] * y);
                    footprint(at, [[0.0; 2]; 2])
                })
                .collect();
            point.evaluate_footprints(&mut scratch, &row, &[], &mut outputs);
            // Weighted sums of deviations by West 1979: no difference of second moments.
            for (&x, &(_, v)) in outputs[0].iter().zip(&nodes[1]) {
                let weight = w * v;
                total += weight;
                let deviation = x - mean;
                mean += deviation * weight / total;
                square += weight * deviation * (x - mean);
            }
        }
        [mean, square / total]
    };
    places.par_iter().map(over).collect()
}
