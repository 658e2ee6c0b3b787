//! Rotation of a vector in space.

use crate::componentwise::{numbers, product, sum};
use crate::coordinate::rotate2d::turn;
use crate::port::{exactly, number};
use mipless_codegen::ir::Float;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "rotate3d",
    aliases: &["vector_rotate_3d", "rotate_3d", "rotate_about_axis"],
    category: Category::Coordinate,
    summary: "Turns a vector around an axis.",
    doc: Doc {
        computes: "out = c p − s k × p + (1 − c)(k · p) k for p = in, with k the axis at length 1, and c and s \
            the cosine and sine of the amount: clockwise for who looks against the axis. The vector \
            stays where the axis is 0.",
        statistics: "By a constant angle, linear and exact: a position stays exactly Gaussian, with its footprint \
            turned. A varying angle goes through the closed forms of sine and cosine and a product. Of a \
            varying axis the mean is used.",
        accuracy: "Exact to rounding for a constant angle. Held by `nodes/src/tests/channel.rs`.",
        references: cite!(
            "Rodrigues 1840, *Des lois géométriques qui régissent les déplacements d'un système \
             solide*."; "rotate3d"
        ),
    },
    inputs: &[
        exactly(Type::Vector3, "in", 0.0, "The vector."),
        number("amount", 0.0, "The angle, clockwise.")
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
    reach: |_| Reach::ANY,
    class,
    example: example! { "rotate3d" => "grain", r#"
    "place": { "type": "position" },
    "rotate3d": { "type": "rotate3d", "inputs": { "in": { "node": "place" }, "amount": 30, "axis": [1, 1, 0] } },
    "grain": { "type": "noise3d", "inputs": { "position": { "node": "rotate3d" }, "frequency": 4 } }
"# },
};

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

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let vector = lower.bundle(node, "in");
    let angle = lower.signal(node, "amount");
    let axis = numbers(lower, node, "axis");
    turned(lower, &vector, &angle, &axis)
}

/// A vector turned clockwise around an axis, by an angle in degrees.
pub(crate) fn turned<'b>(
    lower: &mut Lower<'_, 'b>,
    vector: &[Signal<'b>],
    angle: &Signal<'b>,
    axis: &[Float<'b>],
) -> Bundle<'b> {
    let [cosine, sine] = turn(lower, &-angle);
    let square = lower.b().sum(axis.iter().map(|x| x.square()));
    let directed = square.gt(0.0);
    let length = directed.select(square, 1.0).sqrt();
    let axis: Vec<_> = axis.iter().map(|&x| x / length).collect();
    // Without an axis there is no turn: 1 − c and s are 0 then.
    let here = directed.select(1.0f32, 0.0);
    let (left, sine) = ((-cosine).offset(1.0) * here, sine * here);
    // p + s k × p + (1 − c)((k · p) k − p).
    (0..3)
        .map(|i| {
            (0..3).fold(vector[i].clone(), |out, j| {
                let mut projector = axis[i] * axis[j];
                if i == j {
                    projector += -1.0;
                }
                let mut entry = &left * projector;
                // (k × p)ᵢ = kⱼ′ pⱼ″ − kⱼ″ pⱼ′.
                if i != j {
                    let sign = if (i + 1) % 3 == j { -1.0 } else { 1.0 };
                    entry = entry + &sine * (axis[3 - i - j] * sign);
                }
                sum(&out, &product(lower, &vector[j], &entry))
            })
        })
        .collect()
}
