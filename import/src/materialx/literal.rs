//! Values as documents write them: numbers in a text, with their colour space and their unit.

use crate::build::Refusal;
use crate::value::Literal;
use mipless_graph::Type;

/// A colour space: the power that makes its numbers linear, and the matrix to linear Rec. 709.
struct Space {
    name: &'static str,
    transfer: Transfer,
    /// Row by row.
    matrix: Option<[[f64; 3]; 3]>,
}

enum Transfer {
    Linear,
    Power(f64),
    /// IEC 61966-2-1.
    Srgb,
}

/// ACES' AP1 with its white at D60, to Rec. 709 (Bradford).
const AP1: [[f64; 3]; 3] = [
    [1.705_050_992_658, -0.621_792_120_657, -0.083_258_872_001],
    [-0.130_256_417_507, 1.140_804_736_575, -0.010_548_319_068],
    [-0.024_003_356_805, -0.128_968_976_065, 1.152_972_332_87],
];

/// Adobe RGB (1998).
const ADOBE: [[f64; 3]; 3] = [
    [1.398_355_74, -0.398_355_744, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -0.042_928_989_3, 1.042_928_99],
];

/// Display P3.
const P3: [[f64; 3]; 3] = [
    [1.224_930_29, -0.224_929_68, 0.000_000_06],
    [-0.042_058_68, 1.042_058_94, -0.000_000_01],
    [-0.019_641_28, -0.078_647_94, 1.098_289_25],
];

/// The colour spaces of MaterialX's default colour management.
const SPACES: [Space; 18] = {
    use Transfer::{Linear, Power, Srgb};
    const fn space(name: &'static str, transfer: Transfer, matrix: Option<[[f64; 3]; 3]>) -> Space {
        Space {
            name,
            transfer,
            matrix,
        }
    }
    [
        space("lin_rec709", Linear, None),
        space("lin_srgb", Linear, None),
        space("none", Linear, None),
        space("raw", Linear, None),
        space("srgb_texture", Srgb, None),
        space("g18_rec709", Power(1.8), None),
        space("g22_rec709", Power(2.2), None),
        space("rec709_display", Power(2.4), None),
        // What documents of older versions call them.
        space("gamma18", Power(1.8), None),
        space("gamma22", Power(2.2), None),
        space("gamma24", Power(2.4), None),
        space("acescg", Linear, Some(AP1)),
        space("lin_ap1", Linear, Some(AP1)),
        space("g22_ap1", Power(2.2), Some(AP1)),
        space("lin_adobergb", Linear, Some(ADOBE)),
        space("adobergb", Power(2.199_218_75), Some(ADOBE)),
        space("lin_displayp3", Linear, Some(P3)),
        space("srgb_displayp3", Srgb, Some(P3)),
    ]
};

/// Units of a length in metres, and of an angle in degrees.
const UNITS: [(&str, f64); 12] = [
    ("nanometer", 1e-9),
    ("micron", 1e-6),
    ("millimeter", 1e-3),
    ("centimeter", 1e-2),
    ("inch", 0.0254),
    ("foot", 0.3048),
    ("yard", 0.9144),
    ("meter", 1.0),
    ("kilometer", 1e3),
    ("mile", 1609.344),
    ("degree", 1.0),
    ("radian", 180.0 / std::f64::consts::PI),
];

/// A text as a value of a type.
pub(crate) fn parse(text: &str, ty: &str) -> Result<Literal, Refusal> {
    let wrong = |what: &str| {
        let shown: String = text.chars().take(40).collect();
        Err(Refusal::new(
            "import-value",
            format!("`{shown}` is no {ty}: {what}"),
        ))
    };
    if matches!(ty, "string" | "filename" | "geomname") {
        return Ok(Literal::Text(text.to_owned()));
    }
    if ty == "boolean" {
        return match text.trim() {
            "true" | "True" | "1" => Ok(flag(true)),
            "false" | "False" | "0" => Ok(flag(false)),
            _ => wrong("`true` or `false` is wanted"),
        };
    }
    let mut numbers = Vec::new();
    for word in text
        .split([',', ' ', '\n', '\t', '\r'])
        .filter(|word| !word.is_empty())
    {
        // As MaterialX's own reader, which stops at a second point: `0.5.0` is 0.5.
        let second = word.match_indices('.').nth(1);
        let read = second.map_or(word, |(at, _)| &word[..at]);
        match read.parse::<f64>() {
            Ok(number) if (number as f32).is_finite() => numbers.push(number),
            Ok(_) => return wrong("a number is not finite"),
            Err(_) => return wrong("a number is wanted"),
        }
        if numbers.len() > 16 {
            return wrong("too many numbers");
        }
    }
    if let Some(size) = matrix_size(ty) {
        if numbers.len() == 1 {
            numbers = vec![numbers[0]; size * size];
        }
        return if numbers.len() == size * size {
            Ok(Literal::Matrix(numbers))
        } else {
            wrong(&format!("{} numbers are wanted", size * size))
        };
    }
    let Some(native) = Type::by_name(ty) else {
        return Err(Refusal::new(
            "import-type",
            format!("a value of the type `{ty}` is not supported"),
        ));
    };
    if native == Type::Integer && numbers.iter().any(|number| number.fract() != 0.0) {
        return wrong("a whole number is wanted");
    }
    match Literal::of(native, &numbers) {
        Some(literal) => Ok(literal),
        None => wrong(&format!("{} numbers are wanted", native.components())),
    }
}

