//! The catalogue of nodes, in the rooms of their categories, beside the kernels that they share with
//! their neighbours: one file each, named as the node type, or a row of the file of its family.
//!
//! A node is its [`NodeSpec`](mipless_graph::NodeSpec) as data, its statistics rule, and a lowering
//! that builds IR through the moment algebra. Nothing else knows a node by name.

/// The nodes of a room, a line each: `clamp,` declares the module of a node and lists its
/// definition; `rounding::floor,` lists a row of a family, whose module the room declares itself;
/// `brick with things,` lists a node that gives things numbers where its function `things` says so;
/// `quantize with steps,` one that is a function of whole parts.
///
/// `cargo fmt` does not look into a macro for modules, so that the files of nodes are named to
/// `rustfmt` one by one: see `.ci/run`.
macro_rules! room {
    (@module $node:ident) => { pub(crate) mod $node; };
    (@module $family:ident::$node:ident) => {};
    (@definition $node:ident) => {
        mipless_codegen::NodeDef::new(&$node::SPEC, $node::lower)
    };
    (@definition $node:ident with things) => {
        mipless_codegen::NodeDef::new(&$node::SPEC, $node::lower).of_things($node::things)
    };
    (@definition $node:ident with steps) => {
        mipless_codegen::NodeDef::new(&$node::SPEC, $node::lower)
            .of_steps(crate::noise::cell::steps::summed)
    };
    (@definition $family:ident::$node:ident) => { $family::$node() };
    ($($file:ident $(::$row:ident)? $(with $sums:ident)?,)*) => {
        $(room! { @module $file $(::$row)? })*

        /// The definitions of the room's nodes, in the order of the reference pages.
        pub(crate) const NODES: &[mipless_codegen::NodeDef] =
            &[$(room! { @definition $file $(::$row)? $(with $sums)? }),*];
    };
}

// Texts of reference pages.
#[macro_use]
mod example;
#[macro_use]
mod literature;

// The rooms.
mod arithmetic;
mod channel;
mod color;
mod coordinate;
mod input;
mod noise;
mod pattern;
mod transfer;

// What several rooms share.
mod componentwise;
mod picture;
mod port;

mod page;

pub use page::{describe, page};

use std::sync::LazyLock;

use mipless_codegen::NodeDef;
use mipless_graph::NodeSpec;

/// The rooms one after another, in the order of the categories.
static CATALOGUE: LazyLock<Vec<NodeDef>> = LazyLock::new(|| {
    [
        input::NODES,
        noise::NODES,
        pattern::NODES,
        arithmetic::NODES,
        transfer::NODES,
        color::NODES,
        coordinate::NODES,
        channel::NODES,
    ]
    .concat()
});

/// The node definitions, in the order of the reference pages: what codegen compiles with.
pub fn catalogue() -> &'static [NodeDef] {
    &CATALOGUE
}

/// The specs of [`catalogue`], in the same order: what documents are resolved with.
pub fn specs() -> Vec<&'static NodeSpec> {
    CATALOGUE.iter().map(|def| def.spec).collect()
}

/// The definition of a node type; aliases are not looked up.
pub fn find(name: &str) -> Option<&'static NodeDef> {
    CATALOGUE.iter().find(|def| def.spec.name == name)
}

#[cfg(test)]
mod tests;
