//! What choices by comparison share.

use mipless_graph::{Default, PortSpec, PortType, Range, Type};

/// What is compared, and the results.
pub(crate) const CHOICE: &[PortSpec] = &[
    PortSpec::new(
        "value1",
        PortType::Exactly(Type::Float),
        Default::Float(1.0),
        "The first number that is compared.",
    )
    .range(Range::soft(-1.0, 1.0)),
    PortSpec::new(
        "value2",
        PortType::Exactly(Type::Float),
        Default::Float(0.0),
        "The second number that is compared.",
    )
    .range(Range::soft(-1.0, 1.0)),
    PortSpec::new(
        "in1",
        PortType::Any,
        Default::Float(0.0),
        "The result where the condition holds.",
    ),
    PortSpec::new(
        "in2",
        PortType::Any,
        Default::Float(0.0),
        "The result elsewhere.",
    ),
];
