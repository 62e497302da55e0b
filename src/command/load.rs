//! From the flags to a plan and its axiom.

use super::{Failure, colored, flags, say};
use burgeon::io::bpt;
use burgeon::language::check::{Checked, compile};
use burgeon::language::system::{Axiom, Kind, PatchSource, System};
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{Diagnostic, Severity, diagnostic, lex};
use burgeon::patch;
use burgeon::plan::{Plan, Unsupported};
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
        let bytes =
            std::fs::read(path).map_err(|e| Failure::File(format!("cannot read {}: {e}", path.display())))?;
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

    /// These diagnostics as text.
    pub fn render(&self, diagnostics: &[Diagnostic]) -> String {
        diagnostic::render(diagnostics, &self.path.display().to_string(), &self.text, colored())
    }

    /// All diagnostics as a failure, if one is an error; else the warnings are said.
    pub fn refuse_errors(&self) -> Result<(), Failure> {
        let list = &self.checked.diagnostics;
        if list.iter().any(|d| d.severity == Severity::Error) {
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
        let found = match name {
            None => systems.last(),
            Some(name) => systems.iter().find(|s| s.name == name),
        };
        found.ok_or_else(|| {
            let names: Vec<&str> = systems.iter().map(|s| s.name.as_str()).collect();
            match (names.as_slice(), name) {
                ([], _) => Failure::File(format!("{} holds no system", self.path.display())),
                (list, Some(name)) => Failure::Usage(format!(
                    "{} has no system `{name}`; it has {}",
                    self.path.display(),
                    list.join(", ")
                )),
                _ => Failure::File(format!("{} holds no system", self.path.display())),
            }
        })
    }

    /// What this version does not derive, as a diagnostic.
    pub fn unsupported(&self, e: &Unsupported) -> Failure {
        let d = Diagnostic::error("E0401", e.span, e.to_string())
            .hint("the system parses and checks; a later version derives it");
        Failure::File(self.render(&[d]))
    }
}

/// A plan and the roots it starts from.
pub struct Job {
    pub plan: Plan,
    pub axiom: patch::Axiom,
}

/// Reads the rule file and the axiom's files, and makes the plan.
pub fn job(flags: &flags::Derive) -> Result<Job, Failure> {
    let source = Source::read(&flags.system.file)?;
    source.refuse_errors()?;
    let system = source.system(flags.system.system.as_deref())?;
    let plan = Plan::new(system).map_err(|e| source.unsupported(&e))?;
    let axiom = axiom(&source, system, flags.input.as_deref())?;
    Ok(Job { plan, axiom })
}

/// Reads the axiom's files, relative to the rule file; `input` stands for every source that names
/// the same file as the first.
pub fn axiom(source: &Source, system: &System, input: Option<&Path>) -> Result<patch::Axiom, Failure> {
    let first = first_file(system);
    if let (Some(input), None) = (input, &first) {
        return Err(Failure::Usage(format!(
            "--in {}: the axiom of {} names no file that it could replace",
            input.display(),
            system.name
        )));
    }
    let rational = matches!(system.kind, Kind::Patch { rational: true, .. });
    let folder = source.path.parent().unwrap_or(Path::new(""));
    let mut read = |name: &str| {
        let path = match input {
            Some(input) if first.as_deref() == Some(name) => input.to_path_buf(),
            _ => folder.join(name),
        };
        read_nets(&path, rational)
    };
    patch::Axiom::load(system, &mut read).map_err(|e| match e {
        patch::AxiomError::Source(text) => Failure::File(text),
        patch::AxiomError::Wrong { message, span } => {
            Failure::File(source.render(&[Diagnostic::error("E0402", span, message)]))
        }
    })
}

fn first_file(system: &System) -> Option<String> {
    let Axiom::Patches(starts) = &system.axiom else { return None };
    starts.iter().find_map(|s| match &s.source {
        PatchSource::File { path, .. } => Some(path.clone()),
        _ => None,
    })
}

/// The nets of a .bpt file; a parse error shows the line, cut around the place.
fn read_nets(path: &Path, rational: bool) -> Result<Vec<patch::Net>, String> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("bpt") => {}
        _ => return Err(format!("{}: patches are read from .bpt files", path.display())),
    }
    bpt::read(path, rational).map_err(|e| match &e {
        bpt::ReadError::Text { error, .. } => {
            let bytes = std::fs::read(path).unwrap_or_default();
            let line = bytes.split(|b| *b == b'\n').nth(error.line.saturating_sub(1)).unwrap_or(&[]);
            format!("error: {e}\n{}", excerpt(&String::from_utf8_lossy(line), error.column))
        }
        _ => format!("error: {e}"),
    })
}

/// The line, at most 120 columns of it, and a caret below `column` (from 1).
fn excerpt(line: &str, column: usize) -> String {
    let characters: Vec<char> =
        line.trim_end().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let at = column.saturating_sub(1).min(characters.len());
    let start = at.saturating_sub(60);
    let end = characters.len().min(start + 120);
    let shown: String = characters[start..end].iter().collect();
    format!("  | {shown}\n  | {}^", " ".repeat(at - start))
}

/// Half of the machine's memory; 4 GiB where the system does not say.
pub fn half_of_memory() -> u64 {
    let total = sysinfo::System::new().map(|mut system| {
        system.refresh_memory();
        system.total_memory()
    });
    total.map_or(4 << 30, |bytes| (bytes / 2).max(1 << 28))
}
