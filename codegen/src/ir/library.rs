//! Functions that a module's functions share: what a rule of the algebra builds again and again is
//! built once and called.
//!
//! A graph of 100 nodes uses some twenty rules, each many times. As calls they make text that a
//! person can read, a tenth of the size, in a fraction of the time. Nothing is lost where it runs:
//! shader compilers inline functions, and so does the CPU evaluator (`Module::inlined`), which
//! then removes the results that nothing reads and finds what two calls have in common.
//!
//! A rule depends on nothing but its key, so a process builds it once: later compilations find it
//! ready ([`KNOWN`]). What a module becomes does not depend on what is ready, since the functions
//! of a library are those that its module called, in the order of their first calls.

use super::function::Kept;
use super::{Builder, Constant, Function, FunctionId, FunctionRef, Module, Type, Value};
use hashbrown::HashTable;
use rustc_hash::{FxHashMap, FxHasher};
use smallvec::SmallVec;
use std::borrow::Cow;
use std::cell::RefCell;
use std::hash::{Hash, Hasher};
use std::rc::Rc;
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

/// Set in the id of a function of the library, until [`Library::link`] gives it its place.
const SHARED: u32 = 1 << 31;

/// What an argument is to a shared function: the constants that simplify what is built are part of
/// the function, all other values are its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Argument(u8);

impl Argument {
    const ZERO: Self = Self(4);
    const ONE: Self = Self(5);
    const MINUS_ONE: Self = Self(6);

    fn of(b: &Builder, value: Value) -> Self {
        match b.as_constant(value) {
            Some(0.0) => Self::ZERO,
            Some(1.0) => Self::ONE,
            Some(-1.0) => Self::MINUS_ONE,
            _ => Self(b.ty(value) as u8),
        }
    }

    /// The type of a parameter; `None` for what stays a constant.
    fn passed(self) -> Option<Type> {
        [Type::F32, Type::I32, Type::U32, Type::Bool]
            .get(usize::from(self.0))
            .copied()
    }
}

/// What tells shared functions apart.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Key {
    name: Cow<'static, str>,
    variant: u32,
    literals: SmallVec<[u32; 6]>,
    arguments: Vec<Argument>,
}

impl Key {
    /// Whether it is the key of these parts.
    fn is(&self, name: &str, variant: u32, literals: &[u32], arguments: &[Argument]) -> bool {
        self.variant == variant
            && self.arguments == arguments
            && self.name == name
            && self.literals[..] == *literals
    }

    /// A hash of the parts of a key.
    fn hash_of(name: &str, variant: u32, literals: &[u32], arguments: &[Argument]) -> u64 {
        let mut hasher = FxHasher::default();
        hasher.write(name.as_bytes());
        hasher.write_u32(variant);
        literals.iter().for_each(|&word| hasher.write_u32(word));
        for eight in arguments.chunks(8) {
            let pack = |word: u64, argument: &Argument| word << 8 | u64::from(argument.0);
            hasher.write_u64(eight.iter().fold(1, pack));
        }
        hasher.finish()
    }

    fn hash(&self) -> u64 {
        Self::hash_of(&self.name, self.variant, &self.literals, &self.arguments)
    }
}

impl Hash for Key {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(Self::hash(self));
    }
}

/// Where a result of a shared function is found.
#[derive(Clone, Copy, Debug)]
enum Outcome {
    Constant(Constant),
    Argument(u32),
    Result(u32),
}

/// A finished shared function.
#[derive(Debug)]
struct Rule {
    key: Key,
    /// The function, whose callees are [`SHARED`] and an index of `callees`; none where every
    /// result is a constant or an argument.
    function: Option<Function>,
    /// The types of the function's results.
    types: Arc<[Type]>,
    callees: Vec<Arc<Rule>>,
    outcomes: Vec<Outcome>,
}

/// The most rules that a process keeps: each is some kilobytes.
const MOST: usize = 4096;

/// The rules that this process has built.
static KNOWN: LazyLock<RwLock<FxHashMap<Key, Arc<Rule>>>> = LazyLock::new(RwLock::default);

/// The rule of this key, from those that are ready or by `build`.
fn rule(key: Key, build: impl FnOnce(Key) -> Rule) -> Arc<Rule> {
    // A panic while the lock is held leaves whole rules behind.
    let known = KNOWN.read().unwrap_or_else(PoisonError::into_inner);
    if let Some(rule) = known.get(&key) {
        return Arc::clone(rule);
    }
    drop(known);
    let rule = Arc::new(build(key));
    let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
    if known.len() < MOST {
        known.insert(rule.key.clone(), Arc::clone(&rule));
    }
    rule
}

/// The shared functions of a module under construction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Library(Rc<RefCell<Shelves>>);

/// What a library holds.
#[derive(Debug, Default)]
pub(crate) struct Shelves {
    known: HashTable<Placed>,
    /// The functions that were called, callees first.
    rules: Vec<Arc<Rule>>,
}

/// A rule, and its function as one of the module.
#[derive(Clone, Debug)]
struct Placed {
    hash: u64,
    rule: Arc<Rule>,
    function: Option<FunctionRef>,
}

