//! What is right on a few footprints, and how far values are from it.

use super::super::bands::Bands;
use super::super::place::scattered;
use super::super::sampled::{POINTS, Sampling};
use super::super::{Facts, Method, NodeDef, Options, program};
use crate::cpu::{Evaluator, Footprint, Scratch};
use crate::ir::Program;
use mipless_graph::Graph;

/// Places of each size of footprint: the round ones, and the long ones askew.
const ROUND: usize = 24;
const LONG: usize = 8;
const PLACES: usize = ROUND + LONG;
/// The least width of a window, in pixels.
const WINDOW: f64 = 32.0;
/// How much longer the long ones are than wide.
const RATIO: f32 = 8.0;
/// Cosines and sines of their directions, the same numbers everywhere.
pub(super) const ASKEW: [[f32; 2]; 4] = [[0.8, 0.6], [-0.6, 0.8], [0.96, -0.28], [0.352, 0.936]];
/// Points of the truth of a pixel: at first, and where that shows an error.
pub(super) const GLANCE: u32 = 128;
pub(super) const LOOK: u32 = 1024;

/// The footprints at which a graph is audited, band after band: most of them in the unit square or,
/// where pixels are large, in a window of so many of them; every fourth within a distance.
pub(super) fn footprints(bands: Bands, distance: f64) -> Vec<Footprint> {
    let mut footprints = Vec::new();
    for band in 0..Bands::COUNT {
        let size = bands.size(band);
        for place in 0..PLACES {
            let at = scattered(band * PLACES + place + 1);
            let extent = match place % 4 {
                3 => distance.max(WINDOW * f64::from(size)),
                _ => 0.5 * (WINDOW * f64::from(size)).max(1.0),
            };
            let at = at.map(|x| 0.5 + extent * (2.0 * x - 1.0));
            let (long, [cos, sin]) = match place {
                0..ROUND => (1.0, [1.0, 0.0]),
                _ => (RATIO, ASKEW[place % ASKEW.len()]),
            };
            footprints.push(Footprint {
                du: [long * size * cos, long * size * sin],
                dv: [-size * sin, size * cos],
                ..Footprint::point(at)
            });
        }
    }
    footprints
}

/// The defaults of a program's parameters.
fn parameters(program: &Program) -> Vec<f32> {
    (program.interface.parameters.iter())
        .flat_map(|parameter| parameter.default.iter().copied())
        .collect()
}

/// The values of a program's results at footprints.
pub(super) fn values(program: &Program, footprints: &[Footprint]) -> Vec<Vec<f32>> {
    let mut values = Vec::new();
    Evaluator::<f32>::of_program(program).evaluate_footprints(
        &mut Scratch::new(),
        footprints,
        &parameters(program),
        &mut values,
    );
    values
}

/// What is right at footprints, for the components of all outputs.
pub(super) struct Truth {
    mean: Vec<Vec<f32>>,
    /// The variance of points within a footprint.
    variance: Vec<Vec<f32>>,
    pub(super) point: Vec<Vec<f32>>,
    /// Of each output, the first component and the one after the last.
    outputs: Vec<[usize; 2]>,
    /// How many points there are in a pixel.
    samples: u32,
    bands: Bands,
}

/// Of each output, its errors by band.
pub(super) type Errors = Vec<[f64; Bands::COUNT]>;

impl Truth {
    pub(super) fn of(
        samples: u32,
        (bands, footprints): (Bands, &[Footprint]),
        graph: &Graph,
        catalogue: &[NodeDef],
        options: &Options,
        facts: &Facts,
    ) -> Self {
        let with = |method, moments| {
            let options = Options {
                method,
                moments,
                ..*options
            };
            values(&program(graph, catalogue, &options, facts), footprints)
        };
        let mut mean = with(Method::Supersample(samples), true);
        let variance = mean.split_off(mean.len() / 2);
        let mut end = 0;
        let outputs = (graph.outputs.iter())
            .map(|output| {
                let start = end;
                end += output.ty.components();
                [start, end]
            })
            .collect();
        Self {
            mean,
            variance,
            point: with(Method::Point, false),
            outputs,
            samples,
            bands,
        }
    }

    /// How far values are from the truth.
    pub(super) fn errors(&self, values: &[Vec<f32>]) -> Errors {
        self.over_bands(|component, pixel| {
            let [found, right] =
                [&values[component], &self.mean[component]].map(|all| displayed(all[pixel]));
            (found - right).powi(2)
        })
    }

    /// The errors that the truth itself has, at most.
    pub(super) fn floor(&self) -> Errors {
        self.over_bands(|component, pixel| {
            f64::from(self.variance[component][pixel]).max(0.0) / f64::from(self.samples)
        })
    }

    /// The roots of the means of squares over the components of an output and the pixels of a band.
    fn over_bands(&self, square: impl Fn(usize, usize) -> f64) -> Errors {
        let band = |[start, end]: [usize; 2], band: usize| {
            let pixels = band * PLACES..(band + 1) * PLACES;
            let all = (start..end).flat_map(|component| {
                let square = &square;
                pixels.clone().map(move |pixel| square(component, pixel))
            });
            (all.sum::<f64>() / ((end - start).max(1) * PLACES) as f64).sqrt()
        };
        (self.outputs.iter())
            .map(|&output| std::array::from_fn(|i| band(output, i)))
            .collect()
    }

    /// How an output is best sampled: see [`super::sampled`].
    pub(super) fn sampling(&self, output: usize, is_steady: bool) -> Sampling {
        let [start, end] = self.outputs[output];
        // The largest footprints hold most of the texture.
        let mean = |all: &[f32]| {
            let largest = &all[(Bands::COUNT - 2) * PLACES..];
            largest.iter().map(|&x| f64::from(x)).sum::<f64>() / largest.len() as f64
        };
        let far: Vec<f64> = (start..end).map(|i| mean(&self.mean[i])).collect();
        let kept = std::array::from_fn(|band| {
            let pixels = band * PLACES..(band + 1) * PLACES;
            let (mut between, mut within) = (0.0, 0.0);
            for (component, far) in (start..end).zip(&far) {
                for pixel in pixels.clone() {
                    let variance = f64::from(self.variance[component][pixel]).max(0.0);
                    within += variance / POINTS as f64;
                    between += (f64::from(self.mean[component][pixel]) - far).powi(2)
                        - variance / f64::from(self.samples);
                }
            }
            // In steps, so that the last digits of a platform's functions do not show.
            let kept = between.max(0.0) / (between.max(0.0) + within).max(1e-30);
            // The finest band holds all that is finer, of which a point is right.
            if is_steady && band > 0 && within > 0.0 && kept.is_finite() {
                (64.0 * kept).round() as f32 / 64.0
            } else {
                1.0
            }
        });
        Sampling {
            far: far
                .into_iter()
                .map(|x| (1024.0 * x).round() as f32 / 1024.0)
                .collect(),
            kept,
            within: Bands::ALL,
            bands: self.bands,
        }
    }
}

/// A number as a display shows it, to both sides of 0: normals and heights are numbers too.
pub(super) fn displayed(x: f32) -> f64 {
    let size = f64::from(x.abs().min(1.0));
    let encoded = if size <= 0.003_130_8 {
        12.92 * size
    } else {
        1.055 * size.powf(1.0 / 2.4) - 0.055
    };
    if x.is_finite() {
        encoded.copysign(f64::from(x))
    } else {
        2.0
    }
}
