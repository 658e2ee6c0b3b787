//! Where a texture is evaluated.

use std::fmt;

#[cfg(feature = "gpu")]
use crate::gpu::{AdapterChoice, Gpu, GpuError};

/// What the user asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// A hardware GPU if there is one, else the CPU; never a software adapter.
    #[default]
    Auto,
    /// The CPU; no graphics driver is touched.
    Cpu,
    /// Any graphics adapter, software ones included.
    Gpu,
}

impl DeviceChoice {
    /// The choice of that name: `auto`, `cpu` or `gpu`.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "auto" => Some(Self::Auto),
            "cpu" => Some(Self::Cpu),
            "gpu" => Some(Self::Gpu),
            _ => None,
        }
    }
}

/// An open device.
#[derive(Debug)]
pub enum Device {
    /// The CPU evaluator.
    Cpu,
    /// A graphics device.
    #[cfg(feature = "gpu")]
    Gpu(Box<Gpu>),
}

/// Why the device that was asked for is not there.
#[derive(Clone, Debug)]
pub enum DeviceError {
    /// This build has no support for graphics devices.
    NotBuilt,
    /// There is no adapter, or it does not open.
    #[cfg(feature = "gpu")]
    Gpu(GpuError),
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotBuilt => f.write_str("this build has no support for graphics devices"),
            #[cfg(feature = "gpu")]
            Self::Gpu(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for DeviceError {}

impl Device {
    /// Opens what was asked for.
    ///
    /// # Errors
    /// If [`DeviceChoice::Gpu`] was asked for and no adapter opens.
    #[cfg(feature = "gpu")]
    pub fn open(choice: DeviceChoice) -> Result<Self, DeviceError> {
        match choice {
            DeviceChoice::Cpu => Ok(Self::Cpu),
            DeviceChoice::Auto => Ok(Gpu::new(AdapterChoice::HardwareOnly)
                .map_or(Self::Cpu, |gpu| Self::Gpu(Box::new(gpu)))),
            DeviceChoice::Gpu => match Gpu::new(AdapterChoice::Any) {
                Ok(gpu) => Ok(Self::Gpu(Box::new(gpu))),
                Err(error) => Err(DeviceError::Gpu(error)),
            },
        }
    }

    /// Opens what was asked for.
    ///
    /// # Errors
    /// If [`DeviceChoice::Gpu`] was asked for, which this build does not support.
    #[cfg(not(feature = "gpu"))]
    pub fn open(choice: DeviceChoice) -> Result<Self, DeviceError> {
        match choice {
            DeviceChoice::Cpu | DeviceChoice::Auto => Ok(Self::Cpu),
            DeviceChoice::Gpu => Err(DeviceError::NotBuilt),
        }
    }
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cpu => write!(f, "CPU ({} threads)", rayon::current_num_threads()),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => gpu.report().fmt(f),
        }
    }
}
