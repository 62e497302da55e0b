//! What a name in an expression stands for.

use super::names::Known;
use super::scope::{Local, Scope, Where};
use super::typing::Operand;
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, ExprKind, Value};
use crate::language::ops;
use crate::language::syntax::Span;
use crate::language::system::{Uniform, UniformKind};
use crate::language::vocabulary::{Attribute, Owner};

/// Names that shaders have for the time of a frame.
const CLOCKS: [&str; 8] = ["time", "iTime", "uTime", "u_time", "now", "seconds", "elapsed", "frame_time"];

impl<'a> Checker<'a> {
    pub(super) fn name(&mut self, scope: &mut Scope<'a>, name: &str, span: Span) -> Option<Operand> {
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
        if let Some(index) = scope.fields.iter().position(|field| field.name == name) {
            let ty = scope.fields[index].ty.clone();
            return Operand::typed(Expr { ty, kind: ExprKind::Binder(index), span });
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
            move |a: &&Attribute| a.name == name && place.sees(a.of, kind, in_slot)
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
            let of_meshes = |a: &Attribute| a.name == name && a.of == Owner::Place;
            let hint = match scope.place {
                Where::Place if self.vocabulary.attributes.iter().any(of_meshes) => {
                    "what displaces a tessellation must not hang on how finely it is cut".to_string()
                }
                _ => format!("it is known in {}", attribute.of.describe()),
            };
            self.report(error.hint(hint));
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
        let clock = CLOCKS.iter().any(|clock| clock.eq_ignore_ascii_case(name));
        let hint = if clock {
            Some(format!("declare `param {name}: float = 0`, which the host sets in each frame"))
        } else if self.query_ids.contains_key(name) {
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
            self.nearest(name, candidates)
        };
        let message = format!("there is no `{name}` here");
        self.report(Diagnostic::error(code::UNKNOWN_NAME, span, message).hint_if(hint));
    }
}
