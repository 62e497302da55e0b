//! Wavefront `.obj`: meshes out, polygons with their tags and the control points of B-splines in.

mod chain;
mod grid;
mod lines;
mod mesh;
mod read;
mod write;

pub use grid::GridError;
pub use lines::{parse as lines, write as write_lines};
pub use mesh::{parse_mesh, read_mesh};
pub use write::write;

use super::text::{ParseError, ReadError};
use crate::patch::Net;
use std::path::Path;

/// Reads the nets of a file: [`parse_bspline`] with the path in every error.
///
/// # Errors
/// When the file cannot be read, its text is wrong, or its faces are no grid.
pub fn read_bspline(path: impl AsRef<Path>, rational: bool) -> Result<Vec<Net>, ReadError> {
    ReadError::in_file(path.as_ref(), |text| parse_bspline(text, rational))
}

/// Reads a grid of quads as the control points of a uniform bicubic B-spline, and gives its Bézier
/// nets; see [`ControlGrid::nets`](crate::patch::ControlGrid::nets).
///
/// The faces must form one grid of rows and columns; it may be closed along one of them (a tube) or
/// both (a torus). u runs along the first edge of the first face, v from there to its last corner, and
/// the origin is the corner of the grid where both begin, or the first corner of the first face along
/// a direction that is closed. So the normal S_u × S_v points to where the faces are counter-clockwise.
///
/// Points are `v x y z` or, with a weight, `v x y z w`, which is no factor of x, y and z; unless `rational`,
/// all weights must be 1. A
/// colour, `v x y z r g b`, is passed over, and so are texture coordinates, normals, groups,
/// materials, curves and surfaces of free form, and vertices of no face.
///
/// # Errors
/// The first thing that is wrong in the text, or what keeps its faces from being a grid.
pub fn parse_bspline(text: &[u8], rational: bool) -> Result<Vec<Net>, ParseError> {
    let polygons = read::polygons(&read::joined(text), rational).map_err(|wrong| wrong.locate(text))?;
    let grid = grid::control_grid(&polygons).map_err(|wrong| wrong.locate(text))?;
    Ok(grid.nets())
}
