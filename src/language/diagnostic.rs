//! Errors and warnings about a rule file, each with a stable code, a place and a hint.

use super::syntax::Span;

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
