//! Coordinates keep their integer cell through factors of any size and through all that repeats:
//! what is right at the origin is right 10⁶ units away.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};
use std::f64::consts::TAU;

/// The first coordinate u, and nodes after it, the last of which is `out`.
fn graph(nodes: &str) -> String {
    format!(
        r#"{{"version":1,"name":"g","nodes":{{"uv":{{"type":"texcoord"}},
            "u":{{"type":"extract","inputs":{{"in":{{"node":"uv"}}}}}},{nodes}}},
            "outputs":{{"out":{{"node":"out"}}}}}}"#
    )
}

fn node(name: &str, kind: &str, inputs: &str) -> String {
    format!(r#""{name}":{{"type":"{kind}","inputs":{{{inputs}}}}}"#)
}

/// The means of a graph in f32 at u = cell + fraction, over pixels of a size.
fn means(json: &str, method: Method, places: &[(i32, f32)], size: f32) -> Vec<f64> {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(json, &specs);
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{json}: {:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter: PixelFilter::Gaussian(0.5),
        moments: false,
        seed: 0,
    };
    let footprint = |&(cell, fraction): &(i32, f32)| Footprint {
        cell: [cell, 0],
        uv: [fraction, 0.25],
        du: [size, 0.0],
        dv: [0.0, size],
    };
    let footprints: Vec<Footprint> = places.iter().map(footprint).collect();
    let program = compile(&checked, catalogue, &options);
    let out = eval_program::<f32>(&program, &footprints, &[]);
    out[0].iter().map(|&x| f64::from(x)).collect()
}

const METHODS: [Method; 4] = [Method::Point, Method::Local, Method::Quad, Method::Auto];

const CELLS: [i32; 9] = [0, -1, 1, 7, -100, 12_345, -12_345, 1_000_000, -999_999];

/// Eight pixels of a unit: an edge in its middle leaves four on either side.
fn eighths(cell: i32) -> Vec<(i32, f32)> {
    (0..8).map(|i| (cell, (i as f32 + 0.5) / 8.0)).collect()
}

#[test]
fn a_large_factor_makes_a_hard_edge_of_a_coordinate() {
    let edge = |cell: i32| {
        // In two steps, since no f32 is 10⁶ + ½.
        node(
            "cell",
            "subtract",
            &format!(r#""in1":{{"node":"u"}},"in2":{cell}"#),
        ) + ","
            + &node("half", "subtract", r#""in1":{"node":"cell"},"in2":0.5"#)
    };
    for factor in [
        1e5,
        600_000.5,
        999_999.0,
        1e6,
        2_000_003.0,
        1e8,
        123_456_789.0,
        1e12,
        1e20,
        1e37,
    ] {
        for cell in CELLS {
            let json = graph(&format!(
                "{},{},{}",
                edge(cell),
                node(
                    "steep",
                    "multiply",
                    &format!(r#""in1":{{"node":"half"}},"in2":{factor:e}"#)
                ),
                node("out", "clamp", r#""in":{"node":"steep"}"#),
            ));
            for method in METHODS {
                let found = means(&json, method, &eighths(cell), 1e-9);
                for (x, right) in found.iter().zip([0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]) {
                    assert!(
                        (x - right).abs() < 1e-6,
                        "factor {factor:e} in cell {cell} by {method}: {found:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_range_of_hardly_any_width_makes_a_hard_edge_of_a_coordinate() {
    for width in [1e-3f32, 1e-5, 1.9e-6, 1.2e-6] {
        let (low, high) = (0.5 - 0.5 * width, 0.5 + 0.5 * width);
        let bounds = format!(r#""in":{{"node":"u"}},"inlow":{low:?},"inhigh":{high:?}"#);
        let contrast = format!(
            "{},{}",
            node(
                "steep",
                "contrast",
                &format!(
                    r#""in":{{"node":"u"}},"amount":{:?},"pivot":0.5"#,
                    1.0 / width
                )
            ),
            node("out", "clamp", r#""in":{"node":"steep"}"#),
        );
        let graphs = [
            graph(&node(
                "out",
                "range",
                &format!(r#"{bounds},"doclamp":true"#),
            )),
            graph(&node(
                "out",
                "levels",
                &format!(r#"{bounds},"doclamp":true"#),
            )),
            graph(&node(
                "out",
                "smoothstep",
                &format!(r#""in":{{"node":"u"}},"low":{low:?},"high":{high:?}"#),
            )),
            graph(&contrast),
        ];
        for json in graphs {
            for method in METHODS {
                let places: Vec<_> = [-3, 0, 4].into_iter().flat_map(eighths).collect();
                let found = means(&json, method, &places, 1e-9);
                for (x, (cell, fraction)) in found.iter().zip(&places) {
                    let right = f64::from(u8::from(*cell as f32 + fraction > 0.5));
                    assert!(
                        (x - right).abs() < 1e-6,
                        "{json} by {method} at {cell} + {fraction}: {x}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_coordinate_times_a_number_is_the_product() {
    let fractions = [0.0, 0.125, 0.5, 0.75];
    let places: Vec<_> = (CELLS.into_iter())
        .flat_map(|cell| fractions.map(|fraction| (cell, fraction)))
        .collect();
    for factor in [
        1e-9,
        0.1,
        1.0 / 3.0,
        7.0,
        4096.5,
        524_289.25,
        600_000.5,
        1e6,
        1e8,
        3e12,
        -1e9,
        1e30,
    ] {
        let json = graph(&node(
            "out",
            "multiply",
            &format!(r#""in1":{{"node":"u"}},"in2":{factor:e}"#),
        ));
        for method in METHODS {
            for (found, &(cell, fraction)) in means(&json, method, &places, 0.0).iter().zip(&places)
            {
                let right = (f64::from(cell) + f64::from(fraction)) * f64::from(factor as f32);
                assert!(
                    (found - right).abs() <= 3e-7 * right.abs() + 1.5e-7,
                    "({cell} + {fraction}) · {factor:e} by {method}: {found}, not {right}"
                );
            }
        }
    }
}

/// What repeats, of u.
type Wave = Box<dyn Fn(f64) -> f64>;

/// Graphs that repeat, and what they are.
fn waves() -> Vec<(String, Wave)> {
    let times = |factor: f32| {
        node(
            "x",
            "multiply",
            &format!(r#""in1":{{"node":"u"}},"in2":{factor:?}"#),
        )
    };
    let of = |kind: &str, factor: f32| {
        graph(&format!(
            "{},{}",
            times(factor),
            node("out", kind, r#""in":{"node":"x"}"#)
        ))
    };
    let angle = |factor: f32, u: f64| {
        // 2π is meant by the f32 next to it.
        f64::from(factor) / f64::from(std::f32::consts::TAU) * u * TAU
    };
    let mut all: Vec<(String, Wave)> = Vec::new();
    for factor in [std::f32::consts::TAU, 40.0, 3.3] {
        all.push((of("sin", factor), Box::new(move |u| angle(factor, u).sin())));
        all.push((of("cos", factor), Box::new(move |u| angle(factor, u).cos())));
        let factor64 = f64::from(factor);
        all.push((
            of("fract", factor),
            Box::new(move |u| (factor64 * u).rem_euclid(1.0)),
        ));
    }
    for divisor in [1.0f32, 3.0, 0.21, 0.7, 1e-2] {
        let of = format!(r#""in1":{{"node":"u"}},"in2":{divisor:?}"#);
        let divisor = f64::from(divisor);
        all.push((
            graph(&node("out", "modulo", &of)),
            Box::new(move |u| u.rem_euclid(divisor)),
        ));
        // Whole parts of a far coordinate are large: two of them, one from the other.
        all.push((
            graph(&format!(
                "{},{},{},{}",
                node("x", "divide", &of),
                node("less", "subtract", r#""in1":{"node":"x"},"in2":0.25"#),
                [("a", "x"), ("b", "less")]
                    .map(|(name, of)| node(name, "floor", &format!(r#""in":{{"node":"{of}"}}"#)))
                    .join(","),
                node(
                    "out",
                    "subtract",
                    r#""in1":{"node":"a"},"in2":{"node":"b"}"#
                ),
            )),
            Box::new(move |u| (u / divisor).floor() - (u / divisor - 0.25).floor()),
        ));
    }
    // Through a chain that is baked.
    let chain = format!(
        "{},{},{}",
        times(40.0),
        node("s", "sin", r#""in":{"node":"x"}"#),
        node(
            "out",
            "smoothstep",
            r#""in":{"node":"s"},"low":0.2,"high":0.5"#
        ),
    );
    all.push((
        graph(&chain),
        Box::new(move |u| {
            let t = ((angle(40.0, u).sin() - 0.2) / 0.3).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        }),
    ));
    all
}

#[test]
fn what_repeats_is_right_a_million_units_from_the_origin() {
    let fractions = (0..32).map(|i| ((i as f32 + 0.5) * 0.618_034).fract());
    let places: Vec<_> = (CELLS.into_iter())
        .flat_map(|cell| fractions.clone().map(move |fraction| (cell, fraction)))
        .collect();
    for (json, wave) in waves() {
        for method in METHODS {
            let found = means(&json, method, &places, 1e-9);
            let off = |(found, &(cell, fraction)): (&f64, &(i32, f32))| {
                let right = wave(f64::from(cell) + f64::from(fraction));
                (found - right).abs() > 2e-5
            };
            // At most 2 in a hundred places lie where an edge runs through.
            let count = found.iter().zip(&places).filter(|&pair| off(pair)).count();
            assert!(
                count <= 6,
                "{json} by {method}: {count} of {}",
                places.len()
            );
        }
    }
}
