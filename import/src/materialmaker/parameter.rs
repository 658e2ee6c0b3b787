//! Parameters: numbers, choices, colours, gradients, and expressions of them.

use super::{Maker, input};
use crate::build::{Builder, Refusal};
use crate::json::{Content, Json};
use crate::value::{Literal, Value, number};
use mipless_graph::Type;
use serde_json::{Value as Plain, json};

/// How deep an expression may nest parentheses and names.
const DEEPEST: usize = 16;

/// What a parameter holds.
pub(super) fn value(
    maker: &Maker<'_>,
    builder: &mut Builder,
    graph: usize,
    json: &Json,
    depth: usize,
) -> Result<Value, Refusal> {
    match &json.value {
        Content::Number(number) if (*number as f32).is_finite() => Ok(Value::float(*number)),
        Content::Bool(flag) => Ok(Value::float(f64::from(u8::from(*flag)))),
        Content::Text(text) => {
            let mut expression = Expression {
                maker,
                graph,
                rest: text.trim(),
                depth,
            };
            let value = expression.sum(builder)?;
            if expression.rest.is_empty() {
                Ok(value)
            } else {
                Err(beyond(text))
            }
        }
        Content::Object(_) if json.get("type").and_then(Json::text) == Some("Color") => {
            let channel = |key| json.get(key).and_then(Json::number).unwrap_or(0.0);
            let color = [channel("r"), channel("g"), channel("b"), 0.0];
            Ok(Value::Literal(Literal::Numbers(Type::Color3, color)))
        }
        _ => Err(Refusal::new(
            "import-value",
            "a parameter is neither a number nor a colour",
        )),
    }
}

fn beyond(text: &str) -> Refusal {
    let shown: String = text.chars().take(40).collect();
    Refusal::new(
        "import-value",
        format!("`{shown}` is more than the arithmetic of numbers that is read"),
    )
}

/// A gradient: its stops, and those of its alpha.
pub(super) fn stops(json: &Json, alpha: bool) -> Result<Plain, Refusal> {
    let points = json.get("points").map_or(&[][..], Json::items);
    let mut stops = Vec::with_capacity(points.len());
    for point in points {
        let channel = |key| {
            let value = point.get(key).and_then(Json::number);
            value.filter(|x| (*x as f32).is_finite())
        };
        let place = channel("pos").unwrap_or(0.0);
        let color = ["r", "g", "b"].map(|key| channel(key).unwrap_or(0.0));
        let value = if alpha {
            number(channel("a").unwrap_or(1.0))
        } else {
            color.iter().map(|x| number(*x)).collect()
        };
        stops.push((place, value));
    }
    if stops.is_empty() {
        return Err(Refusal::new("import-value", "a gradient has no stops"));
    }
    stops.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let stops = stops
        .into_iter()
        .map(|(at, value)| json!({ "at": number(at), "value": value }));
    Ok(stops.collect())
}

/// Whether a gradient is opaque everywhere.
pub(super) fn is_opaque(json: &Json) -> bool {
    let points = json.get("points").map_or(&[][..], Json::items);
    points.iter().all(|point| {
        point
            .get("a")
            .and_then(Json::number)
            .is_none_or(|a| a >= 1.0)
    })
}

/// An expression of numbers, `$time`, and parameters of the graph.
struct Expression<'m, 'a, 't> {
    maker: &'m Maker<'a>,
    graph: usize,
    rest: &'t str,
    depth: usize,
}

impl Expression<'_, '_, '_> {
    fn take(&mut self, wanted: char) -> bool {
        match self.rest.strip_prefix(wanted) {
            Some(rest) => {
                self.rest = rest.trim_start();
                true
            }
            None => false,
        }
    }

    fn sum(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        let mut left = self.product(builder)?;
        loop {
            let name = if self.take('+') {
                "add"
            } else if self.take('-') {
                "subtract"
            } else {
                return Ok(left);
            };
            let right = self.product(builder)?;
            left = combine(builder, name, left, right)?;
        }
    }

    fn product(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        let mut left = self.factor(builder)?;
        loop {
            let name = if self.take('*') {
                "multiply"
            } else if self.take('/') {
                "divide"
            } else {
                return Ok(left);
            };
            let right = self.factor(builder)?;
            left = combine(builder, name, left, right)?;
        }
    }

    fn factor(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(beyond(self.rest));
        }
        let value = self.atom(builder);
        self.depth -= 1;
        value
    }

    fn atom(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        if self.take('-') {
            let value = self.factor(builder)?;
            return combine(builder, "multiply", Value::float(-1.0), value);
        }
        if self.take('(') {
            let value = self.sum(builder)?;
            return if self.take(')') {
                Ok(value)
            } else {
                Err(beyond(self.rest))
            };
        }
        if self.take('$') {
            let end = self
                .rest
                .find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let (name, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
            self.rest = rest.trim_start();
            if name == "time" {
                builder
                    .notes
                    .push("time is an input of the graph, in seconds".to_owned());
                return Ok(input(builder, "time"));
            }
            let Some(json) = self.maker.graphs.named(self.graph, name) else {
                return Err(beyond(name));
            };
            return value(self.maker, builder, self.graph, json, self.depth);
        }
        let end = self.rest.find(|c: char| !c.is_ascii_digit() && c != '.');
        let (digits, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        match digits.parse::<f64>() {
            Ok(number) if (number as f32).is_finite() => {
                self.rest = rest.trim_start();
                Ok(Value::float(number))
            }
            _ => Err(beyond(self.rest)),
        }
    }
}

/// Two numbers, worked out if both are literals.
fn combine(builder: &mut Builder, name: &str, left: Value, right: Value) -> Result<Value, Refusal> {
    if let (Value::Literal(a), Value::Literal(b)) = (&left, &right)
        && let ([a], [b]) = (a.numbers(), b.numbers())
    {
        let result = match name {
            "add" => a + b,
            "subtract" => a - b,
            "multiply" => a * b,
            _ => a / b,
        };
        if (result as f32).is_finite() {
            return Ok(Value::float(result));
        }
    }
    let inputs = vec![("in1".to_owned(), left), ("in2".to_owned(), right)];
    builder.node(name, inputs, "out")
}
