//! What an input holds while a document is converted: a literal, or what a node or an input of the
//! graph gives.

use mipless_graph::{Binding, Type};
use serde_json::Value as Json;

/// A value written in a document.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Literal {
    /// As many numbers as the type has components; integers and truth values are numbers as well.
    Numbers(Type, [f64; 4]),
    /// A string, the name of a file, or the name of a choice.
    Text(String),
    /// The rows of a square matrix, one after the other.
    Matrix(Vec<f64>),
    /// What goes into the document as it is: the stops of a ramp.
    Json(Json),
}

/// A signal and its type.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Link {
    pub(crate) binding: Binding,
    pub(crate) ty: Type,
}

/// What an input holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Literal(Literal),
    Link(Link),
}

impl Literal {
    /// One number.
    pub(crate) const fn float(x: f64) -> Self {
        Self::Numbers(Type::Float, [x, 0.0, 0.0, 0.0])
    }

    /// Numbers of a type, the first for all where there is one only.
    pub(crate) fn of(ty: Type, numbers: &[f64]) -> Option<Self> {
        let count = ty.components();
        let mut all = [0.0; 4];
        match numbers {
            [x] => all[..count].fill(*x),
            _ if numbers.len() == count => all[..count].copy_from_slice(numbers),
            _ => return None,
        }
        Some(Self::Numbers(ty, all))
    }

    /// The type, where it is one of numbers.
    pub(crate) fn ty(&self) -> Option<Type> {
        match self {
            Self::Numbers(ty, _) => Some(*ty),
            _ => None,
        }
    }

    /// The numbers, one a component.
    pub(crate) fn numbers(&self) -> &[f64] {
        match self {
            Self::Numbers(ty, numbers) => &numbers[..ty.components()],
            Self::Matrix(numbers) => numbers,
            _ => &[],
        }
    }

    /// As another type, by the rules of MaterialX's `convert`: one number goes to every component,
    /// alpha and w that are missing are 1, what else is missing is 0.
    pub(crate) fn converted(&self, to: Type) -> Option<Self> {
        let Self::Numbers(from, numbers) = self else {
            return None;
        };
        let (have, want) = (from.components(), to.components());
        if want == 0 {
            return None;
        }
        let mut all = *numbers;
        for (i, number) in all.iter_mut().enumerate().take(want).skip(have) {
            *number = match (have, i) {
                (1, _) => numbers[0],
                (_, 3) => 1.0,
                _ => 0.0,
            };
        }
        all[want..].fill(0.0);
        if to == Type::Boolean {
            all[0] = f64::from(u8::from(all[0] != 0.0));
        }
        Some(Self::Numbers(to, all))
    }

    /// As it stands in a JSON document.
    pub(crate) fn to_json(&self) -> Json {
        match self {
            Self::Numbers(Type::Boolean, numbers) => Json::Bool(numbers[0] != 0.0),
            Self::Numbers(ty, numbers) => match ty.components() {
                1 => number(numbers[0]),
                count => numbers[..count].iter().map(|x| number(*x)).collect(),
            },
            Self::Text(text) => Json::String(text.clone()),
            Self::Matrix(numbers) => numbers.iter().map(|x| number(*x)).collect(),
            Self::Json(json) => json.clone(),
        }
    }
}

impl Value {
    /// One number.
    pub(crate) const fn float(x: f64) -> Self {
        Self::Literal(Literal::float(x))
    }

    /// The type, where it is one of numbers.
    pub(crate) fn ty(&self) -> Option<Type> {
        match self {
            Self::Literal(literal) => literal.ty(),
            Self::Link(link) => Some(link.ty),
        }
    }
}

/// A number as it is written: whole numbers without a point.
pub(crate) fn number(x: f64) -> Json {
    if x.fract() == 0.0 && x.abs() < 1e15 {
        Json::from(x as i64)
    } else {
        // What a document holds is finite: readers refuse the rest.
        serde_json::Number::from_f64(x).map_or(Json::Null, Json::Number)
    }
}
