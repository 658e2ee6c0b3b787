//! Identities are mixtures: what is a function of the number of a thing (a cell, a region, a brick)
//! is evaluated for each thing in the footprint and summed, where the number comes from.
//!
//! The mean of two numbers of things is the number of no thing, so that no rule for moments fits what
//! follows them. A node that gives things numbers ([`super::NodeDef::things`]) therefore lowers itself
//! as the sum of any function of them, their [`Image`]; here it is found which nodes of a graph are
//! functions of such a node alone, and these become the image. All of one source are summed at once,
//! with their covariance, and its own number among them where something else reads it.

pub(super) mod steps;

use super::image::Image;
use super::{Arguments, Bundle, Compiler, Facts, Lower, Method, NodeDef, Options};
use crate::ir::Module;
use crate::moments::{Algebra, Mode, Signal, Symbol};
use mipless_graph::{Behaviour, Graph, Node, NodeId, Source};
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use steps::Steps;

/// The most nodes of an image, which is evaluated for each thing.
pub(super) const LONGEST: usize = 64;
/// The most components of an image: their covariance is summed too.
pub(super) const COMPONENTS: usize = 12;

/// Which nodes of a graph are images of things.
#[derive(Clone, Debug, Default)]
pub(super) struct Mixtures {
    /// Of each node that gives things numbers, the nodes that are functions of it.
    ends: FxHashMap<usize, Vec<usize>>,
    /// Of each of these the node that gives the numbers.
    sources: FxHashMap<usize, usize>,
    /// The nodes that are functions of the same whole parts.
    steps: Vec<Steps>,
    /// Of each of these which.
    stepped: FxHashMap<usize, usize>,
}

impl Mixtures {
    pub(super) fn is_empty(&self) -> bool {
        self.sources.is_empty() && self.stepped.is_empty()
    }

    /// The whole parts that a node is a function of.
    pub(super) fn steps(&self, index: usize) -> Option<&Steps> {
        Some(&self.steps[*self.stepped.get(&index)?])
    }

    /// What the lowering of a node reads.
    pub(super) fn reads<'n>(
        &self,
        graph: &'n Graph,
        index: usize,
    ) -> impl Iterator<Item = NodeId> + 'n {
        let source = self
            .sources
            .get(&index)
            .map(|&source| NodeId(source as u32));
        let (readers, rounded): (&[usize], bool) = match self.stepped.get(&index) {
            Some(&steps) => (&self.steps[steps].roundings, true),
            None => (&[], false),
        };
        let readers: SmallVec<[usize; 4]> = match (source, rounded) {
            (Some(_), _) => SmallVec::new(),
            (None, true) => readers.into(),
            (None, false) => smallvec![index],
        };
        let inputs = (readers.into_iter())
            .flat_map(|reader| &graph.nodes[reader].inputs)
            .filter_map(|input| match input.source {
                Source::Node(id) => Some(id),
                _ => None,
            });
        source.into_iter().chain(inputs)
    }

    /// How many read each node of those that outputs need.
    pub(super) fn live(&self, graph: &Graph) -> Vec<u32> {
        let mut uses = vec![0; graph.nodes.len()];
        for output in &graph.outputs {
            uses[output.node.index()] += 1;
        }
        for index in (0..graph.nodes.len()).rev() {
            if uses[index] > 0 {
                for id in self.reads(graph, index) {
                    uses[id.index()] += 1;
                }
            }
        }
        uses
    }
}

/// What a node's output depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// Numbers and inputs of the graph.
    Nothing,
    /// The numbers of the things of one node.
    Things(usize),
    /// The whole parts that these nodes take, in their order.
    Steps(SmallVec<[usize; 4]>),
    /// Anything else.
    Place,
}

