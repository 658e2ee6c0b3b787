//! Reading the text form.

use crate::ir::{
    Body, Constant, Function, FunctionId, Inst, Module, Op, Parameter, Table, Type, Value,
};
use rustc_hash::FxHashMap;
use std::fmt;

/// Why text is not a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong there.
    pub message: String,
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for ParseError {}

type Parsed<T> = Result<T, String>;

impl Module {
    /// Reads the text form.
    ///
    /// # Errors
    /// The first line that is not of the form, or names a function, table or op that does not
    /// exist. The invariants of the IR are not checked: see [`verify`](crate::ir::verify).
    pub fn parse(text: &str) -> Result<Self, ParseError> {
        let mut reader = Reader::default();
        let mut last = 0;
        for (number, line) in (1..).zip(text.lines()) {
            let at = |message| ParseError {
                line: number,
                message,
            };
            last = number;
            let line = line.trim();
            if !line.is_empty() && !line.starts_with('#') {
                reader.line(&mut Cursor { rest: line }).map_err(at)?;
            }
        }
        if reader.open.is_some() {
            return Err(ParseError {
                line: last,
                message: "a function is not closed".to_owned(),
            });
        }
        Ok(reader.module)
    }
}

/// The rest of a line.
struct Cursor<'a> {
    rest: &'a str,
}

impl<'a> Cursor<'a> {
    fn skip_spaces(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn take(&mut self, mark: &str) -> bool {
        self.skip_spaces();
        let rest = self.rest.strip_prefix(mark);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn expect(&mut self, mark: &str) -> Parsed<()> {
        if self.take(mark) {
            Ok(())
        } else {
            Err(format!("expected `{mark}` at `{}`", self.rest))
        }
    }

    fn end(&mut self) -> Parsed<()> {
        self.skip_spaces();
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err(format!("`{}` is too much", self.rest))
        }
    }

    /// The longest run of characters that `of` accepts.
    fn run(&mut self, what: &str, of: impl Fn(char) -> bool) -> Parsed<&'a str> {
        self.skip_spaces();
        let end = self.rest.find(|c| !of(c)).unwrap_or(self.rest.len());
        if end == 0 {
            return Err(format!("expected {what} at `{}`", self.rest));
        }
        let (run, rest) = self.rest.split_at(end);
        self.rest = rest;
        Ok(run)
    }

    fn word(&mut self) -> Parsed<&'a str> {
        self.run("a word", |c| c.is_ascii_alphanumeric() || c == '_')
    }

    fn number<T: std::str::FromStr>(&mut self) -> Parsed<T> {
        let text = self.run("a number", |c| {
            c.is_ascii_alphanumeric() || "+-.".contains(c)
        })?;
        text.parse()
            .map_err(|_| format!("`{text}` is not a number of its type"))
    }

    fn value(&mut self) -> Parsed<Value> {
        self.expect("%")?;
        let index: u32 = self.number()?;
        Ok(Value::from_index(index as usize))
    }

    fn ty(&mut self) -> Parsed<Type> {
        let word = self.word()?;
        let all = [Type::F32, Type::I32, Type::U32, Type::Bool];
        let found = all.into_iter().find(|ty| ty.name() == word);
        found.ok_or_else(|| format!("`{word}` is not a type"))
    }

    fn real(&mut self) -> Parsed<f32> {
        if self.take("bits") {
            self.expect("0x")?;
            let digits = self.word()?;
            let bits = u32::from_str_radix(digits, 16);
            return bits
                .map(f32::from_bits)
                .map_err(|_| format!("0x{digits} is not 32 bits"));
        }
        let number: f32 = self.number()?;
        if number.is_finite() {
            Ok(number)
        } else {
            Err("a real is out of range".to_owned())
        }
    }

    /// An identifier or a quoted text.
    fn name(&mut self) -> Parsed<String> {
        self.skip_spaces();
        if self.rest.starts_with('"') {
            self.quoted()
        } else {
            self.word().map(str::to_owned)
        }
    }

    fn quoted(&mut self) -> Parsed<String> {
        self.expect("\"")?;
        let mut text = String::new();
        let mut chars = self.rest.char_indices();
        while let Some((at, c)) = chars.next() {
            match c {
                '"' => {
                    self.rest = &self.rest[at + 1..];
                    return Ok(text);
                }
                '\\' => match chars.next().map(|(_, c)| c) {
                    Some('n') => text.push('\n'),
                    Some('r') => text.push('\r'),
                    Some('t') => text.push('\t'),
                    Some('0') => text.push('\0'),
                    Some('u') => {
                        let code: String = (chars.by_ref().map(|(_, c)| c).skip(1))
                            .take_while(|&c| c != '}')
                            .collect();
                        let c = u32::from_str_radix(&code, 16).ok().and_then(char::from_u32);
                        text.push(c.ok_or_else(|| format!("`{code}` is not a character"))?);
                    }
                    Some(c) => text.push(c),
                    None => break,
                },
                c => text.push(c),
            }
        }
        Err("a quoted text is not closed".to_owned())
    }

    fn list(&mut self) -> Parsed<Box<[Value]>> {
        self.expect("(")?;
        let mut values = Vec::new();
        while !self.take(")") {
            if !values.is_empty() {
                self.expect(",")?;
            }
            values.push(self.value()?);
        }
        Ok(values.into())
    }
}

