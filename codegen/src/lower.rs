//! From a checked graph to a program: every node lowers itself into the IR through the moment
//! algebra, in topological order.
//!
//! A method that repeats the graph (`supersample`, `split`) is a fold over one function of it, and
//! `auto` is a branch between two functions: nothing is ever unrolled.

mod ahead;
mod arguments;
mod audit;
mod bands;
mod definition;
mod drawn;
mod entry;
mod facts;
mod finish;
mod function;
mod fusion;
mod image;
mod input;
mod instead;
mod jumps;
mod map;
mod method;
mod mixture;
mod order;
mod pair;
mod period;
mod place;
mod rule;
mod sampled;
mod sampling;
mod shape;
mod slope;
mod symbols;
mod table;
mod taps;
mod torus;
mod upstream;

pub use audit::{Audit, AuditedBand, AuditedOutput, Remedy, Replaced};
pub use definition::{NodeDef, SumOfSteps};
pub use image::{Ensemble, Image, pairs};
pub use jumps::jumps;
pub use method::{Method, ParseMethodError, PixelFilter};
pub use rule::{NodeRule, PartNames};
pub use slope::Slopes;
pub use upstream::{Over, Upstream, Widened};

use crate::ir::{Builder, Float, FunctionRef, Interface, Label, Library, Module, Port, Program};
use crate::moments::{Algebra, Map, Mode, Samples, Signal, Symbol, Tabulated};
use arguments::Arguments;
use facts::Facts;
use mipless_graph::{
    Behaviour, Checked, Graph, InputView, Node, NodeId, Picture, Reach, Source, Type,
};
use rustc_hash::FxHashMap;
use std::any::Any;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The components of a node's output.
pub type Bundle<'b> = Vec<Signal<'b>>;

/// What to compile for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// The pixel filter.
    pub filter: PixelFilter,
    /// Whether the outputs' variances are results too.
    pub moments: bool,
    /// Selects the pattern of `supersample`; two seeds are independent.
    pub seed: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            filter: PixelFilter::default(),
            moments: false,
            seed: 0,
        }
    }
}

/// Compiles a checked graph.
///
/// # Panics
/// If `catalogue` is not the one that the graph was resolved with.
pub fn compile(checked: &Checked, catalogue: &[NodeDef], options: &Options) -> Program {
    compile_audited(checked, catalogue, options).0
}

/// The same, with what `auto` has found out about itself; other methods do not look.
///
/// # Panics
/// If `catalogue` is not the one that the graph was resolved with.
pub fn compile_audited(
    checked: &Checked,
    catalogue: &[NodeDef],
    options: &Options,
) -> (Program, Option<Audit>) {
    let graph = checked.graph();
    let mut facts = Facts::of(graph);
    facts.mixtures = mixture::found(graph, catalogue, options, &facts);
    match options.method {
        Method::Auto => {
            let (program, audit) = audit::audited(checked, catalogue, options, facts);
            (program, Some(audit))
        }
        _ => (program(graph, catalogue, options, &facts), None),
    }
}

/// What `auto` does for a checked graph, and how far it and its closed form are from the truth.
///
/// # Panics
/// If `catalogue` is not the one that the graph was resolved with.
pub fn audit(checked: &Checked, catalogue: &[NodeDef], options: &Options) -> Audit {
    let options = Options {
        method: Method::Auto,
        ..*options
    };
    let (_, audit) = compile_audited(checked, catalogue, &options);
    audit.expect("`auto` is audited")
}

/// The program of a graph of which this is known.
fn program(graph: &Graph, catalogue: &[NodeDef], options: &Options, facts: &Facts) -> Program {
    let interface = Interface {
        name: identifier(&graph.name),
        parameters: (graph.parameters.iter())
            .map(|p| Port {
                name: p.name.clone(),
                ty: p.ty,
                default: p.value.numbers(),
            })
            .collect(),
        outputs: (graph.outputs.iter())
            .map(|o| Port {
                name: o.name.clone(),
                ty: o.ty,
                default: Vec::new(),
            })
            .collect(),
        moments: options.moments,
        position: symbols::reads_position(graph),
    };
    let compiler = Compiler::new((graph, facts), catalogue, options);
    let mut module = Module::default();
    entry::build(&compiler, &mut module, &interface.name);
    compiler.library.link(&mut module);
    Program {
        module: module.pruned(),
        interface,
    }
}

/// A lower-snake-case identifier from a graph's name.
fn identifier(name: &str) -> String {
    let mut out: String = (name.chars())
        .map(|c| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '_'
            }
        })
        .collect();
    if out.is_empty() || out.starts_with(|c: char| c.is_ascii_digit()) || out.starts_with('_') {
        out.insert_str(0, "texture");
    }
    out
}

