//! Fusion over two signals: a region that is not linear and depends on two signals alone becomes one
//! function of both, read from a map, where closing it node by node is measurably wrong.
//!
//! Closing takes every intermediate signal for Gaussian. For most sums and for Clark's maximum that
//! is as good as fusing (MATH §7), and costs no table; for a step of a product it is off by a tenth
//! even in the far field. So the region's closed form is compared with its integral under a few
//! Gaussians when it is compiled.
//!
//! A sum of many terms depends on many signals. It is taken for T(X) + Z: the widest term that is a
//! function of one signal, exactly, and all others together as one Gaussian Z. That stands for the
//! conditional taps of T₂(T₁(X) + Y): the taps are in the map.

use super::fusion::{Known, region};
use super::shape::{self, Shape, baked, measured};
use super::{Arguments, Bundle, Compiler, Lower, value_results};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{Builder, FunctionRef, Module};
use crate::moments::{Algebra, Domain, Grid, Map, Mode, Signal, tables};
use mipless_graph::{Node, NodeId, Source};
use std::rc::Rc;
use std::sync::{Arc, LazyLock};

/// The most functions that are not linear in one region.
const LONGEST: u32 = 12;
/// How far, relative to the region's values, the closed form may be off.
pub(super) const TOLERANCE: f32 = 0.02;
/// A range is this many standard deviations of a noise.
pub(super) const DEVIATIONS: f32 = 10.0;

/// That a node is a function of two scalar signals alone.
#[derive(Clone, Debug)]
pub(super) struct Pair<'b> {
    first: Entry<'b>,
    second: Entry<'b>,
    /// How many nodes between are not linear, at most.
    bends: u32,
    /// Whether no live parameter shapes it.
    fixed: bool,
}

/// A signal that a region is a function of.
#[derive(Clone, Debug)]
struct Entry<'b> {
    from: From,
    signal: Rc<Signal<'b>>,
    /// About the standard deviation of the process: regions are measured at it.
    deviation: f32,
}

