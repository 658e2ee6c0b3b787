//! The manifest: what a host needs to know of a compiled texture, as JSON, without reading the shader.

mod schema;

use crate::wgsl::{
    BindingKind, EntryPoint, PIXELS_PER_ROW, Shader, Stage, TableForm, Tables, WORKGROUP_SIZE,
};
use crate::{Audit, Options, Texture};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;

pub use schema::manifest_schema;

/// The compiler that writes manifests.
pub const COMPILER: &str = concat!("mipless ", env!("CARGO_PKG_VERSION"));

/// A compiled texture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Manifest {
    /// The compiler and its version.
    pub compiler: String,
    /// What was compiled, where it came from files.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<ManifestSource>,
    /// The method.
    pub method: String,
    /// The filter over which a pixel is averaged.
    pub pixel_filter: String,
    /// The texture's function.
    pub function: String,
    /// Its arguments, in order, with their types.
    pub arguments: Vec<ManifestArgument>,
    /// The type of its result.
    pub result: String,
    /// The functions that shade its outputs, by a light and by a sky.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shading: Vec<String>,
    /// The structs that stand in buffers, and how they lie there.
    pub structs: Vec<ManifestStruct>,
    /// The entry point, if there is one.
    pub entry_point: Option<EntryPoint>,
    /// How a compute entry point is dispatched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dispatch: Option<ManifestDispatch>,
    /// The members of the struct of parameters, in order.
    pub parameters: Vec<ManifestParameter>,
    /// The size of that struct in bytes.
    pub parameters_size: u32,
    /// The members of the struct of outputs, in order.
    pub outputs: Vec<ManifestOutput>,
    /// Every buffer.
    pub bindings: Vec<ManifestBinding>,
    /// The contents of the buffer of tables.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tables_data: Option<ManifestData>,
    /// The same as a texture, where a text reads them from one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tables_texture: Option<ManifestTexture>,
    /// The tables in that buffer, in order.
    pub tables: Vec<ManifestTable>,
    /// What is written for each target, and what it calls what a host binds.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub targets: BTreeMap<String, ManifestTarget>,
    /// The names of all files beside the manifest: one a target, and the tables.
    pub files: BTreeMap<String, String>,
}

/// Where a texture came from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestSource {
    /// The name of the graph's file, without folders.
    pub file: String,
    /// The SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: String,
    /// What else was read, by the names in the graph.
    pub files: Vec<ManifestRead>,
    /// A digest of what the function and its tables depend on beside `files`: the compiler, the graph
    /// and the options.
    pub key: String,
}

/// A file that a graph reads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestRead {
    /// The name that the graph says.
    pub name: String,
    /// The SHA-256 of its bytes.
    pub sha256: String,
}

/// An argument of the texture's function.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestArgument {
    /// Its name.
    pub name: String,
    /// The name of its struct.
    #[serde(rename = "type")]
    pub ty: String,
}

/// A struct in a buffer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestStruct {
    /// Its name.
    pub name: String,
    /// Its size in bytes, from one to the next in an array.
    pub size: u32,
    /// Its members, in order.
    pub fields: Vec<ManifestField>,
}

/// A member of a struct.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestField {
    /// Its name.
    pub name: String,
    /// The type of a component: `f32`, `i32` or `u32`; of a member that is a struct, its name.
    pub scalar: String,
    /// The number of components.
    pub components: u32,
    /// The first byte.
    pub offset: u32,
}

/// How a compute entry point is dispatched.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestDispatch {
    /// The invocations of a workgroup, along x, y and z.
    pub workgroup_size: [u32; 3],
    /// Pixel i is the invocation (i mod row, i / row).
    pub row: u32,
    /// The bytes of a pixel in the buffer of footprints.
    pub footprint_bytes: u32,
    /// The numbers of a pixel in the buffer of outputs, each an f32.
    pub output_numbers: u32,
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
    /// Where a slider starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub soft_min: Option<f32>,
    /// Where a slider ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub soft_max: Option<f32>,
    /// What it means.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub doc: String,
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
    /// `linear-rec709` of a colour, `data` of what is none: numbers, vectors, variances.
    pub color_space: &'static str,
    /// The largest error that is to be expected of it, as a display shows it (sRGB, root mean square).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted_error: Option<f64>,
    /// What was measured of it, by the size of a pixel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<ManifestError>,
}

/// The error of an output where pixels have one size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestError {
    /// The width of a pixel, in uv.
    pub pixel: f32,
    /// The error, as a display shows it.
    pub error: f64,
    /// That of a point without a filter.
    pub point: f64,
}

/// A buffer that the shader reads or writes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestBinding {
    /// The group.
    pub group: u32,
    /// The binding in its group.
    pub binding: u32,
    /// The variable's name.
    pub name: String,
    /// What it holds.
    pub kind: BindingKind,
    /// `uniform`, `storage-read` or `storage-read-write`.
    pub access: &'static str,
    /// What it holds one of, or an array of: the name of a struct, or `f32`.
    pub element: String,
    /// The bytes of an element.
    pub stride: u32,
}

