//! The steps of `run:`.

use super::scope::{Scope, Where};
use super::typing::as_literal;
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, Type, Value};
use crate::language::syntax::{self, DeriveCount, Element, Item, Name, Span};
use crate::language::system::{BinderPlace, FaceModule, Kind, Step, StepKind, SymbolId, Topology};

impl<'a> Checker<'a> {
    /// The lowered steps; without a `run:` one step of the unnamed group.
    pub(super) fn run(&mut self) -> Vec<Step> {
        let written = self.system.items.iter().find_map(|item| match item {
            Item::Run(run) => Some(run),
            _ => None,
        });
        match written {
            Some(run) => {
                let steps = self.steps(&run.steps, true);
                self.context_wraps();
                steps
            }
            None if self.group_ids.is_empty() => Vec::new(),
            None => {
                let span = self.system.name.span;
                let groups = self.derived_groups(&[], span);
                let count = Expr::literal(Value::Int(1), span);
                self.context_wraps();
                vec![Step { kind: StepKind::Derive { count, until_terminal: false, groups }, span }]
            }
        }
    }

    fn steps(&mut self, steps: &'a [syntax::Step], outermost: bool) -> Vec<Step> {
        let mut lowered = Vec::with_capacity(steps.len());
        for (index, step) in steps.iter().enumerate() {
            if let syntax::StepKind::Place(name) = &step.kind
                && matches!(self.kind, Kind::Patch { .. })
                && !(outermost && index + 1 == steps.len())
            {
                let message = format!("in a patch system `place` stands last, and `{}` does not", name.text);
                let error = Diagnostic::error(code::RUN_ORDER, step.span, message);
                self.report(error.hint("it displaces the tessellation, not the nets"));
            }
            if let Some(kind) = self.step(step) {
                lowered.push(Step { kind, span: step.span });
            }
        }
        lowered
    }

    fn step(&mut self, step: &'a syntax::Step) -> Option<StepKind> {
        match &step.kind {
            syntax::StepKind::Derive { count, groups } => self.derive(count, groups, step.span),
            syntax::StepKind::Repeat { count, body } => {
                let count = self.count(count, "the count of `repeat`");
                let body = self.steps(body, false);
                Some(StepKind::Repeat { count: count?, body })
            }
            syntax::StepKind::If { condition, body } => {
                let mut scope = Scope::new(Where::Run);
                let condition =
                    self.expr(&mut scope, condition, &Type::Bool, || "a condition is a bool".into());
                let body = self.steps(body, false);
                Some(StepKind::If { condition: condition?, body })
            }
            syntax::StepKind::Subdivide { scheme, levels, place } => {
                self.subdivide(scheme, levels, place.as_ref())
            }
            syntax::StepKind::Place(name) => {
                if matches!(self.kind, Kind::Curve(_)) {
                    self.wrong_kind("`place`", step.span, &[syntax::Kind::Mesh, syntax::Kind::Patch]);
                } else {
                    return self.place_name(name).map(StepKind::Place);
                }
                None
            }
            syntax::StepKind::Mark { module, condition, isolated } => {
                let (module, condition) = self.mark(module, condition, step.span)?;
                Some(StepKind::Mark { module, condition, isolated: *isolated })
            }
            syntax::StepKind::Crease { sharpness, condition } => self.crease(sharpness, condition, step.span),
            syntax::StepKind::Deposit { pattern, into, condition } => {
                self.deposit(pattern, into, condition.as_ref());
                Some(StepKind::Deposit)
            }
            syntax::StepKind::Trace { into } => {
                self.trace(into, step.span).map(|into| StepKind::Trace { into })
            }
        }
    }

    fn derive(&mut self, count: &'a DeriveCount, groups: &'a [Name], span: Span) -> Option<StepKind> {
        let (count, until_terminal) = match count {
            DeriveCount::Steps(count) => (self.count(count, "the count of `derive`"), false),
            DeriveCount::UntilTerminal { max: Some(max) } => (self.count(max, "`max`"), true),
            DeriveCount::UntilTerminal { max: None } => {
                let message = "`derive until terminal` needs a limit";
                let error = Diagnostic::error(code::NO_MAX, span, message);
                self.report(error.hint("write `derive until terminal max 100`"));
                (None, true)
            }
        };
        let groups = self.derived_groups(groups, span);
        Some(StepKind::Derive { count: count?, until_terminal, groups })
    }

    fn count(&mut self, count: &'a syntax::Expr, what: &str) -> Option<Expr> {
        let mut scope = Scope::new(Where::Run);
        let typed = self.expr(&mut scope, count, &Type::Int, || format!("{what} is an int"))?;
        if let Some(Value::Int(n)) = as_literal(&typed)
            && n < 0
        {
            let message = format!("{what} is below zero");
            self.report(Diagnostic::error(code::COUNT, count.span, message));
            return None;
        }
        Some(typed)
    }

