//! Reference pages and the description for tools, both generated from the specs.

use std::fmt::Write as _;

use mipless_codegen::NodeDef;
use mipless_graph::{Default, OutputType, PortSpec, PortType};
use serde_json::{Map, Value, json};

/// The reference page of a node, in Markdown.
pub fn page(def: &NodeDef) -> String {
    let spec = def.spec;
    let mut out = format!("# {}\n\n{}\n\n", spec.name, spec.summary);
    let mut line = |text: std::fmt::Arguments<'_>| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{text}");
    };
    line(format_args!("Category: {}.", spec.category.name()));
    if !spec.aliases.is_empty() {
        line(format_args!("Also known as: {}.", spec.aliases.join(", ")));
    }
    line(format_args!(
        "\n## What it computes\n\n{}",
        spec.doc.computes
    ));
    line(format_args!("\n## Ports and parameters\n"));
    line(format_args!(
        "| port | type | default | range | unit | meaning |"
    ));
    line(format_args!("|---|---|---|---|---|---|"));
    for port in spec.inputs {
        let literal = if port.uniform { ", literal only" } else { "" };
        line(format_args!(
            "| `{}` | {}{literal} | {} | {} | {} | {} |",
            port.name,
            type_text(port),
            default_text(port),
            range_text(port),
            port.unit,
            port.doc
        ));
    }
    line(format_args!(
        "| `out` | {} | – | – | – | The result. |",
        output_text(spec.output)
    ));
    if let Some((_, names)) = spec.selector() {
        let parts = spec.material().map_or(&[][..], |(_, parts)| parts);
        for name in names {
            let part = parts.iter().find(|part| part.name == *name);
            let text = part.map_or(output_text(spec.output), |part| part.ty.name());
            let models = match part {
                Some(part) if !part.models.is_empty() => {
                    format!("By `{}`.", part.models.join("`, `"))
                }
                Some(_) => "By every model, where it is asked for.".to_owned(),
                None => format!("The result where `output` is `{name}`."),
            };
            line(format_args!("| `{name}` | {text} | – | – | – | {models} |"));
        }
    }
    line(format_args!("\n## Statistics\n\n{}", spec.doc.statistics));
    line(format_args!("\n## Accuracy\n\n{}", spec.doc.accuracy));
    line(format_args!(
        "\n## Example\n\n```json\n{}\n```",
        spec.example
    ));
    line(format_args!("\n## References\n\n{}", spec.doc.references));
    out
}

/// Whether a port holds numbers, which a range and a unit then describe.
fn is_numeric(port: &PortSpec) -> bool {
    match port.ty {
        PortType::Exactly(ty) => ty.components() > 0 && ty != mipless_graph::Type::Boolean,
        PortType::Any | PortType::Each | PortType::Own | PortType::Color => true,
        PortType::Choice(_) | PortType::Stops | PortType::Matrix => false,
    }
}

fn type_text(port: &PortSpec) -> String {
    match port.ty {
        PortType::Exactly(ty) => ty.name().to_owned(),
        PortType::Any | PortType::Own => "float, vector or colour".to_owned(),
        PortType::Color => "color3 or color4".to_owned(),
        PortType::Each => "float, or the type of the others".to_owned(),
        PortType::Choice(names) => names
            .iter()
            .map(|name| format!("`{name}`"))
            .collect::<Vec<_>>()
            .join(" or "),
        PortType::Stops => "list of stops".to_owned(),
        PortType::Matrix => "9 or 16 numbers".to_owned(),
    }
}

fn default_text(port: &PortSpec) -> String {
    match port.default {
        Default::Float(x) => format!("{x}"),
        Default::Integer(i) => format!("{i}"),
        Default::Boolean(flag) => format!("{flag}"),
        Default::Vector2(xy) => format!("{xy:?}"),
        Default::Color3(rgb) => format!("{rgb:?}"),
        Default::Choice(name) => format!("`{name}`"),
        Default::Text("") => "none".to_owned(),
        Default::Text(text) => format!("`{text}`"),
        Default::Stops(stops) => stops
            .iter()
            .map(|(at, x)| format!("{x} at {at}"))
            .collect::<Vec<_>>()
            .join(", "),
        Default::Surface => "the surface's uv".to_owned(),
        Default::Identity => "the identity".to_owned(),
    }
}

fn range_text(port: &PortSpec) -> String {
    if !is_numeric(port) {
        return "–".to_owned();
    }
    let range = &port.range;
    let mut text = match (range.min == f32::MIN, range.max == f32::MAX) {
        (true, true) => "any".to_owned(),
        (false, true) => format!("≥ {}", range.min),
        (true, false) => format!("≤ {}", range.max),
        (false, false) => format!("[{}, {}]", range.min, range.max),
    };
    if range.nonzero {
        text.push_str(", not 0");
    }
    text
}

