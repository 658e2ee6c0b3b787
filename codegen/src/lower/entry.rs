//! Entries: each method is a way to make an entry from functions of the graph.

use super::symbols::reads_position;
use super::{Arguments, Compiler, Lower, Method, ahead, sampling};
use crate::ir::{Builder, FOOTPRINT, FunctionRef, Module, Type as Scalar, Value};
use crate::moments::{Branch, Mode};
use mipless_graph::Graph;
use std::ops::Range;

/// The largest change of texture coordinates per pixel that is told apart from an infinite one.
const LARGEST_FOOTPRINT: f32 = 1e9;

/// Adds the entry of the compiled method to the module, as its last function.
pub(super) fn build(compiler: &Compiler<'_>, module: &mut Module, name: &str) {
    let options = compiler.options;
    let graph =
        |module: &mut Module, mode, suffix: &str| graph_function(compiler, module, mode, suffix);
    match options.method {
        Method::Point => entry_over(compiler, module, name, |m| graph(m, Mode::Point, "point").0),
        Method::Naive => entry_over(compiler, module, name, |m| graph(m, Mode::Naive, "naive").0),
        Method::Ensemble => {
            entry_over(compiler, module, name, |m| {
                graph(m, Mode::Ensemble, "ensemble").0
            });
        }
        Method::Local => entry_over(compiler, module, name, |m| graph(m, Mode::Local, "local").0),
        Method::Quad => entry_over(compiler, module, name, |m| graph(m, Mode::Quad, "quad").0),
        Method::Auto => auto(compiler, module, name),
        Method::Supersample(samples) => sampling::supersample(compiler, module, name, samples),
        Method::Split(k) => sampling::split(compiler, module, name, k),
    }
}

/// A function of the graph in one mode; whether anything in it is not linear.
pub(super) fn graph_function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    mode: Mode,
    name: &str,
) -> (FunctionRef, bool) {
    let doc = match mode {
        Mode::Point => "The texture at a point.",
        Mode::Naive => "The texture of the filtered sources.",
        Mode::Ensemble => "The filtered texture, by one variance per source.",
        Mode::Local => "The filtered texture, by means, gradients and remainders.",
        Mode::Quad => "The filtered texture, by means, gradients, Hessians and remainders.",
    };
    // A node makes about so many, most of them short-lived constants and products with 0 and 1.
    let room = 24 * compiler.facts.order.len();
    let b = Builder::new(name, doc).with_capacity(room);
    let mut lower = Lower::new(compiler, module, b, mode);
    lower.run();
    let results = lower.results();
    let nonlinear = lower.nonlinear;
    let mut b = lower.algebra.b;
    for (name, value) in results {
        b.result(name, value);
    }
    (b.finish(module), nonlinear)
}

/// A function of the graph that gives the largest and the smallest footprint of its sources that
/// matter, in wavelengths: `None` without sources.
pub(super) fn footprint_function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    name: &str,
    reduce: impl Fn(&mut Builder, &[Value]) -> Value,
) -> Option<FunctionRef> {
    let doc = "What the footprint is to the sources, in their wavelengths.";
    let mut lower = Lower::new(compiler, module, Builder::new(name, doc), Mode::Local);
    lower.run_sources();
    let footprints = std::mem::take(&mut lower.footprints);
    let mut b = lower.algebra.b;
    if footprints.is_empty() {
        return None;
    }
    let reduced = reduce(&mut b, &footprints);
    b.result("result", reduced);
    Some(b.finish(module))
}

/// The entry that passes a footprint made finite on to one function.
fn entry_over(
    compiler: &Compiler<'_>,
    module: &mut Module,
    name: &str,
    function: impl FnOnce(&mut Module) -> FunctionRef,
) {
    let function = function(module);
    let mut b = Builder::new(name, "The texture over a footprint.");
    let arguments = Arguments::declare(&mut b, compiler.graph);
    let mut arguments = finite(&mut b, compiler.graph, &arguments);
    if compiler.options.method == Method::Point {
        // A point has no footprint, and needs none that is finite.
        for place in places(compiler.graph) {
            arguments[place.changes()].fill(b.f32(0.0));
        }
    }
    let results = b.call(&function, &arguments);
    finish(module, b, &function, &results);
}

/// The magnitude from which on a result has lost its meaning: what squares it overflows.
const LARGEST_RESULT: f32 = 1e38;

/// A result, or 0 where it overflows: parameters may be as extreme as footprints.
pub(super) fn guarded(b: &mut Builder, value: Value) -> Value {
    if b.ty(value) != Scalar::F32 || b.as_constant(value).is_some() {
        return value;
    }
    let (limit, zero) = (b.f32(LARGEST_RESULT), b.f32(0.0));
    let magnitude = b.abs(value);
    let within = b.lt(magnitude, limit);
    b.select(within, value, zero)
}

