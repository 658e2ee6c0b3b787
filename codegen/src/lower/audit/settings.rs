//! What a graph shows when its inputs are elsewhere than at their defaults: what is decided at those
//! must hold there.

use super::truth::{BIASED, far_bias, values_with};
use crate::cpu::Footprint;
use crate::ir::Program;
use mipless_graph::{Graph, Parameter, Type};
use std::ops::Range;

/// The numbers of all inputs with those that are real at the lower ends of their sliders, and at the
/// upper ones; without a slider at a half and at three halves of their defaults.
fn ends(graph: &Graph) -> [Vec<f32>; 2] {
    let end = |parameter: &Parameter, side: usize| -> Vec<f32> {
        let defaults = parameter.value.numbers();
        if matches!(parameter.ty, Type::Integer | Type::Boolean) {
            return defaults.to_vec();
        }
        let soft = [parameter.soft_min, parameter.soft_max][side];
        let hard = [parameter.min, parameter.max][side];
        let of = |default: f32| soft.or(hard).unwrap_or(default * [0.5, 1.5][side]);
        defaults.iter().copied().map(of).collect()
    };
    [0, 1].map(|side| {
        (graph.parameters.iter())
            .flat_map(|parameter| end(parameter, side))
            .collect()
    })
}

/// The programs before and after a change, and the truth.
pub(super) struct Change<'a> {
    pub(super) before: &'a Program,
    pub(super) after: &'a Program,
    pub(super) right: &'a Program,
}

impl Change<'_> {
    /// Of each range of components whether their means over footprints are nowhere further off by
    /// the change, or right.
    pub(super) fn helps(
        &self,
        graph: &Graph,
        footprints: &[Footprint],
        components: &[Range<usize>],
    ) -> Vec<bool> {
        let mut helps = vec![true; components.len()];
        for parameters in ends(graph) {
            let [before, after, right] = [self.before, self.after, self.right]
                .map(|program| values_with(program, footprints, &parameters));
            for (helps, components) in helps.iter_mut().zip(components) {
                *helps &= components.clone().all(|i| {
                    let bias = |found: &[Vec<f32>]| far_bias(&found[i], &right[i]);
                    bias(&after) <= bias(&before).max(BIASED)
                });
            }
        }
        helps
    }
}
