//! The largest and the smallest component of a vector or colour.

use crate::componentwise::{composed, exposed};
use crate::port::any;
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Reach, Type};

macro_rules! components {
    ($($node:ident {
        which: $which:literal,
        of_two: $of_two:ident,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: &[],
                category: Category::Arithmetic,
                summary: concat!("The ", $which, " component of a vector or colour."),
                doc: Doc {
                    computes: concat!("out = the ", $which, " component of in, an alpha included."),
                    statistics: "Clark’s moments, one component after another, with the covariances that \
                        they have: exact in mean and variance for two jointly Gaussian ones, close for \
                        more.",
                    accuracy: "As `max`. At a point and as the footprint goes to 0 held by \
                        `nodes/src/tests.rs`.",
                    references: cite!(clark; stringify!($node)),
                },
                inputs: &[any("in", 0.0, "The vector or colour.")],
                output: OutputType::Exactly(Type::Float),
                reach: |inputs| Reach([inputs.reach("in").whole(inputs.components("in")); 4]),
                class: |_| Behaviour::Rough {
                    error: 0.08,
                    place: "has a mean that is off by up to 0.06 of its range where components take two \
                        values, as those of a pattern of two colours",
                },
                example: example! { stringify!($node), concat!(r##"
    "board": { "type": "checkerboard", "inputs": { "color1": "#c08a52", "color2": "#204060" } },
    ""##, stringify!($node), r#"": { "type": ""#, stringify!($node),
                    r#"", "inputs": { "in": { "node": "board" } } }
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let components = exposed(lower, node, "in");
                composed(lower, |lower| {
                    let (first, others) = components.split_first().expect("a component");
                    let extreme = others
                        .iter()
                        .fold(first.clone(), |so_far, x| lower.algebra.$of_two(&so_far, x));
                    vec![extreme]
                })
            })
        }
    )*};
}

components! {
    maxcomponent {
        which: "largest",
        of_two: maximum,
    }
    mincomponent {
        which: "smallest",
        of_two: minimum,
    }
}
