//! Regions of one signal that a live parameter shapes between their bends: averaged where they run.
//!
//! X = m + σ (ξ + τ z) with a few places ξ and a narrow Gaussian z at each. Within one of those the
//! region is nearly straight, so that closing it node by node is right there; the moments of the
//! whole follow from those of the parts (the law of total variance). No table is baked, and every
//! parameter stays live, at the cost of the region's closed form 7, 15 or 31 times; so only regions
//! whose closed form is measured to be off are averaged. Point values in place of the parts would err
//! most where a region has jumps (MATH §7: 7 uniform taps with the cell's variance added).

use super::fusion::{Chain, region};
use super::pair::{DEVIATIONS, TOLERANCE};
use super::shape::{measured, shape};
use super::{Arguments, Bundle, Compiler, Lower, Varying, value_results};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{Builder, FunctionRef, Module, Vec2};
use crate::moments::{Algebra, Mode, SIDES, Signal, Tapped};
use mipless_graph::{Behaviour, NodeId, Type};

/// How much wider, relative to the signal at the parameters' defaults, the entry of a table may be:
/// its finest σ is a part of the domain.
const WIDER: f32 = 4.0;

/// What is known of a parameter without setting it.
#[derive(Clone, Copy)]
enum Setting {
    Default,
    Least,
    Most,
}

impl<'b> Lower<'_, 'b> {
    /// Whether a signal that is affine in the entry of its chain, but shaped by parameters, can be
    /// the entry of tables itself: its bounds over all parameters are not much wider than at their
    /// defaults.
    pub(super) fn enters(&self, index: usize, chain: &Chain<'b>, closed: &[Signal<'b>]) -> bool {
        let ([signal], Some([low, high])) = (closed, chain.domain()) else {
            return false;
        };
        let extent = signal.range[1] - signal.range[0];
        if chain.period.is_some() || signal.cell.is_some() || !extent.is_finite() {
            return false;
        }
        let mut module = Module::default();
        let alone = self.compiler.with_options(self.compiler.options);
        point(&alone, &mut module, index, chain.entry);
        let values = evaluate(self.compiler, &module, &[vec![low, high]], Setting::Default);
        extent <= WIDER * (values[0][1] - values[0][0]).abs()
    }

    /// The region that ends at the node by taps, if its closed form is off.
    pub(super) fn tapped(
        &mut self,
        index: usize,
        closed: &[Signal<'b>],
        chain: &Chain<'b>,
    ) -> Option<Bundle<'b>> {
        let compiler = self.compiler;
        let scales = scales(compiler, chain)?;
        if !(1..=4).contains(&closed.len()) {
            return None;
        }
        let nodes = region(compiler, index, &[chain.entry]);
        let shape = shape(compiler, &[chain.entry], &nodes).map(|mut words| {
            words.extend(scales.iter().flatten().map(|x| x.to_bits()));
            words
        });
        let side = measured(compiler, shape, || side(compiler, index, chain, &scales));
        if side == 0 {
            return None;
        }
        let value = self.function(&format!("point {index}"), |module| {
            point(compiler, module, index, chain.entry)
        });
        let moments = self.function(&format!("taps {index}"), |module| {
            averaged(compiler, module, index, chain, (closed.len(), side))
        });
        let bundle = closed.iter().enumerate().map(|(component, signal)| {
            let tapped = Tapped {
                value: value.clone(),
                moments: moments.clone(),
                component,
                parameters: self.arguments.parameters.clone(),
                range: signal.range,
            };
            self.algebra.transfer(&chain.signal, &tapped)
        });
        Some(bundle.collect())
    }
}

/// Centres and standard deviations of the entry as a process: from its range, or a few that noises of
/// a live amplitude have.
fn scales(compiler: &Compiler<'_>, chain: &Chain<'_>) -> Option<Vec<[f32; 2]>> {
    if chain.period.is_some() {
        return None;
    }
    if let Some([low, high]) = chain.domain() {
        return Some(vec![[0.5 * (low + high), (high - low) / DEVIATIONS]]);
    }
    let node = &compiler.graph.nodes[chain.entry.index()];
    let gaussian = matches!((node.spec.class)(&Varying), Behaviour::Gaussian { .. });
    gaussian.then(|| vec![[0.0, 0.1], [0.0, 0.3], [0.0, 1.0], [0.5, 0.25]])
}

