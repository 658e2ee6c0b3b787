//! Material Maker documents (`.ptex`): nodes whose ports are functions of the coordinate, so that
//! they are converted backwards, from the material to its sources, with the coordinate as an
//! argument.

mod call;
mod code;
mod graph;
mod parameter;

use crate::build::{Builder, Refusal};
use crate::json::Json;
use crate::materialx::literal;
use crate::place::{Findings, Place, Source};
use crate::rule::{Expr, Rules};
use crate::surface;
use crate::value::{Literal, Value};
use crate::{Imported, Options, Output};
use call::NodeCall;
use code::Code;
use graph::Graphs;
use mipless_graph::{Diagnostic, NodeSpec, Reference, Type};
use rustc_hash::FxHashMap;
use std::collections::HashMap;
use std::sync::OnceLock;

/// The signatures of nodes, and what they become.
const NODES: &str = include_str!("materialmaker/nodes.txt");
const RULES: &str = include_str!("materialmaker/rules.txt");

/// The ports of a material, and whether their numbers are colours as a display shows them.
const PORTS: [(&str, &str, bool); 9] = [
    ("albedo", "rgb", true),
    ("metallic", "f", false),
    ("roughness", "f", false),
    ("emission", "rgb", true),
    ("normal", "rgb", false),
    ("ao", "f", false),
    ("depth", "f", false),
    ("opacity", "f", false),
    ("sss", "f", false),
];

/// What the material multiplies its ports by: inputs of the shader, and its parameters.
const FACTORS: [(&str, &str); 4] = [
    ("albedo_color", "albedo_color"),
    ("metallic_scale", "metallic"),
    ("roughness_scale", "roughness"),
    ("emission_energy", "emission_energy"),
];

/// How deep nodes may follow each other, and how often they are looked at: a warp of a warp asks
/// everything at sixteen places.
const DEEPEST: usize = 1_000;
const MOST: usize = 200_000;

/// The stack of the thread that converts: nodes are followed by recursion, to a limit.
const STACK: usize = 512 << 20;

/// An input of a node.
#[derive(Debug)]
struct Port {
    name: String,
    ty: String,
    default: Expr,
}

/// The ports of a node.
#[derive(Debug)]
struct Signature {
    inputs: Vec<Port>,
    outputs: Vec<String>,
}

fn rules() -> &'static Rules {
    static PARSED: OnceLock<Rules> = OnceLock::new();
    PARSED.get_or_init(|| Rules::parse(RULES))
}

fn signatures() -> &'static HashMap<String, Signature> {
    static PARSED: OnceLock<HashMap<String, Signature>> = OnceLock::new();
    PARSED.get_or_init(|| {
        let lines = NODES.lines().filter(|line| !line.starts_with('#'));
        let parsed = lines.map(|line| {
            let mut parts = line.split('|').map(str::trim);
            let mut part = || parts.next().unwrap_or("");
            let (name, inputs, outputs) = (part(), part(), part());
            let inputs = inputs
                .split(';')
                .map(str::trim)
                .filter(|input| !input.is_empty());
            let inputs = inputs.map(|input| {
                let (port, default) = input.split_once(" = ").expect("an input has a default");
                let (name, ty) = port.split_once(':').expect("an input has a type");
                Port {
                    name: name.to_owned(),
                    ty: ty.to_owned(),
                    default: Rules::expression(default),
                }
            });
            let signature = Signature {
                inputs: inputs.collect(),
                outputs: outputs.split_whitespace().map(str::to_owned).collect(),
            };
            (name.to_owned(), signature)
        });
        parsed.collect()
    })
}

/// Reads a document.
pub(crate) fn import(name: &str, text: &str, options: &Options<'_>) -> Imported {
    let specs = options.specs;
    let convert = || on_a_large_stack(name, text, specs);
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new()
            .stack_size(STACK)
            .spawn_scoped(scope, convert);
        match thread.map(std::thread::ScopedJoinHandle::join) {
            Ok(Ok(imported)) => imported,
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(error) => {
                let mut findings = Findings::default();
                findings
                    .sources
                    .push(Source::new(name.to_owned(), text.to_owned()));
                let message = format!("there is no room to convert it: {error}");
                say(&mut findings, 0, "", &Refusal::new("import-limit", message));
                Imported::nothing(findings)
            }
        }
    })
}

