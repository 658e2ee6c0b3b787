//! Rendering on a graphics device, through wgpu.
//!
//! A device evaluates the same footprints as the CPU: they are computed here in f64, uploaded in
//! chunks, and each invocation of the compute entry point evaluates one of them. Mistakes of a
//! shader or a driver come back as a [`GpuError`]; nothing in here panics on them.

mod adapter;
mod error;
mod limit;
mod pace;
mod pipeline;
mod render;
mod report;

pub use adapter::AdapterChoice;
pub use error::GpuError;
pub use limit::LARGEST_PROGRAM;
pub use pace::Pace;
pub use pipeline::Pipeline;
pub use render::Timing;
pub use report::AdapterReport;

use std::sync::{Arc, Mutex};

/// An open graphics device.
#[derive(Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    report: AdapterReport,
    limits: wgpu::Limits,
    /// Whether the device measures time itself.
    timestamps: bool,
    /// The first error that no scope caught; it would otherwise end the process.
    stray: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the best adapter that `choice` allows: discrete before integrated before virtual ones,
    /// and software last.
    ///
    /// # Errors
    /// If there is no such adapter, or it does not open.
    pub fn new(choice: AdapterChoice) -> Result<Self, GpuError> {
        let adapter = adapter::best(choice)?;
        let report = AdapterReport::of(&adapter);
        let limits = adapter.limits();
        let features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
        let description = wgpu::DeviceDescriptor {
            label: Some("mipless"),
            required_features: features,
            required_limits: limits.clone(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&description))
            .map_err(|error| GpuError::Open(report.clone(), error.to_string()))?;
        let stray = Arc::new(Mutex::new(None));
        let catch = Arc::clone(&stray);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut first) = catch.lock() {
                first.get_or_insert_with(|| error.to_string());
            }
        }));
        let timestamps = features.contains(wgpu::Features::TIMESTAMP_QUERY);
        Ok(Self {
            device,
            queue,
            report,
            limits,
            timestamps,
            stray,
        })
    }

    /// What is known of the adapter.
    pub fn report(&self) -> &AdapterReport {
        &self.report
    }

    /// Does `work` on the device and collects the first error that it makes, of any kind.
    fn checked<T>(&self, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        let caught = [validation, internal, memory].map(|scope| pollster::block_on(scope.pop()));
        if let Some(error) = caught.into_iter().flatten().next() {
            return Err(GpuError::from(error));
        }
        let stray = self.stray.lock().ok().and_then(|mut first| first.take());
        stray.map_or(Ok(result), |error| Err(GpuError::Device(error)))
    }
}
