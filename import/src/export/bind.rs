//! Names and values of a resolved graph, as documents have them.

use crate::value::{Literal, number};
use mipless_graph::{InputEntry, Literal as Resolved, Parameter, Stops, Type};
use serde_json::{Value as Json, json};

/// A name that MaterialX takes: letters, digits and underscores, no digit first.
pub(super) fn name(text: &str) -> String {
    let mut name: String = text
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit()) {
        name.insert(0, '_');
    }
    name
}

/// A number as its shortest decimals in f32, so that 0.1 stays 0.1.
fn decimal(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}

/// A literal of the graph, as the importer's rules see it.
pub(super) fn literal(value: &Resolved) -> Literal {
    match value {
        Resolved::Numbers(ty, numbers) => Literal::Numbers(*ty, numbers.map(decimal)),
        Resolved::Integer(number) => {
            Literal::Numbers(Type::Integer, [f64::from(*number), 0.0, 0.0, 0.0])
        }
        Resolved::Boolean(flag) => {
            Literal::Numbers(Type::Boolean, [f64::from(u8::from(*flag)), 0.0, 0.0, 0.0])
        }
        Resolved::Text(text) => Literal::Text(text.clone()),
        Resolved::Stops(list) => Literal::Json(stops(list)),
        Resolved::Matrix(numbers) => Literal::Matrix(numbers.iter().map(|x| decimal(*x)).collect()),
    }
}

fn stops(list: &Stops) -> Json {
    let count = list.ty.components();
    let stop = |stop: &mipless_graph::Stop| {
        let value: Json = match count {
            1 => number(decimal(stop.value[0])),
            _ => stop.value[..count]
                .iter()
                .map(|x| number(decimal(*x)))
                .collect(),
        };
        json!({ "at": number(decimal(stop.at)), "value": value })
    };
    list.stops.iter().map(stop).collect()
}

/// An input of the graph.
pub(super) fn entry(parameter: &Parameter) -> InputEntry {
    let bound = |x: Option<f32>| x.map(decimal);
    InputEntry {
        ty: parameter.ty.name().to_owned(),
        value: literal(&parameter.value).to_json(),
        min: bound(parameter.min),
        max: bound(parameter.max),
        soft_min: bound(parameter.soft_min),
        soft_max: bound(parameter.soft_max),
        doc: (!parameter.doc.is_empty()).then(|| parameter.doc.clone()),
        extra: None,
    }
}

/// Numbers as MaterialX writes them, of a type of so many components.
pub(super) fn value(literal: &Resolved, ty: &str) -> Option<String> {
    let numbers = match literal {
        Resolved::Text(text) => return Some(text.clone()),
        Resolved::Matrix(numbers) => {
            let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
            return Some(numbers.join(", "));
        }
        Resolved::Stops(_) => return None,
        other => other.numbers(),
    };
    let first = *numbers.first()?;
    match ty {
        "boolean" => return Some((first != 0.0).to_string()),
        "integer" => {
            return match literal {
                Resolved::Integer(number) => Some(number.to_string()),
                _ if first.fract() == 0.0 => Some((first as i64).to_string()),
                _ => None,
            };
        }
        _ => {}
    }
    let count = Type::by_name(ty)?.components();
    let mut written: Vec<String> = numbers
        .iter()
        .take(count)
        .map(ToString::to_string)
        .collect();
    while written.len() < count {
        // One number goes to every component; the alpha that a colour lacks is 1.
        written.push(match numbers.len() {
            1 => first.to_string(),
            _ if written.len() == 3 => "1".to_owned(),
            _ => "0".to_owned(),
        });
    }
    Some(written.join(", "))
}
