//! Vectors and lists, and their parts.

use super::scope::Scope;
use super::typing::{Operand, Term, article, as_literal, is_frame};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::syntax::{self, Name, Span};

impl<'a> Checker<'a> {
    pub(super) fn vector(
        &mut self,
        scope: &mut Scope<'a>,
        args: &'a [syntax::Expr],
        span: Span,
    ) -> Option<Operand> {
        let operands: Vec<Option<Operand>> = args.iter().map(|a| self.operand(scope, a)).collect();
        let ty = match args.len() {
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            n => {
                let message = format!("a vector has 2, 3 or 4 components, not {n}");
                self.report(Diagnostic::error(code::VECTOR, span, message));
                return None;
            }
        };
        let mut components = Vec::with_capacity(operands.len());
        for operand in operands {
            let operand = operand?;
            let given = operand.ty();
            if !matches!(given, Type::Int | Type::Float) {
                let message =
                    format!("the components of a vector are numbers, and this is {}", article(&given));
                let hint = matches!(given, Type::Vec2 | Type::Vec3)
                    .then_some("write its components one by one, as in `(v.x, v.y, 0)`");
                self.report(Diagnostic::error(code::VECTOR, operand.span, message).hint_if(hint));
                return None;
            }
            components.push(self.coerce(operand, &Type::Float, String::new)?);
        }
        let words: Option<Vec<u32>> =
            components.iter().map(|c| as_literal(c).and_then(|v| v.words().first().copied())).collect();
        Operand::typed(match words {
            Some(words) => Expr::literal(Value::from_words(&ty, &words), span),
            None => Expr { ty, kind: ExprKind::Vector(components), span },
        })
    }

    pub(super) fn list(
        &mut self,
        scope: &mut Scope<'a>,
        elements: &'a [syntax::Expr],
        span: Span,
    ) -> Option<Operand> {
        let mut values = Vec::with_capacity(elements.len());
        let mut ty: Option<Type> = None;
        for element in elements {
            let lowered = self.free(scope, element)?;
            let Some(value) = as_literal(&lowered) else {
                let message = "the elements of a list are constants, and this one is not";
                self.report(Diagnostic::error(code::LIST, element.span, message));
                return None;
            };
            let given = value.ty();
            ty = match &ty {
                None => Some(given),
                Some(ty) => match common(ty, &given) {
                    Some(common) => Some(common),
                    None => {
                        let message =
                            format!("the list holds {}, and this is {}", plural(ty), article(&given));
                        self.report(Diagnostic::error(code::LIST, element.span, message));
                        return None;
                    }
                },
            };
            values.push(value);
        }
        let Some(ty) = ty else {
            self.report(Diagnostic::error(code::LIST, span, "a list cannot be empty"));
            return None;
        };
        let values = values.into_iter().map(|v| converted(v, &ty)).collect();
        Operand::typed(Expr::literal(Value::List(values), span))
    }

    pub(super) fn component(
        &mut self,
        scope: &mut Scope<'a>,
        base: &'a syntax::Expr,
        field: &Name,
        span: Span,
    ) -> Option<Operand> {
        let operand = self.operand(scope, base)?;
        if is_frame(&operand) {
            return self.operation("-", vec![operand], span);
        }
        let ty = operand.ty();
        let size = match ty {
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            _ => 0,
        };
        let index = ["x", "y", "z", "w"].iter().position(|c| *c == field.text).filter(|i| *i < size);
        let (Some(index), Term::Typed(base)) = (index, operand.term) else {
            let message = format!("{} has no component `{}`", article(&ty), field.text);
            let hint = match size {
                0 => None,
                _ if field.text.len() > 1 => Some("take one component at a time, as in `(v.x, v.y)`"),
                2 => Some("its components are `x` and `y`"),
                3 => Some("its components are `x`, `y` and `z`"),
                _ => Some("its components are `x`, `y`, `z` and `w`"),
            };
            self.report(Diagnostic::error(code::COMPONENT, field.span, message).hint_if(hint));
            return None;
        };
        Operand::typed(match base.kind {
            ExprKind::Literal(value) => {
                Expr::literal(Value::Float(value.components().get(index).copied()?), span)
            }
            kind => {
                let base = Expr { ty: base.ty, kind, span: base.span };
                Expr { ty: Type::Float, kind: ExprKind::Component(Box::new(base), index), span }
            }
        })
    }

