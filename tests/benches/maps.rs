//! Colour maps of two signals: how far the table is from the Gaussian integral, beside the layouts
//! that were known, and how far a texture of two independent noises is from the truth.
//!
//! `cargo bench -p mipless-tests --bench maps` prints Markdown; errors are thousandths of the range
//! of values. Positions are exactly Gaussian within a footprint, so that a map of the surface's
//! coordinates shows the table's error alone.

use mipless::{Footprint, Method, Options, PixelFilter};
use mipless_codegen::cpu::{Evaluator, Scratch};
use mipless_codegen::ir::{Float, Program};
use mipless_codegen::moments::Domain;
use mipless_codegen::{Bundle, Lower, NodeDef, compile};
use mipless_graph::{
    Behaviour, Category, CheckOptions, Default, Doc, Node, NodeSpec, OutputType, PortSpec,
    PortType, Type, check, load,
};
use rayon::prelude::*;

/// Gaussians of each map and orientation.
const PLACES: usize = 600;
/// The largest standard deviation, in maps: the top level of the 36 maps.
const WIDEST: f64 = 0.125;

/// A map of smooth random waves that repeats with period 1, for this benchmark alone.
static WAVES: NodeSpec = NodeSpec {
    name: "waves2d",
    aliases: &[],
    category: Category::Color,
    summary: "Random waves of two numbers.",
    doc: Doc {
        computes: "",
        statistics: "",
        accuracy: "",
        references: "",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "",
        ),
        PortSpec::new(
            "in2",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "",
        ),
        PortSpec::new(
            "seed",
            PortType::Exactly(Type::Integer),
            Default::Integer(0),
            "",
        )
        .uniform(),
    ],
    output: OutputType::Exactly(Type::Color3),
    reach: |_| mipless_graph::Reach::ANY,
    class: |_| Behaviour::Function,
    example: "",
};

fn waves<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (x, y) = (lower.signal(node, "in1"), lower.signal(node, "in2"));
    let seed = lower.integer(node, "seed") as u64;
    let domain = Domain {
        bounds: [[0.0, 1.0]; 2],
        periodic: true,
        detail: 1,
    };
    lower.map(
        node,
        [&x, &y],
        domain,
        &[[0.0, 1.0]; 3],
        move |_, _, place| (0..3).map(|i| channel(place, 3 * seed + i)).collect(),
    )
}

