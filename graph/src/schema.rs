//! The JSON Schema (draft 2020-12) of documents, generated from the node specs, for editors that
//! complete and check while somebody types.

use serde_json::{Map, Value, json};

use crate::{Category, Default, NodeSpec, OutputType, PortSpec, PortType, Type, VERSION};

/// The schema of documents that use these nodes.
pub fn schema(specs: &[&'static NodeSpec]) -> Value {
    let mut branches: Vec<Value> = Vec::with_capacity(specs.len() + 1);
    let mut names = Vec::with_capacity(specs.len());
    let mut definitions = definitions();
    for spec in specs {
        names.push(json!({ "const": spec.name, "description": spec.summary }));
        let key = format!("node.{}", spec.name);
        branches.push(json!({
            "if": { "properties": { "type": { "const": spec.name } }, "required": ["type"] },
            "then": { "$ref": format!("#/$defs/{key}") },
        }));
        definitions.insert(key, node(spec));
    }
    names.push(json!({
        "type": "string", "pattern": "^graph:", "description": "A sub-graph of this document.",
    }));
    definitions.insert(
        "node".to_owned(),
        json!({
            "type": "object",
            "required": ["type"],
            "additionalProperties": false,
            "properties": {
                "type": { "description": "The node type.", "anyOf": names },
                "inputs": { "type": "object", "description": "What is not written holds its default." },
                "doc": { "type": "string", "description": "What the node is for." },
                "extra": { "description": "Whatever an editor wants to keep." },
            },
            "allOf": branches,
        }),
    );
    let mut properties = body_properties();
    properties.insert("$schema".to_owned(), json!({ "type": "string" }));
    properties.insert("version".to_owned(), json!({ "const": VERSION }));
    let name = "The generated functions are named after it; without it, after the file.";
    properties.insert(
        "name".to_owned(),
        json!({ "type": "string", "description": name }),
    );
    properties.insert(
        "graphs".to_owned(),
        json!({
            "type": "object",
            "description": "Sub-graphs, used as node type graph:NAME.",
            "additionalProperties": { "$ref": "#/$defs/graph" },
        }),
    );
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Mipless texture graph",
        "type": "object",
        "required": ["version", "nodes", "outputs"],
        "additionalProperties": false,
        "properties": properties,
        "$defs": definitions,
    })
}

/// The keys of graphs and sub-graphs.
fn body_properties() -> Map<String, Value> {
    let properties = json!({
        "doc": { "type": "string", "description": "What the graph is." },
        "inputs": {
            "type": "object",
            "description": "What may be set from outside, live.",
            "additionalProperties": { "$ref": "#/$defs/input" },
        },
        "nodes": { "type": "object", "additionalProperties": { "$ref": "#/$defs/node" } },
        "outputs": {
            "type": "object",
            "minProperties": 1,
            "additionalProperties": { "$ref": "#/$defs/connection" },
        },
        "extra": { "description": "Whatever an editor wants to keep." },
    });
    match properties {
        Value::Object(properties) => properties,
        _ => Map::new(),
    }
}

/// The definitions that do not depend on the nodes.
fn definitions() -> Map<String, Value> {
    let mut definitions = Map::new();
    let mut put = |name: &str, value: Value| definitions.insert(name.to_owned(), value);
    put(
        "connection",
        json!({
            "type": "object",
            "description": "The output of a node.",
            "required": ["node"],
            "additionalProperties": false,
            "properties": {
                "node": { "type": "string" },
                "output": { "type": "string", "default": "out" },
            },
        }),
    );
    put(
        "interface",
        json!({
            "type": "object",
            "description": "An input of the graph.",
            "required": ["input"],
            "additionalProperties": false,
            "properties": { "input": { "type": "string" } },
        }),
    );
    let color = "sRGB; linear Rec. 709 as numbers.";
    put(
        "color",
        json!({ "type": "string", "description": color, "pattern": "^#([0-9a-fA-F]{6}|[0-9a-fA-F]{8})$" }),
    );
    put(
        "signal",
        json!({
            "anyOf": [
                { "type": "number" },
                { "type": "array", "items": { "type": "number" }, "minItems": 1, "maxItems": 4 },
                { "$ref": "#/$defs/color" },
            ],
        }),
    );
    put(
        "stops",
        json!({
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "required": ["at", "value"],
                "additionalProperties": false,
                "properties": {
                    "at": { "type": "number" },
                    "value": { "$ref": "#/$defs/signal" },
                },
            },
        }),
    );
    let types = Type::ALL
        .into_iter()
        .filter(|ty| ty.components() > 0)
        .map(Type::name);
    let types: Vec<&str> = types.collect();
    put(
        "input",
        json!({
            "type": "object",
            "required": ["type", "value"],
            "additionalProperties": false,
            "properties": {
                "type": { "enum": types },
                "value": { "anyOf": [{ "$ref": "#/$defs/signal" }, { "type": "boolean" }] },
                "min": { "type": "number", "description": "The smallest value that may be set." },
                "max": { "type": "number", "description": "The largest value that may be set." },
                "soft_min": { "type": "number", "description": "Where a slider starts." },
                "soft_max": { "type": "number", "description": "Where a slider ends." },
                "doc": { "type": "string" },
                "extra": {},
            },
        }),
    );
    put(
        "graph",
        json!({
            "type": "object",
            "required": ["nodes", "outputs"],
            "additionalProperties": false,
            "properties": body_properties(),
        }),
    );
    definitions
}

