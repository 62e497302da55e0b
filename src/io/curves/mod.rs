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

/// The curves of a word: the positions of its modules, and whether they close. Of a tree each axis is one, that of a
/// branch from the point where it branches off.
pub fn polylines(word: &Word) -> Vec<(Vec<[f32; 3]>, bool)> {
    if word.topology == Topology::Ring {
        return vec![(word.points(), true)];
    }
    // Where each branches off, and its points.
    let mut curves: Vec<(Option<[f32; 3]>, Vec<[f32; 3]>)> = Vec::new();
    // For each module the curve of its axis, and where it stands or the last before it that has a position.
    let mut places: Vec<(usize, Option<[f32; 3]>)> = Vec::with_capacity(word.modules.len());
    for module in &word.modules {
        let before = module.parent.map(|parent| places[parent]);
        let curve = match before {
            Some((curve, _)) if !module.lateral => curve,
            _ => {
                let start = before.and_then(|(_, at)| at);
                curves.push((start, Vec::new()));
                curves.len() - 1
            }
        };
        let own = module.position();
        curves[curve].1.extend(own);
        places.push((curve, own.or(before.and_then(|(_, at)| at))));
    }
    let drawn = curves.into_iter().filter(|(_, points)| !points.is_empty());
    drawn.map(|(start, points)| (start.into_iter().chain(points).collect(), false)).collect()
}
