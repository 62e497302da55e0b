//! Rules that an earlier rule of their group leaves nothing to.

use super::code;
use super::typing::as_literal;
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::Value;
use crate::language::syntax::{self, Span};
use crate::language::system::{FaceSuccessor, FaceTemplate, Rule, Successor, SymbolId};
use std::collections::HashMap;

/// The rules of a group so far that fire wherever their predecessor stands.
#[derive(Debug, Default)]
pub(super) struct Reach {
    /// By their first symbol.
    always: HashMap<SymbolId, Vec<(Vec<SymbolId>, Span)>>,
}

impl Reach {
    /// Adds the next rule of the group; a warning if it is never reached.
    pub fn add(&mut self, written: &syntax::Rule, rule: &Rule) -> Option<Diagnostic> {
        let first = *rule.strict.first()?;
        let earlier = self.always.entry(first).or_default();
        if let Some((_, span)) = earlier.iter().find(|(strict, _)| rule.strict.starts_with(strict)) {
            let message = "this rule is never reached";
            let warning = Diagnostic::warning(code::UNREACHED, rule.span, message);
            return Some(warning.label(*span, "this one already fires wherever it could"));
        }
        // A join takes pairs, and leaves single faces to the rules behind it.
        if !written.predecessor.joined && always_fires(rule) {
            earlier.push((rule.strict.clone(), rule.span));
        }
        None
    }
}

fn always_fires(rule: &Rule) -> bool {
    let holds = match &rule.condition {
        None => true,
        Some(condition) => as_literal(condition) == Some(Value::Bool(true)),
    };
    let some_alternative = rule.alternatives.iter().any(|a| match &a.weight {
        None => true,
        Some(weight) => matches!(as_literal(weight), Some(Value::Float(w)) if w > 0.0),
    });
    holds
        && some_alternative
        && rule.queries.is_empty()
        && rule.left.is_none()
        && rule.right.is_none()
        && rule.tests.is_empty()
        && rule.alternatives.iter().all(|a| fits_any_face(&a.successor))
}

/// A template of one's own fits only faces with as many corners as its base.
fn fits_any_face(successor: &Successor) -> bool {
    match successor {
        Successor::Face(
            FaceSuccessor::Replace(used) | FaceSuccessor::Attach(used) | FaceSuccessor::Join(used),
        ) => matches!(used.template, FaceTemplate::Shape(_)),
        _ => true,
    }
}
