//! From the axiom's files to what a derivation begins with.

use super::Failure;
use super::load::shown;
use super::source::Source;
use burgeon::curve::{self, Note, Polyline};
use burgeon::io::{NetOptions, Noted, curves, read_nets};
use burgeon::language::system::{Axiom, CurveSource, CurveStart, Kind, PatchSource, PatchStart, System};
use burgeon::language::{Diagnostic, Span};
use burgeon::patch;
use burgeon::plan;
use burgeon::plan::derive::Start;
use std::path::{Path, PathBuf};

/// What a derivation begins with.
pub enum Beginning {
    Nets(patch::Axiom),
    Points(curve::Axiom),
}

impl Beginning {
    /// Roots, each of which may be bound a value of its own.
    pub fn roots(&self) -> usize {
        match self {
            Beginning::Nets(axiom) => axiom.roots(),
            Beginning::Points(axiom) => axiom.roots(),
        }
    }

    /// The points of a curve.
    ///
    /// # Errors
    /// For patches: the file was another one when its kind was looked at.
    pub fn curve(&self) -> Result<&curve::Axiom, plan::Error> {
        match self {
            Beginning::Points(axiom) => Ok(axiom),
            Beginning::Nets(_) => Err(changed()),
        }
    }

    /// The roots of patches.
    ///
    /// # Errors
    /// The same for a curve.
    pub fn patches(&self) -> Result<&patch::Axiom, plan::Error> {
        match self {
            Beginning::Nets(axiom) => Ok(axiom),
            Beginning::Points(_) => Err(changed()),
        }
    }

    /// The nets of the roots; none of a curve.
    pub fn nets(&self) -> Vec<patch::Net> {
        match self {
            Beginning::Nets(axiom) => axiom.roots.iter().map(|root| root.net.clone()).collect(),
            Beginning::Points(_) => Vec::new(),
        }
    }
}

fn changed() -> plan::Error {
    plan::Error::Axiom("the rule file changed while it was read".to_string())
}

/// Why there are no roots.
pub enum AxiomError {
    /// The rule file names a file that is not there.
    Missing(Diagnostic),
    /// The rule file is at fault, at this place.
    Rules(Diagnostic),
    /// A file of patches is, or a flag.
    Other(Failure),
}

impl AxiomError {
    pub fn failure(self, source: &Source) -> Failure {
        match self {
            AxiomError::Missing(d) | AxiomError::Rules(d) => source.error(d),
            AxiomError::Other(failure) => failure,
        }
    }
}

/// Reads the axiom's files, relative to the rule file; `input` stands for every source that names
/// the same file as the first. With `bspline` an .obj is one, too.
pub fn axiom(
    source: &Source,
    system: &System,
    input: Option<&Path>,
    bspline: bool,
) -> Result<Noted<Beginning>, AxiomError> {
    let mut places = Places::new(source, system, input)?;
    let value = if matches!(system.kind, Kind::Curve(_)) {
        let loaded = curve::Axiom::load(system, &mut |name| places.points(name, system));
        let axiom = loaded.map_err(|e| places.wrong(e))?;
        axiom.notes.iter().for_each(|(name, note)| places.note_of(name, note));
        Beginning::Points(axiom)
    } else {
        let mut read = |name: &str| {
            let path = places.of(name);
            nets(&path, system, bspline).map(|read| places.noted(&path, read))
        };
        patch::Axiom::load(system, &mut read).map(Beginning::Nets).map_err(|e| places.wrong(e))?
    };
    Ok(Noted { value, notes: places.notes })
}

/// The same once for each curve of the first file, in place of all its points.
pub fn of_each_curve(
    source: &Source,
    system: &System,
    input: Option<&Path>,
) -> Result<Noted<Vec<curve::Axiom>>, AxiomError> {
    let wrong = |what: String| Err(AxiomError::Other(Failure::Usage(format!("error: --each: {what}"))));
    let Axiom::Curve(starts) = &system.axiom else { return wrong(format!("{} has no axiom", system.name)) };
    let file = starts.iter().find_map(|start| match start {
        CurveStart::Points { source: CurveSource::File { path, index, .. }, .. } => Some((path, index)),
        _ => None,
    });
    let Some((first, index)) = file else {
        return wrong(format!("the axiom of {} names no file", system.name));
    };
    if let Some(index) = index {
        return wrong(format!("the axiom of {} takes curve {index} of {first} alone", system.name));
    }
    let mut places = Places::new(source, system, input)?;
    let curves = match places.points(first, system) {
        Ok(curves) => curves,
        Err(text) => return Err(places.wrong(patch::AxiomError::Source(text))),
    };
    for note in curve::notes(system, first, &curves, false) {
        places.note_of(first, &note);
    }
    let mut of_curve = |curve: Polyline| {
        let mut read = |name: &str| match name == first {
            true => Ok(vec![curve.clone()]),
            false => places.points(name, system),
        };
        curve::Axiom::load(system, &mut read).map_err(|e| places.wrong(e))
    };
    let value: Result<_, AxiomError> = curves.into_iter().map(&mut of_curve).collect();
    Ok(Noted { value: value?, notes: places.notes })
}

