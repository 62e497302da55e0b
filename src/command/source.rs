//! Rule files: read and compiled once, and what is said of them.

use super::load::{cannot_read, has_extension};
use super::{Failure, colored, counted, flags, say};
use burgeon::language::check::{Checked, compile};
use burgeon::language::diagnostic::{self, nearest};
use burgeon::language::system::System;
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{Diagnostic, Severity, Span, Value, lex, parse, syntax};
use burgeon::plan::{Plan, Unsupported};
use std::io;
use std::path::{Path, PathBuf};

/// What is said of a file without systems.
const BEGINNING: &str = "help: a system begins with `system NAME : patch bezier 3` or `system NAME : curve`";

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
        if checked.systems.is_empty() && checked.diagnostics.is_empty() {
            let file = parse(&text).file;
            if file.items.is_empty() && file.version.is_none() {
                let what = if text.trim().is_empty() { "it is empty" } else { "it holds comments only" };
                return Err(Failure::File(format!("error: {name} is no rule file: {what}\n{BEGINNING}")));
            }
        }
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

    /// Takes out the system of this name, or the last.
    fn take(&mut self, name: Option<&str>) -> Result<System, Failure> {
        let systems = &mut self.checked.systems;
        let path = self.path.display();
        let index = match name {
            None => systems.len().checked_sub(1),
            Some(name) => systems.iter().position(|s| s.name == name),
        };
        if let Some(index) = index {
            return Ok(systems.swap_remove(index));
        }
        let names: Vec<&str> = systems.iter().map(|s| s.name.as_str()).collect();
        match (name, names.as_slice()) {
            (Some(name), [_, ..]) => {
                let help = did_you_mean(name, names.iter().copied());
                let names = names.join(", ");
                Err(Failure::Usage(format!("error: {path} has no system `{name}`; it has {names}{help}")))
            }
            _ => Err(Failure::File(format!("error: {path} holds no system\n{BEGINNING}"))),
        }
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
        io::ErrorKind::IsADirectory => "\nhelp: name a rule file in it".to_string(),
        _ => String::new(),
    };
    Failure::File(format!("error: {}{help}", cannot_read(path, e)))
}

/// A rule file without errors, and that system of it that is meant.
pub struct Loaded {
    pub source: Source,
    pub system: System,
}

impl Loaded {
    /// Reads and compiles the file, says its warnings, and takes the system that the flags name. What is wrong with
    /// the file comes before what is wrong with flags.
    pub fn read(flags: &flags::System) -> Result<Loaded, Failure> {
        let mut source = Source::read(&flags.file)?;
        source.refuse_errors()?;
        let system = source.take(flags.system.as_deref())?;
        Ok(Loaded { source, system })
    }

    /// The plan of the system, made as `make` does.
    pub fn plan(&self, make: fn(&System) -> Result<Plan, Unsupported>) -> Result<Plan, Failure> {
        make(&self.system).map_err(|e| self.source.unsupported(&e))
    }

    /// What of `--set` goes to the system: a param of the file that it does not read is left out.
    pub fn set(&self, given: &[(String, Value)]) -> Result<Vec<(String, Value)>, Failure> {
        let mut set = Vec::new();
        for (name, value) in given {
            if self.system.params().any(|param| param.name == name) {
                set.push((name.clone(), value.clone()));
            } else if self.source.shares_param(name) {
                let system = &self.system.name;
                say(&format!("note: {system} does not read the param `{name}` that --set gives"));
            } else {
                return Err(Failure::Usage(format!("error: {}", no_such_param(&self.system, "--set", name))));
            }
        }
        Ok(set)
    }
}

/// A line of help, if one of the names is near.
fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, names).map_or(String::new(), |n| format!("\nhelp: did you mean `{n}`?"))
}

/// What a flag says that names a param which the system has not.
pub fn no_such_param(system: &System, flag: &str, name: &str) -> String {
    let (of, names) = (&system.name, system.params().map(|param| param.name));
    let help = did_you_mean(name, names);
    match params(system) {
        list if list.is_empty() => format!("{flag} {name}: the system {of} has no params"),
        list => format!("{flag} {name}: no such param of {of}; it has\n{}{help}", list.trim_end()),
    }
}

/// The params of a system, each on a line of its own.
pub fn params(system: &System) -> String {
    system.params().map(|param| format!("  param {param}\n")).collect()
}
