//! Pairs the brackets and drops the newlines that end no statement.
//!
//! All brackets of the result are paired: a bracket that is never closed is reported at its
//! opening and closed where its statement probably ends, and one that closes nothing is reported
//! and left out. So the parser behind it can skip a bracket in one step and one slip does not
//! swallow the rest of the file.

use super::lines::{Statement, continues};
use crate::language::diagnostic::{Diagnostic, code};
use crate::language::lex::{Bracket, Findings, Keyword, Token as RawToken, TokenKind};
use crate::language::syntax::Span;

#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub kind: TokenKind,
    pub span: Span,
    /// How many brackets stand around it; a bracket counts as outside of itself.
    pub level: u32,
    /// An opening bracket's closing one; else the token itself.
    pub partner: u32,
    /// An opening bracket with `;` or `|` at its own level.
    pub separated: bool,
    /// An opening bracket with `,` at its own level.
    pub commas: bool,
    /// Inside a bracket that was never closed: what is wrong here follows from that.
    pub suspect: bool,
}

/// Pairs the brackets of `raw`, which ends with [`TokenKind::End`].
pub(super) fn pair(raw: &[RawToken], text: &str, findings: &mut Findings) -> Vec<Token> {
    let mut matching = Matching {
        raw,
        findings,
        open: Vec::new(),
        counts: [0; 3],
        last_break: 0,
        repairs: Vec::new(),
        strays: Vec::new(),
        semicolons: false,
    };
    matching.run();
    let Matching { mut repairs, mut strays, .. } = matching;
    // Where two close at one place, the inner one goes first.
    repairs.sort_by_key(|r| (r.at, std::cmp::Reverse(r.opening)));
    strays.sort_unstable();
    assemble(raw, text, &repairs, &strays)
}

/// A closing bracket to be put in front of token `at`.
struct Repair {
    opening: usize,
    at: usize,
    bracket: Bracket,
}

struct Matching<'a> {
    raw: &'a [RawToken],
    findings: &'a mut Findings,
    open: Vec<(usize, Bracket)>,
    /// How many of each kind of bracket are open.
    counts: [usize; 3],
    /// The last place where a statement may have ended, such that no bracket reaches over it that
    /// has been closed since.
    last_break: usize,
    repairs: Vec<Repair>,
    strays: Vec<usize>,
    /// One at the end of a statement has been reported.
    semicolons: bool,
}

impl Matching<'_> {
    fn run(&mut self) {
        for at in 0..self.raw.len() {
            match self.raw[at].kind {
                TokenKind::Open(bracket) => {
                    self.open.push((at, bracket));
                    self.counts[bracket as usize] += 1;
                }
                TokenKind::Close(bracket) => self.close(at, bracket),
                TokenKind::Semicolon if self.open.is_empty() && self.ends_line(at) => self.semicolon(at),
                TokenKind::Arrow | TokenKind::End => self.abandon(at, 0),
                TokenKind::Keyword(keyword) if keyword.begins_item() && self.begins_line(at) => {
                    let keep = if keyword == Keyword::Place { self.inner_braces(at) } else { 0 };
                    self.abandon(at, keep);
                }
                TokenKind::Newline if !continues(self.raw[at + 1].kind) => self.last_break = at,
                _ => {}
            }
        }
    }

    fn ends_line(&self, at: usize) -> bool {
        let next = self.raw.get(at + 1).map_or(TokenKind::End, |token| token.kind);
        !self.begins_line(at) && matches!(next, TokenKind::Newline | TokenKind::End)
    }

    /// `;` at the end of a statement: the first is reported, all are left out.
    fn semicolon(&mut self, at: usize) {
        if !std::mem::replace(&mut self.semicolons, true) {
            let message = "a statement ends with its line, not with `;`";
            let error = Diagnostic::error(code::UNEXPECTED, self.raw[at].span, message);
            self.findings.push(error.hint("leave `;` out, here and in the lines below"));
        }
        self.strays.push(at);
    }

    fn begins_line(&self, at: usize) -> bool {
        at == 0 || self.raw[at - 1].kind == TokenKind::Newline
    }

    /// `place x` is a step too and may stand inside the braces of a step, unless it declares.
    fn inner_braces(&self, at: usize) -> usize {
        let declares = self
            .raw
            .get(at + 2)
            .is_some_and(|t| matches!(t.kind, TokenKind::Equal | TokenKind::Keyword(Keyword::On)));
        if declares {
            return 0;
        }
        self.open.iter().rposition(|(_, b)| *b == Bracket::Curly).map_or(0, |i| i + 1)
    }

    fn close(&mut self, at: usize, bracket: Bracket) {
        if self.counts[bracket as usize] == 0 {
            let span = self.raw[at].span;
            let message = format!("`{}` closes nothing", bracket.close());
            self.findings.push(Diagnostic::error(code::STRAY_BRACKET, span, message));
            self.strays.push(at);
            return;
        }
        let matched = self.open.iter().rposition(|(_, b)| *b == bracket).unwrap_or(0);
        self.abandon(at, matched + 1);
        if let Some((opening, bracket)) = self.open.pop() {
            self.counts[bracket as usize] -= 1;
            if opening < self.last_break {
                self.last_break = at + 1;
            }
        }
    }

    /// Gives up all open brackets but the outer `keep`, because of token `at`.
    fn abandon(&mut self, at: usize, keep: usize) {
        if self.open.len() > keep {
            self.report(at);
        }
        while self.open.len() > keep {
            let Some((opening, bracket)) = self.open.pop() else { return };
            self.counts[bracket as usize] -= 1;
            let end = if opening < self.last_break { self.last_break } else { at };
            self.repairs.push(Repair { opening, at: end, bracket });
        }
    }

    /// Of several that are given up at one place, the innermost is reported.
    fn report(&mut self, at: usize) {
        let Some(&(opening, bracket)) = self.open.last() else { return };
        let message = format!("`{}` is never closed", bracket.open());
        let mut error = Diagnostic::error(code::UNCLOSED_BRACKET, self.raw[opening].span, message)
            .hint(format!("write `{}`", bracket.close()));
        if self.raw[at].kind != TokenKind::End {
            error = error.label(self.raw[at].span, format!("`{}` is missing before this", bracket.close()));
        }
        self.findings.push(error);
    }
}

