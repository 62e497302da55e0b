//! The devices that the GPU tests run on.

use crate::tier;
use burgeon::gpu::{Engine, Error, Headless, Requirement, adapters_in};
use std::sync::OnceLock;

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
        None => preferred(),
    };
    match found {
        Ok(headless) => Some(headless),
        Err(e) => panic!("{e}; to leave out all GPU tests set BURGEON_SKIP_GPU=1"),
    }
}

fn skipped(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|v| v == "1")
}

/// The preferred adapter under strict WebGPU compliance, or where none is that strict the preferred one. It is looked
/// for once; each test has a device of its own.
fn preferred() -> Result<Headless, Error> {
    static ADAPTER: OnceLock<Option<wgpu::Adapter>> = OnceLock::new();
    let first = |flags: wgpu::InstanceFlags| {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        descriptor.flags |= flags;
        // Lines of the source, for debuggers of kernels: naga takes a sixth of the time of these tests to find them.
        descriptor.flags -= wgpu::InstanceFlags::DEBUG;
        adapters_in(descriptor).into_iter().next()
    };
    let strict = wgpu::InstanceFlags::STRICT_WEBGPU_COMPLIANCE;
    match ADAPTER.get_or_init(|| first(strict).or_else(|| first(wgpu::InstanceFlags::empty()))) {
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

/// Both engines, with their names: the one above and, unless an adapter was named, the GL one.
pub fn both() -> Vec<(String, Engine)> {
    list(true)
}

/// Both engines where all cases are tried. A sample has the GL one where a test asks for [`both`].
pub fn engines() -> Vec<(String, Engine)> {
    list(tier::is_all())
}

fn list(with_gl: bool) -> Vec<(String, Engine)> {
    let Some(first) = headless() else { return Vec::new() };
    let mut list = vec![first];
    if with_gl && std::env::var("BURGEON_ADAPTER").is_err() {
        list.extend(gl());
    }
    let named = |h: Headless| {
        let engine = Engine::new(&h.device, &h.queue).keeping_kernels();
        (format!("{} ({:?})", h.info.name, h.info.backend), engine)
    };
    list.into_iter().map(named).collect()
}

/// All words of a buffer that can be copied.
pub fn words(engine: &Engine, buffer: &wgpu::Buffer) -> Vec<u32> {
    let staging = engine.device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = engine.device().create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    engine.queue().submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    engine.device().poll(wgpu::PollType::wait_indefinitely()).expect("a device");
    bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).expect("a range"))
}
