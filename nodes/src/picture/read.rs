//! Reading a pyramid of moments at a place, for a Gaussian of any width.

use super::pyramid::{Baked, Layout, pairs, triangle};
use super::texels::lerp;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Numbers, Uint, Vec2, dot};
use std::fmt;
use std::sync::{Arc, LazyLock};

/// Numbers of a row of the table that says where the levels are.
const ROW: u32 = 4;

/// The table of a pyramid, and where its levels are.
#[derive(Clone)]
pub(crate) struct Pyramid {
    pub(crate) layout: Layout,
    /// The numbers of all levels.
    numbers: u32,
    /// A row a level: samples in x and y, and the offset as two numbers.
    rows: u32,
    key: String,
    baked: Arc<LazyLock<Baked, Box<dyn FnOnce() -> Baked + Send + Sync>>>,
}

impl fmt::Debug for Pyramid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key)
    }
}

/// The field at a place, by channel: what one function of the module gives.
#[derive(Clone, Debug)]
pub(crate) struct Tap<'b> {
    pub(crate) mean: Vec<Float<'b>>,
    /// The change a texel along x and y.
    pub(crate) gradient: Vec<Vec2<'b>>,
    /// The lower triangle of the covariance beyond the gradient's.
    pub(crate) rest: Vec<Float<'b>>,
}

