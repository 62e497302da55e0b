//! Joins the files of `wgsl/`: `import NAME;` lines name files, each is joined once, before the
//! file that names it; a prologue of constants and the generated code stand before all. Where every
//! line came from is kept.

use super::Error;
use super::generate::Text;
use crate::language::Span;
use std::borrow::Cow;

/// Every file of `wgsl/`.
const FILES: &[(&str, &str)] = &[
    ("address", include_str!("../../wgsl/shared/address.wgsl")),
    ("attributes", include_str!("../../wgsl/shared/attributes.wgsl")),
    ("children", include_str!("../../wgsl/shared/children.wgsl")),
    ("elementary", include_str!("../../wgsl/shared/elementary.wgsl")),
    ("extent", include_str!("../../wgsl/shared/extent.wgsl")),
    ("halving", include_str!("../../wgsl/shared/halving.wgsl")),
    ("ops", include_str!("../../wgsl/shared/ops.wgsl")),
    ("prefix", include_str!("../../wgsl/shared/prefix.wgsl")),
    ("rows", include_str!("../../wgsl/shared/rows.wgsl")),
    ("rules", include_str!("../../wgsl/shared/rules.wgsl")),
    ("spine", include_str!("../../wgsl/shared/spine.wgsl")),
    ("compact", include_str!("../../wgsl/compact.wgsl")),
    ("copy", include_str!("../../wgsl/copy.wgsl")),
    ("count", include_str!("../../wgsl/count.wgsl")),
    ("emit", include_str!("../../wgsl/emit.wgsl")),
    ("emit_by_line", include_str!("../../wgsl/emit_by_line.wgsl")),
    ("emit_by_point", include_str!("../../wgsl/emit_by_point.wgsl")),
    ("expand", include_str!("../../wgsl/expand.wgsl")),
    ("match_modules", include_str!("../../wgsl/match_modules.wgsl")),
    ("measure", include_str!("../../wgsl/measure.wgsl")),
    ("retire", include_str!("../../wgsl/retire.wgsl")),
    ("scan", include_str!("../../wgsl/scan.wgsl")),
    ("advance", include_str!("../../wgsl/tessellate/advance.wgsl")),
    ("decide", include_str!("../../wgsl/tessellate/decide.wgsl")),
    ("finish", include_str!("../../wgsl/tessellate/finish.wgsl")),
    ("mark", include_str!("../../wgsl/tessellate/mark.wgsl")),
    ("split", include_str!("../../wgsl/tessellate/split.wgsl")),
    ("tally", include_str!("../../wgsl/tessellate/tally.wgsl")),
    ("triangles", include_str!("../../wgsl/tessellate/triangles.wgsl")),
    ("vertices", include_str!("../../wgsl/tessellate/vertices.wgsl")),
    ("bound", include_str!("../../wgsl/tessellate/shared/bound.wgsl")),
    ("control", include_str!("../../wgsl/tessellate/shared/control.wgsl")),
    ("lattice", include_str!("../../wgsl/tessellate/shared/lattice.wgsl")),
    ("surface", include_str!("../../wgsl/tessellate/shared/surface.wgsl")),
    ("topology", include_str!("../../wgsl/tessellate/shared/topology.wgsl")),
    ("tree", include_str!("../../wgsl/tessellate/shared/tree.wgsl")),
];

/// A text that stands in place of another, once in a file of `wgsl/` or in each line of the
/// [`GENERATED`] code: the tests break kernels on purpose with it.
#[derive(Clone, Debug)]
pub struct Edit {
    /// The file's name without `.wgsl`, or [`GENERATED`].
    pub file: &'static str,
    pub find: &'static str,
    pub replace: &'static str,
}

/// What the rules say, as the file of an [`Edit`].
pub const GENERATED: &str = "generated";

/// The text of a file as the edit, if it is one of this file, leaves it.
fn edited<'t>(file: &str, text: &'t str, edit: Option<&Edit>) -> Cow<'t, str> {
    match edit {
        Some(e) if e.file == file => Cow::Owned(text.replacen(e.find, e.replace, 1)),
        _ => Cow::Borrowed(text),
    }
}

/// Where a line of a linked module came from.
#[derive(Clone, Copy, Debug)]
enum Origin {
    Constants,
    Generated(Option<Span>),
    /// File and line, from 1.
    File(&'static str, usize),
}

/// A module and the origin of each of its lines.
pub struct Linked {
    pub source: String,
    origins: Vec<Origin>,
}

/// Links the kernel of this name.
pub fn link(name: &'static str, constants: &str, generated: &Text, edit: Option<&Edit>) -> Linked {
    let mut linked = Linked { source: String::new(), origins: Vec::new() };
    constants.lines().for_each(|line| linked.line(line, Origin::Constants));
    for (line, span) in &generated.lines {
        linked.line(&edited(GENERATED, line, edit), Origin::Generated(*span));
    }
    linked.join(name, Origin::Constants, edit, &mut Vec::new());
    linked
}

impl Linked {
    fn line(&mut self, line: &str, origin: Origin) {
        self.source.push_str(line);
        self.source.push('\n');
        self.origins.push(origin);
    }

    fn join(&mut self, name: &str, from: Origin, edit: Option<&Edit>, joined: &mut Vec<&'static str>) {
        let Some(&(name, text)) = FILES.iter().find(|f| f.0 == name) else {
            // naga then refuses the line that asks for what is missing.
            return self.line(&format!("import {name};"), from);
        };
        if joined.contains(&name) {
            return;
        }
        joined.push(name);
        let text = edited(name, text, edit);
        let import = |line: &str| Some(line.strip_prefix("import ")?.strip_suffix(';')?.to_string());
        let lines = || text.lines().enumerate().map(|(n, line)| (line, Origin::File(name, n + 1)));
        for (line, origin) in lines() {
            if let Some(file) = import(line) {
                self.join(&file, origin, edit, joined);
            }
        }
        for (line, origin) in lines() {
            if import(line).is_none() {
                self.line(line, origin);
            }
        }
    }

    /// The place in words, and the rule, where a span of the source begins.
    fn place(&self, span: Option<naga::Span>) -> (String, Option<Span>) {
        let Some(span) = span else { return ("the module as a whole".to_string(), None) };
        let line = span.location(&self.source).line_number as usize;
        match self.origins.get(line.saturating_sub(1)) {
            Some(Origin::File(name, n)) => (format!("wgsl/{name}.wgsl:{n}"), None),
            Some(Origin::Generated(span)) => (format!("generated line {line}"), *span),
            _ => (format!("line {line}"), None),
        }
    }
}

/// Parses and validates with the capabilities of WebGPU's core.
pub fn validate(kernel: &'static str, linked: &Linked) -> Result<naga::Module, Error> {
    let fail = |span: Option<naga::Span>, message: String| {
        let (place, rule) = linked.place(span);
        Error { kernel, place, message, rule }
    };
    let module = naga::front::wgsl::parse_str(&linked.source).map_err(|e| {
        // What a built-in function wants has a label, but stands nowhere.
        let span = e.labels().map(|(span, _)| span).find(naga::Span::is_defined);
        fail(span, e.message().to_string())
    })?;
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    validator.validate(&module).map_err(|e| {
        // The function is named as well as the expression: the narrowest says most.
        let spans = e.spans().filter_map(|(span, _)| Some((span.to_range()?.len(), *span)));
        let span = spans.min_by_key(|(length, _)| *length).map(|(_, span)| span);
        fail(span, with_sources(e.as_inner()))
    })?;
    Ok(module)
}

fn with_sources(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(source) => format!("{error}: {}", with_sources(source)),
        None => error.to_string(),
    }
}