struct Frame {
    opening: usize,
    bracket: Bracket,
    suspect: bool,
}

/// Builds the final list: repairs put in, strays and needless newlines left out.
fn assemble(raw: &[RawToken], text: &str, repairs: &[Repair], strays: &[usize]) -> Vec<Token> {
    let mut unclosed: Vec<usize> = repairs.iter().map(|r| r.opening).collect();
    unclosed.sort_unstable();
    let mut assembly = Assembly { tokens: Vec::with_capacity(raw.len()), frames: Vec::new(), suspects: 0 };
    let mut statement = Statement::default();
    let (mut repairs, mut strays, mut unclosed) =
        (repairs.iter().peekable(), strays.iter().peekable(), unclosed.iter().peekable());
    // The next token may seem wrong only because of a bracket that was put in or left out.
    let mut repaired = false;
    for (at, token) in raw.iter().enumerate() {
        while let Some(repair) = repairs.next_if(|r| r.at == at) {
            // At the end of what stands before it.
            let end = assembly.tokens.last().map_or(0, |t| t.span.end as usize).min(text.len());
            assembly.add(TokenKind::Close(repair.bracket), Span::new(end, end), false);
            repaired = true;
        }
        if strays.next_if(|s| **s == at).is_some() {
            repaired = true;
            continue;
        }
        let next = raw.get(at + 1).map_or(TokenKind::End, |t| t.kind);
        if token.kind == TokenKind::Newline {
            let goes_on = || continues(next) || statement.goes_on(raw, text, at, !assembly.frames.is_empty());
            if assembly.inside_line() || goes_on() {
                continue;
            }
            statement = Statement::default();
        } else if !assembly.inside_line() {
            statement.add(at, token.kind);
        }
        let suspect = unclosed.next_if(|u| **u == at).is_some();
        assembly.add(token.kind, token.span, suspect);
        if let Some(last) = assembly.tokens.last_mut() {
            last.suspect |= std::mem::take(&mut repaired);
        }
    }
    assembly.tokens
}

struct Assembly {
    tokens: Vec<Token>,
    frames: Vec<Frame>,
    /// How many of the frames are brackets that were never closed.
    suspects: usize,
}

impl Assembly {
    /// Inside ( ) or [ ] a newline ends nothing.
    fn inside_line(&self) -> bool {
        self.frames.last().is_some_and(|f| f.bracket != Bracket::Curly)
    }

    fn add(&mut self, kind: TokenKind, span: Span, unclosed: bool) {
        let at = self.tokens.len();
        if let TokenKind::Close(_) = kind
            && let Some(frame) = self.frames.pop()
        {
            self.tokens[frame.opening].partner = at as u32;
            self.suspects -= usize::from(frame.suspect);
        }
        if let Some(frame) = self.frames.last() {
            let opening = &mut self.tokens[frame.opening];
            opening.separated |= matches!(kind, TokenKind::Semicolon | TokenKind::Bar);
            opening.commas |= kind == TokenKind::Comma;
        }
        self.tokens.push(Token {
            kind,
            span,
            level: self.frames.len() as u32,
            partner: at as u32,
            separated: false,
            commas: false,
            suspect: self.suspects > 0 || unclosed,
        });
        if let TokenKind::Open(bracket) = kind {
            self.suspects += usize::from(unclosed);
            self.frames.push(Frame { opening: at, bracket, suspect: unclosed });
        }
    }
}
