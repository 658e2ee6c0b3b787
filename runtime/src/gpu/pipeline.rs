//! A shader made ready on a device.

use std::sync::atomic::AtomicUsize;

use mipless_codegen::ir::Program;
use mipless_codegen::wgsl::{
    Entry, FOOTPRINTS_BINDING, OUTPUTS_BINDING, PARAMETERS_BINDING, Shader, TABLES_BINDING, emit,
};

use super::{Gpu, GpuError, LARGEST_PROGRAM};
use crate::image::{Image, channel_names};
use crate::view::Size;

/// A texture that is compiled for one device. Keep it to render again, with other parameters too.
#[derive(Debug)]
pub struct Pipeline {
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) parameters: wgpu::Buffer,
    pub(super) tables: wgpu::Buffer,
    /// The names of the results of one evaluation, in order.
    pub(super) results: Vec<String>,
    /// Footprints in a dispatch that took a good time so far.
    pub(super) chunk: AtomicUsize,
    shader: Shader,
}

/// The smallest buffer that is bound in place of an empty one: the size of a vec4f.
const LEAST: u64 = 16;

/// Footprints in the first dispatch of a pipeline. Drivers stop a dispatch that takes seconds, so
/// the size follows the time that the one before took.
const FIRST_CHUNK: usize = 1 << 14;

impl Gpu {
    /// Compiles a program, with its default parameters.
    ///
    /// # Errors
    /// If the program has more than [`LARGEST_PROGRAM`] instructions once its calls are expanded,
    /// the device refuses the shader, or has too little memory.
    pub fn pipeline(&self, program: &Program) -> Result<Pipeline, GpuError> {
        let instructions = program.module.expanded_size();
        if instructions > LARGEST_PROGRAM {
            return Err(GpuError::TooLong(instructions));
        }
        self.pipeline_of(emit(program, &Entry::Compute.into()))
    }

    /// Compiles a shader that was emitted with [`Entry::Compute`], with its default parameters.
    ///
    /// # Errors
    /// If the shader is not valid, the device refuses it, or it has too little memory.
    ///
    /// # Panics
    /// If the shader has no entry point.
    pub fn pipeline_of(&self, shader: Shader) -> Result<Pipeline, GpuError> {
        let entry = shader
            .entry_point
            .as_ref()
            .expect("a shader with an entry point");
        let defaults: Vec<f32> = shader
            .parameters
            .iter()
            .flat_map(|p| p.default.clone())
            .collect();
        let parameters = shader.pack_parameters(&defaults);
        let tables = shader
            .tables
            .as_ref()
            .map_or_else(Vec::new, |tables| tables.data());
        let (pipeline, layout, parameters, tables) = self.checked(|| {
            let module = self
                .device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(&shader.function),
                    source: wgpu::ShaderSource::Wgsl(shader.source.as_str().into()),
                });
            let layout = self.layout();
            let pipeline_layout =
                self.device
                    .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                        label: None,
                        bind_group_layouts: &[Some(&layout)],
                        immediate_size: 0,
                    });
            let pipeline = self
                .device
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(&shader.function),
                    layout: Some(&pipeline_layout),
                    module: &module,
                    entry_point: Some(&entry.name),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    cache: None,
                });
            let parameters = self.filled(&parameters, wgpu::BufferUsages::UNIFORM);
            let tables = self.filled(bytemuck::cast_slice(&tables), wgpu::BufferUsages::STORAGE);
            (pipeline, layout, parameters, tables)
        })?;
        let chunk = AtomicUsize::new(FIRST_CHUNK);
        let results = result_names(&shader);
        Ok(Pipeline {
            pipeline,
            layout,
            parameters,
            tables,
            results,
            chunk,
            shader,
        })
    }

    /// Sets the parameters of a pipeline: one number a component, in the order of the program's
    /// interface.
    ///
    /// # Errors
    /// If the device fails.
    ///
    /// # Panics
    /// If there are not as many numbers as components.
    pub fn set_parameters(&self, pipeline: &Pipeline, numbers: &[f32]) -> Result<(), GpuError> {
        let bytes = padded(&pipeline.shader.pack_parameters(numbers));
        self.checked(|| self.queue.write_buffer(&pipeline.parameters, 0, &bytes))
    }

    /// The bindings that a shader may have; one that it does not use may stay in the layout.
    fn layout(&self) -> wgpu::BindGroupLayout {
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let entries = [
            (FOOTPRINTS_BINDING, storage(true)),
            (PARAMETERS_BINDING, wgpu::BufferBindingType::Uniform),
            (OUTPUTS_BINDING, storage(false)),
            (TABLES_BINDING, storage(true)),
        ];
        let entries = entries.map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        });
        let description = wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        };
        self.device.create_bind_group_layout(&description)
    }

    /// A buffer that holds `bytes`, padded with zeros to whole vectors.
    fn filled(&self, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let bytes = padded(bytes);
        let buffer = self.buffer(bytes.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
        self.queue.write_buffer(&buffer, 0, &bytes);
        buffer
    }

    pub(super) fn buffer(&self, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size.max(LEAST),
            usage,
            mapped_at_creation: false,
        })
    }
}

fn padded(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes.resize(
        bytes
            .len()
            .next_multiple_of(LEAST as usize)
            .max(LEAST as usize),
        0,
    );
    bytes
}

/// The names of what the compute entry point writes, as [`crate::cpu`] names them.
fn result_names(shader: &Shader) -> Vec<String> {
    let field = |output: &mipless_codegen::wgsl::OutputField| {
        let kind = if output.variance { ".variance" } else { "" };
        let name = |c| format!("{}{kind}.{c}", output.name);
        channel_names(output.ty)
            .iter()
            .map(name)
            .collect::<Vec<_>>()
    };
    shader.outputs.iter().flat_map(field).collect()
}

impl Pipeline {
    /// The shader that it was made of.
    pub fn shader(&self) -> &Shader {
        &self.shader
    }

    /// An image of zeros with the pipeline's results as channels.
    pub(super) fn blank(&self, size: Size) -> Image {
        let channels = vec![vec![0.0; size.pixels()]; self.results.len()];
        Image::new(size, &self.results, channels)
    }
}
