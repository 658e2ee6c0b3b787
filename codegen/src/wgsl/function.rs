//! One function of the IR as WGSL functions.

use super::expression::{Form, form, level, push_constant, push_number};
use super::name::{Scope, identifier, looks_generated};
use super::part::{Item, Part, split};
use super::statement::{self, Count, Statements, choose, is_single};
use crate::ir::{Function, FunctionId, Inst, Module, Op, Type, Value};

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
}

/// What all functions of a shader share.
#[derive(Debug)]
pub(super) struct Context<'a> {
    /// The functions and tables.
    pub(super) module: &'a Module,
    /// One for each function that is reached; by position in the module.
    pub(super) signatures: Vec<Option<Signature>>,
    /// Every name at module scope.
    pub(super) globals: Scope,
    /// The name of the array of tables.
    pub(super) tables: String,
    /// Where each table starts in it.
    pub(super) table_offsets: Vec<u32>,
    /// The text so far.
    pub(super) out: String,
}

/// How the entry differs from other functions.
#[derive(Debug)]
pub(super) struct EntryText {
    /// The parameters and the result: `footprint: Footprint) -> MarbleOutputs`.
    pub(super) signature: String,
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

/// Marks a generated name `t…` among the locals.
const GENERATED: u32 = 1 << 31;

struct Writer<'c, 'a> {
    context: &'c mut Context<'a>,
    function: &'a Function,
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
    /// A constant that is spelled as a variable: see [`Writer::hide_constant`].
    hidden: Option<(Value, u32)>,
}

/// Appends function `id` with its structs and parts.
pub(super) fn write(context: &mut Context<'_>, id: FunctionId, entry: Option<&EntryText>) {
    let module = context.module;
    let function = module.function(id);
    let size = function.insts.len();
    let mut scope = Scope::default();
    for taken in ["i", "args", "footprint", "parameters"] {
        scope.take(taken.to_owned());
    }
    let mut writer = Writer {
        context,
        function,
        statements: choose(module, function),
        entry,
        places: vec![OWN; size],
        locals: vec![0; size],
        strings: Vec::new(),
        scope,
        generated: 0,
        part_signatures: Vec::new(),
        hidden: None,
    };
    let params = writer.name_parameters();
    writer.whole(id, &params);
}

impl<'a> Writer<'_, 'a> {
    /// Names every parameter, in order; returns their values, if they are read.
    fn name_parameters(&mut self) -> Vec<Option<Value>> {
        let mut values = vec![None; self.function.params.len()];
        for (index, inst) in self.function.insts.iter().enumerate() {
            if let Inst::Param(position) = inst {
                values[*position as usize] = Some(Value::from_index(index));
            }
        }
        for (value, param) in values.iter().zip(&self.function.params) {
            let name = self.fresh(&param.name);
            if let Some(value) = value {
                self.strings.push(name);
                self.locals[value.index()] = self.strings.len() as u32;
            } else {
                // Unread parameters still need their place in the signature.
                self.strings.push(name);
            }
        }
        values
    }

