//! Laws that every node keeps, and the far fields that are known.

mod channel;
mod color;
mod combination;
mod law;
mod vector;

use std::collections::HashSet;
use std::sync::Arc;

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::ir::Program;
use mipless_codegen::{Bundle, Lower, Method, NodeDef, Options, compile};
use mipless_graph::{
    Behaviour, Category, CheckOptions, Default, Doc, Node, NodeSpec, OutputType, Picture, Reach,
    Type, check, load,
};
use serde_json::{Value, json};

use crate::port::number;
use crate::{catalogue, describe, page};

/// A Gaussian source for the tests: mean `pivot`, variance `spread²`, read by nothing else.
static GAUSSIAN: NodeSpec = NodeSpec {
    name: "test_gaussian",
    aliases: &[],
    category: Category::Noise,
    summary: "A Gaussian number.",
    doc: Doc {
        computes: "",
        statistics: "",
        accuracy: "",
        references: "",
    },
    inputs: &[
        number("pivot", 0.0, "The mean."),
        number("spread", 1.0, "Its σ."),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| inputs.reach("pivot") + inputs.reach("spread") * Reach::of(-5.0, 5.0),
    class: |_| Behaviour::Gaussian { deviation: 0.0 },
    example: "",
};

fn gaussian<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut signal = lower.signal(node, "pivot");
    let spread = lower.number(node, "spread");
    if lower.mode().spreads() {
        signal.range = [f32::NEG_INFINITY, f32::INFINITY];
        lower.algebra.attach_fresh(&mut signal, spread.square());
    }
    vec![signal]
}

/// What every file of an example holds.
fn ripples() -> Picture {
    let wave = |i: usize, channel: usize| {
        let (x, y) = ((i % 16) as f32, (i / 16) as f32);
        let turns = [x / 16.0, (x + y) / 8.0, (x - 2.0 * y) / 16.0][channel];
        0.5 + 0.4 * (std::f32::consts::TAU * turns).sin()
    };
    let numbers = (0..3 * 16 * 16).map(|i| wave(i / 3, i % 3));
    Picture::new((16, 16), 3, false, numbers.collect())
}

fn definitions() -> Vec<NodeDef> {
    let mut all = catalogue().to_vec();
    all.push(NodeDef::new(&GAUSSIAN, gaussian));
    all
}

fn compiled(text: &str, method: Method) -> Program {
    let definitions = definitions();
    let specs: Vec<&'static NodeSpec> = definitions.iter().map(|def| def.spec).collect();
    let loaded = load(text, &specs);
    let mut graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{text}\n{:?}", loaded.diagnostics));
    for file in &loaded.files {
        graph.images.insert(&*file.name, Arc::new(ripples()));
    }
    let checked = check(
        graph,
        &CheckOptions {
            allow_sampling: true,
        },
    )
    .unwrap_or_else(|diagnostics| panic!("{text}\n{diagnostics:?}"));
    compile(
        &checked,
        &definitions,
        &Options {
            method,
            moments: true,
            ..Options::default()
        },
    )
}

/// Means, then variances, of each footprint.
fn evaluated(text: &str, method: Method, footprints: &[Footprint]) -> Vec<Vec<f64>> {
    let program = compiled(text, method);
    let defaults: Vec<f32> = program
        .interface
        .parameters
        .iter()
        .flat_map(|p| p.default.clone())
        .collect();
    eval_program::<f64>(&program, footprints, &defaults)
}

/// A graph of one node over connected Gaussians: mean and variance of its first component.
fn moments(nodes: Value, out: &str) -> (f64, f64) {
    let graph = json!({
        "version": 1, "name": "law", "nodes": nodes, "outputs": { "out": { "node": out } }
    });
    let results = evaluated(&graph.to_string(), Method::Local, &[Footprint::default()]);
    (results[0][0], results[results.len() / 2][0])
}

fn near(what: &str, actual: f64, expected: f64, tolerance: f64) {
    assert!(
        (actual - expected).abs() <= tolerance,
        "{what}: {actual}, not {expected}"
    );
}