impl<'b> Entry<'b> {
    fn node(id: NodeId, signal: Rc<Signal<'b>>) -> Self {
        Self {
            from: From::Node(id),
            deviation: extent(&signal) / DEVIATIONS,
            signal,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum From {
    /// The output of a node.
    Node(NodeId),
    /// What a sum adds to a term.
    Rest { sum: NodeId, term: NodeId },
}

/// That a node is T(X) + Z with unit weights.
#[derive(Clone, Debug)]
pub(super) struct Sum<'b> {
    /// The node of T(X).
    term: NodeId,
    /// X.
    of: Entry<'b>,
    fixed: bool,
    /// The extent of T(X).
    extent: f32,
    /// Z.
    rest: Rc<Signal<'b>>,
    /// About the standard deviation of Z as a process.
    deviation: f32,
}

fn extent(signal: &Signal<'_>) -> f32 {
    signal.range[1] - signal.range[0]
}

fn bounded(signal: &Signal<'_>) -> bool {
    let [low, high] = signal.range;
    low.is_finite() && high.is_finite() && low < high
}

impl<'b> Lower<'_, 'b> {
    /// Records what the node, just lowered to `closed`, is a function of; its bundle by a map of two
    /// signals, where that is better than closing it.
    pub(super) fn fuse_pair(
        &mut self,
        index: usize,
        node: &Node,
        closed: &[Signal<'b>],
    ) -> Option<Bundle<'b>> {
        self.sums[index] = self.sum(node, closed);
        let before = self.pair(index, node)?;
        let bends = before.bends + u32::from(self.algebra.bent);
        if bends < LONGEST {
            self.pairs[index] = Some(Pair {
                bends,
                ..before.clone()
            });
        }
        let entries = [&before.first, &before.second];
        let fits = (1..=4).contains(&closed.len()) && entries.iter().all(|e| bounded(&e.signal));
        if !self.algebra.bent || before.bends == 0 || !before.fixed || !fits {
            return None;
        }
        let compiler = self.compiler;
        let shape = shape(compiler, index, &before);
        let gains = measured(compiler, shape.clone(), || {
            usize::from(gains(compiler, index, &before))
        });
        if gains == 0 {
            return None;
        }
        let [x, y] = entries.map(|entry| Rc::clone(&entry.signal));
        let domain = Domain {
            bounds: [x.range, y.range],
            periodic: false,
            detail: 1,
        };
        let ranges: Vec<[f32; 2]> = closed.iter().map(|signal| signal.range).collect();
        let key = format!("pair {index}");
        let name = super::identifier(&node.name);
        let map = compiler.mapped(self.module, &key, |module| {
            let of = point_function(compiler, module, index, &before);
            let mut alone = Module::default();
            let options = compiler.options;
            point_function(&compiler.with_options(options), &mut alone, index, &before);
            let grid: Grid = Arc::new(LazyLock::new(Box::new(move || {
                super::map::sampled(&alone, domain)
            })));
            let tables = baked(shape, || tables(&grid, domain, ranges.len()));
            Map::new(module, &name, of, domain, ranges, tables)
        });
        Some(self.algebra.map([&x, &y], &map))
    }

    /// The two signals that all varying inputs of a node are functions of.
    fn pair(&self, index: usize, node: &Node) -> Option<Pair<'b>> {
        let mut entries: Vec<Entry<'b>> = Vec::new();
        // The inputs themselves, where they are functions of too many signals.
        let mut direct: Vec<Entry<'b>> = Vec::new();
        let (mut bends, mut fixed) = (0, true);
        let mut insert = |entry: &Entry<'b>| {
            if !entries.iter().any(|known| known.from == entry.from) {
                entries.push(entry.clone());
            }
        };
        // Whether all inputs that vary are scalars: no other one can be an entry.
        let mut scalars = true;
        for input in &node.inputs {
            let id = match &input.source {
                Source::Literal(_) => continue,
                Source::Parameter(_) => {
                    fixed = false;
                    continue;
                }
                Source::Surface => return None,
                Source::Node(id) => *id,
            };
            let bundle = self.bundles[id.index()].as_ref()?;
            match &bundle[..] {
                bundle if bundle.iter().all(Signal::is_certain) => {}
                [_] if direct.iter().any(|known| known.from == From::Node(id)) => {}
                [signal] => direct.push(Entry::node(id, Rc::new(signal.clone()))),
                _ => scalars = false,
            }
            if let Some(pair) = &self.pairs[id.index()] {
                insert(&pair.first);
                insert(&pair.second);
                bends = bends.max(pair.bends);
                fixed &= pair.fixed;
                continue;
            }
            match self.known(id)? {
                Known::Certain { literal } => fixed &= literal,
                Known::Function(chain) => {
                    insert(&Entry::node(chain.entry, chain.signal));
                    bends = bends.max(chain.bends);
                    fixed &= chain.fixed;
                }
                Known::Opaque | Known::Placed => return None,
            }
        }
        let pair = |[first, second]: [Entry<'b>; 2], bends, fixed| Pair {
            first,
            second,
            bends,
            fixed,
        };
        match <[Entry<'b>; 2]>::try_from(entries) {
            // The rest of a sum is only known together with the term's own signal.
            Ok(entries) if matches!(entries[0].from, From::Node(_)) => {
                Some(pair(entries, bends, fixed))
            }
            Err(entries) if entries.len() < 2 => None,
            _ => {
                if let Some(sum) = &self.sums[index] {
                    let rest = Entry {
                        from: From::Rest {
                            sum: NodeId(index as u32),
                            term: sum.term,
                        },
                        signal: Rc::clone(&sum.rest),
                        deviation: sum.deviation,
                    };
                    return Some(pair([sum.of.clone(), rest], 1, sum.fixed));
                }
                let entries = <[Entry<'b>; 2]>::try_from(direct).ok()?;
                scalars.then(|| pair(entries, 0, fixed))
            }
        }
    }

