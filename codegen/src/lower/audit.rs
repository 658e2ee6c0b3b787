//! The compiler audits itself: what it has made of a graph is compared with the truth on a few
//! footprints, and what is worse than no filter is sampled.
//!
//! The closed forms are exact for what they are made for; a stranger's graph may be something else.
//! So the program is evaluated on the CPU for [`Bands::COUNT`] sizes of pixels at a few places, those at
//! which it is most in doubt ([`places`]), and held against means of many points. Where an output is further off than a point, or by more than
//! a tolerance, ways are tried one after the other:
//!
//! 1. the closed form as it is;
//! 2. what depends on position alone and repeats by maps ([`super::torus`]);
//! 3. the nodes at which the error begins by points ([`super::sampled`]), what follows them closed;
//! 4. the outputs themselves by points;
//! 5. more points, of what is sampled already.
//!
//! Each node is sampled in the bands alone where that is better, and by more points where few still
//! miss the tolerance. What is left of an output's error
//! is then less where it is drawn to the mean of the texture ([`super::drawn`]). The result depends on the graph
//! alone, and is remembered by its shape ([`super::shape`]): an edit that changes nothing that
//! matters costs nothing.

mod display;
mod extent;
mod places;
mod settings;
mod suspects;
mod truth;
mod verdict;

use super::bands::Bands;
use super::drawn::{Drawn, Far};
use super::mixture::Mixtures;
use super::sampled::Sampling;
use super::shape::{Shape, shape};
use super::torus::Repeated;
use super::{Compiler, Facts, Method, NodeDef, Options, program};
use crate::ir::Program;
use extent::{Extent, extent};
use mipless_graph::{Checked, Class, Graph, NodeId};
use places::{LARGEST, Places, candidates};
use rustc_hash::FxHashMap;
use settings::Change;
use std::sync::{Arc, LazyLock, PoisonError, RwLock};
use suspects::{beginnings, ends, readers, repeated, steady};
use truth::{BIASED, Errors, GLANCE, LOOK, Truth, components, look, values};
use verdict::{BETTER_BY_POINTS, NOTICEABLE, TOLERANCE, Verdict, where_better};

/// Errors that are worth points: somewhat less than what an output may be off, so that bands beside
/// each other are filtered alike.
const SAMPLED: f64 = 0.8 * TOLERANCE;

/// The most nodes of a graph that is audited: an audit takes about as long as a picture of 500 × 500
/// points.
const MOST_NODES: usize = 4096;

/// The most graphs that a process remembers.
const MOST: usize = 1024;

/// What an audit has found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Audit {
    /// The outputs, with their errors; none where every rule is exact.
    pub outputs: Vec<AuditedOutput>,
    /// The nodes that `auto` does not close, in the order of the graph.
    pub replaced: Vec<Replaced>,
    /// Whether the graph has so many nodes that it was not measured.
    pub is_too_large: bool,
}

/// What `auto` does in place of a closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Remedy {
    /// The node depends on position alone and repeats: it is read from a map of its period.
    Repeated,
    /// The node is averaged over points inside the footprint.
    Sampled,
    /// The node is drawn to the mean of the texture.
    Drawn,
}

/// A node that `auto` does not close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replaced {
    /// The node.
    pub node: NodeId,
    /// What takes the place of its closed form.
    pub remedy: Remedy,
    /// From which to which size of pixel, in uv; 0 and infinity where it is any.
    pub sizes: [f32; 2],
}

/// The errors of an output, by bands of footprints.
#[derive(Clone, Debug, PartialEq)]
pub struct AuditedOutput {
    /// Its place among the graph's outputs.
    pub output: usize,
    /// Its errors, from the smallest footprints to the largest.
    pub bands: Vec<AuditedBand>,
}

impl AuditedOutput {
    /// The largest error of `auto` that is to be expected, as a display shows it: a third more than
    /// was measured at a few places beyond the noise of what was held to be true, and a little.
    pub fn predicted(&self) -> f64 {
        let beyond_noise = |band: &AuditedBand| (band.auto.powi(2) - band.floor.powi(2)).max(0.0);
        let largest = self.bands.iter().map(beyond_noise).fold(0.0, f64::max);
        1.33 * largest.sqrt() + 0.003
    }
}

/// Root mean square errors over a few places with footprints of one size, as a display shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AuditedBand {
    /// The shorter axis of the footprint, in uv a pixel.
    pub size: f32,
    /// Of a point.
    pub point: f64,
    /// Of the closed form.
    pub closed: f64,
    /// Of what `auto` does.
    pub auto: f64,
    /// Of what is held to be true.
    pub floor: f64,
}

