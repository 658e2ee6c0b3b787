//! In which order nodes are lowered: so that few signals wait for their readers at any time.
//!
//! Long functions are cut into parts, and what lives across a cut is passed from part to part. A
//! depth-first order from the outputs computes every input just before its reader; of the inputs of
//! one node, the one that needs the most room comes first, since what is done waits while the others
//! are computed (Sethi & Ullman 1970, *The generation of optimal code for arithmetic expressions*;
//! optimal for trees).

use mipless_graph::{Graph, Source};

/// The live nodes, inputs first.
pub(super) fn order(graph: &Graph, live: &[u32]) -> Vec<u32> {
    let count = graph.nodes.len();
    let size = |index: usize| graph.nodes[index].ty.components() as u32;
    // Each node's inputs, the one to compute first at the front.
    let mut inputs: Vec<u32> = Vec::with_capacity(2 * count);
    let mut ends = vec![0; count];
    // How many components are alive, at most, while the node is computed.
    let mut room: Vec<u32> = vec![0; count];
    for (index, node) in graph.nodes.iter().enumerate() {
        let start = inputs.len();
        if live[index] > 0 {
            inputs.extend(node.inputs.iter().filter_map(|input| match input.source {
                Source::Node(id) => Some(id.index() as u32),
                _ => None,
            }));
            let own = &mut inputs[start..];
            own.sort_by_key(|&i| size(i as usize) as i32 - room[i as usize] as i32);
            let mut waiting = 0;
            for &input in &*own {
                room[index] = room[index].max(room[input as usize].saturating_add(waiting));
                waiting += size(input as usize);
            }
            // Far below what an i32 holds, so that differences are ordered.
            room[index] = room[index].max(waiting).max(size(index)).min(1 << 30);
        }
        ends[index] = inputs.len();
    }
    let mut outputs: Vec<u32> = graph
        .outputs
        .iter()
        .map(|o| o.node.index() as u32)
        .collect();
    outputs.sort_by_key(|&i| size(i as usize) as i32 - room[i as usize] as i32);

    let mut order = Vec::with_capacity(count);
    let mut seen = vec![false; count];
    let mut pending: Vec<(u32, usize)> = Vec::new();
    let first = |index: usize| if index == 0 { 0 } else { ends[index - 1] };
    for output in outputs {
        if std::mem::replace(&mut seen[output as usize], true) {
            continue;
        }
        pending.push((output, first(output as usize)));
        while let Some((node, next)) = pending.last_mut() {
            if *next == ends[*node as usize] {
                order.push(*node);
                pending.pop();
                continue;
            }
            let input = inputs[*next];
            *next += 1;
            if !std::mem::replace(&mut seen[input as usize], true) {
                pending.push((input, first(input as usize)));
            }
        }
    }
    order
}
