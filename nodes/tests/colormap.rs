//! Colour maps of two signals from pictures against dense numerical truth.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::ir::Program;
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, Picture, check, linear_from_srgb, load};
use std::sync::Arc;

/// Texels of a row, and rows.
const SIZE: [usize; 2] = [96, 64];

/// Regions with jumps between them and an alpha that is a wave, in sRGB numbers.
fn number(column: usize, row: usize, channel: usize) -> f64 {
    let place = [column as f64 / SIZE[0] as f64, row as f64 / SIZE[1] as f64];
    if channel == 3 {
        return 0.5 + 0.5 * (std::f64::consts::TAU * (place[0] - place[1])).sin();
    }
    let site = |i: usize| [0.754_877_666, 0.569_840_291].map(|step: f64| (i as f64 * step).fract());
    let distance = |i: usize| {
        let site = site(i);
        (place[0] - site[0]).hypot(place[1] - site[1])
    };
    let nearest = (1..9).min_by(|&i, &j| distance(i).total_cmp(&distance(j)));
    (nearest.expect("eight sites") * (channel + 2) % 9) as f64 / 8.0
}

fn picture() -> Picture {
    let texels = (0..SIZE[1]).flat_map(|row| (0..SIZE[0]).map(move |column| (column, row)));
    let numbers = texels
        .flat_map(|(column, row)| (0..4).map(move |channel| number(column, row, channel) as f32));
    Picture::new((SIZE[0] as u32, SIZE[1] as u32), 4, true, numbers.collect())
}

/// The picture over the unit square, between texels linearly, as linear colours.
struct Dense {
    planes: Vec<Vec<f64>>,
    periodic: bool,
}

impl Dense {
    fn new(periodic: bool) -> Self {
        let plane = |channel: usize| {
            let rows = 0..SIZE[1];
            let texel = |column: usize, row: usize| {
                let stored = f64::from(number(column, row, channel) as f32);
                if channel == 3 {
                    stored
                } else {
                    linear_from_srgb(stored)
                }
            };
            rows.flat_map(|row| (0..SIZE[0]).map(move |column| (column, row)))
                .map(|(column, row)| texel(column, row))
                .collect()
        };
        Self {
            planes: (0..4).map(plane).collect(),
            periodic,
        }
    }

    fn at(&self, place: [f64; 2]) -> [f64; 4] {
        let axes = [0, 1].map(|axis| {
            let n = SIZE[axis] as i64;
            let at = place[axis] * n as f64 - 0.5;
            let whole = at.floor();
            let texel = |i: i64| {
                (if self.periodic {
                    i.rem_euclid(n)
                } else {
                    i.clamp(0, n - 1)
                }) as usize
            };
            (texel(whole as i64), texel(whole as i64 + 1), at - whole)
        });
        let [(left, right, across), (above, below, down)] = axes;
        std::array::from_fn(|channel| {
            let plane = &self.planes[channel];
            let row = |row: usize| {
                let row = row * SIZE[0];
                plane[row + left] * (1.0 - across) + plane[row + right] * across
            };
            row(above) * (1.0 - down) + row(below) * down
        })
    }

    /// The mean under a Gaussian with these axes.
    fn mean(&self, place: [f64; 2], axes: [[f64; 2]; 2]) -> [f64; 4] {
        let count = 120;
        let (mut sums, mut total) = ([0.0; 4], 0.0);
        for k in 0..count * count {
            let [p, q] =
                [k % count, k / count].map(|i| 9.0 * (f64::from(i) + 0.5) / f64::from(count) - 4.5);
            let weight = (-0.5 * (p * p + q * q)).exp();
            let at = [0, 1].map(|i| place[i] + p * axes[0][i] + q * axes[1][i]);
            for (sum, value) in sums.iter_mut().zip(self.at(at)) {
                *sum += weight * value;
            }
            total += weight;
        }
        sums.map(|sum| sum / total)
    }
}

/// The map over the square from (−1, −1) to (1, 1), of the position.
fn program(more: &str, method: Method) -> Program {
    let json = format!(
        r#"{{"version":1,"name":"map","nodes":{{
            "uv":{{"type":"texcoord"}},
            "u":{{"type":"extract","inputs":{{"in":{{"node":"uv"}},"index":0}}}},
            "v":{{"type":"extract","inputs":{{"in":{{"node":"uv"}},"index":1}}}},
            "map":{{"type":"colormap2d","inputs":{{"in1":{{"node":"u"}},"in2":{{"node":"v"}},
                "file":"map.png","low":-1{more}}}}}
        }},"outputs":{{"out":{{"node":"map"}}}}}}"#
    );
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(&json, &specs);
    let mut graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let picture = Arc::new(picture());
    for file in &loaded.files {
        graph.images.insert(&*file.name, Arc::clone(&picture));
    }
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter: PixelFilter::Gaussian(1.0),
        moments: false,
        seed: 0,
    };
    compile(&checked, catalogue, &options)
}

