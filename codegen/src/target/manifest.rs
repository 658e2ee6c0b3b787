//! The manifest: what a host needs to know of a compiled texture, as JSON.

use crate::wgsl::{Binding, EntryPoint, Shader};
use serde::Serialize;

/// The range of a graph's input: what the document says of it.
pub type Range = (Option<f32>, Option<f32>);

/// A compiled texture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Manifest {
    /// The texture's function.
    pub function: String,
    /// The entry point, if there is one.
    pub entry_point: Option<EntryPoint>,
    /// Whether the function's second argument is the `Position` of the pixel in space: `cell` + `xyz`,
    /// and its changes `dx` and `dy` to the next pixel on the right and below.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub position: bool,
    /// The members of the struct of parameters, in order.
    pub parameters: Vec<ManifestParameter>,
    /// The size of that struct in bytes.
    pub parameters_size: u32,
    /// The members of the struct of outputs, in order.
    pub outputs: Vec<ManifestOutput>,
    /// Every buffer.
    pub bindings: Vec<Binding>,
    /// The tables in the buffer of tables, in order.
    pub tables: Vec<ManifestTable>,
}

/// A parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestParameter {
    /// The input's name in the graph.
    pub name: String,
    /// The member's name in the shader.
    pub field: String,
    /// The type in the graph.
    #[serde(rename = "type")]
    pub ty: &'static str,
    /// The type of a component in the buffer: `f32`, `i32` or `u32`.
    pub scalar: &'static str,
    /// The first byte in the buffer.
    pub offset: u32,
    /// The default, one number a component.
    pub default: Vec<f32>,
    /// The smallest value that the graph was checked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f32>,
    /// The largest value that the graph was checked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f32>,
}

/// An output.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestOutput {
    /// The output's name in the graph.
    pub name: String,
    /// The member's name in the shader.
    pub field: String,
    /// The type in the graph.
    #[serde(rename = "type")]
    pub ty: &'static str,
    /// Whether it is the output's variance, not its mean.
    pub variance: bool,
    /// The position of its first component among a pixel's scalars.
    pub first: u32,
}

/// A table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestTable {
    /// A readable name.
    pub name: String,
    /// Its first number in the buffer.
    pub first: u32,
    /// How many numbers it has.
    pub length: u32,
    /// The largest error of reading it between its numbers, in units of the function; of slopes and
    /// higher moments, times the powers of σ that they are stored with. Absent where it is exact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
}

impl Manifest {
    /// The manifest of a shader; `range` says what the graph allows for the input of that name.
    pub fn new(shader: &Shader, range: impl Fn(&str) -> Range) -> Self {
        let parameters = shader.parameters.iter().map(|p| {
            let (min, max) = range(&p.name);
            ManifestParameter {
                name: p.name.clone(),
                field: p.field.clone(),
                ty: p.ty.name(),
                scalar: p.scalar.name(),
                offset: p.offset,
                default: p.default.clone(),
                min,
                max,
            }
        });
        let outputs = shader.outputs.iter().map(|o| ManifestOutput {
            name: o.name.clone(),
            field: o.field.clone(),
            ty: o.ty.name(),
            variance: o.variance,
            first: o.first,
        });
        let tables = shader
            .tables
            .iter()
            .flat_map(|t| t.entries.iter().zip(&t.numbers))
            .map(|((name, first, length), numbers)| ManifestTable {
                name: name.clone(),
                first: *first,
                length: *length,
                error: numbers.error(),
            });
        Self {
            function: shader.function.clone(),
            entry_point: shader.entry_point.clone(),
            position: shader.position,
            parameters: parameters.collect(),
            parameters_size: shader.parameters_size,
            outputs: outputs.collect(),
            bindings: shader.bindings.clone(),
            tables: tables.collect(),
        }
    }

    /// The manifest as JSON, indented, ending in a newline.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("the manifest has plain keys");
        text.push('\n');
        text
    }
}
