//! Rules: what their predecessors bind and test, and when they fire.

use super::scope::{Local, Scope, Where};
use super::typing::as_literal;
use super::unreached::Reach;
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, Type, Value};
use crate::language::syntax::{self, Item, Name, Span};
use crate::language::system::{Alternative, BinderPlace, Group, Let, QueryUse, Rule, SymbolId};
use std::collections::HashMap;

/// The most rules of a system.
const MAX_RULES: usize = 4096;

impl<'a> Checker<'a> {
    pub(super) fn groups(&mut self) -> Vec<Group> {
        let mut groups = Vec::new();
        let mut count = 0;
        for item in &self.system.items {
            let Item::Rules(rules) = item else { continue };
            if let Some(first) = rules.rules.get(MAX_RULES - count) {
                let message = format!("more than {MAX_RULES} rules in one system");
                self.report(Diagnostic::error(code::TOO_MANY_RULES, first.span, message));
                break;
            }
            count += rules.rules.len();
            groups.push(self.group(rules));
        }
        groups
    }

    fn group(&mut self, rules: &'a syntax::Rules) -> Group {
        let name = rules.group.as_ref().map_or_else(String::new, |n| n.text.clone());
        let mut reach = Reach::default();
        let mut labels: HashMap<&str, Span> = HashMap::new();
        let mut lowered = Vec::with_capacity(rules.rules.len());
        for (index, rule) in rules.rules.iter().enumerate() {
            if let Some(label) = &rule.label
                && let Some(first) = labels.insert(&label.text, label.span)
            {
                self.duplicate("rules", &label.text, label.span, first);
            }
            if let Some(checked) = self.rule(index, rule) {
                let findings = reach.add(rule, &checked);
                self.findings.extend(findings);
                lowered.push(checked);
            }
        }
        self.strict_lengths(&rules.rules);
        Group { name, rules: lowered }
    }

    fn rule(&mut self, index: usize, rule: &'a syntax::Rule) -> Option<Rule> {
        let predecessor = &rule.predecessor;
        let mut scope = Scope::new(Where::Rule);
        let queries = self.query_uses(&mut scope, &predecessor.queries);
        self.contexts_fit(predecessor);
        let left = predecessor.left.as_ref().map(|c| self.left_context(&mut scope, c));
        let strict: Vec<Option<SymbolId>> = predecessor
            .strict
            .iter()
            .enumerate()
            .map(|(module, p)| {
                self.pattern(&mut scope, p, |field| BinderPlace::Strict { module, field }, Some(module))
            })
            .collect();
        let right = predecessor.right.as_ref().map(|c| self.right_context(&mut scope, c));
        self.strict_fits(predecessor);
        for (name, value) in &rule.lets {
            self.let_value(&mut scope, name, value);
        }
        scope.decides = true;
        let condition = rule
            .condition
            .as_ref()
            .map(|c| self.expr(&mut scope, c, &Type::Bool, || "a condition is a bool".into()));
        scope.decides = false;
        let alternatives = self.alternatives(&mut scope, rule);
        let strict = strict.into_iter().collect::<Option<Vec<_>>>()?;
        Some(Rule {
            label: rule.label.as_ref().map(|l| l.text.clone()),
            index,
            queries,
            left: match left {
                Some(context) => Some(context?),
                None => None,
            },
            strict,
            right: match right {
                Some(context) => Some(context?),
                None => None,
            },
            binders: scope.binders,
            tests: scope.tests,
            lets: scope.lets,
            condition: match condition {
                Some(condition) => Some(condition?),
                None => None,
            },
            alternatives: alternatives?,
            span: rule.span,
        })
    }

