//! Sparse convolution with Gabor kernels.

use crate::cost::{Job, nanoseconds};
use crate::footprint::Shape;
use crate::table::{Source, Target, graph, print};
use mipless::Method;

pub(crate) fn run() {
    let source = |name, inputs, finest, target| Source {
        name,
        graph: graph("gabornoise2d", inputs),
        wavelength: 1.0,
        sd: 1.0,
        finest,
        places: 128,
        extent: 60.0,
        target,
    };
    cost();
    // Above 1 + 3/2πa cycles a wavelength there is a thousandth of the amplitude.
    print(&source(
        "gabornoise2d, one octave, all directions",
        r#""amplitude":4"#,
        0.5,
        target,
    ));
    print(&source(
        "gabornoise2d, one octave, directions within 27° of 20°",
        r#""amplitude":4,"anisotropy":0.7,"orientation":20"#,
        0.5,
        means,
    ));
    print(&source(
        "gabornoise2d, half an octave, one direction",
        r#""amplitude":4,"anisotropy":1,"orientation":70,"bandwidth":0.5"#,
        0.6,
        means,
    ));
}

/// Sixteen impulses by `local` against noise2d by `point`: the target is 12.
const COST: f64 = 12.0;

fn cost() {
    let (gabor, noise) = (graph("gabornoise2d", ""), graph("noise2d", ""));
    let sizes = [0.01, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0];
    let job = |graph, method, size| Job {
        graph,
        method,
        size,
    };
    let mut jobs = vec![
        job(&noise, Method::Point, 0.01),
        job(&gabor, Method::Point, 0.01),
    ];
    jobs.extend(sizes.map(|size| job(&gabor, Method::Local, size)));
    let times = nanoseconds(&jobs);
    println!(
        "gabornoise2d, 16 impulses, against noise2d by `point` ({:.0} ns):",
        times[0]
    );
    println!(
        "`point` {:.1}×; `local` (at most {COST}×) at s:",
        times[1] / times[0]
    );
    for (size, time) in sizes.iter().zip(&times[2..]) {
        let ratio = time / times[0];
        let mark = if ratio > COST { "**" } else { "" };
        println!("{size} {mark}{ratio:.1}×{mark}");
    }
    println!();
}

/// One octave: the mean up to what the windows drop; the standard deviation at .05 and .1 wavelengths.
fn target(size: f64, shape: Shape) -> Target {
    let local = match (size, shape.is_round()) {
        (0.05, true) => Some(0.04),
        (0.1, true) => Some(0.1),
        _ => None,
    };
    Target {
        mean: Some(0.03),
        local,
        quad: None,
    }
}

/// Of other bands only the mean is asked for.
fn means(_: f64, _: Shape) -> Target {
    Target {
        mean: Some(0.03),
        ..Target::default()
    }
}
