//! Graphs of any size.

use std::fmt::Write;

/// A graph of about `count` nodes: groups of ten, each a noise, a pattern and what makes a colour
/// of them, mixed with the group before.
///
/// # Panics
/// If there are fewer than ten.
pub fn graph(count: usize) -> String {
    let mut nodes = String::new();
    for i in 0..count / 10 {
        let before = if i == 0 {
            r#"[0.2, 0.3, 0.4]"#.to_owned()
        } else {
            format!(r#"{{"node":"mix{}"}}"#, i - 1)
        };
        write!(
            nodes,
            r#""place{i}":{{"type":"place2d","inputs":{{"texcoord":{{"node":"uv"}},"scale":[0.5,{scale}],"rotate":-{i}}}}},
            "noise{i}":{{"type":"fractal2d","inputs":{{"texcoord":{{"node":"place{i}"}},"frequency":{{"input":"scale"}},"seed":{i}}}}},
            "turb{i}":{{"type":"absval","inputs":{{"in":{{"node":"noise{i}"}}}}}},
            "grain{i}":{{"type":"noise2d","inputs":{{"frequency":16,"seed":{i}}}}},
            "stripe{i}":{{"type":"stripes","inputs":{{"frequency":{frequency}}}}},
            "sum{i}":{{"type":"add","inputs":{{"in1":{{"node":"turb{i}"}},"in2":{{"node":"grain{i}"}}}}}},
            "mask{i}":{{"type":"smoothstep","inputs":{{"in":{{"node":"sum{i}"}},"low":-0.2,"high":0.4}}}},
            "color{i}":{{"type":"colorramp","inputs":{{"in":{{"node":"noise{i}"}},"stops":[{{"at":-0.4,"value":[0.1,0.2,0.3]}},{{"at":0.1,"value":[0.5,0.4,0.3]}},{{"at":0.4,"value":[0.9,0.8,0.7]}}]}}}},
            "tint{i}":{{"type":"multiply","inputs":{{"in1":{{"node":"color{i}"}},"in2":{{"node":"stripe{i}"}}}}}},
            "mix{i}":{{"type":"mix","inputs":{{"bg":{before},"fg":{{"node":"tint{i}"}},"mix":{{"node":"mask{i}"}}}}}},"#,
            scale = 1.0 + i as f32 * 0.01,
            frequency = 2 + i % 7,
        )
        .expect("writing to a string");
    }
    nodes.pop();
    format!(
        r#"{{"version":1,"name":"bench","inputs":{{"scale":{{"type":"float","value":4,"min":0.5,"max":64}}}},"nodes":{{"uv":{{"type":"texcoord"}},{nodes}}},"outputs":{{"out":{{"node":"mix{}"}}}}}}"#,
        count / 10 - 1
    )
}
