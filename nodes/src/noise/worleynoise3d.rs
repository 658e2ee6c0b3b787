//! `worleynoise3d`: distances to random points in space.

use crate::noise::cellnoise2d::PERIOD;
use crate::noise::components::HASH;
use crate::noise::source::{FREQUENCY, POSITION, SEED, place};
use crate::noise::worley::space::filtered;
use crate::noise::worleynoise2d::{JITTER, OUTPUT, SIGNATURE, STYLE, class, components, reach};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, PortSpec};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "worleynoise3d",
    aliases: &["worley 3d", "worley noise 3d", "voronoi 3d", "cellular 3d"],
    category: Category::Noise,
    summary: "Distances to the nearest of random points in space, or the random numbers of their regions.",
    doc: Doc {
        computes: "As `worleynoise2d` with one point in every cubic cell of frequency · position; the \
            nearest 27 cells are searched. With the hash `materialx` MaterialX’s `worleynoise3d` to \
            rounding, at a seed of 0.",
        statistics: "Not Gaussian: max |CDF − Φ| is about 0.04 (F1, F2), 0.1 (F2 − F1) or 0.058 (solid). \
            At a jitter of 1 the mean and standard deviation over space are those of `worley/shape.rs`. \
            Over a footprint the values at seven places of the surface (a rule of degree 5) give mean, \
            slope and variance, drawn towards the mean of the noise and the variance that a footprint \
            of this size removes, by the slopes that were measured in the plane. Approximate. The range is 0 to 3.6, of \
            numbers 0 to 1; the spectrum is that of a lattice of jittered points, which peaks at one \
            cycle a cell.",
        accuracy: "As `worleynoise2d` for footprints up to a fifth of a cell; beyond it the slopes are \
            those of the plane, and their error in space is not stated. Held by `tests/tests/parity.rs` \
            at a point.",
        references: "Worley 1996, *A cellular texture basis function*; MaterialX 1.39 specification, \
            node `worleynoise3d`; Stroud 1971, *Approximate Calculation of Multiple Integrals*, \
            E₂^{r²} 5-1.",
    },
    inputs: &[
        POSITION,
        FREQUENCY,
        JITTER,
        STYLE,
        OUTPUT,
        SEED,
        PortSpec {
            doc: "After how many cells the noise repeats in all three directions; 0 for never.",
            ..PERIOD
        },
        HASH,
        SIGNATURE,
    ],
    output: OutputType::Named("signature"),
    reach,
    class,
    example: r#"{ "version": 1, "name": "gravel",
        "nodes": { "worleynoise3d": { "type": "worleynoise3d", "inputs": { "frequency": 6, "output": "F2-F1" } } },
        "outputs": { "out": { "node": "worleynoise3d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = place(lower, node);
    let (components, range) = components(lower, node, true);
    (components.into_iter())
        .map(|worley| filtered(lower, &position, worley).with_range(range))
        .collect()
}
