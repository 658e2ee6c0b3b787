//! A node at a coordinate, as the rules see it.

use super::{Maker, PortOf, Signature, parameter, rules};
use crate::build::{Builder, Refusal};
use crate::eval::Call;
use crate::json::Json;
use crate::place::Place;
use crate::rule::Expr;
use crate::value::{Literal, Value};
use mipless_graph::Type;

/// A node at a coordinate.
pub(super) struct NodeCall<'m, 'a> {
    pub(super) maker: &'m mut Maker<'a>,
    pub(super) port: &'m PortOf,
    pub(super) kind: &'m str,
    pub(super) signature: Option<&'m Signature>,
    pub(super) uv: Value,
    pub(super) hint: String,
    pub(super) place: Place,
}

/// What an input holds that nothing is connected to, as a function of the coordinate where it is
/// asked.
struct Unconnected<'c, 'm, 'a> {
    call: &'c mut NodeCall<'m, 'a>,
    uv: Value,
}

impl NodeCall<'_, '_> {
    /// An input at a coordinate, or its alpha.
    fn connected(
        &mut self,
        builder: &mut Builder,
        name: &str,
        at: Option<&Value>,
        alpha: bool,
    ) -> Option<Result<Value, Refusal>> {
        let signature = self.signature?;
        let index = signature.inputs.iter().position(|port| port.name == name)?;
        let port = &signature.inputs[index];
        // A node of many inputs and outputs reads of each output the input of the same number.
        let number = if name.ends_with('#') {
            self.port.port
        } else {
            index
        };
        let uv = at.cloned().unwrap_or_else(|| self.uv.clone());
        let source = self
            .maker
            .graphs
            .source(self.port.graph, &self.port.node, number);
        let value = match source {
            Some(source) => self.elsewhere(builder, |maker| {
                let value = maker.port(&source, &uv, alpha)?;
                maker.typed(value, if alpha { "f" } else { &port.ty })
            }),
            None if alpha => Ok(Value::float(1.0)),
            None => crate::eval::eval(&port.default, builder, &mut Unconnected { call: self, uv }),
        };
        Some(value)
    }

    /// Lets other nodes be made by the same builder.
    fn elsewhere<T>(
        &mut self,
        builder: &mut Builder,
        make: impl FnOnce(&mut Maker<'_>) -> Result<T, Refusal>,
    ) -> Result<T, Refusal> {
        let notes = std::mem::take(&mut builder.notes);
        std::mem::swap(builder, &mut self.maker.builder);
        let made = make(self.maker);
        std::mem::swap(builder, &mut self.maker.builder);
        builder.notes = notes;
        builder.hint.clone_from(&self.hint);
        builder.place = Some(self.place.clone());
        made
    }

    fn json(&self, name: &str) -> Result<&Json, Refusal> {
        let json = self
            .maker
            .graphs
            .parameter(self.port.graph, &self.port.node, name);
        json.ok_or_else(|| {
            Refusal::new(
                "import-input-missing",
                format!("it has no input or parameter `{name}`"),
            )
        })
    }

    /// A parameter, or what is made of a gradient.
    fn parameter(&mut self, builder: &mut Builder, name: &str) -> Result<Value, Refusal> {
        if name == "gradient" || name == "gradient_alpha" {
            let stops = parameter::stops(self.json("gradient")?, name == "gradient_alpha")?;
            return Ok(Value::Literal(Literal::Json(stops)));
        }
        if name == "gradient_opaque" {
            let opaque = parameter::is_opaque(self.json("gradient")?);
            return Ok(Value::float(f64::from(u8::from(opaque))));
        }
        if name == "gradient_interpolation" {
            let interpolation = self.json("gradient")?.get("interpolation");
            return Ok(Value::float(
                interpolation.and_then(Json::number).unwrap_or(1.0),
            ));
        }
        let graphs = &self.maker.graphs;
        match graphs.parameter(self.port.graph, &self.port.node, name) {
            Some(json) => parameter::value(self.maker, builder, self.port.graph, json, 0),
            // Parameters that documents of older versions do not have.
            None => match DEFAULTS
                .iter()
                .find(|(kind, own, _)| *kind == self.kind && *own == name)
            {
                Some((.., number)) => Ok(Value::float(*number)),
                None => {
                    let message = format!("it has no input or parameter `{name}`");
                    Err(Refusal::new("import-input-missing", message))
                }
            },
        }
    }
}

/// What parameters hold that documents of older versions do not name.
const DEFAULTS: [(&str, &str, f64); 18] = [
    ("warp", "mode", 0.0),
    ("mirror", "flip_sides", 0.0),
    ("mirror", "offset", 0.0),
    ("circle_map", "radius", 1.0),
    ("circle_map", "repeat", 1.0),
    ("fbm", "folds", 0.0),
    ("fbm2", "folds", 0.0),
    ("voronoi", "intensity", 1.0),
    ("voronoi", "randomness", 1.0),
    ("normal_map", "param1", 1.0),
    ("noise", "density", 0.5),
    ("kaleidoscope", "offset", 0.0),
    ("tiler", "scale_x", 1.0),
    ("tiler", "scale_y", 1.0),
    ("tiler", "fixed_offset", 0.0),
    ("tiler", "value", 0.0),
    ("tiler", "overlap", 1.0),
    ("tiler", "select_inputs", 0.0),
];

impl Call for NodeCall<'_, '_> {
    fn input(
        &mut self,
        builder: &mut Builder,
        name: &str,
        at: Option<&Value>,
    ) -> Result<Value, Refusal> {
        match self.connected(builder, name, at, false) {
            Some(value) => value,
            None => self.parameter(builder, name),
        }
    }

    fn alpha(
        &mut self,
        builder: &mut Builder,
        name: &str,
        at: Option<&Value>,
    ) -> Result<Value, Refusal> {
        match self.connected(builder, name, at, true) {
            Some(value) => value,
            None => {
                let json = self
                    .maker
                    .graphs
                    .parameter(self.port.graph, &self.port.node, name);
                let alpha = json.and_then(|json| json.get("a")).and_then(Json::number);
                Ok(Value::float(alpha.unwrap_or(1.0)))
            }
        }
    }

    fn local(&self, name: &str) -> Option<&'static Expr> {
        // An input of that name comes first.
        let signature = self.signature;
        if signature.is_some_and(|known| known.inputs.iter().any(|port| port.name == name)) {
            return None;
        }
        rules().get(&format!("{}.{name}", self.kind))
    }

    fn is_given(&self, name: &str) -> bool {
        self.json(name).is_ok()
    }

    fn coordinate(&mut self, _: &mut Builder) -> Result<Value, Refusal> {
        Ok(self.uv.clone())
    }

    fn output(&self) -> (Type, &str) {
        (Type::Color3, "out")
    }

    fn tool_seed(&self) -> Option<i32> {
        let seed = (self.maker.graphs).tool_seed(self.port.graph, &self.port.node)?;
        i32::try_from(seed).ok()
    }

    fn seed(&self) -> i32 {
        self.maker.graphs.seed(self.port.graph, &self.port.node)
    }
}

impl Call for Unconnected<'_, '_, '_> {
    fn input(
        &mut self,
        builder: &mut Builder,
        name: &str,
        _: Option<&Value>,
    ) -> Result<Value, Refusal> {
        self.call.parameter(builder, name)
    }

    fn is_given(&self, name: &str) -> bool {
        self.call.is_given(name)
    }

    fn coordinate(&mut self, _: &mut Builder) -> Result<Value, Refusal> {
        Ok(self.uv.clone())
    }

    fn output(&self) -> (Type, &str) {
        (Type::Color3, "out")
    }
}
