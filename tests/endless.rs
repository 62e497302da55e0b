//! What can never become terminal, and grows, is refused before it fills the memory.

use burgeon::io::bpt;
use burgeon::language::{Span, System};
use burgeon::plan::{self, Options, Plan};
use burgeon::{cpu, curve, patch};
use std::cell::Cell;

/// Rules, whether they surely go on for ever, and which of them the error names.
const UNTIL_TERMINAL: &[(&str, Option<&str>)] = &[
    ("P -> [ P P ; P P ]", Some("P -> [ P P ; P P ]")),
    ("P : true -> [ P | P ]", Some("P : true -> [ P | P ]")),
    ("P : 1 < 2 -> [ P | P ]", Some("P : 1 < 2 -> [ P | P ]")),
    ("P : level >= 0 || true -> [ P | P ]", Some("P : level >= 0 || true -> [ P | P ]")),
    ("P : level >= level -> [ P | P ]", Some("P : level >= level -> [ P | P ]")),
    ("P let x = k : x > 1 -> [ P | P ]", Some("P let x = k : x > 1 -> [ P | P ]")),
    ("P : false -> eps\n  P -> [ P | P ]", Some("P -> [ P | P ]")),
    ("P : level < 40 && k < 0 -> eps\n  P -> [ P | P ]", Some("P -> [ P | P ]")),
    ("P -> [ Q | Q ]\n  Q -> P", Some("P -> [ Q | Q ]")),
    ("P -> Q\n  Q -> [ P ; [ P | Q ] ]", Some("Q -> [ P ; [ P | Q ] ]")),
    ("P ->(1) [ P | P ] ->(k) [ Q P ; eps P ]", Some("P ->(1) [ P | P ] ->(k) [ Q P ; eps P ]")),
    ("P ->(1) [ P | P ] ->(0 - k) eps", Some("P ->(1) [ P | P ] ->(0 - k) eps")),
    ("P : level < 5 -> [ P | P ]\n  P : level >= 5 -> [ P ; P ]", Some("P : level < 5 -> [ P | P ]")),
    ("P : level == 5 -> [ P | P ]\n  P : 5 != level -> [ P ; P ]", Some("P : level == 5 -> [ P | P ]")),
    ("P : level < 5 || level >= 5 -> [ P | P ]", Some("P : level < 5")),
    ("P : level % 2 == 0 || level % 2 != 0 -> [ P | P ]", Some("P : level % 2")),
    ("P : level < 5 -> [ P | P ]\n  P : level > 4 -> [ P ; P ]", Some("P : level < 5 -> [ P | P ]")),
    ("P : !(k > level && level > 3) || level >= 4 -> [ P | P ]", Some("P : !(k")),
    ("P : level < 9 && level < 3 -> [ P | P ]\n  P : level >= 3 -> [ P ; P ]", Some("P : level < 9")),
    (
        "P : level < 3 -> [ P | P ]\n  P : level > 5 -> [ P ; P ]\n  P : 2 < level && 6 > level -> [ P ; P ]",
        Some("P : level < 3"),
    ),
    ("P : level >= 0 -> [ P | P ]", Some("P : level >= 0")),
    ("P : rand() < 2 -> [ P | P ]", Some("P : rand() < 2")),
    ("P let r = rand(1, 3) : r > 0.5 -> [ P | P ]", Some("P let r")),
    ("P : rand() < 0 -> eps\n  P -> [ P | P ]", Some("P -> [ P | P ]")),
    ("P : flatness == 1 || flatness != 1 -> [ P | P ]", Some("P : flatness")),
    ("P : level < 1 -> [ P | P ]\n  P let x = 0 : level >= x -> [ P ; P ]", Some("P : level < 1")),
    ("N(true) -> [ N(false) | N(true) ]\n  N(false) -> [ N(true) | P ]\n  P -> N(true)", Some("N(")),
    // Some of these may end, whatever the others do; or what goes on does not grow.
    ("P : flatness > 0.1 -> [ P | P ]", None),
    ("P : rand() < 0.5 -> [ P | P ]\n  P : rand() >= 0.5 -> [ P ; P ]", None),
    ("P : flatness < 0.1 -> [ P | P ]\n  P : flatness >= 0.1 -> [ P ; P ]", None),
    ("P : level < 5 || level > 5 -> [ P | P ]", None),
    ("P : level < 5 -> [ P | P ]\n  P : level > 5 -> [ P ; P ]", None),
    ("P : rand() < 1 - 1e-7 -> [ P | P ]", None),
    ("P : flatness < 0.1 || flatness >= 0.1 -> [ P | P ]", None),
    ("P let x = 1 : level < x -> [ P | P ]\n  P let x = 3 : level >= x -> [ P ; P ]", None),
    ("P ->(1) [ P | P ] ->(1) Q", None),
    ("P -> [ Q | Q ]", None),
    ("P : flatness < 0.1 -> eps\n  P -> [ P | P ]", None),
    ("P -> Q\n  Q -> P", None),
    ("P -> P", None),
];

