//! Programs by what they are of: a graph that is the same to the last name is compiled once in a process,
//! whichever session has it, and again after an undo.

use super::digest::Digest;
use crate::{Catalogue, TextureEvaluator};
use mipless_codegen::ir::{Numbers, Program};
use mipless_codegen::wgsl::{self, Shader};
use mipless_codegen::{Method, Options};
use mipless_graph::{Checked, Output, Parameter};
use rustc_hash::FxHashMap;
use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError, Weak};

/// How many programs a process keeps that no session has any more.
const KEPT: usize = 32;

/// A graph of which a program is made when it is asked for. Nothing of it changes.
pub struct Compiled {
    checked: Arc<Checked>,
    catalogue: Catalogue,
    options: Options,
    program: OnceLock<Program>,
    shaders: Mutex<Vec<(wgsl::Options, Arc<Shader>)>>,
}

/// A graph with the catalogue that it was resolved with, which stays where it is as long as a program of it
/// is known.
type Key = (Digest, usize);

#[derive(Default)]
struct Known {
    programs: FxHashMap<Key, Weak<Compiled>>,
    latest: VecDeque<Arc<Compiled>>,
}

static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);

impl Compiled {
    /// The graph of this digest, by these options.
    pub(super) fn of(
        checked: &Arc<Checked>,
        digest: Digest,
        catalogue: &Catalogue,
        options: &Options,
    ) -> Arc<Self> {
        let key = (digest, catalogue.identity());
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(compiled) = known.programs.get(&key).and_then(Weak::upgrade) {
            return compiled;
        }
        let compiled = Arc::new(Self {
            checked: Arc::clone(checked),
            catalogue: catalogue.clone(),
            options: *options,
            program: OnceLock::new(),
            shaders: Mutex::default(),
        });
        if known.programs.len() >= 4 * KEPT {
            known
                .programs
                .retain(|_, program| program.strong_count() > 0);
        }
        known.programs.insert(key, Arc::downgrade(&compiled));
        if known.latest.len() >= KEPT {
            known.latest.pop_front();
        }
        known.latest.push_back(Arc::clone(&compiled));
        compiled
    }

    /// The checked graph: the outputs that no mistake reaches, and what they need.
    pub fn checked(&self) -> &Checked {
        &self.checked
    }

    /// Its outputs, in their order.
    pub fn outputs(&self) -> &[Output] {
        &self.checked.graph().outputs
    }

    /// Its inputs; their values are those at which it was compiled.
    pub fn parameters(&self) -> &[Parameter] {
        &self.checked.graph().parameters
    }

    /// By which method it is filtered.
    pub fn method(&self) -> Method {
        self.options.method
    }

    /// The program, compiled when it is first asked for.
    pub fn program(&self) -> &Program {
        self.program.get_or_init(|| {
            mipless_codegen::compile(&self.checked, self.catalogue.definitions(), &self.options)
        })
    }

    /// The WGSL of the program, written once for the same options.
    pub fn shader(&self, options: &wgsl::Options) -> Arc<Shader> {
        let mut shaders = self.shaders.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, shader)) = shaders.iter().find(|(known, _)| known == options) {
            return Arc::clone(shader);
        }
        let shader = Arc::new(wgsl::emit(self.program(), options));
        shaders.push((*options, Arc::clone(&shader)));
        shader
    }

    /// An evaluator on the CPU.
    pub fn evaluator(&self) -> TextureEvaluator {
        TextureEvaluator::new(self.parameters().to_vec(), self.program())
    }

    /// The tables of the program by their names. Their numbers are computed when they are read.
    pub fn tables(&self) -> impl Iterator<Item = (&str, &Numbers)> {
        let tables = self.program().module.tables.iter();
        tables.map(|table| (table.name.as_str(), &table.data))
    }

    /// The names of the tables that are not those of an earlier program: what a host uploads anew.
    pub fn new_tables(&self, before: Option<&Self>) -> Vec<String> {
        let known: Vec<&Numbers> = before
            .into_iter()
            .flat_map(|before| before.tables().map(|(_, numbers)| numbers))
            .collect();
        let is_new = |numbers: &Numbers| {
            let mut known = known.iter();
            !known.any(|known| known.is_shared_with(numbers))
        };
        let tables = self.tables().filter(|(_, numbers)| is_new(numbers));
        tables.map(|(name, _)| name.to_owned()).collect()
    }
}

impl fmt::Debug for Compiled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Compiled")
            .field("name", &self.checked.graph().name)
            .field("method", &self.options.method)
            .field("is_compiled", &self.program.get().is_some())
            .finish_non_exhaustive()
    }
}
