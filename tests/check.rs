//! The checker: examples, refusals, types, folding, lowering, and the table of operations.
use burgeon::language::check::code;
use burgeon::language::diagnostic::render;
use burgeon::language::eval::{apply, eval};
use burgeon::language::expr::{Expr, ExprKind};
use burgeon::language::ops::{self, Cpu, Mismatch};
use burgeon::language::rational::Rational;
use burgeon::language::syntax;
use burgeon::language::system::{
    Axiom, BinderPlace, Block, Cell, CurveWord, Kind, Module, PatchSource, Rule, Step, StepKind, Successor,
    UniformKind,
};
use burgeon::language::{Checked, Severity, Span, System, Type, Value, Vocabulary, check, compile};
use std::path::PathBuf;

/// The findings as a user would read them, for the messages of failed tests.
pub fn shown(text: &str, checked: &Checked) -> String {
    let place = |start: u32| {
        let before = &text[..start as usize];
        let line = before.matches('\n').count() + 1;
        format!("{line}:{}", before.len() - before.rfind('\n').map_or(0, |i| i + 1) + 1)
    };
    let mut out = String::new();
    for d in &checked.diagnostics {
        out += &format!("{} {}: {}", place(d.span.start), d.code, d.message);
        for (span, label) in &d.labels {
            out += &format!(" [{} {label}]", place(span.start));
        }
        if let Some(hint) = &d.hint {
            out += &format!(" ({hint})");
        }
        out += "\n";
    }
    out
}

pub fn checked(text: &str) -> Checked {
    compile(text, &Vocabulary::default())
}

/// The one system of a text that has no errors.
pub fn system(text: &str) -> System {
    let checked = checked(text);
    assert!(!checked.has_errors(), "{}", shown(text, &checked));
    checked.systems.into_iter().next_back().unwrap()
}

pub fn files(folder: &str) -> Vec<(PathBuf, String)> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    files.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

#[test]
fn examples_check() {
    for (path, text) in files("tests/data/language") {
        let checked = checked(&text);
        if std::env::var_os("SHOW_FINDINGS").is_some() {
            println!("{}\n{}", path.display(), shown(&text, &checked));
        }
        assert!(!checked.has_errors(), "{}\n{}", path.display(), shown(&text, &checked));
        assert_eq!(checked.systems.len(), text.lines().filter(|l| l.starts_with("system ")).count());
    }
}

#[test]
fn severities_follow_codes() {
    for (_, text) in files("tests/data/language") {
        for d in checked(&text).diagnostics {
            assert_eq!(d.severity == Severity::Warning, d.code.starts_with('W'), "{d:?}");
        }
    }
}

/// The code in the first line of a file: `// E0202 why`.
fn expected_code(text: &str) -> &str {
    text.strip_prefix("// ").and_then(|t| t.get(..5)).unwrap()
}

