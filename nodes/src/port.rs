//! Ports by what they take and hold, for the specs of nodes.

use mipless_graph::{Default, PortSpec, PortType, Type};

/// A port of any type, with a number in each component.
pub(crate) const fn any(name: &'static str, default: f32, doc: &'static str) -> PortSpec {
    PortSpec::new(name, PortType::Any, Default::Float(default), doc)
}

/// A port of a type, with a number in each component.
pub(crate) const fn exactly(
    ty: Type,
    name: &'static str,
    default: f32,
    doc: &'static str,
) -> PortSpec {
    PortSpec::new(name, PortType::Exactly(ty), Default::Float(default), doc)
}

/// A port that takes one number.
pub(crate) const fn number(name: &'static str, default: f32, doc: &'static str) -> PortSpec {
    exactly(Type::Float, name, default, doc)
}
