//! Expressions: random ones from the table of operations, alike on CPU and GPU; elementary
//! functions against f64; the hash behind random numbers, frozen.

use crate::device;
use crate::oracle::expression::{Constants, Declaration, Scope, evaluate};
use crate::oracle::value::Value as OracleValue;
use crate::oracle::{self, Random};
use crate::parity::system;
use crate::tier;
use burgeon::conformance::elementary::FUNCTIONS;
use burgeon::conformance::systems::WRITTEN;
use burgeon::cpu::Cpu;
use burgeon::gpu::Gpu;
use burgeon::language::elementary;
use burgeon::language::ops::TABLE;
use burgeon::language::syntax::{AxiomKind, Element, FileItem, Item, Start, Successor};
use burgeon::language::{System, Type, Value};
use burgeon::patch::{Axiom, Net, Word};
use burgeon::plan::bound::{self, Known};
use burgeon::plan::compare::Pair;
use burgeon::plan::derive::{Backend, collect, derive};
use burgeon::plan::step::Clock;
use burgeon::plan::{Given, Options, Plan};
use std::fmt::Debug;

const INTS: [&str; 8] = ["-2147483648", "2147483647", "0", "-1", "7", "46341", "-65536", "1"];
const FLOATS: [&str; 8] = ["1.0", "-0.3", "0.37", "-7.25", "123.5", "0.1", "2.5", "-1.75"];

/// Functions of floats that are smooth everywhere.
const SMOOTH: [&str; 14] = [
    "+", "-", "*", "abs", "if", "dot", "length", "distance", "cross", "rotate", "sin", "cos", "atan",
    "radians",
];

/// A random expression of a type over the fields of P, from the rows of the table.
fn expression(random: &mut Random, ty: &Type, depth: usize) -> String {
    let row_of = |random: &mut Random| {
        // Floats go into ints and bools by leaves alone: NaN compares differently on devices.
        let fits = |args: &[Type]| *ty != Type::Int && *ty != Type::Bool || !args.iter().any(is_float);
        let rows: Vec<_> =
            TABLE.iter().filter(|r| r.result == *ty && fits(r.args) && named(r.name)).collect();
        (!rows.is_empty()).then(|| *random.pick(&rows))
    };
    let row = if depth == 0 { None } else { row_of(random) };
    let Some(row) = row else { return leaf(random, ty) };
    // What jumps, or has no value somewhere, takes leaves: rounding moves it by more than a rounding.
    let depth = if is_float(ty) && !SMOOTH.contains(&row.name) { 0 } else { depth - 1 };
    let args: Vec<String> = row.args.iter().map(|ty| expression(random, ty, depth)).collect();
    match args.as_slice() {
        [a] if row.is_operator() => format!("({}{a})", row.name),
        [a, b] if row.is_operator() => format!("({a} {} {b})", row.name),
        args => format!("{}({})", row.name, args.join(", ")),
    }
}

/// What a rule can name; `mix` of a value with itself is that value to some compilers, and 0 or
/// infinity by the sums and products that it stands for, so it is tested by itself.
fn named(name: &str) -> bool {
    !name.ends_with('#') && !name.ends_with(" *") && name != "mix"
}

fn is_float(ty: &Type) -> bool {
    !matches!(ty, Type::Int | Type::Bool)
}

fn leaf(random: &mut Random, ty: &Type) -> String {
    let float = |random: &mut Random| random.pick(&["x", "y", "(x*0.1)", "2.5", "(-1/3)"]).to_string();
    match ty {
        Type::Int => random.pick(&["a", "b", "3", "(-5)", "level", "step", "list[a]"]).to_string(),
        Type::Bool => random.pick(&["f", "true", "(x < y)", "(a == b)"]).to_string(),
        Type::Float => float(random),
        Type::Vec2 => format!("({}, {})", float(random), float(random)),
        Type::Vec3 => random.pick(&["p", "(x, y, 1.0)", "(p*0.3)"]).to_string(),
        _ => format!("({}, {}, x, 0.7)", float(random), float(random)),
    }
}

