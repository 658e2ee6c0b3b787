//! Calls of functions that a module's functions share: how a builder makes them, and builds what the
//! library does not hold yet.

use super::library::{Argument, Key, Library, Outcome, Placed, Rule, SHARED, rule};
use super::{Builder, Value};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::borrow::Cow;
use std::sync::Arc;

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

impl Argument {
    fn of(b: &Builder, value: Value) -> Self {
        match b.as_constant(value) {
            Some(0.0) => Self::ZERO,
            Some(1.0) => Self::ONE,
            Some(-1.0) => Self::MINUS_ONE,
            _ => Self(b.ty(value) as u8),
        }
    }
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
        if self.library.is_none() {
            let values: SmallVec<[Value; 32]> = arguments.iter().map(|&(_, v)| v).collect();
            return build(self, &values).map(|(_, v)| v);
        }
        let key = (Cow::Borrowed(of.name), of.variant, &[][..]);
        let mut results =
            self.call_rule(key, (of.name, of.doc), arguments, |b, v| build(b, v).into());
        let mut results = results.drain(..);
        [(); RESULTS].map(|()| results.next().expect("one for each result"))
    }

    /// The same for as many results as there are; `key` names all that `build` depends on but the
    /// arguments.
    pub(crate) fn call_rule(
        &mut self,
        (name, variant, literals): (Cow<'static, str>, u32, &[u32]),
        (readable, doc): (&'static str, &'static str),
        arguments: &[(&'static str, Value)],
        build: impl FnOnce(&mut Self, &[Value]) -> Vec<(&'static str, Value)>,
    ) -> SmallVec<[Value; 16]> {
        let pattern: SmallVec<[Argument; 128]> = (arguments.iter())
            .map(|&(_, value)| Argument::of(self, value))
            .collect();
        let hash = Key::hash_of(&name, variant, literals, &pattern);
        let library = self
            .library
            .as_ref()
            .expect("the caller has seen a library");
        let is_it = |placed: &Placed| {
            placed.hash == hash && placed.rule.key.is(&name, variant, literals, &pattern)
        };
        let known = library.0.borrow().known.find(hash, is_it).cloned();
        let Placed { rule, function, .. } = known.unwrap_or_else(|| {
            let key = Key {
                name,
                variant,
                literals: literals.into(),
                arguments: pattern.to_vec(),
            };
            let rule = rule(key, |key| Rule::new(key, (readable, doc), arguments, build));
            let function = library.0.borrow_mut().reference(&rule);
            Placed {
                hash,
                rule,
                function,
            }
        });
        let results = match &function {
            Some(function) => {
                let mut inputs = Vec::with_capacity(arguments.len());
                for (&(_, value), argument) in arguments.iter().zip(&rule.key.arguments) {
                    if argument.passed().is_some() {
                        inputs.push(value);
                    }
                }
                self.call_with(function, inputs.into_boxed_slice())
            }
            None => Vec::new(),
        };
        (rule.outcomes.iter())
            .map(|outcome| match *outcome {
                Outcome::Constant(constant) => self.constant(constant.ty, constant.bits),
                Outcome::Argument(i) => arguments[i as usize].1,
                Outcome::Result(i) => results[i as usize],
            })
            .collect()
    }
}

impl Rule {
    fn new(
        key: Key,
        (name, doc): (&'static str, &'static str),
        arguments: &[(&'static str, Value)],
        build: impl FnOnce(&mut Builder, &[Value]) -> Vec<(&'static str, Value)>,
    ) -> Self {
        let library = Library::default();
        let mut b = Builder::new(name, doc).with_library(library.clone());
        let mut places: FxHashMap<Value, u32> = FxHashMap::default();
        let parameters: SmallVec<[Value; 32]> = (0u32..)
            .zip(arguments.iter().zip(&key.arguments))
            .map(|(i, (&(name, _), &argument))| match argument {
                Argument::ZERO => b.f32(0.0),
                Argument::ONE => b.f32(1.0),
                Argument::MINUS_ONE => b.f32(-1.0),
                passed => {
                    let ty = passed.passed().expect("what is no constant is passed");
                    // Arguments without names of their own are told apart by their places.
                    let namesakes = arguments.iter().filter(|a| a.0 == name).count();
                    let parameter = if namesakes == 1 {
                        b.param(name, ty)
                    } else {
                        b.param(format!("{name}{i}"), ty)
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
        let function = (count > 0).then(|| b.finished());
        let callees = &library.0.borrow().rules;
        Self::of(key, function, outcomes, |id| {
            assert!(id.0 & SHARED != 0, "a library calls itself alone");
            Arc::clone(&callees[(id.0 & !SHARED) as usize])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::{Inst, Module, Op};

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