    /// The node as a term and a rest, if it is the plain sum of its two varying inputs.
    fn sum(&self, node: &Node, closed: &[Signal<'b>]) -> Option<Sum<'b>> {
        let [out] = closed else { return None };
        if self.algebra.bent || out.cell.is_some() {
            return None;
        }
        let mut inputs = Vec::new();
        for input in &node.inputs {
            match &input.source {
                Source::Literal(_) => {}
                Source::Node(id) => inputs.push(*id),
                Source::Parameter(_) | Source::Surface => return None,
            }
        }
        let [p, q] = inputs[..] else { return None };
        if p == q {
            return None;
        }
        let of = |id: NodeId| match self.bundles[id.index()].as_deref() {
            Some([signal]) => Some(signal.clone()),
            _ => None,
        };
        let (x, y) = (of(p)?, of(q)?);
        // Equal definitions are one value: the node added, and did nothing else.
        if x.mean + y.mean != out.mean {
            return None;
        }
        let candidates = [(p, &x, &y), (q, &y, &x)].map(|(id, signal, other)| {
            if let Some(sum) = &self.sums[id.index()] {
                return Some((sum.clone(), Some(other)));
            }
            let chain = self.chains[id.index()].as_ref()?;
            let sum = Sum {
                term: id,
                of: Entry::node(chain.entry, Rc::clone(&chain.signal)),
                fixed: chain.fixed,
                extent: extent(signal),
                rest: Rc::new(other.clone()),
                deviation: extent(other) / DEVIATIONS,
            };
            (chain.bends > 0 && bounded(&chain.signal)).then_some((sum, None))
        });
        let widest = (candidates.into_iter().flatten())
            .max_by(|(s, _), (t, _)| s.extent.total_cmp(&t.extent))?;
        let (mut sum, more) = widest;
        if let Some(more) = more {
            // Terms of different sources add in squares.
            sum.deviation = sum.deviation.hypot(extent(more) / DEVIATIONS);
            sum.rest = Rc::new(&*sum.rest + more);
        }
        Some(sum)
    }
}

/// Lowers the region of a pair into `lower`, whose entries are these signals.
fn lower_region<'b>(
    lower: &mut Lower<'_, 'b>,
    index: usize,
    pair: &Pair<'_>,
    [x, y]: [Signal<'b>; 2],
) -> Bundle<'b> {
    let compiler = lower.compiler;
    let From::Node(first) = pair.first.from else {
        panic!("a pair begins with a node")
    };
    lower.bundles[first.index()] = Some(vec![x]);
    let run = |lower: &mut Lower<'_, 'b>, to: usize, entries: &[NodeId]| {
        for node in region(compiler, to, entries) {
            if lower.bundles[node].is_none() {
                let node_of = &compiler.graph.nodes[node];
                let bundle = (compiler.catalogue[node_of.definition].lower)(lower, node_of);
                lower.bundles[node] = Some(bundle);
            }
        }
    };
    let second = match pair.second.from {
        From::Node(second) => {
            lower.bundles[second.index()] = Some(vec![y]);
            second
        }
        From::Rest { sum, term } => {
            run(lower, term.index(), &[first]);
            let term = &lower.bundles[term.index()].as_ref().expect("just lowered")[0];
            lower.bundles[sum.index()] = Some(vec![term + &y]);
            sum
        }
    };
    run(lower, index, &[first, second]);
    lower.bundles[index]
        .take()
        .expect("the region ends at the node")
}

/// The region's function of two parameters, by the builder of the signals of the two entries.
fn function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    index: usize,
    pair: &Pair<'_>,
    mode: Mode,
    entries: impl for<'b> FnOnce(&'b Builder) -> [Signal<'b>; 2],
) -> FunctionRef {
    let name = super::identifier(&compiler.graph.nodes[index].name);
    let b = &Builder::new(format!("{name}_of"), "A function of two signals.");
    let entries = entries(b);
    let arguments = Arguments::without_place(b, compiler.graph, Vec::new());
    let mut lower = Lower::with(compiler, module, Algebra::new(b, mode), arguments);
    let bundle = lower_region(&mut lower, index, pair, entries);
    value_results(b, &bundle);
    b.finish(module)
}

fn point_function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    index: usize,
    pair: &Pair<'_>,
) -> FunctionRef {
    function(compiler, module, index, pair, Mode::Point, |b| {
        ["x", "y"].map(|name| Signal::certain(b.float_param(name)))
    })
}

