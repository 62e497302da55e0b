//! Errors and warnings about a rule file, each with a stable code, a place and a hint.

use super::syntax::Span;
use annotate_snippets::{
    Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str,
};
use std::ops::Range;

/// The codes of the lexer (`E00..`) and of the parser (`E01..`, `W01..`).
///
/// A code never changes its meaning; the checker keeps its own (`E02..`, `W03..`).
pub mod code {
    /// The file is not UTF-8.
    pub const INVALID_UTF8: &str = "E0001";
    /// A character that the language does not use.
    pub const UNKNOWN_CHARACTER: &str = "E0002";
    /// A string without its closing quote.
    pub const UNCLOSED_STRING: &str = "E0003";
    /// A numeral that is none, such as `1.5x` or `.5`.
    pub const BAD_NUMBER: &str = "E0004";
    /// `-->` or `=>` for `->`.
    pub const WRONG_ARROW: &str = "E0005";
    /// `/* … */`: comments are `//`.
    pub const BLOCK_COMMENT: &str = "E0006";
    /// The file is longer than 4 GiB.
    pub const TOO_LONG: &str = "E0007";

    /// Something else was expected here.
    pub const UNEXPECTED: &str = "E0101";
    /// A bracket that is never closed.
    pub const UNCLOSED_BRACKET: &str = "E0102";
    /// A closing bracket that closes nothing.
    pub const STRAY_BRACKET: &str = "E0103";
    /// Nested deeper than 256.
    pub const TOO_DEEP: &str = "E0104";
    /// More than 4,096 rules in a system.
    pub const TOO_MANY_RULES: &str = "E0105";
    /// A keyword where a name is wanted.
    pub const KEYWORD_AS_NAME: &str = "E0106";
    /// A symbol that no `module` declares.
    pub const UNDECLARED_SYMBOL: &str = "E0107";
    /// Nothing after `->`, in a branch or in an axiom.
    pub const EMPTY_WORD: &str = "E0108";
    /// `eps` outside a word or block.
    pub const MISPLACED_EPS: &str = "E0109";
    /// A block whose rows differ in length.
    pub const RAGGED_BLOCK: &str = "E0110";
    /// A block that is not 1×2, 2×1 or 2×2.
    pub const BLOCK_SIZE: &str = "E0111";
    /// In a patch system, a bracket that is neither a block nor a branch.
    pub const NOT_A_BLOCK: &str = "E0112";
    /// `a < b < c`.
    pub const CHAINED_COMPARISON: &str = "E0113";
    /// An operator of another language: `?`, a lone `&` or `|`, `=` for `==`, `^` …
    pub const FOREIGN_OPERATOR: &str = "E0114";
    /// A rule as other systems write it: `A = F A`, `A -> F : 0.3`, `(30%)`, `A -> *`.
    pub const FOREIGN_RULE: &str = "E0115";
    /// A rule without a strict predecessor.
    pub const NO_PREDECESSOR: &str = "E0116";
    /// A pattern that holds more than names and literals.
    pub const BAD_PATTERN: &str = "E0117";
    /// A word that begins no declaration and no step, or names no kind or attribute of a system.
    pub const UNKNOWN_WORD: &str = "E0118";
    /// A declaration where none may stand: after `run:`, or outside a system.
    pub const MISPLACED_ITEM: &str = "E0119";
    /// `burgeon N` with an N that this version does not know, or not in the first line.
    pub const VERSION: &str = "E0120";
    /// A file that is plainly none of rules: prose, markup, data, no text at all.
    pub const NO_RULE_FILE: &str = "E0121";
    /// More errors than are worth listing.
    pub const TOO_MANY_ERRORS: &str = "E0199";

    /// A comment behind a word that is itself empty or a word: two rolls need a space.
    pub const COMMENT_LIKE_WORD: &str = "W0101";
    /// `\` at the end of a line, which is a roll: a word goes on in a line that is indented deeper.
    pub const ROLL_AT_END: &str = "W0102";
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Error,
    Warning,
}

/// One finding.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    pub severity: Severity,
    /// Stable: `E…` for errors, `W…` for warnings.
    pub code: &'static str,
    pub message: String,
    /// Where the caret stands.
    pub span: Span,
    /// Other places, each with what it has to do with the matter.
    pub labels: Vec<(Span, String)>,
    /// What would be right.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// An error without labels and hint.
    pub fn error(code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            severity: Severity::Error,
            code,
            message: message.into(),
            span,
            labels: Vec::new(),
            hint: None,
        }
    }

    /// A warning without labels and hint.
    pub fn warning(code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(code, span, message) }
    }

    /// Adds another place and what it has to do with the matter.
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push((span, text.into()));
        self
    }

    /// Says what would be right.
    pub fn hint(mut self, text: impl Into<String>) -> Diagnostic {
        self.hint = Some(text.into());
        self
    }

    /// Says what would be right, where that is known.
    pub fn hint_if(self, text: Option<impl Into<String>>) -> Diagnostic {
        match text {
            Some(text) => self.hint(text),
            None => self,
        }
    }
}

/// The candidate that `name` is probably a slip of, if one is near: for `did you mean …?`.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 40;
    let longest = |n: usize| if n < 3 { 1 } else { n / 3 };
    if name.len() > LONGEST {
        return None;
    }
    candidates
        .into_iter()
        .filter(|c| c.len() <= LONGEST && c.len().abs_diff(name.len()) <= longest(name.len()))
        .map(|c| (distance(name, c), c))
        // A name of one letter is near to any other: only the case may differ.
        .filter(|(d, c)| *d <= longest(name.len()) && (name.len() > 1 || c.eq_ignore_ascii_case(name)))
        .min()
        .map(|(_, c)| c)
}

