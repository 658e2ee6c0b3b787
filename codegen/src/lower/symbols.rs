//! Who reads what, and who carries which symbol.

use super::Bundle;
use crate::ir::Builder;
use crate::moments::Symbol;
use mipless_graph::{Graph, OutputType, Source};
use rustc_hash::FxHashMap;

/// A signal carries at most this many symbols; the oldest go private first, so that a graph of
/// 10,000 nodes stays linear.
const MOST: usize = 8;

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

/// How many live nodes carry each symbol. A symbol is its own only while several do: from the fork
/// where it was born to where its paths have met.
#[derive(Debug, Default)]
pub(super) struct Carriers {
    counts: FxHashMap<Symbol, u32>,
}

fn symbols(bundle: &Bundle) -> Vec<Symbol> {
    let mut all: Vec<Symbol> = bundle
        .iter()
        .flat_map(|signal| signal.shared.iter().map(|&(s, _)| s))
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

impl Carriers {
    pub(super) fn born(&mut self, bundle: &Bundle) {
        for symbol in symbols(bundle) {
            *self.counts.entry(symbol).or_default() += 1;
        }
    }

    pub(super) fn died(&mut self, bundle: &Bundle) {
        for symbol in symbols(bundle) {
            if let Some(count) = self.counts.get_mut(&symbol) {
                *count -= 1;
            }
        }
    }

    /// Folds into private variance what only this bundle carries (and, where its components are
    /// `crossed` later, only one of them), but for the symbols from `kept` on, and whatever exceeds
    /// the limit.
    pub(super) fn retire(
        &mut self,
        b: &mut Builder,
        bundle: &mut Bundle,
        kept: Symbol,
        crossed: bool,
    ) {
        for symbol in symbols(bundle) {
            let only = self.counts.get(&symbol) == Some(&1);
            let holders = bundle
                .iter()
                .filter(|s| s.coefficient(symbol).is_some())
                .count();
            if only && (holders == 1 || !crossed) && symbol < kept {
                for signal in bundle.iter_mut() {
                    signal.retire(b, symbol);
                }
                self.counts.remove(&symbol);
            }
        }
        for signal in bundle.iter_mut() {
            while signal.shared.len() > MOST {
                let oldest = signal.shared[0].0;
                signal.retire(b, oldest);
            }
        }
    }
}
