//! Where functions of one and of two noises are read from tables, and how right that is far away.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};

/// Four noises of unit variance and nodes over them, the last of which is `o`.
fn graph(nodes: &str) -> String {
    let noises: Vec<String> = (0..4)
        .map(|i| {
            format!(
                r#""n{i}":{{"type":"spectralnoise2d","inputs":{{"amplitude":4,"seed":{}}}}}"#,
                7 * i
            )
        })
        .collect();
    format!(
        r#"{{"version":1,"name":"pair","nodes":{{{},{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#,
        noises.join(",")
    )
}

/// The mean over a footprint of 10⁴ wavelengths, and the bytes of tables.
fn far(nodes: &str) -> (f64, usize) {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|def| def.spec).collect();
    let loaded = load(&graph(nodes), &specs);
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method: Method::Local,
        filter: PixelFilter::Gaussian(1.0),
        moments: false,
        seed: 0,
    };
    let program = compile(&checked, catalogue, &options);
    let footprint = Footprint {
        cell: [0; 2],
        uv: [0.3, 0.7],
        du: [1e4, 0.0],
        dv: [0.0, 1e4],
    };
    let mean = eval_program::<f64>(&program, &[footprint], &[])[0][0];
    let tables = program.module.tables.iter();
    (mean, tables.map(|t| 4 * t.data.len()).sum())
}

/// E[f(X, Y)] of independent unit Gaussians.
fn expected(f: impl Fn(f64, f64) -> f64) -> f64 {
    let n = 1200;
    let scores = (0..n).map(|i| 12.0 * (f64::from(i) + 0.5) / f64::from(n) - 6.0);
    let scores: Vec<f64> = scores.collect();
    let weight = |z: &f64| (-0.5 * z * z).exp();
    let total: f64 = scores.iter().map(weight).sum();
    let sum: f64 = (scores.iter())
        .map(|x| {
            let inner: f64 = scores.iter().map(|y| weight(y) * f(*x, *y)).sum();
            weight(x) * inner
        })
        .sum();
    sum / (total * total)
}

#[test]
fn a_step_of_a_product_is_fused() {
    let (mean, bytes) = far(
        r#""m":{"type":"multiply","inputs":{"in1":{"node":"n0"},"in2":{"node":"n1"}}},"o":{"type":"step","inputs":{"in":{"node":"m"},"edge":0.3}}"#,
    );
    let exact = expected(|x, y| if x * y >= 0.3 { 1.0 } else { 0.0 });
    assert!((mean - exact).abs() < 0.004, "{mean}, not {exact}");
    assert!(bytes > 0 && bytes < 1_000_000, "{bytes}");
}

#[test]
fn a_step_of_a_step_and_a_noise_is_fused() {
    let (mean, _) = far(
        r#""s":{"type":"step","inputs":{"in":{"node":"n0"},"edge":0.2}},"h":{"type":"multiply","inputs":{"in1":{"node":"n1"},"in2":0.25}},"t":{"type":"add","inputs":{"in1":{"node":"s"},"in2":{"node":"h"}}},"o":{"type":"step","inputs":{"in":{"node":"t"},"edge":0.7}}"#,
    );
    let of = |x: f64| if x >= 0.2 { 1.0 } else { 0.0 };
    let exact = expected(|x, y| if of(x) + 0.25 * y >= 0.7 { 1.0 } else { 0.0 });
    assert!((mean - exact).abs() < 0.004, "{mean}, not {exact}");
}

