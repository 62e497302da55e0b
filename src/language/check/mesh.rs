//! Successors of mesh systems: templates, their places and their slots.

use super::scope::Scope;
use super::templates::Template;
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::Type;
use crate::language::syntax::{self, Element, ExprKind, Name, Slot, SlotFill, Span, Transform};
use crate::language::system::{Module, Successor, SymbolId};
use crate::language::vocabulary::{Role, Shape, Slots};
use std::collections::HashMap;

/// The slots of a template or shape: names with the numbers of corners of their faces, if known.
/// Absent where a file must be read first.
pub(super) type KnownSlots = Option<Vec<(String, Vec<usize>)>>;

/// A template as used in a successor.
#[derive(Clone, Copy)]
struct Use<'a> {
    name: &'a Name,
    args: Option<&'a [syntax::Expr]>,
    place: Option<&'a syntax::TemplatePlace>,
    slots: Option<&'a [Slot]>,
    span: Span,
}

impl<'a> Checker<'a> {
    /// `eps`, a module, or a template with nothing around it.
    pub(super) fn mesh_word(
        &mut self,
        scope: &mut Scope<'a>,
        predecessor: &'a syntax::Predecessor,
        word: &'a [Element],
        span: Span,
    ) -> Option<Successor> {
        let used = match word {
            [Element::Eps(_)] => return Some(Successor::Modules(Vec::new())),
            [Element::Module(used)] => used,
            _ => {
                let message = "a successor of a mesh system is one template, one module or `eps`";
                let error = Diagnostic::error(code::SUCCESSOR, span, message);
                self.report(
                    error.hint("several faces come from a template with slots: `extrude(1) { top: A }`"),
                );
                return None;
            }
        };
        let name = used.symbol.text.as_str();
        let is_template =
            self.templates.contains_key(name) || self.vocabulary.shapes.iter().any(|s| s.name == name);
        if is_template && !self.symbol_ids.contains_key(name) {
            let (args, span) = (used.args.as_deref(), used.span);
            let used = Use { name: &used.symbol, args, place: None, slots: None, span };
            return self.template_used(scope, predecessor, used).map(Successor::Modules);
        }
        if predecessor.joined {
            let message = "joined faces are replaced by a template";
            self.report(Diagnostic::error(code::SUCCESSOR, used.span, message));
        }
        let module = self.module_use(scope, used)?;
        if let Some(from) = predecessor.strict.first().and_then(|p| self.known_symbol(&p.symbol)) {
            self.corners.relabelled.push((from, module.symbol));
        }
        Some(Successor::Modules(vec![module]))
    }

    fn known_symbol(&self, name: &Name) -> Option<SymbolId> {
        self.symbol_ids.get(name.text.as_str()).copied()
    }

    pub(super) fn template_use(
        &mut self,
        scope: &mut Scope<'a>,
        predecessor: &'a syntax::Predecessor,
        used: &'a syntax::TemplateUse,
    ) -> Option<Vec<Module>> {
        let used = Use {
            name: &used.name,
            args: used.args.as_deref(),
            place: used.place.as_ref(),
            slots: used.slots.as_deref(),
            span: used.span,
        };
        self.template_used(scope, predecessor, used)
    }

    fn template_used(
        &mut self,
        scope: &mut Scope<'a>,
        predecessor: &'a syntax::Predecessor,
        used: Use<'a>,
    ) -> Option<Vec<Module>> {
        let name = used.name.text.as_str();
        let known = if let Some(template) = self.templates.get(name).cloned() {
            if used.args.is_some_and(|args| !args.is_empty()) {
                let message = format!("the template `{name}` takes no arguments");
                self.report(Diagnostic::error(code::FUNCTION_ARITY, used.span, message));
            }
            self.base_fits(predecessor, &template, used);
            known_slots(&template)
        } else if let Some(shape) = self.shape(name, Role::Template) {
            self.shape_args(scope, &shape, used.args.unwrap_or_default(), used.span);
            shape_slots(&shape)
        } else {
            self.unknown_template(used);
            None
        };
        if let Some(place) = used.place {
            self.transforms(scope, &place.transforms);
        }
        used.slots.map_or(Some(Vec::new()), |slots| self.slots(scope, slots, &known, name))
    }

