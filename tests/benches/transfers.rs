//! Maps of one signal: how far the σ-pyramid and the closed form are from the Gaussian integral,
//! beside the table that was known.
//!
//! `cargo bench -p mipless-tests --bench transfers` prints Markdown: mean, 99.9th percentile and
//! largest error in thousandths of the map's range, and the bytes of a moment that is read. Positions
//! are exactly Gaussian within a footprint, so that a map of the surface's coordinates shows the
//! method's error alone.

use mipless::{Footprint, Method, Options, PixelFilter};
use mipless_codegen::cpu::eval_program;
use mipless_codegen::{Bundle, Lower, NodeDef, compile};
use mipless_graph::{
    Behaviour, Category, CheckOptions, Default, Doc, Node, NodeSpec, OutputType, PortSpec,
    PortType, Type, check, load,
};
use rayon::prelude::*;

/// Gaussians of each map: means in [0, 1], standard deviations from 0.004 to 0.45, by their
/// logarithm.
const PLACES: usize = 20_000;
const NARROWEST: f64 = 0.004;
const WIDEST: f64 = 0.45;

/// Name, function on [0, 1], and the same as a node over `x`, if there is one in closed form.
type Case = (&'static str, fn(f64) -> f64, Option<&'static str>);

const CASES: [Case; 4] = [
    (
        "sin 9x",
        |x| 0.5 + 0.5 * (9.0 * x).sin(),
        Some(
            r#""h":{"type":"multiply","inputs":{"in1":{"node":"x"},"in2":9}},"s":{"type":"sin","inputs":{"in":{"node":"h"}}},"o":{"type":"range","inputs":{"in":{"node":"s"},"inlow":-1}}"#,
        ),
    ),
    (
        "ramp of 5 stops",
        |x| {
            let heights = [0.0, 1.0, 0.2, 0.7, 0.4];
            let at = 4.0 * x.clamp(0.0, 1.0);
            let left = (at as usize).min(3);
            heights[left] + (at - left as f64) * (heights[left + 1] - heights[left])
        },
        Some(
            r#""o":{"type":"colorramp","inputs":{"in":{"node":"x"},"stops":[{"at":0,"value":0},{"at":0.25,"value":1},{"at":0.5,"value":0.2},{"at":0.75,"value":0.7},{"at":1,"value":0.4}]}}"#,
        ),
    ),
    (
        "step",
        |x| if x < 0.43 { 0.0 } else { 1.0 },
        Some(r#""o":{"type":"step","inputs":{"in":{"node":"x"},"edge":0.43}}"#),
    ),
    (
        "ten stripes",
        |x| (20.0 * x.clamp(0.0, 0.999)).floor().rem_euclid(2.0),
        None,
    ),
];

/// The case of this number by a table, for this benchmark alone.
static TABLE: NodeSpec = NodeSpec {
    name: "table1d",
    aliases: &[],
    category: Category::Color,
    summary: "A function of one number by a table.",
    doc: Doc {
        computes: "",
        statistics: "",
        accuracy: "",
        references: "",
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "",
        ),
        PortSpec::new(
            "case",
            PortType::Exactly(Type::Integer),
            Default::Integer(0),
            "",
        )
        .uniform(),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| mipless_graph::Reach::ANY,
    class: |_| Behaviour::Function,
    example: "",
};

fn table<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let x = lower.signal(node, "in");
    let case = lower.integer(node, "case") as usize;
    let name = format!("case_{case}");
    let bounds = ([0.0, 1.0], [0.0, 1.0]);
    let table = lower.tabulate(&name, &name, bounds, CASES[case].1);
    vec![lower.algebra.transfer(&x, &table)]
}

/// The means of `o` under the Gaussians, and the bytes of tables that are read.
fn ours(nodes: &str, places: &[[f64; 2]]) -> (Vec<f64>, usize) {
    let mut catalogue = mipless_nodes::catalogue().to_vec();
    catalogue.push(NodeDef::new(&TABLE, table));
    let specs: Vec<_> = catalogue.iter().map(|def| def.spec).collect();
    let text = format!(
        r#"{{"version":1,"name":"map","nodes":{{"uv":{{"type":"texcoord"}},"x":{{"type":"extract","inputs":{{"in":{{"node":"uv"}},"index":0}}}},{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
    );
    let graph = load(&text, &specs)
        .graph
        .expect("the graph has no mistakes");
    let checked = check(graph, &CheckOptions::default()).expect("the graph has statistics");
    let options = Options {
        method: Method::Local,
        filter: PixelFilter::Gaussian(1.0),
        ..Options::default()
    };
    let program = compile(&checked, &catalogue, &options);
    let footprints: Vec<Footprint> = (places.iter())
        .map(|&[mean, sd]| Footprint {
            uv: [mean as f32, 0.5],
            du: [sd as f32, 0.0],
            ..Footprint::default()
        })
        .collect();
    let tables = program.module.tables.iter();
    // The function's own values and the levels' layout are no moments.
    let moments = tables.filter(|t| t.name.ends_with("_mean"));
    let bytes = moments.map(|t| 4 * t.data.len()).sum();
    let values = eval_program::<f32>(&program, &footprints, &[]).swap_remove(0);
    (values.into_iter().map(f64::from).collect(), bytes)
}

