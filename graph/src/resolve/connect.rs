//! What is connected to an input: whether its type converts, whether its numbers are accepted, and
//! how to say so.

use super::template::Template;
use super::{Context, literal, range};
use crate::{Diagnostic, Graph, Literal, NodeSpec, PortSpec, Source, Type};

/// A value that is known: where it comes from, the type that it has there, and the type that it is
/// seen as (an input of a sub-graph may be wider than what is connected to it).
#[derive(Clone, Debug)]
pub(super) struct Bound {
    pub(super) source: Source,
    pub(super) from: Type,
    pub(super) seen: Type,
}

/// Where something stands, built only when something is reported.
pub(super) struct Place<'a, 'd> {
    pub(super) template: &'a Template<'d>,
    pub(super) node: usize,
    pub(super) path: &'a str,
}

impl Place<'_, '_> {
    pub(super) fn node(&self, code: &'static str, message: String) -> Diagnostic {
        let diagnostic = Diagnostic::error(code, message);
        let diagnostic = diagnostic
            .at(self.template.node_pointer(self.node))
            .in_node(self.path);
        if self.template.name.is_empty() {
            diagnostic
        } else {
            diagnostic.because(format!(
                "`{}` is a node of the sub-graph `{}`",
                self.path, self.template.name
            ))
        }
    }

    pub(super) fn port(&self, code: &'static str, port: &str, message: String) -> Diagnostic {
        let at = self.template.port_pointer(self.node, port);
        self.node(code, message).at(at).in_port(port)
    }
}

/// The same value seen as a type, if it converts.
pub(super) fn convert(
    context: &mut Context<'_>,
    graph: &Graph,
    place: &Place<'_, '_>,
    port: &str,
    ty: Type,
    bound: Bound,
) -> Option<Bound> {
    if bound.seen.converts_to(ty) {
        let Source::Literal(value) = &bound.source else {
            return Some(Bound { seen: ty, ..bound });
        };
        let value = literal::from_numbers(&value.numbers(), ty).unwrap_or_else(|| value.clone());
        return Some(Bound {
            source: Source::Literal(value),
            from: ty,
            seen: ty,
        });
    }
    let message = format!("`{port}` wants a `{ty}`, not a `{}`", bound.seen);
    let help = conversion(context.specs, bound.seen, ty);
    let mut diagnostic = place
        .port("type-mismatch", port, message)
        .because(origin(graph, &bound))
        .help_if(help);
    if matches!(bound.seen, Type::Color3 | Type::Color4) && ty == Type::Vector2 {
        diagnostic =
            diagnostic.because("a colour is no position: its channels are not coordinates");
    }
    context.report(diagnostic);
    None
}

/// Where a value comes from, as a reason.
pub(super) fn origin(graph: &Graph, bound: &Bound) -> String {
    match &bound.source {
        Source::Literal(_) => format!("the literal is a `{}`", bound.seen),
        Source::Surface => format!("the surface's coordinates are a `{}`", bound.seen),
        Source::Parameter(parameter) => {
            let name = &graph.parameters[parameter.index()].name;
            format!("the input `{name}` is a `{}`", bound.seen)
        }
        Source::Node(node) => {
            let node = graph.node(*node);
            format!(
                "the node `{}` (`{}`) is a `{}`",
                node.name, node.spec.name, bound.seen
            )
        }
    }
}

/// Which node of the catalogue would turn one type into another.
pub(super) fn conversion(specs: &[&'static NodeSpec], from: Type, to: Type) -> Option<String> {
    let known = |name: &&&str| specs.iter().any(|spec| spec.name == **name);
    let names: &[&str] = match (from, to) {
        (_, Type::Float) => &["extract"],
        (_, Type::Vector2) => &["combine2", "convert"],
        (Type::Vector2 | Type::Vector3 | Type::Vector4, Type::Color3) => &["combine3", "convert"],
        _ => &["convert"],
    };
    let names: Vec<&str> = names.iter().filter(known).copied().collect();
    (!names.is_empty()).then(|| format!("convert it with `{}`", names.join("` or `")))
}

/// Whether a value lies in the range of a port.
pub(super) fn check_range(
    context: &mut Context<'_>,
    graph: &Graph,
    place: &Place<'_, '_>,
    port: &PortSpec,
    source: &Source,
) -> bool {
    let (refusal, what) = match source {
        Source::Literal(Literal::Numbers(ty, numbers)) => {
            let numbers = &numbers[..ty.components()];
            let refused = numbers
                .iter()
                .find_map(|x| Some((range::refusal(&port.range, *x, *x)?, x)));
            match refused {
                Some((refusal, number)) => (refusal, format!("`{}` is {number}", port.name)),
                None => return true,
            }
        }
        Source::Literal(Literal::Stops(stops)) => {
            let refused = (stops.stops.iter())
                .find_map(|stop| Some((range::refusal(&port.range, stop.at, stop.at)?, stop.at)));
            match refused {
                Some((refusal, at)) => (refusal, format!("a stop of `{}` is at {at}", port.name)),
                None => return true,
            }
        }
        Source::Literal(Literal::Integer(number)) => {
            match range::refusal(&port.range, *number as f32, *number as f32) {
                Some(refusal) => (refusal, format!("`{}` is {number}", port.name)),
                None => return true,
            }
        }
        Source::Parameter(parameter) => {
            let parameter = &graph.parameters[parameter.index()];
            let (low, high) = range::bounds(parameter);
            match range::refusal(&port.range, low, high) {
                Some(refusal) => {
                    let bounds = range::shown_bounds(parameter.min, parameter.max);
                    let what = format!(
                        "`{}` is the input `{}`, which can be {bounds}",
                        port.name, parameter.name
                    );
                    let help = format!("narrow `min` and `max` of the input `{}`", parameter.name);
                    let message = format!("{what}: {refusal}");
                    let diagnostic = place.port("out-of-range", port.name, message);
                    let reason = "an input is checked over all of its [min, max]";
                    context.report(diagnostic.because(reason).help(help));
                    return false;
                }
                None => return true,
            }
        }
        Source::Literal(_) | Source::Node(_) | Source::Surface => return true,
    };
    context.report(place.port("out-of-range", port.name, format!("{what}: {refusal}")));
    false
}
