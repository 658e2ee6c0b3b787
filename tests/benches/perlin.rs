//! Perlin noise, unfiltered, against the crates `noise` and `fastnoise-lite` and against the same
//! noise written by hand: one thread, one run.
//!
//! `cargo bench -p mipless-tests --bench perlin`. The loop by hand gives the same numbers, which is
//! checked, and so bounds what a native kernel for this source would gain.

#[path = "perlin/native.rs"]
mod native;

use mipless_codegen::cpu::{Evaluator, Input, Scratch};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};
use native::Row;
use noise::NoiseFn as _;
use std::hint::black_box;
use std::time::Instant;

/// Pixels along one side of the square that is rendered.
const SIDE: usize = 256;

/// Cells across the square.
const CELLS: f32 = 10.0;

const GRAPH: &str = r#"{"version":1,"name":"n","nodes":{"n":{"type":"fractal2d",
    "inputs":{"octaves":3,"kernel":"quintic"}}},"outputs":{"out":{"node":"n"}}}"#;

/// Positions in cells, row by row.
fn place(index: usize) -> [f32; 2] {
    [index % SIDE, index / SIDE].map(|i| i as f32 * (CELLS / SIDE as f32) + 0.37)
}

/// The time of one run, in seconds.
fn time(work: &mut dyn FnMut()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The pixels as the evaluator takes them.
struct Pixels {
    cells: [Vec<i32>; 2],
    fractions: [Vec<f32>; 2],
}

impl Pixels {
    fn new() -> Self {
        let places: Vec<[f32; 2]> = (0..SIDE * SIDE).map(place).collect();
        Self {
            cells: [0, 1].map(|k| places.iter().map(|p| p[k].floor() as i32).collect()),
            fractions: [0, 1].map(|k| places.iter().map(|p| p[k].fract()).collect()),
        }
    }

    fn row(&self, row: usize) -> Row<'_> {
        let at = row * SIDE..(row + 1) * SIDE;
        Row {
            cells: [0, 1].map(|k| &self.cells[k][at.clone()]),
            fractions: [0, 1].map(|k| &self.fractions[k][at.clone()]),
        }
    }
}

fn evaluator() -> Evaluator<f32> {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let graph = load(GRAPH, &specs).graph.expect("the graph loads");
    let checked = check(graph, &CheckOptions::default()).expect("the graph checks");
    let options = Options {
        method: Method::Point,
        filter: PixelFilter::Gaussian(0.5),
        moments: false,
        seed: 0,
    };
    Evaluator::<f32>::of_program(&compile(&checked, catalogue, &options))
}

fn evaluated(
    evaluator: &Evaluator<f32>,
    scratch: &mut Scratch<f32>,
    row: Row<'_>,
    outputs: &mut Vec<Vec<f32>>,
) {
    let zero = Input::Float(0.0);
    let inputs = [
        Input::Integers(row.cells[0]),
        Input::Integers(row.cells[1]),
        Input::Floats(row.fractions[0]),
        Input::Floats(row.fractions[1]),
        zero,
        zero,
        zero,
        zero,
    ];
    evaluator.evaluate(scratch, black_box(&inputs), SIDE, outputs);
}

fn ours() -> impl FnMut() {
    let (evaluator, pixels) = (evaluator(), Pixels::new());
    let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
    move || {
        for row in 0..SIDE {
            evaluated(&evaluator, &mut scratch, pixels.row(row), &mut outputs);
            black_box(&outputs);
        }
    }
}

fn by_hand() -> impl FnMut() {
    let (kernel, pixels) = (native::kernel(), Pixels::new());
    let mut out = vec![0.0; SIDE];
    move || {
        for row in 0..SIDE {
            kernel(black_box(pixels.row(row)), &mut out);
            black_box(&out);
        }
    }
}

/// The largest difference between the evaluator and the loop by hand.
fn difference() -> f32 {
    let (evaluator, kernel, pixels) = (evaluator(), native::kernel(), Pixels::new());
    let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
    let mut out = vec![0.0; SIDE];
    let mut most = 0.0f32;
    for row in 0..SIDE {
        evaluated(&evaluator, &mut scratch, pixels.row(row), &mut outputs);
        kernel(pixels.row(row), &mut out);
        for (a, b) in outputs[0].iter().zip(&out) {
            most = most.max((a - b).abs());
        }
    }
    most
}

fn by_noise() -> impl FnMut() {
    use noise::{Fbm, MultiFractal as _, Perlin};
    let fractal = Fbm::<Perlin>::new(7).set_octaves(3);
    move || {
        let mut sum = 0.0;
        for index in 0..SIDE * SIDE {
            sum += fractal.get(place(index).map(f64::from));
        }
        black_box(sum);
    }
}

fn by_fastnoise() -> impl FnMut() {
    use fastnoise_lite::{FastNoiseLite, FractalType, NoiseType};
    let mut noise = FastNoiseLite::with_seed(7);
    noise.set_noise_type(Some(NoiseType::Perlin));
    noise.set_fractal_type(Some(FractalType::FBm));
    noise.set_fractal_octaves(Some(3));
    noise.set_frequency(Some(1.0));
    move || {
        let mut sum = 0.0;
        for index in 0..SIDE * SIDE {
            let [x, y] = place(index);
            sum += noise.get_noise_2d(x, y);
        }
        black_box(sum);
    }
}

/// A library, and what it does in one turn.
type Rival = (&'static str, Box<dyn FnMut()>);

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let difference = difference();
    assert!(difference < 1e-5, "not the same noise: {difference}");
    let mut rivals: [Rival; 4] = [
        ("mipless", Box::new(ours())),
        ("by hand", Box::new(by_hand())),
        ("noise", Box::new(by_noise())),
        ("fastnoise-lite", Box::new(by_fastnoise())),
    ];
    // In turn, so that a disturbed machine disturbs all; the shortest time counts.
    let mut best = [f64::INFINITY; 4];
    for _ in 0..200 {
        for (best, (_, work)) in best.iter_mut().zip(&mut rivals) {
            *best = best.min(time(work));
        }
    }
    println!("3-octave fBm of Perlin noise, point, one thread, {SIDE}²");
    for (time, (name, _)) in best.iter().zip(&rivals) {
        let rate = (SIDE * SIDE) as f64 / time / 1e6;
        println!("{name:15} {rate:7.1} Ms/s   {:.2}×", time / best[0]);
    }
}
