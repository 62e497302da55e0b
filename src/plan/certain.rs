//! What is certain of a rule before anything runs: whether it fires on every module of its symbol, or on none.

use super::ranges::{Relation, Set};
use super::tables::MatchRule;
use crate::language::eval;
use crate::language::expr::{Expr, ExprKind, Type, Value};

/// Whether a rule fires on a module of its symbol that no earlier rule has taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fires {
    Never,
    Perhaps,
    Always,
}

/// A rule with what its expressions come to, whatever the module.
pub struct Certain<'a> {
    rule: &'a MatchRule,
    uniforms: &'a [Value],
    lets: Vec<Option<Value>>,
}

impl<'a> Certain<'a> {
    /// Where the uniforms are not known, none are given.
    pub fn new(rule: &'a MatchRule, uniforms: &'a [Value]) -> Certain<'a> {
        let mut certain = Certain { rule, uniforms, lets: Vec::with_capacity(rule.lets.len()) };
        for value in &rule.lets {
            let value = certain.value(value);
            certain.lets.push(value);
        }
        certain
    }

    /// `earlier` are the rules before it on the same symbol.
    pub fn fires(&self, earlier: &[Certain]) -> Fires {
        let rule = self.rule;
        let guards: Vec<Option<Value>> = rule.guards.iter().map(|guard| self.value(guard)).collect();
        if guards.contains(&Some(Value::Bool(false))) || self.never_drawn() {
            return Fires::Never;
        }
        if rule
            .guards
            .iter()
            .any(|guard| self.terms(guard).any(|t| self.sure(guard, false, &t).covers(&self.domain(&t))))
        {
            return Fires::Never;
        }
        match self.looks_nowhere() && self.surely_drawn() && self.guards_hold(earlier) {
            true => Fires::Always,
            false => Fires::Perhaps,
        }
    }

    /// Whether it fires wherever what stands around the module is what it asks for, whatever their parameters are.
    pub fn holds_in_place(&self) -> bool {
        self.surely_drawn() && self.guards_hold(&[])
    }

    /// Whether each guard holds of every module of which all the rules before it leave something.
    fn guards_hold(&self, earlier: &[Certain]) -> bool {
        let guards = &self.rule.guards;
        guards.iter().all(|guard| {
            self.value(guard) == Some(Value::Bool(true))
                || self.terms(guard).any(|term| self.sure(guard, true, &term).covers(&self.domain(&term)))
        }) || self.only_guard().is_some_and(|guard| else_of(guard, earlier))
            || guards.iter().flat_map(|guard| self.terms(guard)).any(|term| self.splits(&term, earlier))
    }

    /// Whether the guards and those of the rules before it share out all values of a term.
    fn splits(&self, term: &Term, earlier: &[Certain]) -> bool {
        if !self.looks_nowhere() || !term.parts().into_iter().all(is_of_module) {
            return false;
        }
        let earlier = earlier
            .iter()
            .rev()
            .take(MOST_EARLIER)
            .filter(|rule| rule.looks_nowhere() && rule.surely_drawn());
        let all = earlier.fold(self.all_hold(term), |all, rule| all.or(&rule.all_hold(term)));
        all.covers(&self.domain(term))
    }

    /// Where all guards surely hold.
    fn all_hold(&self, term: &Term) -> Set {
        let holds = |guard| if is_long(guard) { Set::none() } else { self.sure(guard, true, term) };
        self.rule.guards.iter().fold(Set::all(), |all, guard| all.and(&holds(guard)))
    }

    /// What a condition asks about; the conditions of one are looked at term by term.
    fn terms<'e>(&self, guard: &'e Expr) -> impl Iterator<Item = Term<'e>> + use<'e> {
        let mut terms: Vec<Term<'e>> = Vec::new();
        if is_long(guard) {
            return terms.into_iter();
        }
        guard.walk(&mut |e| {
            let term = match &e.kind {
                ExprKind::Call(op, args) => match (Relation::of(op.row().name), args.as_slice()) {
                    (Some(_), [a, b]) => match (self.value(a), self.value(b)) {
                        (None, Some(_)) => Term::One(a),
                        (Some(_), None) => Term::One(b),
                        (None, None) => Term::Two(a, b),
                        _ => return,
                    },
                    _ => return,
                },
                _ if e.ty == Type::Bool => Term::One(e),
                _ => return,
            };
            if terms.len() < MOST_TERMS && !terms.contains(&term) {
                terms.push(term);
            }
        });
        terms.into_iter()
    }

    /// The values of a term with which a condition surely comes to `wanted`.
    fn sure(&self, e: &Expr, wanted: bool, term: &Term) -> Set {
        if let Some(value) = self.value(e) {
            return if value == Value::Bool(wanted) { Set::all() } else { Set::none() };
        }
        if *term == Term::One(e) {
            return Set::one(i64::from(wanted));
        }
        let ExprKind::Call(op, args) = &e.kind else { return Set::none() };
        let both = |a: &Expr, b: &Expr, and: bool| {
            let (a, b) = (self.sure(a, wanted, term), self.sure(b, wanted, term));
            if and == wanted { a.and(&b) } else { a.or(&b) }
        };
        match (op.row().name, args.as_slice()) {
            ("!", [a]) => self.sure(a, !wanted, term),
            ("&&", [a, b]) => both(a, b, true),
            ("||", [a, b]) => both(a, b, false),
            ("if", [condition, then, otherwise]) => {
                let then = self.sure(condition, true, term).and(&self.sure(then, wanted, term));
                then.or(&self.sure(condition, false, term).and(&self.sure(otherwise, wanted, term)))
            }
            (name, [a, b]) if matches!(a.ty, Type::Bool | Type::Int | Type::Float) => {
                let Some(relation) = Relation::of(name) else { return Set::none() };
                let met = match *term {
                    Term::One(one) if one == a => self.value(b).map(|value| relation.to(&value)),
                    Term::One(one) if one == b => self.value(a).map(|value| relation.turned().to(&value)),
                    Term::Two(x, y) if x == a && y == b => Some(relation.to(&Value::Int(0))),
                    Term::Two(x, y) if x == b && y == a => Some(relation.turned().to(&Value::Int(0))),
                    _ => None,
                };
                met.map_or(Set::none(), |met| if wanted { met } else { met.not() })
            }
            _ => Set::none(),
        }
    }

    /// The values that a term may have.
    fn domain(&self, term: &Term) -> Set {
        match term {
            Term::One(e) => self.range(e),
            Term::Two(a, _) => {
                let order = Set::between(-1, 1);
                if a.ty == Type::Float { order.or(&Set::no_number()) } else { order }
            }
        }
    }

    fn range(&self, e: &Expr) -> Set {
        let float = |low: f32, high: f32| {
            Relation::Least.to(&Value::Float(low)).and(&Relation::Most.to(&Value::Float(high)))
        };
        match &e.kind {
            ExprKind::Let(n) => self.rule.lets.get(*n).map_or_else(Set::all, |value| self.range(value)),
            ExprKind::Attribute("level" | "step") if e.ty == Type::Int => {
                Set::between(0, i64::from(i32::MAX))
            }
            ExprKind::Random { function: "rand", args, .. } => {
                let ends: Option<Vec<f32>> = args.iter().map(|arg| self.number(arg)).collect();
                match ends.as_deref() {
                    // In [0, 1).
                    Some([]) => float(0.0, 1.0 - f32::EPSILON / 2.0),
                    // Rounding may go a little beyond the ends.
                    Some(&[a, b]) if a.abs().max(b.abs()) < 1e30 => {
                        let beyond = (a.abs() + b.abs()) * 1e-5;
                        float(a.min(b) - beyond, a.max(b) + beyond)
                    }
                    _ => Set::all(),
                }
            }
            ExprKind::Call(op, args) if op.row().name == "float" && args[0].ty == Type::Int => {
                float(i32::MIN as f32, i32::MAX as f32)
            }
            _ => match e.ty {
                Type::Bool => Set::between(0, 1),
                Type::Int => Set::between(i64::from(i32::MIN), i64::from(i32::MAX)),
                _ => Set::all(),
            },
        }
    }

    /// Whether alternative `n` is drawn in no case.
    pub fn is_never_drawn(&self, n: usize) -> bool {
        self.rule.weights.get(n).and_then(|weight| self.number(weight)).is_some_and(|w| w <= 0.0)
    }

    fn never_drawn(&self) -> bool {
        let weights = self.rule.weights.len();
        weights > 0 && (0..weights).all(|n| self.is_never_drawn(n))
    }

    /// Weights count in 65,536ths; less than half of one is none.
    fn surely_drawn(&self) -> bool {
        let weights = &self.rule.weights;
        let counts = |weight| self.number(weight).is_some_and(|w| w * 65_536.0 >= 1.0);
        weights.is_empty() || weights.iter().any(counts)
    }

    /// Neither contexts nor further predecessors.
    fn looks_nowhere(&self) -> bool {
        self.rule.context.is_empty() && self.rule.others.is_empty()
    }

    /// The one thing that its firing depends on.
    fn only_guard(&self) -> Option<&'a Expr> {
        match self.rule.guards.as_slice() {
            [guard] if self.looks_nowhere() && self.surely_drawn() => Some(guard),
            _ => None,
        }
    }

    fn number(&self, e: &Expr) -> Option<f32> {
        match self.value(e)? {
            Value::Float(x) => Some(x),
            _ => None,
        }
    }

    /// The value of an expression, if every module has the same.
    fn value(&self, e: &Expr) -> Option<Value> {
        let ExprKind::Call(op, args) = &e.kind else {
            return match &e.kind {
                ExprKind::Let(n) => self.lets.get(*n)?.clone(),
                _ => eval::eval(e, self.uniforms).ok(),
            };
        };
        let values: Vec<Option<Value>> = args.iter().map(|arg| self.value(arg)).collect();
        if let Some(values) = values.iter().cloned().collect::<Option<Vec<Value>>>() {
            return eval::apply(*op, &values);
        }
        let (yes, no) = (Some(Value::Bool(true)), Some(Value::Bool(false)));
        match (op.row().name, values.as_slice()) {
            ("||", [a, b]) if *a == yes || *b == yes => yes,
            ("&&", [a, b]) if *a == no || *b == no => no,
            ("if", [Some(Value::Bool(condition)), then, otherwise]) => {
                if *condition {
                    then.clone()
                } else {
                    otherwise.clone()
                }
            }
            ("if", [_, then, otherwise]) if then == otherwise => then.clone(),
            // Of floats one may be no number, which is equal to nothing.
            ("==" | "<=" | ">=", _) if args[0] == args[1] && args[0].ty != Type::Float => yes,
            ("!=" | "<" | ">", _) if args[0] == args[1] && args[0].ty != Type::Float => no,
            _ => None,
        }
    }
}

