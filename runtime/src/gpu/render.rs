//! Chunks of footprints through a pipeline.

use std::sync::atomic::Ordering;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use mipless_codegen::cpu::{Footprint, Position};
use mipless_codegen::wgsl::workgroups;
use rayon::prelude::*;

use super::{Gpu, GpuError, Pipeline};
use crate::image::Image;
use crate::job::{Job, Tally};
use crate::view::{Part, Size, View};

/// How long a render took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    /// From submitting the dispatches to their end, without the transfers.
    pub wall: Duration,
    /// The time of the dispatches by the device's own clock, where it has one.
    pub device: Option<Duration>,
    /// How many footprints were evaluated.
    pub footprints: u64,
}

impl Timing {
    /// The more precise of the two times.
    pub fn best(&self) -> Duration {
        self.device.unwrap_or(self.wall)
    }
}

/// Within every device's limit of workgroups a dispatch, too.
const LARGEST_CHUNK: usize = 1 << 20;
const SMALLEST_CHUNK: usize = 1 << 8;
const SHORT: Duration = Duration::from_millis(60);
const LONG: Duration = Duration::from_millis(400);

/// The bytes of a packed footprint, and of one with its position in space.
const FOOTPRINT: usize = 32;
const PIXEL: usize = 96;

fn pixel_bytes(pipeline: &Pipeline) -> usize {
    if pipeline.shader().position {
        PIXEL
    } else {
        FOOTPRINT
    }
}

/// The buffers of one render.
struct Buffers {
    footprints: wgpu::Buffer,
    results: wgpu::Buffer,
    readback: wgpu::Buffer,
    clock: Option<Clock>,
}

/// The device's own clock: two timestamps around a dispatch.
struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readback: wgpu::Buffer,
}

/// How long another thread may take to deliver a message that it has already received.
const DELIVERY: Duration = Duration::from_secs(10);

impl Gpu {
    /// Renders all results of a pipeline over a view. Pixels of the background are 0 in every
    /// channel; [`View::present`] puts the background there.
    ///
    /// # Errors
    /// If the job is cancelled, the device fails, or it has too little memory.
    pub fn render(
        &self,
        pipeline: &Pipeline,
        view: &View,
        size: Size,
        job: Job<'_>,
    ) -> Result<(Image, Timing), GpuError> {
        self.render_part(pipeline, view, Part::all(size), job)
    }

    /// The same of a part of a picture.
    ///
    /// # Errors
    /// As [`Gpu::render`].
    pub fn render_part(
        &self,
        pipeline: &Pipeline,
        view: &View,
        part: Part,
        job: Job<'_>,
    ) -> Result<(Image, Timing), GpuError> {
        let size = part.size;
        let mut image = pipeline.blank(size);
        let mut timing = Timing::default();
        let tally = Tally::new(job, size);
        let largest = self.largest_chunk(pipeline)?.min(size.pixels());
        let buffers = self.checked(|| self.buffers(largest, pipeline))?;
        let mut start = 0;
        while start < size.pixels() {
            tally.proceed()?;
            let chunk = pipeline.chunk.load(Ordering::Relaxed).min(largest);
            let end = size.pixels().min(start + chunk);
            let (pixels, footprints): (Vec<usize>, Vec<(Footprint, Position)>) = (start..end)
                .into_par_iter()
                .filter_map(|index| Some((index, view.pixel(part.whole, part.place(index))?)))
                .unzip();
            if !footprints.is_empty() {
                let begun = Instant::now();
                let values = self.dispatch(pipeline, &buffers, &footprints, &mut timing)?;
                // Mostly background, a chunk says nothing about the next one.
                if footprints.len() >= chunk / 4 {
                    adapt(pipeline, chunk, begun.elapsed());
                }
                let count = pipeline.results.len();
                for (c, channel) in image.channels_mut().iter_mut().enumerate() {
                    for (&pixel, values) in pixels.iter().zip(values.chunks_exact(count)) {
                        channel[pixel] = values[c];
                    }
                }
                timing.footprints += footprints.len() as u64;
            }
            tally.add(end - start);
            start = end;
        }
        Ok((image, timing))
    }

