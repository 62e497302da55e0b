//! The steps under `run:`.

use super::{Parse, Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code, nearest};
use crate::language::lex::{Bracket, Keyword, excerpt};
use crate::language::syntax::{DeriveCount, Name, Run, Span, Step, StepKind};

const STEPS: [&str; 9] =
    ["derive", "subdivide", "place", "mark", "crease", "deposit", "trace", "repeat", "if"];

/// Whether a step begins with this word.
pub(super) fn is_step(text: &str) -> bool {
    STEPS.contains(&text)
}

impl Parser<'_> {
    /// `run:` and its steps.
    pub(super) fn run(&mut self) -> Parse<Run> {
        let start = self.bump().span;
        self.section_colon()?;
        let steps = self.steps();
        Ok(Run { steps, span: self.span_from(start) })
    }

    /// Steps up to the next declaration or the closing brace.
    fn steps(&mut self) -> Vec<Step> {
        let mut steps = Vec::new();
        loop {
            self.skip_newlines();
            match self.peek() {
                TokenKind::End | TokenKind::Close(Bracket::Curly) => return steps,
                TokenKind::Keyword(Keyword::Place) if !self.declares_place() => {}
                TokenKind::Keyword(keyword) if keyword.begins_item() => return steps,
                _ => {}
            }
            steps.extend(self.statement(Self::step));
        }
    }

    /// `place x = …` is a declaration, `place x` a step.
    fn declares_place(&self) -> bool {
        matches!(self.peek_at(2), TokenKind::Equal | TokenKind::Keyword(Keyword::On))
    }

    fn step(&mut self) -> Parse<Step> {
        self.foreign_beginning()?;
        let token = self.bump();
        let kind = match self.text_of(token) {
            "derive" => self.derive(),
            "subdivide" => self.subdivide(),
            "place" => self.name("a placement's name").map(StepKind::Place),
            "mark" => self.mark(),
            "crease" => self.crease(),
            "deposit" => self.deposit(),
            "trace" => self.trace(),
            "repeat" => self.repeat(),
            "if" => self.conditional(),
            _ => {
                self.at -= 1;
                self.no_step(token.span)
            }
        }?;
        let span = self.span_from(token.span);
        self.end_of_statement()?;
        Ok(Step { kind, span })
    }

    fn no_step<T>(&mut self, span: Span) -> Parse<T> {
        let token = self.token();
        if token.kind != TokenKind::Name {
            let error = self.unexpected("a step, such as `derive 3`");
            return self.stop(error);
        }
        let text = self.text_of(token);
        let hint = match nearest(text, STEPS) {
            Some(step) => format!("did you mean `{step}`?"),
            None if let Some(hint) = super::habits::meant_by(text) => hint.into(),
            None => format!("the steps are {}", STEPS.map(|s| format!("`{s}`")).join(", ")),
        };
        let message = format!("there is no step `{}`", excerpt(text));
        let error = Diagnostic::error(code::UNKNOWN_WORD, span, message).hint(hint);
        self.stop(error)
    }

    fn derive(&mut self) -> Parse<StepKind> {
        let until = self.is_word("until")
            && self.peek_at(1) == TokenKind::Name
            && self.text_of(self.token_at(self.at + 1)) == "terminal";
        let count = if until {
            self.at += 2;
            let max = if self.take_word("max") { Some(self.expr()?) } else { None };
            DeriveCount::UntilTerminal { max }
        } else {
            DeriveCount::Steps(self.expr()?)
        };
        let groups = if self.take_keyword(Keyword::With) {
            self.list(|p| p.name("the name of a group of rules"))?
        } else {
            Vec::new()
        };
        Ok(StepKind::Derive { count, groups })
    }

    fn subdivide(&mut self) -> Parse<StepKind> {
        let scheme = self.name("the name of a subdivision scheme")?;
        let levels = self.expr()?;
        let place =
            if self.take_keyword(Keyword::Place) { Some(self.name("a placement's name")?) } else { None };
        Ok(StepKind::Subdivide { scheme, levels, place })
    }

    fn mark(&mut self) -> Parse<StepKind> {
        let module = self.module("a module")?;
        self.expect(TokenKind::Colon, "`:` and a condition")?;
        let condition = self.expr()?;
        let isolated = self.take_word("isolated");
        Ok(StepKind::Mark { module, condition, isolated })
    }

    fn crease(&mut self) -> Parse<StepKind> {
        let sharpness = self.expr()?;
        self.expect(TokenKind::Colon, "`:` and a condition")?;
        Ok(StepKind::Crease { sharpness, condition: self.expr()? })
    }

    fn deposit(&mut self) -> Parse<StepKind> {
        let pattern = self.pattern()?;
        self.expect_word("into")?;
        let into = self.name("a volume's name")?;
        let condition = if self.take(TokenKind::Colon) { Some(self.expr()?) } else { None };
        Ok(StepKind::Deposit { pattern, into, condition })
    }

    fn trace(&mut self) -> Parse<StepKind> {
        self.expect_word("into")?;
        let into: Name = self.symbol("the symbol of the points")?;
        Ok(StepKind::Trace { into })
    }

    fn repeat(&mut self) -> Parse<StepKind> {
        let count = self.expr()?;
        Ok(StepKind::Repeat { count, body: self.body()? })
    }

    fn conditional(&mut self) -> Parse<StepKind> {
        let condition = self.expr()?;
        Ok(StepKind::If { condition, body: self.body()? })
    }

    /// Steps in braces.
    fn body(&mut self) -> Parse<Vec<Step>> {
        self.expect(TokenKind::Open(Bracket::Curly), "`{` and steps")?;
        self.nested(|p| {
            let steps = p.steps();
            p.close(Bracket::Curly)?;
            Ok(steps)
        })
    }
}
