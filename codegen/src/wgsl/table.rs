//! Where a shader reads its tables from: the one place that knows.
//!
//! A texture holds number `index` in row `index / `[`TABLE_WIDTH`], read without a sampler. As an
//! argument it is handed down to whatever reads a number.

use super::{Options, TABLES_BINDING};
use crate::ir::{FunctionId, Inst, Module};
use serde::Serialize;
use std::fmt::Write;

/// The numbers in a row of a texture of tables: WebGL 2 promises textures of 2048 by 2048.
pub const TABLE_WIDTH: u32 = 2048;

/// Where the tables are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TableForm {
    /// In a storage buffer.
    #[default]
    Storage,
    /// In a texture of one `f32` a texel, for hosts without storage buffers.
    Texture,
    /// In such a texture, which is the first argument of the texture's function, for hosts that bind
    /// textures themselves. An entry point declares and passes it.
    Argument,
}

/// What the argument is called.
pub(super) const ARGUMENT: &str = "tables";
/// Its type.
pub(super) const ARGUMENT_TYPE: &str = "texture_2d<f32>";

/// How the functions of a shader read its tables.
#[derive(Debug)]
pub(super) struct Reading<'a> {
    form: TableForm,
    /// The variable at module scope.
    variable: &'a str,
    /// The function that reads a number of a texture.
    reader: Option<String>,
    /// The functions that take the argument.
    takes: Vec<bool>,
}

impl<'a> Reading<'a> {
    /// Of a module; `reader` is the name of what reads a number of a texture.
    pub(super) fn new(
        module: &Module,
        form: TableForm,
        variable: &'a str,
        reader: Option<String>,
    ) -> Self {
        let mut takes = vec![false; module.functions.len()];
        if form == TableForm::Argument {
            // Callees stand before their callers.
            for (index, function) in module.functions.iter().enumerate() {
                takes[index] = function.insts.iter().any(|inst| match inst {
                    Inst::Load(..) => true,
                    Inst::Call(callee, _)
                    | Inst::Fold {
                        function: callee, ..
                    } => takes[callee.index()],
                    _ => false,
                });
            }
        }
        Self {
            form,
            variable,
            reader,
            takes,
        }
    }

    /// Of functions that read none.
    pub(super) const fn none() -> Self {
        Self {
            form: TableForm::Storage,
            variable: "",
            reader: None,
            takes: Vec::new(),
        }
    }

    /// Whether a function takes the tables as its first argument.
    pub(super) fn is_argument_of(&self, id: FunctionId) -> bool {
        self.takes.get(id.index()).is_some_and(|&takes| takes)
    }

    /// What stands before and behind the index of a number.
    pub(super) fn around(&self) -> (String, &'static str) {
        match (&self.reader, self.form) {
            (Some(reader), TableForm::Argument) => (format!("{reader}({ARGUMENT}, "), ")"),
            (Some(reader), _) => (format!("{reader}("), ")"),
            (None, _) => (format!("{}[", self.variable), "]"),
        }
    }

    /// Appends the declaration of the tables, and of what reads them.
    pub(super) fn push(&self, out: &mut String, options: &Options) {
        if self.form != TableForm::Argument {
            push_variable(out, options, self.variable);
        }
        let Some(reader) = &self.reader else { return };
        let (argument, texture) = match self.form {
            TableForm::Argument => (format!("{ARGUMENT}: {ARGUMENT_TYPE}, "), ARGUMENT),
            _ => (String::new(), self.variable),
        };
        let (mask, shift) = (TABLE_WIDTH - 1, TABLE_WIDTH.trailing_zeros());
        write!(
            out,
            "/// A number of the tables, of which a row of the texture holds {TABLE_WIDTH}.\n\
             fn {reader}({argument}index: u32) -> f32 {{\n    \
             return textureLoad({texture}, vec2i(i32(index & {mask}u), i32(index >> {shift}u)), 0i).x;\n\
             }}\n\n"
        )
        .expect("a string takes all text");
    }
}

/// Appends the declaration of the tables at module scope.
pub(super) fn push_variable(out: &mut String, options: &Options, name: &str) {
    let (group, binding) = (options.group, options.binding + TABLES_BINDING);
    let (space, ty) = match options.tables {
        TableForm::Storage => ("<storage, read>", "array<f32>"),
        TableForm::Texture | TableForm::Argument => ("", ARGUMENT_TYPE),
    };
    writeln!(
        out,
        "@group({group}) @binding({binding}) var{space} {name}: {ty};\n"
    )
    .expect("a string takes all text");
}
