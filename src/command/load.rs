//! From the flags to a plan and its axiom.

use super::axiom::{self, Beginning, files};
use super::source::{Loaded, Source};
use super::{Failure, counted, flags, say};
use burgeon::curve;
use burgeon::io::{NetOptions, Noted, ReadError, read_nets, values};
use burgeon::language::expr::Type;
use burgeon::language::system::{Axiom, CurveStart, System};
use burgeon::language::{Diagnostic, Span, Value};
use burgeon::patch;
use burgeon::plan::{self, Given, Plan, View, schedule};
use burgeon::tessellate::Camera;
use indicatif::HumanBytes;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file cannot be read.
pub fn cannot_read(path: &Path, e: &io::Error) -> String {
    let path = path.display();
    match e.kind() {
        io::ErrorKind::NotFound => format!("cannot read {path}: there is no such file"),
        io::ErrorKind::IsADirectory => format!("cannot read {path}: it is a folder"),
        _ => format!("cannot read {path}: {e}"),
    }
}

/// Whether the name of a file ends like this, in any case.
pub fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// A plan, the roots it starts from, and the values it is run with.
pub struct Job {
    pub plan: Plan,
    pub axiom: Beginning,
    /// The axiom once for each curve of its first file, where that was asked for.
    pub each: Vec<curve::Axiom>,
    /// What is to be said of the axiom's files.
    notes: Vec<String>,
    pub set: Vec<(String, Value)>,
    pub bind: Vec<(String, patch::Values)>,
    pub view: Option<View>,
    source: Source,
}

/// Reads the axiom's files, and what else the flags name. All that can be wrong with them is found here, before a
/// device is opened.
pub fn job(loaded: Loaded, plan: Plan, flags: &flags::Derive, each: bool) -> Result<Job, Failure> {
    let set = loaded.set(&flags.set)?;
    let Loaded { source, system } = loaded;
    let uniforms = plan.uniforms(&set).map_err(|e| failure(&source, &plan, e))?;
    schedule::unroll(&plan, &uniforms).map_err(|e| failure(&source, &plan, e))?;
    let named = files(&system);
    if flags.bspline
        && !flags.input.as_deref().is_some_and(is_obj)
        && !named.iter().any(|(name, _)| is_obj(Path::new(name)))
    {
        let what = "--bspline is for an .obj, and neither --in nor the axiom names one";
        return Err(Failure::Usage(format!("error: {what}")));
    }
    let input = flags.input.as_deref();
    let (Noted { value: axiom, notes }, each) = match each {
        false => {
            (axiom::axiom(&source, &system, input, flags.bspline).map_err(|e| e.failure(&source))?, vec![])
        }
        true => {
            let each = axiom::of_each_curve(&source, &system, input).map_err(|e| e.failure(&source))?;
            let first = each.value.first().cloned().unwrap_or_default();
            (Noted { value: Beginning::Points(first), notes: each.notes }, each.value)
        }
    };
    let bind = bind(&plan.system, &flags.bind)?;
    let view = sight(&flags.view, flags::Up::Y, axiom.nets().iter())?.map(|s| s.view());
    Given::new(&plan.system, axiom.roots(), &bind, view).map_err(|e| failure(&source, &plan, e))?;
    Ok(Job { plan, axiom, each, notes, set, bind, view, source })
}

impl Job {
    /// The nets of the roots.
    pub fn nets(&self) -> Vec<patch::Net> {
        self.axiom.nets()
    }

    /// Says what is to be said of the axiom's files.
    pub fn say_notes(&self) {
        say_notes(&self.notes);
    }

    /// One error at a place of the rule file.
    pub fn error(&self, d: Diagnostic) -> Failure {
        self.source.error(d)
    }

    /// An error of the plan by whose fault it is, with the place where that is known.
    pub fn failure(&self, e: plan::Error) -> Failure {
        failure(&self.source, &self.plan, e)
    }
}

fn say_notes(notes: &[String]) {
    notes.iter().for_each(|note| say(&format!("note: {note}")));
}

