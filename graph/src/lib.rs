//! The JSON texture graph: document, types, node specs, resolved graph, checks and diagnostics.

mod graph;
mod spec;
mod types;

pub use graph::{Graph, Input, Node, NodeId, Output, Parameter, ParameterId, Source};
pub use spec::{
    Behaviour, Category, ClassRule, Default, Doc, InputView, NodeSpec, OutputType, PortSpec,
    PortType, Range,
};
pub use types::{Literal, Stop, Stops, Type};