/// A system that works out expressions of every type over awkward numbers.
fn text(seed: u64) -> String {
    let mut random = Random::new(seed);
    let types =
        [Type::Int, Type::Int, Type::Bool, Type::Float, Type::Float, Type::Vec2, Type::Vec3, Type::Vec4];
    let values: Vec<String> = types.iter().map(|ty| expression(&mut random, ty, 3)).collect();
    let mut axiom = String::new();
    for _ in 0..12 {
        let int = |random: &mut Random| *random.pick(&INTS);
        let float = |random: &mut Random| *random.pick(&FLOATS);
        let (a, b) = (int(&mut random), int(&mut random));
        let (x, y, z) = (float(&mut random), float(&mut random), float(&mut random));
        let f = random.chance(50);
        axiom += &format!("\n  P({a}, {b}, {f}, {x}, {y}, ({x}, {z}, {y})) = file \"net.bpt\"");
    }
    format!(
        "system random : patch bezier 3\nconst list = [3, -7, 46341]\n\
         module P(a: int, b: int, f: bool, x: float, y: float, p: vec3)\n\
         module Q(i: int, j: int, g: bool, r: float, s: float, u: vec2, v: vec3, w: vec4)\n\
         axiom:{axiom}\nrules:\n  P(a, b, f, x, y, p) -> Q({})\n",
        values.join(",\n    ")
    )
}

fn word<B: Backend>(axiom: &Axiom, seed: u32, backend: &mut B) -> Word
where
    B::Error: Debug,
{
    let options = Options { seed: Some(seed), ..Options::default() };
    let derivation = derive(axiom, &options, backend).expect("a derivation");
    collect(backend, &derivation).expect("a word")
}

fn job(text: &str) -> (Plan, Axiom) {
    let system = system(text);
    let plan = Plan::new(&system).unwrap_or_else(|e| panic!("{e} in\n{text}"));
    let points = (0..16).map(|k| [(k / 4) as f32, (k * 5 % 7) as f32, (k % 4) as f32, 1.0]).collect();
    let net = Net { degree: [3, 3], points };
    (plan, Axiom::load::<String>(&system, &mut |_| Ok(vec![net.clone()])).expect("an axiom"))
}

#[test]
fn random_expressions_are_alike_on_cpu_and_gpu() {
    for (name, engine) in device::engines() {
        for seed in 0..tier::cases(6, 16) {
            let text = text(seed);
            let (plan, axiom) = job(&text);
            let gpu = Gpu::new(&engine, &plan).expect("kernels");
            let cpu = Cpu::new(&plan, 2).expect("threads");
            let mut pair = Pair::new(cpu, gpu, ["CPU", "GPU"]);
            let options = Options { seed: Some(1), ..Options::default() };
            let result = derive(&axiom, &options, &mut pair);
            if let Err(e) = result.and_then(|d| collect(&mut pair, &d)) {
                panic!("{name}: {e}\n{text}");
            }
        }
    }
}

/// The values of a text's axiom and of its rule's arguments in f64, by the oracle.
fn truth(text: &str) -> Vec<Vec<OracleValue>> {
    let file = oracle::parse(text);
    let FileItem::System(system) = &file.items[0] else { panic!("a system") };
    let list = system.items.iter().find_map(|i| if let Item::Const(c) = i { Some(c) } else { None });
    let none = Constants::default();
    let constants = none.extended(&[Declaration::Const(list.expect("a list"))], &[]);
    let attributes = |name: &str| matches!(name, "level" | "step").then_some(OracleValue::Int(0));
    let starts = system.items.iter().find_map(|item| match item {
        Item::Axiom(axiom) => match &axiom.kind {
            AxiomKind::Starts(starts) => Some(starts),
            _ => None,
        },
        _ => None,
    });
    let rule = system.items.iter().find_map(|i| if let Item::Rules(r) = i { r.rules.first() } else { None });
    let Successor::Word(word) = &rule.expect("a rule").alternatives[0].successor else { panic!("a word") };
    let [Element::Module(successor)] = word.as_slice() else { panic!("a module") };
    let of_start = |start: &Start| {
        let free = Scope { bound: Vec::new(), constants: &constants, attributes: &attributes, random: None };
        let names = ["a", "b", "f", "x", "y", "p"].iter().map(|n| n.to_string());
        let types = ["int", "int", "bool", "float", "float", "vec3"];
        let args = start.module.args.iter().flatten().zip(types);
        // What f32 makes of a numeral is where both begin.
        let rounded = |value: OracleValue| match value {
            OracleValue::Float(x) => OracleValue::Float((x as f32).into()),
            OracleValue::Vector(v) => OracleValue::Vector(v.iter().map(|x| (*x as f32).into()).collect()),
            other => other,
        };
        let values = args.map(|(arg, ty)| rounded(evaluate(arg, &free).coerce(ty)));
        let scope = Scope {
            bound: names.zip(values).collect(),
            constants: &constants,
            attributes: &attributes,
            random: None,
        };
        successor.args.iter().flatten().map(|arg| evaluate(arg, &scope).settle()).collect()
    };
    starts.expect("an axiom").iter().map(of_start).collect()
}

