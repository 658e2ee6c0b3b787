//! Fusion: a region that is not linear and depends on one signal alone is composed into one
//! function of that signal and filtered once. Closing it node by node never converges (MATH §7:
//! 0.16 against 0.038).
//!
//! A region is entered at the last signal that more than one thing shapes, or at a source. What a
//! live parameter shapes cannot be baked: where it scales or shifts what is still Gaussian, the
//! region is entered behind it; where it comes after the last bend, the region ends before it; in
//! between, or where the amplitude of the noise itself is live, the region is averaged where it
//! runs, by [`super::taps`].

use super::shape::baked;
use super::{Arguments, Bundle, Compiler, Lower, Options, is_source, shape, value_results};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{Builder, FunctionRef, Module};
use crate::moments::{
    Algebra, Branch, Mode, Pyramids, Sampled, Samples, Signal, Tabulated, pyramids, sample_points,
};
use mipless_graph::{Node, NodeId, Source};
use std::rc::Rc;
use std::sync::{Arc, LazyLock};

/// What tells the shape of a pyramid from that of a map of the same nodes.
const PYRAMIDS: u32 = 0x5059_5241;
/// The most functions that are not linear in one region.
const LONGEST: u32 = 12;
/// The most knots of a single function in closed form: with more the table takes less time (on a
/// CPU, 8 for a colour and 6 for a number; `cargo bench -p mipless-tests --bench stops`).
const MOST_KNOTS: u32 = 8;

/// That a node is a function of one scalar signal alone.
#[derive(Clone, Debug)]
pub(super) struct Chain<'b> {
    /// The node whose output the function takes.
    pub(super) entry: NodeId,
    /// That output, which outlives its other readers.
    pub(super) signal: Rc<Signal<'b>>,
    /// How many nodes between are not linear, at most.
    pub(super) bends: u32,
    /// Whether no live parameter shapes it.
    pub(super) fixed: bool,
    /// The period of the function, where the entry is not bounded but the function repeats.
    pub(super) period: Option<f32>,
}

/// What a node that is read is known to be.
pub(super) enum Known<'b> {
    /// A number; whether literals alone shape it.
    Certain { literal: bool },
    /// A function of one signal: itself, at least.
    Function(Chain<'b>),
    /// Several signals, of which no one function is known.
    Opaque,
    /// A number that differs from place to place: a region is a function of signals alone, and could
    /// not compute it.
    Placed,
}

impl Chain<'_> {
    /// The values of the entry that matter, if they are bounded.
    pub(super) fn domain(&self) -> Option<[f32; 2]> {
        if let Some(period) = self.period {
            return Some([0.0, period]);
        }
        let [low, high] = self.signal.range;
        (low.is_finite() && high.is_finite() && low < high).then_some([low, high])
    }
}

impl<'a> Compiler<'a> {
    /// The same compilation with other options, and nothing built yet.
    pub(super) fn with_options<'o>(&self, options: &'o Options) -> Compiler<'o>
    where
        'a: 'o,
    {
        Compiler {
            library: self.library.clone(),
            ..Compiler::new((self.graph, self.facts), self.catalogue, options)
        }
    }
}

