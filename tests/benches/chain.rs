//! What filtering costs: graphs that chain ten different nodes, by `point` and by `local`.
//!
//! `cargo bench -p mipless-tests --bench chain` prints Markdown: nanoseconds a pixel on one core by
//! `point`, and how many times that `local` takes (a median of at most 2 is the aim) with pixels of 4^k
//! wavelengths of the finest noise that all chains have, k from −3 to 3. The first row is that noise
//! alone.

use mipless::{Footprint, Method, Options, Program, Texture};
use mipless_tests::timing::fastest;

const PIXELS: usize = 1 << 11;
const RUNS: usize = 60;

/// Name, and the nodes as type, name, inputs; the last one is the output.
const CHAINS: [(&str, &str); 5] = [
    (
        "the noise alone",
        r#""o":{"type":"fractal2d","inputs":{"frequency":8,"amplitude":2,"octaves":4}}"#,
    ),
    (
        "one noise, ten functions of it",
        r#""n":{"type":"fractal2d","inputs":{"frequency":8,"amplitude":2,"octaves":4}},
        "c1":{"type":"multiply","inputs":{"in1":{"node":"n"},"in2":2.5}},
        "c2":{"type":"sin","inputs":{"in":{"node":"c1"}}},
        "c3":{"type":"absval","inputs":{"in":{"node":"c2"}}},
        "c4":{"type":"power","inputs":{"in1":{"node":"c3"},"in2":2}},
        "c5":{"type":"smoothstep","inputs":{"in":{"node":"c4"},"low":0.1,"high":0.9}},
        "c6":{"type":"gain","inputs":{"in":{"node":"c5"},"gain":0.7}},
        "c7":{"type":"levels","inputs":{"in":{"node":"c6"},"gamma":1.8,"doclamp":true}},
        "c8":{"type":"trianglewave","inputs":{"in":{"node":"c7"}}},
        "c9":{"type":"contrast","inputs":{"in":{"node":"c8"},"amount":1.4}},
        "o":{"type":"clamp","inputs":{"in":{"node":"c9"}}}"#,
    ),
    (
        "three noises, ten combinations",
        r#""n":{"type":"fractal2d","inputs":{"frequency":8,"amplitude":2,"octaves":4}},
        "m":{"type":"fractal2d","inputs":{"frequency":5,"amplitude":2,"octaves":3,"seed":1}},
        "p":{"type":"noise2d","inputs":{"frequency":3,"amplitude":2,"pivot":0.5,"seed":2}},
        "c1":{"type":"add","inputs":{"in1":{"node":"n"},"in2":{"node":"m"}}},
        "c2":{"type":"multiply","inputs":{"in1":{"node":"c1"},"in2":{"node":"p"}}},
        "c3":{"type":"max","inputs":{"in1":{"node":"c2"},"in2":{"node":"m"}}},
        "c4":{"type":"screen","inputs":{"fg":{"node":"c3"},"bg":{"node":"p"}}},
        "c5":{"type":"difference","inputs":{"fg":{"node":"c4"},"bg":{"node":"n"}}},
        "c6":{"type":"overlay","inputs":{"fg":{"node":"c5"},"bg":{"node":"p"}}},
        "c7":{"type":"ifgreater","inputs":{"value1":{"node":"p"},"value2":0.5,"in1":{"node":"c6"},"in2":{"node":"m"}}},
        "c8":{"type":"mix","inputs":{"bg":{"node":"c7"},"fg":{"node":"n"},"mix":{"node":"p"}}},
        "c9":{"type":"smoothmin","inputs":{"in1":{"node":"c8"},"in2":{"node":"m"},"width":0.2}},
        "o":{"type":"subtract","inputs":{"in1":{"node":"c9"},"in2":{"node":"p"}}}"#,
    ),
    (
        "two noises, functions and combinations",
        r#""n":{"type":"fractal2d","inputs":{"frequency":8,"amplitude":2,"octaves":4}},
        "m":{"type":"fractal2d","inputs":{"frequency":5,"amplitude":1,"octaves":3,"seed":1,"pivot":0.5}},
        "c1":{"type":"sin","inputs":{"in":{"node":"n"}}},
        "c2":{"type":"add","inputs":{"in1":{"node":"c1"},"in2":{"node":"m"}}},
        "c3":{"type":"absval","inputs":{"in":{"node":"c2"}}},
        "c4":{"type":"smoothstep","inputs":{"in":{"node":"c3"},"low":0.1,"high":0.9}},
        "c5":{"type":"multiply","inputs":{"in1":{"node":"c4"},"in2":{"node":"m"}}},
        "c6":{"type":"clamp","inputs":{"in":{"node":"c5"}}},
        "c7":{"type":"mix","inputs":{"bg":{"node":"c6"},"fg":0.8,"mix":{"node":"m"}}},
        "c8":{"type":"invert","inputs":{"in":{"node":"c7"}}},
        "c9":{"type":"range","inputs":{"in":{"node":"c8"},"inlow":0.2,"outhigh":2}},
        "o":{"type":"colorramp","inputs":{"in":{"node":"c9"},"stops":[{"at":0,"value":[0.1,0.2,0.3]},{"at":0.5,"value":[0.8,0.6,0.2]},{"at":1,"value":[1,1,0.9]}]}}"#,
    ),
    (
        "colours of one noise",
        r#""n":{"type":"fractal2d","inputs":{"frequency":8,"amplitude":2,"octaves":4}},
        "m":{"type":"fractal2d","inputs":{"frequency":5,"amplitude":1,"octaves":3,"seed":1,"pivot":0.5}},
        "c1":{"type":"colorramp","inputs":{"in":{"node":"n"},"stops":[{"at":-0.5,"value":[0.1,0.2,0.3]},{"at":0.5,"value":[0.8,0.6,0.2]}]}},
        "c2":{"type":"saturate","inputs":{"in":{"node":"c1"},"amount":1.3}},
        "c3":{"type":"contrast","inputs":{"in":{"node":"c2"},"amount":1.2}},
        "c4":{"type":"screen","inputs":{"fg":{"node":"c3"},"bg":{"node":"m"}}},
        "c5":{"type":"brightness","inputs":{"in":{"node":"c4"},"brightness":0.1}},
        "c6":{"type":"multiply","inputs":{"in1":{"node":"c5"},"in2":0.9}},
        "c7":{"type":"lighten","inputs":{"fg":{"node":"c6"},"bg":0.2}},
        "c8":{"type":"mix","inputs":{"bg":{"node":"c7"},"fg":[0.5,0.4,0.3],"mix":0.2}},
        "c9":{"type":"clamp","inputs":{"in":{"node":"c8"}}},
        "c10":{"type":"luminance","inputs":{"in":{"node":"c9"}}},
        "o":{"type":"extract","inputs":{"in":{"node":"c10"}}}"#,
    ),
];

