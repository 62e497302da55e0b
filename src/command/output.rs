//! What a run writes, by the extension of its name.

use super::run::Device;
use super::{Failure, flags};
use burgeon::io::{self, FileError, WriteError};
use burgeon::patch::Word;
use burgeon::tessellate::{self, Mesh};
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Bpt,
    Json,
    Obj,
    Png,
}

/// A file to be written.
pub struct Target {
    path: PathBuf,
    format: Format,
}

/// The targets, before anything runs: an extension that nobody writes is wrong usage.
pub fn targets(paths: &[PathBuf]) -> Result<Vec<Target>, Failure> {
    let target = |path: &PathBuf| {
        let format = match path.extension().and_then(|e| e.to_str()) {
            Some("bpt") => Format::Bpt,
            Some("json") => Format::Json,
            Some("obj") => Format::Obj,
            Some("png") => Format::Png,
            _ => {
                let what =
                    format!("--out {}: a patch word is written as .bpt .json .obj or .png", path.display());
                return Err(Failure::Usage(what));
            }
        };
        Ok(Target { path: path.clone(), format })
    };
    paths.iter().map(target).collect()
}

/// Writes all targets.
pub fn write(
    targets: &[Target],
    word: &Word,
    flags: &flags::Run,
    device: Option<&Device>,
) -> Result<(), Failure> {
    let needs_mesh = targets.iter().any(|t| matches!(t.format, Format::Obj | Format::Png));
    let mesh = if needs_mesh { Some(mesh(word, flags.grid as usize)?) } else { None };
    let mut failed = None;
    for target in targets {
        let result = match (target.format, &mesh) {
            (Format::Bpt, _) => file(&target.path, |w| io::bpt::write(w, word)),
            (Format::Json, _) => file(&target.path, |w| io::json::write(w, word)),
            (Format::Obj, Some(mesh)) => file(&target.path, |w| io::obj::write(w, mesh, &word.system)),
            (Format::Png, Some(mesh)) => picture(&target.path, mesh, flags, device),
            (_, None) => Ok(()),
        };
        // The others are still written.
        failed = failed.or(result.err());
    }
    failed.map_or(Ok(()), Err)
}

fn mesh(word: &Word, grid: usize) -> Result<Mesh, Failure> {
    let n = tessellate::grid_for(word.modules.len(), grid);
    if n < grid {
        super::say(&format!("--grid {n} in place of {grid}: more would make over 2 million triangles"));
    }
    tessellate::dice(word, n).map_err(|e| Failure::Device(format!("error: {e}")))
}

fn file(
    path: &Path,
    content: impl FnOnce(&mut dyn std::io::Write) -> Result<(), WriteError>,
) -> Result<(), Failure> {
    io::write_atomically(path, content).map_err(|e: FileError| Failure::File(format!("error: {e}")))
}

#[cfg(feature = "gpu")]
fn picture(path: &Path, mesh: &Mesh, flags: &flags::Run, device: Option<&Device>) -> Result<(), Failure> {
    use burgeon::gpu::Requirement;
    use burgeon::render::{self, Picture};
    let no_device = |e: burgeon::gpu::Error| Failure::Device(format!("error: {}: {e}", path.display()));
    let own;
    let device = match device {
        Some(device) => device,
        // The CPU backend has derived; the picture still needs an adapter.
        None => {
            let requirement = flags.derive.adapter.as_deref().map_or(Requirement::Any, Requirement::Named);
            own = Device::new(requirement).map_err(no_device)?;
            &own
        }
    };
    let up = match flags.up {
        flags::Up::Y => render::Up::Y,
        flags::Up::Z => render::Up::Z,
    };
    let options = Picture { up, ..Picture::default() };
    let image = render::render(&device.device, &device.queue, mesh, &options)
        .map_err(|e| Failure::Device(format!("error: {}: {e}", path.display())))?;
    file(path, |w| io::png::write(w, &image))
}

#[cfg(not(feature = "gpu"))]
fn picture(path: &Path, _: &Mesh, _: &flags::Run, _: Option<&Device>) -> Result<(), Failure> {
    Err(Failure::Device(format!("error: {}: this burgeon was built without the feature gpu", path.display())))
}