    /// How many footprints the limits of the device allow in a dispatch.
    fn largest_chunk(&self, pipeline: &Pipeline) -> Result<usize, GpuError> {
        let bytes = pixel_bytes(pipeline).max(4 * pipeline.results.len()) as u64;
        let room = self
            .limits
            .max_storage_buffer_binding_size
            .min(self.limits.max_buffer_size);
        let chunk = (room / bytes).min(LARGEST_CHUNK as u64) as usize;
        if chunk == 0 {
            Err(GpuError::TooLarge)
        } else {
            Ok(chunk)
        }
    }

    fn buffers(&self, chunk: usize, pipeline: &Pipeline) -> Buffers {
        use wgpu::BufferUsages as Usage;
        let pixels = (chunk * pixel_bytes(pipeline)) as u64;
        let values = (chunk * pipeline.results.len() * 4) as u64;
        let clock = self.timestamps.then(|| Clock {
            queries: self.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: self.buffer(16, Usage::QUERY_RESOLVE | Usage::COPY_SRC),
            readback: self.buffer(16, Usage::COPY_DST | Usage::MAP_READ),
        });
        Buffers {
            footprints: self.buffer(pixels, Usage::STORAGE | Usage::COPY_DST),
            results: self.buffer(values, Usage::STORAGE | Usage::COPY_SRC),
            readback: self.buffer(values, Usage::COPY_DST | Usage::MAP_READ),
            clock,
        }
    }