fn footprint([x, y]: [f64; 2], axes: [[f64; 2]; 2]) -> Footprint {
    Footprint {
        cell: [x.floor() as i32, y.floor() as i32],
        uv: [x, y].map(|x| (x - x.floor()) as f32),
        du: axes[0].map(|x| x as f32),
        dv: axes[1].map(|x| x as f32),
    }
}

/// A place of [−1, 1]², and axes of at most an eighth of that, up to 8:1, in any direction.
fn place(i: usize) -> ([f64; 2], [[f64; 2]; 2]) {
    let steps = [
        0.754_877_666,
        0.569_840_291,
        0.430_159_709,
        0.671_043_607,
        0.850_650_808,
    ];
    let [x, y, size, ratio, turn] = steps.map(|step: f64| (i as f64 * step).fract());
    let long = 0.25 * 0.02f64.powf(size);
    let wide = long * 8f64.powf(-ratio);
    let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
    let axes = [[long * cosine, long * sine], [-wide * sine, wide * cosine]];
    ([2.0 * x - 1.0, 2.0 * y - 1.0], axes)
}

#[test]
fn a_picture_of_colours_with_alpha_is_filtered_whatever_the_covariance() {
    for (more, periodic) in [("", false), (r#","addressmode":"periodic""#, true)] {
        let program = program(&format!(r#","signature":"color4"{more}"#), Method::Local);
        let dense = Dense::new(periodic);
        let places: Vec<_> = (1..120).map(place).collect();
        let footprints: Vec<Footprint> = (places.iter())
            .map(|&(place, axes)| footprint(place, axes))
            .collect();
        let found = eval_program::<f64>(&program, &footprints, &[]);
        let (mut sum, mut most) = ([0.0f64; 4], 0.0f64);
        for (i, &(place, axes)) in places.iter().enumerate() {
            // In the picture, which is a unit square.
            let truth = dense.mean(
                place.map(|x| 0.5 * (x + 1.0)),
                axes.map(|axis| axis.map(|x| 0.5 * x)),
            );
            for (channel, truth) in truth.into_iter().enumerate() {
                let error = (found[channel][i] - truth).abs();
                sum[channel] += error / places.len() as f64;
                most = most.max(error);
            }
        }
        println!("periodic {periodic}: mean {sum:?}, largest {most}");
        assert!(sum[..3].iter().all(|&error| error < 0.003), "{sum:?}");
        // A wave over the whole range is harder than the smooth maps of `--bench maps`.
        assert!(sum[3] < 0.0013, "alpha {}", sum[3]);
        assert!(most < 0.06, "{most}");
    }
}

#[test]
fn a_footprint_of_0_reads_the_texels_themselves() {
    for method in [Method::Point, Method::Local, Method::Quad] {
        let program = program(r#","signature":"color4""#, method);
        let dense = Dense::new(false);
        for (column, row) in [(0, 0), (1, 0), (95, 63), (40, 20)] {
            // The first row is at the lowest v.
            let p = [
                (column as f64 + 0.5) / SIZE[0] as f64,
                (row as f64 + 0.5) / SIZE[1] as f64,
            ];
            let at = footprint(p.map(|x| 2.0 * x - 1.0), [[0.0; 2]; 2]);
            let found = eval_program::<f64>(&program, &[at], &[]);
            for (channel, plane) in dense.planes.iter().enumerate() {
                let wanted = plane[row * SIZE[0] + column];
                let found = found[channel][0];
                assert!(
                    (found - wanted).abs() < 2e-5,
                    "{method} {found}, not {wanted}"
                );
            }
        }
    }
}

#[test]
fn the_type_is_named_with_a_file() {
    for (more, channels) in [
        ("", 3),
        (r#","signature":"float""#, 1),
        (r#","signature":"color4""#, 4),
    ] {
        let found =
            eval_program::<f64>(&program(more, Method::Point), &[Footprint::default()], &[]);
        assert_eq!(found.len(), channels, "{more}");
    }
    // One number is data.
    let at = footprint([-0.989, -0.984], [[0.0; 2]; 2]);
    let found = eval_program::<f64>(
        &program(r#","signature":"float""#, Method::Point),
        &[at],
        &[],
    );
    assert!(
        (found[0][0] - number(0, 0, 0)).abs() < 0.01,
        "{}",
        found[0][0]
    );
}

#[test]
fn the_tables_of_a_map_take_less_than_a_megabyte() {
    let program = program("", Method::Local);
    let bytes: usize = program.module.tables.iter().map(|t| 4 * t.data.len()).sum();
    assert!(bytes < 1_000_000, "{bytes}");
}
