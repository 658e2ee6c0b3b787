//! A ramp as a sum over what it does between its stops.

use super::{Evaluation, wrong_rule};
use crate::build::Refusal;
use crate::value::{Literal, Value};
use mipless_graph::Type;
use serde_json::Value as Json;

/// A stop: its place and its value.
type Stop = (f64, Literal);

impl Evaluation<'_> {
    /// The stops that the port `stops` holds, at a place: the first value, and for each pair of
    /// neighbours their difference by how far the place is between them.
    pub(super) fn ramp(&mut self, place: &Value) -> Result<Value, Refusal> {
        let stops = match self.call.input(self.builder, "stops", None)? {
            Value::Literal(Literal::Json(Json::Array(stops))) => stops,
            _ => return Err(wrong_rule("`ramp` wants stops")),
        };
        let kind = match self.call.input(self.builder, "interpolation", None)? {
            Value::Literal(Literal::Text(kind)) => kind,
            _ => return Err(wrong_rule("`ramp` wants an interpolation")),
        };
        let stops: Option<Vec<Stop>> = stops.iter().map(stop).collect();
        let stops = stops.ok_or_else(|| wrong_rule("a stop has a place and a value"))?;
        let Some((_, first)) = stops.first() else {
            return Err(wrong_rule("a ramp has stops"));
        };
        let ty = self.call.output().0;
        let widened = |value: &Literal| {
            let value = value.converted(ty);
            value.ok_or_else(|| wrong_rule("a stop is as wide as the ramp"))
        };
        let mut sum = Value::Literal(widened(first)?);
        for pair in stops.windows(2) {
            let [(low, from), (high, to)] = pair else {
                continue;
            };
            let step = self.binary(
                '-',
                Value::Literal(widened(to)?),
                Value::Literal(widened(from)?),
            )?;
            let number = |x: f64| Value::float(x);
            let share = match kind.as_str() {
                _ if low == high => self.passed(place, *high)?,
                "constant" => self.passed(place, *high)?,
                "linear" => {
                    let along = self.binary('-', place.clone(), number(*low))?;
                    let along = self.binary('*', along, number(1.0 / (high - low)))?;
                    self.builder
                        .node("clamp", vec![("in".to_owned(), along)], "out")?
                }
                "smooth" => {
                    let inputs = vec![
                        ("in".to_owned(), place.clone()),
                        ("low".to_owned(), number(*low)),
                        ("high".to_owned(), number(*high)),
                    ];
                    self.builder.node("smoothstep", inputs, "out")?
                }
                other => {
                    let message = format!("a ramp whose interpolation is `{other}`");
                    return Err(Refusal::new("export-port", message));
                }
            };
            let term = self.binary('*', step, share)?;
            sum = self.binary('+', sum, term)?;
        }
        Ok(sum)
    }

    /// 1 from a place on, 0 before.
    fn passed(&mut self, place: &Value, edge: f64) -> Result<Value, Refusal> {
        let inputs = vec![
            ("value1".to_owned(), place.clone()),
            ("value2".to_owned(), Value::float(edge)),
            ("in1".to_owned(), Value::float(1.0)),
            ("in2".to_owned(), Value::float(0.0)),
        ];
        self.builder.node("ifgreatereq", inputs, "out")
    }
}

fn stop(json: &Json) -> Option<Stop> {
    let value = json.get("value")?;
    let literal = match value.as_array() {
        None => Literal::float(value.as_f64()?),
        Some(numbers) => {
            let numbers: Option<Vec<f64>> = numbers.iter().map(Json::as_f64).collect();
            let numbers = numbers?;
            let ty = if numbers.len() == 4 {
                Type::Color4
            } else {
                Type::Color3
            };
            Literal::of(ty, &numbers)?
        }
    };
    Some((json.get("at")?.as_f64()?, literal))
}
