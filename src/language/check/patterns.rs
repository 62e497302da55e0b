//! Patterns: what they bind and test.

use super::scope::{Local, Scope};
use super::typing::{Operand, Term};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::rational::Rational;
use crate::language::syntax::{self, Name, Pattern, PatternArg, PatternTag, Span};
use crate::language::system::{Binder, BinderPlace, Field, Kind, SymbolId};

impl<'a> Checker<'a> {
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

    pub(super) fn pattern_args(
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
            if !super::declare::is_turtle(&symbol.name) {
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
}
