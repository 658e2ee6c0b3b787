//! What pixels see of a field.

use super::{Direction, Field, visible};

/// A field seen from a direction and lit from another one.
#[derive(Clone, Debug)]
pub struct Lit<'a> {
    field: &'a Field,
    /// V_o (o·(−s, 1))⁺ of each facet: the area that the eye sees.
    seen: Vec<f64>,
    /// V_i of each facet.
    lit: Vec<f64>,
}

impl<'a> Lit<'a> {
    /// By rays.
    pub fn new(field: &'a Field, view: Direction, light: Direction) -> Self {
        Self::of(field, field, view, light)
    }

    /// Of some facets of a field, by rays over all of it: see [`Field::thinned`].
    pub fn of(facets: &'a Field, field: &Field, view: Direction, light: Direction) -> Self {
        let stride = field.torus.texels / facets.torus.texels;
        let open = Self::open(facets, view);
        let clear = visible(field, view, stride);
        Self {
            seen: open.seen.iter().zip(&clear).map(|(a, v)| a * v).collect(),
            lit: visible(field, light, stride),
            ..open
        }
    }

    /// Where nothing hides anything.
    pub fn open(field: &'a Field, view: Direction) -> Self {
        let [x, y, z] = view;
        Self {
            field,
            seen: field.each(|_, [u, v]| (z - x * u - y * v).max(0.0)),
            lit: vec![1.0; field.height.len()],
        }
    }

    /// The area that the eye sees of each facet, over that of the mesh.
    pub fn seen(&self) -> &[f64] {
        &self.seen
    }

    /// What a pixel sees that holds the whole field.
    pub fn whole(&self, f: &[f64]) -> f64 {
        let shown =
            (f.iter().zip(&self.seen).zip(&self.lit)).map(|((f, seen), lit)| f * seen * lit);
        shown.sum::<f64>() / self.seen.iter().sum::<f64>()
    }

    /// The same, were no light hidden.
    pub fn unshadowed(&self, f: &[f64]) -> f64 {
        let shown = f.iter().zip(&self.seen).map(|(f, seen)| f * seen);
        shown.sum::<f64>() / self.seen.iter().sum::<f64>()
    }

    /// What pixels of these deviations see of facets that send `f` to the eye where the light reaches
    /// them, at every `stride`-th texel of every `stride`-th row.
    pub fn pixels(&self, f: &[f64], sds: &[f64], stride: usize) -> Vec<Vec<f64>> {
        let shown =
            (f.iter().zip(&self.seen).zip(&self.lit)).map(|((f, seen), lit)| f * seen * lit);
        let shown: Vec<f64> = shown.collect();
        let averages = Averages::of(self.field, stride);
        sds.iter()
            .map(|&sd| {
                let light = averages.filtered(&shown, sd);
                let area = averages.filtered(&self.seen, sd);
                let ratio = light.iter().zip(&area).map(|(l, a)| l / a.max(1e-9));
                ratio.collect()
            })
            .collect()
    }
}

/// Filtered fields at some of their texels.
#[derive(Clone, Copy, Debug)]
pub struct Averages<'a> {
    field: &'a Field,
    stride: Option<usize>,
}

impl<'a> Averages<'a> {
    /// At every `stride`-th texel of every `stride`-th row.
    pub const fn of(field: &'a Field, stride: usize) -> Self {
        Self {
            field,
            stride: Some(stride),
        }
    }

    /// Over the whole field, as one pixel.
    pub const fn whole(field: &'a Field) -> Self {
        Self {
            field,
            stride: None,
        }
    }

    /// The means of numbers over Gaussians.
    pub fn filtered(&self, numbers: &[f64], sd: f64) -> Vec<f64> {
        let Some(stride) = self.stride else {
            return vec![numbers.iter().sum::<f64>() / numbers.len() as f64];
        };
        let n = self.field.torus.texels;
        let all = self.field.torus.filtered(numbers, sd);
        let rows = all.chunks(n).step_by(stride);
        rows.flat_map(|row| row.iter().copied().step_by(stride))
            .collect()
    }
}
