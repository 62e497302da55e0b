//! A walk through all that a lowered system says: every index in range, every expression of the type that is asked
//! of it, every name known, and as much of everything as was written.

use super::checked;
use crate::check::{files, shown};
use burgeon::language::expr::{Expr, ExprKind};
use burgeon::language::syntax::{self, AxiomKind, Item};
use burgeon::language::system::{
    Axiom, Binder, BinderPlace, Block, Cell, FaceModule, FaceSuccessor, FaceTemplate, Fill, Filling, Let,
    MeshSource, MeshStart, Module, Rule, ShapeArg, ShapeUse, Step, StepKind, Successor, System, TemplateBody,
    TemplateId, TemplateMesh, TemplateUse, Transform, UvRange, surface_modules,
};
use burgeon::language::vocabulary::{Attribute, ParameterKind, Role, Slots};
use burgeon::language::{Type, Vocabulary};
use std::collections::HashMap;

/// The names that an expression may use where it stands.
#[derive(Clone, Copy, Default)]
struct Names<'a> {
    binders: &'a [Binder],
    lets: &'a [Let],
    /// Of the points of a curve, in place of binders.
    fields: Option<&'a [Type]>,
}

struct Walk<'a> {
    system: &'a System,
    /// Those of the file.
    systems: &'a [System],
    vocabulary: Vocabulary,
    /// How many ints the tags of a symbol have.
    tags: HashMap<usize, usize>,
    expressions: usize,
}

impl<'a> Walk<'a> {
    fn expr(&mut self, names: Names, expr: &Expr, ty: Type) {
        assert_eq!(expr.ty, ty, "{expr:?}");
        let system = self.system;
        self.expressions += 1;
        expr.walk(&mut |e| match &e.kind {
            ExprKind::Literal(value) => assert_eq!(value.ty(), e.ty),
            ExprKind::Binder(i) => match names.fields {
                Some(fields) => assert_eq!(fields[*i], e.ty),
                None => assert_eq!(names.binders[*i].ty, e.ty),
            },
            ExprKind::Let(i) => assert_eq!(names.lets[*i].value.ty, e.ty),
            ExprKind::Uniform(i) => assert_eq!(system.uniforms[*i].ty, e.ty),
            ExprKind::Attribute(name) => {
                let is = |a: &&Attribute| a.name == *name && a.ty == e.ty;
                assert!(self.vocabulary.attributes.iter().find(is).is_some(), "{name}");
            }
            ExprKind::Call(op, args) => {
                assert_eq!(op.row().result, e.ty);
                assert!(op.row().args.iter().eq(args.iter().map(|a| &a.ty)), "{e:?}");
            }
            ExprKind::Component(base, i) => assert!(*i < base.ty.words()),
            ExprKind::Vector(parts) => assert_eq!(parts.len(), e.ty.words()),
            ExprKind::Element(values, index) => {
                assert_eq!(index.ty, Type::Int);
                assert!(!values.is_empty() && values.iter().all(|v| v.ty() == e.ty), "{e:?}");
            }
            ExprKind::Random { args, .. } => assert!(args.iter().all(|a| a.ty == Type::Float)),
            ExprKind::Sample(query, _) | ExprKind::OfRoot(query) => {
                assert_eq!(system.queries[*query].ty, e.ty);
            }
        });
    }

    fn module(&mut self, names: Names, module: &Module) {
        let fields = &self.system.symbols[module.symbol].fields;
        assert_eq!(fields.len(), module.args.len());
        for (arg, field) in module.args.iter().zip(fields) {
            self.expr(names, arg, field.ty.clone());
        }
    }

    fn face(&mut self, names: Names, face: &FaceModule) {
        self.module(names, &face.module);
        for part in &face.tag {
            self.expr(names, part, Type::Int);
        }
        if !face.tag.is_empty() {
            let known = *self.tags.entry(face.module.symbol).or_insert(face.tag.len());
            assert_eq!(known, face.tag.len());
        }
    }

    fn template(&self, mesh: &TemplateMesh) {
        let corners =
            || mesh.faces.iter().flat_map(|f| &f.corners).chain(mesh.edges.iter().flat_map(|e| &e.ends));
        assert!(corners().all(|c| (*c as usize) < mesh.vertices.len()));
        assert!(mesh.vertices.iter().flatten().all(|x| x.is_finite()));
        assert!(mesh.faces.iter().all(|f| f.slot < mesh.slots.len() && f.corners.len() >= 3));
        assert!((0..mesh.slots.len()).all(|slot| mesh.faces.iter().any(|f| f.slot == slot)));
        assert!(mesh.bases.iter().all(|base| *base < mesh.faces.len()));
    }

