//! Building functions: hash-consing, constant folding and algebraic simplification on the way in.
//!
//! # Laws of the simplifications
//! Every rewrite keeps the value for finite operands, to the bit but for the sign of zero:
//! - `x + 0 = x`, `x − 0 = x`, `0 − x = −x`, `x − x = 0`, `x · 1 = x`, `x · 0 = 0`, `x · −1 = −x`,
//!   `x / 1 = x`, `x / 2ⁿ = x · 2⁻ⁿ`, `−(−x) = x`, `a + (−b) = a − b`, `a − (−b) = a + b`
//! - `min(x, x) = max(x, x) = x`, `select(true, a, b) = a`, `select(c, a, a) = a`
//! - an op of constants is the constant that its row of the table gives in f32
//! - sums and products are commutative: operands are ordered, so both spellings are one value
//! - a call of no effect does not exist: results alone keep a call alive (dead code is removed when
//!   the function is finished)

use super::prune::without_dead_code;
use super::{
    Body, Constant, Function, FunctionId, FunctionRef, Inst, Label, Module, Numbers, Op, Parameter,
    Table, Type, Value, op::fold_constants,
};
use hashbrown::{HashTable, hash_table::Entry};
use rustc_hash::FxBuildHasher;
use std::hash::BuildHasher;

/// A definition in the table of those that are known: with its hash, which tells most others apart
/// without a look at them.
#[derive(Debug)]
struct Known {
    hash: u64,
    value: u32,
}

/// A function under construction.
#[derive(Debug)]
pub(super) struct Core {
    name: String,
    function: Body,
    /// The definitions by their hash: equal instructions are found, not stored twice.
    cons: HashTable<Known>,
    /// Constants that were asked for, by their bits: found without a look at the table.
    recent: [Option<(Constant, Value)>; 32],
}

