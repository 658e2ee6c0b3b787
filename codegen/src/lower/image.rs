//! What nodes that give things numbers are asked for: any function of the numbers.

use super::torus::alone;
use super::{Arguments, Compiler, Lower, value_results};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{Bool, Builder, Float, FunctionRef, Int, Module, Scalar, Scalars, Type, Uint};
use crate::moments::{Algebra, Mode, Signal};
use mipless_graph::{NodeId, Source};
use std::sync::Arc;

/// How many numbers stand for all: twice as many as random numbers are told apart by
/// (`randomfloat` has steps of 1/4096), so that each step counts alike.
const NUMBERS: usize = 8192;
/// The same where an input of the graph shapes the image, so that they are evaluated where it runs.
const LIVE_NUMBERS: u32 = 64;

/// What the numbers of all things have in common.
#[derive(Clone, Debug)]
pub struct Ensemble<'b> {
    /// Their means.
    pub means: Vec<Float<'b>>,
    /// The rows of the lower triangle of their covariance.
    pub covariance: Vec<Float<'b>>,
}

impl<'b> Scalars<'b> for Ensemble<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        [&self.means, &self.covariance].each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let [means, covariance] = [self.means, self.covariance].replaced(next);
        Self { means, covariance }
    }
}

/// A function of the number of a thing, in [0, 1), which a node sums over its things: the number
/// itself, unless something else is made of it. Or one of the whole parts of coordinates.
#[derive(Clone, Debug)]
pub struct Image {
    function: Option<FunctionRef>,
    /// Of how many whole parts it is a function, if it is one of them.
    axes: Option<usize>,
    channels: usize,
    /// The inputs of the graph, if it reads any.
    parameters: Vec<Type>,
    key: String,
    /// Means and covariance over all numbers, if no input of the graph shapes them.
    known: Option<Arc<[Vec<f32>; 2]>>,
}

/// Pairs of channels, in the order of the lower triangle of a matrix.
pub fn pairs(channels: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..channels).flat_map(|i| (0..=i).map(move |k| (i, k)))
}

impl Image {
    /// The number itself.
    fn identity() -> Self {
        Self {
            function: None,
            axes: None,
            channels: 1,
            parameters: Vec::new(),
            key: String::new(),
            known: Some(Arc::new([vec![0.5], vec![1.0 / 12.0]])),
        }
    }

    /// The components of nodes that are functions of a source, after its own if these are wanted.
    pub(super) fn of_nodes(
        lower: &mut Lower<'_, '_>,
        source: usize,
        own: bool,
        ends: &[usize],
    ) -> Self {
        let compiler = lower.compiler;
        let key = format!("image of {source} {own} {ends:?}");
        Self::kept(lower, key, None, |lower| {
            let region = super::fusion::regions(compiler, ends, &[NodeId(source as u32)]);
            let is_live = is_live(compiler, &region);
            let of = (source, own, ends, &region[..], is_live);
            let function = function(compiler, lower.module, of);
            let known = (!is_live).then(|| {
                let module = alone(compiler, |compiler, module| {
                    self::function(compiler, module, of);
                });
                moments(&module)
            });
            (function, known)
        })
    }

    /// The image of this key among those of the compilation, else what is made: its function, and its
    /// means and covariance unless inputs of the graph shape them.
    pub(super) fn kept<'b>(
        lower: &mut Lower<'_, 'b>,
        key: String,
        axes: Option<usize>,
        make: impl FnOnce(&mut Lower<'_, 'b>) -> (FunctionRef, Option<[Vec<f32>; 2]>),
    ) -> Self {
        let compiler = lower.compiler;
        if let Some(known) = compiler.images.borrow().get(&key) {
            return known.clone();
        }
        let (function, known) = make(lower);
        let parameters = match known {
            Some(_) => Vec::new(),
            None => (lower.arguments.parameters.iter())
                .map(|p| p.ty())
                .collect(),
        };
        let image = Self {
            parameters,
            channels: function.results.len(),
            function: Some(function),
            axes,
            key: key.clone(),
            known: known.map(Arc::new),
        };
        compiler.images.borrow_mut().insert(key, image.clone());
        image
    }

    /// Names it among those of a compilation; empty for the number itself.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// How many components it has.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Whether it is the number itself.
    pub fn is_identity(&self) -> bool {
        self.function.is_none()
    }

    /// The inputs of the graph that it reads, as parameters of a function that evaluates it.
    pub fn declare<'c>(&self, b: &'c Builder) -> Vec<Scalar<'c>> {
        let types = self.parameters.iter().enumerate();
        types
            .map(|(i, &ty)| b.scalar_param(format!("image_parameter_{i}"), ty))
            .collect()
    }

    /// Its components for a number.
    pub fn of<'c>(&self, number: Float<'c>, parameters: &[Scalar<'c>]) -> Vec<Float<'c>> {
        match &self.function {
            None => vec![number],
            Some(function) => number.builder().call(function, (number, parameters)),
        }
    }

    /// Its components for the whole parts of coordinates.
    ///
    /// # Panics
    /// If it is no function of so many whole parts.
    pub fn of_cell<'c>(&self, cell: &[Int<'c>], parameters: &[Scalar<'c>]) -> Vec<Float<'c>> {
        assert_eq!(self.axes, Some(cell.len()), "the whole parts of an image");
        let function = self.function.as_ref().expect("an image of whole parts");
        cell[0].builder().call(function, (cell, parameters))
    }
}

/// Whether inputs of the graph shape nodes.
pub(super) fn is_live(compiler: &Compiler<'_>, region: &[usize]) -> bool {
    region.iter().any(|&node| {
        let mut inputs = compiler.graph.nodes[node].inputs.iter();
        inputs.any(|input| matches!(input.source, Source::Parameter(_)))
    })
}

