//! What a system declares: its kind, modules, queries, groups and placements.

use super::scope::{Scope, Where};
use super::{Checker, code, suggest};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::Type;
use crate::language::syntax::{self, AttributeKind, Item, Name, Number, Span};
use crate::language::system::{Continuity, Field, Kind, Placement, Query, Symbol, SymbolId, Topology};
use std::collections::HashMap;

/// The turtle's symbols: what their one argument is called and what it is when omitted.
pub(super) const TURTLE: [(&str, &str, Omitted); 10] = [
    ("F", "length", Omitted::One),
    ("f", "length", Omitted::One),
    ("!", "width", Omitted::One),
    ("+", "angle", Omitted::Angle),
    ("-", "angle", Omitted::Angle),
    ("&", "angle", Omitted::Angle),
    ("^", "angle", Omitted::Angle),
    ("/", "angle", Omitted::Angle),
    ("\\", "angle", Omitted::Angle),
    ("|", "angle", Omitted::HalfTurn),
];

/// The most symbols of a system: those that 16 bits name, without the one that ends a word and the one of erased cells.
const MAX_SYMBOLS: usize = 65_534;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Omitted {
    One,
    /// The const or param `angle`, else 90 degrees.
    Angle,
    /// `|` turns around, whatever `angle` is.
    HalfTurn,
}

impl<'a> Checker<'a> {
    /// The kind with its attributes; what is wrong is reported and replaced by something usable.
    pub(super) fn system_kind(&mut self) -> Kind {
        let system = self.system;
        let mut topology: Option<(Topology, Span)> = None;
        let mut degree = None;
        let mut seen: HashMap<&str, Span> = HashMap::new();
        for attribute in &system.attributes {
            let (word, of) = match &attribute.kind {
                AttributeKind::Ring => ("ring", syntax::Kind::Curve),
                AttributeKind::Open => ("open", syntax::Kind::Curve),
                AttributeKind::Tree => ("tree", syntax::Kind::Curve),
                AttributeKind::Bezier(..) => ("bezier", syntax::Kind::Patch),
                AttributeKind::Rational => ("rational", syntax::Kind::Patch),
                AttributeKind::Join { .. } => ("join", syntax::Kind::Patch),
            };
            if of != system.kind {
                let message = format!("`{word}` is an attribute of {} systems", kind_word(of));
                let error = Diagnostic::error(code::SYSTEM_ATTRIBUTE, attribute.span, message);
                self.report(
                    error.label(system.kind_span, format!("this is a {} system", kind_word(system.kind))),
                );
                continue;
            }
            if let Some(first) = seen.insert(word, attribute.span) {
                self.duplicate("attributes", word, attribute.span, first);
            }
            let new = match &attribute.kind {
                AttributeKind::Ring => Topology::Ring,
                AttributeKind::Open => Topology::Open,
                AttributeKind::Tree => Topology::Tree,
                AttributeKind::Bezier(u, v) => {
                    degree = Some(self.degree(u, v.as_ref()));
                    continue;
                }
                AttributeKind::Rational | AttributeKind::Join { .. } => continue,
            };
            if let Some((first, span)) = topology
                && first != new
            {
                let message = "a curve is a ring, open or a tree, only one of them";
                let error = Diagnostic::error(code::SYSTEM_ATTRIBUTE, attribute.span, message);
                self.report(error.label(span, "the first is here"));
            }
            topology = Some((new, attribute.span));
        }
        match system.kind {
            syntax::Kind::Curve => Kind::Curve(topology.map_or(Topology::Open, |(t, _)| t)),
            syntax::Kind::Mesh => Kind::Mesh,
            syntax::Kind::Patch => {
                let degree = degree.unwrap_or_else(|| {
                    let message = "a patch system needs the degree of its nets";
                    let error = Diagnostic::error(code::DEGREE, system.kind_span, message);
                    self.report(error.hint("write `patch bezier 3`, or `patch bezier 3 2` for u and v"));
                    [3, 3]
                });
                let join = system.attributes.iter().find_map(|attribute| match attribute.kind {
                    AttributeKind::Join { c1: true } => Some(Continuity::C1),
                    AttributeKind::Join { c1: false } => Some(Continuity::C0),
                    _ => None,
                });
                Kind::Patch { degree, rational: seen.contains_key("rational"), join }
            }
        }
    }

    fn degree(&mut self, u: &Number, v: Option<&Number>) -> [u8; 2] {
        let mut one = |number: &Number| match number.text.parse::<u8>() {
            Ok(degree @ 1..=8) => degree,
            _ => {
                let message = format!("the degree of a net is 1 to 8, not {}", number.text);
                self.report(Diagnostic::error(code::DEGREE, number.span, message));
                3
            }
        };
        let first = one(u);
        [first, v.map_or(first, one)]
    }