/// What is averaged without its derivative: closed forms know more of its slopes.
fn unsloped(bundle: Bundle<'_>) -> Bundle<'_> {
    let signals = bundle.into_iter();
    signals.map(|signal| signal.with_slope(None)).collect()
}

impl<'b> Lower<'_, 'b> {
    /// Records what the node, just lowered to `closed`, is a function of; its bundle by fusion,
    /// where that is better than closing it alone.
    pub(super) fn fuse(
        &mut self,
        index: usize,
        node: &Node,
        closed: &[Signal<'b>],
    ) -> Option<Bundle<'b>> {
        // What looks at other places than its own is no function of the signals here, and a source
        // varies within a step of any table.
        if !self.algebra.mode.spreads() || self.reads_elsewhere || is_source(node) {
            return None;
        }
        let pair = self.fuse_pair(index, node, closed);
        if pair.is_some() {
            return pair.map(unsloped);
        }
        let before = self.chain(node)?;
        let bends = before.bends + u32::from(self.algebra.bent);
        if let (Some(period), true) = (
            self.algebra.period.filter(|_| self.algebra.bent),
            before.bends == 0 && before.domain().is_none(),
        ) {
            // A wave of something unbounded: whatever follows is a function of the phase alone.
            self.chains[index] = self.wave(node, period);
            return None;
        }
        // An affine function of a Gaussian that a parameter shapes is the entry of what follows.
        if bends == 0 && !before.fixed && self.enters(index, &before, closed) {
            return None;
        }
        // Beyond this many bends the result is the entry of what follows: a chain of 10,000 nodes
        // stays linear.
        if bends < LONGEST {
            self.chains[index] = Some(Chain {
                bends,
                ..before.clone()
            });
        }
        let long = self.algebra.knots > MOST_KNOTS;
        if !self.algebra.bent || (before.bends == 0 && !long) {
            return None;
        }
        match before.domain() {
            Some(domain) if before.fixed => {
                Some(self.tabulated(index, closed, node, &before, domain))
            }
            _ if before.bends > 0 => self.tapped(index, closed, &before).map(unsloped),
            _ => None,
        }
    }

    /// The chain that a periodic function of a scalar begins.
    fn wave(&self, node: &Node, period: f32) -> Option<Chain<'b>> {
        let mut entry = None;
        let mut fixed = true;
        for input in &node.inputs {
            match input.source {
                Source::Literal(_) => {}
                Source::Parameter(_) => fixed = false,
                Source::Node(id) if entry.is_none() => entry = Some(id),
                Source::Node(_) | Source::Surface => return None,
            }
        }
        let bundle = self.bundles[entry?.index()].as_ref()?;
        let [signal] = &bundle[..] else { return None };
        Some(Chain {
            entry: entry?,
            signal: Rc::new(signal.clone()),
            bends: 1,
            fixed,
            period: Some(period),
        })
    }

    /// The one signal that all varying inputs of a node are functions of.
    fn chain(&self, node: &Node) -> Option<Chain<'b>> {
        let mut chain: Option<Chain<'b>> = None;
        let mut fixed = true;
        for input in &node.inputs {
            let id = match &input.source {
                Source::Literal(_) => continue,
                Source::Parameter(_) => {
                    fixed = false;
                    continue;
                }
                // Only where a coordinate is read: unused defaults are literals.
                Source::Surface => return None,
                Source::Node(id) => *id,
            };
            let this = match self.known(id)? {
                Known::Function(chain) => chain,
                // A number: what hangs on a parameter, even one that drops out of it, cannot be
                // computed apart from the parameters.
                Known::Certain { literal } => {
                    fixed &= literal;
                    continue;
                }
                Known::Opaque | Known::Placed => return None,
            };
            fixed &= this.fixed;
            chain = Some(match chain {
                None => this,
                Some(other) if other.entry == this.entry => Chain {
                    bends: other.bends.max(this.bends),
                    ..other
                },
                Some(_) => return None,
            });
        }
        chain.map(|chain| Chain { fixed, ..chain })
    }

    /// What an input is known to be; `None` where it is not there.
    pub(super) fn known(&self, id: NodeId) -> Option<Known<'b>> {
        if let Some(chain) = &self.chains[id.index()] {
            return Some(Known::Function(chain.clone()));
        }
        let bundle = self.bundles[id.index()].as_ref()?;
        Some(if bundle.iter().all(Signal::is_certain) {
            // A noise without an amplitude is read at a place, but is the same everywhere.
            let same =
                |signal: &Signal<'b>| signal.cell.is_none() && signal.mean.as_constant().is_some();
            if self.compiler.facts.placed[id.index()] && !bundle.iter().all(same) {
                Known::Placed
            } else {
                Known::Certain {
                    literal: self.compiler.facts.literal[id.index()],
                }
            }
        } else if let [signal] = &bundle[..] {
            Known::Function(Chain {
                entry: id,
                signal: Rc::new(signal.clone()),
                bends: 0,
                fixed: true,
                period: None,
            })
        } else {
            Known::Opaque
        })
    }

    fn tabulated(
        &mut self,
        index: usize,
        closed: &[Signal<'b>],
        node: &Node,
        chain: &Chain<'b>,
        domain: [f32; 2],
    ) -> Bundle<'b> {
        let compiler = self.compiler;
        let (entry, periodic) = (chain.entry, chain.period.is_some());
        // Regions of one shape are one function with one table, whose nodes come first.
        let nodes = region(compiler, index, &[entry]);
        let shape = shape::shape(compiler, &[entry], &nodes).map(|mut shape| {
            shape.extend(domain.map(f32::to_bits));
            shape.push(u32::from(periodic));
            shape
        });
        let (index, entry) = match &shape {
            Some(shape) => {
                *(compiler.shapes.borrow_mut().entry(shape.clone())).or_insert((index, entry))
            }
            None => (index, entry),
        };
        // What a pyramid is of: programs that have the same one share it.
        let pyramids_of = |samples: &Samples, component: usize, rises: bool| {
            let shape = shape.clone().map(|mut shape| {
                shape.extend([PYRAMIDS, component as u32, u32::from(rises)]);
                shape
            });
            baked(shape, || pyramids(samples, component))
        };
        let known = compiler.fused.borrow().get(&index).cloned();
        let samples = known.unwrap_or_else(|| {
            let samples = sample(compiler, index, entry, (domain, periodic), closed.len());
            compiler
                .fused
                .borrow_mut()
                .insert(index, Arc::clone(&samples));
            samples
        });
        let name = super::identifier(&node.name);
        let function = self.function(&format!("fused {index}"), |module| {
            function(compiler, module, index, entry)
        });
        let branch = Branch(self.function(&format!("fused {index} branch"), |module| {
            Branch::of_numbers(module, &name, &function, 1).0
        }));
        (closed.iter().enumerate())
            .map(|(i, signal)| {
                let name = if closed.len() > 1 {
                    format!("{name}_{i}")
                } else {
                    name.clone()
                };
                let key = format!("fused {index} {i}");
                let key_of_rise = format!("{key} rise");
                let known = compiler.tabulated.borrow().get(&key).cloned();
                let table = known.unwrap_or_else(|| {
                    let of = (function.clone(), branch.clone(), i);
                    let bounds = (domain, periodic, signal.range);
                    let pyramids = pyramids_of(&samples, i, false);
                    let table = Tabulated::new(self.module, &name, of, bounds, pyramids);
                    (compiler.tabulated.borrow_mut()).insert(key, table.clone());
                    table
                });
                let mut table = table.within(signal.range);
                if self.algebra.derives() {
                    let of = (&function, i, closed.len());
                    let pyramids = |rises: &Samples| pyramids_of(rises, i, true);
                    let of = (of, (domain, periodic));
                    let rise = self.rise((&key_of_rise, &name), of, &samples, pyramids);
                    table = table.with_rise(rise);
                }
                self.algebra.transfer(&chain.signal, &table)
            })
            .collect()
    }

    /// The derivative of a component of a fused function, as a transfer by tables of its own.
    fn rise(
        &mut self,
        (key, name): (&str, &str),
        ((function, component, components), (domain, periodic)): (
            (&FunctionRef, usize, usize),
            ([f32; 2], bool),
        ),
        samples: &Samples,
        pyramids: impl FnOnce(&Samples) -> Pyramids,
    ) -> Tabulated {
        if let Some(known) = self.compiler.tabulated.borrow().get(key) {
            return known.clone();
        }
        let width = domain[1] - domain[0];
        let name = format!("{name}_rise");
        let rise = self.function(key, |module| {
            let b = &Builder::new(format!("{name}_of"), "How a function of one signal rises.");
            let x = b.float_param("x");
            let step = width * (1.0 / 4096.0);
            let [above, below] = [step, -step].map(|by| b.call(function, x + by));
            for (i, (above, below)) in above.into_iter().zip(below).take(components).enumerate() {
                b.result(format!("value_{i}"), (above - below) * (0.5 / step));
            }
            b.finish(module)
        });
        let branch = Branch(self.function(&format!("{key} branch"), |module| {
            Branch::of_numbers(module, &name, &rise, 1).0
        }));
        let samples = Arc::clone(samples);
        let rises: Samples = Arc::new(LazyLock::new(Box::new(move || {
            let width = f64::from(width);
            samples.iter().map(|sampled| sampled.rise(width)).collect()
        })));
        let bounds = (domain, periodic, [f32::NEG_INFINITY, f32::INFINITY]);
        let table = Tabulated::new(
            self.module,
            &name,
            (rise, branch, component),
            bounds,
            pyramids(&rises),
        );
        (self.compiler.tabulated.borrow_mut()).insert(key.to_owned(), table.clone());
        table
    }
}

