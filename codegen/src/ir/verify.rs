//! The verifier: what every module keeps, whoever made it.
//!
//! [`verify`] checks that
//! 1. a module has a function, and names of functions and of tables are unique;
//! 2. a function has at least one result, and the names of its parameters are unique;
//! 3. every instruction has a type, and every operand comes before its user;
//! 4. operands and results of ops have the types of the op table, and constants, parameters and
//!    results of calls the type that their definition says;
//! 5. parameters exist; truth values are 0 or 1; real constants are finite, as WGSL has no others;
//! 6. calls and folds name functions of smaller ids, with arguments of the right number and types;
//! 7. a fold's function takes (index: u32, state…, captures…) and returns the state, and its count
//!    is u32;
//! 8. [`Inst::Result`] is of a call or fold and in its range, and nothing else reads a call or fold;
//! 9. loads name tables that exist, by u32 indices;
//! 10. tables have numbers, all finite.

use super::{Constant, Function, FunctionId, Inst, Module, Type, Value};
use rustc_hash::FxHashSet;
use std::fmt;

/// A broken invariant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The function's name, if it is of a function.
    pub function: Option<String>,
    /// The instruction, if it is of one.
    pub value: Option<Value>,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(function) = &self.function {
            write!(f, "{function}: ")?;
        }
        if let Some(value) = self.value {
            write!(f, "%{}: ", value.index())?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for Violation {}

/// Checks all invariants of a module: see the module's documentation.
///
/// # Errors
/// Every violation found, in the order of the module.
pub fn verify(module: &Module) -> Result<(), Vec<Violation>> {
    let mut violations = Vec::new();
    let mut global = |message: String| {
        violations.push(Violation {
            function: None,
            value: None,
            message,
        });
    };
    if module.functions.is_empty() {
        global("there is no function".to_owned());
    }
    let mut names = FxHashSet::default();
    for function in &module.functions {
        if !names.insert(function.name.as_str()) {
            global(format!("two functions are called {:?}", function.name));
        }
    }
    names.clear();
    for table in &module.tables {
        if !names.insert(table.name.as_str()) {
            global(format!("two tables are called {:?}", table.name));
        }
        if table.data.is_empty() {
            global(format!("the table {:?} is empty", table.name));
        }
        if let Some(x) = table.data.iter().find(|x| !x.is_finite()) {
            global(format!("the table {:?} holds {x}", table.name));
        }
    }
    for (id, function) in module.functions.iter().enumerate() {
        Checker {
            module,
            id,
            function,
            violations: &mut violations,
        }
        .function();
    }
    if violations.is_empty() {
        Ok(())
    } else {
        Err(violations)
    }
}

struct Checker<'a, 'v> {
    module: &'a Module,
    id: usize,
    function: &'a Function,
    violations: &'v mut Vec<Violation>,
}

impl<'a> Checker<'a, '_> {
    fn report(&mut self, value: Option<Value>, message: String) {
        let function = Some(self.function.name.clone());
        self.violations.push(Violation {
            function,
            value,
            message,
        });
    }

    fn function(&mut self) {
        let function = self.function;
        let mut names = FxHashSet::default();
        for param in &function.params {
            if !names.insert(param.name.as_str()) {
                self.report(None, format!("two parameters are called {:?}", param.name));
            }
        }
        if function.insts.len() != function.types.len() {
            let (insts, types) = (function.insts.len(), function.types.len());
            return self.report(None, format!("{insts} instructions have {types} types"));
        }
        for (index, inst) in function.insts.iter().enumerate() {
            self.inst(Value::from_index(index), inst);
        }
        if function.results.is_empty() {
            self.report(None, "there is no result".to_owned());
        }
        for (name, value) in &function.results {
            if value.index() >= function.insts.len() {
                self.report(None, format!("the result {name:?} is %{}", value.index()));
            } else {
                self.scalar(None, *value);
            }
        }
    }

    /// Reports a value that is a call or a fold, which have no type.
    fn scalar(&mut self, user: Option<Value>, value: Value) {
        if matches!(
            self.function.inst(value),
            Inst::Call(..) | Inst::Fold { .. }
        ) {
            self.report(user, format!("%{} is read, not its results", value.index()));
        }
    }

    fn inst(&mut self, value: Value, inst: &Inst) {
        let mut late = None;
        inst.operands(|v| late = late.or((v >= value).then_some(v)));
        if let Some(late) = late {
            return self.report(
                Some(value),
                format!("reads %{}, defined later", late.index()),
            );
        }
        if !matches!(inst, Inst::Result(..)) {
            inst.operands(|v| self.scalar(Some(value), v));
        }
        match inst {
            Inst::Const(Constant { ty, bits }) => {
                self.is(value, *ty);
                if *ty == Type::Bool && *bits > 1 {
                    self.report(Some(value), format!("a truth value of the bits {bits}"));
                }
                if *ty == Type::F32 && !f32::from_bits(*bits).is_finite() {
                    self.report(Some(value), "the constant is not finite".to_owned());
                }
            }
            Inst::Param(position) => match self.function.params.get(*position as usize) {
                Some(param) => self.is(value, param.ty),
                None => self.report(Some(value), format!("there is no parameter {position}")),
            },
            Inst::Op(op, operands) => {
                let info = op.info();
                self.is(value, info.result);
                let operands = &operands[..info.operands.len()];
                self.arguments(value, operands, info.operands.iter().copied());
            }
            Inst::Load(table, index) => {
                self.is(value, Type::F32);
                self.arguments(value, &[*index], [Type::U32].into_iter());
                if *table as usize >= self.module.tables.len() {
                    self.report(Some(value), format!("there is no table {table}"));
                }
            }
            Inst::Call(callee, arguments) => {
                if let Some(callee) = self.callee(value, *callee) {
                    self.arguments(value, arguments, callee.params.iter().map(|p| p.ty));
                }
            }
            Inst::Fold {
                function: callee,
                count,
                init,
                captures,
            } => {
                self.arguments(value, &[*count], [Type::U32].into_iter());
                let Some(callee) = self.callee(value, *callee) else {
                    return;
                };
                let state = callee
                    .results
                    .iter()
                    .map(|&(_, v)| callee.types.get(v.index()));
                let state: Vec<Type> = state.flatten().copied().collect();
                self.arguments(value, init, state.iter().copied());
                let params: Vec<Type> = callee.params.iter().map(|p| p.ty).collect();
                let expected = [&[Type::U32][..], &state].concat();
                if !params.starts_with(&expected) {
                    let message = format!(
                        "{} takes {} and returns {}: it is no body of a fold",
                        callee.name,
                        list(&params),
                        list(&state)
                    );
                    return self.report(Some(value), message);
                }
                self.arguments(value, captures, params[expected.len()..].iter().copied());
            }
            Inst::Result(of, position) => {
                let (Inst::Call(callee, _)
                | Inst::Fold {
                    function: callee, ..
                }) = self.function.inst(*of)
                else {
                    let message = format!("%{} is no call and no fold", of.index());
                    return self.report(Some(value), message);
                };
                // The call itself reports a callee that does not exist.
                let Some(callee) = self.module.functions.get(callee.index()) else {
                    return;
                };
                match callee.results.get(*position as usize) {
                    Some((_, result)) => {
                        if let Some(&ty) = callee.types.get(result.index()) {
                            self.is(value, ty);
                        }
                    }
                    None => {
                        let message = format!("{} has no result {position}", callee.name);
                        self.report(Some(value), message);
                    }
                }
            }
        }
    }

    /// The function that a call or fold names, if that comes before this one.
    fn callee(&mut self, value: Value, callee: FunctionId) -> Option<&'a Function> {
        if callee.index() >= self.id {
            self.report(
                Some(value),
                format!("calls function {}, not before it", callee.index()),
            );
            return None;
        }
        self.module.functions.get(callee.index())
    }

    /// Reports a value that is not of this type.
    fn is(&mut self, value: Value, ty: Type) {
        let found = self.function.ty(value);
        if found != ty {
            self.report(
                Some(value),
                format!("is {}, not {}", found.name(), ty.name()),
            );
        }
    }

    fn arguments(
        &mut self,
        value: Value,
        arguments: &[Value],
        expected: impl Iterator<Item = Type>,
    ) {
        let found: Vec<Type> = arguments.iter().map(|&v| self.function.ty(v)).collect();
        let expected: Vec<Type> = expected.collect();
        if found != expected {
            let message = format!("takes {}, not {}", list(&expected), list(&found));
            self.report(Some(value), message);
        }
    }
}

