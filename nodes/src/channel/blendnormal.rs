//! A normal with another one's details on it.

use super::gradient::{of_normal, upright};
use crate::port::number;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
    Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "blendnormal",
    aliases: &[
        "blend_normals",
        "normal_combine",
        "rnm",
        "detail_normal",
        "whiteout",
    ],
    category: Category::Channel,
    summary: "A normal with the details of another one on it.",
    doc: Doc {
        computes: "The slopes of both normals add, those of `detail` by the factor `mix`: out = (−s, 1)/√(1 + \
            |s|²), s = s(base) + mix s(detail), with s(n) = −n_xy/n_z within ±50. That is what the heights' \
            sum would have. Normals are in tangent space, as `normalmap` gives them, and so is the result.",
        statistics: "Cubatures over the joint Gaussians of the components: slopes from each normal, and the \
            normal from the sum (24 nodes), as `slopetonormal`. The mean is shorter than 1 by what the normals \
            of a footprint differ.",
        accuracy: "Exact for certain normals. Held by `nodes/tests/surface.rs` against dense sums.",
        references: cite!(
            "Barré-Brisebois & Hill 2012, *Blending in Detail* (partial derivatives).",
            stroud
        ),
    },
    inputs: &[
        PortSpec::new(
            "base",
            PortType::Exactly(Type::Vector3),
            Default::Color3([0.0, 0.0, 1.0]),
            "The normal below.",
        )
        .unit("normal"),
        PortSpec::new(
            "detail",
            PortType::Exactly(Type::Vector3),
            Default::Color3([0.0, 0.0, 1.0]),
            "The normal on it.",
        )
        .unit("normal"),
        number("mix", 1.0, "How much of the details there is.").range(Range::soft(0.0, 2.0)),
    ],
    output: OutputType::Exactly(Type::Vector3),
    reach: |_| Reach::of(-1.0, 1.0),
    class: |_| Behaviour::Function,
    example: example! { "blendnormal", r#"
    "hills": { "type": "noise2d", "inputs": { "frequency": 4 } },
    "grain": { "type": "noise2d", "inputs": { "frequency": 40, "amplitude": 0.1, "seed": 2 } },
    "hill_map": { "type": "heighttonormal", "inputs": { "in": { "node": "hills" }, "scale": 2 } },
    "grain_map": { "type": "heighttonormal", "inputs": { "in": { "node": "grain" }, "scale": 2 } },
    "hill_normal": { "type": "normalmap", "inputs": { "in": { "node": "hill_map" } } },
    "grain_normal": { "type": "normalmap", "inputs": { "in": { "node": "grain_map" } } },
    "blendnormal": { "type": "blendnormal", "inputs": { "base": { "node": "hill_normal" },
        "detail": { "node": "grain_normal" } } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [base, detail] = ["base", "detail"].map(|port| {
        let normal = lower.bundle(node, port);
        of_normal(lower, &normal)
    });
    let mix = lower.number(node, "mix");
    let slopes = [0, 1].map(|i| &base[i] + &detail[i] * mix);
    upright(lower, &slopes)
}