    /// The slots of a template that may be filled; none if its file must be read first.
    fn slots_of(&self, template: TemplateId, with_bases: bool) -> Option<Vec<String>> {
        match &self.system.templates[template].body {
            TemplateBody::File { .. } => None,
            TemplateBody::Inline(mesh) => {
                let is_base = |slot: usize| mesh.bases.iter().any(|base| mesh.faces[*base].slot == slot);
                let slots = mesh.slots.iter().enumerate();
                Some(
                    slots.filter(|(s, _)| with_bases || !is_base(*s)).map(|(_, name)| name.clone()).collect(),
                )
            }
        }
    }

    /// A shape; its slots.
    fn shape(&mut self, names: Names, used: &ShapeUse, role: Role) -> Vec<String> {
        let shapes = self.vocabulary.shapes.clone();
        let shape = shapes.iter().find(|s| s.name == used.shape).expect("a shape of the vocabulary");
        assert_eq!((shape.role, shape.parameters.len()), (role, used.args.len()));
        let mut symbols = Vec::new();
        for (parameter, arg) in shape.parameters.iter().zip(&used.args) {
            match (&parameter.kind, arg) {
                (ParameterKind::Value(ty), ShapeArg::Value(value)) => self.expr(names, value, ty.clone()),
                (ParameterKind::PerPoint, ShapeArg::PerPoint { fields, value }) => {
                    let [ShapeArg::Curve { name, .. }, ..] = used.args.as_slice() else { panic!() };
                    let curve = self.earlier(name);
                    for (field, (symbol, index)) in
                        fields.iter().flat_map(|f| f.places.iter().map(move |p| (f, *p)))
                    {
                        let of = &curve.symbols[symbol].fields[index];
                        assert_eq!((&of.name, &of.ty), (&field.name, &field.ty));
                    }
                    let types: Vec<Type> = fields.iter().map(|f| f.ty.clone()).collect();
                    self.expr(Names { fields: Some(&types), ..Names::default() }, value, Type::Float);
                }
                (ParameterKind::Curve, ShapeArg::Curve { name, .. })
                | (ParameterKind::Patch, ShapeArg::Patch { name, .. }) => {
                    symbols = self.earlier(name).symbols.iter().map(|s| s.name.clone()).collect();
                }
                (kind, arg) => panic!("{kind:?}: {arg:?}"),
            }
        }
        match &shape.slots {
            Slots::Named(slots) => slots.iter().map(|s| s.name.to_string()).collect(),
            Slots::SymbolsOf => symbols,
        }
    }

