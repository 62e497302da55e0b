//! `burgeon devices`.

use super::{Failure, counted, flags, print};

/// A few lines an adapter, the preferred first; then the CPU. The marks say what `--backend` takes.
#[cfg(feature = "gpu")]
pub fn devices(_: &flags::Devices) -> Result<(), Failure> {
    let list = burgeon::gpu::adapters();
    if list.is_empty() {
        let none = burgeon::gpu::Headless::new(burgeon::gpu::Requirement::Any);
        let why = none.err().map_or("no adapter was found".to_string(), |e| e.to_string());
        return Err(Failure::Device(format!("error: {why}\n{}", cpu("auto ->"))));
    }
    let mut text = String::new();
    // Hardware comes first.
    let hardware = list.first().is_some_and(|adapter| burgeon::gpu::is_hardware(&adapter.get_info()));
    for (n, adapter) in list.iter().enumerate() {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let mark = match (n, hardware) {
            (0, true) => "auto ->",
            (0, false) => "gpu  ->",
            _ => "",
        };
        text.push_str(&format!(
            "{mark:7} {}\n          driver: {}\n          largest binding {} MiB, largest buffer {} MiB, {} storage buffers a stage\n",
            label(&info),
            driver(&info),
            limits.max_storage_buffer_binding_size >> 20,
            limits.max_buffer_size >> 20,
            limits.max_storage_buffers_per_shader_stage,
        ));
    }
    text.push_str(&cpu(if hardware { "" } else { "auto ->" }));
    print(&text)
}

/// An adapter in words: its name, through what it is driven, of what kind it is.
#[cfg(feature = "gpu")]
pub fn label(info: &wgpu::AdapterInfo) -> String {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete GPU",
        wgpu::DeviceType::IntegratedGpu => "integrated GPU",
        wgpu::DeviceType::VirtualGpu => "virtual GPU",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "unknown kind",
    };
    let backend = match info.backend {
        wgpu::Backend::Gl => "GL".to_string(),
        wgpu::Backend::Dx12 => "DX12".to_string(),
        other => format!("{other:?}"),
    };
    format!("{} ({backend}, {kind})", info.name)
}

/// The driver and its version, as far as it tells.
#[cfg(feature = "gpu")]
pub fn driver(info: &wgpu::AdapterInfo) -> String {
    let parts = [info.driver.trim(), info.driver_info.trim()];
    parts.into_iter().filter(|s| !s.is_empty()).collect::<Vec<_>>().join(", ")
}

#[cfg(not(feature = "gpu"))]
pub fn devices(_: &flags::Devices) -> Result<(), Failure> {
    print(&format!("{}\nThis burgeon was built without the feature gpu.\n", cpu("auto ->")))
}

fn cpu(mark: &str) -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{mark:7} the CPU backend (--backend cpu), {}\n", counted(threads as u64, "thread"))
}