/// Where the files of an axiom are.
struct Places<'a> {
    folder: &'a Path,
    files: Vec<(String, Span)>,
    /// In place of the first.
    input: Option<&'a Path>,
    /// The one that is not there.
    missing: Option<Span>,
    /// What is to be said of them, each once.
    notes: Vec<String>,
}

impl<'a> Places<'a> {
    fn new(source: &'a Source, system: &System, input: Option<&'a Path>) -> Result<Places<'a>, AxiomError> {
        let files = files(system);
        if let (Some(input), []) = (input, &files[..]) {
            let what = format!("error: --in {}: the axiom of {} names no file", input.display(), system.name);
            return Err(AxiomError::Other(Failure::Usage(format!("{what} that it could replace"))));
        }
        let folder = source.path.parent().unwrap_or(Path::new(""));
        Ok(Places { folder, files, input, missing: None, notes: Vec::new() })
    }

    fn of(&mut self, name: &str) -> PathBuf {
        if let (Some(input), Some((first, _))) = (self.input, self.files.first())
            && first == name
        {
            return input.to_path_buf();
        }
        let path = self.folder.join(name);
        if !path.exists() {
            self.missing = self.files.iter().find(|(file, _)| file == name).map(|(_, span)| *span);
        }
        path
    }

    /// The curves of a file.
    fn points(&mut self, name: &str, system: &System) -> Result<Vec<Polyline>, String> {
        let path = self.of(name);
        let read = curves::read(&path, curve::coordinates(system, name)).map_err(|e| shown(&path, &e))?;
        Ok(self.noted(&path, read))
    }

    fn noted<T>(&mut self, path: &Path, read: Noted<T>) -> T {
        for note in read.notes {
            let note = format!("{}: {note}", path.display());
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
        read.value
    }

    fn note_of(&mut self, name: &str, note: &Note) {
        let help = match note {
            Note::Joined { .. } => " (`run --each` derives each by itself)",
            _ => "",
        };
        let path = self.of(name);
        self.noted(&path, Noted { value: (), notes: vec![format!("{note}{help}")] });
    }

    fn wrong(&self, e: patch::AxiomError<String>) -> AxiomError {
        match (e, self.missing) {
            (patch::AxiomError::Source(text), Some(span)) => {
                let hint = "paths are relative to the rule file; --in FILE reads another one";
                AxiomError::Missing(Diagnostic::error("E0405", span, text).hint(hint))
            }
            (patch::AxiomError::Source(text), None) => {
                AxiomError::Other(Failure::File(format!("error: {text}")))
            }
            (patch::AxiomError::Wrong { message, span }, _) => {
                AxiomError::Rules(Diagnostic::error("E0402", span, message))
            }
        }
    }
}

/// The files that the axiom names, and where.
pub fn files(system: &System) -> Vec<(String, Span)> {
    let of_patch = |s: &'_ PatchStart| match &s.source {
        PatchSource::File { path, span, .. } => Some((path.clone(), *span)),
        _ => None,
    };
    let of_curve = |s: &'_ CurveStart| match s {
        CurveStart::Points { source: CurveSource::File { path, span, .. }, .. } => {
            Some((path.clone(), *span))
        }
        _ => None,
    };
    match &system.axiom {
        Axiom::Patches(starts) => starts.iter().filter_map(of_patch).collect(),
        Axiom::Curve(starts) => starts.iter().filter_map(of_curve).collect(),
        _ => Vec::new(),
    }
}

/// The nets of a file, of the degree that the system rewrites.
fn nets(path: &Path, system: &System, bspline: bool) -> Result<Noted<Vec<patch::Net>>, String> {
    let rational = matches!(system.kind, Kind::Patch { rational: true, .. });
    let nets = read_nets(path, NetOptions { rational, bspline }).map_err(|e| shown(path, &e))?;
    let Kind::Patch { degree, .. } = system.kind else { return Ok(nets) };
    match nets.value.iter().position(|net| net.degree != degree) {
        None => Ok(nets),
        Some(patch) => {
            let ([u, v], [m, n]) = (nets.value[patch].degree, degree);
            let what = format!("patch {patch} of {} has degree {u}×{v}", path.display());
            Err(format!("{what}; {} rewrites nets of degree {m}×{n}", system.name))
        }
    }
}
