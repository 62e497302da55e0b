//! What a command writes, by the extension of its name, and where.

use super::progress::Bar;
use super::run::Device;
use super::{Failure, flags, load, print, say, stop};
use burgeon::io::{self, FileError, WriteError};
use burgeon::patch::Word;
use burgeon::tessellate::{self, Mesh, Up};
use clap::ValueEnum;
use std::io::{IsTerminal, Seek, Write};
use std::path::{Path, PathBuf};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Bpt,
    Bv,
    Json,
    Obj,
    Ply,
    Glb,
    Stl,
    Svg,
    Csv,
    Png,
}

impl Format {
    fn extension(self) -> String {
        format!("{self:?}").to_ascii_lowercase()
    }
}

/// What is written, and as what.
pub struct Content {
    what: &'static str,
    formats: &'static [Format],
}

impl Content {
    fn written_as(&self) -> String {
        let names: Vec<String> = self.formats.iter().map(|f| format!(".{}", f.extension())).collect();
        let (last, others) = names.split_last().map_or(("", &[][..]), |(l, o)| (l.as_str(), o));
        format!("{} are written as {} or {last}", self.what, others.join(", "))
    }

    /// It is not written like this.
    pub fn refuse(&self, format: Format) -> Failure {
        Failure::Usage(format!("error: --format {}: {}", format.extension(), self.written_as()))
    }
}

pub const CURVES: Content =
    Content { what: "curves", formats: &[Format::Svg, Format::Png, Format::Obj, Format::Csv, Format::Json] };

/// What nets are written as, then what triangles are.
const PATCH_FORMATS: &[Format] =
    &[Format::Bpt, Format::Bv, Format::Json, Format::Obj, Format::Ply, Format::Glb, Format::Stl, Format::Png];

pub const PATCHES: Content = Content { what: "patches", formats: PATCH_FORMATS };

pub const TRIANGLES: Content = Content { what: "triangles", formats: PATCH_FORMATS.split_at(3).1 };

/// The name that stands for the standard output.
const STDOUT: &str = "-";

/// A file to be written, or the standard output.
pub struct Target {
    pub path: PathBuf,
    pub format: Format,
}

impl Target {
    fn is_stdout(&self) -> bool {
        self.path == Path::new(STDOUT)
    }
}

/// The targets, before anything runs: an extension that is none of these formats is wrong usage.
pub fn targets(paths: &[PathBuf], stdout: Option<Format>, content: &Content) -> Result<Vec<Target>, Failure> {
    let usage = |what: String| Failure::Usage(format!("error: {what}"));
    let streams = paths.iter().filter(|path| *path == Path::new(STDOUT)).count();
    match stdout {
        Some(_) if streams == 0 => {
            let help = "help: of a file the extension says what it is, as in --out a.obj";
            return Err(usage(format!("--format is for --out -, the standard output\n{help}")));
        }
        _ if streams > 1 => {
            return Err(usage("--out - is given twice; what is written would mix".to_string()));
        }
        _ => {}
    }
    if let Some(n) = (1..paths.len()).find(|&n| paths[..n].contains(&paths[n])) {
        return Err(usage(format!("--out {} is given twice", paths[n].display())));
    }
    let target = |path: &PathBuf| {
        let is_stdout = path == Path::new(STDOUT);
        let format = match is_stdout {
            true => stdout.filter(|format| content.formats.contains(format)),
            false => content.formats.iter().copied().find(|f| load::has_extension(path, &f.extension())),
        };
        if let Some(format) = format {
            return Ok(Target { path: path.clone(), format });
        }
        Err(match (is_stdout, stdout) {
            (true, None) => {
                let what = "--out - is the standard output, whose format --format says, as in --format json";
                usage(format!("{what}\nhelp: {}", content.written_as()))
            }
            (true, Some(format)) => content.refuse(format),
            (false, _) => usage(format!("--out {}: {}", path.display(), content.written_as())),
        })
    };
    paths.iter().map(target).collect()
}

