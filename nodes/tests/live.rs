//! Functions of one noise that an input of the graph shapes: before the first bend, after the last
//! one, and in between, for the input's default and for other values.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::ir::Program;
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};

/// A noise of unit variance and nodes over it, the last of which is `o`, with the input `p`.
fn program(nodes: &str, method: Method) -> Program {
    let json = format!(
        r#"{{"version":1,"name":"live",
            "inputs":{{"p":{{"type":"float","value":1,"min":0.5,"max":2}}}},
            "nodes":{{"n":{{"type":"spectralnoise2d","inputs":{{"amplitude":4}}}},{nodes}}},
            "outputs":{{"out":{{"node":"o"}}}}}}"#
    );
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|def| def.spec).collect();
    let loaded = load(&json, &specs);
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter: PixelFilter::Gaussian(1.0),
        moments: false,
        seed: 0,
    };
    compile(&checked, catalogue, &options)
}

fn tables(program: &Program) -> usize {
    program.module.tables.len()
}

/// E[f(X)] of a unit Gaussian.
fn expected(f: impl Fn(f64) -> f64) -> f64 {
    let scores = (0..4000).map(|i| 12.0 * (f64::from(i) + 0.5) / 4000.0 - 6.0);
    let (mut sum, mut total) = (0.0, 0.0);
    for x in scores {
        let weight = (-0.5 * x * x).exp();
        sum += weight * f(x);
        total += weight;
    }
    sum / total
}

/// Holds the mean over a footprint of 10⁴ wavelengths against the integral, for several values of
/// the input.
fn holds(program: &Program, bound: f64, f: impl Fn(f64, f64) -> f64) {
    let footprint = Footprint {
        cell: [0; 2],
        uv: [0.3, 0.7],
        du: [1e4, 0.0],
        dv: [0.0, 1e4],
    };
    for p in [1.0f32, 0.6, 1.7] {
        let mean = eval_program::<f64>(program, &[footprint], &[p])[0][0];
        let exact = expected(|x| f(x, p.into()));
        assert!((mean - exact).abs() < bound, "p = {p}: {mean}, not {exact}");
    }
}

