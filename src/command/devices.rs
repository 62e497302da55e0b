//! `burgeon devices`.

use super::{Failure, flags, print};

/// A line an adapter, the one that is taken first.
#[cfg(feature = "gpu")]
pub fn devices(_: &flags::Devices) -> Result<(), Failure> {
    let list = burgeon::gpu::adapters();
    if list.is_empty() {
        let none = burgeon::gpu::Headless::new(burgeon::gpu::Requirement::Any);
        let why = none.err().map_or(String::new(), |e| e.to_string());
        return Err(Failure::Device(format!("error: {why}")));
    }
    let mut text = String::new();
    for (n, adapter) in list.iter().enumerate() {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let mark = if n == 0 { "auto ->" } else { "       " };
        text.push_str(&format!("{mark} {} ({:?}, {:?})\n", info.name, info.backend, info.device_type));
        text.push_str(&format!("          driver: {} {}\n", info.driver, info.driver_info));
        text.push_str(&format!(
            "          largest binding {} MiB, largest buffer {} MiB, {} storage buffers a stage\n",
            limits.max_storage_buffer_binding_size >> 20,
            limits.max_buffer_size >> 20,
            limits.max_storage_buffers_per_shader_stage,
        ));
    }
    print(&text)
}

#[cfg(not(feature = "gpu"))]
pub fn devices(_: &flags::Devices) -> Result<(), Failure> {
    print("the CPU only: this burgeon was built without the feature gpu\n")
}