    pub(super) fn shape(&self, name: &str, role: Role) -> Option<Shape> {
        self.vocabulary.shapes.iter().find(|s| s.name == name && s.role == role).cloned()
    }

    fn unknown_template(&mut self, used: Use<'a>) {
        let name = used.name.text.as_str();
        let (message, hint) = if self.shape(name, Role::Axiom).is_some() {
            (format!("`{name}` is a mesh that an axiom starts from, not a template"), None)
        } else if self.symbol_ids.contains_key(name) {
            let message = format!("`{name}` is a module, and only templates are placed or have slots");
            (message, Some(format!("write `{name}` alone to give the face that symbol")))
        } else {
            let shapes = self.vocabulary.shapes.iter().filter(|s| s.role == Role::Template).map(|s| s.name);
            let hint = self.nearest(name, self.templates.keys().copied().chain(shapes));
            (format!("there is no template `{name}`"), hint)
        };
        self.report(Diagnostic::error(code::UNKNOWN_TEMPLATE, used.name.span, message).hint_if(hint));
    }

    fn base_fits(&mut self, predecessor: &'a syntax::Predecessor, template: &Template<'a>, used: Use<'a>) {
        if used.place.is_some_and(|p| p.on) {
            return;
        }
        let replaced = predecessor.strict.len();
        let bases = template.bases.len();
        let name = &used.name.text;
        if bases == 0 && template.groups.is_some() {
            let message = format!("the template `{name}` has no base to stand on");
            let error = Diagnostic::error(code::TEMPLATE_BASE, used.name.span, message);
            let error = error.label(template.span, "it is declared here");
            self.report(error.hint("name a face `base`, or write `base NAME` behind the template"));
        } else if bases > 0 && bases != replaced {
            let message = format!(
                "the template `{name}` has {}, and the rule replaces {}",
                suggest::count(bases, "base"),
                suggest::count(replaced, "face")
            );
            let error = Diagnostic::error(code::TEMPLATE_BASE, used.name.span, message);
            self.report(error.label(template.span, "it is declared here"));
        }
        for (pattern, corners) in predecessor.strict.iter().zip(template.base_corners()) {
            if let Some(symbol) = self.known_symbol(&pattern.symbol) {
                self.corners.needed.push((symbol, corners, used.span));
            }
        }
    }

    /// Fills slots; returns the modules in the order written, one for each name.
    pub(super) fn slots(
        &mut self,
        scope: &mut Scope<'a>,
        slots: &'a [Slot],
        known: &KnownSlots,
        template: &str,
    ) -> Option<Vec<Module>> {
        let mut seen: HashMap<&str, Span> = HashMap::new();
        let mut modules = Vec::new();
        let mut whole = true;
        for slot in slots {
            let module = match &slot.fill {
                SlotFill::Eps(_) => None,
                SlotFill::Module(used) => {
                    scope.in_slot = true;
                    let module = self.module_use(scope, used);
                    scope.in_slot = false;
                    whole &= module.is_some();
                    module
                }
            };
            self.slot_names(slot, known, template);
            for name in &slot.names {
                if let Some(first) = seen.insert(&name.text, name.span) {
                    self.duplicate("fillings of the slot", &name.text, name.span, first);
                }
                if let Some(module) = &module {
                    self.slot_corners(module.symbol, known, &name.text);
                    modules.push(module.clone());
                }
            }
        }
        whole.then_some(modules)
    }

    fn slot_corners(&mut self, symbol: SymbolId, known: &KnownSlots, name: &str) {
        let sizes = known.as_ref().and_then(|k| k.iter().find(|(slot, _)| slot == name));
        match sizes.map(|(_, sizes)| sizes.as_slice()) {
            None | Some([]) => self.corners.given.push((symbol, None)),
            Some(sizes) => self.corners.given.extend(sizes.iter().map(|n| (symbol, Some(*n)))),
        }
    }

