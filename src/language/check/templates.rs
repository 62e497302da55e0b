//! Templates written out in the rule file: their faces, and whether they close.

use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::syntax::{
    self, Item, Name, Number, SignedNumber, Span, TemplateBody, TemplateLine, TemplateLineKind,
};
use crate::language::system::{self, Kind, SharpEdge, SlotName, TemplateFace, TemplateMesh};
use std::collections::{HashMap, HashSet};

impl<'a> Checker<'a> {
    pub(super) fn declare_templates(&mut self) {
        if !matches!(self.kind, Kind::Mesh) {
            return;
        }
        for item in &self.system.items {
            let Item::Template(template) = item else { continue };
            let name = &template.name;
            self.reserved(name);
            if let Some((_, first)) = self.template_ids.get(name.text.as_str()).copied() {
                self.duplicate("templates", &name.text, name.span, first);
                continue;
            }
            if let Some(module) = self.symbol_ids.get(name.text.as_str()) {
                let first = self.symbols[*module].span;
                self.duplicate("things", &name.text, name.span, first);
            }
            let id = self.template(template).map(|lowered| {
                self.templates.push(lowered);
                self.templates.len() - 1
            });
            self.template_ids.insert(&name.text, (id, name.span));
        }
    }

    /// Nothing if it is broken: what is said of it would only repeat that.
    fn template(&mut self, template: &'a syntax::Template) -> Option<system::Template> {
        let mut bases: Vec<&str> = Vec::new();
        for (i, base) in template.base.iter().enumerate() {
            if let Some(first) = template.base[..i].iter().find(|b| b.text == base.text) {
                self.duplicate("bases", &base.text, base.span, first.span);
            }
            bases.push(&base.text);
        }
        let (name, span) = (template.name.text.clone(), template.name.span);
        let lines = match &template.body {
            TemplateBody::Inline(lines) => lines,
            TemplateBody::File(path) => {
                let bases = template.base.iter();
                let bases = bases.map(|b| SlotName { name: b.text.clone(), span: b.span }).collect();
                let body = system::TemplateBody::File { path: path.text.clone(), bases, span: path.span };
                return Some(system::Template { name, body, span });
            }
        };
        let before = self.errors();
        let (mut mesh, spans) = self.template_mesh(lines);
        if bases.is_empty() && mesh.slots.iter().any(|slot| slot == "base") {
            bases.push("base");
        }
        self.bases(template, &bases, &mut mesh);
        if self.errors() > before {
            return None;
        }
        if !bases.is_empty() {
            self.closed(template, &mesh.faces, &spans);
        }
        Some(system::Template { name, body: system::TemplateBody::Inline(mesh), span })
    }

    fn bases(&mut self, template: &'a syntax::Template, bases: &[&str], mesh: &mut TemplateMesh) {
        for base in bases {
            let span = template.base.iter().find(|b| b.text == *base).map_or(template.name.span, |b| b.span);
            let slot = mesh.slots.iter().position(|slot| slot == base);
            let of_slot = |(n, face): (usize, &TemplateFace)| (Some(face.slot) == slot).then_some(n);
            match mesh.faces.iter().enumerate().filter_map(of_slot).collect::<Vec<_>>().as_slice() {
                [face] => mesh.bases.push(*face),
                [] => {
                    let message = format!("template `{}` has no face `{base}`", template.name.text);
                    let hint = self.nearest(base, mesh.slots.iter().map(String::as_str));
                    self.report(Diagnostic::error(code::TEMPLATE_BASE, span, message).hint_if(hint));
                }
                faces => {
                    let message = format!("a base is one face, and there are {} faces `{base}`", faces.len());
                    self.report(Diagnostic::error(code::TEMPLATE_BASE, span, message));
                }
            }
        }
    }

