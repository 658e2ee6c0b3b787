//! The text form of a module: printed by `Display`, read by [`Module::parse`].
//!
//! ```text
//! table steps = [1.0, 2.5]
//!
//! function octave(index: u32, mean: f32) "One octave." {
//!   %0: u32 = param 0
//!   %1: f32 = param 1
//!   %2: f32 = float_u %0
//!   %3: f32 = load steps %0
//!   %4 swirl_mean: f32 = add %1 %2
//!   return mean = %4
//! }
//!
//! function marble(x: f32) "The whole." {
//!   %0: f32 = param 0
//!   %1: u32 = const 5
//!   %2: bool = fold octave count=%1 init=(%0) captures=()
//!   %3: f32 = result %2 0
//!   %4: bool = call other(%3)
//!   return out = %3
//! }
//! ```
//! One line is one instruction; lines may be indented freely, and lines that begin with `#` are
//! comments. A name that is not an identifier stands in quotes, escaped as in Rust. Real constants
//! are the shortest decimals that read back to the bit, or `bits 0x7fc00000` where they are not
//! finite. The type of a call or fold has no meaning, and is printed as it is stored.
//!
//! Reading checks the form and that names exist, not the invariants: see
//! [`verify`](super::verify).

mod read;

use super::{Function, Inst, Module, Type, Value};
use std::fmt;

pub use read::ParseError;

/// A name, in quotes if it is not an identifier.
struct Name<'a>(&'a str);

impl fmt::Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_identifier = self
            .0
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b == b'_')
            && self.0.bytes().next().is_some_and(|b| !b.is_ascii_digit());
        if is_identifier {
            f.write_str(self.0)
        } else {
            write!(f, "{:?}", self.0)
        }
    }
}

/// A real number.
struct Real(f32);

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_finite() {
            write!(f, "{:?}", self.0)
        } else {
            write!(f, "bits {:#010x}", self.0.to_bits())
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "%{}", self.index())
    }
}

/// Values between commas, in parentheses.
struct List<'a>(&'a [Value]);

impl fmt::Display for List<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        for (index, value) in self.0.iter().enumerate() {
            f.write_str(if index == 0 { "" } else { ", " })?;
            value.fmt(f)?;
        }
        f.write_str(")")
    }
}

impl fmt::Display for Module {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for table in &self.tables {
            write!(f, "table {} = [", Name(&table.name))?;
            for (index, &x) in table.data.iter().enumerate() {
                write!(f, "{}{}", if index == 0 { "" } else { ", " }, Real(x))?;
            }
            f.write_str("]\n")?;
        }
        for (index, function) in self.functions.iter().enumerate() {
            if index > 0 || !self.tables.is_empty() {
                f.write_str("\n")?;
            }
            self.print(function, f)?;
        }
        Ok(())
    }
}

impl Module {
    fn print(&self, function: &Function, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "function {}(", Name(&function.name))?;
        for (index, param) in function.params.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{}: {}", Name(&param.name), param.ty.name())?;
        }
        writeln!(f, ") {:?} {{", function.doc)?;
        for (index, (inst, ty)) in function.insts.iter().zip(&function.types).enumerate() {
            let value = Value::from_index(index);
            write!(f, "  {value}")?;
            if let Some(name) = function.names.get(&value).map(|name| name.to_string()) {
                write!(f, " {}", Name(&name))?;
            }
            write!(f, ": {} = ", ty.name())?;
            self.print_inst(inst, f)?;
            f.write_str("\n")?;
        }
        f.write_str("  return")?;
        for (index, (name, value)) in function.results.iter().enumerate() {
            write!(
                f,
                "{} {} = {value}",
                if index == 0 { "" } else { "," },
                Name(name)
            )?;
        }
        f.write_str("\n}\n")
    }

    fn print_inst(&self, inst: &Inst, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match inst {
            Inst::Const(constant) => match constant.ty {
                Type::F32 => write!(f, "const {}", Real(f32::from_bits(constant.bits))),
                Type::I32 => write!(f, "const {}", constant.bits as i32),
                Type::U32 => write!(f, "const {}", constant.bits),
                Type::Bool => write!(f, "const {}", constant.bits != 0),
            },
            Inst::Param(position) => write!(f, "param {position}"),
            Inst::Op(op, operands) => {
                f.write_str(op.info().name)?;
                operands[..op.info().operands.len()]
                    .iter()
                    .try_for_each(|v| write!(f, " {v}"))
            }
            Inst::Load(table, index) => {
                write!(
                    f,
                    "load {} {index}",
                    Name(&self.tables[*table as usize].name)
                )
            }
            Inst::Call(callee, arguments) => {
                write!(
                    f,
                    "call {}{}",
                    Name(&self.function(*callee).name),
                    List(arguments)
                )
            }
            Inst::Fold {
                function,
                count,
                init,
                captures,
            } => {
                let name = Name(&self.function(*function).name);
                write!(
                    f,
                    "fold {name} count={count} init={} captures={}",
                    List(init),
                    List(captures)
                )
            }
            Inst::Result(of, position) => write!(f, "result {of} {position}"),
        }
    }
}