    /// Items that systems of this kind have not, and those of which there may be only one.
    pub(super) fn items(&mut self) {
        let (mut axiom, mut run): (Option<Span>, Option<Span>) = (None, None);
        for item in &self.system.items {
            let (what, span, kinds): (_, _, &[syntax::Kind]) = match item {
                Item::Template(t) => ("`template`", t.name.span, &[syntax::Kind::Mesh]),
                Item::Ignore(names) => {
                    ("`ignore`", names.first().map_or(Span::default(), |n| n.span), &[syntax::Kind::Curve])
                }
                Item::Place(p) => ("`place`", p.name.span, &[syntax::Kind::Mesh, syntax::Kind::Patch]),
                _ => ("", Span::default(), &[]),
            };
            if !kinds.is_empty() && !kinds.contains(&self.system.kind) {
                self.wrong_kind(what, span, kinds);
            }
            if let Some(run) = run {
                let message = "`run:` must stand last";
                self.report(Diagnostic::error(code::RUN_ORDER, run, message));
            }
            match item {
                Item::Axiom(a) => match axiom {
                    Some(first) => self.duplicate("axioms", "", a.span, first),
                    None => axiom = Some(a.span),
                },
                Item::Run(r) => run = Some(r.span),
                _ => {}
            }
        }
    }

    pub(super) fn wrong_kind(&mut self, what: &str, span: Span, kinds: &[syntax::Kind]) {
        let kinds: Vec<&str> = kinds.iter().map(|k| kind_word(*k)).collect();
        let message = format!("{what} belongs to {} systems", kinds.join(" and "));
        let error = Diagnostic::error(code::WRONG_KIND, span, message);
        let label = format!("this is a {} system", kind_word(self.system.kind));
        self.report(error.label(self.system.kind_span, label));
    }

    pub(super) fn modules(&mut self) {
        for item in &self.system.items {
            let Item::Modules(declarations) = item else { continue };
            for declaration in declarations {
                self.module(declaration);
            }
        }
    }

    fn module(&mut self, declaration: &'a syntax::ModuleDecl) {
        let name = &declaration.symbol;
        self.reserved(name);
        let turtle = is_turtle(&name.text);
        if turtle && matches!(self.kind, Kind::Curve(_)) {
            let message = format!("`{}` is a symbol of the turtle and declared already", name.text);
            let error = Diagnostic::error(code::DUPLICATE, name.span, message);
            self.report(error.hint("it has one float; choose another name for a module of your own"));
            return;
        }
        if let Some(first) = self.symbol_ids.get(name.text.as_str()) {
            let first = self.symbols[*first].span;
            self.duplicate("modules", &name.text, name.span, first);
            return;
        }
        let mut fields: Vec<Field> = Vec::with_capacity(declaration.fields.len());
        let mut broken = false;
        for field in &declaration.fields {
            self.reserved(&field.name);
            if let Some(first) =
                declaration.fields[..fields.len()].iter().find(|f| f.name.text == field.name.text)
            {
                self.duplicate("fields", &field.name.text, field.name.span, first.name.span);
            }
            let ty = self.type_named(&field.ty);
            broken |= ty.is_none();
            fields.push(Field { name: field.name.text.clone(), ty: ty.unwrap_or(Type::Float) });
        }
        let id = self.symbols.len();
        if broken {
            self.broken_symbols.insert(id);
        }
        self.symbols.push(Symbol { name: name.text.clone(), fields, span: name.span });
        self.symbol_ids.insert(&name.text, id);
    }

    /// Whether records can name all symbols, those of the turtle that occur among them.
    pub(super) fn count_symbols(&mut self) {
        if let Some(first) = self.symbols.get(MAX_SYMBOLS) {
            let message =
                format!("more than {MAX_SYMBOLS} symbols in one system: `{}` is one too many", first.name);
            let error = Diagnostic::error(code::TOO_MANY_SYMBOLS, first.span, message);
            self.report(error.hint("make one symbol of several, with a parameter that tells them apart"));
        }
    }

    /// A module's symbol; a turtle symbol is entered where it first occurs.
    pub(super) fn symbol(&mut self, name: &'a Name) -> Option<SymbolId> {
        if let Some(id) = self.symbol_ids.get(name.text.as_str()) {
            return Some(*id);
        }
        let turtle = match self.kind {
            Kind::Mesh => None,
            _ => TURTLE.iter().find(|(symbol, ..)| *symbol == name.text),
        };
        if let Some((symbol, field, _)) = turtle {
            let id = self.symbols.len();
            let fields = vec![Field { name: (*field).into(), ty: Type::Float }];
            self.symbols.push(Symbol { name: (*symbol).into(), fields, span: name.span });
            self.symbol_ids.insert(symbol, id);
            return Some(id);
        }
        let is_symbol =
            |s: &str| self.symbol_ids.contains_key(s) || !matches!(self.kind, Kind::Mesh) && is_turtle(s);
        let hint = suggest::spaced(&name.text, is_symbol)
            .or_else(|| self.nearest(&name.text, self.symbol_ids.keys().copied()))
            .unwrap_or_else(|| format!("declare it: `module {}`", name.text));
        let message = format!("no module `{}` is declared", name.text);
        self.report(Diagnostic::error(code::UNKNOWN_MODULE, name.span, message).hint(hint));
        None
    }

    pub(super) fn declare_queries(&mut self) {
        for item in &self.system.items {
            match item {
                Item::Query(query) => self.declare_query(query),
                Item::Volume(volume) => self.volume(volume),
                _ => {}
            }
        }
    }