/// The values that `--bind` names; a name that is none is left for the plan to refuse.
fn bind(system: &System, given: &[(String, PathBuf)]) -> Result<Vec<(String, patch::Values)>, Failure> {
    let mut bound = Vec::new();
    for (name, path) in given {
        let query = system.queries.iter().find(|q| q.name == *name);
        let ty = query.map_or(Type::Float, |q| q.ty.clone());
        let fail = |e| Failure::File(format!("error: {}", shown(path, &e)));
        let values = values::read(path, &ty).map_err(fail)?;
        bound.push((name.clone(), values));
    }
    Ok(bound)
}

/// Where the viewer stands and looks.
pub struct Sight {
    pub eye: [f32; 3],
    pub at: [f32; 3],
    up: [f32; 3],
    angle: f32,
    pixels: [f32; 2],
}

impl Sight {
    fn view(&self) -> View {
        View::looking(self.eye, self.at, self.up, self.angle, self.pixels)
    }

    /// What stands nearer to the eye than a thousandth of the way to the middle is not seen.
    pub fn camera(&self) -> Camera {
        let away: f32 = (0..3).map(|k| (self.at[k] - self.eye[k]).powi(2)).sum();
        Camera::looking(self.eye, self.at, self.up, self.angle, self.pixels, away.sqrt() * 1e-3)
    }
}

/// The viewer that the flags describe.
pub fn sight<'a>(
    flags: &flags::View,
    up: flags::Up,
    nets: impl Iterator<Item = &'a patch::Net>,
) -> Result<Option<Sight>, Failure> {
    let Some(eye) = flags.eye else { return Ok(None) };
    let middle = || bounds(nets).map_or([0.0; 3], |b| b.center());
    let at = flags.look_at.unwrap_or_else(middle);
    if eye == at {
        let [x, y, z] = eye;
        let what = format!("--eye {x},{y},{z} is the point that is looked at, so there is no direction");
        let help = "help: move it away, or say by --look-at X,Y,Z where to look";
        return Err(Failure::Usage(format!("error: {what}\n{help}")));
    }
    let up = match up {
        flags::Up::Y => 1,
        flags::Up::Z => 2,
    };
    // Who looks along it has the other one for up.
    let along = (0..3).all(|k| k == up || eye[k] == at[k]);
    let up = if along { 3 - up } else { up };
    let up = std::array::from_fn(|k| if k == up { 1.0 } else { 0.0 });
    Ok(Some(Sight { eye, at, up, angle: flags.angle, pixels: flags.pixels }))
}

/// The box around all control points; none where there are none.
pub fn bounds<'a>(nets: impl Iterator<Item = &'a patch::Net>) -> Option<patch::Bounds> {
    let points = nets.flat_map(|net| &net.points);
    patch::Bounds::around(points.map(|p| [p[0] / p[3], p[1] / p[3], p[2] / p[3]]))
}

/// The same for a job that is still in the making.
fn failure(source: &Source, plan: &Plan, e: plan::Error) -> Failure {
    let at = |span: Span, text: &str| source.error(Diagnostic::error("E0404", span, text));
    let system = &plan.system;
    match &e {
        plan::Error::Unsupported(e) => source.unsupported(e),
        plan::Error::Value(text, Some(span)) => at(*span, text),
        plan::Error::Axiom(text) => at(place_of_axiom(system), text),
        plan::Error::Endless { symbol, rule, derive, needed, modules, step, budget } => {
            let what = format!(
                "this never becomes terminal: `{symbol}` is rewritten in every step, and leads to `{symbol}` again"
            );
            let (modules, needed, budget) = (counted(*modules, "module"), size(*needed), size(*budget));
            let grown = format!(
                "step {step} would need at least {needed} for {modules}; the memory budget is {budget}"
            );
            let hint =
                "give the rule a condition that ends it, or say by `derive N` how many steps are meant";
            source.error(Diagnostic::error("E0407", *rule, what).label(*derive, grown).hint(hint))
        }
        _ => super::run::of_plan(e),
    }
}

fn place_of_axiom(system: &System) -> Span {
    let first = match &system.axiom {
        Axiom::Patches(starts) => starts.first().map(|start| start.span),
        Axiom::Curve(starts) => starts.first().map(|start| match start {
            CurveStart::Word(word) => word.modules.first().map_or(system.source.name.span, |m| m.span),
            CurveStart::Points { span, .. } | CurveStart::System { span, .. } => *span,
        }),
        _ => None,
    };
    first.unwrap_or(system.source.name.span)
}