    /// A template written out, without its bases, and where each of its faces is written. Wrong faces are reported and
    /// left out.
    fn template_mesh(&mut self, lines: &'a [TemplateLine]) -> (TemplateMesh, Vec<Span>) {
        let vertices = lines.iter().filter(|l| matches!(l.kind, TemplateLineKind::Vertex(_))).count();
        let mut mesh = TemplateMesh::default();
        let mut spans = Vec::new();
        for line in lines {
            match &line.kind {
                TemplateLineKind::Vertex(coordinates) => {
                    mesh.vertices.extend(self.vertex(coordinates));
                }
                TemplateLineKind::Crease(a, b, sharpness) => {
                    let (a, b) = (self.corner(a, vertices), self.corner(b, vertices));
                    if let (Some(a), Some(b), Some(sharpness)) = (a, b, self.template_number(sharpness)) {
                        mesh.edges.push(SharpEdge { ends: [a, b], sharpness });
                    }
                }
                TemplateLineKind::Face(name, corners) => {
                    // Of several wrong corners the first is reported.
                    let corners: Option<Vec<u32>> =
                        corners.iter().map(|c| self.corner(c, vertices)).collect();
                    if let Some(corners) = corners
                        && self.is_face(name, &corners, line.span)
                    {
                        let slot = slot_named(&mut mesh.slots, &name.text);
                        mesh.faces.push(TemplateFace { slot, corners });
                        spans.push(line.span);
                    }
                }
            }
        }
        (mesh, spans)
    }

    fn vertex(&mut self, [x, y, z]: &'a [SignedNumber; 3]) -> Option<[f32; 3]> {
        let (x, y, z) = (self.template_number(x), self.template_number(y), self.template_number(z));
        Some([x?, y?, z?])
    }

    fn template_number(&mut self, written: &SignedNumber) -> Option<f32> {
        let number = written.number.text.parse::<f32>().ok().filter(|x| x.is_finite());
        if number.is_none() {
            let message = format!("{} is beyond the range of float", written.number.text);
            self.report(Diagnostic::error(code::NUMBER, written.number.span, message));
        }
        // As everywhere in the language `-0` is 0.
        number.map(|x| if written.negative { 0.0 - x } else { x })
    }

    fn corner(&mut self, number: &Number, vertices: usize) -> Option<u32> {
        let corner = number.text.parse::<u32>().ok().filter(|c| (*c as usize) < vertices);
        if corner.is_none() {
            let message = format!("there is no vertex {}", number.text);
            let error = Diagnostic::error(code::TEMPLATE_FACE, number.span, message);
            let hint = format!("the template has {}, counted from 0", suggest::count(vertices, "vertice"));
            self.report(
                error.hint(hint.replace("one vertice", "one vertex").replace("no vertice", "no vertex")),
            );
        }
        corner
    }

    fn is_face(&mut self, name: &Name, corners: &[u32], span: Span) -> bool {
        let distinct: HashSet<_> = corners.iter().collect();
        let message = if corners.len() < 3 {
            format!("the face `{}` has {}", name.text, suggest::count(corners.len(), "corner"))
        } else if distinct.len() < corners.len() {
            format!("the face `{}` has a corner twice", name.text)
        } else {
            return true;
        };
        self.report(Diagnostic::error(code::TEMPLATE_FACE, span, message));
        false
    }

    /// Each edge of a closed mesh is run once in each direction.
    fn closed(&mut self, template: &'a syntax::Template, faces: &[TemplateFace], spans: &[Span]) {
        let mut edges: HashMap<(u32, u32), Span> = HashMap::new();
        for (TemplateFace { corners, .. }, span) in faces.iter().zip(spans) {
            for (i, &from) in corners.iter().enumerate() {
                let to = corners[(i + 1) % corners.len()];
                if let Some(first) = edges.insert((from, to), *span) {
                    let message = format!("two faces run from vertex {from} to vertex {to}");
                    let error = Diagnostic::error(code::TEMPLATE_OPEN, *span, message);
                    let error = error.label(first, "the other is here");
                    self.report(
                        error.hint("turn one of them over: faces run counter-clockwise, seen from outside"),
                    );
                    return;
                }
            }
        }
        let mut open: Vec<_> = edges.iter().filter(|((a, b), _)| !edges.contains_key(&(*b, *a))).collect();
        open.sort_by_key(|(edge, _)| **edge);
        if let Some(((from, to), span)) = open.first() {
            let message = format!("template `{}` has a base and must be closed", template.name.text);
            let error = Diagnostic::error(code::TEMPLATE_OPEN, template.name.span, message);
            self.report(error.label(**span, format!("no other face has the edge between {from} and {to}")));
        }
    }
}

/// The index of the slot of that name, which is new where no face before had it.
fn slot_named(slots: &mut Vec<String>, name: &str) -> usize {
    slots.iter().position(|slot| slot == name).unwrap_or_else(|| {
        slots.push(name.to_string());
        slots.len() - 1
    })
}