/// ½ plus eight waves of up to five periods, a fourteenth high each: in [0, 1] but for rounding.
fn channel([x, y]: [Float<'_>; 2], seed: u64) -> Float<'_> {
    let mut random = Random(seed.wrapping_mul(77) + 5);
    (0..8).fold(x.literal(0.5), |sum, _| {
        let cycles = [0, 1].map(|_| ((random.next() * 11.0).floor() - 5.0) as f32);
        let turns = x * cycles[0] + y * cycles[1] + random.next() as f32;
        sum + (turns * std::f32::consts::TAU).sin() * 0.0625
    })
}

/// A small generator (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn catalogue() -> Vec<NodeDef> {
    let mut all = mipless_nodes::catalogue().to_vec();
    all.push(NodeDef::new(&WAVES, waves));
    all
}

/// Writes the nodes of a map of this seed.
type MakeMap = fn(u32) -> String;

/// A graph that ends in the colour `o`.
fn program(nodes: &str, method: Method) -> Program {
    let catalogue = catalogue();
    let specs: Vec<_> = catalogue.iter().map(|def| def.spec).collect();
    let text = format!(
        r#"{{"version":1,"name":"map","nodes":{{{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
    );
    let loaded = load(&text, &specs);
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("the graph has statistics");
    let options = Options {
        method,
        filter: PixelFilter::Gaussian(1.0),
        ..Options::default()
    };
    compile(&checked, &catalogue, &options)
}

fn evaluate(program: &Program, footprints: &[Footprint]) -> Vec<Vec<f32>> {
    let mut outputs = Vec::new();
    Evaluator::<f32>::of_program(program).evaluate_footprints(
        &mut Scratch::new(),
        footprints,
        &[],
        &mut outputs,
    );
    outputs
}

fn footprint(place: [f64; 2], du: [f64; 2], dv: [f64; 2]) -> Footprint {
    Footprint {
        cell: place.map(|x| x.floor() as i32),
        uv: place.map(|x| (x - x.floor()) as f32),
        du: du.map(|x| x as f32),
        dv: dv.map(|x| x as f32),
    }
}

/// A mean and two orthogonal half axes.
struct Gaussian {
    mean: [f64; 2],
    axes: [[f64; 2]; 2],
}

impl Gaussian {
    fn random(random: &mut Random, rotated: bool) -> Self {
        let mean = [random.next(), random.next()];
        let major = WIDEST * (32f64).powf(-random.next());
        let minor = major * (16f64).powf(-random.next());
        let turns = random.next();
        let angle = if rotated {
            turns * std::f64::consts::PI
        } else {
            (2.0 * turns).floor() * std::f64::consts::FRAC_PI_2
        };
        let (s, c) = angle.sin_cos();
        Self {
            mean,
            axes: [[major * c, major * s], [-minor * s, minor * c]],
        }
    }

    /// The mean of the point function over this Gaussian, by a grid of ±4.5 standard deviations.
    fn truth(&self, point: &Program) -> Vec<f64> {
        const SIDE: usize = 161;
        let scores: Vec<f64> = (0..SIDE)
            .map(|i| 9.0 * (i as f64 + 0.5) / SIDE as f64 - 4.5)
            .collect();
        let mut footprints = Vec::new();
        let mut weights = Vec::new();
        for p in &scores {
            for q in &scores {
                let at = [0, 1].map(|i| self.mean[i] + p * self.axes[0][i] + q * self.axes[1][i]);
                footprints.push(footprint(at, [0.0; 2], [0.0; 2]));
                weights.push((-0.5 * (p * p + q * q)).exp());
            }
        }
        let total: f64 = weights.iter().sum();
        let values = evaluate(point, &footprints);
        let weighted = |channel: &Vec<f32>| -> f64 {
            let sum: f64 = channel
                .iter()
                .zip(&weights)
                .map(|(&v, w)| w * f64::from(v))
                .sum();
            sum / total
        };
        values.iter().map(weighted).collect()
    }
}

/// Grenier et al. 2022, §5: maps of 256² for six standard deviations of each axis, the nearest of
/// them read linearly, the covariance dropped.
struct Stack {
    maps: Vec<Vec<f64>>,
    channels: usize,
}

const MAP_SIDE: usize = 256;
const MAP_LEVELS: usize = 6;

impl Stack {
    fn deviation(level: usize) -> f64 {
        WIDEST / (1u32 << (MAP_LEVELS - 1 - level)) as f64
    }

    fn new(point: &Program) -> Self {
        // Each texel is the average of 4×4 samples.
        let side = 4 * MAP_SIDE;
        let mut texels: Vec<Vec<f64>> = Vec::new();
        for row in 0..side {
            let places: Vec<Footprint> = (0..side)
                .map(|column| {
                    let at = [column, row].map(|i| (i as f64 + 0.5) / side as f64);
                    footprint(at, [0.0; 2], [0.0; 2])
                })
                .collect();
            for (i, channel) in evaluate(point, &places).iter().enumerate() {
                if texels.len() <= i {
                    texels.push(vec![0.0; MAP_SIDE * MAP_SIDE]);
                }
                for (column, &value) in channel.iter().enumerate() {
                    texels[i][row / 4 * MAP_SIDE + column / 4] += f64::from(value) / 16.0;
                }
            }
        }
        let channels = texels.len();
        let maps = (0..MAP_LEVELS * MAP_LEVELS * channels)
            .into_par_iter()
            .map(|i| {
                let (pair, channel) = (i / channels, i % channels);
                let [x, y] = [pair % MAP_LEVELS, pair / MAP_LEVELS].map(Self::deviation);
                blurred(&blurred(&texels[channel], x), y)
            })
            .collect();
        Self { maps, channels }
    }

    fn read(&self, gaussian: &Gaussian) -> Vec<f64> {
        let [x, y] = [0, 1].map(|i| {
            let sd = (gaussian.axes[0][i].powi(2) + gaussian.axes[1][i].powi(2)).sqrt();
            let level = (sd / WIDEST).log2() + (MAP_LEVELS - 1) as f64;
            level.round().clamp(0.0, (MAP_LEVELS - 1) as f64) as usize
        });
        (0..self.channels)
            .map(|channel| {
                let map = &self.maps[(y * MAP_LEVELS + x) * self.channels + channel];
                let [(x, across), (y, down)] = gaussian.mean.map(|p| {
                    let at = p * MAP_SIDE as f64 - 0.5;
                    (at.floor() as i64, at - at.floor())
                });
                let texel = |x: i64, y: i64| {
                    let [x, y] = [x, y].map(|i| i.rem_euclid(MAP_SIDE as i64) as usize);
                    map[y * MAP_SIDE + x]
                };
                let row = |y: i64| texel(x, y) + across * (texel(x + 1, y) - texel(x, y));
                row(y) + down * (row(y + 1) - row(y))
            })
            .collect()
    }
}

/// Every row convolved with a Gaussian (in maps), transposed.
fn blurred(map: &[f64], sd: f64) -> Vec<f64> {
    let sd = sd * MAP_SIDE as f64;
    let reach = (4.5 * sd).ceil() as i64;
    let weights: Vec<f64> = (-reach..=reach)
        .map(|i| (-0.5 * (i as f64 / sd).powi(2)).exp())
        .collect();
    let total: f64 = weights.iter().sum();
    let mut out = vec![0.0; map.len()];
    for (y, row) in map.chunks(MAP_SIDE).enumerate() {
        let periods = reach as usize / MAP_SIDE + 1;
        let padded: Vec<f64> = row.repeat(2 * periods + 1);
        for x in 0..MAP_SIDE {
            let start = periods * MAP_SIDE + x - reach as usize;
            let near = &padded[start..start + weights.len()];
            let sum: f64 = near.iter().zip(&weights).map(|(v, w)| v * w).sum();
            out[x * MAP_SIDE + y] = sum / total;
        }
    }
    out
}

const UV: &str = r#""uv":{"type":"texcoord"},"x":{"type":"extract","inputs":{"in":{"node":"uv"},"index":0}},"y":{"type":"extract","inputs":{"in":{"node":"uv"},"index":1}},"#;
const NOISES: &str = r#""x":{"type":"spectralnoise2d","inputs":{"amplitude":0.6667,"pivot":0.5,"seed":SEED1}},"y":{"type":"spectralnoise2d","inputs":{"amplitude":0.6667,"pivot":0.5,"seed":SEED2}},"#;

/// Voronoi cells of random colours.
fn regions(seed: u32, address: &str) -> String {
    let count = 6 + 2 * seed;
    let mut random = Random(u64::from(seed));
    let stops: Vec<String> = (0..count)
        .map(|i| {
            let [r, g, b] = [0; 3].map(|_| random.next());
            let at = f64::from(i) / f64::from(count);
            format!(r#"{{"at":{at},"value":[{r},{g},{b}]}}"#)
        })
        .collect();
    let stops = stops.join(",");
    format!(
        r#""o":{{"type":"colormap2d","inputs":{{"in1":{{"node":"x"}},"in2":{{"node":"y"}},"shape":"regions","count":{count},"seed":{seed},"addressmode":"{address}","interpolation":"constant","stops":[{stops}]}}}}"#
    )
}

fn smooth(seed: u32) -> String {
    format!(
        r#""o":{{"type":"waves2d","inputs":{{"in1":{{"node":"x"}},"in2":{{"node":"y"}},"seed":{seed}}}}}"#
    )
}

/// Mean, root mean square and largest, in thousandths.
fn summary(errors: &[f64]) -> String {
    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let square = errors.iter().map(|e| e * e).sum::<f64>() / n;
    let largest = errors.iter().copied().fold(0.0, f64::max);
    format!(
        "{:.2} / {:.2} / {:.0}",
        1e3 * mean,
        1e3 * square.sqrt(),
        1e3 * largest
    )
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    tables();
    noises();
}

fn tables() {
    println!("| maps | Gaussians | pyramid and five taps | 36 maps |");
    println!("|---|---|---|---|");
    let mut bytes = 0;
    let kinds: [(&str, MakeMap); 2] = [
        ("Voronoi", |seed| regions(seed, "periodic")),
        ("smooth", smooth),
    ];
    for (kind, map) in kinds {
        let maps: Vec<_> = (1..=3)
            .map(|seed| {
                let nodes = format!("{UV}{}", map(seed));
                let point = program(&nodes, Method::Point);
                let stack = Stack::new(&point);
                (program(&nodes, Method::Local), point, stack)
            })
            .collect();
        for rotated in [false, true] {
            let (mut ours, mut theirs) = (Vec::new(), Vec::new());
            for (seed, (local, point, stack)) in maps.iter().enumerate() {
                bytes = local
                    .module
                    .tables
                    .iter()
                    .map(|t| 4 * t.data.len())
                    .sum::<usize>();
                let mut random = Random(seed as u64 + 100);
                let gaussians: Vec<Gaussian> = (0..PLACES)
                    .map(|_| Gaussian::random(&mut random, rotated))
                    .collect();
                let truths: Vec<Vec<f64>> = gaussians.par_iter().map(|g| g.truth(point)).collect();
                let footprints: Vec<Footprint> = gaussians
                    .iter()
                    .map(|g| footprint(g.mean, g.axes[0], g.axes[1]))
                    .collect();
                let values = evaluate(local, &footprints);
                for (i, (g, truth)) in gaussians.iter().zip(&truths).enumerate() {
                    for (channel, (other, exact)) in stack.read(g).iter().zip(truth).enumerate() {
                        ours.push((f64::from(values[channel][i]) - exact).abs());
                        theirs.push((other - exact).abs());
                    }
                }
            }
            let orientation = if rotated { "rotated" } else { "axis-aligned" };
            println!(
                "| {kind} | {orientation} | {} | {} |",
                summary(&ours),
                summary(&theirs)
            );
        }
    }
    let stack = MAP_LEVELS * MAP_LEVELS * MAP_SIDE * MAP_SIDE * 3;
    println!("| bytes of one map | | {bytes} | {stack} |");
    println!();
}

fn noises() {
    const METHODS: [Method; 4] = [Method::Naive, Method::Ensemble, Method::Local, Method::Quad];
    let heads: Vec<String> = METHODS.iter().map(ToString::to_string).collect();
    println!(
        "| map of two independent noises | s | {} |",
        heads.join(" | ")
    );
    println!("|---|---|{}", "---|".repeat(METHODS.len()));
    let kinds: [(&str, MakeMap); 2] = [
        ("Voronoi", |seed| regions(seed, "clamp")),
        ("smooth", smooth),
    ];
    for (kind, map) in kinds {
        for size in [0.02f64, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0] {
            let sums: Vec<Vec<f64>> = (1..=3u32)
                .into_par_iter()
                .map(|seed| {
                    let sources = NOISES
                        .replace("SEED1", &seed.to_string())
                        .replace("SEED2", &(seed + 40).to_string());
                    let nodes = format!("{sources}{}", map(seed));
                    let footprints: Vec<Footprint> = (0..500)
                        .map(|i| {
                            let at = [0.754_877_666, 0.569_840_29]
                                .map(|step: f64| (f64::from(i) * step).fract() * 80.0);
                            footprint(at, [size, 0.0], [0.0, size])
                        })
                        .collect();
                    let truth = evaluate(&program(&nodes, Method::Supersample(4096)), &footprints);
                    let truth = truth.concat();
                    (METHODS.iter())
                        .map(|&method| {
                            let values = evaluate(&program(&nodes, method), &footprints).concat();
                            let error = |(a, b): (&f32, &f32)| f64::from(a - b).abs();
                            values.iter().zip(&truth).map(error).sum::<f64>() / truth.len() as f64
                        })
                        .collect()
                })
                .collect();
            let cells: Vec<String> = (0..METHODS.len())
                .map(|i| format!("{:.1}", 1e3 * sums.iter().map(|s| s[i]).sum::<f64>() / 3.0))
                .collect();
            println!("| {kind} | {size} | {} |", cells.join(" | "));
        }
    }
}
