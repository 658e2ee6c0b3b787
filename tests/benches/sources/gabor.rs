//! Sparse convolution with Gabor kernels.

use crate::footprint::Shape;
use crate::table::{Source, Target, graph, print};

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
