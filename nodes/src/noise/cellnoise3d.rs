//! `cellnoise3d`: a random number in every cell of space.

use crate::noise::cell::Lattice;
use crate::noise::cell::space;
use crate::noise::cellnoise2d::PERIOD;
use crate::noise::components::{HASH, Hash};
use crate::noise::source::{FREQUENCY, POSITION, SEED, place};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, PortSpec, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "cellnoise3d",
    aliases: &["cell noise 3d", "random cubes"],
    category: Category::Noise,
    summary: "A random number of [0, 1) in every cubic cell.",
    doc: Doc {
        computes: "out = the random number of the cell ⌊frequency · position + 1/1024⌋, uniform in [0, 1) and \
            independent of the other cells'. The thousandth of a cell keeps a surface at 0, as every flat \
            one is, in one layer of cells; on their faces, where MaterialX's lies, it would be half in each \
            of two.",
        statistics: "Uniform: mean ½, variance 1/12, range [0, 1); not Gaussian (max |CDF − Φ| is \
            0.058), but the mean over several cells is. A footprint is a Gaussian on the surface, in \
            space one of covariance Σ of rank 2, and a cell weighs the probability of its box: mean, \
            gradient and variance are sums over the cells within 2.8 standard deviations. Within a \
            layer of cells the other two coordinates, and within a row the last one, are taken for \
            Gaussian with the moments that they have given it. Beyond four cells along an axis the \
            mean fades to ½, and what is dropped joins the remainder. The spectrum is that of a box, sinc² in \
            all directions.",
        accuracy: "For round footprints on a plane at any angle, from 0.1 to 1 cells, the mean is within 0.025 \
            standard deviations of the noise (of which the truth has a part), and the local standard \
            deviation within 0.02; at 8:1 within 0.04 and 0.03. Where it fades, beyond 3 cells along an \
            axis, as `cellnoise2d`. Held by `nodes/tests/volume.rs`.",
        references: "MaterialX 1.39 specification, node `cellnoise3d`; Heckbert 1989, *Fundamentals of \
            Texture Mapping and Image Warping*, §3.5.8 (Gaussian footprints); Johnson & Kotz, \
            *Continuous Univariate Distributions*, ch. 13 (truncated normals).",
    },
    inputs: &[
        POSITION,
        FREQUENCY,
        SEED,
        PortSpec {
            doc: "After how many cells the noise repeats in all three directions; 0 for never.",
            ..PERIOD
        },
        HASH,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Random { deviation: 0.058 },
    example: r#"{
  "version": 1,
  "name": "blocks",
  "nodes": {
    "cellnoise3d": { "type": "cellnoise3d", "inputs": { "frequency": 8 } }
  },
  "outputs": { "out": { "node": "cellnoise3d" } }
}"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = place(lower, node);
    let lattice = Lattice {
        seed: lower.integer(node, "seed"),
        period: lower.integer(node, "period"),
        hash: Hash::of(lower, node),
    };
    space::filtered(lower, &position, lattice)
}

/// Every cell has a number.
pub(super) fn things(_: &Node) -> bool {
    true
}
