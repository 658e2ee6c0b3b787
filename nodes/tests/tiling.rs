//! Lattices that repeat, and lattices that cannot.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};

fn graph(node: &str) -> String {
    format!(
        r#"{{"version":1,"name":"n","nodes":{{"n":{node}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
    )
}

/// Mean and variance in f32 over footprints.
fn evaluate(node: &str, method: Method, footprints: &[Footprint]) -> Vec<Vec<f32>> {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(&graph(node), &specs);
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter: PixelFilter::Gaussian(1.0),
        moments: true,
        seed: 0,
    };
    let program = compile(&checked, catalogue, &options);
    eval_program::<f32>(&program, footprints, &[])
}

/// Footprints of several sizes and shapes, moved by whole cells.
fn footprints(shift: [i32; 2]) -> Vec<Footprint> {
    (0..240)
        .map(|i| {
            let at = |by: f64| (f64::from(i) * by).fract();
            let size = 0.004 * 2f64.powi(i % 9);
            let (sin, cos) = (0.7 * f64::from(i)).sin_cos();
            let (du, dv) = (size, size * if i % 2 == 0 { 1.0 } else { 6.0 });
            Footprint {
                cell: [(i % 11) - 5 + shift[0], (i % 7) - 3 + shift[1]],
                uv: [at(0.754_877_666) as f32, at(0.569_840_29) as f32],
                du: [(du * cos) as f32, (du * sin) as f32],
                dv: [(-dv * sin) as f32, (dv * cos) as f32],
            }
        })
        .collect()
}

const METHODS: [Method; 3] = [Method::Point, Method::Local, Method::Quad];

#[test]
fn a_period_repeats_to_the_bit() {
    for (node, period) in [
        (r#"{"type":"noise2d","inputs":{"period":1}}"#, 1),
        (r#"{"type":"noise2d","inputs":{"period":5}}"#, 5),
        (
            r#"{"type":"noise2d","inputs":{"period":1,"kernel":"quintic"}}"#,
            1,
        ),
        (
            r#"{"type":"fractal2d","inputs":{"period":5,"kernel":"quintic","octaves":2.5}}"#,
            5,
        ),
        (r#"{"type":"valuenoise2d","inputs":{"period":7}}"#, 7),
        (
            r#"{"type":"valuenoise2d","inputs":{"period":2,"period_v":3}}"#,
            6,
        ),
        (
            r#"{"type":"valuenoise2d","inputs":{"period":3,"period_v":1,"hash":"materialmaker","seed":5}}"#,
            3,
        ),
        (
            r#"{"type":"turbulence2d","inputs":{"period":3,"octaves":2}}"#,
            3,
        ),
        (
            r#"{"type":"fractal2d","inputs":{"period":3,"octaves":4}}"#,
            3,
        ),
        (
            r#"{"type":"fractal2d","inputs":{"period":8,"octaves":4,"lacunarity":1.5}}"#,
            8,
        ),
    ] {
        for method in METHODS {
            let here = evaluate(node, method, &footprints([0, 0]));
            for turns in [[1, 0], [0, -1], [-3, 2], [100_000, -100_000]] {
                let there = evaluate(node, method, &footprints(turns.map(|n| n * period)));
                assert_eq!(here, there, "{node} by {method} after {turns:?} periods");
            }
        }
    }
}

#[test]
fn nothing_repeats_sooner_than_its_period() {
    for (node, shift) in [
        (r#"{"type":"noise2d","inputs":{"period":6}}"#, 3),
        (r#"{"type":"noise2d","inputs":{"period":6}}"#, 5),
        (r#"{"type":"noise2d"}"#, 6),
    ] {
        let here = evaluate(node, Method::Point, &footprints([0, 0]));
        let there = evaluate(node, Method::Point, &footprints([shift, 0]));
        let difference = here[0].iter().zip(&there[0]).map(|(a, b)| (a - b).powi(2));
        let rms = (difference.sum::<f32>() / here[0].len() as f32).sqrt();
        // Two independent noises of standard deviation ¼ differ by √2/4.
        assert!((0.28..0.43).contains(&rms), "{node} after {shift}: {rms}");
    }
}

#[test]
fn a_period_that_an_octave_cannot_have_is_refused_where_it_stands() {
    let specs = mipless_nodes::specs();
    for (node, fits) in [
        (
            r#"{"type":"fractal2d","inputs":{"period":4,"lacunarity":1.5,"octaves":3}}"#,
            true,
        ),
        (
            r#"{"type":"fractal2d","inputs":{"period":4,"lacunarity":1.5,"octaves":4}}"#,
            false,
        ),
        (
            r#"{"type":"fractal2d","inputs":{"period":4,"lacunarity":2.1,"octaves":2}}"#,
            false,
        ),
        (
            r#"{"type":"fractal2d","inputs":{"period":65536,"octaves":6}}"#,
            false,
        ),
        (
            r#"{"type":"fractal2d","inputs":{"lacunarity":2.1,"octaves":16}}"#,
            true,
        ),
    ] {
        let loaded = load(&graph(node), &specs);
        let graph = loaded.graph.expect("resolves");
        let result = check(graph, &CheckOptions::default());
        assert_eq!(result.is_ok(), fits, "{node}: {result:?}");
        if let Err(diagnostics) = result {
            assert_eq!(diagnostics[0].code, "inputs-disagree");
            assert_eq!(
                diagnostics[0].pointer.as_deref(),
                Some("/nodes/n/inputs/period")
            );
        }
    }
}
