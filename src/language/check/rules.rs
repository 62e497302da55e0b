//! Rules: what their predecessors bind and test, and when they fire.

use super::scope::{Local, Scope, Where};
use super::typing::{Operand, Term, as_literal};
use super::unreached::Reach;
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::rational::Rational;
use crate::language::syntax::{self, ContextPart, Item, Name, Pattern, PatternArg, PatternTag, Span};
use crate::language::system::{
    Alternative, Binder, BinderPlace, Context, Field, Group, Kind, Let, QueryUse, Rule, SymbolId, Topology,
};
use std::collections::HashMap;

/// The most rules of a system.
const MAX_RULES: usize = 4096;
/// The most modules of a context, one behind the other.
const MAX_CONTEXT: usize = 8;

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
                let findings = reach.add(self, rule, &checked);
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
                    let hint = suggest::nearest(&query.query.text, self.query_ids.keys().copied());
                    let message = format!("no query `{}` is declared", query.query.text);
                    let error = Diagnostic::error(code::UNKNOWN_QUERY, query.query.span, message);
                    self.report(error.hint_if(hint));
                    self.bind_broken(scope, &query.binder);
                }
            }
        }
        lowered
    }

    fn contexts_fit(&mut self, predecessor: &'a syntax::Predecessor) {
        let spans = [predecessor.left.as_ref().map(|c| c.span), predecessor.right.as_ref().map(|c| c.span)];
        if matches!(self.kind, Kind::Curve(_)) {
            return;
        }
        let kind = super::declare::kind_word(self.system.kind);
        for span in spans.into_iter().flatten() {
            let message = format!("rules of {kind} systems have no contexts");
            let hint = match self.kind {
                Kind::Mesh => "join faces by tags: `S@t & S@t -> template`",
                _ => "contexts of patches are reserved; a query may see what the rule needs",
            };
            self.report(Diagnostic::error(code::CONTEXT, span, message).hint(hint));
        }
    }

    fn left_context(&mut self, scope: &mut Scope<'a>, context: &'a syntax::LeftContext) -> Option<Context> {
        self.end_in_ring(context.end, context.span);
        self.context_depth(context.patterns.len(), context.span);
        let symbols: Vec<_> = context
            .patterns
            .iter()
            .enumerate()
            .map(|(module, p)| self.pattern(scope, p, |field| BinderPlace::Left { module, field }, None))
            .collect();
        let symbols = symbols.into_iter().collect::<Option<_>>()?;
        Some(Context { symbols, end: context.end, span: context.span })
    }

    fn right_context(&mut self, scope: &mut Scope<'a>, context: &'a syntax::RightContext) -> Option<Context> {
        let mut symbols = Vec::new();
        let depth = self.right_parts(scope, context, &mut symbols);
        self.context_depth(depth, context.span);
        let symbols = symbols.into_iter().collect::<Option<_>>()?;
        Some(Context { symbols, end: context.end, span: context.span })
    }

    /// Enters the modules of a right context as written; returns its depth.
    fn right_parts(
        &mut self,
        scope: &mut Scope<'a>,
        context: &'a syntax::RightContext,
        symbols: &mut Vec<Option<SymbolId>>,
    ) -> usize {
        self.end_in_ring(context.end, context.span);
        let (mut depth, mut deepest) = (0, 0);
        for part in &context.parts {
            match part {
                ContextPart::Pattern(pattern) => {
                    let module = symbols.len();
                    let place = |field| BinderPlace::Right { module, field };
                    symbols.push(self.pattern(scope, pattern, place, None));
                    depth += 1;
                }
                ContextPart::Branch(branch) => {
                    if matches!(self.kind, Kind::Curve(Topology::Ring | Topology::Open)) {
                        self.no_branches(branch.span);
                    }
                    deepest = deepest.max(depth + self.right_parts(scope, branch, symbols));
                }
            }
        }
        depth.max(deepest)
    }

    fn context_depth(&mut self, depth: usize, span: Span) {
        if depth > MAX_CONTEXT {
            let message = format!("a context is at most {MAX_CONTEXT} modules deep, and this one is {depth}");
            self.report(Diagnostic::error(code::CONTEXT_DEPTH, span, message));
        }
    }

    fn end_in_ring(&mut self, end: bool, span: Span) {
        if end && matches!(self.kind, Kind::Curve(Topology::Ring)) {
            let message = "a ring has no ends: this rule never fires";
            self.report(Diagnostic::warning(code::END_IN_RING, span, message));
        }
    }

    pub(super) fn no_branches(&mut self, span: Span) {
        let message = "only the words of `curve tree` have branches";
        let error = Diagnostic::error(code::BRANCH, span, message);
        self.report(error.hint(format!("write `system {} : curve tree`", self.system.name.text)));
    }

    /// What a pattern binds and tests. `joined` = its index among the strict predecessors.
    pub(super) fn pattern(
        &mut self,
        scope: &mut Scope<'a>,
        pattern: &'a Pattern,
        place: impl Fn(usize) -> BinderPlace,
        strict: Option<usize>,
    ) -> Option<SymbolId> {
        let symbol = self.symbol(&pattern.symbol);
        let usable = symbol.filter(|s| !self.broken_symbols.contains(s));
        match (usable, &pattern.args) {
            (_, None) => {}
            (None, Some(args)) => args.iter().for_each(|a| {
                if let PatternArg::Bind(name) = a {
                    self.bind_broken(scope, name);
                }
            }),
            (Some(symbol), Some(args)) => self.pattern_args(scope, pattern, symbol, args, place),
        }
        if let Some(tag) = &pattern.tag {
            self.pattern_tag(scope, pattern, tag, strict);
        }
        symbol
    }

    fn pattern_args(
        &mut self,
        scope: &mut Scope<'a>,
        pattern: &'a Pattern,
        symbol: SymbolId,
        args: &'a [PatternArg],
        place: impl Fn(usize) -> BinderPlace,
    ) {
        let fields: Vec<Field> = self.symbols[symbol].fields.clone();
        if fields.len() != args.len() {
            let symbol = &self.symbols[symbol];
            let message = format!(
                "`{}` has {}, but {} stand here",
                symbol.name,
                suggest::count(fields.len(), "parameter"),
                args.len()
            );
            let mut error = Diagnostic::error(code::MODULE_ARITY, pattern.span, message);
            if !symbol.span_is_use(pattern.symbol.span) {
                error = error.label(symbol.span, "it is declared here");
            }
            let names: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
            let hint = match names.as_slice() {
                [] => format!("write `{}`", symbol.name),
                names => format!(
                    "write `{}({})`, with `_` for what does not matter",
                    symbol.name,
                    names.join(", ")
                ),
            };
            self.report(error.hint(hint));
        }
        for (index, arg) in args.iter().enumerate() {
            match (arg, fields.get(index)) {
                (PatternArg::Bind(name), Some(field)) => {
                    self.bind(scope, name, field.ty.clone(), place(index))
                }
                (PatternArg::Bind(name), None) => self.bind_broken(scope, name),
                (PatternArg::Number(number), Some(field)) => {
                    self.number_test(scope, number, field, place(index));
                }
                (PatternArg::Bool(value, span), Some(field)) if field.ty == Type::Bool => {
                    self.literal_test(scope, Value::Bool(*value), *span, place(index));
                }
                (PatternArg::Bool(_, span), Some(field)) => self.literal_type(*span, field),
                (PatternArg::Any(_) | PatternArg::Number(_) | PatternArg::Bool(..), _) => {}
            }
        }
    }

    fn literal_type(&mut self, span: Span, field: &Field) {
        let message = format!("`{}` is {}", field.name, super::typing::article(&field.ty));
        let hint = match field.ty {
            Type::Vec2 | Type::Vec3 | Type::Vec4 => "bind it and test its components in the condition",
            Type::Bool => "write `true` or `false`",
            _ => "write a number of that type",
        };
        self.report(Diagnostic::error(code::TYPE, span, message).hint(hint));
    }

    fn number_test(
        &mut self,
        scope: &mut Scope<'a>,
        number: &syntax::SignedNumber,
        field: &Field,
        place: BinderPlace,
    ) {
        let span = number.number.span;
        let value = Rational::parse(&number.number.text);
        let value = value.and_then(|v| if number.negative { v.checked_neg() } else { Some(v) });
        let value = match field.ty {
            Type::Int => value.and_then(Rational::to_i32).map(Value::Int),
            Type::Float => value.and_then(Rational::to_f32).map(Value::Float),
            _ => None,
        };
        match value {
            Some(value) => self.literal_test(scope, value, span, place),
            None => self.literal_type(span, field),
        }
    }

    /// A literal of a pattern: a binder without a name, and a test of it.
    fn literal_test(&mut self, scope: &mut Scope<'a>, value: Value, span: Span, place: BinderPlace) {
        let index = scope.binders.len();
        scope.binders.push(Binder { name: "_".into(), ty: value.ty(), place });
        self.equal(scope, index, Expr::literal(value, span), span);
    }

    /// Binds a name; a second time it demands equality.
    pub(super) fn bind(&mut self, scope: &mut Scope<'a>, name: &'a Name, ty: Type, place: BinderPlace) {
        let index = scope.binders.len();
        scope.binders.push(Binder { name: name.text.clone(), ty: ty.clone(), place });
        match scope.locals.get(name.text.as_str()) {
            None => {
                self.reserved(name);
                self.hides(name);
                scope.locals.insert(&name.text, (Local::Binder(index), name.span));
            }
            Some((Local::Binder(first), span)) => {
                let (first, first_span) = (*first, *span);
                let first_ty = scope.binders[first].ty.clone();
                let numbers = |t: &Type| matches!(t, Type::Int | Type::Float);
                if first_ty != ty && !(numbers(&first_ty) && numbers(&ty)) {
                    let message = format!(
                        "`{}` is bound twice, which demands equality, but as {first_ty} and {ty}",
                        name.text
                    );
                    let error = Diagnostic::error(code::TYPE, name.span, message);
                    self.report(error.label(first_span, "the first is here"));
                    return;
                }
                let first = Expr { ty: first_ty, kind: ExprKind::Binder(first), span: name.span };
                self.equal(scope, index, first, name.span);
            }
            Some(_) => {}
        }
    }

    pub(super) fn bind_broken(&mut self, scope: &mut Scope<'a>, name: &'a Name) {
        scope.locals.entry(&name.text).or_insert((Local::Broken, name.span));
    }

    /// Demands that binder `index` equals `other`, vectors component by component.
    fn equal(&mut self, scope: &mut Scope<'a>, index: usize, other: Expr, span: Span) {
        let ty = scope.binders[index].ty.clone();
        let binder = Expr { ty: ty.clone(), kind: ExprKind::Binder(index), span };
        let operand = |expr: Expr| Operand { term: Term::Typed(expr), span };
        let components = match ty {
            Type::Vec2 | Type::Vec3 | Type::Vec4 => ty.words(),
            _ => 0,
        };
        let pairs: Vec<(Expr, Expr)> = match components {
            0 => vec![(other, binder)],
            n => {
                let component = |expr: &Expr, i| {
                    let kind = ExprKind::Component(Box::new(expr.clone()), i);
                    Expr { ty: Type::Float, kind, span }
                };
                (0..n).map(|i| (component(&other, i), component(&binder, i))).collect()
            }
        };
        for (a, b) in pairs {
            if let Some(Operand { term: Term::Typed(test), .. }) =
                self.operation("==", vec![operand(a), operand(b)], span)
            {
                scope.tests.push(test);
            }
        }
    }

    fn pattern_tag(
        &mut self,
        scope: &mut Scope<'a>,
        pattern: &'a Pattern,
        tag: &'a PatternTag,
        strict: Option<usize>,
    ) {
        let (Kind::Mesh, Some(module)) = (self.kind, strict) else {
            let message = "only the faces of mesh systems have tags";
            self.report(Diagnostic::error(code::TAG, pattern.span, message));
            return;
        };
        match tag {
            PatternTag::Bind(name) => self.bind(scope, name, Type::Int, BinderPlace::Tag { module }),
            PatternTag::Number(number) => match number.text.parse::<i32>() {
                Ok(value) => {
                    self.literal_test(scope, Value::Int(value), number.span, BinderPlace::Tag { module });
                }
                Err(_) => {
                    let message = format!("the tag {} is beyond the range of int", number.text);
                    self.report(Diagnostic::error(code::NUMBER, number.span, message));
                }
            },
        }
    }

    /// Several strict predecessors.
    fn strict_fits(&mut self, predecessor: &'a syntax::Predecessor) {
        if predecessor.strict.len() < 2 {
            return;
        }
        let span = predecessor.strict.iter().skip(1).fold(predecessor.strict[0].span, |s, p| s.to(p.span));
        match self.kind {
            Kind::Curve(_) => {}
            Kind::Patch { .. } => {
                let message = "a rule of a patch system replaces one module";
                let error = Diagnostic::error(code::STRICT, span, message);
                self.report(error.hint("several predecessors are reserved in patch systems"));
            }
            Kind::Mesh if !predecessor.joined => {
                let message = "faces that are joined stand with `&` between them";
                let error = Diagnostic::error(code::STRICT, span, message);
                self.report(error.hint("write `S@t & S@t -> template`"));
            }
            Kind::Mesh => self.join(predecessor, span),
        }
    }

    /// A join pairs faces by their tags: each predecessor needs one, and they must be the same.
    fn join(&mut self, predecessor: &'a syntax::Predecessor, span: Span) {
        let tag = |p: &Pattern| match &p.tag {
            Some(PatternTag::Bind(name)) => Some(name.text.clone()),
            Some(PatternTag::Number(number)) => Some(number.text.clone()),
            None => None,
        };
        let tags: Vec<Option<String>> = predecessor.strict.iter().map(tag).collect();
        let Some(first) = tags.iter().flatten().next() else {
            let message = "faces are joined by their tags, and these have none";
            let error = Diagnostic::error(code::TAG, span, message);
            self.report(error.hint("write `S@t & S@t -> template`"));
            return;
        };
        let other = tags.iter().position(|t| t.as_ref() != Some(first));
        if let Some(pattern) = other.and_then(|i| predecessor.strict.get(i)) {
            let message = format!("the tag `{first}` is used in only one predecessor of the join");
            let error = Diagnostic::error(code::TAG, pattern.span, message);
            self.report(error.hint(format!("write `{}@{first}`", pattern.symbol.text)));
        }
    }

    /// In one group all rules with several predecessors have the same number of them.
    fn strict_lengths(&mut self, rules: &'a [syntax::Rule]) {
        if !matches!(self.kind, Kind::Curve(_)) {
            return;
        }
        let mut first: Option<&syntax::Rule> = None;
        for rule in rules.iter().filter(|r| r.predecessor.strict.len() > 1) {
            let Some(first) = first else {
                first = Some(rule);
                continue;
            };
            let (wanted, given) = (first.predecessor.strict.len(), rule.predecessor.strict.len());
            if wanted != given {
                let message = format!("this rule replaces {given} modules, another of its group {wanted}");
                let error = Diagnostic::error(code::STRICT, rule.predecessor.span, message);
                let error = error.label(first.predecessor.span, "the other is here");
                self.report(error.hint("in one group rules replace one module or all the same number"));
            }
        }
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

trait SpanIsUse {
    fn span_is_use(&self, span: Span) -> bool;
}

impl SpanIsUse for crate::language::system::Symbol {
    /// Turtle symbols have no declaration; their span is their first use.
    fn span_is_use(&self, span: Span) -> bool {
        super::declare::TURTLE.iter().any(|(name, ..)| *name == self.name)
            || self.span.range() == span.range()
    }
}