    /// Without names the unnamed group.
    fn derived_groups(&mut self, names: &'a [Name], span: Span) -> Vec<usize> {
        if names.is_empty() {
            if let Some((index, _)) = self.group_ids.get("") {
                return vec![*index];
            }
            let mut named: Vec<(&str, usize)> = self.group_ids.iter().map(|(n, (i, _))| (*n, *i)).collect();
            named.sort_by_key(|(_, index)| *index);
            let hint = match named.first() {
                Some((name, _)) => format!("write `with {name}`, or leave out the group's name"),
                None => "write the rules behind `rules:`".into(),
            };
            let message = "there is no rule group without a name";
            self.report(Diagnostic::error(code::UNKNOWN_GROUP, span, message).hint(hint));
            return Vec::new();
        }
        let mut groups = Vec::with_capacity(names.len());
        for (i, name) in names.iter().enumerate() {
            if let Some(first) = names[..i].iter().find(|n| n.text == name.text) {
                self.duplicate("uses of the rule group", &name.text, name.span, first.span);
            }
            match self.group_ids.get(name.text.as_str()) {
                Some((index, _)) => groups.push(*index),
                None => {
                    let hint = self.nearest(&name.text, self.group_ids.keys().copied());
                    let message = format!("there is no rule group `{}`", name.text);
                    self.report(Diagnostic::error(code::UNKNOWN_GROUP, name.span, message).hint_if(hint));
                }
            }
        }
        groups
    }

    fn subdivide(
        &mut self,
        scheme: &'a Name,
        levels: &'a syntax::Expr,
        place: Option<&'a Name>,
    ) -> Option<StepKind> {
        let known = self.vocabulary.schemes.iter().find(|s| s.name == scheme.text);
        let fitting: Vec<&str> =
            self.vocabulary.schemes.iter().filter(|s| s.of.fits(self.kind)).map(|s| s.name).collect();
        match known {
            Some(scheme) if scheme.of.fits(self.kind) => {}
            _ if fitting.is_empty() => self.wrong_kind("`subdivide`", scheme.span, &[syntax::Kind::Mesh]),
            _ => {
                let hint = self
                    .nearest(&scheme.text, fitting.iter().copied())
                    .unwrap_or_else(|| format!("there are {}", suggest::list(fitting)));
                let message = format!("there is no scheme `{}`", scheme.text);
                self.report(Diagnostic::error(code::UNKNOWN_SCHEME, scheme.span, message).hint(hint));
            }
        }
        let levels = self.count(levels, "the number of levels");
        let place = place.map(|place| self.place_name(place));
        let place = match place {
            Some(place) => Some(place?),
            None => None,
        };
        Some(StepKind::Subdivide { scheme: known?.name, levels: levels?, place })
    }

    /// The index of a placement.
    fn place_name(&mut self, name: &'a Name) -> Option<usize> {
        let known = self.places.get(name.text.as_str()).map(|(index, _)| *index);
        if known.is_none() {
            let hint = self.nearest(&name.text, self.places.keys().copied());
            let message = format!("no placement `{}` is declared", name.text);
            let error = Diagnostic::error(code::UNKNOWN_PLACE, name.span, message);
            let declare = || format!("declare it: `place {} = p + normal * …`", name.text);
            self.report(error.hint(hint.unwrap_or_else(declare)));
        }
        known
    }

    fn mark(
        &mut self,
        module: &'a syntax::ModuleUse,
        condition: &'a syntax::Expr,
        span: Span,
    ) -> Option<(FaceModule, Expr)> {
        if !matches!(self.kind, Kind::Mesh) {
            self.wrong_kind("`mark`", span, &[syntax::Kind::Mesh]);
            return None;
        }
        let mut scope = Scope::new(Where::Mark);
        let module = self.face_module(&mut scope, module);
        scope.decides = true;
        let why = || "what `mark` asks is a bool".into();
        let condition = self.expr(&mut scope, condition, &Type::Bool, why);
        Some((module?, condition?))
    }

    fn crease(
        &mut self,
        sharpness: &'a syntax::Expr,
        condition: &'a syntax::Expr,
        span: Span,
    ) -> Option<StepKind> {
        if !matches!(self.kind, Kind::Mesh) {
            self.wrong_kind("`crease`", span, &[syntax::Kind::Mesh]);
            return None;
        }
        let mut scope = Scope::new(Where::Crease);
        let sharpness = self.expr(&mut scope, sharpness, &Type::Float, || "a sharpness is a number".into());
        scope.decides = true;
        let why = || "what `crease` asks is a bool".into();
        let condition = self.expr(&mut scope, condition, &Type::Bool, why);
        Some(StepKind::Crease { sharpness: sharpness?, condition: condition? })
    }

