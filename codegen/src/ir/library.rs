//! Functions that a module's functions share: what a rule of the algebra builds again and again is
//! built once and called.
//!
//! A graph of 100 nodes uses some twenty rules, each many times. As calls they make text that a
//! person can read, a tenth of the size, in a fraction of the time. Nothing is lost where it runs:
//! shader compilers inline functions, and so does the CPU evaluator (`Module::inlined`), which
//! then removes the results that nothing reads and finds what two calls have in common.

use super::{Builder, Constant, FunctionId, FunctionRef, Inst, Module, Type, Value};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::cell::RefCell;
use std::rc::Rc;

/// Set in the id of a function of the library, until [`Library::link`] gives it its place.
const SHARED: u32 = 1 << 31;

/// What an argument is to a shared function: the constants that simplify what is built are part of
/// the function, all other values are its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Argument {
    Zero,
    One,
    MinusOne,
    Passed(Type),
}

impl Argument {
    fn of(b: &Builder, value: Value) -> Self {
        match b.as_constant(value) {
            Some(0.0) => Self::Zero,
            Some(1.0) => Self::One,
            Some(-1.0) => Self::MinusOne,
            _ => Self::Passed(b.ty(value)),
        }
    }
}

/// What tells shared functions apart.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    name: &'static str,
    variant: u32,
    arguments: SmallVec<[Argument; 24]>,
}

/// Where a result of a shared function is found.
#[derive(Clone, Copy, Debug)]
enum Outcome {
    Constant(Constant),
    Argument(u32),
    Result(u32),
}

/// A shared function and what its results are.
#[derive(Clone, Debug)]
struct Entry {
    function: Option<FunctionRef>,
    outcomes: Rc<[Outcome]>,
}

/// The shared functions of a module under construction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Library(Rc<RefCell<Shelves>>);

#[derive(Debug, Default)]
struct Shelves {
    known: FxHashMap<Key, Entry>,
    module: Module,
}

/// A shared function's name and documentation.
#[derive(Clone, Copy, Debug)]
pub struct SharedFunction {
    /// A readable name (an identifier in lower snake case), unique among rules.
    pub name: &'static str,
    /// Tells apart what `build` makes of the same arguments.
    pub variant: u32,
    /// One sentence that says what it computes.
    pub doc: &'static str,
}