#[test]
fn a_sum_of_many_is_its_widest_term_and_a_gaussian_rest() {
    let (mean, _) = far(
        r#""a":{"type":"absval","inputs":{"in":{"node":"n0"}}},"h1":{"type":"multiply","inputs":{"in1":{"node":"n1"},"in2":0.3}},"h2":{"type":"multiply","inputs":{"in1":{"node":"n2"},"in2":0.2}},"h3":{"type":"multiply","inputs":{"in1":{"node":"n3"},"in2":0.1}},"t1":{"type":"add","inputs":{"in1":{"node":"a"},"in2":{"node":"h1"}}},"t2":{"type":"add","inputs":{"in1":{"node":"h2"},"in2":{"node":"t1"}}},"t":{"type":"add","inputs":{"in1":{"node":"t2"},"in2":{"node":"h3"}}},"o":{"type":"smoothstep","inputs":{"in":{"node":"t"},"low":0.2,"high":0.6}}"#,
    );
    let rest = (0.09f64 + 0.04 + 0.01).sqrt();
    let exact = expected(|x, y| {
        let t = ((x.abs() + rest * y - 0.2) / 0.4).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    });
    assert!((mean - exact).abs() < 0.004, "{mean}, not {exact}");
}

#[test]
fn what_closing_gets_right_has_no_table() {
    let (mean, bytes) = far(
        r#""m":{"type":"max","inputs":{"in1":{"node":"n0"},"in2":{"node":"n1"}}},"o":{"type":"clamp","inputs":{"in":{"node":"m"},"low":-1,"high":1}}"#,
    );
    let exact = expected(|x, y| x.max(y).clamp(-1.0, 1.0));
    assert!((mean - exact).abs() < 0.01, "{mean}, not {exact}");
    assert_eq!(bytes, 0);
}

#[test]
fn short_ramps_have_no_table_and_long_ones_a_small_one() {
    let ramp = |count: i32| {
        let stops: Vec<String> = (0..count)
            .map(|i| {
                let at = 4.0 * f64::from(i) / f64::from(count - 1) - 2.0;
                format!(r#"{{"at":{at},"value":{}}}"#, i * 3 % 5)
            })
            .collect();
        let node = format!(
            r#""o":{{"type":"colorramp","inputs":{{"in":{{"node":"n0"}},"interpolation":"constant","stops":[{}]}}}}"#,
            stops.join(",")
        );
        let exact = expected(|x, _| {
            let below = ((x + 2.0) * f64::from(count - 1) / 4.0).floor() as i32;
            f64::from(below.clamp(0, count - 1) * 3 % 5)
        });
        let (mean, bytes) = far(&node);
        assert!((mean - exact).abs() < 0.02, "{count}: {mean}, not {exact}");
        bytes
    };
    assert_eq!(ramp(4), 0);
    let bytes = ramp(12);
    assert!(bytes > 0 && bytes <= 10_000, "{bytes}");
}

#[test]
fn long_ramps_of_colours_compile_by_every_method() {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|def| def.spec).collect();
    for interpolation in ["constant", "linear", "smooth", "cubic"] {
        let stops: Vec<String> = (0..128)
            .map(|i| {
                let channel = |k: i32| f64::from(i * k % 11) / 10.0;
                let [r, g, b] = [3, 5, 7].map(channel);
                format!(
                    r#"{{"at":{},"value":[{r},{g},{b}]}}"#,
                    f64::from(i) / 16.0 - 4.0
                )
            })
            .collect();
        let nodes = format!(
            r#""o":{{"type":"colorramp","inputs":{{"in":{{"node":"n0"}},"interpolation":"{interpolation}","stops":[{}]}}}}"#,
            stops.join(",")
        );
        let loaded = load(&graph(&nodes), &specs);
        let graph = loaded
            .graph
            .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
        let checked = check(graph, &CheckOptions::default()).expect("checks");
        for method in [Method::Point, Method::Ensemble, Method::Auto] {
            let options = Options {
                method,
                ..Options::default()
            };
            let program = compile(&checked, catalogue, &options);
            let footprint = Footprint {
                uv: [0.3, 0.4],
                du: [0.01, 0.0],
                dv: [0.0, 0.01],
                ..Footprint::default()
            };
            let color = eval_program::<f32>(&program, &[footprint], &[]);
            for channel in &color {
                assert!(
                    (-0.1..=1.1).contains(&channel[0]),
                    "{interpolation} {method}: {}",
                    channel[0]
                );
            }
        }
    }
}