/// The contents of a buffer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestData {
    /// The type of a number.
    pub scalar: &'static str,
    /// The order of its bytes.
    pub byte_order: &'static str,
    /// How many numbers there are.
    pub length: u32,
    /// The SHA-256 of its bytes.
    pub sha256: String,
}

/// A texture that holds the tables row by row, one number a texel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestTexture {
    /// Its columns.
    pub width: u32,
    /// Its rows.
    pub height: u32,
    /// The format of a texel.
    pub format: &'static str,
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

/// What is written for a target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ManifestTarget {
    /// The file.
    pub file: String,
    /// The SHA-256 of its bytes.
    pub sha256: String,
    /// A digest of the options that concern this text alone.
    pub key: String,
    /// The language and its version.
    pub language: &'static str,
    /// The texture's function as this text calls it; absent where there are no names (SPIR-V).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub function: Option<String>,
    /// The entry point as this text calls it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub entry_point: Option<EntryPoint>,
    /// Every buffer, in the order of the manifest's `bindings`.
    pub bindings: Vec<TargetBinding>,
    /// What a fragment entry point takes from the vertices.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub varyings: Vec<TargetLocation>,
    /// What a fragment entry point writes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub colors: Vec<TargetLocation>,
    /// Metal alone: the buffer of the byte lengths of arrays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer_sizes: Option<BufferSizes>,
}

/// A buffer as a target's text calls it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TargetBinding {
    /// What it holds.
    pub kind: BindingKind,
    /// The variable's name; absent where there are no names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// GLSL alone: the name of the block around it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub block: Option<String>,
    /// Where it is bound: `@group(0) @binding(1)`, `set = 0, binding = 1`, `binding = 1`,
    /// `register(b1, space0)` or `[[buffer(1)]]`.
    pub place: String,
    /// The number in that place.
    pub index: u32,
}

/// Something at a location.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TargetLocation {
    /// What it is: `uv`, `xyz`, or the name of an output.
    pub of: String,
    /// The location.
    pub location: u32,
    /// What the text calls it: a variable's name or a semantic.
    pub name: String,
}

/// Where Metal's shaders read the byte lengths of arrays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BufferSizes {
    /// The index of the buffer.
    pub buffer: u32,
    /// The arrays whose lengths it holds, in order, each a 32-bit unsigned integer.
    pub of: Vec<BindingKind>,
}

impl Manifest {
    /// The manifest of a texture's shader, and of what its audit has found; without files and targets.
    pub fn new(
        texture: &Texture,
        shader: &Shader,
        options: &Options,
        audit: Option<&Audit>,
    ) -> Self {
        let structs = structs(shader);
        let mut arguments = vec![argument("footprint", "Footprint")];
        if shader.position {
            arguments.push(argument("position", "Position"));
        }
        if !shader.parameters.is_empty() {
            arguments.push(argument("parameters", &shader.parameters_struct));
        }
        let entry = shader.entry_point.as_ref();
        let is_compute = entry.is_some_and(|entry| entry.stage == Stage::Compute);
        let footprint_bytes = if shader.position { 96 } else { 32 };
        let data = shader.tables.as_ref().map(|tables| ManifestData {
            scalar: "f32",
            byte_order: "little-endian",
            length: tables.entries.iter().map(|entry| entry.2).sum(),
            sha256: sha256(&bytes_of(tables)),
        });
        Self {
            compiler: COMPILER.to_owned(),
            source: None,
            method: options.method.to_string(),
            pixel_filter: options.filter.to_string(),
            function: shader.function.clone(),
            arguments,
            result: shader.outputs_struct.clone(),
            shading: shader.shading.clone(),
            structs,
            entry_point: shader.entry_point.clone(),
            dispatch: is_compute.then(|| ManifestDispatch {
                workgroup_size: [WORKGROUP_SIZE, 1, 1],
                row: PIXELS_PER_ROW,
                footprint_bytes,
                output_numbers: shader.scalars_per_pixel() as u32,
            }),
            parameters: parameters(texture, shader),
            parameters_size: shader.parameters_size,
            outputs: outputs(texture, shader, audit),
            bindings: bindings(shader, footprint_bytes),
            tables_data: data,
            tables_texture: None,
            tables: tables(shader),
            targets: BTreeMap::new(),
            files: BTreeMap::new(),
        }
    }

    /// The manifest as JSON, indented, ending in a newline.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("the manifest has plain keys");
        text.push('\n');
        text
    }
}

/// The bytes of the buffer of tables.
pub(crate) fn bytes_of(tables: &Tables) -> Vec<u8> {
    let numbers = tables.data().into_iter();
    numbers.flat_map(f32::to_le_bytes).collect()
}

/// The SHA-256 of some bytes, in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").expect("a string takes all text");
        text
    })
}

fn argument(name: &str, ty: &str) -> ManifestArgument {
    ManifestArgument {
        name: name.to_owned(),
        ty: ty.to_owned(),
    }
}