/// What conditions ask about.
#[derive(Clone, Copy, PartialEq)]
enum Term<'e> {
    /// An expression whose value is not known.
    One(&'e Expr),
    /// How two such expressions compare: as -1, 0 or 1 does with 0.
    Two(&'e Expr, &'e Expr),
}

impl<'e> Term<'e> {
    fn parts(&self) -> Vec<&'e Expr> {
        match *self {
            Term::One(e) => vec![e],
            Term::Two(a, b) => vec![a, b],
        }
    }
}

/// So many terms of a condition are looked at, and conditions of so many parts: each part is for each term.
const MOST_TERMS: usize = 8;
const MOST_PARTS: usize = 64;

fn is_long(guard: &Expr) -> bool {
    let mut parts = 0;
    guard.walk(&mut |_| parts += 1);
    parts > MOST_PARTS
}

/// So many of the rules before it are looked at: more than these nobody writes out.
const MOST_EARLIER: usize = 16;

/// Whether the guard holds wherever that of an earlier rule does not.
fn else_of(guard: &Expr, earlier: &[Certain]) -> bool {
    let earlier = earlier.iter().rev().take(MOST_EARLIER).filter_map(Certain::only_guard);
    is_of_module(guard) && earlier.into_iter().any(|other| is_of_module(other) && opposite(guard, other))
}

