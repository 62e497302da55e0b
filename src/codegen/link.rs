//! Joins the files of `wgsl/`: `import NAME;` lines name files, each is joined once, before the
//! file that names it; a prologue of constants and the generated code stand before all. Where every
//! line came from is kept.

use super::Error;
use super::generate::Text;
use crate::language::Span;

/// Every file of `wgsl/`.
const FILES: &[(&str, &str)] = &[
    ("address", include_str!("../../wgsl/shared/address.wgsl")),
    ("children", include_str!("../../wgsl/shared/children.wgsl")),
    ("elementary", include_str!("../../wgsl/shared/elementary.wgsl")),
    ("extent", include_str!("../../wgsl/shared/extent.wgsl")),
    ("halving", include_str!("../../wgsl/shared/halving.wgsl")),
    ("ops", include_str!("../../wgsl/shared/ops.wgsl")),
    ("prefix", include_str!("../../wgsl/shared/prefix.wgsl")),
    ("rules", include_str!("../../wgsl/shared/rules.wgsl")),
    ("spine", include_str!("../../wgsl/shared/spine.wgsl")),
    ("compact", include_str!("../../wgsl/compact.wgsl")),
    ("copy", include_str!("../../wgsl/copy.wgsl")),
    ("count", include_str!("../../wgsl/count.wgsl")),
    ("emit", include_str!("../../wgsl/emit.wgsl")),
    ("emit_by_point", include_str!("../../wgsl/emit_by_point.wgsl")),
    ("expand", include_str!("../../wgsl/expand.wgsl")),
    ("match_modules", include_str!("../../wgsl/match_modules.wgsl")),
    ("retire", include_str!("../../wgsl/retire.wgsl")),
    ("scan", include_str!("../../wgsl/scan.wgsl")),
];

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
pub fn link(name: &'static str, constants: &str, generated: &Text) -> Linked {
    let mut linked = Linked { source: String::new(), origins: Vec::new() };
    constants.lines().for_each(|line| linked.line(line, Origin::Constants));
    generated.lines.iter().for_each(|(line, span)| linked.line(line, Origin::Generated(*span)));
    linked.join(name, &mut Vec::new());
    linked
}

impl Linked {
    fn line(&mut self, line: &str, origin: Origin) {
        self.source.push_str(line);
        self.source.push('\n');
        self.origins.push(origin);
    }

    fn join(&mut self, name: &str, joined: &mut Vec<&'static str>) {
        let Some(&(name, text)) = FILES.iter().find(|f| f.0 == name) else {
            // naga then names what is missing.
            return self.line(&format!("import {name};"), Origin::Constants);
        };
        if joined.contains(&name) {
            return;
        }
        joined.push(name);
        let import = |line: &str| Some(line.strip_prefix("import ")?.strip_suffix(';')?.to_string());
        text.lines().filter_map(import).for_each(|file| self.join(&file, joined));
        for (n, line) in text.lines().enumerate() {
            if import(line).is_none() {
                self.line(line, Origin::File(name, n + 1));
            }
        }
    }

    /// The place in words, and the rule, of a line from 1.
    fn place(&self, line: usize) -> (String, Option<Span>) {
        match self.origins.get(line.saturating_sub(1)) {
            Some(Origin::File(name, n)) => (format!("wgsl/{name}.wgsl:{n}"), None),
            Some(Origin::Generated(span)) => (format!("generated line {line}"), *span),
            _ => (format!("line {line}"), None),
        }
    }
}

/// Parses and validates with the capabilities of WebGPU's core.
pub fn validate(kernel: &'static str, linked: &Linked) -> Result<naga::Module, Error> {
    let fail = |line: Option<u32>, message: String| {
        let (place, rule) = linked.place(line.unwrap_or(0) as usize);
        Error { kernel, place, message, rule }
    };
    let module = naga::front::wgsl::parse_str(&linked.source).map_err(|e| {
        let line = e.location(&linked.source).map(|l| l.line_number);
        fail(line, e.message().to_string())
    })?;
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    validator.validate(&module).map_err(|e| {
        let line = e.location(&linked.source).map(|l| l.line_number);
        fail(line, with_sources(e.as_inner()))
    })?;
    Ok(module)
}

fn with_sources(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(source) => format!("{error}: {}", with_sources(source)),
        None => error.to_string(),
    }
}
