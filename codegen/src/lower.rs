//! From a checked graph to a program: every node lowers itself into the IR through the moment
//! algebra, in topological order.
//!
//! A method that repeats the graph (`supersample`, `split`) is a fold over one function of it, and
//! `auto` is a branch between two functions: nothing is ever unrolled.

mod arguments;
mod entry;
mod fusion;
mod input;
mod map;
mod method;
mod pair;
mod sampling;
mod symbols;
mod table;

pub use method::{Method, ParseMethodError, PixelFilter};

use crate::ir::{Builder, FunctionRef, Interface, Library, Module, Port, Program, Value};
use crate::moments::{Algebra, Map, Mode, Samples, Signal, Symbol, Tabulated};
use arguments::Arguments;
use mipless_graph::{Behaviour, Checked, Graph, InputView, Node, NodeSpec, Source, Type};
use rustc_hash::FxHashMap;
use std::any::Any;
use std::cell::RefCell;
use std::sync::Arc;

/// The components of a node's output.
pub type Bundle = Vec<Signal>;

/// A node type: its spec, which holds its statistics rule, and its lowering.
#[derive(Clone, Copy, Debug)]
pub struct NodeDef {
    /// Everything but the lowering.
    pub spec: &'static NodeSpec,
    /// Builds the node's output: as many signals as its type has components.
    pub lower: fn(&mut Lower<'_>, &Node) -> Bundle,
}

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
    let graph = checked.graph();
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
    let live = symbols::live(graph);
    let crossed = symbols::crossed(graph);
    let literal = symbols::literal(graph);
    let (functions, fused) = (RefCell::default(), RefCell::default());
    let compiler = Compiler {
        graph,
        catalogue,
        options,
        live,
        crossed,
        literal,
        functions,
        tables: RefCell::default(),
        made: RefCell::default(),
        tabulated: RefCell::default(),
        fused,
        maps: RefCell::default(),
        gains: RefCell::default(),
        library: Library::default(),
    };
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

    fn stops(&self, _: &str) -> Vec<[f32; 2]> {
        vec![[1.0, 1.0]]
    }
}

/// What all functions of a compilation share.
struct Compiler<'a> {
    graph: &'a Graph,
    catalogue: &'a [NodeDef],
    options: &'a Options,
    /// How many live edges read each node's output.
    live: Vec<u32>,
    /// Whether components of each node's output are combined later.
    crossed: Vec<bool>,
    /// Whether literals alone shape each node's output.
    literal: Vec<bool>,
    /// The functions that nodes share, by their keys.
    functions: RefCell<FxHashMap<String, FunctionRef>>,
    /// The tables that nodes share, by their keys.
    tables: RefCell<FxHashMap<String, u32>>,
    /// The fused functions of nodes, sampled over their domains: one for each component.
    fused: RefCell<FxHashMap<usize, Samples>>,
    /// What nodes have made of pictures, by its keys.
    made: RefCell<FxHashMap<String, Arc<dyn Any + Send + Sync>>>,
    /// The functions by tables that nodes share, by their keys.
    tabulated: RefCell<FxHashMap<String, Tabulated>>,
    /// The functions of two signals, by their keys.
    maps: RefCell<FxHashMap<String, Map>>,
    /// Whether regions of two signals are worth a map, by their shapes.
    gains: RefCell<FxHashMap<u64, bool>>,
    /// The functions that all functions share.
    library: Library,
}

/// The state of the lowering of one function of the graph; what nodes build through.
pub struct Lower<'a> {
    /// The algebra and the builder.
    pub algebra: Algebra,
    module: &'a mut Module,
    compiler: &'a Compiler<'a>,
    arguments: Arguments,
    /// s: the standard deviation of the pixel filter, in pixels.
    filter_sd: f32,
    bundles: Vec<Option<Bundle>>,
    carriers: symbols::Carriers,
    chains: Vec<Option<fusion::Chain>>,
    pairs: Vec<Option<pair::Pair>>,
    sums: Vec<Option<pair::Sum>>,
    parameter_scalars: Vec<usize>,
    /// The footprint of each source, in wavelengths of its dominant detail.
    footprints: Vec<Value>,
    /// Whether something that is not linear follows a source.
    nonlinear: bool,
}

impl<'a> Lower<'a> {
    fn new(compiler: &'a Compiler<'a>, module: &'a mut Module, mut b: Builder, mode: Mode) -> Self {
        let arguments = Arguments::declare(&mut b, compiler.graph);
        let b = b.with_library(compiler.library.clone());
        Self::with(compiler, module, Algebra::new(b, mode), arguments)
    }

