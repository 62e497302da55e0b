//! The types of expressions.
//!
//! An expression of numerals stays an exact fraction until a type is asked of it; whatever is
//! constant is folded on the way.

use super::names::Known;
use super::scope::{Local, Scope, Where};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::eval;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::ops::{self, Mismatch, Op};
use crate::language::rational::Rational;
use crate::language::syntax::{self, BinaryOp, Name, Span, UnaryOp};
use crate::language::system::{Uniform, UniformKind};
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
    fn typed(expr: Expr) -> Option<Operand> {
        Some(Operand { span: expr.span, term: Term::Typed(expr) })
    }

    fn exact(value: Rational, span: Span) -> Option<Operand> {
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
    fn lower(&mut self, operand: Operand) -> Option<Expr> {
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

    fn mismatch(&mut self, name: &str, mismatch: Mismatch, types: &[Type], span: Span) {
        let rows = ops::overloads(name);
        let operator = rows.first().is_some_and(|op| op.row().is_operator());
        let given: Vec<String> = types.iter().map(article).collect();
        let (code, message) = match mismatch {
            Mismatch::Name => (code::UNKNOWN_FUNCTION, format!("there is no function `{name}`")),
            Mismatch::Arity => {
                let mut takes: Vec<usize> = rows.iter().map(|op| op.row().args.len()).collect();
                takes.sort_unstable();
                takes.dedup();
                let takes: Vec<String> = takes.iter().map(usize::to_string).collect();
                let takes = takes.join(" or ");
                let plural = if takes == "1" { "" } else { "s" };
                let message = format!("`{name}` takes {takes} argument{plural}, not {}", types.len());
                (code::FUNCTION_ARITY, message)
            }
            Mismatch::Types if operator && given.len() == 1 => {
                (code::OPERANDS, format!("`{name}` does not stand before {}", given[0]))
            }
            Mismatch::Types if operator => {
                (code::OPERANDS, format!("`{name}` does not stand between {}", given.join(" and ")))
            }
            Mismatch::Types => (code::OPERANDS, format!("`{name}` does not take {}", given.join(", "))),
        };
        let hint = match mismatch {
            Mismatch::Name => None,
            _ if operator => {
                let logical = matches!(name, "&&" | "||" | "!");
                logical.then(|| format!("`{name}` takes bools, such as comparisons"))
            }
            _ => {
                let forms: Vec<String> = rows.iter().take(4).map(|op| format!("`{}`", op.row())).collect();
                Some(format!("it is {}", forms.join(", ")))
            }
        };
        self.report(Diagnostic::error(code, span, message).hint_if(hint));
    }

    fn function(
        &mut self,
        scope: &mut Scope<'a>,
        name: &'a Name,
        args: &'a [syntax::Expr],
        span: Span,
    ) -> Option<Operand> {
        if let Some(query) = self.query_ids.get(name.text.as_str()).copied() {
            return self.sample(scope, name, query, args, span);
        }
        let random = ["rand", "randn"].into_iter().find(|f| *f == name.text);
        // The site of a call is its place in the text, before those of its arguments.
        let site = scope.sites;
        if random.is_some() {
            scope.sites += 1;
        }
        let operands: Vec<Option<Operand>> = args.iter().map(|a| self.operand(scope, a)).collect();
        if let Some(function) = random {
            return self.random(scope, function, site, name, operands, span);
        }
        if ops::overloads(&name.text).is_empty() {
            self.unknown_function(name);
            return None;
        }
        let operands: Vec<Operand> = operands.into_iter().collect::<Option<_>>()?;
        if name.text == "noise" && scope.decides {
            let message = "`noise` decides here: CPU and GPU agree on it only within a bound";
            let warning = Diagnostic::warning(code::NOISE, span, message);
            self.report(warning.hint("modules near the threshold may go either way"));
        }
        self.operation(&name.text, operands, span)
    }

    fn unknown_function(&mut self, name: &Name) {
        let text = name.text.as_str();
        let hint = match text {
            "vec2" => Some("a vector is written `(x, y)`".to_string()),
            "vec3" => Some("a vector is written `(x, y, z)`".to_string()),
            "vec4" => Some("a vector is written `(x, y, z, w)`".to_string()),
            "lerp" => Some("it is called `mix`".to_string()),
            "select" => Some("write `if(condition, then, otherwise)`".to_string()),
            "ln" => Some("it is called `log`".to_string()),
            "random" => Some("it is called `rand`".to_string()),
            _ => {
                let functions = ops::TABLE.iter().filter(|r| !r.is_operator()).map(|r| r.name);
                suggest::nearest(
                    text,
                    functions.chain(["rand", "randn"]).chain(self.query_ids.keys().copied()),
                )
            }
        };
        let message = format!("there is no function `{text}`");
        self.report(Diagnostic::error(code::UNKNOWN_FUNCTION, name.span, message).hint_if(hint));
    }

    fn random(
        &mut self,
        scope: &Scope<'a>,
        function: &'static str,
        site: usize,
        name: &Name,
        operands: Vec<Option<Operand>>,
        span: Span,
    ) -> Option<Operand> {
        if !scope.place.is_random() {
            let message = format!("`{function}` cannot stand in {}", scope.place.describe());
            let error = Diagnostic::error(code::RANDOM, name.span, message);
            self.report(error.hint("random numbers are drawn in rules, `place` and `mark`"));
            return None;
        }
        let fits = match function {
            "rand" => matches!(operands.len(), 0 | 2),
            _ => operands.is_empty(),
        };
        if !fits {
            let takes = if function == "rand" { "no argument or 2" } else { "no argument" };
            let message = format!("`{function}` takes {takes}, not {}", operands.len());
            self.report(Diagnostic::error(code::FUNCTION_ARITY, span, message));
            return None;
        }
        let mut args = Vec::with_capacity(operands.len());
        for operand in operands {
            args.push(self.coerce(operand?, &Type::Float, || "the bounds of `rand` are floats".into())?);
        }
        Operand::typed(Expr { ty: Type::Float, kind: ExprKind::Random { function, args, site }, span })
    }

    fn sample(
        &mut self,
        scope: &mut Scope<'a>,
        name: &Name,
        query: Option<usize>,
        args: &'a [syntax::Expr],
        span: Span,
    ) -> Option<Operand> {
        let query = query?;
        if matches!(scope.place, Where::Const | Where::Param | Where::Axiom | Where::Run) {
            let message = format!("the query `{}` has no value in {}", name.text, scope.place.describe());
            self.report(Diagnostic::error(code::NOT_HERE, name.span, message));
            return None;
        }
        let [point] = args else {
            let message = format!("`{}` takes one point, not {} arguments", name.text, args.len());
            self.report(Diagnostic::error(code::FUNCTION_ARITY, span, message));
            return None;
        };
        let point =
            self.expr(scope, point, &Type::Vec3, || format!("`{}` takes a point, a vec3", name.text))?;
        if self.host_bound(query) {
            let ty = self.queries[query].ty.clone();
            return Operand::typed(Expr { ty, kind: ExprKind::Sample(query, Box::new(point)), span });
        }
        let message = format!("`{}` has a value of its own and cannot be asked at a point", name.text);
        let error = Diagnostic::error(code::OPERANDS, span, message);
        self.report(error.hint(format!("bind it before the predecessor: `?{}(x)`", name.text)));
        None
    }

    fn vector(&mut self, scope: &mut Scope<'a>, args: &'a [syntax::Expr], span: Span) -> Option<Operand> {
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

    fn list(&mut self, scope: &mut Scope<'a>, elements: &'a [syntax::Expr], span: Span) -> Option<Operand> {
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

    fn component(
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

    fn element(
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

    fn name(&mut self, scope: &mut Scope<'a>, name: &str, span: Span) -> Option<Operand> {
        match scope.locals.get(name) {
            Some((Local::Broken, _)) => return None,
            Some((Local::Binder(index), _)) => {
                let ty = scope.binders[*index].ty.clone();
                return Operand::typed(Expr { ty, kind: ExprKind::Binder(*index), span });
            }
            Some((Local::Let(index), _)) => {
                let ty = scope.lets[*index].value.ty.clone();
                return Operand::typed(Expr { ty, kind: ExprKind::Let(*index), span });
            }
            None => {}
        }
        if let Some((_, ty)) = scope.fields.iter().find(|(field, _)| field == name) {
            // The engine reads the field of the point's module; nothing is lowered here.
            return Operand::typed(Expr { ty: ty.clone(), kind: ExprKind::Attribute("field"), span });
        }
        if let Some(index) = self.names.find(name) {
            return match self.known(index) {
                Known::Value(value) => Operand::typed(Expr::literal(value, span)),
                Known::Uniform(index, ty) => {
                    Operand::typed(Expr { ty, kind: ExprKind::Uniform(index), span })
                }
                Known::Broken => None,
            };
        }
        let seen = |place: Where, kind, in_slot| {
            move |a: &&crate::language::vocabulary::Attribute| {
                a.name == name && place.sees(a.of, kind, in_slot)
            }
        };
        if let Some(attribute) =
            self.vocabulary.attributes.iter().find(seen(scope.place, self.kind, scope.in_slot))
        {
            let kind = ExprKind::Attribute(attribute.name);
            return Operand::typed(Expr { ty: attribute.ty.clone(), kind, span });
        }
        if let Some((_, value)) = self.vocabulary.constants.iter().find(|(constant, _)| *constant == name) {
            return Operand::typed(Expr::literal(Value::Float(*value), span));
        }
        if let Some((name, default)) = self.vocabulary.params.iter().find(|(param, _)| *param == name)
            && scope.place != Where::Param
        {
            return Operand::typed(self.implicit_param(name, default.clone(), span));
        }
        self.unknown_name(scope, name, span);
        None
    }

    /// A param that exists undeclared: a uniform from its first use on.
    fn implicit_param(&mut self, name: &str, default: Value, span: Span) -> Expr {
        let ty = default.ty();
        let index = match self.uniforms.iter().position(|u| u.name == name) {
            Some(index) => index,
            None => {
                let kind = UniformKind::Param { default: default.clone(), range: None };
                self.add_uniform(Uniform { name: name.into(), ty: ty.clone(), kind, span }, default);
                self.uniforms.len() - 1
            }
        };
        Expr { ty, kind: ExprKind::Uniform(index), span }
    }

    fn unknown_name(&mut self, scope: &Scope<'a>, name: &str, span: Span) {
        let elsewhere = self.vocabulary.attributes.iter().find(|a| a.name == name);
        if let Some(attribute) = elsewhere {
            let message = format!("`{name}` has no value in {}", scope.place.describe());
            let error = Diagnostic::error(code::NOT_HERE, span, message);
            self.report(error.hint(format!("it is known in {}", attribute.of.describe())));
            return;
        }
        if name == "_" {
            let message = "`_` has no value here";
            let error = Diagnostic::error(code::NOT_HERE, span, message);
            self.report(error.hint(
                "it stands for the point read, as an argument in an axiom such as `P(_) = file \"c.obj\"`",
            ));
            return;
        }
        let hint = if self.query_ids.contains_key(name) {
            Some(format!("bind the query before the predecessor: `?{name}(x)`"))
        } else if !ops::overloads(name).is_empty() {
            Some(format!("`{name}` is a function: write `{name}(…)`"))
        } else {
            let attributes = self.vocabulary.attributes.iter();
            let attributes = attributes.filter(|a| scope.place.sees(a.of, self.kind, scope.in_slot));
            let candidates = scope
                .locals
                .keys()
                .copied()
                .chain(self.names.all())
                .chain(attributes.map(|a| a.name))
                .chain(self.vocabulary.constants.iter().map(|(n, _)| *n));
            suggest::nearest(name, candidates)
        };
        let message = format!("there is no `{name}` here");
        self.report(Diagnostic::error(code::UNKNOWN_NAME, span, message).hint_if(hint));
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
fn is_frame(operand: &Operand) -> bool {
    matches!(&operand.term, Term::Typed(Expr { kind: ExprKind::Attribute("frame"), .. }))
}

pub(super) fn as_literal(expr: &Expr) -> Option<Value> {
    match &expr.kind {
        ExprKind::Literal(value) => Some(value.clone()),
        _ => None,
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

/// `a vec2`, `an int`.
pub(super) fn article(ty: &Type) -> String {
    match ty {
        Type::Int => format!("an {ty}"),
        _ => format!("a {ty}"),
    }
}

fn plural(ty: &Type) -> String {
    match ty {
        Type::List(element, n) => format!("lists of {n} {element}"),
        ty => format!("{ty}s"),
    }
}
