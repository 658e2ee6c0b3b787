//! A few node types for the tests of this crate.

use crate::{
    Behaviour, Category, Default, Doc, InputView, NodeSpec, OutputType, PortSpec, PortType, Range,
    Reach, Type,
};

const NO_DOC: Doc = Doc {
    computes: "",
    statistics: "",
    accuracy: "",
    references: "",
};
const TEXCOORD: PortSpec = PortSpec::new(
    "texcoord",
    PortType::Exactly(Type::Vector2),
    Default::Surface,
    "Where it is read.",
)
.unit("uv");

const fn any(name: &'static str, default: f32) -> PortSpec {
    PortSpec::new(name, PortType::Any, Default::Float(default), "A signal.")
}

const fn spec(
    name: &'static str,
    inputs: &'static [PortSpec],
    output: OutputType,
    class: fn(&dyn InputView) -> Behaviour,
) -> NodeSpec {
    NodeSpec {
        name,
        aliases: &[],
        category: Category::Arithmetic,
        summary: "A node for tests.",
        doc: NO_DOC,
        inputs,
        output,
        reach: |_| Reach::ANY,
        class,
        example: "{}",
    }
}

const FLOAT: OutputType = OutputType::Exactly(Type::Float);

static PICTURE: NodeSpec = spec(
    "picture",
    &[
        PortSpec::new(
            "file",
            PortType::Exactly(Type::Filename),
            Default::Text(""),
            "A picture.",
        ),
        PortSpec::new(
            "signature",
            PortType::Choice(&["color3", "float"]),
            Default::Choice("color3"),
            "A type.",
        ),
    ],
    OutputType::Named("signature"),
    |_| Behaviour::Pattern,
);
static TEXCOORD_NODE: NodeSpec = spec("texcoord", &[], OutputType::Exactly(Type::Vector2), |_| {
    Behaviour::Position
});
static FRACTAL: NodeSpec = NodeSpec {
    aliases: &["fbm"],
    ..spec(
        "fractal2d",
        &[
            TEXCOORD,
            PortSpec::new(
                "frequency",
                PortType::Exactly(Type::Float),
                Default::Float(1.0),
                "Scale.",
            )
            .range(Range::hard(0.0, 1e6)),
            PortSpec::new(
                "octaves",
                PortType::Exactly(Type::Integer),
                Default::Integer(3),
                "Count.",
            )
            .range(Range::hard(1.0, 16.0))
            .uniform(),
            PortSpec::new(
                "kernel",
                PortType::Choice(&["gaussian", "quadrupole"]),
                Default::Choice("gaussian"),
                "Shape.",
            ),
        ],
        FLOAT,
        |_| Behaviour::Gaussian { deviation: 0.0046 },
    )
};
static CELLS: NodeSpec = spec(
    "cells",
    &[
        TEXCOORD,
        PortSpec::new(
            "output",
            PortType::Choice(&["F1", "F2"]),
            Default::Choice("F1"),
            "Which distance.",
        ),
    ],
    FLOAT,
    |_| Behaviour::Random { deviation: 0.04 },
);
static ADD: NodeSpec = spec(
    "add",
    &[any("in1", 0.0), any("in2", 0.0)],
    OutputType::Widest,
    |_| Behaviour::Linear,
);
static MULTIPLY: NodeSpec = NodeSpec {
    aliases: &["times"],
    ..spec(
        "multiply",
        &[any("in1", 1.0), any("in2", 1.0)],
        OutputType::Widest,
        |view| {
            if view.varies("in1") && view.varies("in2") {
                Behaviour::Product
            } else {
                Behaviour::Linear
            }
        },
    )
};
static DIVIDE: NodeSpec = spec(
    "divide",
    &[
        any("in1", 1.0),
        any("in2", 1.0).range(Range::soft(0.0, 1.0).nonzero()),
    ],
    OutputType::Widest,
    |view| {
        if view.varies("in2") {
            Behaviour::Unknown("it divides by a signal")
        } else {
            Behaviour::Linear
        }
    },
);
static SIN: NodeSpec = spec("sin", &[any("in", 0.0)], OutputType::Widest, |_| {
    Behaviour::Function
});
static RAMP: NodeSpec = spec(
    "colorramp",
    &[
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "A signal.",
        ),
        PortSpec::new(
            "stops",
            PortType::Stops,
            Default::Stops(&[(0.0, 0.0), (1.0, 1.0)]),
            "Stops.",
        ),
    ],
    OutputType::Stops,
    |_| Behaviour::Function,
);
static CHECKER: NodeSpec = spec(
    "checkerboard",
    &[
        TEXCOORD,
        PortSpec::new(
            "color1",
            PortType::Exactly(Type::Color3),
            Default::Color3([1.0; 3]),
            "A colour.",
        ),
    ],
    OutputType::Exactly(Type::Color3),
    |_| Behaviour::Pattern,
);
static EXTRACT: NodeSpec = spec(
    "extract",
    &[PortSpec::new(
        "in",
        PortType::Exactly(Type::Color3),
        Default::Float(0.0),
        "A colour.",
    )],
    FLOAT,
    |_| Behaviour::Linear,
);

/// The node types.
pub(crate) static SPECS: &[&NodeSpec] = &[
    &TEXCOORD_NODE,
    &FRACTAL,
    &CELLS,
    &ADD,
    &MULTIPLY,
    &DIVIDE,
    &SIN,
    &RAMP,
    &CHECKER,
    &EXTRACT,
    &PICTURE,
];

/// A document with these `nodes` and `outputs` (JSON without the outer braces).
pub(crate) fn text(rest: &str) -> String {
    format!("{{ \"version\": 1, \"name\": \"t\", {rest} }}")
}