/// The structs that hosts write.
fn structs(shader: &Shader) -> Vec<ManifestStruct> {
    let field = |name: &str, scalar: &str, components: u32, offset: u32| ManifestField {
        name: name.to_owned(),
        scalar: scalar.to_owned(),
        components,
        offset,
    };
    let layout = |name: &str, size: u32, fields: Vec<ManifestField>| ManifestStruct {
        name: name.to_owned(),
        size,
        fields,
    };
    let mut structs = vec![layout(
        "Footprint",
        32,
        vec![
            field("cell", "i32", 2, 0),
            field("uv", "f32", 2, 8),
            field("du", "f32", 2, 16),
            field("dv", "f32", 2, 24),
        ],
    )];
    if shader.position {
        let position = vec![
            field("cell", "i32", 3, 0),
            field("xyz", "f32", 3, 16),
            field("dx", "f32", 3, 32),
            field("dy", "f32", 3, 48),
        ];
        structs.push(layout("Position", 64, position));
        let pixel = vec![
            field("footprint", "Footprint", 1, 0),
            field("position", "Position", 1, 32),
        ];
        structs.push(layout("Pixel", 96, pixel));
    }
    if !shader.parameters.is_empty() {
        let fields = shader.parameters.iter().map(|p| {
            let components = p.ty.components() as u32;
            field(&p.field, p.scalar.name(), components, p.offset)
        });
        structs.push(layout(
            &shader.parameters_struct,
            shader.parameters_size,
            fields.collect(),
        ));
    }
    structs
}

fn parameters(texture: &Texture, shader: &Shader) -> Vec<ManifestParameter> {
    let parameter = |p: &crate::wgsl::ParameterField| {
        let said = texture.parameters().iter().find(|said| said.name == p.name);
        ManifestParameter {
            name: p.name.clone(),
            field: p.field.clone(),
            ty: p.ty.name(),
            scalar: p.scalar.name(),
            offset: p.offset,
            default: p.default.clone(),
            min: said.and_then(|said| said.min),
            max: said.and_then(|said| said.max),
            soft_min: said.and_then(|said| said.soft_min),
            soft_max: said.and_then(|said| said.soft_max),
            doc: said.map_or(String::new(), |said| said.doc.clone()),
        }
    };
    shader.parameters.iter().map(parameter).collect()
}

fn outputs(texture: &Texture, shader: &Shader, audit: Option<&Audit>) -> Vec<ManifestOutput> {
    let output = |o: &crate::wgsl::OutputField| {
        let said = texture
            .outputs()
            .iter()
            .zip(0..)
            .find(|(said, _)| said.name == o.name);
        let index = said.map(|(_, index)| index);
        let audited = audit
            .filter(|audit| !audit.is_too_large && !o.variance)
            .map(|audit| audit.outputs.iter().find(|a| Some(a.output) == index));
        let is_color = !o.variance && said.is_some_and(|(said, _)| texture.is_color(said));
        let errors = audited.flatten().map_or(&[][..], |audited| &audited.bands);
        ManifestOutput {
            name: o.name.clone(),
            field: o.field.clone(),
            ty: o.ty.name(),
            variance: o.variance,
            first: o.first,
            color_space: if is_color { "linear-rec709" } else { "data" },
            // What an audit does not look at is exact.
            predicted_error: audited.map(|audited| audited.map_or(0.0, |a| rounded(a.predicted()))),
            errors: (errors.iter())
                .map(|band| ManifestError {
                    pixel: band.size,
                    error: rounded(band.auto),
                    point: rounded(band.point),
                })
                .collect(),
        }
    };
    shader.outputs.iter().map(output).collect()
}

/// An error in steps of 10⁻⁵, which no display shows: further digits are those of the machine that
/// measured it.
fn rounded(error: f64) -> f64 {
    (error * 1e5).round() / 1e5
}

fn bindings(shader: &Shader, footprint_bytes: u32) -> Vec<ManifestBinding> {
    let binding = |b: &crate::wgsl::Binding| {
        let (access, element, stride) = match b.kind {
            BindingKind::Footprints if shader.position => {
                ("storage-read", "Pixel", footprint_bytes)
            }
            BindingKind::Footprints => ("storage-read", "Footprint", footprint_bytes),
            BindingKind::Parameters => (
                "uniform",
                shader.parameters_struct.as_str(),
                shader.parameters_size,
            ),
            BindingKind::Outputs => ("storage-read-write", "f32", 4),
            BindingKind::Tables if shader.table_form != TableForm::Storage => ("texture", "f32", 4),
            BindingKind::Tables => ("storage-read", "f32", 4),
        };
        ManifestBinding {
            group: b.group,
            binding: b.binding,
            name: b.name.clone(),
            kind: b.kind,
            access,
            element: element.to_owned(),
            stride,
        }
    };
    shader.bindings.iter().map(binding).collect()
}

fn tables(shader: &Shader) -> Vec<ManifestTable> {
    let all = shader.tables.iter();
    all.flat_map(|tables| tables.entries.iter().zip(&tables.numbers))
        .map(|((name, first, length), numbers)| ManifestTable {
            name: name.clone(),
            first: *first,
            length: *length,
            error: numbers.error(),
        })
        .collect()
}