    /// Evaluates some footprints; the results of each lie behind each other.
    fn dispatch(
        &self,
        pipeline: &Pipeline,
        buffers: &Buffers,
        footprints: &[(Footprint, Position)],
        timing: &mut Timing,
    ) -> Result<Vec<f32>, GpuError> {
        let values = (footprints.len() * pipeline.results.len() * 4) as u64;
        let mut words: Vec<u32> = Vec::with_capacity(footprints.len() * pixel_bytes(pipeline) / 4);
        for (footprint, position) in footprints {
            words.extend(packed(footprint));
            if pipeline.shader().position {
                words.extend(packed_position(position));
            }
        }
        // Uploaded before the clock starts.
        self.checked(|| {
            self.queue
                .write_buffer(&buffers.footprints, 0, bytemuck::cast_slice(&words));
            self.queue.submit([]);
        })?;
        self.wait()?;
        let begun = Instant::now();
        self.checked(|| {
            let group = self.bind(pipeline, buffers, footprints.len(), values);
            let mut encoder = self.device.create_command_encoder(&Default::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: None,
                    timestamp_writes: buffers.clock.as_ref().map(|clock| {
                        wgpu::ComputePassTimestampWrites {
                            query_set: &clock.queries,
                            beginning_of_pass_write_index: Some(0),
                            end_of_pass_write_index: Some(1),
                        }
                    }),
                });
                pass.set_pipeline(&pipeline.pipeline);
                pass.set_bind_group(0, &group, &[]);
                let [x, y, z] = workgroups(footprints.len() as u32);
                pass.dispatch_workgroups(x, y, z);
            }
            self.queue.submit([encoder.finish()]);
        })?;
        self.wait()?;
        timing.wall += begun.elapsed();

        self.checked(|| {
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&buffers.results, 0, &buffers.readback, 0, Some(values));
            if let Some(clock) = &buffers.clock {
                encoder.resolve_query_set(&clock.queries, 0..2, &clock.resolved, 0);
                encoder.copy_buffer_to_buffer(&clock.resolved, 0, &clock.readback, 0, Some(16));
            }
            self.queue.submit([encoder.finish()]);
        })?;
        if let Some(clock) = &buffers.clock {
            let bytes = self.read(&clock.readback, 16)?;
            let ticks = bytemuck::pod_collect_to_vec::<u8, u64>(&bytes);
            let nanoseconds = ticks[1].saturating_sub(ticks[0]) as f64
                * f64::from(self.queue.get_timestamp_period());
            *timing.device.get_or_insert_default() += Duration::from_nanos(nanoseconds as u64);
        }
        Ok(bytemuck::pod_collect_to_vec(
            &self.read(&buffers.readback, values)?,
        ))
    }

    fn bind(
        &self,
        pipeline: &Pipeline,
        buffers: &Buffers,
        footprints: usize,
        values: u64,
    ) -> wgpu::BindGroup {
        // The shader takes the number of footprints from the length of their binding.
        let part = |buffer, size: u64| {
            let size = std::num::NonZeroU64::new(size);
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset: 0,
                size,
            })
        };
        let resources = [
            part(
                &buffers.footprints,
                (footprints * pixel_bytes(pipeline)) as u64,
            ),
            pipeline.parameters.as_entire_binding(),
            part(&buffers.results, values),
            pipeline.tables.as_entire_binding(),
        ];
        let mut binding = 0;
        let entries = resources.map(|resource| {
            binding += 1;
            wgpu::BindGroupEntry {
                binding: binding - 1,
                resource,
            }
        });
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.layout,
            entries: &entries,
        })
    }

    fn wait(&self) -> Result<(), GpuError> {
        let waited = self.checked(|| self.device.poll(wgpu::PollType::wait_indefinitely()))?;
        waited
            .map(drop)
            .map_err(|error| GpuError::Device(error.to_string()))
    }

    /// The first `size` bytes of a buffer that can be mapped.
    fn read(&self, buffer: &wgpu::Buffer, size: u64) -> Result<Vec<u8>, GpuError> {
        let (sender, receiver) = mpsc::channel();
        self.checked(|| {
            buffer.map_async(wgpu::MapMode::Read, 0..size, move |result| {
                // The receiver outlives the wait below; without one there is nobody to tell.
                drop(sender.send(result));
            });
        })?;
        self.wait()?;
        // Another thread that waits may have taken the message over: it delivers it when its own
        // wait ends.
        match receiver.recv_timeout(DELIVERY) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(GpuError::Device(error.to_string())),
            Err(_) => return Err(GpuError::Device("a buffer was not mapped".into())),
        }
        let mapped = buffer.get_mapped_range(0..size);
        let bytes = mapped.map(|view| view.to_vec());
        buffer.unmap();
        bytes.map_err(|error| GpuError::Device(error.to_string()))
    }
}

/// Makes the next dispatches longer or shorter.
fn adapt(pipeline: &Pipeline, chunk: usize, took: Duration) {
    let next = if took < SHORT {
        (chunk * 4).min(LARGEST_CHUNK)
    } else if took > LONG {
        (chunk / 4).max(SMALLEST_CHUNK)
    } else {
        chunk
    };
    pipeline.chunk.store(next, Ordering::Relaxed);
}

fn packed(footprint: &Footprint) -> [u32; 8] {
    let Footprint { cell, uv, du, dv } = footprint;
    let [cell_x, cell_y] = cell.map(|c| c as u32);
    let [u, v] = uv.map(f32::to_bits);
    let [du_dx, dv_dx] = du.map(f32::to_bits);
    let [du_dy, dv_dy] = dv.map(f32::to_bits);
    [cell_x, cell_y, u, v, du_dx, dv_dx, du_dy, dv_dy]
}

/// Each vector of three in 16 bytes.
fn packed_position(position: &Position) -> [u32; 16] {
    let Position { cell, xyz, dx, dy } = position;
    let [xyz, dx, dy] = [xyz, dx, dy].map(|vector| vector.map(f32::to_bits));
    let mut words = [0; 16];
    for (place, vector) in [cell.map(|c| c as u32), xyz, dx, dy]
        .into_iter()
        .enumerate()
    {
        words[4 * place..4 * place + 3].copy_from_slice(&vector);
    }
    words
}
