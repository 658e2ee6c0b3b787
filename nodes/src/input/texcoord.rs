//! The texture coordinates of the surface.

use crate::port;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "texcoord",
    aliases: &["uv", "texture_coordinate", "texturecoordinate", "uvmap"],
    category: Category::Input,
    summary: "The texture coordinates of the surface.",
    doc: Doc {
        computes: "out = (u, v), in units of texture space; (u, v, 0) as a vector3. There is one set \
            of coordinates, whatever the index.",
        statistics: "Position: within the footprint exactly Gaussian with mean uv and covariance AAᵀ, A = \
            s·[du dv], where du and dv are the changes of uv from a pixel to its neighbours and \
            s is the standard deviation of the pixel filter in pixels. A box filter is replaced \
            by the Gaussian of its variance, 1/12 square pixels.",
        accuracy: "Exact for a surface that is flat within the pixel. The mean is carried as an integer \
            cell and a fraction in [0, 1), so it keeps its detail up to coordinates of 8 \
            million.",
        references: cite!(
            "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 \
             (Gaussian footprints under affine maps)."; "texcoord"
        ),
    },
    inputs: &[
        port::integer("index", 0, "Which set of coordinates: all are one.")
            .uniform()
            .range(Range::hard(0.0, 7.0)),
        port::choice(
            "signature",
            &["vector2", "vector3"],
            "vector2",
            "The type of the result.",
        ),
    ],
    output: OutputType::Named("signature"),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Position,
    example: example! { "texcoord", r#"
    "texcoord": { "type": "texcoord" }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut place = lower.surface();
    if lower.choice(node, "signature") == "vector3" {
        place.push(Signal::constant(lower.b(), 0.0));
    }
    place
}
