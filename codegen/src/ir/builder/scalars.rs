//! Values that pass the boundary of a function: scalars whose types are known at run time, and what is
//! made of several.

use super::{Bool, Builder, Expr, Float, Int, Kind, Uint};
use crate::ir::{Constant, Type, Value};
use std::fmt;

/// A scalar of any type.
#[derive(Clone, Copy)]
pub struct Scalar<'b> {
    builder: &'b Builder,
    value: Value,
}

impl fmt::Debug for Scalar<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "v{}", self.value.index())
    }
}

impl<'b, T: Kind> From<Expr<'b, T>> for Scalar<'b> {
    fn from(expression: Expr<'b, T>) -> Self {
        Self::new(expression.builder(), expression.value())
    }
}

impl<'b> Scalar<'b> {
    pub(in crate::ir) fn new(builder: &'b Builder, value: Value) -> Self {
        Self { builder, value }
    }

    pub(crate) fn value(self) -> Value {
        self.value
    }

    /// The type.
    pub fn ty(self) -> Type {
        self.builder.ty(self.value)
    }

    /// The constant that this is, if it is one.
    pub(in crate::ir) fn constant(self) -> Option<Constant> {
        self.builder.constant_of(self.value)
    }

    /// The expression of this type.
    ///
    /// # Panics
    /// If it is of another type: a bug of the caller.
    pub fn of_kind<T: Kind>(self) -> Expr<'b, T> {
        assert_eq!(self.ty(), T::TYPE, "{self:?}");
        Expr::new(self.builder, self.value)
    }

    /// The real number that this is. Panics if it is none.
    pub fn float(self) -> Float<'b> {
        self.of_kind()
    }

    /// The signed integer that this is. Panics if it is none.
    pub fn int(self) -> Int<'b> {
        self.of_kind()
    }

    /// The unsigned integer that this is. Panics if it is none.
    pub fn uint(self) -> Uint<'b> {
        self.of_kind()
    }

    /// The truth value that this is. Panics if it is none.
    pub fn bool(self) -> Bool<'b> {
        self.of_kind()
    }
}

/// What is made of scalars: an expression, or several of them in an array, a vector or a tuple. It is
/// what functions take as arguments and folds as their state.
pub trait Scalars<'b> {
    /// Calls `visit` with each scalar, in order.
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>));

    /// The same shape of other scalars, of the same types.
    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self
    where
        Self: Sized;

    /// The values, in order.
    #[doc(hidden)]
    fn values(&self) -> Vec<Value> {
        let mut values = Vec::new();
        self.each(&mut |scalar| values.push(scalar.value()));
        values
    }

    /// The scalars, in order.
    fn scalars(&self) -> Vec<Scalar<'b>> {
        let mut scalars = Vec::new();
        self.each(&mut |scalar| scalars.push(scalar));
        scalars
    }
}

impl<'b> Scalars<'b> for Scalar<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        visit(*self);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let other = next();
        assert_eq!(other.ty(), self.ty());
        other
    }
}

impl<'b, T: Kind> Scalars<'b> for Expr<'b, T> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        visit((*self).into());
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        next().of_kind()
    }
}

impl<'b, S: Scalars<'b>, const N: usize> Scalars<'b> for [S; N] {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.iter().for_each(|part| part.each(visit));
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        self.map(|part| part.replaced(next))
    }
}

impl<'b, S: Scalars<'b>> Scalars<'b> for Vec<S> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.iter().for_each(|part| part.each(visit));
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        self.into_iter().map(|part| part.replaced(next)).collect()
    }
}

impl<'b, S: Scalars<'b>> Scalars<'b> for Option<S> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.iter().for_each(|part| part.each(visit));
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        self.map(|part| part.replaced(next))
    }
}

/// What functions take alone, as captures: a reference to what is made of scalars.
impl<'b, S: Scalars<'b> + ?Sized> Scalars<'b> for &S {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        (**self).each(visit);
    }

    fn replaced(self, _: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        unreachable!("a state is owned")
    }
}

impl<'b, S: Scalars<'b>> Scalars<'b> for [S] {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.iter().for_each(|part| part.each(visit));
    }
}

macro_rules! tuples {
    ($(($($name:ident)*))*) => {
        $(impl<'b, $($name: Scalars<'b>),*> Scalars<'b> for ($($name,)*) {
            #[expect(non_snake_case, reason = "the names of the types")]
            fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
                let ($($name,)*) = self;
                $($name.each(visit);)*
            }

            #[expect(non_snake_case, reason = "the names of the types")]
            fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
                let ($($name,)*) = self;
                ($($name.replaced(next),)*)
            }
        })*
    };
}

tuples! { (A) (A B) (A B C) (A B C D) (A B C D E) (A B C D E F) (A B C D E F G) (A B C D E F G H) }

impl<'b> Scalars<'b> for () {
    fn each(&self, _: &mut dyn FnMut(Scalar<'b>)) {}

    fn replaced(self, _: &mut dyn FnMut() -> Scalar<'b>) -> Self {}
}
