//! The text of functions that modules share: written once in a process, with gaps where the names of
//! the module go.

use super::function::{self, Context, Signature};
use super::gap::{Gap, Spelled};
use super::name::{Scope, capitals, push_letters};
use super::table::Reading;
use crate::ir::{FunctionId, Module};

/// The first of the letters that stand for names while a text is written; those for types follow
/// them one by one. They are of the private use area, so that no identifier has them.
const FIRST: u32 = 0xe000;

/// The letters for a function and its type.
fn letters(place: usize) -> [String; 2] {
    [0, 1].map(|i| {
        let letter = char::from_u32(FIRST + 2 * place as u32 + i);
        letter.expect("the private use area").to_string()
    })
}

/// Writes a function with gaps.
fn spell(module: &Module, id: FunctionId, callees: &[FunctionId]) -> Spelled {
    let mut signatures: Vec<Option<Signature>> = Vec::new();
    signatures.resize_with(module.functions.len(), || None);
    for (place, &named) in std::iter::once(&id).chain(callees).enumerate() {
        let [name, camel] = letters(place);
        let function = module.function(named);
        let signature = Signature::spelled(name, camel, function, &mut Scope::default());
        signatures[named.index()] = Some(signature);
    }
    let mut context = Context {
        module,
        signatures: &signatures,
        globals: Scope::default(),
        tables: &Reading::none(),
        table_offsets: &[],
        out: String::new(),
    };
    let written = function::write(&mut context, id, None);
    let mut pieces = Vec::new();
    let mut rest = context.out.as_str();
    let is_gap = |c: char| (FIRST..FIRST + 2 * (1 + callees.len()) as u32).contains(&(c as u32));
    while let Some(at) = rest.find(is_gap) {
        let letter = rest[at..].chars().next().expect("a letter was found");
        let place = (letter as u32 - FIRST) as usize;
        let gap = match place % 2 {
            0 => Gap::Name(place / 2),
            _ => Gap::Type(place / 2),
        };
        pieces.push((rest[..at].to_owned(), gap));
        rest = &rest[at + letter.len_utf8()..];
    }
    pieces.push((rest.to_owned(), Gap::End));
    Spelled {
        pieces,
        locals: written.locals,
        parts: written.parts,
    }
}

/// Appends function `id` if its text is kept and fits the names of the module; whether it did.
pub(super) fn push(context: &mut Context<'_>, id: FunctionId) -> bool {
    // What is kept is the text of functions that read no tables.
    if context.tables.is_argument_of(id) {
        return false;
    }
    let module = context.module;
    let function = module.function(id);
    let callees = function.callees();
    let Some(spelled) = function.kept.text(|| spell(module, id, &callees)) else {
        return false;
    };
    let signature = |id: FunctionId| {
        let signature = context.signatures[id.index()].as_ref();
        signature.expect("the function is reached")
    };
    let own = signature(id);
    let names: Vec<&Signature> = std::iter::once(own)
        .chain(callees.iter().map(|&callee| signature(callee)))
        .collect();
    let parts: Vec<String> = (0..spelled.parts as u32)
        .flat_map(|part| {
            let camel = format!("{}Part{}", own.camel, capitals(part));
            let args = format!("{camel}Args");
            let mut name = format!("{}_part_", own.name);
            push_letters(&mut name, part);
            [name, camel, args]
        })
        .collect();
    let globals = &context.globals;
    let fits = (names.iter()).all(|s| s.results.as_ref().is_none_or(|r| *r == s.camel))
        && (spelled.locals.iter().chain(&parts)).all(|name| !globals.holds(name));
    if !fits {
        return false;
    }
    for (text, gap) in &spelled.pieces {
        context.out.push_str(text);
        match *gap {
            Gap::End => {}
            Gap::Name(place) => context.out.push_str(&names[place].name),
            Gap::Type(place) => context.out.push_str(&names[place].camel),
        }
    }
    for part in parts {
        context.globals.take(part);
    }
    true
}
