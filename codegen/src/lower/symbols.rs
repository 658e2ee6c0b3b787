//! Who reads what, and who carries which symbol.

use super::{Bundle, Varying};
use crate::moments::{Signal, Symbol};
use mipless_graph::{Behaviour, Graph, Input, OutputType, Source, Type};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// A signal carries at most this many symbols; the oldest go private first, so that a graph of
/// 10,000 nodes stays linear.
pub(super) const MOST: usize = 8;

/// How many live edges (and outputs) read each node; 0 for a node that no output needs.
pub(super) fn live(graph: &Graph) -> Vec<u32> {
    let mut uses = vec![0u32; graph.nodes.len()];
    for output in &graph.outputs {
        uses[output.node.index()] += 1;
    }
    for (index, node) in graph.nodes.iter().enumerate().rev() {
        if uses[index] > 0 {
            for input in &node.inputs {
                if let Source::Node(id) = input.source {
                    uses[id.index()] += 1;
                }
            }
        }
    }
    uses
}

/// Whether a live node reads the surface's position in space: one whose class is the position, with
/// three components, or one with a port of three that defaults to it.
pub(super) fn reads_position(graph: &Graph) -> bool {
    let live = live(graph);
    graph.nodes.iter().zip(live).any(|(node, uses)| {
        let is_position =
            node.ty == Type::Vector3 && matches!((node.spec.class)(&Varying), Behaviour::Position);
        let reads = |input: &Input| input.source == Source::Surface && input.ty == Type::Vector3;
        uses > 0 && (is_position || node.inputs.iter().any(reads))
    })
}

/// Whether a live part of a material tells what slopes have in common with other signals.
pub(super) fn joint(graph: &Graph, live: &[u32]) -> bool {
    let mut nodes = graph.nodes.iter().zip(live);
    nodes.any(|(node, &uses)| uses > 0 && node.part().is_some_and(|part| part.is_joint))
}

/// Whether something that follows each node combines different components of it, so that what they
/// share matters; a node whose inputs and output are all of one polymorphic type does not.
pub(super) fn crossed(graph: &Graph) -> Vec<bool> {
    let mut crossed = vec![false; graph.nodes.len()];
    for (index, node) in graph.nodes.iter().enumerate().rev() {
        let componentwise = node.spec.output == OutputType::Widest;
        for input in &node.inputs {
            if let Source::Node(id) = input.source {
                crossed[id.index()] |= crossed[index] || !componentwise;
            }
        }
    }
    crossed
}

/// Whether literals alone shape each node: no surface and no live parameter.
pub(super) fn literal(graph: &Graph) -> Vec<bool> {
    let mut literal = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        let alone = node.inputs.iter().all(|input| match &input.source {
            Source::Literal(_) => true,
            Source::Node(id) => literal[id.index()],
            Source::Surface | Source::Parameter(_) => false,
        });
        literal.push(alone);
    }
    literal
}

/// Whether the surface's place shapes each node.
pub(super) fn placed(graph: &Graph) -> Vec<bool> {
    let mut placed = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        let reads = node.inputs.iter().any(|input| match &input.source {
            Source::Surface => true,
            Source::Node(id) => placed[id.index()],
            Source::Literal(_) | Source::Parameter(_) => false,
        });
        let is_place = matches!((node.spec.class)(&Varying), Behaviour::Position);
        placed.push(reads || is_place);
    }
    placed
}

/// How many live nodes carry each symbol. A symbol is its own only while several do: from the fork
/// where it was born to where its paths have met.
#[derive(Debug, Default)]
pub(super) struct Carriers {
    counts: FxHashMap<Symbol, u32>,
}

/// Some symbols, in order.
type Symbols = SmallVec<[Symbol; 16]>;

/// The symbols that a bundle's signals carry.
fn carried(bundle: &[Signal<'_>]) -> Symbols {
    distinct(bundle, false)
}

/// The same with those of their second Hermite polynomials, which a transfer of them carries.
fn held(bundle: &[Signal<'_>]) -> Symbols {
    distinct(bundle, true)
}

fn distinct(bundle: &[Signal<'_>], hermites: bool) -> Symbols {
    let mut all = Symbols::new();
    for signal in bundle {
        for &(symbol, _) in &signal.shared {
            all.push(symbol);
        }
        if let Some(symbol) = signal.hermite.filter(|_| hermites) {
            all.push(symbol);
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}

impl Carriers {
    pub(super) fn born(&mut self, bundle: &[Signal<'_>]) {
        for symbol in held(bundle) {
            *self.counts.entry(symbol).or_default() += 1;
        }
    }

    /// A symbol that a bundle which is born already holds from now on.
    pub(super) fn gained(&mut self, symbol: Symbol) {
        *self.counts.entry(symbol).or_default() += 1;
    }

    pub(super) fn died(&mut self, bundle: &[Signal<'_>]) {
        for symbol in held(bundle) {
            if let Some(count) = self.counts.get_mut(&symbol) {
                *count -= 1;
            }
        }
    }

    /// Folds into private variance what only this bundle carries (and, where its components are
    /// `crossed` later, only one of them), and whatever exceeds the limit. Of the symbols from `kept`
    /// on, which several nodes are about to read, it makes one.
    pub(super) fn retire(&mut self, bundle: &mut Bundle<'_>, kept: Symbol, crossed: bool) {
        let mut merged = Vec::new();
        for symbol in carried(bundle) {
            let only = self.counts.get(&symbol) == Some(&1);
            let holders = bundle
                .iter()
                .filter(|s| s.coefficient(symbol).is_some())
                .count();
            if only && (holders == 1 || !crossed) {
                if symbol < kept {
                    for signal in bundle.iter_mut() {
                        signal.retire(symbol);
                    }
                    self.counts.remove(&symbol);
                } else {
                    merged.push(symbol);
                }
            }
        }
        for signal in bundle.iter_mut() {
            signal.merge(&merged);
            while signal.shared.len() > MOST {
                let oldest = signal.shared[0].0;
                signal.retire(oldest);
            }
        }
    }
}