    /// A new local name.
    fn fresh(&mut self, text: &str) -> String {
        let mut name = identifier(text);
        if looks_generated(&name) || self.context.globals.holds(&name) {
            name.push_str("_value");
        }
        self.scope.take(name)
    }

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
        let base = self.signature(id).name.clone();
        let name = self
            .context
            .globals
            .take(format!("{base}_part_{}", number + 1));
        let camel = super::name::camel(&name);
        let packed = (part.inputs.len() > PARAMETERS)
            .then(|| self.context.globals.take(format!("{camel}Args")));
        let results = (part.outputs.len() > 1).then(|| self.context.globals.take(camel));
        let typed = |writer: &mut Self, values: &[Value]| -> Vec<(String, Type)> {
            (values.iter())
                .map(|&v| (writer.name_text(v), writer.function.ty(v)))
                .collect()
        };
        let (inputs, outputs) = (typed(self, &part.inputs), typed(self, &part.outputs));
        if let Some(packed) = &packed {
            self.push_struct(packed, &inputs);
        }
        if let Some(results) = &results {
            self.push_struct(results, &outputs);
        }
        self.push_doc(&format!("Part {} of {total} of {base}.", number + 1));
        self.push("fn ");
        self.push(&name);
        self.push("(");
        if let Some(packed) = &packed {
            self.push("args: ");
            self.push(packed);
        } else {
            for (index, (input, ty)) in inputs.iter().enumerate() {
                self.push(if index == 0 { "" } else { ", " });
                self.push(input);
                self.push(": ");
                self.push(ty.name());
            }
        }
        self.push(") -> ");
        self.push(results.as_deref().unwrap_or(outputs[0].1.name()));
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
        });
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
            self.push("p");
            push_number(&mut self.context.out, number + 1);
        }
        self.push(" = ");
        self.push(&name);
        self.push("(");
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

    fn statement(&mut self, value: Value) {
        let inst = self.function.inst(value);
        let of = match inst {
            Inst::Result(of, _) => *of,
            _ => value,
        };
        if let Inst::Fold { count, .. } = self.function.inst(of) {
            let turns = statement::count(self.function, *count);
            if turns != Count::Once {
                return self.fold(value, of, turns);
            }
        }
        self.hide_constant(inst);
        self.push("    let ");
        self.local_name(value);
        self.push(" = ");
        self.definition(value, level::ANY);
        self.push(";\n");
        self.hidden = None;
    }

    /// Makes an op of nothing but constants opaque to WGSL's constant evaluation, which rejects
    /// results that are not finite: the first operand becomes a variable.
    fn hide_constant(&mut self, inst: &Inst) {
        let Inst::Op(op, operands) = inst else { return };
        let operands = &operands[..op.info().operands.len()];
        if operands
            .iter()
            .any(|&v| self.function.constant(v).is_none())
        {
            return;
        }
        self.generated += 1;
        let number = self.generated;
        self.push("    var t");
        push_number(&mut self.context.out, number);
        self.push(" = ");
        self.operand(operands[0], level::ANY);
        self.push(";\n");
        self.hidden = Some((operands[0], number));
    }

    fn fold(&mut self, value: Value, of: Value, turns: Count) {
        let Inst::Fold {
            function: callee,
            init,
            captures,
            ..
        } = self.function.inst(of)
        else {
            unreachable!("the caller has seen a fold");
        };
        let results = self.signature(*callee).results.clone();
        self.push("    var ");
        self.local_name(value);
        self.push(" = ");
        if let Some(results) = &results {
            self.push(results);
            self.push("(");
        }
        for (index, &state) in init.iter().enumerate() {
            self.push(if index == 0 { "" } else { ", " });
            self.operand(state, level::ARGUMENT);
        }
        self.push(if results.is_some() { ");\n" } else { ";\n" });
        match turns {
            Count::Once => unreachable!("a fold of one turn is a call"),
            Count::If(condition) => {
                self.push("    if ");
                self.operand(condition, level::ANY);
            }
            Count::Unless(condition) => {
                self.push("    if !");
                self.operand(condition, level::PRIMARY);
            }
            Count::Times(count) => {
                self.push("    for (var i = 0u; i < ");
                self.operand(count, level::SUM);
                self.push("; i++)");
            }
        }
        self.push(" {\n        ");
        self.local_name(value);
        self.push(" = ");
        self.open_call(*callee);
        self.push(if matches!(turns, Count::Times(_)) {
            "i"
        } else {
            "0u"
        });
        for index in 0..init.len() {
            self.push(", ");
            self.local_name(value);
            if results.is_some() {
                self.push(".");
                self.field(*callee, index);
            }
        }
        for &capture in captures {
            self.push(", ");
            self.operand(capture, level::ARGUMENT);
        }
        self.close_call(*callee);
        self.push(";\n    }\n");
    }

    /// The text that defines `value`, in parentheses if its place binds tighter.
    fn definition(&mut self, value: Value, place: u8) {
        match self.function.inst(value) {
            Inst::Op(op, operands) => self.op(*op, operands, place),
            Inst::Load(table, index) => self.load(*table, *index),
            Inst::Result(of, _) => self.call(*of),
            Inst::Call(..) | Inst::Fold { .. } => self.call(value),
            Inst::Const(_) | Inst::Param(_) => {
                unreachable!("constants and parameters have no definition")
            }
        }
    }

    fn op(&mut self, op: Op, operands: &[Value; 3], place: u8) {
        match form(op) {
            Form::Infix {
                operator,
                level,
                left,
                right,
                chains,
            } => {
                let parentheses = *level < place;
                self.push(if parentheses { "(" } else { "" });
                let same = self.statements.inlined[operands[0].index()]
                    && matches!(self.function.inst(operands[0]), Inst::Op(o, _) if *o == op);
                self.operand(operands[0], if *chains && same { *level } else { *left });
                self.push(operator);
                match (op, self.function.constant(operands[1])) {
                    (Op::ShlU | Op::ShrU | Op::ShrI, Some(by)) => {
                        // WGSL rejects constant shifts by 32 or more; the op takes the low bits.
                        push_number(&mut self.context.out, by.bits & 31);
                        self.push("u");
                    }
                    _ => self.operand(operands[1], *right),
                }
                self.push(if parentheses { ")" } else { "" });
            }
            Form::Prefix(operator) => {
                let parentheses = level::UNARY < place;
                self.push(if parentheses { "(" } else { "" });
                self.push(operator);
                self.operand(operands[0], level::PRIMARY);
                self.push(if parentheses { ")" } else { "" });
            }
            Form::Call(pieces) => {
                for (text, operand) in pieces {
                    self.push(text);
                    if let Some(operand) = operand {
                        self.operand(operands[*operand], level::ARGUMENT);
                    }
                }
            }
        }
    }

    fn load(&mut self, table: u32, index: Value) {
        let offset = self.context.table_offsets[table as usize];
        let last = self.context.module.tables[table as usize].data.len() as u32 - 1;
        self.context.out.push_str(&self.context.tables);
        self.push("[");
        if let Some(index) = self.function.constant(index) {
            push_number(&mut self.context.out, offset + index.bits.min(last));
            self.push("u]");
            return;
        }
        if offset > 0 {
            push_number(&mut self.context.out, offset);
            self.push("u + ");
        }
        self.push("min(");
        self.operand(index, level::ARGUMENT);
        self.push(", ");
        push_number(&mut self.context.out, last);
        self.push("u)]");
    }

    /// A call, or a fold of one turn.
    fn call(&mut self, call: Value) {
        match self.function.inst(call) {
            Inst::Call(callee, arguments) => {
                self.open_call(*callee);
                for (index, &argument) in arguments.iter().enumerate() {
                    self.push(if index == 0 { "" } else { ", " });
                    self.operand(argument, level::ARGUMENT);
                }
                self.close_call(*callee);
            }
            Inst::Fold {
                function: callee,
                init,
                captures,
                ..
            } => {
                self.open_call(*callee);
                self.push("0u");
                for &argument in init.iter().chain(captures) {
                    self.push(", ");
                    self.operand(argument, level::ARGUMENT);
                }
                self.close_call(*callee);
            }
            _ => unreachable!("a result is of a call or a fold"),
        }
    }

    fn open_call(&mut self, callee: FunctionId) {
        let signature = self.context.signatures[callee.index()].as_ref();
        let signature = signature.expect("a callee is reached");
        self.context.out.push_str(&signature.name);
        self.context.out.push('(');
        if let Some(packed) = &signature.packed {
            self.context.out.push_str(packed);
            self.context.out.push('(');
        }
    }

    fn close_call(&mut self, callee: FunctionId) {
        let packed = self.signature(callee).packed.is_some();
        self.push(if packed { "))" } else { ")" });
    }

    /// A value where it is read: a literal, a name, or its definition.
    fn operand(&mut self, value: Value, place: u8) {
        if let Inst::Const(constant) = self.function.inst(value) {
            if let Some((hidden, number)) = self.hidden
                && hidden == value
            {
                self.push("t");
                push_number(&mut self.context.out, number);
                return;
            }
            let start = self.context.out.len();
            if push_constant(&mut self.context.out, *constant) < place {
                self.context.out.insert(start, '(');
                self.push(")");
            }
            return;
        }
        let is_field = match self.function.inst(value) {
            Inst::Result(of, _) => !is_single(self.context.module, self.function.inst(*of)),
            _ => false,
        };
        if self.statements.inlined[value.index()] && !is_field {
            self.definition(value, place);
        } else {
            self.name(value);
        }
    }

    /// The name of a value from where the text is now.
    fn name(&mut self, value: Value) {
        match self.places[value.index()] {
            OWN => match self.function.inst(value) {
                Inst::Result(of, position)
                    if !is_single(self.context.module, self.function.inst(*of)) =>
                {
                    self.local_name(*of);
                    self.push(".");
                    let (Inst::Call(callee, _)
                    | Inst::Fold {
                        function: callee, ..
                    }) = self.function.inst(*of)
                    else {
                        unreachable!("a result is of a call or a fold");
                    };
                    self.field(*callee, *position as usize);
                }
                _ => self.local_name(value),
            },
            BARE => self.local_name(value),
            PACKED => {
                self.push("args.");
                self.local_name(value);
            }
            ENTRY => {
                let Inst::Param(position) = self.function.inst(value) else {
                    unreachable!("only parameters have the entry's place");
                };
                let entry = self.entry.expect("the entry is being written");
                self.context
                    .out
                    .push_str(&entry.parameters[*position as usize]);
            }
            part => {
                self.push("p");
                push_number(&mut self.context.out, part - PART + 1);
                self.push(".");
                self.local_name(value);
            }
        }
    }

    fn field(&mut self, callee: FunctionId, index: usize) {
        let signature = self.context.signatures[callee.index()].as_ref();
        let field = &signature.expect("a callee is reached").fields[index];
        self.context.out.push_str(field);
    }

    /// The name that a value has in its own scope, made on first use.
    fn local_name(&mut self, value: Value) {
        let index = value.index();
        if self.locals[index] == 0 {
            self.locals[index] = self.make_name(value);
        }
        let local = self.locals[index];
        if local & GENERATED != 0 {
            self.context.out.push('t');
            push_number(&mut self.context.out, local & !GENERATED);
        } else {
            self.context.out.push_str(&self.strings[local as usize - 1]);
        }
    }

    fn name_text(&mut self, value: Value) -> String {
        let start = self.context.out.len();
        self.local_name(value);
        self.context.out.split_off(start)
    }

    fn make_name(&mut self, value: Value) -> u32 {
        let function = self.function;
        let text = if let Some(name) = function.names.get(&value) {
            Some(name.clone())
        } else {
            let (call, of_call) = match function.inst(value) {
                Inst::Result(of, _) if is_single(self.context.module, function.inst(*of)) => {
                    (*of, false)
                }
                Inst::Call(..) | Inst::Fold { .. } => (value, true),
                _ => (value, false),
            };
            match function.inst(call) {
                Inst::Call(callee, _)
                | Inst::Fold {
                    function: callee, ..
                } => {
                    let stem = if of_call {
                        self.common_stem(value, *callee)
                    } else {
                        None
                    };
                    Some(stem.unwrap_or_else(|| self.context.module.function(*callee).name.clone()))
                }
                _ => None,
            }
        };
        if let Some(text) = text {
            let name = self.fresh(&text);
            self.strings.push(name);
            self.strings.len() as u32
        } else {
            self.generated += 1;
            self.generated | GENERATED
        }
    }

    /// `swirl`, where the results of a call are named `swirl_mean`, …: the results of the builder
    /// follow their call.
    fn common_stem(&self, call: Value, callee: FunctionId) -> Option<String> {
        let fields = &self.context.module.function(callee).results;
        (call.index() + 1
            ..self
                .function
                .insts
                .len()
                .min(call.index() + 1 + fields.len()))
            .map_while(|index| match self.function.insts[index] {
                Inst::Result(of, position) if of == call => Some((index, position)),
                _ => None,
            })
            .find_map(|(index, position)| {
                let name = self.function.names.get(&Value::from_index(index))?;
                let stem = name.strip_suffix(fields[position as usize].0.as_str())?;
                let stem = stem.strip_suffix('_')?;
                (!stem.is_empty()).then(|| stem.to_owned())
            })
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
pub(super) fn is_packed(parameters: usize) -> bool {
    parameters > PARAMETERS
}
