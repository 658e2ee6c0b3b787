//! Removing what a fold carries from turn to turn although nobody reads it: numbers of the state that
//! only feed themselves, and captures that the body does not read any more.
//!
//! A rule builds all the moments that its mode has, and who reads them is known only when the graph
//! is built. Of straight code dead instructions go; the state of a fold is dead where no result of the
//! fold is read and no other number of the state depends on it.

use super::function::{Body, Kept};
use super::{Function, Inst, Module, Value};

/// What is read of a function: of its results and its parameters by position, and which of its
/// instructions.
#[derive(Debug)]
struct Read {
    results: Vec<bool>,
    parameters: Vec<bool>,
    insts: Vec<bool>,
}

impl Read {
    fn of(function: &Function, results: Vec<bool>) -> Self {
        let mut insts = vec![false; function.insts.len()];
        for (&(_, value), &is_read) in function.results.iter().zip(&results) {
            insts[value.index()] |= is_read;
        }
        let mut parameters = vec![false; function.params.len()];
        for index in (0..insts.len()).rev() {
            if insts[index] {
                let inst = &function.insts[index];
                inst.operands(|v| insts[v.index()] = true);
                if let Inst::Param(place) = inst {
                    parameters[*place as usize] = true;
                }
            }
        }
        Self {
            results,
            parameters,
            insts,
        }
    }

    /// The same of the body of a fold: a state that is read must be made.
    fn of_body(function: &Function, results: Vec<bool>) -> Self {
        let mut read = Self::of(function, results);
        loop {
            // The state follows the index.
            let state = &read.parameters[1..=read.results.len()];
            let both = read.results.iter().zip(state);
            let wanted: Vec<bool> = both.map(|(result, state)| result | state).collect();
            if wanted == read.results {
                return read;
            }
            read = Self::of(function, wanted);
        }
    }
}

impl Function {
    /// Which of its parameters it reads.
    pub(crate) fn read_parameters(&self) -> Vec<bool> {
        Read::of(self, vec![true; self.results.len()]).parameters
    }
}

impl Module {
    /// The module without idle state.
    pub(super) fn without_idle_state(mut self) -> Self {
        while self.remove_idle_state() {}
        self
    }

    /// Whether there was some, which may leave more of it.
    fn remove_idle_state(&mut self) -> bool {
        let count = self.functions.len();
        let (mut is_called, mut is_body) = (vec![false; count], vec![false; count]);
        for inst in self.functions.iter().flat_map(|f| &f.insts) {
            match inst {
                Inst::Call(callee, _) => is_called[callee.index()] = true,
                Inst::Fold { function, .. } => is_body[function.index()] = true,
                _ => {}
            }
        }
        let shrinks = |i: usize| is_body[i] && !is_called[i];
        let mut wanted: Vec<Vec<bool>> = (self.functions.iter().enumerate())
            .map(|(i, function)| vec![!shrinks(i); function.results.len()])
            .collect();
        // Callers come after their callees.
        let mut read: Vec<Read> = Vec::with_capacity(count);
        for (i, function) in self.functions.iter().enumerate().rev() {
            let results = std::mem::take(&mut wanted[i]);
            let own = match shrinks(i) {
                true => Read::of_body(function, results),
                false => Read::of(function, results),
            };
            for (inst, _) in function.insts.iter().zip(&own.insts).filter(|(_, r)| **r) {
                if let Inst::Result(of, place) = inst
                    && let Inst::Fold { function: body, .. } = function.inst(*of)
                    && let Some(result) = wanted[body.index()].get_mut(*place as usize)
                {
                    *result = true;
                }
            }
            read.push(own);
        }
        read.reverse();
        let is_idle = |i: usize| {
            let Read {
                results,
                parameters,
                ..
            } = &read[i];
            let captures = &parameters[1 + results.len()..];
            // What nothing reaches stays for the pruning of functions.
            results.contains(&true) && (results.contains(&false) || captures.contains(&false))
        };
        let shrinks: Vec<bool> = (0..count).map(|i| shrinks(i) && is_idle(i)).collect();
        if !shrinks.contains(&true) {
            return false;
        }
        let functions = std::mem::take(&mut self.functions);
        self.functions = (functions.into_iter().enumerate())
            .map(|(i, function)| rewritten(function, i, &read, &shrinks))
            .collect();
        true
    }
}

/// The numbers of `all` that are kept.
fn kept<T: Clone>(all: &[T], keep: &[bool]) -> Vec<T> {
    let pairs = all.iter().zip(keep);
    pairs.filter(|(_, k)| **k).map(|(x, _)| x.clone()).collect()
}

