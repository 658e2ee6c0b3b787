//! Shaders that are one expression: the arithmetic of GLSL, as an expression of the rules.
//!
//! An author's own node whose outputs are expressions of its inputs and parameters is as good as a
//! rule. Statements, functions of its own, choices and textures are foreign code.

use super::{Port, Signature};
use crate::json::{Content, Json};
use crate::rule::Expr;

/// How deep expressions nest, and how long they are.
const DEEPEST: usize = 64;
const LONGEST: usize = 10_000;

/// A node's own signature and its output, or nothing where there is more to it than expressions.
#[derive(Debug)]
pub(super) struct Code {
    pub(super) signature: Signature,
    pub(super) rule: Expr,
}

impl Code {
    /// An output of a shader node, or its alpha.
    pub(super) fn read(node: &Json, output: usize, alpha: bool) -> Option<Self> {
        let model = node.get("shader_model")?;
        let silent = |key: &str| match model.get(key) {
            None => true,
            Some(json) => match &json.value {
                Content::Text(text) => text.trim().is_empty(),
                Content::List(lines) => lines.iter().all(|line| line.text() == Some("")),
                _ => false,
            },
        };
        if !["code", "global", "instance"].into_iter().all(silent) {
            return None;
        }
        let parameters = model.get("parameters").map_or(&[][..], Json::items);
        // Choices and truth values put other code into an expression.
        let plain = |parameter: &Json| {
            let ty = parameter.get("type").and_then(Json::text);
            matches!(ty, Some("float" | "color" | "size"))
        };
        if !parameters.iter().all(plain) {
            return None;
        }
        let mut inputs = Vec::new();
        for input in model.get("inputs").map_or(&[][..], Json::items) {
            let (name, ty) = (input.get("name")?.text()?, input.get("type")?.text()?);
            if !matches!(ty, "f" | "rgb" | "rgba") {
                return None;
            }
            let default = input.get("default").and_then(Json::text).unwrap_or("0.0");
            inputs.push(Port {
                name: name.to_owned(),
                ty: ty.to_owned(),
                default: expression(default, &[], &[], false)?,
            });
        }
        let outputs = model.get("outputs").map_or(&[][..], Json::items);
        let types: Option<Vec<&str>> = outputs
            .iter()
            .map(|output| output.get("type")?.text())
            .collect();
        let types = types?;
        let ty = *types.get(output)?;
        let text = outputs.get(output)?.get(ty)?.text()?;
        let colors: Vec<&str> = (parameters.iter())
            .filter(|parameter| parameter.get("type").and_then(Json::text) == Some("color"))
            .filter_map(|parameter| parameter.get("name")?.text())
            .collect();
        let names: Vec<(&str, &str)> = (inputs.iter())
            .map(|port| (port.name.as_str(), port.ty.as_str()))
            .collect();
        let rule = match (alpha, ty) {
            (true, "rgba") => expression(text, &names, &colors, true)?,
            (true, _) => Expr::Number(1.0),
            (false, "f" | "rgb" | "rgba") => expression(text, &names, &colors, false)?,
            _ => return None,
        };
        Some(Self {
            signature: Signature {
                inputs,
                outputs: types.into_iter().map(str::to_owned).collect(),
            },
            rule,
        })
    }
}

/// The expression that a text is, or its fourth component.
/// `inputs` are names and types, `colors` the parameters that are colours.
fn expression(text: &str, inputs: &[(&str, &str)], colors: &[&str], alpha: bool) -> Option<Expr> {
    if text.len() > LONGEST {
        return None;
    }
    let mut parser = Parser {
        rest: text.trim_start(),
        inputs,
        colors,
        alpha,
        depth: 0,
    };
    let expr = parser.sum()?;
    parser.rest.is_empty().then_some(expr)
}

struct Parser<'t> {
    rest: &'t str,
    inputs: &'t [(&'t str, &'t str)],
    colors: &'t [&'t str],
    /// Whether it is the fourth component that is wanted.
    alpha: bool,
    depth: usize,
}

fn call(name: &str, arguments: Vec<(Option<&str>, Expr)>) -> Expr {
    Expr::Call {
        name: name.to_owned(),
        arguments: (arguments.into_iter())
            .map(|(key, expr)| (key.map(str::to_owned), expr))
            .collect(),
        output: "out".to_owned(),
    }
}

fn part(of: Expr, index: usize) -> Expr {
    call("part", vec![(None, of), (None, Expr::Number(index as f64))])
}

