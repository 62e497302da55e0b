//! What a run writes, by the extension of its name.

use super::progress::Bar;
use super::run::Device;
use super::stop::{self, Stoppable};
use super::{Failure, flags, load};
use burgeon::io::{self, FileError, WriteError};
use burgeon::patch::Word;
use burgeon::tessellate::{self, Mesh, Up};
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Bpt,
    Bv,
    Json,
    Obj,
    Ply,
    Glb,
    Png,
}

const FORMATS: [(&str, Format); 7] = [
    ("bpt", Format::Bpt),
    ("bv", Format::Bv),
    ("json", Format::Json),
    ("obj", Format::Obj),
    ("ply", Format::Ply),
    ("glb", Format::Glb),
    ("png", Format::Png),
];

/// A file to be written.
pub struct Target {
    path: PathBuf,
    format: Format,
}

/// The targets, before anything runs: an extension that nobody writes is wrong usage.
pub fn targets(paths: &[PathBuf]) -> Result<Vec<Target>, Failure> {
    let target = |path: &PathBuf| {
        let format = FORMATS.iter().find(|(extension, _)| load::has_extension(path, extension));
        match format {
            Some((_, format)) => Ok(Target { path: path.clone(), format: *format }),
            None => {
                let what = "patches are written as .bpt, .bv, .json, .obj, .ply, .glb or .png";
                Err(Failure::Usage(format!("error: --out {}: {what}", path.display())))
            }
        }
    };
    paths.iter().map(target).collect()
}

/// Whether one of these is a picture.
pub fn needs_adapter(paths: &[PathBuf]) -> bool {
    paths.iter().any(|path| load::has_extension(path, "png"))
}

/// Writes all targets: where one fails, the others are still written.
pub fn write(
    targets: &[Target],
    word: &Word,
    flags: &flags::Run,
    device: Option<&Device>,
    bar: &Bar,
) -> Result<(), Failure> {
    let needs_mesh = targets.iter().any(|t| !matches!(t.format, Format::Bpt | Format::Bv | Format::Json));
    let name = &word.system;
    let up = match flags.up {
        flags::Up::Y => Up::Y,
        flags::Up::Z => Up::Z,
    };
    let mesh = if needs_mesh { mesh(word, flags.grid as usize, bar) } else { Ok(Mesh::default()) };
    let mut failures = Vec::new();
    for target in targets {
        if stop::requested() {
            break;
        }
        bar.writing(&target.path);
        let result = match (target.format, &mesh) {
            (Format::Bpt, _) => file(&target.path, |w| io::bpt::write(w, word)),
            (Format::Bv, _) => file(&target.path, |w| io::bv::write(w, word)),
            (Format::Json, _) => file(&target.path, |w| io::json::write(w, word)),
            (Format::Obj, Ok(mesh)) => file(&target.path, |w| io::obj::write(w, mesh, name)),
            (Format::Ply, Ok(mesh)) => file(&target.path, |w| io::ply::write(w, mesh, name)),
            (Format::Glb, Ok(mesh)) => file(&target.path, |w| io::glb::write(w, mesh, name, up)),
            (Format::Png, Ok(mesh)) => picture(&target.path, mesh, up, flags, device),
            (_, Err(why)) => Err(Failure::Device(format!("error: {}: {why}", target.path.display()))),
        };
        failures.extend(result.err());
    }
    stop::check("before all files were written; those written are whole")?;
    super::joined(failures)
}

fn mesh(word: &Word, grid: usize, bar: &Bar) -> Result<Mesh, tessellate::Error> {
    let n = tessellate::grid_for(word.modules.len(), grid);
    if n < grid {
        let why = "more cells a leaf would make over 2 million triangles";
        bar.say(&format!("note: --grid {n} in place of {grid}: {why}"));
    }
    tessellate::dice(word, n)
}

fn file(
    path: &Path,
    content: impl FnOnce(&mut dyn std::io::Write) -> Result<(), WriteError>,
) -> Result<(), Failure> {
    io::write_atomically(path, |w| content(&mut Stoppable(w)))
        .map_err(|e: FileError| Failure::File(format!("error: {e}")))
}

#[cfg(feature = "gpu")]
fn picture(
    path: &Path,
    mesh: &Mesh,
    up: Up,
    flags: &flags::Run,
    device: Option<&Device>,
) -> Result<(), Failure> {
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
    let options = Picture { up, ..Picture::default() };
    let image = render::render(&device.device, &device.queue, mesh, &options)
        .map_err(|e| Failure::Device(format!("error: {}: {e}", path.display())))?;
    file(path, |w| io::png::write(w, &image))
}

#[cfg(not(feature = "gpu"))]
fn picture(path: &Path, _: &Mesh, _: Up, _: &flags::Run, _: Option<&Device>) -> Result<(), Failure> {
    Err(Failure::Device(format!("error: {}: this burgeon was built without the feature gpu", path.display())))
}
