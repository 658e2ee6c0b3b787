//! One octave of the noise in space.

use super::energy::Energy;
use super::kernel::{STEPS, Window, point_slice, slice, start};
use super::spread::Spread;
use super::{NAMES, PAIRS, WIDTH, parts, place};
use crate::noise::hash::NEXT_OCTAVE;
use crate::noise::lattice::Octaves;
use crate::noise::remainder::{remainder, share};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};

/// Below this share of its amplitude an octave has faded, above the other it has not begun to.
const FADE: [f32; 2] = [0.03, 0.06];

/// A kernel is dropped where its envelope is this small against the unfiltered noise: −2 ln 0.008.
const NEGLIGIBLE_LN: f32 = 9.66;

/// The most slices, rows or columns that are summed; footprints that need more fade.
const MOST: f32 = 32.0;

/// The part of an octave's state that goes from octave to octave.
struct State {
    cells: [Value; 3],
    fractions: [Value; 3],
    scale: Value,
    amplitude: Value,
    seed: Value,
}

impl State {
    fn declare(b: &mut Builder) -> Self {
        let places = ["x", "y", "z"].map(|name| {
            let cell = b.param(format!("cell_{name}"), Type::I32);
            (cell, b.param_f32(name))
        });
        Self {
            cells: places.map(|(cell, _)| cell),
            fractions: places.map(|(_, fraction)| fraction),
            scale: b.param_f32("scale"),
            amplitude: b.param_f32("amplitude"),
            seed: b.param("seed", Type::U32),
        }
    }

    /// The key of the lattice point at the position's cell.
    fn key(&self, b: &mut Builder) -> Value {
        let mut key = self.seed;
        for (cell, step) in self.cells.into_iter().zip(STEPS) {
            let step = b.u32(step);
            let cell = b.cast_u(cell);
            let walked = b.mul_u(cell, step);
            key = b.add_u(key, walked);
        }
        key
    }

    /// The state of the next octave, as results.
    fn advance(&self, b: &mut Builder, octaves: Octaves) {
        let lacunarity = b.f32(octaves.lacunarity);
        for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
            // Octaves must not share lattice points, where the variance of all is largest.
            let shifted = b.offset(self.fractions[i], 0.381_966 / octaves.lacunarity);
            let start = Signal {
                cell: Some(self.cells[i]),
                ..Signal::certain(b, shifted)
            };
            let next = start.scale(b, lacunarity);
            let cell = next.cell.expect("a position keeps its cell");
            b.result(format!("cell_{name}"), cell);
            b.result(name, next.mean);
        }
        let scale = b.scale(self.scale, octaves.lacunarity);
        let amplitude = b.scale(self.amplitude, octaves.diminish);
        let step = b.u32(NEXT_OCTAVE);
        let seed = b.add_u(self.seed, step);
        b.result("scale", scale);
        b.result("amplitude", amplitude);
        b.result("seed", seed);
    }
}

/// κ of the unfiltered noise: √3 π^{−3/4} a^{−3/2}.
fn unit() -> f32 {
    3.0f32.sqrt() * std::f32::consts::PI.powf(-0.75) * WIDTH.powf(-1.5)
}

/// One octave of the unfiltered noise, the body of a fold: the nearest 3×3×3 kernels.
pub(super) fn point(module: &mut Module, octaves: Octaves) -> FunctionRef {
    let slice = point_slice(module, WIDTH);
    let doc = "One more octave of the unfiltered noise in space.";
    let mut builder = Builder::new("volume_octave", doc);
    let b = &mut builder;
    b.param("index", Type::U32);
    let sum = b.param_f32("mean");
    let state = State::declare(b);
    let mut key = state.key(b);
    let three = b.f32(3.0);
    let offsets = [0, 1, 2].map(|axis| {
        let place = start(b, state.fractions[axis], three);
        key = super::kernel::stepped(b, key, axis, place);
        let offset = b.sub(state.fractions[axis], place);
        b.scale(offset, 1.0 / WIDTH)
    });
    let mut captures = Vec::new();
    for column in 0..3 {
        let d = b.offset(offsets[0], -(column as f32) / WIDTH);
        let square = b.square(d);
        let exponent = b.scale(square, -0.5);
        captures.extend([d, b.exp(exponent)]);
    }
    captures.extend([offsets[1], offsets[2], key]);
    let (zero, three) = (b.f32(0.0), b.u32(3));
    let kernels = b.fold(&slice, three, &[zero], &captures)[0];
    let amplitude = b.scale(state.amplitude, unit());
    let part = b.mul(kernels, amplitude);
    let sum = b.add(sum, part);
    b.result("mean", sum);
    state.advance(b, octaves);
    builder.finish(module)
}

