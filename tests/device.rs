//! The devices that the GPU tests run on.

use burgeon::gpu::{Engine, Headless, Requirement, adapters_in};

/// The adapter that `BURGEON_ADAPTER` names, else the preferred one of an instance that hides all
/// that is not WebGPU. None only if `BURGEON_SKIP_GPU=1` asks for it: without an adapter the tests
/// fail.
pub fn headless() -> Option<Headless> {
    if skipped("BURGEON_SKIP_GPU") {
        return None;
    }
    let named = std::env::var("BURGEON_ADAPTER").ok();
    let found = match &named {
        Some(name) => Headless::new(Requirement::Named(name)),
        None => strict(),
    };
    match found {
        Ok(headless) => Some(headless),
        Err(e) => panic!("{e}; to leave out all GPU tests set BURGEON_SKIP_GPU=1"),
    }
}

fn skipped(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|v| v == "1")
}

/// The preferred adapter under strict WebGPU compliance.
fn strict() -> Result<Headless, burgeon::gpu::Error> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.flags |= wgpu::InstanceFlags::STRICT_WEBGPU_COMPLIANCE;
    match adapters_in(descriptor).first() {
        Some(adapter) => Headless::open(adapter),
        // It says what is missing.
        None => Headless::new(Requirement::Any),
    }
}

/// The GL adapter, which strict compliance hides. None only if `BURGEON_SKIP_GL=1` asks for it.
fn gl() -> Option<Headless> {
    if skipped("BURGEON_SKIP_GL") {
        return None;
    }
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::GL;
    let list = adapters_in(descriptor);
    let adapter = list.first();
    let adapter = adapter.unwrap_or_else(|| {
        panic!("no GL adapter (Debian: libegl1 and libgl1-mesa-dri); to leave it out set BURGEON_SKIP_GL=1")
    });
    Some(Headless::open(adapter).unwrap_or_else(|e| panic!("{e}")))
}

/// All engines that the conformance tests run on, with their names: the one above and, unless
/// an adapter was named, the GL one.
pub fn engines() -> Vec<(String, Engine)> {
    let Some(first) = headless() else { return Vec::new() };
    let mut list = vec![first];
    if std::env::var("BURGEON_ADAPTER").is_err() {
        list.extend(gl());
    }
    let named =
        |h: Headless| (format!("{} ({:?})", h.info.name, h.info.backend), Engine::new(&h.device, &h.queue));
    list.into_iter().map(named).collect()
}
