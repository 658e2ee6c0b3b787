use mipless_codegen::cpu::{Footprint, Evaluator, Scratch};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};
fn main() {
    let catalogue = mipless_nodes::catalogue();
    let specs = mipless_nodes::specs();
    let maps = [
        ("smooth", r#"{"type":"sin","inputs":{"in":{"node":"s"}}}"#, r#""s":{"type":"multiply","inputs":{"in1":{"node":"n"},"in2":2}},"#),
        ("ramp", r#"{"type":"colorramp","inputs":{"in":{"node":"n"},"stops":[{"at":-1,"value":0},{"at":1,"value":1}]}}"#, ""),
        ("1 step", r#"{"type":"step","inputs":{"in":{"node":"n"},"edge":0.3}}"#, ""),
        ("4 steps", r#"{"type":"colorramp","inputs":{"in":{"node":"n"},"interpolation":"constant","stops":[{"at":-2,"value":0},{"at":-1,"value":1},{"at":-0.3,"value":0},{"at":0.4,"value":1},{"at":1.1,"value":0}]}}"#, ""),
        ("sin(abs)", r#"{"type":"sin","inputs":{"in":{"node":"s"}}}"#, r#""a":{"type":"absval","inputs":{"in":{"node":"n"}}},"s":{"type":"multiply","inputs":{"in1":{"node":"a"},"in2":5}},"#),
    ];
    for source in ["spectralnoise2d", "noise2d"] {
      for (name, map, extra) in maps {
        let json = format!(r#"{{"version":1,"name":"t","nodes":{{"n":{{"type":"{source}","inputs":{{"amplitude":4,"frequency":{}}}}},{extra}"o":{map}}},"outputs":{{"out":{{"node":"o"}}}}}}"#, if source == "noise2d" {1.53} else {1.0});
        let loaded = load(&json, &specs);
        let graph = loaded.graph.unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
        let checked = check(graph, &CheckOptions::default()).expect("checks");
        let mut totals = [0.0f64; 6];
        let sizes = [0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.35, 0.5, 0.8f32];
        for s in sizes {
            let footprints: Vec<Footprint> = (0..1500).map(|i| {
                let p = [(i as f64 * 0.754_877_666).fract() * 80.0, (i as f64 * 0.569_840_29).fract() * 80.0];
                Footprint { cell: p.map(|x| x.floor() as i32), uv: p.map(|x| (x - x.floor()) as f32), du: [s, 0.0], dv: [0.0, s] }
            }).collect();
            let run = |method| {
                let program = compile(&checked, catalogue, &Options { method, filter: PixelFilter::Gaussian(1.0), ..Options::default() });
                let mut out = Vec::new();
                Evaluator::<f32>::of_program(&program).evaluate_footprints(&mut Scratch::new(), &footprints, &[], &mut out);
                out.swap_remove(0)
            };
            let truth = run(Method::Supersample(4096));
            let mut line = format!("{source} {name} s {s}:");
            let scale = if name.starts_with("s") && !name.starts_with("step") { 0.5 } else { 1.0 };
            for (i, m) in [Method::Naive, Method::Ensemble, Method::Local, Method::Quad, Method::Auto, Method::Split(4)].into_iter().enumerate() {
                let v = run(m);
                let e = (v.iter().zip(&truth).map(|(a, b)| f64::from((a - b) * scale).powi(2)).sum::<f64>() / v.len() as f64).sqrt();
                totals[i] += e * e / sizes.len() as f64;
                line += &format!(" {m} {:.1}", e * 1000.0);
            }
            if std::env::args().len() > 1 { println!("{line}"); }
        }
        println!("{source} {name} TOTAL naive {:.1} ensemble {:.1} local {:.1} quad {:.1} auto {:.1} split4 {:.1}", totals[0].sqrt()*1e3, totals[1].sqrt()*1e3, totals[2].sqrt()*1e3, totals[3].sqrt()*1e3, totals[4].sqrt()*1e3, totals[5].sqrt()*1e3);
      }
    }
}
