//! A function's text in a language, and what a wrapper of it needs to know.

use crate::ir::Type;
use crate::target::{Range, Target, TranslateError, Validated, items};
use crate::wgsl::{OutputField, ParameterField, Shader, TableForm};
use rustc_hash::FxHashSet;

/// A language's names for numbers and vectors.
#[derive(Clone, Copy, Debug)]
pub(super) enum Language {
    Glsl,
    Hlsl,
    Wgsl,
}

impl Language {
    /// The type of so many components.
    pub(super) fn type_name(self, scalar: Type, components: usize) -> String {
        let (name, vector, is_suffixed) = match (self, scalar) {
            (Self::Glsl, Type::F32) => ("float", "vec", false),
            (Self::Glsl, Type::I32) => ("int", "ivec", false),
            (Self::Glsl, Type::U32) => ("uint", "uvec", false),
            (Self::Glsl, Type::Bool) => ("bool", "bvec", false),
            (Self::Hlsl, Type::F32) => ("float", "float", false),
            (Self::Hlsl, Type::I32) => ("int", "int", false),
            (Self::Hlsl, Type::U32) => ("uint", "uint", false),
            (Self::Hlsl, Type::Bool) => ("bool", "bool", false),
            (Self::Wgsl, Type::F32) => ("f32", "f", true),
            (Self::Wgsl, Type::I32) => ("i32", "i", true),
            (Self::Wgsl, Type::U32) => ("u32", "u", true),
            (Self::Wgsl, Type::Bool) => ("bool", "<bool>", true),
        };
        match components {
            1 => name.to_owned(),
            n if is_suffixed => format!("vec{n}{vector}"),
            n => format!("{vector}{n}"),
        }
    }
}

/// A parameter as a wrapper has it.
#[derive(Debug)]
pub(super) struct Parameter<'a> {
    pub(super) field: &'a ParameterField,
    /// What the wrapper calls it.
    pub(super) name: String,
    pub(super) range: Range,
}

impl Parameter<'_> {
    /// Whether the graph has a truth value here, which shaders take as a `u32`.
    pub(super) fn is_truth(&self) -> bool {
        self.field.ty == mipless_graph::Type::Boolean
    }
}

/// The function's text.
#[derive(Debug)]
pub(super) struct Library<'a> {
    pub(super) shader: &'a Shader,
    pub(super) language: Language,
    /// The text, without an entry point.
    pub(super) text: String,
    /// The name of the texture's files.
    pub(super) file: &'a str,
    pub(super) parameters: Vec<Parameter<'a>>,
    /// What a wrapper calls the outputs.
    pub(super) outputs: Vec<(&'a OutputField, String)>,
    /// The words of the module scope, which no wrapper may declare.
    taken: FxHashSet<String>,
}

/// What wrappers call their other arguments and variables.
const OWN: [&str; 16] = [
    "footprint",
    "position",
    "parameters",
    "outputs",
    "tables",
    "uv",
    "du",
    "dv",
    "xyz",
    "dx",
    "dy",
    "coordinate",
    "place",
    // What JavaScript reserves and shading languages do not.
    "arguments",
    "eval",
    "function",
];

impl<'a> Library<'a> {
    /// The text of a shader that has no entry point, in the language of a target.
    pub(super) fn new(
        validated: &Validated,
        shader: &'a Shader,
        target: Target,
        file: &'a str,
        range: &dyn Fn(&str) -> Range,
    ) -> Result<Self, TranslateError> {
        let text = validated.translate(shader, target)?;
        let text = String::from_utf8_lossy(&text).into_owned();
        let language = match target {
            Target::Hlsl => Language::Hlsl,
            Target::Wgsl => Language::Wgsl,
            _ => Language::Glsl,
        };
        let mut taken: FxHashSet<String> = (OWN.iter())
            .map(|&word| word.to_owned())
            .chain(items(&text).filter_map(|item| item.name.map(str::to_owned)))
            .collect();
        let mut take = |name: &str, suffix: &str| {
            let mut name = name.to_owned();
            while !taken.insert(name.clone()) {
                name.push_str(suffix);
            }
            name
        };
        let parameters = (shader.parameters.iter())
            .map(|field| Parameter {
                field,
                name: take(&field.field, "_parameter"),
                range: range(&field.name),
            })
            .collect();
        let outputs = (shader.outputs.iter())
            .map(|field| (field, take(&field.field, "_output")))
            .collect();
        Ok(Self {
            shader,
            language,
            text,
            file,
            parameters,
            outputs,
            taken,
        })
    }

