//! Every source keeps its detail 10⁶ units from the origin: in f32, through a frequency that is no
//! whole number and through a turned and scaled place, it is what it is in f64.

use mipless_codegen::cpu::{Evaluator, Footprint, Position, Scratch};
use mipless_codegen::float::Float;
use mipless_codegen::ir::Program;
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, Picture, check, load};
use std::sync::Arc;

/// A picture of waves that tiles.
fn picture() -> Picture {
    let number = |i: usize| {
        let at = [i % 32, i / 32].map(|x| x as f64 / 32.0 * std::f64::consts::TAU);
        (0.5 + 0.2 * (2.0 * at[0] + at[1]).sin() + 0.2 * (3.0 * at[1] - at[0]).cos()) as f32
    };
    Picture::new((32, 32), 1, false, (0..32 * 32).map(number).collect())
}

/// The sources that lie on a surface, with inputs.
const FLAT: [(&str, &str); 20] = [
    ("noise2d", r#""frequency":3.3"#),
    ("noise2d", r#""frequency":3.3,"kernel":"quintic""#),
    ("noise2d", r#""frequency":3.3,"period":7"#),
    ("fractal2d", r#""frequency":3.3,"lacunarity":2.1"#),
    ("valuenoise2d", r#""frequency":3.3"#),
    ("turbulence2d", r#""frequency":3.3"#),
    ("ridged2d", r#""frequency":3.3"#),
    ("multifractal2d", r#""frequency":3.3"#),
    ("spectralnoise2d", r#""frequency":3.3"#),
    ("gabornoise2d", r#""frequency":3.3"#),
    ("phasornoise2d", r#""frequency":3.3"#),
    ("phasornoise2d", r#""frequency":3.3,"profile":"triangle""#),
    ("worleynoise2d", r#""frequency":3.3"#),
    ("worleynoise2d", r#""frequency":3.3,"output":"F2-F1""#),
    ("worleynoise2d", r#""frequency":3.3,"style":"solid""#),
    ("cellnoise2d", r#""frequency":3.3"#),
    ("whitenoise2d", r#""frequency":3.3"#),
    (
        "image",
        r#""file":"a.png","signature":"float","uvtiling":[3.3,3.3]"#,
    ),
    (
        "image",
        r#""file":"a.png","signature":"float","uaddressmode":"mirror","uvtiling":[3.3,3.3]"#,
    ),
    (
        "byexample",
        r#""file":"a.png","signature":"float","uvtiling":[3.3,3.3]"#,
    ),
];

/// Those in space.
const SOLID: [(&str, &str); 4] = [
    ("noise3d", r#""frequency":3.3"#),
    ("noise3d", r#""frequency":3.3,"kernel":"quintic""#),
    ("fractal3d", r#""frequency":3.3,"lacunarity":2.1"#),
    (
        "fractal3d",
        r#""frequency":3.3,"kernel":"quintic","period":6"#,
    ),
];

fn program(json: &str, method: Method) -> Program {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(json, &specs);
    let mut graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    for file in &loaded.files {
        graph.images.insert(&*file.name, Arc::new(picture()));
    }
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter: PixelFilter::Gaussian(1.0),
        moments: true,
        seed: 0,
    };
    compile(&checked, catalogue, &options)
}

fn evaluated<F: Float>(program: &Program, at: &[(Footprint, Position)]) -> Vec<Vec<f64>> {
    let (footprints, positions): (Vec<_>, Vec<_>) = at.iter().copied().unzip();
    let mut out: Vec<Vec<F>> = Vec::new();
    Evaluator::<F>::of_program(program).evaluate_surface(
        &mut Scratch::new(),
        &footprints,
        &positions,
        &[],
        &mut out,
    );
    (out.iter())
        .map(|values| values.iter().map(|x| x.to_f64()).collect())
        .collect()
}

/// Footprints of up to a tenth of a unit around a far place.
fn places(far: [i32; 3], size: f32) -> Vec<(Footprint, Position)> {
    (0..400)
        .map(|i| {
            let steps = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
            let xyz = steps.map(|step| (f64::from(i) * step).fract() as f32);
            let cell = [0, 1, 2].map(|k| far[k] + (i / [1, 7, 49][k]) % 7);
            let footprint = Footprint {
                cell: [cell[0], cell[1]],
                uv: [xyz[0], xyz[1]],
                du: [size, 0.0],
                dv: [0.3 * size, 0.5 * size],
            };
            let position = Position {
                cell,
                xyz,
                dx: [size, 0.0, 0.2 * size],
                dy: [0.3 * size, 0.5 * size, 0.0],
            };
            (footprint, position)
        })
        .collect()
}

fn deviation(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// Of 400 places, at most 2 % may lie where an edge runs through: there f32 may be on its other side.
fn hold(name: &str, json: &str) {
    for method in [Method::Point, Method::Local] {
        let program = program(json, method);
        for size in [0.0, 0.02, 0.1] {
            let near = evaluated::<f64>(&program, &places([0; 3], size));
            for far in [
                [1_000_000, -1_000_000, 1_000_000],
                [-1_000_000, 999_999, -999_983],
            ] {
                let at = places(far, size);
                let exact = evaluated::<f64>(&program, &at);
                let found = evaluated::<f32>(&program, &at);
                let sd = deviation(&near[0]);
                for (channel, (found, exact)) in found.iter().zip(&exact).enumerate() {
                    let unit = if channel == 0 { sd } else { sd * sd };
                    let off = |(x, y): &(&f64, &f64)| (*x - *y).abs() > 2e-3 * unit.max(1e-3);
                    let count = found.iter().zip(exact).filter(off).count();
                    assert!(
                        count <= 8,
                        "{name} by {method} over {size} at {far:?}: {count} of channel {channel}"
                    );
                }
                let spread = deviation(&found[0]);
                assert!(
                    (0.6 * sd..=1.7 * sd).contains(&spread),
                    "{name} by {method} over {size} at {far:?}: {spread}, not {sd}"
                );
            }
        }
    }
}

#[test]
fn sources_on_a_surface_keep_their_detail_far_away() {
    for (node, inputs) in FLAT {
        let graph = |more: &str, place: &str| {
            format!(
                r#"{{"version":1,"name":"n","nodes":{{{place}"n":{{"type":"{node}","inputs":{{{inputs}{more}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
            )
        };
        hold(&format!("{node} {inputs}"), &graph("", ""));
        let place = r#""uv":{"type":"texcoord"},"p":{"type":"place2d","inputs":{"texcoord":{"node":"uv"},"scale":[0.7,1.3],"rotate":-27,"offset":[0.31,-4.2]}},"#;
        hold(
            &format!("placed {node} {inputs}"),
            &graph(r#","texcoord":{"node":"p"}"#, place),
        );
    }
}

#[test]
fn sources_in_space_keep_their_detail_far_away() {
    for (node, inputs) in SOLID {
        let json = format!(
            r#"{{"version":1,"name":"n","nodes":{{"n":{{"type":"{node}","inputs":{{{inputs}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
        );
        hold(&format!("{node} {inputs}"), &json);
    }
}

/// Noises around a pivot, whose octaves leave what an f32 or an integer can hold.
const STEEP: [(&str, &str); 7] = [
    ("noise2d", ""),
    ("noise2d", r#","kernel":"quintic""#),
    ("valuenoise2d", ""),
    ("fractal2d", r#","octaves":10,"lacunarity":8"#),
    (
        "fractal2d",
        r#","octaves":10,"lacunarity":8,"kernel":"quintic""#,
    ),
    ("fractal3d", r#","octaves":10,"lacunarity":8"#),
    (
        "fractal3d",
        r#","octaves":10,"lacunarity":8,"kernel":"quintic""#,
    ),
];

#[test]
fn no_size_and_no_place_takes_a_noise_from_its_pivot() {
    const PIVOT: f64 = -3.7;
    for (node, inputs) in STEEP {
        let json = format!(
            r#"{{"version":1,"name":"n","nodes":{{"n":{{"type":"{node}","inputs":{{"pivot":{PIVOT}{inputs}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
        );
        for method in [Method::Point, Method::Ensemble, Method::Local, Method::Quad] {
            let program = program(&json, method);
            for exponent in -12..=11 {
                let size = 10f32.powi(exponent);
                let mut at = places([0; 3], size);
                at.extend(places([1 << 30, -(1 << 30), i32::MAX - 8], size));
                // Beyond what the cell of an integer holds.
                at.extend(
                    places([0; 3], size)
                        .into_iter()
                        .map(|(footprint, position)| {
                            let far = Footprint {
                                uv: [1e11, -3e20],
                                ..footprint
                            };
                            let there = Position {
                                xyz: [1e11, -3e20, 7e9],
                                ..position
                            };
                            (far, there)
                        }),
                );
                let found = evaluated::<f32>(&program, &at);
                let what = format!("{node} {inputs} by {method} over {size:e}");
                for (i, (mean, variance)) in found[0].iter().zip(&found[1]).enumerate() {
                    let what = format!("{what} at {i}: {mean} ± √{variance}");
                    assert!((mean - PIVOT).abs() < 2.5, "{what}: {mean}");
                    assert!((0.0..0.5).contains(variance), "{what}: {variance}");
                    if size >= 1e3 && method != Method::Point {
                        assert!((mean - PIVOT).abs() < 1e-3, "{what}: {mean}");
                        assert!(*variance > 0.04, "{what}: {variance}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_variance_beyond_the_largest_number_is_the_largest() {
    let json = r#"{"version":1,"name":"n","nodes":{"n":{"type":"noise2d","inputs":
        {"amplitude":1e20,"frequency":8,"pivot":0.5}}},"outputs":{"out":{"node":"n"}}}"#;
    for method in [Method::Local, Method::Quad] {
        let found = evaluated::<f32>(&program(json, method), &places([0; 3], 2.0));
        assert!(
            found[0].iter().all(|x| (x - 0.5).abs() < 1e-3),
            "{:?}",
            found[0]
        );
        assert!(found[1].iter().all(|x| *x > 9e37), "{:?}", found[1]);
    }
}
