//! The functions that shade the texture's outputs, beside its own.
//!
//! They take the struct of outputs itself: whatever outputs are called as the parts of a material are read,
//! and of what is not there a constant stands.

use super::entry::{Face, Names};
use super::function::{Context, EntryText, Signature, write};
use super::name::callable;
use super::table::Reading;
use crate::ir::FunctionId;
use crate::shade::{FIELDS, Hiding, Lighting, absent};
use std::fmt::Write as _;

const AXES: [&str; 4] = ["x", "y", "z", "w"];

/// The types of what follows the surface, by the number of their components.
fn type_of(components: usize) -> String {
    match components {
        3 => "vec3f".to_owned(),
        n => format!("array<vec3f, {}>", n / 3),
    }
}

/// Appends the functions; returns their names.
pub(super) fn push(
    context: &mut Context<'_>,
    names: &Names,
    face: &Face,
    stem: &str,
) -> Vec<String> {
    [Lighting::Light, Lighting::Sky]
        .map(|lighting| push_one(context, names, face, stem, lighting))
        .into()
}

fn push_one(
    context: &mut Context<'_>,
    names: &Names,
    face: &Face,
    stem: &str,
    lighting: Lighting,
) -> String {
    let name = (context.globals).take(callable(format!("{stem}_{}", lighting.name())));
    let module = lighting.module(Hiding::Facets);
    let signatures = [Some(Signature::of_entry(&name))];
    let mut signature = format!("surface: {}", names.outputs);
    let mut arguments = vec!["surface"];
    let mut parameters = Vec::new();
    for (field, components) in FIELDS {
        let output = face
            .outputs
            .iter()
            .find(|output| output.name == field && !output.variance);
        for axis in &AXES[..components] {
            parameters.push(match output {
                Some(output) if components == 1 => format!("surface.{}", output.field),
                Some(output) => format!("surface.{}.{axis}", output.field),
                None => format!("{:?}", absent(field)),
            });
        }
    }
    for &(argument, components) in lighting.arguments() {
        arguments.push(argument);
        write!(signature, ", {argument}: {}", type_of(components))
            .expect("a string takes all text");
        for k in 0..components {
            let element = if components == 3 {
                String::new()
            } else {
                format!("[{}]", k / 3)
            };
            parameters.push(format!("{argument}{element}.{}", AXES[k % 3]));
        }
    }
    signature.push_str(") -> vec3f");
    let results = vec![
        ("vec3f(".to_owned(), Some(0)),
        (", ".to_owned(), Some(1)),
        (", ".to_owned(), Some(2)),
        (")".to_owned(), None),
    ];
    let text = EntryText {
        signature,
        arguments,
        parameters,
        results,
    };
    let mut own = Context {
        module: &module,
        signatures: &signatures,
        globals: std::mem::take(&mut context.globals),
        tables: &Reading::none(),
        table_offsets: &[],
        out: std::mem::take(&mut context.out),
    };
    write(&mut own, FunctionId::from_index(0), Some(&text));
    let Context { globals, out, .. } = own;
    (context.globals, context.out) = (globals, out);
    name
}