#[test]
fn specs_are_well_formed() {
    let mut names = HashSet::new();
    for def in catalogue() {
        let spec = def.spec;
        assert!(names.insert(spec.name), "{} twice", spec.name);
        for text in [
            spec.summary,
            spec.doc.computes,
            spec.doc.statistics,
            spec.doc.accuracy,
            spec.doc.references,
        ] {
            assert!(
                text.ends_with('.'),
                "{}: a sentence ends: {text}",
                spec.name
            );
        }
        for port in spec.inputs {
            assert!(
                port.doc.ends_with('.'),
                "{}.{}: {}",
                spec.name,
                port.name,
                port.doc
            );
            let numbers: Vec<f32> = match port.default {
                Default::Float(x) => vec![x],
                Default::Integer(i) => vec![i as f32],
                Default::Vector2(xy) => xy.to_vec(),
                Default::Color3(rgb) => rgb.to_vec(),
                _ => Vec::new(),
            };
            let range = port.range;
            for x in numbers {
                assert!(
                    x >= range.min && x <= range.max,
                    "{}.{}: {x}",
                    spec.name,
                    port.name
                );
                assert!(
                    !(range.nonzero && x == 0.0),
                    "{}.{}: divides",
                    spec.name,
                    port.name
                );
            }
            assert!(
                range.soft_min >= range.min && range.soft_max <= range.max,
                "{}",
                port.name
            );
        }
        let example: Value = serde_json::from_str(spec.example)
            .unwrap_or_else(|error| panic!("example of {}: {error}", spec.name));
        assert_eq!(
            example["nodes"][spec.name]["type"], spec.name,
            "example of {}",
            spec.name
        );
    }
    for alias in catalogue().iter().flat_map(|def| def.spec.aliases) {
        assert!(names.insert(alias), "{alias} is a name or alias already");
    }
}

/// The file that lists the nodes of a category.
fn room(category: Category) -> &'static str {
    match category {
        Category::Input => include_str!("input.rs"),
        Category::Noise => include_str!("noise.rs"),
        Category::Pattern => include_str!("pattern.rs"),
        Category::Arithmetic => include_str!("arithmetic.rs"),
        Category::Transfer => include_str!("transfer.rs"),
        Category::Color => include_str!("color.rs"),
        Category::Coordinate => include_str!("coordinate.rs"),
        Category::Channel => include_str!("channel.rs"),
    }
}

#[test]
fn rooms_list_their_nodes_one_a_line_and_categories_are_together() {
    for def in catalogue() {
        let name = def.spec.name;
        let mut listed = room(def.spec.category).lines().filter_map(|line| {
            let line = line.strip_prefix("    ")?.strip_suffix(',')?;
            let (_, node) = line.split_once("::").unwrap_or(("", line));
            let node = node.split(" with ").next().unwrap_or(node);
            // A name that is a keyword is written raw.
            Some(node.strip_prefix("r#").unwrap_or(node))
        });
        assert!(
            listed.any(|node| node == name),
            "{name} is in the room of another category"
        );
    }
    let categories: Vec<Category> = catalogue().iter().map(|def| def.spec.category).collect();
    assert!(categories.is_sorted(), "sorted by category");
}

#[test]
fn pages_and_descriptions_say_everything() {
    let description = describe(catalogue());
    for def in catalogue() {
        let text = page(def);
        for heading in [
            "What it computes",
            "Statistics",
            "Accuracy",
            "Example",
            "References",
        ] {
            assert!(
                text.contains(&format!("## {heading}\n")),
                "{}: {heading}",
                def.spec.name
            );
        }
        let node = &description["nodes"][def.spec.name];
        for port in def.spec.inputs {
            assert!(
                text.contains(&format!("| `{}` |", port.name)),
                "{}",
                def.spec.name
            );
            assert_eq!(node["inputs"][port.name]["doc"], port.doc);
        }
        assert!(node["example"].is_object(), "{}", def.spec.name);
    }
    assert_eq!(
        description["nodes"]["place2d"]["inputs"]["scale"]["nonzero"],
        true
    );
}

/// Positions that lie on no edge of the examples.
fn places(size: f32) -> Vec<Footprint> {
    (0..60)
        .map(|i| {
            let uv = [0.317_31 * i as f32, 0.211_73 * i as f32].map(|x| (x + 0.021).fract());
            Footprint {
                cell: [i % 3, -i % 2],
                uv,
                du: [size, 0.0],
                dv: [0.3 * size, size],
            }
        })
        .collect()
}

