//! Numbers as text.

use serde::ser::{Serialize, Serializer};
use serde_json::ser::{CompactFormatter, Formatter};
use std::io::{self, Write};

/// The one f32 (with its negative) whose shortest decimal, 7.038531e-26, reads back as its neighbour
/// where a program reads numbers in double precision and rounds once more, as most do. Found by trying
/// all 2³¹.
const ROUNDED_TWICE: u32 = 0x15ae_43fd;

/// Writes `x` as text that reads back to the same f32, directly or through an f64: the shortest such,
/// with its sign even at zero (`-0.0`) and a point or an exponent (`1.0`, `1e-7`), so that it never
/// looks like an integer.
///
/// # Errors
/// What the writer reports. `x` must be finite: callers check, since only they can name the element.
pub fn write_f32<W: Write + ?Sized>(writer: &mut W, x: f32) -> io::Result<()> {
    match x.abs().to_bits() {
        ROUNDED_TWICE => CompactFormatter.write_f64(writer, x.into()),
        _ => CompactFormatter.write_f32(writer, x),
    }
}

/// [`write_f32`] for serde.
pub(super) struct Number(pub f32);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.abs().to_bits() {
            ROUNDED_TWICE => serializer.serialize_f64(self.0.into()),
            _ => serializer.serialize_f32(self.0),
        }
    }
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
