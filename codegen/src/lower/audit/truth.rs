//! What is right on a few footprints, and how far values are from it.

use super::super::bands::Bands;
use super::super::drawn::{Drawn, Far};
use super::super::sampled::{MORE, POINTS, Sampling};
use super::super::{Facts, Method, NodeDef, Options, program};
use super::display::displayed;
use super::places::{LARGEST, PLACES, Places};
use crate::cpu::{Evaluator, Footprint, Scratch};
use crate::ir::Program;
use mipless_graph::Graph;
use std::ops::Range;

/// Points of the truth of a pixel at first, and at most where that shows an error.
pub(super) const GLANCE: u32 = 128;
pub(super) const LOOK: u32 = 1024;
/// The work that a truth is worth, in instructions of a lane: about a quarter of a second. What is
/// larger than some hundred nodes is looked at less closely.
const WORK: f64 = 8e8;
/// How far off a mean may be far away, as a display shows it.
pub(super) const BIASED: f64 = 0.004;
/// What of an error may be left where a signal is drawn to its mean, for that to count.
const BETTER: f64 = 0.7;

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

/// The same, and how many instructions of a lane that took.
pub(super) fn measured(program: &Program, footprints: &[Footprint]) -> (Vec<Vec<f32>>, u64) {
    evaluated(program, footprints, &parameters(program))
}

/// The values of a program's results at footprints.
pub(super) fn values_with(
    program: &Program,
    footprints: &[Footprint],
    parameters: &[f32],
) -> Vec<Vec<f32>> {
    evaluated(program, footprints, parameters).0
}

fn evaluated(
    program: &Program,
    footprints: &[Footprint],
    parameters: &[f32],
) -> (Vec<Vec<f32>>, u64) {
    let (mut values, mut scratch) = (Vec::new(), Scratch::new());
    Evaluator::<f32>::of_program(program).evaluate_footprints(
        &mut scratch,
        footprints,
        parameters,
        &mut values,
    );
    (values, scratch.work())
}

/// How many points a closer look at pixels takes, where a point takes so many instructions: more than
/// a glance where that is worth its time.
pub(super) fn look(work: f64) -> u32 {
    let samples = WORK / (work.max(1.0) * (PLACES * Bands::COUNT) as f64);
    let doublings = (samples / f64::from(GLANCE)).clamp(1.0, f64::from(LOOK / GLANCE));
    GLANCE << doublings.log2().floor() as u32
}

/// The components of each output, among those of all.
pub(super) fn components(graph: &Graph) -> Vec<Range<usize>> {
    let mut end = 0;
    (graph.outputs.iter())
        .map(|output| {
            let start = end;
            end += output.ty.components();
            let is_mean = graph.node(output.node).is_mean();
            start..if is_mean { end } else { start }
        })
        .collect()
}

/// What is right at footprints, for the components of all outputs.
pub(super) struct Truth<'p> {
    mean: Vec<Vec<f32>>,
    /// The variance of points within a footprint.
    variance: Vec<Vec<f32>>,
    pub(super) point: Vec<Vec<f32>>,
    /// The components of each output; none of what is no mean of points.
    outputs: Vec<Range<usize>>,
    /// How many points there are in a pixel.
    samples: u32,
    places: &'p Places,
}

/// Of each output, its errors by band.
pub(super) type Errors = Vec<[f64; Bands::COUNT]>;

