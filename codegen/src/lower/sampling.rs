//! Methods that evaluate the graph several times in a pixel: a fold over one function of it.

use super::finish::{finish, guarded, result_names};
use super::function::{footprint_function, graph_function};
use super::{Arguments, Compiler, Options, PixelFilter};
use crate::float::Float as _;
use crate::ir::{Builder, Float, Module, Uint};
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

    // The state: running means, then the sums of squared deviations.
    let b = &Builder::new("sample", "One more sample.");
    let index = b.uint_param("index");
    let state: Vec<Float<'_>> = (0..state_length)
        .map(|i| b.float_param(format!("state_{i}")))
        .collect();
    let shift = ["shift_x", "shift_y"].map(|name| b.uint_param(name));
    let place = Arguments::declare(b, compiler.graph).moved(offset(table, index, shift));
    let values = b.call(&point, place.at_point());
    let number = index.to_float() + 1.0;
    let mut squares = Vec::new();
    for (i, &value) in values.iter().enumerate() {
        let deviation = value - state[i];
        let mean = state[i] + deviation / number;
        b.result(format!("state_{i}"), mean);
        squares.extend(moments.then(|| state[outputs + i] + deviation * (value - mean)));
    }
    for (i, sum) in squares.into_iter().enumerate() {
        b.result(format!("state_{}", outputs + i), sum);
    }
    let sample = b.finish(module);

    let b = &Builder::new(name, "The texture over a footprint.");
    let arguments = Arguments::declare(b, compiler.graph).finite();
    let hash = (arguments.footprint).hashed(compiler.options.seed ^ 0x9e37_79b9);
    let second = (hash ^ 0x68bc_21eb).scramble();
    let start = vec![b.float(0.0); state_length];
    let state = b.fold(&sample, b.uint(samples), start, ([hash, second], arguments));
    let names = result_names(module, &point);
    for (name, &value) in names.iter().zip(&state) {
        b.result(name.clone(), guarded(value));
    }
    for (name, &sum) in names.iter().zip(&state[outputs.min(state.len())..]) {
        let variance = sum * (1.0 / (samples.max(2) - 1) as f32);
        b.result(format!("{name}_variance"), guarded(variance));
    }
    b.finish(module);
}

/// Bits of a sample's place along one axis. With so few, and 12 significant ones of the offset, a
/// sample lies at the same place in f32 and f64.
const PLACES: u32 = 12;

/// The offset of a sample inside the pixel, in pixels; `offsets` is the table of [`offsets`].
fn offset<'b>(offsets: u32, index: Uint<'b>, [x, y]: [Uint<'b>; 2]) -> [Float<'b>; 2] {
    // 2³² divided by the plastic number and by its square.
    [(0xc13f_a9a9, x), (0x91e1_0da5, y)].map(|(step, shift): (u32, Uint<'b>)| {
        let place = (index * step + shift) >> (32 - PLACES);
        index.builder().load(offsets, place)
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
    let size = footprint_function(compiler, module, "size", |footprints| {
        let largest = footprints.iter().copied().reduce(|most, one| most.max(one));
        largest.expect("there are footprints").into()
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
    let b = &Builder::new("part", "One more part of the footprint.");
    let index = b.uint_param("index");
    let length = if moments { 2 * outputs } else { outputs };
    let state: Vec<Float<'_>> = (0..length)
        .map(|i| b.float_param(format!("state_{i}")))
        .collect();
    let [far, near] = b.float_params(["root_share", "root_rest"]);
    let [x, y, weight, share] = [0u32, 1, 2, 3].map(|i| b.load(table, index * 4 + i));
    let shift = far * s;
    let place = Arguments::declare(b, compiler.graph).moved([x * shift, y * shift]);
    let values = b.call(&quad, place.with_changes(|change| change * near));
    let mut spreads = Vec::new();
    for i in 0..outputs {
        let deviation = values[i] - state[i];
        let mean = state[i] + share * deviation;
        b.result(format!("state_{i}"), mean);
        if moments {
            let spread = deviation * (values[i] - mean) + values[outputs + i];
            spreads.push(state[outputs + i] + weight * spread);
        }
    }
    for (i, spread) in spreads.into_iter().enumerate() {
        b.result(format!("state_{}", outputs + i), spread);
    }
    let part = b.finish(module);

    let b = &Builder::new(name, "The texture over a footprint.");
    let arguments = Arguments::declare(b, compiler.graph).finite();
    let share = match &size {
        None => b.float(largest),
        Some(size) => {
            let size = b.call(size, &arguments)[0];
            (scatter / (size + 1e-6)).square().min(largest)
        }
    };
    let roots = [share.sqrt(), (1.0 - share).sqrt()];
    let count = b.uint(nodes.len() as u32);
    let start = vec![b.float(0.0); length];
    let state = b.fold(&part, count, start, (roots, arguments));
    finish(module, b, &quad, state);
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
