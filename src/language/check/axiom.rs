//! Axioms.

use super::scope::{Scope, Where};
use super::typing::as_literal;
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::{Expr, Type, Value};
use crate::language::syntax::{self, AxiomKind, Element, Item, ModuleUse, Source, SourceKind, Span, Start};
use crate::language::system::{Axiom, CurveSource, CurveStart, Kind, PatchSource, PatchStart, Topology};

/// Points of a curve: where from, their type if they are written out, and how far the ring is turned.
struct Points {
    source: CurveSource,
    ty: Option<Type>,
    shift: Option<Expr>,
}

impl<'a> Checker<'a> {
    pub(super) fn axiom(&mut self) -> Axiom {
        let written = self.system.items.iter().find_map(|item| match item {
            Item::Axiom(axiom) => Some(axiom),
            _ => None,
        });
        let Some(axiom) = written else { return Axiom::None };
        match self.kind {
            Kind::Patch { degree, rational, .. } => self.patch_axiom(axiom, degree, rational),
            Kind::Curve(_) => self.curve_axiom(axiom),
            Kind::Mesh => self.mesh_axiom(axiom),
        }
    }

    fn mesh_axiom(&mut self, axiom: &'a syntax::Axiom) -> Axiom {
        let AxiomKind::Meshes(meshes) = &axiom.kind else {
            let message = "a mesh system starts from meshes";
            let error = Diagnostic::error(code::AXIOM, axiom.span, message);
            self.report(error.hint("as in `axiom: box(1, 1, 1) { top: A }`"));
            return Axiom::None;
        };
        // What is missing was reported, so the system is not run.
        Axiom::Meshes(meshes.iter().filter_map(|m| self.mesh_start(m)).collect())
    }

    // Curves.

    fn curve_axiom(&mut self, axiom: &'a syntax::Axiom) -> Axiom {
        let starts = match &axiom.kind {
            AxiomKind::Word(word) => match self.system_word(word) {
                Some(used) => {
                    self.earlier_system(&used.symbol.text, used.span, syntax::Kind::Curve);
                    let name = used.symbol.text.clone();
                    vec![Some(CurveStart::System { name, shift: None, span: used.span })]
                }
                None => {
                    let mut scope = Scope::new(Where::Axiom);
                    let mut modules = Vec::new();
                    // What is not whole was reported, so the system is not run.
                    self.word(&mut scope, word, &mut modules);
                    vec![Some(CurveStart::Word(super::branches::curve_word(word, modules)))]
                }
            },
            AxiomKind::Source(source) => {
                let points = self.curve_source(source);
                vec![match &source.kind {
                    SourceKind::Named(name, _) => {
                        let (name, span) = (name.text.clone(), name.span);
                        points.map(|points| CurveStart::System { name, shift: points.shift, span })
                    }
                    _ => self.unnamed_points(source, points),
                }]
            }
            AxiomKind::Starts(starts) => starts.iter().map(|s| self.curve_start(s)).collect(),
            AxiomKind::Meshes(_) => {
                let message = "a curve system starts from a word or from points";
                self.report(Diagnostic::error(code::AXIOM, axiom.span, message));
                return Axiom::None;
            }
        };
        // What is missing was reported, so the system is not run.
        Axiom::Curve(starts.into_iter().flatten().collect())
    }

