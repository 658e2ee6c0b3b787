//! What follows the whole parts of coordinates (`floor`, `round`, steps) is a mixture over the cells of
//! a lattice.
//!
//! The whole part of a coordinate jumps from step to step, and a random number of it, a hash or a
//! condition has nothing to do with that of the step beside it: no moments of the whole part fit what
//! follows. So nodes that are functions of the same whole parts, of one coordinate or of two, are
//! evaluated for each step in the footprint and summed with what of the Gaussian lies in it. Which
//! nodes take whole parts their definitions say ([`super::super::NodeDef::steps`]), and who sums.
//!
//! Footprints over more steps than are summed fade to the mean over all. So it is done where the
//! function is alike everywhere: what is left of it under the narrowest footprint that fades is no
//! more than of independent numbers, which is found by trying. Of a ramp of steps, or of a pattern
//! that repeats after many, the nodes are closed one by one, or read from a map.

use super::super::image::{self, Image, is_live};
use super::super::shape::{Shape, shape};
use super::super::torus::alone;
use super::super::{Arguments, Bundle, Compiler, Lower, SumOfSteps, value_results};
use super::{COMPONENTS, LONGEST, Mixed, Origin};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{FunctionRef, Int, Module, Value};
use crate::moments::{Algebra, Mode, Signal, Symbol, Wholes};
use mipless_graph::{NodeId, Source};
use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

/// The most nodes that take whole parts of which one function depends.
pub(super) const MOST_NODES: usize = 4;

/// How far apart the cells are that are tried, in cells: what people see of a texture.
const EXTENT: f64 = 2000.0;

/// The cells that are tried: so many stretches of so many along each of the axes.
const STRETCHES: [usize; 2] = [64, 16];
const STRETCH: [usize; 2] = [1024, 64];

/// The narrowest standard deviation that fades, in cells.
const FADES: [f64; 2] = [6.0, 3.0];

/// How many times what is left of independent numbers may be left of a function, and how much of any.
const LIKE_INDEPENDENT: f64 = 1.5;
const NOTHING: f64 = 0.002;

/// What this process has tried, and the most that it remembers.
static KNOWN: LazyLock<RwLock<FxHashMap<Shape, Arc<Sampled>>>> = LazyLock::new(RwLock::default);
const MOST_KNOWN: usize = 1024;

/// The most nodes that are tried.
const MOST_TRIED: usize = 64;

/// The functions of whole parts among nodes: where one is not alike everywhere, what it is made of may
/// be.
pub(super) fn found(
    compiler: &Compiler<'_>,
    origins: &[Origin],
    mut nodes: Vec<usize>,
) -> Vec<Steps> {
    let mut all: Vec<Steps> = Vec::new();
    let mut seen: FxHashSet<usize> = nodes.iter().copied().collect();
    while !nodes.is_empty() && seen.len() <= MOST_TRIED {
        let mut sets: Vec<(&[usize], Vec<usize>)> = Vec::new();
        for node in nodes {
            let Origin::Steps(of) = &origins[node] else {
                continue;
            };
            match sets.iter_mut().find(|(known, _)| known == &&of[..]) {
                _ if of.contains(&node) => {}
                Some((_, ends)) => ends.push(node),
                None => sets.push((of, vec![node])),
            }
        }
        nodes = Vec::new();
        for (roundings, ends) in sets {
            let steps = Steps::of(compiler, origins, roundings, &ends);
            let is_found = |end: &usize| steps.as_ref().is_some_and(|s| s.ends.contains(end));
            for end in ends.iter().filter(|end| !is_found(end)) {
                for input in &compiler.graph.nodes[*end].inputs {
                    if let Source::Node(id) = input.source
                        && seen.insert(id.index())
                    {
                        nodes.push(id.index());
                    }
                }
            }
            all.extend(steps);
        }
    }
    all
}

