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
    Body, Constant, Function, FunctionId, FunctionRef, Inst, Label, Library, Module, Numbers, Op,
    Parameter, Table, Type, Value, op::fold_constants,
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
pub struct Builder {
    name: String,
    function: Body,
    /// The definitions by their hash: equal instructions are found, not stored twice.
    cons: HashTable<Known>,
    /// The functions that the module's functions share, where it has any.
    pub(super) library: Option<Library>,
}

impl Builder {
    /// An empty function; `doc` is one sentence.
    pub fn new(name: impl Into<String>, doc: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            function: Body {
                doc: doc.into(),
                ..Body::default()
            },
            cons: HashTable::new(),
            library: None,
        }
    }

    /// Room for so many instructions.
    pub(crate) fn with_capacity(mut self, instructions: usize) -> Self {
        self.function.insts.reserve(instructions);
        self.function.types.reserve(instructions);
        self.function.names.reserve(instructions / 4);
        self.cons.reserve(instructions, |known| known.hash);
        self
    }

    /// Shared rules become calls of functions of `library` from here on.
    pub(crate) fn with_library(mut self, library: Library) -> Self {
        self.library = Some(library);
        self
    }

    /// Whether shared rules are calls.
    pub(crate) fn has_library(&self) -> bool {
        self.library.is_some()
    }

    /// The functions that the module's functions share.
    pub(crate) fn library(&self) -> Option<&Library> {
        self.library.as_ref()
    }

    /// A further parameter.
    pub fn param(&mut self, name: impl Into<String>, ty: Type) -> Value {
        let index = self.function.params.len() as u32;
        self.function.params.push(Parameter {
            name: name.into(),
            ty,
        });
        self.push(Inst::Param(index), ty)
    }

    /// A further f32 parameter.
    pub fn param_f32(&mut self, name: impl Into<String>) -> Value {
        self.param(name, Type::F32)
    }

    /// Gives a value a readable name, unless it is a constant or a parameter or has a name.
    pub fn name(&mut self, value: Value, name: impl Into<Label>) {
        if !matches!(self.function.inst(value), Inst::Const(_) | Inst::Param(_)) {
            self.function
                .names
                .entry(value)
                .or_insert_with(|| name.into());
        }
    }

    /// A further result.
    pub fn result(&mut self, name: impl Into<String>, value: Value) {
        self.function.results.push((name.into(), value));
    }

    /// Adds the function to `module`, without the instructions that no result needs.
    pub fn finish(self, module: &mut Module) -> FunctionRef {
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
    pub fn ty(&self, value: Value) -> Type {
        self.function.ty(value)
    }

    /// The f32 constant that a value is, if it is one.
    pub fn as_constant(&self, value: Value) -> Option<f32> {
        self.function.constant(value).and_then(Constant::as_f32)
    }

    /// The constant that a value is, if it is one.
    pub(super) fn constant_of(&self, value: Value) -> Option<Constant> {
        self.function.constant(value)
    }

    /// Whether a value is the f32 constant 0.
    pub fn is_zero(&self, value: Value) -> bool {
        self.as_constant(value) == Some(0.0)
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
        self.push(Inst::Const(Constant { ty, bits }), ty)
    }

    /// An f32 constant. −0 becomes 0.
    pub fn f32(&mut self, x: f32) -> Value {
        self.constant(Type::F32, (x + 0.0).to_bits())
    }

    /// An i32 constant.
    pub fn i32(&mut self, x: i32) -> Value {
        self.constant(Type::I32, x as u32)
    }

    /// A u32 constant.
    pub fn u32(&mut self, x: u32) -> Value {
        self.constant(Type::U32, x)
    }

    /// A truth value.
    pub fn bool(&mut self, x: bool) -> Value {
        self.constant(Type::Bool, u32::from(x))
    }

    /// An op of the table, simplified.
    ///
    /// # Panics
    /// If the operands' number or types are not the table's: a bug of the caller.
    pub fn op(&mut self, op: Op, operands: &[Value]) -> Value {
        let info = op.info();
        assert_eq!(
            operands.len(),
            info.operands.len(),
            "operands of {}",
            info.name
        );
        let mut padded = [operands[0]; 3];
        padded[..operands.len()].copy_from_slice(operands);
        for (&value, &ty) in operands.iter().zip(info.operands) {
            assert_eq!(
                self.ty(value),
                ty,
                "operand of {} in {}",
                info.name,
                self.name
            );
        }
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
    pub fn load(&mut self, table: u32, index: Value) -> Value {
        assert_eq!(self.ty(index), Type::U32, "index of a table");
        self.push(Inst::Load(table, index), Type::F32)
    }

    /// The results of a call.
    pub fn call(&mut self, function: &FunctionRef, arguments: &[Value]) -> Vec<Value> {
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
    pub fn fold(
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
        impl Builder {
            $(#[doc = concat!("[`Op::", stringify!($op), "`].")]
            pub fn $name(&mut self, $($p: Value),*) -> Value {
                self.op(Op::$op, &[$($p),*])
            })*
        }
    };
}
shorthands! {
    add Add (a, b); sub Sub (a, b); mul Mul (a, b); div Div (a, b); neg Neg (a);
    abs Abs (a); min Min (a, b); max Max (a, b); floor Floor (a); sqrt Sqrt (a);
    exp Exp (a); ln Ln (a); sin Sin (a); cos Cos (a); high High (a);
    lt Lt (a, b); le Le (a, b); and And (a, b); or Or (a, b); not Not (a);
    add_i AddI (a, b); sub_i SubI (a, b); mul_i MulI (a, b); min_i MinI (a, b); max_i MaxI (a, b);
    lt_i LtI (a, b); eq_i EqI (a, b); and_i AndI (a, b); shr_i ShrI (a, b);
    add_u AddU (a, b); sub_u SubU (a, b); mul_u MulU (a, b); min_u MinU (a, b);
    and_u AndU (a, b); or_u OrU (a, b); xor_u XorU (a, b); shl_u ShlU (a, b); shr_u ShrU (a, b);
    lt_u LtU (a, b); eq_u EqU (a, b);
    float_i FloatI (a); float_u FloatU (a); trunc_i TruncI (a); bits Bits (a);
    cast_u CastU (a); cast_i CastI (a);
}

impl Builder {
    /// `b` where `condition` holds, else `c`: the select of their type.
    pub fn select(&mut self, condition: Value, b: Value, c: Value) -> Value {
        let op = match self.ty(b) {
            Type::F32 => Op::Select,
            Type::I32 => Op::SelectI,
            Type::U32 => Op::SelectU,
            Type::Bool => {
                let (yes, no) = (self.and(condition, b), self.not(condition));
                let otherwise = self.and(no, c);
                return self.or(yes, otherwise);
            }
        };
        self.op(op, &[condition, b, c])
    }

    /// The product with a constant.
    pub fn scale(&mut self, a: Value, by: f32) -> Value {
        let by = self.f32(by);
        self.mul(a, by)
    }

    /// The sum with a constant.
    pub fn offset(&mut self, a: Value, by: f32) -> Value {
        let by = self.f32(by);
        self.add(a, by)
    }

    /// A bijection of 32-bit words without visible structure (Wellons's lowbias32), the hash of all
    /// noises and samples.
    pub fn scramble(&mut self, mut x: Value) -> Value {
        for (shift, factor) in [(16, 0x7feb_352d), (15, 0x846c_a68b), (16, 1)] {
            let by = self.u32(shift);
            let shifted = self.shr_u(x, by);
            x = self.xor_u(x, shifted);
            let factor = self.u32(factor);
            x = self.mul_u(x, factor);
        }
        x
    }

    /// The square.
    pub fn square(&mut self, a: Value) -> Value {
        self.mul(a, a)
    }

    /// The sum of products `Σ aᵢ bᵢ`.
    pub fn dot(&mut self, a: &[Value], b: &[Value]) -> Value {
        let mut sum = self.f32(0.0);
        for (&x, &y) in a.iter().zip(b) {
            let product = self.mul(x, y);
            sum = self.add(sum, product);
        }
        sum
    }

    /// Limits to `[low, high]`, constants.
    pub fn clamp(&mut self, a: Value, low: f32, high: f32) -> Value {
        let (low, high) = (self.f32(low), self.f32(high));
        let a = self.max(a, low);
        self.min(a, high)
    }
}

impl Module {
    /// A further table; returns its index for [`Builder::load`]. Equal data is stored once.
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
        let mut b = Builder::new("f", "A test.");
        let (x, y) = (b.param_f32("x"), b.param_f32("y"));
        let (s, t) = (b.add(x, y), b.add(y, x));
        assert_eq!(s, t);
        let zero = b.f32(0.0);
        assert_eq!(b.mul(x, zero), zero);
        assert_eq!(b.add(x, zero), x);
        b.exp(x);
        b.result("out", s);
        let mut module = Module::default();
        b.finish(&mut module);
        assert_eq!(module.entry().insts.len(), 3);
    }

    #[test]
    fn a_fold_of_no_turns_is_its_initial_state() {
        let mut module = Module::default();
        let mut body = Builder::new("body", "A test.");
        body.param("index", Type::U32);
        let state = body.param_f32("state");
        let next = body.offset(state, 1.0);
        body.result("state", next);
        let body = body.finish(&mut module);
        let mut b = Builder::new("f", "A test.");
        let (zero, x) = (b.u32(0), b.param_f32("x"));
        assert_eq!(b.fold(&body, zero, &[x], &[]), vec![x]);
    }
}