impl<'t> Parser<'t> {
    fn take(&mut self, wanted: char) -> bool {
        match self.rest.strip_prefix(wanted) {
            Some(rest) => {
                self.rest = rest.trim_start();
                true
            }
            None => false,
        }
    }

    fn word(&mut self) -> &'t str {
        let belongs = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = self.rest.find(|c| !belongs(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest.trim_start();
        word
    }

    fn sum(&mut self) -> Option<Expr> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let mut left = self.product()?;
        while let Some(operator @ ('+' | '-')) = self.rest.chars().next() {
            self.take(operator);
            left = Expr::Binary(operator, Box::new(left), Box::new(self.product()?));
        }
        self.depth -= 1;
        Some(left)
    }

    fn product(&mut self) -> Option<Expr> {
        let mut left = self.factor()?;
        loop {
            let operator = match self.rest.chars().next() {
                Some(operator @ ('*' | '/')) => operator,
                _ => return Some(left),
            };
            self.take(operator);
            left = Expr::Binary(operator, Box::new(left), Box::new(self.factor()?));
        }
    }

    fn factor(&mut self) -> Option<Expr> {
        let negative = self.take('-');
        let mut expr = self.atom()?;
        while self.take('.') {
            expr = self.swizzled(expr)?;
        }
        Some(if negative {
            Expr::Negated(Box::new(expr))
        } else {
            expr
        })
    }

    /// Components by their letters.
    fn swizzled(&mut self, of: Expr) -> Option<Expr> {
        let letters = self.word();
        let places: Option<Vec<usize>> = letters
            .chars()
            .map(|c| match c {
                'x' | 'r' => Some(0),
                'y' | 'g' => Some(1),
                'z' | 'b' => Some(2),
                // Alpha stands apart from the colour.
                _ => None,
            })
            .collect();
        let parts: Vec<Expr> = places?.into_iter().map(|i| part(of.clone(), i)).collect();
        match parts.len() {
            1 => parts.into_iter().next(),
            2 => Some(Expr::List(parts)),
            3 => Some(call(
                "rgb",
                parts.into_iter().map(|part| (None, part)).collect(),
            )),
            _ => None,
        }
    }

    fn arguments(&mut self) -> Option<Vec<Expr>> {
        let mut arguments = Vec::new();
        loop {
            arguments.push(self.sum()?);
            if self.take(')') {
                return Some(arguments);
            }
            if !self.take(',') {
                return None;
            }
        }
    }

    /// Numbers of a coordinate or a colour, whichever part is wanted of the whole.
    fn whole<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        let alpha = std::mem::replace(&mut self.alpha, false);
        let value = read(self);
        self.alpha = alpha;
        value
    }

    fn atom(&mut self) -> Option<Expr> {
        if self.take('(') {
            let inner = self.sum()?;
            return self.take(')').then_some(inner);
        }
        if self.take('$') {
            return self.named();
        }
        if self
            .rest
            .starts_with(|c: char| c.is_ascii_digit() || c == '.')
        {
            let end = self.rest.find(|c: char| !c.is_ascii_digit() && c != '.');
            let (digits, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
            self.rest = rest.trim_start();
            return digits.parse().ok().map(Expr::Number);
        }
        let name = self.word();
        if name.is_empty() || !self.take('(') {
            return None;
        }
        if name == "vec4" && self.alpha {
            // The last number is the alpha; those of the colour are left.
            let mut arguments = self.whole(Self::arguments)?;
            return arguments.pop();
        }
        let arguments = self.arguments()?;
        made(name, arguments)
    }

    /// The coordinate, an input at one, or a parameter.
    fn named(&mut self) -> Option<Expr> {
        let braced = self.take('(');
        let name = self.word();
        if braced && !self.take(')') {
            return None;
        }
        if name == "uv" {
            return Some(Expr::Name("uv".to_owned()));
        }
        if let Some((_, ty)) = self.inputs.iter().find(|(own, _)| *own == name) {
            if !self.take('(') {
                return None;
            }
            let at = self.whole(Self::sum)?;
            if !self.take(')') {
                return None;
            }
            // A number stands for all components.
            return Some(if self.alpha && *ty != "f" {
                let text = Expr::Text(name.to_owned());
                call("alpha", vec![(None, text), (None, at)])
            } else {
                Expr::Port(name.to_owned(), Some(Box::new(at)))
            });
        }
        if matches!(name, "" | "time" | "seed" | "name" | "name_uv") {
            return None;
        }
        Some(if self.alpha && self.colors.contains(&name) {
            call("alpha", vec![(None, Expr::Text(name.to_owned()))])
        } else {
            Expr::Port(name.to_owned(), None)
        })
    }
}