/// Nodes that are functions of the same whole parts.
#[derive(Clone, Debug)]
pub(in super::super) struct Steps {
    /// The nodes that take the whole parts, in their order.
    pub(super) roundings: Vec<usize>,
    /// The functions of them.
    pub(super) ends: Vec<usize>,
    /// Where the whole parts come from: what is before them.
    entries: Vec<NodeId>,
    /// Of which axis each whole part is, if it is read.
    axes: Vec<Option<usize>>,
    /// Whether each is carried as an integer cell, as positions are, or as a number.
    celled: Vec<bool>,
    sum: SumOfSteps,
}

impl Steps {
    /// Those of some nodes that are functions of whole parts of one coordinate or two, and alike
    /// everywhere.
    fn of(
        compiler: &Compiler<'_>,
        origins: &[Origin],
        roundings: &[usize],
        ends: &[usize],
    ) -> Option<Self> {
        let graph = compiler.graph;
        let inputs = roundings.iter().flat_map(|&node| &graph.nodes[node].inputs);
        let mut entries: Vec<NodeId> = inputs
            .filter_map(|input| match input.source {
                Source::Node(id) if origins[id.index()] == Origin::Place => Some(id),
                _ => None,
            })
            .collect();
        entries.sort_unstable();
        entries.dedup();
        let wholes = roundings
            .iter()
            .map(|&node| graph.nodes[node].ty.components());
        let count = wholes.sum();
        let mut steps = Self {
            axes: (0..count).map(Some).collect(),
            celled: vec![true; count],
            roundings: roundings.to_vec(),
            ends: Vec::new(),
            entries,
            sum: compiler.catalogue[graph.nodes[roundings[0]].definition].steps?,
        };
        if steps.region(compiler, ends).len() > LONGEST {
            return None;
        }
        // Which whole parts are read, and of which coordinates they are.
        let read = steps.read(compiler, ends);
        (steps.axes, steps.celled) = axes(compiler, &steps, &read)?;
        let mut components = 0;
        for &end in ends {
            let of_end = graph.nodes[end].ty.components();
            if components + of_end < COMPONENTS && steps.sampled(compiler, &[end]).is_alike() {
                components += of_end;
                steps.ends.push(end);
            }
        }
        (!steps.ends.is_empty()).then_some(steps)
    }

    /// Of how many coordinates the whole parts are.
    pub(super) fn axes(&self) -> usize {
        self.axes.iter().flatten().max().map_or(0, |last| last + 1)
    }

    /// The nodes from those that take whole parts to the ends.
    pub(super) fn region(&self, compiler: &Compiler<'_>, ends: &[usize]) -> Vec<usize> {
        super::super::fusion::regions(compiler, ends, &self.entries)
    }

    /// Ends as functions of the whole parts of the coordinates.
    pub(super) fn function(
        &self,
        compiler: &Compiler<'_>,
        module: &mut Module,
        ends: &[usize],
        is_live: bool,
    ) -> FunctionRef {
        self.function_at(compiler, module, ends, is_live).0
    }

    /// The same, and whether it looks at other places than its own.
    fn function_at(
        &self,
        compiler: &Compiler<'_>,
        module: &mut Module,
        ends: &[usize],
        is_live: bool,
    ) -> (FunctionRef, bool) {
        let graph = compiler.graph;
        let name = super::super::identifier(&graph.nodes[ends[0]].name);
        let b = &compiler.builder(format!("{name}_image"), "Functions of whole parts.");
        let cell: Vec<Int<'_>> = (0..self.axes())
            .map(|axis| b.int_param(format!("whole_{axis}")))
            .collect();
        let parameters = match is_live {
            true => Arguments::parameters(b, graph),
            false => Vec::new(),
        };
        let arguments = Arguments::without_place(b, graph, parameters);
        let mut lower = Lower::with(compiler, module, Algebra::new(b, Mode::Point), arguments);
        for entry in &self.entries {
            let components = graph.nodes[entry.index()].ty.components();
            lower.bundles[entry.index()] = Some(vec![Signal::constant(b, 0.0); components]);
        }
        let axis = |axis: &Option<usize>| axis.map_or(b.int(0), |axis| cell[axis]);
        let mut wholes = self.axes.iter().map(axis).zip(self.celled.iter().copied());
        let mut looks_elsewhere = false;
        for node in self.region(compiler, ends) {
            if self.roundings.contains(&node) {
                let count = graph.nodes[node].ty.components();
                lower.algebra.wholes = Wholes::Given(wholes.by_ref().take(count).collect());
            }
            lower.reads_elsewhere = false;
            lower.place_node(node);
            looks_elsewhere |= lower.reads_elsewhere;
            lower.algebra.wholes = Wholes::Own;
        }
        let bundles = ends.iter().filter_map(|&node| lower.bundles[node].clone());
        let signals: Vec<Signal<'_>> = bundles.flatten().collect();
        value_results(b, &signals);
        (b.finish(module), looks_elsewhere)
    }

