//! What is doubtful of a material's inputs.

use super::{Signal, reached};
use crate::{Diagnostic, Graph, Literal, Node, PortSpec, Source};

/// How far a value may lie beyond the bounds of its port without a word, in widths of the port: tails of a
/// noise are seldom.
const TAIL: f32 = 0.25;

/// How far from 1 the length of a normal is that nobody meant.
const LENGTH: f32 = 0.05;

/// What is doubtful of the inputs of a node that end in a material or are normals.
pub(super) fn warnings(graph: &Graph, signals: &[Signal], node: &Node) -> Vec<Diagnostic> {
    let ends = node.spec.material().is_some();
    let mut warnings = Vec::new();
    for (port, input) in node.spec.inputs.iter().zip(&node.inputs) {
        let reach = || reached::of(graph, signals, input);
        let at = |code, message| {
            Diagnostic::warning(code, message)
                .at(format!("{}/inputs/{}", node.pointer, port.name))
                .in_node(&*node.name)
                .in_port(port.name)
        };
        match &input.source {
            Source::Node(_) if ends && is_bounded(port) => {
                let values = reach().whole(1);
                let (low, high) = (port.range.min, port.range.max);
                let beyond = TAIL * (high - low);
                if values.low < low - beyond || values.high > high + beyond {
                    let message = format!("`{}` may be {values}", port.name);
                    let reason = format!(
                        "it is held within {low} to {high}, and its filter by its mean alone"
                    );
                    warnings.push(
                        at("beyond-range", message)
                            .because(reason)
                            .help("bring it into range with `range` or `clamp`"),
                    );
                }
            }
            Source::Node(_) if port.unit == "normal" => {
                let parts = [0, 1, 2].map(|i| reach().component(i).whole(1));
                // The colours of a map are never negative, and its third number is never small.
                if parts[..2].iter().all(|part| part.low >= 0.0) {
                    let message = format!("`{}` never leans to the left or downwards", port.name);
                    warnings.push(
                        at("not-a-normal", message)
                            .because("the colours of a normal map are from 0 to 1, its normals from -1 to 1")
                            .help("turn the colours into normals with `normalmap`"),
                    );
                }
            }
            Source::Literal(Literal::Numbers(_, [x, y, z, _])) if port.unit == "normal" => {
                let length = (x * x + y * y + z * z).sqrt();
                if (length - 1.0).abs() > LENGTH || *z <= 0.0 {
                    let message = format!("`{}` is ({x}, {y}, {z}), which is no normal", port.name);
                    warnings.push(
                        at("not-a-normal", message)
                            .because("a normal has the length 1, and points upwards: (0, 0, 1) is the surface's own"),
                    );
                }
            }
            _ => {}
        }
    }
    warnings
}

/// Whether a port has bounds that a signal may leave.
fn is_bounded(port: &PortSpec) -> bool {
    port.range.min > f32::MIN && port.range.max < f32::MAX
}
