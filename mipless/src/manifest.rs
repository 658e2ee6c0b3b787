//! The manifest: what a host needs to know of a compiled texture, as JSON, without reading the shader.

mod build;

use crate::wgsl::{BindingKind, EntryPoint, Tables};
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, json_schema};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The compiler that writes manifests.
pub const COMPILER: &str = concat!("mipless ", env!("CARGO_PKG_VERSION"));

/// A compiled texture.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
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
    #[schemars(schema_with = "entry_point")]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestSource {
    /// The name of the graph's file, without folders.
    pub file: String,
    /// The SHA-256 of its bytes, in hexadecimal digits.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub sha256: String,
    /// What else was read, by the names in the graph.
    pub files: Vec<ManifestRead>,
    /// A digest of what the function and its tables depend on beside `files`: the compiler, the graph
    /// and the options.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub key: String,
}

/// A file that a graph reads.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestRead {
    /// The name that the graph says.
    pub name: String,
    /// The SHA-256 of its bytes.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub sha256: String,
}

/// An argument of the texture's function.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestArgument {
    /// Its name.
    pub name: String,
    /// The name of its struct.
    #[serde(rename = "type")]
    pub ty: String,
}

/// A struct in a buffer.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestStruct {
    /// Its name.
    pub name: String,
    /// Its size in bytes, from one to the next in an array.
    pub size: u32,
    /// Its members, in order.
    pub fields: Vec<ManifestField>,
}

/// A member of a struct.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestError {
    /// The width of a pixel, in uv.
    pub pixel: f32,
    /// The error, as a display shows it.
    pub error: f64,
    /// That of a point without a filter.
    pub point: f64,
}

/// A buffer that the shader reads or writes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestBinding {
    /// The group.
    pub group: u32,
    /// The binding in its group.
    pub binding: u32,
    /// The variable's name.
    pub name: String,
    /// What it holds.
    #[schemars(schema_with = "kind")]
    pub kind: BindingKind,
    /// `uniform`, `storage-read` or `storage-read-write`.
    pub access: &'static str,
    /// What it holds one of, or an array of: the name of a struct, or `f32`.
    pub element: String,
    /// The bytes of an element.
    pub stride: u32,
}

/// The contents of a buffer.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestData {
    /// The type of a number.
    pub scalar: &'static str,
    /// The order of its bytes.
    pub byte_order: &'static str,
    /// How many numbers there are.
    pub length: u32,
    /// The SHA-256 of its bytes.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub sha256: String,
}

/// A texture that holds the tables row by row, one number a texel.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestTexture {
    /// Its columns.
    pub width: u32,
    /// Its rows.
    pub height: u32,
    /// The format of a texel.
    pub format: &'static str,
}

/// A table.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct ManifestTarget {
    /// The file.
    pub file: String,
    /// The SHA-256 of its bytes.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub sha256: String,
    /// A digest of the options that concern this text alone.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub key: String,
    /// The language and its version.
    pub language: &'static str,
    /// The texture's function as this text calls it; absent where there are no names (SPIR-V).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub function: Option<String>,
    /// The entry point as this text calls it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "entry_point")]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct TargetBinding {
    /// What it holds.
    #[schemars(schema_with = "kind")]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct TargetLocation {
    /// What it is: `uv`, `xyz`, or the name of an output.
    pub of: String,
    /// The location.
    pub location: u32,
    /// What the text calls it: a variable's name or a semantic.
    pub name: String,
}

/// Where Metal's shaders read the byte lengths of arrays.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct BufferSizes {
    /// The index of the buffer.
    pub buffer: u32,
    /// The arrays whose lengths it holds, in order, each a 32-bit unsigned integer.
    #[schemars(schema_with = "kinds")]
    pub of: Vec<BindingKind>,
}

/// What bindings hold, and entry points: types of the compiler, which knows of no schemas.
fn kind(_: &mut schemars::SchemaGenerator) -> Schema {
    json_schema!({ "enum": ["footprints", "parameters", "outputs", "tables"] })
}

fn kinds(generator: &mut schemars::SchemaGenerator) -> Schema {
    json_schema!({ "type": "array", "items": kind(generator) })
}

fn entry_point(_: &mut schemars::SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["object", "null"],
        "required": ["name", "stage"],
        "additionalProperties": false,
        "properties": {
            "name": { "type": "string", "description": "The function's name." },
            "stage": { "enum": ["fragment", "compute"] },
        },
    })
}

/// The JSON Schema (draft 2020-12) of manifests, for the tools that read them.
pub fn manifest_schema() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<Manifest>()
}

impl Manifest {
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
