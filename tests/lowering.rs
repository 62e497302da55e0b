//! Mesh systems and branching surfaces as the checker hands them on: nothing of them is left in the syntax tree.

mod walk;

use super::check::{checked, shown, system, written};
use burgeon::language::check::code;
use burgeon::language::system::{
    Axiom, BinderPlace, Continuity, FaceModule, FaceSuccessor, FaceTemplate, Fill, Filling, Kind, MeshSource,
    MeshStart, Module, Pairing, PointField, ShapeArg, ShapeUse, SharpEdge, StepKind, Successor,
    SurfaceElement, System, TemplateBody, TemplateMesh, TemplateUse, Transform, UvRange,
};
use burgeon::language::{Expr, Type};
use burgeon::plan::Plan;

// As text.

fn list<T>(items: &[T], separator: &str, text: impl Fn(&T) -> String) -> String {
    items.iter().map(text).collect::<Vec<_>>().join(separator)
}

fn module(system: &System, module: &Module) -> String {
    let name = &system.symbols[module.symbol].name;
    if module.args.is_empty() {
        name.clone()
    } else {
        format!("{name}({})", list(&module.args, ", ", written))
    }
}

fn face(system: &System, face: &FaceModule) -> String {
    let text = module(system, &face.module);
    if face.tag.is_empty() { text } else { format!("{text}@({})", list(&face.tag, ", ", written)) }
}

fn shape(used: &ShapeUse) -> String {
    let arg = |arg: &ShapeArg| match arg {
        ShapeArg::Value(value) => written(value),
        ShapeArg::PerPoint { fields, value } => {
            format!("{} of {}", written(value), list(fields, " ", |f| f.name.clone()))
        }
        ShapeArg::Curve { name, .. } => format!("curve {name}"),
        ShapeArg::Patch { name, .. } => format!("patch {name}"),
    };
    format!("{}({})", used.shape, list(&used.args, ", ", arg))
}

fn transform(transform: &Transform) -> String {
    match transform {
        Transform::Scale(factor) => format!("scale {}", written(factor)),
        Transform::Stretch(factors) => format!("stretch {}", list(factors, " ", written)),
        Transform::Rotate { axis, angle } => format!("rotate {} {}", written(axis), written(angle)),
    }
}

fn placed(transforms: &[Transform], uv: &Option<UvRange>) -> String {
    let mut text = String::new();
    for t in transforms {
        text += &format!(", {}", transform(t));
    }
    if let Some(UvRange { u, v }) = uv {
        text += &format!(", u {}", list(u, " ", written));
        if let Some(v) = v {
            text += &format!(", v {}", list(v, " ", written));
        }
    }
    text
}

fn fillings(system: &System, fillings: &[Filling]) -> String {
    let fill = |fill: &Fill| match fill {
        Fill::Erase => "eps".to_string(),
        Fill::Module(module) => face(system, module),
    };
    match fillings {
        [] => String::new(),
        fillings => {
            let one =
                |f: &Filling| format!("{}: {}", list(&f.slots, ", ", |s| s.name.clone()), fill(&f.fill));
            format!(" {{ {} }}", list(fillings, "; ", one))
        }
    }
}

fn used(system: &System, used: &TemplateUse) -> String {
    let name = match &used.template {
        FaceTemplate::Template(id) => system.templates[*id].name.clone(),
        FaceTemplate::Shape(used) => shape(used),
    };
    let pairing = match used.attachment.pairing {
        Pairing::Fitted => "",
        Pairing::FirstCorners => ", corner",
    };
    let placed = placed(&used.attachment.transforms, &used.attachment.uv);
    format!("{name}{pairing}{placed}{}", fillings(system, &used.fillings))
}

fn successor(system: &System, successor: &Successor) -> String {
    match successor {
        Successor::Face(FaceSuccessor::Erase) => "eps".to_string(),
        Successor::Face(FaceSuccessor::Relabel(module)) => face(system, module),
        Successor::Face(FaceSuccessor::Replace(template)) => format!("replace {}", used(system, template)),
        Successor::Face(FaceSuccessor::Attach(template)) => format!("attach {}", used(system, template)),
        Successor::Face(FaceSuccessor::Join(template)) => format!("join {}", used(system, template)),
        other => panic!("no face: {other:?}"),
    }
}

