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
use super::{Constant, Function, FunctionId, FunctionRef, Module, Type};
use hashbrown::HashTable;
use rustc_hash::{FxHashMap, FxHasher};
use smallvec::SmallVec;
use std::borrow::Cow;
use std::cell::RefCell;
use std::hash::{Hash, Hasher};
use std::rc::Rc;
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

/// Set in the id of a function of the library, until [`Library::link`] gives it its place.
pub(super) const SHARED: u32 = 1 << 31;

/// What an argument is to a shared function: the constants that simplify what is built are part of
/// the function, all other values are its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Argument(pub(super) u8);

impl Argument {
    pub(super) const ZERO: Self = Self(4);
    pub(super) const ONE: Self = Self(5);
    pub(super) const MINUS_ONE: Self = Self(6);

    /// The type of a parameter; `None` for what stays a constant.
    pub(super) fn passed(self) -> Option<Type> {
        [Type::F32, Type::I32, Type::U32, Type::Bool]
            .get(usize::from(self.0))
            .copied()
    }
}

/// What the arguments of a call are.
pub(super) type Pattern = SmallVec<[Argument; 128]>;

/// What tells shared functions apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Key {
    pub(super) name: Cow<'static, str>,
    pub(super) variant: u32,
    pub(super) literals: SmallVec<[u32; 6]>,
    pub(super) arguments: Vec<Argument>,
}

impl Key {
    /// Whether it is the key of these parts.
    pub(super) fn is(
        &self,
        name: &str,
        variant: u32,
        literals: &[u32],
        arguments: &[Argument],
    ) -> bool {
        self.variant == variant
            && self.arguments == arguments
            && self.name == name
            && self.literals[..] == *literals
    }

    /// A hash of the parts of a key.
    pub(super) fn hash_of(
        name: &str,
        variant: u32,
        literals: &[u32],
        arguments: &[Argument],
    ) -> u64 {
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
pub(super) enum Outcome {
    Constant(Constant),
    Argument(u32),
    Result(u32),
}

/// A finished shared function.
#[derive(Debug)]
pub(super) struct Rule {
    pub(super) key: Key,
    /// The function, whose callees are [`SHARED`] and an index of `callees`; none where every
    /// result is a constant or an argument.
    function: Option<Function>,
    /// The types of the function's results.
    types: Arc<[Type]>,
    callees: Vec<Arc<Rule>>,
    pub(super) outcomes: Vec<Outcome>,
}

/// The most rules that a process keeps: each is some kilobytes.
const MOST: usize = 4096;

/// The rules that this process has built.
static KNOWN: LazyLock<RwLock<FxHashMap<Key, Arc<Rule>>>> = LazyLock::new(RwLock::default);

/// The rule of this key, from those that are ready or by `build`.
pub(super) fn rule(key: Key, build: impl FnOnce(Key) -> Rule) -> Arc<Rule> {
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
pub(crate) struct Library(pub(super) Rc<RefCell<Shelves>>);

/// What a library holds.
#[derive(Debug, Default)]
pub(crate) struct Shelves {
    pub(super) known: HashTable<Placed>,
    /// The functions that were called, callees first.
    pub(super) rules: Vec<Arc<Rule>>,
}

/// A rule, and its function as one of the module.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) hash: u64,
    pub(super) rule: Arc<Rule>,
    pub(super) function: Option<FunctionRef>,
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
    pub(super) fn reference(&mut self, rule: &Arc<Rule>) -> Option<FunctionRef> {
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

impl Rule {
    pub(super) fn of(
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