/// Lowers the region into `lower`, whose entry is this signal.
fn lowered<'b>(
    lower: &mut Lower<'_, 'b>,
    index: usize,
    entry: NodeId,
    x: Signal<'b>,
) -> Bundle<'b> {
    let compiler = lower.compiler;
    lower.bundles[entry.index()] = Some(vec![x]);
    // Signals of the region that are read twice keep what they share.
    lower.algebra.shares = true;
    for node in region(compiler, index, &[entry]) {
        let node_of = &compiler.graph.nodes[node];
        let bundle = (compiler.catalogue[node_of.definition].lower)(lower, node_of);
        lower.bundles[node] = Some(bundle);
    }
    lower.bundles[index].take().expect("the region ends here")
}

/// The region's values at a value of its entry, for these parameters.
fn point(compiler: &Compiler<'_>, module: &mut Module, index: usize, entry: NodeId) -> FunctionRef {
    let name = super::identifier(&compiler.graph.nodes[index].name);
    let b = &Builder::new(format!("{name}_of"), "A function of one signal.");
    let argument = Signal::certain(b.float_param("x"));
    let parameters = Arguments::parameters(b, compiler.graph);
    let arguments = Arguments::without_place(b, compiler.graph, parameters);
    let mut lower = Lower::with(compiler, module, Algebra::new(b, Mode::Point), arguments);
    value_results(b, &lowered(&mut lower, index, entry, argument));
    b.finish(module)
}

/// The region closed node by node over a Gaussian of its entry: of each component the mean, the
/// slope, and the variance beyond it.
fn part(
    compiler: &Compiler<'_>,
    module: &mut Module,
    index: usize,
    chain: &Chain<'_>,
) -> FunctionRef {
    let name = super::identifier(&compiler.graph.nodes[index].name);
    let b = &Builder::new(format!("{name}_part"), "A function of a narrow Gaussian.");
    let [mean, sd] = b.float_params(["mean", "sd"]);
    let x = Signal {
        g: Vec2([sd, b.float(0.0)]),
        ..Signal::certain(mean).with_range(chain.signal.range)
    };
    let parameters = Arguments::parameters(b, compiler.graph);
    let arguments = Arguments::without_place(b, compiler.graph, parameters);
    let mut lower = Lower::with(compiler, module, Algebra::new(b, Mode::Local), arguments);
    let bundle = lowered(&mut lower, index, chain.entry, x);
    for (i, signal) in bundle.iter().enumerate() {
        b.result(format!("mean_{i}"), signal.flat_mean());
        b.result(format!("slope_{i}"), signal.g[0] / sd);
        b.result(format!("rest_{i}"), signal.other_variance());
    }
    b.finish(module)
}

/// The moments of that many components of the region, by that many parts on each side.
fn averaged(
    compiler: &Compiler<'_>,
    module: &mut Module,
    index: usize,
    chain: &Chain<'_>,
    counts: (usize, usize),
) -> FunctionRef {
    let part = part(compiler, module, index, chain);
    let name = super::identifier(&compiler.graph.nodes[index].name);
    Tapped::function(module, &name, &part, counts, |b| {
        Arguments::parameters(b, compiler.graph)
    })
}

