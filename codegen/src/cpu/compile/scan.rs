//! The linear scan over one function.

mod call;

use super::{Compiled, Constants, Frame, Place, bank, parameter_places};
use crate::cpu::code::{Code, Node, Register, Step};
use crate::ir::{Function, FunctionId, Inst, Module, Op, Type, Value};
use rustc_hash::FxHashMap;
use std::mem::take;

/// The position of a value's last use that comes after every instruction.
const END: usize = usize::MAX;

/// The registers of one bank in a frame.
#[derive(Debug, Default)]
struct Pool {
    free: Vec<Register>,
    size: Register,
}

impl Pool {
    /// A free register: the one that was used last, whose lines are in the cache.
    fn take(&mut self) -> Register {
        self.free.pop().unwrap_or_else(|| {
            self.size += 1;
            self.size - 1
        })
    }
}

/// The state of the scan.
pub(super) struct Scan<'a> {
    module: &'a Module,
    function: &'a Function,
    id: FunctionId,
    callees: &'a [Compiled],
    constants: &'a mut Constants,
    /// Whether a fold applies this function: its parameters then outlive their last use.
    is_body: bool,
    places: Vec<Option<Place>>,
    /// The results of each call and fold that something takes, with their numbers.
    results_of: FxHashMap<Value, Vec<(Value, u32)>>,
    /// The position of the last instruction that reads a value, [`END`] for results; nothing where
    /// no code is needed.
    last_use: Vec<Option<usize>>,
    /// The products that a sum or difference computes on the way.
    merged: Vec<bool>,
    pools: [Pool; 2],
    block: Vec<Step<Place>>,
    nodes: Vec<Node<Place>>,
}

impl<'a> Scan<'a> {
    pub(super) fn new(
        module: &'a Module,
        id: FunctionId,
        callees: &'a [Compiled],
        is_body: bool,
        constants: &'a mut Constants,
    ) -> Self {
        let function = module.function(id);
        let count = function.insts.len();
        let mut results_of: FxHashMap<Value, Vec<(Value, u32)>> = FxHashMap::default();
        for (index, inst) in function.insts.iter().enumerate() {
            if let Inst::Result(of, i) = inst {
                let results = results_of.entry(*of).or_default();
                results.push((Value::from_index(index), *i));
            }
        }
        Self {
            module,
            function,
            id,
            callees,
            constants,
            is_body,
            places: vec![None; count],
            results_of,
            last_use: vec![None; count],
            merged: vec![false; count],
            pools: Default::default(),
            block: Vec::new(),
            nodes: Vec::new(),
        }
    }

    /// Compiles the function; `uniform` says which parameters an evaluation has once.
    pub(super) fn run(mut self, uniform: &dyn Fn(usize) -> bool) -> Compiled {
        let uniform = self.uniform_values(uniform);
        let (prologue, body): (Vec<usize>, Vec<usize>) =
            (0..self.function.insts.len()).partition(|&index| uniform[index]);
        self.find_uses(&prologue, &body);
        self.place_parameters();
        for (position, &index) in prologue.iter().enumerate() {
            self.define(Value::from_index(index), position);
        }
        let prologue_nodes = self.take_nodes();
        for (position, &index) in body.iter().enumerate() {
            self.define(Value::from_index(index), prologue.len() + position);
        }
        let results = self.results();
        Compiled {
            prologue: prologue_nodes,
            nodes: self.take_nodes(),
            results,
            size: self.pools.map(|pool| pool.size),
        }
    }

    /// Which values depend on constants and uniform parameters alone.
    fn uniform_values(&self, uniform: &dyn Fn(usize) -> bool) -> Vec<bool> {
        let mut values = Vec::with_capacity(self.function.insts.len());
        let has_prologue = (0..self.function.params.len()).any(uniform);
        for inst in &self.function.insts {
            let is_uniform = match inst {
                Inst::Param(index) => uniform(*index as usize),
                _ => {
                    let mut all = has_prologue;
                    inst.operands(|v| all &= values[v.index()]);
                    all
                }
            };
            values.push(is_uniform);
        }
        values
    }

    /// Finds the last uses and the products to merge. An instruction without a use has no code.
    fn find_uses(&mut self, prologue: &[usize], body: &[usize]) {
        let mut uses = vec![0_u32; self.function.insts.len()];
        for &(_, value) in &self.function.results {
            self.last_use[value.index()] = Some(END);
            uses[value.index()] += 1;
        }
        let order = [prologue, body].concat();
        for (position, &index) in order.iter().enumerate().rev() {
            if self.last_use[index].is_some() {
                self.function.insts[index].operands(|v| {
                    self.last_use[v.index()].get_or_insert(position);
                    uses[v.index()] += 1;
                });
            }
        }
        // What the prologue defines for the body must outlive the batch.
        for &index in prologue {
            let last = &mut self.last_use[index];
            *last = last.map(|at| if at >= prologue.len() { END } else { at });
        }
        for (base, part) in [(0, prologue), (prologue.len(), body)] {
            for (position, &index) in part.iter().enumerate() {
                if self.last_use[index].is_some()
                    && let Some(product) = self.mergeable(index, &uses, part)
                {
                    self.merged[product.index()] = true;
                    self.function.inst(product).operands(|v| {
                        let last = &mut self.last_use[v.index()];
                        *last = (*last).max(Some(base + position));
                    });
                }
            }
        }
    }

