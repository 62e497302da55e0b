//! From the flags to a plan and its axiom.

use super::axiom::{self, Beginning, files};
use super::{Failure, colored, counted, flags, say};
use burgeon::curve;
use burgeon::io::{NetOptions, Noted, ReadError, read_nets, values};
use burgeon::language::check::{Checked, compile};
use burgeon::language::diagnostic::{self, nearest};
use burgeon::language::expr::Type;
use burgeon::language::system::{Axiom, CurveStart, Kind, System};
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{Diagnostic, Severity, Span, Value, lex, parse, syntax};
use burgeon::patch;
use burgeon::plan::derive::Start;
use burgeon::plan::{self, Given, Plan, Unsupported, View, schedule};
use burgeon::tessellate::Camera;
use indicatif::HumanBytes;
use std::io;
use std::path::{Path, PathBuf};

/// A rule file, read and checked.
pub struct Source {
    pub path: PathBuf,
    pub text: String,
    pub checked: Checked,
}

impl Source {
    /// Reads and checks; diagnostics are not looked at yet.
    pub fn read(path: &Path) -> Result<Source, Failure> {
        if ["bpt", "bv", "json", "obj"].iter().any(|e| has_extension(path, e)) {
            let what = format!("error: {} holds patches, not rules", path.display());
            let help = "help: give the rule file here, and the patches by --in";
            return Err(Failure::Usage(format!("{what}\n{help}")));
        }
        if ["csv", "svg"].iter().any(|e| has_extension(path, e)) {
            let what = format!("error: {} holds points, not rules", path.display());
            let help = "help: give the rule file here, and the points by --in";
            return Err(Failure::Usage(format!("{what}\n{help}")));
        }
        let bytes = std::fs::read(path).map_err(|e| unreadable_rules(path, &e))?;
        let name = path.display().to_string();
        let text = match lex::decode(&bytes) {
            Ok(text) => text.to_string(),
            Err(d) => {
                let lossy = String::from_utf8_lossy(&bytes);
                return Err(Failure::File(diagnostic::render(&[d], &name, &lossy, colored())));
            }
        };
        let checked = compile(&text, &Vocabulary::default());
        Ok(Source { path: path.to_path_buf(), text, checked })
    }

    /// These diagnostics as text, and how many they are.
    pub fn render(&self, diagnostics: &[Diagnostic]) -> String {
        let name = self.path.display().to_string();
        let text = diagnostic::render(diagnostics, &name, &self.text, colored());
        let count = |severity| diagnostics.iter().filter(|d| d.severity == severity).count() as u64;
        let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
        let total = match (errors, warnings) {
            (0 | 1, 0) | (0, 1) => return text,
            (0, w) => counted(w, "warning"),
            (e, 0) => counted(e, "error"),
            (e, w) => format!("{}, {}", counted(e, "error"), counted(w, "warning")),
        };
        format!("{text}{name}: {total}\n")
    }

    /// One error at a place of the rule file.
    pub fn error(&self, d: Diagnostic) -> Failure {
        Failure::File(self.render(&[d]))
    }

    /// All diagnostics as a failure, if one is an error; else the warnings are said.
    pub fn refuse_errors(&self) -> Result<(), Failure> {
        let list = &self.checked.diagnostics;
        if self.checked.has_errors() {
            return Err(Failure::File(self.render(list)));
        }
        if !list.is_empty() {
            say(&self.render(list));
        }
        Ok(())
    }

    /// The system of this name, or the last.
    pub fn system(&self, name: Option<&str>) -> Result<&System, Failure> {
        let systems = &self.checked.systems;
        let path = self.path.display();
        let Some(last) = systems.last() else {
            let help = "help: a system begins with `system NAME : patch bezier 3`";
            return Err(Failure::File(format!("error: {path} holds no system\n{help}")));
        };
        let Some(name) = name else { return Ok(last) };
        systems.iter().find(|s| s.name == name).ok_or_else(|| {
            let names = systems.iter().map(|s| s.name.as_str());
            let help = did_you_mean(name, names.clone());
            let names: Vec<&str> = names.collect();
            Failure::Usage(format!("error: {path} has no system `{name}`; it has {}{help}", names.join(", ")))
        })
    }

    /// What this version does not derive, as a diagnostic.
    pub fn unsupported(&self, e: &Unsupported) -> Failure {
        let d = Diagnostic::error("E0401", e.span, e.to_string());
        self.error(d.hint("the system parses and checks; a later version derives it"))
    }

    /// Whether a param of this name stands outside the systems. Such a one that the system does not
    /// read is none of its own, but of the file.
    fn shares_param(&self, name: &str) -> bool {
        let items = parse(&self.text).file.items;
        items.iter().any(|item| matches!(item, syntax::FileItem::Param(p) if p.name.text == name))
    }

    /// The line of a place, from 1.
    pub fn line(&self, span: Span) -> usize {
        let before = self.text.as_bytes().get(..span.start as usize).unwrap_or_default();
        before.iter().filter(|&&b| b == b'\n').count() + 1
    }
}

fn unreadable_rules(path: &Path, e: &io::Error) -> Failure {
    let longer = PathBuf::from(format!("{}.burgeon", path.display()));
    let help = match e.kind() {
        io::ErrorKind::NotFound if longer.is_file() => format!("\nhelp: there is {}", longer.display()),
        _ => String::new(),
    };
    Failure::File(format!("error: {}{help}", cannot_read(path, e)))
}

/// Why a file cannot be read.
pub fn cannot_read(path: &Path, e: &io::Error) -> String {
    let path = path.display();
    match e.kind() {
        io::ErrorKind::NotFound => format!("cannot read {path}: there is no such file"),
        io::ErrorKind::IsADirectory => format!("cannot read {path}: it is a folder"),
        _ => format!("cannot read {path}: {e}"),
    }
}

