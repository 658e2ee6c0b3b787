//! One function of the IR as WGSL functions: signatures, parts, structs.

mod body;
mod local;

use super::expression::level;
use super::name::{Scope, camel, capitals, internal, push_letters};
use super::part::{Item, Part, split};
use super::statement::{self, Statements, choose, is_single};
use super::table::{ARGUMENT, ARGUMENT_TYPE, Reading};
use crate::ir::{Function, FunctionId, Inst, Module, Type, Value};

/// The most parameters of a function; beyond that they are packed into a struct.
const PARAMETERS: usize = 200;

/// How callers see a function.
#[derive(Debug)]
pub(super) struct Signature {
    /// The WGSL name.
    pub(super) name: String,
    /// The struct that the arguments are packed into, if there are too many.
    pub(super) packed: Option<String>,
    /// The struct of the results, unless there is one.
    pub(super) results: Option<String>,
    /// The names of the results.
    pub(super) fields: Vec<String>,
    /// The name as that of a type.
    pub(super) camel: String,
}

impl Signature {
    /// Of the texture's function.
    pub(super) fn of_entry(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            packed: None,
            results: None,
            fields: Vec::new(),
            camel: camel(name),
        }
    }

    /// Of a function of this name.
    pub(super) fn new(name: String, function: &Function, globals: &mut Scope) -> Self {
        let camel = camel(&name);
        Self::spelled(name, camel, function, globals)
    }

    /// The same, where the name as that of a type is known.
    pub(super) fn spelled(
        name: String,
        camel: String,
        function: &Function,
        globals: &mut Scope,
    ) -> Self {
        let mut fields = Scope::default();
        Self {
            packed: is_packed(function.params.len()).then(|| globals.take(format!("{camel}Args"))),
            results: (function.results.len() > 1).then(|| globals.take(camel.clone())),
            fields: (function.results.iter())
                .map(|(field, _)| fields.take(internal(field)))
                .collect(),
            name,
            camel,
        }
    }
}

/// What all functions of a shader share.
#[derive(Clone, Debug)]
pub(super) struct Context<'a> {
    /// The functions and tables.
    pub(super) module: &'a Module,
    /// One for each function that is reached; by position in the module.
    pub(super) signatures: &'a [Option<Signature>],
    /// Every name at module scope.
    pub(super) globals: Scope,
    /// How the tables are read.
    pub(super) tables: &'a Reading<'a>,
    /// Where each table starts in it.
    pub(super) table_offsets: &'a [u32],
    /// The text so far.
    pub(super) out: String,
}

/// How the entry differs from other functions.
#[derive(Debug)]
pub(super) struct EntryText {
    /// The parameters and the result: `footprint: Footprint) -> MarbleOutputs`.
    pub(super) signature: String,
    /// The names of arguments that no local may have, beside those of a texture's function.
    pub(super) arguments: Vec<&'static str>,
    /// How each parameter of the IR function is spelled.
    pub(super) parameters: Vec<String>,
    /// The result: text, and the first result after it.
    pub(super) results: Vec<(String, Option<usize>)>,
}

/// The value is spelled by its own name, or as a field of its call.
const OWN: u32 = 0;
/// The value is spelled by its own name, wherever it was defined.
const BARE: u32 = 1;
/// The value is a field of the packed arguments.
const PACKED: u32 = 2;
/// The value is a parameter of the entry.
const ENTRY: u32 = 3;
/// From here on: the value is a field of the result of the part of this number.
const PART: u32 = 4;

/// Marks a generated name `t_…` among the locals.
const GENERATED: u32 = 1 << 31;

