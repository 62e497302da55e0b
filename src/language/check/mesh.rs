//! Successors of mesh systems: templates, their places and their slots.

use super::scope::Scope;
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::syntax::{self, Element, Name, Slot, SlotFill, Span};
use crate::language::system::{
    Attachment, FaceSuccessor, FaceTemplate, Fill, Filling, Pairing, SlotName, SymbolId, Template,
    TemplateBody, TemplateId, TemplateUse,
};
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
    ) -> Option<FaceSuccessor> {
        let used = match word {
            [Element::Eps(_)] => return Some(FaceSuccessor::Erase),
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
            self.template_ids.contains_key(name) || self.vocabulary.shapes.iter().any(|s| s.name == name);
        if is_template && !self.symbol_ids.contains_key(name) {
            let (args, span) = (used.args.as_deref(), used.span);
            let used = Use { name: &used.symbol, args, place: None, slots: None, span };
            return self.template_used(scope, predecessor, used);
        }
        if predecessor.joined {
            let message = "joined faces are replaced by a template";
            self.report(Diagnostic::error(code::SUCCESSOR, used.span, message));
        }
        let face = self.face_module(scope, used)?;
        if let Some(from) = predecessor.strict.first().and_then(|p| self.known_symbol(&p.symbol)) {
            self.corners.relabelled.push((from, face.module.symbol));
        }
        Some(FaceSuccessor::Relabel(face))
    }

    fn known_symbol(&self, name: &Name) -> Option<SymbolId> {
        self.symbol_ids.get(name.text.as_str()).copied()
    }

    pub(super) fn template_use(
        &mut self,
        scope: &mut Scope<'a>,
        predecessor: &'a syntax::Predecessor,
        used: &'a syntax::TemplateUse,
    ) -> Option<FaceSuccessor> {
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
    ) -> Option<FaceSuccessor> {
        let (template, known) = self.face_template(scope, predecessor, used);
        let words = used.place.map_or(&[][..], |place| &place.transforms);
        let placing = self.placing(scope, words);
        let fillings = match used.slots {
            Some(slots) => self.fillings(scope, slots, &known, &used.name.text),
            None => Some(Vec::new()),
        };
        let placing = placing?;
        let pairing = if placing.corner { Pairing::FirstCorners } else { Pairing::Fitted };
        let attachment = Attachment { pairing, transforms: placing.transforms, uv: placing.uv };
        let (template, fillings) = (template?, fillings?);
        let template = Box::new(TemplateUse { template, attachment, fillings, span: used.span });
        Some(match used.place {
            Some(place) if place.on => FaceSuccessor::Attach(template),
            _ if predecessor.joined => FaceSuccessor::Join(template),
            _ => FaceSuccessor::Replace(template),
        })
    }

    /// What the name stands for, and its slots.
    fn face_template(
        &mut self,
        scope: &mut Scope<'a>,
        predecessor: &'a syntax::Predecessor,
        used: Use<'a>,
    ) -> (Option<FaceTemplate>, KnownSlots) {
        let name = used.name.text.as_str();
        if let Some((id, _)) = self.template_ids.get(name).copied() {
            self.no_template_arguments(used.name, used.args, used.span);
            let Some(id) = id else { return (None, None) };
            self.base_fits(predecessor, id, used);
            return (Some(FaceTemplate::Template(id)), known_slots(&self.templates[id]));
        }
        if let Some(shape) = self.shape(name, Role::Template) {
            let made = self.shape_use(scope, &shape, used.args.unwrap_or_default(), used.span);
            return (made.map(FaceTemplate::Shape), shape_slots(&shape));
        }
        self.unknown_template(used);
        (None, None)
    }

    pub(super) fn no_template_arguments(&mut self, name: &Name, args: Option<&[syntax::Expr]>, span: Span) {
        if args.is_some_and(|args| !args.is_empty()) {
            let message = format!("the template `{}` takes no arguments", name.text);
            self.report(Diagnostic::error(code::FUNCTION_ARITY, span, message));
        }
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
            let hint = self.nearest(name, self.template_ids.keys().copied().chain(shapes));
            (format!("there is no template `{name}`"), hint)
        };
        self.report(Diagnostic::error(code::UNKNOWN_TEMPLATE, used.name.span, message).hint_if(hint));
    }

    fn base_fits(&mut self, predecessor: &'a syntax::Predecessor, template: TemplateId, used: Use<'a>) {
        if used.place.is_some_and(|p| p.on) {
            return;
        }
        let replaced = predecessor.strict.len();
        let template = &self.templates[template];
        let (declared, corners) = (template.span, base_corners(template));
        let (bases, read) = match &template.body {
            TemplateBody::File { bases, .. } => (bases.len(), false),
            TemplateBody::Inline(mesh) => (mesh.bases.len(), true),
        };
        let name = &used.name.text;
        if bases == 0 && read {
            let message = format!("the template `{name}` has no base to stand on");
            let error = Diagnostic::error(code::TEMPLATE_BASE, used.name.span, message);
            let error = error.label(declared, "it is declared here");
            self.report(error.hint("name a face `base`, or write `base NAME` behind the template"));
        } else if bases > 0 && bases != replaced {
            let message = format!(
                "the template `{name}` has {}, and the rule replaces {}",
                suggest::count(bases, "base"),
                suggest::count(replaced, "face")
            );
            let error = Diagnostic::error(code::TEMPLATE_BASE, used.name.span, message);
            self.report(error.label(declared, "it is declared here"));
        }
        for (pattern, corners) in predecessor.strict.iter().zip(corners) {
            if let Some(symbol) = self.known_symbol(&pattern.symbol) {
                self.corners.needed.push((symbol, corners, used.span));
            }
        }
    }

    /// What fills slots, in the order written.
    pub(super) fn fillings(
        &mut self,
        scope: &mut Scope<'a>,
        slots: &'a [Slot],
        known: &KnownSlots,
        template: &str,
    ) -> Option<Vec<Filling>> {
        let mut seen: HashMap<&str, Span> = HashMap::new();
        let mut fillings = Vec::with_capacity(slots.len());
        let mut whole = true;
        for slot in slots {
            let fill = match &slot.fill {
                SlotFill::Eps(_) => Some(Fill::Erase),
                SlotFill::Module(used) => {
                    scope.in_slot = true;
                    let face = self.face_module(scope, used);
                    scope.in_slot = false;
                    face.map(Fill::Module)
                }
            };
            let filled = self.slot_names(slot, known, template);
            for name in &slot.names {
                if let Some(first) = seen.insert(&name.text, name.span) {
                    self.duplicate("fillings of the slot", &name.text, name.span, first);
                }
                if let Some(Fill::Module(face)) = &fill {
                    self.slot_corners(face.module.symbol, known, &name.text);
                }
            }
            match fill {
                Some(fill) => fillings.push(Filling { slots: filled, fill }),
                None => whole = false,
            }
        }
        whole.then_some(fillings)
    }

    fn slot_corners(&mut self, symbol: SymbolId, known: &KnownSlots, name: &str) {
        let sizes = known.as_ref().and_then(|k| k.iter().find(|(slot, _)| slot == name));
        match sizes.map(|(_, sizes)| sizes.as_slice()) {
            None | Some([]) => self.corners.given.push((symbol, None)),
            Some(sizes) => self.corners.given.extend(sizes.iter().map(|n| (symbol, Some(*n)))),
        }
    }

    /// The slots that exist, as far as it is known. One that does not is an error; in a list that names another one,
    /// a warning.
    fn slot_names(&mut self, slot: &'a Slot, known: &KnownSlots, template: &str) -> Vec<SlotName> {
        let lowered = |name: &Name| SlotName { name: name.text.clone(), span: name.span };
        let Some(known) = known else { return slot.names.iter().map(lowered).collect() };
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
        slot.names.iter().filter(|name| exists(name)).map(lowered).collect()
    }
}

