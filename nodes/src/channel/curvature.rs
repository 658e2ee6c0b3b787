//! How a height bends: crests and valleys.

use super::blur::{blurred, class, variance};
use crate::port;
use crate::port::number;
use mipless_codegen::ir::{Sym2, Vec2};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "curvature",
    aliases: &[
        "cavity",
        "convexity",
        "edge_wear",
        "curvature_smooth",
        "laplacian",
    ],
    category: Category::Channel,
    summary: "How a height bends: above 0 on crests and edges, below in valleys.",
    doc: Doc {
        computes: "out = scale (in − B)/r², with B the mean of in under a round Gaussian of the variance \
            r² = size²/12 along each axis (that of `blur`). For a height in units of the texcoord that is \
            smooth over `size` it is the mean curvature of a gentle slope, −½ (∂²/∂u² + ∂²/∂v²) in; what \
            is finer than `size` counts as in/r². Nothing is sampled: what the input depends on is \
            evaluated once more, over a larger footprint.",
        statistics: "The difference of the signal and of the same signal over a footprint convolved with the \
            Gaussian: its mean is as exact as the filter of the height, and of its variation within the \
            pixel the parts of both that the place moves are subtracted; of the rest, that of the blurred \
            signal (see `blur`) is taken for a share of the height's, as it is for one wavelength.",
        accuracy: "As `blur`, divided by r²: so is the rounding of the height, about 1e-6 of it. Held by `nodes/tests/surface.rs` against dense sums.",
        references: "Marr & Hildreth 1980, *Theory of Edge Detection* (differences of Gaussians). Heckbert \
            1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8.",
    },
    inputs: &[
        number("in", 0.0, "The height."),
        number("size", 0.02, "The width of what counts as bent.")
            .range(Range::hard(1e-4, 1e4).with_soft(0.001, 0.1))
            .unit("uv"),
        number(
            "scale",
            1.0,
            "What the height is multiplied by: 1 for a height in units of the texcoord.",
        )
        .range(Range::soft(0.0, 1.0)),
        port::surface("Where it is: the surface's own coordinates."),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::ANY,
    class,
    example: example! { "curvature", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 4 } },
    "curvature": { "type": "curvature", "inputs": { "in": { "node": "hills" }, "size": 0.1, "scale": 0.001 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let variance = variance(lower, node);
    let by = lower.number(node, "scale") / variance;
    let height = lower.signal(node, "in").flat();
    let mean = blurred(lower, node, variance).remove(0);
    let response = |signal: &Signal<'b>| Signal {
        g: signal.g,
        h: signal.h,
        ..Signal::certain(signal.mean)
    };
    // What the footprint has removed of both is one wave, of which the blur leaves a share.
    let [own, left] = [&height, &mean].map(|signal| signal.private + signal.shared_variance());
    let share = (left / own.max(1e-30)).min(1.0).sqrt();
    let removed = Signal {
        g: Vec2::splat(own.literal(0.0)),
        h: Sym2::splat(own.literal(0.0)),
        mean: own.literal(0.0),
        ..height.clone()
    };
    let bent = &response(&height) - &response(&mean);
    vec![(bent + removed * (1.0 - share)) * by]
}