/// A line of help, if one of the names is near.
fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, names).map_or(String::new(), |n| format!("\nhelp: did you mean `{n}`?"))
}

/// Whether the name of a file ends like this, in any case.
pub fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// A plan, the roots it starts from, and the values it is run with.
pub struct Job {
    pub plan: Plan,
    pub axiom: Beginning,
    /// What is to be said of the axiom's files.
    notes: Vec<String>,
    pub set: Vec<(String, Value)>,
    pub uniforms: Vec<Value>,
    pub bind: Vec<(String, patch::Values)>,
    pub view: Option<View>,
    source: Source,
}

/// Whether the flags name a system of curves; what is wrong with the file is said by whoever reads it next.
pub fn is_curve(flags: &flags::System) -> bool {
    let source = Source::read(&flags.file).ok();
    let is = |source: &Source| {
        let system = source.system(flags.system.as_deref()).ok()?;
        Some(matches!(system.kind, Kind::Curve(_)))
    };
    source.as_ref().and_then(is).unwrap_or(false)
}

/// Reads the rule file and the axiom's files, and makes the plan as `plan` does. All that can be wrong with them is
/// found here, before a device is opened.
pub fn job(flags: &flags::Derive, plan: fn(&System) -> Result<Plan, Unsupported>) -> Result<Job, Failure> {
    let source = Source::read(&flags.system.file)?;
    source.refuse_errors()?;
    let system = source.system(flags.system.system.as_deref())?;
    let plan = plan(system).map_err(|e| source.unsupported(&e))?;
    let set = set(&source, system, &flags.set)?;
    let uniforms = plan.uniforms(&set).map_err(|e| failure(&source, &plan, e))?;
    schedule::unroll(&plan, &uniforms).map_err(|e| failure(&source, &plan, e))?;
    let named = files(system);
    if flags.bspline
        && !flags.input.as_deref().is_some_and(is_obj)
        && !named.iter().any(|(name, _)| is_obj(Path::new(name)))
    {
        let what = "--bspline is for an .obj, and neither --in nor the axiom names one";
        return Err(Failure::Usage(format!("error: {what}")));
    }
    let Noted { value: axiom, notes } = axiom::axiom(&source, system, flags.input.as_deref(), flags.bspline)
        .map_err(|e| e.failure(&source))?;
    let bind = bind(&plan.system, &flags.bind)?;
    let view = sight(&flags.view, flags::Up::Y, axiom.nets().iter())?.map(|s| s.view());
    Given::new(&plan.system, axiom.roots(), &bind, view).map_err(|e| failure(&source, &plan, e))?;
    Ok(Job { plan, axiom, notes, set, uniforms, bind, view, source })
}

impl Job {
    /// The nets of the roots.
    pub fn nets(&self) -> Vec<patch::Net> {
        self.axiom.nets()
    }

    /// The axiom once for each curve of its first file. Says what is to be said of it.
    pub fn each_curve(&self, input: Option<&Path>) -> Result<Vec<curve::Axiom>, Failure> {
        let each = axiom::of_each_curve(&self.source, &self.plan.system, input);
        let each = each.map_err(|e| e.failure(&self.source))?;
        say_notes(&each.notes);
        Ok(each.value)
    }

    /// Says what is to be said of the axiom's files, where it is not taken curve by curve.
    pub fn say_notes(&self) {
        say_notes(&self.notes);
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

/// What of `--set` goes to the system: a param of the file that it does not read is left out.
pub fn set(
    source: &Source,
    system: &System,
    given: &[(String, Value)],
) -> Result<Vec<(String, Value)>, Failure> {
    let own = |name: &str| system.uniforms.iter().any(|u| u.is_param() && u.name == name);
    let mut set = Vec::new();
    for (name, value) in given {
        if own(name) {
            set.push((name.clone(), value.clone()));
        } else if source.shares_param(name) {
            say(&format!("note: {} does not read the param `{name}` that --set gives", system.name));
        } else {
            return Err(Failure::Usage(format!("error: {}", no_such_param(system, "--set", name))));
        }
    }
    Ok(set)
}

/// What a flag says that names a param which the system has not.
pub fn no_such_param(system: &System, flag: &str, name: &str) -> String {
    let params: Vec<&str> =
        system.uniforms.iter().filter(|u| u.is_param()).map(|u| u.name.as_str()).collect();
    match params.as_slice() {
        [] => format!("{flag} {name}: the system {} has no params", system.name),
        list => {
            let help = did_you_mean(name, list.iter().copied());
            format!("{flag} {name}: no such param of {}; it has {}{help}", system.name, list.join(", "))
        }
    }
}

/// The same for a job that is still in the making.
fn failure(source: &Source, plan: &Plan, e: plan::Error) -> Failure {
    let at = |span: Span, text: &str| source.error(Diagnostic::error("E0404", span, text));
    let system = &plan.system;
    match &e {
        plan::Error::Unsupported(e) => source.unsupported(e),
        plan::Error::Value(text) => at(place_of_value(system, text), text),
        plan::Error::Axiom(text) => at(place_of_axiom(system), text),
        _ => super::run::of_plan(e),
    }
}

/// Where the expression without a value stands: the message begins with what it belongs to.
fn place_of_value(system: &System, text: &str) -> Span {
    let constant = text.strip_prefix("const ").and_then(|rest| rest.split(':').next());
    let constant = constant.and_then(|name| system.uniforms.iter().find(|u| u.name == name));
    match constant {
        Some(constant) => constant.span,
        None if text.starts_with("axiom") => place_of_axiom(system),
        None => system.run.first().map_or(system.source.name.span, |step| step.span),
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
