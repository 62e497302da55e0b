//! What those write who know other systems, where a statement begins or ends; and how it is written here.

use super::system::ITEMS;
use super::{Parse, Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code, nearest};
use crate::language::lex::{Bracket, Keyword, excerpt};
use crate::language::syntax::{Kind, Span};

/// First words of lines of L-studio, L-Py, Houdini, Fractint, textbooks and shaders, in small letters.
const WORDS: &[(&[&str], &str)] = &[
    (
        &["derivation", "iterations", "iteration", "iterate", "generations", "generation", "steps"],
        "write `derive 5` under `run:`",
    ),
    (
        &["production", "productions", "decomposition", "homomorphism", "interpretation"],
        "rules stand under `rules:`, a second group under `rules NAME:`",
    ),
    (&["lsystem", "endlsystem"], "write `system name : curve`; a system ends where the next one begins"),
    (&["premise", "omega", "start", "initiator", "initial"], "write `axiom: F`"),
    (&["generator"], "write a rule under `rules:`, such as `F -> F + F`"),
    (&["variables", "variable", "alphabet", "symbols", "constants"], "write `module A, B`"),
    (&["angle", "delta", "theta", "turn"], "write `const angle = 90`"),
    (&["consider"], "contexts see all symbols but those that `ignore` names"),
    (
        &["float", "int", "bool", "vec2", "vec3", "vec4", "double", "var", "def", "static"],
        "write `const x = 2`",
    ),
    (&["uniform"], "write `param x = 2`, which the host sets"),
    (&["for", "while", "loop", "do"], "write `repeat 3 { … }` under `run:`"),
    (&["else", "elif"], "write a second `if`, with the opposite condition"),
    (&["include", "import", "from", "using"], "a rule file stands alone; it holds several systems"),
    (&["end", "return"], "nothing ends a system: it ends where the next one begins"),
];

/// Words behind `#` that are no comment.
const DIRECTIVES: &[(&str, &str)] = &[
    ("define", "write `const NAME = 2`"),
    ("iterate", "write `derive 5` under `run:`"),
    ("include", "a rule file stands alone; it holds several systems"),
    ("ignore", "write `ignore + -`"),
];

/// What to write for a word that begins no statement of the language.
pub(super) fn meant_by(word: &str) -> Option<&'static str> {
    let word = word.to_ascii_lowercase();
    WORDS.iter().find(|(words, _)| words.contains(&word.as_str())).map(|(_, hint)| *hint)
}

impl Parser<'_> {
    /// The word that a declaration begins with and that this is a slip of.
    pub(super) fn nearest_item(&self, text: &str) -> Option<&'static str> {
        nearest(text, ITEMS)
    }

    /// At the beginning of a statement: signs that other languages begin lines with.
    pub(super) fn foreign_beginning(&mut self) -> Parse<()> {
        let token = self.token();
        let error = match token.kind {
            TokenKind::Hash if !self.begins_context() => self.directive(),
            TokenKind::Semicolon => {
                Diagnostic::error(code::UNKNOWN_WORD, token.span, "`;` begins no comment").hint("write `//`")
            }
            TokenKind::Keyword(Keyword::Let) => {
                Diagnostic::error(code::UNKNOWN_WORD, token.span, "`let` stands only in rules")
                    .hint("write `const x = 2`")
            }
            _ => return Ok(()),
        };
        // Of a habit one line tells as much as all.
        if !self.told.insert(error.message.clone()) {
            self.failed = true;
            return Err(super::Stop);
        }
        self.stop(error)
    }

    /// `#` as the end of a word, at the beginning of a rule.
    fn begins_context(&self) -> bool {
        self.kind == Kind::Curve
            && self.in_rules
            && (self.statement_holds(self.at, TokenKind::Less) || self.has_arrow())
            && self.directive_word().is_none()
    }

    /// The word that touches the `#` here, if it is one of those that languages have.
    fn directive_word(&self) -> Option<(&'static str, &'static str)> {
        let (hash, word) = (self.token(), self.token_at(self.at + 1));
        let touches = hash.span.end == word.span.start;
        let text = self.text_of(word);
        DIRECTIVES.iter().find(|(directive, _)| touches && *directive == text).copied()
    }

    fn directive(&self) -> Diagnostic {
        let span = self.token().span;
        match self.directive_word() {
            Some((word, hint)) => {
                let span = span.to(self.token_at(self.at + 1).span);
                Diagnostic::error(code::UNKNOWN_WORD, span, format!("there is no `#{word}`")).hint(hint)
            }
            None => Diagnostic::error(code::UNKNOWN_WORD, span, "`#` begins no comment").hint("write `//`"),
        }
    }

    /// Behind a whole statement.
    pub(super) fn behind_statement(&self) -> Option<Diagnostic> {
        let message = "a statement ends with its line, not with `;`";
        (self.peek() == TokenKind::Semicolon).then(|| {
            Diagnostic::error(code::UNEXPECTED, self.token().span, message)
                .hint("leave `;` out, and write one statement a line")
        })
    }

    /// `1: A -> B`.
    pub(super) fn numeric_label(&mut self) {
        let token = self.token();
        if token.kind != TokenKind::Number || self.peek_at(1) != TokenKind::Colon {
            return;
        }
        let number = excerpt(self.text_of(token));
        let error = Diagnostic::error(code::FOREIGN_RULE, token.span, "a label is a name, not a number")
            .hint(format!("write `p{}: …`, or leave the label out", number.replace('.', "_")));
        self.report(error);
        self.at += 2;
    }

    /// `: if n < 3 -> …`.
    pub(super) fn condition_with_if(&mut self) -> Parse<()> {
        if !self.is_word("if") {
            return Ok(());
        }
        let next = self.token_at(self.at + 1);
        let lone = match next.kind {
            TokenKind::Open(Bracket::Round) => {
                let behind = self.token_at(next.partner as usize + 1).kind;
                !next.commas && matches!(behind, TokenKind::Arrow | TokenKind::Newline)
            }
            kind => begins_value(kind),
        };
        if !lone {
            return Ok(());
        }
        let error =
            Diagnostic::error(code::FOREIGN_RULE, self.token().span, "a condition stands without `if`")
                .hint("write `A(n) : n < 3 -> …`");
        self.stop(error)
    }

    /// `if c then a else b`, at the name `if` in an expression.
    pub(super) fn if_without_brackets(&mut self) -> Parse<()> {
        if !self.is_word("if") || !begins_value(self.peek_at(1)) {
            return Ok(());
        }
        let error = Diagnostic::error(code::FOREIGN_OPERATOR, self.token().span, "`if` is a function here")
            .hint("write `if(c, a, b)`: a where c holds, else b");
        self.stop(error)
    }

    /// A line of modules under a rule, which may have been meant to go on with it.
    pub(super) fn line_without_arrow(&mut self, line: Span) -> Option<Diagnostic> {
        let before = self.rule_before?;
        let written = excerpt(&self.text[line.range()]);
        let message = "the rule ends with this line, and the next one is no rule";
        Some(
            Diagnostic::error(code::UNEXPECTED, before, message)
                .label(line, format!("`{written}` has no `->`"))
                .hint(format!(
                    "indent `{written}` deeper than its rule to go on with it, or write `{written} -> …` for a rule"
                )),
        )
    }
}

/// A value begins so, and nothing that could stand behind a name.
fn begins_value(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::Name | TokenKind::Number | TokenKind::Bang)
}
