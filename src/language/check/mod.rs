//! From the syntax tree to checked systems: names resolved, expressions typed, constants folded.
//!
//! Everything that can be known without a file or a device is checked here. A mistake is reported
//! once: what depends on a broken thing is left alone rather than reported again.

mod affine;
mod axiom;
mod branches;
mod calls;
pub mod code;
mod constants;
mod contexts;
mod corners;
mod data;
mod declare;
mod lookup;
mod mesh;
mod names;
mod patch;
mod patterns;
mod placing;
mod rules;
mod run;
mod scope;
mod shapes;
mod successor;
mod suggest;
mod templates;
mod typing;
mod unreached;

use super::diagnostic::{Diagnostic, Severity};
use super::syntax::{self, Span};
use super::system::{
    Axiom, Group, Kind, Placement, Query, Step, Symbol, SymbolId, System, Template, TemplateId, Uniform,
};
use super::vocabulary::Vocabulary;
use super::{Value, parse};
use names::Names;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// What [`check`] found.
#[derive(Clone, Debug, Default)]
pub struct Checked {
    /// The systems without errors, in the order of the file.
    pub systems: Vec<System>,
    /// Errors and warnings, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

impl Checked {
    /// Whether anything is wrong: a system with an error is not among [`Checked::systems`].
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity == Severity::Error)
    }
}

/// Parses and checks a rule file.
pub fn compile(text: &str, vocabulary: &Vocabulary) -> Checked {
    let parsed = parse::parse(text);
    let mut checked = check(&parsed.file, vocabulary);
    if parsed.has_errors() {
        // A statement that could not be read may have declared what is missing now.
        checked.systems.clear();
        let lines: Vec<_> = parsed
            .diagnostics
            .iter()
            .filter(|d| d.severity == Severity::Error)
            .map(|d| lines_of(text, d.span))
            .collect();
        checked.diagnostics.retain(|d| {
            let touches =
                |line: &Range<usize>| d.span.range().start < line.end && line.start < d.span.range().end;
            !may_follow_from_unread(d) && !lines.iter().any(touches)
        });
    }
    checked.diagnostics.extend(parsed.diagnostics);
    sort(&mut checked.diagnostics);
    checked
}

/// The whole lines that a span touches.
fn lines_of(text: &str, span: Span) -> Range<usize> {
    let range = span.range();
    let before = text.get(..range.start).unwrap_or_default();
    let behind = text.get(range.end..).unwrap_or_default();
    before.rfind('\n').map_or(0, |i| i + 1)..behind.find('\n').map_or(text.len(), |i| range.end + i)
}

/// Whether a finding may owe itself to a statement that the parser had to leave out.
fn may_follow_from_unread(finding: &Diagnostic) -> bool {
    let unknown = code::UNKNOWN_MODULE..=code::NOT_HERE;
    let absence = [code::AXIOM, code::DEGREE, code::RUN_ORDER, code::TEMPLATE_BASE, code::TRACE];
    finding.severity == Severity::Warning
        || unknown.contains(&finding.code)
        || absence.contains(&finding.code)
}

/// Checks a syntax tree.
pub fn check(file: &syntax::RuleFile, vocabulary: &Vocabulary) -> Checked {
    let nothing = empty_system();
    let mut checked = Checked::default();
    let mut shared = Vec::new();
    let mut earlier: Vec<Earlier> = Vec::new();
    let mut used = HashSet::new();
    for item in &file.items {
        match item {
            syntax::FileItem::Const(c) => shared.push(names::Declaration::of_const(c, false)),
            syntax::FileItem::Param(p) => shared.push(names::Declaration::of_param(p, false)),
            syntax::FileItem::System(system) => {
                let mut checker = Checker::new(vocabulary, &shared, earlier, system);
                checker.system_name();
                checked.systems.extend(checker.check());
                used.extend(checker.names.used_shared());
                checked.diagnostics.append(&mut checker.findings);
                let outline = checker.outline();
                earlier = checker.earlier;
                earlier.push(outline);
            }
        }
    }
    // Shared constants that no system reads are checked here, and the others found broken before.
    let mut checker = Checker::new(vocabulary, &shared, Vec::new(), &nothing);
    checker.constants();
    let between = checker.names.used_shared();
    checked.diagnostics.append(&mut checker.findings);
    if !checked.has_errors() {
        used.extend(between);
        checked.diagnostics.extend(names::unused(&shared, |d| used.contains(d.name.text.as_str())));
    }
    sort(&mut checked.diagnostics);
    checked
}

/// In the order of the text; each finding once, though shared constants are read by each system.
fn sort(findings: &mut Vec<Diagnostic>) {
    let key = |d: &Diagnostic| (d.span.start, d.span.end, d.code, d.message.clone());
    findings.sort_by_cached_key(key);
    findings.dedup_by(|a, b| key(a) == key(b));
}

fn empty_system() -> syntax::System {
    let name = syntax::Name { text: String::new(), span: Span::default() };
    let (kind, span) = (syntax::Kind::Curve, Span::default());
    syntax::System { name, kind, kind_span: span, attributes: Vec::new(), items: Vec::new(), span }
}

/// What later systems may know of a system.
#[derive(Clone, Debug)]
struct Earlier {
    name: String,
    span: Span,
    kind: syntax::Kind,
    symbols: Vec<Symbol>,
    /// The module that its turtle writes.
    traced: Option<SymbolId>,
}