/// Inputs of which nothing is known but that they vary.
struct Varying;

impl InputView for Varying {
    fn varies(&self, _: &str) -> bool {
        true
    }

    fn flag(&self, _: &str) -> bool {
        false
    }

    fn choice(&self, _: &str) -> &str {
        ""
    }

    fn number(&self, _: &str) -> f32 {
        1.0
    }

    fn in_space(&self, _: &str) -> bool {
        false
    }

    fn stops(&self, _: &str) -> Vec<[f32; 2]> {
        vec![[1.0, 1.0]]
    }

    fn matrix(&self, _: &str) -> Vec<f32> {
        vec![1.0]
    }

    fn picture(&self, _: &str) -> Option<&Picture> {
        None
    }

    fn same(&self, _: &str, _: &str) -> bool {
        false
    }

    fn components(&self, _: &str) -> usize {
        1
    }

    fn reach(&self, _: &str) -> Reach {
        Reach::ANY
    }
}

/// Whether a node is a source of detail: whatever its inputs are, it is random by itself.
fn is_source(node: &Node) -> bool {
    let behaviour = (node.spec.class)(&Varying);
    matches!(
        behaviour,
        Behaviour::Gaussian { .. } | Behaviour::Random { .. }
    )
}

/// What all functions of a compilation share.
struct Compiler<'a> {
    graph: &'a Graph,
    catalogue: &'a [NodeDef],
    options: &'a Options,
    facts: &'a Facts,
    /// The functions that nodes share, by their keys.
    functions: RefCell<FxHashMap<String, FunctionRef>>,
    /// The tables that nodes share, by their keys.
    tables: RefCell<FxHashMap<String, u32>>,
    /// The fused functions of nodes, sampled over their domains: one for each component.
    fused: RefCell<FxHashMap<usize, Samples>>,
    /// The first region of each shape that is fused: its last node and its entry.
    shapes: RefCell<FxHashMap<shape::Shape, (usize, NodeId)>>,
    /// What nodes have made of pictures, by its keys.
    made: RefCell<FxHashMap<String, Arc<dyn Any + Send + Sync>>>,
    /// The functions by tables that nodes share, by their keys.
    tabulated: RefCell<FxHashMap<String, Tabulated>>,
    /// The functions of two signals, by their keys.
    maps: RefCell<FxHashMap<String, Map>>,
    /// The nodes at which something jumps whose slopes are asked for.
    jumps: RefCell<BTreeSet<usize>>,
    /// The functions of things, by their keys.
    images: RefCell<FxHashMap<String, Image>>,
    /// Whether regions are worth more than their closed form, by their shapes: of two signals 1 for a
    /// map, of one signal the parts on each side of its middle; 0 for no.
    gains: RefCell<FxHashMap<shape::Shape, usize>>,
    /// The functions that all functions share.
    library: Library,
}

impl<'a> Compiler<'a> {
    fn new(
        (graph, facts): (&'a Graph, &'a Facts),
        catalogue: &'a [NodeDef],
        options: &'a Options,
    ) -> Self {
        Self {
            graph,
            catalogue,
            options,
            facts,
            functions: RefCell::default(),
            tables: RefCell::default(),
            made: RefCell::default(),
            tabulated: RefCell::default(),
            fused: RefCell::default(),
            shapes: RefCell::default(),
            maps: RefCell::default(),
            jumps: RefCell::default(),
            images: RefCell::default(),
            gains: RefCell::default(),
            library: Library::default(),
        }
    }

    /// A function that calls what all functions share.
    fn builder(&self, name: impl Into<String>, doc: impl Into<String>) -> Builder {
        Builder::new(name, doc).with_library(self.library.clone())
    }
}

