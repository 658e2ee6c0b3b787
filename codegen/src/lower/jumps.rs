//! Where a height jumps whose slopes are asked for: a jump's slope has no variance, and what is counted is
//! a lower bound.

use super::function::graph_function;
use super::{Compiler, Facts, Lower, NodeDef, Options};
use crate::ir::Module;
use crate::moments::{Mode, Signal};
use mipless_graph::{Checked, NodeId};

/// The nodes at which the heights of a graph's materials jump, in the graph's order; none where nothing
/// that is read depends on slopes.
///
/// # Panics
/// If `catalogue` is not the one that the graph was resolved with.
pub fn jumps(checked: &Checked, catalogue: &[NodeDef]) -> Vec<NodeId> {
    let graph = checked.graph();
    if graph.materials.is_empty() {
        return Vec::new();
    }
    let facts = Facts::of(graph);
    let options = Options::default();
    let compiler = Compiler::new((graph, &facts), catalogue, &options);
    graph_function(&compiler, &mut Module::default(), Mode::Local, "jumps");
    let found = compiler.jumps.into_inner();
    found.into_iter().map(|node| NodeId(node as u32)).collect()
}

impl<'b> Lower<'_, 'b> {
    /// Whether the node at work has made something jump whose slopes are asked for: by its rule, or because
    /// it takes two values and gives no slopes.
    pub(super) fn jumps(&self, bundle: &[Signal<'b>]) -> bool {
        let is_step = |signal: &Signal<'b>| signal.binary.is_some() && signal.slope.is_none();
        self.algebra.derives() && (self.algebra.jumped || bundle.iter().any(is_step))
    }
}
