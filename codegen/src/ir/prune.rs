//! Removing what no result needs: instructions of a function, functions and tables of a module.

use super::{Body, Function, FunctionId, Inst, Module, Value};
use rustc_hash::FxHashMap;

/// The function without the instructions that no result needs; parameters stay.
pub(super) fn without_dead_code(function: Body) -> Body {
    let mut live = vec![false; function.insts.len()];
    for &(_, value) in &function.results {
        live[value.index()] = true;
    }
    for index in (0..function.insts.len()).rev() {
        live[index] |= matches!(function.insts[index], Inst::Param(_));
        if live[index] {
            function.insts[index].operands(|v| live[v.index()] = true);
        }
    }
    if live.iter().all(|&l| l) {
        return function;
    }
    let mut moved = vec![Value(0); live.len()];
    let Body {
        mut insts,
        mut types,
        names,
        results,
        ..
    } = function;
    let mut next = 0;
    for index in 0..insts.len() {
        if live[index] {
            renumber(&mut insts[index], |v| moved[v.index()]);
            moved[index] = Value(next as u32);
            insts.swap(next, index);
            types[next] = types[index];
            next += 1;
        }
    }
    insts.truncate(next);
    types.truncate(next);
    Body {
        doc: function.doc,
        params: function.params,
        insts,
        types,
        names: (names.into_iter())
            .filter(|(v, _)| live[v.index()])
            .map(|(v, name)| (moved[v.index()], name))
            .collect(),
        results: (results.into_iter())
            .map(|(n, v)| (n, moved[v.index()]))
            .collect(),
        kept: function.kept,
    }
}

impl Function {
    /// Makes every call one of the function that `to` gives for its callee. A body that stays as it
    /// is stays shared.
    pub(crate) fn redirect(&mut self, to: impl Fn(FunctionId) -> FunctionId) {
        let callee = |inst: &Inst| match inst {
            Inst::Call(f, _) | Inst::Fold { function: f, .. } => Some(*f),
            _ => None,
        };
        if (self.insts.iter()).any(|inst| callee(inst).is_some_and(|f| to(f) != f)) {
            let kept = self.kept.of_copy();
            for inst in &mut self.insts {
                if let Inst::Call(f, _) | Inst::Fold { function: f, .. } = inst {
                    *f = to(*f);
                }
            }
            self.kept = kept;
        }
    }
}

impl Module {
    /// The module without the state of folds that nothing reads, the functions that the entry does
    /// not reach and the tables that they do not read, each name used once.
    pub fn pruned(self) -> Self {
        self.without_idle_state().reached()
    }

    fn reached(mut self) -> Self {
        let mut live = vec![false; self.functions.len()];
        if let Some(entry) = live.last_mut() {
            *entry = true;
        }
        for index in (0..self.functions.len()).rev() {
            if live[index] {
                for inst in &self.functions[index].insts {
                    if let Inst::Call(f, _) | Inst::Fold { function: f, .. } = inst {
                        live[f.index()] = true;
                    }
                }
            }
        }
        let mut moved = Vec::with_capacity(live.len());
        let mut next = 0;
        for &keep in &live {
            moved.push(FunctionId(next));
            next += u32::from(keep);
        }
        let mut index = 0;
        self.functions.retain(|_| {
            index += 1;
            live[index - 1]
        });
        self.prune_tables();
        let mut taken: FxHashMap<String, u32> = FxHashMap::default();
        // The entry keeps its name.
        for function in self.functions.iter_mut().rev() {
            function.redirect(|f| moved[f.index()]);
            let count = taken.entry(function.name.clone()).or_default();
            *count += 1;
            if *count > 1 {
                function.name = format!("{}_{count}", function.name);
            }
        }
        self
    }

    fn prune_tables(&mut self) {
        let loads = |functions: &[Function]| -> Vec<u32> {
            (functions.iter().flat_map(|f| &f.insts))
                .filter_map(|inst| match inst {
                    Inst::Load(table, _) => Some(*table),
                    _ => None,
                })
                .collect()
        };
        let mut moved = vec![None; self.tables.len()];
        let mut read = loads(&self.functions);
        read.sort_unstable();
        read.dedup();
        for (place, &table) in (0u32..).zip(&read) {
            moved[table as usize] = Some(place);
        }
        let mut taken: FxHashMap<String, u32> = FxHashMap::default();
        let tables = std::mem::take(&mut self.tables);
        self.tables = (tables.into_iter().zip(&moved))
            .filter_map(|(table, place)| place.is_some().then_some(table))
            .collect();
        for table in &mut self.tables {
            let count = taken.entry(table.name.clone()).or_default();
            *count += 1;
            if *count > 1 {
                table.name = format!("{}_{count}", table.name);
            }
        }
        let place = |table: u32| moved[table as usize].expect("a table that is read");
        let is_moved =
            |inst: &Inst| matches!(inst, Inst::Load(table, _) if place(*table) != *table);
        for function in &mut self.functions {
            if function.insts.iter().any(is_moved) {
                for inst in &mut function.insts {
                    if let Inst::Load(table, _) = inst {
                        *table = place(*table);
                    }
                }
            }
        }
    }
}

/// Replaces every operand of an instruction.
fn renumber(inst: &mut Inst, to: impl Fn(Value) -> Value) {
    match inst {
        Inst::Const(_) | Inst::Param(_) => {}
        Inst::Op(_, operands) => operands.iter_mut().for_each(|v| *v = to(*v)),
        Inst::Load(_, index) => *index = to(*index),
        Inst::Call(_, arguments) => arguments.iter_mut().for_each(|v| *v = to(*v)),
        Inst::Fold {
            count,
            init,
            captures,
            ..
        } => {
            *count = to(*count);
            init.iter_mut().chain(captures).for_each(|v| *v = to(*v));
        }
        Inst::Result(of, _) => *of = to(*of),
    }
}
