//! The JSON texture graph: document, types, node specs, resolved graph, checks and diagnostics.
//!
//! ```text
//! text ──parse──► Document ──resolve──► Graph ──check──► Checked
//! ```
//!
//! A [`Document`] is what is written in a file: names, literals, whatever an editor keeps. Tools
//! edit it and save it. [`resolve()`] looks names up in a list of [`NodeSpec`]s and gives a
//! [`Graph`]: ids, types, defaults, sub-graphs expanded, nodes in topological order. [`check()`]
//! gives each signal its statistics class and returns a [`Checked`], which only it can make; what
//! takes a `Checked` cannot fail on user input. [`load`] does the first two steps for text.
//!
//! Mistakes of the user are [`Diagnostic`]s, all of one run together. Bugs are panics.
//! Nothing in the crate recurses over the user's graph.

mod check;
mod diagnostic;
mod document;
mod graph;
mod image;
mod load;
mod reach;
mod resolve;
mod schema;
mod setting;
mod spec;
mod types;

pub use check::{CheckOptions, Checked, Class, Correlation, Signal, Sources, check};
pub use diagnostic::{Diagnostic, Severity, suggest};
pub use document::{Binding, Body, Document, InputEntry, Map, NodeEntry, Reference, VERSION};
pub use graph::{Graph, Input, Node, NodeId, Output, Parameter, ParameterId, Source};
pub use image::{FileReference, Images, Picture};
pub use load::{Loaded, load, load_with};
pub use reach::{Interval, Reach};
pub use resolve::{Draft, MAX_NESTING, MAX_NODES, draft, linear_from_srgb, resolve};
pub use schema::schema;
pub use setting::{SettingError, parse_setting};
pub use spec::{
    Behaviour, Category, ClassRule, Default, Doc, InputView, MaterialPart, NodeSpec, OutputType,
    PortSpec, PortType, Range, ReachRule,
};
pub use types::{Literal, Stop, Stops, Type};

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