impl Origin {
    /// Of what depends on both.
    fn with(self, other: &Self) -> Self {
        match (self, other) {
            (one, Self::Nothing) => one,
            (Self::Nothing, other) => other.clone(),
            (Self::Steps(mut of), Self::Steps(others)) => {
                of.extend_from_slice(others);
                of.sort_unstable();
                of.dedup();
                if of.len() > steps::MOST_NODES {
                    Self::Place
                } else {
                    Self::Steps(of)
                }
            }
            (one, other) if one == *other => one,
            _ => Self::Place,
        }
    }
}

/// What each node's output depends on.
fn origins(graph: &Graph, catalogue: &[NodeDef]) -> Vec<Origin> {
    let mut origins = Vec::with_capacity(graph.nodes.len());
    for (index, node) in graph.nodes.iter().enumerate() {
        let mut origin = match (node.spec.class)(&super::Varying) {
            Behaviour::Position => Origin::Place,
            _ => Origin::Nothing,
        };
        for input in &node.inputs {
            let of = match &input.source {
                Source::Literal(_) | Source::Parameter(_) => &Origin::Nothing,
                Source::Surface => &Origin::Place,
                Source::Node(id) => &origins[id.index()],
            };
            origin = origin.with(of);
        }
        let definition = &catalogue[node.definition];
        if origin == Origin::Place && (definition.things)(node) {
            origin = Origin::Things(index);
        } else if origin == Origin::Place && definition.steps.is_some() {
            origin = Origin::Steps(smallvec![index]);
        }
        origins.push(origin);
    }
    origins
}

/// The nodes of a graph that are functions of the things of one node alone, and not linear: those that
/// outputs or other nodes read.
pub(super) fn found(
    graph: &Graph,
    catalogue: &[NodeDef],
    options: &Options,
    facts: &Facts,
) -> Mixtures {
    let mut mixtures = Mixtures::default();
    let origins = origins(graph, catalogue);
    let mut is_read = vec![false; graph.nodes.len()];
    for output in &graph.outputs {
        is_read[output.node.index()] = true;
    }
    for (index, node) in graph.nodes.iter().enumerate() {
        if facts.live[index] == 0 {
            continue;
        }
        for input in &node.inputs {
            if let Source::Node(id) = input.source {
                is_read[id.index()] |= origins[id.index()] != origins[index];
            }
        }
    }
    let mut ends: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    let mut stepped: Vec<usize> = Vec::new();
    for (index, origin) in origins.iter().enumerate() {
        if !is_read[index] || facts.live[index] == 0 {
            continue;
        }
        match origin {
            Origin::Things(source) if *source != index => {
                ends.entry(*source).or_default().push(index);
            }
            Origin::Steps(_) => stepped.push(index),
            _ => {}
        }
    }
    let compiler = Compiler::new((graph, facts), catalogue, options);
    for steps in steps::found(&compiler, &origins, stepped) {
        let place = mixtures.steps.len();
        (mixtures.stepped).extend(steps.ends.iter().map(|&end| (end, place)));
        mixtures.steps.push(steps);
    }
    for (source, mut of_source) in ends {
        curved(&compiler, source, &mut of_source);
        let mut components = 0;
        of_source.retain(|&end| {
            components += graph.nodes[end].ty.components();
            components < COMPONENTS
        });
        if !of_source.is_empty() {
            (mixtures.sources).extend(of_source.iter().map(|&end| (end, source)));
            mixtures.ends.insert(source, of_source);
        }
    }
    mixtures
}