/// The components of the signals, by their means, as the function's results.
fn value_results(b: &Builder, signals: &[Signal<'_>]) {
    for (i, signal) in signals.iter().enumerate() {
        b.result(format!("value_{i}"), signal.flat_mean());
    }
}

/// The state of the lowering of one function of the graph; what nodes build through.
pub struct Lower<'g, 'b> {
    /// The algebra and the builder.
    pub algebra: Algebra<'b>,
    module: &'g mut Module,
    compiler: &'g Compiler<'g>,
    arguments: Arguments<'b>,
    /// s: the standard deviation of the pixel filter, in pixels.
    filter_sd: f32,
    bundles: Vec<Option<Bundle<'b>>>,
    carriers: symbols::Carriers,
    chains: Vec<Option<fusion::Chain<'b>>>,
    pairs: Vec<Option<pair::Pair<'b>>>,
    sums: Vec<Option<pair::Sum<'b>>>,
    parameter_scalars: Vec<usize>,
    /// The footprint of each source, in wavelengths of its dominant detail.
    footprints: Vec<Float<'b>>,
    /// The footprint of each source and pattern, in wavelengths that tell its slopes.
    details: Vec<Float<'b>>,
    /// Whether they are asked for.
    measures: bool,
    /// Which nodes nothing but their footprints is asked of.
    only_measured: Vec<bool>,
    /// Whether the node at work is one.
    is_only_measured: bool,
    /// The node whose closed form is wanted, whatever the audit has found of it.
    closes: Option<usize>,
    /// Whether a rule is being built, whose functions are the library's.
    in_rule: bool,
    /// Whether something that is not linear follows a source.
    nonlinear: bool,
    /// Whether the node at work reads what is upstream over another footprint.
    reads_elsewhere: bool,
    /// The function of its things that the node at work is asked for.
    image: Option<Image>,
    /// What nodes have made of the same inputs, by its keys: [`Self::jointly`].
    made: FxHashMap<String, Bundle<'b>>,
    /// What sources have made of their things for nodes that follow.
    mixed: FxHashMap<usize, mixture::Mixed<'b>>,
}

impl<'g, 'b> Lower<'g, 'b> {
    fn new(compiler: &'g Compiler<'g>, module: &'g mut Module, b: &'b Builder, mode: Mode) -> Self {
        let arguments = Arguments::declare(b, compiler.graph);
        Self::with(compiler, module, Algebra::new(b, mode), arguments)
    }

    fn with(
        compiler: &'g Compiler<'g>,
        module: &'g mut Module,
        algebra: Algebra<'b>,
        arguments: Arguments<'b>,
    ) -> Self {
        let mut parameter_scalars = Vec::new();
        let mut next = 0;
        for parameter in &compiler.graph.parameters {
            parameter_scalars.push(next);
            next += parameter.ty.components();
        }
        Self {
            algebra,
            module,
            compiler,
            arguments,
            filter_sd: compiler.options.filter.sd(),
            bundles: vec![None; compiler.graph.nodes.len()],
            carriers: symbols::Carriers::default(),
            chains: vec![None; compiler.graph.nodes.len()],
            pairs: vec![None; compiler.graph.nodes.len()],
            sums: vec![None; compiler.graph.nodes.len()],
            parameter_scalars,
            footprints: Vec::new(),
            details: Vec::new(),
            measures: false,
            only_measured: Vec::new(),
            is_only_measured: false,
            closes: None,
            in_rule: false,
            nonlinear: false,
            reads_elsewhere: false,
            image: None,
            made: FxHashMap::default(),
            mixed: FxHashMap::default(),
        }
    }

    /// Lowers every live node.
    fn run(&mut self) {
        let facts = self.compiler.facts;
        let live = if self.mixes() && !facts.mixtures.is_empty() {
            facts.mixtures.live(self.compiler.graph)
        } else {
            facts.live.clone()
        };
        self.run_nodes(live);
    }

    /// Lowers the sources and what their inputs need, for their footprints alone.
    fn run_sources(&mut self) {
        self.measures = true;
        self.only_measured = vec![false; self.compiler.graph.nodes.len()];
        let graph = self.compiler.graph;
        let mut uses = vec![0; graph.nodes.len()];
        for (index, node) in graph.nodes.iter().enumerate().rev() {
            let live = self.compiler.facts.live[index] > 0;
            if uses[index] == 0 && !(live && is_source(node)) {
                continue;
            }
            if uses[index] == 0 {
                self.only_measured[index] = true;
                uses[index] = 1;
            }
            for input in &node.inputs {
                if let Source::Node(id) = input.source {
                    uses[id.index()] += 1;
                }
            }
        }
        self.run_nodes(uses);
    }

    /// Lowers a node and what it depends on, as if nothing else were read.
    fn run_alone(&mut self, index: usize) -> Bundle<'b> {
        let graph = self.compiler.graph;
        let mut uses = vec![0; graph.nodes.len()];
        uses[index] = 1;
        for node in (0..=index).rev() {
            if uses[node] > 0 {
                for id in self.reads(node) {
                    uses[id.index()] += 1;
                }
            }
        }
        self.run_nodes(uses);
        self.bundles[index]
            .take()
            .expect("what is asked for is read once more than by its readers")
    }

    /// Lowers the nodes that something uses, `uses` times each.
    fn run_nodes(&mut self, mut uses: Vec<u32>) {
        let compiler = self.compiler;
        let graph = compiler.graph;
        for &index in &compiler.facts.order {
            let index = index as usize;
            let node = &graph.nodes[index];
            if uses[index] == 0 {
                continue;
            }
            self.is_only_measured = self.only_measured.get(index) == Some(&true);
            let forks = uses[index] > 1;
            self.algebra.shares = forks || self.algebra.derives;
            let details = self.details.len();
            let mixed = self.mixed(index).or_else(|| self.stepped(index, &uses));
            let next = match &mixed {
                Some((_, first)) => *first,
                None => self.algebra.next_symbol(),
            };
            let kept = forks.then_some(next);
            let definition = &self.compiler.catalogue[node.definition];
            assert_eq!(
                definition.spec.name, node.spec.name,
                "the catalogue of the graph"
            );
            self.algebra.jumped = false;
            self.algebra.bent = false;
            self.algebra.knots = 0;
            self.algebra.period = None;
            self.reads_elsewhere = false;
            let is_mixed = mixed.is_some();
            let mut bundle = match mixed {
                Some((bundle, _)) => bundle,
                None => self.with_images(index, node, &uses),
            };
            assert_eq!(
                bundle.len(),
                node.ty.components(),
                "components of {}",
                node.spec.name
            );
            self.nonlinear |= self.algebra.bent;
            let mut slopes = self.slopes_of(&bundle, details);
            if self.jumps(&bundle) {
                self.compiler.jumps.borrow_mut().insert(index);
            }
            if !is_mixed && let Some(fused) = self.fuse(index, node, &bundle) {
                bundle = fused;
                for (slope, signal) in slopes.iter_mut().zip(&bundle) {
                    if let Some(own) = &signal.slope {
                        *slope = Some(own.clone());
                    }
                }
            }
            if self.closes != Some(index)
                && let Some(other) = self.instead(index, &bundle)
            {
                bundle = other;
                self.chains[index] = None;
                self.pairs[index] = None;
                self.sums[index] = None;
            }
            if self.algebra.derives {
                self.put_slopes(&mut bundle, slopes);
            }
            self.carriers.born(&bundle);
            // Inputs that nothing else reads are gone: a symbol that only this signal still carries
            // is nobody's business.
            for id in self.reads(index) {
                uses[id.index()] -= 1;
                if uses[id.index()] == 0
                    && let Some(dead) = self.bundles[id.index()].take()
                {
                    self.carriers.died(&dead);
                }
            }
            let kept = kept.unwrap_or(Symbol(u32::MAX));
            if !self.algebra.derives {
                self.carriers
                    .retire(&mut bundle, kept, self.compiler.facts.crossed[index]);
            }
            self.name(node, &bundle);
            if forks {
                for signal in &mut bundle {
                    // What a linear node passes on is no fresh part of it, and has several readers now.
                    if let Some(symbol) = self.algebra.publish(signal) {
                        self.carriers.gained(symbol);
                    }
                    if signal.hermite.is_none() {
                        let symbol = self.algebra.fresh_symbol();
                        signal.hermite = Some(symbol);
                        self.carriers.gained(symbol);
                    }
                }
            }
            self.bundles[index] = Some(bundle);
        }
    }

    fn name(&self, node: &Node, bundle: &Bundle<'b>) {
        let name: Arc<str> = identifier(&node.name).into();
        let letters: &[&str] = match (node.ty, bundle.len()) {
            (_, 1) => &[""],
            (Type::Color3 | Type::Color4, _) => &["_r", "_g", "_b", "_a"],
            _ => &["_x", "_y", "_z", "_w"],
        };
        for (signal, letter) in bundle.iter().zip(letters) {
            let parts = [
                (signal.mean, ""),
                (signal.g[0], "_gx"),
                (signal.g[1], "_gy"),
                (signal.private, "_rest"),
            ];
            for (value, part) in parts {
                let label = Label::of_parts(&name, [letter, part]);
                self.algebra.b.name(value, label);
            }
        }
    }

    /// The means, then (if demanded) the variances of all outputs, with names.
    fn results(&self) -> Vec<(String, Float<'b>)> {
        let graph = self.compiler.graph;
        let (mut means, mut variances) = (Vec::new(), Vec::new());
        for output in &graph.outputs {
            let bundle = self.bundles[output.node.index()]
                .as_ref()
                .expect("outputs are live");
            for (i, signal) in bundle.iter().enumerate() {
                let name = format!("{}_{i}", identifier(&output.name));
                means.push((name.clone(), signal.flat_mean()));
                if self.compiler.options.moments {
                    variances.push((format!("{name}_variance"), signal.variance()));
                }
            }
        }
        means.extend(variances);
        means
    }
}