    fn with(
        compiler: &'a Compiler<'a>,
        module: &'a mut Module,
        algebra: Algebra,
        arguments: Arguments,
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
            nonlinear: false,
        }
    }

    /// Lowers every live node.
    fn run(&mut self) {
        let live = self.compiler.live.clone();
        self.run_nodes(live);
    }

    /// Lowers the sources and what their inputs need, for their footprints alone.
    fn run_sources(&mut self) {
        let graph = self.compiler.graph;
        let mut uses = vec![0; graph.nodes.len()];
        for (index, node) in graph.nodes.iter().enumerate().rev() {
            let live = self.compiler.live[index] > 0;
            // Whatever its inputs are, a source is Gaussian by itself.
            let source = matches!(
                (node.spec.class)(&Varying),
                Behaviour::Gaussian { .. } | Behaviour::Random { .. }
            );
            if uses[index] == 0 && !(live && source) {
                continue;
            }
            uses[index] = uses[index].max(1);
            for input in &node.inputs {
                if let Source::Node(id) = input.source {
                    uses[id.index()] += 1;
                }
            }
        }
        self.run_nodes(uses);
    }

    /// Lowers the nodes that something uses, `uses` times each.
    fn run_nodes(&mut self, mut uses: Vec<u32>) {
        let graph = self.compiler.graph;
        for (index, node) in graph.nodes.iter().enumerate() {
            if uses[index] == 0 {
                continue;
            }
            let forks = uses[index] > 1;
            self.algebra.shares = forks;
            let kept = forks.then(|| self.algebra.next_symbol());
            let definition = &self.compiler.catalogue[node.definition];
            assert_eq!(
                definition.spec.name, node.spec.name,
                "the catalogue of the graph"
            );
            self.algebra.bent = false;
            self.algebra.knots = 0;
            self.algebra.period = None;
            let mut bundle = (definition.lower)(self, node);
            assert_eq!(
                bundle.len(),
                node.ty.components(),
                "components of {}",
                node.spec.name
            );
            self.nonlinear |= self.algebra.bent;
            if let Some(fused) = self.fuse(index, node, &bundle) {
                bundle = fused;
            }
            self.carriers.born(&bundle);
            // Inputs that nothing else reads are gone: a symbol that only this signal still carries
            // is nobody's business.
            for input in &node.inputs {
                if let Source::Node(id) = input.source {
                    uses[id.index()] -= 1;
                    if uses[id.index()] == 0
                        && let Some(dead) = self.bundles[id.index()].take()
                    {
                        self.carriers.died(&dead);
                    }
                }
            }
            let b = &mut self.algebra.b;
            let kept = kept.unwrap_or(Symbol(u32::MAX));
            self.carriers
                .retire(b, &mut bundle, kept, self.compiler.crossed[index]);
            self.name(node, &bundle);
            if forks {
                for signal in &mut bundle {
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

    fn name(&mut self, node: &Node, bundle: &Bundle) {
        let name = identifier(&node.name);
        let letters: &[&str] = match (node.ty, bundle.len()) {
            (_, 1) => &[""],
            (Type::Color3 | Type::Color4, _) => &["_r", "_g", "_b", "_a"],
            _ => &["_x", "_y", "_z", "_w"],
        };
        let b = &mut self.algebra.b;
        for (signal, letter) in bundle.iter().zip(letters) {
            b.name(signal.mean, format!("{name}{letter}"));
            b.name(signal.g[0], format!("{name}{letter}_gx"));
            b.name(signal.g[1], format!("{name}{letter}_gy"));
            b.name(signal.private, format!("{name}{letter}_rest"));
        }
    }

    /// The means, then (if demanded) the variances of all outputs, with names.
    fn results(&mut self) -> Vec<(String, Value)> {
        let graph = self.compiler.graph;
        let (mut means, mut variances) = (Vec::new(), Vec::new());
        for output in &graph.outputs {
            let bundle = self.bundles[output.node.index()]
                .clone()
                .expect("outputs are live");
            for (i, signal) in bundle.iter().enumerate() {
                let name = format!("{}_{i}", identifier(&output.name));
                let b = &mut self.algebra.b;
                means.push((name.clone(), signal.flat_mean(b)));
                if self.compiler.options.moments {
                    variances.push((format!("{name}_variance"), signal.variance(b)));
                }
            }
        }
        means.extend(variances);
        means
    }
}
