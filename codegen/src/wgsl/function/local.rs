//! The names of a function's values: made on first use, spelled by where the value is found.

use super::{BARE, ENTRY, GENERATED, OWN, PACKED, PART, Writer};
use crate::ir::{FunctionId, Inst, Value};
use crate::wgsl::name::{internal, looks_generated, push_letters};
use crate::wgsl::statement::is_single;

impl Writer<'_, '_> {
    /// Names every parameter, in order; returns their values, if they are read.
    pub(super) fn name_parameters(&mut self) -> Vec<Option<Value>> {
        let mut values = vec![None; self.function.params.len()];
        for (index, inst) in self.function.insts.iter().enumerate() {
            if let Inst::Param(position) = inst {
                values[*position as usize] = Some(Value::from_index(index));
            }
        }
        for (value, param) in values.iter().zip(&self.function.params) {
            let name = self.fresh(&param.name);
            if let Some(value) = value {
                self.strings.push(name);
                self.locals[value.index()] = self.strings.len() as u32;
            } else {
                // Unread parameters still need their place in the signature.
                self.strings.push(name);
            }
        }
        values
    }

    /// A new local name.
    pub(super) fn fresh(&mut self, text: &str) -> String {
        let mut name = internal(text);
        if looks_generated(&name) || self.context.globals.holds(&name) {
            name.push_str("_value");
        }
        self.scope.take(name)
    }

    /// The name of a value from where the text is now.
    pub(super) fn name(&mut self, value: Value) {
        match self.places[value.index()] {
            OWN => match self.function.inst(value) {
                Inst::Result(of, position)
                    if !is_single(self.context.module, self.function.inst(*of)) =>
                {
                    self.local_name(*of);
                    self.push(".");
                    let (Inst::Call(callee, _)
                    | Inst::Fold {
                        function: callee, ..
                    }) = self.function.inst(*of)
                    else {
                        unreachable!("a result is of a call or a fold");
                    };
                    self.field(*callee, *position as usize);
                }
                _ => self.local_name(value),
            },
            BARE => self.local_name(value),
            PACKED => {
                self.push("args.");
                self.local_name(value);
            }
            ENTRY => {
                let Inst::Param(position) = self.function.inst(value) else {
                    unreachable!("only parameters have the entry's place");
                };
                let entry = self.entry.expect("the entry is being written");
                self.context
                    .out
                    .push_str(&entry.parameters[*position as usize]);
            }
            part => {
                self.push("p_");
                push_letters(&mut self.context.out, part - PART);
                self.push(".");
                self.local_name(value);
            }
        }
    }

    pub(super) fn field(&mut self, callee: FunctionId, index: usize) {
        let signature = self.context.signatures[callee.index()].as_ref();
        let field = &signature.expect("a callee is reached").fields[index];
        self.context.out.push_str(field);
    }

    /// The name that a value has in its own scope, made on first use.
    pub(super) fn local_name(&mut self, value: Value) {
        let index = value.index();
        if self.locals[index] == 0 {
            self.locals[index] = self.make_name(value);
        }
        let local = self.locals[index];
        if local & GENERATED != 0 {
            self.push("t_");
            push_letters(&mut self.context.out, (local & !GENERATED) - 1);
        } else {
            self.context.out.push_str(&self.strings[local as usize - 1]);
        }
    }

    fn make_name(&mut self, value: Value) -> u32 {
        let function = self.function;
        let text =
            if let Some(name) = function.names.get(&value) {
                Some(name.to_string())
            } else {
                let (call, of_call) = match function.inst(value) {
                    Inst::Result(of, _) if is_single(self.context.module, function.inst(*of)) => {
                        (*of, false)
                    }
                    Inst::Call(..) | Inst::Fold { .. } => (value, true),
                    _ => (value, false),
                };
                match function.inst(call) {
                    Inst::Call(callee, _)
                    | Inst::Fold {
                        function: callee, ..
                    } => {
                        let stem = if of_call {
                            self.common_stem(value, *callee)
                        } else {
                            None
                        };
                        Some(stem.unwrap_or_else(|| {
                            self.context.module.function(*callee).stem().to_owned()
                        }))
                    }
                    _ => None,
                }
            };
        if let Some(text) = text {
            let name = self.fresh(&text);
            self.strings.push(name);
            self.strings.len() as u32
        } else {
            self.generated += 1;
            self.generated | GENERATED
        }
    }

    /// `swirl`, where the results of a call are named `swirl_mean`, …: the results of the builder
    /// follow their call.
    fn common_stem(&self, call: Value, callee: FunctionId) -> Option<String> {
        let fields = &self.context.module.function(callee).results;
        (call.index() + 1
            ..self
                .function
                .insts
                .len()
                .min(call.index() + 1 + fields.len()))
            .map_while(|index| match self.function.insts[index] {
                Inst::Result(of, position) if of == call => Some((index, position)),
                _ => None,
            })
            .find_map(|(index, position)| {
                let name = self.function.names.get(&Value::from_index(index))?;
                let name = name.to_string();
                let stem = name.strip_suffix(fields[position as usize].0.as_str())?;
                let stem = stem.strip_suffix('_')?;
                (!stem.is_empty()).then(|| stem.to_owned())
            })
    }
}
