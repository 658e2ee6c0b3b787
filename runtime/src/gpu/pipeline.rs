//! A compute shader made ready on a device.

use std::sync::atomic::AtomicUsize;

use super::{Gpu, GpuError};
use crate::image::Image;

/// A compute entry point that evaluates one footprint an invocation.
///
/// Its bindings, all in group 0: 0, read-only storage, the packed footprints (32 bytes: two i32,
/// six f32); 1, uniform, the parameters; 2, storage, the results (f32, those of one footprint
/// behind each other); 3, read-only storage, the tables (f32). What a shader does not use may be
/// missing in it. An invocation beyond the length of binding 0 does nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct ComputeShader<'a> {
    /// The WGSL text.
    pub source: &'a str,
    /// The name of the entry point.
    pub entry: &'a str,
    /// Invocations in a workgroup, all in x.
    pub workgroup: u32,
    /// The names of the results of one evaluation, in order.
    pub results: Vec<String>,
    /// The bytes of the parameters, in the shader's layout; may be empty.
    pub parameters: Vec<u8>,
    /// The numbers of all tables; may be empty.
    pub tables: Vec<f32>,
}

/// A shader that is compiled for one device, with its tables. Keep it to render again.
#[derive(Debug)]
pub struct Pipeline {
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) parameters: wgpu::Buffer,
    pub(super) tables: wgpu::Buffer,
    pub(super) workgroup: u32,
    pub(super) results: Vec<String>,
    /// Footprints in a dispatch that took a good time so far.
    pub(super) chunk: AtomicUsize,
}

/// The smallest buffer that is bound in place of an empty one: the size of a vec4f.
const LEAST: u64 = 16;

impl Gpu {
    /// Compiles a shader.
    ///
    /// # Errors
    /// If the shader is not valid or the device has too little memory.
    pub fn pipeline(&self, shader: &ComputeShader<'_>) -> Result<Pipeline, GpuError> {
        if shader.results.is_empty() {
            return Err(GpuError::Validation("the shader has no results".into()));
        }
        let made = self.checked(|| {
            let module = self
                .device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(shader.entry),
                    source: wgpu::ShaderSource::Wgsl(shader.source.into()),
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
                    label: Some(shader.entry),
                    layout: Some(&pipeline_layout),
                    module: &module,
                    entry_point: Some(shader.entry),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    cache: None,
                });
            let tables: &[u8] = bytemuck::cast_slice(&shader.tables);
            Pipeline {
                pipeline,
                layout,
                parameters: self.filled(&shader.parameters, wgpu::BufferUsages::UNIFORM),
                tables: self.filled(tables, wgpu::BufferUsages::STORAGE),
                workgroup: shader.workgroup,
                results: shader.results.clone(),
                chunk: AtomicUsize::new(super::render::FIRST_CHUNK),
            }
        })?;
        Ok(made)
    }

    /// Sets the parameters of a pipeline, in the shader's layout.
    ///
    /// # Errors
    /// If there are more bytes than the pipeline was made for.
    pub fn set_parameters(&self, pipeline: &Pipeline, bytes: &[u8]) -> Result<(), GpuError> {
        self.checked(|| {
            self.queue
                .write_buffer(&pipeline.parameters, 0, &padded(bytes))
        })
    }

    fn layout(&self) -> wgpu::BindGroupLayout {
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let kinds = [
            storage(true),
            wgpu::BufferBindingType::Uniform,
            storage(false),
            storage(true),
        ];
        let entries = [0u32, 1, 2, 3].map(|binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: kinds[binding as usize],
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

impl Pipeline {
    /// An image of zeros with the pipeline's results as channels.
    pub(super) fn blank(&self, size: crate::view::Size) -> Image {
        let channels = vec![vec![0.0; size.pixels()]; self.results.len()];
        Image::new(size, &self.results, channels)
    }
}
