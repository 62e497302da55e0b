//! Nets by the extension of their file.

use super::{Noted, ReadError, bpt, bv, json, obj};
use crate::patch::Net;
use std::path::Path;

/// How nets are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NetOptions {
    /// Whether weights may be other than 1.
    pub rational: bool,
    /// Whether the quads of an `.obj` are the control points of a B-spline
    /// ([`obj::parse_bspline`]); else an `.obj` is refused.
    pub bspline: bool,
}

/// Reads nets from a `.bpt`, `.bv`, `.json` or, as a B-spline, `.obj`, in any case of letters.
///
/// # Errors
/// When the file has another extension, cannot be read, or holds something else.
pub fn read_nets(path: impl AsRef<Path>, options: NetOptions) -> Result<Noted<Vec<Net>>, ReadError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let refuse = |help| Err(ReadError::Format { path: path.into(), help });
    match extension.as_ref().and_then(|e| e.to_str()) {
        Some("bpt") => bpt::read(path, options.rational).map(Noted::from),
        Some("bv") => bv::read(path, options.rational),
        Some("json") => json::read_nets(path, options.rational).map(Noted::from),
        Some("obj") if options.bspline => obj::read_bspline(path, options.rational).map(Noted::from),
        Some("obj") => {
            refuse("an .obj holds a mesh; as the control points of a B-spline it is read with --bspline")
        }
        _ => refuse("patches are read from .bpt, .bv, .json, and with --bspline from .obj"),
    }
}
