//! Meshes that are made from arguments, and those that an axiom starts from.

use super::mesh::{KnownSlots, axiom_slots, shape_slots};
use super::scope::{Scope, Where};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::Type;
use crate::language::syntax::{self, ExprKind, Name, Span};
use crate::language::vocabulary::{Parameter, ParameterKind, Role, Shape, Slots};

impl<'a> Checker<'a> {
    /// The arguments of a shape or built-in template.
    pub(super) fn shape_args(
        &mut self,
        scope: &mut Scope<'a>,
        shape: &Shape,
        args: &'a [syntax::Expr],
        span: Span,
    ) {
        if args.len() != shape.parameters.len() {
            let names: Vec<&str> = shape.parameters.iter().map(|p| p.name).collect();
            let message = format!(
                "`{}` takes {}, not {}",
                shape.name,
                suggest::count(shape.parameters.len(), "argument"),
                args.len()
            );
            let error = Diagnostic::error(code::FUNCTION_ARITY, span, message);
            self.report(error.hint(format!("it is `{}({})`", shape.name, names.join(", "))));
            return;
        }
        let mut curve = None;
        for (arg, parameter) in args.iter().zip(&shape.parameters) {
            match &parameter.kind {
                ParameterKind::Value(ty) => {
                    let why = || {
                        format!("`{}` of `{}` is {}", parameter.name, shape.name, super::typing::article(ty))
                    };
                    self.expr(scope, arg, ty, why);
                }
                ParameterKind::Curve => {
                    curve = self.earlier_argument(arg, syntax::Kind::Curve, shape, parameter)
                }
                ParameterKind::Patch => _ = self.earlier_argument(arg, syntax::Kind::Patch, shape, parameter),
                ParameterKind::PerPoint => {
                    let mut point = Scope::new(scope.place);
                    point.fields = curve.map_or_else(Vec::new, |c| self.fields_of_points(c));
                    self.expr(&mut point, arg, &Type::Float, || format!("`{}` is a number", parameter.name));
                }
            }
        }
    }

    fn earlier_argument(
        &mut self,
        arg: &'a syntax::Expr,
        kind: syntax::Kind,
        shape: &Shape,
        parameter: &Parameter,
    ) -> Option<usize> {
        let word = super::declare::kind_word(kind);
        let ExprKind::Name(name) = &arg.kind else {
            let message =
                format!("`{}` of `{}` is the name of an earlier {word} system", parameter.name, shape.name);
            self.report(Diagnostic::error(code::TYPE, arg.span, message));
            return None;
        };
        self.earlier_system(name, arg.span, kind)
    }

    /// The earlier system of that name, if it is of that kind.
    pub(super) fn earlier_system(&mut self, name: &str, span: Span, kind: syntax::Kind) -> Option<usize> {
        let word = super::declare::kind_word(kind);
        let found = self.earlier.iter().position(|e| e.name == name);
        match found.map(|i| self.earlier[i].kind) {
            Some(found_kind) if found_kind == kind => found,
            Some(other) => {
                let other = super::declare::kind_word(other);
                let message = format!("`{name}` is a {other} system, and a {word} system is needed here");
                self.report(Diagnostic::error(code::UNKNOWN_TEMPLATE, span, message));
                None
            }
            None => {
                let fitting = self.earlier.iter().filter(|e| e.kind == kind).map(|e| e.name.as_str());
                let hint = self.nearest(name, fitting).or_else(|| {
                    let systems = self.earlier.iter().map(|e| e.name.as_str());
                    (systems.count() == 0).then(|| "a system may only use those that stand above it".into())
                });
                let message = format!("there is no earlier {word} system `{name}`");
                self.report(Diagnostic::error(code::UNKNOWN_TEMPLATE, span, message).hint_if(hint));
                None
            }
        }
    }

