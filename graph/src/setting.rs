//! Values of a graph's inputs written as text: `0.5`, `0.1,0.2,0.3`, `#rrggbb`, `true`.

use std::error::Error;
use std::fmt;

use crate::resolve::{color, from_numbers, outside, shown_bounds};
use crate::{Literal, Parameter, Type};

/// Why a text is no value.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingError {
    /// It is no value of the type.
    NotOfType {
        /// What was written.
        text: String,
        /// The type that is wanted.
        ty: Type,
    },
    /// It is outside the bounds of the input.
    OutOfRange {
        /// The first component that is.
        number: f32,
        /// The smallest value.
        min: Option<f32>,
        /// The largest value.
        max: Option<f32>,
    },
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotOfType { text, ty } => {
                let form = match ty {
                    Type::Float => "a number",
                    Type::Integer => "a whole number",
                    Type::Boolean => "`true` or `false`",
                    Type::Color3 => "`#rrggbb`, or `R,G,B` in linear numbers",
                    Type::Color4 => "`#rrggbbaa`, or `R,G,B,A` in linear numbers",
                    Type::Vector2 => "`X,Y`",
                    Type::Vector3 => "`X,Y,Z`",
                    Type::Vector4 => "`X,Y,Z,W`",
                    Type::String | Type::Filename => "a text",
                };
                write!(f, "`{text}` is no `{ty}`: write {form}")
            }
            Self::OutOfRange { number, min, max } => {
                write!(
                    f,
                    "{number} is out of range: {} is wanted",
                    shown_bounds(*min, *max)
                )
            }
        }
    }
}

impl Error for SettingError {}

/// Reads a value of a type; one number broadcasts over a vector or a colour.
///
/// # Errors
/// [`SettingError::NotOfType`].
pub fn parse_setting(ty: Type, text: &str) -> Result<Literal, SettingError> {
    let trimmed = text.trim();
    let value = match ty {
        Type::Boolean => trimmed.parse().ok().map(Literal::Boolean),
        Type::Integer => trimmed.parse().ok().map(Literal::Integer),
        Type::String | Type::Filename => Some(Literal::Text(text.to_owned())),
        Type::Color3 | Type::Color4 if trimmed.starts_with('#') => match color(trimmed) {
            Some(Literal::Numbers(from, channels)) if from.converts_to(ty) => {
                from_numbers(&channels[..from.components()], ty)
            }
            _ => None,
        },
        _ => {
            let numbers = trimmed.split(',').map(|number| {
                number
                    .trim()
                    .parse::<f32>()
                    .ok()
                    .filter(|number| number.is_finite())
            });
            let numbers: Option<Vec<f32>> = numbers.collect();
            numbers.and_then(|numbers| from_numbers(&numbers, ty))
        }
    };
    value.ok_or_else(|| SettingError::NotOfType {
        text: text.to_owned(),
        ty,
    })
}

impl Parameter {
    /// Reads a value for this input and checks it against the input's bounds.
    ///
    /// # Errors
    /// [`SettingError`].
    pub fn parse(&self, text: &str) -> Result<Literal, SettingError> {
        let value = parse_setting(self.ty, text)?;
        match outside(&value.numbers(), self.min, self.max) {
            Some(number) => Err(SettingError::OutOfRange {
                number,
                min: self.min,
                max: self.max,
            }),
            None => Ok(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_as_the_input_wants() {
        assert_eq!(parse_setting(Type::Float, "0.5"), Ok(Literal::float(0.5)));
        assert_eq!(
            parse_setting(Type::Color3, "0.1, 0.2,0.3"),
            Ok(Literal::Numbers(Type::Color3, [0.1, 0.2, 0.3, 0.0]))
        );
        assert_eq!(
            parse_setting(Type::Color4, "#ffffff"),
            Ok(Literal::Numbers(Type::Color4, [1.0; 4]))
        );
        assert_eq!(
            parse_setting(Type::Boolean, "true"),
            Ok(Literal::Boolean(true))
        );
        for (ty, text) in [
            (Type::Float, "nan"),
            (Type::Float, "1e39"),
            (Type::Float, ""),
            (Type::Vector2, "1,2,3"),
            (Type::Color3, "#12"),
            (Type::Integer, "1.5"),
        ] {
            assert!(parse_setting(ty, text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_bounds_of_the_input_hold() {
        let input = Parameter {
            name: "scale".to_owned(),
            ty: Type::Float,
            value: Literal::float(1.0),
            min: Some(0.5),
            max: None,
            soft_min: None,
            soft_max: None,
            doc: String::new(),
        };
        assert_eq!(input.parse("2"), Ok(Literal::float(2.0)));
        let error = input.parse("0.25").expect_err("too small");
        assert_eq!(
            error.to_string(),
            "0.25 is out of range: at least 0.5 is wanted"
        );
    }
}