    /// A slot that does not exist is an error; in a list that names another one, a warning.
    fn slot_names(&mut self, slot: &'a Slot, known: &KnownSlots, template: &str) {
        let Some(known) = known else { return };
        let exists = |name: &Name| known.iter().any(|(slot, _)| *slot == name.text);
        let some = slot.names.iter().any(exists);
        for name in slot.names.iter().filter(|n| !exists(n)) {
            let names = known.iter().map(|(slot, _)| slot.as_str());
            let hint = self.nearest(&name.text, names.clone()).unwrap_or_else(|| match known.len() {
                0 => "it has no slots".into(),
                _ => format!("it has {}", suggest::list(names)),
            });
            let message = format!("`{template}` has no slot `{}`", name.text);
            let finding = if some {
                Diagnostic::warning(code::SLOT_IGNORED, name.span, message)
            } else {
                Diagnostic::error(code::UNKNOWN_SLOT, name.span, message)
            };
            self.report(finding.hint(hint));
        }
    }

    pub(super) fn transforms(&mut self, scope: &mut Scope<'a>, transforms: &'a [Transform]) {
        for transform in transforms {
            self.transform(scope, transform);
        }
    }

    fn transform(&mut self, scope: &mut Scope<'a>, transform: &'a Transform) {
        let name = &transform.name;
        let args = transform.args.as_deref().unwrap_or_default();
        let takes = match (name.text.as_str(), args) {
            ("corner", []) => return,
            ("corner", _) => "no arguments",
            ("scale", [_] | [_, _, _]) | ("uv", [_, _] | [_, _, _, _]) => {
                for arg in args {
                    self.expr(scope, arg, &Type::Float, || format!("`{}` takes numbers", name.text));
                }
                return;
            }
            ("scale", _) => "one factor, or one for each of x, y and z",
            ("uv", _) => "u0 and u1, or u0, u1, v0 and v1",
            ("rotate", [axis, angle]) => {
                let named =
                    matches!(&axis.kind, ExprKind::Name(axis) if matches!(axis.as_str(), "x" | "y" | "z"));
                if !named {
                    self.expr(scope, axis, &Type::Vec3, || "an axis is `x`, `y`, `z` or a vec3".into());
                }
                self.expr(scope, angle, &Type::Float, || "an angle is a number of degrees".into());
                return;
            }
            ("rotate", _) => "an axis and an angle in degrees: `rotate(z, 90)`",
            _ => {
                let hint = self.nearest(&name.text, ["scale", "rotate", "corner", "uv"]);
                let message = format!("there is no transform `{}`", name.text);
                let error = Diagnostic::error(code::UNKNOWN_TRANSFORM, name.span, message);
                let all = "the transforms are `scale`, `rotate`, `corner` and `uv`".to_string();
                self.report(error.hint(hint.unwrap_or(all)));
                return;
            }
        };
        let message = format!("`{}` takes {takes}", name.text);
        self.report(Diagnostic::error(code::FUNCTION_ARITY, name.span, message));
    }
}

/// All groups of a template, its base among them: an axiom has no face for it to land on.
pub(super) fn axiom_slots(template: &Template) -> KnownSlots {
    let groups = template.groups.as_ref()?;
    Some(groups.iter().map(|(name, corners)| (name.to_string(), corners.clone())).collect())
}

/// The groups of a template but its bases, which vanish.
fn known_slots(template: &Template) -> KnownSlots {
    let mut slots = axiom_slots(template)?;
    slots.retain(|(name, _)| !template.bases.contains(&name.as_str()));
    Some(slots)
}

pub(super) fn shape_slots(shape: &Shape) -> KnownSlots {
    match &shape.slots {
        Slots::Named(slots) => {
            Some(slots.iter().map(|s| (s.name.to_string(), s.corners.into_iter().collect())).collect())
        }
        Slots::SymbolsOf => None,
    }
}
