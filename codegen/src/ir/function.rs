//! A function: its name in a module, and its body, which modules share.

use super::{Constant, FunctionId, Inst, Type, Value};
use crate::wgsl::Spelled;
use rustc_hash::FxHashMap;
use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};

/// A named, typed parameter or result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// A readable name (an identifier in lower snake case), unique in its function.
    pub name: String,
    /// The type.
    pub ty: Type,
}

/// A readable name of a value: a stem, which several values may share, and what follows it.
#[derive(Clone, Debug)]
pub struct Label {
    stem: Arc<str>,
    rest: [&'static str; 2],
}

impl Label {
    /// The name that is these three texts in a row.
    pub fn of_parts(stem: &Arc<str>, rest: [&'static str; 2]) -> Self {
        Self {
            stem: Arc::clone(stem),
            rest,
        }
    }
}

impl<T: Into<Arc<str>>> From<T> for Label {
    fn from(name: T) -> Self {
        Self {
            stem: name.into(),
            rest: [""; 2],
        }
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.stem)?;
        self.rest.iter().try_for_each(|part| f.write_str(part))
    }
}

impl PartialEq for Label {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

/// A pure function over scalars. What it computes is its [`Body`], which is copied when a function
/// that shares it is changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// A readable name (an identifier in lower snake case), unique in the module.
    pub name: String,
    body: Arc<Body>,
}

/// What a function computes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// One sentence that says what it computes; printed above the function in WGSL.
    pub doc: String,
    /// The parameters, in order.
    pub params: Vec<Parameter>,
    /// The definitions; [`Value`] indexes them.
    pub insts: Vec<Inst>,
    /// The type of each definition (meaningless for [`Inst::Call`] and [`Inst::Fold`]).
    pub types: Vec<Type>,
    /// Readable names of some values.
    pub names: FxHashMap<Value, Label>,
    /// The named results, in order.
    pub results: Vec<(String, Value)>,
    /// What back ends keep with the body.
    pub(crate) kept: Kept,
}

/// What is kept with the body of a function that modules share, and follows from it alone: its text,
/// once it was written. It is no part of what a body is.
#[derive(Debug, Default)]
pub(crate) struct Kept(Option<Arc<OnceLock<Spelled>>>);

impl Kept {
    /// Of a function that modules share.
    pub(crate) fn shared() -> Self {
        Self(Some(Arc::default()))
    }

    /// Whether modules share the function.
    pub(crate) fn is_shared(&self) -> bool {
        self.0.is_some()
    }

    /// The same for a copy that computes the same.
    pub(super) fn of_copy(&self) -> Self {
        Self(self.0.clone())
    }

    /// The text, where it is worth keeping.
    pub(crate) fn text(&self, write: impl FnOnce() -> Spelled) -> Option<&Spelled> {
        self.0.as_ref().map(|text| text.get_or_init(write))
    }
}

impl Clone for Kept {
    /// Nothing: a body is copied to be changed.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Kept {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Function {
    /// A function of this body.
    pub fn new(name: String, body: Body) -> Self {
        Self {
            name,
            body: Arc::new(body),
        }
    }

    /// The name without the number that made it unique.
    pub(crate) fn stem(&self) -> &str {
        let digits = self.name.trim_end_matches(|c: char| c.is_ascii_digit());
        match digits.strip_suffix('_') {
            Some(stem) if digits.len() < self.name.len() && !stem.is_empty() => stem,
            _ => &self.name,
        }
    }
}

impl Deref for Function {
    type Target = Body;

    fn deref(&self) -> &Body {
        &self.body
    }
}

impl DerefMut for Function {
    fn deref_mut(&mut self) -> &mut Body {
        Arc::make_mut(&mut self.body)
    }
}

impl Body {
    /// The definition of `value`.
    pub fn inst(&self, value: Value) -> &Inst {
        &self.insts[value.index()]
    }

    /// The type of `value`.
    pub fn ty(&self, value: Value) -> Type {
        self.types[value.index()]
    }

    /// The constant that `value` is, if it is one.
    pub fn constant(&self, value: Value) -> Option<Constant> {
        match self.inst(value) {
            Inst::Const(constant) => Some(*constant),
            _ => None,
        }
    }

    /// The types of the results.
    pub(crate) fn result_types(&self) -> Arc<[Type]> {
        self.results.iter().map(|&(_, v)| self.ty(v)).collect()
    }

    /// The functions that it calls, in the order of their first calls.
    pub(crate) fn callees(&self) -> Vec<FunctionId> {
        let mut callees = Vec::new();
        for inst in &self.insts {
            if let Inst::Call(id, _) | Inst::Fold { function: id, .. } = inst
                && !callees.contains(id)
            {
                callees.push(*id);
            }
        }
        callees
    }
}

/// A finished function of a module, as a callee.
#[derive(Clone, Debug)]
pub struct FunctionRef {
    /// Which.
    pub id: FunctionId,
    /// The types of its results.
    pub results: Arc<[Type]>,
}