fn on_a_large_stack(name: &str, text: &str, specs: &[&'static NodeSpec]) -> Imported {
    let mut findings = Findings::default();
    findings
        .sources
        .push(Source::new(name.to_owned(), text.to_owned()));
    let json = match Json::parse(text) {
        Ok(json) => json,
        Err((offset, refusal)) => {
            say(&mut findings, offset, "", &refusal);
            return Imported::nothing(findings);
        }
    };
    let graphs = Graphs::read(&json);
    let Some((material, place)) = graphs.material() else {
        let message = "the document has no node `material`, which says what is shown";
        say(
            &mut findings,
            json.offset,
            "",
            &Refusal::new("import-empty", message),
        );
        return Imported::nothing(findings);
    };
    let mut maker = Maker {
        graphs,
        builder: Builder::new(specs),
        findings,
        done: FxHashMap::default(),
        depth: 0,
        count: 0,
    };
    let mut outputs = Vec::new();
    let mut given = Vec::new();
    for (port, (name, ty, encoded)) in PORTS.iter().enumerate() {
        let Some(source) = maker.graphs.source(0, &material, port) else {
            continue;
        };
        let made = maker.output(&source, ty, *encoded);
        let loads = made.is_ok();
        match made {
            Ok(value) => given.push(((*name).to_owned(), value)),
            Err(refusal) => maker.refuse(&place, &refusal),
        }
        outputs.push(Output {
            name: (*name).to_owned(),
            source: format!("{material}/{name}"),
            loads,
        });
    }
    if let Err(refusal) = maker.material(&material, &place, given) {
        maker.refuse(&place, &refusal);
        outputs.iter_mut().for_each(|output| output.loads = false);
    }
    if outputs.is_empty() {
        let message = "nothing is connected to the material";
        maker.refuse(&place, &Refusal::new("import-empty", message));
    }
    Imported::new(maker.builder, outputs, maker.findings)
}

fn say(findings: &mut Findings, offset: usize, path: &str, refusal: &Refusal) {
    let place = Place {
        file: 0,
        offset,
        path: path.to_owned(),
    };
    findings.say(
        &place,
        Diagnostic::error(refusal.code, refusal.message.clone()),
    );
}

/// The code of a failure that was told where it began.
const CONSEQUENCE: &str = "import-consequence";

/// A port of a node in a graph.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct PortOf {
    graph: usize,
    node: String,
    port: usize,
}

/// Converts.
struct Maker<'a> {
    graphs: Graphs<'a>,
    builder: Builder,
    findings: Findings,
    /// What ports give, by coordinate, and whether it is their alpha.
    done: FxHashMap<(PortOf, String, bool), Result<Value, ()>>,
    depth: usize,
    count: usize,
}

