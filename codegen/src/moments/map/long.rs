//! Long footprints over a map that repeats: as many places along the major axis as the ratio of the
//! axes asks for.
//!
//! Five taps with a capped ratio ([`super::read`]) blur the minor axis; a pattern of hard edges shows
//! that. Here N(m, Σ) is a row of isotropic Gaussians of the minor axis' σ (s), weighted by a
//! Gaussian: with distances of at most [`APART`] s between them their sum is even to 2 exp(−2π²/APART²).

use super::super::tabulated::lerp;
use super::read::{Axes, Levels};
use super::{Map, Moment, Packing};
use crate::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2};

/// Where the ratio of the axes is above this, one after the other is read.
const LONG: f32 = 2.5;
/// How far along the row reaches, in standard deviations.
const REACH: f32 = 3.0;
/// The distance of neighbours, in s.
const APART: f32 = 1.5;
/// The most places; where they do not suffice, s is larger.
const MOST: f32 = 64.0;

/// One more place along the major axis: adds the codes there and their weight to the state.
pub(super) fn step(
    module: &mut Module,
    name: &str,
    reader: &FunctionRef,
    packing: &Packing,
) -> FunctionRef {
    let b = &Builder::new(name, "One more place along a long footprint.");
    let index = b.uint_param("index");
    let sums: Vec<Float<'_>> = (0..packing.components())
        .map(|i| b.float_param(format!("sum_{i}")))
        .collect();
    let weights = b.float_param("weights");
    let centre = Vec2(b.float_params(["centre_x", "centre_y"]));
    let axis = Vec2(b.float_params(["axis_x", "axis_y"]));
    let apart = b.float_param("apart");
    let fine = b.float_params(["fine_intervals", "fine_first"]);
    let coarse = b.float_params(["coarse_intervals", "coarse_first"]);
    let share = b.float_param("share");
    let x = (index.to_float() + 0.5) * apart - REACH;
    let weight = (-0.5 * x.square()).exp();
    let place = (centre + axis * x).map(|at| at - at.floor());
    let [fine, coarse] = [fine, coarse].map(|row| b.call(reader, (place, row)));
    for (i, sum) in sums.into_iter().enumerate() {
        let code = lerp(fine[i], coarse[i], share);
        b.result(format!("sum_{i}"), sum + weight * code);
    }
    b.result("weights", weights + weight);
    b.finish(module)
}

impl Map {
    /// The means of all components under a long footprint, `otherwise` elsewhere.
    pub(super) fn long<'b>(
        &self,
        mean: Vec2<'b>,
        covariance: Sym2<'b>,
        otherwise: Vec<Float<'b>>,
    ) -> Vec<Float<'b>> {
        let Some(step) = &self.step else {
            return otherwise;
        };
        let b = mean[0].builder();
        let Axes {
            centre,
            direction,
            variances: [more, less],
        } = self.axes(mean, covariance);
        // The finest level holds what is finer.
        let finest = super::FINEST as f32;
        let s = less.max(finest * finest).sqrt();
        let along = (more - s.square()).max(0.0).sqrt();
        let is_long = along.gt(LONG * s);
        let wanted = along * (2.0 * REACH / APART) / s;
        let count = wanted.ceil().min(MOST);
        let apart = 2.0 * REACH / count.max(1.0);
        let Levels {
            rows: [fine, coarse],
            share,
        } = self.levels(s.max(along * apart * (1.0 / APART)));
        let turns = is_long.select(count, 0.0).to_int().to_uint();
        let start = (vec![b.float(0.0); otherwise.len()], b.float(0.0));
        let (sums, weights) = b.fold(
            step,
            turns,
            start,
            (centre, direction * along, apart, (fine, coarse, share)),
        );
        let by_weight = 1.0 / weights.max(1e-6);
        let codes = sums.into_iter().map(|sum| sum * by_weight);
        let means = (self.packing).decode(self.tables[Moment::Mean as usize], codes);
        (means.into_iter().zip(otherwise))
            .map(|(long, otherwise)| is_long.select(long, otherwise))
            .collect()
    }
}
