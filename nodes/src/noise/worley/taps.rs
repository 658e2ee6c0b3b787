//! The search for the points that are nearest to several places at once.

use super::shape::{Output, Worley};
use crate::noise::cell::number;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// x, y, weight: a unit Gaussian's integral to degree 5 (Stroud, E₂^{r²} 5-1).
pub(super) const NODES: [[f32; 3]; 7] = [
    [0.0, 0.0, 0.5],
    [2.0, 0.0, 1.0 / 12.0],
    [1.0, 1.732_050_8, 1.0 / 12.0],
    [-1.0, 1.732_050_8, 1.0 / 12.0],
    [-2.0, 0.0, 1.0 / 12.0],
    [-1.0, -1.732_050_8, 1.0 / 12.0],
    [1.0, -1.732_050_8, 1.0 / 12.0],
];

/// A squared distance beyond all.
const FAR: f32 = 1e6;

/// The cell that a window of `count` (a float) cells around `x` starts at.
pub(super) fn window(b: &mut Builder, x: Value, count: Value) -> Value {
    let half = b.scale(count, -0.5);
    let start = b.add(x, half);
    let start = b.offset(start, 0.5);
    b.floor(start)
}

/// What is known of the nearest points of a place: squared distances of the nearest and, where it
/// matters, the second, then their numbers.
fn names(worley: Worley) -> &'static [&'static str] {
    match (worley.solid, worley.output) {
        (false, Output::First) => &["first"],
        (false, _) => &["first", "second"],
        (true, Output::First) => &["first", "value"],
        (true, _) => &["first", "second", "value", "other"],
    }
}

/// The state of a place before any point.
pub(super) fn init(b: &mut Builder, worley: Worley) -> Vec<Value> {
    let (far, zero) = (b.f32(FAR), b.f32(0.0));
    let distances = if worley.output == Output::First { 1 } else { 2 };
    (0..names(worley).len())
        .map(|i| if i < distances { far } else { zero })
        .collect()
}

/// The value at a place.
pub(super) fn value(b: &mut Builder, worley: Worley, tap: &[Value]) -> Value {
    match (worley.solid, worley.output) {
        (false, Output::First) => b.sqrt(tap[0]),
        (false, Output::Second) => b.sqrt(tap[1]),
        (false, Output::Difference) => {
            let (first, second) = (b.sqrt(tap[0]), b.sqrt(tap[1]));
            b.sub(second, first)
        }
        (true, Output::First) => tap[1],
        (true, Output::Second) => tap[3],
        (true, Output::Difference) => b.sub(tap[3], tap[2]),
    }
}

/// One more point for a place.
fn nearer(b: &mut Builder, worley: Worley, tap: &[Value], q: Value, v: Value) -> Vec<Value> {
    let first = b.min(tap[0], q);
    if worley.output == Output::First {
        let mut next = vec![first];
        if worley.solid {
            let won = b.lt(q, tap[0]);
            next.push(b.select(won, v, tap[1]));
        }
        return next;
    }
    let loser = b.max(tap[0], q);
    let second = b.min(tap[1], loser);
    let mut next = vec![first, second];
    if worley.solid {
        let won = b.lt(q, tap[0]);
        let placed = b.lt(q, tap[1]);
        let other = b.select(placed, v, tap[3]);
        next.push(b.select(won, v, tap[2]));
        next.push(b.select(won, tap[2], other));
    }
    next
}

/// The point of one cell, the body of a fold over columns.
fn column(module: &mut Module, worley: Worley, count: usize) -> FunctionRef {
    let mut b = Builder::new("worley_column", "The point of one cell.");
    let index = b.param("index", Type::U32);
    let names = names(worley);
    let state: Vec<Value> = (0..count)
        .flat_map(|tap| names.iter().map(move |name| format!("{name}_{tap}")))
        .map(|name| b.param_f32(name))
        .collect();
    let start = b.param_f32("start_x");
    let place_y = b.param_f32("place_y");
    let cell = b.param("cell_x", Type::I32);
    let row = b.param("row", Type::I32);
    let seed = b.param("seed", Type::U32);
    let places: Vec<[Value; 2]> = (0..count)
        .map(|tap| {
            [
                b.param_f32(format!("x_{tap}")),
                b.param_f32(format!("y_{tap}")),
            ]
        })
        .collect();
    let offset = b.float_u(index);
    let place_x = b.add(start, offset);
    let whole = b.trunc_i(place_x);
    let column = b.add_i(cell, whole);
    let (_, hash) = number(&mut b, column, row, seed, worley.period);
    let mask = b.u32(0xffff);
    let by = b.u32(16);
    let (low, high) = (b.and_u(hash, mask), b.shr_u(hash, by));
    let point = [(low, place_x), (high, place_y)].map(|(bits, place)| {
        let share = b.float_u(bits);
        let share = b.scale(share, 1.0 / 65536.0);
        let moved = b.offset(share, -0.5);
        let moved = b.scale(moved, worley.jitter);
        let moved = b.offset(moved, 0.5);
        b.add(place, moved)
    });
    let value = if worley.solid {
        let mixed = b.u32(0x9e37_79b9);
        let hash = b.xor_u(hash, mixed);
        let hash = b.scramble(hash);
        let by = b.u32(8);
        let leading = b.shr_u(hash, by);
        let number = b.float_u(leading);
        b.scale(number, 1.0 / (1u32 << 24) as f32)
    } else {
        b.f32(0.0)
    };
    for (tap, (state, place)) in state.chunks(names.len()).zip(&places).enumerate() {
        let (dx, dy) = (b.sub(place[0], point[0]), b.sub(place[1], point[1]));
        let q = b.dot(&[dx, dy], &[dx, dy]);
        for (name, next) in names.iter().zip(nearer(&mut b, worley, state, q, value)) {
            b.result(format!("{name}_{tap}"), next);
        }
    }
    b.finish(module)
}

/// The points of one row of cells, the body of a fold.
pub(super) fn row(module: &mut Module, worley: Worley, count: usize) -> FunctionRef {
    let column = column(module, worley, count);
    let mut b = Builder::new("worley_row", "The points of one row of cells.");
    let index = b.param("index", Type::U32);
    let names: Vec<String> = (0..count)
        .flat_map(|tap| {
            names(worley)
                .iter()
                .map(move |name| format!("{name}_{tap}"))
        })
        .collect();
    let state: Vec<Value> = names.iter().map(|name| b.param_f32(name.clone())).collect();
    let (start_y, start_x) = (b.param_f32("start_y"), b.param_f32("start_x"));
    let columns = b.param("columns", Type::U32);
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let seed = b.param("seed", Type::U32);
    let places: Vec<Value> = (0..count)
        .flat_map(|tap| [format!("x_{tap}"), format!("y_{tap}")])
        .map(|name| b.param_f32(name))
        .collect();
    let offset = b.float_u(index);
    let place = b.add(start_y, offset);
    let whole = b.trunc_i(place);
    let row = b.add_i(cells[1], whole);
    let mut captures = vec![start_x, place, cells[0], row, seed];
    captures.extend(places);
    let state = b.fold(&column, columns, &state, &captures);
    for (name, value) in names.into_iter().zip(state) {
        b.result(name, value);
    }
    b.finish(module)
}