#[derive(Default)]
struct Reader {
    module: Module,
    open: Option<Function>,
    functions: FxHashMap<String, FunctionId>,
    tables: FxHashMap<String, u32>,
}

impl Reader {
    fn line(&mut self, cursor: &mut Cursor<'_>) -> Parsed<()> {
        match self.open.take() {
            None => self.global(cursor)?,
            Some(function) if cursor.take("}") => {
                let id = FunctionId::from_index(self.module.functions.len());
                if self.functions.insert(function.name.clone(), id).is_some() {
                    return Err(format!("two functions are called {:?}", function.name));
                }
                self.module.functions.push(function);
            }
            Some(mut function) => {
                self.local(&mut function, cursor)?;
                self.open = Some(function);
            }
        }
        cursor.end()
    }

    fn global(&mut self, cursor: &mut Cursor<'_>) -> Parsed<()> {
        match cursor.word()? {
            "table" => {
                let name = cursor.name()?;
                cursor.expect("=")?;
                cursor.expect("[")?;
                let mut data = Vec::new();
                while !cursor.take("]") {
                    if !data.is_empty() {
                        cursor.expect(",")?;
                    }
                    data.push(cursor.real()?);
                }
                let index = self.module.tables.len() as u32;
                if self.tables.insert(name.clone(), index).is_some() {
                    return Err(format!("two tables are called {name:?}"));
                }
                self.module.tables.push(Table {
                    name,
                    data: data.into(),
                });
            }
            "function" => {
                let name = cursor.name()?;
                cursor.expect("(")?;
                let mut params = Vec::new();
                while !cursor.take(")") {
                    if !params.is_empty() {
                        cursor.expect(",")?;
                    }
                    let name = cursor.name()?;
                    cursor.expect(":")?;
                    params.push(Parameter {
                        name,
                        ty: cursor.ty()?,
                    });
                }
                let doc = cursor.quoted()?;
                cursor.expect("{")?;
                let body = Body {
                    doc,
                    params,
                    ..Body::default()
                };
                self.open = Some(Function::new(name, body));
            }
            word => return Err(format!("expected `table` or `function`, found `{word}`")),
        }
        Ok(())
    }

    fn local(&self, function: &mut Function, cursor: &mut Cursor<'_>) -> Parsed<()> {
        if cursor.take("return") {
            while !cursor.rest.is_empty() {
                if !function.results.is_empty() {
                    cursor.expect(",")?;
                }
                let name = cursor.name()?;
                cursor.expect("=")?;
                function.results.push((name, cursor.value()?));
                cursor.skip_spaces();
            }
            return Ok(());
        }
        let value = cursor.value()?;
        if value.index() != function.insts.len() {
            return Err(format!("%{} is expected here", function.insts.len()));
        }
        if !cursor.take(":") {
            function.names.insert(value, cursor.name()?.into());
            cursor.expect(":")?;
        }
        let ty = cursor.ty()?;
        cursor.expect("=")?;
        let inst = self.inst(ty, cursor)?;
        function.insts.push(inst);
        function.types.push(ty);
        Ok(())
    }

