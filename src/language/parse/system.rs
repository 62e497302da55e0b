//! The file and its systems.

use super::{Parse, Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code, nearest};
use crate::language::lex::{Keyword, excerpt};
use crate::language::syntax::{
    Attribute, AttributeKind, FileItem, Item, Kind, Name, Number, RuleFile, Span, System,
};

/// The words that declarations begin with.
pub(super) const ITEMS: [&str; 12] = [
    "system", "module", "const", "param", "query", "volume", "ignore", "template", "axiom", "rules", "place",
    "run",
];
const KINDS: [&str; 3] = ["curve", "patch", "mesh"];
const ATTRIBUTES: [&str; 6] = ["ring", "open", "tree", "bezier", "rational", "join"];

impl Parser<'_> {
    pub(super) fn file(&mut self) -> RuleFile {
        self.skip_newlines();
        let version = self.statement(Self::version).flatten();
        let mut items = Vec::new();
        loop {
            self.skip_newlines();
            let start = self.at;
            match self.peek() {
                TokenKind::End => break,
                TokenKind::Keyword(Keyword::System) => {
                    self.survey(start);
                    items.extend(self.system().map(FileItem::System));
                }
                _ => {
                    items.extend(self.statement(Self::file_item));
                    self.survey(start);
                }
            }
            if self.findings.is_full() {
                break;
            }
        }
        RuleFile { version, items }
    }

    /// A first line `burgeon 1`.
    fn version(&mut self) -> Parse<Option<Number>> {
        if !self.take_word("burgeon") {
            return Ok(None);
        }
        let number = self.whole("the version of the language: `burgeon 1`")?;
        if number.text != "1" {
            let message = format!("version {} of the language is not known", excerpt(&number.text));
            self.report(Diagnostic::error(code::VERSION, number.span, message).hint("write `burgeon 1`"));
        }
        self.end_of_statement()?;
        Ok(Some(number))
    }

    fn file_item(&mut self) -> Parse<FileItem> {
        match self.peek() {
            TokenKind::Keyword(Keyword::Const) => self.constant().map(FileItem::Const),
            TokenKind::Keyword(Keyword::Param) => self.param().map(FileItem::Param),
            TokenKind::Keyword(keyword) if keyword.begins_item() => {
                let span = self.token().span;
                let message = format!("`{}` stands outside of a system", keyword.text());
                let error = Diagnostic::error(code::MISPLACED_ITEM, span, message)
                    .hint("begin a system before it, such as `system name : curve`");
                self.stop(error)
            }
            _ => self.unknown_item(),
        }
    }

    fn system(&mut self) -> Option<System> {
        let start = self.token().span;
        let Some((name, kind, kind_span)) = self.header() else {
            self.skip_system();
            return None;
        };
        let attributes = self.statement(Self::attributes).unwrap_or_default();
        let (items, span) = self.items(start);
        Some(System { name, kind, kind_span, attributes, items, span })
    }

    /// Nothing can be read without the kind of the system.
    fn skip_system(&mut self) {
        while !matches!(self.peek(), TokenKind::End | TokenKind::Keyword(Keyword::System)) {
            self.at += 1;
        }
    }

    /// `system NAME: kind`.
    fn header(&mut self) -> Option<(Name, Kind, Span)> {
        self.bump();
        let name_token = self.token();
        let (name, kind_span) = self.header_name().ok()?;
        let kind = self.kind().ok()?;
        self.systems.insert(self.text_of(name_token));
        self.kind = kind;
        self.rule_count = 0;
        self.collect_symbols();
        Some((name, kind, kind_span))
    }

    fn header_name(&mut self) -> Parse<(Name, Span)> {
        let name = self.name("the system's name")?;
        self.expect(TokenKind::Colon, "`:` and the kind of the system: `curve`, `patch` or `mesh`")?;
        Ok((name, self.token().span))
    }

    fn attributes(&mut self) -> Parse<Vec<Attribute>> {
        let mut attributes = Vec::new();
        while !self.at_end_of_statement() {
            attributes.push(self.attribute()?);
        }
        self.end_of_statement()?;
        Ok(attributes)
    }

    /// A kind that is slightly misspelt is taken for what was meant, so that the rest can be read.
    fn kind(&mut self) -> Parse<Kind> {
        let token = self.token();
        let name = self.name("the kind of the system: `curve`, `patch` or `mesh`")?;
        let meant = if KINDS.contains(&name.text.as_str()) {
            Some(name.text.as_str())
        } else {
            let near = nearest(&name.text, KINDS);
            let message = format!("there is no kind of system `{}`", excerpt(&name.text));
            let hint = match near {
                Some(kind) => format!("did you mean `{kind}`?"),
                None => "write `curve`, `patch` or `mesh`".into(),
            };
            self.report(Diagnostic::error(code::UNKNOWN_WORD, token.span, message).hint(hint));
            near
        };
        match meant {
            Some("curve") => Ok(Kind::Curve),
            Some("patch") => Ok(Kind::Patch),
            Some("mesh") => Ok(Kind::Mesh),
            _ => Err(super::Stop),
        }
    }

    fn attribute(&mut self) -> Parse<Attribute> {
        let start = self.token().span;
        let name = self.name("an attribute of the system")?;
        let kind = match name.text.as_str() {
            "ring" => AttributeKind::Ring,
            "open" => AttributeKind::Open,
            "tree" => AttributeKind::Tree,
            "rational" => AttributeKind::Rational,
            "bezier" => self.bezier()?,
            "join" => self.join()?,
            text => {
                let message = format!("there is no attribute `{}`", excerpt(text));
                let hint = match nearest(text, ATTRIBUTES) {
                    Some(attribute) => format!("did you mean `{attribute}`?"),
                    None => format!("the attributes are {}", ATTRIBUTES.map(|a| format!("`{a}`")).join(", ")),
                };
                let error = Diagnostic::error(code::UNKNOWN_WORD, start, message).hint(hint);
                return self.stop(error);
            }
        };
        Ok(Attribute { kind, span: self.span_from(start) })
    }

    fn bezier(&mut self) -> Parse<AttributeKind> {
        let u = self.whole("the degree, such as `bezier 3`")?;
        let v = match self.peek() {
            TokenKind::Number => Some(self.whole("the degree along v")?),
            _ => None,
        };
        Ok(AttributeKind::Bezier(u, v))
    }

    fn join(&mut self) -> Parse<AttributeKind> {
        let c1 = self.is_word("c1");
        if c1 || self.is_word("c0") {
            self.bump();
            return Ok(AttributeKind::Join { c1 });
        }
        let error = self.unexpected("`c0` or `c1`");
        self.stop(error)
    }

    /// The declarations of a system. A const or param behind its `run:` is the file's.
    fn items(&mut self, start: Span) -> (Vec<Item>, Span) {
        let mut items = Vec::new();
        let mut ran: Option<Span> = None;
        let mut reported = false;
        let mut span = self.span_from(start);
        loop {
            self.skip_newlines();
            let keyword = match self.peek() {
                TokenKind::End | TokenKind::Keyword(Keyword::System) => break,
                TokenKind::Keyword(keyword) => Some(keyword),
                _ => None,
            };
            if let Some(run) = ran {
                if matches!(keyword, Some(Keyword::Const | Keyword::Param)) {
                    break;
                }
                if !reported && keyword.is_some_and(Keyword::begins_item) {
                    self.behind_run(run);
                    reported = true;
                }
            }
            if keyword == Some(Keyword::Run) {
                ran = ran.or(Some(self.token().span));
            }
            items.extend(self.statement(Self::item));
            span = self.span_from(start);
            if self.findings.is_full() {
                break;
            }
        }
        (items, span)
    }

    fn behind_run(&mut self, run: Span) {
        let message = format!("{} stands behind `run:`", self.found());
        let error = Diagnostic::error(code::MISPLACED_ITEM, self.token().span, message)
            .label(run, "`run:` is here")
            .hint("`run:` stands once, at the end of its system");
        self.report(error);
    }

    pub(super) fn unknown_item<T>(&mut self) -> Parse<T> {
        self.foreign_beginning()?;
        let token = self.token();
        if token.kind != TokenKind::Name {
            let error = self.unexpected("a declaration");
            return self.stop(error);
        }
        let text = self.text_of(token);
        let (code, hint) = match self.nearest_item(text) {
            Some(item) => (code::UNKNOWN_WORD, format!("did you mean `{item}`?")),
            None if text == "burgeon" => (code::VERSION, "`burgeon 1` is the first line of a file".into()),
            None if super::run::is_step(text) => (code::UNKNOWN_WORD, "steps stand under `run:`".into()),
            None if self.is_symbol(token) || self.has_arrow() => {
                (code::UNKNOWN_WORD, "rules stand under `rules:`".into())
            }
            None if let Some(hint) = super::habits::meant_by(text) => (code::UNKNOWN_WORD, hint.into()),
            None => (
                code::UNKNOWN_WORD,
                format!("declarations begin with {}", ITEMS.map(|i| format!("`{i}`")).join(", ")),
            ),
        };
        let message = format!("`{}` begins no declaration", excerpt(text));
        let error = Diagnostic::error(code, token.span, message).hint(hint);
        self.stop(error)
    }
}
