//! What is known of an adapter.

use std::fmt;

/// What is known of an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterReport {
    /// The name of the device.
    pub name: String,
    /// The graphics interface: Vulkan, Metal, Dx12 or Gl.
    pub backend: String,
    /// The driver and its version; empty where the interface does not say.
    pub driver: String,
    /// Whether it runs on the CPU.
    pub software: bool,
}

impl AdapterReport {
    pub(super) fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self {
            software: is_software(&info),
            backend: format!("{:?}", info.backend),
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            name: info.name,
        }
    }
}

impl fmt::Display for AdapterReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}", self.name, self.backend)?;
        if !self.driver.is_empty() {
            write!(f, ", {}", self.driver)?;
        }
        if self.software {
            f.write_str(", software")?;
        }
        f.write_str(")")
    }
}

/// Whether an adapter runs on the CPU. Some interfaces do not give the type of theirs, so known
/// names count as well.
pub(super) fn is_software(info: &wgpu::AdapterInfo) -> bool {
    let name = info.name.to_lowercase();
    let known = [
        "llvmpipe",
        "lavapipe",
        "softpipe",
        "swiftshader",
        "microsoft basic render",
    ];
    info.device_type == wgpu::DeviceType::Cpu || known.iter().any(|known| name.contains(known))
}