#[test]
fn a_footprint_of_nothing_gives_the_value() {
    for def in catalogue() {
        let point = evaluated(def.spec.example, Method::Point, &places(0.0));
        let components = point.len() / 2;
        for method in [
            Method::Naive,
            Method::Ensemble,
            Method::Local,
            Method::Quad,
            Method::Auto,
        ] {
            let filtered = evaluated(def.spec.example, method, &places(0.0));
            for i in 0..components {
                for (place, (a, b)) in filtered[i].iter().zip(&point[i]).enumerate() {
                    near(
                        &format!("{} by {method} at {place}", def.spec.name),
                        *a,
                        *b,
                        1e-5,
                    );
                    let variance = filtered[components + i][place];
                    assert!(
                        (0.0..1e-5).contains(&variance),
                        "{}: {variance}",
                        def.spec.name
                    );
                }
            }
        }
    }
}

#[test]
fn a_large_footprint_gives_the_far_field() {
    let far = |name: &str, component: usize| {
        let spec = crate::find(name).expect("a node").spec;
        let results = evaluated(spec.example, Method::Local, &places(300.0));
        (
            results[component][5],
            results[results.len() / 2 + component][5],
        )
    };
    let (mean, variance) = far("stripes", 0);
    near("stripes", mean, 0.35, 1e-5);
    near("variance of stripes", variance, 0.35 * 0.65, 1e-4);
    let (mean, variance) = far("sin", 0);
    near("sine", mean, 0.0, 1e-5);
    near("variance of sine", variance, 0.5, 1e-4);
    // #e8c27a and #20303c in linear red: 0.8069523 and 0.0144438.
    near(
        "checkerboard",
        far("checkerboard", 0).0,
        (0.806_952_3 + 0.014_443_8) / 2.0,
        1e-4,
    );
    near(
        "luminance",
        far("luminance", 0).0,
        0.5 * far_luminance(),
        1e-4,
    );
}

/// The luminance of #c08a52.
fn far_luminance() -> f64 {
    let linear = |byte: f64| ((byte / 255.0 + 0.055) / 1.055f64).powf(2.4);
    0.272_228_7 * linear(192.0) + 0.674_081_8 * linear(138.0) + 0.053_689_5 * linear(82.0)
}

#[test]
fn transfers_of_a_gaussian_have_their_closed_forms() {
    let source = json!({ "type": "test_gaussian", "inputs": { "pivot": 0.3, "spread": 0.5 } });
    let of = |node: Value| moments(json!({ "x": source, "y": node }), "y");
    let x = json!({ "node": "x" });
    // Φ(0.6) and φ(0.6).
    let (p, density) = (0.725_746_882_249_926_4, 0.333_224_602_891_799_7);
    let (mean, variance) = of(json!({ "type": "step", "inputs": { "in": x } }));
    near("step", mean, p, 1e-6);
    near("variance of step", variance, p * (1.0 - p), 1e-5);
    let (mean, variance) = of(json!({ "type": "absval", "inputs": { "in": x } }));
    let folded = 0.3 * (2.0 * p - 1.0) + 2.0 * 0.5 * density;
    near("absval", mean, folded, 1e-6);
    near("variance of absval", variance, 0.34 - folded * folded, 1e-5);
    let (mean, variance) = of(json!({ "type": "sin", "inputs": { "in": x } }));
    near("sin", mean, 0.3f64.sin() * (-0.125f64).exp(), 1e-6);
    let second = 0.5 * (1.0 - 0.6f64.cos() * (-0.5f64).exp());
    near("variance of sin", variance, second - mean * mean, 1e-6);
    let (mean, variance) = of(json!({ "type": "power", "inputs": { "in1": x, "in2": 2 } }));
    near("power", mean, 0.34, 1e-6);
    near(
        "variance of power",
        variance,
        2.0 * 0.0625 + 4.0 * 0.09 * 0.25,
        1e-6,
    );
    let (mean, variance) = of(json!({ "type": "multiply", "inputs": { "in1": x, "in2": x } }));
    near("a square by multiply", mean, 0.34, 1e-6);
    near(
        "its variance",
        variance,
        2.0 * 0.0625 + 4.0 * 0.09 * 0.25,
        1e-6,
    );
    let (mean, variance) = of(json!({ "type": "subtract", "inputs": { "in1": x, "in2": x } }));
    assert_eq!((mean, variance), (0.0, 0.0), "a signal less itself");
    let (mean, _) = of(json!({ "type": "max", "inputs": { "in1": x, "in2": 0 } }));
    near("max", mean, 0.3 * p + 0.5 * density, 1e-6);
    let (mean, _) = of(json!({ "type": "min", "inputs": { "in1": x, "in2": 0 } }));
    near("min", mean, 0.3 - (0.3 * p + 0.5 * density), 1e-6);
    let (mean, variance) = of(json!({ "type": "mix", "inputs": { "bg": 1, "fg": 3, "mix": x } }));
    near("mix", mean, 1.6, 1e-6);
    near("variance of mix", variance, 4.0 * 0.25, 1e-6);
}

