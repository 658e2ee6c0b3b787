use mipless_codegen::cpu::{Footprint, Evaluator, Scratch};
use mipless_codegen::{Method, Options, compile};
use mipless_graph::{CheckOptions, check, load};
fn main() {
    let json = std::fs::read_to_string(std::env::args().nth(1).unwrap()).unwrap();
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(&json, &specs);
    let graph = loaded.graph.unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    for size in [1.0/64., 1.0/16., 0.25, 1.0, 4.0, 16.0, 64.0f32] {
        let px = size * 1.53;
        let footprints: Vec<Footprint> = (0..128*128).map(|i| {
            let p = [(i % 128) as f32 * px, (i / 128) as f32 * px];
            Footprint { cell: p.map(|x| x.floor() as i32), uv: p.map(|x| x - x.floor()), du: [px, 0.0], dv: [0.0, px] }
        }).collect();
        let mut line = format!("px {size:.4}");
        let mut base = 0.0;
        for method in [Method::Point, Method::Naive, Method::Local, Method::Quad, Method::Auto] {
            let program = compile(&checked, catalogue, &Options { method, ..Options::default() });
            let ev = Evaluator::<f32>::of_program(&program);
            let mut scratch = Scratch::new();
            let mut out = Vec::new();
            let mut best = f64::MAX;
            for _ in 0..7 { let t = std::time::Instant::now(); ev.evaluate_footprints(&mut scratch, &footprints, &[], &mut out); best = best.min(t.elapsed().as_secs_f64()); }
            if method == Method::Point { base = best; line += &format!("  point {:.2} Ms/s", 16384.0/best/1e6); }
            line += &format!("  {method} {:.2}", best/base);
        }
        println!("{line}");
    }
}