    fn inst(&self, ty: Type, cursor: &mut Cursor<'_>) -> Parsed<Inst> {
        let word = cursor.word()?;
        Ok(match word {
            "const" => {
                let bits = match ty {
                    Type::F32 => cursor.real()?.to_bits(),
                    Type::I32 => cursor.number::<i32>()? as u32,
                    Type::U32 => cursor.number::<u32>()?,
                    Type::Bool => u32::from(cursor.number::<bool>()?),
                };
                Inst::Const(Constant { ty, bits })
            }
            "param" => Inst::Param(cursor.number()?),
            "load" => {
                let name = cursor.name()?;
                let table = self.tables.get(&name);
                let table = *table.ok_or_else(|| format!("there is no table {name:?}"))?;
                Inst::Load(table, cursor.value()?)
            }
            "call" => {
                let callee = self.callee(cursor)?;
                Inst::Call(callee, cursor.list()?)
            }
            "fold" => {
                let function = self.callee(cursor)?;
                cursor.expect("count=")?;
                let count = cursor.value()?;
                cursor.expect("init=")?;
                let init = cursor.list()?;
                cursor.expect("captures=")?;
                Inst::Fold {
                    function,
                    count,
                    init,
                    captures: cursor.list()?,
                }
            }
            "result" => {
                let of = cursor.value()?;
                Inst::Result(of, cursor.number()?)
            }
            word => {
                let op = Op::by_name(word).ok_or_else(|| format!("there is no op `{word}`"))?;
                // Unused places repeat the first operand, as in the builder.
                let mut operands = [cursor.value()?; 3];
                for operand in operands.iter_mut().take(op.info().operands.len()).skip(1) {
                    *operand = cursor.value()?;
                }
                Inst::Op(op, operands)
            }
        })
    }

    fn callee(&self, cursor: &mut Cursor<'_>) -> Parsed<FunctionId> {
        let name = cursor.name()?;
        let callee = self.functions.get(&name).copied();
        callee.ok_or_else(|| format!("there is no function {name:?} before"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::{random, verify};
    use proptest::prelude::*;

    const TEXT: &str = r#"table steps = [1.0, 2.5, 1e-45]

function octave(index: u32, mean: f32) "One \"octave\".\nAnd more: σ." {
  %0: u32 = param 0
  %1: f32 = param 1
  %2: f32 = load steps %0
  %3 swirl_mean: f32 = add %1 %2
  return mean = %3
}

function "das Ganze"(x: f32) "The whole." {
  %0: f32 = param 0
  %1: u32 = const 5
  %2: bool = fold octave count=%1 init=(%0) captures=()
  %3: f32 = result %2 0
  %4: bool = call octave(%1, %3)
  %5: f32 = result %4 0
  %6: f32 = const bits 0x7fc00001
  %7: i32 = const -2147483648
  %8: bool = const true
  return "1" = %5, same = %3
}
"#;

    #[test]
    fn text_is_read_and_printed_back() {
        let module = Module::parse(TEXT).unwrap();
        assert_eq!(module.to_string(), TEXT);
        let commented = TEXT.replace("\n\n", "\n# A comment.\n\n");
        assert_eq!(Module::parse(&commented).unwrap().to_string(), TEXT);
        let violations = verify(&module).expect_err("a constant is not finite");
        assert_eq!(violations.len(), 1);
        assert_eq!(violations[0].value, Some(Value::from_index(6)));
    }

    #[test]
    fn mistakes_are_found_on_their_line() {
        for (from, to, line, message) in [
            ("load steps", "load stairs", 6, "no table \"stairs\""),
            ("= add", "= plus", 7, "no op `plus`"),
            (
                "fold octave",
                "fold later",
                14,
                "no function \"later\" before",
            ),
            ("%3 swirl", "%4 swirl", 7, "%3 is expected"),
            (
                "const 5",
                "const 5.5",
                13,
                "`5.5` is not a number of its type",
            ),
            ("captures=()", "captures=(", 14, "expected `%`"),
            (
                "= param 0\n  %1: f32",
                "= param 0 0\n  %1: f32",
                4,
                "too much",
            ),
            ("\n}\n\n", "\n\n", 10, "expected `%`"),
            ("1e-45", "1e99", 1, "out of range"),
        ] {
            let error = Module::parse(&TEXT.replacen(from, to, 1)).unwrap_err();
            assert!(error.message.contains(message), "{error}");
            assert_eq!(error.line, line, "{error}");
        }
        let error = Module::parse(TEXT.trim_end().trim_end_matches('}')).unwrap_err();
        assert!(error.message.contains("not closed"), "{error}");
    }

    proptest! {
        #[test]
        fn random_modules_round_trip_and_verify(program in random::program()) {
            let module = program.module;
            prop_assert_eq!(verify(&module), Ok(()));
            let text = module.to_string();
            let read = Module::parse(&text).unwrap();
            prop_assert_eq!(&read, &module);
            prop_assert_eq!(read.to_string(), text);
        }
    }
}
