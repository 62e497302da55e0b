//! Expressions: precedence climbing, with a bound on the height of the tree.

use super::{MAX_DEPTH, Parse, Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code};
use crate::language::lex::{Bracket, Keyword, excerpt};
use crate::language::syntax::{BinaryOp, Expr, ExprKind, Name, Number, Span, UnaryOp};

/// An expression and how high its tree is. All that walks the tree may recurse, so a long chain
/// of operators counts as nested just as brackets do.
struct Tree {
    expr: Expr,
    height: u32,
}

impl Parser<'_> {
    pub(super) fn expr(&mut self) -> Parse<Expr> {
        Ok(self.tree()?.expr)
    }

    fn tree(&mut self) -> Parse<Tree> {
        let tree = self.nested(|p| p.binary(1))?;
        self.foreign_operator(&tree.expr)?;
        Ok(tree)
    }

    fn grow(&mut self, kind: ExprKind, span: Span, below: u32) -> Parse<Tree> {
        if below >= MAX_DEPTH {
            let error = self.too_deep(span).hint("put parts of it into a `let` or `const`");
            return self.stop(error);
        }
        Ok(Tree { expr: Expr { kind, span }, height: below + 1 })
    }

    fn binary(&mut self, least: u8) -> Parse<Tree> {
        let mut left = self.unary()?;
        let mut compared = false;
        while let Some((op, length)) = self.operator() {
            if op.precedence() < least {
                break;
            }
            let operator = self.token().span;
            self.at += length;
            if op == BinaryOp::Rem {
                self.percentage(&left.expr, operator)?;
            }
            let right = self.binary(op.precedence() + 1)?;
            let comparison = is_comparison(op);
            if comparison && compared {
                self.chained(&left.expr, op, operator, &right.expr);
            }
            compared = comparison;
            let span = left.expr.span.to(right.expr.span);
            let below = left.height.max(right.height);
            left = self.grow(ExprKind::Binary(op, Box::new(left.expr), Box::new(right.expr)), span, below)?;
        }
        Ok(left)
    }

    /// The binary operator that stands here, and how many tokens it has.
    fn operator(&self) -> Option<(BinaryOp, usize)> {
        let op = match self.peek() {
            TokenKind::And if self.doubled() => return Some((BinaryOp::And, 2)),
            TokenKind::Bar if self.doubled() => return Some((BinaryOp::Or, 2)),
            TokenKind::EqualEqual => BinaryOp::Equal,
            TokenKind::NotEqual => BinaryOp::NotEqual,
            TokenKind::Less => BinaryOp::Less,
            TokenKind::LessEqual => BinaryOp::LessEqual,
            TokenKind::Greater => BinaryOp::Greater,
            TokenKind::GreaterEqual => BinaryOp::GreaterEqual,
            TokenKind::Plus => BinaryOp::Add,
            TokenKind::Minus => BinaryOp::Sub,
            TokenKind::Star => BinaryOp::Mul,
            TokenKind::Slash => BinaryOp::Div,
            TokenKind::Percent => BinaryOp::Rem,
            _ => return None,
        };
        Some((op, 1))
    }

    /// The next token is the same, without a space between.
    fn doubled(&self) -> bool {
        let (this, next) = (self.token(), self.token_at(self.at + 1));
        this.kind == next.kind && this.span.end == next.span.start
    }

    fn unary(&mut self) -> Parse<Tree> {
        let op = match self.peek() {
            TokenKind::Minus => UnaryOp::Neg,
            TokenKind::Bang => UnaryOp::Not,
            _ => return self.postfix(),
        };
        let start = self.bump().span;
        let operand = self.nested(Self::unary)?;
        let span = start.to(operand.expr.span);
        self.grow(ExprKind::Unary(op, Box::new(operand.expr)), span, operand.height)
    }

    fn postfix(&mut self) -> Parse<Tree> {
        let mut base = self.primary()?;
        loop {
            let start = base.expr.span;
            if self.take(TokenKind::Dot) {
                let field = self.name("a component's name")?;
                let span = start.to(field.span);
                base = self.grow(ExprKind::Field(Box::new(base.expr), field), span, base.height)?;
            } else if self.take_open(Bracket::Square) {
                let index = self.tree()?;
                let end = self.close(Bracket::Square)?.span;
                let below = base.height.max(index.height);
                base = self.grow(
                    ExprKind::Index(Box::new(base.expr), Box::new(index.expr)),
                    start.to(end),
                    below,
                )?;
            } else {
                return Ok(base);
            }
        }
    }

    fn primary(&mut self) -> Parse<Tree> {
        let token = self.token();
        match token.kind {
            TokenKind::Number => {
                self.bump();
                let text = self.text_of(token).to_owned();
                self.grow(ExprKind::Number(Number { text, span: token.span }), token.span, 0)
            }
            TokenKind::Name => self.named(),
            TokenKind::Open(Bracket::Round) => self.vector(),
            TokenKind::Open(Bracket::Square) => self.list_constant(),
            _ => self.no_expression(),
        }
    }

    fn named(&mut self) -> Parse<Tree> {
        self.if_without_brackets()?;
        let token = self.bump();
        let text = self.text_of(token);
        if self.take_open(Bracket::Round) {
            let (args, below) = self.arguments(Bracket::Round)?;
            let name = Name { text: text.to_owned(), span: token.span };
            return self.grow(ExprKind::Call(name, args), self.span_from(token.span), below);
        }
        let kind = match text {
            "true" => ExprKind::Bool(true),
            "false" => ExprKind::Bool(false),
            _ => ExprKind::Name(text.to_owned()),
        };
        self.grow(kind, token.span, 0)
    }

    /// Expressions up to the closing bracket, and the height of the highest.
    fn arguments(&mut self, bracket: Bracket) -> Parse<(Vec<Expr>, u32)> {
        let mut highest = 0;
        if bracket == Bracket::Round && self.take(TokenKind::Close(bracket)) {
            return Ok((Vec::new(), highest));
        }
        let args = self.list(|p| {
            let tree = p.tree()?;
            highest = highest.max(tree.height);
            Ok(tree.expr)
        })?;
        if self.peek() != TokenKind::Close(bracket) {
            let error = self.unexpected(&format!("`,` or `{}`", bracket.close()));
            return self.stop(error);
        }
        self.bump();
        Ok((args, highest))
    }

    /// `(a)` is a; `(a, b)` is a vector.
    fn vector(&mut self) -> Parse<Tree> {
        let start = self.bump().span;
        let (mut parts, below) = self.arguments(Bracket::Round)?;
        let span = self.span_from(start);
        match parts.len() {
            0 => {
                let error = Diagnostic::error(code::UNEXPECTED, span, "nothing stands in these brackets");
                self.stop(error)
            }
            1 => {
                let expr = Expr { span, ..parts.remove(0) };
                Ok(Tree { expr, height: below })
            }
            _ => self.grow(ExprKind::Vector(parts), span, below),
        }
    }

    fn list_constant(&mut self) -> Parse<Tree> {
        let start = self.bump().span;
        let (parts, below) = self.arguments(Bracket::Square)?;
        self.grow(ExprKind::List(parts), self.span_from(start), below)
    }

    /// A list constant and nothing behind it.
    pub(super) fn list_expr(&mut self) -> Parse<Expr> {
        Ok(self.nested(Self::list_constant)?.expr)
    }

    /// The arguments of a module, template or shape, if an opening bracket stands here.
    pub(super) fn optional_args(&mut self) -> Parse<Option<Vec<Expr>>> {
        if !self.take_open(Bracket::Round) {
            return Ok(None);
        }
        Ok(Some(self.arguments(Bracket::Round)?.0))
    }

    // What people who know other languages write.

    fn no_expression<T>(&mut self) -> Parse<T> {
        let span = self.token().span;
        let error = match self.peek() {
            TokenKind::Keyword(Keyword::Eps) => {
                Diagnostic::error(code::MISPLACED_EPS, span, "`eps` is not a value")
                    .hint("`eps` stands only in a successor, a block, a slot or an axiom")
            }
            TokenKind::Keyword(keyword) => {
                let message = format!("`{}` is a keyword and cannot stand in an expression", keyword.text());
                Diagnostic::error(code::KEYWORD_AS_NAME, span, message)
            }
            TokenKind::Star if self.follows_star() => {
                Diagnostic::error(code::FOREIGN_OPERATOR, span, "there is no operator `**`")
                    .hint("write `pow(a, b)`")
            }
            _ => self.unexpected("an expression"),
        };
        self.stop(error)
    }

    fn follows_star(&self) -> bool {
        self.at.checked_sub(1).is_some_and(|before| {
            let before = self.tokens[before];
            before.kind == TokenKind::Star && before.span.end == self.token().span.start
        })
    }

    /// `30%` as a weight.
    fn percentage(&mut self, left: &Expr, operator: Span) -> Parse<()> {
        let ends =
            matches!(self.peek(), TokenKind::Close(_) | TokenKind::Comma) || self.at_end_of_statement();
        if !ends {
            return Ok(());
        }
        let span = left.span.to(operator);
        let value = match &left.kind {
            ExprKind::Number(n) => n.text.parse::<f64>().ok().map(|x| x / 100.0),
            _ => None,
        };
        let hint = match value {
            Some(value) => format!("write `{value}`"),
            None => "`%` is the remainder of a division; divide by 100 for per cent".into(),
        };
        let error = Diagnostic::error(code::FOREIGN_RULE, span, "`%` does not mean per cent").hint(hint);
        self.stop(error)
    }

    fn chained(&mut self, left: &Expr, op: BinaryOp, operator: Span, right: &Expr) {
        let written = |span: Span| excerpt(&self.text[span.range()]);
        let middle = match &left.kind {
            ExprKind::Binary(_, _, middle) => written(middle.span),
            _ => written(left.span),
        };
        let hint =
            format!("write `{} && {middle} {} {}`", written(left.span), op.token(), written(right.span));
        let message = "comparisons do not chain";
        self.report(Diagnostic::error(code::CHAINED_COMPARISON, operator, message).hint(hint));
    }

    /// Nothing of this can follow an expression, so it says what was meant.
    fn foreign_operator(&mut self, before: &Expr) -> Parse<()> {
        let token = self.token();
        let hint = match token.kind {
            // Without a reader a hint is not worth the trial, which might find the next `?`.
            TokenKind::Question if self.silent => return Err(super::Stop),
            TokenKind::Question => self.conditional_hint(before),
            TokenKind::And => "write `&&`".to_owned(),
            TokenKind::Bar => "write `||`".to_owned(),
            TokenKind::Equal => "write `==` to compare".to_owned(),
            TokenKind::Caret => "write `pow(a, b)`".to_owned(),
            TokenKind::Name => match self.text_of(token) {
                "and" => "write `&&`".to_owned(),
                "or" => "write `||`".to_owned(),
                "mod" => "write `%`".to_owned(),
                _ => return Ok(()),
            },
            _ => return Ok(()),
        };
        let message = format!("`{}` is not an operator of expressions", self.text_of(token));
        let error = Diagnostic::error(code::FOREIGN_OPERATOR, token.span, message).hint(hint);
        self.stop(error)
    }

    /// `if(c, a, b)` for `c ? a : b`.
    fn conditional_hint(&mut self, condition: &Expr) -> String {
        let mut parts = None;
        self.try_out(|p| {
            p.bump();
            let yes = p.expr()?.span;
            p.expect(TokenKind::Colon, "`:`")?;
            parts = Some((yes, p.expr()?.span));
            Ok(())
        });
        let written = |span: Span| excerpt(&self.text[span.range()]);
        match parts {
            Some((yes, no)) => {
                format!("write `if({}, {}, {})`", written(condition.span), written(yes), written(no))
            }
            None => format!("write `if({}, a, b)`", written(condition.span)),
        }
    }
}

fn is_comparison(op: BinaryOp) -> bool {
    op.precedence() == BinaryOp::Less.precedence()
}