/// E[f] by 2001 nodes, the function constant beyond [0, 1].
fn truth(f: fn(f64) -> f64, [mean, sd]: [f64; 2]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for i in 0..=2000 {
        let z = 9.0 * f64::from(i) / 2000.0 - 4.5;
        let weight = (-0.5 * z * z).exp();
        sum += weight * f((mean + sd * z).clamp(0.0, 1.0));
        total += weight;
    }
    sum / total
}

/// Heitz et al. 2013, §4: the mean for 256 means and 256 standard deviations, read linearly; texels
/// in f64, where the paper has bytes.
struct Known(Vec<f64>);

const SIDE: usize = 256;

impl Known {
    fn new(f: fn(f64) -> f64) -> Self {
        let texels = (0..SIDE * SIDE).into_par_iter().map(|i| {
            let mean = (i % SIDE) as f64 / (SIDE - 1) as f64;
            let sd = WIDEST * (i / SIDE) as f64 / (SIDE - 1) as f64;
            // Without a spread the average over the texel.
            truth(f, [mean, sd.max(0.3 / SIDE as f64)])
        });
        Self(texels.collect())
    }

    fn read(&self, [mean, sd]: [f64; 2]) -> f64 {
        let last = (SIDE - 1) as f64;
        let [(x, across), (y, down)] = [mean * last, sd / WIDEST * last].map(|at| {
            let whole = at.floor().min(last - 1.0);
            (whole as usize, at - whole)
        });
        let row = |y: usize| {
            let [left, right] = [x, x + 1].map(|x| self.0[y * SIDE + x]);
            left + across * (right - left)
        };
        row(y) + down * (row(y + 1) - row(y))
    }
}

/// Mean, 99.9th percentile and the largest, in thousandths.
fn summary(found: &[f64], truth: &[f64]) -> String {
    let mut errors: Vec<f64> = found
        .iter()
        .zip(truth)
        .map(|(f, t)| (f - t).abs())
        .collect();
    errors.sort_by(f64::total_cmp);
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let high = errors[errors.len() * 999 / 1000];
    let most = errors[errors.len() - 1];
    format!("{:.2} / {:.1} / {:.0}", 1e3 * mean, 1e3 * high, 1e3 * most)
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let places: Vec<[f64; 2]> = (0..PLACES)
        .map(|i| {
            let [p, q] = [0.754_877_666, 0.569_840_291].map(|step: f64| (i as f64 * step).fract());
            [p, NARROWEST * (WIDEST / NARROWEST).powf(q)]
        })
        .collect();
    println!("| map | σ-pyramid | bytes | closed form | 256×256 table | bytes |");
    println!("|---|---|---|---|---|---|");
    for (i, (name, f, closed)) in CASES.into_iter().enumerate() {
        let wanted: Vec<f64> = places.par_iter().map(|&place| truth(f, place)).collect();
        let node =
            format!(r#""o":{{"type":"table1d","inputs":{{"in":{{"node":"x"}},"case":{i}}}}}"#);
        let (pyramid, bytes) = ours(&node, &places);
        let closed = closed.map_or_else(
            || "–".to_owned(),
            |nodes| {
                // Waves go on beyond [0, 1], where the tables' functions are constant.
                let inside = |[mean, sd]: [f64; 2]| mean > 4.5 * sd && mean + 4.5 * sd < 1.0;
                let keep = |all: &[f64]| -> Vec<f64> {
                    let all = all.iter().zip(&places);
                    all.filter(|&(_, &place)| inside(place))
                        .map(|(&x, _)| x)
                        .collect()
                };
                let (found, _) = ours(nodes, &places);
                summary(&keep(&found), &keep(&wanted))
            },
        );
        let known = Known::new(f);
        let read: Vec<f64> = places.iter().map(|&place| known.read(place)).collect();
        println!(
            "| {name} | {} | {bytes} | {closed} | {} | {} |",
            summary(&pyramid, &wanted),
            summary(&read, &wanted),
            SIDE * SIDE
        );
    }
}
