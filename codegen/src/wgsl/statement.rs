//! Which values of a function become statements, and which are written inside their only reader.
//!
//! Every instruction is pure and total, so any value may be written where it is read. It is, when
//! it has one reader, no name, and the expression stays short; everything else is a statement.

use crate::ir::{Function, Inst, Module, Op, Value};

/// The longest expression, in characters (estimated).
const LONGEST: u32 = 72;
/// An operand farther away than this is a statement, so that values live short lives.
const FARTHEST: usize = 256;
/// The estimated length of a name or literal.
const NAME: u32 = 6;

/// The statements of a function.
#[derive(Debug)]
pub(super) struct Statements {
    /// The values that are statements, in order: ops, loads, results of functions of one result,
    /// and the calls and folds of functions of several.
    pub(super) order: Vec<Value>,
    /// Whether a value is written inside its only reader.
    pub(super) inlined: Vec<bool>,
}

/// How often a fold runs, where that is simpler than a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Count {
    /// Once: a call.
    Once,
    /// Once if the condition holds, else not at all: an `if`.
    If(Value),
    /// Once unless the condition holds.
    Unless(Value),
    /// A loop.
    Times(Value),
}

/// How often a fold with this count runs.
pub(super) fn count(function: &Function, count: Value) -> Count {
    match *function.inst(count) {
        Inst::Const(constant) if constant.bits == 1 => Count::Once,
        Inst::Op(Op::SelectU, [condition, yes, no]) => {
            let bits = [yes, no].map(|v| function.constant(v).map(|c| c.bits));
            match bits {
                [Some(1), Some(0)] => Count::If(condition),
                [Some(0), Some(1)] => Count::Unless(condition),
                _ => Count::Times(count),
            }
        }
        _ => Count::Times(count),
    }
}

/// Whether a call or fold has one result, so that it is written through that result.
pub(super) fn is_single(module: &Module, inst: &Inst) -> bool {
    match inst {
        Inst::Call(callee, _)
        | Inst::Fold {
            function: callee, ..
        } => module.function(*callee).results.len() == 1,
        _ => false,
    }
}

/// Calls `visit` with every value that the text of `value` reads.
fn reads(function: &Function, value: Value, mut visit: impl FnMut(Value)) {
    let inst = function.inst(value);
    let Inst::Fold {
        count: turns,
        init,
        captures,
        ..
    } = inst
    else {
        return inst.operands(visit);
    };
    match count(function, *turns) {
        Count::Once => {}
        Count::If(value) | Count::Unless(value) | Count::Times(value) => visit(value),
    }
    init.iter().chain(captures).for_each(|&v| visit(v));
}

/// Chooses the statements of a function.
pub(super) fn choose(module: &Module, function: &Function) -> Statements {
    let size = function.insts.len();
    let mut readers = vec![0_u32; size];
    for &(_, value) in &function.results {
        readers[value.index()] += 1;
    }
    for index in (0..size).rev() {
        if readers[index] > 0 {
            reads(function, Value::from_index(index), |v| {
                readers[v.index()] += 1
            });
        }
    }

    let mut named = vec![false; size];
    for value in function.names.keys() {
        named[value.index()] = true;
    }
    let mut inlined = vec![false; size];
    let mut length = vec![NAME; size];
    for index in 0..size {
        if readers[index] == 0 {
            continue;
        }
        let value = Value::from_index(index);
        let inst = &function.insts[index];
        let (own, may_inline) = match inst {
            Inst::Const(_) | Inst::Param(_) => continue,
            Inst::Op(op, operands) => (
                op.info().wgsl.len() as u32,
                // Ops of constants only are kept from WGSL's constant evaluation: see the writer.
                !operands.iter().all(|&v| function.constant(v).is_some()),
            ),
            Inst::Load(..) => (24, true),
            Inst::Call(callee, _) => (module.function(*callee).stem().len() as u32 + 12, false),
            Inst::Fold {
                function: callee,
                count: turns,
                captures,
                ..
            } => {
                let turns = count(function, *turns);
                if let Count::Times(value) = turns {
                    inlined[value.index()] = false;
                    captures.iter().for_each(|v| inlined[v.index()] = false);
                }
                (module.function(*callee).stem().len() as u32 + 12, false)
            }
            Inst::Result(of, _) => {
                let call = function.inst(*of);
                inlined[of.index()] = true;
                length[index] = length[of.index()];
                let inline = is_single(module, call)
                    && matches!(call, Inst::Call(..))
                    && readers[index] == 1
                    && !named[index];
                inlined[index] = inline;
                continue;
            }
        };
        let mut total = own;
        let mut count = 0;
        reads(function, value, |v| {
            if inlined[v.index()] && index - v.index() > FARTHEST {
                inlined[v.index()] = false;
            }
            count += 1;
            total += if inlined[v.index()] {
                length[v.index()]
            } else {
                NAME
            };
        });
        // So many names alone are too long.
        if own + NAME * count > LONGEST {
            reads(function, value, |v| inlined[v.index()] = false);
            total = own + NAME * count;
        }
        while total > LONGEST {
            let mut longest = None;
            reads(function, value, |v| {
                let v = v.index();
                if inlined[v] && longest.is_none_or(|l: usize| length[v] > length[l]) {
                    longest = Some(v);
                }
            });
            let Some(longest) = longest else { break };
            inlined[longest] = false;
            total = total - length[longest] + NAME;
        }
        length[index] = total;
        inlined[index] = may_inline && readers[index] == 1 && !named[index];
    }
    for &(_, value) in &function.results {
        if size - value.index() > FARTHEST {
            inlined[value.index()] = false;
        }
    }

    let is_statement = |index: usize| match &function.insts[index] {
        Inst::Const(_) | Inst::Param(_) => false,
        Inst::Op(..) | Inst::Load(..) => !inlined[index],
        inst @ (Inst::Call(..) | Inst::Fold { .. }) => !is_single(module, inst),
        Inst::Result(of, _) => !inlined[index] && is_single(module, function.inst(*of)),
    };
    let order = (0..size)
        .filter(|&index| readers[index] > 0 && is_statement(index))
        .map(Value::from_index)
        .collect();
    Statements { order, inlined }
}

/// Calls `visit` with the values that a statement reads by name: parameters, other statements, and
/// results of calls of several results.
pub(super) fn inputs(
    module: &Module,
    function: &Function,
    inlined: &[bool],
    statement: Value,
    visit: &mut impl FnMut(Value),
) {
    let source = match function.inst(statement) {
        Inst::Result(of, _) => *of,
        _ => statement,
    };
    reads(function, source, |v| {
        named(module, function, inlined, v, visit)
    });
}

/// Calls `visit` with the values that the text of `value` reads by name, itself included.
pub(super) fn named(
    module: &Module,
    function: &Function,
    inlined: &[bool],
    value: Value,
    visit: &mut impl FnMut(Value),
) {
    match function.inst(value) {
        Inst::Const(_) => {}
        Inst::Result(of, _) if !is_single(module, function.inst(*of)) => visit(value),
        _ if inlined[value.index()] => inputs(module, function, inlined, value, visit),
        _ => visit(value),
    }
}