/// How many before `place` are kept.
fn place_among(keep: &[bool], place: u32) -> u32 {
    let before = &keep[..place as usize];
    before.iter().filter(|&&k| k).count() as u32
}

/// Function `i` of the module where those that `shrinks` names lose what is not read of them.
fn rewritten(function: Function, i: usize, read: &[Read], shrinks: &[bool]) -> Function {
    let folds =
        |inst: &Inst| matches!(inst, Inst::Fold { function, .. } if shrinks[function.index()]);
    if !shrinks[i] && !function.insts.iter().any(folds) {
        return function;
    }
    let own = &read[i];
    let mut keep_parameters = own.parameters.clone();
    let mut keep_results = own.results.clone();
    if shrinks[i] {
        let states = keep_results.len();
        keep_parameters[0] = true;
        keep_parameters[1..=states].copy_from_slice(&keep_results);
    } else {
        keep_parameters.fill(true);
        keep_results.fill(true);
    }
    let mut moved = vec![Value(0); function.insts.len()];
    let (mut insts, mut types) = (Vec::new(), Vec::new());
    let mut is_kept = vec![false; function.insts.len()];
    for (index, inst) in function.insts.iter().enumerate() {
        let keep = match inst {
            Inst::Param(place) => keep_parameters[*place as usize],
            _ => own.insts[index],
        };
        if !keep {
            continue;
        }
        let to = |v: &Value| moved[v.index()];
        let inst = match inst {
            Inst::Const(constant) => Inst::Const(*constant),
            Inst::Param(place) => Inst::Param(place_among(&keep_parameters, *place)),
            Inst::Op(op, operands) => Inst::Op(*op, operands.map(|v| to(&v))),
            Inst::Load(table, at) => Inst::Load(*table, to(at)),
            Inst::Call(callee, arguments) => {
                Inst::Call(*callee, arguments.iter().map(to).collect())
            }
            Inst::Fold {
                function: body,
                count,
                init,
                captures,
            } => {
                let of = &read[body.index()];
                let (mut state, mut others) = (init.to_vec(), captures.to_vec());
                if shrinks[body.index()] {
                    others = kept(&others, &of.parameters[1 + state.len()..]);
                    state = kept(&state, &of.results);
                }
                Inst::Fold {
                    function: *body,
                    count: to(count),
                    init: state.iter().map(to).collect(),
                    captures: others.iter().map(to).collect(),
                }
            }
            Inst::Result(of, place) => {
                let place = match function.inst(*of) {
                    Inst::Fold { function: body, .. } if shrinks[body.index()] => {
                        place_among(&read[body.index()].results, *place)
                    }
                    _ => *place,
                };
                Inst::Result(to(of), place)
            }
        };
        is_kept[index] = true;
        moved[index] = Value(insts.len() as u32);
        insts.push(inst);
        types.push(function.types[index]);
    }
    let body = Body {
        insts,
        types,
        names: (function.names.iter())
            .filter(|(v, _)| is_kept[v.index()])
            .map(|(v, name)| (moved[v.index()], name.clone()))
            .collect(),
        results: (kept(&function.results, &keep_results).into_iter())
            .map(|(name, v)| (name, moved[v.index()]))
            .collect(),
        params: kept(&function.params, &keep_parameters),
        doc: function.doc.clone(),
        // The text of a shared function is not that of a changed one.
        kept: Kept::default(),
    };
    Function::new(function.name, body)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::Builder;

    #[test]
    fn what_only_feeds_itself_goes_and_what_feeds_others_stays() {
        let mut module = Module::default();
        let body = Builder::new("body", "A test.");
        body.uint_param("index");
        let state = body.float_params(["read", "feeds", "idle"]);
        let [used, unused] = body.float_params(["used", "unused"]);
        body.result("read", state[0] + state[1]);
        body.result("feeds", state[1] * used);
        body.result("idle", state[2] * unused);
        let body = body.finish(&mut module);
        let b = Builder::new("f", "A test.");
        let (x, y) = (b.float_param("x"), b.float_param("y"));
        let state = b.fold(&body, b.uint(3), [x, y, y], [x, y]);
        b.result("out", state[0]);
        b.finish(&mut module);
        let module = module.without_idle_state();
        let names: Vec<&str> = (module.functions[0].params.iter())
            .map(|p| p.name.as_str())
            .collect();
        assert_eq!(names, ["index", "read", "feeds", "used"]);
        let fold = module.entry().insts.iter().find_map(|inst| match inst {
            Inst::Fold { init, captures, .. } => Some((init.len(), captures.len())),
            _ => None,
        });
        assert_eq!(fold, Some((2, 1)));
        assert_eq!(module.clone().without_idle_state(), module);
    }
}