    fn deposit(&mut self, pattern: &'a syntax::Pattern, into: &'a Name, condition: Option<&'a syntax::Expr>) {
        let mut scope = Scope::new(Where::Rule);
        self.pattern(&mut scope, pattern, |field| BinderPlace::Strict { module: 0, field }, Some(0));
        if !self.volumes.contains_key(into.text.as_str()) {
            let hint = self.nearest(&into.text, self.volumes.keys().copied());
            let message = format!("no volume `{}` is declared", into.text);
            self.report(Diagnostic::error(code::UNKNOWN_PLACE, into.span, message).hint_if(hint));
        }
        if let Some(condition) = condition {
            // Reserved; what it means to deposit a number or by a condition is still open.
            self.free(&mut scope, condition);
        }
    }

    /// The turtle writes points: their module needs a vector, and nothing that it cannot know.
    fn trace(&mut self, into: &'a Name, span: Span) -> Option<SymbolId> {
        let Kind::Curve(topology) = self.kind else {
            self.wrong_kind("`trace`", span, &[syntax::Kind::Curve]);
            return None;
        };
        let symbol = self.symbol(into)?;
        self.traced = Some(symbol);
        let fields = self.symbols[symbol].fields.clone();
        let Some(position) = fields.iter().position(|f| matches!(f.ty, Type::Vec2 | Type::Vec3)) else {
            let message = format!("`{}` has no field for the position", into.text);
            let error = Diagnostic::error(code::TRACE, into.span, message);
            self.report(error.hint("the first field of type vec2 or vec3 is the position"));
            return None;
        };
        let others = fields.iter().enumerate().find(|(i, f)| *i != position && f.name != "r");
        if let Some((_, field)) = others {
            let message = format!("the turtle knows no value for `{}` of `{}`", field.name, into.text);
            let error = Diagnostic::error(code::TRACE, into.span, message);
            self.report(error.hint("it writes the position and, into a field `r`, the width"));
        } else if let Some(width) = fields.iter().find(|f| f.name == "r" && f.ty != Type::Float) {
            let message = format!("the width `r` of `{}` is a float, not {}", into.text, width.ty);
            self.report(Diagnostic::error(code::TRACE, into.span, message));
        }
        if topology == Topology::Ring
            && let Some(move_) = self.first_move()
        {
            let message = "`f` begins a new curve, and a ring is one curve";
            let error = Diagnostic::error(code::TRACE, move_, message);
            self.report(error.label(span, "the ring is traced here"));
        }
        Some(symbol)
    }

    /// The first `f` in the axiom or a successor.
    fn first_move(&self) -> Option<Span> {
        fn in_word(word: &[Element]) -> Option<Span> {
            word.iter().find_map(|element| match element {
                Element::Module(used) if used.symbol.text == "f" => Some(used.span),
                Element::Branch(branch, _) => in_word(branch),
                _ => None,
            })
        }
        self.system.items.iter().find_map(|item| match item {
            Item::Axiom(syntax::Axiom { kind: syntax::AxiomKind::Word(word), .. }) => in_word(word),
            Item::Rules(rules) => {
                rules.rules.iter().flat_map(|r| &r.alternatives).find_map(|a| match &a.successor {
                    syntax::Successor::Word(word) => in_word(word),
                    syntax::Successor::Template(_) => None,
                })
            }
            _ => None,
        })
    }

    /// Contexts that meet themselves in the axiom's ring.
    fn context_wraps(&mut self) {
        if self.kind != Kind::Curve(Topology::Ring) {
            return;
        }
        let Some(length) = self.axiom_length() else { return };
        for item in &self.system.items {
            let Item::Rules(rules) = item else { continue };
            for rule in &rules.rules {
                let predecessor = &rule.predecessor;
                let left = predecessor.left.as_ref().map_or(0, |c| c.patterns.len());
                let right = predecessor.right.as_ref().map_or(0, |c| c.parts.len());
                let reach = left + predecessor.strict.len() + right;
                if (left > 0 || right > 0) && reach > length {
                    let message =
                        format!("the rule looks at {reach} modules, and the ring of the axiom has {length}");
                    let warning = Diagnostic::warning(code::CONTEXT_WRAPS, predecessor.span, message);
                    self.report(warning.hint("it sees some of them twice, around the ring"));
                }
            }
        }
    }
}
