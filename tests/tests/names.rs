//! Whatever a graph, its nodes, inputs and outputs are called, every target compiles with every entry;
//! and names that other programs have for ports and nodes are answered.

use mipless::target::{Target, validate};
use mipless::wgsl::{Entry, Shader, emit};
use mipless::{CheckOptions, Method, NoFiles, Options, Texture};
use serde_json::{Value, json};
use std::collections::BTreeSet;

const ENTRIES: [Entry; 3] = [Entry::None, Entry::Fragment, Entry::Compute];

/// A graph with an input of each kind of type, a table, functions of its own and two outputs, in
/// which everything is called `name`, or as `each` makes of it.
fn graph(name: &str, each: impl Fn(&str) -> String) -> Value {
    let [float, vector, whole] = ["float", "vector", "whole"].map(&each);
    let [noise, wave, ramp, out, other] = ["noise", "wave", "ramp", "out", "other"].map(&each);
    let [scaled, two] = ["scaled", "two"].map(&each);
    let stops: Vec<Value> = (0..12)
        .map(|i| json!({ "at": i as f32 / 12.0, "value": [0.1, (i % 3) as f32, 0.5] }))
        .collect();
    json!({
        "version": 1,
        "name": name,
        "inputs": {
            float.clone(): { "type": "float", "value": 4, "min": 1, "max": 9 },
            vector.clone(): { "type": "vector2", "value": [1, 2] },
            whole.clone(): { "type": "boolean", "value": true },
        },
        "nodes": {
            noise.clone(): { "type": "noise2d", "inputs": { "frequency": { "input": float } } },
            wave.clone(): { "type": "sin", "inputs": { "in": { "node": noise } } },
            ramp.clone(): { "type": "colorramp", "inputs": { "in": { "node": wave }, "stops": stops } },
            scaled.clone(): { "type": "multiply",
                "inputs": { "in1": { "input": vector }, "in2": { "node": two } } },
            two.clone(): { "type": "add", "inputs": { "in1": { "node": wave }, "in2": 2 } },
        },
        "outputs": { out.clone(): { "node": ramp }, other.clone(): { "node": scaled } }
    })
}

fn shader(graph: &Value, method: Method, entry: Entry) -> Shader {
    let texture =
        Texture::from_json(&graph.to_string()).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    let options = Options {
        method,
        moments: true,
        ..Options::default()
    };
    emit(&texture.compile(&options), &entry.into())
}

/// What is wrong with the shaders of a graph: each is valid, and the short ones go to every target.
fn faults(graph: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    let tabled = shader(graph, Method::Local, Entry::Fragment);
    if let Err(error) = validate(&tabled.source) {
        faults.push(format!("with tables: {error}"));
    }
    for entry in ENTRIES {
        let shader = shader(graph, Method::Point, entry);
        let validated = match validate(&shader.source) {
            Ok(validated) => validated,
            Err(error) => {
                faults.push(format!("{entry:?}: {error}"));
                continue;
            }
        };
        for target in Target::ALL {
            if target.refuses(&shader).is_some() {
                continue;
            }
            match validated.translate(&shader, target) {
                Ok(text) if !text.is_empty() => {}
                Ok(_) => faults.push(format!("{entry:?}: {} is empty", target.name())),
                Err(error) => faults.push(format!("{entry:?}: {error}")),
            }
        }
    }
    faults
}

/// Every identifier in the text of the graph's own shaders.
fn spoken() -> BTreeSet<String> {
    let graph = graph("g", |of| format!("{of}_of_g"));
    let mut words = BTreeSet::new();
    let mut hear = |text: &str| {
        let parts = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        let fits = |word: &&str| word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        words.extend(parts.filter(fits).map(str::to_owned));
    };
    for entry in ENTRIES {
        let shader = shader(&graph, Method::Local, entry);
        hear(&shader.source);
    }
    // `t17` stands for every value of its kind.
    words.retain(|word| word.len() < 3 || !word[1..].bytes().all(|byte| byte.is_ascii_digit()));
    words
}

