//! A picture as a function of a place, without moments: what is sampled to make a map of it.

use super::planes::Planes;
use mipless_codegen::ir::{Builder, Module, Numbers, Value};

/// The texels of a picture, the channels of each together.
#[derive(Clone, Debug)]
pub(crate) struct Texels {
    size: [usize; 2],
    /// The least and the largest number of each channel.
    ranges: Vec<[f32; 2]>,
    numbers: Numbers,
}

impl Texels {
    pub(crate) fn of(planes: &Planes) -> Self {
        let count = planes.size[0] * planes.size[1];
        let numbers: Vec<f32> = (0..count)
            .flat_map(|i| planes.planes.iter().map(move |plane| plane[i] as f32))
            .collect();
        let ranges = planes.planes.iter().map(|plane| {
            let bounds = [f32::INFINITY, f32::NEG_INFINITY];
            plane.iter().fold(bounds, |[low, high], &x| {
                [low.min(x as f32), high.max(x as f32)]
            })
        });
        Self {
            size: planes.size,
            ranges: ranges.collect(),
            numbers: numbers.into(),
        }
    }

    /// Texels in a row, and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The least and the largest number of each channel.
    pub(crate) fn ranges(&self) -> &[[f32; 2]] {
        &self.ranges
    }

    /// The channels at a place of the unit square, the first row at 0, between texels linearly;
    /// beyond the edges the picture is its edge, or repeats.
    pub(crate) fn at(
        &self,
        b: &mut Builder,
        module: &mut Module,
        place: [Value; 2],
        periodic: bool,
    ) -> Vec<Value> {
        let table = module.table("texels", self.numbers.clone());
        let axes = [0, 1].map(|axis| {
            let n = self.size[axis] as f32;
            let at = b.scale(place[axis], n);
            let at = b.offset(at, -0.5);
            let whole = b.floor(at);
            let share = b.sub(at, whole);
            let next = b.offset(whole, 1.0);
            let [zero, last, first] = [0.0, n - 1.0, n].map(|x| b.f32(x));
            let (before, after) = if periodic {
                let (outside, over) = (b.lt(whole, zero), b.lt(next, first));
                (b.select(outside, last, whole), b.select(over, next, zero))
            } else {
                (b.max(whole, zero), b.min(next, last))
            };
            ([before, after], share)
        });
        let [(columns, across), (rows, down)] = axes;
        let channels = self.ranges.len();
        let corners = rows.map(|row| {
            let start = b.scale(row, self.size[0] as f32);
            columns.map(|column| {
                // Whole numbers below 2²⁴ are exact, and a picture has at most 2²² texels.
                let texel = b.add(start, column);
                let texel = b.trunc_i(texel);
                let texel = b.cast_u(texel);
                let stride = b.u32(channels as u32);
                b.mul_u(texel, stride)
            })
        });
        (0..channels as u32)
            .map(|channel| {
                let channel = b.u32(channel);
                let [above, below] = corners.map(|[left, right]| {
                    let [left, right] = [left, right].map(|first| {
                        let index = b.add_u(first, channel);
                        b.load(table, index)
                    });
                    lerp(b, left, right, across)
                });
                lerp(b, above, below, down)
            })
            .collect()
    }
}

fn lerp(b: &mut Builder, from: Value, to: Value, share: Value) -> Value {
    let difference = b.sub(to, from);
    let part = b.mul(difference, share);
    b.add(from, part)
}