/// The successors of all rules of the first group, weights in front.
fn successors(system: &System) -> Vec<String> {
    let alternatives = system.groups[0].rules.iter().flat_map(|rule| &rule.alternatives);
    let text =
        |weight: &Option<Expr>| weight.as_ref().map_or(String::new(), |w| format!("({}) ", written(w)));
    alternatives.map(|a| text(&a.weight) + &successor(system, &a.successor)).collect()
}

/// A mesh system of these rules, with a module A(n), a module S and a template `block`.
fn with_rules(rules: &str) -> System {
    system(&format!("system s : mesh\nmodule A(n: int), S\n{BLOCK}\nrules:\n{rules}"))
}

const BLOCK: &str = "template block {\n  v 0 0 0  v 1 0 0  v 1 1 0  v 0 1 0  v 0 0 2  v 1 0 2  v 1 1 2  v 0 1 2\n  \
     f base: 3 2 1 0\n  f top: 4 5 6 7\n  f side: 0 1 5 4\n  f side: 1 2 6 5\n  f side: 2 3 7 6\n  f side: 3 0 4 7\n}";

// Templates.

fn inline(system: &System, template: usize) -> &TemplateMesh {
    match &system.templates[template].body {
        TemplateBody::Inline(mesh) => mesh,
        body => panic!("{body:?}"),
    }
}

