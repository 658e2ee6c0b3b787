//! Functions of the whole graph, of which entries are made.

use super::{Compiler, Lower};
use crate::ir::{Float, FunctionRef, Module, Scalar};
use crate::moments::Mode;

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
    let b = &compiler.builder(name, doc).with_capacity(room);
    let mut lower = Lower::new(compiler, module, b, mode);
    lower.run();
    for (name, value) in lower.results() {
        b.result(name, value);
    }
    let nonlinear = lower.nonlinear;
    (b.finish(module), nonlinear)
}

/// A function of the graph that gives what `reduce` makes of the footprints of its sources that
/// matter, in wavelengths: `None` without sources.
pub(super) fn footprint_function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    name: &str,
    reduce: impl for<'b> Fn(&[Float<'b>]) -> Scalar<'b>,
) -> Option<FunctionRef> {
    let doc = "What the footprint is to the sources, in their wavelengths.";
    let b = &compiler.builder(name, doc);
    let mut lower = Lower::new(compiler, module, b, Mode::Local);
    lower.run_sources();
    let footprints = std::mem::take(&mut lower.footprints);
    if footprints.is_empty() {
        return None;
    }
    b.result("result", reduce(&footprints));
    Some(b.finish(module))
}
