//! Finding an adapter.

use std::path::Path;

use super::GpuError;
use super::report::{AdapterReport, is_software};

/// Which adapters may be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdapterChoice {
    /// A hardware GPU only: never an adapter that runs on the CPU or does not say what it is.
    HardwareOnly,
    /// Any adapter, software ones such as lavapipe included.
    Any,
}

/// The rank of an adapter, the lowest being the best; `None` where it cannot run compute shaders.
fn rank(adapter: &wgpu::Adapter) -> Option<u32> {
    let flags = adapter.get_downlevel_capabilities().flags;
    let limits = adapter.limits();
    let computes = flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
        && limits.max_storage_buffers_per_shader_stage >= 4
        && limits.max_compute_invocations_per_workgroup >= 64;
    let info = adapter.get_info();
    let kind = match info.device_type {
        _ if is_software(&info) => 4,
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other | wgpu::DeviceType::Cpu => 3,
    };
    computes.then_some(kind)
}

/// Whether this machine may have a hardware GPU: on Linux and Android, whether a kernel driver offers
/// one. Asking first spares machines without one the start of the graphics drivers, some of which
/// print to the standard streams.
fn may_have_hardware() -> bool {
    if !cfg!(any(target_os = "linux", target_os = "android")) {
        return true;
    }
    let devices = [
        "nvidiactl",
        "nvidia0",
        "nvhost-gpu",
        "dxg",
        "kgsl-3d0",
        "mali0",
    ];
    let rendering = std::fs::read_dir("/dev/dri").is_ok_and(|nodes| nodes.count() > 0);
    rendering
        || devices
            .iter()
            .any(|name| Path::new("/dev").join(name).exists())
}

/// The best adapter that the choice allows.
pub(super) fn best(choice: AdapterChoice) -> Result<wgpu::Adapter, GpuError> {
    // OpenGL comes last, for machines that have nothing else: starting it can print to the standard
    // streams, which a silent automatic choice must never do.
    let (worst_kind, backends) = match choice {
        AdapterChoice::HardwareOnly => (2, &[wgpu::Backends::PRIMARY][..]),
        AdapterChoice::Any => (4, &[wgpu::Backends::PRIMARY, wgpu::Backends::GL][..]),
    };
    if choice == AdapterChoice::HardwareOnly && !may_have_hardware() {
        return Err(GpuError::NoAdapter(Vec::new()));
    }
    let mut reports = Vec::new();
    for &backends in backends {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            // The driver's own validation layers print to the standard streams as well.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let found = pollster::block_on(instance.enumerate_adapters(backends));
        reports.extend(found.iter().map(AdapterReport::of));
        let ranked = found
            .into_iter()
            .filter_map(|adapter| Some((rank(&adapter)?, adapter)));
        let allowed = ranked.filter(|(kind, _)| *kind <= worst_kind);
        if let Some((_, best)) = allowed.min_by_key(|(kind, _)| *kind) {
            return Ok(best);
        }
    }
    Err(GpuError::NoAdapter(reports))
}
