//! Filtered patterns against dense sums of the pattern itself.

mod hatch;
mod upstream;

use crate::{catalogue, specs};
use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};
use serde_json::{Value, json};

/// Means, then variances, in f64, at the defaults of the graph's inputs.
fn evaluated(text: &str, method: Method, footprints: &[Footprint]) -> Vec<Vec<f64>> {
    let loaded = load(text, &specs());
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{text}\n{:?}", loaded.diagnostics));
    let options = CheckOptions {
        allow_sampling: true,
    };
    let checked = check(graph, &options).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    let options = Options {
        method,
        moments: true,
        filter: PixelFilter::Gaussian(1.0),
        ..Options::default()
    };
    let program = compile(&checked, catalogue(), &options);
    let inputs = program.interface.parameters.iter();
    let defaults: Vec<f32> = inputs.flat_map(|p| p.default.clone()).collect();
    eval_program::<f64>(&program, footprints, &defaults)
}

/// A graph of one node.
pub(super) fn graph(ty: &str, inputs: &Value) -> String {
    json!({
        "version": 1, "name": "law",
        "nodes": { "x": { "type": ty, "inputs": inputs } },
        "outputs": { "out": { "node": "x" } }
    })
    .to_string()
}

/// Footprints of this size: round ones, or turned ones of 8:1.
fn footprints(size: f32, turned: bool, places: usize) -> Vec<Footprint> {
    (0..places)
        .map(|i| {
            let uv = [0.754_877_67, 0.569_840_3].map(|step: f32| (0.013 + step * i as f32).fract());
            let (du, dv) = if turned {
                // The direction differs from place to place.
                let (s, c) = (0.5 + 0.7 * i as f32).sin_cos();
                let (long, short) = (size * 8f32.sqrt(), size / 8f32.sqrt());
                ([long * c, long * s], [-short * s, short * c])
            } else {
                ([size, 0.0], [0.0, size])
            };
            Footprint {
                cell: [i as i32 % 3 - 1, 0],
                uv,
                du,
                dv,
            }
        })
        .collect()
}

