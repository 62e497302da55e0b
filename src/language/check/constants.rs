//! The values of consts and params.

use super::names::{Declaration, Known, State};
use super::scope::{Scope, Where};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::eval;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::syntax::{self, Name, Span};
use crate::language::system::{Uniform, UniformKind};

impl<'a> Checker<'a> {
    /// Computes the system's own consts and params; of those above it only what is read.
    pub(super) fn constants(&mut self) {
        let whole_file = self.system.name.text.is_empty();
        for index in 0..self.names.len() {
            if (whole_file || self.names.declaration(index).own)
                && matches!(self.names.state(index), State::Waiting)
            {
                self.resolve(index);
            }
        }
    }

    /// What a declared name stands for, computed now if need be.
    pub(super) fn known(&mut self, index: usize) -> Known {
        self.names.mark_used(index);
        if matches!(self.names.state(index), State::Waiting) {
            self.resolve(index);
        }
        match self.names.state(index) {
            State::Done(known) => known.clone(),
            State::Waiting | State::Working => Known::Broken,
        }
    }

    /// Computes a declaration after all that it needs; a loop, since chains may be long.
    fn resolve(&mut self, index: usize) {
        let mut path = vec![self.enter(index)];
        while let Some((current, needed)) = path.last_mut() {
            let current = *current;
            match needed.pop() {
                None => {
                    path.pop();
                    if matches!(self.names.state(current), State::Working) {
                        let known = self.compute(self.names.declaration(current));
                        self.names.set(current, State::Done(known));
                    }
                }
                Some(next) => match self.names.state(next) {
                    State::Waiting => {
                        let entered = self.enter(next);
                        path.push(entered);
                    }
                    State::Working => {
                        let start = path.iter().position(|(i, _)| *i == next).unwrap_or(0);
                        let cycle: Vec<usize> = path[start..].iter().map(|(i, _)| *i).collect();
                        self.cycle(&cycle);
                    }
                    State::Done(_) => {}
                },
            }
        }
    }

    fn enter(&mut self, index: usize) -> (usize, Vec<usize>) {
        self.names.set(index, State::Working);
        let declaration = self.names.declaration(index);
        let mut needed = self.names.named_in(declaration.value);
        if let Some((low, high)) = declaration.range {
            needed.extend(self.names.named_in(low));
            needed.extend(self.names.named_in(high));
        }
        (index, needed)
    }

    fn cycle(&mut self, cycle: &[usize]) {
        for &index in cycle {
            self.names.set(index, State::Done(Known::Broken));
        }
        let Some(&first) = cycle.first() else { return };
        let first = self.names.declaration(first);
        let way = cycle.iter().map(|&i| self.names.declaration(i).name.text.as_str());
        let message = match cycle.len() {
            1 => format!("`{}` needs itself", first.name.text),
            _ => format!("{} need one another", suggest::list(way)),
        };
        let mut error = Diagnostic::error(code::CYCLE, first.name.span, message);
        for &index in &cycle[1..] {
            error = error.label(self.names.declaration(index).name.span, "and this");
        }
        self.report(error);
    }

    fn compute(&mut self, declaration: Declaration<'a>) -> Known {
        let place = if declaration.is_param { Where::Param } else { Where::Const };
        let wanted = match declaration.ty {
            Some(name) => match self.type_named(name) {
                Some(ty) => Some(ty),
                None => return Known::Broken,
            },
            None => None,
        };
        let mut scope = Scope::new(place);
        let name = &declaration.name.text;
        let value = match &wanted {
            Some(ty) => self.expr(&mut scope, declaration.value, ty, || format!("`{name}` is declared {ty}")),
            None => self.free(&mut scope, declaration.value),
        };
        let Some(value) = value else { return Known::Broken };
        let known = if declaration.is_param {
            self.param(declaration, value)
        } else {
            self.constant_or_derived(declaration, value)
        };
        known.unwrap_or(Known::Broken)
    }

    fn constant_or_derived(&mut self, declaration: Declaration<'a>, value: Expr) -> Option<Known> {
        if let ExprKind::Literal(value) = value.kind {
            return Some(Known::Value(value));
        }
        let default = self.host_value(&value)?;
        let uniform = Uniform {
            name: declaration.name.text.clone(),
            ty: value.ty.clone(),
            kind: UniformKind::Derived(value),
            span: declaration.name.span,
        };
        Some(self.add_uniform(uniform, default))
    }

