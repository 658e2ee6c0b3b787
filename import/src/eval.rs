//! Works out what a rule says, making nodes on the way.
//!
//! | word | gives |
//! |---|---|
//! | `as(type, e)` | `e` converted; `out` is the type of the node's output |
//! | `part(e, i)`, `entry(m, i)` | a component, or a row of a matrix; one number of a matrix |
//! | `each(e)` | `e` for every channel `#` of the output |
//! | `channel(e)` | the part `#` of `e`, or `e` where it is one number |
//! | `case(e, 0: a, "x": b, else: c)` | by the literal `e`; a signal is something else |
//! | `given("port", a, b)` | `a` where the document says what the input holds, else `b` |
//! | `fold(node, e)` | the node over all parts of `e` |
//! | `rgba(c, a)`, `rgb(r, g, b)` | a colour with another alpha; a colour of three numbers |
//! | `alpha("port", e)` | the alpha of an input, at the coordinate `e` if there is one |
//! | `sum(n, e)` | `e` for each `#` from 0 up to n, summed, the last one by the share of it that n has |
//! | `whole(e)` | rounded down, worked out where it is a literal |
//! | `most(n, e)` | the largest `e` for `#` from 0 to n − 1 |
//! | `ramp(e)` | the node's stops at `e`, by its interpolation |
//! | `sin(e)`, `cos(e)`, `pow(a, b)` | worked out where they are literals |
//! | `seed(e)`, `period(x, y, #)` | the node's own random numbers; after how many cells they repeat |
//! | `toolseed()`, `cells(x, #)` | the tool's own seed; after how many cells it repeats along an axis |
//! | `input("name", e)` | an input of the graph, a number |
//! | `index()` | which output of the node is asked for, from its last letter |
//! | `type()`, `space("file")` | the name of the output's type; the colour space of a picture |
//! | `determinant(m)`, `transpose(m)`, `invertmatrix(m)` | of literals |
//! | `note("text", e)`, `refuse("code", "text")` | says so |

mod ramp;

use crate::build::{Builder, Refusal};
use crate::matrix;
use crate::rule::Expr;
use crate::value::{Literal, Value};
use mipless_graph::{InputEntry, Type};

/// What a rule is worked out for.
pub(crate) trait Call {
    /// What an input holds, at a coordinate if one is named.
    fn input(
        &mut self,
        builder: &mut Builder,
        name: &str,
        at: Option<&Value>,
    ) -> Result<Value, Refusal>;

    /// Whether the document says what the input holds.
    fn is_given(&self, name: &str) -> bool;

    /// The coordinate.
    fn coordinate(&mut self, builder: &mut Builder) -> Result<Value, Refusal>;

    /// The type and the name of the output that is asked for.
    fn output(&self) -> (Type, &str);

    /// The colour space of the file that an input names, as the port `colorspace` has it.
    fn color_space(&mut self, _: &str) -> Result<&'static str, Refusal> {
        Ok("auto")
    }

    /// The alpha of an input.
    fn alpha(&mut self, _: &mut Builder, _: &str, _: Option<&Value>) -> Result<Value, Refusal> {
        Ok(Value::float(1.0))
    }

    /// A part of the node's rule that has a name.
    fn local(&self, _: &str) -> Option<&'static Expr> {
        None
    }

    /// The seed that the node has in the tool that it comes from.
    fn tool_seed(&self) -> Option<i32> {
        None
    }

    /// The number from which the node's random numbers are counted.
    fn seed(&self) -> i32 {
        0
    }
}

/// A mistake of a table, not of a document.
fn wrong_rule(what: &str) -> Refusal {
    Refusal::new(
        "import-rule",
        format!("a rule of the importer is wrong: {what}"),
    )
}

/// The value of an expression.
pub(crate) fn eval(
    expr: &Expr,
    builder: &mut Builder,
    call: &mut dyn Call,
) -> Result<Value, Refusal> {
    Evaluation {
        builder,
        call,
        channel: None,
    }
    .value(expr)
}

struct Evaluation<'a> {
    builder: &'a mut Builder,
    call: &'a mut dyn Call,
    channel: Option<usize>,
}

