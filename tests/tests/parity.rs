//! Every node that bears a name of MaterialX computes at a point what MaterialX's own shader
//! computes: `tests/parity/probe.jsonl` holds the values, made by `tests/parity/probe.py`.

use std::collections::BTreeMap;

use mipless::{Footprint, Method, Options, Severity, Texture};
use mipless_graph::PortType;
use serde_json::{Map, Value, json};

/// How far a value may be off, relative to its size where that is above 1.
const TOLERANCE: f64 = 2e-4;
/// Pixels along a side of what the oracle draws, and where texture space begins in it; it is one
/// unit wide.
const SIDE: f64 = 512.0;
const CORNER: [f64; 2] = [0.0137, 0.0071];
/// The values of a case.
const VALUES: usize = 64;

/// The scattered pixels of a case, as `probe.py` has them (Roberts 2018, the plastic number).
fn footprints(count: usize) -> Vec<Footprint> {
    (0..count)
        .map(|j| {
            let factors = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
            let pixel = factors.map(|factor| (SIDE * ((0.5 + factor * j as f64) % 1.0)).floor());
            Footprint::point([0, 1].map(|i| CORNER[i] + (pixel[i] + 0.5) / SIDE))
        })
        .collect()
}

/// A node of MaterialX as the node of the same name here: a result whose type does not follow from
/// the inputs is named, as its `signature` or where it is converted `to`.
fn node(category: &str, types: &[&str], inputs: &Map<String, Value>) -> Value {
    let mut inputs = inputs.clone();
    let ports = mipless_nodes::find(category).map_or(&[][..], |def| def.spec.inputs);
    for port in ports {
        let PortType::Choice(names) = port.ty else {
            continue;
        };
        let named = match port.name {
            "hash" => Some(&"materialx"),
            "signature" | "to" => types.iter().find(|ty| names.contains(ty)),
            _ => None,
        };
        if let Some(name) = named {
            inputs.insert(port.name.to_owned(), json!(name));
        }
    }
    json!({ "type": category, "inputs": inputs })
}

/// How far a case is off, or why it cannot be computed.
fn error(case: &Value, upstream: &Map<String, Value>) -> Result<f64, String> {
    let text = |key: &str| case[key].as_str().expect("a text");
    let mut nodes: Map<String, Value> = (upstream.iter())
        .map(|(name, made)| {
            let inputs = made["inputs"].as_object().expect("inputs");
            let of = made["of"].as_str().expect("a type");
            let category = made["type"].as_str().expect("a category");
            (name.clone(), node(category, &[of], inputs))
        })
        .collect();
    let inputs = case["inputs"].as_object().expect("inputs");
    // `ND_randomfloat_integer` is told by its last word, `ND_noise2d_color3FA` by its result.
    let last = text("definition").rsplit('_').next().expect("a last word");
    let types = [last, text("type")];
    nodes.insert("t".to_owned(), node(text("node"), &types, inputs));
    let document = json!({
        "version": 1,
        "name": "parity",
        "nodes": nodes,
        "outputs": { "out": { "node": "t", "output": text("output") } },
    });
    let texture = Texture::from_json(&document.to_string()).map_err(|mistakes| {
        let mistake = mistakes
            .iter()
            .find(|mistake| mistake.severity == Severity::Error);
        mistake.expect("a mistake").message.clone()
    })?;
    let values = case["values"].as_array().expect("values");
    let components = match text("type") {
        "vector2" => 2,
        "vector3" | "color3" => 3,
        "vector4" | "color4" => 4,
        _ => 1,
    };
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let found = (texture.evaluator(&options)).evaluate(&footprints(VALUES / components));
    if found.len() != components && found.len() != 1 {
        return Err(format!("{} components for {components}", found.len()));
    }
    let mut worst = 0.0f64;
    for (i, value) in values.iter().enumerate() {
        // What is no number there is not compared.
        let Some(wanted) = value.as_f64() else {
            continue;
        };
        let component = (i % components).min(found.len() - 1);
        let found = f64::from(found[component][i / components]);
        worst = worst.max((found - wanted).abs() / wanted.abs().max(1.0));
    }
    Ok(worst)
}

