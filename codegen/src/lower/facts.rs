//! What is known of a graph before it is lowered.

use super::{drawn, mixture, order, sampled, symbols, torus};
use mipless_graph::Graph;
use rustc_hash::FxHashMap;

/// What is known of a graph's nodes before they are lowered.
pub(super) struct Facts {
    /// How many live edges read each node's output.
    pub(super) live: Vec<u32>,
    /// The live nodes in the order in which they are lowered.
    pub(super) order: Vec<u32>,
    /// Whether components of each node's output are combined later.
    pub(super) crossed: Vec<bool>,
    /// Whether literals alone shape each node's output.
    pub(super) literal: Vec<bool>,
    /// The nodes that `auto` samples.
    pub(super) sampled: FxHashMap<usize, sampled::Sampling>,
    /// The nodes that repeat, which `auto` reads from maps.
    pub(super) repeated: FxHashMap<usize, torus::Repeated>,
    /// Whether these are tried: means over many points take the place of maps, which take far longer
    /// to bake than an audit does.
    pub(super) rehearses: bool,
    /// The nodes that `auto` draws to their means.
    pub(super) drawn: FxHashMap<usize, drawn::Drawn>,
    /// Whether the surface's place shapes each node's output.
    pub(super) placed: Vec<bool>,
    /// Whether it is asked what slopes have in common with other signals, and on what share they are.
    pub(super) joint: bool,
    /// The nodes that are functions of things.
    pub(super) mixtures: mixture::Mixtures,
}

impl Facts {
    pub(super) fn of(graph: &Graph) -> Self {
        let live = symbols::live(graph);
        Self {
            order: order::order(graph, &live),
            crossed: symbols::crossed(graph),
            literal: symbols::literal(graph),
            sampled: FxHashMap::default(),
            repeated: FxHashMap::default(),
            rehearses: false,
            drawn: FxHashMap::default(),
            placed: symbols::placed(graph),
            joint: symbols::joint(graph, &live),
            mixtures: mixture::Mixtures::default(),
            live,
        }
    }
}