    /// A name at module scope that is free.
    pub(super) fn free(&self, name: &str) -> String {
        let mut name = name.to_owned();
        while self.taken.contains(&name) {
            name.push_str("_wrapper");
        }
        name
    }

    /// Whether the function takes its tables as an argument.
    pub(super) fn takes_tables(&self) -> bool {
        self.shader.tables.is_some() && self.shader.table_form == TableForm::Argument
    }

    /// The coordinate and its derivatives, with their numbers of components.
    pub(super) fn place(&self) -> Vec<(&'static str, usize)> {
        let mut place = vec![("uv", 2), ("du", 2), ("dv", 2)];
        if self.shader.position {
            place.extend([("xyz", 3), ("dx", 3), ("dy", 3)]);
        }
        place
    }

    /// The arguments of the texture's function, in GLSL or WGSL; `parameters` are the expressions of its
    /// parameters.
    pub(super) fn call(&self, tables: &str, parameters: &[String]) -> String {
        let (cell, space) = match self.language {
            Language::Wgsl => ("vec2i(0i, 0i)", "vec3i(0i, 0i, 0i)"),
            _ => ("ivec2(0)", "ivec3(0)"),
        };
        let mut call = format!("{}(", self.shader.function);
        if self.takes_tables() {
            call.push_str(tables);
            call.push_str(", ");
        }
        call.push_str(&format!("Footprint({cell}, uv, du, dv)"));
        if self.shader.position {
            call.push_str(&format!(", Position({space}, xyz, dx, dy)"));
        }
        if !parameters.is_empty() {
            let name = &self.shader.parameters_struct;
            call.push_str(&format!(", {name}({})", parameters.join(", ")));
        }
        call + ")"
    }

    /// The type of a parameter in the host, where a truth value is one.
    pub(super) fn host_type(&self, parameter: &Parameter<'_>) -> String {
        let scalar = match parameter.is_truth() {
            true => Type::Bool,
            false => parameter.field.scalar,
        };
        (self.language).type_name(scalar, parameter.field.ty.components())
    }

    /// The head of a file: what it is, in comments that begin with `start`.
    pub(super) fn head(&self, start: &str, lines: &[String]) -> String {
        let mut head = format!("{start} The texture {} by Mipless.\n", self.shader.function);
        for line in lines {
            head.push_str(&format!("{start} {line}\n"));
        }
        head
    }
}

/// A number as every language takes it, with a point or an exponent.
pub(super) fn real(number: f32) -> String {
    format!("{number:?}")
}

/// Numbers as a literal of a parameter's type, in GLSL or HLSL.
pub(super) fn literal(language: Language, parameter: &Parameter<'_>) -> String {
    let numbers = &parameter.field.default;
    let each = |&number: &f32| match (parameter.is_truth(), parameter.field.scalar) {
        (true, _) => (number != 0.0).to_string(),
        (_, Type::F32) => real(number),
        _ => format!("{number}"),
    };
    match &numbers[..] {
        [one] => each(one),
        several => {
            let several: Vec<String> = several.iter().map(each).collect();
            let scalar = parameter.field.scalar;
            let ty = language.type_name(scalar, several.len());
            format!("{ty}({})", several.join(", "))
        }
    }
}