impl Maker<'_> {
    fn refuse(&mut self, place: &Place, refusal: &Refusal) {
        if refusal.code != CONSEQUENCE {
            let diagnostic = Diagnostic::error(refusal.code, refusal.message.clone());
            self.findings.say(place, diagnostic);
        }
    }

    /// The outputs that show what is connected to the material: parts of a surface, where it has them.
    fn material(
        &mut self,
        name: &str,
        place: &Place,
        mut given: Vec<(String, Value)>,
    ) -> Result<(), Refusal> {
        let shader =
            surface::shader("material").filter(|_| self.builder.spec(surface::NODE).is_some());
        let connected = given.clone();
        for (input, parameter) in FACTORS {
            let Some(json) = self.graphs.parameter(0, name, parameter) else {
                continue;
            };
            let placeholder = Builder::new(&[]);
            let mut builder = std::mem::replace(&mut self.builder, placeholder);
            let value = parameter::value(self, &mut builder, 0, json, 0);
            self.builder = builder;
            let value = match value? {
                // A colour is one of a display.
                Value::Literal(color @ Literal::Numbers(Type::Color3, _)) => {
                    Value::Literal(literal::linear(color, "srgb_texture")?)
                }
                value => value,
            };
            given.push((input.to_owned(), value));
        }
        self.builder.place = Some(place.clone());
        surface::NODE.clone_into(&mut self.builder.hint);
        let made = match shader {
            Some(shader) if !connected.is_empty() => {
                Some((shader, shader.node(&mut self.builder, &given)?))
            }
            _ => None,
        };
        for (name, value) in connected {
            let part = made.as_ref().and_then(|(shader, node)| {
                let (part, shown) = shader.part(&name).filter(|_| name != "normal")?;
                Some((shown.to_owned(), part.to_owned(), node.clone()))
            });
            match part {
                Some((shown, part, node)) => {
                    let part = Reference {
                        output: part,
                        ..node
                    };
                    self.builder.read(&shown, part);
                }
                None => self.builder.output(&name, value)?,
            }
        }
        Ok(())
    }

    /// What an output of the material shows.
    fn output(&mut self, source: &PortOf, ty: &str, encoded: bool) -> Result<Value, Refusal> {
        let uv = self.builder.node("texcoord", Vec::new(), "out")?;
        let value = self.port(source, &uv, false)?;
        let value = self.typed(value, ty)?;
        let value = if ty == "rgb" {
            self.builder.converted(value, Type::Color3)?
        } else {
            value
        };
        if !encoded {
            return Ok(value);
        }
        let rule = rules().get("decoded").ok_or_else(|| {
            Refusal::new("import-rule", "there is no rule for colours of a display")
        })?;
        self.builder.hint = "linear".to_owned();
        let mut call = Decoding(value);
        let decoded = crate::eval::eval(rule, &mut self.builder, &mut call)?;
        self.builder.converted(decoded, Type::Color3)
    }

    /// A value as a port of a type reads it: a number of a colour is the mean of its channels.
    fn typed(&mut self, value: Value, ty: &str) -> Result<Value, Refusal> {
        let wide = value.ty().map_or(0, Type::components);
        if ty != "f" || wide <= 1 {
            return Ok(value);
        }
        let third = Value::float(1.0 / 3.0);
        let mut sum = self.builder.part(&value, 0)?;
        for i in 1..wide.min(3) {
            let part = self.builder.part(&value, i)?;
            let inputs = vec![("in1".to_owned(), sum), ("in2".to_owned(), part)];
            sum = self.folded("add", inputs)?;
        }
        let inputs = vec![("in1".to_owned(), sum), ("in2".to_owned(), third)];
        self.folded("multiply", inputs)
    }

    /// A node, worked out where its inputs are literals.
    fn folded(&mut self, name: &str, inputs: Vec<(String, Value)>) -> Result<Value, Refusal> {
        let numbers: Option<Vec<f64>> = (inputs.iter())
            .map(|(_, value)| match value {
                Value::Literal(literal) => literal.numbers().first().copied(),
                Value::Link(_) => None,
            })
            .collect();
        match (name, numbers.as_deref()) {
            ("add", Some([a, b])) => Ok(Value::float(a + b)),
            ("multiply", Some([a, b])) => Ok(Value::float(a * b)),
            _ => self.builder.node(name, inputs, "out"),
        }
    }

    /// What a port of a node gives at a coordinate.
    fn port(&mut self, port: &PortOf, uv: &Value, alpha: bool) -> Result<Value, Refusal> {
        let key = (port.clone(), format!("{uv:?}"), alpha);
        if let Some(value) = self.done.get(&key) {
            return value.clone().map_err(|()| Refusal::new(CONSEQUENCE, ""));
        }
        self.count += 1;
        let value = if self.depth >= DEEPEST {
            let message =
                format!("nodes follow each other more than {DEEPEST} deep, or in a circle");
            Err(Refusal::new("import-limit", message))
        } else if self.count > MOST {
            let message = format!("nodes are read at more than {MOST} places");
            Err(Refusal::new("import-limit", message))
        } else {
            self.depth += 1;
            let value = self.made(port, uv, alpha);
            self.depth -= 1;
            value
        };
        let place = self.graphs.place(port.graph, &port.node);
        for note in std::mem::take(&mut self.builder.notes) {
            self.findings
                .say(&place, Diagnostic::note("import-approximated", note));
        }
        if let Err(refusal) = &value {
            let named = match self.graphs.kind(port.graph, &port.node) {
                Some(kind) if refusal.code != CONSEQUENCE => Refusal {
                    message: format!("Material Maker node `{kind}`: {}", refusal.message),
                    ..refusal.clone()
                },
                _ => refusal.clone(),
            };
            self.refuse(&place, &named);
        }
        self.done.insert(key, value.clone().map_err(drop));
        value.map_err(|_| Refusal::new(CONSEQUENCE, ""))
    }

    fn made(&mut self, port: &PortOf, uv: &Value, alpha: bool) -> Result<Value, Refusal> {
        let missing = || {
            Refusal::new(
                "import-reference",
                format!("there is no node `{}`", port.node),
            )
        };
        let kind = self
            .graphs
            .kind(port.graph, &port.node)
            .ok_or_else(missing)?
            .to_owned();
        let nothing = if alpha { 1.0 } else { 0.0 };
        let through = match kind.as_str() {
            "graph" => self.graphs.inside(port),
            "ios" => self.graphs.outside(port),
            "switch" => Some(self.graphs.switched(port)),
            _ => None,
        };
        if let Some(source) = through {
            return match source {
                Some(source) => self.port(&source, uv, alpha),
                None => Ok(Value::float(nothing)),
            };
        }
        // What the node's author wrote is a rule of its own, if it is one expression.
        let own = if kind == "shader" {
            let node = self.graphs.node(port.graph, &port.node);
            let code = node.and_then(|node| Code::read(node, port.port, alpha));
            Some(code.ok_or_else(|| {
                let message = "it is code that its author wrote, which is not run here";
                Refusal::new("import-foreign-code", message)
            })?)
        } else {
            None
        };
        let rules = rules();
        let (rule, signature) = match &own {
            Some(code) => (&code.rule, Some(&code.signature)),
            None if alpha => match rules.get(&format!("{kind}.alpha")) {
                Some(rule) => (rule, signatures().get(&kind)),
                None => return Ok(Value::float(1.0)),
            },
            None => {
                let several = format!("{kind}.{}", port.port);
                let rule = rules.get(&several).or_else(|| rules.get(&kind));
                let rule = rule.ok_or_else(|| {
                    Refusal::new("import-node-missing", "there is no such node here")
                })?;
                (rule, signatures().get(&kind))
            }
        };
        let place = self.graphs.place(port.graph, &port.node);
        let hint = place.path.trim_start_matches('/').replace('/', "_");
        self.builder.hint.clone_from(&hint);
        self.builder.place = Some(place.clone());
        let placeholder = Builder::new(&[]);
        let mut builder = std::mem::replace(&mut self.builder, placeholder);
        let mut call = NodeCall {
            maker: self,
            port,
            kind: &kind,
            signature,
            uv: uv.clone(),
            hint,
            place,
        };
        let value = crate::eval::eval(rule, &mut builder, &mut call);
        self.builder = builder;
        let value = value?;
        let ty = signature.and_then(|signature| signature.outputs.get(port.port));
        match ty.map(String::as_str) {
            Some("f") if !alpha => self.typed(value, "f"),
            _ => Ok(value),
        }
    }
}

/// The colours of a display, which become linear.
struct Decoding(Value);

impl crate::eval::Call for Decoding {
    fn input(&mut self, _: &mut Builder, _: &str, _: Option<&Value>) -> Result<Value, Refusal> {
        Ok(self.0.clone())
    }

    fn is_given(&self, _: &str) -> bool {
        true
    }

    fn coordinate(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        builder.node("texcoord", Vec::new(), "out")
    }

    fn output(&self) -> (Type, &str) {
        (Type::Color3, "out")
    }
}

/// An input of the graph, a number.
fn input(builder: &mut Builder, name: &str) -> Value {
    let entry = mipless_graph::InputEntry {
        ty: "float".to_owned(),
        value: Literal::float(0.0).to_json(),
        ..mipless_graph::InputEntry::default()
    };
    builder.input(name, entry, Type::Float)
}
