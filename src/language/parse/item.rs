//! The declarations of a system.

use super::{Parse, Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code};
use crate::language::lex::{Bracket, Keyword};
use crate::language::syntax::{
    Axiom, AxiomKind, Const, Element, Field, Item, Kind, MeshStart, ModuleDecl, Name, Number, Param, Place,
    Query, Source, SourceKind, Span, Start, Template, TemplateBody, TemplateLine, TemplateLineKind, Volume,
};

impl Parser<'_> {
    pub(super) fn item(&mut self) -> Parse<Item> {
        let TokenKind::Keyword(keyword) = self.peek() else { return self.unknown_item() };
        match keyword {
            Keyword::Const => self.constant().map(Item::Const),
            Keyword::Param => self.param().map(Item::Param),
            Keyword::Module => self.modules().map(Item::Modules),
            Keyword::Query => self.query().map(Item::Query),
            Keyword::Volume => self.volume().map(Item::Volume),
            Keyword::Ignore => self.ignore().map(Item::Ignore),
            Keyword::Template => self.template().map(Item::Template),
            Keyword::Axiom => self.axiom().map(Item::Axiom),
            Keyword::Rules => self.rules().map(Item::Rules),
            Keyword::Place => self.place().map(Item::Place),
            Keyword::Run => self.run().map(Item::Run),
            _ => self.unknown_item(),
        }
    }

    /// The span of a statement from `start`, whose end is checked.
    fn ended(&mut self, start: Span) -> Parse<Span> {
        let span = self.span_from(start);
        self.end_of_statement()?;
        Ok(span)
    }

    fn optional_type(&mut self) -> Parse<Option<Name>> {
        if self.take(TokenKind::Colon) { self.name("a type").map(Some) } else { Ok(None) }
    }

    pub(super) fn constant(&mut self) -> Parse<Const> {
        let start = self.bump().span;
        let name = self.name("the name of a const")?;
        let ty = self.optional_type()?;
        self.expect(TokenKind::Equal, "`=` and a value")?;
        let value = self.expr()?;
        Ok(Const { name, ty, value, span: self.ended(start)? })
    }

    pub(super) fn param(&mut self) -> Parse<Param> {
        let start = self.bump().span;
        let name = self.name("the name of a param")?;
        let ty = self.optional_type()?;
        self.expect(TokenKind::Equal, "`=` and a value")?;
        let value = self.expr()?;
        let range = if self.take_word("in") {
            let low = self.expr()?;
            self.expect(TokenKind::DotDot, "`..` and the upper end of the range")?;
            Some((low, self.expr()?))
        } else {
            None
        };
        Ok(Param { name, ty, value, range, span: self.ended(start)? })
    }

    fn modules(&mut self) -> Parse<Vec<ModuleDecl>> {
        self.bump();
        let modules = self.list(Self::module_decl)?;
        self.end_of_statement()?;
        Ok(modules)
    }

    fn module_decl(&mut self) -> Parse<ModuleDecl> {
        let token = self.token();
        let symbol = if super::symbols::is_operator_symbol(token.kind) {
            self.bump();
            Name { text: self.text_of(token).to_owned(), span: token.span }
        } else {
            self.name("a module's symbol")?
        };
        let fields = if self.take_open(Bracket::Round) { self.bracketed(Self::field)? } else { Vec::new() };
        Ok(ModuleDecl { symbol, fields, span: self.span_from(token.span) })
    }

    fn field(&mut self) -> Parse<Field> {
        let name = self.name("the name of a parameter")?;
        self.expect(TokenKind::Colon, "`:` and the parameter's type")?;
        Ok(Field { name, ty: self.name("a type")? })
    }

    fn query(&mut self) -> Parse<Query> {
        let start = self.bump().span;
        let name = self.name("a query's name")?;
        self.expect(TokenKind::Open(Bracket::Round), "`(` and the query's parameter, such as `(d: float)`")?;
        let field = self.field()?;
        self.close(Bracket::Round)?;
        let value = if self.take(TokenKind::Equal) { Some(self.expr()?) } else { None };
        Ok(Query { name, field, value, span: self.ended(start)? })
    }

    fn volume(&mut self) -> Parse<Volume> {
        let start = self.bump().span;
        let name = self.name("a volume's name")?;
        self.expect(TokenKind::Colon, "`:` and the type of its values")?;
        let ty = self.name("a type")?;
        self.expect(TokenKind::Open(Bracket::Round), "`(` and three sizes")?;
        let size = self.volume_size()?;
        self.close(Bracket::Round)?;
        self.expect_word("from")?;
        let from = self.expr()?;
        self.expect_word("to")?;
        let to = self.expr()?;
        Ok(Volume { name, ty, size, from, to, span: self.ended(start)? })
    }

    fn volume_size(&mut self) -> Parse<[Number; 3]> {
        let what = "a size: a whole number";
        let x = self.whole(what)?;
        self.expect(TokenKind::Comma, "`,`")?;
        let y = self.whole(what)?;
        self.expect(TokenKind::Comma, "`,`")?;
        Ok([x, y, self.whole(what)?])
    }

    fn ignore(&mut self) -> Parse<Vec<Name>> {
        self.bump();
        if self.peek() == TokenKind::Colon {
            let error = self.unexpected("a symbol").hint("write `ignore + -`, without `:`");
            return self.stop(error);
        }
        let mut symbols = vec![self.symbol("a symbol")?];
        while !self.at_end_of_statement() {
            symbols.push(self.symbol("a symbol")?);
        }
        self.end_of_statement()?;
        Ok(symbols)
    }

    fn place(&mut self) -> Parse<Place> {
        let start = self.bump().span;
        let name = self.name("a placement's name")?;
        let on =
            if self.take_keyword(Keyword::On) { self.list(|p| p.symbol("a symbol"))? } else { Vec::new() };
        self.expect(TokenKind::Equal, "`=` and the new position")?;
        let value = self.expr()?;
        Ok(Place { name, on, value, span: self.ended(start)? })
    }

    // Templates.

    fn template(&mut self) -> Parse<Template> {
        let start = self.bump().span;
        let name = self.name("a template's name")?;
        let body = if self.take(TokenKind::Equal) {
            TemplateBody::File(self.string("the name of a file in quotes")?)
        } else if self.take_open(Bracket::Curly) {
            let lines = self.template_lines()?;
            self.close(Bracket::Curly)?;
            TemplateBody::Inline(lines)
        } else {
            let error = self.unexpected("`= \"file\"` or `{` and the template's vertices and faces");
            return self.stop(error);
        };
        let mut base = Vec::new();
        if self.take_word("base") {
            base.push(self.name("the name of a base face")?);
            while self.peek() == TokenKind::Name {
                base.push(self.name("the name of a base face")?);
            }
        }
        Ok(Template { name, body, base, span: self.ended(start)? })
    }

    fn template_lines(&mut self) -> Parse<Vec<TemplateLine>> {
        let mut lines = Vec::new();
        loop {
            self.skip_newlines();
            if self.peek() == TokenKind::Close(Bracket::Curly) {
                return Ok(lines);
            }
            lines.push(self.template_line()?);
        }
    }

    fn template_line(&mut self) -> Parse<TemplateLine> {
        let start = self.token().span;
        let kind = if self.take_word("v") {
            let what = "three numbers behind `v`";
            TemplateLineKind::Vertex([
                self.signed_number(what)?,
                self.signed_number(what)?,
                self.signed_number(what)?,
            ])
        } else if self.take_word("e") {
            let what = "two vertices and a sharpness behind `e`";
            TemplateLineKind::Crease(self.whole(what)?, self.whole(what)?, self.signed_number(what)?)
        } else if self.take_word("f") {
            self.face()?
        } else {
            let error = self.unexpected("`v x y z`, `f name: vertices …` or `e from to sharpness`");
            return self.stop(error);
        };
        Ok(TemplateLine { kind, span: self.span_from(start) })
    }

    fn face(&mut self) -> Parse<TemplateLineKind> {
        let name = self.name("the face's name")?;
        self.expect(TokenKind::Colon, "`:` and the face's vertices")?;
        let mut vertices = vec![self.whole("the number of a vertex")?];
        while self.peek() == TokenKind::Number {
            vertices.push(self.whole("the number of a vertex")?);
        }
        Ok(TemplateLineKind::Face(name, vertices))
    }

    // Axioms.

    fn axiom(&mut self) -> Parse<Axiom> {
        let start = self.bump().span;
        self.expect(TokenKind::Colon, "`:`")?;
        if self.begins_line_of_axiom() {
            self.skip_newlines();
        }
        let kind = match self.kind {
            Kind::Mesh => self.mesh_axiom()?,
            Kind::Curve | Kind::Patch => self.word_axiom()?,
        };
        Ok(Axiom { kind, span: self.ended(start)? })
    }

    /// At a newline behind which the axiom goes on: declarations begin with a keyword.
    fn begins_line_of_axiom(&self) -> bool {
        self.peek() == TokenKind::Newline
            && match self.peek_at(1) {
                TokenKind::Keyword(keyword) => !keyword.begins_item(),
                TokenKind::End => false,
                _ => true,
            }
    }

    fn mesh_axiom(&mut self) -> Parse<AxiomKind> {
        let mut meshes = vec![self.mesh_start()?];
        loop {
            if self.begins_line_of_axiom() {
                self.skip_newlines();
            }
            if self.at_end_of_statement() {
                return Ok(AxiomKind::Meshes(meshes));
            }
            meshes.push(self.mesh_start()?);
        }
    }

    fn mesh_start(&mut self) -> Parse<MeshStart> {
        let source = self.source()?;
        let at = if self.take_keyword(Keyword::At) { self.transforms()? } else { Vec::new() };
        Ok(MeshStart { source, at, slots: self.optional_slots()? })
    }

    /// A word, one source, or `mod = source …`.
    fn word_axiom(&mut self) -> Parse<AxiomKind> {
        if self.begins_source() {
            return self.source().map(AxiomKind::Source);
        }
        let mut word = self.word("`axiom:`")?;
        if self.peek() != TokenKind::Equal {
            self.only_words()?;
            return Ok(AxiomKind::Word(word));
        }
        match (word.pop(), word.is_empty()) {
            (Some(Element::Module(module)), true) => {
                self.bump();
                let source = self.source()?;
                self.starts(Start { module, source }).map(AxiomKind::Starts)
            }
            _ => {
                let error = self.unexpected("one module before `=`");
                self.stop(error)
            }
        }
    }

    fn starts(&mut self, first: Start) -> Parse<Vec<Start>> {
        let mut starts = vec![first];
        loop {
            if self.begins_line_of_axiom() && !self.begins_misspelt_item() {
                self.skip_newlines();
            }
            if self.at_end_of_statement() {
                return Ok(starts);
            }
            let module = self.module("a module and `=`")?;
            self.expect(TokenKind::Equal, "`=` and a source")?;
            starts.push(Start { module, source: self.source()? });
        }
    }

    /// The next line is no `mod = …`, but begins with nearly a keyword.
    fn begins_misspelt_item(&self) -> bool {
        let next = self.token_at(self.at + 1);
        next.kind == TokenKind::Name
            && !self.is_symbol(next)
            && self.nearest_item(self.text_of(next)).is_some()
    }

    fn only_words(&mut self) -> Parse<()> {
        if self.peek() != TokenKind::Hash {
            return Ok(());
        }
        let error = Diagnostic::error(code::UNEXPECTED, self.token().span, "`#` is never written in a word")
            .hint("the ends of an open word are there without it");
        self.stop(error)
    }

    /// Whether the axiom is a source and not a word: a file, a list, or a name that is no symbol.
    fn begins_source(&self) -> bool {
        let token = self.token();
        match token.kind {
            TokenKind::Keyword(Keyword::File) => true,
            TokenKind::Open(Bracket::Square) => self.begins_list(),
            TokenKind::Name => !self.is_symbol(token) && self.begins_named_source(),
            _ => false,
        }
    }

    /// A list of points, not a branch: it has commas, or begins with a numeral or round bracket.
    fn begins_list(&self) -> bool {
        let mut at = self.at;
        while self.token_at(at).kind == TokenKind::Open(Bracket::Square) {
            if self.token_at(at).commas {
                return true;
            }
            at += 1;
        }
        matches!(self.token_at(at).kind, TokenKind::Number | TokenKind::Open(Bracket::Round))
    }

    /// The name of an earlier system, or a lone name with or without arguments that may be one; but
    /// not symbols without spaces.
    fn begins_named_source(&self) -> bool {
        let text = self.text_of(self.token());
        if self.systems.contains(text) {
            return true;
        }
        let next = self.token_at(self.at + 1);
        let behind = match next.kind {
            TokenKind::Open(Bracket::Round) => self.token_at(next.partner as usize + 1),
            _ => next,
        };
        let lone = matches!(behind.kind, TokenKind::Newline | TokenKind::End)
            || behind.kind == TokenKind::Name && self.text_of(behind) == "shift";
        lone && self.spaced(text).is_none()
    }

    fn source(&mut self) -> Parse<Source> {
        let start = self.token().span;
        let kind = match self.peek() {
            TokenKind::Keyword(Keyword::File) => self.file_source()?,
            TokenKind::Open(Bracket::Square) => SourceKind::List(self.list_expr()?),
            TokenKind::Name => {
                let name = self.name("a source")?;
                SourceKind::Named(name, self.optional_args()?)
            }
            TokenKind::Text => {
                let error = self.unexpected("a source").hint("write `file` before the file's name");
                return self.stop(error);
            }
            _ => {
                let error =
                    self.unexpected("a source: `file \"…\"`, a list, a shape or the name of a system");
                return self.stop(error);
            }
        };
        let shift = if self.take_word("shift") { Some(self.expr()?) } else { None };
        Ok(Source { kind, shift, span: self.span_from(start) })
    }

    fn file_source(&mut self) -> Parse<SourceKind> {
        self.bump();
        let path = self.string("the name of a file in quotes")?;
        if !self.take_open(Bracket::Square) {
            return Ok(SourceKind::File(path, None));
        }
        let index = self.whole("the number of a mesh, curve or net in the file")?;
        self.close(Bracket::Square)?;
        Ok(SourceKind::File(path, Some(index)))
    }
}
