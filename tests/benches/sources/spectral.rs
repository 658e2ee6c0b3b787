//! Sums of cosines.

use crate::footprint::Shape;
use crate::table::{Source, Target, graph, print};

pub(crate) fn run() {
    print(&Source {
        name: "spectralnoise2d, one octave",
        graph: graph("spectralnoise2d", r#""amplitude":4"#),
        wavelength: 1.0,
        sd: 1.0,
        // The band ends at √2 cycles a wavelength.
        finest: 0.7,
        places: 192,
        extent: 60.0,
        target,
    });
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