impl<'p> Truth<'p> {
    pub(super) fn of(
        samples: u32,
        places: &'p Places,
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
            let program = program(graph, catalogue, &options, facts);
            values(&program, &places.footprints)
        };
        let mut mean = with(Method::Supersample(samples), true);
        let variance = mean.split_off(mean.len() / 2);
        Self {
            mean,
            variance,
            point: with(Method::Point, false),
            outputs: components(graph),
            samples,
            places,
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

    /// The errors that the truth itself has, at most. Of what is far beyond white they are large, since
    /// points say little of its mean.
    pub(super) fn floor(&self) -> Errors {
        self.over_bands(|component, pixel| {
            f64::from(self.variance[component][pixel]).max(0.0) / f64::from(self.samples)
        })
    }

    /// The same, as a display shows them: nothing where all that a mean may be is beyond white.
    pub(super) fn shown_floor(&self) -> Errors {
        self.over_bands(|component, pixel| {
            let mean = self.mean[component][pixel];
            let variance = self.variance[component][pixel].max(0.0);
            let sd = (variance / self.samples as f32).sqrt();
            let [low, high] = [mean - sd, mean + sd].map(displayed);
            (0.5 * (high - low)).powi(2)
        })
    }

    /// The roots of the means of squares over the components of an output and the pixels of a band.
    fn over_bands(&self, square: impl Fn(usize, usize) -> f64) -> Errors {
        let band = |output: usize, band: usize| {
            let all = self.places(output, band);
            let sum: f64 = all.map(|(i, pixel, share)| share * square(i, pixel)).sum();
            (sum / self.outputs[output].len().max(1) as f64).sqrt()
        };
        (0..self.outputs.len())
            .map(|output| std::array::from_fn(|i| band(output, i)))
            .collect()
    }

    /// The means of an output's components over the largest footprints, which hold most of the
    /// texture.
    fn far(&self, output: usize) -> Vec<f64> {
        self.components(output)
            .map(|component| mean_of_largest(&self.mean[component]))
            .collect()
    }

    /// How far the means of an output's components are off over the largest footprints, as a display
    /// shows them; the largest.
    pub(super) fn far_bias(&self, output: usize, found: &[Vec<f32>]) -> f64 {
        let of = |component: usize| far_bias(&found[component], &self.mean[component]);
        self.components(output).map(of).fold(0.0, f64::max)
    }

    /// The components of an output.
    pub(super) fn components(&self, output: usize) -> Range<usize> {
        self.outputs[output].clone()
    }

    /// The components of an output at the places of a band, with the shares of these.
    fn places(&self, output: usize, band: usize) -> impl Iterator<Item = (usize, usize, f64)> {
        let pixels = band * PLACES..(band + 1) * PLACES;
        self.components(output).flat_map(move |component| {
            let shares = pixels.clone().map(|pixel| self.places.shares[pixel]);
            (pixels.clone().zip(shares)).map(move |(pixel, share)| (component, pixel, share))
        })
    }

    /// How an output is best sampled: see [`super::sampled`]. Its points are drawn to the mean of the
    /// texture; where inputs of the graph shape it, to `closed`, which moves with them, as far as this
    /// has the right mean far away but for a factor.
    pub(super) fn sampling(&self, output: usize, is_steady: bool, closed: &[Vec<f32>]) -> Sampling {
        let start = self.outputs[output].start;
        let means = self.far(output);
        let far = match is_steady {
            true => Some(Far::Means(rounded(&means))),
            false => self.factors(output, &means, closed, BIASED).map(Far::Times),
        };
        let lost = |points: usize, band: usize| {
            let Some(far) = &far else { return 0.0 };
            let (mut between, mut within) = (0.0, 0.0);
            for (component, pixel, share) in self.places(output, band) {
                let variance = f64::from(self.variance[component][pixel]).max(0.0);
                let to = far.of(component - start, closed[component][pixel], |x| x);
                let apart = f64::from(self.mean[component][pixel]) - f64::from(to);
                within += share * variance / points as f64;
                between += share * (apart * apart - variance / f64::from(self.samples));
            }
            let lost = within / (between.max(0.0) + within).max(1e-30);
            // The finest band holds all that is finer, of which a point is right.
            if band > 0 && within > 0.0 {
                stepped(lost)
            } else {
                0.0
            }
        };
        let of = |points: usize| std::array::from_fn(|band| lost(points, band));
        let [few, more] = [POINTS, MORE].map(of);
        Sampling {
            drawn: self.drawn_to(far.unwrap_or(Far::Means(rounded(&means))), few),
            within: Bands::ALL,
            finer: 0,
            lost_of_more: more,
        }
    }

    /// How many times an output's values are its means far away, if that is no more than twice and no
    /// less than half for each component. What is as `near` to its mean is its mean.
    fn factors(
        &self,
        output: usize,
        means: &[f64],
        values: &[Vec<f32>],
        near: f64,
    ) -> Option<Vec<f32>> {
        let found = self.components(output).map(|i| mean_of_largest(&values[i]));
        let factors: Vec<f64> = (means.iter().zip(found))
            .map(|(mean, found)| match (mean - found).abs() < near {
                true => 1.0,
                false => mean / found,
            })
            .collect();
        let small = |factor: &f64| (0.5..2.0).contains(factor);
        factors.iter().all(small).then(|| rounded(&factors))
    }

    /// How an output's values are best drawn to its means, in the bands of `within` where that counts;
    /// `None` where it counts in none.
    pub(super) fn drawn(
        &self,
        output: usize,
        found: &[Vec<f32>],
        (is_steady, within): (bool, u32),
    ) -> Option<Drawn> {
        let components = self.components(output);
        let start = components.start;
        let means = self.far(output);
        let far = if is_steady {
            Far::Means(rounded(&means))
        } else {
            Far::Times(self.factors(output, &means, found, 0.0)?)
        };
        let lost = std::array::from_fn(|band| {
            let triples: Vec<(f64, [f64; 3])> = (self.places(output, band))
                .map(|(component, pixel, share)| {
                    let found = found[component][pixel];
                    let far = far.of(component - start, found, |x| x);
                    let right = self.mean[component][pixel];
                    (share, [found, far, right].map(f64::from))
                })
                .collect();
            let (mut along, mut squares) = (0.0, 0.0);
            for (share, [found, far, right]) in &triples {
                let way = far - found;
                along += share * way * (right - found);
                squares += share * way * way;
            }
            let lost = stepped((along / squares.max(1e-30)).clamp(0.0, 1.0));
            let error = |lost: f64| {
                let squares = triples.iter().map(|(share, [found, far, right])| {
                    let drawn = found + lost * (far - found);
                    share * (displayed(drawn as f32) - displayed(*right as f32)).powi(2)
                });
                (squares.sum::<f64>() / self.outputs[output].len().max(1) as f64).sqrt()
            };
            let before = error(0.0);
            // The finest band holds all that is finer.
            let may = band > 0 && within >> band & 1 == 1 && before > BIASED;
            let counts = may && error(f64::from(lost)) < BETTER * before;
            if counts { lost } else { 0.0 }
        });
        (lost != [0.0; Bands::COUNT]).then(|| self.drawn_to(far, lost))
    }

    fn drawn_to(&self, far: Far, lost: [f32; Bands::COUNT]) -> Drawn {
        Drawn {
            far,
            lost,
            bands: self.places.bands,
            near: Vec::new(),
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
    let largest = &values[values.len().saturating_sub(LARGEST)..];
    largest.iter().map(|&x| f64::from(x)).sum::<f64>() / largest.len() as f64
}
