//! Inlining calls: what two calls have in common is found, and what nobody reads is gone. Every
//! result keeps its bits.

use super::build::Core;
use super::{Function, FunctionRef, Inst, Module, Value};
use rustc_hash::FxHashMap;

/// A callee of more instructions than this stays a call.
const LARGEST: usize = 2_000;

impl Module {
    /// The module with every call of a function that is not large replaced by its instructions.
    ///
    /// With `folds`, real constants that meet are folded, in f32: not for the oracle.
    pub(crate) fn inlined(&self, folds: bool) -> Self {
        let mut out = Self {
            functions: Vec::with_capacity(self.functions.len()),
            tables: self.tables.clone(),
        };
        for function in &self.functions {
            let mut b = Core::new(function.name.clone(), function.doc.clone());
            let parameters: Vec<Value> = (function.params.iter())
                .map(|p| b.param(p.name.clone(), p.ty))
                .collect();
            let values = copied(&mut b, function, &parameters, &out, folds);
            for (name, value) in &function.results {
                b.result(name.clone(), values[value.index()]);
            }
            b.finish(&mut out);
        }
        out.pruned()
    }
}

/// Builds the instructions of `function` for these arguments; where each value went. Callees are
/// functions of `module`.
fn copied(
    b: &mut Core,
    function: &Function,
    arguments: &[Value],
    module: &Module,
    folds: bool,
) -> Vec<Value> {
    // What calls and folds gave, by the value that stands for them.
    let mut given: FxHashMap<Value, Vec<Value>> = FxHashMap::default();
    let mut values = Vec::with_capacity(function.insts.len());
    let unused = Value(u32::MAX);
    for (index, inst) in function.insts.iter().enumerate() {
        let here = Value::from_index(index);
        let moved = |v: &Value| values[v.index()];
        let value = match inst {
            Inst::Const(constant) => b.constant(constant.ty, constant.bits),
            Inst::Param(place) => arguments[*place as usize],
            Inst::Op(op, operands) => {
                let count = op.info().operands.len();
                let mut moved = [moved(&operands[0]); 3];
                for (to, from) in moved.iter_mut().zip(&operands[..count]) {
                    *to = values[from.index()];
                }
                b.exact(*op, moved, folds)
            }
            Inst::Load(table, index) => b.load(*table, moved(index)),
            Inst::Call(id, inputs) => {
                let callee = module.function(*id);
                let inputs: Vec<Value> = inputs.iter().map(moved).collect();
                let results = if callee.insts.len() <= LARGEST {
                    let inner = copied(b, callee, &inputs, module, folds);
                    (callee.results.iter())
                        .map(|(_, v)| inner[v.index()])
                        .collect()
                } else {
                    b.call(&reference(module, *id), &inputs)
                };
                given.insert(here, results);
                unused
            }
            Inst::Fold {
                function,
                count,
                init,
                captures,
            } => {
                let init: Vec<Value> = init.iter().map(moved).collect();
                let captures: Vec<Value> = captures.iter().map(moved).collect();
                let results = b.fold(
                    &reference(module, *function),
                    moved(count),
                    &init,
                    &captures,
                );
                given.insert(here, results);
                unused
            }
            Inst::Result(of, place) => given[of][*place as usize],
        };
        values.push(value);
    }
    values
}

fn reference(module: &Module, id: super::FunctionId) -> FunctionRef {
    let function = module.function(id);
    FunctionRef {
        id,
        results: function.result_types(),
    }
}
