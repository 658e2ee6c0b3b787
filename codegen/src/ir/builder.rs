//! What code builds functions through: a builder that hands out expressions.
//!
//! A [`Builder`] is one function under construction. It is used through shared references, so that the
//! expressions that it hands out ([`super::Expr`]) live side by side and are written as formulas.

mod expression;
mod scalars;

pub use expression::{Bool, Choice, Expr, Float, Int, Kind, Operand, Uint};
pub use scalars::{Scalar, Scalars};

use super::build::Core;
use super::library::{Argument, Pattern};
use super::{Constant, FunctionRef, Label, Library, Module, Op, Type, Value};
use std::cell::RefCell;
use std::fmt;

/// A function under construction.
pub struct Builder {
    core: RefCell<Core>,
    /// The functions that the module's functions share, where it has any.
    library: Option<Library>,
}

impl fmt::Debug for Builder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.core.borrow().fmt(f)
    }
}

impl Builder {
    /// An empty function; `doc` is one sentence.
    pub fn new(name: impl Into<String>, doc: impl Into<String>) -> Self {
        Self {
            core: RefCell::new(Core::new(name, doc)),
            library: None,
        }
    }

    /// Room for so many instructions.
    pub(crate) fn with_capacity(self, instructions: usize) -> Self {
        Self {
            core: RefCell::new(self.core.into_inner().with_capacity(instructions)),
            ..self
        }
    }

    /// Shared rules become calls of functions of `library` from here on.
    pub(crate) fn with_library(self, library: Library) -> Self {
        Self {
            library: Some(library),
            ..self
        }
    }

    /// The functions that the module's functions share; where there are none, shared rules are built
    /// in place.
    pub(crate) fn library(&self) -> Option<&Library> {
        self.library.as_ref()
    }

