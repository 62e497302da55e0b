//! Which lines go on in the next one.
//!
//! A statement ends with its line unless the line that follows cannot be meant otherwise: what ends a line is an
//! operator of an expression, what begins one can begin no statement, or a word goes on in a line that is indented
//! deeper than its statement and is no rule.

use super::symbols::is_operator_symbol;
use crate::language::lex::{Bracket, Keyword, Token, TokenKind};

/// What of a statement has been read, where no bracket is open.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Statement {
    /// Its first token.
    first: Option<usize>,
    arrow: bool,
    /// `:` or `let`, so that an expression follows.
    value: bool,
}

impl Statement {
    /// Adds token `at`, which stands in no bracket.
    pub fn add(&mut self, at: usize, kind: TokenKind) {
        self.first.get_or_insert(at);
        self.arrow |= kind == TokenKind::Arrow;
        self.value |= matches!(kind, TokenKind::Colon | TokenKind::Keyword(Keyword::Let));
    }

    /// Whether it goes on behind the newline that is token `at`, in braces or not.
    pub fn goes_on(&self, raw: &[Token], text: &str, at: usize, braces: bool) -> bool {
        let (Some(first), Some(last)) = (self.first, at.checked_sub(1)) else { return false };
        let next = kind(raw, at + 1);
        match next {
            TokenKind::End => return false,
            TokenKind::Keyword(keyword) if keyword.begins_item() => return false,
            _ if raw[last].kind == TokenKind::Comma => return true,
            _ => {}
        }
        if self.arrow {
            let unfinished = raw[last].kind == TokenKind::Arrow || ends_with_weight(raw, last);
            return (unfinished || is_deeper(raw, text, first, at + 1)) && is_word(raw, at + 1);
        }
        let declares = match raw[first].kind {
            TokenKind::Keyword(Keyword::Const | Keyword::Param | Keyword::Query | Keyword::Place) => true,
            TokenKind::Keyword(Keyword::Axiom) => {
                return is_deeper(raw, text, first, at + 1) && is_word(raw, at + 1);
            }
            TokenKind::Keyword(_) => return false,
            _ => false,
        };
        let step = super::run::is_step(&text[raw[first].span.range()]);
        if never_ends(raw[last].kind) || never_begins(raw, at + 1) {
            return true;
        }
        // In braces `:` gives a slot its module.
        let value = declares || step || self.value && !braces;
        let range =
            raw[first].kind == TokenKind::Keyword(Keyword::Param) && &text[raw[at + 1].span.range()] == "in";
        range || value && is_sign(raw[last].kind) || declares && is_sign(next)
    }
}

fn kind(raw: &[Token], at: usize) -> TokenKind {
    raw.get(at).map_or(TokenKind::End, |token| token.kind)
}

/// A line that begins so goes on with the statement before it, whatever that is.
pub(super) fn continues(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::Keyword(Keyword::Let | Keyword::At | Keyword::On | Keyword::With)
            | TokenKind::Colon
            | TokenKind::Arrow
            | TokenKind::Equal
            | TokenKind::Open(Bracket::Curly)
    )
}

/// What is no symbol, and ends neither an expression nor a word.
fn never_ends(kind: TokenKind) -> bool {
    let others = [TokenKind::Less, TokenKind::Greater, TokenKind::Equal, TokenKind::DotDot];
    others.contains(&kind) || kind == TokenKind::Keyword(Keyword::With) || is_comparison_or_product(kind)
}

/// The same at the beginning of a line: no rule begins with them.
fn never_begins(raw: &[Token], at: usize) -> bool {
    let (this, next) = (kind(raw, at), kind(raw, at + 1));
    let touch = || raw[at].span.end == raw[at + 1].span.start;
    let doubled = matches!(this, TokenKind::And | TokenKind::Bar) && this == next && touch();
    doubled || this == TokenKind::DotDot || is_comparison_or_product(this)
}

fn is_comparison_or_product(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::Star
            | TokenKind::Percent
            | TokenKind::LessEqual
            | TokenKind::GreaterEqual
            | TokenKind::EqualEqual
            | TokenKind::NotEqual
    )
}

/// Operators of expressions that are symbols of words, too.
fn is_sign(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::Plus
            | TokenKind::Minus
            | TokenKind::Slash
            | TokenKind::And
            | TokenKind::Bar
            | TokenKind::Less
            | TokenKind::Greater
    )
}

/// `->(…)` at the end of a line.
fn ends_with_weight(raw: &[Token], last: usize) -> bool {
    if raw[last].kind != TokenKind::Close(Bracket::Round) {
        return false;
    }
    let mut depth = 0usize;
    for at in (0..=last).rev() {
        match raw[at].kind {
            TokenKind::Close(_) => depth += 1,
            TokenKind::Open(_) => depth -= 1,
            TokenKind::Newline => return false,
            _ => {}
        }
        if depth == 0 {
            return at > 0 && raw[at - 1].kind == TokenKind::Arrow;
        }
    }
    false
}

/// Whether the line of token `next` is indented deeper than that of token `first`.
fn is_deeper(raw: &[Token], text: &str, first: usize, next: usize) -> bool {
    let indent = |at: usize| {
        let before = &text[..raw[at].span.start as usize];
        let line = &before[before.rfind(['\n', '\r']).map_or(0, |end| end + 1)..];
        &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
    };
    let (outer, inner) = (indent(first), indent(next));
    inner.len() > outer.len() && inner.starts_with(outer)
}

/// Whether the statement that begins at token `at` would be a word and nothing else: modules and brackets, without
/// an arrow but that of a further alternative.
fn is_word(raw: &[Token], at: usize) -> bool {
    // A bracket that is never closed must not lead to the end of the file from every line.
    const MOST_LINES: usize = 64;
    let (mut depth, mut lines) = (0usize, 0);
    for (at, token) in raw.iter().enumerate().skip(at) {
        match token.kind {
            TokenKind::End => return true,
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) if depth == 0 => return true,
            TokenKind::Close(_) => depth -= 1,
            TokenKind::Arrow => return false,
            TokenKind::Newline if depth > 0 && lines == MOST_LINES => return false,
            TokenKind::Newline if depth > 0 => lines += 1,
            _ if depth > 0 => {}
            TokenKind::Newline => match kind(raw, at + 1) {
                TokenKind::Keyword(Keyword::At | Keyword::On) | TokenKind::Open(Bracket::Curly) => {}
                TokenKind::Arrow => return kind(raw, at + 2) == TokenKind::Open(Bracket::Round),
                next => return !continues(next),
            },
            TokenKind::Name | TokenKind::Keyword(Keyword::Eps | Keyword::At | Keyword::On) => {}
            kind if is_operator_symbol(kind) => {}
            _ => return false,
        }
    }
    true
}
