//! Points that are constant sums of points: do the coefficients sum to 1?
//!
//! If not, the figure depends on where the origin lies, which is nearly always a slip in a
//! coefficient. The sums are exact, on what was written.

use super::names::{Known, State};
use super::scope::{Local, Scope};
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Type, Value};
use crate::language::rational::Rational;
use crate::language::syntax::{BinaryOp, Expr, ExprKind, ModuleUse, UnaryOp};
use crate::language::system::SymbolId;

/// What an expression is, seen as a sum of points.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    Number(Rational),
    Point {
        /// Of the coefficients of bound vectors.
        sum: Rational,
        /// Whether any bound vector stands in it.
        bound: bool,
    },
}

impl<'a> Checker<'a> {
    /// Warns if the first vector of a successor's module is a sum with other coefficients than 1
    /// in all.
    pub(super) fn affine(&mut self, scope: &Scope<'a>, used: &'a ModuleUse, symbol: SymbolId) {
        let is_vector = |ty: &Type| matches!(ty, Type::Vec2 | Type::Vec3 | Type::Vec4);
        let Some(first) = self.symbols[symbol].fields.iter().position(|f| is_vector(&f.ty)) else { return };
        let Some(arg) = used.args.as_ref().and_then(|args| args.get(first)) else { return };
        let Some(Form::Point { sum, bound: true }) = self.form(scope, arg) else { return };
        let value = sum.to_f32();
        if value.is_some_and(|x| (x - 1.0).abs() < 1e-6) {
            return;
        }
        let shown = match value {
            Some(x) if sum.to_string().len() > 12 => x.to_string(),
            _ => sum.to_string(),
        };
        let message = format!("the coefficients of this point sum to {shown}, not to 1");
        self.report(Diagnostic::warning(code::AFFINE, arg.span, message));
    }

    pub(super) fn form(&self, scope: &Scope<'a>, expr: &Expr) -> Option<Form> {
        match &expr.kind {
            ExprKind::Number(number) => Rational::parse(&number.text).map(Form::Number),
            ExprKind::Name(name) => self.form_of_name(scope, name),
            ExprKind::Vector(components) => {
                let constant = |e: &Expr| matches!(self.form(scope, e), Some(Form::Number(_)));
                components.iter().all(constant).then_some(Form::Point { sum: Rational::ZERO, bound: false })
            }
            ExprKind::Unary(UnaryOp::Neg, inner) => match self.form(scope, inner)? {
                Form::Number(x) => x.checked_neg().map(Form::Number),
                Form::Point { sum, bound } => sum.checked_neg().map(|sum| Form::Point { sum, bound }),
            },
            ExprKind::Binary(operator, left, right) => {
                combined(*operator, self.form(scope, left)?, self.form(scope, right)?)
            }
            _ => None,
        }
    }

    fn form_of_name(&self, scope: &Scope<'a>, name: &str) -> Option<Form> {
        match scope.locals.get(name) {
            Some((Local::Binder(index), _)) => {
                return match scope.binders[*index].ty {
                    Type::Vec2 | Type::Vec3 | Type::Vec4 => {
                        Some(Form::Point { sum: Rational::ONE, bound: true })
                    }
                    _ => None,
                };
            }
            Some((Local::Let(_), _)) => return scope.forms.get(name).copied(),
            Some((Local::Broken, _)) => return None,
            None => {}
        }
        match self.names.state(self.names.find(name)?) {
            State::Done(Known::Value(Value::Int(i))) => Rational::new(*i as i128, 1).map(Form::Number),
            State::Done(Known::Value(Value::Float(x))) => Rational::from_f32(*x).map(Form::Number),
            State::Done(Known::Value(Value::Vec2(_) | Value::Vec3(_) | Value::Vec4(_))) => {
                Some(Form::Point { sum: Rational::ZERO, bound: false })
            }
            _ => None,
        }
    }
}

fn combined(operator: BinaryOp, left: Form, right: Form) -> Option<Form> {
    use Form::{Number, Point};
    Some(match (operator, left, right) {
        (BinaryOp::Add, Number(a), Number(b)) => Number(a.checked_add(b)?),
        (BinaryOp::Sub, Number(a), Number(b)) => Number(a.checked_sub(b)?),
        (BinaryOp::Mul, Number(a), Number(b)) => Number(a.checked_mul(b)?),
        (BinaryOp::Div, Number(a), Number(b)) => Number(a.checked_div(b)?),
        (BinaryOp::Add, Point { sum: a, bound: x }, Point { sum: b, bound: y }) => {
            Point { sum: a.checked_add(b)?, bound: x || y }
        }
        (BinaryOp::Sub, Point { sum: a, bound: x }, Point { sum: b, bound: y }) => {
            Point { sum: a.checked_sub(b)?, bound: x || y }
        }
        (BinaryOp::Mul, Number(a), Point { sum, bound })
        | (BinaryOp::Mul, Point { sum, bound }, Number(a)) => Point { sum: sum.checked_mul(a)?, bound },
        (BinaryOp::Div, Point { sum, bound }, Number(a)) => Point { sum: sum.checked_div(a)?, bound },
        _ => return None,
    })
}