impl Core {
    /// An empty function; `doc` is one sentence.
    pub(super) fn new(name: impl Into<String>, doc: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            function: Body {
                doc: doc.into(),
                ..Body::default()
            },
            cons: HashTable::new(),
            recent: [None; 32],
        }
    }

    /// Room for so many instructions.
    pub(super) fn with_capacity(mut self, instructions: usize) -> Self {
        self.function.insts.reserve(instructions);
        self.function.types.reserve(instructions);
        self.function.names.reserve(instructions / 4);
        self.cons.reserve(instructions, |known| known.hash);
        self
    }

    /// A further parameter.
    pub(super) fn param(&mut self, name: impl Into<String>, ty: Type) -> Value {
        let index = self.function.params.len() as u32;
        self.function.params.push(Parameter {
            name: name.into(),
            ty,
        });
        self.push(Inst::Param(index), ty)
    }

    /// Gives a value a readable name, unless it is a constant or a parameter or has a name.
    pub(super) fn name(&mut self, value: Value, name: impl Into<Label>) {
        if !matches!(self.function.inst(value), Inst::Const(_) | Inst::Param(_)) {
            self.function
                .names
                .entry(value)
                .or_insert_with(|| name.into());
        }
    }

    /// A further result.
    pub(super) fn result(&mut self, name: impl Into<String>, value: Value) {
        self.function.results.push((name.into(), value));
    }

    /// Adds the function to `module`, without the instructions that no result needs.
    pub(super) fn finish(self, module: &mut Module) -> FunctionRef {
        let function = self.finished();
        let results = function.result_types();
        module.functions.push(function);
        FunctionRef {
            id: FunctionId(module.functions.len() as u32 - 1),
            results,
        }
    }

    /// The function without the instructions that no result needs.
    pub(super) fn finished(self) -> Function {
        Function::new(self.name, without_dead_code(self.function))
    }

    /// The type of a value.
    pub(super) fn ty(&self, value: Value) -> Type {
        self.function.ty(value)
    }

    /// The f32 constant that a value is, if it is one.
    pub(super) fn as_constant(&self, value: Value) -> Option<f32> {
        self.function.constant(value).and_then(Constant::as_f32)
    }

    /// The constant that a value is, if it is one.
    pub(super) fn constant_of(&self, value: Value) -> Option<Constant> {
        self.function.constant(value)
    }

    fn push(&mut self, inst: Inst, ty: Type) -> Value {
        let insts = &mut self.function.insts;
        let hash = FxBuildHasher.hash_one(&inst);
        let entry = self.cons.entry(
            hash,
            |known| known.hash == hash && insts[known.value as usize] == inst,
            |known| known.hash,
        );
        match entry {
            Entry::Occupied(known) => Value(known.get().value),
            Entry::Vacant(place) => {
                let value = insts.len() as u32;
                place.insert(Known { hash, value });
                insts.push(inst);
                self.function.types.push(ty);
                Value(value)
            }
        }
    }

    pub(super) fn constant(&mut self, ty: Type, bits: u32) -> Value {
        let constant = Constant { ty, bits };
        // Formulas name the same few numbers again and again.
        let slot = (bits.wrapping_mul(0x9e37_79b9) >> 27) as usize;
        if let Some((known, value)) = self.recent[slot]
            && known == constant
        {
            return value;
        }
        let value = self.push(Inst::Const(constant), ty);
        self.recent[slot] = Some((constant, value));
        value
    }

    /// An f32 constant. −0 becomes 0.
    pub(super) fn f32(&mut self, x: f32) -> Value {
        self.constant(Type::F32, (x + 0.0).to_bits())
    }

    /// An op of the table, simplified.
    ///
    /// # Panics
    /// If the operands' number or types are not the table's: a bug of the caller.
    pub(super) fn op(&mut self, op: Op, operands: &[Value]) -> Value {
        let info = op.info();
        assert_eq!(
            operands.len(),
            info.operands.len(),
            "operands of {}",
            info.name
        );
        // Expressions have the types of the table already.
        debug_assert!(
            (operands.iter().zip(info.operands)).all(|(&value, &ty)| self.ty(value) == ty),
            "operands of {} in {}",
            info.name,
            self.name
        );
        let padded = match *operands {
            [a] => [a; 3],
            [a, b] => [a, b, a],
            [a, b, c] => [a, b, c],
            _ => unreachable!("ops take up to three operands"),
        };
        if let Some(value) = self.simplified(op, padded) {
            return value;
        }
        self.ordered(op, padded)
    }

    /// An op whose every bit is kept: constants alone are folded, and real results only with
    /// `folds`, since they are computed in f32.
    pub(super) fn exact(&mut self, op: Op, operands: [Value; 3], folds: bool) -> Value {
        let ty = op.info().result;
        if (folds || ty != Type::F32)
            && let Some(bits) = self.folded(op, operands)
            && (ty != Type::F32 || f32::from_bits(bits).is_finite())
        {
            return self.constant(ty, bits);
        }
        self.ordered(op, operands)
    }

    fn ordered(&mut self, op: Op, mut operands: [Value; 3]) -> Value {
        if is_commutative(op) && operands[0] > operands[1] {
            operands.swap(0, 1);
            operands[2] = operands[0];
        }
        self.push(Inst::Op(op, operands), op.info().result)
    }

    /// The bits of an op of constants.
    fn folded(&self, op: Op, operands: [Value; 3]) -> Option<u32> {
        let count = op.info().operands.len();
        let mut bits = [0; 3];
        for (bits, &operand) in bits.iter_mut().zip(&operands[..count]) {
            *bits = self.function.constant(operand)?.bits;
        }
        Some(fold_constants(op, bits))
    }

    /// What a simpler value an op is, if one of the laws applies.
    fn simplified(&mut self, op: Op, [a, b, c]: [Value; 3]) -> Option<Value> {
        let constants = [a, b, c].map(|v| self.function.constant(v));
        if let [Some(a), Some(b), Some(c)] = constants {
            // Unused places repeat the first operand.
            let result = fold_constants(op, [a.bits, b.bits, c.bits]);
            let ty = op.info().result;
            if ty == Type::F32 {
                let number = f32::from_bits(result);
                return number.is_finite().then(|| self.f32(number));
            }
            return Some(self.constant(ty, result));
        }
        let [x, y, _] = constants.map(|c| c.and_then(Constant::as_f32));
        let negated = |builder: &Self, v: Value| match builder.function.inst(v) {
            Inst::Op(Op::Neg, [inner, ..]) => Some(*inner),
            _ => None,
        };
        match op {
            Op::Add => match (x, y) {
                (Some(0.0), _) => Some(b),
                (_, Some(0.0)) => Some(a),
                _ => match (negated(self, a), negated(self, b)) {
                    (_, Some(inner)) => Some(self.sub(a, inner)),
                    (Some(inner), _) => Some(self.sub(b, inner)),
                    _ => None,
                },
            },
            Op::Sub if a == b => Some(self.f32(0.0)),
            Op::Sub => match (x, y) {
                (_, Some(0.0)) => Some(a),
                (Some(0.0), _) => Some(self.neg(b)),
                _ => negated(self, b).map(|inner| self.add(a, inner)),
            },
            Op::Mul => match (x, y) {
                (Some(0.0), _) | (_, Some(0.0)) => Some(self.f32(0.0)),
                (Some(1.0), _) => Some(b),
                (_, Some(1.0)) => Some(a),
                (Some(-1.0), _) => Some(self.neg(b)),
                (_, Some(-1.0)) => Some(self.neg(a)),
                _ => None,
            },
            Op::Div => match (x, y) {
                (Some(0.0), _) => Some(self.f32(0.0)),
                (_, Some(1.0)) => Some(a),
                (_, Some(d)) if is_power_of_two(d) => {
                    let reciprocal = self.f32(1.0 / d);
                    Some(self.mul(a, reciprocal))
                }
                _ => None,
            },
            Op::Neg => negated(self, a),
            Op::Min | Op::Max | Op::MinI | Op::MaxI | Op::MinU | Op::And | Op::Or if a == b => {
                Some(a)
            }
            Op::And | Op::Or => {
                // The truth value that leaves the other one as it is.
                let neutral = u32::from(op == Op::And);
                let other = |constant: Option<Constant>, kept: Value, known: Value| {
                    constant.map(|c| if c.bits == neutral { kept } else { known })
                };
                other(constants[0], b, a).or_else(|| other(constants[1], a, b))
            }
            Op::AddI | Op::AddU | Op::XorU | Op::OrU => {
                if constants[0].is_some_and(|c| c.bits == 0) {
                    Some(b)
                } else if constants[1].is_some_and(|c| c.bits == 0) {
                    Some(a)
                } else {
                    None
                }
            }
            Op::SubI | Op::SubU | Op::ShlU | Op::ShrU | Op::ShrI
                if constants[1].is_some_and(|c| c.bits == 0) =>
            {
                Some(a)
            }
            Op::MulI | Op::MulU => {
                match (constants[0].map(|c| c.bits), constants[1].map(|c| c.bits)) {
                    (Some(0), _) | (_, Some(1)) => Some(a),
                    (_, Some(0)) | (Some(1), _) => Some(b),
                    _ => None,
                }
            }
            Op::Select | Op::SelectI | Op::SelectU => match constants[0].map(|c| c.bits) {
                Some(0) => Some(c),
                Some(_) => Some(b),
                None if b == c => Some(b),
                None => None,
            },
            _ => None,
        }
    }

    /// `module.tables[table].data[index]`.
    pub(super) fn load(&mut self, table: u32, index: Value) -> Value {
        assert_eq!(self.ty(index), Type::U32, "index of a table");
        self.push(Inst::Load(table, index), Type::F32)
    }

    /// The results of a call.
    pub(super) fn call(&mut self, function: &FunctionRef, arguments: &[Value]) -> Vec<Value> {
        self.call_with(function, arguments.into())
    }

    /// The same with arguments that need not be copied.
    pub(super) fn call_with(
        &mut self,
        function: &FunctionRef,
        arguments: Box<[Value]>,
    ) -> Vec<Value> {
        let inst = Inst::Call(function.id, arguments);
        self.results_of(inst, &function.results)
    }

    /// The last state of a fold: see [`Inst::Fold`].
    pub(super) fn fold(
        &mut self,
        function: &FunctionRef,
        count: Value,
        init: &[Value],
        captures: &[Value],
    ) -> Vec<Value> {
        assert_eq!(init.len(), function.results.len(), "state of a fold");
        assert_eq!(self.ty(count), Type::U32, "count of a fold");
        if self.function.constant(count).is_some_and(|c| c.bits == 0) {
            return init.to_vec();
        }
        let inst = Inst::Fold {
            function: function.id,
            count,
            init: init.into(),
            captures: captures.into(),
        };
        self.results_of(inst, &function.results)
    }

    fn results_of(&mut self, inst: Inst, types: &[Type]) -> Vec<Value> {
        let of = self.push(inst, Type::Bool);
        (0u32..)
            .zip(types)
            .map(|(i, &ty)| self.push(Inst::Result(of, i), ty))
            .collect()
    }
}