/// Why a file could not be read; a parse error shows the line, cut around the place.
pub fn shown(path: &Path, e: &ReadError) -> String {
    match e {
        ReadError::Io { source, .. } => cannot_read(path, source),
        ReadError::Word { .. } | ReadError::Values { .. } | ReadError::Format { .. } => e.to_string(),
        ReadError::Text { error, .. } => {
            let bytes = std::fs::read(path).unwrap_or_default();
            let line = bytes.split(|b| *b == b'\n').nth(error.line.saturating_sub(1)).unwrap_or(&[]);
            format!("{e}\n{}", excerpt(&String::from_utf8_lossy(line), error.line, error.column))
        }
    }
}

fn is_obj(path: &Path) -> bool {
    has_extension(path, "obj")
}

/// The nets of a file that no rules rewrite, as a word named like the file: one net at least, all of the
/// same degrees, whatever these are.
pub fn patches(path: &Path, bspline: bool) -> Result<patch::Word, Failure> {
    let name = path.display();
    if has_extension(path, "burgeon") {
        let what = format!("error: {name} holds rules, not patches");
        let help = format!("help: `burgeon run {name} --tolerance T` tessellates what they derive");
        return Err(Failure::Usage(format!("{what}\n{help}")));
    }
    if bspline && !is_obj(path) {
        return Err(Failure::Usage(format!("error: --bspline is for an .obj, and {name} is none")));
    }
    let wrong = |what: String| Failure::File(format!("error: {what}"));
    let read = read_nets(path, NetOptions { rational: true, bspline }).map_err(|e| wrong(shown(path, &e)))?;
    say_notes(&read.notes.iter().map(|note| format!("{name}: {note}")).collect::<Vec<_>>());
    let nets = read.value;
    let Some(first) = nets.first() else {
        return Err(wrong(format!("{name} holds no patches; one at least is needed")));
    };
    let [m, n] = first.degree;
    for (patch, net) in nets.iter().enumerate() {
        if net.degree != first.degree {
            let [u, v] = net.degree;
            let what = format!("patch {patch} of {name} has degree {u}×{v}, and patch 0 {m}×{n}");
            let help =
                "help: all patches of a mesh have the same degrees; raise the lower ones, or split the file";
            return Err(wrong(format!("{what}\n{help}")));
        }
        net.validate(true).map_err(|e| wrong(format!("patch {patch} of {name}: {e}")))?;
    }
    let stem = path.file_stem().map_or_else(|| "patches".into(), |stem| stem.to_string_lossy());
    patch::Word::from_nets(&stem, "P", &nets).map_err(|e| wrong(format!("{name}: {e}")))
}

/// The line, at most 120 columns of it, and a caret below `column` (from 1).
fn excerpt(line: &str, number: usize, column: usize) -> String {
    const SHOWN: usize = 110;
    let characters: Vec<char> =
        line.trim_end().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let at = column.saturating_sub(1).min(characters.len());
    let start = at.saturating_sub(SHOWN / 2);
    let end = characters.len().min(start + SHOWN);
    let mark = |cut: bool| if cut { "…" } else { "" };
    let (before, behind) = (mark(start > 0), mark(end < characters.len()));
    let shown: String = characters[start..end].iter().collect();
    let number = number.to_string();
    let (margin, indent) = (" ".repeat(number.len()), " ".repeat(at - start + before.chars().count()));
    format!("{margin} |\n{number} | {before}{shown}{behind}\n{margin} | {indent}^")
}

/// A size for people: `1.50 GiB`.
pub fn size(bytes: u64) -> String {
    HumanBytes(bytes).to_string()
}

/// Half of the memory that the machine has, or the container; 4 GiB where the system does not say.
pub fn half_of_memory() -> u64 {
    let total = sysinfo::System::new().map(|mut system| {
        system.refresh_memory();
        let limit = system.cgroup_limits().map(|limits| limits.total_memory).filter(|limit| *limit > 0);
        limit.map_or(system.total_memory(), |limit| limit.min(system.total_memory()))
    });
    total.map_or(4 << 30, |bytes| (bytes / 2).max(1 << 28))
}
