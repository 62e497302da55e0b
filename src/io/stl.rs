//! Triangle meshes as binary `.stl`.
//!
//! ```text
//! 80 bytes     a comment
//! u32          how many triangles
//! 50 bytes a triangle: the unit normal and three corners, counter-clockwise, as f32; a u16 that is 0
//! ```
//!
//! All is little-endian. The format knows neither units nor an axis that points up: coordinates are those of the model.

use super::write::{WriteError, check_vertex, one_line, write_in_blocks};
use crate::tessellate::Mesh;
use std::io::Write;

/// Bytes of the comment.
const COMMENT: usize = 80;

/// Writes a mesh, triangle by triangle. The name stands in the comment in ASCII, cut to its length, with `_` for all
/// other characters. A triangle without an area has the normal (0, 0, 0), from which readers make their own.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the vertex; more triangles than the format can count.
pub fn write(writer: &mut dyn Write, mesh: &Mesh, name: &str) -> Result<(), WriteError> {
    let triangles = mesh.indices.len() / 3;
    let count = u32::try_from(triangles);
    let count = count.map_err(|_| {
        WriteError::Unsupported(format!("{triangles} triangles are more than an .stl can hold"))
    })?;
    // It may not begin with `solid`, as the other form of the format does.
    let comment = format!("burgeon {} {}", env!("CARGO_PKG_VERSION"), one_line(name));
    let mut comment = comment.replace(|c: char| !c.is_ascii(), "_").into_bytes();
    comment.resize(COMMENT, 0);
    writer.write_all(&comment)?;
    writer.write_all(&count.to_le_bytes())?;
    write_in_blocks(writer, triangles, |triangle, bytes| {
        let corners = [0, 1, 2].map(|corner| mesh.indices[3 * triangle + corner] as usize);
        corners.iter().try_for_each(|&vertex| check_vertex(mesh, vertex))?;
        let [a, b, c] = corners.map(|vertex| mesh.positions[vertex]);
        let numbers = normal([a, b, c]).into_iter().chain([a, b, c].into_iter().flatten());
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
        Ok(())
    })
}

/// To the side from which the corners run counter-clockwise.
fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|corner| glam::DVec3::from_array(corner.map(f64::from)));
    (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array()
}
