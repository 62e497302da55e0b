//! Words: modules, branches, blocks; templates and their slots.

use super::symbols::is_operator_symbol;
use super::{Parse, Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code};
use crate::language::lex::{self, Bracket, Findings, Keyword, excerpt};
use crate::language::syntax::{
    Block, Cell, Element, Expr, ExprKind, Kind, ModuleUse, Name, Slot, SlotFill, Span, Successor,
    TemplatePlace, TemplateUse, Transform,
};

impl Parser<'_> {
    /// `mod`: a symbol, its arguments and its tag.
    pub(super) fn module(&mut self, what: &str) -> Parse<ModuleUse> {
        let symbol = self.symbol(what)?;
        let start = symbol.span;
        let args = self.optional_args()?;
        let tag = if self.take(TokenKind::AtSign) { Some(self.tag()?) } else { None };
        Ok(ModuleUse { symbol, args, tag, span: self.span_from(start) })
    }

    /// A name, a whole number, or expressions in brackets.
    fn tag(&mut self) -> Parse<Vec<Expr>> {
        let span = self.token().span;
        match self.peek() {
            TokenKind::Open(Bracket::Round) => {
                self.bump();
                let parts = self.list(Self::expr)?;
                self.close(Bracket::Round)?;
                Ok(parts)
            }
            TokenKind::Number => {
                let number = self.whole("a whole number, or an expression in `( )`")?;
                Ok(vec![Expr { kind: ExprKind::Number(number), span }])
            }
            _ => {
                let name = self.name("a tag: a name, a whole number or `( … )`")?;
                let kind = match name.text.as_str() {
                    "true" => ExprKind::Bool(true),
                    "false" => ExprKind::Bool(false),
                    _ => ExprKind::Name(name.text),
                };
                Ok(vec![Expr { kind, span }])
            }
        }
    }

    /// A word of at least one element. `after` says behind what it stands.
    pub(super) fn word(&mut self, after: &str) -> Parse<Vec<Element>> {
        let mut word = Vec::new();
        while let Some(element) = self.element()? {
            word.push(element);
            self.roll_at_end_of_line();
        }
        if word.is_empty() {
            let error = self.empty_word(after);
            return self.stop(error);
        }
        self.comment_behind_word();
        Ok(word)
    }

    /// `\` at the end of a line was perhaps meant to go on in the next one.
    fn roll_at_end_of_line(&mut self) {
        let Some(&last) = self.at.checked_sub(1).and_then(|last| self.tokens.get(last)) else { return };
        if self.silent || last.kind != TokenKind::Backslash || !self.is_turtle_symbol(last) {
            return;
        }
        // A newline within a statement is no token.
        let (end, next) = (last.span.end as usize, self.token());
        let gap = &self.text[end..(next.span.start as usize).max(end)];
        if gap.contains(['\n', '\r']) || matches!(next.kind, TokenKind::Newline | TokenKind::End) {
            let message = "`\\` at the end of a line is a roll of the turtle";
            let hint = "leave it out where the word goes on in the next line: that is indented deeper than its rule; \
                        a roll that is meant is clear as `\\(90)`";
            self.report(Diagnostic::warning(code::ROLL_AT_END, last.span, message).hint(hint));
        }
    }

    /// `F // F` was perhaps meant as two rolls: warns of a comment behind a word that is empty or
    /// reads as a word itself.
    fn comment_behind_word(&mut self) {
        let Some(last) = self.at.checked_sub(1).filter(|_| self.kind == Kind::Curve) else { return };
        let start = self.tokens[last].span.end as usize;
        let gap = &self.text[start..(self.token().span.start as usize).max(start)];
        let Some(line) = gap.split(['\n', '\r']).next() else { return };
        let before = line.len() - line.trim_start().len();
        let Some(comment) = line.trim_start().strip_prefix("//") else { return };
        if self.reads_as_word(comment) {
            let span = Span::new(start + before, start + before + 2);
            let message = "this begins a comment, which could be a part of the word";
            let hint = "two rolls are `/ /`, with a space; a comment should say more";
            self.report(Diagnostic::warning(code::COMMENT_LIKE_WORD, span, message).hint(hint));
        }
    }

    /// Whether it is empty or has only symbols of the system in it, perhaps with arguments.
    fn reads_as_word(&self, comment: &str) -> bool {
        const LONGEST: usize = 200;
        if comment.len() > LONGEST {
            return false;
        }
        let mut depth = 0;
        lex::lex(comment, &mut Findings::default()).iter().all(|token| {
            let text = &comment[token.span.range()];
            match token.kind {
                TokenKind::Open(Bracket::Round) => depth += 1,
                TokenKind::Close(Bracket::Round) => depth -= 1,
                _ if depth > 0 => {}
                TokenKind::Name => return self.symbols.contains(text),
                TokenKind::Open(_) | TokenKind::Close(_) | TokenKind::End => {}
                kind => return is_operator_symbol(kind),
            }
            true
        })
    }

    pub(super) fn empty_word(&self, after: &str) -> Diagnostic {
        let span = self.token().span;
        match self.peek() {
            TokenKind::Star => Diagnostic::error(code::FOREIGN_RULE, span, "`*` is not the empty word")
                .hint("write `eps` to erase"),
            _ if self.at_end_of_statement() || matches!(self.peek(), TokenKind::Close(_)) => {
                Diagnostic::error(code::EMPTY_WORD, span, format!("nothing stands after {after}"))
                    .hint("write `eps` to erase")
            }
            _ => self.unexpected("a module, `eps` or `[`"),
        }
    }

    /// The next element, or nothing at the end of the word.
    fn element(&mut self) -> Parse<Option<Element>> {
        let token = self.token();
        Ok(Some(match token.kind {
            TokenKind::Keyword(Keyword::Eps) => {
                self.bump();
                Element::Eps(token.span)
            }
            TokenKind::Open(Bracket::Square) if self.kind == Kind::Patch && self.is_block() => {
                match self.nested(Self::block)? {
                    Some(block) => Element::Block(block),
                    None => Element::Eps(token.span),
                }
            }
            TokenKind::Open(Bracket::Square) => self.nested(Self::branch)?,
            kind if kind == TokenKind::Name || is_operator_symbol(kind) => {
                Element::Module(self.module("a module")?)
            }
            _ => return Ok(None),
        }))
    }

    /// In a patch system all brackets are blocks, except those that begin with a turtle symbol.
    fn is_block(&self) -> bool {
        let inner = self.token_at(self.at + 1);
        self.token().separated || !self.is_turtle_symbol(inner)
    }

    fn branch(&mut self) -> Parse<Element> {
        let start = self.bump().span;
        let word = self.word("`[`")?;
        let end = self.close(Bracket::Square)?.span;
        Ok(Element::Branch(word, start.to(end)))
    }

    /// A block; nothing if its rows do not fit, which has been reported.
    fn block(&mut self) -> Parse<Option<Block>> {
        let opening = self.bump();
        let mut rows = vec![self.row()?];
        while self.take(TokenKind::Semicolon) {
            rows.push(self.row()?);
        }
        let end = self.close(Bracket::Square)?.span;
        let block = Block { rows, span: opening.span.to(end) };
        let fits = self.check_block(&block, opening.span, opening.separated);
        Ok(fits.then_some(block))
    }

    fn row(&mut self) -> Parse<Vec<Cell>> {
        let mut row = vec![self.cell()?];
        while !matches!(self.peek(), TokenKind::Semicolon | TokenKind::Close(_)) {
            self.take(TokenKind::Bar);
            row.push(self.cell()?);
        }
        Ok(row)
    }

    fn cell(&mut self) -> Parse<Cell> {
        let token = self.token();
        match token.kind {
            TokenKind::Keyword(Keyword::Eps) => {
                self.bump();
                Ok(Cell::Eps(token.span))
            }
            TokenKind::Open(Bracket::Square) => {
                Ok(self.nested(Self::block)?.map_or(Cell::Eps(token.span), Cell::Block))
            }
            kind if kind == TokenKind::Name || is_operator_symbol(kind) && kind != TokenKind::Bar => {
                Ok(Cell::Module(self.module("a module")?))
            }
            _ => {
                let error = self.unexpected("a cell: a module, `eps` or a block");
                self.stop(error)
            }
        }
    }

    fn check_block(&mut self, block: &Block, opening: Span, separated: bool) -> bool {
        let lengths: Vec<usize> = block.rows.iter().map(Vec::len).collect();
        let (rows, columns) = (lengths.len(), lengths[0]);
        let error = if lengths.iter().any(|n| *n != columns) {
            Diagnostic::error(code::RAGGED_BLOCK, opening, format!("rows have {} cells", listed(&lengths)))
                .hint("write as many cells in each row; `eps` is a hole")
        } else if !separated {
            self.no_block(block, opening)
        } else if rows > 2 || columns > 2 {
            let message = format!("a block is 1×2, 2×1 or 2×2, not {rows}×{columns}");
            Diagnostic::error(code::BLOCK_SIZE, opening, message).hint("put blocks into its cells")
        } else {
            return true;
        };
        self.report(error);
        false
    }

    /// A bracket of a patch system without `;` and `|`.
    fn no_block(&self, block: &Block, opening: Span) -> Diagnostic {
        let message = "this bracket is neither a block nor a branch";
        let error = Diagnostic::error(code::NOT_A_BLOCK, opening, message);
        match block.rows.as_slice() {
            [row] if row.len() == 2 => {
                let cell = |c: &Cell| {
                    let (Cell::Eps(span)
                    | Cell::Module(ModuleUse { span, .. })
                    | Cell::Block(Block { span, .. })) = c;
                    excerpt(&self.text[span.range()])
                };
                error.hint(format!("was `[ {} | {} ]` meant?", cell(&row[0]), cell(&row[1])))
            }
            [row] if row.len() == 1 => {
                error.hint("leave the brackets out, or write two cells with `|` or `;`")
            }
            _ => error.hint("write `|` between columns and `;` between rows"),
        }
    }

    // Mesh systems.

    /// The successor of a mesh rule: `eps`, a module or a template.
    pub(super) fn mesh_successor(&mut self) -> Parse<Successor> {
        let token = self.token();
        if self.take_keyword(Keyword::Eps) {
            return Ok(Successor::Word(vec![Element::Eps(token.span)]));
        }
        if self.peek() != TokenKind::Name && !self.is_symbol(token) {
            let error = self.empty_word("`->`");
            return self.stop(error);
        }
        if self.is_mesh_module() {
            return Ok(Successor::Word(vec![Element::Module(self.module("a module or template")?)]));
        }
        let name = self.name("a module or template")?;
        let args = self.optional_args()?;
        let place = self.template_place()?;
        let slots = self.optional_slots()?;
        Ok(Successor::Template(TemplateUse { name, args, place, slots, span: self.span_from(token.span) }))
    }

    /// A symbol or something tagged is a module, unless it is placed or filled as only a template can be.
    fn is_mesh_module(&self) -> bool {
        let behind = match self.peek_at(1) {
            TokenKind::Open(Bracket::Round) => self.token_at(self.at + 1).partner as usize + 1,
            _ => self.at + 1,
        };
        match self.token_at(behind).kind {
            TokenKind::AtSign => true,
            TokenKind::Keyword(Keyword::At | Keyword::On) | TokenKind::Open(Bracket::Curly) => false,
            _ => self.is_symbol(self.token()),
        }
    }

    fn template_place(&mut self) -> Parse<Option<TemplatePlace>> {
        let on = match self.peek() {
            TokenKind::Keyword(Keyword::At) => false,
            TokenKind::Keyword(Keyword::On) => true,
            _ => return Ok(None),
        };
        self.bump();
        Ok(Some(TemplatePlace { on, transforms: self.transforms()? }))
    }

    /// One or more words of an `at` or `on` clause.
    pub(super) fn transforms(&mut self) -> Parse<Vec<Transform>> {
        let mut transforms = Vec::new();
        while transforms.is_empty() || self.peek() == TokenKind::Name {
            let name = self.name("a transformation, such as `scale(2)`")?;
            transforms.push(Transform { name, args: self.optional_args()? });
        }
        Ok(transforms)
    }

    pub(super) fn optional_slots(&mut self) -> Parse<Option<Vec<Slot>>> {
        if !self.take_open(Bracket::Curly) {
            return Ok(None);
        }
        let mut slots = Vec::new();
        self.skip_newlines();
        while self.peek() != TokenKind::Close(Bracket::Curly) {
            slots.push(self.slot()?);
            if !matches!(
                self.peek(),
                TokenKind::Semicolon | TokenKind::Newline | TokenKind::Close(Bracket::Curly)
            ) {
                let error = self.unexpected("`;`, a new line or `}` after the slot");
                return self.stop(error);
            }
            // `;` at the end of a line is one separator with it.
            self.skip_newlines();
            self.take(TokenKind::Semicolon);
            self.skip_newlines();
        }
        self.close(Bracket::Curly)?;
        Ok(Some(slots))
    }

    fn slot(&mut self) -> Parse<Slot> {
        let names: Vec<Name> = self.list(|p| p.name("a slot's name"))?;
        self.expect(TokenKind::Colon, "`:` after the slot's name")?;
        let token = self.token();
        let fill = if self.take_keyword(Keyword::Eps) {
            SlotFill::Eps(token.span)
        } else {
            SlotFill::Module(self.module("a module or `eps`")?)
        };
        Ok(Slot { names, fill })
    }
}

/// `3, 1 and 2`.
fn listed(numbers: &[usize]) -> String {
    match numbers {
        [rest @ .., last] if !rest.is_empty() => {
            let rest: Vec<String> = rest.iter().map(usize::to_string).collect();
            format!("{} and {last}", rest.join(", "))
        }
        _ => numbers.iter().map(usize::to_string).collect(),
    }
}