/// All that the region's function and its entries depend on.
fn shape(compiler: &Compiler<'_>, index: usize, pair: &Pair<'_>) -> Option<Shape> {
    let From::Node(first) = pair.first.from else {
        panic!("a pair begins with a node")
    };
    let mut nodes = Vec::new();
    let second = match pair.second.from {
        From::Node(second) => second,
        From::Rest { sum, term } => {
            nodes.extend(region(compiler, term.index(), &[first]));
            sum
        }
    };
    let entries = [first, second];
    nodes.extend(region(compiler, index, &entries));
    let mut words = shape::shape(compiler, &entries, &nodes)?;
    for entry in [&pair.first, &pair.second] {
        let [low, high] = entry.signal.range;
        words.extend([low, high, entry.deviation].map(f32::to_bits));
    }
    words.push(u32::from(matches!(pair.second.from, From::Node(_))));
    Some(words)
}

/// Whether the closed form of the region is off by more than [`TOLERANCE`] under one of a few
/// Gaussians: the whole process, and footprints that have removed half of its deviation.
fn gains(compiler: &Compiler<'_>, index: usize, pair: &Pair<'_>) -> bool {
    let alone = compiler.with_options(compiler.options);
    let mut point = Module::default();
    point_function(&alone, &mut point, index, pair);
    let alone = compiler.with_options(compiler.options);
    let mut closed = Module::default();
    let ranges = [&pair.first, &pair.second].map(|entry| entry.signal.range);
    function(&alone, &mut closed, index, pair, Mode::Local, |b| {
        let [x, sd_x, y, sd_y] = b.float_params(["x", "sd_x", "y", "sd_y"]);
        let mut signals = [x, y].map(Signal::certain);
        signals[0].g[0] = sd_x;
        signals[1].g[1] = sd_y;
        let [x, y] = signals;
        [x.with_range(ranges[0]), y.with_range(ranges[1])]
    });
    let whole = [&pair.first, &pair.second].map(|entry| entry.deviation);
    let centre = 0.5 * (ranges[0][0] + ranges[0][1]);
    // A noise has the middle of its range for a mean; where a rest has it is not known.
    let shares: &[f32] = match pair.second.from {
        From::Node(_) => &[0.5],
        From::Rest { .. } => &[0.1, 0.2, 0.35, 0.5],
    };
    let mut gaussians = Vec::new();
    for share in shares {
        let other = ranges[1][0] + share * (ranges[1][1] - ranges[1][0]);
        gaussians.push(([centre, other], whole));
        for [p, q] in [[0.3f32, 0.5], [-0.8, 0.4], [0.9, -0.6], [-0.4, -0.9]] {
            let mean = [centre + p * whole[0], other + q * whole[1]];
            gaussians.push((mean, whole.map(|sd| 0.5 * sd)));
        }
    }
    let evaluate = |module: &Module, columns: &[Vec<f32>]| {
        let inputs: Vec<Input<'_>> = columns.iter().map(|c| Input::Floats(c)).collect();
        let mut out: Vec<Vec<f32>> = Vec::new();
        let evaluator = Evaluator::<f32>::new(module);
        evaluator.evaluate(&mut Scratch::new(), &inputs, columns[0].len(), &mut out);
        out
    };
    let columns = [
        gaussians.iter().map(|(m, _)| m[0]).collect(),
        gaussians.iter().map(|(_, s)| s[0]).collect(),
        gaussians.iter().map(|(m, _)| m[1]).collect(),
        gaussians.iter().map(|(_, s)| s[1]).collect(),
    ];
    let closed = evaluate(&closed, &columns);
    let scores: Vec<f32> = (-20..=20).map(|i| 0.2 * i as f32).collect();
    let mut places = [Vec::new(), Vec::new()];
    for ([m, n], [s, t]) in &gaussians {
        for p in &scores {
            for q in &scores {
                places[0].push(m + s * p);
                places[1].push(n + t * q);
            }
        }
    }
    let values = evaluate(&point, &places);
    let weights: Vec<f32> = (scores.iter())
        .flat_map(|p| scores.iter().map(move |q| (-0.5 * (p * p + q * q)).exp()))
        .collect();
    let total: f32 = weights.iter().sum();
    (values.iter().zip(&closed)).any(|(values, closed)| {
        let low = values.iter().copied().fold(f32::INFINITY, f32::min);
        let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let off = (values.chunks(weights.len()).zip(closed)).map(|(values, closed)| {
            let sum: f32 = values.iter().zip(&weights).map(|(v, w)| v * w).sum();
            (sum / total - closed).abs()
        });
        off.fold(0.0, f32::max) > TOLERANCE * (high - low)
    })
}
