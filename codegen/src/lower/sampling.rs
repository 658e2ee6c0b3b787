//! Methods that evaluate the graph several times in a pixel: a fold over one function of it.

use super::finish::{finish, guarded};
use super::function::{footprint_function, graph_function};
use super::place::{finite, places};
use super::{Arguments, Compiler, Options, PixelFilter};
use crate::float::Float;
use crate::ir::{Builder, Module, Type as Scalar, Value};
use crate::moments::Mode;
use std::iter;
use std::sync::LazyLock;

/// Mean (and variance) of points of the pixel filter: the R2 sequence (Roberts 2018) in integers,
/// shifted by a hash of the pixel, warped to the filter along each axis. Means and squared deviations accumulate by
/// Welford's recurrence.
pub(super) fn supersample(compiler: &Compiler<'_>, module: &mut Module, name: &str, samples: u32) {
    let moments = compiler.options.moments;
    // Variances of the point function are 0 and are not asked for.
    let options = Options {
        moments: false,
        ..*compiler.options
    };
    let plain = compiler.with_options(&options);
    let (point, _) = graph_function(&plain, module, Mode::Point, "point");
    let outputs = point.results.len();
    let state_length = if moments { 2 * outputs } else { outputs };

    let table = module.table("sample_offsets", offsets(compiler.options.filter));

    let mut b = Builder::new("sample", "One more sample.");
    let index = b.param("index", Scalar::U32);
    let state: Vec<Value> = (0..state_length)
        .map(|i| b.param_f32(format!("state_{i}")))
        .collect();
    let (shift_x, shift_y) = (
        b.param("shift_x", Scalar::U32),
        b.param("shift_y", Scalar::U32),
    );
    let arguments = Arguments::declare(&mut b, compiler.graph);
    let [x, y] = offset(&mut b, table, index, [shift_x, shift_y]);
    let mut all = arguments.all();
    displace(&mut b, compiler, &mut all, [x, y]);
    for place in places(compiler.graph) {
        all[place.changes()].fill(b.f32(0.0));
    }
    let values = b.call(&point, &all);
    let number = b.float_u(index);
    let number = b.offset(number, 1.0);
    let mut squares = Vec::new();
    for (i, &value) in values.iter().enumerate() {
        let deviation = b.sub(value, state[i]);
        let part = b.div(deviation, number);
        let mean = b.add(state[i], part);
        b.result(format!("state_{i}"), mean);
        if moments {
            let after = b.sub(value, mean);
            let square = b.mul(deviation, after);
            squares.push(b.add(state[outputs + i], square));
        }
    }
    for (i, sum) in squares.into_iter().enumerate() {
        b.result(format!("state_{}", outputs + i), sum);
    }
    let sample = b.finish(module);

    let mut b = Builder::new(name, "The texture over a footprint.");
    let arguments = Arguments::declare(&mut b, compiler.graph);
    let arguments = finite(&mut b, compiler.graph, &arguments);
    let [cell_x, cell_y] = [b.cast_u(arguments[0]), b.cast_u(arguments[1])];
    let [u, v] = [b.bits(arguments[2]), b.bits(arguments[3])];
    let mut hash = b.u32(compiler.options.seed ^ 0x9e37_79b9);
    for word in [cell_x, cell_y, u, v] {
        hash = b.xor_u(hash, word);
        hash = b.scramble(hash);
    }
    let other = b.u32(0x68bc_21eb);
    let second = b.xor_u(hash, other);
    let second = b.scramble(second);
    let zero = b.f32(0.0);
    let count = b.u32(samples);
    let mut captures = vec![hash, second];
    captures.extend(&arguments);
    let state = b.fold(&sample, count, &vec![zero; state_length], &captures);
    let names: Vec<String> = module
        .function(point.id)
        .results
        .iter()
        .map(|(name, _)| name.clone())
        .collect();
    for (name, &value) in names.iter().zip(&state) {
        let value = guarded(&mut b, value);
        b.result(name.clone(), value);
    }
    for (name, &sum) in names.iter().zip(&state[outputs.min(state.len())..]) {
        let variance = b.scale(sum, 1.0 / (samples.max(2) - 1) as f32);
        let variance = guarded(&mut b, variance);
        b.result(format!("{name}_variance"), variance);
    }
    b.finish(module);
}

/// Moves the position of a graph's arguments by (x, y) pixels. Pixels may be hundreds of units long:
/// their integer parts join the cell, and a product with a number of 12 significant bits is made of
/// two exact ones.
fn displace(b: &mut Builder, compiler: &Compiler<'_>, all: &mut [Value], pixels: [Value; 2]) {
    for place in places(compiler.graph) {
        let right = place.changes().start;
        for axis in 0..place.axes {
            let (cell, rest) = (place.cell(axis), place.fraction(axis));
            let changes = [all[right + axis], all[right + place.axes + axis]];
            for (&pixels, length) in pixels.iter().zip(changes) {
                let high = b.high(length);
                let low = b.sub(length, high);
                for part in [high, low] {
                    let step = b.mul(pixels, part);
                    let whole = b.floor(step);
                    let fraction = b.sub(step, whole);
                    let whole = b.trunc_i(whole);
                    all[cell] = b.add_i(all[cell], whole);
                    all[rest] = b.add(all[rest], fraction);
                }
            }
        }
    }
}

