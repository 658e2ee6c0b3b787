//! What a graph costs grows as the graph does: counted instructions and tables, and graphs that end
//! only where nothing is quadratic.

use mipless::{Footprint, Method, Options, Program, Texture};
use serde_json::{Map, Value, json};

fn compiled(graph: &Value, method: Method) -> Program {
    let texture =
        Texture::from_json(&graph.to_string()).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    texture.compile(&Options {
        method,
        ..Options::default()
    })
}

/// The instructions of all functions, and the tables.
fn size(program: &Program) -> [usize; 2] {
    let functions = program.module.functions.iter();
    let instructions = functions.map(|function| function.insts.len()).sum();
    [instructions, program.module.tables.len()]
}

/// A noise, then `count` nodes, each of which reads what is before it by `inputs`.
fn chain(count: usize, node: impl Fn(usize, Value) -> Value) -> Value {
    let mut nodes = Map::new();
    nodes.insert(
        "n".into(),
        json!({ "type": "noise2d", "inputs": { "frequency": 3 } }),
    );
    let mut before = "n".to_owned();
    for i in 0..count {
        let name = format!("c{i}");
        nodes.insert(name.clone(), node(i, json!({ "node": before })));
        before = name;
    }
    json!({ "version": 1, "nodes": nodes, "outputs": { "out": { "node": before } } })
}

fn sines(count: usize) -> Value {
    chain(
        count,
        |_, before| json!({ "type": "sin", "inputs": { "in": before } }),
    )
}

fn mixed(count: usize) -> Value {
    let types = [
        "sin",
        "absval",
        "exp",
        "smoothstep",
        "invert",
        "fract",
        "sqrt",
    ];
    chain(
        count,
        |i, before| json!({ "type": types[i % types.len()], "inputs": { "in": before } }),
    )
}

fn doubled(count: usize) -> Value {
    chain(count, |i, before| {
        let ty = if i % 2 == 0 { "add" } else { "multiply" };
        json!({ "type": ty, "inputs": { "in1": before, "in2": before } })
    })
}

#[test]
fn chains_and_diamonds_grow_by_the_same_for_each_node() {
    let families: [fn(usize) -> Value; 3] = [sines, mixed, doubled];
    for family in families {
        for method in [Method::Point, Method::Local, Method::Quad] {
            let [a, b, c] = [420, 840, 1260].map(|count| size(&compiled(&family(count), method)));
            for kind in 0..2 {
                let [first, second] = [
                    b[kind] - a[kind].min(b[kind]),
                    c[kind] - b[kind].min(c[kind]),
                ];
                let same = second <= first + first / 10 + 2;
                assert!(same, "{method}: {a:?}, {b:?}, {c:?}");
            }
        }
    }
}

#[test]
fn regions_of_one_shape_share_their_tables() {
    let [few, many] = [60, 600].map(|count| size(&compiled(&sines(count), Method::Local))[1]);
    assert!(few > 0 && many == few, "{few} tables, then {many}");
}

#[test]
fn ten_thousand_nodes_have_a_value() {
    for graph in [sines(10_000), doubled(10_000)] {
        let texture = Texture::from_json(&graph.to_string()).expect("no mistakes");
        let options = Options {
            method: Method::Local,
            ..Options::default()
        };
        let footprint = Footprint {
            uv: [0.3, 0.7],
            du: [0.01, 0.0],
            dv: [0.0, 0.01],
            ..Footprint::default()
        };
        let value = texture.evaluator(&options).evaluate(&[footprint])[0][0];
        assert!(value.is_finite(), "{value}");
    }
}

/// More constants than sixteen bits count, each of which has a register.
#[test]
fn seventy_thousand_constants_are_seventy_thousand_numbers() {
    let sum = chain(70_000, |i, before| {
        let number = if i % 2 == 0 { -(i as f32) } else { i as f32 };
        json!({ "type": "add", "inputs": { "in1": before, "in2": number } })
    });
    let texture = Texture::from_json(&sum.to_string()).expect("no mistakes");
    let at = Footprint {
        uv: [0.3, 0.7],
        ..Footprint::default()
    };
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let value = texture.evaluator(&options).evaluate(&[at])[0][0];
    // Each two of them add one to a noise, in numbers of six digits.
    assert!((value - 35_000.0).abs() < 2.0, "{value}");
}

