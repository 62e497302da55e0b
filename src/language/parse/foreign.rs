//! Files that are plainly no rule files: prose, markup, data of another format.

use super::brackets::Token;
use super::{Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code};
use crate::language::lex::Keyword;
use crate::language::syntax::Span;

/// What stands outside of systems.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Foreign {
    /// The first statement that is none.
    first: Option<Span>,
    /// Lines that read as prose or data, before the first system.
    prose: usize,
    /// Something of the language has been met.
    known: bool,
    /// A system has begun.
    system: bool,
}

/// So many lines of prose before the first system are no slip.
const PROSE: usize = 3;

impl Parser<'_> {
    /// Looks at a statement outside of systems, which begins with token `start` and ends before the one at hand.
    pub(super) fn survey(&mut self, start: usize) {
        let (token, last) = (self.tokens[start], self.tokens[self.at.saturating_sub(1).max(start)]);
        match token.kind {
            TokenKind::Keyword(keyword) if keyword.begins_item() => {
                self.foreign.known = true;
                self.foreign.system |= keyword == Keyword::System;
            }
            _ if self.foreign.system => {}
            TokenKind::Name if self.is_nearly_known(token) => self.foreign.known = true,
            TokenKind::End => {}
            kind => {
                self.foreign.first.get_or_insert(token.span);
                // `#` may be meant as a comment. A bracket that is never closed takes many lines with it.
                let lines = self.text[token.span.start as usize..last.span.end as usize].lines();
                let lines = lines.filter(|line| !line.trim().is_empty());
                self.foreign.prose += if is_prose(kind) { lines.count() } else { 0 };
            }
        }
    }

    /// A word that a file of rules may begin with, or a slip of one.
    fn is_nearly_known(&self, token: Token) -> bool {
        let text = self.text_of(token);
        text == "burgeon" || self.nearest_item(text).is_some()
    }

    /// That the file is none of rules, instead of an error for each of its lines.
    pub(super) fn no_rule_file(&self) -> Option<Diagnostic> {
        let Foreign { first, prose, known, system } = self.foreign;
        let first = first.filter(|_| if system { prose >= PROSE } else { !known })?;
        self.findings.any_error().then(|| {
            Diagnostic::error(code::NO_RULE_FILE, first, "this is no rule file")
                .hint("a rule file has systems in it, which begin so: `system name : curve`")
        })
    }
}

fn is_prose(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Name | TokenKind::Number | TokenKind::Less | TokenKind::Bang)
        || matches!(kind, TokenKind::Star | TokenKind::Minus | TokenKind::Keyword(_))
}