/// What is decided for a graph.
#[derive(Debug, Default)]
struct Decision {
    mixtures: Mixtures,
    sampled: FxHashMap<usize, Sampling>,
    repeated: FxHashMap<usize, Repeated>,
    drawn: FxHashMap<usize, Drawn>,
    audit: Audit,
}

/// What this process has decided, by the shapes of graphs.
static KNOWN: LazyLock<RwLock<FxHashMap<Shape, Arc<Decision>>>> = LazyLock::new(RwLock::default);

/// The program of `auto`, with what its audit has found.
pub(super) fn audited(
    checked: &Checked,
    catalogue: &[NodeDef],
    options: &Options,
    mut facts: Facts,
) -> (Program, Audit) {
    let graph = checked.graph();
    let is_too_large = facts.order.len() > MOST_NODES;
    if is_too_large || is_exact(checked) {
        let audit = Audit {
            is_too_large,
            ..Audit::default()
        };
        return (program(graph, catalogue, options, &facts), audit);
    }
    let shape = shape_of(graph, catalogue, options, &facts);
    let known = shape.as_ref().and_then(|shape| {
        let known = KNOWN.read().unwrap_or_else(PoisonError::into_inner);
        known.get(shape).cloned()
    });
    if let Some(known) = known {
        facts.mixtures = known.mixtures.clone();
        facts.sampled = known.sampled.clone();
        facts.repeated = known.repeated.clone();
        facts.drawn = known.drawn.clone();
        return (
            program(graph, catalogue, options, &facts),
            known.audit.clone(),
        );
    }
    let (program, decision) = decide(checked, catalogue, options, &mut facts);
    let audit = decision.audit.clone();
    if let Some(shape) = shape {
        let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
        if known.len() < MOST {
            known.insert(shape, Arc::new(decision));
        }
    }
    (program, audit)
}

/// Whether every output is Gaussian or a constant, of which all rules are exact.
fn is_exact(checked: &Checked) -> bool {
    let exact = |class| matches!(class, Class::Constant | Class::Gaussian { .. });
    let mut outputs = checked.graph().outputs.iter();
    outputs.all(|output| exact(checked.signal(output.node).class))
}

/// All that the decision depends on.
fn shape_of(
    graph: &Graph,
    catalogue: &[NodeDef],
    options: &Options,
    facts: &Facts,
) -> Option<Shape> {
    let compiler = Compiler::new((graph, facts), catalogue, options);
    let all: Vec<usize> = (0..graph.nodes.len()).collect();
    let mut words = shape(&compiler, &[], &all)?;
    words.extend(graph.outputs.iter().map(|output| output.node.0));
    words.push(options.filter.sd().to_bits());
    Some(words)
}

/// A program with its values, their errors and what it is made of.
struct Candidate {
    program: Program,
    values: Vec<Vec<f32>>,
    errors: Errors,
    sampled: FxHashMap<usize, Sampling>,
    repeated: FxHashMap<usize, Repeated>,
}

impl Candidate {
    /// The other one if it is so much better that it is worth its time.
    fn or(self, other: Self, verdict: impl Fn(&Errors) -> Verdict) -> Self {
        if verdict(&other.errors).beats(verdict(&self.errors)) {
            other
        } else {
            self
        }
    }
}

