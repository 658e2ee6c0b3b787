//! Literals: JSON values of the type that a port wants.

use serde_json::Value;

use crate::diagnostic::did_you_mean;
use crate::{Default, Diagnostic, Literal, PortSpec, PortType, Stop, Stops, Type};

/// What is wrong with a literal, before its place is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mistake {
    pub(super) code: &'static str,
    pub(super) message: String,
    pub(super) help: Option<String>,
}

impl Mistake {
    fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            help: None,
        }
    }

    fn help(self, help: impl Into<String>) -> Self {
        Self {
            help: Some(help.into()),
            ..self
        }
    }

    /// The diagnostic at that place.
    pub(super) fn into_diagnostic(self, place: Diagnostic) -> Diagnostic {
        Diagnostic {
            code: self.code,
            message: self.message,
            ..place
        }
        .help_if(self.help)
    }
}

/// What a value is, for messages.
fn shown(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(value) => format!("`{value}`"),
        Value::Number(number) => format!("the number {number}"),
        Value::String(text) => format!("the text \"{text}\""),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "an object".to_owned(),
    }
}

/// What a port wants, for messages.
fn wanted(ty: Type) -> &'static str {
    match ty {
        Type::Float => "a number",
        Type::Integer => "a whole number",
        Type::Boolean => "`true` or `false`",
        Type::Vector2 => "two numbers, or one for both",
        Type::Vector3 => "three numbers, or one for all",
        Type::Vector4 => "four numbers, or one for all",
        Type::Color3 => "a colour: `\"#rrggbb\"`, three numbers, or one for all",
        Type::Color4 => "a colour: `\"#rrggbbaa\"`, four or three numbers, or one for all",
        Type::String => "a text",
        Type::Filename => "the name of a file",
    }
}

/// A number as f32.
fn finite(value: &Value) -> Result<f32, Mistake> {
    let Some(number) = value.as_f64() else {
        return Err(Mistake::new(
            "type-mismatch",
            format!("{} is no number", shown(value)),
        ));
    };
    // Narrowing to the semantics of the graph is the point.
    let narrow = number as f32;
    if narrow.is_finite() {
        Ok(narrow)
    } else {
        let message = format!("{number:e} is not finite as a 32-bit float");
        Err(Mistake::new("number-not-finite", message).help("the largest is 3.4028235e38"))
    }
}

/// Numbers as a value of a type: one number broadcasts, three become a colour with an alpha of 1.
/// `None` if they are not as many as the type takes, or it takes none.
pub(crate) fn from_numbers(numbers: &[f32], ty: Type) -> Option<Literal> {
    let mut all = [0.0; 4];
    match (ty, numbers) {
        (Type::String | Type::Filename | Type::Integer | Type::Boolean, _) => return None,
        (_, [x]) => all[..ty.components()].fill(*x),
        (Type::Color4, [r, g, b]) => all = [*r, *g, *b, 1.0],
        _ if numbers.len() == ty.components() => all[..numbers.len()].copy_from_slice(numbers),
        _ => return None,
    }
    Some(Literal::Numbers(ty, all))
}

/// `#rrggbb` or `#rrggbbaa`: sRGB, made linear; alpha is linear already.
pub(crate) fn color(text: &str) -> Option<Literal> {
    let digits = text.strip_prefix('#')?;
    let ty = match digits.len() {
        6 => Type::Color3,
        8 => Type::Color4,
        _ => return None,
    };
    if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let mut channels = [0.0; 4];
    for (i, channel) in channels.iter_mut().take(ty.components()).enumerate() {
        let byte = u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok()?;
        let encoded = f64::from(byte) / 255.0;
        let value = if i == 3 {
            encoded
        } else {
            linear_from_srgb(encoded)
        };
        *channel = value as f32;
    }
    Some(Literal::Numbers(ty, channels))
}