/// All slots of a template, its bases among them: an axiom has no face for them to land on.
pub(super) fn axiom_slots(template: &Template) -> KnownSlots {
    let TemplateBody::Inline(mesh) = &template.body else { return None };
    let corners = |slot: usize| {
        mesh.faces.iter().filter(|face| face.slot == slot).map(|face| face.corners.len()).collect()
    };
    Some(mesh.slots.iter().enumerate().map(|(slot, name)| (name.clone(), corners(slot))).collect())
}

/// The slots of a template but its bases, which vanish.
fn known_slots(template: &Template) -> KnownSlots {
    let TemplateBody::Inline(mesh) = &template.body else { return None };
    let mut slots = axiom_slots(template)?;
    let is_base = |name: &str| mesh.bases.iter().any(|base| mesh.slots[mesh.faces[*base].slot] == name);
    slots.retain(|(name, _)| !is_base(name));
    Some(slots)
}

/// How many corners each base has, where that is known.
fn base_corners(template: &Template) -> Vec<usize> {
    match &template.body {
        TemplateBody::File { .. } => Vec::new(),
        TemplateBody::Inline(mesh) => mesh.bases.iter().map(|base| mesh.faces[*base].corners.len()).collect(),
    }
}

pub(super) fn shape_slots(shape: &Shape) -> KnownSlots {
    match &shape.slots {
        Slots::Named(slots) => {
            Some(slots.iter().map(|s| (s.name.to_string(), s.corners.into_iter().collect())).collect())
        }
        Slots::SymbolsOf => None,
    }
}
