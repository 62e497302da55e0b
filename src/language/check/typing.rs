//! The types of expressions.
//!
//! An expression of numerals stays an exact fraction until a type is asked of it; whatever is
//! constant is folded on the way.

use super::scope::Scope;
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::eval;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::ops::{self, Op};
use crate::language::rational::Rational;
use crate::language::syntax::{self, BinaryOp, Span, UnaryOp};
use std::cmp::Ordering;

/// Deeper expressions are refused, since all that walk them recurse.
const MAX_DEPTH: usize = 512;

/// An expression on its way to a type.
#[derive(Clone, Debug)]
pub(super) struct Operand {
    pub term: Term,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(super) enum Term {
    /// Of numerals only.
    Exact(Rational),
    Typed(Expr),
}

impl Operand {
    pub fn typed(expr: Expr) -> Option<Operand> {
        Some(Operand { span: expr.span, term: Term::Typed(expr) })
    }

    pub fn exact(value: Rational, span: Span) -> Option<Operand> {
        Some(Operand { term: Term::Exact(value), span })
    }

    /// The type that it has if nothing else is asked of it.
    pub fn ty(&self) -> Type {
        match &self.term {
            Term::Exact(value) if value.is_whole() => Type::Int,
            Term::Exact(_) => Type::Float,
            Term::Typed(expr) => expr.ty.clone(),
        }
    }
}

impl<'a> Checker<'a> {
    /// An expression of a type that is asked of it; `why` says who asks.
    pub(super) fn expr(
        &mut self,
        scope: &mut Scope<'a>,
        expr: &'a syntax::Expr,
        wanted: &Type,
        why: impl FnOnce() -> String,
    ) -> Option<Expr> {
        let operand = self.operand(scope, expr)?;
        self.coerce(operand, wanted, why)
    }

    /// An expression of its own type.
    pub(super) fn free(&mut self, scope: &mut Scope<'a>, expr: &'a syntax::Expr) -> Option<Expr> {
        let operand = self.operand(scope, expr)?;
        self.lower(operand)
    }

    /// Without a fraction an int, else a float.
    pub(super) fn lower(&mut self, operand: Operand) -> Option<Expr> {
        match operand.term {
            Term::Typed(expr) => Some(expr),
            Term::Exact(value) => {
                let ty = if value.is_whole() { Type::Int } else { Type::Float };
                self.numeral(value, &ty, operand.span)
            }
        }
    }

    fn numeral(&mut self, value: Rational, ty: &Type, span: Span) -> Option<Expr> {
        let lowered = match ty {
            Type::Int => value.to_i32().map(Value::Int),
            _ => value.to_f32().map(Value::Float),
        };
        let Some(lowered) = lowered else {
            let message = match ty {
                Type::Int => format!("{value} is beyond the range of int, -2147483648 to 2147483647"),
                _ => format!("{value} is beyond the range of float"),
            };
            self.report(Diagnostic::error(code::NUMBER, span, message));
            return None;
        };
        Some(Expr::literal(lowered, span))
    }

    /// Gives an operand the wanted type, an int becoming a float where need be.
    pub(super) fn coerce(
        &mut self,
        operand: Operand,
        wanted: &Type,
        why: impl FnOnce() -> String,
    ) -> Option<Expr> {
        let given = operand.ty();
        match operand.term {
            Term::Exact(value) if given == *wanted || *wanted == Type::Float => {
                self.numeral(value, wanted, operand.span)
            }
            Term::Typed(expr) if given == *wanted => Some(expr),
            Term::Typed(expr) if given == Type::Int && *wanted == Type::Float => Some(promote(expr)),
            _ => {
                let message = format!("this is {}, but {}", article(&given), why());
                let hint = match (&given, wanted) {
                    (Type::Float, Type::Int) => Some("write `int(…)`, which rounds towards zero"),
                    (Type::Int, Type::Bool) => Some("compare it, as in `… != 0`"),
                    (Type::Bool, Type::Int | Type::Float) => Some("write `if(…, 1, 0)`"),
                    (Type::Int | Type::Float, Type::Vec2) => Some("a vector is written `(x, y)`"),
                    (Type::Int | Type::Float, Type::Vec3) => Some("a vector is written `(x, y, z)`"),
                    _ => None,
                };
                self.report(Diagnostic::error(code::TYPE, operand.span, message).hint_if(hint));
                None
            }
        }
    }

    pub(super) fn operand(&mut self, scope: &mut Scope<'a>, expr: &'a syntax::Expr) -> Option<Operand> {
        if self.depth >= MAX_DEPTH {
            let message = format!("the expression is nested deeper than {MAX_DEPTH}");
            let error = Diagnostic::error(code::TOO_DEEP, expr.span, message);
            self.report(error.hint("name its parts with `let` or `const`"));
            return None;
        }
        self.depth += 1;
        let operand = self.operand_inside(scope, expr);
        self.depth -= 1;
        operand
    }