    /// The constant `x`. −0 becomes 0.
    pub fn float(&self, x: f32) -> Float<'_> {
        self.literal(x)
    }

    /// The constant `x`.
    pub fn int(&self, x: i32) -> Int<'_> {
        self.literal(x)
    }

    /// The constant `x`.
    pub fn uint(&self, x: u32) -> Uint<'_> {
        self.literal(x)
    }

    /// A constant of any type.
    pub fn literal<T: Kind>(&self, x: T) -> Expr<'_, T> {
        let value = self.core.borrow_mut().constant(T::TYPE, x.bits());
        Expr::new(self, value)
    }

    /// A constant of a type that is known at run time.
    pub(super) fn scalar(&self, constant: Constant) -> Scalar<'_> {
        let value = (self.core.borrow_mut()).constant(constant.ty, constant.bits);
        Scalar::new(self, value)
    }

    /// A further parameter of a real number.
    pub fn float_param(&self, name: impl Into<String>) -> Float<'_> {
        self.param(name)
    }

    /// Further f32 parameters.
    pub fn float_params<const N: usize>(&self, names: [impl Into<String>; N]) -> [Float<'_>; N] {
        names.map(|name| self.float_param(name))
    }

    /// A further parameter of a signed integer.
    pub fn int_param(&self, name: impl Into<String>) -> Int<'_> {
        self.param(name)
    }

    /// A further parameter of an unsigned integer.
    pub fn uint_param(&self, name: impl Into<String>) -> Uint<'_> {
        self.param(name)
    }

    /// A further parameter.
    pub fn param<T: Kind>(&self, name: impl Into<String>) -> Expr<'_, T> {
        let value = self.core.borrow_mut().param(name, T::TYPE);
        Expr::new(self, value)
    }

    /// A further parameter of a type that is known at run time.
    pub fn scalar_param(&self, name: impl Into<String>, ty: Type) -> Scalar<'_> {
        let value = self.core.borrow_mut().param(name, ty);
        Scalar::new(self, value)
    }

    /// Gives a value a readable name, unless it is a constant or a parameter or has a name.
    pub fn name<'b>(&'b self, value: impl Into<Scalar<'b>>, name: impl Into<Label>) {
        let value = value.into().value();
        self.core.borrow_mut().name(value, name);
    }

    /// A further result.
    pub fn result<'b>(&'b self, name: impl Into<String>, value: impl Into<Scalar<'b>>) {
        let value = value.into().value();
        self.core.borrow_mut().result(name, value);
    }

    /// Further results by their names.
    pub fn results<'b, N: Into<String>, S: Into<Scalar<'b>>>(
        &'b self,
        names: impl IntoIterator<Item = N>,
        values: impl IntoIterator<Item = S>,
    ) {
        for (name, value) in names.into_iter().zip(values) {
            self.result(name, value);
        }
    }

    /// The results of the body of a fold that adds up: each number of the state more by its part.
    pub fn sums<'b, N: Into<String>>(
        &'b self,
        names: impl IntoIterator<Item = N>,
        state: impl IntoIterator<Item = Float<'b>>,
        parts: impl IntoIterator<Item = Float<'b>>,
    ) {
        let sums = state.into_iter().zip(parts).map(|(sum, part)| sum + part);
        self.results(names, sums);
    }

    /// The sum; 0 of nothing.
    pub fn sum<'b>(&'b self, terms: impl IntoIterator<Item = Float<'b>>) -> Float<'b> {
        let sum = terms.into_iter().reduce(|sum, term| sum + term);
        sum.unwrap_or_else(|| self.float(0.0))
    }

    /// `module.tables[table].data[index]`.
    pub fn load<'b>(&'b self, table: u32, index: Uint<'b>) -> Float<'b> {
        let value = self.core.borrow_mut().load(table, index.value());
        Expr::new(self, value)
    }

    /// The results of a call, real numbers all.
    pub fn call<'b>(
        &'b self,
        function: &FunctionRef,
        arguments: impl Scalars<'b>,
    ) -> Vec<Float<'b>> {
        let results = self.call_any(function, arguments);
        results.into_iter().map(Scalar::float).collect()
    }

    /// The results of a call.
    pub fn call_any<'b>(
        &'b self,
        function: &FunctionRef,
        arguments: impl Scalars<'b>,
    ) -> Vec<Scalar<'b>> {
        let arguments = arguments.values();
        self.call_values(function, arguments.into_boxed_slice())
    }

    pub(super) fn call_values(
        &self,
        function: &FunctionRef,
        arguments: Box<[Value]>,
    ) -> Vec<Scalar<'_>> {
        let results = self.core.borrow_mut().call_with(function, arguments);
        results
            .into_iter()
            .map(|value| Scalar::new(self, value))
            .collect()
    }

    /// The last state of a fold, in the shape of the first one: see [`super::Inst::Fold`].
    ///
    /// # Panics
    /// If the state is not the function's: a bug of the caller.
    pub fn fold<'b, S: Scalars<'b>>(
        &'b self,
        body: &FunctionRef,
        count: Uint<'b>,
        init: S,
        captures: impl Scalars<'b>,
    ) -> S {
        let (start, captures) = (init.values(), captures.values());
        let last = (self.core.borrow_mut()).fold(body, count.value(), &start, &captures);
        let mut last = last.into_iter();
        init.replaced(&mut || Scalar::new(self, last.next().expect("a result for each part")))
    }

    /// Adds the function to `module`, without the instructions that no result needs. The builder is
    /// empty from here on.
    pub fn finish(&self, module: &mut Module) -> FunctionRef {
        self.taken().finish(module)
    }

    /// What was built; the builder is empty from here on.
    pub(super) fn taken(&self) -> Core {
        self.core.replace(Core::new("", ""))
    }

    /// An op that is known at run time.
    #[cfg(test)]
    pub(crate) fn dynamic<'b>(&'b self, op: Op, operands: &[Scalar<'b>]) -> Scalar<'b> {
        let operands: Vec<Value> = operands.iter().map(|operand| operand.value()).collect();
        Scalar::new(self, self.op(op, &operands))
    }

    /// What arguments are to a shared function.
    pub(super) fn arguments(&self, values: impl Iterator<Item = Value>) -> Pattern {
        let core = self.core.borrow();
        values.map(|value| Argument::of(&core, value)).collect()
    }

    pub(super) fn op(&self, op: Op, operands: &[Value]) -> Value {
        self.core.borrow_mut().op(op, operands)
    }

    pub(super) fn ty(&self, value: Value) -> Type {
        self.core.borrow().ty(value)
    }

    pub(super) fn constant_of(&self, value: Value) -> Option<Constant> {
        self.core.borrow().constant_of(value)
    }
}
