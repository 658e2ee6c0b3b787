//! The results of an entry.

use crate::ir::{Builder, Float, FunctionRef, Module};

/// The magnitude from which on a result has lost its meaning: what squares it overflows.
const LARGEST_RESULT: f32 = 1e38;

/// A result, or 0 where it overflows: parameters may be as extreme as footprints.
pub(super) fn guarded(value: Float<'_>) -> Float<'_> {
    if value.as_constant().is_some() {
        return value;
    }
    value.abs().lt(LARGEST_RESULT).select(value, 0.0)
}

/// The names of a function's results.
pub(super) fn result_names(module: &Module, function: &FunctionRef) -> Vec<String> {
    let results = &module.function(function.id).results;
    results.iter().map(|(name, _)| name.clone()).collect()
}

/// Makes `results`, named as those of the function `like`, the results of the entry.
pub(super) fn finish(
    module: &mut Module,
    b: &Builder,
    like: &FunctionRef,
    results: Vec<Float<'_>>,
) {
    for (name, value) in result_names(module, like).into_iter().zip(results) {
        b.result(name, guarded(value));
    }
    b.finish(module);
}
