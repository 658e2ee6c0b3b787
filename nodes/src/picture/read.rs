//! Reading a pyramid of moments at a place, for a Gaussian of any width.

use super::pyramid::{Layout, triangle};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Numbers, Type, Value};

/// Numbers of a row of the table that says where the levels are.
const ROW: u32 = 4;

/// The table of a pyramid, and where its levels are.
#[derive(Clone, Debug)]
pub(crate) struct Pyramid {
    pub(crate) layout: Layout,
    /// The numbers of all levels.
    numbers: u32,
    /// A row a level: samples in x and y, and the offset as two numbers.
    rows: u32,
    key: String,
}

/// The field at a place, by channel: what one function of the module gives.
#[derive(Clone, Debug)]
pub(crate) struct Tap {
    pub(crate) mean: Vec<Value>,
    /// The change a texel along x and y.
    pub(crate) gradient: Vec<[Value; 2]>,
    /// The lower triangle of the covariance beyond the gradient's.
    pub(crate) rest: Vec<Value>,
}

impl Tap {
    /// From numbers: the means, and if there are more the gradients and the rest.
    pub(crate) fn of(numbers: &[Value], channels: usize) -> Self {
        let (mean, more) = numbers.split_at(channels);
        let (gradient, rest) = more.split_at(if more.is_empty() { 0 } else { 2 * channels });
        Self {
            mean: mean.to_vec(),
            gradient: gradient.chunks(2).map(|pair| [pair[0], pair[1]]).collect(),
            rest: rest.to_vec(),
        }
    }

