//! The larger and the smaller of two signals.

use crate::componentwise::{OPERANDS, binary};
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType};

macro_rules! extrema {
    ($($node:ident {
        aliases: $aliases:expr,
        which: $which:literal,
        statistics: $statistics:literal,
        rule: $rule:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: concat!("The ", $which, " of two signals."),
                doc: Doc {
                    computes: concat!("out = ", stringify!($node), "(in1, in2), for each component."),
                    statistics: $statistics,
                    accuracy: "For Gaussian inputs the mean is within 1e-6 θ (the error of the normal \
                        distribution function); for others the error follows their distance from a \
                        Gaussian. Held by `nodes/src/tests.rs`.",
                    references: cite!(
                        "Clark 1961, *The Greatest of a Finite Set of Random Variables*, eqs. 2 and \
                         4–6."; stringify!($node)
                    ),
                },
                inputs: OPERANDS,
                output: OutputType::Widest,
                reach: |inputs| inputs.reach("in1").$node(inputs.reach("in2")),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    ""#, stringify!($node), r#"": { "type": ""#, stringify!($node),
                    r#"", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "across" } } }
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| binary(lower, node, ["in1", "in2"], $rule))
        }
    )*};
}

extrema! {
    max {
        aliases: &["maximum", "math_max"],
        which: "larger",
        statistics: "For jointly Gaussian inputs with θ² = Var(in1 − in2) and a = (m₁ − m₂)/θ: E = m₁Φ(a) \
            + m₂Φ(−a) + θφ(a); the coefficients are Φ(a)·in1 + Φ(−a)·in2, and what they leave of \
            the variance, θ²d(a) with d(a) = (a² + 1)Φ(a)Φ(−a) − |a|φ(a)|Φ(a) − Φ(−a)| − φ(a)², \
            joins an uncorrelated remainder. Exact in mean, variance and covariance with \
            Gaussians.",
        rule: |lower, x, y| lower.algebra.maximum(x, y),
    }
    min {
        aliases: &["minimum", "math_min"],
        which: "smaller",
        statistics: "min(x, y) = −max(−x, −y): for jointly Gaussian inputs with θ² = Var(in1 − in2) and a \
            = (m₁ − m₂)/θ, E = m₁Φ(−a) + m₂Φ(a) − θφ(a); the coefficients are Φ(−a)·in1 + \
            Φ(a)·in2. Exact in mean, variance and covariance with Gaussians.",
        rule: |lower, x, y| lower.algebra.minimum(x, y),
    }
}
