//! Triangle meshes as binary `.ply` (Stanford's polygon file format).
//!
//! ```text
//! ply
//! format binary_little_endian 1.0
//! comment burgeon 0.1.0
//! comment NAME
//! element vertex N
//! property float x …    position x y z, unit normal nx ny nz, uv as s t
//! element face M
//! property list uchar uint vertex_indices
//! end_header
//! ```

use super::write::{WriteError, check_vertex, one_line, write_in_blocks};
use crate::tessellate::Mesh;
use std::io::Write;

/// Writes a mesh: 32 bytes a vertex, in its order, then 13 a triangle. The name becomes a comment in
/// ASCII, with `_` for all other characters.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the vertex.
pub fn write(writer: &mut dyn Write, mesh: &Mesh, name: &str) -> Result<(), WriteError> {
    let name = one_line(name).replace(|c: char| !c.is_ascii(), "_");
    let (vertices, triangles) = (mesh.positions.len(), mesh.indices.len() / 3);
    let version = env!("CARGO_PKG_VERSION");
    write!(writer, "ply\nformat binary_little_endian 1.0\ncomment burgeon {version}\ncomment {name}\n")?;
    writeln!(writer, "element vertex {vertices}")?;
    for property in ["x", "y", "z", "nx", "ny", "nz", "s", "t"] {
        writeln!(writer, "property float {property}")?;
    }
    write!(writer, "element face {triangles}\nproperty list uchar uint vertex_indices\nend_header\n")?;
    write_in_blocks(writer, vertices, |vertex, bytes| {
        check_vertex(mesh, vertex)?;
        let (position, normal, uv) = (mesh.positions[vertex], mesh.normals[vertex], mesh.uvs[vertex]);
        bytes.extend(position.iter().chain(&normal).chain(&uv).flat_map(|x| x.to_le_bytes()));
        Ok(())
    })?;
    write_in_blocks(writer, triangles, |triangle, bytes| {
        bytes.push(3);
        bytes.extend(mesh.indices[3 * triangle..3 * triangle + 3].iter().flat_map(|i| i.to_le_bytes()));
        Ok(())
    })
}
