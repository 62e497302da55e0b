//! From text to one system in one call.

use super::diagnostic::{self, Diagnostic, Severity, code};
use super::{Span, System, Vocabulary, compile};
use std::fmt;

/// What is wrong with a rule file, together with its text: it prints as lines with carets.
///
/// The debug form is the same text, since that is what a `main` that returns an error prints.
#[derive(Clone)]
pub struct Diagnostics {
    /// In the order of the text; at least one is an error.
    pub list: Vec<Diagnostic>,
    pub text: String,
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(diagnostic::render(&self.list, "rules", &self.text, false).trim_end())
    }
}

impl fmt::Debug for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

impl std::error::Error for Diagnostics {}

impl System {
    /// Parses and checks a rule file, and takes its last system.
    ///
    /// Warnings are dropped; [`compile`] gives them, and all systems of the file.
    ///
    /// ```
    /// # use burgeon::language::System;
    /// let error = System::parse("system s : patch bezier 3\nmodule P\nrules:\n  P -> [ P Q ; P P ]").unwrap_err();
    /// assert!(error.to_string().contains("no module `Q` is declared"));
    /// ```
    ///
    /// # Errors
    /// All errors and warnings of the file if any is an error, or if it holds no system.
    pub fn parse(text: &str) -> Result<System, Diagnostics> {
        let mut checked = compile(text, &Vocabulary::default());
        if checked.diagnostics.iter().all(|d| d.severity == Severity::Warning) {
            if let Some(last) = checked.systems.pop() {
                return Ok(last);
            }
            let end = Span::new(text.len(), text.len());
            let error =
                Diagnostic::error(code::UNEXPECTED, end, "expected a system, found the end of the file");
            checked.diagnostics.push(error.hint("begin one: `system name : patch bezier 3`"));
        }
        Err(Diagnostics { list: checked.diagnostics, text: text.to_string() })
    }
}