/// Shorthands for the rows of the op table.
macro_rules! shorthands {
    ($($name:ident $op:ident ($($p:ident),*);)*) => {
        impl Core {
            $(#[doc = concat!("[`Op::", stringify!($op), "`].")]
            pub(super) fn $name(&mut self, $($p: Value),*) -> Value {
                self.op(Op::$op, &[$($p),*])
            })*
        }
    };
}
shorthands! {
    add Add (a, b); sub Sub (a, b); mul Mul (a, b); neg Neg (a);
}

impl Module {
    /// A further table; returns its index for [`Builder::load`](super::Builder::load). Equal data is stored once.
    pub fn table(&mut self, name: impl Into<String>, data: impl Into<Numbers>) -> u32 {
        let (name, data) = (name.into(), data.into());
        let same = |t: &Table| t.name == name && t.data == data;
        if let Some(same) = self.tables.iter().position(same) {
            return same as u32;
        }
        self.push_table(name, data)
    }

    /// A further table, whatever others hold.
    pub fn push_table(&mut self, name: impl Into<String>, data: Numbers) -> u32 {
        assert!(!data.is_empty(), "a table has numbers");
        self.tables.push(Table {
            name: name.into(),
            data,
        });
        self.tables.len() as u32 - 1
    }
}

fn is_commutative(op: Op) -> bool {
    matches!(
        op,
        Op::Add
            | Op::Mul
            | Op::And
            | Op::Or
            | Op::AddI
            | Op::MulI
            | Op::EqI
            | Op::AndI
            | Op::AddU
            | Op::MulU
            | Op::AndU
            | Op::OrU
            | Op::XorU
            | Op::EqU
    )
}