/// What the table says of infinities and of what is not a number, value by value, as the host computes it; that the
/// devices do is a case of the conformance suite.
#[test]
fn infinities_and_nan_have_their_stated_values() {
    const NAN: f32 = f32::NAN;
    const INF: f32 = f32::INFINITY;
    let value = |name: &str, args: &[f32]| {
        let op = burgeon::language::ops::find(name, &vec![Type::Float; args.len()]).expect("a row");
        let words: Vec<u32> = args.iter().map(|x| x.to_bits()).collect();
        let word = op.row().cpu.and_then(|cpu| cpu.word(&words)).expect("a value");
        match op.row().result {
            Type::Float => f64::from(f32::from_bits(word)),
            Type::Int => f64::from(word as i32),
            _ => f64::from(word),
        }
    };
    let (inf, nan) = (f64::from(INF), f64::from(NAN));
    let half_pi = std::f64::consts::FRAC_PI_2;
    let cases: &[(&str, &[f32], f64)] = &[
        ("==", &[NAN, NAN], 0.0),
        ("!=", &[NAN, NAN], 1.0),
        ("==", &[-0.0, 0.0], 1.0),
        ("==", &[INF, INF], 1.0),
        ("<", &[NAN, 1.0], 0.0),
        ("<", &[1.0, NAN], 0.0),
        ("<=", &[NAN, NAN], 0.0),
        (">", &[NAN, 1.0], 0.0),
        (">=", &[1.0, NAN], 0.0),
        ("<", &[-INF, f32::MIN], 1.0),
        (">", &[INF, f32::MAX], 1.0),
        ("+", &[INF, -INF], nan),
        ("-", &[INF, INF], nan),
        ("-", &[INF, -INF], inf),
        ("+", &[INF, 1.0], inf),
        ("*", &[INF, 0.0], nan),
        ("*", &[INF, -2.0], -inf),
        ("/", &[1.0, 0.0], inf),
        ("/", &[1.0, -0.0], -inf),
        ("/", &[-3.0, 0.0], -inf),
        ("/", &[0.0, 0.0], nan),
        ("/", &[INF, INF], nan),
        ("/", &[2.0, INF], 0.0),
        ("-", &[NAN], nan),
        ("int", &[NAN], 0.0),
        ("int", &[INF], 2147483520.0),
        ("int", &[-INF], -2147483648.0),
        ("int", &[4294967296.0], 2147483520.0),
        ("abs", &[-INF], inf),
        ("abs", &[NAN], nan),
        ("sign", &[NAN], 0.0),
        ("sign", &[-INF], -1.0),
        ("min", &[NAN, 1.0], nan),
        ("min", &[1.0, NAN], 1.0),
        ("max", &[NAN, 1.0], nan),
        ("max", &[1.0, NAN], 1.0),
        ("max", &[INF, 1.0], inf),
        ("clamp", &[NAN, 0.0, 1.0], nan),
        ("clamp", &[INF, 0.0, 1.0], 1.0),
        ("floor", &[-INF], -inf),
        ("round", &[NAN], nan),
        ("sqrt", &[-1.0], nan),
        ("sqrt", &[INF], inf),
        ("step", &[0.0, NAN], 1.0),
        ("exp", &[INF], f64::from(elementary::exp(88.0))),
        ("exp", &[NAN], nan),
        ("log", &[INF], inf),
        ("log", &[-INF], f64::from(f32::MIN)),
        ("log", &[NAN], nan),
        ("log2", &[INF], inf),
        ("pow", &[NAN, 0.0], 1.0),
        ("pow", &[2.0, NAN], nan),
        ("pow", &[0.5, INF], f64::from(elementary::exp(-87.0))),
        ("sin", &[INF], nan),
        ("cos", &[NAN], nan),
        ("tan", &[-INF], nan),
        ("atan", &[INF], half_pi),
        ("atan2", &[INF, INF], half_pi / 2.0),
        ("atan2", &[1.0, -INF], 2.0 * half_pi),
        ("atan2", &[NAN, 1.0], nan),
        ("asin", &[NAN], nan),
        ("asin", &[INF], half_pi),
    ];
    for (name, args, expected) in cases {
        let found = value(name, args);
        let same = found == *expected || found.is_nan() && expected.is_nan();
        assert!(same || (found - expected).abs() < 1e-6, "{name}{args:?} is {found}, not {expected}");
    }
}

