//! Functions that are evaluated only where they are needed.

use crate::ir::{Bool, Builder, Float, FunctionRef, Module, Scalar, Scalars};

/// A function as the body of a fold of at most one turn.
#[derive(Clone, Debug)]
pub(crate) struct Branch(pub(crate) FunctionRef);

impl Branch {
    /// Of a function that gives numbers; `declare` adds its parameters and gives them.
    pub(crate) fn new(
        module: &mut Module,
        name: impl Into<String>,
        function: &FunctionRef,
        declare: impl for<'b> FnOnce(&'b Builder) -> Vec<Scalar<'b>>,
    ) -> Self {
        let b = &Builder::new(name, "The state becomes the function's value.");
        b.uint_param("index");
        for i in 0..function.results.len() {
            b.float_param(format!("state_{i}"));
        }
        for (i, value) in b.call(function, declare(b)).into_iter().enumerate() {
            b.result(format!("state_{i}"), value);
        }
        Self(b.finish(module))
    }

    /// Of a function that takes so many numbers.
    pub(crate) fn of_numbers(
        module: &mut Module,
        name: &str,
        function: &FunctionRef,
        arguments: usize,
    ) -> Self {
        Self::new(module, format!("{name}_point"), function, |b| {
            (0..arguments)
                .map(|i| b.float_param(format!("x_{i}")).into())
                .collect()
        })
    }

    /// The function's results where `needed` holds, else 0.
    pub(crate) fn taken<'b>(
        &self,
        needed: Bool<'b>,
        arguments: impl Scalars<'b>,
    ) -> Vec<Float<'b>> {
        let b = needed.builder();
        let count = needed.select(1u32, 0u32);
        b.fold(
            &self.0,
            count,
            vec![b.float(0.0); self.0.results.len()],
            arguments,
        )
    }
}
