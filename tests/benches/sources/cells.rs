//! Noises that are not Gaussian: random cells, and distances to random points.

use crate::footprint::Shape;
use crate::table::{Source, Target, graph, print};

pub(crate) fn run() {
    // One cell counts as a wavelength. Edges have all frequencies: the truth's grid is a limit.
    for (name, node, inputs, sd, finest) in [
        ("cellnoise2d", "cellnoise2d", "", 0.288_675, 0.06),
        ("worleynoise2d, F1", "worleynoise2d", "", 0.1898, 0.15),
        (
            "worleynoise2d, F2 − F1",
            "worleynoise2d",
            r#""output":"F2-F1""#,
            0.2019,
            0.15,
        ),
        (
            "worleynoise2d, solid",
            "worleynoise2d",
            r#""style":"solid""#,
            0.288_675,
            0.1,
        ),
    ] {
        print(&Source {
            name,
            graph: graph(node, inputs),
            wavelength: 1.0,
            sd,
            finest,
            places: 64,
            extent: 50.0,
            target,
        });
    }
}

/// Nothing was asked for.
fn target(_: f64, _: Shape) -> Target {
    Target::default()
}