/// The transfer function of IEC 61966-2-1 (sRGB), §5.2, inverted.
pub fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// The type that a literal has by itself: one number is a float, two a vector, three and four a
/// colour unless `beside` (what else the node is connected to) is a vector. `None` for what is no
/// value of a signal, which [`literal`] reports.
pub(super) fn natural(value: &Value, beside: Type) -> Option<Type> {
    let vectors = matches!(beside, Type::Vector2 | Type::Vector3 | Type::Vector4);
    match value {
        Value::Number(_) | Value::Bool(_) => Some(Type::Float),
        Value::Array(items) => match items.len() {
            1 => Some(Type::Float),
            2 => Some(Type::Vector2),
            3 => Some(if vectors { Type::Vector3 } else { Type::Color3 }),
            4 => Some(if vectors { Type::Vector4 } else { Type::Color4 }),
            _ => None,
        },
        Value::String(text) => match color(text)? {
            Literal::Numbers(ty, _) => Some(ty),
            _ => None,
        },
        _ => None,
    }
}

/// A value of a type.
pub(super) fn literal(value: &Value, ty: Type) -> Result<Literal, Mistake> {
    let mismatch = || {
        let message = format!("`{ty}` wants {}, not {}", wanted(ty), shown(value));
        Mistake::new("type-mismatch", message)
    };
    match (ty, value) {
        (Type::Boolean, Value::Bool(value)) => Ok(Literal::Boolean(*value)),
        (Type::Integer, Value::Number(number)) => {
            let whole = number.as_i64().or_else(|| {
                // 5.0 is whole as well.
                let number = number.as_f64()?;
                (number.fract() == 0.0 && number.abs() <= f64::from(i32::MAX))
                    .then_some(number as i64)
            });
            let whole = whole.and_then(|whole| i32::try_from(whole).ok());
            whole.map(Literal::Integer).ok_or_else(mismatch)
        }
        (Type::String | Type::Filename, Value::String(text)) => Ok(Literal::Text(text.clone())),
        (Type::String | Type::Filename | Type::Boolean | Type::Integer, _) => Err(mismatch()),
        // A truth value where signals are: 1 or 0.
        (Type::Float, Value::Bool(value)) => Ok(Literal::float(f32::from(u8::from(*value)))),
        (_, Value::Number(_)) => from_numbers(&[finite(value)?], ty).ok_or_else(mismatch),
        (_, Value::Array(items)) => {
            if items.len() > 4 {
                return Err(mismatch());
            }
            let mut numbers = [0.0; 4];
            for (number, item) in numbers.iter_mut().zip(items) {
                *number = finite(item)?;
            }
            from_numbers(&numbers[..items.len()], ty).ok_or_else(mismatch)
        }
        (Type::Color3 | Type::Color4, Value::String(text)) => match color(text) {
            Some(Literal::Numbers(from, channels)) if from.converts_to(ty) => {
                from_numbers(&channels[..from.components()], ty).ok_or_else(mismatch)
            }
            Some(_) => Err(mismatch().help("leave the alpha away")),
            None => {
                let message = format!("\"{text}\" is no colour");
                let help = "write `\"#rrggbb\"` or `\"#rrggbbaa\"`, or linear numbers";
                Err(Mistake::new("bad-color", message).help(help))
            }
        },
        _ => Err(mismatch()),
    }
}