    /// The results of a function.
    fn results(&self, b: &mut Builder) {
        for (i, &mean) in self.mean.iter().enumerate() {
            b.result(format!("mean_{i}"), mean);
        }
        for (i, &[x, y]) in self.gradient.iter().enumerate() {
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
fn variance_of(b: &mut Builder, row: Value) -> Value {
    let one = b.u32(1);
    let doubled = b.shl_u(one, row);
    let square = b.shr_u(doubled, one);
    b.float_u(square)
}

impl Pyramid {
    /// The pyramid of this layout; `key` names whatever the numbers depend on.
    pub(crate) fn new(
        lower: &mut Lower<'_>,
        key: &str,
        name: &str,
        layout: Layout,
        numbers: impl FnOnce() -> Numbers,
    ) -> Self {
        let rows = layout.levels.iter().flat_map(|level| {
            let [nx, ny] = level.size.map(|n| n as f32);
            let (high, low) = (level.offset >> 12, level.offset & 0xfff);
            [nx, ny, high as f32, low as f32]
        });
        let rows: Vec<f32> = rows.collect();
        let numbers = lower.table(&format!("{key} numbers"), name, numbers);
        let rows_name = format!("{name}_levels");
        let rows = lower.table(&format!("{key} rows"), &rows_name, || rows.into());
        Self {
            layout,
            numbers,
            rows,
            key: key.to_owned(),
        }
    }

    /// The function of a place (x, y), in pictures, that gives the value there: bilinear
    /// interpolation of the texels.
    pub(crate) fn point(&self, lower: &mut Lower<'_>) -> FunctionRef {
        lower.function(&format!("{} point", self.key), |module| {
            let mut b = Builder::new("texel", "A picture between its texels.");
            let place = [b.param_f32("x"), b.param_f32("y")];
            let zero = b.u32(0);
            let mean = self.level(&mut b, zero, place, false).mean;
            for (i, mean) in mean.into_iter().enumerate() {
                b.result(format!("mean_{i}"), mean);
            }
            b.finish(module)
        })
    }

    /// The function of a place (x, y), in pictures, and a variance in texels that gives a [`Tap`];
    /// without `carries`, the means alone.
    pub(crate) fn filtered(&self, lower: &mut Lower<'_>, carries: bool) -> FunctionRef {
        let key = format!("{} filtered {carries}", self.key);
        lower.function(&key, |module| self.build(module, carries))
    }

    fn build(&self, module: &mut Module, carries: bool) -> FunctionRef {
        let mut b = Builder::new("level", "One level of a picture's pyramid of moments.");
        let row = b.param("row", Type::U32);
        let place = [b.param_f32("x"), b.param_f32("y")];
        let tap = self.level(&mut b, row, place, carries);
        tap.results(&mut b);
        let level = b.finish(module);

        let mut b = Builder::new("filtered_picture", "A picture under a Gaussian.");
        let place = [b.param_f32("x"), b.param_f32("y")];
        let variance = b.param_f32("variance");
        let (row, share, share_of_rest) = self.between(&mut b, variance);
        let one = b.u32(1);
        let next = b.add_u(row, one);
        let [fine, coarse] = [row, next].map(|row| b.call(&level, &[row, place[0], place[1]]));
        let numbers = 3 * self.layout.channels;
        let mixed: Vec<Value> = (fine.iter().zip(&coarse).enumerate())
            .map(|(i, (&fine, &coarse))| {
                let share = if i < numbers { share } else { share_of_rest };
                let step = b.sub(coarse, fine);
                let part = b.mul(step, share);
                b.add(fine, part)
            })
            .collect();
        Tap::of(&mixed, self.layout.channels).results(&mut b);
        b.finish(module)
    }

    /// The finer of the two levels between which a variance lies, the share of the coarser one by
    /// variance, and its share of what is beyond the gradient, which grows as σ⁴ from the texels.
    fn between(&self, b: &mut Builder, variance: Value) -> (Value, Value, Value) {
        let last = self.layout.levels.len() - 2;
        let scaled = b.scale(variance, 1.0 / WIDENED);
        let most = (last as f32).exp2();
        let scaled = b.clamp(scaled, 0.0, most);
        let one = b.f32(1.0);
        let wide = b.max(scaled, one);
        let log = b.ln(wide);
        let level = b.scale(log, 1.0 / std::f32::consts::LN_2);
        let level = b.offset(level, 1.0);
        let level = b.floor(level);
        let level = b.clamp(level, 0.0, last as f32);
        let below = b.lt(scaled, one);
        let zero = b.f32(0.0);
        let level = b.select(below, zero, level);
        let row = b.trunc_i(level);
        let row = b.cast_u(row);
        let own = variance_of(b, row);
        let own = b.max(own, one);
        let ratio = b.div(scaled, own);
        let beyond = b.offset(ratio, -1.0);
        let share = b.select(below, scaled, beyond);
        let share = b.clamp(share, 0.0, 1.0);
        // Between 0 and level 1: t² (3 − t)/2.
        let square = b.square(share);
        let bend = b.scale(share, -0.5);
        let bend = b.offset(bend, 1.5);
        let slow = b.mul(square, bend);
        let rest = b.select(below, slow, share);
        (row, share, rest)
    }

    fn row(&self, b: &mut Builder, row: Value, number: u32) -> Value {
        let (row_length, number) = (b.u32(ROW), b.u32(number));
        let first = b.mul_u(row, row_length);
        let at = b.add_u(first, number);
        b.load(self.rows, at)
    }

    /// The bilinear patch of a level at a place: its mean and gradient, and what its four samples
    /// and the way between them have of covariance beyond that gradient. Level 0 has none: it is
    /// the function itself.
    fn level(&self, b: &mut Builder, row: Value, place: [Value; 2], carries: bool) -> Tap {
        let sizes = [self.row(b, row, 0), self.row(b, row, 1)];
        let [left, top] = [0, 1].map(|axis| {
            let margin = self.layout.address[axis].margin() as f32;
            let at = b.mul(place[axis], sizes[axis]);
            let at = b.offset(at, margin - 0.5);
            let last = b.offset(sizes[axis], 2.0 * margin - 1.0);
            let zero = b.f32(0.0);
            let at = b.max(at, zero);
            let at = b.min(at, last);
            let whole = b.floor(at);
            let limit = b.offset(last, -1.0);
            let whole = b.min(whole, limit);
            (whole, b.sub(at, whole))
        });
        let unsigned = |b: &mut Builder, x: Value| {
            let whole = b.trunc_i(x);
            b.cast_u(whole)
        };
        let margins = self.layout.address[0].margin() as f32;
        let width = b.offset(sizes[0], 2.0 * margins);
        let width = unsigned(b, width);
        let none = {
            let zero = b.u32(0);
            b.eq_u(row, zero)
        };
        // Level 0 has no covariances.
        let n = self.layout.channels;
        let (few, all) = (b.u32(n as u32), b.u32((n + triangle(n)) as u32));
        let stride = b.select(none, few, all);
        let (x, y) = (unsigned(b, left.0), unsigned(b, top.0));
        let rows = b.mul_u(y, width);
        let sample = b.add_u(rows, x);
        let (high, low) = (self.row(b, row, 2), self.row(b, row, 3));
        let (high, low) = (unsigned(b, high), unsigned(b, low));
        let twelve = b.u32(12);
        let high = b.shl_u(high, twelve);
        let offset = b.add_u(high, low);
        let sample = b.mul_u(sample, stride);
        let first = b.add_u(offset, sample);
        let down = b.mul_u(width, stride);
        let below = b.add_u(first, down);
        let corners = [first, b.add_u(first, stride), below, b.add_u(below, stride)];
        let number = |b: &mut Builder, i: usize| {
            let i = b.u32(i as u32);
            corners.map(|corner| {
                let at = b.add_u(corner, i);
                b.load(self.numbers, at)
            })
        };
        let (s, t) = (left.1, top.1);
        let mix = |b: &mut Builder, p: Value, q: Value, share: Value| {
            let step = b.sub(q, p);
            let part = b.mul(step, share);
            b.add(p, part)
        };
        // Each channel's mean, and its steps: along x above and below, and along y.
        let mut mean = Vec::new();
        let mut steps = Vec::new();
        for channel in 0..n {
            let [p, q, r, u] = number(b, channel);
            let (above, under) = (mix(b, p, q, s), mix(b, r, u, s));
            mean.push(mix(b, above, under, t));
            steps.push([b.sub(q, p), b.sub(u, r), b.sub(under, above)]);
        }
        if !carries {
            return Tap {
                mean,
                gradient: Vec::new(),
                rest: Vec::new(),
            };
        }
        let texels = self.layout.levels[0].size.map(|n| n as f32);
        let per_texel = [0, 1].map(|axis| b.scale(sizes[axis], 1.0 / texels[axis]));
        let gradient: Vec<[Value; 2]> = (steps.iter())
            .map(|&[above, under, down]| {
                let across = mix(b, above, under, t);
                [b.mul(across, per_texel[0]), b.mul(down, per_texel[1])]
            })
            .collect();
        let one = b.f32(1.0);
        // The weights' own variance: s(1 − s) of a step.
        let spread = [s, t].map(|x| {
            let other = b.sub(one, x);
            b.mul(x, other)
        });
        let sigma = variance_of(b, row);
        let kernel = [0, 1].map(|axis| {
            let square = b.square(per_texel[axis]);
            let step = b.div(spread[axis], square);
            b.add(sigma, step)
        });
        let zero = b.f32(0.0);
        let mut rest = Vec::new();
        for i in 0..n {
            for k in 0..=i {
                let [p, q, r, u] = number(b, n + rest.len());
                let (above, under) = (mix(b, p, q, s), mix(b, r, u, s));
                let inside = mix(b, above, under, t);
                let ([a, c, d], [e, f, g]) = (steps[i], steps[k]);
                let (above, under) = (b.mul(a, e), b.mul(c, f));
                let across = mix(b, above, under, t);
                let down = b.mul(d, g);
                let between = b.dot(&[across, down], &spread);
                let all = b.add(inside, between);
                let linear = [0, 1].map(|axis| b.mul(gradient[i][axis], gradient[k][axis]));
                let linear = b.dot(&linear, &kernel);
                let mut left = b.sub(all, linear);
                if i == k {
                    left = b.max(left, zero);
                }
                rest.push(b.select(none, zero, left));
            }
        }
        Tap {
            mean,
            gradient,
            rest,
        }
    }

    /// The covariance that a Gaussian of this variance removes on average over the picture; `rows`
    /// gives those of the levels, so many numbers.
    pub(crate) fn removed(
        &self,
        lower: &mut Lower<'_>,
        variance: Value,
        rows: impl FnOnce(usize) -> Numbers,
    ) -> Vec<Value> {
        let key = format!("{} removed", self.key);
        let length = self.layout.levels.len() * triangle(self.layout.channels);
        let table = lower.table(&key, "removed_covariance", || rows(length));
        let b = lower.b();
        let (row, share, _) = self.between(b, variance);
        let count = triangle(self.layout.channels) as u32;
        let length = b.u32(count);
        let first = b.mul_u(row, length);
        let next = b.add_u(first, length);
        (0..count)
            .map(|i| {
                let i = b.u32(i);
                let [fine, coarse] = [first, next].map(|row| {
                    let at = b.add_u(row, i);
                    b.load(table, at)
                });
                let step = b.sub(coarse, fine);
                let part = b.mul(step, share);
                b.add(fine, part)
            })
            .collect()
    }
}
