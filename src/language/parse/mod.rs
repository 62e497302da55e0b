//! From text to the syntax tree.
//!
//! The parser is recursive descent over paired brackets. Errors are recovered at
//! the end of the statement, so that one run finds several; whatever the text, it ends in time
//! linear in its length and never nests deeper than [`MAX_DEPTH`].
//!
//! It knows which symbols a system declares, because the grammar needs that: labels, blocks and
//! words are told apart by it. All that needs types or the meaning of names is the checker's.

mod brackets;
mod expr;
mod foreign;
mod habits;
mod item;
mod lines;
mod rule;
mod run;
mod symbols;
mod system;
mod word;

use self::brackets::Token;
use self::symbols::Symbols;
use super::diagnostic::{Diagnostic, Severity, code};
use super::lex::{self, Bracket, Findings, Keyword, TokenKind, excerpt};
use super::syntax::{Kind, Name, Number, RuleFile, Span, Text};
use std::collections::HashSet;

pub use super::lex::decode;

/// Brackets, blocks, branches, expressions and steps nest at most so deep.
pub const MAX_DEPTH: u32 = 256;
/// The most rules of one system.
pub const MAX_RULES: usize = 4096;

/// What was read, and what is wrong with it.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// All that could be read; whole only if there are no errors.
    pub file: RuleFile,
    /// In the order of the text. Mind that some may be warnings.
    pub diagnostics: Vec<Diagnostic>,
}

impl Parsed {
    /// Whether something could not be read. If not, the tree is whole.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity == Severity::Error)
    }
}

/// Parses the text of a rule file.
pub fn parse(text: &str) -> Parsed {
    let mut findings = Findings::default();
    if u32::try_from(text.len()).is_err() {
        let message = "the file is longer than 4 GiB";
        findings.push(Diagnostic::error(code::TOO_LONG, Span::default(), message));
        return Parsed {
            file: RuleFile { version: None, items: Vec::new() },
            diagnostics: findings.finish(),
        };
    }
    if lex::is_binary(text.as_bytes()) {
        let file = RuleFile { version: None, items: Vec::new() };
        return Parsed { file, diagnostics: vec![lex::binary()] };
    }
    let raw = lex::lex(text, &mut findings);
    let tokens = brackets::pair(&raw, text, &mut findings);
    drop(raw);
    let mut parser = Parser {
        text,
        tokens,
        at: 0,
        depth: 0,
        findings,
        silent: false,
        failed: false,
        kind: Kind::Curve,
        symbols: Symbols::default(),
        undeclared: HashSet::new(),
        systems: HashSet::new(),
        rule_count: 0,
        rule_before: None,
        in_rules: false,
        told: HashSet::new(),
        foreign: foreign::Foreign::default(),
    };
    let file = parser.file();
    if let Some(finding) = parser.no_rule_file() {
        return Parsed { file: RuleFile { version: None, items: Vec::new() }, diagnostics: vec![finding] };
    }
    Parsed { file, diagnostics: parser.findings.finish() }
}

/// The statement cannot be read on; its error has been reported.
#[derive(Debug)]
struct Stop;

type Parse<T> = Result<T, Stop>;

struct Parser<'t> {
    text: &'t str,
    tokens: Vec<Token>,
    at: usize,
    depth: u32,
    findings: Findings,
    /// Trying out: nothing is reported, but `failed` is set.
    silent: bool,
    failed: bool,
    /// Of the system at hand, as are the following two.
    kind: Kind,
    symbols: Symbols<'t>,
    /// Those already reported.
    undeclared: HashSet<&'t str>,
    /// Names of the systems so far.
    systems: HashSet<&'t str>,
    /// Rules of the system so far.
    rule_count: usize,
    /// The last token of the rule before the statement at hand.
    rule_before: Option<Span>,
    /// Under `rules:`.
    in_rules: bool,
    /// Habits that have been told of.
    told: HashSet<String>,
    foreign: foreign::Foreign,
}

impl<'t> Parser<'t> {
    fn token_at(&self, at: usize) -> Token {
        // The last token is the end of the file, and nothing comes after it.
        self.tokens[at.min(self.tokens.len() - 1)]
    }

    fn token(&self) -> Token {
        self.token_at(self.at)
    }