    /// The product that the sum or difference at `index` can compute on the way: one that has no
    /// other use and the same part of the code. Of two, the later one.
    fn mergeable(&self, index: usize, uses: &[u32], part: &[usize]) -> Option<Value> {
        let Inst::Op(Op::Add | Op::Sub, [a, b, _]) = self.function.insts[index] else {
            return None;
        };
        [a, b]
            .into_iter()
            .filter(|&v| matches!(self.function.inst(v), Inst::Op(Op::Mul, _)))
            .filter(|v| uses[v.index()] == 1 && part.binary_search(&v.index()).is_ok())
            .max()
    }

    fn place_parameters(&mut self) {
        let places = parameter_places(self.function, self.id);
        for place in &places {
            self.pools[place.bank].size += 1;
        }
        for (index, inst) in self.function.insts.iter().enumerate() {
            if let Inst::Param(parameter) = inst {
                self.places[index] = Some(places[*parameter as usize]);
                if self.is_body {
                    self.last_use[index] = Some(END);
                }
            }
        }
    }

    /// Emits the code of one instruction.
    fn define(&mut self, value: Value, position: usize) {
        let function = self.function;
        if self.last_use[value.index()].is_none() || self.merged[value.index()] {
            return;
        }
        match function.inst(value) {
            Inst::Const(constant) => {
                let place = self.constants.place(constant.ty, constant.bits);
                self.places[value.index()] = Some(place);
            }
            // Parameters have places, and results get theirs with what they are results of.
            Inst::Param(_) | Inst::Result(..) => {}
            Inst::Op(op, operands) => self.define_op(value, *op, *operands, position),
            Inst::Load(table, index) => {
                let index_place = self.place(*index);
                self.release(&[*index], position);
                let destination = self.allocate(value);
                let table = Place {
                    bank: 0,
                    frame: Frame::Constants,
                    index: *table,
                };
                self.step(Code::Load, destination, [index_place, table, index_place]);
            }
            Inst::Call(callee, arguments) => self.define_call(value, *callee, arguments, position),
            Inst::Fold {
                function,
                count,
                init,
                captures,
            } => {
                self.define_fold(value, *function, *count, [init, captures], position);
            }
        }
    }

    fn define_op(&mut self, value: Value, op: Op, operands: [Value; 3], position: usize) {
        let [a, b, _] = operands;
        if matches!(op, Op::CastU | Op::CastI) && self.last_use[a.index()] == Some(position) {
            let place = self.place(a);
            if place.frame != Frame::Constants {
                // The same bits in the same bank: the register changes its owner.
                self.places[value.index()] = Some(place);
                return;
            }
        }
        let (code, operands): (Code, Vec<Value>) = match op {
            Op::Add | Op::Sub if self.merged[a.index()] || self.merged[b.index()] => {
                let (product, other) = if self.merged[a.index()] {
                    (a, b)
                } else {
                    (b, a)
                };
                let code = match op {
                    Op::Add => Code::MulAdd,
                    _ if product == a => Code::MulSub,
                    _ => Code::SubMul,
                };
                let mut factors = Vec::with_capacity(3);
                self.function.inst(product).operands(|v| factors.push(v));
                factors.push(other);
                (code, factors)
            }
            _ => (op.into(), operands[..op.info().operands.len()].to_vec()),
        };
        let places: Vec<Place> = operands.iter().map(|&v| self.place(v)).collect();
        self.release(&operands, position);
        let destination = self.allocate(value);
        let place = |i: usize| places.get(i).copied().unwrap_or(places[0]);
        self.step(code, destination, [place(0), place(1), place(2)]);
    }

    /// The places of the results. A body's results become its state one after the other, so none
    /// may be the parameter of another state.
    fn results(&mut self) -> Vec<Place> {
        let parameters = parameter_places(self.function, self.id);
        let function = self.function;
        let mut places = Vec::with_capacity(function.results.len());
        for (i, &(_, value)) in function.results.iter().enumerate() {
            let mut place = self.place(value);
            let state = parameters.iter().skip(1).take(function.results.len());
            if self.is_body && state.enumerate().any(|(k, &p)| p == place && k != i) {
                let own = self.fresh(function.ty(value));
                self.transfer(place, own, true);
                place = own;
            }
            places.push(place);
        }
        places
    }

    fn step(&mut self, code: Code, destination: Place, operands: [Place; 3]) {
        self.block.push(Step {
            code,
            destination,
            operands,
        });
    }

    fn flush(&mut self) {
        if !self.block.is_empty() {
            self.nodes.push(Node::Block(take(&mut self.block).into()));
        }
    }

    fn take_nodes(&mut self) -> Vec<Node<Place>> {
        self.flush();
        take(&mut self.nodes)
    }

    fn place(&self, value: Value) -> Place {
        self.places[value.index()].expect("a value is defined before it is used")
    }

    fn fresh(&mut self, ty: Type) -> Place {
        let bank = bank(ty);
        Place {
            bank,
            frame: Frame::Function(self.id),
            index: self.pools[bank].take(),
        }
    }

    fn allocate(&mut self, value: Value) -> Place {
        let place = self.fresh(self.function.ty(value));
        self.places[value.index()] = Some(place);
        place
    }

    /// Frees the registers of the values that are read for the last time.
    fn release(&mut self, values: &[Value], position: usize) {
        for (i, &value) in values.iter().enumerate() {
            let place = self.place(value);
            if self.last_use[value.index()] == Some(position)
                && place.frame != Frame::Constants
                && !values[..i].contains(&value)
            {
                self.pools[place.bank].free.push(place.index);
            }
        }
    }
}