/// Compiles the graph, and decides what of it is sampled or read from maps.
fn decide(
    checked: &Checked,
    catalogue: &[NodeDef],
    options: &Options,
    facts: &mut Facts,
) -> (Program, Decision) {
    let graph = checked.graph();
    let point = Options {
        method: Method::Point,
        moments: false,
        ..*options
    };
    let point = program(graph, catalogue, &point, facts);
    let Extent {
        bands,
        distance,
        work,
    } = extent(&point);
    let candidates = candidates(bands, distance);
    let closed = program(graph, catalogue, options, facts);
    let seen = values(&closed, &candidates);
    let of_points = values(&point, &candidates);
    let outputs = components(graph);
    let (places, indices) = Places::of(bands, &candidates, [&seen, &of_points], &outputs);
    let places = &places;
    let footprints = &*places.footprints;
    let found: Vec<Vec<f32>> = (seen.iter())
        .map(|values| indices.iter().map(|&index| values[index]).collect())
        .collect();
    let glance = Truth::of(GLANCE, places, graph, catalogue, options, facts);
    let errors = glance.errors(&found);
    let (point, floor) = (glance.errors(&glance.point), glance.floor());
    let steady = steady(graph);
    let outputs: Vec<(usize, usize)> = (graph.outputs.iter().enumerate())
        .map(|(output, of)| (output, of.node.index()))
        .collect();
    let is_biased = |&(output, _): &(usize, usize)| glance.far_bias(output, &found) > BIASED;
    // A glance is noisy: what it says to be off is looked at closer.
    let is_near = errors.iter().flatten().all(|&error| error <= TOLERANCE);
    let is_good = is_near && Verdict::of(&errors, &point, &floor).is_good();
    if is_good && !outputs.iter().any(is_biased) {
        let audit = Audit {
            outputs: audited_outputs(bands, [&point, &errors, &errors, &glance.shown_floor()]),
            ..Audit::default()
        };
        let decision = Decision {
            mixtures: facts.mixtures.clone(),
            audit,
            ..Decision::default()
        };
        return (closed, decision);
    }
    let samples = look(work);
    let truth = if samples > GLANCE {
        Truth::of(samples, places, graph, catalogue, options, facts)
    } else {
        glance
    };
    facts.rehearses = true;
    let (point, floor) = (truth.errors(&truth.point), truth.floor());
    let verdict = |errors: &Errors| Verdict::of(errors, &point, &floor);
    let candidate = |facts: &Facts| {
        let program = program(graph, catalogue, options, facts);
        let values = values(&program, footprints);
        Candidate {
            errors: truth.errors(&values),
            values,
            program,
            sampled: facts.sampled.clone(),
            repeated: facts.repeated.clone(),
        }
    };
    let closed_errors = truth.errors(&found);
    let closed_values = found.clone();
    let mut best = Candidate {
        program: closed,
        errors: closed_errors.clone(),
        values: found,
        sampled: FxHashMap::default(),
        repeated: FxHashMap::default(),
    };

    if !facts.mixtures.is_empty() {
        // What is closed without them is worth as much, where it is as good.
        let mixtures = std::mem::take(&mut facts.mixtures);
        let plain = candidate(facts);
        if verdict(&plain.errors).beats(verdict(&best.errors)) {
            best = plain;
        } else {
            facts.mixtures = mixtures;
        }
    }
    let readers = readers(graph);
    if !verdict(&best.errors).is_good() {
        facts.repeated = repeated(bands, checked, catalogue, options, facts);
        let maps = candidate(facts);
        let mut everywhere = true;
        facts.repeated.retain(|node, repeated| {
            let noticed = [NOTICEABLE, 1.0];
            repeated.within = where_better(&maps.errors, &best.errors, &readers[*node], noticed);
            everywhere &= repeated.within == Bands::ALL;
            repeated.within != 0
        });
        if !facts.repeated.is_empty() {
            let maps = if everywhere { maps } else { candidate(facts) };
            best = best.or(maps, verdict);
        }
        facts.repeated.clone_from(&best.repeated);
    }
    for by in [
        Points::AtBeginnings,
        Points::AtEnds,
        Points::MoreAtAll,
        Points::MoreAtEnds,
    ] {
        if verdict(&best.errors).is_good() {
            break;
        }
        let mut added = match by {
            Points::AtBeginnings => beginnings(places, graph, catalogue, options, facts, &steady),
            Points::AtEnds | Points::MoreAtEnds => {
                let of = (&truth, &closed_values[..]);
                ends(graph, of, [&best.errors, &point, &floor], &steady)
            }
            Points::MoreAtAll => best.sampled.clone(),
        };
        if matches!(by, Points::MoreAtAll | Points::MoreAtEnds) {
            added.values_mut().for_each(|by| by.take_more(Bands::ALL));
        }
        if added.is_empty() {
            continue;
        }
        facts.sampled.extend(added.clone());
        let points = candidate(facts);
        let mut everywhere = true;
        added.retain(|node, sampling| {
            let noticed = [SAMPLED, BETTER_BY_POINTS];
            let better = where_better(&points.errors, &best.errors, &readers[*node], noticed);
            everywhere &= better == Bands::ALL;
            match best.sampled.get(node) {
                // Few points are enough elsewhere.
                Some(before) => {
                    let more = sampling.finer & better;
                    *sampling = before.clone();
                    sampling.within |= better;
                    sampling.take_more(more);
                }
                None => sampling.keep(better),
            }
            better != 0
        });
        facts.sampled.clone_from(&best.sampled);
        if !added.is_empty() {
            facts.sampled.extend(added);
            let points = if everywhere { points } else { candidate(facts) };
            // They are taken only where they are worth their time.
            if verdict(&points.errors).improves(verdict(&best.errors)) {
                best = points;
            }
            facts.sampled.clone_from(&best.sampled);
        }
    }

    let right = Options {
        method: Method::Supersample(LOOK),
        moments: false,
        ..*options
    };
    let largest = &footprints[footprints.len() - LARGEST..];
    let is_drawn = |(_, by): &(&usize, &Sampling)| {
        matches!(by.drawn.far, Far::Times(_)) && by.drawn.lost.iter().any(|&lost| lost > 0.0)
    };
    let live: Vec<usize> = (best.sampled.iter().filter(is_drawn))
        .map(|(&node, _)| node)
        .collect();
    if !live.is_empty() {
        for node in &live {
            if let Some(sampling) = facts.sampled.get_mut(node) {
                sampling.drawn.lost = [0.0; Bands::COUNT];
            }
        }
        let before = program(graph, catalogue, options, facts);
        facts.sampled.clone_from(&best.sampled);
        let components: Vec<_> = (outputs.iter())
            .map(|&(output, _)| truth.components(output))
            .collect();
        let near = Change {
            before: &before,
            after: &best.program,
            right: &program(graph, catalogue, &right, facts),
        }
        .near(graph, largest, &components);
        if near.iter().any(|near| !near.is_empty()) {
            for node in live {
                if let Some(sampling) = facts.sampled.get_mut(&node) {
                    let of_readers = readers[node].iter().flat_map(|&output| &near[output]);
                    sampling.drawn.stay_near(of_readers);
                }
            }
            best.sampled.clone_from(&facts.sampled);
            best.program = program(graph, catalogue, options, facts);
        }
    }

    // Nodes with the first output that reads them.
    for &(output, node) in outputs.iter().rev() {
        // A map has the right mean.
        let mapped = best
            .repeated
            .get(&node)
            .map_or(0, |repeated| repeated.within);
        match truth.drawn(output, &best.values, (steady[node], !mapped)) {
            Some(drawn) => facts.drawn.insert(node, drawn),
            None => facts.drawn.remove(&node),
        };
    }
    let live: Vec<(usize, usize)> = (outputs.iter().copied())
        .filter(|(_, node)| !steady[*node] && facts.drawn.contains_key(node))
        .collect();
    if !live.is_empty() {
        let change = Change {
            before: &best.program,
            after: &program(graph, catalogue, options, facts),
            right: &program(graph, catalogue, &right, facts),
        };
        let components: Vec<_> = (live.iter())
            .map(|&(output, _)| truth.components(output))
            .collect();
        let near = change.near(graph, largest, &components);
        for ((_, node), near) in live.into_iter().zip(near) {
            if let Some(drawn) = facts.drawn.get_mut(&node) {
                drawn.near = near;
            }
        }
    }
    if !facts.drawn.is_empty() {
        let drawn = candidate(facts);
        if verdict(&drawn.errors).square < verdict(&best.errors).square {
            best = drawn;
        } else {
            facts.drawn.clear();
        }
    }

    facts.rehearses = false;
    if !best.repeated.is_empty() {
        best.program = program(graph, catalogue, options, facts);
    }
    let sampled = (best.sampled.iter()).map(|(&node, by)| (node, Remedy::Sampled, by.within));
    let repeated = (best.repeated.iter()).map(|(&node, by)| (node, Remedy::Repeated, by.within));
    let drawn = (facts.drawn.iter()).map(|(&node, by)| (node, Remedy::Drawn, by.within()));
    let mut replaced: Vec<Replaced> = sampled
        .chain(repeated)
        .chain(drawn)
        .map(|(node, remedy, within)| Replaced {
            node: NodeId(node as u32),
            remedy,
            sizes: bands.sizes(within),
        })
        .collect();
    replaced.sort_by_key(|replaced| (replaced.node, replaced.remedy));
    let audit = Audit {
        outputs: audited_outputs(
            bands,
            [&point, &closed_errors, &best.errors, &truth.shown_floor()],
        ),
        replaced,
        is_too_large: false,
    };
    let decision = Decision {
        mixtures: facts.mixtures.clone(),
        sampled: best.sampled,
        repeated: best.repeated,
        drawn: facts.drawn.clone(),
        audit,
    };
    (best.program, decision)
}

/// The errors of each output.
fn audited_outputs(bands: Bands, [point, closed, auto, floor]: [&Errors; 4]) -> Vec<AuditedOutput> {
    let band = |output: usize, band: usize| AuditedBand {
        size: bands.size(band),
        point: point[output][band],
        closed: closed[output][band],
        auto: auto[output][band],
        floor: floor[output][band],
    };
    (0..point.len())
        .map(|output| AuditedOutput {
            output,
            bands: (0..Bands::COUNT).map(|i| band(output, i)).collect(),
        })
        .collect()
}

/// Which nodes are sampled.
#[derive(Clone, Copy)]
enum Points {
    /// Those at which the error begins.
    AtBeginnings,
    /// The outputs.
    AtEnds,
    /// Those that are sampled, by more points.
    MoreAtAll,
    /// The outputs, by more points.
    MoreAtEnds,
}