    fn operand_inside(&mut self, scope: &mut Scope<'a>, expr: &'a syntax::Expr) -> Option<Operand> {
        let span = expr.span;
        match &expr.kind {
            syntax::ExprKind::Number(number) => match Rational::parse(&number.text) {
                Some(value) => Operand::exact(value, span),
                None => {
                    let message = "the number is too great or too fine to be held exactly in 128 bits";
                    self.report(Diagnostic::error(code::NUMBER, number.span, message));
                    None
                }
            },
            syntax::ExprKind::Bool(value) => Operand::typed(Expr::literal(Value::Bool(*value), span)),
            syntax::ExprKind::Name(name) => self.name(scope, name, span),
            syntax::ExprKind::Call(name, args) => self.function(scope, name, args, span),
            syntax::ExprKind::Vector(args) => self.vector(scope, args, span),
            syntax::ExprKind::List(elements) => self.list(scope, elements, span),
            syntax::ExprKind::Field(base, field) => self.component(scope, base, field, span),
            syntax::ExprKind::Index(base, index) => self.element(scope, base, index, span),
            syntax::ExprKind::Unary(operator, inner) => {
                let inner = self.operand(scope, inner)?;
                self.unary(*operator, inner, span)
            }
            syntax::ExprKind::Binary(..) => self.chain(scope, expr),
        }
    }

    /// Operators of one chain, from left to right: `a + b + c` is deep in the tree only.
    fn chain(&mut self, scope: &mut Scope<'a>, expr: &'a syntax::Expr) -> Option<Operand> {
        let mut operators = Vec::new();
        let mut first = expr;
        while let syntax::ExprKind::Binary(operator, left, right) = &first.kind {
            operators.push((*operator, &**right, first.span));
            first = left;
        }
        let outer = self.depth;
        self.depth += operators.len();
        let mut result = self.operand(scope, first);
        for (operator, right, span) in operators.into_iter().rev() {
            self.depth -= 1;
            if self.depth >= MAX_DEPTH {
                // Already reported at the innermost.
                continue;
            }
            let right = self.operand(scope, right);
            result = match (result, right) {
                (Some(left), Some(right)) => self.binary(operator, left, right, span),
                _ => None,
            };
        }
        self.depth = outer;
        result
    }

    fn unary(&mut self, operator: UnaryOp, inner: Operand, span: Span) -> Option<Operand> {
        match (operator, &inner.term) {
            (UnaryOp::Neg, Term::Exact(value)) => match value.checked_neg() {
                Some(value) => Operand::exact(value, span),
                None => self.inexact(span),
            },
            (UnaryOp::Neg, _) => self.operation("-", vec![inner], span),
            (UnaryOp::Not, _) => self.operation("!", vec![inner], span),
        }
    }

    fn inexact(&mut self, span: Span) -> Option<Operand> {
        let message = "this leaves the range of exact fractions (128 bits)";
        self.report(Diagnostic::error(code::NUMBER, span, message));
        None
    }

    fn binary(&mut self, operator: BinaryOp, left: Operand, right: Operand, span: Span) -> Option<Operand> {
        if let (Term::Exact(a), Term::Exact(b)) = (&left.term, &right.term) {
            let (a, b) = (*a, *b);
            return self.exact_binary(operator, a, b, left, right, span);
        }
        if operator == BinaryOp::Mul && is_frame(&left) {
            return self.operation("frame *", vec![left, right], span);
        }
        let vectors = |o: &Operand| matches!(o.ty(), Type::Vec2 | Type::Vec3 | Type::Vec4);
        if matches!(operator, BinaryOp::Equal | BinaryOp::NotEqual) && (vectors(&left) || vectors(&right)) {
            let message = format!("vectors cannot be compared with `{}`", operator.token());
            let error = Diagnostic::error(code::VECTOR_EQUALITY, span, message);
            self.report(error.hint("compare a distance or components, as in `distance(a, b) < 0.001`"));
            return None;
        }
        self.operation(operator.token(), vec![left, right], span)
    }

    fn exact_binary(
        &mut self,
        operator: BinaryOp,
        a: Rational,
        b: Rational,
        left: Operand,
        right: Operand,
        span: Span,
    ) -> Option<Operand> {
        let value = match operator {
            BinaryOp::Add => a.checked_add(b),
            BinaryOp::Sub => a.checked_sub(b),
            BinaryOp::Mul => a.checked_mul(b),
            BinaryOp::Div | BinaryOp::Rem if b.is_zero() => {
                let error = Diagnostic::error(code::NUMBER, span, "a numeral is divided by zero");
                self.report(error.label(right.span, "this is 0"));
                return None;
            }
            BinaryOp::Div => a.checked_div(b),
            BinaryOp::Rem => a.checked_rem(b),
            BinaryOp::Or | BinaryOp::And => {
                return self.operation(operator.token(), vec![left, right], span);
            }
            _ => {
                let Some(order) = a.checked_cmp(b) else { return self.inexact(span) };
                let holds = match operator {
                    BinaryOp::Equal => order == Ordering::Equal,
                    BinaryOp::NotEqual => order != Ordering::Equal,
                    BinaryOp::Less => order == Ordering::Less,
                    BinaryOp::LessEqual => order != Ordering::Greater,
                    BinaryOp::Greater => order == Ordering::Greater,
                    _ => order != Ordering::Less,
                };
                return Operand::typed(Expr::literal(Value::Bool(holds), span));
            }
        };
        match value {
            Some(value) => Operand::exact(value, span),
            None => self.inexact(span),
        }
    }

