//! A vector times a matrix.

use crate::componentwise::total;
use crate::port::any;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Interval, Node, NodeSpec, OutputType, PortSpec,
    PortType, Reach,
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
    reach,
    class: |_| Behaviour::Linear,
    example: example! { "transformmatrix" => "board", r#"
    "uv": { "type": "texcoord" },
    "transformmatrix": { "type": "transformmatrix", "inputs": {
        "in": { "node": "uv" }, "mat": [1, 0.3, 0, -0.3, 1, 0, 0.1, 0.2, 1] } },
    "board": { "type": "checkerboard", "inputs": { "texcoord": { "node": "transformmatrix" } } }
"# },
};

/// How many rows a matrix of so many numbers has.
const fn rows(numbers: usize) -> usize {
    if numbers == 9 { 3 } else { 4 }
}

/// The same sums as [`lower`] has: what a column leaves out is not looked at, so that w of a point
/// stays 1.
fn reach(inputs: &dyn InputView) -> Reach {
    let (matrix, vector) = (inputs.matrix("mat"), inputs.reach("in"));
    let (rows, components) = (rows(matrix.len()), inputs.components("in"));
    let mut out = vector;
    for i in 0..components.min(rows) {
        out.0[i] = (0..rows)
            .map(|j| {
                let component = match vector.0.get(j) {
                    Some(component) if j < components => *component,
                    _ => Interval::point(1.0),
                };
                component * Interval::point(matrix[rows * j + i])
            })
            .reduce(|sum, term| sum + term)
            .unwrap_or(Interval::ANY);
    }
    out
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let vector = lower.bundle(node, "in");
    let matrix = lower.matrix(node, "mat");
    let rows = rows(matrix.len());
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