#[test]
fn what_can_never_become_terminal_is_refused_before_it_fills_the_memory() {
    for &(rules, endless) in UNTIL_TERMINAL {
        let text = format!(
            "system s : patch bezier 3\nparam k: int = 3\nmodule P, Q, N(is: bool)\naxiom: P = file \"sheet.bpt\"\n\
             rules:\n  {rules}\nrun:\n  derive until terminal max 12\n"
        );
        let system = System::parse(&text).expect("a system");
        let axiom = patch::Axiom::load(&system, &mut |_| bpt::read("examples/data/sheet.bpt", false))
            .expect("an axiom");
        let plan = Plan::new(&system).expect("it is derived");
        let module = plan.tables.layout.module_bytes();
        let ran = Cell::new(0);
        let progress = |_: plan::Progress| ran.set(ran.get() + 1);
        let named = |rule: Span| endless.is_some_and(|endless| text[rule.range()].starts_with(endless));
        match cpu::derive(
            &plan,
            &axiom,
            &Options { progress: Some(&progress), max_bytes: 40 * module, ..Options::default() },
            1,
        ) {
            Err(plan::Error::Endless { rule, derive, modules, .. }) => {
                assert!(named(rule), "{} is named\n{text}", &text[rule.range()]);
                assert_eq!(&text[derive.range()], "derive until terminal max 12");
                assert!(modules > 40 && ran.get() == 0, "{modules} after {} steps\n{text}", ran.get());
            }
            // By chance they may well grow.
            Err(plan::Error::Memory { .. }) => assert!(endless.is_none() && ran.get() > 0, "{text}"),
            Err(error) => panic!("{error}\n{text}"),
            Ok(_) => assert!(endless.is_none(), "{text}"),
        }
        // What fits is derived: `max` says how far.
        let room = Options { steps: Some(2), max_bytes: 40 * module, ..Options::default() };
        cpu::derive(&plan, &axiom, &room, 1).unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
}

/// Growth as a power of the step is found far from the start, and after other derives.
#[test]
fn slow_growth_without_end_is_refused_too() {
    let rules = "A -> A B\n  B : 1 < 2 -> B F";
    let text = |run: &str| {
        format!(
            "system s : curve\nmodule A, B, C\naxiom: C\nrules:\n  {rules}\nrules first:\n  C -> A\nrun:\n  {run}\n"
        )
    };
    let refusal = |run: &str| {
        let system = System::parse(&text(run)).expect("a system");
        let axiom = curve::Axiom::load(&system, &mut |_| Err("no files")).expect("an axiom");
        let plan = Plan::new(&system).expect("it is derived");
        let module = plan.tables.layout.module_bytes();
        cpu::derive(&plan, &axiom, &Options { max_bytes: 1_000_000 * module, ..Options::default() }, 1)
            .map(|(word, _)| word.modules.len())
    };
    for run in [
        "derive 1 with first\n  derive until terminal max 1000000",
        "repeat 2 { \n  derive until terminal max 1000000 with first\n  derive until terminal max 1000000\n  }",
    ] {
        match refusal(run) {
            // n² / 2 modules, about.
            Err(plan::Error::Endless { symbol, modules, step, .. }) => {
                assert_eq!(symbol, "A");
                assert!(modules > 1_000_000 && (1400..1420).contains(&step), "{modules} after {step}");
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(refusal("derive 1 with first\n  derive until terminal max 100").expect("it fits"), 5051);
}

/// In a word of one symbol what a rule looks for stands everywhere but at the ends.
#[test]
fn rules_that_look_around_are_refused_where_one_symbol_stands_alone() {
    let ends = |topology: &str, axiom: &str, rules: &str| {
        let text = format!(
            "system s : curve{topology}\nmodule A(x: int), B\naxiom: {axiom}\nrules:\n  {rules}\nrun:\n  derive until \
             terminal max 20\n"
        );
        let system = System::parse(&text).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
        let axiom = curve::Axiom::load(&system, &mut |_| Err("no files")).expect("an axiom");
        let plan = Plan::new(&system).expect("it is derived");
        let module = plan.tables.layout.module_bytes();
        match cpu::derive(&plan, &axiom, &Options { max_bytes: 1000 * module, ..Options::default() }, 1) {
            Err(plan::Error::Endless { symbol, .. }) => {
                assert_eq!(symbol, "A");
                false
            }
            Err(plan::Error::Memory { .. }) | Ok(_) => true,
            Err(error) => panic!("{error}\n{text}"),
        }
    };
    let two = "A(1) A(2)";
    for (topology, axiom, rules) in [
        (" ring", two, "A(a) A(b) -> A(a) A(b) A(a) A(b)"),
        ("", two, "A(a) A(b) -> A(a) A(b) A(a) A(b)"),
        ("", "A(1) A(2) A(3)", "A(a) A(b) : a < b || a >= b -> A(a) A(b) A(a)  A(a)\n  A(a) -> A(a) A(a)"),
        ("", two, "A(a) < A(b) -> A(a) A(b)"),
        (" ring", two, "A(a) < A(b) -> A(a) A(b)"),
        ("", "A(1) A(2) A(3)", "A(a) < A(b) > A(c) -> A(a) A(b) A(c)"),
    ] {
        assert!(!ends(topology, axiom, rules), "{axiom}, {rules}");
    }
    for (topology, axiom, rules) in [
        ("", "A(1)", "A(a) A(b) -> A(a) A(b) A(a) A(b)"),
        ("", "A(1) B A(2)", "A(a) A(b) -> A(a) A(b) A(a) A(b)"),
        ("", two, "A(a) A(b) -> A(a) B A(b)"),
        ("", two, "A(a) A(b) : a < b -> A(a) A(b) A(a) A(b)"),
        ("", two, "A(a) < A(b) > # -> A(a) A(b)"),
        ("", two, "B < A(b) -> A(b) A(b)"),
        ("", two, "A(a) < A(b) -> A(a) A(b)\n  A(a) -> eps"),
    ] {
        assert!(ends(topology, axiom, rules), "{axiom}, {rules}");
    }
}

/// Growth or not: `check` warns of what makes all its steps with any params.
#[test]
fn what_makes_all_its_steps_is_known_before() {
    for (rules, named) in [
        ("A -> A B\n  B -> B", Some("A -> A B")),
        ("A -> B\n  B -> A", Some("B -> A")),
        ("A -> C B\n  C : 1 < 2 -> C B", Some("C : 1 < 2 -> C B")),
        ("A -> A", None),
        ("A -> B", None),
        ("A : k > 0 -> A B", None),
        ("A -> A B\n  A A -> B", None),
        ("A A -> B\n  A -> A B", None),
        ("A ->(1) A B ->(1) B", None),
    ] {
        let text = format!(
            "system s : curve\nparam k = 1\nmodule A, B, C\naxiom: B A\nrules:\n  {rules}\nrun:\n  derive until \
             terminal max 9\n"
        );
        let system = System::parse(&text).unwrap_or_else(|e| panic!("{e:?}\n{text}"));
        let found = Plan::new(&system).expect("it is derived").without_end();
        let found = found.map(|(rule, derive)| (&text[rule.range()], &text[derive.range()]));
        assert_eq!(found, named.map(|rule| (rule, "derive until terminal max 9")), "{text}");
    }
}
