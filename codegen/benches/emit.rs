//! How long emission takes: pseudo-random straight-line programs of 40 instructions a graph node.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use mipless_codegen::ir::{Builder, FOOTPRINT, Float, Interface, Module, Port, Program};
use mipless_codegen::wgsl::{Options, emit};

fn main() {
    divan::main();
}

/// A texture of `nodes` × 40 instructions that read near ones, and a name for each node.
fn program(nodes: usize) -> Program {
    let b = &Builder::new("long", "A texture.");
    let footprint = FOOTPRINT.map(|(name, ty)| b.scalar_param(name, ty));
    let mut values: Vec<Float<'_>> = footprint[2..].iter().map(|number| number.float()).collect();
    let mut state = 7_u32;
    for instruction in 0..nodes * 40 {
        let mut pick = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            values[values.len() - 1 - (state >> 8) as usize % values.len().min(12)]
        };
        let (x, y) = (pick(), pick());
        let value = match instruction % 5 {
            0 => x * y,
            1 => x * (0.3 + instruction as f32 * 0.01),
            2 => x.max(y),
            _ => x + y,
        };
        if instruction % 40 == 0 {
            b.name(value, format!("node_{instruction}_mean"));
        }
        values.push(value);
    }
    let recent = &values[values.len() - 12..];
    b.result("value", b.sum(recent.iter().copied()));
    let mut module = Module::default();
    b.finish(&mut module);
    let ty = mipless_graph::Type::Float;
    let interface = Interface {
        name: "long".to_owned(),
        parameters: Vec::new(),
        outputs: vec![Port {
            name: "value".to_owned(),
            ty,
            default: Vec::new(),
        }],
        moments: false,
        position: false,
    };
    Program { module, interface }
}

#[divan::bench(args = [100, 10_000])]
fn nodes(bencher: Bencher<'_, '_>, nodes: usize) {
    let program = program(nodes);
    bencher
        .counter(ItemsCount::new(nodes))
        .bench_local(|| emit(black_box(&program), &Options::default()));
}