fn matrix_size(ty: &str) -> Option<usize> {
    match ty {
        "matrix33" => Some(3),
        "matrix44" => Some(4),
        _ => None,
    }
}

pub(crate) const fn flag(flag: bool) -> Literal {
    Literal::Numbers(Type::Boolean, [if flag { 1.0 } else { 0.0 }, 0.0, 0.0, 0.0])
}

/// The zero of a type.
pub(crate) fn zero(ty: &str) -> Result<Literal, Refusal> {
    match ty {
        "string" | "filename" | "geomname" => Ok(Literal::Text(String::new())),
        "boolean" => Ok(flag(false)),
        _ => parse("0", ty),
    }
}

/// A colour in linear Rec. 709, from the space that it is written in.
pub(crate) fn linear(literal: Literal, space: &str) -> Result<Literal, Refusal> {
    let Literal::Numbers(ty @ (Type::Color3 | Type::Color4), mut numbers) = literal else {
        return Ok(literal);
    };
    let Some(space) = SPACES.iter().find(|known| known.name == space) else {
        let known: Vec<&str> = SPACES.iter().map(|space| space.name).collect();
        return Err(Refusal::new(
            "import-colorspace",
            format!(
                "the colour space `{space}` is not known; these are: {}",
                known.join(", ")
            ),
        ));
    };
    let encoded = [numbers[0], numbers[1], numbers[2]];
    let light = encoded.map(|x| match space.transfer {
        Transfer::Linear => x,
        Transfer::Power(gamma) => x.max(0.0).powf(gamma),
        Transfer::Srgb => mipless_graph::linear_from_srgb(x),
    });
    for (i, number) in numbers.iter_mut().take(3).enumerate() {
        *number = match &space.matrix {
            Some(matrix) => (0..3).map(|j| matrix[i][j] * light[j]).sum(),
            None => light[i],
        };
    }
    Ok(Literal::Numbers(ty, numbers))
}

/// What a picture's file says of its colour space, as the port `colorspace` has it.
pub(crate) fn picture_space(space: Option<&str>) -> Result<&'static str, Refusal> {
    match space {
        // Without a colour space MaterialX takes the numbers as they are.
        None | Some("" | "none" | "raw" | "lin_rec709" | "lin_srgb") => Ok("lin_rec709"),
        Some("srgb_texture") => Ok("srgb_texture"),
        Some(other) => Err(Refusal::new(
            "import-colorspace",
            format!("a picture in the colour space `{other}` is not supported"),
        )),
    }
}

/// A length in metres or an angle in degrees, from the unit that it is written in.
pub(crate) fn in_units(literal: Literal, unit: &str) -> Result<Literal, Refusal> {
    let Some((_, scale)) = UNITS.iter().find(|(name, _)| *name == unit) else {
        return Err(Refusal::new(
            "import-unit",
            format!("the unit `{unit}` is not known"),
        ));
    };
    Ok(match literal {
        Literal::Numbers(ty, numbers) => Literal::Numbers(ty, numbers.map(|x| x * scale)),
        other => other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_become_linear_rec_709() {
        let white = Literal::Numbers(Type::Color3, [1.0, 1.0, 1.0, 0.0]);
        for space in SPACES {
            let linear = linear(white.clone(), space.name).expect("a known space");
            assert!(
                linear.numbers().iter().all(|x| (x - 1.0).abs() < 1e-4),
                "white stays white: {} {linear:?}",
                space.name
            );
        }
        assert!(linear(white, "ACES2065-1").is_err());
    }

    #[test]
    fn lengths_are_metres_and_angles_degrees() {
        let one = Literal::float(1.0);
        assert_eq!(in_units(one.clone(), "inch"), Ok(Literal::float(0.0254)));
        let right = in_units(Literal::float(std::f64::consts::FRAC_PI_2), "radian");
        assert!((right.expect("a unit").numbers()[0] - 90.0).abs() < 1e-9);
        assert!(in_units(one, "furlong").is_err());
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in ["1e99", "nan", "inf", "x", "1, 2", ""] {
            assert!(parse(text, "color3").is_err(), "{text}");
        }
        assert_eq!(
            parse("1,2 ,3", "vector3").expect("three").numbers(),
            [1.0, 2.0, 3.0]
        );
        assert_eq!(parse("2", "integer").expect("whole").numbers(), [2.0]);
    }
}