/// Bits of a sample's place along one axis. With so few, and 12 significant ones of the offset, a
/// sample lies at the same place in f32 and f64.
const PLACES: u32 = 12;

/// The offset of a sample inside the pixel, in pixels; `offsets` is the table of [`offsets`].
fn offset(b: &mut Builder, offsets: u32, index: Value, shift: [Value; 2]) -> [Value; 2] {
    // 2³² divided by the plastic number and by its square.
    let uniform = [0xc13f_a9a9u32, 0x91e1_0da5].map(|step| b.u32(step));
    [0, 1].map(|i| {
        let walked = b.mul_u(index, uniform[i]);
        let place = b.add_u(walked, shift[i]);
        let by = b.u32(32 - PLACES);
        let place = b.shr_u(place, by);
        b.load(offsets, place)
    })
}

/// The means of intervals of equal weight of the normal distribution.
static NORMAL: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let count = 1_u32 << PLACES;
    let inner = (1..count).map(|k| quantile(f64::from(k) / f64::from(count)));
    let inner = inner.map(|z| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt());
    let edges: Vec<f64> = iter::once(0.0).chain(inner).chain([0.0]).collect();
    let means = edges.windows(2).map(|e| f64::from(count) * (e[0] - e[1]));
    means.collect()
});

/// The offsets, in pixels, that stand for intervals of equal weight of the pixel filter along one
/// axis: their means, to 12 significant bits.
fn offsets(filter: PixelFilter) -> Vec<f32> {
    let count = 1_u32 << PLACES;
    let means: Vec<f64> = match filter {
        PixelFilter::Box => (0..count)
            .map(|k| (f64::from(k) + 0.5) / f64::from(count) - 0.5)
            .collect(),
        PixelFilter::Gaussian(sd) => NORMAL.iter().map(|z| z * f64::from(sd)).collect(),
    };
    means.into_iter().map(|x| (x as f32).high()).collect()
}