struct Writer<'c, 'a> {
    context: &'c mut Context<'a>,
    function: &'a Function,
    /// Whether it takes the tables as its first argument, and so do its parts.
    takes_tables: bool,
    statements: Statements,
    entry: Option<&'c EntryText>,
    /// Where each value is found at the moment.
    places: Vec<u32>,
    /// The name of each value: 0 none yet, else 1 + the index in `strings`, or a generated number.
    locals: Vec<u32>,
    strings: Vec<String>,
    scope: Scope,
    generated: u32,
    /// The WGSL names of the parts and of the structs of their arguments and results.
    part_signatures: Vec<Signature>,
    /// The names at module scope that the parts take.
    taken: Vec<String>,
    /// A constant that is spelled as a variable: see [`Writer::hide_constant`].
    hidden: Option<(Value, u32)>,
}

/// What the text of a function takes beside its name.
#[derive(Debug)]
pub(super) struct Written {
    /// The names of its locals.
    pub(super) locals: Vec<String>,
    /// How many parts it has.
    pub(super) parts: usize,
    /// What its parts and their structs are called.
    pub(super) taken: Vec<String>,
}

/// Appends function `id` with its structs and parts.
pub(super) fn write(
    context: &mut Context<'_>,
    id: FunctionId,
    entry: Option<&EntryText>,
) -> Written {
    let module = context.module;
    let function = module.function(id);
    let size = function.insts.len();
    let mut scope = Scope::default();
    let arguments = entry.map_or(&[][..], |entry| &entry.arguments);
    for &taken in ["i", "args", "footprint", "parameters"]
        .iter()
        .chain(arguments)
    {
        scope.take(taken.to_owned());
    }
    let takes_tables = context.tables.is_argument_of(id);
    if takes_tables {
        scope.take(ARGUMENT.to_owned());
    }
    let mut writer = Writer {
        context,
        function,
        takes_tables,
        statements: choose(module, function),
        entry,
        places: vec![OWN; size],
        locals: vec![0; size],
        strings: Vec::new(),
        scope,
        generated: 0,
        part_signatures: Vec::new(),
        taken: Vec::new(),
        hidden: None,
    };
    let params = writer.name_parameters();
    writer.whole(id, &params);
    Written {
        locals: writer.strings,
        parts: writer.part_signatures.len(),
        taken: writer.taken,
    }
}