fn output_text(output: OutputType) -> &'static str {
    match output {
        OutputType::Exactly(ty) => ty.name(),
        OutputType::Widest | OutputType::Whole => "the widest of the inputs'",
        OutputType::Named(_) => "the type that is named",
        OutputType::Joined => "the inputs' components together",
        OutputType::Colored => "that of the colour",
        OutputType::Stops => "that of the stops' values",
        OutputType::Picture { .. } => {
            "with a file the type that is named, else that of the stops' values"
        }
        OutputType::Material { .. } => "a material",
    }
}

/// The catalogue as data for tools: every port with its type, default, range and unit, every text
/// of the reference pages, and the examples as graphs.
pub fn describe(catalogue: &[NodeDef]) -> Value {
    let nodes: Map<String, Value> = catalogue
        .iter()
        .map(|def| (def.spec.name.to_owned(), describe_node(def)))
        .collect();
    json!({ "version": 1, "nodes": nodes })
}

fn describe_node(def: &NodeDef) -> Value {
    let spec = def.spec;
    let inputs: Map<String, Value> = spec
        .inputs
        .iter()
        .map(|port| (port.name.to_owned(), describe_port(port)))
        .collect();
    let output = match spec.output {
        OutputType::Exactly(ty) => ty.name(),
        OutputType::Widest | OutputType::Whole => "widest",
        OutputType::Named(_) => "named",
        OutputType::Joined => "joined",
        OutputType::Colored => "colored",
        OutputType::Stops => "stops",
        OutputType::Picture { .. } => "named or stops",
        OutputType::Material { .. } => "material",
    };
    let others = spec.selector().map_or(&[][..], |(_, names)| names);
    let parts = spec.material().map_or(&[][..], |(_, parts)| parts);
    let outputs: Map<String, Value> = (["out"].iter().chain(others))
        .map(|name| {
            let part = parts.iter().find(|part| part.name == *name);
            let described = match part {
                Some(part) => json!({ "type": part.ty.name(), "models": part.models }),
                None => json!({ "type": output }),
            };
            ((*name).to_owned(), described)
        })
        .collect();
    // An example that is no JSON would fail the tests; tools then get its text.
    let example: Value =
        serde_json::from_str(spec.example).unwrap_or_else(|_| Value::from(spec.example));
    json!({
        "category": spec.category.name(),
        "aliases": spec.aliases,
        "summary": spec.summary,
        "inputs": inputs,
        "outputs": outputs,
        "doc": {
            "computes": spec.doc.computes,
            "statistics": spec.doc.statistics,
            "accuracy": spec.doc.accuracy,
            "references": spec.doc.references,
        },
        "example": example,
    })
}

fn describe_port(port: &PortSpec) -> Value {
    let mut out = Map::new();
    let mut set = |key: &str, value: Value| out.insert(key.to_owned(), value);
    match port.ty {
        PortType::Exactly(ty) => set("type", json!(ty.name())),
        PortType::Any => set("type", json!("any")),
        PortType::Each => set("type", json!("each")),
        PortType::Own => set("type", json!("own")),
        PortType::Color => set("type", json!("color")),
        PortType::Choice(names) => {
            set("type", json!("string"));
            set("enum", json!(names))
        }
        PortType::Stops => set("type", json!("stops")),
        PortType::Matrix => set("type", json!("matrix")),
    };
    set(
        "default",
        match port.default {
            Default::Float(x) => number(x),
            Default::Integer(i) => json!(i),
            Default::Boolean(flag) => json!(flag),
            Default::Vector2(xy) => xy.into_iter().map(number).collect(),
            Default::Color3(rgb) => rgb.into_iter().map(number).collect(),
            Default::Choice(text) | Default::Text(text) => json!(text),
            Default::Stops(stops) => (stops.iter())
                .map(|&(at, value)| json!({ "at": number(at), "value": number(value) }))
                .collect(),
            Default::Identity => json!("identity"),
            Default::Surface => json!({ "surface": "texcoord" }),
        },
    );
    set("uniform", json!(port.uniform));
    if is_numeric(port) {
        let range = &port.range;
        if range.min != f32::MIN {
            set("min", number(range.min));
        }
        if range.max != f32::MAX {
            set("max", number(range.max));
        }
        set("soft_min", number(range.soft_min));
        set("soft_max", number(range.soft_max));
        set("nonzero", json!(range.nonzero));
        set("unit", json!(port.unit));
    }
    set("doc", json!(port.doc));
    Value::Object(out)
}

/// A number with the digits that an f32 has.
fn number(x: f32) -> Value {
    x.to_string()
        .parse::<f64>()
        .map_or(Value::Null, |x| json!(x))
}
