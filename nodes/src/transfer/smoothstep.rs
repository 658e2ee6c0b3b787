//! Cubic step between two bounds.

use crate::componentwise::{difference, ternary, transfer};
use crate::port::any;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "smoothstep",
    aliases: &["smooth_step", "tones_range", "ease"],
    category: Category::Transfer,
    summary: "Rises from 0 to 1 between two bounds, without kinks.",
    doc: Doc {
        computes: "out = 3t² − 2t³ with t = (in − low)/(high − low) limited to [0, 1], for each \
            component; a step at high where the bounds are closer than 1e-6 or swapped.",
        statistics: "For a Gaussian input: the mean and its derivatives by the truncated moments of the \
            cubic, or by Gauss–Legendre quadrature where the cubic is narrower than 1.2 standard \
            deviations; the distortion as a sum of squares over positive weights. Where low or high \
            vary, it is the function of in − high; of high − low the mean is used.",
        accuracy: "For a Gaussian input the mean is within 1e-4, the remainder’s standard deviation \
            within 3e-3. Held by `codegen/src/moments/tests.rs` against dense numerical \
            integration in f64.",
        references: cite!(bussgang; "smoothstep"),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        any("low", 0.0, "Where the rise begins."),
        any("high", 1.0, "Where the rise ends."),
    ],
    output: OutputType::Widest,
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Function,
    example: example! { "smoothstep", r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "smoothstep": { "type": "smoothstep", "inputs": { "in": { "node": "wave" }, "low": -0.2, "high": 0.4 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    ternary(lower, node, ["in", "low", "high"], |lower, x, low, high| {
        if low.is_certain() && high.is_certain() {
            let smooth = Piecewise::smoothstep(low.flat_mean(), high.flat_mean());
            return transfer(lower, x, &smooth);
        }
        // What the bounds share with the signal moves the rise; only its width is a number.
        let width = difference(high, low).flat_mean();
        let smooth = Piecewise::smoothstep(-width, width.literal(0.0));
        transfer(lower, &difference(x, high), &smooth)
    })
}
