//! Ten chains of functions of noises and two more, footprints from 0.03 to 2 wavelengths.
//!
//! `cargo bench -p mipless-tests --bench cascades [-- NAME…]` prints Markdown: the RMS error of
//! each method over the footprints and seeds, in thousandths of the chain's range, against 4096
//! samples a pixel. The column *fusion* is what one function of the base Gaussians reached with
//! gradients and remainders in the design study.

use mipless::{Footprint, Method, Options, PixelFilter, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use rayon::prelude::*;

/// Standard deviations of the footprint, in wavelengths of the lowest noise.
const SIZES: [f32; 7] = [0.03, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0];
/// The noises' seeds.
const SEEDS: [u32; 3] = [0, 1, 2];
const PIXELS: usize = 500;
const METHODS: [Method; 6] = [
    Method::Naive,
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Split(4),
    Method::Split(16),
];

/// A chain that ends in the node `o` with values of [0, 1].
struct Chain {
    name: &'static str,
    /// The design study's figure, in thousandths; not a number for chains that it has not.
    fusion: f64,
    /// The nodes; `{n}` stands for a noise of unit variance, number n.
    nodes: &'static str,
}

const CHAINS: [Chain; 12] = [
    Chain {
        name: "sin(8 gain(abs N))",
        fusion: 38.0,
        nodes: r#"{0},"a":{"type":"absval","inputs":{"in":{"node":"n0"}}},"g":{"type":"smoothstep","inputs":{"in":{"node":"a"},"low":0,"high":2}},"m":{"type":"multiply","inputs":{"in1":{"node":"g"},"in2":8}},"s":{"type":"sin","inputs":{"in":{"node":"m"}}},"o":{"type":"range","inputs":{"in":{"node":"s"},"inlow":-1,"inhigh":1}}"#,
    },
    Chain {
        name: "step(gain(abs N))",
        fusion: 80.0,
        nodes: r#"{0},"a":{"type":"absval","inputs":{"in":{"node":"n0"}}},"g":{"type":"smoothstep","inputs":{"in":{"node":"a"},"low":0,"high":2}},"o":{"type":"step","inputs":{"in":{"node":"g"},"edge":0.3}}"#,
    },
    Chain {
        name: "turbulence (4 octaves), smoothstep",
        fusion: 49.0,
        nodes: r#"{0},{1},{2},{3},"a0":{"type":"absval","inputs":{"in":{"node":"n0"}}},"a1":{"type":"absval","inputs":{"in":{"node":"n1"}}},"a2":{"type":"absval","inputs":{"in":{"node":"n2"}}},"a3":{"type":"absval","inputs":{"in":{"node":"n3"}}},"h1":{"type":"multiply","inputs":{"in1":{"node":"a1"},"in2":0.5}},"h2":{"type":"multiply","inputs":{"in1":{"node":"a2"},"in2":0.25}},"h3":{"type":"multiply","inputs":{"in1":{"node":"a3"},"in2":0.125}},"t1":{"type":"add","inputs":{"in1":{"node":"a0"},"in2":{"node":"h1"}}},"t2":{"type":"add","inputs":{"in1":{"node":"t1"},"in2":{"node":"h2"}}},"t":{"type":"add","inputs":{"in1":{"node":"t2"},"in2":{"node":"h3"}}},"o":{"type":"smoothstep","inputs":{"in":{"node":"t"},"low":0.6,"high":2.4}}"#,
    },
    Chain {
        name: "turbulence, step",
        fusion: 77.0,
        nodes: r#"{0},{1},{2},{3},"a0":{"type":"absval","inputs":{"in":{"node":"n0"}}},"a1":{"type":"absval","inputs":{"in":{"node":"n1"}}},"a2":{"type":"absval","inputs":{"in":{"node":"n2"}}},"a3":{"type":"absval","inputs":{"in":{"node":"n3"}}},"h1":{"type":"multiply","inputs":{"in1":{"node":"a1"},"in2":0.5}},"h2":{"type":"multiply","inputs":{"in1":{"node":"a2"},"in2":0.25}},"h3":{"type":"multiply","inputs":{"in1":{"node":"a3"},"in2":0.125}},"t1":{"type":"add","inputs":{"in1":{"node":"a0"},"in2":{"node":"h1"}}},"t2":{"type":"add","inputs":{"in1":{"node":"t1"},"in2":{"node":"h2"}}},"t":{"type":"add","inputs":{"in1":{"node":"t2"},"in2":{"node":"h3"}}},"o":{"type":"step","inputs":{"in":{"node":"t"},"edge":1.5}}"#,
    },
    Chain {
        name: "mix(c1, c2, smoothstep(N1) N2)",
        fusion: 18.0,
        nodes: r##"{0},{1},"s":{"type":"smoothstep","inputs":{"in":{"node":"n0"},"low":-1,"high":1}},"h":{"type":"range","inputs":{"in":{"node":"n1"},"inlow":-2,"inhigh":2}},"m":{"type":"multiply","inputs":{"in1":{"node":"s"},"in2":{"node":"h"}}},"o":{"type":"mix","inputs":{"bg":[0.1,0.2,0.8],"fg":[0.9,0.7,0.1],"mix":{"node":"m"}}}"##,
    },
    Chain {
        name: "sin(3 smoothstep(N1) N2)",
        fusion: 35.0,
        nodes: r#"{0},{1},"s":{"type":"smoothstep","inputs":{"in":{"node":"n0"},"low":-1,"high":1}},"m":{"type":"multiply","inputs":{"in1":{"node":"s"},"in2":{"node":"n1"}}},"p":{"type":"multiply","inputs":{"in1":{"node":"m"},"in2":3}},"w":{"type":"sin","inputs":{"in":{"node":"p"}}},"o":{"type":"range","inputs":{"in":{"node":"w"},"inlow":-1,"inhigh":1}}"#,
    },
    Chain {
        name: "ramp(max(N1, N2))",
        fusion: 24.0,
        nodes: r#"{0},{1},"m":{"type":"max","inputs":{"in1":{"node":"n0"},"in2":{"node":"n1"}}},"o":{"type":"colorramp","inputs":{"in":{"node":"m"},"stops":[{"at":-1,"value":0},{"at":1.5,"value":1}]}}"#,
    },
    Chain {
        name: "step(max(N1, N2))",
        fusion: 51.0,
        nodes: r#"{0},{1},"m":{"type":"max","inputs":{"in1":{"node":"n0"},"in2":{"node":"n1"}}},"o":{"type":"step","inputs":{"in":{"node":"m"},"edge":0.5}}"#,
    },
    Chain {
        name: "ridged multifractal (3 octaves)",
        fusion: 40.0,
        nodes: RIDGED,
    },
    Chain {
        name: "step(ridged)",
        fusion: 68.0,
        nodes: STEPPED_RIDGED,
    },
    Chain {
        name: "step(N1 N2)",
        fusion: f64::NAN,
        nodes: r#"{0},{1},"m":{"type":"multiply","inputs":{"in1":{"node":"n0"},"in2":{"node":"n1"}}},"o":{"type":"step","inputs":{"in":{"node":"m"},"edge":0.3}}"#,
    },
    Chain {
        name: "step(step(N1) + N2/4)",
        fusion: f64::NAN,
        nodes: r#"{0},{1},"s":{"type":"step","inputs":{"in":{"node":"n0"},"edge":0.2}},"h":{"type":"multiply","inputs":{"in1":{"node":"n1"},"in2":0.25}},"t":{"type":"add","inputs":{"in1":{"node":"s"},"in2":{"node":"h"}}},"o":{"type":"step","inputs":{"in":{"node":"t"},"edge":0.7}}"#,
    },
];

/// Musgrave's recurrence: s = (1 − |N|/2)², weighted by the octave before.
macro_rules! ridged {
    ($end:literal) => {
        concat!(
            r#"{0},{1},{2},"a0":{"type":"absval","inputs":{"in":{"node":"n0"}}},"r0":{"type":"range","inputs":{"in":{"node":"a0"},"inhigh":2,"outlow":1,"outhigh":0}},"s0":{"type":"power","inputs":{"in1":{"node":"r0"},"in2":2}},"w0":{"type":"clamp","inputs":{"in":{"node":"s0"}}},"#,
            r#""a1":{"type":"absval","inputs":{"in":{"node":"n1"}}},"r1":{"type":"range","inputs":{"in":{"node":"a1"},"inhigh":2,"outlow":1,"outhigh":0}},"q1":{"type":"power","inputs":{"in1":{"node":"r1"},"in2":2}},"s1":{"type":"multiply","inputs":{"in1":{"node":"q1"},"in2":{"node":"w0"}}},"w1":{"type":"clamp","inputs":{"in":{"node":"s1"}}},"#,
            r#""a2":{"type":"absval","inputs":{"in":{"node":"n2"}}},"r2":{"type":"range","inputs":{"in":{"node":"a2"},"inhigh":2,"outlow":1,"outhigh":0}},"q2":{"type":"power","inputs":{"in1":{"node":"r2"},"in2":2}},"s2":{"type":"multiply","inputs":{"in1":{"node":"q2"},"in2":{"node":"w1"}}},"#,
            r#""h1":{"type":"multiply","inputs":{"in1":{"node":"s1"},"in2":0.5}},"h2":{"type":"multiply","inputs":{"in1":{"node":"s2"},"in2":0.25}},"t1":{"type":"add","inputs":{"in1":{"node":"s0"},"in2":{"node":"h1"}}},"t":{"type":"add","inputs":{"in1":{"node":"t1"},"in2":{"node":"h2"}}},"#,
            $end
        )
    };
}
const RIDGED: &str =
    ridged!(r#""o":{"type":"multiply","inputs":{"in1":{"node":"t"},"in2":0.5714}}"#);
const STEPPED_RIDGED: &str =
    ridged!(r#""o":{"type":"step","inputs":{"in":{"node":"t"},"edge":0.6}}"#);

impl Chain {
    /// The texture with noises of this seed; the n-th noise of a sum of octaves is 2ⁿ times as fine.
    fn texture(&self, seed: u32) -> Texture {
        let octaves = self.nodes.contains("{2}");
        let mut nodes = self.nodes.to_owned();
        for n in 0..4u32 {
            let frequency = if octaves { 1 << n } else { 1 };
            let noise = format!(
                r#""n{n}":{{"type":"spectralnoise2d","inputs":{{"amplitude":4,"frequency":{frequency},"seed":{}}}}}"#,
                seed + 10 * n
            );
            nodes = nodes.replace(&format!("{{{n}}}"), &noise);
        }
        Texture::from_json(&format!(
            r#"{{"version":1,"name":"chain","nodes":{{{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
        ))
        .unwrap_or_else(|error| panic!("{}: {error:?}", self.name))
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|argument| argument == "--test") {
        return;
    }
    let wanted = |name: &str| {
        let mut names = arguments.iter().filter(|a| !a.starts_with("--")).peekable();
        names.peek().is_none() || names.any(|part| name.contains(part.as_str()))
    };
    let heads: Vec<String> = METHODS.iter().map(ToString::to_string).collect();
    println!("| chain | fusion | {} |", heads.join(" | "));
    println!("|---|---|{}", "---|".repeat(METHODS.len()));
    for chain in CHAINS.iter().filter(|chain| wanted(chain.name)) {
        let textures = SEEDS.map(|seed| chain.texture(seed));
        let runs: Vec<(usize, f32)> = (0..SEEDS.len())
            .flat_map(|seed| SIZES.map(|size| (seed, size)))
            .collect();
        let squares: Vec<Vec<f64>> = runs
            .par_iter()
            .map(|&(seed, size)| errors(&textures[seed], size))
            .collect();
        let totals: Vec<String> = (0..METHODS.len())
            .map(|i| {
                let mean = squares.iter().map(|s| s[i]).sum::<f64>() / runs.len() as f64;
                format!("{:.1}", 1e3 * mean.sqrt())
            })
            .collect();
        let fusion = if chain.fusion.is_nan() {
            "–".to_owned()
        } else {
            chain.fusion.to_string()
        };
        println!("| {} | {fusion} | {} |", chain.name, totals.join(" | "));
        if arguments.iter().any(|argument| argument == "--sizes") {
            for size in SIZES {
                let of_size = |i: usize| {
                    let picked = runs.iter().zip(&squares).filter(|(run, _)| run.1 == size);
                    let sum: f64 = picked.map(|(_, s)| s[i]).sum();
                    format!("{:.1}", 1e3 * (sum / SEEDS.len() as f64).sqrt())
                };
                let cells: Vec<String> = (0..METHODS.len()).map(of_size).collect();
                println!("| … {size} | | {} |", cells.join(" | "));
            }
        }
    }
}

/// The mean squared error of each method at one footprint.
fn errors(texture: &Texture, size: f32) -> Vec<f64> {
    let footprints: Vec<Footprint> = (0..PIXELS)
        .map(|i| {
            // The R2 sequence spreads pixels over 80 wavelengths.
            let p = [0.754_877_666, 0.569_840_29].map(|step: f64| (i as f64 * step).fract() * 80.0);
            Footprint {
                cell: p.map(|x| x.floor() as i32),
                uv: p.map(|x| x.fract() as f32),
                du: [size, 0.0],
                dv: [0.0, size],
            }
        })
        .collect();
    let run = |method| {
        let program = texture.compile(&Options {
            method,
            filter: PixelFilter::Gaussian(1.0),
            ..Options::default()
        });
        let mut outputs = Vec::new();
        let evaluator = Evaluator::<f32>::of_program(&program);
        evaluator.evaluate_footprints(&mut Scratch::new(), &footprints, &[], &mut outputs);
        outputs.concat()
    };
    let truth = run(Method::Supersample(4096));
    (METHODS.iter())
        .map(|&method| {
            let values = run(method);
            let square = |(&a, &b): (&f32, &f32)| f64::from(a - b).powi(2);
            values.iter().zip(&truth).map(square).sum::<f64>() / truth.len() as f64
        })
        .collect()
}