fn node(spec: &NodeSpec) -> Value {
    let ports = spec
        .inputs
        .iter()
        .map(|input| (input.name.to_owned(), port(input)));
    let ports: Map<String, Value> = ports.collect();
    let output = match spec.output {
        OutputType::Exactly(ty) => ty.name(),
        OutputType::Widest | OutputType::Whole => "the widest of the inputs",
        OutputType::Named(_) => "the type that is named",
        OutputType::Joined => "the inputs' components together",
        OutputType::Colored => "the type of the colour",
        OutputType::Stops => "the type of the stops",
        OutputType::Picture { .. } => "the type that is named, or that of the stops",
        OutputType::Material { .. } => "the parts of a material, each an output of the graph",
    };
    let category: Category = spec.category;
    let description = format!("{} ({}; out: {output})", spec.summary, category.name());
    json!({
        "description": description,
        "properties": {
            "inputs": {
                "type": "object",
                "additionalProperties": false,
                "properties": ports,
            },
        },
    })
}

fn port(port: &PortSpec) -> Value {
    let bounds = |mut value: Value| {
        // A soft range is the editor's matter, and JSON Schema has no word for it.
        if port.range.min > f32::MIN {
            value["minimum"] = decimal(port.range.min);
        }
        if port.range.max < f32::MAX {
            value["maximum"] = decimal(port.range.max);
        }
        if port.range.nonzero {
            value["not"] = json!({ "const": 0 });
        }
        value
    };
    let number = || bounds(json!({ "type": "number" }));
    let list = |lengths: [usize; 2]| {
        let [min, max] = lengths;
        json!({ "type": "array", "items": number(), "minItems": min, "maxItems": max })
    };
    let color = || json!({ "$ref": "#/$defs/color" });
    let mut literals = match port.ty {
        PortType::Choice(names) => vec![
            json!({ "enum": names }),
            json!({ "type": "integer", "minimum": 0, "maximum": names.len() - 1 }),
        ],
        PortType::Stops => vec![json!({ "$ref": "#/$defs/stops" })],
        PortType::Matrix => [9, 16]
            .into_iter()
            .map(|count| json!({ "type": "array", "items": { "type": "number" }, "minItems": count, "maxItems": count }))
            .collect(),
        PortType::Any | PortType::Each | PortType::Own | PortType::Color => {
            vec![number(), list([1, 4]), color()]
        }
        PortType::Exactly(ty) => match ty {
            Type::Float => vec![number(), list([1, 1]), json!({ "type": "boolean" })],
            Type::Integer => vec![bounds(json!({ "type": "integer" }))],
            Type::Boolean => vec![json!({ "type": "boolean" })],
            Type::Vector2 => vec![number(), list([1, 2])],
            Type::Vector3 => vec![number(), list([1, 3])],
            Type::Vector4 => vec![number(), list([1, 4])],
            Type::Color3 => vec![number(), list([1, 3]), color()],
            Type::Color4 => vec![number(), list([1, 4]), color()],
            Type::String | Type::Filename => vec![json!({ "type": "string" })],
        },
    };
    if !port.uniform {
        literals.push(json!({ "$ref": "#/$defs/connection" }));
        literals.push(json!({ "$ref": "#/$defs/interface" }));
    }
    let unit = if port.unit == "dimensionless" {
        String::new()
    } else {
        format!(" [{}]", port.unit)
    };
    let mut schema = json!({ "description": format!("{}{unit}", port.doc), "anyOf": literals });
    if let Some(default) = default(port) {
        schema["default"] = default;
    }
    schema
}

/// The default as it would be written; none for the surface's coordinates.
fn default(port: &PortSpec) -> Option<Value> {
    Some(match port.default {
        Default::Float(x) => decimal(x),
        Default::Integer(i) => i.into(),
        Default::Boolean(flag) => flag.into(),
        Default::Vector2(xy) => xy.map(decimal).to_vec().into(),
        Default::Color3(rgb) => rgb.map(decimal).to_vec().into(),
        Default::Choice(text) | Default::Text(text) => text.into(),
        Default::Stops(stops) => {
            let stops = stops.iter();
            stops
                .map(|(at, x)| json!({ "at": decimal(*at), "value": decimal(*x) }))
                .collect()
        }
        Default::Surface | Default::Identity => return None,
    })
}

/// The shortest decimal number that is this f32; whole numbers without a fraction.
fn decimal(number: f32) -> Value {
    let text = number.to_string();
    text.parse::<i64>().map_or_else(
        |_| text.parse::<f64>().map_or(Value::Null, Value::from),
        Value::from,
    )
}