impl Evaluation<'_> {
    fn value(&mut self, expr: &Expr) -> Result<Value, Refusal> {
        match expr {
            Expr::Port(name, None) => match self.call.local(name) {
                Some(part) => self.value(part),
                None => self.call.input(self.builder, name, None),
            },
            Expr::Port(name, Some(at)) => {
                let at = self.value(at)?;
                self.call.input(self.builder, name, Some(&at))
            }
            Expr::Number(number) => Ok(Value::float(*number)),
            Expr::Text(text) => Ok(Value::Literal(Literal::Text(text.clone()))),
            Expr::Flag(flag) => {
                let number = f64::from(u8::from(*flag));
                Ok(Value::Literal(Literal::Numbers(
                    Type::Boolean,
                    [number, 0.0, 0.0, 0.0],
                )))
            }
            Expr::Name(name) if name == "uv" => self.call.coordinate(self.builder),
            Expr::Name(name) => Err(wrong_rule(&format!("`{name}` is nothing"))),
            Expr::Channel => Ok(Value::float(self.channel.unwrap_or(0) as f64)),
            Expr::List(items) => {
                let parts = self.values(items)?;
                let ty = match parts.len() {
                    2 => Type::Vector2,
                    3 => Type::Color3,
                    _ => Type::Color4,
                };
                self.builder.combined(&parts, ty)
            }
            Expr::Negated(inner) => {
                let inner = self.value(inner)?;
                self.binary('*', Value::float(-1.0), inner)
            }
            Expr::Binary(operator, left, right) => {
                let (left, right) = (self.value(left)?, self.value(right)?);
                self.binary(*operator, left, right)
            }
            Expr::Call {
                name,
                arguments,
                output,
            } => self.call(name, arguments, output),
        }
    }

    fn values(&mut self, items: &[Expr]) -> Result<Vec<Value>, Refusal> {
        items.iter().map(|item| self.value(item)).collect()
    }

    fn binary(&mut self, operator: char, left: Value, right: Value) -> Result<Value, Refusal> {
        if let (Value::Literal(a), Value::Literal(b)) = (&left, &right)
            && let (Some(from), Some(to)) = (a.ty(), b.ty())
        {
            let ty = if from.components() >= to.components() {
                from
            } else {
                to
            };
            let ty = if ty.components() == 1 {
                Type::Float
            } else {
                ty
            };
            let (a, b) = (a.converted(ty), b.converted(ty));
            if let (Some(Literal::Numbers(_, a)), Some(Literal::Numbers(_, b))) = (a, b) {
                let mut numbers = [0.0; 4];
                for i in 0..ty.components() {
                    numbers[i] = match operator {
                        '+' => a[i] + b[i],
                        '-' => a[i] - b[i],
                        '*' => a[i] * b[i],
                        _ => a[i] / b[i],
                    };
                }
                if numbers.iter().all(|number| number.is_finite()) {
                    return Ok(Value::Literal(Literal::Numbers(ty, numbers)));
                }
            }
        }
        // What changes nothing, and is no wider than what it would change.
        let is = |value: &Value, number: f64, beside: &Value| {
            let wide = |value: &Value| value.ty().map_or(0, Type::components);
            matches!(value, Value::Literal(literal) if !literal.numbers().is_empty()
                && literal.numbers().iter().all(|x| *x == number))
                && wide(value) <= wide(beside)
        };
        let name = match operator {
            '+' if is(&left, 0.0, &right) => return Ok(right),
            '+' | '-' if is(&right, 0.0, &left) => return Ok(left),
            '*' if is(&left, 1.0, &right) => return Ok(right),
            '*' | '/' if is(&right, 1.0, &left) => return Ok(left),
            '+' => "add",
            '-' => "subtract",
            '*' => "multiply",
            _ => "divide",
        };
        let inputs = vec![("in1".to_owned(), left), ("in2".to_owned(), right)];
        self.builder.node(name, inputs, "out")
    }

    fn call(
        &mut self,
        name: &str,
        arguments: &[(Option<String>, Expr)],
        output: &str,
    ) -> Result<Value, Refusal> {
        let argument = |i: usize| {
            let argument = arguments.get(i).map(|(_, expr)| expr);
            argument.ok_or_else(|| wrong_rule(&format!("`{name}` wants more")))
        };
        let text = |i: usize| match arguments.get(i) {
            Some((_, Expr::Text(text) | Expr::Name(text))) => Ok(text.as_str()),
            _ => Err(wrong_rule(&format!("`{name}` wants a text"))),
        };
        match name {
            "as" => {
                let ty = match text(0)? {
                    "out" => self.call.output().0,
                    ty => Type::by_name(ty).ok_or_else(|| wrong_rule(ty))?,
                };
                let value = self.value(argument(1)?)?;
                self.builder.converted(value, ty)
            }
            "part" | "entry" => {
                let value = self.value(argument(0)?)?;
                let index = self.whole(argument(1)?)?;
                match (name, &value) {
                    ("entry", Value::Literal(Literal::Matrix(numbers))) => numbers
                        .get(index)
                        .map(|number| Value::float(*number))
                        .ok_or_else(|| wrong_rule("a matrix has fewer entries")),
                    ("entry", _) => Err(Refusal::new(
                        "import-literal-only",
                        "a matrix that is no literal is not supported",
                    )),
                    _ => self.builder.part(&value, index),
                }
            }
            "whole" => match self.value(argument(0)?)? {
                Value::Literal(literal) => {
                    let number = literal.numbers().first().copied().unwrap_or(0.0);
                    Ok(Value::float(number.floor()))
                }
                value => {
                    let inputs = vec![("in".to_owned(), value)];
                    self.builder.node("floor", inputs, "out")
                }
            },
            "most" => {
                let count = self.whole(argument(0)?)?.clamp(1, LONGEST_SUM);
                let outer = self.channel;
                let mut most = None;
                for i in 0..count {
                    self.channel = Some(i);
                    let term = self.value(argument(1)?)?;
                    most = Some(match most {
                        None => term,
                        Some(most) => {
                            let inputs = vec![("in1".to_owned(), most), ("in2".to_owned(), term)];
                            self.builder.node("max", inputs, "out")?
                        }
                    });
                }
                self.channel = outer;
                most.ok_or_else(|| wrong_rule("`most` has terms"))
            }
            "ramp" => {
                let place = self.value(argument(0)?)?;
                self.ramp(&place)
            }
            "each" => {
                let ty = self.call.output().0;
                let outer = self.channel;
                let mut parts = Vec::new();
                for channel in 0..ty.components() {
                    self.channel = Some(channel);
                    let part = self.value(argument(0)?)?;
                    parts.push(self.builder.converted(part, Type::Float)?);
                }
                self.channel = outer;
                self.builder.combined(&parts, ty)
            }
            "channel" => {
                let value = self.value(argument(0)?)?;
                match value.ty() {
                    Some(ty) if ty.components() > 1 => {
                        self.builder.part(&value, self.channel.unwrap_or(0))
                    }
                    _ => Ok(value),
                }
            }
            "rgb" => {
                let mut parts = Vec::with_capacity(3);
                for i in 0..3 {
                    let part = self.value(argument(i)?)?;
                    parts.push(self.builder.converted(part, Type::Float)?);
                }
                self.builder.combined(&parts, Type::Color3)
            }
            "alpha" => {
                let at = match arguments.get(1) {
                    Some((_, at)) => Some(self.value(at)?),
                    None => None,
                };
                self.call.alpha(self.builder, text(0)?, at.as_ref())
            }
            "sum" => {
                let count = self.count(argument(0)?)?;
                let outer = self.channel;
                let mut sum = Value::float(0.0);
                let mut left = count.clamp(1.0, LONGEST_SUM as f64);
                let mut i = 0;
                while left > 0.0 {
                    self.channel = Some(i);
                    let term = self.value(argument(1)?)?;
                    let term = self.binary('*', Value::float(left.min(1.0)), term)?;
                    sum = self.binary('+', sum, term)?;
                    left -= 1.0;
                    i += 1;
                }
                self.channel = outer;
                Ok(sum)
            }
            "seed" => {
                let offset = self.whole(argument(0)?)?;
                Ok(Value::float(f64::from(self.call.seed()) + offset as f64))
            }
            "toolseed" => Ok(Value::float(f64::from(match self.call.tool_seed() {
                Some(seed) => seed,
                None => {
                    let note =
                        "the noise has other blobs than Material Maker's, with the same statistics";
                    self.builder.notes.push(note.to_owned());
                    self.call.seed()
                }
            }))),
            "cells" => {
                let (cells, octave) = (self.value(argument(0)?)?, self.value(argument(1)?)?);
                let cells = self.builder.decided(cells);
                let cells = match (&cells, &octave) {
                    (Value::Literal(cells), Value::Literal(octave)) => {
                        let first = |literal: &Literal| literal.numbers().first().copied();
                        first(cells).unwrap_or(0.0) * first(octave).unwrap_or(0.0).exp2()
                    }
                    _ => 0.0,
                };
                let repeats = cells.fract() == 0.0 && (1.0..=65_536.0).contains(&cells);
                Ok(Value::float(if repeats { cells } else { 0.0 }))
            }
            "period" => self.period(arguments),
            "sin" | "cos" if arguments.iter().all(|(key, _)| key.is_none()) => {
                let value = self.value(argument(0)?)?;
                match &value {
                    Value::Literal(literal) => {
                        let x = literal.numbers().first().copied().unwrap_or(0.0);
                        Ok(Value::float(if name == "sin" { x.sin() } else { x.cos() }))
                    }
                    Value::Link(_) => {
                        self.builder
                            .node(name, vec![("in".to_owned(), value)], "out")
                    }
                }
            }
            "pow" => {
                let (base, exponent) = (self.value(argument(0)?)?, self.value(argument(1)?)?);
                if let (Value::Literal(a), Value::Literal(b)) = (&base, &exponent)
                    && let ([a], [b]) = (a.numbers(), b.numbers())
                    && a.powf(*b).is_finite()
                {
                    return Ok(Value::float(a.powf(*b)));
                }
                let inputs = vec![("in1".to_owned(), base), ("in2".to_owned(), exponent)];
                self.builder.node("power", inputs, "out")
            }
            "case" => self.case(argument(0)?, &arguments[1..]),
            "given" => {
                let which = if self.call.is_given(text(0)?) { 1 } else { 2 };
                self.value(argument(which)?)
            }
            "fold" => {
                let value = self.value(argument(1)?)?;
                let count = value.ty().map_or(1, Type::components);
                let mut all = self.builder.part(&value, 0)?;
                for i in 1..count {
                    let part = self.builder.part(&value, i)?;
                    let inputs = vec![("in1".to_owned(), all), ("in2".to_owned(), part)];
                    all = self.builder.node(text(0)?, inputs, "out")?;
                }
                Ok(all)
            }
            "rgba" => {
                let color = self.value(argument(0)?)?;
                let alpha = self.value(argument(1)?)?;
                let mut parts = Vec::with_capacity(4);
                for i in 0..3 {
                    parts.push(self.builder.part(&color, i)?);
                }
                parts.push(alpha);
                self.builder.combined(&parts, Type::Color4)
            }
            "input" => {
                let value = self.value(argument(1)?)?;
                let Value::Literal(literal) = value else {
                    return Ok(value);
                };
                let entry = InputEntry {
                    ty: "float".to_owned(),
                    value: literal.to_json(),
                    ..InputEntry::default()
                };
                Ok(self.builder.input(text(0)?, entry, Type::Float))
            }
            "index" => {
                let index = match self.call.output().1.chars().last() {
                    Some('y' | 'g' | '2') => 1,
                    Some('z' | 'b' | '3') => 2,
                    Some('w' | 'a' | '4') => 3,
                    _ => 0,
                };
                Ok(Value::float(f64::from(index)))
            }
            "type" => {
                let name = self.call.output().0.name();
                Ok(Value::Literal(Literal::Text(name.to_owned())))
            }
            "space" => {
                let space = self.call.color_space(text(0)?)?;
                Ok(Value::Literal(Literal::Text(space.to_owned())))
            }
            "determinant" | "transpose" | "invertmatrix" => {
                let value = self.value(argument(0)?)?;
                let Value::Literal(Literal::Matrix(numbers)) = value else {
                    return Err(Refusal::new(
                        "import-literal-only",
                        "a matrix that is no literal is not supported",
                    ));
                };
                Ok(match name {
                    "determinant" => Value::float(matrix::determinant(&numbers)),
                    "transpose" => Value::Literal(Literal::Matrix(matrix::transpose(&numbers))),
                    _ => {
                        let inverse = matrix::inverse(&numbers).ok_or_else(|| {
                            Refusal::new("import-value", "the matrix has no inverse")
                        })?;
                        Value::Literal(Literal::Matrix(inverse))
                    }
                })
            }
            "note" => {
                self.builder.notes.push(text(0)?.to_owned());
                self.value(argument(1)?)
            }
            "refuse" => {
                // Codes are names of the program, of which there are few.
                let code = REFUSALS.iter().find(|code| **code == text(0).unwrap_or(""));
                let code = code.ok_or_else(|| wrong_rule("an unknown code"))?;
                Err(Refusal::new(code, text(1)?))
            }
            _ => {
                let mut inputs = Vec::with_capacity(arguments.len());
                for (port, expr) in arguments {
                    let port = port
                        .clone()
                        .ok_or_else(|| wrong_rule("an input has a name"))?;
                    inputs.push((port, self.value(expr)?));
                }
                match of_literals(name, &inputs) {
                    Some(value) => Ok(value),
                    None => self.builder.node(name, inputs, output),
                }
            }
        }
    }

    /// After how many cells a noise repeats that repeats with the unit square: of two numbers of
    /// cells, and of the octave.
    fn period(&mut self, arguments: &[(Option<String>, Expr)]) -> Result<Value, Refusal> {
        let mut numbers = [0.0; 3];
        for (number, (_, argument)) in numbers.iter_mut().zip(arguments) {
            let value = self.value(argument)?;
            if let Value::Literal(literal) = self.builder.decided(value) {
                *number = literal.numbers().first().copied().unwrap_or(0.0);
            }
        }
        let [x, y, octave] = numbers;
        let cells = x * octave.exp2();
        let repeats = x == y && x.fract() == 0.0 && (1.0..=65_536.0).contains(&cells);
        Ok(Value::float(if repeats { cells } else { 0.0 }))
    }

    /// A literal number that is not negative.
    fn count(&mut self, expr: &Expr) -> Result<f64, Refusal> {
        let value = self.value(expr)?;
        match self.builder.decided(value) {
            Value::Literal(literal) => match literal.numbers() {
                [number] if *number >= 0.0 => Ok(*number),
                _ => Err(Refusal::new("import-value", "a number of terms is wanted")),
            },
            Value::Link(_) => Err(Refusal::new(
                "import-literal-only",
                "the number of terms must be a literal",
            )),
        }
    }

    /// A literal whole number.
    fn whole(&mut self, expr: &Expr) -> Result<usize, Refusal> {
        let value = self.value(expr)?;
        match self.builder.decided(value) {
            Value::Literal(literal) => match literal.numbers() {
                [number] if *number >= 0.0 && number.fract() == 0.0 => Ok(*number as usize),
                _ => Err(Refusal::new("import-value", "a whole number is wanted")),
            },
            Value::Link(_) => Err(Refusal::new(
                "import-literal-only",
                "the number of a component must be a literal",
            )),
        }
    }

    fn case(&mut self, of: &Expr, cases: &[(Option<String>, Expr)]) -> Result<Value, Refusal> {
        let value = self.value(of)?;
        // An input of the graph decides by what it holds; what is made depends on it.
        let value = self.builder.decided(value);
        let key = match &value {
            Value::Literal(Literal::Text(text)) => Some(text.clone()),
            Value::Literal(literal) => literal.numbers().first().map(ToString::to_string),
            Value::Link(_) => None,
        };
        let fits = |(name, _): &&(Option<String>, Expr)| name.is_some() && *name == key;
        let other = |(name, _): &&(Option<String>, Expr)| name.as_deref() == Some("else");
        match cases.iter().find(fits).or_else(|| cases.iter().find(other)) {
            Some((_, expr)) => self.value(expr),
            None => Err(match key {
                Some(key) => Refusal::new("import-value", format!("`{key}` is not supported here")),
                None => Refusal::new(
                    "import-literal-only",
                    "this input takes literals only, and a signal is connected",
                ),
            }),
        }
    }
}

/// The most terms of a sum: octaves beyond are finer than any texture is looked at.
const LONGEST_SUM: usize = 16;

/// What a node makes of two numbers that are literals.
fn of_literals(name: &str, inputs: &[(String, Value)]) -> Option<Value> {
    let [(_, Value::Literal(a)), (_, Value::Literal(b))] = inputs else {
        return None;
    };
    match (name, a.numbers(), b.numbers()) {
        ("min", [a], [b]) => Some(Value::float(a.min(*b))),
        ("max", [a], [b]) => Some(Value::float(a.max(*b))),
        ("modulo", [a], [b]) if *b > 0.0 => Some(Value::float(a.rem_euclid(*b))),
        _ => None,
    }
}

/// The codes that rules refuse by.
pub(crate) const REFUSALS: [&str; 8] = [
    "export-node",
    "export-port",
    "import-geometry",
    "import-foreign-code",
    "import-image",
    "import-node-missing",
    "import-input-missing",
    "import-value",
];
