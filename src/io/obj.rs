//! Triangle meshes as Wavefront `.obj`.

use super::number::{write_each, write_usize};
use super::write::WriteError;
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
    let name: String = name.trim().chars().map(|c| if c.is_control() { '_' } else { c }).collect();
    writeln!(writer, "o {}", if name.is_empty() { "mesh" } else { &name })?;
    vectors(writer, "v", "the position", &mesh.positions)?;
    vectors(writer, "vt", "the uv", &mesh.uvs)?;
    vectors(writer, "vn", "the normal", &mesh.normals)?;
    for triangle in mesh.triangles() {
        face(writer, triangle)?;
    }
    Ok(())
}

fn vectors<const N: usize>(
    writer: &mut dyn Write,
    keyword: &str,
    what: &str,
    vectors: &[[f32; N]],
) -> Result<(), WriteError> {
    for (vertex, vector) in vectors.iter().enumerate() {
        if let Some(&value) = vector.iter().find(|x| !x.is_finite()) {
            return Err(WriteError::not_finite(format_args!("{what} of vertex {vertex}"), value));
        }
        writer.write_all(keyword.as_bytes())?;
        write_each(writer, b" ", vector)?;
        writer.write_all(b"\n")?;
    }
    Ok(())
}

/// Vertices count from 1 in the file.
fn face(writer: &mut dyn Write, triangle: [u32; 3]) -> io::Result<()> {
    writer.write_all(b"f")?;
    for vertex in triangle {
        for separator in [b" ", b"/", b"/"] {
            writer.write_all(separator)?;
            write_usize(writer, vertex as usize + 1)?;
        }
    }
    writer.write_all(b"\n")
}