/// The module's entry at each row of its leading columns, with the graph's inputs set.
fn evaluate(
    compiler: &Compiler<'_>,
    module: &Module,
    columns: &[Vec<f32>],
    setting: Setting,
) -> Vec<Vec<f32>> {
    let mut inputs: Vec<Input<'_>> = columns.iter().map(|c| Input::Floats(c)).collect();
    for parameter in &compiler.graph.parameters {
        let bound = match setting {
            Setting::Default => None,
            Setting::Least => parameter.soft_min.or(parameter.min),
            Setting::Most => parameter.soft_max.or(parameter.max),
        };
        inputs.extend(parameter.value.numbers().into_iter().map(|x| {
            let x = bound.unwrap_or(x);
            match parameter.ty {
                Type::Integer => Input::Integer(x as i32),
                Type::Boolean => Input::Integer(i32::from(x != 0.0)),
                _ => Input::Float(x),
            }
        }));
    }
    let mut out: Vec<Vec<f32>> = Vec::new();
    let evaluator = Evaluator::<f32>::new(module);
    evaluator.evaluate(&mut Scratch::new(), &inputs, columns[0].len(), &mut out);
    out
}

/// The means of a component under some Gaussians, and how far they may be off.
type Wanted = (Vec<f32>, f32);

/// How many parts the region needs on each side so that its mean is off by at most [`TOLERANCE`] of
/// its values under a few Gaussians, for the defaults of the graph's inputs and the ends of their
/// sliders: the process at these centres and standard deviations, and footprints that have removed half of its deviation. 0 where the
/// closed form of the whole is good enough.
fn side(compiler: &Compiler<'_>, index: usize, chain: &Chain<'_>, scales: &[[f32; 2]]) -> usize {
    let alone = || compiler.with_options(compiler.options);
    let mut values = Module::default();
    let components = point(&alone(), &mut values, index, chain.entry)
        .results
        .len();
    let shapes = [(0.0, 1.0), (0.3, 0.5), (-0.8, 0.5), (0.9, 0.5), (-0.4, 0.5)];
    let (means, sds): (Vec<f32>, Vec<f32>) = (scales.iter())
        .flat_map(|&[centre, whole]| shapes.map(|(m, s)| (centre + m * whole, s * whole)))
        .unzip();
    let scores: Vec<f32> = (-200..=200).map(|i| 0.02 * i as f32).collect();
    let weights: Vec<f32> = scores.iter().map(|z| (-0.5 * z * z).exp()).collect();
    let total: f32 = weights.iter().sum();
    let places: Vec<f32> = (means.iter().zip(&sds))
        .flat_map(|(mean, sd)| scores.iter().map(move |z| mean + sd * z))
        .collect();
    let gaussians = [means, sds];
    let settings = [Setting::Default, Setting::Least, Setting::Most];
    let wanted: Vec<(Setting, Vec<Wanted>)> = (settings.into_iter())
        .map(|setting| {
            let values = evaluate(compiler, &values, std::slice::from_ref(&places), setting);
            let of = values.iter().map(|values| {
                let least = values.iter().copied().fold(f32::INFINITY, f32::min);
                let most = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                let means = values.chunks(scores.len()).map(|values| {
                    let sum: f32 = values.iter().zip(&weights).map(|(v, w)| v * w).sum();
                    sum / total
                });
                (means.collect(), TOLERANCE * (most - least))
            });
            (setting, of.collect())
        })
        .collect();
    // Every so many results of the module's entry are a component's, the mean first.
    let fits = |module: &Module, stride: usize| {
        wanted.iter().all(|(setting, wanted)| {
            let found = evaluate(compiler, module, &gaussians, *setting);
            wanted
                .iter()
                .zip(found.chunks(stride))
                .all(|((wanted, tolerance), found)| {
                    let off = wanted.iter().zip(&found[0]).map(|(w, f)| (w - f).abs());
                    off.fold(0.0, f32::max) <= *tolerance
                })
        })
    };
    let mut closed = Module::default();
    part(&alone(), &mut closed, index, chain);
    if fits(&closed, 3) {
        return 0;
    }
    let [fewer @ .., most] = SIDES;
    let enough = |&side: &usize| {
        let mut module = Module::default();
        averaged(&alone(), &mut module, index, chain, (components, side));
        fits(&module, Tapped::MOMENTS)
    };
    fewer.into_iter().find(enough).unwrap_or(most)
}