#[test]
fn equal_functions_have_equal_moments() {
    let source = json!({ "type": "test_gaussian", "inputs": { "pivot": 0.3, "spread": 0.5 } });
    let x = json!({ "node": "x" });
    let of = |node: Value| moments(json!({ "x": source, "y": node }), "y");
    let clamp = of(json!({ "type": "clamp", "inputs": { "in": x, "low": 0.1, "high": 0.6 } }));
    let ramp = of(json!({ "type": "colorramp", "inputs": {
        "in": x, "stops": [{ "at": 0.1, "value": 0.1 }, { "at": 0.6, "value": 0.6 }] } }));
    let range = of(json!({ "type": "range", "inputs": {
        "in": x, "inlow": 0.1, "inhigh": 0.6, "outlow": 0.1, "outhigh": 0.6, "doclamp": true } }));
    let swapped = of(json!({ "type": "range", "inputs": {
        "in": x, "inlow": 0.6, "inhigh": 0.1, "outlow": 0.6, "outhigh": 0.1, "doclamp": true } }));
    let smooth = of(json!({ "type": "smoothstep", "inputs": { "in": x } }));
    let smooth_ramp =
        of(json!({ "type": "colorramp", "inputs": { "in": x, "interpolation": "smooth" } }));
    for (name, other, one) in [
        ("ramp", ramp, clamp),
        ("range", range, clamp),
        ("swapped range", swapped, clamp),
        ("smooth ramp", smooth_ramp, smooth),
    ] {
        near(name, other.0, one.0, 2e-6);
        near(name, other.1, one.1, 2e-5);
    }
}

#[test]
fn bounds_that_vary_are_limits_too() {
    let of = |node: Value| {
        moments(
            json!({
                "x": { "type": "test_gaussian", "inputs": { "pivot": 0.3, "spread": 0.4 } },
                "edge": { "type": "test_gaussian", "inputs": { "pivot": 0.0, "spread": 0.3 } },
                "y": node
            }),
            "y",
        )
    };
    let (x, edge) = (json!({ "node": "x" }), json!({ "node": "edge" }));
    // The difference has mean 0.3 and spread 0.5.
    let (mean, _) = of(json!({ "type": "step", "inputs": { "in": x, "edge": edge } }));
    near(
        "step at a varying edge",
        mean,
        0.725_746_882_249_926_4,
        1e-6,
    );
    // Low far below: min(x, edge) = 0 − E[max(edge − x, 0)] + … = E[x] − E[max(x − edge, 0)].
    let (mean, _) = of(json!({ "type": "clamp", "inputs": { "in": x, "low": -50, "high": edge } }));
    near(
        "clamp to a varying bound",
        mean,
        0.3 - (0.3 * 0.725_746_88 + 0.5 * 0.333_224_6),
        1e-5,
    );
    let (mean, variance) = of(json!({ "type": "divide", "inputs": { "in1": x, "in2": 4 } }));
    near("divide by a number", mean, 0.075, 1e-7);
    near("its variance", variance, 0.01, 1e-7);
    let far = json!({ "type": "test_gaussian", "inputs": { "pivot": 5, "spread": 0.5 } });
    let (mean, _) = moments(
        json!({
            "x": far,
            "y": { "type": "divide", "inputs": { "in1": 1, "in2": { "node": "x" } } }
        }),
        "y",
    );
    // E[1/X] = Σ (2k − 1)!! σ^{2k} / m^{2k + 1}.
    near(
        "divide by a signal",
        mean,
        0.2 * (1.0 + 0.01 + 3e-4 + 1.5e-5 + 1e-6),
        2e-6,
    );
}

