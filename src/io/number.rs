//! Numbers as text.

use serde_json::ser::{CompactFormatter, Formatter};
use std::io::{self, Write};

/// Writes `x` as the shortest text that reads back to the same f32, with its sign even at zero
/// (`-0.0`) and a point or an exponent (`1.0`, `1e-7`), so that it never looks like an integer.
///
/// # Errors
/// What the writer reports. `x` must be finite: callers check, since only they can name the element.
pub fn write_f32<W: Write + ?Sized>(writer: &mut W, x: f32) -> io::Result<()> {
    CompactFormatter.write_f32(writer, x)
}

/// [`write_f32`] with double precision.
pub(super) fn write_f64<W: Write + ?Sized>(writer: &mut W, x: f64) -> io::Result<()> {
    CompactFormatter.write_f64(writer, x)
}

pub(super) fn write_usize<W: Write + ?Sized>(writer: &mut W, x: usize) -> io::Result<()> {
    CompactFormatter.write_u64(writer, x as u64)
}

/// Writes the numbers with `separator` before each.
pub(super) fn write_each<W: Write + ?Sized>(writer: &mut W, separator: &[u8], xs: &[f32]) -> io::Result<()> {
    xs.iter().try_for_each(|&x| {
        writer.write_all(separator)?;
        write_f32(writer, x)
    })
}
