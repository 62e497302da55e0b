//! Pictures as `.png`.

use super::write::WriteError;
use std::io::{self, Write};

/// A picture of 8-bit sRGB with straight alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    /// Red, green, blue, alpha; row by row from the top left.
    pub pixels: Vec<u8>,
}

impl Image {
    /// The pixel at column `x` and row `y`, counted from the top left; `None` outside.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        if x >= self.width {
            return None;
        }
        let start = (y as usize * self.width as usize + x as usize) * 4;
        self.pixels.get(start..start + 4)?.try_into().ok()
    }
}

/// Writes a picture, marked as sRGB.
///
/// # Errors
/// What the writer reports, or that the pixels are not width × height × 4 bytes.
pub fn write(writer: &mut dyn Write, image: &Image) -> Result<(), WriteError> {
    let mut encoder = png::Encoder::new(writer, image.width, image.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut body = encoder.write_header().map_err(io_error)?;
    body.write_image_data(&image.pixels).map_err(io_error)?;
    body.finish().map_err(io_error)
}

fn io_error(error: png::EncodingError) -> WriteError {
    match error {
        png::EncodingError::IoError(error) => error.into(),
        other => io::Error::other(other).into(),
    }
}