/// A function of GLSL.
fn made(name: &str, arguments: Vec<Expr>) -> Option<Expr> {
    let count = arguments.len();
    let mut next = arguments.into_iter();
    let mut first = || next.next();
    let one = |node: &str, a: Expr| call(node, vec![(Some("in"), a)]);
    Some(match (name, count) {
        ("vec2", 1) => {
            let a = first()?;
            Expr::List(vec![a.clone(), a])
        }
        ("vec2", 2) => Expr::List(vec![first()?, first()?]),
        ("vec3", 1) => call(
            "as",
            vec![(None, Expr::Text("color3".to_owned())), (None, first()?)],
        ),
        ("vec3" | "vec4", 3 | 4) => call(
            "rgb",
            vec![(None, first()?), (None, first()?), (None, first()?)],
        ),
        ("vec4", 1 | 2) => call(
            "as",
            vec![(None, Expr::Text("color3".to_owned())), (None, first()?)],
        ),
        ("sin" | "cos", 1) => call(name, vec![(None, first()?)]),
        (
            "tan" | "floor" | "ceil" | "fract" | "sqrt" | "exp" | "sign" | "round" | "normalize",
            1,
        ) => one(name, first()?),
        ("abs", 1) => one("absval", first()?),
        ("log", 1) => one("ln", first()?),
        ("length", 1) => one("magnitude", first()?),
        ("min" | "max", 2) => call(name, vec![(Some("in1"), first()?), (Some("in2"), first()?)]),
        ("pow", 2) => call("pow", vec![(None, first()?), (None, first()?)]),
        ("mod", 2) => call(
            "modulo",
            vec![(Some("in1"), first()?), (Some("in2"), first()?)],
        ),
        ("atan", 2) => call(
            "atan2",
            vec![(Some("iny"), first()?), (Some("inx"), first()?)],
        ),
        ("dot", 2) => call(
            "dotproduct",
            vec![(Some("in1"), first()?), (Some("in2"), first()?)],
        ),
        ("distance", 2) => call(
            "distance",
            vec![(Some("in1"), first()?), (Some("in2"), first()?)],
        ),
        ("mix", 3) => call(
            "mix",
            vec![
                (Some("bg"), first()?),
                (Some("fg"), first()?),
                (Some("mix"), first()?),
            ],
        ),
        ("clamp", 3) => call(
            "clamp",
            vec![
                (Some("in"), first()?),
                (Some("low"), first()?),
                (Some("high"), first()?),
            ],
        ),
        ("step", 2) => call(
            "step",
            vec![(Some("edge"), first()?), (Some("in"), first()?)],
        ),
        ("smoothstep", 3) => call(
            "smoothstep",
            vec![
                (Some("low"), first()?),
                (Some("high"), first()?),
                (Some("in"), first()?),
            ],
        ),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::expression;
    use crate::rule::Rules;

    const INPUTS: [(&str, &str); 2] = [("in", "rgba"), ("d", "f")];

    #[test]
    fn expressions_of_glsl_are_expressions_of_rules() {
        let same = |glsl: &str, rule: &str| {
            assert_eq!(
                expression(glsl, &INPUTS, &["c1", "c2"], false),
                Some(Rules::expression(rule)),
                "{glsl}"
            );
        };
        same(
            "mix($c1, $c2, $in($uv))",
            "mix(bg: $c1, fg: $c2, mix: $in(uv))",
        );
        same(
            "$in($uv+$a*vec2(1.0, 0.0)).x",
            "part($in(uv + $a * [1, 0]), 0)",
        );
        same(
            "-2.0*(0.5 - $d(fract($uv)))",
            "-2 * (0.5 - $d(fract(in: uv)))",
        );
        assert_eq!(
            expression(
                "mix($c, vec4($in($uv), $d($uv)), $k)",
                &INPUTS,
                &["c"],
                true
            ),
            Some(Rules::expression(
                "mix(bg: alpha(\"c\"), fg: $d(uv), mix: $k)"
            ))
        );
        for foreign in [
            "$in($uv) > 0.5 ? 1.0 : 0.0",
            "texture(t, $uv)",
            "f($uv",
            "",
            "1.0.0",
            "$in",
        ] {
            assert_eq!(expression(foreign, &INPUTS, &[], false), None, "{foreign}");
        }
        let deep = "(".repeat(1_000);
        assert_eq!(expression(&deep, &[], &[], false), None);
    }
}
