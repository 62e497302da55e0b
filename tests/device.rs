//! The device that the GPU tests run on.

use burgeon::gpu::{Engine, Headless, Requirement};

/// The adapter named by `BURGEON_ADAPTER`, else the preferred one. None only if
/// `BURGEON_SKIP_GPU=1` asks for it: without an adapter the tests fail.
pub fn headless() -> Option<Headless> {
    if std::env::var("BURGEON_SKIP_GPU").is_ok_and(|v| v == "1") {
        return None;
    }
    let name = std::env::var("BURGEON_ADAPTER").ok();
    let requirement = name.as_deref().map_or(Requirement::Any, Requirement::Named);
    match Headless::new(requirement) {
        Ok(headless) => Some(headless),
        Err(e) => panic!("{e}; to leave out all GPU tests set BURGEON_SKIP_GPU=1"),
    }
}

/// An engine on it.
pub fn engine() -> Option<Engine> {
    headless().map(|h| Engine::new(&h.device, &h.queue))
}
