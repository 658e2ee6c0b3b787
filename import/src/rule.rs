//! The language of the tables that say what a node becomes: one line a node, an expression of its
//! inputs. The tables are data; this reads them.
//!
//! ```text
//! rotate2d = rotate2d(in: $in, amount: -$amount)
//! ```
//!
//! A line that begins with a space goes on with the line before; one that begins with `#` is for
//! people. An expression is made of
//!
//! - `$name`, an input of the node, and `$name(e)`, the same at the coordinate `e`;
//! - numbers, `[1, 2]`, `"texts"`, `true`, `false`, and `+ - * /`, worked out where both sides are
//!   literals;
//! - `node(port: e, …)`, a node of the catalogue, and `node(…).output`;
//! - `uv`, the coordinate; `#`, the channel inside `each`;
//! - what [`eval`](crate::eval) lists: `as`, `part`, `case`, …

use std::collections::HashMap;

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expr {
    Port(String, Option<Box<Expr>>),
    Number(f64),
    List(Vec<Expr>),
    Text(String),
    Flag(bool),
    Name(String),
    Channel,
    Negated(Box<Expr>),
    Binary(char, Box<Expr>, Box<Expr>),
    Call {
        name: String,
        arguments: Vec<(Option<String>, Expr)>,
        output: String,
    },
}

impl Expr {
    /// The inputs that it reads, in the order of the text.
    pub(crate) fn ports(&self, found: &mut Vec<String>) {
        match self {
            Self::Port(name, at) => {
                found.push(name.clone());
                at.iter().for_each(|at| at.ports(found));
            }
            Self::List(items) => items.iter().for_each(|item| item.ports(found)),
            Self::Negated(inner) => inner.ports(found),
            Self::Binary(_, left, right) => {
                left.ports(found);
                right.ports(found);
            }
            Self::Call { arguments, .. } => {
                arguments.iter().for_each(|(_, item)| item.ports(found));
            }
            Self::Number(_) | Self::Text(_) | Self::Flag(_) | Self::Name(_) | Self::Channel => {}
        }
    }
}

/// Expressions by name.
#[derive(Debug, Default)]
pub(crate) struct Rules(HashMap<String, Expr>);

impl Rules {
    /// The rules of a table.
    ///
    /// # Panics
    /// If the table is not of this language: it is part of the crate, and a test reads it.
    pub(crate) fn parse(text: &str) -> Self {
        let mut written: Vec<(&str, String)> = Vec::new();
        for line in text.lines() {
            if line.starts_with('#') || line.trim().is_empty() {
                continue;
            }
            if line.starts_with(' ') {
                let (_, rule) = written.last_mut().expect("a rule begins at the margin");
                rule.push_str(line);
                continue;
            }
            let (name, rule) = line
                .split_once(" = ")
                .expect("a rule is `name = expression`");
            written.push((name.trim(), rule.to_owned()));
        }
        let mut rules = HashMap::new();
        for (name, rule) in written {
            let twice = rules.insert(name.to_owned(), Self::expression(&rule));
            assert!(twice.is_none(), "`{name}` has two rules");
        }
        Self(rules)
    }

    /// One expression.
    ///
    /// # Panics
    /// If it is none.
    pub(crate) fn expression(text: &str) -> Expr {
        let mut parser = Parser::new(text);
        let expr = parser.sum();
        assert!(parser.at_end(), "`{text}` goes on with `{}`", parser.rest());
        expr
    }

    /// The rule of that name.
    pub(crate) fn get(&self, name: &str) -> Option<&Expr> {
        self.0.get(name)
    }

