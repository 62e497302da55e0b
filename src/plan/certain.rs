//! What is certain of a rule before anything runs: whether it fires on every module of its symbol, or on none.

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
        let holds = |guard: &Option<Value>| *guard == Some(Value::Bool(true));
        let holds =
            guards.iter().all(holds) || self.only_guard().is_some_and(|guard| else_of(guard, earlier));
        match self.looks_nowhere() && self.surely_drawn() && holds {
            true => Fires::Always,
            false => Fires::Perhaps,
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
