//! A normal from slopes.

use super::gradient::normals;
use crate::port::number;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
    Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "slopetonormal",
    aliases: &["slope_to_normal", "normal_from_slope", "gradient_to_normal"],
    category: Category::Channel,
    summary: "The normal of a surface with these slopes, as a colour of a normal map.",
    doc: Doc {
        computes: "out = ½ + ½ n/|n| with n = (−scale in₁, −scale in₂, 1), all in [0, 1]: (½, ½, 1) for no \
            slope. Sums of slopes are what details on details look like: `slope` of each height, `add`, \
            and this.",
        statistics: "A cubature of 24 nodes over the two slopes as a joint Gaussian: mean, the slopes by each \
            input, and the rest as a sum of squares. What the components of the normal share of the slopes \
            that a footprint removed, they share.",
        accuracy: "Exact for certain slopes. For Gaussian slopes with a standard deviation of 1.6, E[n_x²] is \
            within 0.003. Held by `nodes/tests/slope.rs`.",
        references: "Olano & Baker 2010, *LEAN Mapping*. Mikkelsen 2010, *Bump Mapping Unparametrized Surfaces \
            on the GPU*.",
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.0, 0.0]),
            "How the height rises along u and along v.",
        ),
        number("scale", 1.0, "What the slopes are multiplied by.").range(Range::soft(0.0, 4.0)),
    ],
    output: OutputType::Exactly(Type::Vector3),
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Function,
    example: example! { "slopetonormal", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "slope": { "type": "slope", "inputs": { "in": { "node": "hills" } } },
    "slopetonormal": { "type": "slopetonormal", "inputs": { "in": { "node": "slope" }, "scale": 0.2 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let scale = lower.number(node, "scale");
    let slopes = lower.bundle(node, "in");
    normals(lower, &[0, 1].map(|i| &slopes[i] * -scale))
}