#[test]
fn templates_are_numbers() {
    let text = "system s : mesh\ntemplate wedge {\n  v -0 0 0  v 1.5 0 -0.25  v 0 1e1 0  v 0 0 1\n  e 1 3 2.5\n  \
                f side: 0 1 3\n  f foot: 2 1 0\n  f side: 1 2 3\n  e 3 0 10\n  f back: 2 0 3\n} base foot\n";
    let system = system(text);
    let wedge = inline(&system, 0);
    assert_eq!(system.templates[0].name, "wedge");
    assert_eq!(wedge.vertices[0].map(f32::to_bits), [0; 3]);
    assert_eq!(wedge.vertices, [[0.0, 0.0, 0.0], [1.5, 0.0, -0.25], [0.0, 10.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(wedge.slots, ["side", "foot", "back"]);
    let faces: Vec<(usize, &[u32])> = wedge.faces.iter().map(|f| (f.slot, f.corners.as_slice())).collect();
    let expected: [(usize, &[u32]); 4] = [(0, &[0, 1, 3]), (1, &[2, 1, 0]), (0, &[1, 2, 3]), (2, &[2, 0, 3])];
    assert_eq!(faces, expected);
    let sharp = |ends, sharpness| SharpEdge { ends, sharpness };
    assert_eq!(wedge.edges, [sharp([1, 3], 2.5), sharp([3, 0], 10.0)]);
    assert_eq!(wedge.bases, [1]);
}

#[test]
fn bases_stand_in_the_order_of_the_faces_that_they_replace() {
    let tetrahedron = "{ v 0 0 0 v 1 0 0 v 0 1 0 v 0 0 1 f a: 2 1 0 f b: 0 1 3 f base: 1 2 3 f c: 2 0 3 }";
    let text = format!(
        "system s : mesh\ntemplate two {tetrahedron} base c a\ntemplate one {tetrahedron}\n\
         template none {{ v 0 0 0 v 1 0 0 v 0 1 0 f leaf: 0 1 2 }}\n\
         template read = \"a.obj\"\ntemplate girder = \"b.obj\" base end1 end0\n"
    );
    let system = system(&text);
    let bases: Vec<&[usize]> = (0..3).map(|t| inline(&system, t).bases.as_slice()).collect();
    let expected: [&[usize]; 3] = [&[3, 0], &[2], &[]];
    assert_eq!(bases, expected);
    let file = |t: usize| match &system.templates[t].body {
        TemplateBody::File { path, bases, span } => {
            (path.as_str(), list(bases, " ", |b| b.name.clone()), &text[span.range()])
        }
        body => panic!("{body:?}"),
    };
    assert_eq!(file(3), ("a.obj", String::new(), "\"a.obj\""));
    assert_eq!(file(4), ("b.obj", "end1 end0".to_string(), "\"b.obj\""));
}

#[test]
fn a_number_of_a_template_that_no_float_holds_is_refused() {
    let triangle = |x: &str, sharp: &str| {
        format!(
            "system s : mesh\ntemplate t {{ v {x} 0 0 v 1 0 0 v 0 1 0 f a: 0 1 2 e 0 1 {sharp} }}\naxiom: t\n"
        )
    };
    let largest = system(&triangle("-3.4028235e38", "0.000000000000000000000000000000000000000000000000001"));
    assert_eq!(inline(&largest, 0).vertices[0][0], f32::MIN);
    for text in [triangle("4e38", "1"), triangle("0", "1e39")] {
        let checked = checked(&text);
        let codes: Vec<&str> = checked.diagnostics.iter().map(|d| d.code).collect();
        assert_eq!(codes, [code::NUMBER], "{}", shown(&text, &checked));
    }
}

// Successors.

#[test]
fn faces_are_removed_relabelled_replaced_and_decorated() {
    let rules =
        "  A(0) -> eps\n  A(1) -> S\n  A(2) -> A(7)@3\n  A(3) -> block\n  A(n) : n < 9 -> extrude(n)\n  \
                 S ->(n) eps ->(2) block on scale(2) { top: S }\n"
            .replace("->(n)", "->(1/2)");
    assert_eq!(
        successors(&with_rules(&rules)),
        [
            "eps",
            "S",
            "A(7)@(3)",
            "replace block",
            "replace extrude(float(b0))",
            "(0.5) eps",
            "(2.0) attach block, scale 2.0 { top: S }"
        ]
    );
}

#[test]
fn attachments_keep_their_transforms_in_order() {
    let system = with_rules(
        "  A(x) -> block at rotate(x, x) scale(1/2) rotate((0, x, 1), 10) scale(1, 2, x) corner uv(0, x)\n  \
         A(x) -> inset(0.3) at uv(0, 1, x, 3) scale(rand(1, 2))\n  S -> block\n",
    );
    let rotate = "rotate Vec3([1.0, 0.0, 0.0]) float(b0), scale 0.5, rotate (0.0, float(b0), 1.0) 10.0";
    assert_eq!(
        successors(&system),
        [
            format!("replace block, corner, {rotate}, stretch 1.0 2.0 float(b0), u 0.0 float(b0)"),
            "replace inset(0.3), scale rand(1.0, 2.0), u 0.0 1.0, v float(b0) 3.0".to_string(),
            "replace block".to_string(),
        ]
    );
}

#[test]
fn slots_keep_their_order_lists_and_tags() {
    let system = with_rules(
        "  A(n) let k = 2*n -> block { side, top: A(nth + k)@(n, k)\n }\n  A(n) -> extrude(1) { side: eps; top: S }\n  \
         S -> block { }\n",
    );
    assert_eq!(
        successors(&system),
        [
            "replace block { side, top: A((nth + l0))@(b0, l0) }",
            "replace extrude(1.0) { side: eps; top: S }",
            "replace block"
        ]
    );
}

#[test]
fn a_slot_that_a_template_has_not_is_left_out() {
    let system = with_rules("  S -> block { rim, top, edge: A(1); side: S }\n");
    assert_eq!(successors(&system), ["replace block { top: A(1); side: S }"]);
    // Which slots a file has is known when it is read.
    let text = "system s : mesh\nmodule S\ntemplate t = \"t.obj\"\nrules:\n  S -> t { rim, top: S }\n";
    assert_eq!(successors(&self::system(text)), ["replace t { rim, top: S }"]);
}

#[test]
fn joins_know_their_tags_and_bases() {
    let ring = "template beam = \"beam.obj\" base end0 end1\n";
    let rules = "  A(n)@t & S@t : n > t -> beam at corner { steel: A(t) }\n  S@4 & S@4 -> beam\n  A(n)@k -> S@(k + 1)\n";
    let text = format!("system s : mesh\nmodule A(n: int), S\n{ring}rules:\n{rules}");
    let system = system(&text);
    assert_eq!(successors(&system), ["join beam, corner { steel: A(b1) }", "join beam", "S@((b1 + 1))"]);
    let rules = &system.groups[0].rules;
    let strict: Vec<&[usize]> = rules.iter().map(|r| r.strict.as_slice()).collect();
    let expected: [&[usize]; 3] = [&[0, 1], &[1, 1], &[0]];
    assert_eq!(strict, expected);
    let places = |rule: usize| rules[rule].binders.iter().map(|b| b.place).collect::<Vec<_>>();
    let (field, tag) = (BinderPlace::Strict { module: 0, field: 0 }, |module| BinderPlace::Tag { module });
    assert_eq!(places(0), [field, tag(0), tag(1)]);
    assert_eq!(places(1), [tag(0), tag(1)]);
    assert_eq!(places(2), [field, tag(0)]);
    let tests = |rule: usize| rules[rule].tests.iter().map(written).collect::<Vec<_>>();
    assert_eq!(
        (tests(0), tests(1), tests(2)),
        (vec!["(b1 == b2)".into()], vec!["(4 == b0)".into(), "(4 == b1)".into()], vec![])
    );
}

#[test]
fn random_numbers_of_a_face_are_counted_in_the_order_of_the_text() {
    let system = with_rules(
        "  A(n) : rand() < 0.5 -> inset(rand()) at scale(rand()) rotate((rand(), 0, 0), rand()) uv(rand(), rand()) \
         { top: A(int(rand()))@(int(rand()), int(rand())); side: A(int(rand())) }\n",
    );
    let mut sites = Vec::new();
    walk::rule_expressions(&system.groups[0].rules[0], &mut |e| {
        if let burgeon::language::expr::ExprKind::Random { site, .. } = &e.kind {
            sites.push((e.span.start, *site));
        }
    });
    sites.sort_unstable();
    assert_eq!(sites.iter().map(|(_, site)| *site).collect::<Vec<_>>(), (0..11).collect::<Vec<_>>());
}

// Axioms.

fn start(system: &System, start: &MeshStart) -> String {
    let source = match &start.source {
        MeshSource::File { path, index: None, .. } => path.clone(),
        MeshSource::File { path, index: Some(index), .. } => format!("{path}[{index}]"),
        MeshSource::Template { template, .. } => system.templates[*template].name.clone(),
        MeshSource::Shape(used) => shape(used),
        MeshSource::System { name, .. } => format!("system {name}"),
    };
    format!("{source}{}{}", placed(&start.transforms, &start.uv), fillings(system, &start.fillings))
}

fn starts(system: &System) -> Vec<String> {
    match &system.axiom {
        Axiom::Meshes(starts) => starts.iter().map(|s| start(system, s)).collect(),
        axiom => panic!("{axiom:?}"),
    }
}

#[test]
fn axioms_are_files_templates_shapes_and_systems() {
    let text = format!(
        "system first : mesh\nmodule A\naxiom: disc(5, 1/2)\n\
         system s : mesh\nparam h: float = 2\nmodule A(n: int), S\n{BLOCK}\n\
         axiom: file \"a.obj\"\n  file \"b.obj\" [3] at scale(2) {{ soil, rim: A(nth) }}\n  \
         block at rotate(y, 90) uv(0, 1) {{ base: S@7; side: eps }}\n  box(1, h, 2*h) {{ top, side: S }}\n  \
         first {{ A: S }}\n"
    );
    assert_eq!(
        starts(&system(&text)),
        [
            "a.obj",
            "b.obj[3], scale 2.0 { soil, rim: A(nth) }",
            "block, rotate Vec3([0.0, 1.0, 0.0]) 90.0, u 0.0 1.0 { base: S@(7); side: eps }",
            "box(1.0, u0, (2.0 * u0)) { top, side: S }",
            "system first { A: S }"
        ]
    );
}

#[test]
fn an_index_into_a_mesh_file_that_is_none_is_refused() {
    let text = "system s : mesh\naxiom: file \"a.obj\" [4294967296]\n";
    let checked = checked(text);
    let codes: Vec<&str> = checked.diagnostics.iter().map(|d| d.code).collect();
    assert_eq!(codes, [code::NUMBER], "{}", shown(text, &checked));
}

#[test]
fn shapes_take_earlier_systems_and_ask_at_their_points() {
    let curve = "system c : curve open\nmodule P(v: vec3, r: float), Q(k: int, r: float), R(r: int)\n\
                 axiom: P((0,0,0), 1) Q(2, 1) R(3)\n";
    let text = format!(
        "{curve}system p : patch bezier 1\nmodule L\n\
         system s : mesh\nparam w: float = 1\nmodule Bark\n\
         axiom: tube(c, 8, w * r + v.y + k) {{ side: Bark }}\n  fill(c)\n  revolve(c, 3)\n  leaves(p) {{ L: Bark }}\n"
    );
    let system = system(&text);
    assert_eq!(
        starts(&system),
        [
            "tube(curve c, 8, (((u0 * b1) + b0.1) + float(b2)) of v r k) { side: Bark }",
            "fill(curve c)",
            "revolve(curve c, 3)",
            "leaves(patch p) { L: Bark }"
        ]
    );
    let Axiom::Meshes(starts) = &system.axiom else { panic!() };
    let MeshSource::Shape(ShapeUse { args, .. }) = &starts[0].source else { panic!() };
    let ShapeArg::PerPoint { fields, .. } = &args[2] else { panic!() };
    // The `r` of R is an int.
    let field = |name: &str, ty, places: &[(usize, usize)]| PointField {
        name: name.into(),
        ty,
        places: places.to_vec(),
    };
    let expected = [
        field("v", Type::Vec3, &[(0, 0)]),
        field("r", Type::Float, &[(0, 1), (1, 1)]),
        field("k", Type::Int, &[(1, 0)]),
    ];
    assert_eq!(*fields, expected);
}

#[test]
fn points_of_a_turtle_have_the_fields_of_the_module_it_writes() {
    let text = "system c : curve open\nmodule X(k: int)\nmodule P(v: vec3, r: float)\naxiom: X(1)\nrun:\n  trace into P\n\
                system s : mesh\naxiom: tube(c, 8, r)\n";
    let system = system(text);
    let Axiom::Meshes(starts) = &system.axiom else { panic!() };
    let MeshSource::Shape(ShapeUse { args, .. }) = &starts[0].source else { panic!() };
    let ShapeArg::PerPoint { fields, .. } = &args[2] else { panic!() };
    let places: Vec<_> = fields.iter().map(|f| (f.name.as_str(), f.places.as_slice())).collect();
    assert_eq!(places, [("v", &[(1, 0)][..]), ("r", &[(1, 1)][..])]);
}

// Steps.

#[test]
fn steps_of_meshes_are_typed() {
    let text = "system s : mesh\nparam n: int = 2\nmodule A(k: int), S\nplace a = p\nplace b on S = p + normal\n\
                rules:\n  S -> S\nrun:\n  subdivide loop n + 1\n  repeat 2 {\n    subdivide catmull_clark 2 place b\n    \
                mark A(sides)@(level, 2) : rand() < 0.5 isolated\n  }\n  if n > 1 {\n    mark S : normal.z > 0\n  }\n  \
                crease length : boundary || dihedral > 40\n  place a\n";
    let system = system(text);
    let place = |place: &Option<usize>| place.map_or("", |p| &system.placements[p].name).to_string();
    fn each(steps: &[burgeon::language::system::Step], visit: &mut dyn FnMut(&StepKind)) {
        for step in steps {
            visit(&step.kind);
            if let StepKind::Repeat { body, .. } | StepKind::If { body, .. } = &step.kind {
                each(body, visit);
            }
        }
    }
    let mut found = Vec::new();
    each(&system.run, &mut |step| {
        let rest = match step {
            StepKind::Subdivide { scheme, levels, place: p } => {
                format!("{scheme} {} {}", written(levels), place(p))
            }
            StepKind::Mark { module, condition, isolated } => {
                format!("{} {} {isolated}", face(&system, module), written(condition))
            }
            StepKind::Crease { sharpness, condition } => {
                format!("{} {}", written(sharpness), written(condition))
            }
            StepKind::Place(p) => place(&Some(*p)),
            StepKind::Repeat { count, .. } => written(count),
            StepKind::If { condition, .. } => written(condition),
            _ => String::new(),
        };
        found.push(format!("{} {rest}", step.word()));
    });
    assert_eq!(
        found,
        [
            "subdivide loop (u0 + 1) ",
            "repeat 2",
            "subdivide catmull_clark 2 b",
            "mark A(sides)@(level, 2) (rand() < 0.5) true",
            "if (u0 > 1)",
            "mark S (normal.2 > 0.0) false",
            "crease length (boundary || (dihedral > 40.0))",
            "place a"
        ]
    );
    assert_eq!(system.placements[1].on, [1]);
}

#[test]
fn what_is_not_derived_is_refused_by_name() {
    let volume = "volume water: float (8, 8, 8) from (0,0,0) to (1,1,1)\n";
    let refused = [
        (
            format!(
                "system s : curve open\nmodule P(v: vec2)\n{volume}axiom: P((0,0))\nrun:\n  deposit P into water\n"
            ),
            "this version does not derive `deposit` in a curve system",
        ),
        (
            "system s : patch bezier 1\nmodule P\nrules:\n  P -> P [ +(30) P ] P\n".to_string(),
            "this version does not derive brackets in patch systems",
        ),
        ("system s : mesh\naxiom: box(1, 1, 1)\n".to_string(), "this version does not derive mesh systems"),
    ];
    for (text, why) in refused {
        let Err(e) = Plan::new(&system(&text)) else { panic!("{text}") };
        assert_eq!(e.to_string(), why, "{text}");
    }
}

// Branching surfaces.

#[test]
fn branching_surfaces_keep_their_branches() {
    let text = "system s : patch bezier 3 join c1\nparam angle = 30\nmodule P(n: int)\nrules:\n  \
                P(n) -> P(0) [ + ^(24) P(n - 1) [ - eps [ P(1) | eps ] ] ] |(5) P(n)\n";
    let system = system(text);
    assert_eq!(system.kind, Kind::Patch { degree: [3, 3], rational: false, join: Some(Continuity::C1) });
    fn word(system: &System, elements: &[SurfaceElement]) -> String {
        list(elements, " ", |element| match element {
            SurfaceElement::Eps => "eps".into(),
            SurfaceElement::Net(m) => format!("net {}", module(system, m)),
            SurfaceElement::Turtle(m) => format!("turn {}", module(system, m)),
            SurfaceElement::Block(b) => format!("{}×{}", b.rows, b.columns),
            SurfaceElement::Branch(branch) => format!("[ {} ]", word(system, branch)),
        })
    }
    let Successor::Surface(elements) = &system.groups[0].rules[0].alternatives[0].successor else { panic!() };
    assert_eq!(
        word(&system, elements),
        "net P(0) [ turn +(float(u0)) turn ^(24.0) net P((b0 - 1)) [ turn -(float(u0)) eps 1×2 ] ] turn |(5.0) net P(b0)"
    );
    let mut symbols = Vec::new();
    burgeon::language::system::surface_modules(elements, &mut |m| {
        symbols.push(system.symbols[m.symbol].name.as_str())
    });
    assert_eq!(symbols, ["P", "+", "^", "P", "-", "P", "|", "P"]);
}

#[test]
fn a_declared_module_with_a_turtles_name_has_a_net() {
    let text = "system s : patch bezier 1\nmodule F(n: int), P\nrules:\n  P -> P [ + F(1) ]\n";
    let system = system(text);
    let Successor::Surface(elements) = &system.groups[0].rules[0].alternatives[0].successor else { panic!() };
    let [SurfaceElement::Net(_), SurfaceElement::Branch(branch)] = elements.as_slice() else {
        panic!("{elements:?}")
    };
    assert!(matches!(branch.as_slice(), [SurfaceElement::Turtle(_), SurfaceElement::Net(_)]), "{branch:?}");
}

#[test]
fn a_patch_axiom_may_be_an_earlier_system() {
    for axiom in ["first", "P = first"] {
        let text = format!(
            "system first : patch bezier 1\nmodule P\nsystem s : patch bezier 1\nmodule P\naxiom: {axiom}\nrules:\n  P -> P\n"
        );
        match (axiom, &system(&text).axiom) {
            ("first", Axiom::PatchSystem { name, span }) => {
                assert_eq!((name.as_str(), &text[span.range()]), ("first", "first"))
            }
            (_, Axiom::Patches(starts)) => assert_eq!(starts.len(), 1),
            (_, axiom) => panic!("{axiom:?}"),
        }
    }
}
