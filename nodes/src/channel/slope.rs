//! How a height rises along u and v.

use super::gradient::{class, gradient};
use crate::port;
use crate::port::number;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "slope",
    aliases: &["gradient_of_height", "derivative", "steepness", "ddx_ddy"],
    category: Category::Channel,
    summary: "How a height rises along u and along v.",
    doc: Doc {
        computes: "out = scale (∂in/∂u, ∂in/∂v), with (u, v) the texcoord; 0 where the texcoord does not \
            change. At a point the derivatives are those of the height under a round Gaussian with a \
            standard deviation of 1e-5 uv. What the height depends on is evaluated once more for it.",
        statistics: "Slopes are signals of their own, by the chain rule through everything that the height \
            is made of: their mean is the gradient of the filtered height, their response to the place in \
            the footprint its Hessian, and what the footprint removed is a covariance, from the \
            spectrum of each noise (`noise2d`, `fractal2d`, `valuenoise2d`, `spectralnoise2d`, \
            `gabornoise2d`), through sums, products, mixes, maxima, conditions, warps and all \
            functions of one signal. Squares and products of both components keep it. Other sources \
            (patterns, pictures, cells, noises in space) name how fine their detail is: of theirs the \
            removed slopes are isotropic, R(2π/λ)²/2 in each direction, with R the height's variance \
            beyond its Hessian. Of several inputs at once (normals, hues, maps) it is a lower bound.",
        accuracy: "In its mean exact wherever the filtered height is. Bias of the trace of the slopes' \
            covariance against dense sums, on average over places, footprints from 0.02 to 8 wavelengths, \
            round and 8:1: within 0.03 for `noise2d`, `fractal2d`, `spectralnoise2d` and `gabornoise2d` \
            (`quintic` 0.04, `valuenoise2d` 0.06), 0.04 for sums and maxima of two noises, 0.06 for mixes and \
            smooth steps, 0.1 for products, squares, plateaus, ridges, cracks and warps (the largest at 8:1 \
            and 0.1 to 0.3 wavelengths, elsewhere half of that), 0.01 for waves; the ratio of its axes within \
            0.05 for noises, 0.12 for others. Held by `nodes/tests/slope.rs`. A height with jumps has no \
            slope there: its variance is a lower bound, and its edges should be ramps.",
        references: "Bruneton & Neyret 2012, *A Survey of Nonlinear Prefiltering Methods*, §3–5. Olano & Baker \
            2010, *LEAN Mapping*. Heitz et al. 2014, *Filtering Color Mapped Textures and Surfaces*, §5.",
    },
    inputs: &[
        number("in", 0.0, "The height."),
        number(
            "scale",
            1.0,
            "What the height is multiplied by: 1 for a height in units of the texcoord.",
        )
        .range(Range::soft(0.0, 16.0)),
        port::surface("The coordinates along which the height rises."),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class,
    example: example! { "slope", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "slope": { "type": "slope", "inputs": { "in": { "node": "hills" }, "scale": 0.25 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let scale = lower.number(node, "scale");
    gradient(lower, node, "in")
        .map(|slope| slope * scale)
        .to_vec()
}