/// Whether one of these is a picture.
pub fn needs_adapter(paths: &[PathBuf], stdout: Option<Format>) -> bool {
    stdout == Some(Format::Png) || paths.iter().any(|path| load::has_extension(path, "png"))
}

/// Whether one of these is made of triangles.
pub fn need_mesh(targets: &[Target]) -> bool {
    targets.iter().any(|t| TRIANGLES.formats.contains(&t.format))
}

/// Whether one of these is a picture.
pub fn need_picture(targets: &[Target]) -> bool {
    targets.iter().any(|t| t.format == Format::Png)
}

/// Says what came of it: on stdout, or where that takes a file, on stderr.
pub fn report(targets: &[Target], text: &str) -> Result<(), Failure> {
    match targets.iter().any(Target::is_stdout) {
        true => say(text),
        false => print(&format!("{text}\n"))?,
    }
    Ok(())
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

/// Writes each of the targets: where one fails, the others are still written.
pub fn each(
    targets: &[Target],
    write: impl Fn(&Target) -> Result<(), Failure>,
) -> Result<Vec<Failure>, Failure> {
    let mut failures = Vec::new();
    for target in targets {
        if stop::requested() {
            break;
        }
        failures.extend(write(target).err());
    }
    stop::check("before all files were written; those written are whole")?;
    Ok(failures)
}

/// Writes a word and its triangles.
pub fn write(
    targets: &[Target],
    word: &Word,
    shape: &Result<Shape, String>,
    look: &Look,
    bar: &Bar,
) -> Result<(), Failure> {
    let name = &word.system;
    let mut failures = each(targets, |target| {
        let path = &target.path;
        match (target.format, shape) {
            (Format::Bpt, _) => file(path, bar, |w| io::bpt::write(w, word)),
            (Format::Bv, _) => file(path, bar, |w| io::bv::write(w, word)),
            (Format::Json, _) => file(path, bar, |w| io::json::write(w, word)),
            (Format::Obj, Ok(shape)) => file(path, bar, |w| io::obj::write(w, &shape.mesh, name)),
            (Format::Ply, Ok(shape)) => file(path, bar, |w| io::ply::write(w, &shape.mesh, name)),
            (Format::Glb, Ok(shape)) => file(path, bar, |w| io::glb::write(w, &shape.mesh, name, look.up())),
            (Format::Stl, Ok(shape)) => file(path, bar, |w| io::stl::write(w, &shape.mesh, name)),
            (Format::Png, Ok(shape)) => picture(path, shape, look, bar),
            (Format::Svg | Format::Csv, _) => Err(PATCHES.refuse(target.format)),
            (_, Err(why)) => Err(Failure::Device(format!("error: {}: {why}", shown(path)))),
        }
    })?;
    if let (Err(why), false) = (shape, need_mesh(targets)) {
        failures.push(Failure::Device(format!("error: {why}")));
    }
    super::joined(failures)
}

/// Cells along each side of a leaf, where nobody says how many.
const USUAL_GRID: usize = 8;

/// Every leaf of a word as a grid, within so many bytes. The usual grid is halved where it makes too many triangles
/// for comfort; one that was asked for is kept.
pub fn diced(
    word: &Word,
    grid: Option<u32>,
    by_symbol: bool,
    budget: u64,
    bar: &Bar,
) -> Result<Shape, String> {
    let leaves = word.modules.len();
    let n = grid.map_or(tessellate::grid_for(leaves, USUAL_GRID), |n| n as usize);
    if grid.is_none() && n < USUAL_GRID {
        let why = "more would make over 2 million triangles; --grid N makes N";
        bar.say(&format!("note: a grid of {n} in place of {USUAL_GRID}: {why}"));
    }
    let (vertices, triangles) =
        (leaves as u64 * (n as u64 + 1).pow(2), leaves as u64 * 2 * (n as u64).pow(2));
    let copies = if by_symbol { 2 } else { 1 };
    let needed = copies * (vertices * BYTES_A_VERTEX + triangles * BYTES_A_TRIANGLE);
    if needed > budget {
        let (leaves, triangles) =
            (super::counted(leaves as u64, "module"), super::counted(triangles, "triangle"));
        let (needed, budget) = (load::size(needed), load::size(budget));
        let what = format!("a grid of {n} × {n} on {leaves} makes {triangles}, which take at least {needed}");
        let help = "help: take a smaller --grid, or raise --max-memory";
        return Err(format!("{what}; the memory budget is {budget}\n{help}"));
    }
    bar.doing(&format!("dicing {}", super::counted(leaves as u64, "module")));
    let mesh = tessellate::dice(word, n).map_err(|e| e.to_string())?;
    let colors = || tessellate::per_vertex(word, n, |module| color(module.symbol));
    let coloured = by_symbol.then(|| (mesh.clone(), colors()));
    Ok(Shape { mesh, coloured })
}

/// Of a [`Mesh`].
const BYTES_A_VERTEX: u64 = 32;
const BYTES_A_TRIANGLE: u64 = 12;

/// Writes a file, or the standard output: all of it or nothing.
pub fn file(
    path: &Path,
    bar: &Bar,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), Failure> {
    bar.writing(&shown(path), 0);
    if path != Path::new(STDOUT) {
        return io::write_atomically(path, |writer| content(&mut Watched { writer, path, bar, written: 0 }))
            .map_err(|e: FileError| Failure::File(format!("error: {e}")));
    }
    let failure = |e: WriteError| Failure::File(format!("error: cannot write to the standard output: {e}"));
    /// What is held in memory until it is whole; more goes to a temporary file.
    const HELD: usize = 1 << 26;
    let mut spool = std::io::BufWriter::new(tempfile::SpooledTempFile::new(HELD));
    content(&mut Watched { writer: &mut spool, path, bar, written: 0 }).map_err(failure)?;
    let spool = spool.into_inner().map_err(|e| e.into_error());
    let copied = spool.and_then(|mut spool| {
        spool.rewind()?;
        let mut out = std::io::stdout().lock();
        // It may be the bar's terminal.
        if out.is_terminal() {
            bar.clear();
        }
        std::io::copy(&mut spool, &mut Watched { writer: &mut out, path, bar, written: 0 })?;
        out.flush()
    });
    match copied {
        // A reader that has seen enough is no failure.
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(failure(e.into())),
        _ => Ok(()),
    }
}

/// A target as messages name it.
pub fn shown(path: &Path) -> String {
    if path == Path::new(STDOUT) { "the standard output".to_string() } else { path.display().to_string() }
}

/// A writer that shows how far it is, and fails once Ctrl-C has come.
struct Watched<'a> {
    writer: &'a mut dyn Write,
    path: &'a Path,
    bar: &'a Bar,
    written: u64,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if stop::requested() {
            // Not of the kind `Interrupted`, which asks to try again.
            return Err(std::io::Error::other("stopped by Ctrl-C"));
        }
        let written = self.writer.write(bytes)?;
        self.written += written as u64;
        self.bar.writing(&shown(self.path), self.written);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.writer.flush()
    }
}

#[cfg(feature = "gpu")]
fn picture(path: &Path, shape: &Shape, look: &Look, bar: &Bar) -> Result<(), Failure> {
    use burgeon::gpu::Requirement;
    use burgeon::render::{self, Picture};
    let no_device = |e: burgeon::gpu::Error| Failure::Device(format!("error: {}: {e}", shown(path)));
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
    bar.doing(&format!("drawing {}", shown(path)));
    let image = render::render(&device.device, &device.queue, mesh, &options)
        .map_err(|e| Failure::Device(format!("error: {}: {e}", shown(path))))?;
    file(path, bar, |w| io::png::write(w, &image))
}

#[cfg(not(feature = "gpu"))]
fn picture(path: &Path, _: &Shape, _: &Look, _: &Bar) -> Result<(), Failure> {
    Err(Failure::Device(format!("error: {}: this burgeon was built without the feature gpu", shown(path))))
}