    fn earlier(&self, name: &str) -> &'a System {
        let found = self.systems.iter().find(|s| s.name == name).expect("an earlier system");
        assert_ne!(found.name, self.system.name);
        found
    }

    fn transforms(&mut self, names: Names, transforms: &[Transform], uv: &Option<UvRange>) {
        for transform in transforms {
            match transform {
                Transform::Scale(factor) => self.expr(names, factor, Type::Float),
                Transform::Stretch(factors) => factors.iter().for_each(|f| self.expr(names, f, Type::Float)),
                Transform::Rotate { axis, angle } => {
                    self.expr(names, axis, Type::Vec3);
                    self.expr(names, angle, Type::Float);
                }
            }
        }
        for bound in uv.iter().flat_map(|uv| uv.u.iter().chain(uv.v.iter().flatten())) {
            self.expr(names, bound, Type::Float);
        }
    }

    fn fillings(&mut self, names: Names, fillings: &[Filling], slots: Option<&[String]>) {
        let mut seen = Vec::new();
        for filling in fillings {
            assert!(!filling.slots.is_empty());
            for slot in &filling.slots {
                let slot = &slot.name;
                assert!(slots.is_none_or(|slots| slots.contains(slot)), "{slot} is none of {slots:?}");
                assert!(!seen.contains(&slot), "{slot} is filled twice");
                seen.push(slot);
            }
            if let Fill::Module(face) = &filling.fill {
                self.face(names, face);
            }
        }
    }

    /// A template on as many faces.
    fn used(&mut self, names: Names, used: &TemplateUse, replaced: Option<usize>) {
        let slots = match &used.template {
            FaceTemplate::Shape(shape) => Some(self.shape(names, shape, Role::Template)),
            FaceTemplate::Template(id) => {
                if let (TemplateBody::Inline(mesh), Some(replaced)) =
                    (&self.system.templates[*id].body, replaced)
                {
                    assert_eq!(mesh.bases.len(), replaced);
                }
                self.slots_of(*id, false)
            }
        };
        self.transforms(names, &used.attachment.transforms, &used.attachment.uv);
        self.fillings(names, &used.fillings, slots.as_deref());
    }

    fn cells(&mut self, names: Names, block: &Block) {
        for cell in &block.cells {
            match cell {
                Cell::Eps => {}
                Cell::Module(module) => self.module(names, module),
                Cell::Block(inner) => self.cells(names, inner),
            }
        }
    }

    fn successor(&mut self, names: Names, successor: &Successor, rule: &Rule) {
        match successor {
            Successor::Erase | Successor::Face(FaceSuccessor::Erase) => {}
            Successor::Relabel(module) => self.module(names, module),
            Successor::Split(block) => self.cells(names, block),
            Successor::Word(word) => word.modules.iter().for_each(|m| self.module(names, m)),
            Successor::Surface(word) => surface_modules(word, &mut |m| self.module(names, m)),
            Successor::Face(FaceSuccessor::Relabel(face)) => self.face(names, face),
            Successor::Face(FaceSuccessor::Attach(used)) => self.used(names, used, None),
            Successor::Face(FaceSuccessor::Replace(used)) => {
                assert_eq!(rule.strict.len(), 1);
                self.used(names, used, Some(1));
            }
            Successor::Face(FaceSuccessor::Join(used)) => {
                assert!(rule.strict.len() > 1);
                self.used(names, used, Some(rule.strict.len()));
            }
        }
    }

    fn rule(&mut self, rule: &Rule) {
        let system = self.system;
        let fields = |symbol: usize| &system.symbols[symbol].fields;
        for binder in &rule.binders {
            let ty = match binder.place {
                BinderPlace::Strict { module, field } => &fields(rule.strict[module])[field].ty,
                BinderPlace::Left { module, field } => {
                    &fields(rule.left.as_ref().expect("a context").symbols[module])[field].ty
                }
                BinderPlace::Right { module, field } => {
                    &fields(rule.right.as_ref().expect("a context").symbols[module])[field].ty
                }
                BinderPlace::Query(n) => &system.queries[rule.queries[n].query].ty,
                BinderPlace::Tag { module } => {
                    assert!(module < rule.strict.len());
                    &Type::Int
                }
            };
            assert_eq!(*ty, binder.ty);
        }
        for (n, l) in rule.lets.iter().enumerate() {
            let names = Names { binders: &rule.binders, lets: &rule.lets[..n], fields: None };
            self.expr(names, &l.value, l.value.ty.clone());
        }
        let names = Names { binders: &rule.binders, lets: &rule.lets, fields: None };
        for test in rule.tests.iter().chain(&rule.condition) {
            self.expr(names, test, Type::Bool);
        }
        for alternative in &rule.alternatives {
            if let Some(weight) = &alternative.weight {
                self.expr(names, weight, Type::Float);
            }
            self.successor(names, &alternative.successor, rule);
        }
        let mut sites = Vec::new();
        rule_expressions(rule, &mut |e| {
            if let ExprKind::Random { site, .. } = e.kind {
                sites.push(site);
            }
        });
        sites.sort_unstable();
        assert!(sites.is_sorted_by(|a, b| a < b), "{sites:?}");
    }

    fn start(&mut self, start: &MeshStart) {
        let names = Names::default();
        let slots = match &start.source {
            MeshSource::File { .. } => None,
            MeshSource::Template { template, .. } => self.slots_of(*template, true),
            MeshSource::Shape(used) => Some(self.shape(names, used, Role::Axiom)),
            MeshSource::System { name, .. } => {
                self.earlier(name);
                None
            }
        };
        self.transforms(names, &start.transforms, &start.uv);
        self.fillings(names, &start.fillings, slots.as_deref());
    }

    fn steps(&mut self, steps: &[Step]) {
        let names = Names::default();
        for step in steps {
            match &step.kind {
                StepKind::Derive { count, groups, .. } => {
                    self.expr(names, count, Type::Int);
                    assert!(groups.iter().all(|g| *g < self.system.groups.len()));
                }
                StepKind::Repeat { count, body } => {
                    self.expr(names, count, Type::Int);
                    self.steps(body);
                }
                StepKind::If { condition, body } => {
                    self.expr(names, condition, Type::Bool);
                    self.steps(body);
                }
                StepKind::Place(place) => assert!(*place < self.system.placements.len()),
                StepKind::Trace { into } => assert!(*into < self.system.symbols.len()),
                StepKind::Subdivide { scheme, levels, place } => {
                    let known = self.vocabulary.schemes.iter().find(|s| s.name == *scheme).expect("a scheme");
                    assert!(known.of.fits(self.system.kind));
                    self.expr(names, levels, Type::Int);
                    assert!(place.is_none_or(|place| place < self.system.placements.len()));
                }
                StepKind::Mark { module, condition, .. } => {
                    self.face(names, module);
                    self.expr(names, condition, Type::Bool);
                }
                StepKind::Crease { sharpness, condition } => {
                    self.expr(names, sharpness, Type::Float);
                    self.expr(names, condition, Type::Bool);
                }
                StepKind::Deposit => {}
            }
        }
    }

    fn whole(&mut self) {
        let system = self.system;
        for template in &system.templates {
            if let TemplateBody::Inline(mesh) = &template.body {
                self.template(mesh);
            }
        }
        if let Axiom::Meshes(starts) = &system.axiom {
            starts.iter().for_each(|s| self.start(s));
        }
        system.groups.iter().flat_map(|g| &g.rules).for_each(|r| self.rule(r));
        for place in &system.placements {
            self.expr(Names::default(), &place.value, Type::Vec3);
            assert!(place.on.iter().all(|s| *s < system.symbols.len()));
        }
        self.steps(&system.run);
    }
}

