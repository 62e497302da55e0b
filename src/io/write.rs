//! Whole files or none.

use crate::tessellate::Mesh;
use rayon::prelude::*;
use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;
use thiserror::Error;

/// Why a writer stopped.
#[derive(Debug, Error)]
pub enum WriteError {
    #[error(transparent)]
    Io(#[from] io::Error),
    /// No text format here has a number for infinity or NaN.
    #[error("{element} holds {value}, which is not a finite number")]
    NotFinite { element: String, value: f32 },
    /// The format cannot say this.
    #[error("{0}")]
    Unsupported(String),
}

impl WriteError {
    pub(super) fn not_finite(element: std::fmt::Arguments, value: f32) -> WriteError {
        WriteError::NotFinite { element: element.to_string(), value }
    }

    /// Of one of several words, by its number.
    pub(super) fn of_word(self, n: usize, words: usize) -> WriteError {
        match self {
            WriteError::NotFinite { element, value } if words > 1 => {
                WriteError::NotFinite { element: format!("{element} of word {n}"), value }
            }
            e => e,
        }
    }
}

/// An output file that could not be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct FileError {
    pub path: PathBuf,
    pub source: WriteError,
}

/// Writes a file through `content`, all of it or nothing.
///
/// The text goes to a new file in the same folder, which takes the place of `path` when it is
/// complete; on any failure the new file is removed and an old one at `path` stays as it was. A
/// link is followed, so the file it names is replaced and the link stays. The permissions are those
/// of the old file, or of any newly created one. What is not a regular file (`/dev/stdout`, a pipe, a
/// terminal) is written straight.
///
/// # Errors
/// What `content` or the file system reports, with the path.
pub fn write_atomically(
    path: impl AsRef<Path>,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), FileError> {
    let path = path.as_ref();
    write(path, content).map_err(|source| FileError { path: path.into(), source })
}

fn write(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    // Opening /dev/stdout by name would truncate a file it was redirected to.
    if path == Path::new("/dev/stdout") || path == Path::new("/dev/fd/1") {
        return finish(BufWriter::new(io::stdout().lock()), content);
    }
    match fs::metadata(path) {
        Ok(old) if old.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory).into()),
        Ok(old) if !old.is_file() || path.starts_with("/dev") || path.starts_with("/proc") => {
            finish(BufWriter::new(OpenOptions::new().write(true).open(path)?), content)
        }
        Ok(old) => replace(&fs::canonicalize(path)?, Some(old.permissions()), content),
        Err(_) => replace(path, None, content),
    }
}

fn replace(
    path: &Path,
    permissions: Option<fs::Permissions>,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    // Renaming over a read-only file would work, but nobody who protects a file expects it.
    if permissions.as_ref().is_some_and(fs::Permissions::readonly) {
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only").into());
    }
    let mut beside = create_beside(path)?;
    finish(BufWriter::new(beside.as_file_mut()), content)?;
    if let Some(permissions) = permissions {
        fs::set_permissions(beside.path(), permissions)?;
    }
    beside.persist(path).map(drop).map_err(|e| e.error.into())
}

/// A new file in the folder of `path`, with the permissions that a plain new file would get.
fn create_beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".burgeon-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder).map_err(|e| plain(e, folder))
}

/// The error without the name of the temporary file, which the user never asked for.
fn plain(error: io::Error, folder: &Path) -> io::Error {
    let kind = error.kind();
    let text = match kind {
        io::ErrorKind::NotFound => format!("there is no folder {}", folder.display()),
        io::ErrorKind::NotADirectory => format!("{} is not a folder", folder.display()),
        io::ErrorKind::PermissionDenied => format!("the folder {} is not writable", folder.display()),
        _ => kind.to_string(),
    };
    io::Error::new(kind, text)
}

fn finish<W: Write>(
    mut writer: BufWriter<W>,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    content(&mut writer)?;
    writer.flush()?;
    Ok(())
}

/// Whether the formats of meshes can say this vertex: all its numbers are finite.
pub(super) fn check_vertex(mesh: &Mesh, vertex: usize) -> Result<(), WriteError> {
    let check = |what: &str, vector: &[f32]| match vector.iter().find(|x| !x.is_finite()) {
        Some(&value) => Err(WriteError::not_finite(format_args!("{what} of vertex {vertex}"), value)),
        None => Ok(()),
    };
    check("the position", &mesh.positions[vertex])?;
    check("the normal", &mesh.normals[vertex])?;
    check("the uv", &mesh.uvs[vertex])
}

/// A name that stands on a line of its own: line breaks and other control characters become `_`, an
/// empty one `mesh`.
pub(super) fn one_line(name: &str) -> String {
    match name.trim() {
        "" => "mesh".into(),
        name => name.chars().map(|c| if c.is_control() { '_' } else { c }).collect(),
    }
}

/// Whether a file of patches can say this point; readers take no other.
pub(super) fn check_point(
    module: usize,
    point: usize,
    &[x, y, z, weight]: &[f32; 4],
) -> Result<(), WriteError> {
    // A weight that is NaN is found as such, not as one that is not positive.
    if weight <= 0.0 {
        return Err(WriteError::Unsupported(format!(
            "point {point} of module {module} has the weight {weight}; a file of patches holds positive ones"
        )));
    }
    match [x / weight, y / weight, z / weight, weight].into_iter().find(|x| !x.is_finite()) {
        Some(value) => Err(WriteError::not_finite(format_args!("point {point} of module {module}"), value)),
        None => Ok(()),
    }
}

/// Writes elements 0..count, each as `element` appends it to its block: many blocks at once, in order.
///
/// # Errors
/// What the writer reports, or the error of the first element that has one.
pub(super) fn write_in_blocks(
    writer: &mut dyn Write,
    count: usize,
    element: impl Fn(usize, &mut Vec<u8>) -> Result<(), WriteError> + Sync,
) -> Result<(), WriteError> {
    const BLOCK: usize = 1 << 12;
    /// Blocks held in memory at a time.
    const BATCH: usize = 64;
    let block = |block: usize| -> Result<Vec<u8>, WriteError> {
        let mut text = Vec::new();
        let first = block * BLOCK;
        (first..count.min(first + BLOCK)).try_for_each(|index| element(index, &mut text))?;
        Ok(text)
    };
    let blocks = count.div_ceil(BLOCK);
    for first in (0..blocks).step_by(BATCH) {
        let batch: Vec<_> = (first..blocks.min(first + BATCH)).into_par_iter().map(block).collect();
        for text in batch {
            writer.write_all(&text?)?;
        }
    }
    Ok(())
}
