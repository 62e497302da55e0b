//! Joins the files of `wgsl/`: `import NAME;` lines name files or [parts](Parts) of what is generated, each is joined
//! once, before the file that names it; a prologue of constants stands before all. Where every line came from is kept.
//! Loops over a net are [written out](super::unroll).

use super::Error;
use super::generate::Text;
use super::unroll::unroll;
use crate::language::Span;
use std::borrow::Cow;

macro_rules! files {
    ($($path:literal)*) => {
        &[$(($path, include_str!(concat!("../../wgsl/", $path, ".wgsl")))),*]
    };
}

/// Every file of `wgsl/`, by its path without the ending. Files are imported by the last part of it.
const FILES: &[(&str, &str)] = files![
    "shared/address"
    "shared/attributes"
    "shared/branches"
    "shared/cell"
    "shared/children"
    "shared/compositions"
    "shared/elementary"
    "shared/extent"
    "shared/halving"
    "shared/links"
    "shared/motion"
    "shared/numbers"
    "shared/ops"
    "shared/progress"
    "shared/rows"
    "shared/rules"
    "shared/sums"
    "shared/tiles"
    "shared/workgroups"
    "claim"
    "compact"
    "copy"
    "count"
    "emit"
    "emit_by_line"
    "emit_by_point"
    "emit_word"
    "expand"
    "join"
    "link"
    "match_modules"
    "measure"
    "proceed"
    "retire"
    "scan"
    "start_word"
    "stencil"
    "turtle"
    "turtle_linked"
    "refine/faces"
    "refine/first"
    "refine/gather"
    "refine/levels"
    "refine/rings"
    "refine/shared/pinned"
    "refine/shared/roots"
    "tessellate/adopt"
    "tessellate/advance"
    "tessellate/afford"
    "tessellate/begin"
    "tessellate/decide"
    "tessellate/enter"
    "tessellate/finish"
    "tessellate/mark"
    "tessellate/recall"
    "tessellate/split"
    "tessellate/tally"
    "tessellate/triangles"
    "tessellate/vertices"
    "tessellate/shared/bound"
    "tessellate/shared/budget"
    "tessellate/shared/control"
    "tessellate/shared/hash"
    "tessellate/shared/lattice"
    "tessellate/shared/placement"
    "tessellate/shared/source"
    "tessellate/shared/surface"
    "tessellate/shared/table"
    "tessellate/shared/target"
    "tessellate/shared/topology"
    "tessellate/shared/tree"
];

fn name_of(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

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
    /// File, without the ending, and line, from 1.
    File(&'static str, usize),
}

/// A module and the origin of each of its lines.
pub struct Linked {
    pub source: String,
    origins: Vec<Origin>,
}

/// What the rules say, by the names under which files import it; none of others.
pub type Parts<'a> = &'a dyn Fn(&str) -> Option<Text>;

/// Links the kernel of this name.
pub fn link(name: &'static str, constants: &str, parts: Parts, edit: Option<&Edit>) -> Linked {
    let mut linked = Linked { source: String::new(), origins: Vec::new() };
    constants.lines().for_each(|line| linked.line(line, Origin::Constants));
    linked.join(name, Origin::Constants, (parts, edit), &mut Vec::new());
    let lines = linked.source.lines().map(str::to_string).zip(linked.origins).collect();
    let mut unrolled = Linked { source: String::new(), origins: Vec::new() };
    unroll(lines, constants).iter().for_each(|(line, origin)| unrolled.line(line, *origin));
    unrolled
}

impl Linked {
    fn line(&mut self, line: &str, origin: Origin) {
        self.source.push_str(line);
        self.source.push('\n');
        self.origins.push(origin);
    }

    fn join(
        &mut self,
        name: &str,
        from: Origin,
        (parts, edit): (Parts, Option<&Edit>),
        joined: &mut Vec<String>,
    ) {
        if joined.iter().any(|known| known == name) {
            return;
        }
        joined.push(name.to_string());
        let Some(&(path, text)) = FILES.iter().find(|f| name_of(f.0) == name) else {
            let Some(part) = parts(name) else {
                // naga then refuses the line that asks for what is missing.
                return self.line(&format!("import {name};"), from);
            };
            for (line, span) in &part.lines {
                self.line(&edited(GENERATED, line, edit), Origin::Generated(*span));
            }
            return;
        };
        let text = edited(name_of(path), text, edit);
        let import = |line: &str| Some(line.strip_prefix("import ")?.strip_suffix(';')?.to_string());
        let lines = || text.lines().enumerate().map(|(n, line)| (line, Origin::File(path, n + 1)));
        for (line, origin) in lines() {
            if let Some(file) = import(line) {
                self.join(&file, origin, (parts, edit), joined);
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
            Some(Origin::File(path, n)) => (format!("wgsl/{path}.wgsl:{n}"), None),
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
