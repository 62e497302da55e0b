//! Errors and warnings about a rule file, each with a stable code, a place and a hint.

use super::syntax::Span;

/// The codes of the lexer (`E00..`) and of the parser (`E01..`).
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
    /// More errors than are worth listing.
    pub const TOO_MANY_ERRORS: &str = "E0199";
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
