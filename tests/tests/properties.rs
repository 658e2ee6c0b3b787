//! Random graphs, and every node with each of its inputs set, go through everything without a panic
//! and come out finite; mutilated documents give diagnostics with places.
//!
//! `MIPLESS_LONG=1` tries ten times as many.

use mipless::target::validate;
use mipless::wgsl::{Entry, Options as Emission, emit};
use mipless::{Diagnostic, Footprint, Method, Options, Texture};
use mipless_codegen::ir::verify;
use mipless_tests::case::{all, load};
use mipless_tests::random::Random;
use mipless_tests::varied::varied;
use mipless_tests::{METHODS, cases, random_graph};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::panic::catch_unwind;

fn config(usual: u32) -> ProptestConfig {
    // The same cases in every run; what fails is printed whole.
    let rng_seed = RngSeed::Fixed(20_261);
    let failure_persistence = None;
    ProptestConfig {
        rng_seed,
        failure_persistence,
        ..ProptestConfig::with_cases(cases(usual))
    }
}

fn footprints() -> Vec<Footprint> {
    let mut random = Random::new(23);
    let mut footprint = |size: f64| {
        let mut axis = || [0, 1].map(|_| random.within(-size, size) as f32);
        let (du, dv) = (axis(), axis());
        let cell = [0, 1].map(|_| random.within(-1e4, 1e4) as i32);
        Footprint {
            cell,
            uv: [0, 1].map(|_| random.unit() as f32),
            du,
            dv,
        }
    };
    [0.0, 1e-9, 1e-4, 0.01, 0.1, 1.0, 100.0, 1e9]
        .map(&mut footprint)
        .to_vec()
}

/// The method compiles the texture to valid IR and valid WGSL, and evaluates it to finite numbers.
fn sound(texture: &Texture, method: Method) -> Result<(), String> {
    let options = Options {
        method,
        moments: true,
        ..Options::default()
    };
    let program = texture.compile(&options);
    verify(&program.module).map_err(|violations| violations[0].to_string())?;
    let entry = Entry::Compute;
    let shader = emit(&program, &entry.into());
    validate(&shader.source).map_err(|error| error.to_string())?;
    let outputs = texture.evaluator(&options).evaluate(&footprints());
    let finite = outputs.iter().flatten().all(|x| x.is_finite());
    if finite {
        Ok(())
    } else {
        Err(format!("{outputs:?}"))
    }
}

/// Every method is sound.
fn holds(texture: &Texture, text: &str) {
    for method in METHODS {
        if let Err(reason) = sound(texture, method) {
            panic!("{method}: {reason}\n{text}");
        }
    }
}

/// Every mistake says where it is.
fn located(mistakes: &[Diagnostic], text: &str) {
    assert!(!mistakes.is_empty(), "refused without a reason:\n{text}");
    for mistake in mistakes {
        let line = mistake.line.is_some() || mistake.pointer.is_some();
        assert!(line, "{mistake} stands nowhere:\n{text}");
        assert!(
            !mistake.message.is_empty(),
            "{} says nothing:\n{text}",
            mistake.code
        );
    }
}

#[test]
fn random_graphs_mostly_pass_the_check() {
    let mut random = Random::new(2);
    let accepted = (0..100).filter(|_| {
        let text = random_graph::text(&mut random, 6);
        load(&text).is_ok()
    });
    // The others divide by a signal, or something of that kind.
    assert!(
        accepted.count() >= 50,
        "the random graphs are hardly ever graphs"
    );
}

/// What is wrong with a graph that was accepted.
fn faults(name: &str, texture: &Texture) -> Vec<String> {
    let methods = [Method::Point, Method::Local, Method::Quad];
    let fault = |method: Method| {
        let reason = match catch_unwind(|| sound(texture, method)) {
            Ok(result) => result.err()?,
            Err(_) => "a panic".to_owned(),
        };
        Some(format!("{name} by {method}: {reason}"))
    };
    methods.into_iter().filter_map(fault).collect()
}

/// An input beside the one that somebody tried is where panics live: a hexagon of size 0. Every tenth
/// graph, or all of them when there is time.
#[test]
fn every_input_of_every_node_may_be_what_it_accepts() {
    let graphs: Vec<_> = (varied().into_iter())
        .step_by(10 / cases(1) as usize)
        .collect();
    let results: Vec<Option<Vec<String>>> = (graphs.par_iter())
        .map(|(name, text)| match load(text) {
            Ok(texture) => Some(faults(name, &texture)),
            Err(mistakes) => {
                located(&mistakes, text);
                None
            }
        })
        .collect();
    let accepted = results.iter().flatten().count();
    let faults: Vec<String> = results.into_iter().flatten().flatten().collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    // The others divide by a signal, or something of that kind.
    let all = graphs.len();
    assert!(accepted * 10 > all * 9, "{accepted} of {all} are accepted");
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn random_graphs_compile_and_evaluate(seed: u64, nodes in 1_usize..12) {
        let text = random_graph::text(&mut Random::new(seed), nodes);
        match load(&text) {
            Ok(texture) => holds(&texture, &text),
            Err(mistakes) => located(&mistakes, &text),
        }
    }
}

