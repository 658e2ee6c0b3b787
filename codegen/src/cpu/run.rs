//! Control flow over batches of lanes.

use super::block::{LANES, Registers, Runner};
use super::code::{Fold, Node, Register};
use super::compile::Code;
use crate::float::Float;

/// One batch in flight.
pub(super) struct Run<'a, F> {
    pub(super) code: &'a Code<F>,
    pub(super) runner: Runner<F>,
    pub(super) registers: &'a mut Registers<F>,
}

impl<F: Float> Run<'_, F> {
    /// Runs `nodes`; `active` is the word register of the lanes whose results matter, all of them
    /// where there is none.
    pub(super) fn nodes(&mut self, nodes: &[Node<Register>], active: Option<Register>) {
        let code = self.code;
        for node in nodes {
            match node {
                Node::Block(steps) => {
                    self.registers.steps += steps.len() as u64;
                    (self.runner)(steps, self.registers, &code.tables);
                }
                Node::Call(function) => self.nodes(&code.functions[function.index()], active),
                Node::Fold(fold) => self.fold(fold, active),
            }
        }
    }

    /// Takes as many turns as the active lane that asks for the most. Turns that every active lane
    /// takes replace the state; later ones select it.
    fn fold(&mut self, fold: &Fold<Register>, active: Option<Register>) {
        let Self { code, runner, .. } = *self;
        let [least, most] = self.limit(fold, active);
        runner(&fold.init, self.registers, &code.tables);
        if most > 0 {
            runner(&fold.captures, self.registers, &code.tables);
        }
        let body = &code.functions[fold.function.index()];
        for turn in 0..most {
            self.words(fold.index).fill(turn);
            if turn < least {
                self.nodes(body, active);
                runner(&fold.update, self.registers, &code.tables);
            } else {
                let limit = *self.words(fold.limit);
                let mask = self.words(fold.mask);
                for lane in 0..LANES {
                    mask[lane] = u32::from(turn < limit[lane]);
                }
                self.nodes(body, Some(fold.mask));
                runner(&fold.masked_update, self.registers, &code.tables);
            }
        }
        runner(&fold.results, self.registers, &code.tables);
    }

    /// Writes the turns that each lane takes, and returns the least and the most of the active
    /// lanes. What inactive lanes ask for is meaningless, and may be four milliards.
    fn limit(&mut self, fold: &Fold<Register>, active: Option<Register>) -> [u32; 2] {
        let count = *self.words(fold.count);
        let active = active.map_or([1; LANES], |register| *self.words(register));
        let limit = self.words(fold.limit);
        let (mut least, mut most) = (u32::MAX, 0);
        for lane in 0..LANES {
            let is_active = active[lane] != 0;
            limit[lane] = if is_active { count[lane] } else { 0 };
            most = most.max(limit[lane]);
            least = least.min(if is_active { count[lane] } else { u32::MAX });
        }
        [least, most]
    }

    fn words(&mut self, register: Register) -> &mut [u32; LANES] {
        &mut self.registers.words[register as usize].0
    }
}