#[test]
fn coordinates_keep_their_detail_far_from_the_origin() {
    let graph = |rotate: f32, order: &str| {
        json!({
            "version": 1, "name": "far", "nodes": {
                "uv": { "type": "texcoord" },
                "place": { "type": "place2d", "inputs": {
                    "texcoord": { "node": "uv" }, "scale": [0.5, 0.25], "rotate": -rotate, "offset": [0.25, 0.5],
                    "pivot": [0.5, 0.5], "operationorder": order } },
                "stripes": { "type": "stripes", "inputs": {
                    "texcoord": { "node": "place" }, "frequency": 1, "rotate": 90 } },
                "x": { "type": "extract", "inputs": { "in": { "node": "place" }, "index": 0 } }
            },
            "outputs": { "out": { "node": "stripes" }, "x": { "node": "x" } }
        })
        .to_string()
    };
    let at = |cell: i32, u: f32, v: f32| Footprint {
        cell: [cell, cell],
        uv: [u, v],
        du: [0.01, 0.0],
        dv: [0.0, 0.01],
    };
    for order in ["SRT", "TRS"] {
        for method in [Method::Point, Method::Local] {
            let near_by = evaluated(
                &graph(90.0, order),
                method,
                &[at(0, 0.3, 0.7), at(0, 0.55, 0.2)],
            );
            let far = evaluated(
                &graph(90.0, order),
                method,
                &[at(4_000_000, 0.3, 0.7), at(4_000_000, 0.55, 0.2)],
            );
            for i in 0..2 {
                near(
                    &format!("{order} by {method}"),
                    far[0][i],
                    near_by[0][i],
                    1e-5,
                );
            }
        }
    }
    // SRT at (0.3, 0.7): ((−0.2, 0.2) / (0.5, 0.25)) = (−0.4, 0.8), turned (−0.8, −0.4), less the
    // offset (−1.05, −0.9), back (−0.55, −0.4). TRS: (−0.45, −0.3), turned (0.3, −0.45), scaled
    // (0.6, −1.8), back (1.1, −1.3).
    for (order, x) in [("SRT", -0.55), ("TRS", 1.1)] {
        let results = evaluated(&graph(90.0, order), Method::Point, &[at(0, 0.3, 0.7)]);
        near(order, results[1][0], x, 1e-6);
    }
    let turned = evaluated(&graph(30.0, "SRT"), Method::Point, &[at(0, 0.3, 0.7)]);
    near(
        "30°",
        turned[1][0],
        -0.4 * 0.866_025_4 - 0.8 * 0.5 + 0.25,
        1e-6,
    );
}

#[test]
fn a_checkerboard_is_color2_where_the_cells_are_even() {
    let graph = json!({
        "version": 1, "name": "board",
        "nodes": { "b": { "type": "checkerboard", "inputs": { "uvtiling": [4, 2], "uvoffset": [1, 0] } } },
        "outputs": { "out": { "node": "b" } }
    })
    .to_string();
    let places: Vec<Footprint> = (0..64)
        .map(|i| Footprint {
            uv: [0.125 * (i % 8) as f32 + 0.06, 0.125 * (i / 8) as f32 + 0.06],
            cell: [i % 5 - 2, 0],
            ..Footprint::default()
        })
        .collect();
    let results = evaluated(&graph, Method::Local, &places);
    for (place, value) in places.iter().zip(&results[0]) {
        let (u, v) = (place.cell[0] as f32 + place.uv[0], place.uv[1]);
        let cells = (u * 4.0 - 1.0).floor() as i32 + (v * 2.0).floor() as i32;
        near(
            "square",
            *value,
            f64::from(u8::from(cells.rem_euclid(2) == 1)),
            1e-6,
        );
    }
}

#[test]
fn a_mix_with_a_number_is_linear_in_both() {
    let of = |node: Value| {
        let source = json!({ "type": "test_gaussian", "inputs": { "pivot": 0.3, "spread": 0.5 } });
        moments(json!({ "x": source, "y": node }), "y")
    };
    let x = json!({ "node": "x" });
    let (mean, variance) = of(json!({ "type": "mix", "inputs": { "bg": x, "fg": 1, "mix": 0.5 } }));
    near("mix", mean, 0.65, 1e-6);
    near("variance of mix", variance, 0.25 * 0.25, 1e-6);
}

#[test]
fn transfers_of_one_signal_share_their_distortion() {
    // |X| + X² of a standard normal: 1 − 2/π + 2 + 2 (E|X|³ − E|X|).
    let graph = json!({
        "x": { "type": "test_gaussian" },
        "fold": { "type": "absval", "inputs": { "in": { "node": "x" } } },
        "square": { "type": "power", "inputs": { "in1": { "node": "x" }, "in2": 2 } },
        "y": { "type": "add", "inputs": { "in1": { "node": "fold" }, "in2": { "node": "square" } } }
    });
    let (_, variance) = moments(graph, "y");
    let folded = (2.0 / std::f64::consts::PI).sqrt();
    near(
        "|X| + X²",
        variance,
        3.0 - folded * folded + 2.0 * folded,
        1e-4,
    );
}