impl<'a> Writer<'_, 'a> {
    fn whole(&mut self, id: FunctionId, params: &[Option<Value>]) {
        let module = self.context.module;
        let function = self.function;
        let inlined = std::mem::take(&mut self.statements.inlined);
        let weighted: Vec<(Value, u32)> = (self.statements.order.iter())
            .map(|&v| (v, self.weight(v)))
            .collect();
        let mut results = Vec::new();
        for &(_, value) in &function.results {
            statement::named(module, function, &inlined, value, &mut |v| results.push(v));
        }
        let split = split(
            function.insts.len(),
            &weighted,
            |v, visit| statement::inputs(module, function, &inlined, v, &mut |v| visit(v)),
            |v| match function.inst(v) {
                Inst::Param(_) => None,
                Inst::Result(of, _) if !is_single(module, function.inst(*of)) => Some(*of),
                _ => Some(v),
            },
            &results,
        );
        self.statements.inlined = inlined;
        let total = split.parts.len();
        for (number, part) in split.parts.iter().enumerate() {
            self.part(id, number, total, part, &split.parts);
        }

        let signature = self.signature(id);
        let (name, packed) = (signature.name.clone(), signature.packed.clone());
        let results = signature.results.clone();
        if self.entry.is_none() {
            if let Some(packed) = &packed {
                let fields: Vec<_> = (function.params.iter().enumerate())
                    .map(|(i, p)| (self.strings[i].clone(), p.ty))
                    .collect();
                self.push_struct(packed, &fields);
            }
            if let Some(results) = &results {
                let names = self.signature(id).fields.clone();
                let types = function.results.iter().map(|&(_, v)| function.ty(v));
                let fields: Vec<_> = names.into_iter().zip(types).collect();
                self.push_struct(results, &fields);
            }
        }
        let place = match (self.entry, &packed) {
            (Some(_), _) => ENTRY,
            (None, Some(_)) => PACKED,
            (None, None) => BARE,
        };
        params
            .iter()
            .flatten()
            .for_each(|v| self.places[v.index()] = place);

        self.push_doc(&function.doc);
        self.push("fn ");
        self.push(&name);
        self.push("(");
        if let Some(entry) = self.entry {
            self.push(&entry.signature);
        } else {
            self.push_tables_parameter(function.params.is_empty());
            if let Some(packed) = &packed {
                self.push("args: ");
                self.push(packed);
            } else {
                for (index, param) in function.params.iter().enumerate() {
                    self.push(if index == 0 { "" } else { ", " });
                    self.context.out.push_str(&self.strings[index]);
                    self.push(": ");
                    self.push(param.ty.name());
                }
            }
            self.push(") -> ");
            match &results {
                Some(results) => self.push(results),
                None => self.push(function.ty(function.results[0].1).name()),
            }
        }
        self.push(" {\n");
        for &item in &split.items {
            self.item(item, &split.parts);
        }
        self.push("    return ");
        if let Some(entry) = self.entry {
            for (text, result) in &entry.results {
                self.push(text);
                if let Some(result) = result {
                    self.operand(function.results[*result].1, level::ARGUMENT);
                }
            }
        } else if let Some(results) = &results {
            self.push(results);
            self.push("(");
            for (index, &(_, value)) in function.results.iter().enumerate() {
                self.push(if index == 0 { "" } else { ", " });
                self.operand(value, level::ARGUMENT);
            }
            self.push(")");
        } else {
            self.operand(function.results[0].1, level::ANY);
        }
        self.push(";\n}\n\n");
    }

    fn weight(&self, statement: Value) -> u32 {
        let inst = match self.function.inst(statement) {
            Inst::Result(of, _) => self.function.inst(*of),
            inst => inst,
        };
        if matches!(inst, Inst::Fold { .. }) {
            3
        } else {
            1
        }
    }

    fn part(&mut self, id: FunctionId, number: usize, total: usize, part: &Part, all: &[Part]) {
        let whole = self.signature(id);
        let base = whole.name.clone();
        let camel = format!("{}Part{}", whole.camel, capitals(number as u32));
        let mut name = format!("{base}_part_");
        push_letters(&mut name, number as u32);
        let name = self.take(name);
        let packed = (part.inputs.len() > PARAMETERS).then(|| self.take(format!("{camel}Args")));
        let results = (part.outputs.len() > 1).then(|| self.take(camel));
        if let Some(packed) = &packed {
            self.push_values_struct(packed, &part.inputs);
        }
        if let Some(results) = &results {
            self.push_values_struct(results, &part.outputs);
        }
        self.push_doc(&format!("Part {} of {total} of {base}.", number + 1));
        self.push("fn ");
        self.push(&name);
        self.push("(");
        self.push_tables_parameter(part.inputs.is_empty());
        if let Some(packed) = &packed {
            self.push("args: ");
            self.push(packed);
        } else {
            for (index, &input) in part.inputs.iter().enumerate() {
                self.push(if index == 0 { "" } else { ", " });
                self.local_name(input);
                self.push(": ");
                self.push(self.function.ty(input).name());
            }
        }
        self.push(") -> ");
        let only = self.function.ty(part.outputs[0]);
        self.push(results.as_deref().unwrap_or(only.name()));
        self.push(" {\n");
        let place = if packed.is_some() { PACKED } else { BARE };
        part.inputs
            .iter()
            .for_each(|v| self.places[v.index()] = place);
        for &item in &part.items {
            self.item(item, all);
        }
        self.push("    return ");
        if let Some(results) = &results {
            self.push(results);
            self.push("(");
        }
        for (index, &value) in part.outputs.iter().enumerate() {
            self.push(if index == 0 { "" } else { ", " });
            self.name(value);
        }
        self.push(if results.is_some() {
            ");\n}\n\n"
        } else {
            ";\n}\n\n"
        });
        self.part_signatures.push(Signature {
            name,
            packed,
            results,
            fields: Vec::new(),
            camel: String::new(),
        });
    }

    /// The declaration of the tables among the parameters, if they are one.
    fn push_tables_parameter(&mut self, is_only: bool) {
        if self.takes_tables {
            self.push(ARGUMENT);
            self.push(": ");
            self.push(ARGUMENT_TYPE);
            self.push(if is_only { "" } else { ", " });
        }
    }

    /// The tables among the arguments of a call.
    fn push_tables_argument(&mut self, is_only: bool) {
        self.push(ARGUMENT);
        self.push(if is_only { "" } else { ", " });
    }

    /// A name at module scope.
    fn take(&mut self, name: String) -> String {
        let name = self.context.globals.take(name);
        self.taken.push(name.clone());
        name
    }

    fn item(&mut self, item: Item, parts: &[Part]) {
        match item {
            Item::Statement(value) => self.statement(value),
            Item::Part(number) => self.call_part(number, &parts[number as usize]),
        }
    }

    fn call_part(&mut self, number: u32, part: &Part) {
        let signature = &self.part_signatures[number as usize];
        let (name, packed) = (signature.name.clone(), signature.packed.clone());
        self.push("    let ");
        if let [output] = part.outputs[..] {
            self.local_name(output);
        } else {
            self.push("p_");
            push_letters(&mut self.context.out, number);
        }
        self.push(" = ");
        self.push(&name);
        self.push("(");
        if self.takes_tables {
            self.push_tables_argument(part.inputs.is_empty());
        }
        if let Some(packed) = &packed {
            self.push(packed);
            self.push("(");
        }
        for (index, &value) in part.inputs.iter().enumerate() {
            self.push(if index == 0 { "" } else { ", " });
            self.name(value);
        }
        self.push(if packed.is_some() { "));\n" } else { ");\n" });
        let place = if part.outputs.len() == 1 {
            BARE
        } else {
            PART + number
        };
        for value in &part.outputs {
            self.places[value.index()] = place;
        }
    }

    fn signature(&self, id: FunctionId) -> &Signature {
        self.context.signatures[id.index()]
            .as_ref()
            .expect("the function is reached")
    }

    fn push(&mut self, text: &str) {
        self.context.out.push_str(text);
    }

    fn push_doc(&mut self, doc: &str) {
        push_doc(&mut self.context.out, doc);
    }

    /// A struct of values under their local names.
    fn push_values_struct(&mut self, name: &str, values: &[Value]) {
        self.push("struct ");
        self.push(name);
        self.push(" {\n");
        for &value in values {
            self.push("    ");
            self.local_name(value);
            self.push(": ");
            self.push(self.function.ty(value).name());
            self.push(",\n");
        }
        self.push("}\n\n");
    }

    fn push_struct(&mut self, name: &str, fields: &[(String, Type)]) {
        let out = &mut self.context.out;
        out.push_str("struct ");
        out.push_str(name);
        out.push_str(" {\n");
        for (field, ty) in fields {
            out.push_str("    ");
            out.push_str(field);
            out.push_str(": ");
            out.push_str(ty.name());
            out.push_str(",\n");
        }
        out.push_str("}\n\n");
    }
}

/// Appends a documentation comment of one line.
pub(super) fn push_doc(out: &mut String, doc: &str) {
    if doc.trim().is_empty() {
        return;
    }
    out.push_str("/// ");
    // Line ends of any script would end the comment early.
    let is_break = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    out.extend(
        doc.trim()
            .chars()
            .map(|c| if is_break(c) { ' ' } else { c }),
    );
    out.push('\n');
}

/// Whether a function of this many parameters takes them packed into a struct.
fn is_packed(parameters: usize) -> bool {
    parameters > PARAMETERS
}
