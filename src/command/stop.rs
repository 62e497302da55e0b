//! Ctrl-C: what is being done ends at the next good place, and no file is left half written.

use super::Failure;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by Ctrl-C.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C is looked for. Before, and in commands that write no file, it ends the program
/// at once, which is just as clean.
pub fn watch() {
    // Without a handler Ctrl-C still ends the program, only less cleanly.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
}

/// Whether Ctrl-C has come.
pub fn requested() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// [`Failure::Stopped`] if Ctrl-C has come.
pub fn check(doing: &str) -> Result<(), Failure> {
    if requested() { Err(Failure::Stopped(format!("error: stopped by Ctrl-C {doing}"))) } else { Ok(()) }
}