    /// A row of the table on operands.
    pub(super) fn operation(&mut self, name: &str, args: Vec<Operand>, span: Span) -> Option<Operand> {
        if name != "frame *" && args.iter().any(is_frame) {
            let message = "`frame` is not a value of its own";
            let error = Diagnostic::error(code::OPERANDS, span, message);
            self.report(error.hint("write `frame * v` with a vec3"));
            return None;
        }
        let types: Vec<Type> = args.iter().map(Operand::ty).collect();
        match ops::find(name, &types) {
            Ok(op) => self.call(op, args, span),
            Err(mismatch) => {
                self.mismatch(name, mismatch, &types, span);
                None
            }
        }
    }

    fn call(&mut self, op: Op, args: Vec<Operand>, span: Span) -> Option<Operand> {
        let row = op.row();
        let mut lowered = Vec::with_capacity(args.len());
        for (arg, wanted) in args.into_iter().zip(row.args) {
            lowered.push(self.coerce(arg, wanted, || format!("`{}` takes {}", row.name, article(wanted)))?);
        }
        self.apply(op, lowered, span).and_then(Operand::typed)
    }

    /// A row of the table on arguments of exactly its types; constant where they are.
    pub(super) fn apply(&mut self, op: Op, args: Vec<Expr>, span: Span) -> Option<Expr> {
        let row = op.row();
        if let ("int" | "float", [arg]) = (row.name, args.as_slice())
            && arg.ty == row.result
        {
            return args.into_iter().next();
        }
        let values: Option<Vec<Value>> = args.iter().map(as_literal).collect();
        if row.args == [Type::Int, Type::Int] && matches!(row.name, "/" | "%") {
            if let Some(Value::Int(0)) = args.get(1).and_then(as_literal) {
                return self.by_zero(row.name, args, span);
            }
            if row.name == "/" {
                self.truncates(values.as_deref(), span);
            }
        }
        if let Some(value) = values.and_then(|v| eval::apply(op, &v)) {
            return self.folded(value, span);
        }
        Some(Expr { ty: row.result.clone(), kind: ExprKind::Call(op, args), span })
    }

    fn folded(&mut self, value: Value, span: Span) -> Option<Expr> {
        if value.components().iter().any(|x| !x.is_finite()) {
            let message = "the value of this constant is not a finite number";
            self.report(Diagnostic::error(code::NUMBER, span, message));
            return None;
        }
        Some(Expr::literal(value, span))
    }

    /// WGSL refuses a division by the constant 0; the language gives x for `/` and 0 for `%`.
    fn by_zero(&mut self, operator: &str, args: Vec<Expr>, span: Span) -> Option<Expr> {
        let message = "this divides by the constant 0";
        let warning = Diagnostic::warning(code::DIVISION_BY_ZERO, span, message);
        self.report(warning.hint("`x / 0` is x and `x % 0` is 0"));
        if operator == "%" {
            return Some(Expr::literal(Value::Int(0), span));
        }
        args.into_iter().next()
    }

    fn truncates(&mut self, values: Option<&[Value]>, span: Span) {
        if let Some([Value::Int(a), Value::Int(b)]) = values
            && a.checked_rem(*b) == Some(0)
        {
            return;
        }
        let message = "a division of ints truncates";
        let warning = Diagnostic::warning(code::TRUNCATES, span, message);
        self.report(
            warning.hint("write `float(…)` around one of them, or `int(…)` around the quotient of floats"),
        );
    }
}

/// An int expression as a float.
fn promote(expr: Expr) -> Expr {
    let span = expr.span;
    if let ExprKind::Literal(Value::Int(i)) = expr.kind {
        return Expr::literal(Value::Float(i as f32), span);
    }
    match ops::find("float", &[Type::Int]) {
        Ok(op) => Expr { ty: Type::Float, kind: ExprKind::Call(op, vec![expr]), span },
        Err(_) => expr,
    }
}

/// The local axes of a place, which are no vector though they take four words.
pub(super) fn is_frame(operand: &Operand) -> bool {
    matches!(&operand.term, Term::Typed(Expr { kind: ExprKind::Attribute("frame"), .. }))
}

pub(super) fn as_literal(expr: &Expr) -> Option<Value> {
    match &expr.kind {
        ExprKind::Literal(value) => Some(value.clone()),
        _ => None,
    }
}

/// `a vec2`, `an int`.
pub(super) fn article(ty: &Type) -> String {
    match ty {
        Type::Int => format!("an {ty}"),
        _ => format!("a {ty}"),
    }
}