/// The nodes from `entries` (exclusive) to `index`, inputs first.
pub(super) fn region(compiler: &Compiler<'_>, index: usize, entries: &[NodeId]) -> Vec<usize> {
    regions(compiler, &[index], entries)
}

/// The same of several nodes, each once.
pub(super) fn regions(compiler: &Compiler<'_>, ends: &[usize], entries: &[NodeId]) -> Vec<usize> {
    let mut region = ends.to_vec();
    let mut seen: rustc_hash::FxHashSet<usize> = entries.iter().map(|e| e.index()).collect();
    seen.extend(ends);
    let mut next = 0;
    while next < region.len() {
        for input in &compiler.graph.nodes[region[next]].inputs {
            if let Source::Node(id) = input.source
                && seen.insert(id.index())
            {
                region.push(id.index());
            }
        }
        next += 1;
    }
    region.sort_unstable();
    region
}

/// The region as a function of the entry's value.
fn function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    index: usize,
    entry: NodeId,
) -> FunctionRef {
    let graph = compiler.graph;
    let name = super::identifier(&graph.nodes[index].name);
    let b = &Builder::new(format!("{name}_of"), "A function of one signal.");
    let argument = Signal::certain(b.float_param("x"));
    let arguments = Arguments::without_place(b, compiler.graph, Vec::new());
    let mut lower = Lower::with(compiler, module, Algebra::new(b, Mode::Point), arguments);
    lower.bundles[entry.index()] = Some(vec![argument]);
    for node in region(compiler, index, &[entry]) {
        let definition = &compiler.catalogue[graph.nodes[node].definition];
        let bundle = (definition.lower)(&mut lower, &graph.nodes[node]);
        lower.bundles[node] = Some(bundle);
    }
    let bundle = lower.bundles[index]
        .take()
        .expect("the region ends at the node");
    value_results(b, &bundle);
    b.finish(module)
}

/// The region's values over a domain, to be computed when a table of them is read.
fn sample(
    compiler: &Compiler<'_>,
    index: usize,
    entry: NodeId,
    (domain, periodic): ([f32; 2], bool),
    components: usize,
) -> Samples {
    let mut module = Module::default();
    let alone = compiler.with_options(compiler.options);
    function(&alone, &mut module, index, entry);
    Arc::new(LazyLock::new(Box::new(move || {
        let points = sample_points(domain);
        let mut values = Vec::new();
        let evaluator = Evaluator::<f64>::new(&module);
        let inputs = [Input::Floats(&points)];
        evaluator.evaluate(&mut Scratch::new(), &inputs, points.len(), &mut values);
        values.truncate(components);
        values
            .into_iter()
            .map(|values| Sampled::new(values, periodic))
            .collect()
    })))
}