fn list(types: &[Type]) -> String {
    let names: Vec<&str> = types.iter().map(|ty| ty.name()).collect();
    format!("({})", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::super::{Builder, Op};
    use super::*;

    fn module() -> Module {
        let mut module = Module::default();
        module.table("steps", vec![1.0]);
        let body = Builder::new("body", "A body.");
        let index = body.uint_param("index");
        let state = body.float_param("state");
        body.result("state", (state + index.to_float()) * body.load(0, index));
        let body = body.finish(&mut module);
        let b = Builder::new("entry", "An entry.");
        let x = b.float_param("x");
        b.result("y", b.fold(&body, b.uint(3), x, ()));
        b.finish(&mut module);
        module
    }

    /// The messages for a module broken by `break_it`.
    fn broken(break_it: impl FnOnce(&mut Module)) -> String {
        let mut module = module();
        break_it(&mut module);
        let violations = verify(&module).expect_err("the module is broken");
        violations.iter().map(|v| format!("{v}\n")).collect()
    }

    #[test]
    fn each_invariant_is_checked() {
        assert_eq!(verify(&module()), Ok(()));
        type Break = fn(&mut Module);
        let cases: [(Break, &str); 15] = [
            (|m| m.functions.clear(), "no function"),
            (
                |m| m.functions[1].name = "body".into(),
                "two functions are called \"body\"",
            ),
            (|m| m.tables[0].data = Vec::new().into(), "is empty"),
            (|m| m.tables[0].data = vec![f32::NAN].into(), "holds NaN"),
            (
                |m| m.functions[0].params[1].name = "index".into(),
                "two parameters",
            ),
            (|m| m.functions[0].results.clear(), "there is no result"),
            (
                |m| m.functions[0].insts[2] = Inst::Op(Op::FloatU, [Value(4); 3]),
                "defined later",
            ),
            (
                |m| m.functions[0].insts[2] = Inst::Op(Op::FloatI, [Value(0); 3]),
                "takes (i32), not (u32)",
            ),
            (|m| m.functions[0].types[2] = Type::I32, "is i32, not f32"),
            (
                |m| m.functions[0].insts[0] = Inst::Param(7),
                "no parameter 7",
            ),
            (|m| m.tables.clear(), "no table 0"),
            (|m| m.functions.reverse(), "calls function"),
            (|m| m.functions[0].params.swap(0, 1), "no body of a fold"),
            (
                |m| m.functions[1].insts[3] = Inst::Result(Value(2), 1),
                "has no result 1",
            ),
            (
                |m| m.functions[1].results[0].1 = Value(2),
                "is read, not its results",
            ),
        ];
        for (number, (break_it, message)) in cases.into_iter().enumerate() {
            let found = broken(break_it);
            assert!(found.contains(message), "case {number}: {found}");
        }
        let infinite = Constant {
            ty: Type::F32,
            bits: f32::INFINITY.to_bits(),
        };
        assert!(broken(|m| m.functions[1].insts[0] = Inst::Const(infinite)).contains("not finite"));
    }
}
