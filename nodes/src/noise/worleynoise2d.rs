//! `worleynoise2d`: distances to random points.

use crate::noise::cellnoise2d::PERIOD;
use crate::noise::components::{HASH, Hash};
use crate::noise::source::{FREQUENCY, SEED, TEXCOORD, position};
use crate::noise::worley::{self, Output, Worley};
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Literal, Node, NodeSpec, OutputType, PortSpec, Range,
    Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "worleynoise2d",
    aliases: &["worley", "worley noise", "voronoi", "cellular", "cells"],
    category: Category::Noise,
    summary: "Distances to the nearest of random points, or the random numbers of their regions.",
    doc: Doc {
        computes: "One point lies in every cell of frequency · texcoord, at its centre moved by \
            jitter · (r − ½), r uniform. With `style` `distance`, `output` is the distance to the \
            nearest point (`F1`), to the second nearest (`F2`), their difference (`F2-F1`), or to the \
            third (`F3`), in cells; with `solid` it is the random number of [0, 1) of that point, or the second's \
            less the first's. Points within 1.5 cells are found. With the hash \
            `materialx` MaterialX’s `worleynoise2d` to rounding, at a seed of 0, which searches the \
            nearest nine cells.",
        statistics: "Not Gaussian: max |CDF − Φ| is about 0.04 (F1, F2), 0.1 (F2 − F1) or 0.058 \
            (solid). The range is 0 to √2 (F1), to 1.81 (F2), or [0, 1) (solid; differences ±1). The \
            spectrum is broad up to about a cycle a cell and falls from there, as k⁻⁵ by the creases \
            of distances and as k⁻³ by the edges of solid regions. Over the plane at a jitter of 1 the mean and standard deviation are 0.429 and \
            0.190 (F1), 0.699 and 0.177 (F2), 0.270 and 0.202 (F2 − F1), ½ and 0.289 (solid). Over \
            a footprint the values at seven places (a rule of degree 5) give mean, gradient and \
            variance; their mean is drawn towards that of the plane, and their variance towards the \
            average that a footprint of this size removes, by slopes that were measured by size. \
            Beyond 1.5 cells only the statistics of the plane are left. Functions of the numbers of solid regions are \
            summed over the regions along lines through the footprint, and beyond 1.1 to 1.3 cells over their \
            points, weighted by the density there; they fade to the mean over all numbers from 3 to 4 cells.",
        accuracy: "The filtered mean is within 0.01, 0.03, 0.07, 0.21 and 0.15 standard deviations of \
            the noise (F1, root mean square) at footprints of 0.05, 0.1, 0.2, 0.4 and 0.8 cells, 0.02 to \
            0.23 for F2 − F1, 0.07 to 0.22 for solid regions, and 0.26 to 0.3 at 8:1 where the axes are \
            0.15 and 1.2 cells. The local standard deviation is within 0.03 to 0.1 of the true one (F1) \
            and 0.1 to 0.35 (solid). Slopes are those of a jitter of 1. Random colours of \
            regions are within 0.012 as a display shows them under pixels of up to 6 cells: \
            `tests/tests/field.rs`. Held by `nodes/tests/sources.rs`; all sizes in `tests/benches/sources.rs`.",
        references: "Worley 1996, *A cellular texture basis function*; MaterialX 1.39 specification, \
            node `worleynoise2d`; Stroud 1971, *Approximate Calculation of Multiple Integrals*, \
            E₂^{r²} 5-1.",
    },
    inputs: &[
        TEXCOORD, FREQUENCY, JITTER, STYLE, OUTPUT, SEED, PERIOD, HASH, SIGNATURE,
    ],
    output: OutputType::Named("signature"),
    reach,
    class,
    example: r#"{ "version": 1, "name": "pebbles",
        "nodes": { "worleynoise2d": { "type": "worleynoise2d", "inputs": { "frequency": 6, "output": "F2-F1" } } },
        "outputs": { "out": { "node": "worleynoise2d" } } }"#,
};

/// How irregular.
pub(crate) const JITTER: PortSpec = port::number(
    "jitter",
    1.0,
    "How far points leave the centres of their cells.",
)
.uniform()
.range(Range::hard(0.0, 1.0));

/// What of a point.
pub(crate) const STYLE: PortSpec = port::choice(
    "style",
    &["distance", "solid"],
    "distance",
    "Distances, or a random number for each region.",
);

/// Of which point.
pub(crate) const OUTPUT: PortSpec = port::choice(
    "output",
    &["F1", "F2", "F2-F1", "F3"],
    "F1",
    "Of the nearest point, the second, the difference of the two, or (of distances) the third.",
);

/// How many points.
pub(crate) const SIGNATURE: PortSpec = port::choice(
    "signature",
    &["float", "vector2", "vector3"],
    "float",
    "The type of the result: a float is the output that is asked for, a vector the distances of the \
     nearest points in order, or random numbers of the nearest one.",
);

/// What the values lie between.
pub(crate) fn reach(inputs: &dyn InputView) -> Reach {
    match (inputs.choice("style"), inputs.choice("output")) {
        ("solid", "F2-F1") => Reach::of(-1.0, 1.0),
        ("solid", _) => Reach::of(0.0, 1.0),
        _ => Reach::of(0.0, 2.5),
    }
}

/// Not Gaussian; the third region is not told apart.
pub(crate) fn class(inputs: &dyn InputView) -> Behaviour {
    let deviation = match (inputs.choice("style"), inputs.choice("output")) {
        ("solid", "F3") => {
            return Behaviour::Refused {
                port: "output",
                reason: "of solid regions there are those of the nearest and the second point",
            };
        }
        ("solid", _) => 0.058,
        (_, "F2-F1") => 0.1,
        _ => 0.04,
    };
    Behaviour::Random { deviation }
}

/// The noises of a node's components, and what all lie between.
pub(crate) fn components(
    lower: &Lower<'_, '_>,
    node: &Node,
    space: bool,
) -> (Vec<Worley>, [f32; 2]) {
    let solid = lower.choice(node, "style") == "solid";
    let output = match lower.choice(node, "output") {
        "F2" => Output::Second,
        "F2-F1" => Output::Difference,
        "F3" => Output::Third,
        _ => Output::First,
    };
    let worley = Worley {
        jitter: lower.float(node, "jitter"),
        solid,
        output,
        period: lower.integer(node, "period"),
        seed: lower.integer(node, "seed"),
        hash: Hash::of(lower, node),
        channel: None,
        space,
    };
    let range = match (solid, output) {
        (true, Output::Difference) => [-1.0, 1.0],
        (true, _) => [0.0, 1.0],
        // No point of the window is farther than its corner.
        (false, _) => [0.0, 3.6],
    };
    let count = node.ty.components();
    let component = |i: usize| match (count, solid) {
        (1, _) => worley,
        (_, true) => Worley {
            output: Output::First,
            channel: Some(i as u8),
            ..worley
        },
        (_, false) => Worley {
            output: [Output::First, Output::Second, Output::Third][i],
            ..worley
        },
    };
    ((0..count).map(component).collect(), range)
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let (components, range) = components(lower, node, false);
    (components.into_iter())
        .flat_map(|worley| worley::filtered(lower, &position, worley, range))
        .collect()
}

/// The regions of the nearest points have numbers: of several components, several that no function of
/// one number gives.
pub(super) fn things(node: &Node) -> bool {
    let chosen = |port: &str| match node.literal(port) {
        Literal::Text(text) => text.as_str(),
        _ => "",
    };
    chosen("style") == "solid" && chosen("output") == "F1" && node.ty.components() == 1
}