    /// Which whole parts ends read.
    fn read(&self, compiler: &Compiler<'_>, ends: &[usize]) -> Vec<bool> {
        let module = alone(compiler, |compiler, module| {
            self.function(compiler, module, ends, true);
        });
        let mut read = module.entry().read_parameters();
        read.truncate(self.axes.len());
        read
    }

    /// Ends at cells of the lattice.
    pub(super) fn sampled(&self, compiler: &Compiler<'_>, ends: &[usize]) -> Arc<Sampled> {
        let region = self.region(compiler, ends);
        let words = shape(compiler, &self.entries, &region).map(|mut words| {
            let at = |node: &usize| region.iter().position(|other| other == node);
            words.extend(
                ends.iter()
                    .map(|end| at(end).map_or(u32::MAX, |at| at as u32)),
            );
            let axes = self.axes.iter();
            words.extend(axes.map(|axis| axis.map_or(u32::MAX, |axis| axis as u32)));
            words
        });
        let known = words.as_ref().and_then(|words| {
            let known = KNOWN.read().unwrap_or_else(PoisonError::into_inner);
            known.get(words).cloned()
        });
        if let Some(known) = known {
            return known;
        }
        let mut looks_elsewhere = false;
        let module = alone(compiler, |compiler, module| {
            (_, looks_elsewhere) = self.function_at(compiler, module, ends, true);
        });
        let sampled = Arc::new(Sampled {
            looks_elsewhere,
            ..Sampled::of(&module, compiler, self.axes())
        });
        if let Some(words) = words {
            let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
            if known.len() < MOST_KNOWN {
                known.insert(words, Arc::clone(&sampled));
            }
        }
        sampled
    }

    /// The coordinates of which these are the whole parts, each where it is taken.
    fn coordinates<'b>(&self, lower: &mut Lower<'_, 'b>) -> Vec<Signal<'b>> {
        let compiler = lower.compiler;
        lower.algebra.wholes = Wholes::Noted(Vec::new());
        for &rounding in &self.roundings {
            let node = &compiler.graph.nodes[rounding];
            let _ = (compiler.catalogue[node.definition].lower)(lower, node);
        }
        match std::mem::take(&mut lower.algebra.wholes) {
            Wholes::Noted(signals) => signals,
            other => panic!("whole parts were asked for: {other:?}"),
        }
    }
}