/// Definitions that differ in a case, and why.
struct Exception {
    case: &'static str,
    reason: &'static str,
    definitions: &'static [&'static str],
}

const EXCEPTIONS: [Exception; 5] = [
    Exception {
        case: "defaults",
        reason: "the type follows from what is connected, which is nothing",
        definitions: &[
            "ND_colorcorrect_color4",
            "ND_combine2_color4CF",
            "ND_combine2_vector4VF",
            "ND_combine2_vector4VV",
            "ND_convert_color3_color4",
            "ND_convert_color3_vector4",
            "ND_convert_vector2_color4",
            "ND_convert_vector2_vector4",
            "ND_convert_vector3_color4",
            "ND_convert_vector3_vector4",
            "ND_hsvadjust_color4",
            "ND_hsvtorgb_color4",
            "ND_luminance_color4",
            "ND_rgbtohsv_color4",
            "ND_saturate_color4",
        ],
    },
    Exception {
        case: "defaults",
        reason: "in these forms alone the default of value1 is 1",
        definitions: &["ND_ifequal_boolean", "ND_ifequal_booleanI"],
    },
    Exception {
        case: "probe",
        reason: "the device of the oracle draws nothing where hexagons are staggered",
        definitions: &["ND_tiledhexagons_color3"],
    },
    Exception {
        case: "wide",
        reason: "27000 times the lacunarity, in 32 bits, moves MaterialX's octaves by 1/500 of a cell",
        definitions: &["ND_unifiednoise2d_float"],
    },
    Exception {
        case: "wide",
        reason: "a turn by 27000 degrees, in 32 bits",
        definitions: &["ND_unifiednoise3d_float"],
    },
];

/// Why a definition may differ in a case.
fn excepted(definition: &str, case: &str) -> Option<&'static str> {
    let of = |exception: &&Exception| {
        exception.case == case && exception.definitions.contains(&definition)
    };
    EXCEPTIONS.iter().find(of).map(|exception| exception.reason)
}

/// The least share of the definitions that are right, of those that may be.
const SHARE: f64 = 0.95;

#[test]
fn names_of_materialx_mean_what_they_mean_there() {
    let path = mipless_tests::root().join("tests/parity/probe.jsonl");
    let text = std::fs::read_to_string(path).expect("the table of the oracle");
    let mut lines = text.lines();
    let read = |line: &str| -> Value { serde_json::from_str(line).expect("a line of the table") };
    let signals = read(lines.next().expect("the signals"));
    let mut counts: BTreeMap<String, [usize; 2]> = BTreeMap::new();
    let mut wrong = Vec::new();
    for line in lines {
        let case = read(line);
        let kind = case["case"].as_str().expect("a case");
        let name = case["definition"].as_str().expect("a definition");
        let base = if kind == "wide" { "wide" } else { "probe" };
        let result = error(&case, signals[base].as_object().expect("signals"));
        let count = counts.entry(kind.to_owned()).or_default();
        count[1] += 1;
        match (result, excepted(name, kind)) {
            (Ok(worst), reason) if worst <= TOLERANCE => {
                count[0] += 1;
                if let Some(reason) = reason {
                    wrong.push(format!("{name} {kind} is right, although {reason}"));
                }
            }
            (_, Some(_)) => {}
            (Ok(worst), None) => wrong.push(format!("{name} {kind}: off by {worst:.1e}")),
            (Err(mistake), None) => wrong.push(format!("{name} {kind}: {mistake}")),
        }
    }
    for (kind, [right, all]) in &counts {
        println!("{kind}: {right} of {all} node definitions");
        assert!(
            *right as f64 >= SHARE * *all as f64,
            "{kind}: {right} of {all}"
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