/// The name of one of a port's choices.
pub(super) fn choice(value: &Value, names: &[&'static str]) -> Result<Literal, Mistake> {
    let listed = || format!("one of `{}`", names.join("`, `"));
    // MaterialX counts some of its names.
    let counted = value.as_u64().and_then(|index| names.get(index as usize));
    if let Some(name) = counted {
        return Ok(Literal::Text((*name).to_owned()));
    }
    let Value::String(text) = value else {
        let message = format!("a name is wanted here, not {}", shown(value));
        return Err(Mistake::new("type-mismatch", message).help(listed()));
    };
    if names.contains(&text.as_str()) {
        return Ok(Literal::Text(text.clone()));
    }
    let help = did_you_mean(text, names.iter().copied()).unwrap_or_else(listed);
    Err(Mistake::new("unknown-choice", format!("there is no `{text}` to choose")).help(help))
}

/// The stops of a ramp, sorted; those at the same place keep their order.
pub(super) fn stops(value: &Value) -> Result<Literal, Mistake> {
    let bad = |message: String| {
        let help =
            "write `[ { \"at\": 0, \"value\": 0.2 }, { \"at\": 1, \"value\": \"#ffffff\" } ]`";
        Mistake::new("bad-stops", message).help(help)
    };
    let Value::Array(items) = value else {
        return Err(bad(format!(
            "a list of stops is wanted here, not {}",
            shown(value)
        )));
    };
    if items.is_empty() {
        return Err(bad("a ramp has at least one stop".to_owned()));
    }
    let mut read = Vec::with_capacity(items.len());
    let mut ty = Type::Float;
    for (index, item) in items.iter().enumerate() {
        let Value::Object(members) = item else {
            return Err(bad(format!(
                "stop {index} is {}, not an object",
                shown(item)
            )));
        };
        let unknown = members.keys().find(|key| *key != "at" && *key != "value");
        if let Some(key) = unknown {
            return Err(bad(format!("stop {index} has the unknown key `{key}`")));
        }
        let (Some(at), Some(value)) = (members.get("at"), members.get("value")) else {
            return Err(bad(format!("stop {index} lacks `at` or `value`")));
        };
        let at = finite(at)?;
        let own = natural(value, Type::Color3).and_then(|own| own.widest(ty));
        let Some(own) = own.filter(|own| matches!(own, Type::Float | Type::Color3 | Type::Color4))
        else {
            return Err(bad(format!(
                "the value of stop {index} is {}",
                shown(value)
            )));
        };
        ty = own;
        read.push((at, value));
    }
    read.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut stops = Vec::with_capacity(read.len());
    for (at, value) in read {
        let Literal::Numbers(_, value) = literal(value, ty)? else {
            return Err(bad(format!("{} is no value of a stop", shown(value))));
        };
        stops.push(Stop { at, value });
    }
    Ok(Literal::Stops(Stops { ty, stops }))
}

/// A square matrix.
pub(super) fn matrix(value: &Value) -> Result<Literal, Mistake> {
    let items = value.as_array().map_or(&[][..], Vec::as_slice);
    if !matches!(items.len(), 9 | 16) {
        let message = format!("a matrix is wanted here, not {}", shown(value));
        return Err(Mistake::new("type-mismatch", message).help("write a list of 9 or 16 numbers"));
    }
    let numbers: Result<Vec<f32>, Mistake> = items.iter().map(finite).collect();
    Ok(Literal::Matrix(numbers?))
}

/// What an unconnected port holds, as a value of `ty`; `None` for the surface's coordinates.
///
/// # Panics
/// If the default is no value of the port's type: a bug of the spec.
pub(super) fn default(port: &PortSpec, ty: Type) -> Option<Literal> {
    let numbers = |numbers: &[f32]| {
        from_numbers(numbers, ty)
            .unwrap_or_else(|| panic!("the default of `{}` is no `{ty}`", port.name))
    };
    Some(match port.default {
        Default::Surface => return None,
        Default::Identity => {
            Literal::Matrix((0..9).map(|i| if i % 4 == 0 { 1.0 } else { 0.0 }).collect())
        }
        Default::Float(x) if ty == Type::Integer => Literal::Integer(x as i32),
        Default::Float(x) => numbers(&[x]),
        Default::Integer(i) if ty == Type::Integer => Literal::Integer(i),
        Default::Integer(i) => numbers(&[i as f32]),
        Default::Boolean(flag) => Literal::Boolean(flag),
        Default::Vector2(xy) => numbers(&xy),
        Default::Color3(rgb) => numbers(&rgb),
        Default::Choice(text) | Default::Text(text) => Literal::Text(text.to_owned()),
        Default::Stops(stops) => {
            let stops = stops.iter().map(|(at, x)| Stop {
                at: *at,
                value: [*x, 0.0, 0.0, 0.0],
            });
            Literal::Stops(Stops {
                ty: Type::Float,
                stops: stops.collect(),
            })
        }
    })
}

/// The type that the default of a port of any type has by itself.
pub(super) fn default_type(port: &PortSpec) -> Type {
    debug_assert!(
        !matches!(
            port.ty,
            PortType::Exactly(_) | PortType::Choice(_) | PortType::Stops
        ),
        "{} has a type",
        port.name
    );
    match port.default {
        Default::Vector2(_) | Default::Surface => Type::Vector2,
        Default::Color3(_) => Type::Color3,
        _ => Type::Float,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_take_the_type_that_is_wanted() {
        let rgb = |ty, value| literal(&value, ty);
        assert_eq!(
            rgb(Type::Color4, json!([0.25, 0.5, 1])),
            Ok(Literal::Numbers(Type::Color4, [0.25, 0.5, 1.0, 1.0]))
        );
        assert_eq!(
            rgb(Type::Vector3, json!(2)),
            Ok(Literal::Numbers(Type::Vector3, [2.0, 2.0, 2.0, 0.0]))
        );
        assert_eq!(rgb(Type::Integer, json!(5.0)), Ok(Literal::Integer(5)));
        assert_eq!(
            rgb(Type::Integer, json!(5.5)).unwrap_err().code,
            "type-mismatch"
        );
        assert_eq!(
            rgb(Type::Float, json!([1, 2])).unwrap_err().code,
            "type-mismatch"
        );
        assert_eq!(
            rgb(Type::Float, json!(1e300)).unwrap_err().code,
            "number-not-finite"
        );
        assert_eq!(
            rgb(Type::Color3, json!("#12345")).unwrap_err().code,
            "bad-color"
        );
        assert_eq!(
            rgb(Type::Color3, json!("#éaaaa")).unwrap_err().code,
            "bad-color"
        );
    }

    #[test]
    fn names_are_counted_and_truth_values_are_numbers() {
        let names = ["linear", "smooth", "step"];
        assert_eq!(
            choice(&json!(2), &names),
            Ok(Literal::Text("step".to_owned()))
        );
        assert_eq!(choice(&json!(3), &names).unwrap_err().code, "type-mismatch");
        assert_eq!(literal(&json!(true), Type::Float), Ok(Literal::float(1.0)));
        assert_eq!(matrix(&json!([1, 2])).unwrap_err().code, "type-mismatch");
    }

    #[test]
    fn hexadecimal_colours_are_srgb() {
        let Some(Literal::Numbers(ty, [r, g, b, a])) = color("#ff808080") else {
            panic!("a colour")
        };
        assert_eq!((ty, r), (Type::Color4, 1.0));
        // 128/255 in sRGB is 0.2158605 linear.
        assert!((g - 0.215_860_5).abs() < 1e-6 && g == b);
        assert!((a - 128.0 / 255.0).abs() < 1e-7);
    }

    #[test]
    fn stops_are_sorted_stably_and_widened() {
        let value = json!([
            { "at": 1, "value": 0.5 }, { "at": 0, "value": "#ffffff" }, { "at": 1, "value": 0.25 }
        ]);
        let Ok(Literal::Stops(stops)) = stops(&value) else {
            panic!("stops")
        };
        assert_eq!(stops.ty, Type::Color3);
        let places: Vec<(f32, f32)> = stops.stops.iter().map(|s| (s.at, s.value[2])).collect();
        assert_eq!(places, [(0.0, 1.0), (1.0, 0.5), (1.0, 0.25)]);
        assert_eq!(super::stops(&json!([])).unwrap_err().code, "bad-stops");
        assert_eq!(
            super::stops(&json!([{ "at": 0, "value": [1, 2] }]))
                .unwrap_err()
                .code,
            "bad-stops"
        );
    }
}
