//! The types of a graph and the literals that a document holds: MaterialX's names and promotions.

use std::fmt;

/// The type of a port, an input or an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Type {
    /// A real number.
    Float,
    /// An integer.
    Integer,
    /// A truth value.
    Boolean,
    /// Two numbers.
    Vector2,
    /// Three numbers.
    Vector3,
    /// Four numbers.
    Vector4,
    /// A linear Rec. 709 colour.
    Color3,
    /// A linear Rec. 709 colour and alpha.
    Color4,
    /// Text.
    String,
    /// The name of a file.
    Filename,
}

impl Type {
    /// Every type.
    pub const ALL: [Self; 10] = [
        Self::Float,
        Self::Integer,
        Self::Boolean,
        Self::Vector2,
        Self::Vector3,
        Self::Vector4,
        Self::Color3,
        Self::Color4,
        Self::String,
        Self::Filename,
    ];

    /// MaterialX's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Float => "float",
            Self::Integer => "integer",
            Self::Boolean => "boolean",
            Self::Vector2 => "vector2",
            Self::Vector3 => "vector3",
            Self::Vector4 => "vector4",
            Self::Color3 => "color3",
            Self::Color4 => "color4",
            Self::String => "string",
            Self::Filename => "filename",
        }
    }

    /// The type of that name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|ty| ty.name() == name)
    }

    /// How many numbers a value holds; 0 for text.
    pub const fn components(self) -> usize {
        match self {
            Self::Float | Self::Integer | Self::Boolean => 1,
            Self::Vector2 => 2,
            Self::Vector3 | Self::Color3 => 3,
            Self::Vector4 | Self::Color4 => 4,
            Self::String | Self::Filename => 0,
        }
    }

    /// The type that two meeting types are promoted to: floats (integers and truth values are floats) broadcast,
    /// `color3` with `color4` gives `color4`; colours and vectors do not mix.
    pub fn widest(self, other: Self) -> Option<Self> {
        use Type::{Boolean, Color3, Color4, Float, Integer};
        match (self, other) {
            (a, b) if a == b => Some(a),
            (Float | Integer | Boolean, Float | Integer | Boolean) => Some(Float),
            (Float | Integer | Boolean, wide) | (wide, Float | Integer | Boolean)
                if wide.components() > 1 =>
            {
                Some(wide)
            }
            (Color3, Color4) | (Color4, Color3) => Some(Color4),
            _ => None,
        }
    }

    /// Whether a value of this type may stand where `wanted` is expected (see [`Type::widest`]).
    pub fn converts_to(self, wanted: Self) -> bool {
        self.widest(wanted) == Some(wanted)
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One stop of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Where, in the units of the ramp's input.
    pub at: f32,
    /// One number, or the channels of a colour (the rest is 0).
    pub value: [f32; 4],
}

/// The stops of a ramp, sorted by `at`; stops at the same place make a jump.
#[derive(Clone, Debug, PartialEq)]
pub struct Stops {
    /// `Float`, `Color3` or `Color4`: the widest of the values.
    pub ty: Type,
    /// At least one.
    pub stops: Vec<Stop>,
}

impl Stops {
    /// The places with the means of the values' components.
    pub fn means(&self) -> Vec<[f32; 2]> {
        let count = self.ty.components();
        (self.stops.iter())
            .map(|stop| {
                let sum: f32 = stop.value[..count].iter().sum();
                [stop.at, sum / count as f32]
            })
            .collect()
    }
}

/// A value written in a document, already of the type that its port wants.
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    /// Numbers: as many of the array as the type has components; integers and truth values (0 or 1)
    /// fit f32 exactly only up to 2²⁴, so they have variants of their own.
    Numbers(Type, [f32; 4]),
    /// An integer.
    Integer(i32),
    /// A truth value.
    Boolean(bool),
    /// Text: a string, a file name, or the chosen name of an enumeration.
    Text(String),
    /// The stops of a ramp.
    Stops(Stops),
    /// A square matrix of 9 or 16 numbers, as MaterialX writes it.
    Matrix(Vec<f32>),
}

impl Literal {
    /// A real number.
    pub const fn float(x: f32) -> Self {
        Self::Numbers(Type::Float, [x, 0.0, 0.0, 0.0])
    }

    /// The type of the value: [`Type::String`] for stops and matrices too.
    pub const fn ty(&self) -> Type {
        match self {
            Self::Numbers(ty, _) => *ty,
            Self::Integer(_) => Type::Integer,
            Self::Boolean(_) => Type::Boolean,
            Self::Text(_) | Self::Stops(_) | Self::Matrix(_) => Type::String,
        }
    }

    /// The numbers of the value, one a component; empty for text, stops and matrices.
    pub fn numbers(&self) -> Vec<f32> {
        match self {
            Self::Numbers(ty, numbers) => numbers[..ty.components()].to_vec(),
            Self::Integer(i) => vec![*i as f32],
            Self::Boolean(b) => vec![f32::from(u8::from(*b))],
            Self::Text(_) | Self::Stops(_) | Self::Matrix(_) => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Type::{Boolean, Color3, Color4, Float, Vector2, Vector3};

    #[test]
    fn promotions_are_those_of_materialx() {
        assert_eq!(Float.widest(Color3), Some(Color3));
        assert_eq!(Boolean.widest(Float), Some(Float));
        assert_eq!(Color4.widest(Color3), Some(Color4));
        assert_eq!(Color3.widest(Vector3), None);
        assert_eq!(Vector2.widest(Vector3), None);
        assert!(Color3.converts_to(Color4) && !Color4.converts_to(Color3));
        assert!(Float.converts_to(Vector2) && !Vector2.converts_to(Float));
    }
}