/// The standard score below which the share `p` of a normal distribution lies, 0 < p < 1: Newton's
/// iteration from the middle, where it converges from one side.
fn quantile(p: f64) -> f64 {
    let mut z = 0.0_f64;
    for _ in 0..60 {
        let density = (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        // Φ(z) = ½ + φ(z) (z + z³/3 + z⁵/(3·5) + …).
        let (mut term, mut sum, mut odd) = (z, 0.0, 1.0);
        while f64::abs(term) > 1e-17 {
            sum += term;
            odd += 2.0;
            term *= z * z / odd;
        }
        let step = (0.5 + density * sum - p) / density;
        z -= step;
        if step.abs() < 1e-13 {
            break;
        }
    }
    z
}

/// The nodes (x, y) and weights of a split rule, for a unit Gaussian, with the largest share of the
/// footprint r₀ and the scatter c in wavelengths (MATH §4).
fn rule(k: u32) -> (Vec<[f32; 3]>, f32, f32) {
    match k {
        4 => {
            let nodes = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
            (nodes.map(|[x, y]| [x, y, 0.25]).to_vec(), 0.5, 0.18)
        }
        7 => {
            let mut nodes = vec![[0.0, 0.0, 0.5]];
            for i in 0..6 {
                let angle = std::f32::consts::FRAC_PI_3 * i as f32;
                nodes.push([2.0 * angle.cos(), 2.0 * angle.sin(), 1.0 / 12.0]);
            }
            (nodes, 0.7, 0.25)
        }
        _ => {
            let root = 6.0f32.sqrt();
            let one = [
                (-(3.0 + root).sqrt(), 1.0 / (4.0 * (3.0 + root))),
                (-(3.0 - root).sqrt(), 1.0 / (4.0 * (3.0 - root))),
                ((3.0 - root).sqrt(), 1.0 / (4.0 * (3.0 - root))),
                ((3.0 + root).sqrt(), 1.0 / (4.0 * (3.0 + root))),
            ];
            let mut nodes = Vec::new();
            for (x, w) in one {
                nodes.extend(one.map(|(y, v)| [x, y, w * v]));
            }
            (nodes, 0.8, 0.32)
        }
    }
}

/// Real sub-footprints, each by `quad`: node x at √r x of the footprint, of which each keeps the
/// share 1 − r. r = min(r₀, (c/s)²) with s the largest footprint of a source tends to one
/// evaluation at large footprints.
pub(super) fn split(compiler: &Compiler<'_>, module: &mut Module, name: &str, k: u32) {
    let (nodes, largest, scatter) = rule(k);
    let s = compiler.options.filter.sd();
    let (quad, _) = graph_function(compiler, module, Mode::Quad, "quad");
    let size = footprint_function(compiler, module, "size", |b, footprints| {
        let mut most = footprints[0];
        for &footprint in &footprints[1..] {
            most = b.max(most, footprint);
        }
        most
    });
    let moments = compiler.options.moments;
    let outputs = if moments {
        quad.results.len() / 2
    } else {
        quad.results.len()
    };
    // Of each node: x, y, the weight, and the weight's share of all weights so far.
    let mut total = 0.0;
    let mut rows = Vec::new();
    for [x, y, weight] in &nodes {
        total += weight;
        rows.extend([*x, *y, *weight, weight / total]);
    }
    let table = module.table("split_nodes", rows);

    // The state: running weighted means, then the weighted sums of squared deviations and of
    // variances (West 1979): no difference of second moments.
    let mut b = Builder::new("part", "One more part of the footprint.");
    let index = b.param("index", Scalar::U32);
    let length = if moments { 2 * outputs } else { outputs };
    let state: Vec<Value> = (0..length)
        .map(|i| b.param_f32(format!("state_{i}")))
        .collect();
    let (far, near) = (b.param_f32("root_share"), b.param_f32("root_rest"));
    let arguments = Arguments::declare(&mut b, compiler.graph);
    let four = b.u32(4);
    let first = b.mul_u(index, four);
    let node: [Value; 4] = [0u32, 1, 2, 3].map(|i| {
        let i = b.u32(i);
        let at = b.add_u(first, i);
        b.load(table, at)
    });
    let shift = b.scale(far, s);
    let (x, y) = (b.mul(node[0], shift), b.mul(node[1], shift));
    let mut all = arguments.all();
    displace(&mut b, compiler, &mut all, [x, y]);
    for place in places(compiler.graph) {
        for value in &mut all[place.changes()] {
            *value = b.mul(*value, near);
        }
    }
    let values = b.call(&quad, &all);
    let mut spreads = Vec::new();
    for i in 0..outputs {
        let deviation = b.sub(values[i], state[i]);
        let step = b.mul(node[3], deviation);
        let mean = b.add(state[i], step);
        b.result(format!("state_{i}"), mean);
        if moments {
            let after = b.sub(values[i], mean);
            let square = b.mul(deviation, after);
            let spread = b.add(square, values[outputs + i]);
            let part = b.mul(node[2], spread);
            spreads.push(b.add(state[outputs + i], part));
        }
    }
    for (i, spread) in spreads.into_iter().enumerate() {
        b.result(format!("state_{}", outputs + i), spread);
    }
    let part = b.finish(module);

    let mut b = Builder::new(name, "The texture over a footprint.");
    let arguments = Arguments::declare(&mut b, compiler.graph);
    let arguments = finite(&mut b, compiler.graph, &arguments);
    let share = match &size {
        None => b.f32(largest),
        Some(size) => {
            let size = b.call(size, &arguments)[0];
            let size = b.offset(size, 1e-6);
            let scatter = b.f32(scatter);
            let ratio = b.div(scatter, size);
            let square = b.square(ratio);
            let most = b.f32(largest);
            b.min(square, most)
        }
    };
    let one = b.f32(1.0);
    let rest = b.sub(one, share);
    let (far, near) = (b.sqrt(share), b.sqrt(rest));
    let zero = b.f32(0.0);
    let count = b.u32(nodes.len() as u32);
    let mut captures = vec![far, near];
    captures.extend(&arguments);
    let state = b.fold(&part, count, &vec![zero; length], &captures);
    finish(module, b, &quad, &state);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_normal_distribution() {
        // Abramowitz & Stegun, table 26.5.
        for (p, z) in [(0.5, 0.0), (0.975, 1.959_963_985), (0.001, -3.090_232_306)] {
            assert!((quantile(p) - z).abs() < 1e-8, "{p}: {}", quantile(p));
        }
    }

    #[test]
    fn offsets_have_the_moments_of_the_filter_and_12_bits() {
        for (filter, wanted) in [
            (PixelFilter::Gaussian(0.5), 0.25),
            (PixelFilter::Box, 1.0 / 12.0),
        ] {
            let all = offsets(filter);
            let n = all.len() as f64;
            let mean = all.iter().map(|&x| f64::from(x)).sum::<f64>() / n;
            let square = all.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>() / n;
            assert!(mean.abs() < 1e-6, "{filter:?}: {mean}");
            assert!((square / wanted - 1.0).abs() < 1e-3, "{filter:?}: {square}");
            assert!(all.iter().all(|x| x.to_bits() & 0xfff == 0), "{filter:?}");
        }
    }
}
