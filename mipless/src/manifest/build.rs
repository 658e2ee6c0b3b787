//! What the shader says of itself, as parts of its manifest.

use super::{
    COMPILER, Manifest, ManifestArgument, ManifestBinding, ManifestData, ManifestDispatch,
    ManifestError, ManifestField, ManifestOutput, ManifestParameter, ManifestStruct, ManifestTable,
    bytes_of, sha256,
};
use crate::wgsl::{BindingKind, PIXELS_PER_ROW, Shader, Stage, TableForm, WORKGROUP_SIZE};
use crate::{Audit, Options, Texture};
use std::collections::BTreeMap;

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