    /// What may be asked of each point of a curve: the fields of the module that its turtle
    /// writes, or of all its modules.
    fn fields_of_points(&self, earlier: usize) -> Vec<(String, Type)> {
        let earlier = &self.earlier[earlier];
        let symbols = match earlier.traced {
            Some(symbol) => earlier.symbols.get(symbol).map_or(&[][..], std::slice::from_ref),
            None => &earlier.symbols,
        };
        symbols.iter().flat_map(|s| &s.fields).map(|f| (f.name.clone(), f.ty.clone())).collect()
    }

    /// The arguments, transforms and slots of a mesh that an axiom starts from.
    pub(super) fn mesh_start(&mut self, start: &'a syntax::MeshStart) {
        let mut scope = Scope::new(Where::Axiom);
        let known = self.mesh_source(&mut scope, &start.source);
        self.transforms(&mut scope, &start.at);
        if let Some(slots) = &start.slots {
            let name = match &start.source.kind {
                syntax::SourceKind::Named(name, _) => name.text.as_str(),
                _ => "the file",
            };
            self.slots(&mut scope, slots, &known, name);
        }
    }

    fn mesh_source(&mut self, scope: &mut Scope<'a>, source: &'a syntax::Source) -> KnownSlots {
        if let Some(shift) = &source.shift {
            let message = "`shift` turns the ring of a curve system";
            self.report(Diagnostic::error(code::AXIOM, shift.span, message));
        }
        let (name, args) = match &source.kind {
            syntax::SourceKind::File(..) => return None,
            syntax::SourceKind::List(list) => {
                let message = "a mesh cannot be written as a list";
                let error = Diagnostic::error(code::AXIOM, list.span, message);
                self.report(error.hint("write it as a `template`, or start from a file or a shape"));
                return None;
            }
            syntax::SourceKind::Named(name, args) => (name, args.as_deref()),
        };
        if let Some(template) = self.templates.get(name.text.as_str()).cloned() {
            if args.is_some_and(|args| !args.is_empty()) {
                let message = format!("the template `{}` takes no arguments", name.text);
                self.report(Diagnostic::error(code::FUNCTION_ARITY, source.span, message));
            }
            return axiom_slots(&template);
        }
        if let Some(shape) = self.shape(&name.text, Role::Axiom) {
            self.shape_args(scope, &shape, args.unwrap_or_default(), source.span);
            return match &shape.slots {
                Slots::Named(_) => shape_slots(&shape),
                Slots::SymbolsOf => self.symbols_of(args.unwrap_or_default()),
            };
        }
        if self.earlier.iter().any(|e| e.name == name.text) {
            self.earlier_system(&name.text, name.span, syntax::Kind::Mesh);
            return None;
        }
        self.unknown_mesh(name);
        None
    }

    fn symbols_of(&self, args: &[syntax::Expr]) -> KnownSlots {
        let Some(ExprKind::Name(name)) = args.first().map(|a| &a.kind) else { return None };
        let earlier = self.earlier.iter().find(|e| e.name == *name)?;
        Some(earlier.symbols.iter().map(|s| (s.name.clone(), Vec::new())).collect())
    }

    fn unknown_mesh(&mut self, name: &Name) {
        let shapes = self.vocabulary.shapes.iter().filter(|s| s.role == Role::Axiom).map(|s| s.name);
        let systems = self.earlier.iter().filter(|e| e.kind == syntax::Kind::Mesh).map(|e| e.name.as_str());
        let candidates = self.templates.keys().copied().chain(shapes).chain(systems);
        let hint = self.nearest(&name.text, candidates);
        let (message, hint) = if self.shape(&name.text, Role::Template).is_some() {
            let message = format!("`{}` replaces a face and is no mesh to start from", name.text);
            (message, Some("start from a shape such as `box(1, 1, 1)`".to_string()))
        } else {
            (format!("there is no template, shape or earlier system `{}`", name.text), hint)
        };
        self.report(Diagnostic::error(code::UNKNOWN_TEMPLATE, name.span, message).hint_if(hint));
    }
}
