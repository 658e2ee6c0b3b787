//! Entries: each method is a way to make an entry from functions of the graph.

use super::finish::finish;
use super::function::{footprint_function, graph_function};
use super::{Arguments, Compiler, Method, ahead, sampling};
use crate::ir::{Bool, Builder, Float, FunctionRef, Module, Scalar, Scalars};
use crate::moments::{Branch, Mode};

/// Adds the entry of the compiled method to the module, as its last function.
pub(super) fn build(compiler: &Compiler<'_>, module: &mut Module, name: &str) {
    let (mode, suffix) = match compiler.options.method {
        Method::Point => (Mode::Point, "point"),
        Method::Naive => (Mode::Naive, "naive"),
        Method::Ensemble => (Mode::Ensemble, "ensemble"),
        Method::Local => (Mode::Local, "local"),
        Method::Quad => (Mode::Quad, "quad"),
        Method::Auto => return auto(compiler, module, name),
        Method::Supersample(samples) => {
            return sampling::supersample(compiler, module, name, samples);
        }
        Method::Split(k) => return sampling::split(compiler, module, name, k),
    };
    let (function, _) = graph_function(compiler, module, mode, suffix);
    entry_over(compiler, module, name, &function);
}

/// The entry that passes a footprint made finite on to one function.
fn entry_over(compiler: &Compiler<'_>, module: &mut Module, name: &str, function: &FunctionRef) {
    let b = &Builder::new(name, "The texture over a footprint.");
    let mut arguments = Arguments::declare(b, compiler.graph).finite();
    if compiler.options.method == Method::Point {
        // A point has no footprint, and needs none that is finite.
        arguments = arguments.at_point();
    }
    let results = b.call(function, arguments);
    finish(module, b, function, results);
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
        return entry_over(compiler, module, name, &local);
    };
    let quad = (ahead.and_then(|ahead| ahead.join(compiler, module)))
        .unwrap_or_else(|| graph_function(compiler, module, other.0, other.1).0);
    let [by_local, by_quad] = [(&local, "by_local"), (&quad, "by_quad")].map(|(function, name)| {
        Branch::new(module, name, function, |b| {
            Arguments::declare(b, compiler.graph).scalars()
        })
    });
    let b = &Builder::new(name, "The texture over a footprint.");
    let arguments = Arguments::declare(b, compiler.graph).finite();
    let bends = b.call_any(&band, &arguments)[0].bool();
    let state = vec![b.float(0.0); local.results.len()];
    let state = b.fold(&by_local.0, bends.select(0u32, 1u32), state, &arguments);
    let state = b.fold(&by_quad.0, bends.select(1u32, 0u32), state, &arguments);
    finish(module, b, &local, state);
}

/// Whether a footprint lies where `quad` pays.
fn within_band<'b>(footprints: &[Float<'b>]) -> Scalar<'b> {
    let within = |footprint: &Float<'b>| footprint.gt(0.02) & footprint.lt(0.6);
    let any: Option<Bool<'b>> = footprints.iter().map(within).reduce(|any, one| any | one);
    any.expect("there are footprints").into()
}
