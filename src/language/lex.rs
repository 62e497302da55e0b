//! From text to tokens.
//!
//! The lexer knows characters only. Which newline ends a statement depends on the brackets around
//! it and is settled behind it, in `parse::brackets`.

use super::diagnostic::{Diagnostic, Severity, code};
use super::syntax::Span;

/// How many errors of one file are listed; after that the rest is noise.
pub const MAX_ERRORS: usize = 100;

/// Collects the errors of a file, up to [`MAX_ERRORS`].
#[derive(Debug, Default)]
pub(crate) struct Findings {
    list: Vec<Diagnostic>,
    /// Where the first error stood that was no longer listed.
    overflow: Option<Span>,
}

impl Findings {
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.list.len() < MAX_ERRORS {
            self.list.push(diagnostic);
        } else if self.overflow.is_none() {
            self.overflow = Some(diagnostic.span);
        }
    }

    pub fn any_error(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }

    pub fn is_full(&self) -> bool {
        self.list.len() >= MAX_ERRORS
    }

    /// All findings in the order of the text.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        self.list.sort_by_key(|d| d.span.start);
        if let Some(span) = self.overflow {
            let message = format!("more than {MAX_ERRORS} errors; the rest is not listed");
            self.list.push(Diagnostic::error(code::TOO_MANY_ERRORS, span, message));
        }
        self.list
    }
}

macro_rules! keywords {
    ($($variant:ident $text:literal)*) => {
        /// A word that cannot be a name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Keyword { $(#[doc = $text] $variant),* }

        impl Keyword {
            /// The keyword that is written so.
            pub fn from_text(text: &str) -> Option<Keyword> {
                match text { $($text => Some(Keyword::$variant),)* _ => None }
            }
            /// As written.
            pub fn text(self) -> &'static str {
                match self { $(Keyword::$variant => $text),* }
            }
        }
    };
}

keywords! {
    System "system" Module "module" Const "const" Param "param" Query "query" Volume "volume"
    Ignore "ignore" Template "template" Axiom "axiom" Rules "rules" Place "place" Run "run"
    Eps "eps" Let "let" At "at" On "on" File "file" With "with"
}

