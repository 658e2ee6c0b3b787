//! Entries: each method is a way to make an entry from functions of the graph.

use super::finish::finish;
use super::function::{footprint_function, graph_function};
use super::place::{finite, places};
use super::{Arguments, Compiler, Method, ahead, sampling};
use crate::ir::{Builder, FunctionRef, Module, Value};
use crate::moments::{Branch, Mode};

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
