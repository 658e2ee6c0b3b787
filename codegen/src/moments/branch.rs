//! Functions that are evaluated only where they are needed.

use crate::ir::{Builder, FunctionRef, Module, Type, Value};

/// A function as the body of a fold of at most one turn.
#[derive(Clone, Debug)]
pub(crate) struct Branch(pub(crate) FunctionRef);

impl Branch {
    /// Of a function that gives numbers; `declare` adds its parameters and gives them.
    pub(crate) fn new(
        module: &mut Module,
        name: impl Into<String>,
        function: &FunctionRef,
        declare: impl FnOnce(&mut Builder) -> Vec<Value>,
    ) -> Self {
        let mut b = Builder::new(name, "The state becomes the function's value.");
        b.param("index", Type::U32);
        for i in 0..function.results.len() {
            b.param_f32(format!("state_{i}"));
        }
        let arguments = declare(&mut b);
        for (i, &value) in b.call(function, &arguments).iter().enumerate() {
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
                .map(|i| b.param_f32(format!("x_{i}")))
                .collect()
        })
    }

    /// The function's results where `needed` holds, else 0.
    pub(crate) fn taken(&self, b: &mut Builder, needed: Value, arguments: &[Value]) -> Vec<Value> {
        let (none, once, zero) = (b.u32(0), b.u32(1), b.f32(0.0));
        let count = b.select(needed, once, none);
        let init = vec![zero; self.0.results.len()];
        b.fold(&self.0, count, &init, arguments)
    }
}