impl Builder {
    /// What `build` makes of `arguments`, as a call of a function that all functions of the module
    /// share; built in place where there is no library. `build` must depend on nothing but the
    /// builder, the arguments, and `of`.
    ///
    /// Arguments that are the constants 0, 1 or −1 stay constants inside.
    pub fn shared<const RESULTS: usize>(
        &mut self,
        of: SharedFunction,
        arguments: &[(&'static str, Value)],
        build: impl FnOnce(&mut Self, &[Value]) -> [(&'static str, Value); RESULTS],
    ) -> [Value; RESULTS] {
        let values: SmallVec<[Value; 24]> = arguments.iter().map(|&(_, v)| v).collect();
        let Some(library) = self.library.clone() else {
            return build(self, &values).map(|(_, v)| v);
        };
        let key = Key {
            name: of.name,
            variant: of.variant,
            arguments: values.iter().map(|&v| Argument::of(self, v)).collect(),
        };
        let known = library.0.borrow().known.get(&key).cloned();
        let entry = known.unwrap_or_else(|| library.add(key, of, arguments, build));
        let passed = |b: &Self, v: Value| matches!(Argument::of(b, v), Argument::Passed(_));
        let results = match &entry.function {
            Some(function) => {
                let inputs: SmallVec<[Value; 24]> = values
                    .iter()
                    .copied()
                    .filter(|&v| passed(self, v))
                    .collect();
                self.call(function, &inputs)
            }
            None => Vec::new(),
        };
        let mut outcomes = entry.outcomes.iter();
        [(); RESULTS].map(|()| match outcomes.next().expect("one for each result") {
            Outcome::Constant(constant) => self.constant(constant.ty, constant.bits),
            Outcome::Argument(i) => values[*i as usize],
            Outcome::Result(i) => results[*i as usize],
        })
    }
}

impl Library {
    /// Builds a function that is not yet known.
    fn add<const RESULTS: usize>(
        &self,
        key: Key,
        of: SharedFunction,
        arguments: &[(&'static str, Value)],
        build: impl FnOnce(&mut Builder, &[Value]) -> [(&'static str, Value); RESULTS],
    ) -> Entry {
        let mut b = Builder::new(of.name, of.doc);
        b.library = Some(self.clone());
        let mut places: FxHashMap<Value, u32> = FxHashMap::default();
        let parameters: SmallVec<[Value; 24]> = (0u32..)
            .zip(arguments.iter().zip(&key.arguments))
            .map(|(i, (&(name, _), argument))| match argument {
                Argument::Zero => b.f32(0.0),
                Argument::One => b.f32(1.0),
                Argument::MinusOne => b.f32(-1.0),
                Argument::Passed(ty) => {
                    // Arguments without names of their own are told apart by their places.
                    let namesakes = arguments.iter().filter(|a| a.0 == name).count();
                    let parameter = if namesakes == 1 {
                        b.param(name, *ty)
                    } else {
                        b.param(format!("{name}{i}"), *ty)
                    };
                    places.insert(parameter, i);
                    parameter
                }
            })
            .collect();
        let results = build(&mut b, &parameters);
        let mut count = 0;
        let outcomes = results
            .iter()
            .map(|&(name, value)| {
                if let Some(constant) = b.constant_of(value) {
                    Outcome::Constant(constant)
                } else if let Some(&place) = places.get(&value) {
                    Outcome::Argument(place)
                } else {
                    b.result(name, value);
                    count += 1;
                    Outcome::Result(count - 1)
                }
            })
            .collect();
        let mut shelves = self.0.borrow_mut();
        let function = (count > 0).then(|| {
            let mut function = b.finish(&mut shelves.module);
            function.id.0 |= SHARED;
            function
        });
        let entry = Entry { function, outcomes };
        shelves.known.insert(key, entry.clone());
        entry
    }

    /// Puts the library's functions before those of `module`, which call them.
    pub(crate) fn link(self, module: &mut Module) {
        let shelves = std::mem::take(&mut *self.0.borrow_mut());
        let shared = shelves.module.functions;
        let offset = shared.len() as u32;
        let own = std::mem::replace(&mut module.functions, shared);
        module.functions.extend(own);
        for (index, function) in (0u32..).zip(&mut module.functions) {
            for inst in &mut function.insts {
                if let Inst::Call(id, _) | Inst::Fold { function: id, .. } = inst {
                    let FunctionId(old) = *id;
                    let is_shared = old & SHARED != 0;
                    assert!(is_shared || index >= offset, "a library calls itself alone");
                    *id = FunctionId(if is_shared {
                        old & !SHARED
                    } else {
                        old + offset
                    });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::Op;

    const PRODUCT: SharedFunction = SharedFunction {
        name: "weighted",
        variant: 0,
        doc: "A test.",
    };

    fn weighted(b: &mut Builder, x: Value, y: Value) -> [Value; 3] {
        b.shared(PRODUCT, &[("x", x), ("y", y)], |b, v| {
            let product = b.mul(v[0], v[1]);
            [("product", product), ("zero", b.f32(0.0)), ("x", v[0])]
        })
    }

    #[test]
    fn rules_become_functions_and_constants_stay_visible() {
        let library = Library::default();
        let mut b = Builder::new("f", "A test.");
        b.library = Some(library.clone());
        let (x, y) = (b.param_f32("x"), b.param_f32("y"));
        let [xy, zero, same] = weighted(&mut b, x, y);
        assert!(b.is_zero(zero));
        assert_eq!(same, x);
        let [yx, ..] = weighted(&mut b, y, x);
        let one = b.f32(1.0);
        let [plain, ..] = weighted(&mut b, y, one);
        assert_eq!(plain, y, "a factor of 1 needs no call");
        let sum = b.sub(xy, yx);
        b.result("sum", sum);
        let mut module = Module::default();
        b.finish(&mut module);
        library.link(&mut module);
        assert_eq!(module.functions.len(), 2, "two calls of one function");
        assert_eq!(crate::ir::verify(&module), Ok(()));
        // Inlined, the two products are one and the same.
        let inlined = module.inlined(true);
        assert_eq!(inlined.functions.len(), 1);
        let difference = inlined.entry().inst(inlined.entry().results[0].1);
        let Inst::Op(Op::Sub, [left, right, _]) = difference else {
            panic!("{difference:?}")
        };
        assert_eq!(left, right);
    }
}
