//! Sums of cosines.

use crate::footprint::Shape;
use crate::table::{Source, Target, graph, print};

pub(crate) fn run() {
    let source = |name, inputs, finest, target| Source {
        name,
        graph: graph("spectralnoise2d", inputs),
        wavelength: 1.0,
        sd: 1.0,
        finest,
        places: 192,
        extent: 60.0,
        target,
    };
    // The band ends at √2 cycles a wavelength.
    print(&source(
        "spectralnoise2d, one octave",
        r#""amplitude":4"#,
        0.7,
        target,
    ));
    print(&source(
        "spectralnoise2d, four octaves by a power law",
        r#""amplitude":4,"spectrum":"power","bandwidth":4"#,
        0.25,
        means,
    ));
    print(&source(
        "spectralnoise2d, a list of three lines",
        r#""amplitude":4,"spectrum":"list","lines":[{"at":0.5,"value":1},{"at":1,"value":0.7},{"at":2,"value":0.5}]"#,
        0.5,
        means,
    ));
}

/// Any spectrum: the mean is exact.
fn means(_: f64, _: Shape) -> Target {
    Target {
        mean: Some(0.001),
        ..Target::default()
    }
}

/// One octave: the mean is exact; the standard deviation at .02, .05 and .1 wavelengths.
fn target(size: f64, shape: Shape) -> Target {
    let (local, quad) = match (size, shape.is_round()) {
        (0.02, true) => (Some(0.01), Some(0.001)),
        (0.05, true) => (Some(0.03), Some(0.003)),
        (0.1, true) => (Some(0.09), Some(0.02)),
        _ => (None, None),
    };
    Target {
        mean: Some(0.001),
        local,
        quad,
    }
}
