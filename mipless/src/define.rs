//! All that a node of a tool's own is made of: see [`Catalogue`](crate::Catalogue) for an example.
//!
//! A definition is a [`NodeSpec`] (ports, types, ranges, the rules of what values it can have and of its
//! class) and a function that builds its output from the signals of its inputs, `lower.bundle(node, port)`,
//! by `lower.algebra`: sums, products, transfers ([`Piecewise`], [`Curve`], or a [`Transfer`] of your own),
//! so that every method, the CPU and every shader language come of it.

pub use mipless_codegen::ir::{Bool, Builder, Float, Int, Numbers, Sym2, Uint, Vec2};
pub use mipless_codegen::moments::{
    Algebra, Curve, Gaussian, LinearWave, Moments, Piecewise, Signal, Transfer,
};
pub use mipless_codegen::{Bundle, Lower, NodeDef, NodeRule, SumOfSteps};
pub use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Interval, Node, NodeSpec, OutputType, PortSpec,
    PortType, Range, Reach, Type,
};