fn gain(x: f64) -> f64 {
    let t = (x / 2.0).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

const GAIN: &str = r#""g":{"type":"smoothstep","inputs":{"in":{"node":"a"},"low":0,"high":2}}"#;

#[test]
fn an_input_before_the_first_bend_leaves_a_table_of_what_follows() {
    let nodes = format!(
        r#""m":{{"type":"multiply","inputs":{{"in1":{{"node":"n"}},"in2":{{"input":"p"}}}}}},
        "a":{{"type":"absval","inputs":{{"in":{{"node":"m"}}}}}},{GAIN},
        "o":{{"type":"step","inputs":{{"in":{{"node":"g"}},"edge":0.3}}}}"#
    );
    let program = program(&nodes, Method::Local);
    assert!(tables(&program) > 0);
    // A table of a step errs by up to 0.007 between its texels.
    holds(&program, 0.008, |x, p| {
        if gain((p * x).abs()) >= 0.3 { 1.0 } else { 0.0 }
    });
}

#[test]
fn an_input_after_the_last_bend_scales_a_fused_region() {
    let nodes = format!(
        r#""a":{{"type":"absval","inputs":{{"in":{{"node":"n"}}}}}},{GAIN},
        "h":{{"type":"multiply","inputs":{{"in1":{{"node":"g"}},"in2":8}}}},
        "s":{{"type":"sin","inputs":{{"in":{{"node":"h"}}}}}},
        "o":{{"type":"multiply","inputs":{{"in1":{{"node":"s"}},"in2":{{"input":"p"}}}}}}"#
    );
    let program = program(&nodes, Method::Local);
    assert!(tables(&program) > 0);
    // Two waves and a half of a noise that is Gaussian to 0.003.
    holds(&program, 0.02, |x, p| p * (8.0 * gain(x.abs())).sin());
}

#[test]
fn an_input_between_bends_is_averaged_without_a_table() {
    let nodes = format!(
        r#""a":{{"type":"absval","inputs":{{"in":{{"node":"n"}}}}}},{GAIN},
        "h":{{"type":"multiply","inputs":{{"in1":{{"node":"g"}},"in2":{{"input":"p"}}}}}},
        "w":{{"type":"multiply","inputs":{{"in1":{{"node":"h"}},"in2":8}}}},
        "o":{{"type":"sin","inputs":{{"in":{{"node":"w"}}}}}}"#
    );
    let program = program(&nodes, Method::Local);
    assert_eq!(tables(&program), 0);
    holds(&program, 0.02, |x, p| (8.0 * p * gain(x.abs())).sin());

    let ramp = r#""a":{"type":"absval","inputs":{"in":{"node":"n"}}},
        "h":{"type":"multiply","inputs":{"in1":{"node":"a"},"in2":{"input":"p"}}},
        "o":{"type":"colorramp","inputs":{"in":{"node":"h"},"stops":[
            {"at":0,"value":[0,1,0]},{"at":0.2,"value":[1,0,0]},{"at":0.4,"value":[0,0,1]}]}}"#;
    let program = self::program(ramp, Method::Local);
    assert_eq!(tables(&program), 0);
    // Parts are taken until the mean is off by at most 0.02 of the values.
    holds(&program, 0.01, |x, p| {
        let t = (p * x).abs();
        (5.0 * t).min(2.0 - 5.0 * t).max(0.0)
    });
}

/// The RMS error against samples over footprints of this many wavelengths.
fn error(nodes: &str, size: f32, method: Method) -> f64 {
    let footprints: Vec<Footprint> = (0..300)
        .map(|i| {
            let p = [0.754_877_666, 0.569_840_291]
                .map(|step: f64| (f64::from(i) * step).fract() * 80.0);
            Footprint {
                cell: p.map(|x| x.floor() as i32),
                uv: p.map(|x| x.fract() as f32),
                du: [size, 0.0],
                dv: [0.0, size],
            }
        })
        .collect();
    let run =
        |method| eval_program::<f32>(&program(nodes, method), &footprints, &[1.0]).swap_remove(0);
    let (found, truth) = (run(method), run(Method::Supersample(1024)));
    let square = |(a, b): (&f32, &f32)| f64::from(a - b).powi(2);
    (found.iter().zip(&truth).map(square).sum::<f64>() / 300.0).sqrt()
}

#[test]
fn a_live_input_costs_little_accuracy_at_any_footprint() {
    let nodes = |p: &str| {
        format!(
            r#""a":{{"type":"absval","inputs":{{"in":{{"node":"n"}}}}}},{GAIN},
            "h":{{"type":"multiply","inputs":{{"in1":{{"node":"g"}},"in2":{p}}}}},
            "w":{{"type":"multiply","inputs":{{"in1":{{"node":"h"}},"in2":8}}}},
            "o":{{"type":"sin","inputs":{{"in":{{"node":"w"}}}}}}"#
        )
    };
    for method in [Method::Local, Method::Quad] {
        let (mut live, mut baked) = (0.0, 0.0);
        for size in [0.03, 0.1, 0.2, 0.5, 1.0] {
            live += error(&nodes(r#"{"input":"p"}"#), size, method).powi(2);
            baked += error(&nodes("1"), size, method).powi(2);
        }
        println!(
            "{method}: {} live, {} baked",
            (live / 5.0).sqrt(),
            (baked / 5.0).sqrt()
        );
        assert!(live < 1.15 * baked, "{method}: {live} and {baked}");
    }
}

#[test]
fn a_live_amplitude_of_the_noise_is_averaged() {
    let nodes = r#""m":{"type":"spectralnoise2d","inputs":{"amplitude":{"input":"p"}}},
        "a":{"type":"absval","inputs":{"in":{"node":"m"}}},
        "o":{"type":"colorramp","inputs":{"in":{"node":"a"},"stops":[
            {"at":0,"value":0},{"at":0.05,"value":1},{"at":0.1,"value":0}]}}"#;
    let program = program(nodes, Method::Local);
    holds(&program, 0.01, |x, p| {
        let t = (0.25 * p * x).abs();
        (20.0 * t).min(2.0 - 20.0 * t).max(0.0)
    });
}
