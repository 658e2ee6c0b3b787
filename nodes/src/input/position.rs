//! The surface's position in space.

use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "position",
    aliases: &[
        "object position",
        "world position",
        "texture coordinate object",
    ],
    category: Category::Input,
    summary: "Where the surface is in space.",
    doc: Doc {
        computes: "out = (x, y, z), in units of space: what the shader’s caller passes as its second \
            argument. In the flat view it is (u, v, 0), in the plane view the point of the plane \
            y = 0, in the sphere view the point of the unit sphere.",
        statistics: "Position: within the footprint exactly Gaussian with mean xyz and covariance AAᵀ of \
            rank 2, A = s·[dx dy], where dx and dy are the changes of the position from a pixel to \
            its neighbours and s is the standard deviation of the pixel filter in pixels.",
        accuracy: "Exact for a surface that is flat within the pixel. The mean is carried as an integer \
            cell and a fraction in [0, 1), so it keeps its detail up to coordinates of 8 million.",
        references: cite!("MaterialX 1.39 specification, node `position`.", heckbert),
    },
    inputs: &[port::choice(
        "space",
        &["object"],
        "object",
        "The space of the coordinates: the one that the shader’s caller passes.",
    )],
    output: OutputType::Exactly(Type::Vector3),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Position,
    example: example! { "position", r#"
    "position": { "type": "position" }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, _: &Node) -> Bundle<'b> {
    lower.space()
}
