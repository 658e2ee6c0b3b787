//! Topological order, and cycles with all their members.

use std::collections::VecDeque;

use petgraph::algo::{kosaraju_scc, toposort};
use petgraph::graph::{DiGraph, NodeIndex};
use rustc_hash::{FxHashMap, FxHashSet};

use super::Context;
use super::template::{Kind, Template, Wire, position_u32};
use crate::Diagnostic;

/// The order of `count` things in which what is needed comes first, and the cycles, each as its
/// members from one to the next that it needs. What lies on a cycle is in the order too, anywhere.
pub(super) fn order(count: usize, needs: &[(u32, u32)]) -> (Vec<u32>, Vec<Vec<u32>>) {
    // Edges go from what is needed to who needs it.
    let mut graph = DiGraph::<(), ()>::with_capacity(count, needs.len());
    for _ in 0..count {
        graph.add_node(());
    }
    for (user, needed) in needs {
        graph.add_edge(
            NodeIndex::new(*needed as usize),
            NodeIndex::new(*user as usize),
            (),
        );
    }
    if let Ok(sorted) = toposort(&graph, None) {
        return (
            sorted
                .into_iter()
                .map(|index| position_u32(index.index()))
                .collect(),
            Vec::new(),
        );
    }
    // Kosaraju's components come in reverse topological order, and without recursion.
    let components = kosaraju_scc(&graph);
    let mut sorted = Vec::with_capacity(count);
    let mut cycles = Vec::new();
    for component in components.iter().rev() {
        let members: Vec<u32> = component.iter().map(|i| position_u32(i.index())).collect();
        let alone = graph.find_edge(component[0], component[0]).is_none();
        if members.len() > 1 || !alone {
            cycles.push(shortest_cycle(&members, needs_of(&members, needs)));
        }
        sorted.extend(members);
    }
    cycles.sort_unstable();
    (sorted, cycles)
}

/// What each member needs of the other members.
fn needs_of(members: &[u32], needs: &[(u32, u32)]) -> FxHashMap<u32, Vec<u32>> {
    let inside: FxHashSet<u32> = members.iter().copied().collect();
    let mut of: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    for (user, needed) in needs {
        if inside.contains(user) && inside.contains(needed) {
            of.entry(*user).or_default().push(*needed);
        }
    }
    of
}

/// The shortest cycle through the first written of the members of a component.
fn shortest_cycle(members: &[u32], needs: FxHashMap<u32, Vec<u32>>) -> Vec<u32> {
    let start = members
        .iter()
        .copied()
        .min()
        .expect("a component has members");
    let mut reached_from: FxHashMap<u32, u32> = FxHashMap::default();
    let mut queue = VecDeque::from([start]);
    while let Some(node) = queue.pop_front() {
        for next in needs.get(&node).into_iter().flatten() {
            if *next == start {
                let mut path = vec![node];
                while let Some(previous) = reached_from.get(path.last().expect("not empty")) {
                    path.push(*previous);
                }
                path.reverse();
                return path;
            }
            if *next != start && !reached_from.contains_key(next) {
                reached_from.insert(*next, node);
                queue.push_back(*next);
            }
        }
    }
    unreachable!("every member of a strongly connected component lies on a cycle")
}

/// Orders the nodes of each template; nodes on a cycle are reported and broken.
pub(super) fn sort(context: &mut Context<'_>, templates: &mut [Template<'_>]) {
    for template in templates {
        let mut needs = Vec::new();
        for (index, node) in template.nodes.iter().enumerate() {
            for (_, wire) in &node.wires {
                if let Wire::Node(port) = wire {
                    needs.push((position_u32(index), port.node));
                }
            }
        }
        let (order, cycles) = order(template.nodes.len(), &needs);
        template.order = order;
        for cycle in cycles {
            let names: Vec<&str> = cycle
                .iter()
                .map(|node| template.nodes[*node as usize].name)
                .collect();
            let first = cycle[0] as usize;
            let mut diagnostic =
                Diagnostic::error("cycle", format!("the node `{}` needs itself", names[0]))
                    .at(template.node_pointer(first))
                    .in_node(names[0])
                    .help("take one of these connections away");
            diagnostic.because = links(&names, "needs");
            context.report(diagnostic);
            for node in cycle {
                template.nodes[node as usize].kind = Kind::Broken;
            }
        }
    }
}

/// One reason for each link of a cycle; very long ones are shortened in the middle.
pub(super) fn links(names: &[&str], verb: &str) -> Vec<String> {
    const SHOWN: usize = 64;
    let link = |i: usize| format!("`{}` {verb} `{}`", names[i], names[(i + 1) % names.len()]);
    if names.len() <= SHOWN {
        return (0..names.len()).map(link).collect();
    }
    let hidden = names.len() - SHOWN;
    let mut links: Vec<String> = (0..SHOWN / 2).map(link).collect();
    links.push(format!("… {hidden} more …"));
    links.extend((names.len() - SHOWN / 2..names.len()).map(link));
    links
}

#[cfg(test)]
mod tests {
    use super::order;

    #[test]
    fn what_is_needed_comes_first() {
        let (sorted, cycles) = order(4, &[(0, 1), (1, 3), (0, 2), (2, 3)]);
        assert!(cycles.is_empty());
        let place = |wanted| sorted.iter().position(|node| *node == wanted);
        assert!(place(3) < place(1) && place(3) < place(2) && place(1) < place(0));
    }

    #[test]
    fn every_component_gives_one_whole_cycle() {
        let (sorted, cycles) = order(6, &[(0, 1), (1, 2), (2, 0), (3, 3), (4, 0), (5, 4), (1, 5)]);
        assert_eq!(sorted.len(), 6);
        assert_eq!(cycles, [vec![0, 1, 2], vec![3]]);
    }
}