    /// Every rule.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&String, &Expr)> {
        self.0.iter()
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Parser<'a> {
    const fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    fn rest(&self) -> &'a str {
        self.text[self.at..].trim_start()
    }

    fn at_end(&self) -> bool {
        self.rest().is_empty()
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Passes over a character, if it is next.
    fn take(&mut self, wanted: char) -> bool {
        let rest = self.rest();
        let found = rest.starts_with(wanted);
        if found {
            self.at = self.text.len() - rest.len() + wanted.len_utf8();
        }
        found
    }

    fn expect(&mut self, wanted: char) {
        let taken = self.take(wanted);
        assert!(taken, "`{wanted}` is wanted before `{}`", self.rest());
    }

    /// As many characters as belong to a word.
    fn word(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let rest = self.rest();
        let end = rest.find(|c| !belongs(c)).unwrap_or(rest.len());
        self.at = self.text.len() - rest.len() + end;
        &rest[..end]
    }

    fn sum(&mut self) -> Expr {
        let mut left = self.product();
        loop {
            let operator = match self.peek() {
                Some(operator @ ('+' | '-')) => operator,
                _ => return left,
            };
            self.expect(operator);
            left = Expr::Binary(operator, Box::new(left), Box::new(self.product()));
        }
    }

    fn product(&mut self) -> Expr {
        let mut left = self.unary();
        loop {
            let operator = match self.peek() {
                Some(operator @ ('*' | '/')) => operator,
                _ => return left,
            };
            self.expect(operator);
            left = Expr::Binary(operator, Box::new(left), Box::new(self.unary()));
        }
    }

    fn unary(&mut self) -> Expr {
        if self.take('-') {
            return Expr::Negated(Box::new(self.unary()));
        }
        self.atom()
    }

    fn atom(&mut self) -> Expr {
        match self.peek() {
            Some('(') => {
                self.expect('(');
                let inner = self.sum();
                self.expect(')');
                inner
            }
            Some('[') => {
                self.expect('[');
                let mut items = Vec::new();
                while !self.take(']') {
                    items.push(self.sum());
                    self.take(',');
                }
                Expr::List(items)
            }
            Some('#') => {
                self.expect('#');
                Expr::Channel
            }
            Some('"') => Expr::Text(self.quoted()),
            Some('$') => {
                self.expect('$');
                let mut name = self.word(is_name).to_owned();
                if self.text[self.at..].starts_with('#') {
                    self.at += 1;
                    name.push('#');
                }
                let at = self.take('(').then(|| {
                    let at = self.sum();
                    self.expect(')');
                    Box::new(at)
                });
                Expr::Port(name, at)
            }
            Some(c) if c.is_ascii_digit() => {
                let digits = self.word(|c| c.is_ascii_digit() || c == '.' || c == 'e');
                Expr::Number(digits.parse().expect("a number"))
            }
            _ => self.named(),
        }
    }

    fn quoted(&mut self) -> String {
        self.expect('"');
        let rest = &self.text[self.at..];
        let end = rest.find('"').expect("a text ends");
        self.at += end + 1;
        rest[..end].to_owned()
    }

    fn named(&mut self) -> Expr {
        let name = self.word(is_name).to_owned();
        assert!(
            !name.is_empty(),
            "an expression is wanted at `{}`",
            self.rest()
        );
        if !self.take('(') {
            return match name.as_str() {
                "true" => Expr::Flag(true),
                "false" => Expr::Flag(false),
                _ => Expr::Name(name),
            };
        }
        let mut arguments = Vec::new();
        while !self.take(')') {
            let start = self.at;
            let key = match self.peek() {
                Some('"') => self.quoted(),
                _ => self.word(|c| is_name(c) || c == '.').to_owned(),
            };
            if !key.is_empty() && self.take(':') {
                arguments.push((Some(key), self.sum()));
            } else {
                self.at = start;
                arguments.push((None, self.sum()));
            }
            self.take(',');
        }
        let output = if self.take('.') {
            self.word(|c| is_name(c) || c == '-').to_owned()
        } else {
            "out".to_owned()
        };
        Expr::Call {
            name,
            arguments,
            output,
        }
    }
}

fn is_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_bind_before_sums_and_calls_have_names_and_outputs() {
        let rules =
            Rules::parse("a = 1 - $x * 2\nb = brick(texcoord: uv,\n  mortar: -$m).height\n");
        assert_eq!(
            rules.get("a"),
            Some(&Expr::Binary(
                '-',
                Box::new(Expr::Number(1.0)),
                Box::new(Expr::Binary(
                    '*',
                    Box::new(Expr::Port("x".to_owned(), None)),
                    Box::new(Expr::Number(2.0))
                ))
            ))
        );
        let Some(Expr::Call {
            name,
            arguments,
            output,
        }) = rules.get("b")
        else {
            panic!("a call");
        };
        assert_eq!((name.as_str(), output.as_str()), ("brick", "height"));
        assert_eq!(
            arguments[0],
            (Some("texcoord".to_owned()), Expr::Name("uv".to_owned()))
        );
    }
}