/// Words of the languages, and what is no word at all.
fn nasty() -> Vec<String> {
    let words = "main fragment compute texture footprint uv sampler float float4 half vec3 vec3f mat3x3 \
        layout in out inout uniform buffer discard fn let var struct switch if else for while return \
        true false lerp mix saturate frac mul tex2D cbuffer register SV_Position packoffset matrix \
        row_major technique pass precise groupshared numthreads kernel vertex thread constant device \
        threadgroup metal using namespace template typename class operator this new delete asm union \
        goto typedef enum extern static volatile gl_Position gl_FragCoord gl_ __ a__b _ _a a_ t1 p2 T1 \
        naga_f2i32 naga_mod bitcast ptr array atomic f16 f32 i32 u32 bool NULL Self self active \
        alignas filter common partition superp noperspective highp lowp mediump precision varying \
        attribute centroid flat smooth invariant subroutine resource image2D isampler2D usamplerBuffer \
        textureSample dpdx workgroupBarrier arrayLength select modf frexp ldexp fma Footprint Position \
        Pixel GParameters GOutputs g_tables g_fragment g_compute g_uniforms x1 x_1 x_ a1 a9 a1_ a1_2 \
        1 12 1a 9_9 color2";
    let mut names: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
    names.extend(
        [
            "",
            " ",
            "-",
            "/",
            "~1",
            "a b",
            "a/b~c",
            "\"",
            "\\",
            "\n",
            "*/",
            "/*",
            "//",
            "\0",
            "}",
            ";",
            "σ",
            "стена",
            "石",
            "🧱",
            "é",
            "e\u{301}",
            "\u{200f}",
            "\u{feff}a",
            "ﬁ",
            "ſ",
            "K",
            "ı",
        ]
        .map(str::to_owned),
    );
    names.push("n".repeat(10_000));
    names.push("9".repeat(10_000));
    names.push("ж".repeat(10_000));
    names
}

#[test]
fn a_graph_whose_parts_are_called_as_anything_compiles_for_every_target() {
    let spoken = spoken();
    assert!(
        spoken.contains("footprint") && spoken.len() > 50,
        "{spoken:?}"
    );
    let names: BTreeSet<String> = nasty().into_iter().chain(spoken).collect();
    let mut wrong = Vec::new();
    for name in &names {
        let shown: String = name.chars().take(40).collect();
        // The graph and one of each kind as the word, others as what could be made of it.
        let several = |of: &str| match of {
            "float" | "noise" | "out" => name.clone(),
            "vector" | "wave" | "other" => format!("{name}2"),
            "two" => format!("{name} "),
            "scaled" => format!("{name}-2"),
            _ => format!("{name}_2"),
        };
        for graph in [graph(name, str::to_owned), graph(name, several)] {
            wrong.extend(
                faults(&graph)
                    .into_iter()
                    .map(|fault| format!("{shown:?}: {fault}")),
            );
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {}:\n{}",
        wrong.len(),
        names.len(),
        wrong.join("\n")
    );
}

/// The help of the only mistake of a graph of one node.
fn help(node: &str) -> String {
    let text = format!(
        r#"{{ "version": 1, "nodes": {{ "n": {node} }}, "outputs": {{ "out": {{ "node": "n" }} }} }}"#
    );
    let mistakes = Texture::with_name("n", &text, &CheckOptions::default(), &NoFiles);
    let mistakes = mistakes.expect_err("there is a mistake");
    assert_eq!(mistakes.len(), 1, "{mistakes:?}");
    mistakes[0].help.clone().unwrap_or_default()
}

#[test]
fn ports_of_other_programs_are_told_their_name_here_and_nodes_what_to_do_instead() {
    for (node, port) in [
        (
            r#"{ "type": "noise2d", "inputs": { "scale": 3 } }"#,
            "frequency",
        ),
        (
            r#"{ "type": "fractal2d", "inputs": { "Detail": 3 } }"#,
            "octaves",
        ),
        (
            r#"{ "type": "fractal2d", "inputs": { "Roughness": 0.5 } }"#,
            "diminish",
        ),
        (r#"{ "type": "mix", "inputs": { "Fac": 0.5 } }"#, "mix"),
        (
            r#"{ "type": "checkerboard", "inputs": { "scale": 3 } }"#,
            "uvtiling",
        ),
        (
            r#"{ "type": "worleynoise2d", "inputs": { "randomness": 1 } }"#,
            "jitter",
        ),
        (r#"{ "type": "add", "inputs": { "A": 1 } }"#, "in1"),
    ] {
        assert_eq!(help(node), format!("here it is called `{port}`"));
    }
    // A name that is nearly right is still told.
    assert_eq!(
        help(r#"{ "type": "noise2d", "inputs": { "freqency": 3 } }"#),
        "did you mean `frequency`?"
    );
    for (node, answer) in [
        ("Tile Sampler", "worleynoise2d"),
        ("fresnel", "direction of view"),
        ("time", "input of the graph"),
        ("ambient_occlusion", "blur"),
    ] {
        let help = help(&format!(r#"{{ "type": "{node}" }}"#));
        assert!(help.contains(answer), "{node}: {help}");
    }
}