impl Keyword {
    /// Begins a declaration or section of a file, so it can stand inside no bracket.
    pub fn begins_item(self) -> bool {
        !matches!(
            self,
            Keyword::Eps | Keyword::Let | Keyword::At | Keyword::On | Keyword::File | Keyword::With
        )
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bracket {
    Round,
    Square,
    Curly,
}

impl Bracket {
    /// The opening one, as written.
    pub fn open(self) -> &'static str {
        match self {
            Bracket::Round => "(",
            Bracket::Square => "[",
            Bracket::Curly => "{",
        }
    }
    /// The closing one, as written.
    pub fn close(self) -> &'static str {
        match self {
            Bracket::Round => ")",
            Bracket::Square => "]",
            Bracket::Curly => "}",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    Name,
    Keyword(Keyword),
    Number,
    /// A string; the span holds its quotes.
    Text,
    Open(Bracket),
    Close(Bracket),
    Plus,
    Minus,
    Star,
    Slash,
    Percent,
    Backslash,
    Caret,
    /// One `&`; the expressions put two together where they touch.
    And,
    /// One `|`, likewise.
    Bar,
    Bang,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    EqualEqual,
    NotEqual,
    Equal,
    Arrow,
    Comma,
    Semicolon,
    Colon,
    Dot,
    DotDot,
    AtSign,
    Question,
    Hash,
    /// One or more line ends in a row.
    Newline,
    /// The end of the file; always the last token.
    End,
}

#[derive(Clone, Copy, Debug)]
pub struct Token {
    pub kind: TokenKind,
    pub span: Span,
}

/// Checks that the bytes of a file are UTF-8, and says where they are not.
pub fn decode(bytes: &[u8]) -> Result<&str, Diagnostic> {
    std::str::from_utf8(bytes).map_err(|error| {
        let at = error.valid_up_to();
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            let message = "the file is UTF-16, not UTF-8";
            return Diagnostic::error(code::INVALID_UTF8, Span::default(), message)
                .hint("save the file as UTF-8");
        }
        if is_binary(bytes) {
            return binary();
        }
        let message = format!("the file is not UTF-8: byte {at} is 0x{:02x}", bytes[at]);
        Diagnostic::error(code::INVALID_UTF8, Span::new(at, at + 1), message).hint("save the file as UTF-8")
    })
}

/// Whether these are no text: many are zeros, or the first.
pub(crate) fn is_binary(bytes: &[u8]) -> bool {
    let zeros = bytes.iter().filter(|byte| **byte == 0).count();
    bytes.first() == Some(&0) || zeros > bytes.len() / 512
}

/// Of a file that is no text.
pub(crate) fn binary() -> Diagnostic {
    Diagnostic::error(code::NO_RULE_FILE, Span::default(), "this is no rule file: it is no text")
        .hint("a rule file has systems in it, which begin so: `system name : curve`")
}

/// Cuts the text into tokens. What is no token is reported and left out, or taken for what was
/// probably meant.
pub(crate) fn lex(text: &str, findings: &mut Findings) -> Vec<Token> {
    let mut lexer = Lexer { text, at: 0, tokens: Vec::new(), findings, no_comment_end: false };
    if text.starts_with('\u{feff}') {
        lexer.at = '\u{feff}'.len_utf8();
    }
    while let Some(c) = lexer.peek() {
        lexer.token(c);
    }
    lexer.push(TokenKind::End, text.len());
    lexer.tokens
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    tokens: Vec<Token>,
    findings: &'a mut Findings,
    /// Known to hold no further `*/`: keeps many `/*` from searching the file again and again.
    no_comment_end: bool,
}

impl Lexer<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Adds a token from `start` to the present place.
    fn push(&mut self, kind: TokenKind, start: usize) {
        self.tokens.push(Token { kind, span: Span::new(start, self.at) });
    }

    fn error(&mut self, code: &'static str, start: usize, message: String, hint: &str) {
        let span = Span::new(start, self.at);
        self.findings.push(Diagnostic::error(code, span, message).hint(hint));
    }

    fn skip_while(&mut self, test: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(|c| !test(c)).unwrap_or(rest.len());
    }

    fn token(&mut self, c: char) {
        match c {
            '\n' | '\r' => self.newline(),
            ' ' | '\t' => self.at += 1,
            'a'..='z' | 'A'..='Z' | '_' => self.name(),
            '0'..='9' => self.number(),
            '"' => self.string(),
            _ => self.operator(c),
        }
    }

    fn newline(&mut self) {
        let start = self.at;
        self.at += 1;
        if !matches!(self.tokens.last(), None | Some(Token { kind: TokenKind::Newline, .. })) {
            self.push(TokenKind::Newline, start);
        }
    }

    fn name(&mut self) {
        let start = self.at;
        self.skip_while(is_name_char);
        if self.peek().is_some_and(is_foreign_letter) {
            return self.foreign_name(start);
        }
        let kind = Keyword::from_text(&self.text[start..self.at]).map_or(TokenKind::Name, TokenKind::Keyword);
        self.push(kind, start);
    }

    /// A name with letters beyond ASCII: reported, then taken as a name so that nothing follows from it.
    fn foreign_name(&mut self, start: usize) {
        self.skip_while(|c| is_name_char(c) || is_foreign_letter(c));
        let text = &self.text[start..self.at];
        let message = format!("`{}` is not a name", excerpt(text));
        let hint = match text {
            // What papers have in place of a word of the language.
            "λ" | "Λ" | "ɛ" | "ϵ" => "the empty word is written `eps`",
            "ω" | "Ω" => "what the system starts from is written `axiom: …`",
            "δ" | "Δ" | "θ" => {
                "an angle is written `const angle = 90`, and stands in brackets: `+(angle)`"
            }
            _ => "names are written with a to z, A to Z, 0 to 9 and `_`",
        };
        self.error(code::UNKNOWN_CHARACTER, start, message, hint);
        self.push(TokenKind::Name, start);
    }