/// Calls `visit` on every expression of a rule of a mesh system, and all below them.
pub fn rule_expressions<'a>(rule: &'a Rule, visit: &mut dyn FnMut(&'a Expr)) {
    let mut each = |e: &'a Expr| e.walk(&mut |e| visit(e));
    rule.lets.iter().map(|l| &l.value).chain(&rule.tests).chain(&rule.condition).for_each(&mut each);
    let face = |f: &'a FaceModule, each: &mut dyn FnMut(&'a Expr)| {
        f.module.args.iter().chain(&f.tag).for_each(each);
    };
    for alternative in &rule.alternatives {
        alternative.weight.iter().for_each(&mut each);
        let used = match &alternative.successor {
            Successor::Face(FaceSuccessor::Relabel(f)) => {
                face(f, &mut each);
                continue;
            }
            Successor::Face(
                FaceSuccessor::Replace(used) | FaceSuccessor::Attach(used) | FaceSuccessor::Join(used),
            ) => used,
            _ => continue,
        };
        if let FaceTemplate::Shape(shape) = &used.template {
            for arg in &shape.args {
                if let ShapeArg::Value(value) | ShapeArg::PerPoint { value, .. } = arg {
                    each(value);
                }
            }
        }
        for transform in &used.attachment.transforms {
            match transform {
                Transform::Scale(factor) => each(factor),
                Transform::Stretch(factors) => factors.iter().for_each(&mut each),
                Transform::Rotate { axis, angle } => [axis, angle].into_iter().for_each(&mut each),
            }
        }
        if let Some(UvRange { u, v }) = &used.attachment.uv {
            u.iter().chain(v.iter().flatten()).for_each(&mut each);
        }
        for filling in &used.fillings {
            if let Fill::Module(f) = &filling.fill {
                face(f, &mut each);
            }
        }
    }
}

// As much as was written.

fn same_steps(written: &[syntax::Step], lowered: &[Step]) {
    assert_eq!(written.len(), lowered.len());
    for (w, l) in written.iter().zip(lowered) {
        assert_eq!(w.span.start, l.span.start);
        match (&w.kind, &l.kind) {
            (syntax::StepKind::Repeat { body: w, .. }, StepKind::Repeat { body: l, .. })
            | (syntax::StepKind::If { body: w, .. }, StepKind::If { body: l, .. }) => same_steps(w, l),
            (syntax::StepKind::Mark { isolated: w, .. }, StepKind::Mark { isolated: l, .. }) => {
                assert_eq!(w, l)
            }
            _ => {}
        }
    }
}