    fn query_uses(&mut self, scope: &mut Scope<'a>, uses: &'a [syntax::QueryUse]) -> Vec<QueryUse> {
        let mut lowered = Vec::with_capacity(uses.len());
        for query in uses {
            match self.query_ids.get(query.query.text.as_str()).copied() {
                Some(Some(id)) => {
                    let ty = self.queries[id].ty.clone();
                    self.bind(scope, &query.binder, ty, BinderPlace::Query(lowered.len()));
                    lowered.push(QueryUse { query: id, span: query.query.span.to(query.binder.span) });
                }
                Some(None) => self.bind_broken(scope, &query.binder),
                None => {
                    let hint = self.nearest(&query.query.text, self.query_ids.keys().copied());
                    let message = format!("no query `{}` is declared", query.query.text);
                    let error = Diagnostic::error(code::UNKNOWN_QUERY, query.query.span, message);
                    self.report(error.hint_if(hint));
                    self.bind_broken(scope, &query.binder);
                }
            }
        }
        lowered
    }

    fn let_value(&mut self, scope: &mut Scope<'a>, name: &'a Name, value: &'a syntax::Expr) {
        let form = self.form(scope, value);
        let typed = self.free(scope, value);
        self.reserved(name);
        if let Some((_, first)) = scope.locals.get(name.text.as_str()) {
            let message = format!("`{}` is bound already", name.text);
            let error = Diagnostic::error(code::DUPLICATE, name.span, message);
            self.report(error.label(*first, "the first is here"));
            return;
        }
        self.hides(name);
        let local = match typed {
            Some(value) if matches!(value.ty, Type::List(..)) => {
                let message = format!("`{}` cannot be a list", name.text);
                let error = Diagnostic::error(code::LIST, value.span, message);
                self.report(error.hint("declare the list as a `const`"));
                Local::Broken
            }
            Some(value) => {
                scope.lets.push(Let { name: name.text.clone(), value });
                Local::Let(scope.lets.len() - 1)
            }
            None => Local::Broken,
        };
        if let Some(form) = form {
            scope.forms.insert(&name.text, form);
        }
        scope.locals.insert(&name.text, (local, name.span));
    }

    fn alternatives(&mut self, scope: &mut Scope<'a>, rule: &'a syntax::Rule) -> Option<Vec<Alternative>> {
        let weighted = rule.alternatives.iter().filter(|a| a.weight.is_some()).count();
        match rule.alternatives.as_slice() {
            [only] if weighted == 1 => {
                let span = only.weight.as_ref().map_or(only.span, |w| w.span);
                let message = "a weight needs a second alternative";
                let error = Diagnostic::error(code::WEIGHT, span, message);
                self.report(error.hint("write the chance as a condition: `: rand() < 0.1`"));
            }
            alternatives if alternatives.len() > 1 && weighted < alternatives.len() => {
                let bare = alternatives.iter().find(|a| a.weight.is_none());
                let span = bare.map_or(rule.span, |a| a.span);
                let message = "of several alternatives each needs a weight";
                let error = Diagnostic::error(code::WEIGHT, span, message);
                self.report(error.hint("write `->(0.5) …`, or one rule for each condition"));
            }
            _ => {}
        }
        let mut lowered = Vec::with_capacity(rule.alternatives.len());
        let mut whole = true;
        for alternative in &rule.alternatives {
            scope.decides = true;
            let weight = alternative.weight.as_ref().map(|w| self.weight(scope, w));
            scope.decides = false;
            let successor = self.successor(scope, &rule.predecessor, alternative);
            match (weight, successor) {
                (Some(None), _) | (_, None) => whole = false,
                (weight, Some(successor)) => {
                    let (weight, span) = (weight.flatten(), alternative.span);
                    lowered.push(Alternative { weight, successor, span });
                }
            }
        }
        whole.then_some(lowered)
    }

    fn weight(&mut self, scope: &mut Scope<'a>, weight: &'a syntax::Expr) -> Option<Expr> {
        let typed = self.expr(scope, weight, &Type::Float, || "a weight is a number".into())?;
        if let Some(Value::Float(value)) = as_literal(&typed)
            && value <= 0.0
        {
            let message = "this weight is never positive, so the alternative is never taken";
            let error = Diagnostic::error(code::WEIGHT, weight.span, message);
            self.report(error.hint("leave the alternative out"));
        }
        Some(typed)
    }
}