/// Sub-graphs in sub-graphs, each of which holds the one below it twice: a chain of 2ⁿ nodes.
fn nested(levels: usize) -> Value {
    let mut graphs = Map::new();
    for level in 0..levels {
        let inner = match level {
            0 => "sin".to_owned(),
            _ => format!("graph:g{}", level - 1),
        };
        graphs.insert(
            format!("g{level}"),
            json!({
                "inputs": { "in": { "type": "float", "value": 0 } },
                "nodes": {
                    "a": { "type": inner, "inputs": { "in": { "input": "in" } } },
                    "b": { "type": inner, "inputs": { "in": { "node": "a" } } }
                },
                "outputs": { "out": { "node": "b" } }
            }),
        );
    }
    json!({ "version": 1, "graphs": graphs,
        "nodes": { "n": { "type": "noise2d" },
            "t": { "type": format!("graph:g{}", levels - 1), "inputs": { "in": { "node": "n" } } } },
        "outputs": { "out": { "node": "t" } } })
}

#[test]
fn nested_doublings_are_checked_or_refused_by_their_number() {
    let texture = Texture::from_json(&nested(14).to_string()).expect("2¹⁴ nodes");
    assert_eq!(texture.signals().len(), (1 << 14) + 1);
    let mistakes = Texture::from_json(&nested(60).to_string()).expect_err("2⁶⁰ nodes");
    assert_eq!(mistakes[0].code, "too-many-nodes", "{mistakes:?}");
    assert!(mistakes[0].pointer.is_some(), "{mistakes:?}");
}

#[test]
fn a_hundred_thousand_levels_of_json_are_one_located_mistake() {
    for (open, close) in [("[", "]"), ("{\"a\":", "}")] {
        let deep = format!("{}1{}", open.repeat(100_000), close.repeat(100_000));
        let text =
            format!(r#"{{ "version": 1, "extra": {deep}, "nodes": {{}}, "outputs": {{}} }}"#);
        let mistakes = Texture::from_json(&text).expect_err("it is too deep");
        assert_eq!(mistakes.len(), 1, "{mistakes:?}");
        assert!(mistakes[0].line.is_some(), "{mistakes:?}");
    }
}

fn ramp(count: usize, interpolation: &str) -> Value {
    // No two neighbours rise alike, two in a hundred are at one place.
    let stops: Vec<Value> = (0..count)
        .map(|i| {
            let place = if i % 100 == 7 { i - 1 } else { i };
            let value = [
                (i * 7 % 11) as f32 / 11.0,
                (i * 5 % 13) as f32 / 13.0,
                (i % 2) as f32,
            ];
            json!({ "at": place as f32 / count as f32 - 0.5, "value": value })
        })
        .collect();
    json!({ "version": 1,
        "nodes": {
            "n": { "type": "noise2d", "inputs": { "frequency": 3, "amplitude": 1.3 } },
            "t": { "type": "colorramp",
                "inputs": { "in": { "node": "n" }, "stops": stops, "interpolation": interpolation } } },
        "outputs": { "out": { "node": "t" } } })
}

#[test]
fn a_ramp_of_ten_thousand_stops_has_no_more_code_than_one_of_a_hundred() {
    for method in [Method::Point, Method::Local, Method::Auto] {
        let [few, many] =
            [100, 10_000].map(|count| size(&compiled(&ramp(count, "linear"), method)));
        assert_eq!(few[1], many[1], "{method}: tables");
        assert!(many[0] < few[0] + 400, "{method}: {few:?}, {many:?}");
    }
}

#[test]
fn a_ramp_of_many_stops_has_the_values_of_its_halves() {
    // 60 stops are summed, 120 are looked up: the first half of them are the same function.
    let places: Vec<Footprint> = (0..500)
        .map(|i| Footprint {
            uv: [0.754_877_7 * i as f32, 0.569_840_3 * i as f32].map(f32::fract),
            ..Footprint::default()
        })
        .collect();
    for interpolation in ["constant", "linear", "smooth", "cubic"] {
        let mut long = ramp(120, interpolation);
        let mut short = long.clone();
        let stops = |graph: &mut Value, keep: std::ops::Range<usize>| {
            let list = graph["nodes"]["t"]["inputs"]["stops"]
                .as_array_mut()
                .expect("stops");
            *list = list[keep].to_vec();
        };
        stops(&mut short, 30..90);
        // Where both are the same: between the stops 40 and 80.
        for graph in [&mut long, &mut short] {
            graph["nodes"]["n"]["inputs"]["amplitude"] = json!(0.12);
        }
        let options = Options {
            method: Method::Point,
            ..Options::default()
        };
        let [long, short] = [long, short].map(|graph| {
            let texture = Texture::from_json(&graph.to_string()).expect("no mistakes");
            texture.evaluator(&options).evaluate(&places)
        });
        let far = long.iter().flatten().zip(short.iter().flatten());
        let far = far.filter(|(x, y)| (**x - **y).abs() > 1e-4).count();
        // A place at a jump may lie on either side of it.
        assert!(far <= 3, "{interpolation}: {far} of 1500");
    }
}
