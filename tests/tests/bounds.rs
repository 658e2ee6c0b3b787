//! Nodes with two bounds, in order, equal and crossed, as literals, as inputs of the graph and as
//! signals: what filters is, over a vanishing footprint, what a point has, and over a footprint the
//! mean of the points in it.

use mipless::{Footprint, Method, Options, Texture};
use mipless_tests::METHODS;
use mipless_tests::tolerance::{BOUNDED, VANISHING};
use serde_json::{Value, json};

/// How a bound is given.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Literal,
    Live,
    Varying,
}

/// The pairs of ports that are a low and a high bound, by the names that such ports have.
const PAIRS: [[&str; 2]; 4] = [
    ["low", "high"],
    ["inlow", "inhigh"],
    ["outlow", "outhigh"],
    ["outmin", "outmax"],
];

/// Every node of the catalogue that has such a pair, each with settings of its other inputs.
fn nodes() -> Vec<(&'static str, [&'static str; 2], Value)> {
    let mut found = Vec::new();
    for spec in mipless::specs() {
        for pair in PAIRS {
            let uniform = |name: &str| spec.input(name).map(|at| spec.inputs[at].uniform);
            if pair.map(uniform) != [Some(false); 2] {
                continue;
            }
            let mut settings = vec![json!({})];
            for flag in ["doclamp", "clampoutput"] {
                if spec.input(flag).is_some() {
                    settings = vec![json!({ flag: false }), json!({ flag: true })];
                }
            }
            if spec.input("gamma").is_some() {
                for other in settings.clone() {
                    let mut other = other;
                    other["gamma"] = json!(2.2);
                    settings.push(other);
                }
            }
            found.extend(settings.into_iter().map(|other| (spec.name, pair, other)));
        }
    }
    found
}

/// `low` and `high` at these values, of this kind, on the signal of a wave and a noise.
fn graph(node: (&str, [&str; 2], Value), kind: Kind, bounds: [f32; 2]) -> Texture {
    let (ty, ports, settings) = node;
    let mut inputs = settings;
    let mut document = json!({
        "version": 1,
        "inputs": {},
        "nodes": {
            "signal": { "type": "noise2d",
                "inputs": { "frequency": 3, "amplitude": 1.5, "pivot": 0.5, "seed": 4 } },
        },
        "outputs": { "out": { "node": "bounded" } }
    });
    for (index, (port, value)) in ports.into_iter().zip(bounds).enumerate() {
        inputs[port] = match kind {
            Kind::Literal => json!(value),
            Kind::Live => {
                document["inputs"][port] =
                    json!({ "type": "float", "value": value, "min": -2, "max": 2 });
                json!({ "input": port })
            }
            Kind::Varying => {
                document["nodes"][port] = json!({ "type": "noise2d", "inputs": {
                    "frequency": 2, "amplitude": 0.1, "pivot": value, "seed": 5 + index } });
                json!({ "node": port })
            }
        };
    }
    let spec = mipless::specs().into_iter().find(|spec| spec.name == ty);
    if spec.is_some_and(|spec| spec.input("in").is_some()) {
        inputs["in"] = json!({ "node": "signal" });
    }
    document["nodes"]["bounded"] = json!({ "type": ty, "inputs": inputs });
    Texture::from_json(&document.to_string()).unwrap_or_else(|mistakes| panic!("{mistakes:?}"))
}

const KINDS: [Kind; 3] = [Kind::Literal, Kind::Live, Kind::Varying];

/// In order, equal, close, and crossed.
const BOUNDS: [[f32; 2]; 5] = [
    [0.3, 0.7],
    [0.5, 0.5],
    [0.5, 0.500_000_5],
    [0.7, 0.3],
    [0.5001, 0.5],
];

const PLACES: usize = 128;

/// Places that no symmetry of a noise or a pattern prefers.
fn footprints(size: f32) -> Vec<Footprint> {
    (0..PLACES)
        .map(|i| Footprint {
            uv: [
                0.013 + 0.754_877_7 * i as f32,
                0.37 + 0.569_840_3 * i as f32,
            ]
            .map(f32::fract),
            du: [size, 0.0],
            dv: [0.0, size],
            ..Footprint::default()
        })
        .collect()
}

fn values(texture: &Texture, method: Method, footprints: &[Footprint]) -> Vec<f32> {
    let options = Options {
        method,
        ..Options::default()
    };
    texture
        .evaluator(&options)
        .evaluate(footprints)
        .swap_remove(0)
}

#[test]
fn bounds_in_any_order_give_the_points_value_where_the_footprint_vanishes() {
    let all = nodes();
    assert!(all.len() >= 12, "{all:?}");
    let footprints = footprints(1e-7);
    let mut failures = Vec::new();
    for node in all {
        for (kind, bounds) in KINDS.into_iter().flat_map(|kind| BOUNDS.map(|b| (kind, b))) {
            let texture = graph(node.clone(), kind, bounds);
            let truth = values(&texture, Method::Point, &footprints);
            for method in METHODS {
                let got = values(&texture, method, &footprints);
                let off = |x: f32, y: f32| f64::from((x - y).abs() / y.abs().max(1.0)) > VANISHING;
                let wrong = got.iter().zip(&truth).filter(|&(&x, &y)| off(x, y)).count();
                if wrong > 2 {
                    failures.push(format!(
                        "{node:?} {kind:?} {bounds:?} by {method}: {wrong} of {PLACES}"
                    ));
                }
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{}\n{}",
        failures.len(),
        failures.join("\n")
    );
}

#[test]
fn bounds_in_any_order_filter_to_the_mean_of_the_points() {
    let footprints = footprints(0.04);
    let mut failures = Vec::new();
    for node in nodes() {
        let bounds = [[0.3, 0.7], [0.5, 0.5], [0.7, 0.3]];
        for (kind, bounds) in KINDS.into_iter().flat_map(|kind| bounds.map(|b| (kind, b))) {
            let texture = graph(node.clone(), kind, bounds);
            // A width that may be 0 has no moments: the check says so.
            if texture
                .warnings()
                .iter()
                .any(|warning| warning.code == "no-moments")
            {
                continue;
            }
            let truth = values(&texture, Method::Supersample(256), &footprints);
            let largest = truth.iter().fold(1.0, |most: f32, y| most.max(y.abs()));
            for method in [Method::Local, Method::Quad, Method::Split(4), Method::Auto] {
                let got = values(&texture, method, &footprints);
                let squares = got
                    .iter()
                    .zip(&truth)
                    .map(|(x, y)| ((x - y) / largest).powi(2));
                let error = (squares.sum::<f32>() / PLACES as f32).sqrt();
                if error.is_nan() || f64::from(error) >= BOUNDED {
                    failures.push(format!("{node:?} {kind:?} {bounds:?} by {method}: {error}"));
                }
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{}\n{}",
        failures.len(),
        failures.join("\n")
    );
}
