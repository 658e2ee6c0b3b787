//! What the check says of the values that signals can have holds for the values that points have, and
//! dividing by what may be 0 is said where it is done.

use mipless::{CheckOptions, Footprint, Method, Options, Texture};
use mipless_tests::case::{all, load};
use mipless_tests::tolerance::RANGE;
use mipless_tests::varied::varied;
use serde_json::{Value, json};

/// Places within a few units of the origin, all over a node's pattern.
fn places() -> Vec<Footprint> {
    (0..512)
        .map(|i| Footprint {
            cell: [i / 100, 3 - i / 70],
            uv: [0.754_877_7 * i as f32, 0.569_840_3 * i as f32].map(f32::fract),
            ..Footprint::default()
        })
        .collect()
}

/// The first value of an output that its node should not have.
fn outside(texture: &Texture, places: &[Footprint]) -> Option<String> {
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let mut components = texture.evaluator(&options).evaluate(places).into_iter();
    for output in texture.outputs() {
        let reach = texture.checked().signal(output.node).reach;
        for (i, values) in components.by_ref().take(output.ty.components()).enumerate() {
            let interval = reach.0[i];
            let slack = RANGE as f32
                * [interval.low, interval.high, 1.0]
                    .iter()
                    .fold(0.0, |most, end| {
                        if end.is_finite() {
                            f32::max(most, end.abs())
                        } else {
                            most
                        }
                    });
            let fits = |x: f32| interval.low - slack <= x && x <= interval.high + slack;
            if let Some(wrong) = values.into_iter().find(|&x| !fits(x)) {
                return Some(format!(
                    "component {i} of `{}` is {wrong}, not {interval}",
                    output.name
                ));
            }
        }
    }
    None
}

#[test]
fn no_point_has_a_value_that_the_check_excludes() {
    let places = places();
    let given = all().into_iter().map(|case| (case.name, case.text));
    let mut failures = Vec::new();
    let (mut graphs, mut bounded) = (0, 0);
    for (name, text) in given.chain(varied()) {
        let Ok(texture) = load(&text) else { continue };
        graphs += 1;
        bounded += usize::from(
            texture
                .signals()
                .iter()
                .all(|signal| signal.reach.0[0].is_bounded()),
        );
        failures.extend(outside(&texture, &places).map(|what| format!("{name}: {what}")));
    }
    assert!(graphs > 500 && bounded > 100, "{bounded} of {graphs}");
    assert!(
        failures.is_empty(),
        "{} of {graphs}:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

/// The codes and ports that are reported of a graph of these nodes, whose output is `t`.
fn reported(inputs: Value, nodes: Value) -> Vec<(&'static str, Option<String>, Option<String>)> {
    let graph = json!({ "version": 1, "inputs": inputs, "nodes": nodes,
        "outputs": { "out": { "node": "t" } } });
    let options = CheckOptions::default();
    let diagnostics = match Texture::with_options(&graph.to_string(), &options) {
        Ok(texture) => texture.warnings().to_vec(),
        Err(mistakes) => mistakes,
    };
    (diagnostics.into_iter())
        .map(|diagnostic| (diagnostic.code, diagnostic.node, diagnostic.port))
        .collect()
}

fn divided_by(divisor: Value, more: Value) -> Vec<(&'static str, Option<String>, Option<String>)> {
    let mut nodes = json!({ "n": { "type": "noise2d" },
        "t": { "type": "divide", "inputs": { "in1": { "node": "n" }, "in2": divisor } } });
    for (name, node) in more.as_object().expect("nodes") {
        nodes[name] = node.clone();
    }
    reported(
        json!({ "k": { "type": "float", "value": 1, "min": -1, "max": 2 } }),
        nodes,
    )
}

fn at(
    code: &'static str,
    node: &str,
    port: &str,
) -> Vec<(&'static str, Option<String>, Option<String>)> {
    vec![(code, Some(node.to_owned()), Some(port.to_owned()))]
}

#[test]
fn a_divisor_that_is_zero_everywhere_is_a_mistake_at_its_port_whatever_makes_it() {
    let error = at("out-of-range", "t", "in2");
    let c = json!({ "node": "c" });
    let by = |node: Value| divided_by(c.clone(), json!({ "c": node }));
    let k = json!({ "input": "k" });
    for node in [
        json!({ "type": "constant", "inputs": { "value": 0 } }),
        json!({ "type": "subtract", "inputs": { "in1": 3, "in2": 3 } }),
        json!({ "type": "multiply", "inputs": { "in1": k, "in2": 2 } }),
        json!({ "type": "invert", "inputs": { "in": k } }),
        json!({ "type": "floor", "inputs": { "in": 0.5 } }),
        json!({ "type": "clamp", "inputs": { "in": k } }),
        json!({ "type": "colorramp", "inputs": { "in": k } }),
    ] {
        // The graph's input is not read by each of them.
        let mut found = by(node.clone());
        found.retain(|(code, ..)| *code != "unused-input");
        assert_eq!(found, error, "{node}");
    }
    let far = json!({ "type": "add", "inputs": { "in1": k, "in2": 1.5 } });
    assert_eq!(by(far), []);
    let square = json!({ "s": { "type": "multiply", "inputs": { "in1": c, "in2": c } },
        "c": { "type": "multiply", "inputs": { "in1": k, "in2": 1 } },
        "far": { "type": "add", "inputs": { "in1": { "node": "s" }, "in2": 0.5 } } });
    assert_eq!(divided_by(json!({ "node": "far" }), square), []);
}

#[test]
fn whatever_has_no_moments_is_warned_of_once_at_its_port() {
    let n = json!({ "node": "n" });
    let of = |ty: &str, inputs: Value, noise: Value| {
        let nodes = json!({ "n": { "type": "noise2d", "inputs": noise },
            "t": { "type": ty, "inputs": inputs } });
        reported(json!({}), nodes)
    };
    let (near, far) = (json!({ "pivot": 0.5 }), json!({ "pivot": 4 }));
    for (ty, port, inputs) in [
        ("divide", "in2", json!({ "in2": n })),
        ("modulo", "in2", json!({ "in1": n, "in2": n })),
        ("ln", "in", json!({ "in": n })),
        ("power", "in1", json!({ "in1": n, "in2": -0.5 })),
        ("range", "inhigh", json!({ "in": n, "inhigh": n })),
        (
            "levels",
            "inlow",
            json!({ "in": 1, "inlow": n, "inhigh": 0 }),
        ),
    ] {
        assert_eq!(
            of(ty, inputs.clone(), near.clone()),
            at("no-moments", "t", port),
            "{ty}"
        );
        assert_eq!(of(ty, inputs, far.clone()), [], "{ty} far from 0");
    }
    let after = json!({
        "first": { "type": "divide", "inputs": { "in2": n } },
        "second": { "type": "ln", "inputs": { "in": { "node": "first" } } },
        "n": { "type": "noise2d" },
        "t": { "type": "divide", "inputs": { "in2": { "node": "second" } } } });
    assert_eq!(reported(json!({}), after), at("no-moments", "first", "in2"));
}
