//! The statements and expressions of a function.

use super::Writer;
use crate::ir::{FunctionId, Inst, Op, Value};
use crate::wgsl::expression::{Form, form, level, push_constant, push_number};
use crate::wgsl::name::push_letters;
use crate::wgsl::statement::{self, Count, is_single};

impl Writer<'_, '_> {
    pub(super) fn statement(&mut self, value: Value) {
        let inst = self.function.inst(value);
        let of = match inst {
            Inst::Result(of, _) => *of,
            _ => value,
        };
        if let Inst::Fold { count, .. } = self.function.inst(of) {
            let turns = statement::count(self.function, *count);
            if turns != Count::Once {
                return self.fold(value, of, turns);
            }
        }
        self.hide_constant(inst);
        self.push("    let ");
        self.local_name(value);
        self.push(" = ");
        self.definition(value, level::ANY);
        self.push(";\n");
        self.hidden = None;
    }

    /// Makes an op of nothing but constants opaque to WGSL's constant evaluation, which rejects
    /// results that are not finite: the first operand becomes a variable.
    fn hide_constant(&mut self, inst: &Inst) {
        let Inst::Op(op, operands) = inst else { return };
        let operands = &operands[..op.info().operands.len()];
        if operands
            .iter()
            .any(|&v| self.function.constant(v).is_none())
        {
            return;
        }
        self.generated += 1;
        let number = self.generated;
        self.push("    var t_");
        push_letters(&mut self.context.out, number - 1);
        self.push(" = ");
        self.operand(operands[0], level::ANY);
        self.push(";\n");
        self.hidden = Some((operands[0], number));
    }

    fn fold(&mut self, value: Value, of: Value, turns: Count) {
        let Inst::Fold {
            function: callee,
            init,
            captures,
            ..
        } = self.function.inst(of)
        else {
            unreachable!("the caller has seen a fold");
        };
        let results = self.signature(*callee).results.clone();
        self.push("    var ");
        self.local_name(value);
        self.push(" = ");
        if let Some(results) = &results {
            self.push(results);
            self.push("(");
        }
        for (index, &state) in init.iter().enumerate() {
            self.push(if index == 0 { "" } else { ", " });
            self.operand(state, level::ARGUMENT);
        }
        self.push(if results.is_some() { ");\n" } else { ";\n" });
        match turns {
            Count::Once => unreachable!("a fold of one turn is a call"),
            Count::If(condition) => {
                self.push("    if ");
                self.operand(condition, level::ANY);
            }
            Count::Unless(condition) => {
                self.push("    if !");
                self.operand(condition, level::PRIMARY);
            }
            Count::Times(count) if self.function.constant(count).is_some() => {
                self.push("    for (var i = 0u; i < ");
                self.operand(count, level::SUM);
                self.push("; i++)");
            }
            // A device that masks its lanes instead of branching runs the body of a loop that is
            // left at its top once more, for nothing.
            Count::Times(count) => {
                self.push("    if 0u < ");
                self.operand(count, level::SUM);
                self.push(" { for (var i = 0u; ; )");
            }
        }
        self.push(" {\n        ");
        self.local_name(value);
        self.push(" = ");
        self.open_call(*callee);
        self.push(if matches!(turns, Count::Times(_)) {
            "i"
        } else {
            "0u"
        });
        for index in 0..init.len() {
            self.push(", ");
            self.local_name(value);
            if results.is_some() {
                self.push(".");
                self.field(*callee, index);
            }
        }
        for &capture in captures {
            self.push(", ");
            self.operand(capture, level::ARGUMENT);
        }
        self.close_call(*callee);
        self.push(";\n");
        match turns {
            Count::Times(count) if self.function.constant(count).is_none() => {
                self.push("        i++;\n        if i >= ");
                self.operand(count, level::SUM);
                self.push(" { break; }\n    } }\n");
            }
            _ => self.push("    }\n"),
        }
    }

    /// The text that defines `value`, in parentheses if its place binds tighter.
    fn definition(&mut self, value: Value, place: u8) {
        match self.function.inst(value) {
            Inst::Op(op, operands) => self.op(*op, operands, place),
            Inst::Load(table, index) => self.load(*table, *index),
            Inst::Result(of, _) => self.call(*of),
            Inst::Call(..) | Inst::Fold { .. } => self.call(value),
            Inst::Const(_) | Inst::Param(_) => {
                unreachable!("constants and parameters have no definition")
            }
        }
    }