#[test]
fn refused_files_are_refused_with_their_code() {
    let mut wrong = String::new();
    for (path, text) in files("tests/data/refused") {
        let checked = checked(&text);
        let errors: Vec<&str> =
            checked.diagnostics.iter().filter(|d| d.severity == Severity::Error).map(|d| d.code).collect();
        if std::env::var_os("SHOW_FINDINGS").is_some() {
            println!("{}\n{}", path.display(), render(&checked.diagnostics, "it", &text, false));
        }
        if errors != [expected_code(&text)] {
            wrong += &format!("{}\n{}\n", path.display(), shown(&text, &checked));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn warned_files_are_warned_of_with_their_code() {
    let mut wrong = String::new();
    for (path, text) in files("tests/data/warned") {
        let checked = checked(&text);
        let found: Vec<&str> = checked.diagnostics.iter().map(|d| d.code).collect();
        if std::env::var_os("SHOW_FINDINGS").is_some() {
            println!("{}\n{}", path.display(), render(&checked.diagnostics, "it", &text, false));
        }
        if found != [expected_code(&text)] || checked.systems.is_empty() {
            wrong += &format!("{}\n{}\n", path.display(), shown(&text, &checked));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn every_code_has_a_file() {
    let mut wanted = std::collections::BTreeSet::new();
    for line in include_str!("../src/language/check/code.rs").lines() {
        if let Some(code) = line.split('"').nth(1) {
            wanted.insert(code.to_string());
        }
    }
    for folder in ["tests/data/refused", "tests/data/warned"] {
        for (_, text) in files(folder) {
            wanted.remove(expected_code(&text));
        }
    }
    // Trees that the parser never makes, or that are too long for a file.
    let elsewhere = ["E0201", "E0229", "E0268", "E0272"];
    assert!(wanted.iter().eq(elsewhere.iter()), "{wanted:?}");
}

// Expressions.

/// The value of a constant expression.
fn folded(expr: &str) -> Value {
    let system = system(&format!("system s : mesh\nparam x = {expr}\n"));
    match &system.uniforms[0].kind {
        UniformKind::Param { default, .. } => default.clone(),
        kind => panic!("{kind:?}"),
    }
}

#[test]
fn numerals_are_exact_until_a_type_is_asked() {
    assert_eq!(folded("6/2"), Value::Int(3));
    assert_eq!(folded("1/3"), Value::Float(1.0 / 3.0));
    assert_eq!(folded("1/3 + 1/3 + 1/3"), Value::Int(1));
    assert_eq!(folded("1/16"), Value::Float(0.0625));
    assert_eq!(folded("0.1 + 0.2"), Value::Float(0.3));
    assert_eq!(folded("10.0"), Value::Int(10));
    assert_eq!(folded("-2147483648"), Value::Int(i32::MIN));
    assert_eq!(folded("7 % 3 - 7/2"), Value::Float(-2.5));
    assert_eq!(folded("1/3 < 0.3334"), Value::Bool(true));
    assert_eq!(folded("1e-20 * 1e-18"), Value::Float(1e-38));
    assert_eq!(folded("16777217 * 1/1 + 1/2"), Value::Float(16777218.0));
    assert_eq!(folded("(1, 1/2, 2)"), Value::Vec3([1.0, 0.5, 2.0]));
    assert_eq!(folded("float(1)"), Value::Float(1.0));
    assert_eq!(folded("int(7/2)"), Value::Int(3));
}

#[test]
fn rationals_round_correctly() {
    // Against the same quotient of numbers that f64 holds exactly, rounded once more; quotients of
    // 24-bit numbers are never so near a tie that this matters.
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as i128
    };
    for _ in 0..100_000 {
        let (n, d) = (next() - (1 << 23), next() + 1);
        let exact = Rational::new(n, d).and_then(Rational::to_f32);
        assert_eq!(exact, Some((n as f64 / d as f64) as f32), "{n}/{d}");
    }
    let tie = |n: i128, d: i128| Rational::new(n, d).and_then(Rational::to_f32);
    assert_eq!(tie((1 << 24) + 1, 1), Some(16777216.0));
    assert_eq!(tie((1 << 24) + 3, 1), Some(16777220.0));
    assert_eq!(tie((1 << 25) + 3, 2), Some(16777218.0));
    assert_eq!(tie(i128::MAX, 1), Some(2f32.powi(127)));
    assert_eq!(tie(1, i128::MAX), Some(2f32.powi(-127)));
    assert_eq!(tie(0, 5), Some(0.0));
    for x in [1.5f32, -0.1, 1e-30, 3e37, f32::MIN_POSITIVE] {
        assert_eq!(Rational::from_f32(x).and_then(Rational::to_f32), Some(x), "{x}");
    }
}

#[test]
fn numerals_read_as_rust_reads_them() {
    for text in
        ["0", "1", "007", "3.25", "0.1", "1e3", "1.5e-7", "2E+5", "123456789.123456789", "1e-38", "0.000"]
    {
        let exact = Rational::parse(text).and_then(Rational::to_f32);
        assert_eq!(exact, Some(text.parse().unwrap()), "{text}");
    }
    assert_eq!(Rational::parse("1e99"), None);
    assert_eq!(Rational::parse("x"), None);
}

#[test]
fn ints_wrap_and_divide_as_wgsl_says() {
    let through = |expr: &str| folded_int(&format!("a = {expr}"));
    assert_eq!(through("big + 1"), i32::MIN);
    assert_eq!(through("-small"), i32::MIN);
    assert_eq!(through("small / minus"), i32::MIN);
    assert_eq!(through("small % minus"), 0);
    assert_eq!(through("five / zero"), 5);
    assert_eq!(through("five % zero"), 0);
    assert_eq!(through("-five / 2"), -2);
    assert_eq!(through("-five % 3"), -2);
    assert_eq!(through("abs(small)"), i32::MIN);
    assert_eq!(through("int(3.0e9 * float(five))"), 2147483520);
}

/// The value of a const through other consts, which are no numerals.
fn folded_int(declaration: &str) -> i32 {
    let consts = "const big = 2147483647\nconst small = -2147483648\nconst minus = -1\nconst zero = 0\nconst five = 5\n";
    let text = format!("system s : mesh\n{consts}const {declaration}\nparam p: int = a\n");
    match &system(&text).uniforms[0].kind {
        UniformKind::Param { default: Value::Int(i), .. } => *i,
        kind => panic!("{kind:?}"),
    }
}

#[test]
fn constants_fold_on_the_host() {
    assert_eq!(folded("sqrt(9/4)"), Value::Float(1.5));
    assert_eq!(folded("cross((1, 0, 0), (0, 1, 0))"), Value::Vec3([0.0, 0.0, 1.0]));
    assert_eq!(folded("dot((1, 2), (3, 4)) + length((3, 4))"), Value::Float(16.0));
    assert_eq!(folded("2 * (1, 2) + 1"), Value::Vec2([3.0, 5.0]));
    assert_eq!(folded("normalize((0, 3, 0)).y"), Value::Float(1.0));
    assert_eq!(folded("if(1 < 2, (1, 0), (0, 1))"), Value::Vec2([1.0, 0.0]));
    assert_eq!(folded("clamp(5, 0, 3) + min(1, 2)"), Value::Int(4));
    assert_eq!(folded("smoothstep(0, 1, 0.5)"), Value::Float(0.5));
    assert_eq!(folded("[1, 2.5, 3][1]"), Value::Float(2.5));
    assert_eq!(folded("[[1, 2], [3, 4]][1][0]"), Value::Int(3));
    let turned = folded("rotate((1, 0, 0), (0, 0, 1), 90)");
    let Value::Vec3([x, y, z]) = turned else { panic!("{turned:?}") };
    assert!(x.abs() < 1e-6 && (y - 1.0).abs() < 1e-6 && z == 0.0);
    let Value::Float(sine) = folded("sin(pi / 6)") else { panic!() };
    assert!((sine - 0.5).abs() < 1e-6);
}

/// The type of an expression over binders of a rule.
fn type_of(expr: &str) -> Type {
    let text = format!(
        "system s : curve\nmodule A(b: bool, i: int, x: float, u: vec2, v: vec3, w: vec4)\nmodule B\nrules:\n  \
         A(b, i, x, u, v, w) let e = {expr} -> B\n"
    );
    system(&text).groups[0].rules[0].lets[0].value.ty.clone()
}

#[test]
fn types_of_expressions() {
    for (expr, ty) in [
        ("i + 1", Type::Int),
        ("i + 0.5", Type::Float),
        ("i * x", Type::Float),
        ("i / 2", Type::Int),
        ("2 * v", Type::Vec3),
        ("v + 1", Type::Vec3),
        ("u * u", Type::Vec2),
        ("i * u / 3", Type::Vec2),
        ("-w", Type::Vec4),
        ("i < x", Type::Bool),
        ("!b || i == 2", Type::Bool),
        ("if(b, 1, 0.5)", Type::Float),
        ("if(b, i, 2)", Type::Int),
        ("if(b, v, (0, 0, i))", Type::Vec3),
        ("max(i, 0)", Type::Int),
        ("max(i, 0.5)", Type::Float),
        ("length(v) * i", Type::Float),
        ("v.z", Type::Float),
        ("(i, x)", Type::Vec2),
        ("[1, 2, 3][i]", Type::Int),
        ("[(1, 2), (3, 4)][i]", Type::Vec2),
        ("[[1, 2], [3, 4.5]][i][i + 1]", Type::Float),
        ("rand(i, 2)", Type::Float),
        ("randn() + step", Type::Float),
        ("noise(v)", Type::Float),
        ("mix(u, (1, 1), x)", Type::Vec2),
        ("int(x) % 2", Type::Int),
        ("int(b)", Type::Int),
    ] {
        assert_eq!(type_of(expr), ty, "{expr}");
    }
}

#[test]
fn sites_count_calls_in_the_order_of_the_text() {
    let text = "system s : patch bezier 1\nmodule P(x: float)\nrules:\n  \
                P(x) let a = rand(rand(), 2) : randn() > a ->(rand()) P(rand()) ->(1) [ P(x) | P(rand()) ]\n";
    let system = system(text);
    let rule = &system.groups[0].rules[0];
    let mut sites = Vec::new();
    let mut visit = |e: &Expr| {
        if let ExprKind::Random { site, .. } = &e.kind {
            sites.push(*site);
        }
    };
    rule.lets[0].value.walk(&mut visit);
    rule.condition.as_ref().unwrap().walk(&mut visit);
    for alternative in &rule.alternatives {
        alternative.weight.as_ref().unwrap().walk(&mut visit);
        match &alternative.successor {
            Successor::Relabel(module) => module.args[0].walk(&mut visit),
            Successor::Split(block) => block.cells.iter().for_each(|cell| match cell {
                Cell::Module(module) => module.args[0].walk(&mut visit),
                _ => unreachable!(),
            }),
            _ => unreachable!(),
        }
    }
    assert_eq!(sites, [0, 1, 2, 3, 4, 5]);
}

// Lowering.

/// An expression with its parentheses, binders as `b0`, uniforms as `u0`, lets as `l0`.
pub fn written(expr: &Expr) -> String {
    let all = |args: &[Expr]| args.iter().map(written).collect::<Vec<_>>().join(", ");
    match &expr.kind {
        ExprKind::Literal(Value::Int(i)) => i.to_string(),
        ExprKind::Literal(Value::Float(x)) => format!("{x:?}"),
        ExprKind::Literal(value) => format!("{value:?}"),
        ExprKind::Binder(i) => format!("b{i}"),
        ExprKind::Let(i) => format!("l{i}"),
        ExprKind::Uniform(i) => format!("u{i}"),
        ExprKind::Attribute(name) => name.to_string(),
        ExprKind::Call(op, args) => match (op.row().name, args.as_slice()) {
            (name, [a, b]) if op.row().is_operator() => format!("({} {name} {})", written(a), written(b)),
            (name, args) => format!("{name}({})", all(args)),
        },
        ExprKind::Component(base, i) => format!("{}.{i}", written(base)),
        ExprKind::Vector(args) => format!("({})", all(args)),
        ExprKind::Element(_, index) => format!("list[{}]", written(index)),
        ExprKind::Random { function, args, .. } => format!("{function}({})", all(args)),
        ExprKind::OfRoot(q) => format!("r{q}"),
        ExprKind::Sample(i, point) => format!("q{i}({})", written(point)),
    }
}

/// A successor as text: `[P((b0 + 1)) eps; eps P((b0 + 1))]`.
fn successor(system: &System, successor: &Successor) -> String {
    let module = |m: &Module| {
        let args: Vec<String> = m.args.iter().map(written).collect();
        let name = &system.symbols[m.symbol].name;
        if args.is_empty() { name.clone() } else { format!("{name}({})", args.join(", ")) }
    };
    fn block(b: &Block, module: &dyn Fn(&Module) -> String) -> String {
        let cell = |c: &Cell| match c {
            Cell::Eps => "eps".into(),
            Cell::Module(m) => module(m),
            Cell::Block(b) => block(b, module),
        };
        assert_eq!(b.cells.len(), b.rows * b.columns);
        let rows: Vec<String> =
            b.cells.chunks(b.columns).map(|row| row.iter().map(cell).collect::<Vec<_>>().join(" ")).collect();
        format!("[{}]", rows.join("; "))
    }
    match successor {
        Successor::Erase => "eps".into(),
        Successor::Relabel(m) => module(m),
        Successor::Split(b) => block(b, &module),
        Successor::Word(CurveWord { modules, .. }) => {
            modules.iter().map(module).collect::<Vec<_>>().join(" ")
        }
        Successor::Surface(_) | Successor::Face(_) => panic!("neither a word nor a block"),
    }
}

/// The rules of a group as text: `P [tests] : condition -> successor`.
fn rules(system: &System, group: usize) -> Vec<String> {
    let lowered = |rule: &Rule| {
        let strict: Vec<&str> = rule.strict.iter().map(|s| system.symbols[*s].name.as_str()).collect();
        let mut text = strict.join(" ");
        for test in &rule.tests {
            text += &format!(" [{}]", written(test));
        }
        for l in &rule.lets {
            text += &format!(" let {} = {}", l.name, written(&l.value));
        }
        if let Some(condition) = &rule.condition {
            text += &format!(" : {}", written(condition));
        }
        for alternative in &rule.alternatives {
            text += " ->";
            if let Some(weight) = &alternative.weight {
                text += &format!("({})", written(weight));
            }
            text += &format!(" {}", successor(system, &alternative.successor));
        }
        text
    };
    system.groups[group].rules.iter().map(lowered).collect()
}

#[test]
fn holes_are_lowered() {
    let system = system(include_str!("data/language/holes.burgeon"));
    assert_eq!(system.kind, Kind::Patch { degree: [3, 3], rational: false, join: None });
    assert!(system.uniforms.is_empty());
    let split = "P : (b0 < 3) -> [P((b0 + 1)) P((b0 + 1)); P((b0 + 1)) P((b0 + 1))]";
    assert_eq!(rules(&system, 0), [split, "P : (b0 == 3) -> [P((b0 + 1)) eps; eps P((b0 + 1))]"]);
    assert_eq!(system.groups[0].rules[1].label.as_deref(), Some("p2"));
    let Axiom::Patches(starts) = &system.axiom else { panic!() };
    assert_eq!(written(&starts[0].args[0]), "0");
    assert!(matches!(&starts[0].source, PatchSource::File { path, index: None, .. } if path == "sheet.bpt"));
    let StepKind::Derive { count, until_terminal: true, groups } = &system.run[0].kind else { panic!() };
    assert_eq!((written(count), groups.as_slice()), ("8".into(), &[0][..]));
}

#[test]
fn sierpinski_is_lowered() {
    let system = system(include_str!("data/language/sierpinski2.burgeon"));
    let names: Vec<&str> = system.symbols.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["P", "Q", "A", "B", "C", "D", "A2", "B2", "C2", "D2"]);
    let expected = [
        "P -> [A B; C D]",
        "A -> [A eps; A A]",
        "B -> eps",
        "C -> [C eps; C C]",
        "D -> [D eps; D D]",
        "Q -> [A2 B2; C2 D2]",
        "A2 -> [A2 A2; eps A2]",
        "B2 -> [B2 B2; eps B2]",
        "C2 -> eps",
        "D2 -> [D2 D2; eps D2]",
    ];
    assert_eq!(rules(&system, 0), expected);
    let Axiom::Patches(starts) = &system.axiom else { panic!() };
    assert_eq!(starts.iter().map(|s| s.symbol).collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn the_adaptive_patch_is_lowered() {
    let system = system(include_str!("data/language/adaptive.burgeon"));
    let uniforms: Vec<(&str, &Type)> = system.uniforms.iter().map(|u| (u.name.as_str(), &u.ty)).collect();
    assert_eq!(uniforms, [("eps_dist", &Type::Float), ("eye", &Type::Vec3)]);
    assert_eq!(written(system.queries[0].value.as_ref().unwrap()), "distance(u1, centroid)");
    assert_eq!(written(system.queries[1].value.as_ref().unwrap()), "flatness");
    let split = "-> [P((b1 + 1)) P((b1 + 1)); P((b1 + 1)) P((b1 + 1))]";
    assert_eq!(rules(&system, 0), [format!("P : ((b0 <= u0) && (b1 < 7)) {split}")]);
    assert_eq!(rules(&system, 1), [format!("P : ((b0 > 0.001) && (b1 < 7)) {split}")]);
    let rule = &system.groups[1].rules[0];
    assert_eq!(rule.queries[0].query, 1);
    let places: Vec<BinderPlace> = rule.binders.iter().map(|b| b.place).collect();
    assert_eq!(places, [BinderPlace::Query(0), BinderPlace::Strict { module: 0, field: 0 }]);
    let StepKind::Derive { groups, .. } = &system.run[0].kind else { panic!() };
    assert_eq!(groups, &[1]);
}

#[test]
fn patterns_test_literals_and_names_bound_twice() {
    let text = "system s : patch bezier 2 1 rational\nmodule P(a: int, b: int, c: bool, d: vec2, e: vec2)\nmodule Q\n\
                rules:\n  P(3, _, true, d, d) -> Q\n  P(a, a, _, (0), _) -> Q\n";
    let text = text.replace("  P(a, a, _, (0), _) -> Q\n", "  P(a, a, _, _, _) -> Q\n");
    let system = system(&text);
    assert_eq!(system.kind, Kind::Patch { degree: [2, 1], rational: true, join: None });
    assert_eq!(
        rules(&system, 0),
        ["P [(3 == b0)] [(Bool(true) == b1)] [(b2.0 == b3.0)] [(b2.1 == b3.1)] -> Q", "P [(b0 == b1)] -> Q",]
    );
    let fields: Vec<BinderPlace> = system.groups[0].rules[0].binders.iter().map(|b| b.place).collect();
    let strict = |field| BinderPlace::Strict { module: 0, field };
    assert_eq!(fields, [strict(0), strict(2), strict(3), strict(4)]);
}

#[test]
fn alternatives_relabel_erase_and_nest() {
    let text = "system s : patch bezier 1\nparam k: int = 2\nconst twice = 2 * k\nmodule P(x: float), Q\n\
                axiom: P(k) = [[(0,0,0), (1,0,0)], [(0,0,1), (1,0,1)]]\n\
                rules:\n  P(x) let a = x / 2 : a > twice\n    ->(k) Q\n    ->(1/3) eps\n    ->(0.5) [ Q | [ P(1) ; P(a) ] ]\n";
    let system = system(text);
    assert_eq!(
        rules(&system, 0),
        [
            "P let a = (b0 / 2.0) : (l0 > float(u1)) ->(float(u0)) Q ->(0.33333334) eps ->(0.5) [Q [P(1.0); P(l0)]]"
        ]
    );
    assert!(matches!(&system.uniforms[1].kind, UniformKind::Derived(e) if written(e) == "(2 * u0)"));
    let Axiom::Patches(starts) = &system.axiom else { panic!() };
    assert_eq!(written(&starts[0].args[0]), "float(u0)");
    let PatchSource::Inline { points, .. } = &starts[0].source else { panic!() };
    assert_eq!(points[2], [0.0, 0.0, 1.0, 1.0]);
    // Without `run:` one step of the unnamed group.
    let [Step { kind: StepKind::Derive { count, until_terminal: false, groups }, .. }] =
        system.run.as_slice()
    else {
        panic!()
    };
    assert_eq!((written(count), groups.as_slice()), ("1".into(), &[0][..]));
}

#[test]
fn the_run_keeps_its_loops_and_conditions() {
    let text = "system s : patch bezier 1\nparam n: int = 2\nmodule P(l: int)\nrules a:\n  P(l) -> [ P(l) | P(l) ]\n\
                rules b:\n  P(0) -> P(1)\nrun:\n  repeat n + 1 {\n    derive n with b, a\n  }\n  if detail >= 1 {\n    derive until terminal max 9 with a\n  }\n";
    let system = system(text);
    let StepKind::Repeat { count, body } = &system.run[0].kind else { panic!() };
    assert_eq!(written(count), "(u0 + 1)");
    let StepKind::Derive { groups, .. } = &body[0].kind else { panic!() };
    assert_eq!(groups, &[1, 0]);
    let StepKind::If { condition, .. } = &system.run[1].kind else { panic!() };
    assert_eq!(written(condition), "(u1 >= 1)");
    assert_eq!(system.uniforms[1].name, "detail");
    let values: Vec<Value> = [4, 0].map(Value::Int).to_vec();
    assert_eq!(eval(count, &values), Ok(Value::Int(5)));
    assert_eq!(eval(condition, &values), Ok(Value::Bool(false)));
}

#[test]
fn curves_are_lowered_to_words() {
    let text = "system s : curve tree\nparam angle = 30\nmodule A(n: int)\nrules:\n  F A(n) < A(n) > [ F ] A(m) # -> F [ + A(n - 1) ] | F(2)\n";
    let system = system(text);
    let names: Vec<&str> = system.symbols.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["A", "F", "+", "|"]);
    let rule = &system.groups[0].rules[0];
    assert_eq!(
        rules(&system, 0),
        ["A [(b0 == b1)] -> F(1.0) +(float(u0)) A((b1 - 1)) |(180.0) F(2.0)".replace("A((b1", "A((b0")]
    );
    assert_eq!(rule.left.as_ref().unwrap().symbols, [1, 0]);
    let right = rule.right.as_ref().unwrap();
    assert_eq!((right.symbols.as_slice(), right.end), (&[1, 0][..], true));
    assert_eq!(rule.binders[0].place, BinderPlace::Left { module: 1, field: 0 });
    assert_eq!(rule.binders[2].place, BinderPlace::Right { module: 1, field: 0 });
}

#[test]
fn shared_constants_reach_the_systems_below() {
    let text = "param tol: float = 1/100\nconst wide = 2 * tol\nsystem a : patch bezier 1\nmodule P(x: float)\nrules:\n  \
                P(x) : x > wide -> eps\nsystem b : patch bezier 1\nmodule P(x: float)\nrules:\n  P(x) -> eps\n";
    let checked = checked(text);
    let names = |i: usize| checked.systems[i].uniforms.iter().map(|u| u.name.as_str()).collect::<Vec<_>>();
    assert_eq!(names(0), ["tol", "wide"]);
    assert!(names(1).is_empty(), "only what a system reads");
    assert!(checked.diagnostics.is_empty(), "{}", shown(text, &checked));
}

#[test]
fn a_broken_system_leaves_the_others() {
    let text = "const k = [1, 2][5]\nsystem a : patch bezier 1\nmodule P(x: float)\nrules:\n  P(x) : x > k -> eps\n\
                system b : patch bezier 1\nmodule P(x: float)\nrules:\n  P(x) -> eps\n";
    let checked = checked(text);
    assert_eq!(checked.diagnostics.len(), 1, "{}", shown(text, &checked));
    assert_eq!(checked.systems.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["b"]);
}

#[test]
fn findings_are_marked_where_they_are() {
    let text = "system s : patch bezier 1\nmodule P(l: int)\nrules:\n  P(l) : l > limmit -> eps\n";
    let checked = checked(text);
    let d = &checked.diagnostics[0];
    assert_eq!(&text[d.span.range()], "limmit");
    let text = text.replace("limmit", "limt").replace("module", "const limit = 3\nmodule");
    let checked = compile(&text, &Vocabulary::default());
    let hints: Vec<_> = checked.diagnostics.iter().filter_map(|d| d.hint.as_deref()).collect();
    assert_eq!(hints, ["did you mean `limit`?"]);
}

// Robustness.

#[test]
fn long_chains_of_consts_neither_recurse_nor_take_long() {
    let mut text = String::from("system s : patch bezier 1\nmodule P(l: int)\n");
    for i in 0..20_000 {
        text += &format!("const c{i} = c{} + 1\n", i + 1);
    }
    text += "const c20000 = 1\nrules:\n  P(l) : l < c0 -> eps\n";
    let system = system(&text);
    assert_eq!(rules(&system, 0), ["P : (b0 < 20001) -> eps"]);
}

#[test]
fn many_rules_are_checked_quickly() {
    let mut text =
        String::from("system s : patch bezier 3\nmodule P(l: int, x: float)\nparam k = 3\nrules:\n");
    for i in 0..4096 {
        text += &format!("  P({i}, x) : x * 2 + k > {i} -> [ P(x, x) P({i} + 1, x / 3) ; P(1, x) eps ]\n")
            .replace("P(x, x)", "P(2, x)");
    }
    let parsed = burgeon::language::parse(&text);
    assert!(parsed.diagnostics.is_empty());
    let begin = std::time::Instant::now();
    let checked = check(&parsed.file, &Vocabulary::default());
    let took = begin.elapsed();
    assert!(!checked.has_errors());
    assert_eq!(checked.systems[0].groups[0].rules.len(), 4096);
    println!("4,096 rules in {took:?}");
    assert!(took.as_secs() < 5);
    let mut more = parsed.file.clone();
    for item in &mut more.items {
        let syntax::FileItem::System(system) = item else { continue };
        for item in &mut system.items {
            if let syntax::Item::Rules(rules) = item {
                rules.rules.push(rules.rules[0].clone());
            }
        }
    }
    let codes: Vec<&str> = check(&more, &Vocabulary::default()).diagnostics.iter().map(|d| d.code).collect();
    assert_eq!(codes, [code::TOO_MANY_RULES]);
}

#[test]
fn trees_that_the_parser_never_makes_are_refused() {
    let mut file = burgeon::language::parse(
        "system s : patch bezier 1\nmodule P(l: int)\nconst c = 1\nrules:\n  P(l) : l < c -> P(l)\n",
    )
    .file;
    let syntax::FileItem::System(system) = &mut file.items[0] else { panic!() };
    for item in &mut system.items {
        match item {
            syntax::Item::Const(c) => {
                for _ in 0..600 {
                    let kind = syntax::ExprKind::Unary(syntax::UnaryOp::Neg, Box::new(c.value.clone()));
                    c.value = syntax::Expr { kind, span: Span::default() };
                }
            }
            syntax::Item::Rules(rules) => {
                let syntax::Successor::Word(word) = &mut rules.rules[0].alternatives[0].successor else {
                    panic!()
                };
                let syntax::Element::Module(used) = &mut word[0] else { panic!() };
                used.symbol.text = "R".into();
            }
            _ => {}
        }
    }
    let mut codes: Vec<&str> =
        check(&file, &Vocabulary::default()).diagnostics.iter().map(|d| d.code).collect();
    codes.sort_unstable();
    assert_eq!(codes, [code::UNKNOWN_MODULE, code::TOO_DEEP]);
}

#[test]
fn mangled_examples_never_panic() {
    let mut state = 7u64;
    let mut next = |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    for (_, text) in files("tests/data/language") {
        let words: Vec<&str> = text.split_inclusive([' ', '\n', '(', ')', ',']).collect();
        for _ in 0..60 {
            let mut mangled = words.clone();
            for _ in 0..1 + next(3) {
                let (a, b) = (next(mangled.len()), next(mangled.len()));
                match next(3) {
                    0 => mangled.swap(a, b),
                    1 => _ = mangled.remove(a),
                    _ => mangled.insert(a, words[b % words.len()]),
                }
            }
            let checked = checked(&mangled.concat());
            for d in &checked.diagnostics {
                assert!(!d.message.is_empty());
            }
        }
    }
}

// The table of operations.

const INTS: [i32; 15] =
    [0, 1, -1, 2, -2, 3, 7, -7, 31, 65_536, 1_000_003, i32::MAX, i32::MIN, i32::MIN + 1, i32::MAX - 1];
const FLOATS: [f32; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    1.5,
    2.5,
    -2.5,
    3.0,
    1e-40,
    -1e-40,
    1e30,
    -1e30,
    16777217.0,
    0.1,
    2147483648.0,
    -2147483904.0,
    f32::INFINITY,
    f32::NEG_INFINITY,
];

fn samples(ty: &Type) -> Vec<u32> {
    match ty {
        Type::Bool => vec![0, 1],
        Type::Int => INTS.iter().map(|i| *i as u32).collect(),
        _ => FLOATS.iter().map(|x| x.to_bits()).collect(),
    }
}

/// What a row should give, computed in i64 or f64; no value where the language fixes none.
fn reference(row: &ops::Row, args: &[u32]) -> Option<Value> {
    let wrap = |x: i64| Some(Value::Int(x as i32));
    let float = |x: f64| (!x.is_nan()).then_some(Value::Float(x as f32));
    let b = |i: usize| args[i] != 0;
    let n = |i: usize| args[i] as i32 as i64;
    let x = |i: usize| f32::from_bits(args[i]) as f64;
    let ty = row.args.last().unwrap();
    Some(Value::Bool(match (row.name, ty) {
        ("||", _) => b(0) || b(1),
        ("&&", _) => b(0) && b(1),
        ("!", _) => !b(0),
        ("==", Type::Float) => x(0) == x(1),
        ("!=", Type::Float) => x(0) != x(1),
        ("==", _) => n(0) == n(1),
        ("!=", _) => n(0) != n(1),
        ("<", Type::Int) => n(0) < n(1),
        ("<=", Type::Int) => n(0) <= n(1),
        (">", Type::Int) => n(0) > n(1),
        (">=", Type::Int) => n(0) >= n(1),
        ("<", _) => x(0) < x(1),
        ("<=", _) => x(0) <= x(1),
        (">", _) => x(0) > x(1),
        (">=", _) => x(0) >= x(1),
        ("+", Type::Int) => return wrap(n(0) + n(1)),
        ("-", Type::Int) if args.len() == 1 => return wrap(-n(0)),
        ("-", Type::Int) => return wrap(n(0) - n(1)),
        ("*", Type::Int) => return wrap(n(0) * n(1)),
        ("/", Type::Int) => return wrap(if n(1) == 0 { n(0) } else { n(0) / n(1) }),
        ("%", Type::Int) => return wrap(if n(1) == 0 { 0 } else { n(0) % n(1) }),
        ("+", _) => return float(x(0) + x(1)),
        ("-", _) if args.len() == 1 => return float(-x(0)),
        ("-", _) => return float(x(0) - x(1)),
        ("*", _) => return float(x(0) * x(1)),
        ("/", _) => return float(x(0) / x(1)),
        ("int", Type::Float) => return wrap(x(0).trunc().clamp(-2147483648.0, 2147483520.0) as i64),
        ("int", Type::Bool) => return wrap(b(0) as i64),
        ("int", _) => return wrap(n(0)),
        ("float", Type::Int) => return float(n(0) as f64),
        ("float", Type::Bool) => return float(b(0) as i32 as f64),
        ("float", _) => return float(x(0)),
        ("if", _) => return Some(Value::from_words(&row.result, &[if b(0) { args[1] } else { args[2] }])),
        ("abs", Type::Int) => return wrap(n(0).abs()),
        ("sign", Type::Int) => return wrap(n(0).signum()),
        ("min", Type::Int) => return wrap(n(0).min(n(1))),
        ("max", Type::Int) => return wrap(n(0).max(n(1))),
        ("clamp", Type::Int) => return wrap(n(0).max(n(1)).min(n(2))),
        ("abs", _) => return float(x(0).abs()),
        ("sign", _) => return float(if x(0) == 0.0 { 0.0 } else { x(0).signum() }),
        ("min", _) => return float(x(0).min(x(1))),
        ("max", _) => return float(x(0).max(x(1))),
        ("clamp", _) => return float(x(0).max(x(1)).min(x(2))),
        ("floor", _) => return float(x(0).floor()),
        ("ceil", _) => return float(x(0).ceil()),
        ("trunc", _) => return float(x(0).trunc()),
        ("round", _) => return float((x(0) / 2.0).round_ties_even().mul_add(2.0, nearest_rest(x(0)))),
        ("sqrt", _) => return float(x(0).sqrt()),
        ("radians", _) => return Some(Value::Float(f32::from_bits(args[0]) * 0.017453292)),
        ("degrees", _) => return Some(Value::Float(f32::from_bits(args[0]) * 57.29578)),
        ("step", _) => return float(if x(1) < x(0) { 0.0 } else { 1.0 }),
        // `tests/expressions.rs` holds these against the truth within their bounds.
        (name, _) if name.ends_with(" #") || ELEMENTARY.contains(&name) => return None,
        (name, ty) => panic!("no reference for {name} of {ty}"),
    }))
}

const ELEMENTARY: [&str; 12] =
    ["pow", "exp", "exp2", "log", "log2", "sin", "cos", "tan", "asin", "acos", "atan", "atan2"];

/// `round(x) - 2 * round(x / 2)`: x rounded to the nearest whole number by way of the nearest
/// even one, which x is at most 1 away from; a half goes back to the even one.
fn nearest_rest(x: f64) -> f64 {
    let even = (x / 2.0).round_ties_even() * 2.0;
    let rest = x - even;
    if rest > 0.5 {
        1.0
    } else if rest < -0.5 {
        -1.0
    } else {
        0.0
    }
}

#[test]
fn rows_agree_with_a_plain_reference() {
    for (index, row) in ops::TABLE.iter().enumerate() {
        let Some(cpu) = row.cpu else { continue };
        let mut cases: Vec<Vec<u32>> = vec![Vec::new()];
        for ty in row.args {
            cases = cases
                .iter()
                .flat_map(|case| samples(ty).into_iter().map(move |s| [case.as_slice(), &[s]].concat()))
                .collect();
        }
        let columns: Vec<Vec<u32>> =
            (0..row.args.len()).map(|i| cases.iter().map(|case| case[i]).collect()).collect();
        let mut out = vec![0; cases.len()];
        match cpu {
            Cpu::One(f) => f(&columns[0], &mut out),
            Cpu::Two(f) => f(&columns[0], &columns[1], &mut out),
            Cpu::Three(f) => f(&columns[0], &columns[1], &columns[2], &mut out),
        }
        for (case, word) in cases.iter().zip(&out) {
            let Some(expected) = reference(row, case) else { continue };
            let found = Value::from_words(&row.result, &[*word]);
            assert_eq!(found, expected, "{row} of {case:x?}");
            assert_eq!(cpu.word(case), Some(*word));
            let args: Vec<Value> =
                case.iter().zip(row.args).map(|(word, ty)| Value::from_words(ty, &[*word])).collect();
            assert_eq!(apply(ops::Op(index as u16), &args), Some(expected));
        }
    }
}

#[test]
fn rows_are_found_by_their_types() {
    for (index, row) in ops::TABLE.iter().enumerate() {
        assert_eq!(ops::find(row.name, row.args), Ok(ops::Op(index as u16)), "{row}");
        assert_eq!(row.cpu.is_some(), !row.wgsl.is_empty(), "{row}");
        assert_eq!(row.parameters.len(), row.args.len());
        assert!(row.doc.ends_with('.'), "{row}");
    }
    let row = |name, args: &[Type]| ops::find(name, args).map(|op| op.row().to_string());
    assert_eq!(row("min", &[Type::Int, Type::Float]).unwrap(), "min(a: float, b: float) -> float");
    assert_eq!(row("*", &[Type::Int, Type::Vec3]).unwrap(), "float * vec3 -> vec3");
    assert_eq!(row("-", &[Type::Bool]), Err(Mismatch::Types));
    assert_eq!(row("sin", &[]), Err(Mismatch::Arity));
    assert_eq!(row("sine", &[Type::Float]), Err(Mismatch::Name));
}

/// Each WGSL text as the body of a function, in one module that naga accepts. Some call functions
/// of wgsl/.
#[test]
fn wgsl_texts_are_valid() {
    let name = |ty: &Type| match ty {
        Type::Bool => "bool",
        Type::Int => "i32",
        _ => "f32",
    };
    let files = [
        include_str!("../wgsl/shared/numbers.wgsl"),
        include_str!("../wgsl/shared/elementary.wgsl"),
        include_str!("../wgsl/shared/ops.wgsl"),
    ];
    let mut text = files.concat().replace("import elementary;", "").replace("import numbers;", "");
    for (index, row) in ops::TABLE.iter().enumerate().filter(|(_, row)| row.cpu.is_some()) {
        let mut body = row.wgsl.to_string();
        let mut parameters = Vec::new();
        for (i, ty) in row.args.iter().enumerate() {
            assert_eq!(row.wgsl.matches(&format!("{{{i}}}")).count(), 1, "{row}");
            body = body.replace(&format!("{{{i}}}"), &format!("a{i}"));
            parameters.push(format!("a{i}: {}", name(ty)));
        }
        text += &format!(
            "fn row{index}({}) -> {} {{ return {body}; }}\n",
            parameters.join(", "),
            name(&row.result)
        );
    }
    let module =
        naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
    let (flags, capabilities) = (naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    naga::valid::Validator::new(flags, capabilities).validate(&module).unwrap();
}

#[test]
fn many_errors_are_found_quickly() {
    let mut text = String::from("system s : patch bezier 3\nmodule P(l: int)\n");
    for i in 0..4096 {
        text += &format!("const length_{i} = {i}\n");
    }
    text += "rules:\n";
    for i in 0..4096 {
        text += &format!("  P({i}) : lenght_x{i} > 0 -> P(1)\n");
    }
    let begin = std::time::Instant::now();
    assert_eq!(checked(&text).diagnostics.len(), 4096);
    let took = begin.elapsed();
    println!("4,096 errors in {took:?}");
    assert!(took.as_secs() < 20);
}

#[test]
fn points_without_a_place_get_the_two_ways_to_write_them() {
    for (modules, axiom, hints) in [
        ("P(v: vec2)", "P", &["write `P(_) = file \"x.svg\"`", "or `axiom: file \"x.svg\"` alone"][..]),
        ("Q(n: int, v: vec2)", "Q", &["write `Q(0, _) = file \"x.svg\"`, with `_` for the point"]),
        ("Q(n: int)", "Q", &["`module Q(v: vec2)`"]),
    ] {
        let checked =
            checked(&format!("system s : curve\nmodule {modules}\naxiom: {axiom} = file \"x.svg\"\n"));
        let [error] = checked.diagnostics.as_slice() else { panic!("{:?}", checked.diagnostics) };
        let hint = error.hint.clone().unwrap_or_default();
        assert!(error.code == "E0267" && hints.iter().all(|h| hint.contains(h)), "{error:?}");
        assert_eq!(hint.contains("alone"), hints.len() > 1, "{hint}");
    }
}
