//! How many f32 operations a second the CPU batch evaluator runs: the throughput column counts ops
//! of the IR times lanes.
//!
//! `cargo bench -p mipless-codegen --bench cpu`

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use mipless_codegen::cpu::{Evaluator, Input, Level, Scratch};
use mipless_codegen::ir::{Builder, Float, Inst, Module};

/// A tile of 64 × 64 pixels.
const LANES: usize = 4096;

fn main() {
    divan::main();
}

/// A program of about a thousand sums, differences, products and limits with `live` values in
/// flight; `separate` keeps sums from following products directly.
fn arithmetic(live: usize, separate: bool) -> Module {
    let b = &Builder::new("arithmetic", "Arithmetic on many live values.");
    let [u, v] = ["u", "v"].map(|name| b.float_param(name));
    let start = (0..live).map(|i| u * (0.3 + i as f32 * 0.07) - v);
    let mut values: Vec<Float<'_>> = start.collect();
    for round in 0..1000 / live {
        for i in 0..live {
            let (x, y, z) = (values[i], values[(i + 1) % live], values[(i + 3) % live]);
            values[i] = match (i + round) % 5 {
                0 => x + y,
                1 => y * z,
                2 => x - z,
                3 => x.min(y),
                _ if separate => x.max(z),
                _ => x * y + z,
            };
        }
    }
    for (i, &value) in values.iter().enumerate() {
        b.result(format!("r{i}"), value);
    }
    module_of(b)
}

/// A thousand applications of one function of one operand.
fn repeated(op: for<'b> fn(Float<'b>) -> Float<'b>) -> Module {
    let b = &Builder::new("repeated", "One function over and over.");
    let mut values = ["u", "v"].map(|name| b.float_param(name));
    for i in 0..1000 {
        values[i % 2] = op(values[i % 2]);
    }
    b.result("first", values[0]);
    b.result("second", values[1]);
    module_of(b)
}

fn module_of(builder: &Builder) -> Module {
    let mut module = Module::default();
    builder.finish(&mut module);
    module
}

/// The ops of the entry that run in each batch.
fn ops(module: &Module) -> usize {
    module
        .entry()
        .insts
        .iter()
        .filter(|inst| matches!(inst, Inst::Op(..)))
        .count()
}

/// Measures one evaluation of a tile on each of `threads` threads.
fn measure(bencher: Bencher<'_, '_>, module: &Module, level: Level, threads: usize) {
    let evaluator = Evaluator::<f32>::new(module).at_level(level);
    let u: Vec<f32> = (0..LANES).map(|i| i as f32 / LANES as f32).collect();
    let v: Vec<f32> = u.iter().map(|u| 1.0 - u * u).collect();
    const TILES: usize = 64;
    let work = || {
        let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
        for _ in 0..TILES {
            let inputs = [Input::Floats(black_box(&u)), Input::Floats(&v)];
            evaluator.evaluate(&mut scratch, &inputs, LANES, &mut outputs);
        }
        outputs
    };
    bencher
        .counter(ItemsCount::new(ops(module) * LANES * TILES * threads))
        .bench(|| {
            std::thread::scope(|scope| {
                for _ in 1..threads {
                    scope.spawn(|| black_box(work()));
                }
                black_box(work());
            });
        });
}

/// The levels of this machine.
fn levels() -> impl Iterator<Item = Level> {
    Level::ALL.into_iter().filter(|level| level.is_available())
}

#[divan::bench(args = levels())]
fn arithmetic_8_live(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &arithmetic(8, true), level, 1);
}

#[divan::bench(args = levels())]
fn arithmetic_8_live_2_threads(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &arithmetic(8, true), level, 2);
}

#[divan::bench(args = levels())]
fn arithmetic_32_live(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &arithmetic(32, true), level, 1);
}

#[divan::bench(args = levels())]
fn arithmetic_80_live(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &arithmetic(80, true), level, 1);
}

#[divan::bench(args = levels())]
fn arithmetic_8_live_products_and_sums(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &arithmetic(8, false), level, 1);
}

#[divan::bench(args = levels())]
fn sine(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &repeated(|x| x.sin()), level, 1);
}

#[divan::bench(args = levels())]
fn exponential(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &repeated(|x| -x.exp()), level, 1);
}

#[divan::bench(args = levels())]
fn floor(bencher: Bencher<'_, '_>, level: Level) {
    measure(bencher, &repeated(|x| x.floor() + 0.7), level, 1);
}
