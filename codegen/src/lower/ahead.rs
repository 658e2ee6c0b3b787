//! Lowering on a second thread: `auto` needs the graph in two modes, which have nothing in common but
//! the functions that both call.
//!
//! What comes of it is put together as if one had been lowered after the other, to the byte.

use super::Compiler;
use super::function::graph_function;
use crate::ir::{FunctionId, FunctionRef, Module, Shelves};
use crate::moments::Mode;
use rustc_hash::FxHashMap;
use std::panic::resume_unwind;
use std::thread;

/// From how many nodes on a thread is worth its start.
const LARGE: usize = 48;

/// The graph in one mode, in a module of its own.
pub(super) struct Ahead {
    module: Module,
    function: FunctionRef,
    /// The functions that nodes share, by their keys.
    functions: FxHashMap<String, FunctionRef>,
    shelves: Shelves,
}

/// Runs `meanwhile` and gives its result with a function of the graph in another mode, where it was
/// worth it and can be had: not for graphs whose tables both modes read.
pub(super) fn both<T>(
    compiler: &Compiler<'_>,
    module: &mut Module,
    (mode, name): (Mode, &str),
    meanwhile: impl FnOnce(&mut Module) -> T,
) -> (T, Option<Ahead>) {
    let Compiler {
        graph,
        facts,
        catalogue,
        options,
        ..
    } = *compiler;
    if facts.order.len() < LARGE || !graph.images.is_empty() {
        return (meanwhile(module), None);
    }
    let lower = || {
        let compiler = Compiler::new((graph, facts), catalogue, options);
        let mut module = Module::default();
        let (function, _) = graph_function(&compiler, &mut module, mode, name);
        Ahead {
            module,
            function,
            functions: compiler.functions.take(),
            shelves: compiler.library.into_shelves(),
        }
    };
    thread::scope(|scope| {
        // Where there are no threads, the caller lowers one after the other.
        let thread = thread::Builder::new().spawn_scoped(scope, lower).ok();
        let done = meanwhile(module);
        let join = |t: thread::ScopedJoinHandle<'_, Ahead>| {
            t.join().unwrap_or_else(|panic| resume_unwind(panic))
        };
        (done, thread.map(join))
    })
}

impl Ahead {
    /// Adds the functions to those of `module`; those of a key that is known there already are it.
    /// `None` where tables were made, which the two modes share.
    pub(super) fn join(self, compiler: &Compiler<'_>, module: &mut Module) -> Option<FunctionRef> {
        if !self.module.tables.is_empty() || !module.tables.is_empty() {
            return None;
        }
        let shared = compiler.library.adopt(&self.shelves);
        let mut keys: FxHashMap<FunctionId, String> = (self.functions.into_iter())
            .map(|(key, function)| (function.id, key))
            .collect();
        let mut functions = compiler.functions.borrow_mut();
        let mut places: Vec<FunctionId> = Vec::new();
        for (index, mut function) in self.module.functions.into_iter().enumerate() {
            let key = keys.remove(&FunctionId::from_index(index));
            if let Some(known) = key.as_ref().and_then(|key| functions.get(key)) {
                places.push(known.id);
                continue;
            }
            function.redirect(|id| shared.get(id).unwrap_or_else(|| places[id.index()]));
            let id = FunctionId::from_index(module.functions.len());
            if let Some(key) = key {
                let results = function.result_types();
                functions.insert(key, FunctionRef { id, results });
            }
            module.functions.push(function);
            places.push(id);
        }
        Some(FunctionRef {
            id: places[self.function.id.index()],
            results: self.function.results,
        })
    }
}