    fn peek(&self) -> TokenKind {
        self.token().kind
    }

    fn peek_at(&self, ahead: usize) -> TokenKind {
        self.token_at(self.at + ahead).kind
    }

    fn bump(&mut self) -> Token {
        let token = self.token();
        if token.kind != TokenKind::End {
            self.at += 1;
        }
        token
    }

    fn text_of(&self, token: Token) -> &'t str {
        &self.text[token.span.range()]
    }

    /// From `start` to the last token read.
    fn span_from(&self, start: Span) -> Span {
        match self.at.checked_sub(1) {
            Some(last) if self.tokens[last].span.end >= start.start => start.to(self.tokens[last].span),
            _ => start,
        }
    }

    fn take(&mut self, kind: TokenKind) -> bool {
        let found = self.peek() == kind;
        if found {
            self.bump();
        }
        found
    }

    fn take_keyword(&mut self, keyword: Keyword) -> bool {
        self.take(TokenKind::Keyword(keyword))
    }

    /// A word that means something only here, and may be a name elsewhere.
    fn is_word(&self, word: &str) -> bool {
        self.peek() == TokenKind::Name && self.text_of(self.token()) == word
    }

    fn take_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.bump();
        }
        found
    }

    fn open(&self, bracket: Bracket) -> bool {
        self.peek() == TokenKind::Open(bracket)
    }

    fn take_open(&mut self, bracket: Bracket) -> bool {
        self.take(TokenKind::Open(bracket))
    }

    fn at_end_of_statement(&self) -> bool {
        matches!(self.peek(), TokenKind::Newline | TokenKind::End | TokenKind::Close(Bracket::Curly))
    }

    fn skip_newlines(&mut self) {
        while self.take(TokenKind::Newline) {}
    }

    // Errors.

    fn report(&mut self, diagnostic: Diagnostic) {
        self.failed = true;
        if !self.silent && !self.token().suspect && !self.is_foreign_name(diagnostic.span) {
            self.findings.push(diagnostic);
        }
    }

    /// A name that is none, by its letters, was reported when it was read: nothing more is to be said of it.
    fn is_foreign_name(&self, span: Span) -> bool {
        let token = self.token();
        token.kind == TokenKind::Name && token.span == span && !self.text_of(token).is_ascii()
    }

    fn stop<T>(&mut self, diagnostic: Diagnostic) -> Parse<T> {
        self.report(diagnostic);
        Err(Stop)
    }

    /// What stands here, for a message.
    fn found(&self) -> String {
        let token = self.token();
        match token.kind {
            TokenKind::Newline => "the end of the line".into(),
            TokenKind::End => "the end of the file".into(),
            TokenKind::Keyword(keyword) => format!("the keyword `{}`", keyword.text()),
            _ => format!("`{}`", excerpt(self.text_of(token))),
        }
    }

    /// `expected {what}, found …`.
    fn unexpected(&self, what: &str) -> Diagnostic {
        let message = format!("expected {what}, found {}", self.found());
        Diagnostic::error(code::UNEXPECTED, self.token().span, message)
    }

    fn expect(&mut self, kind: TokenKind, what: &str) -> Parse<Token> {
        if self.peek() == kind {
            return Ok(self.bump());
        }
        let error = self.unexpected(what);
        self.stop(error)
    }

    fn close(&mut self, bracket: Bracket) -> Parse<Token> {
        self.expect(TokenKind::Close(bracket), &format!("`{}`", bracket.close()))
    }

    /// The `:` of a section. Without it the section is read nevertheless: its lines would make no
    /// sense elsewhere.
    fn section_colon(&mut self) -> Parse<()> {
        if self.peek() == TokenKind::Newline {
            let error = self.unexpected("`:`");
            self.report(error);
            return Ok(());
        }
        self.expect(TokenKind::Colon, "`:`")?;
        Ok(())
    }

    fn expect_word(&mut self, word: &str) -> Parse<()> {
        if self.take_word(word) {
            return Ok(());
        }
        let error = self.unexpected(&format!("`{word}`"));
        self.stop(error)
    }

    /// The end of the statement, and the newlines behind it.
    fn end_of_statement(&mut self) -> Parse<()> {
        if !self.at_end_of_statement() {
            let error = self.behind_statement().unwrap_or_else(|| self.unexpected("the end of the line"));
            return self.stop(error);
        }
        self.skip_newlines();
        Ok(())
    }

    /// Goes to the end of a statement that began at bracket level `level`.
    fn recover(&mut self, level: u32) {
        loop {
            let token = self.token();
            let ends = token.kind == TokenKind::Newline && token.level == level;
            if ends || token.kind == TokenKind::End || token.level < level {
                break;
            }
            self.at += 1;
        }
        self.skip_newlines();
    }

    /// Reads a statement; if it fails, goes to its end.
    fn statement<T>(&mut self, read: impl FnOnce(&mut Self) -> Parse<T>) -> Option<T> {
        let level = self.token().level;
        let depth = self.depth;
        match read(self) {
            Ok(value) => Some(value),
            Err(Stop) => {
                self.depth = depth;
                self.recover(level);
                None
            }
        }
    }

    /// Tries to read without reporting; the place stays where it was.
    fn try_out(&mut self, read: impl FnOnce(&mut Self) -> Parse<()>) -> bool {
        let (at, depth, silent) = (self.at, self.depth, self.silent);
        let failed = std::mem::replace(&mut self.failed, false);
        self.silent = true;
        let fits = read(self).is_ok() && !self.failed;
        (self.at, self.depth, self.silent, self.failed) = (at, depth, silent, failed);
        fits
    }

    /// Reads something that may hold its like.
    fn nested<T>(&mut self, read: impl FnOnce(&mut Self) -> Parse<T>) -> Parse<T> {
        if self.depth >= MAX_DEPTH {
            let error = self.too_deep(self.token().span);
            return self.stop(error);
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }

    fn too_deep(&self, span: Span) -> Diagnostic {
        Diagnostic::error(code::TOO_DEEP, span, format!("nested deeper than {MAX_DEPTH}"))
    }

    // Words of the language that occur everywhere.

    /// A name; `what` says whose, for the message.
    fn name(&mut self, what: &str) -> Parse<Name> {
        let token = self.token();
        match token.kind {
            TokenKind::Name => {
                self.bump();
                Ok(Name { text: self.text_of(token).to_owned(), span: token.span })
            }
            TokenKind::Keyword(keyword) => {
                let message = format!("`{}` is a keyword and cannot be {what}", keyword.text());
                let error =
                    Diagnostic::error(code::KEYWORD_AS_NAME, token.span, message).hint("choose another name");
                self.stop(error)
            }
            _ => {
                let error = self.unexpected(what);
                self.stop(error)
            }
        }
    }

    fn number(&mut self, what: &str) -> Parse<Number> {
        let token = self.expect(TokenKind::Number, what)?;
        Ok(Number { text: self.text_of(token).to_owned(), span: token.span })
    }

    /// A numeral without point and exponent.
    fn whole(&mut self, what: &str) -> Parse<Number> {
        let token = self.token();
        if token.kind == TokenKind::Number && !self.text_of(token).bytes().all(|b| b.is_ascii_digit()) {
            let error = self.unexpected(what);
            return self.stop(error);
        }
        self.number(what)
    }

    fn string(&mut self, what: &str) -> Parse<Text> {
        let token = self.expect(TokenKind::Text, what)?;
        let text = self.text_of(token);
        let text = text.strip_prefix('"').unwrap_or(text);
        Ok(Text { text: text.strip_suffix('"').unwrap_or(text).to_owned(), span: token.span })
    }

    /// One or more, with commas between.
    fn list<T>(&mut self, mut read: impl FnMut(&mut Self) -> Parse<T>) -> Parse<Vec<T>> {
        let mut list = vec![read(self)?];
        while self.take(TokenKind::Comma) {
            list.push(read(self)?);
        }
        Ok(list)
    }

    /// None or more in round brackets, the opening one being read; with commas between.
    fn bracketed<T>(&mut self, read: impl FnMut(&mut Self) -> Parse<T>) -> Parse<Vec<T>> {
        if self.take(TokenKind::Close(Bracket::Round)) {
            return Ok(Vec::new());
        }
        let list = self.list(read)?;
        if self.peek() != TokenKind::Close(Bracket::Round) {
            let error = self.unexpected("`,` or `)`");
            return self.stop(error);
        }
        self.bump();
        Ok(list)
    }
}
