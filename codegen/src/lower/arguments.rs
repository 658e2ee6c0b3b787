//! The scalars that every function of the graph takes.

use super::{identifier, symbols};
use crate::ir::{Builder, FOOTPRINT, POSITION, Type as Scalar, Value};
use mipless_graph::{Graph, Type};

/// The parameters of an entry or of a function that stands for the graph.
pub(super) struct Arguments {
    pub(super) footprint: [Value; 8],
    /// Where the graph reads the position in space.
    pub(super) position: Option<[Value; 12]>,
    pub(super) parameters: Vec<Value>,
}

impl Arguments {
    pub(super) fn declare(b: &mut Builder, graph: &Graph) -> Self {
        let footprint = FOOTPRINT.map(|(name, ty)| b.param(name, ty));
        let position =
            symbols::reads_position(graph).then(|| POSITION.map(|(name, ty)| b.param(name, ty)));
        Self {
            footprint,
            position,
            parameters: Self::parameters(b, graph),
        }
    }

    /// The inputs of the graph as parameters of a function.
    pub(super) fn parameters(b: &mut Builder, graph: &Graph) -> Vec<Value> {
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
                    Type::Integer => Scalar::I32,
                    Type::Boolean => Scalar::Bool,
                    _ => Scalar::F32,
                };
                // Two names may meet in one identifier.
                let name = format!("p{}_{name}", parameters.len());
                parameters.push(b.param(name, ty));
            }
        }
        parameters
    }

    pub(super) fn all(&self) -> Vec<Value> {
        self.footprint
            .iter()
            .chain(self.position.iter().flatten())
            .chain(&self.parameters)
            .copied()
            .collect()
    }
}