    fn skip_digits(&mut self) {
        self.skip_while(|c| c.is_ascii_digit());
    }

    fn number(&mut self) {
        let start = self.at;
        self.skip_digits();
        // `1..2` is the range from 1 to 2.
        if self.rest().starts_with('.') && !self.rest().starts_with("..") {
            self.at += 1;
            self.skip_digits();
        }
        self.exponent();
        let digits = self.at;
        if self.peek().is_some_and(|c| is_name_char(c) || is_foreign_letter(c)) {
            self.skip_while(|c| is_name_char(c) || is_foreign_letter(c));
            let (number, name) = (excerpt(&self.text[start..digits]), excerpt(&self.text[digits..self.at]));
            let message = format!("`{number}{name}` is neither a number nor a name");
            let hint = match name.chars().next() {
                Some('x' | 'X' | 'b') if number == "0" => "write the number in decimal".to_owned(),
                _ => format!("write `{number}*{name}`"),
            };
            self.error(code::BAD_NUMBER, start, message, &hint);
        }
        self.tokens.push(Token { kind: TokenKind::Number, span: Span::new(start, digits) });
    }

    fn exponent(&mut self) {
        let bytes = self.rest().as_bytes();
        let sign = usize::from(matches!(bytes.get(1), Some(b'+' | b'-')));
        if matches!(bytes.first(), Some(b'e' | b'E')) && bytes.get(1 + sign).is_some_and(u8::is_ascii_digit) {
            self.at += 1 + sign;
            self.skip_digits();
        }
    }

    fn string(&mut self) {
        let start = self.at;
        self.at += 1;
        self.skip_while(|c| !matches!(c, '"' | '\n' | '\r'));
        if self.rest().starts_with('"') {
            self.at += 1;
        } else {
            self.error(
                code::UNCLOSED_STRING,
                start,
                "this string is never closed".into(),
                "write `\"` at its end, in the same line",
            );
        }
        self.push(TokenKind::Text, start);
    }