#[test]
fn random_expressions_are_near_the_oracle() {
    let (mut near, mut seeds) = (0, 0);
    for seed in 0..400 {
        // Numerals that f32 holds: what rounding makes of others is no difference between machines.
        let dyadic = [("0.1", "0.125"), ("-1/3", "-3/8"), ("0.7", "0.75"), ("0.3", "0.25")];
        let text = dyadic.iter().fold(text(seed), |text, (from, to)| text.replace(from, to));
        // The oracle knows no noise; a constant without a value is refused.
        if text.contains("noise") || System::parse(&text).is_err() {
            continue;
        }
        seeds += 1;
        let (plan, axiom) = job(&text);
        let word = word(&axiom, 1, &mut Cpu::new(&plan, 2).expect("threads"));
        let stage = &plan.tables.rule_sets[0].stages[0];
        let environment = plan.environment(stage, &[], &Given::default());
        let content = plan.axiom(&axiom, &[]).expect("the axiom");
        let records = content.records();
        let code = &stage.code.children[0];
        let truth = truth(&text);
        for (n, record) in records.chunks_exact(plan.tables.layout.record_words).enumerate() {
            let (given, measured, spread) = (&[][..], &[][..], &[][..]);
            let environment = environment.as_slice();
            let module = bound::Module {
                record,
                window: &[],
                at: 0,
                behind: 0,
                environment,
                given,
                measured,
                spread,
                clock: Clock::default(),
                linked: None,
                index: n as u32,
            };
            let nodes = bound::evaluate(&code.graph, &module);
            let mut known = code.args[0].iter().map(|a| nodes[a.0]);
            for (field, (value, truth)) in word.params(n).iter().zip(&truth[n]).enumerate() {
                let truths: Vec<f64> = match truth {
                    OracleValue::Vector(v) => v.clone(),
                    OracleValue::Bool(b) => vec![f64::from(*b)],
                    OracleValue::Int(i) => vec![f64::from(*i)],
                    number => vec![number.clone().float()],
                };
                for (own, truth) in value.words().into_iter().zip(truths) {
                    let known = known.next().expect("a word");
                    let right = match (&value, known) {
                        // WGSL leaves open what NaN compares as, and what lies beyond f32 is what its
                        // overflow makes of it.
                        _ if truth.is_nan() || truth.abs() > 1e36 => continue,
                        (_, Known::Any) => continue,
                        (_, Known::Near { radius: f32::INFINITY, .. }) => continue,
                        (_, Known::Between { low, high, .. }) => {
                            (f64::from(low)..=f64::from(high)).contains(&truth)
                        }
                        (Value::Int(i), _) => f64::from(*i) == truth,
                        (Value::Bool(b), _) => f64::from(*b) == truth,
                        (_, Known::Near { value, radius }) => {
                            (f64::from(value) - truth).abs() <= f64::from(radius) + 1e-36
                        }
                        // The same everywhere, since the host has worked it out: in f32.
                        (_, Known::Exact(_)) => {
                            let (own, size) = (f64::from(f32::from_bits(own)), truth.abs().max(1.0));
                            own == truth || (own - truth).abs() <= 4.0 * f64::from(f32::EPSILON) * size
                        }
                    };
                    near += 1;
                    assert!(
                        right,
                        "seed {seed}, module {n}, field {field}: {value:?}, {known:?}, in truth {truth}\n{text}"
                    );
                }
            }
        }
    }
    assert!(seeds > 200 && near > 20_000, "{seeds} systems, {near} values");
}

