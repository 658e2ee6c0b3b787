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

/// A port that takes two numbers.
pub(crate) const fn pair(name: &'static str, default: [f32; 2], doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Vector2);
    PortSpec::new(name, ty, Default::Vector2(default), doc)
}

/// Texture coordinates, those of the surface where nothing is connected.
pub(crate) const fn surface(doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Vector2);
    PortSpec::new("texcoord", ty, Default::Surface, doc).unit("uv")
}

/// A port that takes a whole number.
pub(crate) const fn integer(name: &'static str, default: i32, doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Integer);
    PortSpec::new(name, ty, Default::Integer(default), doc)
}

/// A port that takes a truth value.
pub(crate) const fn flag(name: &'static str, default: bool, doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Boolean);
    PortSpec::new(name, ty, Default::Boolean(default), doc)
}

/// A port that takes one of several names.
pub(crate) const fn choice(
    name: &'static str,
    names: &'static [&'static str],
    default: &'static str,
    doc: &'static str,
) -> PortSpec {
    PortSpec::new(name, PortType::Choice(names), Default::Choice(default), doc)
}