fn is_power_of_two(x: f32) -> bool {
    x.is_normal() && (1.0 / x).is_normal() && x.to_bits() & 0x007f_ffff == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_definitions_are_one_value_and_dead_ones_go() {
        let mut b = Core::new("f", "A test.");
        let [x, y] = ["x", "y"].map(|name| b.param(name, Type::F32));
        let (s, t) = (b.add(x, y), b.add(y, x));
        assert_eq!(s, t);
        let zero = b.f32(0.0);
        assert_eq!(b.mul(x, zero), zero);
        assert_eq!(b.add(x, zero), x);
        b.op(Op::Exp, &[x]);
        b.result("out", s);
        let mut module = Module::default();
        b.finish(&mut module);
        assert_eq!(module.entry().insts.len(), 3);
    }

    #[test]
    fn a_fold_of_no_turns_is_its_initial_state() {
        let mut module = Module::default();
        let mut body = Core::new("body", "A test.");
        body.param("index", Type::U32);
        let state = body.param("state", Type::F32);
        let one = body.f32(1.0);
        let next = body.add(state, one);
        body.result("state", next);
        let body = body.finish(&mut module);
        let mut b = Core::new("f", "A test.");
        let (none, x) = (b.constant(Type::U32, 0), b.param("x", Type::F32));
        assert_eq!(b.fold(&body, none, &[x], &[]), vec![x]);
    }
}