/// Changes one random place of a document.
fn mutilate(value: &mut Value, random: &mut Random) {
    let mut place = value;
    // Down to some depth, one random member each.
    for _ in 0..random.below(7) {
        let members = match place {
            Value::Object(members) => members.len(),
            Value::Array(members) => members.len(),
            _ => 0,
        };
        if members == 0 {
            break;
        }
        let index = random.below(members);
        place = match place {
            Value::Object(members) => members.values_mut().nth(index).expect("a member"),
            Value::Array(members) => &mut members[index],
            _ => unreachable!("only these have members"),
        };
    }
    let odd = [
        "null",
        "true",
        "-1",
        "0",
        "1e30",
        "1e-30",
        "3.5",
        "[]",
        "{}",
        "[1, 2, 3]",
        "\"#ff0000\"",
        "\"noise2d\"",
        "{ \"node\": \"none\" }",
        "{ \"input\": \"none\" }",
        "[[[]]]",
        "\"\"",
        "9007199254740993",
        "[1e38, -1e38]",
        "{ \"type\": \"noise2d\" }",
    ];
    let odd: Value = serde_json::from_str(odd[random.below(odd.len())]).expect("JSON");
    match (random.below(4), place) {
        (0, Value::Object(members)) if !members.is_empty() => {
            let key = members.keys().nth(random.below(members.len())).cloned();
            members.remove(&key.expect("a key"));
        }
        (1, Value::Object(members)) => {
            let keys = [
                "in", "in1", "type", "nodes", "value", "extra", "seed", "odd", "doc",
            ];
            members.insert((*random.choose(&keys)).to_owned(), odd);
        }
        (2, Value::Array(members)) => members.push(odd),
        (_, place) => *place = odd,
    }
}

proptest! {
    #![proptest_config(config(400))]

    #[test]
    fn mutilated_documents_give_located_diagnostics(seed: u64, changes in 1_usize..4) {
        let mut random = Random::new(seed);
        let originals = all();
        let case = random.choose(&originals);
        let mut document: Value = serde_json::from_str(&case.text).expect("JSON");
        for _ in 0..changes {
            mutilate(&mut document, &mut random);
        }
        let text = serde_json::to_string_pretty(&document).expect("JSON");
        match load(&text) {
            Ok(texture) => {
                let options = Options { method: Method::Local, ..Options::default() };
                let outputs = texture.evaluator(&options).evaluate(&footprints());
                prop_assert!(outputs.iter().flatten().all(|x| x.is_finite()), "{text}");
            }
            Err(mistakes) => located(&mistakes, &text),
        }
    }

    #[test]
    fn truncated_and_garbled_texts_give_located_diagnostics(seed: u64) {
        let mut random = Random::new(seed);
        let originals = all();
        let mut bytes = random.choose(&originals).text.clone().into_bytes();
        bytes.truncate(1 + random.below(2 * bytes.len()));
        for _ in 0..random.below(4) {
            let index = random.below(bytes.len());
            bytes[index] = *random.choose(b"{}[]\",:0e-x\\\n");
        }
        let text = String::from_utf8_lossy(&bytes).into_owned();
        if let Err(mistakes) = load(&text) {
            located(&mistakes, &text);
        }
    }
}

/// Groups of nodes in a chain of mixes, so many that modes are lowered and written on threads; with
/// regions that are fused into tables, or without.
fn chain(groups: usize, fused: bool) -> String {
    let mut nodes = serde_json::Map::new();
    let mut before = json!(0.3);
    for i in 0..groups {
        let noise = json!({ "type": "fractal2d", "inputs": { "frequency": { "input": "scale" }, "seed": i } });
        let turbulence =
            json!({ "type": "absval", "inputs": { "in": { "node": format!("noise{i}") } } });
        let of = if fused { "turbulence" } else { "noise" };
        let mask = json!({ "type": "smoothstep", "inputs": { "in": { "node": format!("{of}{i}") }, "low": 0.1, "high": 0.3 } });
        let stripes = json!({ "type": "stripes", "inputs": { "frequency": 3 + i } });
        let mix = json!({ "type": "mix", "inputs": { "bg": before, "fg": { "node": format!("stripes{i}") }, "mix": { "node": format!("mask{i}") } } });
        let named = [
            ("noise", noise),
            ("turbulence", turbulence),
            ("mask", mask),
            ("stripes", stripes),
            ("mix", mix),
        ];
        nodes.extend(named.map(|(name, node)| (format!("{name}{i}"), node)));
        before = json!({ "node": format!("mix{i}") });
    }
    let last = groups - 1;
    let graph = json!({
        "version": 1,
        "name": "chain",
        "inputs": { "scale": { "type": "float", "value": 4, "min": 0.5, "max": 64 } },
        "nodes": nodes,
        "outputs": { "out": before, "edge": { "node": format!("turbulence{last}") } },
    });
    graph.to_string()
}

/// What a process has compiled before, and what it compiles at the same time, does not show.
#[test]
fn compilations_beside_each_other_give_the_same_text() {
    let graphs = [chain(20, false), chain(16, true), chain(2, false)];
    let text = |json: &String| {
        let texture = Texture::from_json(json).expect("the graph has no mistakes");
        let program = texture.compile(&Options::default());
        assert_eq!(verify(&program.module), Ok(()));
        emit(&program, &Emission::default()).source
    };
    let together: Vec<Vec<String>> = std::thread::scope(|scope| {
        let (graphs, text) = (&graphs, &text);
        let run = |turn: usize| {
            scope.spawn(move || {
                let mut texts = vec![String::new(); 3];
                for i in 0..3 {
                    let place = (turn + i) % 3;
                    texts[place] = text(&graphs[place]);
                }
                texts
            })
        };
        let threads = [0, 1, 2].map(run);
        threads
            .map(|thread| thread.join().expect("no panic"))
            .into()
    });
    for (place, graph) in graphs.iter().enumerate() {
        let after = text(graph);
        validate(&after).expect("valid WGSL");
        for texts in &together {
            assert!(texts[place] == after, "graph {place}");
        }
    }
}
