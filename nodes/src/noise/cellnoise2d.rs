//! `cellnoise2d`: a random number in every cell.

use crate::noise::cell;
use crate::noise::cell::{Content, Lattice};
use crate::noise::components::{HASH, Hash};
use crate::noise::source::{FREQUENCY, SEED, TEXCOORD, position};
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, Node, NodeSpec, OutputType, PortSpec, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "cellnoise2d",
    aliases: &["cell noise", "cellnoise", "random squares"],
    category: Category::Noise,
    summary: "A random number of [0, 1) in every square cell.",
    doc: Doc {
        computes: "out = the random number of the cell ⌊frequency · texcoord⌋, uniform in [0, 1) and \
            independent of the other cells'.",
        statistics: "Uniform: mean ½, variance 1/12, range [0, 1); not Gaussian (max |CDF − Φ| is \
            0.058), but the mean over several cells is. Over a footprint a cell weighs the \
            probability of its box: mean, gradient and variance are sums over the cells within 2.8 \
            standard deviations. Within a row of cells the other coordinate is taken for Gaussian with \
            its mean and variance given the row. Beyond four cells the mean fades to ½, and what is \
            dropped joins the remainder. The spectrum is that of a box, sinc² in both directions.",
        accuracy: "For footprints along the axes of the lattice up to 3 cells exact but for the window: \
            the mean is within 0.009 standard deviations of the noise (of which the truth has a part), \
            and the local standard deviation within 0.009 from 0.3 cells on; for rotated 8:1 footprints within 0.022 and \
            0.012. Where it fades, beyond 3 cells along an axis, the mean loses up to 0.15. Held by `nodes/tests/sources.rs`; all sizes in \
            `tests/benches/sources.rs`.",
        references: "MaterialX 1.39 specification, node `cellnoise2d`; Heckbert 1989, *Fundamentals of \
            Texture Mapping and Image Warping*, §3.5.8 (Gaussian footprints); Johnson & Kotz, \
            *Continuous Univariate Distributions*, ch. 13 (truncated normals).",
    },
    inputs: &[TEXCOORD, FREQUENCY, SEED, PERIOD, HASH],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Random { deviation: 0.058 },
    example: r#"{ "version": 1, "name": "tiles",
        "nodes": { "cellnoise2d": { "type": "cellnoise2d", "inputs": { "frequency": 8 } } },
        "outputs": { "out": { "node": "cellnoise2d" } } }"#,
};

/// Whether it tiles.
pub(crate) const PERIOD: PortSpec = port::integer(
    "period",
    0,
    "After how many cells the noise repeats in both directions; 0 for never.",
)
.uniform()
.range(Range::hard(0.0, 65536.0).with_soft(0.0, 64.0))
.unit("cells");

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let lattice = Lattice {
        seed: lower.integer(node, "seed"),
        period: lower.integer(node, "period"),
        hash: Hash::of(lower, node),
    };
    cell::filtered(lower, &position, Content::InPlane(lattice))
}

/// Every cell has a number.
pub(super) fn things(_: &Node) -> bool {
    true
}
