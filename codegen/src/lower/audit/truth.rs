//! What is right on a few footprints, and how far values are from it.

use super::super::bands::Bands;
use super::super::drawn::{Drawn, Far};
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
/// The places of the two largest sizes.
pub(super) const LARGEST: usize = 2 * PLACES;
/// The least width of a window, in pixels.
const WINDOW: f64 = 32.0;
/// How much longer the long ones are than wide.
const RATIO: f32 = 8.0;
/// Cosines and sines of their directions, the same numbers everywhere.
pub(super) const ASKEW: [[f32; 2]; 4] = [[0.8, 0.6], [-0.6, 0.8], [0.96, -0.28], [0.352, 0.936]];
/// Points of the truth of a pixel: at first, and where that shows an error.
pub(super) const GLANCE: u32 = 128;
pub(super) const LOOK: u32 = 1024;
/// How far off a mean may be far away, as a display shows it.
pub(super) const BIASED: f64 = 0.004;
/// What of an error may be left where a signal is drawn to its mean, for that to count.
const BETTER: f64 = 0.7;

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

/// The values of a program's results at footprints, all inputs of the graph at their defaults.
pub(super) fn values(program: &Program, footprints: &[Footprint]) -> Vec<Vec<f32>> {
    values_with(program, footprints, &parameters(program))
}

/// The values of a program's results at footprints.
pub(super) fn values_with(
    program: &Program,
    footprints: &[Footprint],
    parameters: &[f32],
) -> Vec<Vec<f32>> {
    let mut values = Vec::new();
    Evaluator::<f32>::of_program(program).evaluate_footprints(
        &mut Scratch::new(),
        footprints,
        parameters,
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
    /// Of each output, the first component and the one after the last; none of what is no mean of points.
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
                let is_mean = graph.node(output.node).is_mean();
                [start, if is_mean { end } else { start }]
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

    /// The means of an output's components over the largest footprints, which hold most of the
    /// texture.
    fn far(&self, output: usize) -> Vec<f64> {
        let [start, end] = self.outputs[output];
        (start..end)
            .map(|component| mean_of_largest(&self.mean[component]))
            .collect()
    }

    /// How far the means of an output's components are off over the largest footprints, as a display
    /// shows them; the largest.
    pub(super) fn far_bias(&self, output: usize, found: &[Vec<f32>]) -> f64 {
        let [start, end] = self.outputs[output];
        let of = |component: usize| far_bias(&found[component], &self.mean[component]);
        (start..end).map(of).fold(0.0, f64::max)
    }

    /// The components of an output.
    pub(super) fn components(&self, output: usize) -> std::ops::Range<usize> {
        let [start, end] = self.outputs[output];
        start..end
    }

    /// The components of an output at the places of a band.
    fn places(&self, output: usize, band: usize) -> impl Iterator<Item = (usize, usize)> {
        let [start, end] = self.outputs[output];
        let pixels = band * PLACES..(band + 1) * PLACES;
        (start..end).flat_map(move |component| pixels.clone().map(move |pixel| (component, pixel)))
    }

    /// How an output is best sampled: see [`super::sampled`].
    pub(super) fn sampling(&self, output: usize, is_steady: bool) -> Sampling {
        let [start, _] = self.outputs[output];
        let far = self.far(output);
        let lost = std::array::from_fn(|band| {
            let (mut between, mut within) = (0.0, 0.0);
            for (component, pixel) in self.places(output, band) {
                let variance = f64::from(self.variance[component][pixel]).max(0.0);
                let mean = f64::from(self.mean[component][pixel]);
                within += variance / POINTS as f64;
                between +=
                    (mean - far[component - start]).powi(2) - variance / f64::from(self.samples);
            }
            let lost = within / (between.max(0.0) + within).max(1e-30);
            // The finest band holds all that is finer, of which a point is right.
            if is_steady && band > 0 && within > 0.0 {
                stepped(lost)
            } else {
                0.0
            }
        });
        Sampling {
            drawn: self.drawn_to(Far::Means(rounded(&far)), lost),
            within: Bands::ALL,
        }
    }

    /// How an output's values are best drawn to its means, in the bands where that counts; `None`
    /// where it counts in none.
    pub(super) fn drawn(
        &self,
        output: usize,
        found: &[Vec<f32>],
        is_steady: bool,
    ) -> Option<Drawn> {
        let [start, end] = self.outputs[output];
        let means = self.far(output);
        let far = if is_steady {
            Far::Means(rounded(&means))
        } else {
            let closed = (start..end).map(|component| mean_of_largest(&found[component]));
            let factors: Vec<f64> = (means.iter().zip(closed))
                .map(|(far, closed)| far / closed)
                .collect();
            let small = |factor: &f64| (0.5..2.0).contains(factor);
            if !factors.iter().all(small) {
                return None;
            }
            Far::Times(rounded(&factors))
        };
        let lost = std::array::from_fn(|band| {
            let triples: Vec<[f64; 3]> = (self.places(output, band))
                .map(|(component, pixel)| {
                    let found = found[component][pixel];
                    let far = far.of(component - start, found, |x| x);
                    [found, far, self.mean[component][pixel]].map(f64::from)
                })
                .collect();
            let (along, squares) = (triples.iter()).fold((0.0, 0.0), |(along, squares), t| {
                let [found, far, right] = t;
                let way = far - found;
                (along + way * (right - found), squares + way * way)
            });
            let lost = stepped((along / squares.max(1e-30)).clamp(0.0, 1.0));
            let error = |lost: f64| {
                let squares = triples.iter().map(|[found, far, right]| {
                    let drawn = found + lost * (far - found);
                    (displayed(drawn as f32) - displayed(*right as f32)).powi(2)
                });
                (squares.sum::<f64>() / triples.len().max(1) as f64).sqrt()
            };
            let before = error(0.0);
            // The finest band holds all that is finer.
            let counts = band > 0 && before > BIASED && error(f64::from(lost)) < BETTER * before;
            if counts { lost } else { 0.0 }
        });
        (lost != [0.0; Bands::COUNT]).then(|| self.drawn_to(far, lost))
    }

    fn drawn_to(&self, far: Far, lost: [f32; Bands::COUNT]) -> Drawn {
        Drawn {
            far,
            lost,
            bands: self.bands,
        }
    }
}

/// Numbers without the last digits of a platform's functions.
fn rounded(numbers: &[f64]) -> Vec<f32> {
    (numbers.iter())
        .map(|&x| (1024.0 * x).round() as f32 / 1024.0)
        .collect()
}

/// How far the mean over the largest footprints is off, as a display shows it.
pub(super) fn far_bias(found: &[f32], right: &[f32]) -> f64 {
    let [found, right] = [found, right].map(|values| displayed(mean_of_largest(values) as f32));
    (found - right).abs()
}

/// A share in steps, so that the last digits of a platform's functions do not show.
fn stepped(share: f64) -> f32 {
    if share.is_finite() {
        (64.0 * share).round() as f32 / 64.0
    } else {
        0.0
    }
}

/// The mean over the two largest sizes of footprints.
fn mean_of_largest(values: &[f32]) -> f64 {
    let largest = &values[values.len() - LARGEST..];
    largest.iter().map(|&x| f64::from(x)).sum::<f64>() / largest.len() as f64
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
