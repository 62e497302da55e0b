//! Successors, and the modules that stand in them.

use super::declare::{Omitted, TURTLE};
use super::scope::{Scope, Where};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::syntax::{self, Element, ModuleUse, Span};
use crate::language::system::{FaceModule, Field, Kind, Module, Successor, SymbolId, Topology};

impl<'a> Checker<'a> {
    pub(super) fn successor(
        &mut self,
        scope: &mut Scope<'a>,
        predecessor: &'a syntax::Predecessor,
        alternative: &'a syntax::Alternative,
    ) -> Option<Successor> {
        match (&alternative.successor, self.kind) {
            (syntax::Successor::Word(word), Kind::Patch { .. }) => {
                self.patch_successor(scope, word, alternative.span)
            }
            (syntax::Successor::Word(word), Kind::Curve(_)) => {
                let mut modules = Vec::new();
                let whole = self.word(scope, word, &mut modules);
                whole.then(|| Successor::Word(super::branches::curve_word(word, modules)))
            }
            (syntax::Successor::Word(word), Kind::Mesh) => {
                self.mesh_word(scope, predecessor, word, alternative.span).map(Successor::Face)
            }
            (syntax::Successor::Template(used), Kind::Mesh) => {
                self.template_use(scope, predecessor, used).map(Successor::Face)
            }
            (syntax::Successor::Template(used), _) => {
                self.wrong_kind("a template", used.span, &[syntax::Kind::Mesh]);
                None
            }
        }
    }

    /// A word of a curve system, its branches flattened.
    pub(super) fn word(
        &mut self,
        scope: &mut Scope<'a>,
        word: &'a [Element],
        modules: &mut Vec<Module>,
    ) -> bool {
        let mut whole = true;
        for element in word {
            match element {
                Element::Eps(_) => {}
                Element::Module(used) => match self.module_use(scope, used) {
                    Some(module) => {
                        if matches!(self.kind, Kind::Curve(_)) && scope.place == Where::Rule {
                            self.affine(scope, used, module.symbol);
                        }
                        modules.push(module);
                    }
                    None => whole = false,
                },
                Element::Branch(branch, span) => {
                    if matches!(self.kind, Kind::Curve(Topology::Ring | Topology::Open)) {
                        self.no_branches(*span);
                        whole = false;
                    }
                    whole &= self.word(scope, branch, modules);
                }
                Element::Block(block) => {
                    let message = "a block belongs to patch systems";
                    let error = Diagnostic::error(code::SUCCESSOR, block.span, message);
                    self.report(error.hint("a branch holds neither `|` nor `;` of its own"));
                    whole = false;
                }
            }
        }
        whole
    }

    /// A module of a curve or patch system.
    pub(super) fn module_use(&mut self, scope: &mut Scope<'a>, used: &'a ModuleUse) -> Option<Module> {
        if used.tag.is_some() {
            let message = "only the faces of mesh systems have tags";
            self.report(Diagnostic::error(code::TAG, used.span, message));
        }
        self.module_with_arguments(scope, used)
    }

    /// A module on a face, with its tag.
    pub(super) fn face_module(&mut self, scope: &mut Scope<'a>, used: &'a ModuleUse) -> Option<FaceModule> {
        let module = self.module_with_arguments(scope, used);
        let tag = self.tag(scope, used);
        Some(FaceModule { module: module?, tag: tag? })
    }

    /// A module with its arguments, given the types of its fields.
    fn module_with_arguments(&mut self, scope: &mut Scope<'a>, used: &'a ModuleUse) -> Option<Module> {
        let symbol = self.symbol(&used.symbol).filter(|s| !self.broken_symbols.contains(s))?;
        let fields = self.symbols[symbol].fields.clone();
        let args = used.args.as_deref().unwrap_or_default();
        if used.args.is_none()
            && let Some(omitted) = self.omitted(symbol)
        {
            let arg = self.omitted_argument(omitted, used.span)?;
            return Some(Module { symbol, args: vec![arg], span: used.span });
        }
        if args.len() != fields.len() {
            self.module_arity(symbol, used, args.len());
            // What stands in them may be wrong, too.
            args.iter().for_each(|a| _ = self.operand(scope, a));
            return None;
        }
        let mut lowered = Vec::with_capacity(args.len());
        let mut whole = true;
        for (arg, field) in args.iter().zip(&fields) {
            match self.argument(scope, arg, field, symbol) {
                Some(arg) => lowered.push(arg),
                None => whole = false,
            }
        }
        whole.then_some(Module { symbol, args: lowered, span: used.span })
    }

