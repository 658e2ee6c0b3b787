//! What passes between a function's frame and those of its callees.

use super::super::{Frame, Place, parameter_places};
use super::Scan;
use crate::cpu::code::{Code, Fold, Node};
use crate::ir::{FunctionId, Type, Value};
use std::mem::take;

impl Scan<'_> {
    pub(super) fn define_call(
        &mut self,
        value: Value,
        callee: FunctionId,
        arguments: &[Value],
        position: usize,
    ) {
        let parameters = parameter_places(self.module.function(callee), callee);
        self.pass(arguments, &parameters, &[], position);
        self.release(arguments, position);
        self.flush();
        self.nodes.push(Node::Call(callee));
        let sources = &self.callees[callee.index()].results;
        self.receive(value, sources);
    }

    pub(super) fn define_fold(
        &mut self,
        value: Value,
        body: FunctionId,
        count: Value,
        [init, captures]: [&[Value]; 2],
        position: usize,
    ) {
        let parameters = parameter_places(self.module.function(body), body);
        let (index, parameters) = parameters.split_first().expect("a body has an index");
        let (state, constant) = parameters.split_at(init.len());
        self.flush();
        let [limit, mask] = [0, 1].map(|_| self.fresh(Type::U32));
        self.pass(init, state, captures, position);
        let init_steps = take(&mut self.block);
        self.pass(captures, constant, &[], position);
        let capture_steps = take(&mut self.block);

        // A body's result is never the parameter of another state, so the order is free.
        let sources = &self.callees[body.index()].results;
        for (i, (&source, &to)) in sources.iter().zip(state).enumerate() {
            if source != to {
                let again = sources[i + 1..].contains(&source) || parameters.contains(&source);
                self.transfer(source, to, again || source == *index);
            }
        }
        let update = take(&mut self.block);
        for (&source, &to) in sources.iter().zip(state) {
            if source != to {
                let code = if to.bank == 0 {
                    Code::Select
                } else {
                    Code::SelectU
                };
                self.step(code, to, [mask, source, to]);
            }
        }
        let masked_update = take(&mut self.block);

        let count_place = self.place(count);
        self.release(&[&[count], init, captures].concat(), position);
        for place in [limit, mask] {
            self.pools[place.bank].free.push(place.index);
        }
        self.receive(value, state);
        let results = take(&mut self.block);
        self.nodes.push(Node::Fold(Box::new(Fold {
            function: body,
            count: count_place,
            limit,
            mask,
            index: *index,
            init: init_steps.into(),
            captures: capture_steps.into(),
            update: update.into(),
            masked_update: masked_update.into(),
            results: results.into(),
        })));
    }

    /// Moves arguments into the parameters of a callee. `later` are arguments that another pass at
    /// the same position moves.
    fn pass(
        &mut self,
        arguments: &[Value],
        parameters: &[Place],
        later: &[Value],
        position: usize,
    ) {
        for (i, (&argument, &to)) in arguments.iter().zip(parameters).enumerate() {
            let again = arguments[i + 1..].contains(&argument)
                || later.contains(&argument)
                || self.last_use[argument.index()] != Some(position);
            self.transfer(self.place(argument), to, again);
        }
    }

    /// Gives places to the results of `of`, and moves them there.
    fn receive(&mut self, of: Value, sources: &[Place]) {
        let results: Vec<(Value, Place)> = (self.results_of.remove(&of).unwrap_or_default())
            .into_iter()
            .filter(|(value, _)| self.last_use[value.index()].is_some())
            .map(|(value, i)| (value, sources[i as usize]))
            .collect();
        for (k, &(value, source)) in results.iter().enumerate() {
            let destination = self.allocate(value);
            let again = results[k + 1..].iter().any(|&(_, later)| later == source);
            self.transfer(source, destination, again);
        }
    }

    pub(super) fn transfer(&mut self, from: Place, to: Place, is_read_again: bool) {
        let code = match (is_read_again || from.frame == Frame::Constants, from.bank) {
            (true, 0) => Code::Copy,
            (true, _) => Code::CopyWord,
            (false, 0) => Code::Exchange,
            (false, _) => Code::ExchangeWord,
        };
        self.step(code, to, [from; 3]);
    }
}