/// Φ at −6 and every [`STEP`] from there.
fn masses() -> Vec<f64> {
    let mut mass = 0.0;
    (0..12_000)
        .map(|i| {
            let z = STEP * (f64::from(i) - 0.5) - 6.0;
            mass += STEP * (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
            mass
        })
        .collect()
}

/// Φ⁻¹ of a number in (0, 1), from a table of Φ.
fn quantile(table: &[f64], p: f64) -> f64 {
    let after = table
        .partition_point(|&mass| mass < p)
        .clamp(1, table.len() - 1);
    let (low, high) = (table[after - 1], table[after]);
    (after as f64 - 1.0 + (p - low) / (high - low)) * STEP - 6.0
}

const STEP: f64 = 1e-3;

/// Mean and variance of the point values of the first component over a footprint.
fn dense(text: &str, footprints: &[Footprint], points: usize) -> Vec<[f64; 2]> {
    dense_components(text, footprints, points).swap_remove(0)
}

/// The same of each component, by the R2 sequence (Roberts 2018) of normal numbers: an edge is met by
/// the same share of the points in any direction.
fn dense_components(text: &str, footprints: &[Footprint], points: usize) -> Vec<Vec<[f64; 2]>> {
    let table = masses();
    let normal: Vec<[f64; 2]> = (0..points)
        .map(|i| {
            [0.754_877_666_246_693, 0.569_840_290_998_053]
                .map(|step| quantile(&table, (0.5 + step * i as f64).fract()))
        })
        .collect();
    let mut samples = Vec::with_capacity(points * footprints.len());
    for footprint in footprints {
        for [x, y] in &normal {
            let uv = [0, 1].map(|k| {
                let step = f64::from(footprint.du[k]) * x + f64::from(footprint.dv[k]) * y;
                f64::from(footprint.uv[k]) + step
            });
            let whole = uv.map(f64::floor);
            samples.push(Footprint {
                cell: [0, 1].map(|k| footprint.cell[k] + whole[k] as i32),
                uv: [0, 1].map(|k| (uv[k] - whole[k]) as f32),
                ..Footprint::default()
            });
        }
    }
    let values = evaluated(text, Method::Point, &samples);
    let moments = |chunk: &[f64]| {
        let mean = chunk.iter().sum::<f64>() / chunk.len() as f64;
        let square = chunk.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        [mean, square / chunk.len() as f64]
    };
    (values[..values.len() / 2].iter())
        .map(|component| component.chunks(points).map(moments).collect())
        .collect()
}

/// The largest errors of mean and variance over the sizes, for round and turned footprints.
fn errors<const N: usize>(text: &str, sizes: &[f32], methods: [Method; N]) -> [[[f64; 2]; 2]; N] {
    let (places, points) = if is_long() { (12, 100_000) } else { (4, 8_000) };
    let mut worst = [[[0.0f64; 2]; 2]; N];
    for turned in [false, true] {
        for &size in sizes {
            let footprints = footprints(size, turned, places);
            let truth = dense(text, &footprints, points);
            for (worst, method) in worst.iter_mut().zip(methods) {
                let filtered = evaluated(text, method, &footprints);
                let variances = &filtered[filtered.len() / 2];
                let worst = &mut worst[usize::from(turned)];
                for (i, truth) in truth.iter().enumerate() {
                    let found = [filtered[0][i], variances[i]];
                    for k in 0..2 {
                        worst[k] = worst[k].max((found[k] - truth[k]).abs());
                    }
                }
            }
        }
    }
    worst
}

/// Sizes in cells, from where an edge is a line to where nothing is left.
const SIZES: [f32; 7] = [0.01, 0.04, 0.1, 0.2, 0.35, 0.7, 2.0];

/// Holds the errors of mean and variance: round, then turned 8:1.
fn held(ty: &str, inputs: &Value, cell: f32, bounds: [[f64; 2]; 2]) {
    let sizes = SIZES.map(|size| size * cell);
    let methods = [Method::Local, Method::Quad];
    let found = errors(&graph(ty, inputs), &sizes, methods);
    for (found, method) in found.iter().zip(methods) {
        println!("{ty} {inputs} by {method}: {found:.5?}");
        for (found, bound) in found.iter().flatten().zip(bounds.iter().flatten()) {
            assert!(
                found <= bound,
                "{ty} {inputs} by {method}: {found} > {bound}"
            );
        }
    }
}

/// Every bond.
const BONDS: [&str; 6] = [
    "running",
    "english",
    "flemish",
    "herringbone",
    "basket",
    "spanish",
];

/// What the dense sums themselves may be off by: footprints of 8:1 meet many edges.
fn tolerance() -> f64 {
    if is_long() { 2.5e-3 } else { 1e-2 }
}

fn is_long() -> bool {
    std::env::var_os("MIPLESS_LONG").is_some()
}

#[test]
fn separable_patterns_are_filtered_exactly() {
    let bound = [[tolerance(); 2]; 2];
    held("checkerboard", &json!({ "uvtiling": [1, 1] }), 1.0, bound);
    for staggered in [false, true] {
        let inputs = json!({ "thickness": 0.2, "staggered": staggered });
        held("grid", &inputs, 1.0, bound);
    }
}

#[test]
fn bricks_are_filtered_exactly() {
    for bond in BONDS {
        let inputs = json!({ "bond": bond, "columns": 1, "rows": 2, "mortar": 0.15 });
        held("brick", &inputs, 0.7, [[tolerance(); 2]; 2]);
    }
}

#[test]
fn random_bricks_are_filtered_until_they_fade() {
    for bond in ["running", "flemish", "herringbone", "spanish"] {
        let inputs =
            json!({ "bond": bond, "columns": 1, "rows": 2, "output": "random", "seed": 3 });
        held("brick", &inputs, 0.3, [[1e-3; 2], [0.012, 0.006]]);
        held("brick", &inputs, 1.0, [[0.04, 0.015], [0.04, 0.015]]);
    }
}

#[test]
fn bevelled_bricks_have_their_mean_and_nearly_their_variance() {
    for bond in ["running", "herringbone", "spanish"] {
        let inputs = json!({ "bond": bond, "columns": 1, "rows": 2, "mortar": 0.1, "bevel": 0.3 });
        held("brick", &inputs, 0.7, [[tolerance(), 0.05]; 2]);
    }
}

#[test]
fn walls_with_live_joints_are_those_with_fixed_ones() {
    for bond in BONDS {
        for (mortar, bevel) in [(0.15, 0.0), (0.1, 0.3)] {
            let inputs = |mortar: Value, bevel: Value| json!({ "bond": bond, "columns": 1, "rows": 2, "mortar": mortar, "bevel": bevel });
            let fixed = graph("brick", &inputs(json!(mortar), json!(bevel)));
            let live = json!({
                "version": 1, "name": "live",
                "inputs": { "a": { "type": "float", "value": mortar, "min": 0, "max": 1 }, "b": { "type": "float", "value": bevel, "min": 0, "max": 1 } },
                "nodes": { "x": { "type": "brick", "inputs": inputs(json!({ "input": "a" }), json!({ "input": "b" })) } },
                "outputs": { "out": { "node": "x" } }
            })
            .to_string();
            for method in [Method::Local, Method::Quad] {
                for turned in [false, true] {
                    for size in SIZES {
                        let footprints = footprints(0.7 * size, turned, 12);
                        let wanted = evaluated(&fixed, method, &footprints);
                        let found = evaluated(&live, method, &footprints);
                        for (part, bound) in [(0, 2e-3), (1, 6e-3)] {
                            for (found, wanted) in found[part].iter().zip(&wanted[part]) {
                                let error = (found - wanted).abs();
                                assert!(
                                    error < bound,
                                    "{bond} {mortar} {bevel} {method} {size} {turned} {part}: {found} {wanted}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn every_place_belongs_to_one_brick() {
    let places: Vec<Footprint> = (0..400)
        .map(|i| Footprint {
            uv: [0.754_877_67, 0.569_840_3].map(|step: f32| (0.5 + step * i as f32).fract()),
            cell: [i % 5 - 2, i % 7 - 3],
            ..Footprint::default()
        })
        .collect();
    for bond in BONDS {
        let inputs =
            json!({ "bond": bond, "columns": 1.3, "rows": 2.7, "mortar": 0, "row_offset": 0.3 });
        let values = &evaluated(&graph("brick", &inputs), Method::Point, &places)[0];
        assert!(values.iter().all(|&x| x == 1.0), "{bond}");
    }
}

/// The RMS error of the mean of a noise of standard deviation 1 that is read at coordinates, over
/// footprints of a size.
fn read_error(coordinate: &Value, size: f32, turned: bool) -> f64 {
    let graph = json!({
        "version": 1, "name": "read",
        "nodes": {
            "place": coordinate,
            "x": { "type": "noise2d", "inputs": { "texcoord": { "node": "place" }, "frequency": 6, "amplitude": 4 } }
        },
        "outputs": { "out": { "node": "x" } }
    })
    .to_string();
    let places = 30;
    let footprints = footprints(size, turned, places);
    let truth = dense(&graph, &footprints, 1000);
    let found = &evaluated(&graph, Method::Local, &footprints)[0];
    let square = |(found, truth): (&f64, &[f64; 2])| (found - truth[0]).powi(2);
    let sum: f64 = found.iter().zip(&truth).map(square).sum();
    (sum / places as f64).sqrt()
}

#[test]
fn ramps_and_splits_are_filtered_exactly() {
    let exact = [[1e-3; 2]; 2];
    for name in ["ramplr", "splitlr"] {
        held(name, &json!({ "valuel": 0, "valuer": 1 }), 1.0, exact);
    }
    for name in ["ramptb", "splittb"] {
        held(name, &json!({ "valuet": 0, "valueb": 1 }), 1.0, exact);
    }
    let corners = json!({ "valuetl": 0.5, "valuetr": 0, "valuebl": 0, "valuebr": 1 });
    held("ramp4", &corners, 1.0, [[1e-3, 0.02], [0.08, 0.16]]);
}

#[test]
fn figures_are_filtered_exactly() {
    let bound = [[tolerance(); 2]; 2];
    for radius in [0.2, 0.5] {
        let inputs = json!({ "center": [0.4, 0.6], "radius": radius });
        held("circle", &inputs, 1.0, bound);
        held("hexagon", &inputs, 1.0, bound);
    }
    held("shape", &json!({ "rotate": 20 }), 1.0, bound);
    held(
        "shape",
        &json!({ "shape": "star", "inner": 0.3, "sides": 6 }),
        1.0,
        bound,
    );
    // The ends of a line are figures of 24 corners.
    let bound = [[tolerance().max(6e-3); 2]; 2];
    held("line", &json!({}), 1.0, bound);
    let thin = json!({ "radius": 0.02, "point1": [0.9, 0.1], "point2": [0.2, 0.4] });
    held("line", &thin, 1.0, bound);
}

#[test]
fn soft_edges_have_nearly_their_means() {
    let bounds = [
        (0.02, [[[tolerance(), 0.015]; 2]; 3]),
        (
            0.2,
            [
                [[0.01, 0.016], [0.023, 0.02]],
                [[0.01, 0.018], [0.03, 0.035]],
                [[0.045, 0.045], [0.05, 0.035]],
            ],
        ),
    ];
    for (edge, [of_disc, of_polygon, of_star]) in bounds {
        let disc = json!({ "center": [0.4, 0.6], "radius": 0.4, "edge": edge });
        held("circle", &disc, 1.0, of_disc);
        let polygon = json!({ "rotate": 20, "edge": edge });
        held("shape", &polygon, 1.0, of_polygon);
        let star = json!({ "shape": "star", "edge": edge });
        held("shape", &star, 1.0, of_star);
    }
}

#[test]
fn an_edge_much_wider_than_its_figure_has_its_mean() {
    // A thousandth of the rise lies in all of the footprint.
    for (edge, bound) in [
        (1000.0, [[1e-3; 2]; 2]),
        (30.0, [[4e-3, 3e-3], [6e-3, 0.015]]),
    ] {
        let disc = json!({ "center": [0.4, 0.6], "radius": 0.4, "edge": edge });
        held("circle", &disc, 1.0, bound);
        held("shape", &json!({ "rotate": 20, "edge": edge }), 1.0, bound);
        held(
            "shape",
            &json!({ "shape": "star", "edge": edge }),
            1.0,
            bound,
        );
    }
}

#[test]
fn waves_are_filtered_exactly() {
    for shape in ["sine", "triangle", "saw", "square"] {
        let inputs = json!({ "shape": shape, "frequency": 1, "rotate": 25, "phase": 0.1 });
        held("wave", &inputs, 1.0, [[tolerance(); 2]; 2]);
    }
}

#[test]
fn hatches_and_leaves_are_filtered_exactly() {
    let bound = [[tolerance(); 2]; 2];
    for staggered in [false, true] {
        let inputs = json!({ "thickness": 0.25, "staggered": staggered });
        held("crosshatch", &inputs, 1.0, bound);
    }
    held("cloverleaf", &json!({ "center": [0.4, 0.6] }), 1.0, bound);
    let across = [[tolerance() + 5e-4; 2], [0.01; 2]];
    held("tiledcloverleafs", &json!({ "size": 0.8 }), 1.0, across);
    // Leaves that overlap are cut where they meet, and more edges meet in a footprint.
    let cut = [[tolerance() + 1e-3; 2], [0.01; 2]];
    let staggered = json!({ "size": 0.9, "staggered": true });
    held("tiledcloverleafs", &staggered, 1.0, cut);
}

#[test]
fn tilings_are_filtered_exactly_unless_they_are_blurred_across() {
    for (staggered, size) in [(false, 0.5), (true, 0.9), (false, 0.95)] {
        let inputs = json!({ "size": size, "staggered": staggered });
        for name in ["tiledcircles", "tiledhexagons"] {
            held(name, &inputs, 1.0, [[tolerance(); 2], [0.01; 2]]);
        }
    }
}

#[test]
fn figures_of_size_0_are_not_there() {
    for name in ["tiledcircles", "tiledhexagons", "tiledcloverleafs"] {
        for method in [Method::Point, Method::Local, Method::Quad] {
            let text = graph(name, &json!({ "size": 0 }));
            for size in SIZES {
                let found = evaluated(&text, method, &footprints(size, true, 3));
                assert!(found.iter().flatten().all(|&x| x == 0.0), "{name} {method}");
            }
        }
    }
}

#[test]
fn gradients_around_a_centre_have_nearly_their_means() {
    held("gradientradial", &json!({}), 0.5, [[0.03; 2], [0.09; 2]]);
    held(
        "gradientangular",
        &json!({ "center": [-2, -3] }),
        0.3,
        [[0.02; 2]; 2],
    );
}

#[test]
fn coordinates_have_the_moments_that_their_pages_state() {
    held("mirror", &json!({}), 1.0, [[2e-3, 5e-3]; 2]);
    held("swirl", &json!({}), 0.025, [[0.02; 2], [0.07; 2]]);
    held("polar", &json!({ "center": [-2, -3] }), 0.3, [[0.02; 2]; 2]);
}

#[test]
fn what_reads_odd_coordinates_is_filtered_by_their_footprint() {
    for (ty, bound) in [
        ("mirror", 0.1),
        ("kaleidoscope", 0.15),
        ("swirl", 0.12),
        ("repeat", 0.25),
        ("polar", 0.2),
    ] {
        let coordinate = json!({ "type": ty });
        for (size, turned) in [
            (0.003, false),
            (0.01, false),
            (0.03, false),
            (0.01, true),
            (0.03, true),
        ] {
            let error = read_error(&coordinate, size, turned);
            println!("{ty} {size} {turned}: {error:.4}");
            assert!(error < bound, "{ty} {size} {turned}: {error:.4}");
        }
    }
}