impl<'b> Lower<'_, 'b> {
    /// The function of its things' numbers that the node at work is asked for, with the inputs of the
    /// graph that it reads.
    pub fn image(&self) -> (Image, Vec<Scalar<'b>>) {
        let image = self.image.clone().unwrap_or_else(Image::identity);
        let parameters = match image.parameters.is_empty() {
            true => Vec::new(),
            false => self.arguments.parameters.clone(),
        };
        (image, parameters)
    }

    /// What an image is over all numbers, where the condition says that it is wanted.
    pub fn ensemble(&mut self, image: &Image, wanted: Bool<'b>) -> Ensemble<'b> {
        let b = self.b();
        if let Some(known) = &image.known {
            let [means, covariance] = &**known;
            let constants = |all: &[f32]| all.iter().map(|&x| b.float(x)).collect();
            return Ensemble {
                means: constants(means),
                covariance: constants(covariance),
            };
        }
        let key = format!("one more of {}", image.key);
        let body = self.function(&key, |module| one_more(module, image));
        let channels = image.channels;
        let before = vec![b.float(0.0); channels + pairs(channels).count()];
        let parameters = self.arguments.parameters.clone();
        let sums = b.fold(
            &body,
            wanted.select(LIVE_NUMBERS, 0u32),
            before,
            &parameters,
        );
        let mut means: Vec<Float<'b>> = (sums.iter())
            .map(|&sum| sum * (1.0 / LIVE_NUMBERS as f32))
            .collect();
        let products = means.split_off(channels);
        let covariance = (pairs(channels).zip(products))
            .map(|((i, k), product)| {
                let covariance = product - means[i] * means[k];
                if i == k {
                    covariance.max(0.0)
                } else {
                    covariance
                }
            })
            .collect();
        Ensemble { means, covariance }
    }
}

/// One more number, the body of a fold over all of them.
fn one_more(module: &mut Module, image: &Image) -> FunctionRef {
    let b = &Builder::new("one_more_number", "One more of the numbers of all things.");
    let index = b.uint_param("index");
    let channels = image.channels;
    let names: Vec<String> = (0..channels)
        .map(|i| format!("mean_{i}"))
        .chain(pairs(channels).map(|(i, k)| format!("product_{i}_{k}")))
        .collect();
    let state: Vec<Float<'_>> = names.iter().map(|name| b.float_param(name)).collect();
    let parameters = image.declare(b);
    let values = match image.axes {
        None => {
            let number = (index.to_float() + 0.5) * (1.0 / LIVE_NUMBERS as f32);
            image.of(number, &parameters)
        }
        Some(axes) => image.of_cell(&scattered(index, axes), &parameters),
    };
    let products = pairs(channels).map(|(i, k)| values[i] * values[k]);
    let parts: Vec<Float<'_>> = values.iter().copied().chain(products).collect();
    b.sums(names, state, parts);
    b.finish(module)
}

/// The components of nodes as a function of the number of a thing.
fn function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    (source, own, ends, region, is_live): (usize, bool, &[usize], &[usize], bool),
) -> FunctionRef {
    let graph = compiler.graph;
    let name = super::identifier(&graph.nodes[ends[0]].name);
    let b = &compiler.builder(
        format!("{name}_image"),
        "Functions of the number of a thing.",
    );
    let number = Signal::certain(b.float_param("number"));
    let parameters = match is_live {
        true => Arguments::parameters(b, graph),
        false => Vec::new(),
    };
    let arguments = Arguments::without_place(b, graph, parameters);
    let mut lower = Lower::with(compiler, module, Algebra::new(b, Mode::Point), arguments);
    lower.bundles[source] = Some(vec![number]);
    for &node in region {
        lower.place_node(node);
    }
    let wanted = own.then_some(&source).into_iter().chain(ends);
    let bundles = wanted.filter_map(|&node| lower.bundles[node].clone());
    let signals: Vec<Signal<'_>> = bundles.flatten().collect();
    value_results(b, &signals);
    b.finish(module)
}

/// Means and covariance of a function over all numbers.
fn moments(module: &Module) -> [Vec<f32>; 2] {
    let numbers: Vec<f32> = (0..NUMBERS)
        .map(|i| (i as f32 + 0.5) / NUMBERS as f32)
        .collect();
    let mut values: Vec<Vec<f32>> = Vec::new();
    let inputs = [Input::Floats(&numbers)];
    let evaluator = Evaluator::<f32>::new(module);
    evaluator.evaluate(&mut Scratch::new(), &inputs, NUMBERS, &mut values);
    moments_of(&values)
}

/// Means and covariance of components.
pub(super) fn moments_of(values: &[Vec<f32>]) -> [Vec<f32>; 2] {
    let count = values.first().map_or(1, Vec::len);
    let mean = |of: &dyn Fn(usize) -> f64| (0..count).map(of).sum::<f64>() / count as f64;
    let means: Vec<f64> = (values.iter())
        .map(|values| mean(&|i| f64::from(values[i])))
        .collect();
    let covariance = pairs(values.len()).map(|(i, k)| {
        let apart = |of: usize, at: usize| f64::from(values[of][at]) - means[of];
        mean(&|at| apart(i, at) * apart(k, at)) as f32
    });
    let covariance = covariance.collect();
    [means.iter().map(|&mean| mean as f32).collect(), covariance]
}

/// The cell of a number among all: far from those of others.
fn scattered(index: Uint<'_>, axes: usize) -> Vec<Int<'_>> {
    (0..axes as u32)
        .map(|axis| {
            let word = (index * 2u32 + axis).scramble();
            (word & 0xfff).to_int() + -0x800
        })
        .collect()
}