/// It means the same in each rule: it names no `let`, and draws no number.
fn is_of_module(e: &Expr) -> bool {
    let mut own = true;
    e.walk(&mut |e| own &= !matches!(e.kind, ExprKind::Let(_) | ExprKind::Random { .. }));
    own
}

/// Whether always one of two conditions holds.
fn opposite(a: &Expr, b: &Expr) -> bool {
    let is_not = |a: &Expr, b: &Expr| match &a.kind {
        ExprKind::Call(op, args) => op.row().name == "!" && args[0] == *b,
        _ => false,
    };
    if is_not(a, b) || is_not(b, a) {
        return true;
    }
    let (ExprKind::Call(first, x), ExprKind::Call(second, y)) = (&a.kind, &b.kind) else { return false };
    let ([x0, x1], [y0, y1]) = (x.as_slice(), y.as_slice()) else { return false };
    // Patterns ask so for `true` and `false`.
    let bools = |a: &Expr, b: &Expr| match (&a.kind, &b.kind) {
        (ExprKind::Literal(Value::Bool(a)), ExprKind::Literal(Value::Bool(b))) => a != b,
        _ => false,
    };
    let straight = x0 == y0 && x1 == y1;
    let turned = x0 == y1 && x1 == y0;
    // Neither of `<` and `>=` holds of what is no number.
    let ordered = x0.ty != Type::Float;
    match (first.row().name, second.row().name) {
        ("==", "==") => x0 == y0 && bools(x1, y1) || x1 == y1 && bools(x0, y0),
        ("==", "!=") | ("!=", "==") => straight || turned,
        ("<", ">=") | (">=", "<") | (">", "<=") | ("<=", ">") => straight && ordered,
        ("<", "<=") | ("<=", "<") | (">", ">=") | (">=", ">") => turned && ordered,
        _ => false,
    }
}