/// How many letters must be put in, left out, replaced or swapped with their neighbour.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(!a[i - 1].eq_ignore_ascii_case(&b[j - 1]));
            let mut best = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

/// The most columns of a line that are shown.
const SHOWN: usize = 110;
/// The most columns that are shown before the caret.
const SHOWN_BEFORE: usize = 60;

/// The findings as text for a terminal: of each its place, its line with a caret below, the other
/// places that matter, and the hint. `file` is the name to show; `text` is what was parsed (of a file
/// that is not UTF-8, its lossy decoding).
pub fn render(diagnostics: &[Diagnostic], file: &str, text: &str, color: bool) -> String {
    let renderer = if color { Renderer::styled().hyperlink(false) } else { Renderer::plain() };
    let renderer = renderer.term_width(2 * SHOWN);
    let source = Source::new(file, text);
    let mut out = String::new();
    for diagnostic in diagnostics {
        out += &renderer.render(&[source.group(diagnostic)]);
        out += "\n\n";
    }
    out
}

/// A text whose lines have been found.
struct Source<'a> {
    file: &'a str,
    text: &'a str,
    /// Where each line starts.
    lines: Vec<usize>,
}

/// A part of a line.
struct Window {
    line: usize,
    /// The bytes of the text that are shown.
    shown: Range<usize>,
    cut_before: bool,
    cut_behind: bool,
}

impl<'a> Source<'a> {
    fn new(file: &'a str, text: &'a str) -> Source<'a> {
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Source { file, text, lines }
    }

    fn group(&self, diagnostic: &'a Diagnostic) -> Group<'a> {
        let level = match diagnostic.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let span = self.clamp(diagnostic.span);
        let window = self.window(&span);
        let mut marks = vec![self.mark(AnnotationKind::Primary, &span, &window)];
        let mut elsewhere = Vec::new();
        for (place, label) in &diagnostic.labels {
            let place = self.clamp(*place);
            if window.shown.contains(&place.start) {
                marks.push(self.mark(AnnotationKind::Context, &place, &window).label(label.as_str()));
            } else {
                elsewhere.push((place, label));
            }
        }
        let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code);
        let mut group = self.show(Group::with_title(title), &span, &window, marks);
        for (place, label) in elsewhere {
            let window = self.window(&place);
            let mark = self.mark(AnnotationKind::Context, &place, &window).label(label.as_str());
            group = self.show(group, &place, &window, vec![mark]);
        }
        match &diagnostic.hint {
            Some(hint) => group.element(Level::HELP.message(normalize_untrusted_str(hint))),
            None => group,
        }
    }

    /// The bytes of a span, inside the text, at whole characters and in one line.
    fn clamp(&self, span: Span) -> Range<usize> {
        let start = self.text.floor_char_boundary(span.start as usize);
        let end = self.text.floor_char_boundary(span.end as usize).max(start);
        start..end.min(self.line_end(self.line_of(start))).max(start)
    }

    fn line_of(&self, at: usize) -> usize {
        self.lines.partition_point(|start| *start <= at) - 1
    }

    fn line_end(&self, line: usize) -> usize {
        let end = self.lines.get(line + 1).map_or(self.text.len(), |next| next - 1);
        let line = &self.text[self.lines[line]..end];
        end - usize::from(line.ends_with('\r'))
    }

    /// Adds a line with its place above and its marks below.
    fn show(
        &self,
        group: Group<'a>,
        place: &Range<usize>,
        window: &Window,
        marks: Vec<Annotation<'a>>,
    ) -> Group<'a> {
        let snippet = self.snippet(window).annotations(marks);
        if !window.cut_before {
            return group.element(snippet.path(self.file));
        }
        // The snippet would count columns from the cut.
        let column = self.text[self.lines[window.line]..place.start].chars().count() + 1;
        group.element(Origin::path(self.file).line(window.line + 1).char_column(column)).element(snippet)
    }

    /// What is shown of the line of `place`.
    fn window(&self, place: &Range<usize>) -> Window {
        let line = self.line_of(place.start);
        let (first, last) = (self.lines[line], self.line_end(line).max(place.start));
        let before = self.text[first..place.start].chars().rev();
        let (before, columns) = fitting(before, SHOWN_BEFORE);
        let (behind, _) = fitting(self.text[place.start..last].chars(), SHOWN - columns);
        let shown = place.start - before..place.start + behind;
        Window { line, cut_before: shown.start > first, cut_behind: shown.end < last, shown }
    }

    fn snippet(&self, window: &Window) -> Snippet<'a, Annotation<'a>> {
        let (before, behind) =
            (if window.cut_before { "…" } else { "" }, if window.cut_behind { "…" } else { "" });
        // Of one byte each, so that the marks stay where they are.
        let shown = self.text[window.shown.clone()].replace(|c: char| c.is_ascii_control(), " ");
        Snippet::source(format!("{before}{shown}{behind}")).line_start(window.line + 1)
    }

    fn mark(&self, kind: AnnotationKind, place: &Range<usize>, window: &Window) -> Annotation<'a> {
        let shift = if window.cut_before { "…".len() } else { 0 };
        let at = |byte: usize| byte.min(window.shown.end) - window.shown.start + shift;
        kind.span(at(place.start)..at(place.end))
    }
}

/// The bytes and columns of as many characters as fit into `columns`. What is not ASCII may be two
/// columns wide.
fn fitting(chars: impl Iterator<Item = char>, columns: usize) -> (usize, usize) {
    let (mut bytes, mut used) = (0, 0);
    for c in chars {
        let width = if c.is_ascii() { 1 } else { 2 };
        if used + width > columns {
            break;
        }
        bytes += c.len_utf8();
        used += width;
    }
    (bytes, used)
}
