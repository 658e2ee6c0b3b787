//! What can go wrong on a graphics device.

use std::fmt;

use super::{AdapterReport, LARGEST_PROGRAM};
use crate::job::Cancelled;

/// Why there is no device, or no image from it.
#[derive(Clone, Debug)]
pub enum GpuError {
    /// There is no adapter of the wanted kind; these are the ones that there are.
    NoAdapter(Vec<AdapterReport>),
    /// The adapter does not open, with the driver's reason.
    Open(AdapterReport, String),
    /// The shader, or what is bound to it, is not valid on this device: a bug in the shader.
    Validation(String),
    /// The device has too little memory.
    OutOfMemory(String),
    /// The shader has this many instructions: a driver would take minutes to compile it.
    TooLong(u64),
    /// The results of one evaluation do not fit the device's limits.
    TooLarge,
    /// The device failed or was lost, with the driver's reason.
    Device(String),
    /// The render was stopped.
    Cancelled(Cancelled),
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter(found) if found.is_empty() => {
                f.write_str("there is no graphics adapter")
            }
            Self::NoAdapter(found) => {
                f.write_str("there is no suitable graphics adapter, only")?;
                let mut separator = " ";
                for report in found {
                    write!(f, "{separator}{report}")?;
                    separator = ", ";
                }
                Ok(())
            }
            Self::Open(report, reason) => write!(f, "{report} does not open: {reason}"),
            Self::Validation(reason) => write!(f, "the device refuses the shader: {reason}"),
            Self::OutOfMemory(reason) => write!(f, "the device has too little memory: {reason}"),
            Self::TooLong(instructions) => write!(
                f,
                "the shader has {instructions} instructions, more than the {LARGEST_PROGRAM} that \
                 drivers compile within a minute"
            ),
            Self::TooLarge => f.write_str("the shader has more results than the device can hold"),
            Self::Device(reason) => write!(f, "the device failed: {reason}"),
            Self::Cancelled(cancelled) => cancelled.fmt(f),
        }
    }
}

impl std::error::Error for GpuError {}

impl From<Cancelled> for GpuError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl From<wgpu::Error> for GpuError {
    fn from(error: wgpu::Error) -> Self {
        match error {
            wgpu::Error::Validation { description, .. } => Self::Validation(description),
            wgpu::Error::OutOfMemory { source } => Self::OutOfMemory(source.to_string()),
            wgpu::Error::Internal { description, .. } => Self::Device(description),
        }
    }
}
