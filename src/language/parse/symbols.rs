//! The symbols of a system, known before its rules are read.

use super::brackets::Token;
use super::{Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code, nearest};
use crate::language::lex::{Bracket, Keyword, excerpt};
use crate::language::syntax::{Kind, Name};
use std::collections::HashSet;

/// The turtle symbols that are names; the others are operators.
const TURTLE_NAMES: [&str; 2] = ["F", "f"];

/// What other languages have before a condition.
const BEFORE_CONDITIONS: [&str; 3] = ["if", "when", "where"];

/// Among more symbols than these no near name is looked for.
const MOST_COMPARED: usize = 1000;

#[derive(Debug, Default)]
pub(super) struct Symbols<'t> {
    /// From `module` lines.
    pub declared: HashSet<&'t str>,
    /// Whether the turtle symbols are there too.
    pub turtle: bool,
}

impl Symbols<'_> {
    pub fn contains(&self, text: &str) -> bool {
        self.declared.contains(text) || self.turtle && TURTLE_NAMES.contains(&text)
    }
}

/// A token that is a symbol without being a name.
pub(super) fn is_operator_symbol(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::Plus
            | TokenKind::Minus
            | TokenKind::And
            | TokenKind::Caret
            | TokenKind::Slash
            | TokenKind::Backslash
            | TokenKind::Bar
            | TokenKind::Bang
    )
}

impl<'t> Parser<'t> {
    /// Collects what the `module` lines from here to the next system declare.
    pub(super) fn collect_symbols(&mut self) {
        let mut symbols = Symbols { turtle: self.kind != Kind::Mesh, ..Symbols::default() };
        let mut at = self.at;
        loop {
            match self.token_at(at).kind {
                TokenKind::End | TokenKind::Keyword(Keyword::System) => break,
                TokenKind::Keyword(Keyword::Module) => at = self.collect_line(at + 1, &mut symbols),
                _ => at += 1,
            }
        }
        self.symbols = symbols;
        self.undeclared.clear();
    }

    /// One `module` line, from behind the keyword; returns the place behind it.
    fn collect_line(&self, mut at: usize, symbols: &mut Symbols<'t>) -> usize {
        loop {
            let token = self.token_at(at);
            if token.kind != TokenKind::Name && !is_operator_symbol(token.kind) {
                return at;
            }
            symbols.declared.insert(self.text_of(token));
            at += 1;
            if self.token_at(at).kind == TokenKind::Open(Bracket::Round) {
                at = self.token_at(at).partner as usize + 1;
            }
            if self.token_at(at).kind != TokenKind::Comma {
                return at;
            }
            at += 1;
        }
    }

    /// Whether the token is a symbol of this system.
    pub(super) fn is_symbol(&self, token: Token) -> bool {
        match token.kind {
            TokenKind::Name => self.symbols.contains(self.text_of(token)),
            kind if is_operator_symbol(kind) => {
                self.symbols.turtle || self.symbols.declared.contains(self.text_of(token))
            }
            _ => false,
        }
    }

    /// A turtle symbol that the system does not declare for itself.
    pub(super) fn is_turtle_symbol(&self, token: Token) -> bool {
        let text = self.text_of(token);
        (is_operator_symbol(token.kind) || TURTLE_NAMES.contains(&text))
            && !self.symbols.declared.contains(text)
    }

    /// A symbol in a word or pattern. One that is not declared is reported once a system and then
    /// taken for a symbol.
    pub(super) fn symbol(&mut self, what: &str) -> super::Parse<Name> {
        let token = self.token();
        if self.is_symbol(token) || is_operator_symbol(token.kind) || token.kind == TokenKind::Name {
            if !self.is_symbol(token) {
                self.undeclared(token);
                if BEFORE_CONDITIONS.contains(&self.text_of(token)) {
                    // What follows is a condition, and no symbols.
                    return Err(super::Stop);
                }
            }
            self.bump();
            return Ok(Name { text: self.text_of(token).to_owned(), span: token.span });
        }
        if token.kind == TokenKind::Keyword(Keyword::Eps) {
            let error =
                Diagnostic::error(code::MISPLACED_EPS, token.span, format!("expected {what}, found `eps`"))
                    .hint("`eps` stands only in a successor, a block, a slot or an axiom");
            return self.stop(error);
        }
        self.name(what)
    }

    fn undeclared(&mut self, token: Token) {
        let text = self.text_of(token);
        if self.silent {
            self.failed = true;
        } else if self.undeclared.insert(text) {
            let message = format!("no module `{}` is declared", excerpt(text));
            // The search for a near name takes time, so it is made only for what is listed.
            let hint = if self.findings.is_full() { String::new() } else { self.undeclared_hint(text) };
            self.report(Diagnostic::error(code::UNDECLARED_SYMBOL, token.span, message).hint(hint));
        }
    }

    fn undeclared_hint(&self, text: &str) -> String {
        if let Some(spaced) = self.spaced(text) {
            return format!("symbols need spaces between them: write `{spaced}`");
        }
        if BEFORE_CONDITIONS.contains(&text) {
            return "write the condition behind `:`, before `->`".into();
        }
        if self.peek_at(1) == TokenKind::Colon && self.begins_line() {
            return "declare it, or, if it is a label, let a predecessor of declared modules follow".into();
        }
        if self.symbols.declared.len() > MOST_COMPARED {
            return format!("declare it: `module {}`", excerpt(text));
        }
        let turtle = TURTLE_NAMES.iter().filter(|_| self.symbols.turtle);
        match nearest(text, self.symbols.declared.iter().chain(turtle).copied()) {
            Some(name) => format!("did you mean `{name}`?"),
            None => format!("declare it: `module {}`", excerpt(text)),
        }
    }

    fn begins_line(&self) -> bool {
        self.at.checked_sub(1).is_some_and(|before| self.tokens[before].kind == TokenKind::Newline)
    }

    /// `C F C` for `CFC`, if each letter is a symbol.
    pub(super) fn spaced(&self, text: &str) -> Option<String> {
        let fits = (2..=40).contains(&text.len())
            && text.char_indices().all(|(i, c)| self.symbols.contains(&text[i..i + c.len_utf8()]));
        fits.then(|| text.chars().map(String::from).collect::<Vec<_>>().join(" "))
    }
}
