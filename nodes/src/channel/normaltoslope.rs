//! The slopes that a normal means.

use super::gradient::of_normal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "normaltoslope",
    aliases: &["normal_to_slope", "slope_of_normal", "normal_to_gradient"],
    category: Category::Channel,
    summary: "The slopes of a surface with this normal.",
    doc: Doc {
        computes: "out = −(in₁, in₂)/in₃, limited to ±50: how the surface rises along u and along v. The \
            normal is in tangent space and of any length, as `normalmap` gives it; one that points \
            downwards is vertical. Slopes are what adds up where details lie on one another.",
        statistics: "A cubature over the joint Gaussian of the normal's components: means, the slopes by \
            each input, and the rest as a sum of squares; both slopes keep what they share.",
        accuracy: "Exact for a certain normal. Of the normals of a noise with slopes of a deviation of 0.3, \
            filtered, the slopes' means are within 0.02. Held by `nodes/tests/surface.rs`.",
        references: cite!("Barré-Brisebois & Hill 2012, *Blending in Detail*.", stroud),
    },
    inputs: &[PortSpec::new(
        "in",
        PortType::Exactly(Type::Vector3),
        Default::Color3([0.0, 0.0, 1.0]),
        "The normal, in tangent space.",
    )
    .unit("normal")],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::of(-50.0, 50.0),
    class: |_| Behaviour::Function,
    example: example! { "normaltoslope", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "map": { "type": "heighttonormal", "inputs": { "in": { "node": "hills" } } },
    "normal": { "type": "normalmap", "inputs": { "in": { "node": "map" } } },
    "normaltoslope": { "type": "normaltoslope", "inputs": { "in": { "node": "normal" } } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let normal = lower.bundle(node, "in");
    of_normal(lower, &normal).to_vec()
}
