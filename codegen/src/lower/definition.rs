//! What codegen knows of a node type.

use super::{Bundle, Lower};
use crate::moments::Signal;
use mipless_graph::{Node, NodeSpec};

/// How the image that is asked for ([`Lower::image`]) is summed over the whole parts that one
/// coordinate or two have in the footprint.
pub type SumOfSteps = for<'b> fn(&mut Lower<'_, 'b>, &[Signal<'b>]) -> Vec<Signal<'b>>;

/// A node type: its spec, which holds its statistics rule, and its lowering.
#[derive(Clone, Copy, Debug)]
pub struct NodeDef {
    /// Everything but the lowering.
    pub spec: &'static NodeSpec,
    /// Builds the node's output: as many signals as its type has components.
    pub lower: for<'b> fn(&mut Lower<'_, 'b>, &Node) -> Bundle<'b>,
    /// Whether a node of the type gives each of many things (cells, regions, bricks) a random number:
    /// its lowering sums any function of the numbers over them ([`Lower::image`]).
    pub things: fn(&Node) -> bool,
    /// Of nodes that are a function of whole parts alone, one for each component, which they take by
    /// [`Algebra::floor`](crate::moments::Algebra::floor).
    pub steps: Option<SumOfSteps>,
}

impl NodeDef {
    /// A node that knows of no things.
    pub const fn new(
        spec: &'static NodeSpec,
        lower: for<'b> fn(&mut Lower<'_, 'b>, &Node) -> Bundle<'b>,
    ) -> Self {
        Self {
            spec,
            lower,
            things: |_| false,
            steps: None,
        }
    }

    /// One that gives things numbers where this holds.
    pub const fn of_things(self, things: fn(&Node) -> bool) -> Self {
        Self { things, ..self }
    }

    /// One that is a function of whole parts alone.
    pub const fn of_steps(self, sum: SumOfSteps) -> Self {
        Self {
            steps: Some(sum),
            ..self
        }
    }
}
