//! `//` that may have been meant as two symbols: in a word two rolls need a space between them.

use super::code;
use super::declare::TURTLE;
use crate::language::diagnostic::Diagnostic;
use crate::language::syntax::{FileItem, Item, Kind, RuleFile, Span, System};
use std::collections::HashSet;

/// Warns of comments behind a statement that are empty or read as words of the system's symbols.
pub(super) fn suspicious(text: &str, file: &RuleFile) -> Vec<Diagnostic> {
    let mut findings = Vec::new();
    for item in &file.items {
        if let FileItem::System(system) = item
            && system.kind != Kind::Mesh
        {
            let symbols = symbols(system);
            for rules in system.items.iter().filter_map(word_span) {
                findings.extend(comments(text, rules).filter_map(|c| check(text, c, &symbols)));
            }
        }
    }
    findings
}

/// The places of a system's words.
fn word_span(item: &Item) -> Option<Span> {
    match item {
        Item::Rules(rules) => Some(rules.span),
        Item::Axiom(axiom) => Some(axiom.span),
        _ => None,
    }
}

fn symbols(system: &System) -> HashSet<&str> {
    let declared = system.items.iter().flat_map(|item| match item {
        Item::Modules(modules) => modules.as_slice(),
        _ => &[],
    });
    declared.map(|m| m.symbol.text.as_str()).chain(TURTLE.iter().map(|(name, ..)| *name)).collect()
}

/// The comments that stand behind something on a line of the span, from their `//` to the end of
/// the line.
fn comments(text: &str, span: Span) -> impl Iterator<Item = Span> {
    let range = span.range();
    let start = text.get(..range.start).and_then(|t| t.rfind('\n')).map_or(0, |i| i + 1);
    // The last word's comment stands behind the span.
    let end = text.get(range.end..).and_then(|t| t.find('\n')).map_or(text.len(), |i| range.end + i);
    let mut at = start;
    let lines = text.get(start..end).unwrap_or("").split('\n');
    lines.filter_map(move |line| {
        let begin = at;
        at += line.len() + 1;
        let slashes = comment_start(line)?;
        let behind_something = !line[..slashes].trim().is_empty();
        let end = begin + line.trim_end().len();
        behind_something.then(|| Span::new(begin + slashes, end))
    })
}

/// Where `//` begins outside of a string.
fn comment_start(line: &str) -> Option<usize> {
    let mut quoted = false;
    let bytes = line.as_bytes();
    (0..bytes.len()).find(|&i| {
        quoted ^= bytes[i] == b'"';
        !quoted && bytes[i] == b'/' && bytes.get(i + 1) == Some(&b'/')
    })
}

fn check(text: &str, comment: Span, symbols: &HashSet<&str>) -> Option<Diagnostic> {
    let words = text.get(comment.range())?.trim_start_matches('/');
    let message = if words.trim().is_empty() {
        "this begins an empty comment"
    } else if words.split_whitespace().all(|w| symbols.contains(w)) {
        "this begins a comment that reads like a word"
    } else {
        return None;
    };
    let warning = Diagnostic::warning(code::COMMENT, comment, message);
    Some(warning.hint("two rolls of the turtle need a space between them: `/ /`"))
}
