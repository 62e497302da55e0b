//! Templates written out in the rule file: their faces, and whether they close.

use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::syntax::{self, Item, Name, Number, Span, TemplateBody, TemplateLine, TemplateLineKind};
use crate::language::system::Kind;
use std::collections::{HashMap, HashSet};

/// What is known of a template before its file is read.
#[derive(Clone, Debug)]
pub(super) struct Template<'a> {
    pub span: Span,
    /// The groups of faces with the numbers of corners of each; absent for a file.
    pub groups: Option<Vec<(&'a str, Vec<usize>)>>,
    /// The names behind `base`; `base` itself where none was written and there is such a group.
    pub bases: Vec<&'a str>,
}

impl Template<'_> {
    /// How many corners each base has, where that is known.
    pub fn base_corners(&self) -> Vec<usize> {
        let groups = self.groups.as_deref().unwrap_or_default();
        let of = |base: &&str| groups.iter().find(|(name, _)| name == base).map(|(_, corners)| corners);
        self.bases.iter().filter_map(of).filter_map(|corners| corners.first().copied()).collect()
    }
}

impl<'a> Checker<'a> {
    pub(super) fn declare_templates(&mut self) {
        if !matches!(self.kind, Kind::Mesh) {
            return;
        }
        for item in &self.system.items {
            let Item::Template(template) = item else { continue };
            let name = &template.name;
            self.reserved(name);
            if let Some(first) = self.templates.get(name.text.as_str()) {
                let first = first.span;
                self.duplicate("templates", &name.text, name.span, first);
                continue;
            }
            if let Some(module) = self.symbol_ids.get(name.text.as_str()) {
                let first = self.symbols[*module].span;
                self.duplicate("things", &name.text, name.span, first);
            }
            let lowered = self.template(template);
            self.templates.insert(&name.text, lowered);
        }
    }

    fn template(&mut self, template: &'a syntax::Template) -> Template<'a> {
        let mut bases: Vec<&str> = Vec::new();
        for (i, base) in template.base.iter().enumerate() {
            if let Some(first) = template.base[..i].iter().find(|b| b.text == base.text) {
                self.duplicate("bases", &base.text, base.span, first.span);
            }
            bases.push(&base.text);
        }
        let TemplateBody::Inline(lines) = &template.body else {
            return Template { span: template.name.span, groups: None, bases };
        };
        let before = self.errors();
        let faces = self.faces(lines);
        let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
        for (name, corners, _) in &faces {
            match groups.iter_mut().find(|(group, _)| *group == name.text) {
                Some((_, sizes)) => sizes.push(corners.len()),
                None => groups.push((&name.text, vec![corners.len()])),
            }
        }
        if bases.is_empty() && groups.iter().any(|(name, _)| *name == "base") {
            bases.push("base");
        }
        self.bases(template, &bases, &groups);
        if self.errors() > before {
            // What is said of a broken template would only repeat it.
            return Template { span: template.name.span, groups: None, bases: Vec::new() };
        }
        if !bases.is_empty() {
            self.closed(template, &faces);
        }
        Template { span: template.name.span, groups: Some(groups), bases }
    }

    fn bases(&mut self, template: &'a syntax::Template, bases: &[&str], groups: &[(&str, Vec<usize>)]) {
        for base in bases {
            let span = template.base.iter().find(|b| b.text == *base).map_or(template.name.span, |b| b.span);
            match groups.iter().find(|(name, _)| name == base) {
                None => {
                    let message = format!("template `{}` has no face `{base}`", template.name.text);
                    let hint = self.nearest(base, groups.iter().map(|(name, _)| *name));
                    self.report(Diagnostic::error(code::TEMPLATE_BASE, span, message).hint_if(hint));
                }
                Some((_, sizes)) if sizes.len() > 1 => {
                    let message = format!("a base is one face, and there are {} faces `{base}`", sizes.len());
                    self.report(Diagnostic::error(code::TEMPLATE_BASE, span, message));
                }
                Some(_) => {}
            }
        }
    }

    /// The faces with their corners; wrong ones are reported and left out.
    fn faces(&mut self, lines: &'a [TemplateLine]) -> Vec<(&'a Name, Vec<usize>, Span)> {
        let vertices = lines.iter().filter(|l| matches!(l.kind, TemplateLineKind::Vertex(_))).count();
        let mut faces = Vec::new();
        for line in lines {
            match &line.kind {
                TemplateLineKind::Vertex(_) => {}
                TemplateLineKind::Crease(a, b, _) => {
                    self.corner(a, vertices);
                    self.corner(b, vertices);
                }
                TemplateLineKind::Face(name, corners) => {
                    let corners: Option<Vec<usize>> =
                        corners.iter().map(|c| self.corner(c, vertices)).collect();
                    if let Some(corners) = corners
                        && self.is_face(name, &corners, line.span)
                    {
                        faces.push((name, corners, line.span));
                    }
                }
            }
        }
        faces
    }

    fn corner(&mut self, number: &Number, vertices: usize) -> Option<usize> {
        let corner = number.text.parse::<usize>().ok().filter(|c| *c < vertices);
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

    fn is_face(&mut self, name: &Name, corners: &[usize], span: Span) -> bool {
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
    fn closed(&mut self, template: &'a syntax::Template, faces: &[(&'a Name, Vec<usize>, Span)]) {
        let mut edges: HashMap<(usize, usize), Span> = HashMap::new();
        for (_, corners, span) in faces {
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