impl Shelves {
    /// Where the rule of this key is, if it is known.
    fn find(&self, key: &Key) -> Option<&Placed> {
        let hash = Key::hash(key);
        (self.known).find(hash, |placed| {
            placed.hash == hash && placed.rule.key == *key
        })
    }

    /// The rule's function as one of this module.
    fn reference(&mut self, rule: &Arc<Rule>) -> Option<FunctionRef> {
        if let Some(placed) = self.find(&rule.key) {
            return placed.function.clone();
        }
        for callee in &rule.callees {
            self.reference(callee);
        }
        let reference = rule.function.as_ref().map(|_| {
            self.rules.push(Arc::clone(rule));
            FunctionRef {
                id: FunctionId((self.rules.len() as u32 - 1) | SHARED),
                results: Arc::clone(&rule.types),
            }
        });
        let hash = Key::hash(&rule.key);
        let placed = Placed {
            hash,
            rule: Arc::clone(rule),
            function: reference.clone(),
        };
        (self.known).insert_unique(hash, placed, |placed| placed.hash);
        reference
    }
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

    fn of(
        key: Key,
        mut function: Option<Function>,
        outcomes: Vec<Outcome>,
        callee: impl Fn(FunctionId) -> Arc<Self>,
    ) -> Self {
        let called = function.as_ref().map_or(Vec::new(), |f| f.callees());
        if let Some(function) = &mut function {
            function.redirect(|id| {
                let place = called.iter().position(|&known| known == id);
                FunctionId(place.expect("every callee is listed") as u32 | SHARED)
            });
            function.kept = Kept::shared();
        }
        Self {
            key,
            types: function.as_ref().map_or([].into(), |f| f.result_types()),
            function,
            callees: called.into_iter().map(callee).collect(),
            outcomes,
        }
    }
}

/// Where the functions of another library went.
#[derive(Debug)]
pub(crate) struct Adopted(Vec<FunctionId>);

impl Adopted {
    /// Where a function went; `None` if it is not one of a library.
    pub(crate) fn get(&self, id: FunctionId) -> Option<FunctionId> {
        (id.0 & SHARED != 0).then(|| self.0[(id.0 & !SHARED) as usize])
    }
}

impl Library {
    /// A function that all functions of the module share, by a key that names all that it depends
    /// on. `build` puts it into a module of its own, with what it calls.
    pub(crate) fn function(
        &self,
        key: &str,
        build: impl FnOnce(&mut Module) -> FunctionRef,
    ) -> FunctionRef {
        let key = |variant| Key {
            name: Cow::Owned(key.to_owned()),
            variant,
            literals: SmallVec::new(),
            arguments: Vec::new(),
        };
        if let Some(placed) = self.0.borrow().find(&key(0)) {
            return placed.function.clone().expect("a function has results");
        }
        let rule = rule(key(0), |whole| {
            let mut module = Module::default();
            let last = build(&mut module);
            assert!(module.tables.is_empty(), "shared functions read no tables");
            assert_eq!(last.id.index() + 1, module.functions.len(), "callees first");
            let mut rules: Vec<Arc<Rule>> = Vec::new();
            let mut functions = module.functions.into_iter();
            let last = functions.next_back();
            for (variant, function) in (1..).zip(functions) {
                let callee = |id: FunctionId| Arc::clone(&rules[id.index()]);
                let rule = Rule::of(key(variant), Some(function), Vec::new(), callee);
                rules.push(Arc::new(rule));
            }
            Rule::of(whole, last, Vec::new(), |id| Arc::clone(&rules[id.index()]))
        });
        let reference = self.0.borrow_mut().reference(&rule);
        reference.expect("a function has results")
    }

    /// What it holds, for another thread.
    pub(crate) fn into_shelves(self) -> Shelves {
        std::mem::take(&mut *self.0.borrow_mut())
    }

    /// The functions of another library as functions of this one.
    pub(crate) fn adopt(&self, other: &Shelves) -> Adopted {
        let mut shelves = self.0.borrow_mut();
        let place = |rule| {
            shelves
                .reference(rule)
                .expect("only functions are listed")
                .id
        };
        Adopted(other.rules.iter().map(place).collect())
    }

    /// Puts the library's functions before those of `module`, which call them.
    pub(crate) fn link(self, module: &mut Module) {
        let shelves = std::mem::take(&mut *self.0.borrow_mut());
        let offset = shelves.rules.len() as u32;
        let place = |rule: &Rule| {
            let placed = shelves.find(&rule.key).and_then(|p| p.function.as_ref());
            FunctionId(placed.expect("a callee is a function").id.0 & !SHARED)
        };
        let own = std::mem::take(&mut module.functions);
        for rule in &shelves.rules {
            let mut function = rule.function.clone().expect("only functions are listed");
            if !rule.callees.is_empty() {
                function.redirect(|id| place(&rule.callees[(id.0 & !SHARED) as usize]));
            }
            module.functions.push(function);
        }
        for mut function in own {
            function.redirect(|FunctionId(old)| {
                FunctionId(if old & SHARED != 0 {
                    old & !SHARED
                } else {
                    old + offset
                })
            });
            module.functions.push(function);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::{Inst, Op};

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
