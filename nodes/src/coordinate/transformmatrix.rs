//! A vector times a matrix.

use crate::componentwise::total;
use crate::port::any;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "transformmatrix",
    aliases: &["matrix_multiply", "vector_transform_matrix"],
    category: Category::Coordinate,
    summary: "Multiplies a vector by a matrix.",
    doc: Doc {
        computes: "outᵢ = Σⱼ inⱼ mat[n j + i] with n the rows of the matrix: its numbers are listed column \
            by column, as MaterialX has them. What in lacks of n components is 1 (so that the last \
            column of the list moves a point); what is beyond the components of in is left out.",
        statistics: "Linear, exact for any distribution as far as the covariances of the components are \
            carried: a position stays exactly Gaussian, with its footprint transformed.",
        accuracy: "Exact to rounding. Held by `tests/tests/parity.rs` at a point, and by \
            `nodes/src/tests.rs` as the footprint goes to 0.",
        references: cite!(linear; "transformmatrix"),
    },
    inputs: &[
        any("in", 0.0, "The vector."),
        PortSpec::new(
            "mat",
            PortType::Matrix,
            Default::Identity,
            "The matrix, of three rows or four.",
        ),
    ],
    output: OutputType::Whole,
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Linear,
    example: example! { "transformmatrix" => "board", r#"
    "uv": { "type": "texcoord" },
    "transformmatrix": { "type": "transformmatrix", "inputs": {
        "in": { "node": "uv" }, "mat": [1, 0.3, 0, -0.3, 1, 0, 0.1, 0.2, 1] } },
    "board": { "type": "checkerboard", "inputs": { "texcoord": { "node": "transformmatrix" } } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let vector = lower.bundle(node, "in");
    let matrix = lower.matrix(node, "mat");
    let rows = if matrix.len() == 9 { 3 } else { 4 };
    let one = Signal::constant(lower.b(), 1.0);
    let component = |i: usize| {
        let terms = (0..rows).map(|j| vector.get(j).unwrap_or(&one) * matrix[rows * j + i]);
        total(lower.b(), terms)
    };
    (0..vector.len().min(rows))
        .map(component)
        // A vector of four keeps what a matrix of three rows does not reach.
        .chain(vector.iter().skip(rows).cloned())
        .collect()
}