/// Of which axis each whole part is that is read, and whether it is carried as a cell; `None` where they are of none, of more than two, or of
/// numbers that are no coordinates: those that are bounded, or are the same everywhere.
fn axes(
    compiler: &Compiler<'_>,
    steps: &Steps,
    read: &[bool],
) -> Option<(Vec<Option<usize>>, Vec<bool>)> {
    let graph = compiler.graph;
    let b = &compiler.builder("coordinates", "What whole parts are taken of.");
    let mut module = Module::default();
    let mut lower = Lower::new(compiler, &mut module, b, Mode::Local);
    let mut uses = vec![0; graph.nodes.len()];
    for &rounding in &steps.roundings {
        for input in &graph.nodes[rounding].inputs {
            if let Source::Node(id) = input.source {
                uses[id.index()] += 1;
            }
        }
    }
    for node in (0..uses.len()).rev() {
        if uses[node] > 0 {
            for id in lower.reads(node) {
                uses[id.index()] += 1;
            }
        }
    }
    lower.run_nodes(uses);
    let coordinates = steps.coordinates(&mut lower);
    let values = |signal: &Signal<'_>| -> Vec<Value> {
        let [u, v] = signal.g.0;
        let cell = signal.cell.map(|cell| cell.value());
        let floats = [signal.mean, u, v, signal.private];
        cell.into_iter().chain(floats.map(|x| x.value())).collect()
    };
    let mut known: Vec<Vec<Value>> = Vec::new();
    let mut axes = Vec::new();
    for (coordinate, &is_read) in coordinates.iter().zip(read) {
        if !is_read {
            axes.push(None);
            continue;
        }
        let is_bounded = coordinate.range.iter().any(|end| end.is_finite());
        if is_bounded || coordinate.is_certain() || coordinate.binary.is_some() {
            return None;
        }
        let own = values(coordinate);
        let axis = known.iter().position(|other| *other == own);
        axes.push(Some(axis.unwrap_or_else(|| {
            known.push(own);
            known.len() - 1
        })));
    }
    let celled = coordinates
        .iter()
        .map(|coordinate| coordinate.cell.is_some());
    (1..=2)
        .contains(&known.len())
        .then(|| (axes, celled.collect()))
}

impl Image {
    /// The components of some of the nodes that are functions of whole parts.
    fn of_steps(lower: &mut Lower<'_, '_>, steps: &Steps, ends: &[usize]) -> Self {
        let compiler = lower.compiler;
        let key = format!("image of steps {:?} {ends:?}", steps.roundings);
        Self::kept(lower, key, Some(steps.axes()), |lower| {
            let is_live = is_live(compiler, &steps.region(compiler, ends));
            let function = steps.function(compiler, lower.module, ends, is_live);
            let known = (!is_live).then(|| steps.sampled(compiler, ends).moments());
            (function, known)
        })
    }
}

/// A function of cells at many of them.
pub(super) struct Sampled {
    axes: usize,
    /// Whether it looks at other places than its own, so that it is none of cells alone.
    looks_elsewhere: bool,
    /// Its components.
    values: Vec<Vec<f32>>,
}

impl std::fmt::Debug for Sampled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} components over {} axes",
            self.values.len(),
            self.axes
        )
    }
}

impl Sampled {
    fn of(module: &Module, compiler: &Compiler<'_>, axes: usize) -> Self {
        let stretch = STRETCH[axes - 1];
        let mut cells = vec![Vec::new(); axes];
        for number in 0..STRETCHES[axes - 1] {
            let from =
                super::super::place::scattered(number).map(|x| ((2.0 * x - 1.0) * EXTENT) as i32);
            for i in 0..stretch.pow(axes as u32) {
                for (axis, cells) in cells.iter_mut().enumerate() {
                    let along = i / stretch.pow(axis as u32) % stretch;
                    cells.push(from[axis] + along as i32);
                }
            }
        }
        // The inputs of the graph are at their defaults.
        let defaults = (compiler.graph.parameters.iter()).flat_map(|parameter| {
            let is_float = !matches!(
                parameter.ty,
                mipless_graph::Type::Integer | mipless_graph::Type::Boolean
            );
            let of = move |x: f32| match is_float {
                true => Input::Float(x),
                false => Input::Integer(x as i32),
            };
            parameter.value.numbers().into_iter().map(of)
        });
        let inputs: Vec<Input<'_>> = (cells.iter())
            .map(|cells| Input::Integers(cells))
            .chain(defaults)
            .collect();
        let mut values = Vec::new();
        let evaluator = Evaluator::<f32>::new(module);
        evaluator.evaluate(&mut Scratch::new(), &inputs, cells[0].len(), &mut values);
        Self {
            axes,
            looks_elsewhere: false,
            values,
        }
    }

    /// Means and covariance of its components.
    pub(super) fn moments(&self) -> [Vec<f32>; 2] {
        image::moments_of(&self.values)
    }