/// One octave of the filtered noise, the body of a fold.
pub(super) fn filtered(module: &mut Module, mode: Mode, octaves: Octaves) -> FunctionRef {
    let parts = parts(mode);
    let slice = slice(module, parts, WIDTH);
    let doc = "One more octave of the filtered noise in space.";
    let mut builder = Builder::new("volume_octave", doc);
    let b = &mut builder;
    b.param("index", Type::U32);
    let sums: Vec<Value> = NAMES[..parts]
        .iter()
        .map(|name| b.param_f32(*name))
        .collect();
    let rest = mode.spreads().then(|| b.param_f32("rest"));
    let state = State::declare(b);
    let spread = Spread::declare(b).scaled(b, state.scale);
    let energy = Energy::of(b, &spread);
    let (zero, one) = (b.f32(0.0), b.f32(1.0));

    // How far kernels reach, R² = ln F + 9.66, along z, along y at a z, along x at a y and z.
    let tiny = b.f32(1e-12);
    let left = b.max(energy.shares[0], tiny);
    let reach = b.ln(left);
    let reach = b.offset(reach, NEGLIGIBLE_LN);
    let reach = b.max(reach, one);
    let reach = b.sqrt(reach);
    let reach = b.scale(reach, 2.0 * WIDTH);
    let [p_xx, p_xy, p_xz, ..] = energy.inverse;
    let t: [Value; 6] = std::array::from_fn(|at| match at {
        0 | 3 | 5 => b.offset(spread.covariance[at], 1.0),
        _ => spread.covariance[at],
    });
    let whole = b.mul(t[5], energy.shrink);
    let along_y = b.div(p_xx, whole);
    let along_x = b.div(one, p_xx);
    let mut most = zero;
    let counts = [t[5], along_y, along_x].map(|variance| {
        let size = b.sqrt(variance);
        let needed = b.mul(size, reach);
        most = b.max(most, needed);
        // ⌈needed⌉ between 3 and the most.
        let minus = b.neg(needed);
        let floor = b.floor(minus);
        let up = b.neg(floor);
        b.clamp(up, 3.0, MOST)
    });

    // The octave fades to nothing before it is dropped.
    let amplitude = b.sqrt(left);
    let by_amplitude = share(b, amplitude, FADE[0], FADE[1]);
    let by_reach = share(b, most, MOST, MOST * 0.8);
    let fade = b.mul(by_amplitude, by_reach);
    let is_there = b.lt(zero, fade);
    let [slices, rows, columns] = counts.map(|count| {
        let turns = b.trunc_i(count);
        let turns = b.cast_u(turns);
        Window { count, turns }
    });
    let none = b.u32(0);
    let turns = b.select(is_there, slices.turns, none);

    let shear = b.div(t[4], t[5]);
    let leans = [p_xy, p_xz].map(|p| {
        let lean = b.div(p, p_xx);
        b.neg(lean)
    });
    let [x, y, z] = state.fractions;
    let first = start(b, z, slices.count);
    let key = state.key(b);
    let key = super::kernel::stepped(b, key, 2, first);
    let dz = b.sub(z, first);
    let dz = b.scale(dz, 1.0 / WIDTH);
    let mut captures = rows.captures().to_vec();
    captures.extend(columns.captures());
    captures.push(shear);
    captures.extend(leans);
    captures.extend([x, y, dz, key]);
    captures.extend(energy.inverse);
    captures.push(energy.trace);
    captures.extend(t);
    let kernels = b.fold(&slice, turns, &vec![zero; parts], &captures);

    // κ = κ₀/√det(I + S), and P on the sums.
    let root = b.sqrt(energy.shrink);
    let weight = b.scale(root, unit());
    let weight = b.mul(weight, fade);
    let weight = b.mul(weight, state.amplitude);
    let mut totals = vec![b.mul(weight, kernels[0])];
    let row = |i: usize| [0, 1, 2].map(|j| energy.inverse[place(i, j)]);
    let finer = b.scale(state.scale, 1.0 / WIDTH);
    if let Some(sums) = kernels.get(1..4) {
        let weight = b.mul(weight, finer);
        for i in 0..3 {
            let slope = b.dot(&row(i), sums);
            totals.push(b.mul(weight, slope));
        }
    }
    if let Some(sums) = kernels.get(4..10) {
        let area = b.square(finer);
        let weight = b.mul(weight, area);
        for [i, j] in PAIRS {
            let inner = [0, 1, 2].map(|k| {
                let column = [0, 1, 2].map(|l| sums[place(k, l)]);
                b.dot(&column, &row(j))
            });
            let bend = b.dot(&row(i), &inner);
            totals.push(b.mul(weight, bend));
        }
    }
    for ((name, sum), part) in NAMES.into_iter().zip(sums).zip(totals) {
        let total = b.add(sum, part);
        b.result(name, total);
    }
    if let Some(rest) = rest {
        let left = remainder(b, mode, energy.shares, fade);
        let power = b.square(state.amplitude);
        let part = b.mul(power, left);
        let rest = b.add(rest, part);
        b.result("rest", rest);
    }
    state.advance(b, octaves);
    builder.finish(module)
}
