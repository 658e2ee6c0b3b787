//! How sub-graphs contain one another: no sub-graph in itself, not too deep, and not too many nodes
//! in all, which is known before anything is expanded.

use super::order::{links, order};
use super::template::{Kind, Template, position_u32};
use super::{Context, MAX_NESTING, MAX_NODES};
use crate::Diagnostic;

/// Reports recursion (the nodes that would recurse are broken) and limits. Whether the graph may be
/// expanded.
pub(super) fn check(context: &mut Context<'_>, templates: &mut [Template<'_>]) -> bool {
    let mut contains = Vec::new();
    for (user, template) in templates.iter().enumerate() {
        for node in &template.nodes {
            if let Kind::Graph(used) = node.kind {
                contains.push((position_u32(user), position_u32(used)));
            }
        }
    }
    // One edge for each pair: a cycle has no use for more.
    contains.sort_unstable();
    contains.dedup();
    let (sorted, cycles) = order(templates.len(), &contains);
    for cycle in &cycles {
        let names: Vec<&str> = cycle
            .iter()
            .map(|graph| templates[*graph as usize].name)
            .collect();
        let next = cycle[1 % cycle.len()] as usize;
        let template = &templates[cycle[0] as usize];
        let node = template
            .nodes
            .iter()
            .position(|node| node.kind == Kind::Graph(next));
        let node = node.expect("a link of the cycle is a node");
        let message = format!("the sub-graph `{}` contains itself", names[0]);
        let mut diagnostic = Diagnostic::error("recursive-graph", message)
            .at(format!("{}/type", template.node_pointer(node)))
            .in_node(template.nodes[node].name)
            .help("sub-graphs are expanded where they are used, which would never end");
        diagnostic.because = links(&names, "contains");
        context.report(diagnostic);
    }
    if !cycles.is_empty() {
        break_links(templates, &sorted);
    }
    count(context, templates, &sorted)
}

/// Breaks each node whose sub-graph does not come before the sub-graph that it stands in: that
/// leaves no cycle.
fn break_links(templates: &mut [Template<'_>], sorted: &[u32]) {
    let mut place = vec![0; templates.len()];
    for (position, template) in sorted.iter().enumerate() {
        place[*template as usize] = position;
    }
    for (user, template) in templates.iter_mut().enumerate() {
        for node in &mut template.nodes {
            if let Kind::Graph(used) = node.kind
                && place[used] >= place[user]
            {
                node.kind = Kind::Broken;
            }
        }
    }
}

/// Counts the nodes and the depth of every template from the innermost outwards.
fn count(context: &mut Context<'_>, templates: &[Template<'_>], sorted: &[u32]) -> bool {
    let mut nodes = vec![0_u64; templates.len()];
    let mut depth = vec![0_usize; templates.len()];
    // The sub-graph that contributes the most, and how often it is used.
    let mut largest = vec![(0_u64, 0_usize); templates.len()];
    for position in sorted {
        let position = *position as usize;
        for node in &templates[position].nodes {
            let more = match node.kind {
                Kind::Graph(used) => {
                    depth[position] = depth[position].max(depth[used] + 1);
                    largest[position] = largest[position].max((nodes[used], used));
                    nodes[used]
                }
                // The limit holds whether or not the node is otherwise right.
                Kind::Spec(_) | Kind::Broken => node.outputs.len().max(1) as u64,
            };
            nodes[position] = nodes[position].saturating_add(more);
        }
    }
    let mut fits = true;
    if nodes[0] > MAX_NODES {
        let total = nodes[0];
        let message = format!("the graph expands to {total} nodes; the limit is {MAX_NODES}");
        let mut diagnostic = Diagnostic::error("too-many-nodes", message)
            .at("/nodes")
            .help("use fewer copies of the sub-graphs, or smaller ones");
        let mut here = 0;
        for _ in 0..8 {
            let (count, next) = largest[here];
            if count <= 1 {
                break;
            }
            let uses = templates[here]
                .nodes
                .iter()
                .filter(|node| node.kind == Kind::Graph(next))
                .count();
            let outer = if here == 0 {
                "the graph".to_owned()
            } else {
                format!("`{}`", templates[here].name)
            };
            let inner = templates[next].name;
            let times = if uses == 1 {
                "once".to_owned()
            } else {
                format!("{uses} times")
            };
            let reason = format!("{outer} contains `{inner}` {times}, with {count} nodes each");
            diagnostic = diagnostic.because(reason);
            here = next;
        }
        context.report(diagnostic);
        fits = false;
    }
    if depth[0] > MAX_NESTING {
        let message = format!(
            "sub-graphs are nested {} levels deep; the limit is {MAX_NESTING}",
            depth[0]
        );
        context.report(Diagnostic::error("too-deep", message).at("/graphs"));
        fits = false;
    }
    fits
}