/// The state of checking one system.
struct Checker<'a> {
    vocabulary: &'a Vocabulary,
    system: &'a syntax::System,
    kind: Kind,
    earlier: Vec<Earlier>,
    findings: Vec<Diagnostic>,
    symbols: Vec<Symbol>,
    symbol_ids: HashMap<&'a str, SymbolId>,
    /// Symbols with a field of no type: what is said of them is not checked.
    broken_symbols: HashSet<SymbolId>,
    names: Names<'a>,
    uniforms: Vec<Uniform>,
    /// A value for each uniform: its default.
    defaults: Vec<Value>,
    queries: Vec<Query>,
    query_ids: HashMap<&'a str, Option<usize>>,
    templates: Vec<Template>,
    /// Their names with their index, none if they are broken, and place.
    template_ids: HashMap<&'a str, (Option<TemplateId>, Span)>,
    /// Names of placements with their index and place.
    places: HashMap<&'a str, (usize, Span)>,
    volumes: HashMap<&'a str, Span>,
    /// Group names with their index and place.
    group_ids: HashMap<&'a str, (usize, Span)>,
    /// How many components the tags of a symbol have, and where that was first seen.
    tags: HashMap<SymbolId, (usize, Span)>,
    traced: Option<SymbolId>,
    corners: corners::Corners,
    /// Nesting of the expression that is being typed.
    depth: usize,
}

impl<'a> Checker<'a> {
    fn new(
        vocabulary: &'a Vocabulary,
        shared: &[names::Declaration<'a>],
        earlier: Vec<Earlier>,
        system: &'a syntax::System,
    ) -> Checker<'a> {
        let mut checker = Checker {
            vocabulary,
            system,
            kind: Kind::Mesh,
            earlier,
            findings: Vec::new(),
            symbols: Vec::new(),
            symbol_ids: HashMap::new(),
            broken_symbols: HashSet::new(),
            names: Names::default(),
            uniforms: Vec::new(),
            defaults: Vec::new(),
            queries: Vec::new(),
            query_ids: HashMap::new(),
            templates: Vec::new(),
            template_ids: HashMap::new(),
            places: HashMap::new(),
            volumes: HashMap::new(),
            group_ids: HashMap::new(),
            tags: HashMap::new(),
            traced: None,
            corners: corners::Corners::default(),
            depth: 0,
        };
        checker.declare_names(shared);
        checker
    }

    /// All checks, from the outside in. `None` if the system has errors.
    fn check(&mut self) -> Option<System> {
        self.kind = self.system_kind();
        self.items();
        self.modules();
        self.declare_queries();
        self.constants();
        self.query_values();
        self.declare_templates();
        self.declare_places();
        self.ignored();
        self.declare_groups();
        let axiom = self.axiom();
        let groups = self.groups();
        let placements = self.place_values();
        let run = self.run();
        self.count_symbols();
        if self.errors() > 0 {
            return None;
        }
        self.base_sizes();
        self.unused();
        (self.errors() == 0).then(|| self.lowered(axiom, groups, placements, run))
    }

    fn lowered(
        &self,
        axiom: Axiom,
        groups: Vec<Group>,
        placements: Vec<Placement>,
        run: Vec<Step>,
    ) -> System {
        let ignored = self.system.items.iter().flat_map(|item| match item {
            syntax::Item::Ignore(names) => &names[..],
            _ => &[],
        });
        let ignored = ignored.filter_map(|name| self.symbol_ids.get(name.text.as_str()).copied()).collect();
        System {
            name: self.system.name.text.clone(),
            kind: self.kind,
            symbols: self.symbols.clone(),
            uniforms: self.uniforms.clone(),
            queries: self.queries.clone(),
            templates: self.templates.clone(),
            axiom,
            groups,
            placements,
            ignored,
            run,
            source: Arc::new(self.system.clone()),
        }
    }

    fn outline(&self) -> Earlier {
        Earlier {
            name: self.system.name.text.clone(),
            span: self.system.name.span,
            kind: self.system.kind,
            symbols: self.symbols.clone(),
            traced: self.traced,
        }
    }

    fn system_name(&mut self) {
        let name = &self.system.name;
        if let Some(first) = self.earlier.iter().find(|e| e.name == name.text) {
            let span = first.span;
            self.duplicate("systems", &name.text, name.span, span);
        }
    }

    fn report(&mut self, finding: Diagnostic) {
        self.findings.push(finding);
    }

    fn errors(&self) -> usize {
        self.findings.iter().filter(|d| d.severity == Severity::Error).count()
    }

    /// A hint that names the candidate nearest to a name. Behind many findings it is not worth the
    /// time that the search takes.
    fn nearest<'n>(&self, name: &str, candidates: impl IntoIterator<Item = &'n str>) -> Option<String> {
        const MOST_FINDINGS: usize = 64;
        if self.findings.len() > MOST_FINDINGS {
            return None;
        }
        suggest::nearest(name, candidates)
    }

    /// Two things of one name where only one may be.
    fn duplicate(&mut self, what: &str, name: &str, span: Span, first: Span) {
        let message = if name.is_empty() { format!("two {what}") } else { format!("two {what} `{name}`") };
        let error = Diagnostic::error(code::DUPLICATE, span, message);
        self.report(error.label(first, "the first is here"));
    }

    fn unused(&mut self) {
        if self.findings.iter().any(|d| d.severity == Severity::Error) {
            return;
        }
        let findings = self.names.unused_own();
        self.findings.extend(findings);
    }
}