#[test]
fn lots_fall_alike_on_cpu_and_gpu_and_differ_by_seed() {
    let lots = WRITTEN.iter().find(|s| s.name == "lots").expect("a system of the suite");
    let (plan, axiom) = job(lots.text);
    let on_cpu = |seed| word(&axiom, seed, &mut Cpu::new(&plan, 2).expect("threads"));
    let first = (1..9).map(on_cpu).find(|w| w.modules.len() > 50).expect("a seed that grows");
    assert!((1..9).any(|seed| on_cpu(seed) != first), "the seed changes nothing");
    for (name, engine) in device::engines() {
        for seed in 1..5 {
            let gpu = word(&axiom, seed, &mut Gpu::new(&engine, &plan).expect("kernels"));
            assert!(gpu == on_cpu(seed), "{name}, seed {seed}");
        }
    }
}

#[test]
fn an_edit_in_one_branch_rolls_that_branch_alone() {
    let text = "system s : patch bezier 3\nmodule R, A(x: float), B(x: float)\naxiom: R = file \"net.bpt\"\n\
        rules:\n  R -> [ A(0.0) | B(0.0) ]\n  a: A(x) -> [ A(rand()) | A(rand()) ]\n  \
        b: B(x) -> [ B(rand()) | B(rand()) ]\nrun:\n  derive 4\n";
    let edited = text.replace("b: B(x) -> [ B(rand()) | B(rand()) ]", "b: B(x) -> [ B(rand()) | eps ]");
    let of_a = |text: &str| {
        let (plan, axiom) = job(text);
        let word = word(&axiom, 7, &mut Cpu::new(&plan, 1).expect("threads"));
        let a = word.modules.iter().filter(|m| m.symbol == 1);
        a.map(|m| (m.key, word.params.row(1, m.row).to_vec())).collect::<Vec<_>>()
    };
    assert_eq!(of_a(text), of_a(&edited));
    assert_eq!(of_a(text).len(), 8);
}

#[test]
fn weights_are_drawn_in_proportion() {
    let text = "system s : patch bezier 3\nmodule P, A, B, C\naxiom: P = file \"net.bpt\"\n\
        rules grow:\n  P -> [ P P ; P P ]\nrules draw:\n  P ->(1) A\n    ->(2) B\n    ->(if(step > 0, 1, -1)) C\n    ->(5) eps\n\
        run:\n  derive 7 with grow\n  derive 1 with draw\n";
    let (plan, axiom) = job(text);
    let word = word(&axiom, 3, &mut Cpu::new(&plan, 2).expect("threads"));
    let share = |symbol| word.modules.iter().filter(|m| m.symbol == symbol).count() as f64 / 16384.0;
    assert!((share(1) - 0.125).abs() < 0.01, "{}", share(1));
    assert!((share(2) - 0.25).abs() < 0.015, "{}", share(2));
    assert_eq!(share(3), 0.0);
}

#[test]
fn the_hash_is_frozen() {
    // Pictures made from a seed stay as they are for ever: these may not change.
    assert_eq!(elementary::hash(0, 0), HASHES[0]);
    assert_eq!(elementary::hash(1, 2), HASHES[1]);
    assert_eq!(elementary::hash(0xffff_ffff, 0x1234_5678), HASHES[2]);
    assert_eq!(elementary::unit(0xffff_ffff), 0.999_999_94);
    assert_eq!(elementary::unit(0), 0.0);
    assert_eq!(elementary::scale(0x8000_0000, 10), 5);
    assert_eq!(elementary::scale(0xffff_ffff, 0x7fff_ffff), 0x7fff_fffe);
}

const HASHES: [u32; 3] = [0x9bb31115, 0x01e95d13, 0xe53adcfd];

#[test]
fn elementary_functions_are_near_the_truth() {
    for f in FUNCTIONS {
        let errors = (0..200_000).map(|n| {
            let x = f.argument(n, 200_000);
            (f.error(x, (f.cpu)(x)), x)
        });
        let (worst, at) = errors.fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
        assert!(worst <= f.ulps, "{}({at}): {worst:.2} ulp, {} allowed", f.name, f.ulps);
    }
}

#[test]
fn noise_is_zero_at_whole_points_and_bounded() {
    for n in 0..4000 {
        let t = n as f32 * 0.37;
        let value = elementary::noise(t, t * 0.7 - 3.0, 11.0 - t * 0.31);
        assert!(value.abs() <= 1.0, "{value} at {t}");
        assert_eq!(elementary::noise((n % 17) as f32, (n % 5) as f32 - 2.0, -(n as f32)), 0.0);
    }
}
