//! Noises with the quintic window, and what octaves cost that the footprint has removed.

use crate::cost::{Job, nanoseconds};
use crate::footprint::Shape;
use crate::table::{Source, Target, graph, print};
use mipless::Method;

pub(crate) fn run() {
    let source = |name, graph, wavelength, finest, target| Source {
        name,
        graph,
        wavelength,
        sd: 1.0,
        finest,
        places: 96,
        extent: 60.0,
        target,
    };
    print(&source(
        "noise2d, quintic (classic Perlin)",
        graph("noise2d", r#""amplitude":4,"kernel":"quintic""#),
        1.7,
        0.4,
        perlin,
    ));
    print(&source(
        "valuenoise2d",
        graph("valuenoise2d", r#""amplitude":4.42103,"pivot":0"#),
        3.144,
        0.2,
        perlin,
    ));
    println!("### Octaves that the footprint has removed\n");
    println!("nanoseconds a footprint, 8 octaves, at 16 wavelengths a pixel and at 1/16\n");
    println!("| node | method | 16 | 1/16 | ratio |\n|---|---|---|---|---|");
    for (node, inputs) in [
        ("fractal2d", r#""octaves":8"#),
        ("fractal2d", r#""octaves":8,"kernel":"quintic""#),
        ("turbulence2d", r#""octaves":8"#),
        ("ridged2d", r#""octaves":8"#),
    ] {
        let graph = graph(node, inputs);
        for method in [Method::Local, Method::Auto] {
            // In cells: a wavelength is about 1.6 of them.
            let jobs = [16.0, 1.0 / 16.0].map(|wavelengths| Job {
                graph: &graph,
                method,
                size: 1.6 * wavelengths,
            });
            let [wide, narrow] = nanoseconds(&jobs)[..] else {
                panic!("a time for each job")
            };
            let ratio = wide / narrow;
            println!("| {node} {inputs} | {method} | {wide:.0} | {narrow:.0} | {ratio:.3} |");
        }
    }
    println!();
}

/// The mean at any footprint, turned and 8:1 included.
fn perlin(_: f64, _: Shape) -> Target {
    Target {
        mean: Some(0.06),
        ..Target::default()
    }
}
