//! What a command writes, by the extension of its name.

use super::progress::Bar;
use super::run::Device;
use super::stop::{self, Stoppable};
use super::{Failure, flags, load};
use burgeon::io::{self, FileError, WriteError};
use burgeon::patch::Word;
use burgeon::tessellate::{self, Mesh, Up};
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Bpt,
    Bv,
    Json,
    Obj,
    Ply,
    Glb,
    Stl,
    Png,
}

/// What nets are written as, then what triangles are.
pub const ALL: [(&str, Format); 8] = [
    ("bpt", Format::Bpt),
    ("bv", Format::Bv),
    ("json", Format::Json),
    ("obj", Format::Obj),
    ("ply", Format::Ply),
    ("glb", Format::Glb),
    ("stl", Format::Stl),
    ("png", Format::Png),
];

/// What triangles are written as.
pub const MESHES: &[(&str, Format)] = ALL.split_at(3).1;

/// A file to be written.
pub struct Target {
    path: PathBuf,
    format: Format,
}

/// The targets, before anything runs: an extension that is none of these formats is wrong usage.
pub fn targets(paths: &[PathBuf], formats: &[(&str, Format)]) -> Result<Vec<Target>, Failure> {
    let target = |path: &PathBuf| {
        let format = formats.iter().find(|(extension, _)| load::has_extension(path, extension));
        match format {
            Some((_, format)) => Ok(Target { path: path.clone(), format: *format }),
            None => {
                let what = if formats.len() == ALL.len() { "patches" } else { "triangles" };
                let names: Vec<String> =
                    formats.iter().map(|(extension, _)| format!(".{extension}")).collect();
                let (last, others) = names.split_last().map_or(("", &[][..]), |(l, o)| (l.as_str(), o));
                let what = format!("{what} are written as {} or {last}", others.join(", "));
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

/// Whether one of these is made of triangles.
pub fn need_mesh(targets: &[Target]) -> bool {
    targets.iter().any(|t| MESHES.iter().any(|(_, format)| *format == t.format))
}

/// Whether one of these is a picture.
pub fn need_picture(targets: &[Target]) -> bool {
    targets.iter().any(|t| t.format == Format::Png)
}

/// Triangles to be written.
#[derive(Default)]
pub struct Shape {
    pub mesh: Mesh,
    /// The same for pictures with a colour a vertex.
    #[cfg_attr(not(feature = "gpu"), expect(dead_code))]
    pub coloured: Option<(Mesh, Vec<[u8; 3]>)>,
}

/// What pictures and scenes look like, and who draws them.
pub struct Look<'a> {
    pub drawing: &'a flags::Drawing,
    #[cfg_attr(not(feature = "gpu"), expect(dead_code))]
    pub device: Option<&'a Device>,
    /// Which one is opened where there is none.
    #[cfg_attr(not(feature = "gpu"), expect(dead_code))]
    pub adapter: Option<&'a str>,
}

impl Look<'_> {
    fn up(&self) -> Up {
        self.drawing.up.into()
    }
}

impl From<flags::Up> for Up {
    fn from(up: flags::Up) -> Up {
        match up {
            flags::Up::Y => Up::Y,
            flags::Up::Z => Up::Z,
        }
    }
}

/// The colour of a symbol, by its index: the first is that of pictures without symbols.
pub fn color(symbol: usize) -> [u8; 3] {
    const COLORS: [[u8; 3]; 6] =
        [[217, 155, 108], [72, 150, 150], [150, 92, 122], [222, 196, 140], [126, 158, 92], [168, 160, 156]];
    COLORS[symbol % COLORS.len()]
}

/// Writes all targets: where one fails, the others are still written.
pub fn write(
    targets: &[Target],
    word: &Word,
    shape: &Result<Shape, String>,
    look: &Look,
    bar: &Bar,
) -> Result<(), Failure> {
    let name = &word.system;
    let mut failures = Vec::new();
    for target in targets {
        if stop::requested() {
            break;
        }
        bar.writing(&target.path);
        let result = match (target.format, shape) {
            (Format::Bpt, _) => file(&target.path, |w| io::bpt::write(w, word)),
            (Format::Bv, _) => file(&target.path, |w| io::bv::write(w, word)),
            (Format::Json, _) => file(&target.path, |w| io::json::write(w, word)),
            (Format::Obj, Ok(shape)) => file(&target.path, |w| io::obj::write(w, &shape.mesh, name)),
            (Format::Ply, Ok(shape)) => file(&target.path, |w| io::ply::write(w, &shape.mesh, name)),
            (Format::Glb, Ok(shape)) => {
                file(&target.path, |w| io::glb::write(w, &shape.mesh, name, look.up()))
            }
            (Format::Stl, Ok(shape)) => file(&target.path, |w| io::stl::write(w, &shape.mesh, name)),
            (Format::Png, Ok(shape)) => picture(&target.path, shape, look),
            (_, Err(why)) => Err(Failure::Device(format!("error: {}: {why}", target.path.display()))),
        };
        failures.extend(result.err());
    }
    stop::check("before all files were written; those written are whole")?;
    if let (Err(why), false) = (shape, need_mesh(targets)) {
        failures.push(Failure::Device(format!("error: {why}")));
    }
    super::joined(failures)
}

/// Every leaf of a word as a grid.
pub fn diced(word: &Word, grid: usize, by_symbol: bool, bar: &Bar) -> Result<Shape, String> {
    let n = tessellate::grid_for(word.modules.len(), grid);
    if n < grid {
        let why = "more cells a leaf would make over 2 million triangles";
        bar.say(&format!("note: --grid {n} in place of {grid}: {why}"));
    }
    let mesh = tessellate::dice(word, n).map_err(|e| e.to_string())?;
    let colors = || tessellate::per_vertex(word, n, |module| color(module.symbol));
    let coloured = by_symbol.then(|| (mesh.clone(), colors()));
    Ok(Shape { mesh, coloured })
}

pub fn file(
    path: &Path,
    content: impl FnOnce(&mut dyn std::io::Write) -> Result<(), WriteError>,
) -> Result<(), Failure> {
    io::write_atomically(path, |w| content(&mut Stoppable(w)))
        .map_err(|e: FileError| Failure::File(format!("error: {e}")))
}

#[cfg(feature = "gpu")]
fn picture(path: &Path, shape: &Shape, look: &Look) -> Result<(), Failure> {
    use burgeon::gpu::Requirement;
    use burgeon::render::{self, Picture};
    let no_device = |e: burgeon::gpu::Error| Failure::Device(format!("error: {}: {e}", path.display()));
    let own;
    let device = match look.device {
        Some(device) => device,
        // The CPU backend has worked; the picture still needs an adapter.
        None => {
            own =
                Device::new(look.adapter.map_or(Requirement::Any, Requirement::Named)).map_err(no_device)?;
            &own
        }
    };
    let (mesh, colors) = match &shape.coloured {
        Some((mesh, colors)) => (mesh, colors.clone()),
        None => (&shape.mesh, Vec::new()),
    };
    let mut options = Picture { up: look.up(), colors, ..Picture::default() };
    if look.drawing.wireframe {
        // Lines as thin as these want more samples than surfaces do.
        options = Picture { lines: mesh.edges(), line_width: 0.8, supersample: 3, ..options };
    }
    let image = render::render(&device.device, &device.queue, mesh, &options)
        .map_err(|e| Failure::Device(format!("error: {}: {e}", path.display())))?;
    file(path, |w| io::png::write(w, &image))
}

#[cfg(not(feature = "gpu"))]
fn picture(path: &Path, _: &Shape, _: &Look) -> Result<(), Failure> {
    Err(Failure::Device(format!("error: {}: this burgeon was built without the feature gpu", path.display())))
}
