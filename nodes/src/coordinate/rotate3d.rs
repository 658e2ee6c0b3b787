//! Rotation of a vector in space.

use crate::componentwise::{numbers, product, sum};
use crate::coordinate::rotate2d::turn;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "rotate3d",
    aliases: &["vector_rotate_3d", "rotate_3d", "rotate_about_axis"],
    category: Category::Coordinate,
    summary: "Turns a vector around an axis.",
    doc: Doc {
        computes: "out = c p + s k × p + (1 − c)(k · p) k for p = in, with k the axis at length 1, and c and s \
            the cosine and sine of the amount: counter-clockwise for who looks against the axis. The \
            vector stays where the axis is 0. MaterialX's node of this name turns the other way, as \
            its `rotate2d` does.",
        statistics: "By a constant angle, linear and exact: a position stays exactly Gaussian, with its footprint \
            turned. A varying angle goes through the closed forms of sine and cosine and a product. Of a \
            varying axis the mean is used.",
        accuracy: "Exact to rounding for a constant angle. Held by `nodes/src/tests/channel.rs`.",
        references: "Rodrigues 1840, *Des lois géométriques qui régissent les déplacements d'un système \
            solide*. MaterialX 1.39 specification, node `rotate3d`.",
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Vector3),
            Default::Float(0.0),
            "The vector.",
        ),
        PortSpec::new(
            "amount",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The angle, counter-clockwise.",
        )
        .range(Range::soft(-180.0, 180.0))
        .unit("degrees"),
        PortSpec::new(
            "axis",
            PortType::Exactly(Type::Vector3),
            Default::Color3([0.0, 1.0, 0.0]),
            "The axis, of any length.",
        )
        .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Exactly(Type::Vector3),
    class,
    example: r#"{
  "version": 1,
  "name": "rotate3d_example",
  "nodes": {
    "place": { "type": "position" },
    "rotate3d": { "type": "rotate3d", "inputs": { "in": { "node": "place" }, "amount": 30, "axis": [1, 1, 0] } },
    "grain": { "type": "noise3d", "inputs": { "position": { "node": "rotate3d" }, "frequency": 4 } }
  },
  "outputs": { "out": { "node": "grain" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// Linear unless the angle or the axis varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    match (
        inputs.varies("in"),
        inputs.varies("amount") || inputs.varies("axis"),
    ) {
        (_, false) => Behaviour::Linear,
        (false, true) => Behaviour::Function,
        (true, true) => Behaviour::Product,
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let vector = lower.bundle(node, "in");
    let angle = lower.signal(node, "amount");
    let axis = numbers(lower, node, "axis");
    let [cosine, sine] = turn(lower, &angle);
    let b = lower.b();
    let square = b.dot(&axis, &axis);
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let directed = b.lt(zero, square);
    let guarded = b.select(directed, square, one);
    let length = b.sqrt(guarded);
    let axis: Vec<_> = axis.iter().map(|&x| b.div(x, length)).collect();
    // Without an axis there is no turn: 1 − c and s are 0 then.
    let here = b.select(directed, one, zero);
    let minus = cosine.negate(b).offset(b, one);
    let (left, sine) = (minus.scale(b, here), sine.scale(b, here));
    // p + s k × p + (1 − c)((k · p) k − p).
    (0..3)
        .map(|i| {
            let mut out = vector[i].clone();
            for j in 0..3 {
                let b = lower.b();
                let projector = b.mul(axis[i], axis[j]);
                let projector = if i == j {
                    b.offset(projector, -1.0)
                } else {
                    projector
                };
                let mut entry = left.scale(b, projector);
                // (k × p)ᵢ = kⱼ′ pⱼ″ − kⱼ″ pⱼ′.
                if i != j {
                    let other = axis[3 - i - j];
                    let sign = if (i + 1) % 3 == j { -1.0 } else { 1.0 };
                    let by = b.scale(other, sign);
                    let cross = sine.scale(b, by);
                    entry = entry.add(b, &cross);
                }
                let part = product(lower, &vector[j], &entry);
                out = sum(lower, &out, &part);
            }
            out
        })
        .collect()
}