    fn param(&mut self, declaration: Declaration<'a>, value: Expr) -> Option<Known> {
        let ty = value.ty.clone();
        if matches!(ty, Type::List(..)) {
            let message = format!("param `{}` cannot be a list", declaration.name.text);
            let error = Diagnostic::error(code::LIST, value.span, message);
            self.report(error.hint("lists are constants: write `const`"));
            return None;
        }
        let span = value.span;
        let default = self.literal(value)?;
        if declaration.name.text == "seed" && ty != Type::Int {
            let message = format!("`seed` is an int, not {}", super::typing::article(&ty));
            self.report(Diagnostic::error(code::TYPE, span, message));
            return None;
        }
        let range = match declaration.range {
            Some((low, high)) => Some(self.range(declaration, &ty, &default, low, high)?),
            None => None,
        };
        let name = declaration.name.text.clone();
        let kind = UniformKind::Param { default: default.clone(), range };
        Some(self.add_uniform(Uniform { name, ty, kind, span: declaration.name.span }, default))
    }

    fn range(
        &mut self,
        declaration: Declaration<'a>,
        ty: &Type,
        default: &Value,
        low: &'a syntax::Expr,
        high: &'a syntax::Expr,
    ) -> Option<(Value, Value)> {
        let name = &declaration.name.text;
        if *ty == Type::Bool {
            let message = format!("`{name}` is a bool and has no range");
            self.report(Diagnostic::error(code::RANGE, low.span.to(high.span), message));
            return None;
        }
        let span = low.span.to(high.span);
        let mut bound = |e: &'a syntax::Expr| {
            let mut scope = Scope::new(Where::Param);
            let value = self.expr(&mut scope, e, ty, || format!("the range of `{name}` is {ty}"))?;
            self.literal(value)
        };
        let (low, high) = (bound(low)?, bound(high)?);
        let below = |a: &Value, b: &Value| match (a, b) {
            (Value::Int(a), Value::Int(b)) => a < b,
            _ => a.components().iter().zip(b.components()).any(|(a, b)| a < b),
        };
        if below(&high, &low) {
            let message = format!("the range of `{name}` ends below its beginning");
            self.report(Diagnostic::error(code::RANGE, span, message));
        } else if below(default, &low) || below(&high, default) {
            let message = format!("the default of `{name}` lies outside its range");
            let error = Diagnostic::error(code::RANGE, declaration.value.span, message);
            self.report(error.label(span, "the range"));
        }
        Some((low, high))
    }

    pub(super) fn add_uniform(&mut self, uniform: Uniform, default: Value) -> Known {
        let known = Known::Uniform(self.uniforms.len(), uniform.ty.clone());
        self.uniforms.push(uniform);
        self.defaults.push(default);
        known
    }

    /// The value of an expression that must be constant.
    pub(super) fn literal(&mut self, expr: Expr) -> Option<Value> {
        if let ExprKind::Literal(value) = expr.kind {
            return Some(value);
        }
        // An expression without uniforms is folded if the host can, so the reason is elsewhere.
        let mut reads = None;
        expr.walk(&mut |e| {
            if let ExprKind::Uniform(index) = e.kind {
                reads = reads.or(Some((index, e.span)));
            }
        });
        match reads {
            Some((index, span)) => {
                let message =
                    format!("this must be constant, but `{}` may change", self.uniforms[index].name);
                self.report(Diagnostic::error(code::NOT_CONSTANT, span, message));
            }
            None => {
                self.host_value(&expr);
            }
        }
        None
    }

    /// The value of an expression over uniforms at their defaults; reports what the host cannot.
    pub(super) fn host_value(&mut self, expr: &Expr) -> Option<Value> {
        match eval::eval(expr, &self.defaults) {
            Ok(value) => Some(value),
            Err(error) => {
                self.report(Diagnostic::error(code::NOT_CONSTANT, error.span(), error.to_string()));
                None
            }
        }
    }

    /// The type of that name.
    pub(super) fn type_named(&mut self, name: &Name) -> Option<Type> {
        let ty = match name.text.as_str() {
            "bool" => Type::Bool,
            "int" => Type::Int,
            "float" => Type::Float,
            "vec2" => Type::Vec2,
            "vec3" => Type::Vec3,
            "vec4" => Type::Vec4,
            other => {
                self.report(unknown_type(other, name.span));
                return None;
            }
        };
        Some(ty)
    }
}

fn unknown_type(name: &str, span: Span) -> Diagnostic {
    const TYPES: [&str; 6] = ["bool", "int", "float", "vec2", "vec3", "vec4"];
    let meant = match name {
        "i32" | "integer" | "uint" | "u32" => Some("int"),
        "f32" | "f64" | "double" | "real" | "number" => Some("float"),
        "point2" | "vec2f" | "float2" => Some("vec2"),
        "point" | "point3" | "vec" | "vec3f" | "float3" => Some("vec3"),
        "boolean" => Some("bool"),
        _ => None,
    };
    let hint = match meant {
        Some(meant) => Some(format!("did you mean `{meant}`?")),
        None => suggest::nearest(name, TYPES),
    };
    let error = Diagnostic::error(code::UNKNOWN_TYPE, span, format!("there is no type `{name}`"));
    error.hint(hint.unwrap_or_else(|| format!("the types are {}", suggest::list(TYPES))))
}