/// Keeps of the functions of a source those that are not linear, unless they are too long or look at
/// other places than their own.
fn curved(compiler: &Compiler<'_>, source: usize, ends: &mut Vec<usize>) {
    let graph = compiler.graph;
    let region = super::fusion::regions(compiler, ends, &[NodeId(source as u32)]);
    if region.len() > LONGEST {
        ends.clear();
        return;
    }
    let b = &compiler.builder("region", "Functions of a number.");
    let mut module = Module::default();
    let parameters = Arguments::parameters(b, graph);
    let arguments = Arguments::without_place(b, graph, parameters);
    let mut lower = Lower::with(
        compiler,
        &mut module,
        Algebra::new(b, Mode::Local),
        arguments,
    );
    let number = |i: usize| Signal {
        private: b.float_param(format!("variance_{i}")),
        ..Signal::certain(b.float_param(format!("number_{i}")))
    };
    let numbers = (0..graph.nodes[source].ty.components()).map(number);
    lower.bundles[source] = Some(numbers.collect());
    let mut bent: FxHashMap<usize, bool> = FxHashMap::default();
    for node in region {
        lower.algebra.bent = false;
        lower.reads_elsewhere = false;
        lower.place_node(node);
        if lower.reads_elsewhere {
            ends.clear();
            return;
        }
        let before = (graph.nodes[node].inputs.iter()).any(
            |input| matches!(input.source, Source::Node(id) if bent.get(&id.index()) == Some(&true)),
        );
        bent.insert(node, before || lower.algebra.bent);
    }
    ends.retain(|end| bent[end]);
}

/// What a source has made of its things for a node that is a function of them.
#[derive(Clone, Debug)]
pub(super) struct Mixed<'b> {
    pub(super) bundle: Bundle<'b>,
    /// The symbols from this one on are the mixture's own.
    pub(super) first: Symbol,
}

impl<'b> Lower<'_, 'b> {
    /// Whether things are summed where their numbers come from.
    pub(super) fn mixes(&self) -> bool {
        let of_method = matches!(
            self.compiler.options.method,
            Method::Auto | Method::Local | Method::Quad | Method::Split(_)
        );
        of_method && self.algebra.mode.spreads() && self.only_measured.is_empty() && !self.in_rule
    }

    /// What the lowering of a node reads.
    pub(super) fn reads(&self, index: usize) -> Vec<NodeId> {
        let graph = self.compiler.graph;
        if self.mixes() {
            self.compiler.facts.mixtures.reads(graph, index).collect()
        } else {
            Mixtures::default().reads(graph, index).collect()
        }
    }

    /// Lowers a node into its place.
    pub(super) fn place_node(&mut self, index: usize) {
        let node = &self.compiler.graph.nodes[index];
        let definition = &self.compiler.catalogue[node.definition];
        let bundle = (definition.lower)(self, node);
        self.bundles[index] = Some(bundle);
    }

    /// The node's output, with what its readers are of its things: see [`Self::mixed`].
    pub(super) fn with_images(&mut self, index: usize, node: &Node, uses: &[u32]) -> Bundle<'b> {
        let compiler = self.compiler;
        let definition = &compiler.catalogue[node.definition];
        let ends = match compiler.facts.mixtures.ends.get(&index) {
            Some(ends) if self.mixes() => ends,
            _ => return (definition.lower)(self, node),
        };
        let ends: Vec<usize> = (ends.iter().copied())
            .filter(|&end| uses[end] > 0)
            .collect();
        if ends.is_empty() {
            return (definition.lower)(self, node);
        }
        let own = uses[index] > ends.len() as u32;
        let first = self.algebra.next_symbol();
        self.algebra.shares = true;
        self.image = Some(Image::of_nodes(self, index, own, &ends));
        let mut signals = (definition.lower)(self, node);
        self.image = None;
        let mut rest = signals.split_off(if own { node.ty.components() } else { 0 });
        for end in ends {
            let others = rest.split_off(compiler.graph.nodes[end].ty.components());
            let bundle = std::mem::replace(&mut rest, others);
            self.carriers.born(&bundle);
            self.mixed.insert(end, Mixed { bundle, first });
        }
        assert!(rest.is_empty(), "components of {}", node.spec.name);
        if !own {
            // Nobody reads it.
            let zero = Signal::constant(self.algebra.b, 0.0);
            signals = vec![zero; node.ty.components()];
        }
        signals
    }

    /// What a source has made of its things for this node, and the first of its symbols.
    pub(super) fn mixed(&mut self, index: usize) -> Option<(Bundle<'b>, Symbol)> {
        let Mixed { bundle, first } = self.mixed.remove(&index)?;
        self.carriers.died(&bundle);
        Some((bundle, first))
    }
}
