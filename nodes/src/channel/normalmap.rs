//! The normal that a normal map holds.

use crate::arithmetic::vector::unit;
use crate::port::number;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
    Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "normalmap",
    aliases: &["decode_normal", "unpack_normal", "tangent_normal"],
    category: Category::Channel,
    summary: "The normal that the colour of a normal map means, in tangent space.",
    doc: Doc {
        computes: "out = n/|n| with n = (scale (2 in₁ − 1), scale (2 in₂ − 1), 2 in₃ − 1); 0 for an n \
            shorter than 1e-6. A float is all three numbers, of two the third is 1, a fourth is \
            ignored. The result is in tangent space: (0, 0, 1) is the surface's own normal. MaterialX \
            turns it by its inputs `normal`, `tangent` and `bitangent`, which do not exist here, as a \
            texture has no surface; and it takes in = 0 for a missing map.",
        statistics: "As `normalize`: a cubature of degree 5 over the joint Gaussian of the inputs, with \
            positive weights: mean, the slopes by each input, and the rest as a sum of squares. A \
            scale that varies is one of them. Where E|n|² is within 0.02 of 1 (and `scale` is 1) the vectors are \
            taken for unit normals, as those of a normal map are, and the result is the vectors \
            themselves over its root: means, variances and covariances of a map are exact; up to \
            0.06 both are mixed. The mean is shorter than 1 by what the normals of a \
            footprint differ.",
        accuracy: "For Gaussian inputs of standard deviations up to 0.1 around a normal the mean is within \
            1e-3 and the standard deviation within 6e-3; up to 0.2, within 0.02 and 0.04. Normals of \
            length 1 are no Gaussian: largest error of a component (root mean square) over footprints \
            from 0.01 to 5 wavelengths, round and 8:1, for the normals of a noise of three octaves: \
            0.024 (0.006) where its slopes have a standard deviation of 0.35, 0.075 (0.02) of 0.7, 0.16 \
            (0.05) of 1.4; the standard deviation is within 0.1, 0.18 and 0.26. Held by \
            `nodes/src/tests/vector.rs` against dense numerical integration in f64, and by \
            `nodes/src/pattern/tests/upstream.rs` against dense sums.",
        references: cite!(
            "Olano & Baker 2010, *LEAN Mapping* (what the normals of a footprint have in \
             common).",
            stroud; "normalmap"
        ),
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Any,
            Default::Color3([0.5, 0.5, 1.0]),
            "The colour of a normal map, or the same numbers as a vector.",
        ),
        number("scale", 1.0, "How much the normal leans: 0 for not at all.")
            .range(Range::soft(0.0, 2.0)),
    ],
    output: OutputType::Exactly(Type::Vector3),
    reach: |_| Reach::of(-1.0, 1.0),
    class: |inputs| {
        if inputs.varies("in") || inputs.varies("scale") {
            Behaviour::Rough {
                error: 0.05,
                place: "has a mean that is off by up to 0.16, and a standard deviation by 0.26, where the \
                    normals of a footprint lean to all sides by 50 degrees and more",
            }
        } else {
            Behaviour::Function
        }
    },
    example: example! { "normalmap", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "map": { "type": "heighttonormal", "inputs": { "in": { "node": "hills" }, "scale": 0.5 } },
    "normalmap": { "type": "normalmap", "inputs": { "in": { "node": "map" }, "scale": 1.5 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let color = lower.bundle(node, "in");
    let scale = lower.signal(node, "scale");
    let mut inputs = match &color[..] {
        [one] => vec![one.clone(); 3],
        [x, y] => vec![x.clone(), y.clone(), Signal::constant(lower.b(), 1.0)],
        more => more[..3].to_vec(),
    };
    let plain = scale.is_certain() && scale.mean.as_constant() == Some(1.0);
    inputs.push(scale);
    let ranges = [[-1.0, 1.0]; 3];
    if plain && lower.mode().spreads() {
        let exposed = inputs.iter().map(|x| lower.algebra.expose(x));
        inputs = exposed.collect();
    }
    let normals = lower.algebra.cubature(&inputs, &ranges, |v| {
        let scale = v[3];
        let [x, y, z] = [v[0], v[1], v[2]].map(|x| x + x + -1.0);
        unit(&[x * scale, y * scale, z])
    });
    if plain && lower.mode().spreads() {
        return decoded(&inputs[..3], &normals);
    }
    normals
}

/// Where E|n|² is this close to 1, vectors are taken for unit normals, and farther away for any.
const UNIT: [f32; 2] = [0.02, 0.06];

/// The vectors themselves, over the root of E|n|², where that says that they are unit normals, as those
/// of a normal map are, whatever their spread: a Gaussian of the same moments is not of one length, and
/// its directions are others. Else the normals of the Gaussian.
fn decoded<'b>(color: &[Signal<'b>], normals: &[Signal<'b>]) -> Bundle<'b> {
    let b = color[0].mean.builder();
    let vectors: Vec<Signal<'b>> = color
        .iter()
        .map(|x| (x * 2.0).offset(-1.0).flat())
        .collect();
    let squares = vectors.iter().map(|x| x.mean.square() + x.variance());
    let square = b.sum(squares);
    let [near, far] = UNIT;
    let share = ((far - (square - 1.0).abs()) * (1.0 / (far - near))).clamp(0.0, 1.0);
    let by = share / square.max(0.5).sqrt();
    (vectors.iter().zip(normals))
        .map(|(vector, normal)| (vector * by + normal * (1.0 - share)).with_range([-1.0, 1.0]))
        .collect()
}
