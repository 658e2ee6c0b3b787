//! Lengths and directions.

use crate::componentwise::{composed, exposed, total, transfer};
use crate::port::any;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Piecewise, Polynomial, RealPower};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach, Type};

macro_rules! lengths {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        inputs: $inputs:expr,
        example: $example:literal,
        components: $components:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: "The squares in closed form, their sum taken for a Gaussian, and its \
                        square root by ten-point Gauss–Legendre quadrature over the part above 0. \
                        Approximate: near 0 the sum of few squares is far from Gaussian.",
                    accuracy: "For jointly Gaussian components the mean is within 0.02 and the standard \
                        deviation within 0.07 of the root of the components’ summed variance; the \
                        worst is a vector of mean 0. Held by `nodes/src/tests/vector.rs` against \
                        dense numerical integration in f64.",
                    references: cite!(isserlis, bussgang; stringify!($node)),
                },
                inputs: $inputs,
                output: OutputType::Exactly(Type::Float),
                reach: |_| Reach::of(0.0, f32::INFINITY),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "uv": {"type": "texcoord"},
    "turned": {"type": "rotate2d", "inputs": {"in": {"node": "uv"}, "amount": 30}},
"#, $example) },
            };
            NodeDef::new(&SPEC, |lower, node| measured(lower, node, $components))
        }
    )*};
}

lengths! {
    distance {
        aliases: &["vector_distance"],
        summary: "How far two points are apart.",
        computes: "out = √Σ (in1ᵢ − in2ᵢ)².",
        inputs: &[any("in1", 0.0, "The first operand."), any("in2", 0.0, "The second operand.")],
        example: r#"    "distance": {"type": "distance", "inputs": {"in1": {"node": "uv"}, "in2": [0.5, 0.4]}}
"#,
        components: |lower, node| {
            let [x, y] = ["in1", "in2"].map(|port| exposed(lower, node, port));
            x.iter().zip(&y).map(|(x, y)| x - y).collect()
        },
    }
    magnitude {
        aliases: &["length", "vector_length", "norm"],
        summary: "The length of a vector.",
        computes: "out = √Σ inᵢ²; of a number, |in|.",
        inputs: &[any("in", 0.0, "The vector.")],
        example: r#"    "magnitude": {"type": "magnitude", "inputs": {"in": {"node": "uv"}}}
"#,
        components: |lower, node| exposed(lower, node, "in"),
    }
}

/// √Σ xᵢ² of these components; of one number, |x|.
fn measured<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    components: impl FnOnce(&mut Lower<'_, 'b>, &Node) -> Bundle<'b>,
) -> Bundle<'b> {
    let components = components(lower, node);
    if let [x] = &components[..] {
        let absolute = Piecewise::absolute(lower.b());
        return vec![transfer(lower, x, &absolute)];
    }
    composed(lower, |lower| {
        let b = lower.b();
        let square = |x| transfer(lower, x, &Polynomial { power: 2 });
        let sum = total(b, components.iter().map(square));
        let power = b.float(0.5);
        vec![transfer(lower, &sum, &RealPower { power })]
    })
}

/// x / √Σ xᵢ²; 0 for what is shorter than 1e-6.
pub(crate) fn unit<'b>(x: &[Float<'b>]) -> Vec<Float<'b>> {
    let square = x[0].builder().sum(x.iter().map(|x| x.square()));
    let inverse = 1.0 / square.max(1e-12).sqrt();
    let inverse = square.gt(1e-12).select(inverse, 0.0);
    x.iter().map(|&x| x * inverse).collect()
}
