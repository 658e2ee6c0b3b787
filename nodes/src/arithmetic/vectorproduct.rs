//! Products of vectors.

use crate::componentwise::{composed, exposed, product, total};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach, Type,
};

macro_rules! products {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        operands: $operands:expr,
        output: $output:expr,
        example: $example:literal,
        rule: $rule:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: "Products of varying signals take their covariance: exact in mean and \
                        variance for jointly Gaussian ones, with numbers linear and exact.",
                    accuracy: "For jointly Gaussian inputs the mean is exact to rounding and the \
                        standard deviation within 1e-3. Held by `nodes/src/tests/vector.rs` against \
                        dense numerical integration in f64.",
                    references: cite!(isserlis; stringify!($node)),
                },
                inputs: &[
                    operand("in1", $operands, "The first operand."),
                    operand("in2", $operands, "The second operand."),
                ],
                output: OutputType::Exactly($output),
                reach: |_| Reach::ANY,
                class: |_| Behaviour::Product,
                example: example! { stringify!($node), concat!(r#"
    "uv": {"type": "texcoord"},
    "turned": {"type": "rotate2d", "inputs": {"in": {"node": "uv"}, "amount": 30}},
"#, $example) },
            };
            NodeDef::new(&SPEC, |lower, node| multiplied(lower, node, $rule))
        }
    )*};
}

const fn operand(name: &'static str, ty: PortType, doc: &'static str) -> PortSpec {
    PortSpec::new(name, ty, Default::Float(0.0), doc)
}

products! {
    crossproduct {
        aliases: &["cross", "cross_product"],
        summary: "The vector at right angles to two others.",
        computes: "out = in1 × in2.",
        operands: PortType::Exactly(Type::Vector3),
        output: Type::Vector3,
        example: r#"    "a": {"type": "convert", "inputs": {"in": {"node": "uv"}, "to": "vector3"}},
    "b": {"type": "convert", "inputs": {"in": {"node": "turned"}, "to": "vector3"}},
    "crossproduct": {"type": "crossproduct", "inputs": {"in1": {"node": "a"}, "in2": {"node": "b"}}}
"#,
        rule: |lower, x, y| {
            let component = |k: usize| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                product(lower, &x[i], &y[j]) - product(lower, &x[j], &y[i])
            };
            (0..3).map(component).collect()
        },
    }
    dotproduct {
        aliases: &["dot_product"],
        summary: "The sum of the products of components.",
        computes: "out = Σ in1ᵢ in2ᵢ.",
        operands: PortType::Any,
        output: Type::Float,
        example: r#"    "dotproduct": {"type": "dotproduct", "inputs": {"in1": {"node": "uv"}, "in2": {"node": "turned"}}}
"#,
        rule: |lower, x, y| {
            let b = lower.b();
            let pairs = x.iter().zip(y);
            vec![total(b, pairs.map(|(x, y)| product(lower, x, y)))]
        },
    }
}

fn multiplied<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    rule: impl FnOnce(&mut Lower<'_, 'b>, &[Signal<'b>], &[Signal<'b>]) -> Bundle<'b>,
) -> Bundle<'b> {
    let [x, y] = ["in1", "in2"].map(|port| exposed(lower, node, port));
    composed(lower, |lower| rule(lower, &x, &y))
}