    /// A lone name that is no module but an earlier system.
    fn system_word(&self, word: &'a [Element]) -> Option<&'a ModuleUse> {
        let [Element::Module(used)] = word else { return None };
        let name = used.symbol.text.as_str();
        let is_system = !self.symbol_ids.contains_key(name) && self.earlier.iter().any(|e| e.name == name);
        is_system.then_some(used)
    }

    /// `P(_, false) = file "c.csv"`.
    fn curve_start(&mut self, start: &'a Start) -> Option<CurveStart> {
        let points = self.curve_source(&start.source);
        let used = &start.module;
        let symbol = self.symbol(&used.symbol).filter(|s| !self.broken_symbols.contains(s))?;
        let is_point = |e: &syntax::Expr| matches!(&e.kind, syntax::ExprKind::Name(name) if name == "_");
        let args = used.args.as_deref().unwrap_or_default();
        let fields = self.symbols[symbol].fields.clone();
        let mut scope = Scope::new(Where::Axiom);
        if args.len() != fields.len() || !args.iter().any(is_point) {
            if used.args.is_none() {
                self.point_is_missing(start, symbol);
            } else if args.len() != fields.len() {
                self.module_use(&mut scope, used);
            } else {
                let message = "`_` must stand where the point read goes";
                let error = Diagnostic::error(code::AXIOM, used.span, message);
                self.report(error.hint(format!("as in `{}(_) = file \"c.obj\"`", used.symbol.text)));
            }
            return None;
        }
        let mut lowered = Vec::with_capacity(args.len());
        for (arg, field) in args.iter().zip(&fields) {
            if !is_point(arg) {
                let why = || format!("`{}` is {}", field.name, super::typing::article(&field.ty));
                lowered.push(self.expr(&mut scope, arg, &field.ty, why).map(Some));
                continue;
            }
            if !matches!(field.ty, Type::Vec2 | Type::Vec3 | Type::Vec4) {
                let message = format!("a point is a vector, and `{}` is {}", field.name, field.ty);
                self.report(Diagnostic::error(code::TYPE, arg.span, message));
            } else if let Some(points) =
                points.as_ref().and_then(|p| p.ty.as_ref()).filter(|p| **p != field.ty)
            {
                let message = format!("the points are {points}, and `{}` is {}", field.name, field.ty);
                self.report(Diagnostic::error(code::TYPE, start.source.span, message));
            }
            lowered.push(Some(None));
        }
        let (points, args) = (points?, lowered.into_iter().collect::<Option<Vec<_>>>()?);
        let span = used.span.to(start.source.span);
        Some(CurveStart::Points { symbol, args, source: points.source, shift: points.shift, span })
    }

    /// `P = file "c.svg"`, for `P(_) = file "c.svg"`.
    fn point_is_missing(&mut self, start: &'a Start, symbol: usize) {
        let vector = |ty: &Type| matches!(ty, Type::Vec2 | Type::Vec3 | Type::Vec4);
        let fields = &self.symbols[symbol].fields;
        let name = &start.module.symbol.text;
        let source = match &start.source.kind {
            SourceKind::File(path, _) => format!("file \"{}\"", path.text),
            SourceKind::List(_) | SourceKind::Named(..) => "…".to_string(),
        };
        let (message, hint) = match fields.iter().position(|field| vector(&field.ty)) {
            None => {
                let message = format!("`{name}` holds no point to be read");
                (
                    message,
                    format!("declare one, as in `module {name}(v: vec2)`, and write `{name}(_) = {source}`"),
                )
            }
            Some(point) => {
                let arg = |(n, field): (usize, &crate::language::system::Field)| match n == point {
                    true => "_",
                    false => super::successor::example(&field.ty),
                };
                let args: Vec<&str> = fields.iter().enumerate().map(arg).collect();
                let hint = format!("write `{name}({}) = {source}`, with `_` for the point", args.join(", "));
                let points = self
                    .symbols
                    .iter()
                    .filter(|s| matches!(s.fields.as_slice(), [field] if vector(&field.ty)));
                let alone = fields.len() == 1 && points.count() == 1 && source != "…";
                let hint = if alone { format!("{hint}, or `axiom: {source}` alone") } else { hint };
                (format!("the points read have no place in `{name}`"), hint)
            }
        };
        self.report(Diagnostic::error(code::AXIOM, start.module.span, message).hint(hint));
    }

    /// Points without a module: they become the one module that holds a vector and nothing else.
    fn unnamed_points(&mut self, source: &'a Source, points: Option<Points>) -> Option<CurveStart> {
        let vector = |ty: &Type| matches!(ty, Type::Vec2 | Type::Vec3 | Type::Vec4);
        let fits = |s: &&crate::language::system::Symbol| matches!(s.fields.as_slice(), [field] if vector(&field.ty));
        let fitting: Vec<_> = self.symbols.iter().filter(fits).collect();
        match fitting.as_slice() {
            [only] => {
                let (name, field) = (only.name.clone(), only.fields[0].ty.clone());
                let symbol = self.symbols.iter().position(|s| s.name == name)?;
                if let Some(points) = points.as_ref().and_then(|p| p.ty.as_ref()).filter(|p| **p != field) {
                    let message = format!("the points are {points}, and `{name}` takes {field}");
                    self.report(Diagnostic::error(code::TYPE, source.span, message));
                }
                let Points { source: from, shift, .. } = points?;
                Some(CurveStart::Points { symbol, args: vec![None], source: from, shift, span: source.span })
            }
            [] => {
                let message = "no module holds a point and nothing else";
                let error = Diagnostic::error(code::AXIOM, source.span, message);
                self.report(
                    error
                        .hint("say what a point becomes: `P(_, …) = file \"c.obj\"`, with `_` for the point"),
                );
                None
            }
            [a, b, ..] => {
                let message = format!("the points may become `{}` or `{}`", a.name, b.name);
                let hint = format!("say which: `{}(_) = …`", a.name);
                self.report(Diagnostic::error(code::AXIOM, source.span, message).hint(hint));
                None
            }
        }
    }

    /// Checks the source of a curve.
    fn curve_source(&mut self, source: &'a Source) -> Option<Points> {
        let mut turned = Some(None);
        if let Some(shift) = &source.shift {
            if self.kind != Kind::Curve(Topology::Ring) {
                let message = "only a ring can be shifted";
                let error = Diagnostic::error(code::AXIOM, shift.span, message);
                self.report(error.hint(format!("write `system {} : curve ring`", self.system.name.text)));
            }
            let mut scope = Scope::new(Where::Axiom);
            let why = || "a shift is a number of points, an int".into();
            turned = self.expr(&mut scope, shift, &Type::Int, why).map(Some);
        }
        let (from, ty) = match &source.kind {
            SourceKind::File(path, index) => {
                let index = self.file_index(index.as_ref());
                (CurveSource::File { path: path.text.clone(), index, span: path.span }, None)
            }
            SourceKind::List(list) => {
                let mut scope = Scope::new(Where::Axiom);
                let list = self.free(&mut scope, list)?;
                match (&list.ty, as_literal(&list)) {
                    (Type::List(element, _), Some(Value::List(points)))
                        if matches!(**element, Type::Vec2 | Type::Vec3 | Type::Vec4) =>
                    {
                        (CurveSource::Inline(points), Some((**element).clone()))
                    }
                    (ty, _) => {
                        let what = super::typing::article(ty);
                        let message = format!("a curve is a list of points, not {what}");
                        self.report(Diagnostic::error(code::AXIOM, list.span, message));
                        return None;
                    }
                }
            }
            SourceKind::Named(name, args) => {
                self.no_arguments(args.as_deref(), source.span);
                self.earlier_system(&name.text, name.span, syntax::Kind::Curve)?;
                (CurveSource::System { name: name.text.clone(), span: name.span }, None)
            }
        };
        Some(Points { source: from, ty, shift: turned? })
    }

    fn no_arguments(&mut self, args: Option<&[syntax::Expr]>, span: Span) {
        if args.is_some() {
            let message = "an earlier system takes no arguments";
            self.report(Diagnostic::error(code::FUNCTION_ARITY, span, message));
        }
    }

    pub(super) fn file_index(&mut self, index: Option<&syntax::Number>) -> Option<u32> {
        let index = index?;
        let value = index.text.parse().ok();
        if value.is_none() {
            let message = format!("{} is no index into a file", index.text);
            self.report(Diagnostic::error(code::NUMBER, index.span, message));
        }
        value
    }

    // Patches.

    fn patch_axiom(&mut self, axiom: &'a syntax::Axiom, degree: [u8; 2], rational: bool) -> Axiom {
        let name = self.symbols.first().map_or("P".to_string(), |s| {
            let args: Vec<&str> = s.fields.iter().map(|f| super::successor::example(&f.ty)).collect();
            if args.is_empty() { s.name.clone() } else { format!("{}({})", s.name, args.join(", ")) }
        });
        let starts = match &axiom.kind {
            AxiomKind::Starts(starts) => starts,
            // The final word of an earlier system, with its own symbols.
            AxiomKind::Source(Source { kind: SourceKind::Named(name, _), .. }) => {
                return self.patch_system(&name.text, name.span);
            }
            AxiomKind::Word(word) => {
                if let Some(used) = self.system_word(word) {
                    return self.patch_system(&used.symbol.text, used.span);
                }
                self.no_nets(axiom.span, "the modules of a patch system need nets", &name);
                return Axiom::None;
            }
            AxiomKind::Source(_) | AxiomKind::Meshes(_) => {
                self.no_nets(axiom.span, "the nets of a patch system need a symbol", &name);
                return Axiom::None;
            }
        };
        let lowered = starts.iter().filter_map(|s| self.patch_start(s, degree, rational)).collect();
        Axiom::Patches(lowered)
    }

    fn patch_system(&mut self, name: &str, span: Span) -> Axiom {
        match self.earlier_system(name, span, syntax::Kind::Patch) {
            Some(_) => Axiom::PatchSystem { name: name.to_string(), span },
            None => Axiom::None,
        }
    }

    fn no_nets(&mut self, span: Span, message: &str, symbol: &str) {
        let error = Diagnostic::error(code::AXIOM, span, message);
        self.report(error.hint(format!("write `axiom: {symbol} = file \"nets.bpt\"`")));
    }

    fn patch_start(&mut self, start: &'a Start, degree: [u8; 2], rational: bool) -> Option<PatchStart> {
        let mut scope = Scope::new(Where::Axiom);
        let module = self.module_use(&mut scope, &start.module);
        let source = self.patch_source(&start.source, degree, rational);
        let (module, source) = (module?, source?);
        let span = start.module.span.to(start.source.span);
        Some(PatchStart { symbol: module.symbol, args: module.args, source, span })
    }

    fn patch_source(&mut self, source: &'a Source, degree: [u8; 2], rational: bool) -> Option<PatchSource> {
        if let Some(shift) = &source.shift {
            let message = "`shift` turns the ring of a curve system";
            self.report(Diagnostic::error(code::AXIOM, shift.span, message));
        }
        let span = source.span;
        match &source.kind {
            SourceKind::File(path, index) => {
                let index = self.file_index(index.as_ref());
                Some(PatchSource::File { path: path.text.clone(), index, span: path.span })
            }
            SourceKind::List(list) => {
                let mut scope = Scope::new(Where::Axiom);
                let list = self.free(&mut scope, list)?;
                let points = self.net(&list, degree, rational)?;
                Some(PatchSource::Inline { points, span })
            }
            SourceKind::Named(name, args) => {
                self.no_arguments(args.as_deref(), span);
                self.earlier_system(&name.text, name.span, syntax::Kind::Patch)?;
                Some(PatchSource::System { name: name.text.clone(), span: name.span })
            }
        }
    }

    /// A net written out: a list of rows of points.
    fn net(&mut self, list: &Expr, degree: [u8; 2], rational: bool) -> Option<Vec<[f32; 4]>> {
        let (rows, columns) = (degree[0] as usize + 1, degree[1] as usize + 1);
        let message = match (as_literal(list), &list.ty) {
            (Some(Value::List(written)), Type::List(row, n)) => match &**row {
                Type::List(point, m) if matches!(**point, Type::Vec3 | Type::Vec4) => {
                    if (*n, *m) == (rows, columns) {
                        return self.points(&written, rational, list.span);
                    }
                    format!(
                        "a net of degree {} by {} has {rows} rows of {columns} points, not {n} of {m}",
                        degree[0], degree[1]
                    )
                }
                _ => "a net is a list of rows, each a list of points, vec3 or vec4".into(),
            },
            _ => "a net is a list of rows, each a list of points, vec3 or vec4".into(),
        };
        let error = Diagnostic::error(code::AXIOM, list.span, message);
        self.report(error.hint("as in `[[(0,0,0), (1,0,0)], [(0,1,0), (1,1,0)]]` for `bezier 1`"));
        None
    }

    fn points(&mut self, rows: &[Value], rational: bool, span: Span) -> Option<Vec<[f32; 4]>> {
        let mut points = Vec::new();
        for row in rows {
            let Value::List(row) = row else { return None };
            for point in row {
                points.push(match point {
                    Value::Vec3([x, y, z]) => [*x, *y, *z, 1.0],
                    Value::Vec4(point) => *point,
                    _ => return None,
                });
            }
        }
        let wrong = |p: &[f32; 4]| p[3] <= 0.0 || p[3] != 1.0 && !rational;
        if let Some(index) = points.iter().position(wrong) {
            let (weight, columns) = (points[index][3], points.len() / rows.len().max(1));
            let point = format!("point {} of row {}", index % columns, index / columns);
            let (message, hint) = if weight <= 0.0 {
                (
                    format!("{point} has the weight {weight}; a weight must be positive"),
                    "the fourth coordinate is the weight",
                )
            } else {
                (
                    format!("{point} has the weight {weight}, which needs a rational system"),
                    "the fourth coordinate is the weight; write `patch bezier … rational`",
                )
            };
            let error = Diagnostic::error(code::AXIOM, span, message);
            self.report(error.hint(hint));
            return None;
        }
        Some(points)
    }

    /// The number of modules of an axiom that is written out, for contexts that wrap around it.
    pub(super) fn axiom_length(&self) -> Option<usize> {
        let axiom = self.system.items.iter().find_map(|item| match item {
            Item::Axiom(axiom) => Some(axiom),
            _ => None,
        })?;
        match &axiom.kind {
            AxiomKind::Word(word) if self.system_word(word).is_none() => {
                Some(word.iter().filter(|e| matches!(e, Element::Module(_))).count())
            }
            AxiomKind::Source(Source { kind: SourceKind::List(list), .. }) => match &list.kind {
                syntax::ExprKind::List(points) => Some(points.len()),
                _ => None,
            },
            _ => None,
        }
    }
}
