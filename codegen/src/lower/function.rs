//! Functions of the graph: what it is in one mode, and what a footprint is to its sources.

use super::{Compiler, Lower};
use crate::ir::{Builder, FunctionRef, Module, Value};
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
