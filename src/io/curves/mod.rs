//! Curves as files: polylines in, words out.

pub mod csv;
pub mod json;
mod picture;
pub mod raster;
pub mod svg;

pub use picture::{Picture, Stroke, Style};

use super::obj;
use super::text::ReadError;
use crate::curve::Word;
use crate::language::system::Topology;
use std::path::Path;

/// Points of a curve, x, y, z and a fourth coordinate, 1 where a file has none.
pub type Polyline = Vec<[f32; 4]>;

/// Reads the curves of a file, by its extension: `.obj` (vertices, and lines if there are any), `.csv` or
/// `.svg`.
///
/// # Errors
/// When the file cannot be read or is not of its format.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<Polyline>, ReadError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    match extension.as_ref().and_then(|e| e.to_str()) {
        Some("obj") => ReadError::in_file(path, obj::lines),
        Some("csv") => ReadError::in_file(path, csv::parse),
        Some("svg") => ReadError::in_file(path, svg::parse),
        _ => {
            let help = "the points of curves are read from .obj, .csv and .svg";
            Err(ReadError::Format { path: path.into(), help })
        }
    }
}

/// The curves of a word: the positions of its modules, and whether they close.
pub fn polylines(word: &Word) -> Vec<(Vec<[f32; 3]>, bool)> {
    vec![(word.points(), word.topology == Topology::Ring)]
}
