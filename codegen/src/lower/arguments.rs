//! The scalars that every function of the graph takes.

use super::place::Place;
use super::{identifier, symbols};
use crate::ir::{Builder, FOOTPRINT, Float, POSITION, Scalar, Scalars, Type as Kind};
use mipless_graph::{Graph, Type};

/// The parameters of an entry or of a function that stands for the graph.
#[derive(Clone, Debug)]
pub(super) struct Arguments<'b> {
    pub(super) footprint: Place<'b, 2>,
    /// Where the graph reads the position in space.
    pub(super) position: Option<Place<'b, 3>>,
    /// The inputs of the graph.
    pub(super) parameters: Vec<Scalar<'b>>,
}

impl<'b> Arguments<'b> {
    pub(super) fn declare(b: &'b Builder, graph: &Graph) -> Self {
        let footprint = Place::declare(b, &FOOTPRINT);
        let position = symbols::reads_position(graph).then(|| Place::declare(b, &POSITION));
        Self {
            footprint,
            position,
            parameters: Self::parameters(b, graph),
        }
    }

    /// Of a function that reads these inputs of the graph, but not where the pixel is. What it holds
    /// is the same everywhere, and may still be written as a noise at some place.
    pub(super) fn without_place(
        b: &'b Builder,
        graph: &Graph,
        parameters: Vec<Scalar<'b>>,
    ) -> Self {
        Self {
            footprint: Place::origin(b),
            position: symbols::reads_position(graph).then(|| Place::origin(b)),
            parameters,
        }
    }

    /// Of a function that reads where a point is, with the inputs of the graph at their defaults.
    pub(super) fn of_place(b: &'b Builder, graph: &Graph, footprint: Place<'b, 2>) -> Self {
        let parameters = graph.parameters.iter().flat_map(|parameter| {
            let of = move |x: f32| match parameter.ty {
                Type::Integer => b.int(x as i32).into(),
                Type::Boolean => b.literal(x != 0.0).into(),
                _ => b.float(x).into(),
            };
            parameter.value.numbers().into_iter().map(of)
        });
        Self {
            footprint,
            position: None,
            parameters: parameters.collect(),
        }
    }

    /// The inputs of the graph as parameters of a function.
    pub(super) fn parameters(b: &'b Builder, graph: &Graph) -> Vec<Scalar<'b>> {
        let mut parameters = Vec::new();
        for parameter in &graph.parameters {
            let components = parameter.ty.components();
            for i in 0..components {
                let name = if components == 1 {
                    identifier(&parameter.name)
                } else {
                    format!("{}_{i}", identifier(&parameter.name))
                };
                let ty = match parameter.ty {
                    Type::Integer => Kind::I32,
                    Type::Boolean => Kind::Bool,
                    _ => Kind::F32,
                };
                // Two names may meet in one identifier.
                let name = format!("p{}_{name}", parameters.len());
                parameters.push(b.scalar_param(name, ty));
            }
        }
        parameters
    }

    /// With a footprint that is finite.
    pub(super) fn finite(self) -> Self {
        Self {
            footprint: self.footprint.finite(),
            position: self.position.map(Place::finite),
            ..self
        }
    }

    /// Moved by (x, y) pixels.
    pub(super) fn moved(self, pixels: [Float<'b>; 2]) -> Self {
        Self {
            footprint: self.footprint.moved(pixels),
            position: self.position.map(|position| position.moved(pixels)),
            ..self
        }
    }

    /// Each change from pixel to pixel through `f`.
    pub(super) fn with_changes(self, f: impl Fn(Float<'b>) -> Float<'b>) -> Self {
        Self {
            footprint: self.footprint.with_changes(&f),
            position: self.position.map(|position| position.with_changes(&f)),
            ..self
        }
    }

    /// Without a footprint.
    pub(super) fn at_point(self) -> Self {
        self.with_changes(|change| change.literal(0.0))
    }
}

impl<'b> Scalars<'b> for Arguments<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.footprint.each(visit);
        self.position.each(visit);
        self.parameters.each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        Self {
            footprint: self.footprint.replaced(next),
            position: self.position.replaced(next),
            parameters: self.parameters.replaced(next),
        }
    }
}