pub(super) fn finish(module: &mut Module, mut b: Builder, like: &FunctionRef, results: &[Value]) {
    let names: Vec<String> = module
        .function(like.id)
        .results
        .iter()
        .map(|(name, _)| name.clone())
        .collect();
    for (name, &value) in names.into_iter().zip(results) {
        let value = guarded(&mut b, value);
        b.result(name, value);
    }
    b.finish(module);
}

/// Where among the arguments a place stands: cells, fractions, and the changes of all axes from a
/// pixel to the next one to the right, and to the one below.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    first: usize,
    pub(super) axes: usize,
}

impl Place {
    pub(super) fn cell(self, axis: usize) -> usize {
        self.first + axis
    }

    pub(super) fn fraction(self, axis: usize) -> usize {
        self.first + self.axes + axis
    }

    /// Of all axes to the right, then of all axes down.
    pub(super) fn changes(self) -> Range<usize> {
        let first = self.first + 2 * self.axes;
        first..first + 2 * self.axes
    }
}

/// The places among the arguments: in texture space, and in space if the graph reads it.
pub(super) fn places(graph: &Graph) -> impl Iterator<Item = Place> {
    let space = Place {
        first: FOOTPRINT.len(),
        axes: 3,
    };
    let texture = Place { first: 0, axes: 2 };
    std::iter::once(texture).chain(reads_position(graph).then_some(space))
}

/// The arguments with a footprint that is finite: one that is not is taken for the largest, whose
/// filtered values are the far field's.
pub(super) fn finite(b: &mut Builder, graph: &Graph, arguments: &Arguments) -> Vec<Value> {
    let mut all = arguments.all();
    let limit = b.f32(LARGEST_FOOTPRINT);
    let zero = b.f32(0.0);
    for place in places(graph) {
        let mut regular = b.bool(true);
        for &value in &all[place.changes()] {
            let magnitude = b.abs(value);
            let within = b.lt(magnitude, limit);
            regular = b.and(regular, within);
        }
        for (i, at) in place.changes().enumerate() {
            // The first axis changes to the right, the second one down.
            let far = if i == 0 || i == place.axes + 1 {
                limit
            } else {
                zero
            };
            all[at] = b.select(regular, all[at], far);
        }
        for axis in 0..place.axes {
            let value = &mut all[place.fraction(axis)];
            let magnitude = b.abs(*value);
            let within = b.lt(magnitude, limit);
            *value = b.select(within, *value, zero);
        }
    }
    all
}

/// `quad` where a source's footprint lies between 0.02 and 0.6 wavelengths and something that is
/// not linear follows, else `local`: a branch between two functions.
fn auto(compiler: &Compiler<'_>, module: &mut Module, name: &str) {
    let other = (Mode::Quad, "quad");
    let ((local, band), ahead) = ahead::both(compiler, module, other, |module| {
        let (local, nonlinear) = graph_function(compiler, module, Mode::Local, "local");
        let band = nonlinear.then(|| footprint_function(compiler, module, "bends", within_band));
        (local, band.flatten())
    });
    let Some(band) = band else {
        return entry_over(compiler, module, name, |_| local);
    };
    let quad = (ahead.and_then(|ahead| ahead.join(compiler, module)))
        .unwrap_or_else(|| graph_function(compiler, module, other.0, other.1).0);
    let branches = [(&local, "by_local"), (&quad, "by_quad")].map(|(function, suffix)| {
        let declare = |b: &mut Builder| Arguments::declare(b, compiler.graph).all();
        Branch::new(module, suffix, function, declare)
    });
    let mut b = Builder::new(name, "The texture over a footprint.");
    let arguments = Arguments::declare(&mut b, compiler.graph);
    let arguments = finite(&mut b, compiler.graph, &arguments);
    let bends = b.call(&band, &arguments)[0];
    let (zero, one) = (b.u32(0), b.u32(1));
    let none = b.f32(0.0);
    let mut state = vec![none; local.results.len()];
    for (branch, [yes, no]) in branches.iter().zip([[zero, one], [one, zero]]) {
        let count = b.select(bends, yes, no);
        state = b.fold(&branch.0, count, &state, &arguments);
    }
    finish(module, b, &local, &state);
}

/// Whether a footprint lies where `quad` pays.
fn within_band(b: &mut Builder, footprints: &[Value]) -> Value {
    let (low, high) = (b.f32(0.02), b.f32(0.6));
    let within = |b: &mut Builder, &footprint: &Value| {
        let above = b.lt(low, footprint);
        let below = b.lt(footprint, high);
        b.and(above, below)
    };
    let mut any = within(b, &footprints[0]);
    for footprint in &footprints[1..] {
        let within = within(b, footprint);
        any = b.or(any, within);
    }
    any
}
