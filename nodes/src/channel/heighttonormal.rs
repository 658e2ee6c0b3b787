//! A normal from a height.

use super::gradient::{class, gradient, normals};
use crate::port;
use crate::port::number;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "heighttonormal",
    aliases: &["normal_map", "bump", "height_to_normal", "normal"],
    category: Category::Channel,
    summary: "The normal of a height, as a colour of a normal map.",
    doc: Doc {
        computes: "out = ½ + ½ n/|n| with n = (−k ∂in/∂u, −k ∂in/∂v, 1), k = scale/16 and (u, v) the \
            texcoord, all in [0, 1]; (½, ½, 1) where the texcoord does not change. At a point the \
            derivatives are those of the height under a round Gaussian with a standard deviation of \
            1e-5 uv, which a smooth height does not tell from its own. What the height depends on is \
            evaluated once more for it.",
        statistics: "The slopes are those of `slope`: their mean is the gradient of the filtered height, which \
            is exact wherever the filtered height is, their response to the place in the footprint its \
            Hessian, and what the filter removed of them is a covariance by the chain rule from the \
            spectra of the noises; the page of `slope` says of which sources it is estimated. \
            The normal is then a cubature of 24 nodes over the two slopes, as a joint Gaussian.",
        accuracy: "Exact for a plane, and in its mean slope for every height that is filtered exactly. \
            Largest error of a component over footprints from 0.01 to 5 wavelengths, round and 8:1 (root \
            mean square): 0.033 (0.006) for a noise whose slopes have a standard deviation of 0.6, 0.035 \
            (0.009) for one of three octaves, 0.008 (0.002) for a sine wave of slopes up to 0.5, 0.09 \
            (0.018) for bricks with bevels of 51 degrees, whose slopes are no Gaussian. The standard deviation is within 0.11, for such bricks within 0.19. Footprints beyond 64 uv are \
            taken for such. A height with jumps \
            has no slope there: its edges should be ramps. Held by `nodes/src/pattern/tests/upstream.rs` \
            against dense sums.",
        references: "Olano & Baker 2010, *LEAN Mapping* (slopes have means and variances, normals do \
            not). Mikkelsen 2010, *Bump Mapping Unparametrized Surfaces on the GPU*. MaterialX 1.39 \
            specification, node `heighttonormal`; its factor 1/16 is that of its implementation.",
    },
    inputs: &[
        number("in", 0.0, "The height."),
        number(
            "scale",
            1.0,
            "How much the height tilts the normal: 16 for a height in units of the texcoord.",
        )
        .range(Range::soft(0.0, 16.0)),
        port::surface("The coordinates that the normal's axes follow."),
    ],
    output: OutputType::Exactly(Type::Vector3),
    reach: |_| Reach::of(0.0, 1.0),
    class,
    example: example! { "heighttonormal", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "heighttonormal": { "type": "heighttonormal", "inputs": { "in": { "node": "hills" }, "scale": 2 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let scale = lower.number(node, "scale") * (-1.0 / 16.0);
    let tilts = gradient(lower, node, "in").map(|slope| slope * scale);
    normals(lower, &tilts)
}
