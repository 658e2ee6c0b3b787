//! Calls of functions that a module's functions share: how a builder makes them, and builds what the
//! library does not hold yet.

use super::build::Core;
use super::library::{Argument, Key, Library, Outcome, Placed, Rule, SHARED, rule};
use super::{Builder, Float, Scalar, Value};
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
    /// What a value of a function is.
    pub(super) fn of(function: &Core, value: Value) -> Self {
        match function.as_constant(value) {
            Some(0.0) => Self::ZERO,
            Some(1.0) => Self::ONE,
            Some(-1.0) => Self::MINUS_ONE,
            _ => Self(function.ty(value) as u8),
        }
    }
}

impl Builder {
    /// What `build` makes of `arguments`, real numbers, as a call of a function that all functions of
    /// the module share; built in place where there is no library. `build` must depend on nothing but
    /// the arguments, and `of`.
    ///
    /// Arguments that are the constants 0, 1 or −1 stay constants inside.
    pub fn shared<'b, const RESULTS: usize>(
        &'b self,
        of: SharedFunction,
        arguments: &[(&'static str, Float<'b>)],
        build: impl for<'c> FnOnce(&'c Self, &[Float<'c>]) -> [(&'static str, Float<'c>); RESULTS],
    ) -> [Float<'b>; RESULTS] {
        if self.library().is_none() {
            let values: SmallVec<[Float<'b>; 32]> = arguments.iter().map(|&(_, v)| v).collect();
            return build(self, &values).map(|(_, v)| v);
        }
        let key = (Cow::Borrowed(of.name), of.variant, &[][..]);
        let results = self.call_rule(key, (of.name, of.doc), arguments, |b, v| {
            let values: SmallVec<[Float<'_>; 32]> = v.iter().map(|v| v.float()).collect();
            let results = build(b, &values);
            results.map(|(name, v)| (name, v.into())).into()
        });
        std::array::from_fn(|i| results[i].float())
    }

    /// The same of scalars of any type.
    pub fn shared_scalars<'b, const RESULTS: usize>(
        &'b self,
        of: SharedFunction,
        arguments: &[(&'static str, Scalar<'b>)],
        build: impl for<'c> FnOnce(&'c Self, &[Scalar<'c>]) -> [(&'static str, Scalar<'c>); RESULTS],
    ) -> [Scalar<'b>; RESULTS] {
        if self.library().is_none() {
            let values: SmallVec<[Scalar<'b>; 32]> = arguments.iter().map(|&(_, v)| v).collect();
            return build(self, &values).map(|(_, v)| v);
        }
        let key = (Cow::Borrowed(of.name), of.variant, &[][..]);
        let results = self.call_rule(key, (of.name, of.doc), arguments, |b, v| build(b, v).into());
        std::array::from_fn(|i| results[i])
    }

    /// The same for as many results as there are; `key` names all that `build` depends on but the
    /// arguments.
    pub(crate) fn call_rule<'b, A: Into<Scalar<'b>> + Copy>(
        &'b self,
        (name, variant, literals): (Cow<'static, str>, u32, &[u32]),
        (readable, doc): (&'static str, &'static str),
        arguments: &[(&'static str, A)],
        build: impl for<'c> FnOnce(&'c Self, &[Scalar<'c>]) -> Vec<(&'static str, Scalar<'c>)>,
    ) -> SmallVec<[Scalar<'b>; 16]> {
        let values = || {
            arguments
                .iter()
                .map(|&(_, argument)| argument.into().value())
        };
        let pattern = self.arguments(values());
        let hash = Key::hash_of(&name, variant, literals, &pattern);
        let library = self.library().expect("the caller has seen a library");
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
            let names = arguments.iter().map(|&(name, _)| name).collect();
            let rule = rule(key, |key| Rule::new(key, (readable, doc), names, build));
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
                for (value, argument) in values().zip(&rule.key.arguments) {
                    if argument.passed().is_some() {
                        inputs.push(value);
                    }
                }
                self.call_values(function, inputs.into_boxed_slice())
            }
            None => Vec::new(),
        };
        (rule.outcomes.iter())
            .map(|outcome| match *outcome {
                Outcome::Constant(constant) => self.scalar(constant),
                Outcome::Argument(i) => arguments[i as usize].1.into(),
                Outcome::Result(i) => results[i as usize],
            })
            .collect()
    }
}

impl Rule {
    fn new(
        key: Key,
        (name, doc): (&'static str, &'static str),
        names: SmallVec<[&'static str; 32]>,
        build: impl for<'c> FnOnce(&'c Builder, &[Scalar<'c>]) -> Vec<(&'static str, Scalar<'c>)>,
    ) -> Self {
        let library = Library::default();
        let b = &Builder::new(name, doc).with_library(library.clone());
        let mut places: FxHashMap<Value, u32> = FxHashMap::default();
        let parameters: SmallVec<[Scalar<'_>; 32]> = (0u32..)
            .zip(names.iter().zip(&key.arguments))
            .map(|(i, (&name, &argument))| match argument {
                Argument::ZERO => b.float(0.0).into(),
                Argument::ONE => b.float(1.0).into(),
                Argument::MINUS_ONE => b.float(-1.0).into(),
                passed => {
                    let ty = passed.passed().expect("what is no constant is passed");
                    // Arguments without names of their own are told apart by their places.
                    let namesakes = names.iter().filter(|&&other| other == name).count();
                    let parameter = if namesakes == 1 {
                        b.scalar_param(name, ty)
                    } else {
                        b.scalar_param(format!("{name}{i}"), ty)
                    };
                    places.insert(parameter.value(), i);
                    parameter
                }
            })
            .collect();
        let results = build(b, &parameters);
        let mut count = 0;
        let outcomes = results
            .iter()
            .map(|&(name, value)| {
                if let Some(constant) = value.constant() {
                    Outcome::Constant(constant)
                } else if let Some(&place) = places.get(&value.value()) {
                    Outcome::Argument(place)
                } else {
                    b.result(name, value);
                    count += 1;
                    Outcome::Result(count - 1)
                }
            })
            .collect();
        let function = (count > 0).then(|| b.taken().finished());
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

    fn weighted<'b>(x: Float<'b>, y: Float<'b>) -> [Float<'b>; 3] {
        let arguments = [("x", x), ("y", y)];
        x.builder().shared(PRODUCT, &arguments, |b, v| {
            [
                ("product", v[0] * v[1]),
                ("zero", b.float(0.0)),
                ("x", v[0]),
            ]
        })
    }

    #[test]
    fn rules_become_functions_and_constants_stay_visible() {
        let library = Library::default();
        let b = Builder::new("f", "A test.").with_library(library.clone());
        let (x, y) = (b.float_param("x"), b.float_param("y"));
        let [xy, zero, same] = weighted(x, y);
        assert!(zero.is_zero());
        assert_eq!(same, x);
        let [yx, ..] = weighted(y, x);
        let [plain, ..] = weighted(y, b.float(1.0));
        assert_eq!(plain, y, "a factor of 1 needs no call");
        b.result("sum", xy - yx);
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
