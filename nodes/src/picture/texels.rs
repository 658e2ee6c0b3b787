//! A picture as a function of a place, without moments: what is sampled to make a map of it.

use super::planes::Planes;
use mipless_codegen::ir::{Float, Module, Numbers};

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
        Self {
            size: planes.size,
            ranges: planes.ranges(),
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
    pub(crate) fn at<'b>(
        &self,
        module: &mut Module,
        place: [Float<'b>; 2],
        periodic: bool,
    ) -> Vec<Float<'b>> {
        let table = module.table("texels", self.numbers.clone());
        let [(columns, across), (rows, down)] = [0, 1].map(|axis| {
            let n = self.size[axis] as f32;
            let at = place[axis] * n + -0.5;
            let whole = at.floor();
            let next = whole + 1.0;
            let neighbours = if periodic {
                [
                    whole.lt(0.0).select(n - 1.0, whole),
                    next.lt(n).select(next, 0.0),
                ]
            } else {
                [whole.max(0.0), next.min(n - 1.0)]
            };
            (neighbours, at - whole)
        });
        let channels = self.ranges.len() as u32;
        // Whole numbers below 2²⁴ are exact, and a picture has at most 2²² texels.
        let corners = rows.map(|row| {
            let start = row * self.size[0] as f32;
            columns.map(|column| (start + column).to_int().to_uint() * channels)
        });
        (0..channels)
            .map(|channel| {
                let [above, below] = corners.map(|row| {
                    let [left, right] =
                        row.map(|first| first.builder().load(table, first + channel));
                    lerp(left, right, across)
                });
                lerp(above, below, down)
            })
            .collect()
    }
}

/// So much of the way from one number to another.
pub(crate) fn lerp<'b>(from: Float<'b>, to: Float<'b>, share: Float<'b>) -> Float<'b> {
    from + (to - from) * share
}
