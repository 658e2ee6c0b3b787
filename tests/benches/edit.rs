//! What an edit of a session costs: graphs of 100 and 1,000 nodes.
//!
//! `cargo bench -p mipless-tests --bench edit` prints Markdown. *edit* is a literal of one node, until it is
//! said what has changed; *WGSL* until the text of the shader is there; *from text* the same by loading the
//! text anew; *input* a value of an input of the graph; *evaluator* from the edit until a picture could be
//! evaluated on the CPU, tables baked; *again* the same for an edit that changes no table.

use mipless::session::{Edit, Session, Setup};
use mipless::{Method, Options, Texture, wgsl};
use mipless_tests::large::graph;
use serde_json::json;
use std::time::Instant;

const RUNS: usize = 15;

fn ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn set(node: &str, input: &str, value: f64) -> Edit {
    let edit = json!({ "edit": "set", "node": node, "input": input, "value": value });
    serde_json::from_value(edit).expect("an edit")
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    println!(
        "| nodes | method | edit, ms | WGSL, ms | from text, ms | input, ms | commit, ms | evaluator, ms |"
    );
    println!("|---:|---|---:|---:|---:|---:|---:|---:|");
    for count in [100, 1_000] {
        for method in [Method::Point, Method::Local] {
            row(count, method);
        }
    }
}

fn row(count: usize, method: Method) {
    let options = Options {
        method,
        ..Options::default()
    };
    let text = graph(count);
    let setup = Setup {
        options,
        ..Setup::default()
    };
    let mut session = Session::open_with(&text, setup).expect("a document");
    let node = format!("grain{}", count / 20);
    let [
        mut edit,
        mut shader,
        mut scratch,
        mut input,
        mut commit,
        mut evaluator,
    ] = [f64::INFINITY; 6];
    for run in 0..RUNS {
        let frequency = 17.0 + run as f64;
        let start = Instant::now();
        session
            .apply(set(&node, "frequency", frequency))
            .expect("a node");
        edit = edit.min(ms(start));
        let compiled = &session.output("out").expect("an output").compiled;
        let source = compiled.shader(&wgsl::Options::default());
        shader = shader.min(ms(start));
        let text = session.to_text();
        let start = Instant::now();
        let texture = Texture::from_json(&text).expect("no mistakes");
        let anew = wgsl::emit(&texture.compile(&options), &wgsl::Options::default());
        scratch = scratch.min(ms(start));
        assert!(anew.source == source.source, "the same bytes");

        let start = Instant::now();
        let scale = json!({ "edit": "set_input", "input": "scale", "value": 4.0 + run as f64 });
        session
            .apply(serde_json::from_value(scale).expect("an edit"))
            .expect("an input");
        input = input.min(ms(start));
        let start = Instant::now();
        session.commit();
        commit = commit.min(ms(start));

        let start = Instant::now();
        session
            .apply(set(&node, "frequency", frequency + 0.5))
            .expect("a node");
        let compiled = &session.output("out").expect("an output").compiled;
        let mut on_cpu = compiled.evaluator();
        on_cpu.evaluate(&[mipless::Footprint::default()]);
        evaluator = evaluator.min(ms(start));
    }
    println!(
        "| {count} | {method} | {edit:.2} | {shader:.2} | {scratch:.2} | {input:.2} | {commit:.2} | {evaluator:.1} |"
    );
}