    fn operator(&mut self, c: char) {
        use TokenKind::*;
        const OPERATORS: [(&str, TokenKind); 37] = [
            ("->", Arrow),
            ("→", Arrow),
            ("..", DotDot),
            ("<=", LessEqual),
            ("≤", LessEqual),
            (">=", GreaterEqual),
            ("≥", GreaterEqual),
            ("==", EqualEqual),
            ("!=", NotEqual),
            ("≠", NotEqual),
            ("ε", Keyword(self::Keyword::Eps)),
            ("+", Plus),
            ("-", Minus),
            ("*", Star),
            ("/", Slash),
            ("%", Percent),
            ("\\", Backslash),
            ("^", Caret),
            ("&", And),
            ("|", Bar),
            ("!", Bang),
            ("<", Less),
            (">", Greater),
            ("=", Equal),
            ("(", Open(Bracket::Round)),
            ("[", Open(Bracket::Square)),
            ("{", Open(Bracket::Curly)),
            (")", Close(Bracket::Round)),
            ("]", Close(Bracket::Square)),
            ("}", Close(Bracket::Curly)),
            (",", Comma),
            (";", Semicolon),
            (":", Colon),
            (".", Dot),
            ("@", AtSign),
            ("?", Question),
            ("#", Hash),
        ];
        let start = self.at;
        let rest = self.rest();
        if rest.starts_with("//") {
            return self.skip_while(|c| c != '\n' && c != '\r');
        }
        if rest.starts_with("/*") {
            return self.block_comment();
        }
        for wrong in ["-->", "=>", "⇒"] {
            if rest.starts_with(wrong) {
                return self.wrong_arrow(wrong);
            }
        }
        if c == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit()) && !self.follows_value() {
            return self.bare_fraction();
        }
        match OPERATORS.iter().find(|(text, _)| rest.starts_with(text)) {
            Some((text, kind)) => {
                self.at += text.len();
                self.push(*kind, start);
            }
            None => self.unknown(c),
        }
    }

    /// A `.` behind a value is a field's, not a numeral's.
    fn follows_value(&self) -> bool {
        self.tokens.last().is_some_and(|t| {
            t.span.end as usize == self.at
                && matches!(t.kind, TokenKind::Name | TokenKind::Close(_) | TokenKind::DotDot)
        })
    }

    fn bare_fraction(&mut self) {
        let start = self.at;
        self.at += 1;
        self.skip_digits();
        self.exponent();
        let written = excerpt(&self.text[start..self.at]);
        self.error(
            code::BAD_NUMBER,
            start,
            format!("`{written}` is not a number"),
            &format!("write `0{written}`"),
        );
        self.push(TokenKind::Number, start);
    }

    fn wrong_arrow(&mut self, wrong: &str) {
        let start = self.at;
        self.at += wrong.len();
        let hint = match wrong {
            "=>" => "write `->`, or `>=` for a comparison",
            _ => "write `->`",
        };
        self.error(code::WRONG_ARROW, start, format!("`{wrong}` is not an arrow"), hint);
        self.push(TokenKind::Arrow, start);
    }

    fn block_comment(&mut self) {
        let start = self.at;
        self.at += 2;
        let hint = "write `//`: a comment goes to the end of its line";
        self.error(code::BLOCK_COMMENT, start, "`/*` is not a comment".into(), hint);
        let end = if self.no_comment_end { None } else { self.rest().find("*/") };
        match end {
            Some(end) => self.at += end + 2,
            None => {
                self.no_comment_end = true;
                self.skip_while(|c| c != '\n' && c != '\r');
            }
        }
    }

    /// A run of characters that are no tokens, as one error.
    fn unknown(&mut self, first: char) {
        let start = self.at;
        if is_foreign_letter(first) {
            return self.foreign_name(start);
        }
        let known = meant_by(first);
        self.at += first.len_utf8();
        if known.is_none() {
            self.skip_while(|c| !c.is_ascii_graphic() && !c.is_ascii_whitespace() && meant_by(c).is_none());
        }
        let message = match first {
            c if c.is_control() || c.is_whitespace() => {
                format!("the character U+{:04X} is not used in this language", c as u32)
            }
            _ => format!("`{}` is not used in this language", excerpt(&self.text[start..self.at])),
        };
        let span = Span::new(start, self.at);
        let hint = known.map(|(_, hint)| hint);
        self.findings.push(Diagnostic::error(code::UNKNOWN_CHARACTER, span, message).hint_if(hint));
        if let Some((Some(kind), _)) = known {
            self.push(kind, start);
        }
    }
}

/// What a character stands for that papers, word processors and other languages use, and what to
/// write for it.
fn meant_by(c: char) -> Option<(Option<TokenKind>, &'static str)> {
    use TokenKind::*;
    Some(match c {
        '−' | '–' | '—' => (Some(Minus), "write `-`"),
        '×' | '·' | '∗' => (Some(Star), "write `*`"),
        '÷' => (Some(Slash), "write `/`"),
        '∧' => (None, "write `&&`"),
        '∨' => (None, "write `||`"),
        '¬' => (Some(Bang), "write `!`"),
        '“' | '”' | '„' | '\'' | '‘' | '’' => (None, "write a string in plain quotes, `\"…\"`"),
        '\u{a0}' | '\u{2009}' | '\u{202f}' => (None, "write a plain space"),
        '…' => (Some(DotDot), "write `..`"),
        '$' => (None, "the turtle has `+ - & ^ / \\ | !`"),
        _ => return None,
    })
}

fn is_name_char(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// A letter or digit beyond ASCII; ε stands for `eps`.
fn is_foreign_letter(c: char) -> bool {
    !c.is_ascii() && c.is_alphanumeric() && c != 'ε'
}

/// At most 40 characters, for a message.
pub(crate) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
