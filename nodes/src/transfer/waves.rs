//! Waves of period 1 that are straight between their corners.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::NodeDef;
use mipless_codegen::moments::LinearWave;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Range, Reach};

macro_rules! waves {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        far: $far:literal,
        high: $high:literal,
        wave: $wave:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Transfer,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: concat!("For σ ≤ 0.2 periods the piecewise function of the corners within \
                        reach in closed form, beyond it three harmonics of the Fourier series, damped \
                        by e^{−2π²k²v}; the distortion as a sum of squares over the pieces, or from \
                        the series of the square. Exact for a Gaussian. Over a large footprint the \
                        mean goes to ", $far, "."),
                    accuracy: "For a Gaussian input the mean is within 4e-6, the remainder’s standard \
                        deviation within 1e-3. Held by `codegen/src/moments/tests/waves.rs` against \
                        dense numerical integration in f64.",
                    references: cite!(characteristic, bussgang; stringify!($node)),
                },
                inputs: &[any("in", 0.0, "The signal.").range(Range::soft(-1.0, 1.0))],
                output: OutputType::Widest,
                reach: |_| Reach::of(0.0, $high),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "six": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 6.3}},
    ""#, stringify!($node), r#"": {"type": ""#, stringify!($node), r#"", "inputs": {"in": {"node": "six"}}}
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let wave = $wave;
                unary(lower, node, "in", |lower, x| transfer(lower, x, &wave))
            })
        }
    )*};
}

waves! {
    fract {
        aliases: &["sawtooth", "sawtooth_wave", "fraction", "frac"],
        summary: "A signal less the whole number below it: a sawtooth of period 1.",
        computes: "out = in − ⌊in⌋, for each component: from 0 up to 1, then 0 again.",
        far: "½ and the variance to 1/12",
        high: 1.0,
        wave: LinearWave::sawtooth(),
    }
    trianglewave {
        aliases: &["triangle", "triangle_wave", "pingpong"],
        summary: "Rises from 0 to ½ and falls back once in every unit.",
        computes: "out = |in − ⌊in + ½⌋|, for each component: 0 at whole numbers, ½ halfway between \
            them.",
        far: "¼ and the variance to 1/48",
        high: 0.5,
        wave: LinearWave::through(&[(0.0, 0.0), (0.5, 0.5)]),
    }
}
