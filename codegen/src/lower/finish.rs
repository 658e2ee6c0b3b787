//! The results of an entry.

use crate::ir::{Builder, Float, FunctionRef, Module};

/// The largest magnitude of a result: parameters may be as extreme as footprints.
const LARGEST_RESULT: f32 = 1e38;

/// A result, limited to what a number can be told from infinity; 0 where it is no number.
pub(super) fn guarded(value: Float<'_>) -> Float<'_> {
    if value.as_constant().is_some() {
        return value;
    }
    let beyond = value.ge(LARGEST_RESULT).select(LARGEST_RESULT, 0.0);
    let beyond = value.le(-LARGEST_RESULT).select(-LARGEST_RESULT, beyond);
    value.abs().lt(LARGEST_RESULT).select(value, beyond)
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
