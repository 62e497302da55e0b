//! The words behind `at` and `on`: how a template comes to lie, and how it is transformed.

use super::scope::Scope;
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, Type, Value};
use crate::language::syntax::{self, ExprKind};
use crate::language::system::{Transform, UvRange};

/// What the words of a clause say, all together.
#[derive(Debug, Default)]
pub(super) struct Placing {
    /// First corners meet.
    pub corner: bool,
    /// In the order written.
    pub transforms: Vec<Transform>,
    /// Of several the last.
    pub uv: Option<UvRange>,
}

impl<'a> Checker<'a> {
    pub(super) fn placing(
        &mut self,
        scope: &mut Scope<'a>,
        words: &'a [syntax::Transform],
    ) -> Option<Placing> {
        let mut placing = Placing::default();
        let mut whole = true;
        for word in words {
            whole &= self.placing_word(scope, word, &mut placing).is_some();
        }
        whole.then_some(placing)
    }

    fn placing_word(
        &mut self,
        scope: &mut Scope<'a>,
        word: &'a syntax::Transform,
        placing: &mut Placing,
    ) -> Option<()> {
        let name = &word.name;
        let args = word.args.as_deref().unwrap_or_default();
        let takes = match (name.text.as_str(), args) {
            ("corner", []) => {
                placing.corner = true;
                return Some(());
            }
            ("corner", _) => "no arguments",
            ("scale", [_] | [_, _, _]) => {
                let transform = match self.floats(scope, word, args)?.try_into() {
                    Ok(factors) => Transform::Stretch(factors),
                    Err(one) => Transform::Scale(one.into_iter().next()?),
                };
                placing.transforms.push(transform);
                return Some(());
            }
            ("scale", _) => "one factor, or one for each of x, y and z",
            ("uv", [_, _] | [_, _, _, _]) => {
                let mut bounds = self.floats(scope, word, args)?.into_iter();
                let mut pair = || Some([bounds.next()?, bounds.next()?]);
                placing.uv = Some(UvRange { u: pair()?, v: pair() });
                return Some(());
            }
            ("uv", _) => "u0 and u1, or u0, u1, v0 and v1",
            ("rotate", [axis, angle]) => {
                let axis = self.axis(scope, axis);
                let why = || "an angle is a number of degrees".into();
                let angle = self.expr(scope, angle, &Type::Float, why);
                placing.transforms.push(Transform::Rotate { axis: axis?, angle: angle? });
                return Some(());
            }
            ("rotate", _) => "an axis and an angle in degrees: `rotate(z, 90)`",
            _ => {
                let hint = self.nearest(&name.text, ["scale", "rotate", "corner", "uv"]);
                let message = format!("there is no transform `{}`", name.text);
                let error = Diagnostic::error(code::UNKNOWN_TRANSFORM, name.span, message);
                let all = "the transforms are `scale`, `rotate`, `corner` and `uv`".to_string();
                self.report(error.hint(hint.unwrap_or(all)));
                return None;
            }
        };
        let message = format!("`{}` takes {takes}", name.text);
        self.report(Diagnostic::error(code::FUNCTION_ARITY, name.span, message));
        None
    }

    fn floats(
        &mut self,
        scope: &mut Scope<'a>,
        word: &syntax::Transform,
        args: &'a [syntax::Expr],
    ) -> Option<Vec<Expr>> {
        let float =
            |arg| self.expr(scope, arg, &Type::Float, || format!("`{}` takes numbers", word.name.text));
        let floats: Vec<Option<Expr>> = args.iter().map(float).collect();
        floats.into_iter().collect()
    }

    /// An axis by name, or a vector.
    fn axis(&mut self, scope: &mut Scope<'a>, axis: &'a syntax::Expr) -> Option<Expr> {
        let named = match &axis.kind {
            ExprKind::Name(name) => ["x", "y", "z"].iter().position(|axis| axis == name),
            _ => None,
        };
        let Some(named) = named else {
            return self.expr(scope, axis, &Type::Vec3, || "an axis is `x`, `y`, `z` or a vec3".into());
        };
        let mut unit = [0.0; 3];
        unit[named] = 1.0;
        Some(Expr::literal(Value::Vec3(unit), axis.span))
    }
}
