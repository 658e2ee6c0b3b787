//! The results of an entry.

use crate::ir::{Builder, FunctionRef, Module, Type as Scalar, Value};

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
