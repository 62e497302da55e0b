//! Rules: labels, predecessors with their contexts, conditions, alternatives.

use super::symbols::is_operator_symbol;
use super::{MAX_RULES, Parse, Parser, TokenKind};
use crate::language::diagnostic::{Diagnostic, code};
use crate::language::lex::{Bracket, Keyword, excerpt};
use crate::language::syntax::{
    Alternative, ContextPart, Expr, Kind, LeftContext, Name, Pattern, PatternArg, PatternTag, Predecessor,
    QueryUse, RightContext, Rule, Rules, SignedNumber, Span, Successor,
};

impl Parser<'_> {
    /// `rules [NAME]:` and all rules up to the next declaration.
    pub(super) fn rules(&mut self) -> Parse<Rules> {
        let start = self.bump().span;
        let group = match self.peek() {
            TokenKind::Colon | TokenKind::Newline => None,
            _ => Some(self.name("the group's name, or `:`")?),
        };
        self.section_colon()?;
        let mut rules = Vec::new();
        self.in_rules = true;
        self.rule_before = None;
        loop {
            self.skip_newlines();
            match self.peek() {
                TokenKind::End => break,
                TokenKind::Keyword(keyword) if keyword.begins_item() => break,
                _ => {}
            }
            let rule = self.statement(Self::rule).flatten();
            self.rule_before =
                rule.as_ref().map(|rule| Span { start: rule.span.end.saturating_sub(1), ..rule.span });
            if let Some(rule) = rule {
                self.keep_rule(rule, &mut rules);
            }
        }
        self.in_rules = false;
        Ok(Rules { group, rules, span: self.span_from(start) })
    }

    fn keep_rule(&mut self, rule: Rule, rules: &mut Vec<Rule>) {
        self.rule_count += 1;
        if self.rule_count <= MAX_RULES {
            rules.push(rule);
        } else if self.rule_count == MAX_RULES + 1 {
            let message = format!("more than {MAX_RULES} rules in one system");
            self.report(Diagnostic::error(code::TOO_MANY_RULES, rule.span, message));
        }
    }

    /// One rule; nothing for `# -> #`, which does nothing.
    fn rule(&mut self) -> Parse<Option<Rule>> {
        self.foreign_beginning()?;
        self.no_rule()?;
        self.numeric_label();
        let start = self.token().span;
        let label = self.label();
        if self.take_idle_rule() {
            self.end_of_statement()?;
            return Ok(None);
        }
        let predecessor = self.predecessor()?;
        let lets = self.lets()?;
        let condition = self.condition()?;
        self.before_arrow(start)?;
        let mut alternatives = Vec::new();
        while self.peek() == TokenKind::Arrow {
            alternatives.push(self.alternative()?);
        }
        self.behind_successor()?;
        let span = self.span_from(start);
        self.end_of_statement()?;
        Ok(Some(Rule { label, predecessor, lets, condition, alternatives, span }))
    }

    /// A name before `:` is a label only if a predecessor follows and it is no symbol.
    fn label(&mut self) -> Option<Name> {
        let token = self.token();
        if token.kind != TokenKind::Name || self.peek_at(1) != TokenKind::Colon || self.is_symbol(token) {
            return None;
        }
        let fits = self.try_out(|p| {
            p.at += 2;
            p.predecessor()?;
            match p.peek() {
                TokenKind::Colon | TokenKind::Arrow | TokenKind::Keyword(Keyword::Let) => Ok(()),
                _ => Err(super::Stop),
            }
        });
        if !fits && !self.looks_like_label() {
            return None;
        }
        self.at += 2;
        Some(Name { text: self.text_of(token).to_owned(), span: token.span })
    }

    /// What follows is no predecessor, but was probably meant as one.
    fn looks_like_label(&self) -> bool {
        let next = self.token_at(self.at + 2);
        matches!(next.kind, TokenKind::Question | TokenKind::Hash)
            || self.is_symbol(next) && next.kind == TokenKind::Name
            || self.statement_holds(self.at + 2, TokenKind::Colon)
    }

    /// Whether the token stands between place `at` and the next `->` or the end of the statement,
    /// outside of brackets.
    pub(super) fn statement_holds(&self, mut at: usize, kind: TokenKind) -> bool {
        loop {
            let token = self.token_at(at);
            match token.kind {
                found if found == kind => return true,
                TokenKind::Arrow | TokenKind::Newline | TokenKind::End => return false,
                TokenKind::Open(_) => at = token.partner as usize + 1,
                _ => at += 1,
            }
        }
    }

    fn take_idle_rule(&mut self) -> bool {
        let idle = self.kind == Kind::Curve
            && self.peek() == TokenKind::Hash
            && self.peek_at(1) == TokenKind::Arrow
            && self.peek_at(2) == TokenKind::Hash;
        if idle {
            self.at += 3;
        }
        idle
    }

    // The predecessor.

    fn predecessor(&mut self) -> Parse<Predecessor> {
        let start = self.token().span;
        let mut queries = Vec::new();
        while self.take(TokenKind::Question) {
            queries.push(self.query_use()?);
        }
        let context = self.token().span;
        let end = self.take(TokenKind::Hash);
        let mut strict = self.patterns()?;
        let mut left = None;
        if self.peek() == TokenKind::Less {
            if !end && strict.is_empty() {
                let error = self.unexpected("the left context before `<`");
                return self.stop(error);
            }
            left = Some(LeftContext { end, patterns: strict, span: self.span_from(context) });
            self.bump();
            strict = self.patterns()?;
        } else if end {
            let message = "`#` at the left belongs to a left context";
            let error = Diagnostic::error(code::NO_PREDECESSOR, context, message)
                .hint("write `# <` before the predecessor");
            return self.stop(error);
        }
        if strict.is_empty() {
            return self.no_predecessor();
        }
        let joined = self.joined(&mut strict)?;
        let right = if self.take(TokenKind::Greater) { Some(self.right_context()?) } else { None };
        if let TokenKind::Less | TokenKind::Greater = self.peek() {
            let error = Diagnostic::error(code::UNEXPECTED, self.token().span, "one context too many")
                .hint("a rule is `left < predecessor > right -> successor`");
            return self.stop(error);
        }
        Ok(Predecessor { queries, left, strict, joined, right, span: self.span_from(start) })
    }

    fn no_predecessor<T>(&mut self) -> Parse<T> {
        let span = self.token().span;
        let error = match self.peek() {
            TokenKind::Greater | TokenKind::Arrow | TokenKind::Colon => {
                let message = "this rule has no predecessor";
                Diagnostic::error(code::NO_PREDECESSOR, span, message)
                    .hint("write the module that is replaced before this")
            }
            TokenKind::Keyword(Keyword::Eps) => {
                Diagnostic::error(code::MISPLACED_EPS, span, "`eps` cannot be replaced")
                    .hint("write the module that is replaced")
            }
            TokenKind::Keyword(keyword) => {
                let message = format!("`{}` is a keyword and cannot be a symbol", keyword.text());
                Diagnostic::error(code::KEYWORD_AS_NAME, span, message).hint("choose another name")
            }
            _ => self.unexpected("a rule's predecessor"),
        };
        self.stop(error)
    }

    fn query_use(&mut self) -> Parse<QueryUse> {
        let query = self.name("a query's name")?;
        self.expect(TokenKind::Open(Bracket::Round), "`(` and the name for its value")?;
        let binder = self.name("the name for the query's value")?;
        self.close(Bracket::Round)?;
        Ok(QueryUse { query, binder })
    }

    /// `S & S`; in curve systems `&` is a symbol.
    fn joined(&mut self, strict: &mut Vec<Pattern>) -> Parse<bool> {
        let mut joined = false;
        while self.kind != Kind::Curve && self.take(TokenKind::And) {
            strict.push(self.pattern()?);
            joined = true;
        }
        Ok(joined)
    }

    fn begins_pattern(&self) -> bool {
        let token = self.token();
        let joins = token.kind == TokenKind::And && self.kind != Kind::Curve;
        token.kind == TokenKind::Name || is_operator_symbol(token.kind) && !joins && self.is_symbol(token)
    }

    fn patterns(&mut self) -> Parse<Vec<Pattern>> {
        let mut patterns = Vec::new();
        while self.begins_pattern() {
            patterns.push(self.pattern()?);
        }
        Ok(patterns)
    }

    fn right_context(&mut self) -> Parse<RightContext> {
        let start = self.token().span;
        let mut parts = Vec::new();
        loop {
            if self.take_open(Bracket::Square) {
                let branch = self.nested(Self::right_context)?;
                self.close(Bracket::Square)?;
                parts.push(ContextPart::Branch(branch));
            } else if self.begins_pattern() {
                parts.push(ContextPart::Pattern(self.pattern()?));
            } else {
                break;
            }
        }
        let end = self.take(TokenKind::Hash);
        if parts.is_empty() && !end {
            let error = self.unexpected("a right context: modules, `[ … ]` or `#`");
            return self.stop(error);
        }
        Ok(RightContext { parts, end, span: self.span_from(start) })
    }

    pub(super) fn pattern(&mut self) -> Parse<Pattern> {
        let symbol = self.symbol("a module")?;
        let start = symbol.span;
        let args = if self.take_open(Bracket::Round) { Some(self.pattern_args()?) } else { None };
        let tag = if self.take(TokenKind::AtSign) { Some(self.pattern_tag()?) } else { None };
        Ok(Pattern { symbol, args, tag, span: self.span_from(start) })
    }

    fn pattern_args(&mut self) -> Parse<Vec<PatternArg>> {
        let mut args = Vec::new();
        if self.take(TokenKind::Close(Bracket::Round)) {
            return Ok(args);
        }
        loop {
            args.push(self.pattern_arg()?);
            match self.peek() {
                TokenKind::Comma => _ = self.bump(),
                TokenKind::Close(Bracket::Round) => break,
                _ => return self.bad_pattern(),
            }
        }
        self.bump();
        Ok(args)
    }

    fn pattern_arg(&mut self) -> Parse<PatternArg> {
        let token = self.token();
        match token.kind {
            TokenKind::Name => {
                self.bump();
                Ok(match self.text_of(token) {
                    "_" => PatternArg::Any(token.span),
                    "true" => PatternArg::Bool(true, token.span),
                    "false" => PatternArg::Bool(false, token.span),
                    name => PatternArg::Bind(Name { text: name.to_owned(), span: token.span }),
                })
            }
            TokenKind::Keyword(_) => match self.name("the name for a parameter") {
                Ok(name) => Ok(PatternArg::Bind(name)),
                Err(stop) => Err(stop),
            },
            TokenKind::Number => self.signed_number("a number").map(PatternArg::Number),
            TokenKind::Minus if self.peek_at(1) == TokenKind::Number => {
                self.signed_number("a number").map(PatternArg::Number)
            }
            _ => self.bad_pattern(),
        }
    }

    fn bad_pattern<T>(&mut self) -> Parse<T> {
        let before = self.at.checked_sub(1).map(|before| self.tokens[before]);
        if let (TokenKind::Percent, Some(number)) = (self.peek(), before)
            && number.kind == TokenKind::Number
        {
            let span = number.span.to(self.token().span);
            let share = self.text_of(number).parse::<f64>().map_or(0.5, |percent| percent / 100.0);
            let error =
                Diagnostic::error(code::FOREIGN_RULE, span, "a weight does not stand in the predecessor");
            return self.stop(error.hint(format!("write it behind the arrow: `->({share}) …`")));
        }
        let message = format!("{} cannot stand in a pattern", self.found());
        let error = Diagnostic::error(code::BAD_PATTERN, self.token().span, message)
            .hint("a pattern holds names, numbers, `true`, `false` and `_`; test the value in the condition");
        self.stop(error)
    }

    fn pattern_tag(&mut self) -> Parse<PatternTag> {
        if self.peek() == TokenKind::Number {
            return self.whole("a whole number").map(PatternTag::Number);
        }
        if self.open(Bracket::Round) {
            let message = "an expression cannot stand in a pattern";
            let error = Diagnostic::error(code::BAD_PATTERN, self.token().span, message)
                .hint("a tag in a pattern is a name or a whole number");
            return self.stop(error);
        }
        self.name("a tag: a name or a whole number").map(PatternTag::Bind)
    }

    pub(super) fn signed_number(&mut self, what: &str) -> Parse<SignedNumber> {
        let negative = self.take(TokenKind::Minus);
        Ok(SignedNumber { negative, number: self.number(what)? })
    }

    // Behind the predecessor.

    fn lets(&mut self) -> Parse<Vec<(Name, Expr)>> {
        if !self.take_keyword(Keyword::Let) {
            return Ok(Vec::new());
        }
        self.list(|p| {
            let name = p.name("a name for the value")?;
            p.expect(TokenKind::Equal, "`=`")?;
            Ok((name, p.expr()?))
        })
    }

    fn condition(&mut self) -> Parse<Option<Expr>> {
        if !self.take(TokenKind::Colon) {
            return Ok(None);
        }
        if self.peek() == TokenKind::Star && self.peek_at(1) == TokenKind::Arrow {
            let message = "`*` is not a condition";
            let error = Diagnostic::error(code::FOREIGN_RULE, self.token().span, message)
                .hint("a rule without condition needs no `:`");
            return self.stop(error);
        }
        self.condition_with_if()?;
        let condition = self.expr()?;
        if self.peek() == TokenKind::Keyword(Keyword::Let) {
            let error =
                Diagnostic::error(code::UNEXPECTED, self.token().span, "`let` stands behind the condition")
                    .hint("write `let` before the condition: it may use what `let` defines");
            return self.stop(error);
        }
        Ok(Some(condition))
    }

    fn before_arrow(&mut self, start: Span) -> Parse<()> {
        if self.peek() == TokenKind::Arrow {
            return Ok(());
        }
        let line = self.span_from(start);
        let error = if self.at_end_of_statement()
            && let Some(error) = self.line_without_arrow(line)
        {
            error
        } else if self.peek() == TokenKind::Equal {
            Diagnostic::error(code::FOREIGN_RULE, self.token().span, "a rule is not written with `=`")
                .hint("write `->`")
        } else {
            self.unexpected("`->`").hint("a rule is `predecessor : condition -> successor`")
        };
        self.stop(error)
    }

    fn alternative(&mut self) -> Parse<Alternative> {
        let start = self.bump().span;
        let weight = if self.take_open(Bracket::Round) {
            let weight = self.expr()?;
            self.close(Bracket::Round)?;
            Some(weight)
        } else {
            None
        };
        let successor = match self.kind {
            Kind::Mesh => self.mesh_successor()?,
            Kind::Curve | Kind::Patch => Successor::Word(self.word("`->`")?),
        };
        Ok(Alternative { weight, successor, span: self.span_from(start) })
    }

    fn behind_successor(&mut self) -> Parse<()> {
        if self.at_end_of_statement() {
            return Ok(());
        }
        let span = self.token().span;
        let error = match self.peek() {
            TokenKind::Colon => self.weight_behind(span),
            TokenKind::Star => Diagnostic::error(code::FOREIGN_RULE, span, "`*` cannot stand in a word")
                .hint("write `eps` to erase"),
            TokenKind::Hash => Diagnostic::error(code::UNEXPECTED, span, "`#` is never written in a word")
                .hint("`#` marks an end only in the contexts of a predecessor"),
            TokenKind::Equal => Diagnostic::error(code::FOREIGN_RULE, span, "a rule is not written with `=`")
                .hint("write `->`"),
            TokenKind::Less | TokenKind::Greater => {
                Diagnostic::error(code::UNEXPECTED, span, "a context cannot stand in a successor")
                    .hint("contexts stand before `->`: `left < predecessor > right -> successor`")
            }
            TokenKind::Name if self.kind == Kind::Mesh => {
                let message = "a mesh rule has one successor: `eps`, a module or a template";
                Diagnostic::error(code::UNEXPECTED, span, message)
                    .hint("write `{ slot: MODULE }` behind a template to name its faces")
            }
            _ => self.behind_statement().unwrap_or_else(|| self.unexpected("the end of the rule")),
        };
        self.stop(error)
    }

    /// `A -> F : 0.3`, a weight or condition at the wrong end.
    fn weight_behind(&mut self, span: Span) -> Diagnostic {
        let mut value = None;
        self.try_out(|p| {
            p.bump();
            value = Some(p.expr()?.span);
            Ok(())
        });
        let written = value.map_or("0.5".to_owned(), |s| excerpt(&self.text[s.range()]));
        Diagnostic::error(code::FOREIGN_RULE, span, "nothing can stand behind the successor").hint(format!(
            "write a weight as `->({written}) …`, a condition as `: {written} -> …` before the arrow"
        ))
    }

    /// A line among the rules that was meant as something else.
    fn no_rule(&mut self) -> Parse<()> {
        let token = self.token();
        let named = token.kind == TokenKind::Name && !self.is_symbol(token);
        if !named || self.statement_holds(self.at, TokenKind::Less) || self.has_arrow() {
            return Ok(());
        }
        let text = self.text_of(token);
        let hint = match self.nearest_item(text) {
            Some(item) => format!("did you mean `{item}`?"),
            None if super::run::is_step(text) => "steps stand under `run:`".into(),
            None => match super::habits::meant_by(text) {
                Some(hint) => hint.into(),
                None => return Ok(()),
            },
        };
        let message = format!("`{}` begins no rule", excerpt(text));
        let error = Diagnostic::error(code::UNKNOWN_WORD, token.span, message).hint(hint);
        self.stop(error)
    }

    pub(super) fn has_arrow(&self) -> bool {
        self.statement_holds(self.at, TokenKind::Arrow)
    }
}
