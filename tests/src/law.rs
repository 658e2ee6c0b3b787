//! The laws of composition: what holds for every graph that the check accepts, whoever wrote it. Those of a
//! graph alone are [`mipless::conformance`]'s; here are the bounds of nodes by their kind, and what takes
//! the truth of pictures.

use crate::measured::{Effort, Measured};
use crate::shown::wavelength;
pub use mipless::conformance::{Law, Violation};
use mipless::{Literal, Method, Texture, conformance};
use mipless_graph::Node;

/// What a graph breaks of these laws, by these methods. Panics are always found.
pub fn violations(texture: &Texture, laws: &[Law], methods: &[Method]) -> Vec<Violation> {
    let mut all = conformance::violations(texture, laws, methods, &bounds);
    if laws.contains(&Law::Worse) && methods.contains(&Method::Auto) {
        let of = |what| Violation {
            law: Law::Worse,
            method: Method::Auto,
            what,
        };
        all.extend(worse(texture).into_iter().map(of));
    }
    all
}

/// How much of a graph is held against the truth.
const EFFORT: Effort = Effort {
    pixels: 12,
    samples: 128,
};

/// The errors of a graph that `auto` makes worse.
fn worse(texture: &Texture) -> Vec<String> {
    let measured = wavelength(texture).map(|length| Measured::of(texture, length, EFFORT));
    let worse = measured.filter(|errors| errors.excess() > 0.0);
    let said = worse.map(|errors| {
        let Measured { auto, point, floor } = errors;
        format!("{auto:.4}, where a point is off by {point:.4} and the truth by {floor:.4}")
    });
    said.into_iter().collect()
}

/// Bounds of each component that a node gives, whatever it is given, where its kind has any.
fn bounds(node: &Node) -> Option<Vec<[f32; 2]>> {
    let all = |bounds| Some(vec![bounds; node.ty.components()]);
    match node.spec.name {
        "colorramp" => {
            let Literal::Stops(ramp) = node.literal("stops") else {
                panic!("a ramp has stops");
            };
            let of = |component: usize| {
                let values = ramp.stops.iter().map(|stop| stop.value[component]);
                let low = values.clone().fold(f32::INFINITY, f32::min);
                [low, values.fold(f32::NEG_INFINITY, f32::max)]
            };
            Some((0..node.ty.components()).map(of).collect())
        }
        "step" | "smoothstep" | "fract" | "squarewave" | "stripes" | "shape" | "circle"
        | "hexagon" | "grid" | "crosshatch" => all([0.0, 1.0]),
        "trianglewave" => all([0.0, 0.5]),
        "sin" | "cos" | "sign" => all([-1.0, 1.0]),
        _ => None,
    }
}
