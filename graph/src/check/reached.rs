//! What values reach an input.

use super::Signal;
use crate::{Graph, Input, Literal, Reach, Source, Stops, Type};

/// The values that an input can have, of the type that the node sees.
pub(super) fn of(graph: &Graph, signals: &[Signal], input: &Input) -> Reach {
    let own = match &input.source {
        Source::Literal(Literal::Stops(stops)) => of_stops(stops),
        Source::Literal(literal) => Reach::numbers(&literal.numbers()),
        Source::Node(node) => signals[node.index()].reach,
        Source::Parameter(id) => {
            let parameter = &graph.parameters[id.index()];
            match parameter.ty {
                Type::Boolean => Reach::of(0.0, 1.0),
                _ => Reach::of(
                    parameter.min.unwrap_or(f32::NEG_INFINITY),
                    parameter.max.unwrap_or(f32::INFINITY),
                ),
            }
        }
        Source::Surface => Reach::ANY,
    };
    promoted(own, input.from, input.ty)
}

/// The values between those of the stops.
fn of_stops(stops: &Stops) -> Reach {
    let values =
        (stops.stops.iter()).map(|stop| Reach::numbers(&stop.value[..stops.ty.components()]));
    values.reduce(Reach::hull).unwrap_or(Reach::ANY)
}

/// Floats broadcast, to alpha too; a colour gains an alpha of 1.
fn promoted(own: Reach, from: Type, to: Type) -> Reach {
    let mut reach = if from.components() == 1 {
        own.component(0)
    } else {
        own
    };
    if to == Type::Color4 && from == Type::Color3 {
        reach.0[3] = crate::Interval::point(1.0);
    }
    reach
}
