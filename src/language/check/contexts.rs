//! Contexts, and rules with several strict predecessors.

use super::scope::Scope;
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::syntax::{self, ContextPart, Pattern, PatternTag, Span};
use crate::language::system::{self, BinderPlace, Context, Kind, SymbolId, Topology};

/// The most modules of a context, one behind the other.
const MAX_CONTEXT: usize = 8;

impl<'a> Checker<'a> {
    pub(super) fn contexts_fit(&mut self, predecessor: &'a syntax::Predecessor) {
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

    pub(super) fn left_context(
        &mut self,
        scope: &mut Scope<'a>,
        context: &'a syntax::LeftContext,
    ) -> Option<Context> {
        self.end_in_ring(context.end, context.span);
        self.context_depth(context.patterns.len(), context.span);
        let symbols: Vec<_> = context
            .patterns
            .iter()
            .enumerate()
            .map(|(module, p)| self.pattern(scope, p, |field| BinderPlace::Left { module, field }, None))
            .collect();
        let symbols = symbols.into_iter().collect::<Option<_>>()?;
        Some(Context { symbols, parts: Vec::new(), end: context.end, span: context.span })
    }

    pub(super) fn right_context(
        &mut self,
        scope: &mut Scope<'a>,
        context: &'a syntax::RightContext,
    ) -> Option<Context> {
        let mut symbols = Vec::new();
        let (depth, parts) = self.right_parts(scope, context, &mut symbols);
        self.context_depth(depth, context.span);
        let symbols = symbols.into_iter().collect::<Option<_>>()?;
        Some(Context { symbols, parts, end: context.end, span: context.span })
    }

    /// Enters the modules of a right context as written; returns its depth and its form.
    fn right_parts(
        &mut self,
        scope: &mut Scope<'a>,
        context: &'a syntax::RightContext,
        symbols: &mut Vec<Option<SymbolId>>,
    ) -> (usize, Vec<system::ContextPart>) {
        self.end_in_ring(context.end, context.span);
        let (mut depth, mut deepest) = (0, 0);
        let mut form = Vec::new();
        for part in &context.parts {
            match part {
                ContextPart::Pattern(pattern) => {
                    let module = symbols.len();
                    let place = |field| BinderPlace::Right { module, field };
                    symbols.push(self.pattern(scope, pattern, place, None));
                    form.push(system::ContextPart::Module(module));
                    depth += 1;
                }
                ContextPart::Branch(branch) => {
                    if matches!(self.kind, Kind::Curve(Topology::Ring | Topology::Open)) {
                        self.no_branches(branch.span);
                    }
                    let (inside, mut parts) = self.right_parts(scope, branch, symbols);
                    deepest = deepest.max(depth + inside);
                    // A branch that begins with branches is so many more.
                    let is_branch =
                        |part: &system::ContextPart| matches!(part, system::ContextPart::Branch(..));
                    let rest = parts.split_off(parts.iter().take_while(|part| is_branch(part)).count());
                    form.extend(parts);
                    if !rest.is_empty() {
                        form.push(system::ContextPart::Branch(rest, branch.end));
                    }
                }
            }
        }
        (depth.max(deepest), form)
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

    /// Several strict predecessors.
    pub(super) fn strict_fits(&mut self, predecessor: &'a syntax::Predecessor) {
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
    pub(super) fn strict_lengths(&mut self, rules: &'a [syntax::Rule]) {
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
}