    fn argument(
        &mut self,
        scope: &mut Scope<'a>,
        arg: &'a syntax::Expr,
        field: &Field,
        symbol: SymbolId,
    ) -> Option<Expr> {
        let operand = self.operand(scope, arg)?;
        let name = self.symbols[symbol].name.clone();
        self.coerce(operand, &field.ty, || {
            format!("`{}` of `{name}` is {}", field.name, super::typing::article(&field.ty))
        })
    }

    /// What stands for the argument that a turtle symbol may do without.
    fn omitted(&self, symbol: SymbolId) -> Option<Omitted> {
        let (.., omitted) = TURTLE.iter().find(|(name, ..)| *name == self.symbols[symbol].name)?;
        self.is_turtles(symbol).then_some(*omitted)
    }

    /// Whether the symbol is one of the turtle: in patch systems a declared module may have the name of one.
    pub(super) fn is_turtles(&self, symbol: SymbolId) -> bool {
        let name = &self.symbols[symbol].name;
        let declared = self.system.items.iter().any(|item| match item {
            syntax::Item::Modules(modules) => modules.iter().any(|m| m.symbol.text == *name),
            _ => false,
        });
        super::declare::is_turtle(name) && !declared
    }

    fn omitted_argument(&mut self, omitted: Omitted, span: Span) -> Option<Expr> {
        let number = |x: f32| Some(Expr::literal(Value::Float(x), span));
        match omitted {
            Omitted::One => number(1.0),
            Omitted::HalfTurn => number(180.0),
            Omitted::Angle => {
                let Some(index) = self.names.find("angle") else { return number(90.0) };
                let expr = match self.known(index) {
                    super::names::Known::Value(value) => Expr::literal(value, span),
                    super::names::Known::Uniform(index, ty) => {
                        Expr { ty, kind: ExprKind::Uniform(index), span }
                    }
                    super::names::Known::Broken => return None,
                };
                let operand = super::typing::Operand { term: super::typing::Term::Typed(expr), span };
                self.coerce(operand, &Type::Float, || "the turtle's `angle` is a number".into())
            }
        }
    }

    fn module_arity(&mut self, symbol: SymbolId, used: &ModuleUse, given: usize) {
        let symbol = &self.symbols[symbol];
        let types: Vec<String> = match symbol.fields.as_slice() {
            [field] => vec![format!("one {}", field.ty)],
            fields => fields.iter().map(|f| f.ty.to_string()).collect(),
        };
        let examples: Vec<&str> = symbol.fields.iter().map(|f| example(&f.ty)).collect();
        let message = match symbol.fields.len() {
            0 => format!("`{}` takes no arguments", symbol.name),
            n if given == 0 => format!("`{}` needs {}", symbol.name, suggest::count(n, "argument")),
            1 => format!("`{}` takes {}, not {}", symbol.name, types[0], suggest::count(given, "argument")),
            n => format!("`{}` takes {n} arguments ({}), not {given}", symbol.name, types.join(", ")),
        };
        let hint = match examples.as_slice() {
            [] => format!("write `{}`", symbol.name),
            examples => format!("as in `{}({})`", symbol.name, examples.join(", ")),
        };
        let error = Diagnostic::error(code::MODULE_ARITY, used.span, message);
        let error = error.label(symbol.span, "it is declared here");
        self.report(error.hint(hint));
    }

    /// Empty where none is written.
    fn tag(&mut self, scope: &mut Scope<'a>, used: &'a ModuleUse) -> Option<Vec<Expr>> {
        let Some(tag) = &used.tag else { return Some(Vec::new()) };
        let ints: Vec<Option<Expr>> =
            tag.iter().map(|part| self.expr(scope, part, &Type::Int, || "tags are ints".into())).collect();
        let symbol = self.symbol_ids.get(used.symbol.text.as_str()).copied()?;
        let (length, first) = *self.tags.entry(symbol).or_insert((tag.len(), used.span));
        if length != tag.len() {
            let message = format!(
                "the tags of `{}` have {} here and {length} elsewhere",
                used.symbol.text,
                suggest::count(tag.len(), "component")
            );
            let error = Diagnostic::error(code::TAG, used.span, message);
            self.report(error.label(first, "the other is here"));
        }
        ints.into_iter().collect()
    }
}

pub(super) fn example(ty: &Type) -> &'static str {
    match ty {
        Type::Bool => "true",
        Type::Int => "0",
        Type::Float => "0.5",
        Type::Vec2 => "(0, 0)",
        Type::Vec3 => "(0, 0, 0)",
        Type::Vec4 => "(0, 0, 0, 1)",
        Type::List(..) => "…",
    }
}
