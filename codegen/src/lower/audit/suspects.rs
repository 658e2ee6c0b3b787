//! What of a graph may be wrong, and what may take its place.

use super::super::bands::Bands;
use super::super::sampled::Sampling;
use super::super::torus::{self, Repeated};
use super::super::{Compiler, Facts, NodeDef, Options, program, symbols};
use super::places::Places;
use super::truth::{Errors, GLANCE, Truth, values};
use super::verdict::{Verdict, is_off, is_worse};
use mipless_graph::{Checked, Class, Graph, NodeId, Output, Source, Type};
use rustc_hash::FxHashMap;

/// The most nodes among which the beginning of an error is looked for.
const SEARCHED: usize = 2000;

/// Whether no input of the graph shapes each node.
pub(super) fn steady(graph: &Graph) -> Vec<bool> {
    let mut steady: Vec<bool> = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        steady.push(node.inputs.iter().all(|input| match input.source {
            Source::Node(id) => steady[id.index()],
            Source::Parameter(_) => false,
            Source::Literal(_) | Source::Surface => true,
        }));
    }
    steady
}

/// Which outputs depend on each node.
pub(super) fn readers(graph: &Graph) -> Vec<Vec<usize>> {
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); graph.nodes.len()];
    for (index, output) in graph.outputs.iter().enumerate() {
        readers[output.node.index()].push(index);
    }
    for index in (0..graph.nodes.len()).rev() {
        let own = std::mem::take(&mut readers[index]);
        for input in &graph.nodes[index].inputs {
            if let Source::Node(id) = input.source {
                let of_input = &mut readers[id.index()];
                of_input.extend(&own);
                of_input.sort_unstable();
                of_input.dedup();
            }
        }
        readers[index] = own;
    }
    readers
}

/// The nodes whose own error is too large while those of their inputs are not.
pub(super) fn beginnings(
    places: &Places,
    graph: &Graph,
    catalogue: &[NodeDef],
    options: &Options,
    facts: &Facts,
    steady: &[bool],
) -> FxHashMap<usize, Sampling> {
    let uses = facts.mixtures.live(graph);
    let live: Vec<usize> = (0..graph.nodes.len())
        .filter(|&index| uses[index] > 0)
        .collect();
    let numbers = |ty: Type| !matches!(ty, Type::String | Type::Filename);
    if live.len() > SEARCHED {
        return FxHashMap::default();
    }
    let mut every = graph.clone();
    every.outputs = (live.iter())
        .filter(|&&index| numbers(graph.nodes[index].ty))
        .map(|&index| Output {
            name: format!("n{index}"),
            node: NodeId(index as u32),
            ty: graph.nodes[index].ty,
        })
        .collect();
    let facts = Facts {
        repeated: facts.repeated.clone(),
        mixtures: facts.mixtures.clone(),
        rehearses: facts.rehearses,
        ..Facts::of(&every)
    };
    let facts = &facts;
    let truth = Truth::of(GLANCE, places, &every, catalogue, options, facts);
    let (point, floor) = (truth.errors(&truth.point), truth.floor());
    let found = values(
        &program(&every, catalogue, options, facts),
        &places.footprints,
    );
    let closed = truth.errors(&found);
    let bad: FxHashMap<usize, bool> = (every.outputs.iter().enumerate())
        .map(|(output, of)| {
            let bad = (0..Bands::COUNT).any(|band| {
                let [closed, point, floor] =
                    [&closed, &point, &floor].map(|errors| errors[output][band]);
                is_off(closed, floor) || is_worse(closed, point, floor)
            });
            (of.node.index(), bad)
        })
        .collect();
    let is_bad = |id: NodeId| bad.get(&id.index()) == Some(&true);
    (every.outputs.iter().enumerate())
        .filter(|(_, output)| is_bad(output.node))
        .filter(|(_, output)| {
            let mut reads = facts.mixtures.reads(graph, output.node.index());
            !reads.any(is_bad)
        })
        .map(|(index, output)| {
            let node = output.node.index();
            (node, truth.sampling(index, steady[node], &found))
        })
        .collect()
}

/// The nodes of the outputs whose error is too large, of which these are the values in closed form.
pub(super) fn ends(
    graph: &Graph,
    (truth, found): (&Truth<'_>, &[Vec<f32>]),
    [closed, point, floor]: [&Errors; 3],
    steady: &[bool],
) -> FxHashMap<usize, Sampling> {
    (graph.outputs.iter().enumerate())
        .filter(|(index, _)| {
            let one = |errors: &Errors| vec![errors[*index]];
            !Verdict::of(&one(closed), &one(point), &one(floor)).is_good()
        })
        .map(|(index, output)| {
            let node = output.node.index();
            (node, truth.sampling(index, steady[node], found))
        })
        .collect()
}

/// The periods of what depends on position alone, as far as anything does.
pub(super) fn repeated(
    bands: Bands,
    checked: &Checked,
    catalogue: &[NodeDef],
    options: &Options,
    facts: &Facts,
) -> FxHashMap<usize, Repeated> {
    let graph = checked.graph();
    if symbols::reads_position(graph) {
        return FxHashMap::default();
    }
    let steady = steady(graph);
    let of_position: Vec<bool> = (checked.signals().iter().enumerate())
        .map(|(index, signal)| {
            let sources = &signal.sources;
            let curved = !matches!(signal.class, Class::Constant | Class::Gaussian { .. });
            let alone = sources.position() && sources.nodes().is_empty();
            alone && curved && steady[index] && facts.live[index] > 0
        })
        .collect();
    let compiler = Compiler::new((graph, facts), catalogue, options);
    (torus::tops(&compiler, &of_position).into_iter())
        .filter_map(|index| {
            let repeated = Repeated {
                periods: torus::found(&compiler, index)?,
                within: Bands::ALL,
                bands,
            };
            Some((index, repeated))
        })
        .collect()
}
