//! Triangle meshes.

use super::super::number::{write_each, write_usize};
use super::super::write::{WriteError, check_vertex, one_line, write_in_blocks};
use crate::tessellate::Mesh;
use std::io::{self, Write};

/// Writes a mesh as one object: a `v`, `vt` and `vn` for each vertex, in its order, and an
/// `f a/a/a b/b/b c/c/c` for each triangle. Numbers read back to the same f32.
///
/// The name stands on a line of its own, up to its end; line breaks and other control characters in
/// it become `_`, and an empty one `mesh`.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the vertex.
pub fn write(writer: &mut dyn Write, mesh: &Mesh, name: &str) -> Result<(), WriteError> {
    writeln!(writer, "o {}", one_line(name))?;
    vectors(writer, "v", mesh, &mesh.positions)?;
    vectors(writer, "vt", mesh, &mesh.uvs)?;
    vectors(writer, "vn", mesh, &mesh.normals)?;
    let triangles = mesh.indices.len() / 3;
    write_in_blocks(writer, triangles, |index, text| Ok(face(text, &mesh.indices[3 * index..3 * index + 3])?))
}

fn vectors<const N: usize>(
    writer: &mut dyn Write,
    keyword: &str,
    mesh: &Mesh,
    vectors: &[[f32; N]],
) -> Result<(), WriteError> {
    write_in_blocks(writer, vectors.len(), |vertex, text| {
        check_vertex(mesh, vertex)?;
        text.extend_from_slice(keyword.as_bytes());
        write_each(text, b" ", &vectors[vertex])?;
        text.push(b'\n');
        Ok(())
    })
}

/// Vertices count from 1 in the file.
fn face(text: &mut Vec<u8>, triangle: &[u32]) -> io::Result<()> {
    text.push(b'f');
    for &vertex in triangle {
        for separator in [b' ', b'/', b'/'] {
            text.push(separator);
            write_usize(text, vertex as usize + 1)?;
        }
    }
    text.push(b'\n');
    Ok(())
}
