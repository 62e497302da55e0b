//! Curves as files: polylines in, words out.

pub mod csv;
pub mod json;
mod picture;
pub mod raster;
pub mod svg;

pub use crate::curve::Polyline;
pub use picture::{Panel, Picture, Stroke, Style};

use super::Noted;
use super::obj;
use super::text::ReadError;
use crate::curve::{Module, Word};
use crate::language::system::Topology;
use crate::word::Column;
use std::path::Path;

/// Reads the curves of a file, by its extension: `.obj` (vertices, and lines if there are any), `.csv` or
/// `.svg`. `coordinates`, of 2 to 4, are how many of a point are wanted: a `.csv` may not have more columns.
///
/// # Errors
/// When the file cannot be read or is not of its format.
pub fn read(path: impl AsRef<Path>, coordinates: usize) -> Result<Noted<Vec<Polyline>>, ReadError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    match extension.as_ref().and_then(|e| e.to_str()) {
        Some("obj") => ReadError::in_file(path, obj::lines),
        Some("csv") => ReadError::in_file(path, |text| Ok(csv::parse(text, coordinates)?.into())),
        Some("svg") => ReadError::in_file(path, svg::parse),
        _ => {
            let help = "the points of curves are read from .obj, .csv and .svg";
            Err(ReadError::Format { path: path.into(), help })
        }
    }
}

/// A curve of a word.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// The positions of its modules; a branch begins where it branches off.
    pub points: Vec<[f32; 3]>,
    pub closed: bool,
    /// How wide the line to each point is, where modules have a float `r`; else empty.
    pub widths: Vec<f32>,
}

/// The curves of a word: of a tree each axis is one.
pub fn lines(word: &Word) -> Vec<Line> {
    if word.topology == Topology::Ring {
        return vec![Line { points: word.points(), closed: true, widths: Vec::new() }];
    }
    let width_of = |module: &Module| {
        let fields = word.symbols[module.symbol].fields.iter();
        fields.zip(word.params.columns(module.symbol)).find_map(|(field, column)| match column {
            Column::Float(all) if field.name == "r" => all.get(module.row as usize).copied(),
            _ => None,
        })
    };
    let mut lines: Vec<Line> = Vec::new();
    // For each module the curve of its axis, and where it stands or the last before it that has a position.
    let mut places: Vec<(Option<usize>, Option<[f32; 3]>)> = Vec::with_capacity(word.modules.len());
    for (module, position) in word.modules.iter().zip(word.positions()) {
        let (before, from) = module.parent.map_or((None, None), |parent| places[parent]);
        let mut line = before.filter(|_| !module.lateral);
        let Some(own) = position else {
            places.push((line, from));
            continue;
        };
        let n = *line.get_or_insert_with(|| {
            let points: Vec<[f32; 3]> = from.into_iter().collect();
            let widths = points.iter().filter_map(|_| width_of(module)).collect();
            lines.push(Line { points, closed: false, widths });
            lines.len() - 1
        });
        lines[n].points.push(own);
        lines[n].widths.extend(width_of(module));
        places.push((line, Some(own)));
    }
    lines
}