/// The wavelength of a noise of frequency 8, in units of texture space: 1.53 cells.
const WAVELENGTH: f32 = 1.53 / 8.0;

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    println!("| chain | point, ns | local/point at 1/64 | 1/16 | 1/4 | 1 | 4 | 16 | 64 | median |");
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (name, nodes) in CHAINS {
        let texture = Texture::from_json(&format!(
            r#"{{"version":1,"name":"chain","nodes":{{{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
        ))
        .unwrap_or_else(|mistakes| panic!("{name}: {}", mistakes[0]));
        let programs = [Method::Point, Method::Local].map(|method| {
            texture.compile(&Options {
                method,
                ..Options::default()
            })
        });
        let mut fastest = f64::INFINITY;
        let mut ratios: Vec<f64> = (-3..=3)
            .map(|k| {
                let [point, local] = times(&programs, WAVELENGTH * 4f32.powi(k));
                fastest = fastest.min(point);
                local / point
            })
            .collect();
        print!("| {name} | {fastest:.0} |");
        ratios.iter().for_each(|ratio| print!(" {ratio:.2} |"));
        ratios.sort_by(f64::total_cmp);
        println!(" {:.2} |", ratios[ratios.len() / 2]);
    }
}

/// Nanoseconds a pixel.
fn times(programs: &[Program; 2], pixel: f32) -> [f64; 2] {
    let footprints: Vec<Footprint> = (0..PIXELS)
        .map(|i| Footprint {
            cell: [0; 2],
            uv: [(i % 64) as f32 * pixel, (i / 64) as f32 * pixel],
            du: [pixel, 0.0],
            dv: [0.0, pixel],
        })
        .collect();
    fastest(programs, &footprints, RUNS).map(|seconds| seconds * 1e9 / PIXELS as f64)
}