    pub(super) fn element(
        &mut self,
        scope: &mut Scope<'a>,
        base: &'a syntax::Expr,
        index: &'a syntax::Expr,
        span: Span,
    ) -> Option<Operand> {
        let operand = self.free(scope, base);
        let index = self.expr(scope, index, &Type::Int, || "an index is an int".into());
        let (operand, index) = (operand?, index?);
        let Type::List(element, length) = operand.ty.clone() else {
            let message = format!("{} has no elements", article(&operand.ty));
            let vector = matches!(operand.ty, Type::Vec2 | Type::Vec3 | Type::Vec4);
            let hint = vector.then_some("its components are `.x`, `.y` …");
            self.report(Diagnostic::error(code::INDEX, operand.span, message).hint_if(hint));
            return None;
        };
        let inside = match as_literal(&index) {
            Some(Value::Int(i)) => usize::try_from(i).is_ok_and(|i| i < length),
            _ => true,
        };
        if !inside {
            let message = format!("the list has {}, from 0", suggest::count(length, "element"));
            self.report(Diagnostic::error(code::INDEX, index.span, message));
            return None;
        }
        match (operand.kind, as_literal(&index)) {
            (ExprKind::Literal(Value::List(values)), Some(Value::Int(i))) => {
                let value = values.into_iter().nth(i as usize)?;
                Operand::typed(Expr::literal(value, span))
            }
            (ExprKind::Literal(Value::List(values)), _) => {
                Operand::typed(Expr { ty: *element, kind: ExprKind::Element(values, Box::new(index)), span })
            }
            (ExprKind::Element(rows, row), _) => {
                let flat = rows.into_iter().flat_map(elements_of).collect();
                let index = self.flat_index(*row, index, length, span)?;
                Operand::typed(Expr { ty: *element, kind: ExprKind::Element(flat, Box::new(index)), span })
            }
            _ => None,
        }
    }

    /// `row * length + index`, the index clamped to its row. The row is clamped with the whole.
    fn flat_index(&mut self, row: Expr, index: Expr, length: usize, span: Span) -> Option<Expr> {
        let int = |n: usize| Operand::typed(Expr::literal(Value::Int(i32::try_from(n).ok()?), span));
        let bounds = vec![Operand::typed(index)?, int(0)?, int(length.saturating_sub(1))?];
        let index = self.operation("clamp", bounds, span)?;
        // Within the greatest row whose product does not wrap; a greater one is clamped anyway.
        let bounds = vec![Operand::typed(row)?, int(0)?, int(0x7fff_ffff / length.max(1) - 1)?];
        let row = self.operation("clamp", bounds, span)?;
        let start = self.operation("*", vec![row, int(length)?], span)?;
        let sum = self.operation("+", vec![start, index], span)?;
        self.lower(sum)
    }
}

/// The type that values of both types can have.
fn common(a: &Type, b: &Type) -> Option<Type> {
    match (a, b) {
        _ if a == b => Some(a.clone()),
        (Type::Int, Type::Float) | (Type::Float, Type::Int) => Some(Type::Float),
        (Type::List(a, n), Type::List(b, m)) if n == m => Some(Type::List(Box::new(common(a, b)?), *n)),
        _ => None,
    }
}

/// A constant as one of the common type.
fn converted(value: Value, ty: &Type) -> Value {
    match (value, ty) {
        (Value::Int(i), Type::Float) => Value::Float(i as f32),
        (Value::List(values), Type::List(element, _)) => {
            Value::List(values.into_iter().map(|v| converted(v, element)).collect())
        }
        (value, _) => value,
    }
}

fn elements_of(value: Value) -> Vec<Value> {
    match value {
        Value::List(values) => values,
        value => vec![value],
    }
}

fn plural(ty: &Type) -> String {
    match ty {
        Type::List(element, n) => format!("lists of {n} {element}"),
        ty => format!("{ty}s"),
    }
}
