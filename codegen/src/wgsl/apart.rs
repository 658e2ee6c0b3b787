//! Writing long functions on threads of their own.
//!
//! The text is that of one thread, to the byte: functions have nothing in common but the names at
//! module scope, and where a name of one is one of another's, they are written one after the other.

use super::function::{self, Context, Written};
use super::spelled;
use crate::ir::FunctionId;
use std::panic::resume_unwind;
use std::thread;

/// From how many instructions on a thread is worth its start.
const LONG: usize = 1_000;
/// How many functions are written beside each other, at most.
const MOST: usize = 8;

/// Appends functions, in order.
pub(super) fn write(context: &mut Context<'_>, functions: &[FunctionId]) {
    let module = context.module;
    let is_long = |id: &&FunctionId| {
        let function = module.function(**id);
        function.insts.len() >= LONG && !function.kept.is_shared()
    };
    let mut long: Vec<FunctionId> = functions.iter().filter(is_long).copied().collect();
    long.truncate(MOST);
    let own = long.pop();
    let start = Context {
        out: String::new(),
        ..context.clone()
    };
    let alone = |id: FunctionId| {
        let mut context = start.clone();
        context.out.reserve(40 * module.function(id).insts.len());
        let written = function::write(&mut context, id, None);
        (id, written, context.out)
    };
    let alone = &alone;
    thread::scope(|scope| {
        let threads: Vec<_> = (long.iter())
            .map(|&id| {
                let thread = thread::Builder::new().spawn_scoped(scope, move || alone(id));
                (id, thread)
            })
            .collect();
        let own = if threads.is_empty() {
            None
        } else {
            own.map(alone)
        };
        let others = threads.into_iter().map(|(id, thread)| match thread {
            Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
            // Where there are no threads, it is written here.
            Err(_) => alone(id),
        });
        let mut done = others.chain(own).peekable();
        for &id in functions {
            if let Some((_, written, text)) = done.next_if(|(done, ..)| *done == id)
                && adopt(context, &written)
            {
                context.out.push_str(&text);
                continue;
            }
            if !spelled::push(context, id) {
                function::write(context, id, None);
            }
        }
    });
}

/// Takes the names of a function that was written alone, if they are free.
fn adopt(context: &mut Context<'_>, written: &Written) -> bool {
    let free =
        (written.taken.iter().chain(&written.locals)).all(|name| !context.globals.holds(name));
    if free {
        for name in &written.taken {
            context.globals.take(name.clone());
        }
    }
    free
}