    /// Whether the function is alike everywhere, and no constant.
    fn is_alike(&self) -> bool {
        let sd = FADES[self.axes - 1];
        // Independent numbers have 1/(2√π σ) of their variance left, along each axis.
        let left = (1.0 / (2.0 * std::f64::consts::PI.sqrt() * sd)).powi(self.axes as i32);
        let count = self.values[0].len() as f64;
        if self.looks_elsewhere {
            return false;
        }
        self.values.iter().all(|values| {
            let mean = values.iter().map(|&x| f64::from(x)).sum::<f64>() / count;
            let apart: Vec<f64> = values.iter().map(|&x| f64::from(x) - mean).collect();
            let variance = apart.iter().map(|x| x * x).sum::<f64>() / count;
            let wide = self.blurred(&apart, sd);
            let most = LIKE_INDEPENDENT * (variance * left).sqrt() + NOTHING;
            mean.is_finite() && wide.is_finite() && wide < most
        }) && self
            .values
            .iter()
            .any(|values| values.iter().any(|x| *x != values[0]))
    }

    /// The root mean square of the values of stretches under a Gaussian, at the middles of stretches.
    fn blurred(&self, values: &[f64], sd: f64) -> f64 {
        let stretch = STRETCH[self.axes - 1];
        let reach = (3.0 * sd).ceil() as usize;
        let mut kernel: Vec<f64> = (0..=2 * reach)
            .map(|i| (-0.5 * ((i as f64 - reach as f64) / sd).powi(2)).exp())
            .collect();
        let sum: f64 = kernel.iter().sum();
        for weight in &mut kernel {
            *weight /= sum;
        }
        // Windows lie side by side; the second axis is blurred where there is one.
        let (width, windows) = (kernel.len(), stretch / kernel.len());
        let under = |part: &mut dyn Iterator<Item = f64>| -> f64 {
            part.zip(&kernel).map(|(x, weight)| x * weight).sum()
        };
        let mut squares = Vec::new();
        for of_stretch in values.chunks(stretch.pow(self.axes as u32)) {
            let rows: Vec<Vec<f64>> = (of_stretch.chunks(stretch))
                .map(|row| {
                    let windows = row.chunks_exact(width);
                    windows
                        .map(|part| under(&mut part.iter().copied()))
                        .collect()
                })
                .collect();
            for along in 0..windows {
                if self.axes == 1 {
                    squares.push(rows[0][along].powi(2));
                } else {
                    let windows = rows.chunks_exact(width);
                    let blurred = windows.map(|part| under(&mut part.iter().map(|row| row[along])));
                    squares.extend(blurred.map(|x| x * x));
                }
            }
        }
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }
}

impl<'b> Lower<'_, 'b> {
    /// A node that is a function of whole parts, summed over the steps with the others of them.
    pub(in super::super) fn stepped(
        &mut self,
        index: usize,
        uses: &[u32],
    ) -> Option<(Bundle<'b>, Symbol)> {
        let compiler = self.compiler;
        let steps = compiler
            .facts
            .mixtures
            .steps(index)
            .filter(|_| self.mixes())?;
        let ends: Vec<usize> = (steps.ends.iter().copied())
            .filter(|&end| uses[end] > 0)
            .collect();
        let first = self.algebra.next_symbol();
        self.algebra.shares = true;
        let mut axes: Vec<Option<Signal<'b>>> = vec![None; steps.axes()];
        for (coordinate, axis) in steps.coordinates(self).into_iter().zip(&steps.axes) {
            if let Some(axis) = *axis {
                axes[axis].get_or_insert(coordinate);
            }
        }
        let axes: Vec<Signal<'b>> = axes.into_iter().flatten().collect();
        self.image = Some(Image::of_steps(self, steps, &ends));
        let mut rest = (steps.sum)(self, &axes);
        self.image = None;
        self.nonlinear = true;
        let mut own = None;
        for end in ends {
            let others = rest.split_off(compiler.graph.nodes[end].ty.components());
            let bundle = std::mem::replace(&mut rest, others);
            if end == index {
                own = Some((bundle, first));
            } else {
                self.carriers.born(&bundle);
                self.mixed.insert(end, Mixed { bundle, first });
            }
        }
        assert!(own.is_some() && rest.is_empty(), "components of steps");
        own
    }
}