/// What was written has its counterpart.
fn nothing_is_lost(system: &System) {
    let (mut templates, mut rules) = (0, Vec::new());
    for item in &system.source.items {
        match item {
            Item::Template(template) => {
                assert_eq!(template.name.text, system.templates[templates].name);
                if let (syntax::TemplateBody::Inline(lines), TemplateBody::Inline(mesh)) =
                    (&template.body, &system.templates[templates].body)
                {
                    assert_eq!(lines.len(), mesh.vertices.len() + mesh.faces.len() + mesh.edges.len());
                }
                templates += 1;
            }
            Item::Axiom(axiom) => match (&axiom.kind, &system.axiom) {
                (AxiomKind::Meshes(written), Axiom::Meshes(lowered)) => {
                    assert_eq!(written.len(), lowered.len());
                    for (w, l) in written.iter().zip(lowered) {
                        assert_eq!(w.slots.as_ref().map_or(0, Vec::len), l.fillings.len());
                    }
                }
                (AxiomKind::Meshes(_), axiom) => panic!("{axiom:?}"),
                (_, axiom) => assert!(!matches!(axiom, Axiom::None | Axiom::Meshes(_))),
            },
            Item::Rules(group) => rules.push(group),
            Item::Run(run) => same_steps(&run.steps, &system.run),
            _ => {}
        }
    }
    assert_eq!(templates, system.templates.len());
    assert_eq!(rules.len(), system.groups.len());
    for (w, l) in rules.iter().zip(&system.groups) {
        assert_eq!(w.rules.len(), l.rules.len());
        for (w, l) in w.rules.iter().zip(&l.rules) {
            assert_eq!(w.alternatives.len(), l.alternatives.len());
            assert_eq!(w.predecessor.strict.len(), l.strict.len());
            for (w, l) in w.alternatives.iter().zip(&l.alternatives) {
                let (syntax::Successor::Template(w), Successor::Face(l)) = (&w.successor, &l.successor)
                else {
                    continue;
                };
                let on = w.place.as_ref().is_some_and(|place| place.on);
                let (FaceSuccessor::Replace(used) | FaceSuccessor::Attach(used) | FaceSuccessor::Join(used)) =
                    l
                else {
                    panic!("{l:?}")
                };
                assert_eq!(on, matches!(l, FaceSuccessor::Attach(_)));
                assert_eq!(w.slots.as_ref().map_or(0, Vec::len), used.fillings.len());
            }
        }
    }
}

/// Walks all systems of a text; how many expressions there are in those of meshes.
fn walked(systems: &[System]) -> usize {
    let mut expressions = 0;
    for system in systems {
        let (vocabulary, tags) = (Vocabulary::default(), HashMap::new());
        let mut walk = Walk { system, systems, vocabulary, tags, expressions: 0 };
        walk.whole();
        nothing_is_lost(system);
        expressions += walk.expressions;
    }
    expressions
}

const FOLDERS: [&str; 3] = ["tests/data/language", "tests/data/growth", "tests/data/warned"];

#[test]
fn every_rule_file_is_lowered_whole() {
    for (path, text) in FOLDERS.iter().flat_map(|folder| files(folder)) {
        let checked = checked(&text);
        assert!(!checked.has_errors(), "{}\n{}", path.display(), shown(&text, &checked));
        assert_eq!(checked.systems.len(), text.lines().filter(|l| l.starts_with("system ")).count());
        println!("{}: {} expressions", path.display(), walked(&checked.systems));
    }
}

/// What a mangled text still means is lowered whole, too.
#[test]
fn what_is_left_of_mangled_files_is_lowered_whole() {
    let mut state = 11u64;
    let mut next = |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    let mut left = 0;
    for (_, text) in FOLDERS[..2].iter().flat_map(|folder| files(folder)) {
        if !text.contains(": mesh") && !text.contains("join c1") {
            continue;
        }
        let words: Vec<&str> = text.split_inclusive([' ', '\n', '(', ')', ',', ';', '{', '}']).collect();
        for _ in 0..300 {
            let mut mangled = words.clone();
            let (a, b) = (next(mangled.len()), next(mangled.len()));
            match next(4) {
                0 => mangled.swap(a, b),
                1 => _ = mangled.remove(a),
                2 => mangled[a] = words[b],
                _ => mangled.insert(a, words[b]),
            }
            let checked = checked(&mangled.concat());
            // Of a file with an error an earlier system may be missing.
            if !checked.has_errors() {
                walked(&checked.systems);
                left += 1;
            }
        }
    }
    assert!(left > 500, "{left} texts are still accepted");
}
