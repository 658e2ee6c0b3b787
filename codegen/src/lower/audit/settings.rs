//! What a graph shows when its inputs are elsewhere than at their defaults: what is decided at those
//! must hold there.

use super::super::drawn::Near;
use super::truth::{BIASED, far_bias, values_with};
use crate::cpu::Footprint;
use crate::ir::Program;
use mipless_graph::{Graph, Parameter, Type};
use std::ops::Range;

/// The share of a slider from its default at which nothing is drawn any more, where that would not be right
/// at the slider's ends.
const REACH: f32 = 0.25;

/// Whether an input has a slider's ends.
fn is_real(parameter: &Parameter) -> bool {
    !matches!(parameter.ty, Type::Integer | Type::Boolean)
}

/// The lower end of a slider and the upper one, for a default; without a slider a half and three halves
/// of that.
fn slider(parameter: &Parameter, default: f32) -> [f32; 2] {
    let soft = [parameter.soft_min, parameter.soft_max];
    let hard = [parameter.min, parameter.max];
    [0, 1].map(|side| {
        let end = soft[side].or(hard[side]);
        end.unwrap_or(default * [0.5, 1.5][side])
    })
}

/// The numbers of all inputs with those that are `moved` and real at the lower ends of their sliders, and
/// at the upper ones.
fn ends(graph: &Graph, moved: impl Fn(usize) -> bool) -> [Vec<f32>; 2] {
    [0, 1].map(|side| {
        (graph.parameters.iter().enumerate())
            .flat_map(|(index, parameter)| {
                let moves = moved(index) && is_real(parameter);
                let of = move |default: f32| match moves {
                    true => slider(parameter, default)[side],
                    false => default,
                };
                parameter.value.numbers().into_iter().map(of)
            })
            .collect()
    })
}

/// The numbers of an input, with how far from their defaults each is still near.
fn near(graph: &Graph, index: usize) -> Vec<Near> {
    let before = graph.parameters[..index].iter();
    let first: usize = before.map(|parameter| parameter.ty.components()).sum();
    let parameter = &graph.parameters[index];
    (parameter.value.numbers().into_iter().enumerate())
        .map(|(i, default)| {
            let [low, high] = slider(parameter, default);
            Near {
                scalar: first + i,
                default,
                reach: (REACH * (high - low).abs()).max(1e-6),
            }
        })
        .collect()
}

/// Of so many footprints one is looked at, input by input.
const FEW: usize = 3;

/// The programs before and after a change, and the truth.
pub(super) struct Change<'a> {
    pub(super) before: &'a Program,
    pub(super) after: &'a Program,
    pub(super) right: &'a Program,
}

impl Change<'_> {
    /// Of each range of components near which inputs their means over footprints are further off by the
    /// change nowhere, or right: near those at the ends of whose sliders they are not; near all, where
    /// it is no one input's.
    pub(super) fn near(
        &self,
        graph: &Graph,
        footprints: &[Footprint],
        components: &[Range<usize>],
    ) -> Vec<Vec<Near>> {
        let helps = self.helps(ends(graph, |_| true), footprints, components);
        let mut all = vec![Vec::new(); components.len()];
        if helps.iter().all(|&helps| helps) {
            return all;
        }
        let some: Vec<Footprint> = footprints.iter().step_by(FEW).copied().collect();
        let real = |&index: &usize| is_real(&graph.parameters[index]);
        let inputs: Vec<usize> = (0..graph.parameters.len()).filter(real).collect();
        for &index in &inputs {
            let alone = self.helps(ends(graph, |moved| moved == index), &some, components);
            for ((near_of, alone), helps) in all.iter_mut().zip(alone).zip(&helps) {
                if !alone && !helps {
                    near_of.extend(near(graph, index));
                }
            }
        }
        for (near_of, helps) in all.iter_mut().zip(helps) {
            if near_of.is_empty() && !helps {
                near_of.extend(inputs.iter().flat_map(|&index| near(graph, index)));
            }
        }
        all
    }

    /// Of each range of components whether their means over footprints are nowhere further off by
    /// the change, or right, at two settings of the inputs.
    fn helps(
        &self,
        settings: [Vec<f32>; 2],
        footprints: &[Footprint],
        components: &[Range<usize>],
    ) -> Vec<bool> {
        let mut helps = vec![true; components.len()];
        for parameters in settings {
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
