//! Keeps a library from talking on our stderr.
//!
//! Mesa's Vulkan layer that picks a device asks the Wayland compositor which one it runs on, with or
//! without a desktop. Where there is neither `XDG_RUNTIME_DIR` nor a desktop (containers, cron, CI),
//! libwayland answers with an error on stderr, once for every look at the adapters. The name of a
//! socket that does not exist answers the same question silently.

/// A name for the compositor's socket that needs no `XDG_RUNTIME_DIR`, and where none ever is.
#[cfg(target_os = "linux")]
const NOWHERE: &str = "/dev/null/wayland-0";

/// Says that there is no compositor, if libwayland would complain that it cannot tell.
///
/// The environment of a running program cannot be changed safely, so the program starts itself once
/// more in its own place. Where that is not possible it simply goes on.
#[cfg(target_os = "linux")]
pub fn without_wayland() {
    use std::os::unix::process::CommandExt;
    let absolute = |name| std::env::var_os(name).is_some_and(|v| v.as_encoded_bytes().starts_with(b"/"));
    let socket = std::env::var_os("WAYLAND_SOCKET").is_some();
    if socket || absolute("XDG_RUNTIME_DIR") || absolute("WAYLAND_DISPLAY") {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let mut args = std::env::args_os();
    let mut command = std::process::Command::new(program);
    if let Some(name) = args.next() {
        command.arg0(name);
    }
    // It returns only where it failed.
    let _ = command.args(args).env("WAYLAND_DISPLAY", NOWHERE).exec();
}

#[cfg(not(target_os = "linux"))]
pub fn without_wayland() {}