    fn declare_query(&mut self, query: &'a syntax::Query) {
        let name = &query.name;
        self.reserved(name);
        if let Some(first) = self.query_ids.get(name.text.as_str()) {
            let first = first.map_or(name.span, |i| self.queries[i].span);
            self.duplicate("queries", &name.text, name.span, first);
            return;
        }
        let id = self.type_named(&query.field.ty).map(|ty| {
            self.queries.push(Query { name: name.text.clone(), ty, value: None, span: query.span });
            self.queries.len() - 1
        });
        self.query_ids.insert(&name.text, id);
    }

    pub(super) fn query_values(&mut self) {
        for item in &self.system.items {
            let Item::Query(query) = item else { continue };
            let Some(value) = &query.value else { continue };
            let Some(Some(id)) = self.query_ids.get(query.name.text.as_str()).copied() else { continue };
            let ty = self.queries[id].ty.clone();
            let mut scope = Scope::new(Where::Query);
            let why = || format!("`{}` is declared {ty}", query.name.text);
            self.queries[id].value = self.expr(&mut scope, value, &ty, why);
        }
    }

    /// Whether the host binds the query; those with a value of their own are computed.
    pub(super) fn host_bound(&self, query: usize) -> bool {
        let name = &self.queries[query].name;
        let declared = self.system.items.iter().find_map(|item| match item {
            Item::Query(q) if q.name.text == *name => Some(q),
            _ => None,
        });
        declared.is_some_and(|q| q.value.is_none())
    }

    fn volume(&mut self, volume: &'a syntax::Volume) {
        self.reserved(&volume.name);
        if let Some(first) = self.volumes.insert(&volume.name.text, volume.name.span) {
            self.duplicate("volumes", &volume.name.text, volume.name.span, first);
        }
        if let Some(ty) = self.type_named(&volume.ty)
            && !matches!(ty, Type::Int | Type::Float)
        {
            let message = format!("a volume holds ints or floats, not {ty}");
            self.report(Diagnostic::error(code::TYPE, volume.ty.span, message));
        }
        for corner in [&volume.from, &volume.to] {
            let mut scope = Scope::new(Where::Run);
            self.expr(&mut scope, corner, &Type::Vec3, || "the corners of a volume are vec3".into());
        }
    }

    pub(super) fn ignored(&mut self) {
        let symbols = self.symbols.len();
        for item in &self.system.items {
            let Item::Ignore(names) = item else { continue };
            for name in names {
                self.symbol(name);
            }
        }
        // A turtle symbol that is only ignored does not occur.
        for symbol in self.symbols.drain(symbols..) {
            self.symbol_ids.remove(symbol.name.as_str());
        }
    }

    pub(super) fn declare_places(&mut self) {
        for item in &self.system.items {
            let Item::Place(place) = item else { continue };
            self.reserved(&place.name);
            let index = self.places.len();
            match self.places.get(place.name.text.as_str()) {
                Some(&(_, first)) => {
                    self.duplicate("placements", &place.name.text, place.name.span, first);
                }
                None => _ = self.places.insert(&place.name.text, (index, place.name.span)),
            }
        }
    }

    /// The placements in order of declaration; not all of them where one is at fault.
    pub(super) fn place_values(&mut self) -> Vec<Placement> {
        let mut placements = Vec::new();
        if matches!(self.kind, Kind::Curve(_)) {
            return placements;
        }
        for item in &self.system.items {
            let Item::Place(place) = item else { continue };
            let on = place.on.iter().filter_map(|symbol| self.symbol(symbol)).collect();
            let mut scope = Scope::new(Where::Place);
            let value = self
                .expr(&mut scope, &place.value, &Type::Vec3, || "`place` gives a position, a vec3".into());
            let (name, span) = (place.name.text.clone(), place.name.span);
            placements.extend(value.map(|value| Placement { name, on, value, span }));
        }
        placements
    }

    pub(super) fn declare_groups(&mut self) {
        let mut count = 0;
        for item in &self.system.items {
            let Item::Rules(rules) = item else { continue };
            let name = rules.group.as_ref().map_or("", |n| n.text.as_str());
            let span = rules.group.as_ref().map_or(rules.span, |n| n.span);
            if let Some(name) = &rules.group {
                self.reserved(name);
            }
            match self.group_ids.get(name) {
                Some((_, first)) => {
                    let what = if name.is_empty() { "rule groups without a name" } else { "rule groups" };
                    let first = *first;
                    self.duplicate(what, name, span, first);
                }
                None => _ = self.group_ids.insert(name, (count, span)),
            }
            count += 1;
        }
    }
}

/// Whether the turtle has a symbol of that name; those have no declaration to point at.
pub(super) fn is_turtle(name: &str) -> bool {
    TURTLE.iter().any(|(symbol, ..)| *symbol == name)
}

pub(super) fn kind_word(kind: syntax::Kind) -> &'static str {
    match kind {
        syntax::Kind::Curve => "curve",
        syntax::Kind::Patch => "patch",
        syntax::Kind::Mesh => "mesh",
    }
}
