//! The spelling of ops and constants: templates of the op table, precedence, literals.

use crate::ir::{Constant, Op, Type};
use std::sync::LazyLock;

/// How tightly an expression binds; an operand of lower level than its place gets parentheses.
///
/// WGSL does not let shifts and bitwise operators mix with others unparenthesised.
pub(super) mod level {
    /// The right-hand side of a `let`: anything.
    pub(crate) const ANY: u8 = 0;
    /// A shift. Parenthesised even as an argument: `f(a < b, c >> d)` would read as a template.
    pub(crate) const SHIFT: u8 = 1;
    /// An argument of a call.
    pub(crate) const ARGUMENT: u8 = 2;
    /// A comparison or a bitwise operator.
    pub(crate) const BITS: u8 = 2;
    /// A sum.
    pub(crate) const SUM: u8 = 4;
    /// A product.
    pub(crate) const PRODUCT: u8 = 5;
    /// `-x`, `!x`, a negative literal.
    pub(crate) const UNARY: u8 = 6;
    /// A name, a literal, a call.
    pub(crate) const PRIMARY: u8 = 7;
}

/// How an op is written.
#[derive(Debug)]
pub(super) enum Form {
    /// `a OP b`.
    Infix {
        /// With a space on either side.
        operator: &'static str,
        /// Its own level.
        level: u8,
        /// The level that the left operand needs.
        left: u8,
        /// The level that the right operand needs.
        right: u8,
        /// Whether the left operand may be the same operator unparenthesised.
        chains: bool,
    },
    /// `OP a`.
    Prefix(&'static str),
    /// Text with operands between: operand numbers follow each piece of text but the last.
    Call(Vec<(&'static str, Option<usize>)>),
}

static FORMS: LazyLock<Vec<Form>> =
    LazyLock::new(|| Op::ALL.iter().map(|op| parse(op.info().wgsl)).collect());

/// How `op` is written.
pub(super) fn form(op: Op) -> &'static Form {
    &FORMS[op as usize]
}

fn parse(template: &'static str) -> Form {
    let middle = template
        .strip_prefix("{a}")
        .and_then(|t| t.strip_suffix("{b}"));
    if let Some(operator) = middle {
        use level::{BITS, PRODUCT, SHIFT, SUM, UNARY};
        let (level, left, right, chains) = match operator.trim() {
            "*" | "/" => (PRODUCT, PRODUCT, UNARY, false),
            "+" | "-" => (SUM, SUM, PRODUCT, false),
            "<<" | ">>" => (SHIFT, UNARY, UNARY, false),
            "<" | "<=" | "==" => (BITS, SUM, SUM, false),
            "&" | "|" | "^" => (BITS, UNARY, UNARY, true),
            other => panic!("the op table has an operator of unknown precedence: {other}"),
        };
        return Form::Infix {
            operator,
            level,
            left,
            right,
            chains,
        };
    }
    match template {
        "-{a}" => return Form::Prefix("-"),
        "!{a}" => return Form::Prefix("!"),
        _ => {}
    }
    let mut pieces = Vec::new();
    let mut rest = template;
    while let Some(at) = rest.find('{') {
        let operand = rest.as_bytes()[at + 1] - b'a';
        pieces.push((&rest[..at], Some(usize::from(operand))));
        rest = &rest[at + 3..];
    }
    pieces.push((rest, None));
    Form::Call(pieces)
}

/// Appends a decimal number.
pub(super) fn push_number(out: &mut String, mut number: u32) {
    let mut digits = [0_u8; 10];
    let mut start = digits.len();
    loop {
        start -= 1;
        digits[start] = b'0' + (number % 10) as u8;
        number /= 10;
        if number == 0 {
            break;
        }
    }
    out.push_str(std::str::from_utf8(&digits[start..]).expect("digits are ASCII"));
}

/// Appends a constant as a WGSL literal of the same bits; returns its level.
///
/// # Panics
/// If it is a real that is not finite: the IR's verifier excludes it.
pub(super) fn push_constant(out: &mut String, constant: Constant) -> u8 {
    let bits = constant.bits;
    match constant.ty {
        Type::F32 => {
            let number = f32::from_bits(bits);
            assert!(number.is_finite(), "a constant of the IR is {number}");
            push_f32(out, number);
            if number.is_sign_negative() {
                level::UNARY
            } else {
                level::PRIMARY
            }
        }
        Type::I32 => {
            let number = bits as i32;
            if number == i32::MIN {
                // `-2147483648i` would be the negation of a literal that does not fit.
                out.push_str("i32(-2147483648)");
                return level::PRIMARY;
            }
            if number < 0 {
                out.push('-');
            }
            push_number(out, number.unsigned_abs());
            out.push('i');
            if number < 0 {
                level::UNARY
            } else {
                level::PRIMARY
            }
        }
        Type::U32 => {
            push_number(out, bits);
            out.push('u');
            level::PRIMARY
        }
        Type::Bool => {
            out.push_str(if bits == 0 { "false" } else { "true" });
            level::PRIMARY
        }
    }
}

/// Appends the shortest decimal that reads back as `number`.
pub(super) fn push_f32(out: &mut String, number: f32) {
    use std::fmt::Write;
    let magnitude = number.abs();
    if magnitude < 10_000.0 && magnitude.fract() == 0.0 {
        // Small whole numbers are half of all constants; the general formatter is slow.
        if number.is_sign_negative() {
            out.push('-');
        }
        push_number(out, magnitude as u32);
        out.push_str(".0");
    } else {
        write!(out, "{number:?}").expect("a string takes all text");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn literal(x: f32) -> String {
        let mut out = String::new();
        push_f32(&mut out, x);
        out
    }

    #[test]
    fn literals_read_back_to_the_bit_also_by_way_of_f64() {
        for x in [
            0.0,
            -0.0,
            1.0,
            -3.5,
            0.1,
            1e-45,
            f32::MIN_POSITIVE,
            f32::MAX,
            16_777_216.0,
        ] {
            assert_eq!(literal(x).parse::<f32>().unwrap().to_bits(), x.to_bits());
        }
        // WGSL reads a literal without suffix as f64 and rounds it then.
        let mut bits = 1_u32;
        for _ in 0..200_000 {
            bits = bits.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let x = f32::from_bits(bits);
            if x.is_finite() {
                let text = literal(x);
                assert!(text.contains(['.', 'e']), "{text} reads as an integer");
                assert_eq!(
                    (text.parse::<f64>().unwrap() as f32).to_bits(),
                    bits,
                    "{text}"
                );
            }
        }
    }
}
