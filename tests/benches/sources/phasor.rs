//! Profiles of the phase of a Gabor field.

use crate::footprint::Shape;
use crate::table::{Source, Target, graph, print};

pub(crate) fn run() {
    for (name, profile, sd, finest) in [
        (
            "phasornoise2d, sine",
            "sine",
            std::f64::consts::FRAC_1_SQRT_2,
            0.25,
        ),
        ("phasornoise2d, sawtooth", "sawtooth", 0.577_350_3, 0.1),
    ] {
        print(&Source {
            name,
            graph: graph(
                "phasornoise2d",
                &format!(r#""amplitude":2,"profile":"{profile}","orientation":10"#),
            ),
            wavelength: 1.0,
            sd,
            finest,
            places: 64,
            extent: 60.0,
            target,
        });
    }
}

/// What the page states, for round footprints.
fn target(size: f64, shape: Shape) -> Target {
    let stated = [
        (0.02, 0.08, 0.08),
        (0.05, 0.06, 0.09),
        (0.1, 0.11, 0.12),
        (0.2, 0.18, 0.09),
        (0.5, 0.09, 0.04),
    ];
    let found = stated.iter().find(|row| row.0 == size && shape.is_round());
    Target {
        mean: found.map(|row| row.1),
        local: found.map(|row| row.2),
        quad: None,
    }
}