impl<'b> Tap<'b> {
    /// From numbers: the means, and if there are more the gradients and the rest.
    pub(crate) fn of(numbers: &[Float<'b>], channels: usize) -> Self {
        let (mean, more) = numbers.split_at(channels);
        let (gradient, rest) = more.split_at(if more.is_empty() { 0 } else { 2 * channels });
        Self {
            mean: mean.to_vec(),
            gradient: (gradient.as_chunks().0.iter())
                .map(|&slopes| Vec2(slopes))
                .collect(),
            rest: rest.to_vec(),
        }
    }

    /// The results of a function.
    fn results(&self, b: &'b Builder) {
        for (i, &mean) in self.mean.iter().enumerate() {
            b.result(format!("mean_{i}"), mean);
        }
        for (i, &Vec2([x, y])) in self.gradient.iter().enumerate() {
            b.result(format!("dx_{i}"), x);
            b.result(format!("dy_{i}"), y);
        }
        for (i, &rest) in self.rest.iter().enumerate() {
            b.result(format!("rest_{i}"), rest);
        }
    }
}

/// How wide a level's Gaussian is with bilinear interpolation on a grid of σ: σ² + σ²/6.
const WIDENED: f32 = 7.0 / 6.0;

/// σ² of a level, in texels: 0, then 1, 2, 4, …
fn variance_of(row: Uint<'_>) -> Float<'_> {
    ((row.literal(1) << row) >> 1).to_float()
}

impl Pyramid {
    /// The pyramid of this layout; `key` names whatever its numbers depend on, and `bake` makes them
    /// when they are first read.
    pub(crate) fn new(
        lower: &mut Lower<'_, '_>,
        key: &str,
        name: &str,
        layout: Layout,
        bake: impl FnOnce(&Layout) -> Baked + Send + Sync + 'static,
    ) -> Self {
        let rows = layout.levels.iter().flat_map(|level| {
            let [nx, ny] = level.size.map(|n| n as f32);
            let (high, low) = (level.offset >> 12, level.offset & 0xfff);
            [nx, ny, high as f32, low as f32]
        });
        let rows: Vec<f32> = rows.collect();
        let of = layout.clone();
        let make: Box<dyn FnOnce() -> Baked + Send + Sync> = Box::new(move || bake(&of));
        let baked = Arc::new(LazyLock::new(make));
        let numbers = lower.table(&format!("{key} numbers"), name, || {
            let baked = Arc::clone(&baked);
            Numbers::lazy(layout.len(), move || baked.numbers.clone())
        });
        let rows_name = format!("{name}_levels");
        let rows = lower.table(&format!("{key} rows"), &rows_name, || rows.into());
        Self {
            layout,
            numbers,
            rows,
            key: key.to_owned(),
            baked,
        }
    }

    /// Texels in a row, and rows.
    pub(crate) fn texels(&self) -> [f32; 2] {
        self.layout.levels[0].size.map(|n| n as f32)
    }

    /// The function of a place (x, y), in pictures, that gives the value there: bilinear
    /// interpolation of the texels.
    pub(crate) fn point(&self, lower: &mut Lower<'_, '_>) -> FunctionRef {
        lower.function(&format!("{} point", self.key), |module| {
            let b = &Builder::new("texel", "A picture between its texels.");
            let place = b.float_params(["x", "y"]);
            self.level(b.uint(0), place, false).results(b);
            b.finish(module)
        })
    }

    /// The function of a place (x, y), in pictures, and a variance in texels that gives a [`Tap`];
    /// without `carries`, the means alone.
    pub(crate) fn filtered(&self, lower: &mut Lower<'_, '_>, carries: bool) -> FunctionRef {
        let key = format!("{} filtered {carries}", self.key);
        lower.function(&key, |module| self.build(module, carries))
    }

    fn build(&self, module: &mut Module, carries: bool) -> FunctionRef {
        let b = &Builder::new("level", "One level of a picture's pyramid of moments.");
        let row = b.uint_param("row");
        let place = b.float_params(["x", "y"]);
        self.level(row, place, carries).results(b);
        let level = b.finish(module);

        let b = &Builder::new("filtered_picture", "A picture under a Gaussian.");
        let place = b.float_params(["x", "y"]);
        let variance = b.float_param("variance");
        let (row, share, share_of_rest) = self.between(variance);
        let [fine, coarse] = [row, row + 1].map(|row| b.call(&level, (row, place)));
        let numbers = 3 * self.layout.channels;
        let mixed: Vec<Float<'_>> = (fine.iter().zip(&coarse).enumerate())
            .map(|(i, (&fine, &coarse))| {
                let share = if i < numbers { share } else { share_of_rest };
                lerp(fine, coarse, share)
            })
            .collect();
        Tap::of(&mixed, self.layout.channels).results(b);
        b.finish(module)
    }

    /// The finer of the two levels between which a variance lies, the share of the coarser one by
    /// variance, and its share of what is beyond the gradient, which grows as σ⁴ from the texels.
    fn between<'b>(&self, variance: Float<'b>) -> (Uint<'b>, Float<'b>, Float<'b>) {
        let last = (self.layout.levels.len() - 2) as f32;
        let scaled = (variance * (1.0 / WIDENED)).clamp(0.0, last.exp2());
        let octaves = scaled.max(1.0).ln() * (1.0 / std::f32::consts::LN_2);
        let level = (octaves + 1.0).floor().clamp(0.0, last);
        let below = scaled.lt(1.0);
        let row = below.select(0.0, level).to_int().to_uint();
        let ratio = scaled / variance_of(row).max(1.0);
        let share = below.select(scaled, ratio + -1.0).clamp(0.0, 1.0);
        // Between 0 and level 1: t² (3 − t)/2.
        let slow = share.square() * (share * -0.5 + 1.5);
        (row, share, below.select(slow, share))
    }

    /// A number of a level's row.
    fn row<'b>(&self, row: Uint<'b>, number: u32) -> Float<'b> {
        row.builder().load(self.rows, row * ROW + number)
    }

    /// The bilinear patch of a level at a place: its mean and gradient, and what its four samples
    /// and the way between them have of covariance beyond that gradient. Level 0 has none: it is
    /// the function itself.
    fn level<'b>(&self, row: Uint<'b>, place: [Float<'b>; 2], carries: bool) -> Tap<'b> {
        let (b, n) = (row.builder(), self.layout.channels);
        let sizes = [self.row(row, 0), self.row(row, 1)];
        let margins = self.layout.address.map(|address| address.margin() as f32);
        let [(left, s), (top, t)] = [0, 1].map(|axis| {
            let last = sizes[axis] + (2.0 * margins[axis] - 1.0);
            let at = (place[axis] * sizes[axis] + (margins[axis] - 0.5)).clamp(0.0, last);
            let whole = at.floor().min(last + -1.0);
            (whole, at - whole)
        });

        // The four samples; level 0 has no covariances.
        let unsigned = |x: Float<'b>| x.to_int().to_uint();
        let finest = row.equals(0);
        let stride = finest.select(n as u32, (n + triangle(n)) as u32);
        let width = unsigned(sizes[0] + 2.0 * margins[0]);
        let sample = unsigned(top) * width + unsigned(left);
        let offset = (unsigned(self.row(row, 2)) << 12) + unsigned(self.row(row, 3));
        let first = offset + sample * stride;
        let below = first + width * stride;
        let corners = [first, first + stride, below, below + stride];
        let numbers = |i: usize| corners.map(|at| b.load(self.numbers, at + i as u32));

        // Each channel's mean, and its steps: along x above and below, and along y.
        let (mut mean, mut steps) = (Vec::new(), Vec::new());
        for channel in 0..n {
            let [p, q, r, u] = numbers(channel);
            let (above, under) = (lerp(p, q, s), lerp(r, u, s));
            mean.push(lerp(above, under, t));
            steps.push([q - p, u - r, under - above]);
        }
        if !carries {
            return Tap::of(&mean, n);
        }
        let texels = self.texels();
        let per_texel = [0, 1].map(|axis| sizes[axis] * (1.0 / texels[axis]));
        let gradient: Vec<Vec2<'b>> = (steps.iter())
            .map(|&[above, under, down]| {
                Vec2([lerp(above, under, t) * per_texel[0], down * per_texel[1]])
            })
            .collect();

        // The variance of the level's Gaussian and of the weights themselves: s(1 − s) of a step.
        let spread = [s, t].map(|x| x * (1.0 - x));
        let sigma = variance_of(row);
        let kernel = [0, 1].map(|axis| sigma + spread[axis] / per_texel[axis].square());
        let rest = pairs(n).enumerate().map(|(entry, (i, k))| {
            let [p, q, r, u] = numbers(n + entry);
            let inside = lerp(lerp(p, q, s), lerp(r, u, s), t);
            let [above, under, down] = [0, 1, 2].map(|step| steps[i][step] * steps[k][step]);
            let all = inside + dot([lerp(above, under, t), down], spread);
            let linear = [0, 1].map(|axis| gradient[i][axis] * gradient[k][axis]);
            let mut left = all - dot(linear, kernel);
            if i == k {
                left = left.max(0.0);
            }
            finest.select(0.0, left)
        });
        Tap {
            rest: rest.collect(),
            mean,
            gradient,
        }
    }

    /// The covariance that a Gaussian of this variance removes on average over the picture.
    pub(crate) fn removed<'b>(
        &self,
        lower: &mut Lower<'_, 'b>,
        variance: Float<'b>,
    ) -> Vec<Float<'b>> {
        let count = triangle(self.layout.channels);
        let key = format!("{} removed", self.key);
        let table = lower.table(&key, "removed_covariance", || {
            let baked = Arc::clone(&self.baked);
            Numbers::lazy(self.layout.levels.len() * count, move || {
                baked.removed.iter().flatten().map(|&x| x as f32).collect()
            })
        });
        let (row, share, _) = self.between(variance);
        let first = row * count as u32;
        let next = first + count as u32;
        (0..count as u32)
            .map(|i| {
                let [fine, coarse] = [first, next].map(|row| lower.b().load(table, row + i));
                lerp(fine, coarse, share)
            })
            .collect()
    }
}