    fn op(&mut self, op: Op, operands: &[Value; 3], place: u8) {
        match form(op) {
            Form::Infix {
                operator,
                level,
                left,
                right,
                chains,
            } => {
                let parentheses = *level < place;
                self.push(if parentheses { "(" } else { "" });
                let same = self.statements.inlined[operands[0].index()]
                    && matches!(self.function.inst(operands[0]), Inst::Op(o, _) if *o == op);
                self.operand(operands[0], if *chains && same { *level } else { *left });
                self.push(operator);
                match (op, self.function.constant(operands[1])) {
                    (Op::ShlU | Op::ShrU | Op::ShrI, Some(by)) => {
                        // WGSL rejects constant shifts by 32 or more; the op takes the low bits.
                        push_number(&mut self.context.out, by.bits & 31);
                        self.push("u");
                    }
                    _ => self.operand(operands[1], *right),
                }
                self.push(if parentheses { ")" } else { "" });
            }
            Form::Prefix(operator) => {
                let parentheses = level::UNARY < place;
                self.push(if parentheses { "(" } else { "" });
                self.push(operator);
                self.operand(operands[0], level::PRIMARY);
                self.push(if parentheses { ")" } else { "" });
            }
            Form::Call(pieces) => {
                for (text, operand) in pieces {
                    self.push(text);
                    if let Some(operand) = operand {
                        self.operand(operands[*operand], level::ARGUMENT);
                    }
                }
            }
        }
    }

    fn load(&mut self, table: u32, index: Value) {
        let offset = self.context.table_offsets[table as usize];
        let last = self.context.module.tables[table as usize].data.len() as u32 - 1;
        let (before, behind) = self.context.tables.around();
        self.push(&before);
        if let Some(index) = self.function.constant(index) {
            push_number(&mut self.context.out, offset + index.bits.min(last));
            self.push("u");
            self.push(behind);
            return;
        }
        if offset > 0 {
            push_number(&mut self.context.out, offset);
            self.push("u + ");
        }
        self.push("min(");
        self.operand(index, level::ARGUMENT);
        self.push(", ");
        push_number(&mut self.context.out, last);
        self.push("u)");
        self.push(behind);
    }

    /// A call, or a fold of one turn.
    fn call(&mut self, call: Value) {
        match self.function.inst(call) {
            Inst::Call(callee, arguments) => {
                self.open_call(*callee);
                for (index, &argument) in arguments.iter().enumerate() {
                    self.push(if index == 0 { "" } else { ", " });
                    self.operand(argument, level::ARGUMENT);
                }
                self.close_call(*callee);
            }
            Inst::Fold {
                function: callee,
                init,
                captures,
                ..
            } => {
                self.open_call(*callee);
                self.push("0u");
                for &argument in init.iter().chain(captures) {
                    self.push(", ");
                    self.operand(argument, level::ARGUMENT);
                }
                self.close_call(*callee);
            }
            _ => unreachable!("a result is of a call or a fold"),
        }
    }

    fn open_call(&mut self, callee: FunctionId) {
        let signature = self.context.signatures[callee.index()].as_ref();
        let signature = signature.expect("a callee is reached");
        self.context.out.push_str(&signature.name);
        self.context.out.push('(');
        if self.context.tables.is_argument_of(callee) {
            let is_only = self.context.module.function(callee).params.is_empty();
            self.push_tables_argument(is_only);
        }
        let signature = self.context.signatures[callee.index()].as_ref();
        let signature = signature.expect("a callee is reached");
        if let Some(packed) = &signature.packed {
            self.context.out.push_str(packed);
            self.context.out.push('(');
        }
    }

    fn close_call(&mut self, callee: FunctionId) {
        let packed = self.signature(callee).packed.is_some();
        self.push(if packed { "))" } else { ")" });
    }

    /// A value where it is read: a literal, a name, or its definition.
    pub(super) fn operand(&mut self, value: Value, place: u8) {
        if let Inst::Const(constant) = self.function.inst(value) {
            if let Some((hidden, number)) = self.hidden
                && hidden == value
            {
                self.push("t_");
                push_letters(&mut self.context.out, number - 1);
                return;
            }
            let start = self.context.out.len();
            if push_constant(&mut self.context.out, *constant) < place {
                self.context.out.insert(start, '(');
                self.push(")");
            }
            return;
        }
        let is_field = match self.function.inst(value) {
            Inst::Result(of, _) => !is_single(self.context.module, self.function.inst(*of)),
            _ => false,
        };
        if self.statements.inlined[value.index()] && !is_field {
            self.definition(value, place);
        } else {
            self.name(value);
        }
    }
}
