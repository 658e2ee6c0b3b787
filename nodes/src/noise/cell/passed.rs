//! Structs of scalars that pass the boundaries of functions: what a fold's body takes.

use mipless_codegen::ir::{Builder, Scalars};

/// What passes as parameters that have the names of its fields, in their order.
pub(crate) trait Passed<'b>: Scalars<'b> {
    /// The parameters of a function that takes it over.
    fn declare(b: &'b Builder) -> Self;
}

/// Defines a struct of scalars that implements [`Passed`].
macro_rules! passed {
    ($(#[$doc:meta])* $visibility:vis struct $name:ident {
        $($(#[$about:meta])* $field:ident: $ty:ident,)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        $visibility struct $name<'b> {
            $($(#[$about])* $visibility $field: $ty<'b>,)*
        }

        impl<'b> mipless_codegen::ir::Scalars<'b> for $name<'b> {
            fn each(&self, visit: &mut dyn FnMut(mipless_codegen::ir::Scalar<'b>)) {
                $(self.$field.each(visit);)*
            }

            fn replaced(self, next: &mut dyn FnMut() -> mipless_codegen::ir::Scalar<'b>) -> Self {
                Self { $($field: self.$field.replaced(next),)* }
            }
        }

        impl<'b> $crate::noise::cell::passed::Passed<'b> for $name<'b> {
            fn declare(b: &'b mipless_codegen::ir::Builder) -> Self {
                Self { $($field: b.param(stringify!($field)),)* }
            }
        }
    };
}
pub(crate) use passed;
