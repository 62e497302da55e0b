//! Meshes that are made from arguments, and those that an axiom starts from.

use super::mesh::{KnownSlots, axiom_slots, shape_slots};
use super::placing::Placing;
use super::scope::{Scope, Where};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::Type;
use crate::language::syntax::{self, ExprKind, Name, Span};
use crate::language::system::{MeshSource, MeshStart, PointField, ShapeArg, ShapeUse};
use crate::language::vocabulary::{Parameter, ParameterKind, Role, Shape, Slots};

impl<'a> Checker<'a> {
    /// A shape or built-in template with its arguments.
    pub(super) fn shape_use(
        &mut self,
        scope: &mut Scope<'a>,
        shape: &Shape,
        args: &'a [syntax::Expr],
        span: Span,
    ) -> Option<ShapeUse> {
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
            return None;
        }
        let mut curve = None;
        let mut lowered = Vec::with_capacity(args.len());
        for (arg, parameter) in args.iter().zip(&shape.parameters) {
            lowered.push(self.shape_argument(scope, shape, parameter, arg, &mut curve));
        }
        let args = lowered.into_iter().collect::<Option<_>>()?;
        Some(ShapeUse { shape: shape.name, args, span })
    }

    /// `curve` is the earlier system of the arguments so far.
    fn shape_argument(
        &mut self,
        scope: &mut Scope<'a>,
        shape: &Shape,
        parameter: &Parameter,
        arg: &'a syntax::Expr,
        curve: &mut Option<usize>,
    ) -> Option<ShapeArg> {
        match &parameter.kind {
            ParameterKind::Value(ty) => {
                let why =
                    || format!("`{}` of `{}` is {}", parameter.name, shape.name, super::typing::article(ty));
                self.expr(scope, arg, ty, why).map(ShapeArg::Value)
            }
            ParameterKind::Curve => {
                *curve = self.earlier_argument(arg, syntax::Kind::Curve, shape, parameter);
                let name = self.earlier[(*curve)?].name.clone();
                Some(ShapeArg::Curve { name, span: arg.span })
            }
            ParameterKind::Patch => {
                let patch = self.earlier_argument(arg, syntax::Kind::Patch, shape, parameter)?;
                Some(ShapeArg::Patch { name: self.earlier[patch].name.clone(), span: arg.span })
            }
            ParameterKind::PerPoint => {
                let mut point = Scope::new(scope.place);
                point.fields = curve.map_or_else(Vec::new, |c| self.fields_of_points(c));
                let why = || format!("`{}` is a number", parameter.name);
                let value = self.expr(&mut point, arg, &Type::Float, why)?;
                Some(ShapeArg::PerPoint { fields: point.fields, value })
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
    /// writes, or of all its modules. Of those of one name the first says the type.
    fn fields_of_points(&self, earlier: usize) -> Vec<PointField> {
        let earlier = &self.earlier[earlier];
        let mut fields: Vec<PointField> = Vec::new();
        for (symbol, of) in earlier.symbols.iter().enumerate() {
            if earlier.traced.is_some_and(|traced| traced != symbol) {
                continue;
            }
            for (index, field) in of.fields.iter().enumerate() {
                let place = (symbol, index);
                match fields.iter_mut().find(|known| known.name == field.name) {
                    Some(known) if known.ty == field.ty => known.places.push(place),
                    Some(_) => {}
                    None => {
                        let (name, ty) = (field.name.clone(), field.ty.clone());
                        fields.push(PointField { name, ty, places: vec![place] });
                    }
                }
            }
        }
        fields
    }

    /// A mesh that an axiom starts from, its transforms and slots.
    pub(super) fn mesh_start(&mut self, start: &'a syntax::MeshStart) -> Option<MeshStart> {
        let mut scope = Scope::new(Where::Axiom);
        let (source, known) = self.mesh_source(&mut scope, &start.source);
        let placing = self.placing(&mut scope, &start.at);
        let fillings = match &start.slots {
            Some(slots) => {
                let name = match &start.source.kind {
                    syntax::SourceKind::Named(name, _) => name.text.as_str(),
                    _ => "the file",
                };
                self.fillings(&mut scope, slots, &known, name)
            }
            None => Some(Vec::new()),
        };
        // That its first corner meets one says nothing where there is no face.
        let Placing { transforms, uv, .. } = placing?;
        Some(MeshStart { source: source?, transforms, uv, fillings: fillings?, span: start.source.span })
    }

    /// What the source stands for, and its slots.
    fn mesh_source(
        &mut self,
        scope: &mut Scope<'a>,
        source: &'a syntax::Source,
    ) -> (Option<MeshSource>, KnownSlots) {
        if let Some(shift) = &source.shift {
            let message = "`shift` turns the ring of a curve system";
            self.report(Diagnostic::error(code::AXIOM, shift.span, message));
        }
        let (name, args) = match &source.kind {
            syntax::SourceKind::File(path, index) => {
                let index = self.file_index(index.as_ref());
                let file = MeshSource::File { path: path.text.clone(), index, span: path.span };
                return (Some(file), None);
            }
            syntax::SourceKind::List(list) => {
                let message = "a mesh cannot be written as a list";
                let error = Diagnostic::error(code::AXIOM, list.span, message);
                self.report(error.hint("write it as a `template`, or start from a file or a shape"));
                return (None, None);
            }
            syntax::SourceKind::Named(name, args) => (name, args.as_deref()),
        };
        if let Some((id, _)) = self.template_ids.get(name.text.as_str()).copied() {
            self.no_template_arguments(name, args, source.span);
            let Some(template) = id else { return (None, None) };
            let slots = axiom_slots(&self.templates[template]);
            return (Some(MeshSource::Template { template, span: name.span }), slots);
        }
        if let Some(shape) = self.shape(&name.text, Role::Axiom) {
            let made = self.shape_use(scope, &shape, args.unwrap_or_default(), source.span);
            let slots = match &shape.slots {
                Slots::Named(_) => shape_slots(&shape),
                Slots::SymbolsOf => self.symbols_of(args.unwrap_or_default()),
            };
            return (made.map(MeshSource::Shape), slots);
        }
        if self.earlier.iter().any(|e| e.name == name.text) {
            let found = self.earlier_system(&name.text, name.span, syntax::Kind::Mesh);
            let system = found.map(|_| MeshSource::System { name: name.text.clone(), span: name.span });
            return (system, None);
        }
        self.unknown_mesh(name);
        (None, None)
    }

    fn symbols_of(&self, args: &[syntax::Expr]) -> KnownSlots {
        let Some(ExprKind::Name(name)) = args.first().map(|a| &a.kind) else { return None };
        let earlier = self.earlier.iter().find(|e| e.name == *name)?;
        Some(earlier.symbols.iter().map(|s| (s.name.clone(), Vec::new())).collect())
    }

    fn unknown_mesh(&mut self, name: &Name) {
        let shapes = self.vocabulary.shapes.iter().filter(|s| s.role == Role::Axiom).map(|s| s.name);
        let systems = self.earlier.iter().filter(|e| e.kind == syntax::Kind::Mesh).map(|e| e.name.as_str());
        let candidates = self.template_ids.keys().copied().chain(shapes).chain(systems);
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
