//! The parser: examples, round trips, refusals, robustness.
use burgeon::language::diagnostic::{Diagnostic, Severity, code, nearest, render};
use burgeon::language::lex::MAX_ERRORS;
use burgeon::language::parse::{MAX_RULES, decode, parse};
use burgeon::language::print::print;
use burgeon::language::syntax::*;
use proptest::prelude::*;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// All rule files of a folder of test data, with their texts.
fn files(folder: &str) -> Vec<(PathBuf, String)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "burgeon"))
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path, text)
        })
        .collect();
    files.sort();
    files
}

fn shown(diagnostics: &[Diagnostic], text: &str) -> String {
    render(diagnostics, "test.burgeon", text, false)
}

fn parsed(text: &str) -> RuleFile {
    let parsed = parse(text);
    assert!(parsed.diagnostics.is_empty(), "{}\n{text}", shown(&parsed.diagnostics, text));
    parsed.file
}

fn errors(text: &str) -> Vec<Diagnostic> {
    let diagnostics = parse(text).diagnostics;
    let _ = shown(&diagnostics, text);
    diagnostics
}

fn codes(text: &str) -> Vec<&'static str> {
    errors(text).iter().map(|d| d.code).collect()
}

/// What parses without errors prints to a text that parses to the same tree.
fn round_trip(text: &str) {
    let first = parse(text);
    if !first.has_errors() {
        let printed = print(&first.file);
        let again = parse(&printed);
        assert!(!again.has_errors(), "{}\n{text}", shown(&again.diagnostics, &printed));
        assert_eq!(again.file, first.file, "\n{text}\n----\n{printed}");
        assert_eq!(print(&again.file), printed);
    }
}

/// The only system of a text.
fn system(text: &str) -> System {
    match parsed(text).items.pop() {
        Some(FileItem::System(system)) => system,
        other => panic!("{other:?}"),
    }
}

fn rules(text: &str) -> Vec<Rule> {
    let rules = |item| match item {
        Item::Rules(rules) => Some(rules.rules),
        _ => None,
    };
    system(text).items.into_iter().filter_map(rules).flatten().collect()
}

fn axiom(text: &str) -> AxiomKind {
    let axiom = |item| match item {
        Item::Axiom(axiom) => Some(axiom.kind),
        _ => None,
    };
    system(text).items.into_iter().find_map(axiom).unwrap()
}

/// A curve system with the modules A, B, C and X(a, b), and these rules.
fn curve(rules: &str) -> String {
    format!("system s : curve\nmodule A, B, C, X(a: int, b: int)\naxiom: A\nrules:\n{rules}\n")
}

fn patch(rules: &str) -> String {
    format!("system s : patch bezier 3\nmodule P, Q, R(l: int)\naxiom: P = file \"a.bpt\"\nrules:\n{rules}\n")
}

fn mesh(rules: &str) -> String {
    format!("system s : mesh\nmodule A, B(n: int)\ntemplate t = \"t.obj\"\naxiom: t\nrules:\n{rules}\n")
}

// What is right.

#[test]
fn examples_parse_and_print() {
    let files = files("language");
    assert!(files.len() > 25);
    for (_, text) in files {
        parsed(&text);
        round_trip(&text);
    }
}

#[test]
fn a_newline_ends_a_statement_only_outside_of_brackets() {
    let rules = rules(&curve(
        "  X(a,\n    b)\n    let c = (a\n + b)\n    : c > 0\n    -> X(c,\n c) [ B\n C ]\n  A -> B",
    ));
    assert_eq!(rules.len(), 2);
    assert_eq!(rules[0].lets.len(), 1);
    assert!(rules[0].condition.is_some());
    // Inside braces lines count again, even where the braces stand behind brackets.
    let text = mesh("  A -> extrude(1\n + 2) {\n    top: A\n    side, rim: B(nth)\n  }\n  B(n) -> A");
    assert_eq!(self::rules(&text).len(), 2);
    system("system s : curve\nconst x\n  = 3\nparam y : int\n  = 4\n");
}

/// Rules written over several lines, and in one.
#[test]
fn a_line_goes_on_where_nothing_else_can_be_meant() {
    for (lines, line) in [
        ("A -> B\n    C A", "A -> B C A"),
        ("A -> B\n\t\tC A\n\t\t+ A", "A -> B"),
        ("A -> F +\n    - F\n    [ C ]\n  B -> A", "A -> F + - F [ C ]\n  B -> A"),
        ("A ->\n  B C", "A -> B C"),
        ("A ->\n  B\n    C", "A -> B C"),
        ("A ->(0.5)\n  B\n  ->(0.5) C\n    A", "A ->(0.5) B ->(0.5) C A"),
        ("A -> B // a comment\n    // and one more\n    C", "A -> B C"),
        ("A\n    -> B\n    C\n      -> A", "A -> B\n  C -> A"),
        ("X(a, b) : a > 2 &&\n  b < 3 -> C", "X(a, b) : a > 2 && b < 3 -> C"),
        ("X(a, b) : a > 2\n  && b < 3\n  -> C", "X(a, b) : a > 2 && b < 3 -> C"),
        ("X(a, b) : a >\n  b +\n  3 -> C", "X(a, b) : a > b + 3 -> C"),
        (
            "X(a, b) let x = a *\n  b,\n  y = x\n  : x\n  == y -> C",
            "X(a, b) let x = a * b, y = x : x == y -> C",
        ),
        ("A <\n  B -> C", "A < B -> C"),
    ] {
        let lines = curve(&format!("  {lines}"));
        // A tab is not deeper than spaces.
        match lines.contains('\t') {
            true => assert_eq!(codes(&lines), [code::UNEXPECTED; 2]),
            false => assert_eq!(rules(&lines), rules(&curve(&format!("  {line}"))), "{lines}"),
        }
    }
    let lines = "const x = 1 +\n  2\nconst y = x\n  * 2\nconst z = x\n- y\nparam w: float = x\n  in 0 ..\n  9\nsystem s : curve\nmodule A,\n  B\naxiom: A\n  + B\nrules:\n  A -> B\nrun:\n  derive x +\n    y\n  repeat 2\n  {\n    derive 1\n      with\n      a, b\n  }\n";
    let line = "const x = 1 + 2\nconst y = x * 2\nconst z = x - y\nparam w: float = x in 0 .. 9\nsystem s : curve\nmodule A, B\naxiom: A + B\nrules:\n  A -> B\nrun:\n  derive x + y\n  repeat 2 {\n    derive 1 with a, b\n  }\n";
    assert_eq!(parsed(lines), parsed(line));
    let lines = mesh("  A ->\n    extrude(1)\n    at scale(2)\n    {\n top: A\n }");
    assert_eq!(rules(&lines), rules(&mesh("  A -> extrude(1) at scale(2) { top: A }")));
    // A rule is one wherever it stands, and what is no word is none of the rule before.
    assert_eq!(rules(&curve("  A -> B\n    C -> A\n      B C : true\n  -> A")).len(), 3);
    assert_eq!(codes(&curve("  A ->\n  B -> C")), [code::EMPTY_WORD]);
}

#[test]
fn a_line_that_ended_too_early_is_named() {
    let text = "system s : curve\nmodule A, B\naxiom: A\nrules:\n  A -> B\n  B A\n  B -> A\n";
    let expected = "error[E0101]: the rule ends with this line, and the next one is no rule
 --> test.burgeon:5:8
  |
5 |   A -> B
  |        ^
  |
 ::: test.burgeon:6:3
  |
6 |   B A
  |   --- `B A` has no `->`
  |
  = help: indent `B A` deeper than its rule to go on with it, or write `B A -> …` for a rule

";
    assert_eq!(shown(&errors(text), text), expected);
    let text = "system s : curve\nmodule A,\nmodule B\naxiom: A\n";
    let found = errors(text);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].span.start as usize, text.find(",\n").expect("a comma") + 1);
}

#[test]
fn what_is_plainly_no_rule_file_is_told_once() {
    let prose = "Rewriting patches.\nIt has rules (many) and [more.\n".repeat(100);
    for text in [
        format!("# Title\n\n{prose}```\nsystem s : curve\naxiom: F\n```\n"),
        format!("Title\n=====\n{prose}"),
        "v 0 0 0\nv 1 0 0\nf 1 2 3\n".into(),
        "<?xml version=\"1.0\"?>\n<svg>\n<path d=\"M0,0\"/>\n</svg>\n".into(),
        "x,y\n0,1\n2,3\n".into(),
        "{ \"version\": 1 }\n".into(),
        "[package]\nname = \"x\"\n".into(),
        "Koch1 { ; by hand\n  Angle 6\n  F=F+F--F+F\n}\n".into(),
        "\0\0\0\0".into(),
        "PNG\0\0\0\rIHDR\0\0\0".into(),
    ] {
        assert_eq!(codes(&text), [code::NO_RULE_FILE], "{}", shown(&errors(&text), &text));
    }
    assert_eq!(decode(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").unwrap_err().code, code::NO_RULE_FILE);
    let error = decode(b"\xff\xfes\0y\0s\0").unwrap_err();
    assert_eq!((error.code, error.message.as_str()), (code::INVALID_UTF8, "the file is UTF-16, not UTF-8"));
    // Slips in one that is.
    for text in [
        "sytem s : curve\n",
        "module A\n",
        "foo\n// a leaf\n\n// by me\n\nsystem s : curve\naxiom: F\n",
        "# a leaf\n# by me\n# in May\n# 2020\nsystem s : curve\naxiom: F\n",
        "#define N 5\nderivation length: 5\nsystem s : curve\naxiom: F\n",
        "Axiom: F\nderivation length: 3\n",
        "const x = 1 1\n",
        "system s : curve\nfoo\nfoo bar\nfoo foo\nbar\n",
    ] {
        assert!(!codes(text).contains(&code::NO_RULE_FILE) && !codes(text).is_empty(), "{text}");
    }
}

#[test]
fn text_may_have_a_mark_carriage_returns_and_signs() {
    let text = "\u{feff}burgeon 1\r\nsystem s : curve\r\nmodule A(n: int)\r\naxiom: A(1)\r\nrules:\r\n  A(n) : n ≤ 3 && n ≠ 2 → ε // →\r\n";
    let plain = "burgeon 1\n\nsystem s : curve\nmodule A(n: int)\naxiom: A(1)\nrules:\n  A(n) : n <= 3 && n != 2 -> eps\n";
    assert_eq!(parsed(text), parsed(plain));
    assert_eq!(print(&parsed(text)), plain);
    assert_eq!(parsed(text).version.unwrap().text, "1");
}

#[test]
fn in_a_word_doubled_signs_are_two_symbols() {
    assert_eq!(rules(&curve("  A -> &&F||+F--")), rules(&curve("  A -> & & F | | + F - -")));
    let rules = rules(&curve("  A : true && false || true -> F"));
    assert!(matches!(&rules[0].condition.as_ref().unwrap().kind, ExprKind::Binary(BinaryOp::Or, ..)));
}

#[test]
fn ranges_and_numbers() {
    for text in
        ["param x = 1 in 0..1", "param x = 1 in 0 .. 1", "param x = 1 in 0. .. 1e-3", "const x = 1. + 2.5e+2"]
    {
        parsed(text);
        round_trip(text);
    }
    let FileItem::Param(param) = &parsed("param x = 1 in 1..2").items[0] else { panic!() };
    let (low, high) = param.range.as_ref().unwrap();
    assert!(
        matches!((&low.kind, &high.kind), (ExprKind::Number(l), ExprKind::Number(h)) if l.text == "1" && h.text == "2")
    );
}

#[test]
fn precedence() {
    let value = |text: &str| match parsed(&format!("const x = {text}")).items.remove(0) {
        FileItem::Const(c) => c.value,
        _ => panic!(),
    };
    for (plain, bracketed) in [
        ("1 + 2*3", "1 + (2*3)"),
        ("1 - 2 - 3", "(1 - 2) - 3"),
        ("-a.x*b[1].y", "(-(a.x))*((b[1]).y)"),
        ("a && b || c && !d", "(a && b) || (c && (!d))"),
        ("a < b && c + 1 >= d", "(a < b) && ((c + 1) >= d)"),
        ("a/b*c%d", "((a/b)*c)%d"),
        ("--a - -b", "(-(-a)) - (-b)"),
    ] {
        assert_eq!(value(plain), value(bracketed), "{plain}");
    }
    assert_ne!(value("1 - (2 - 3)"), value("1 - 2 - 3"));
    assert_eq!(value("if(c, 1, 2)"), value("if (c, 1, 2)"));
}

#[test]
fn labels() {
    let label = |text: &str| rules(text)[0].label.clone().map(|l| l.text);
    assert_eq!(label(&curve("  p: A -> B")).as_deref(), Some("p"));
    assert_eq!(label(&curve("  p: A : true -> B")).as_deref(), Some("p"));
    assert_eq!(label(&curve("  p: A < B > [ C ] # let x = 1 -> B")).as_deref(), Some("p"));
    assert_eq!(label(&curve("  A : true -> B")), None);
    // A module is never a label, whatever follows.
    assert_eq!(label(&curve("  A : B -> C")), None);
    assert_eq!(label(&mesh("  j: A@t & A@t -> t")).as_deref(), Some("j"));
    // Two colons: the first is a label's, so the missing module is the second name.
    let wrong = errors(&curve("  p: Z : true -> B"));
    assert_eq!((wrong.len(), wrong[0].code), (1, code::UNDECLARED_SYMBOL));
    assert!(wrong[0].message.contains("`Z`"));
}

#[test]
fn contexts_and_ends() {
    let rules = rules(&curve(
        "  # A B < C > [ A [ B ] # ] X(_, 1) # -> C\n  # < A -> B\n  A > # -> B\n  # -> #\n  A B -> C",
    ));
    assert_eq!(rules.len(), 4, "`# -> #` does nothing and is left out");
    let first = &rules[0].predecessor;
    assert!(first.left.as_ref().unwrap().end && first.left.as_ref().unwrap().patterns.len() == 2);
    assert!(first.right.as_ref().unwrap().end && first.right.as_ref().unwrap().parts.len() == 2);
    assert_eq!(rules[3].predecessor.strict.len(), 2);
    let joined = self::rules(&mesh("  A@t & A@t -> eps"));
    assert!(joined[0].predecessor.joined);
    let turtle = self::rules(&curve("  & < + > - -> / \\ ^ !"));
    assert!(!turtle[0].predecessor.joined);
}

#[test]
fn blocks_and_branches() {
    let element = |text: &str| match &rules(&patch(text))[0].alternatives[0].successor {
        Successor::Word(word) => word[0].clone(),
        other => panic!("{other:?}"),
    };
    let Element::Block(block) = element("  P -> [ P eps ; Q [ P | Q ] ]") else { panic!() };
    assert_eq!(block.rows.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
    assert!(matches!(&block.rows[1][1], Cell::Block(inner) if inner.rows.len() == 1));
    assert!(matches!(element("  P -> [ P ; Q ]"), Element::Block(b) if b.rows.len() == 2));
    assert!(matches!(element("  P -> [ P |\n Q ]"), Element::Block(_)));
    assert!(matches!(element("  P -> [ +(30) P ] P"), Element::Branch(..)));
    assert!(matches!(element("  P -> [ F P [ - Q ] ]"), Element::Branch(..)));
    // In a curve `|` is the turtle's.
    let curve = rules(&curve("  A -> [ B | C ]"));
    assert!(
        matches!(&curve[0].alternatives[0].successor, Successor::Word(w) if matches!(w[0], Element::Branch(..)))
    );
}

#[test]
fn axioms() {
    let curve = |text: &str| {
        axiom(&format!("system s : curve\nmodule A, P(v: vec2, n: int)\nconst p = (0, 0)\naxiom: {text}\n"))
    };
    assert!(matches!(curve("F [ + A ] A"), AxiomKind::Word(w) if w.len() == 3));
    assert!(matches!(curve("\n  F A"), AxiomKind::Word(_)));
    assert!(matches!(curve("[ A ] A"), AxiomKind::Word(_)));
    assert!(matches!(curve("[ [ - A ] ]"), AxiomKind::Word(_)));
    for list in ["[(0, 0), (1, 1)]", "[p, p]", "[(p)]", "[[p, p]]", "[1, 2] shift 3"] {
        assert!(matches!(curve(list), AxiomKind::Source(Source { kind: SourceKind::List(_), .. })), "{list}");
    }
    assert!(matches!(curve("file \"a.csv\" [2] shift 3"), AxiomKind::Source(_)));
    assert!(matches!(curve("earlier shift 1"), AxiomKind::Source(_)));
    assert!(matches!(curve("circle(3)"), AxiomKind::Source(_)));
    assert!(matches!(curve("P(_, 0) = file \"a.csv\" shift 2"), AxiomKind::Starts(s) if s.len() == 1));
    let starts = axiom(
        "system s : patch bezier 3\nmodule P(l: int), Q\naxiom: P(0)\n  = file \"a\"  Q = file \"b\" [1]\n  P(1) = file \"c\"\n",
    );
    assert!(matches!(starts, AxiomKind::Starts(s) if s.len() == 3));
    let meshes = axiom(
        "system s : mesh\nmodule A\naxiom: grid(1, 1, 1.0) at scale(2) corner { face: A }\n  trunk { a, b: A; }\n",
    );
    assert!(matches!(meshes, AxiomKind::Meshes(m) if m.len() == 2 && m[0].at.len() == 2));
}

#[test]
fn successors_of_meshes() {
    let successors: Vec<Successor> = rules(&mesh(
        "  A -> eps\n  A -> B(1)\n  A -> A@(1, 2)\n  A -> other\n  A -> A { top: A }\n  A -> t(2) on corner scale(1, 1, 2)",
    ))
    .into_iter()
    .map(|mut rule| rule.alternatives.remove(0).successor)
    .collect();
    let templates: Vec<bool> = successors.iter().map(|s| matches!(s, Successor::Template(_))).collect();
    assert_eq!(templates, [false, false, false, true, true, true]);
}

#[test]
fn what_stands_behind_run_belongs_to_the_file() {
    let file = parsed(
        "system a : curve\naxiom: F\nrun:\n  derive 1\nconst x = 1\nparam y = x\nsystem b : curve\naxiom: F\n",
    );
    assert_eq!(file.items.len(), 4);
    round_trip(&print(&file));
}

#[test]
fn all_else_round_trips() {
    round_trip(&curve("  X(-1, true) -> B\n  X(_, false)@t -> A@3 B@(1 + 2) C@x"));
    let text = "system s : mesh\nmodule S, +(a: float)\nvolume v : float(8, 8, 8) from (0, 0, 0) to (1, 1, 1)\ntemplate t { v 0 -1.5 0 e 0 1 2.5\n f base: 0 1 2 } base base side\nquery E(d: float)\nplace w on S, + = p\nrun:\n  deposit S(_) into v : true\n  derive until terminal\n  derive until terminal max 3 with a, b\n  repeat 2 { if x > 1 { place w }\n  mark S@1 : true isolated\n }\n  crease 2 : dihedral > 40\n  trace into S\n";
    parsed(text);
    round_trip(text);
}

// What is wrong.

/// One error with this code, and a hint that says this.
fn refused(text: &str, code: &str, hint: &str) {
    let errors = errors(text);
    let shown = shown(&errors, text);
    assert_eq!(errors.len(), 1, "{text}\n{shown}");
    assert_eq!(errors[0].code, code, "{shown}");
    let said = errors[0].hint.clone().unwrap_or_default();
    assert!(said.contains(hint), "{hint:?} is not in\n{shown}");
}

#[test]
fn habits_of_other_systems_get_a_hint() {
    for (rule, code, hint) in [
        ("A = F A", code::FOREIGN_RULE, "write `->`"),
        ("A -> F : 0.3", code::FOREIGN_RULE, "->(0.3)"),
        ("A ->(30%) F ->(70%) A", code::FOREIGN_RULE, "0.3"),
        ("X(a, b) : a > 0 ? 1 : 2 -> F", code::FOREIGN_OPERATOR, "if(a > 0, 1, 2)"),
        ("A -> *", code::FOREIGN_RULE, "write `eps`"),
        ("A : * -> B", code::FOREIGN_RULE, "no `:`"),
        ("A -> B /* B */", code::BLOCK_COMMENT, "//"),
        ("A --> B", code::WRONG_ARROW, "write `->`"),
        ("A => B", code::WRONG_ARROW, "write `->`"),
        ("A -> CFC", code::UNDECLARED_SYMBOL, "write `C F C`"),
        ("A -> Dab", code::UNDECLARED_SYMBOL, "module Dab"),
        ("A ->", code::EMPTY_WORD, "write `eps`"),
        ("A -> [ ]", code::EMPTY_WORD, "write `eps`"),
        ("A : 1 < 2 < 3 -> B", code::CHAINED_COMPARISON, "1 < 2 && 2 < 3"),
        ("A : true | true -> B", code::FOREIGN_OPERATOR, "||"),
        ("A : true & true -> B", code::FOREIGN_OPERATOR, "&&"),
        ("A : true and true -> B", code::FOREIGN_OPERATOR, "&&"),
        ("A : 1 = 1 -> B", code::FOREIGN_OPERATOR, "=="),
        ("A : 2^2 > 1 -> B", code::FOREIGN_OPERATOR, "pow"),
        ("A : 2**2 > 1 -> B", code::FOREIGN_OPERATOR, "pow"),
        ("X(a, b + 1) -> B", code::BAD_PATTERN, "condition"),
        ("A : true let x = 1 -> B", code::UNEXPECTED, "before the condition"),
        ("eps -> B", code::MISPLACED_EPS, "replaced"),
        ("# A -> B", code::NO_PREDECESSOR, "# <"),
        ("A -> B #", code::UNEXPECTED, "contexts"),
        ("modul A", code::UNKNOWN_WORD, "did you mean `module`?"),
        ("derive 3", code::UNKNOWN_WORD, "run:"),
        ("1: A -> B", code::FOREIGN_RULE, "write `p1: …`"),
        ("A -> B;", code::UNEXPECTED, "leave `;` out"),
        ("A -> B;\n  B -> C;\n  C -> A;", code::UNEXPECTED, "in the lines below"),
        ("A -> B; B -> C", code::UNEXPECTED, "one statement a line"),
        ("; B becomes C", code::UNKNOWN_WORD, "write `//`"),
        ("# B becomes C", code::UNKNOWN_WORD, "write `//`"),
        ("# B becomes C\n  # C becomes A", code::UNKNOWN_WORD, "write `//`"),
        ("#define N 5", code::UNKNOWN_WORD, "const NAME = 2"),
        ("#iterate 5", code::UNKNOWN_WORD, "derive 5"),
        ("X(a, b) : if a < 3 -> B", code::FOREIGN_RULE, "A(n) : n < 3 -> …"),
        ("X(a, b) : if (a < 3) -> B", code::FOREIGN_RULE, "A(n) : n < 3 -> …"),
        ("X(a, b) if a < 3 -> B", code::UNDECLARED_SYMBOL, "behind `:`"),
        ("X(a, b) -> B if a < 3", code::UNDECLARED_SYMBOL, "behind `:`"),
        ("if a < 3: X(a, b) -> B", code::UNDECLARED_SYMBOL, "behind `:`"),
        ("if (a < 3) X(a, b) -> B", code::UNDECLARED_SYMBOL, "behind `:`"),
        ("X(a, b) -> X(if a < 3 then 1 else 2, b)", code::FOREIGN_OPERATOR, "if(c, a, b)"),
        ("derivation length: 5", code::UNKNOWN_WORD, "derive 5"),
    ] {
        refused(&curve(&format!("  {rule}")), code, hint);
    }
    refused("system s : curve\nmodule Apex\naxiom: F\nrules:\n  Apx -> F", code::UNDECLARED_SYMBOL, "`Apex`");
    refused(&mesh("  A -> A B(1)"), code::UNEXPECTED, "slot");
    refused(&patch("  P -> [ P Q ]"), code::NOT_A_BLOCK, "[ P | Q ]");
    refused(&patch("  P -> [ P P Q ; P ]"), code::RAGGED_BLOCK, "eps");
    refused(&patch("  P -> [ P P Q ; P P Q ]"), code::BLOCK_SIZE, "cells");
    refused("const x = .5", code::BAD_NUMBER, "0.5");
    refused("const x = 3y", code::BAD_NUMBER, "3*y");
    refused("const x = 3 − 2", code::UNKNOWN_CHARACTER, "write `-`");
    refused("burgeon 2\nconst x = 3", code::VERSION, "burgeon 1");
    for (line, hint) in [
        ("#define N 5", "const NAME = 2"),
        ("derivation length: 5", "derive 5"),
        ("Axiom: F", "did you mean `axiom`?"),
        ("production:", "rules:"),
        ("F -> F F", "rules:"),
        ("Apex -> F F", "rules:"),
        ("Angle 6", "const angle"),
        ("variables : A B", "module A, B"),
        ("float x = 3", "const x = 2"),
        ("uniform float x", "param x = 2"),
        ("; A", "write `//`"),
    ] {
        refused(&format!("system s : curve\n{line}\nmodule A\naxiom: A\n"), code::UNKNOWN_WORD, hint);
    }
    refused("system s : curve\nignore: F\naxiom: F\n", code::UNEXPECTED, "without `:`");
    for (step, hint) in
        [("for i in 1 .. 3 {\n  }", "repeat"), ("else {\n  }", "opposite"), ("derive 1;", "`;`")]
    {
        let text = format!("system s : curve\naxiom: F\nrun:\n  {step}\n");
        let errors = errors(&text);
        assert!(errors[0].hint.as_ref().is_some_and(|said| said.contains(hint)), "{}", shown(&errors, &text));
    }
}

#[test]
fn a_comment_that_reads_as_a_word_gets_a_warning() {
    for word in ["B //", "B // ", "B // B", "F // +(30) [ A ]\n  B -> C"] {
        let text = curve(&format!("  A -> {word}"));
        refused(&text, code::COMMENT_LIKE_WORD, "/ /");
        assert!(!parse(&text).has_errors());
    }
    for word in ["B // two steps", "B\n  //", "B // A becomes B", "B\n  // B"] {
        parsed(&curve(&format!("  A -> {word}")));
    }
    parsed(&mesh("  A -> B(1) // A"));
}

#[test]
fn a_ragged_block_names_its_rows_at_its_bracket() {
    let text = patch("  P -> [ P P Q ; P ]");
    let error = errors(&text).remove(0);
    assert_eq!(error.message, "rows have 3 and 1 cells");
    assert_eq!(&text[error.span.range()], "[");
}

#[test]
fn an_unclosed_bracket_is_reported_at_its_opening_and_swallows_nothing() {
    for (text, bracket) in [
        (curve("  A -> [ B C\n  B -> C\n  B -> Z"), "["),
        (curve("  X(a, b -> B\n  B -> Z"), "("),
        (curve("  A -> X((1, 2)\n  B -> Z"), "("),
        (mesh("  A -> t { top: A\n  A -> Z@1"), "{"),
        ("system s : curve\nmodule P(v: vec2)\naxiom: P((0, 0) P((1, 0))\nrules:\n  P -> Z".into(), "("),
        (patch("  P -> [ R(1 ; P ]\n  P -> Z"), "("),
    ] {
        let errors = errors(&text);
        assert_eq!(errors.len(), 2, "{}", shown(&errors, &text));
        assert_eq!(errors[0].code, code::UNCLOSED_BRACKET);
        assert_eq!(&text[errors[0].span.range()], bracket);
        assert!(errors[1].message.contains('Z'));
    }
}

#[test]
fn several_errors_of_one_file() {
    let text = "param = 3\nsystem s : curve rong\nmodule A\nfoo\naxiom: A Q\nrules:\n  A => B\n  A -> ]\n  A : 1 ? 2 : 3 -> A\nrun:\n  derive\n  repeat 2 {\n    derive 1 2\n    derive 3\n    stop\n  }\n  mark A\n";
    let codes = codes(text);
    let expected = [
        code::UNEXPECTED,
        code::UNKNOWN_WORD,
        code::UNKNOWN_WORD,
        code::UNDECLARED_SYMBOL,
        code::WRONG_ARROW,
        code::UNDECLARED_SYMBOL,
        code::STRAY_BRACKET,
        code::FOREIGN_OPERATOR,
        code::UNEXPECTED,
        code::UNEXPECTED,
        code::UNKNOWN_WORD,
        code::UNEXPECTED,
    ];
    assert_eq!(codes, expected, "{}", shown(&errors(text), text));
}

#[test]
fn refused_files_have_the_code_of_their_first_line() {
    let mut count = 0;
    for (path, text) in files("refused") {
        let code = text.strip_prefix("// ").and_then(|t| t.get(..5)).unwrap();
        // The codes above these are the checker's.
        if code.starts_with("E00") || code.starts_with("E01") {
            let found = codes(&text);
            assert!(found.contains(&code), "{}: {found:?}", path.display());
            assert_eq!(found.len(), 1, "{}: {}", path.display(), shown(&errors(&text), &text));
            count += 1;
        }
    }
    assert!(count > 40);
}

#[test]
fn bytes_that_are_not_utf8_are_placed() {
    assert_eq!(decode("ε".as_bytes()).unwrap(), "ε");
    let bytes = b"const x = 1\nconst \xff = 2\n";
    let error = decode(bytes).unwrap_err();
    assert_eq!((error.code, error.span.start), (code::INVALID_UTF8, 18));
    let shown = render(&[error], "a.burgeon", &String::from_utf8_lossy(bytes), false);
    assert!(shown.contains("a.burgeon:2:7"), "{shown}");
}

#[test]
fn names_are_suggested_only_if_near() {
    assert_eq!(nearest("lenght", ["length", "level"]), Some("length"));
    assert_eq!(nearest("p", ["P", "Q"]), Some("P"));
    assert_eq!(nearest("A", ["B", "C"]), None);
    assert_eq!(nearest("centroid", ["normal"]), None);
}

// What is shown.

#[test]
fn a_rendered_error_has_all_its_parts() {
    let text = curve("  A -> B\n  A -> [ B\n  B -> C");
    let shown = shown(&errors(&text), &text);
    for part in [
        "error[E0102]: `[` is never closed",
        "test.burgeon:6:8",
        "6 |   A -> [ B",
        "^",
        "test.burgeon:7:5",
        "help: write `]`",
    ] {
        assert!(shown.contains(part), "{part:?} is not in\n{shown}");
    }
    let warning = Diagnostic::warning("W0300", Span::new(0, 6), "look").label(Span::new(7, 8), "here");
    assert_eq!(warning.severity, Severity::Warning);
    let shown = render(&[warning], "a", &text, false);
    assert!(shown.contains("warning[W0300]: look") && shown.contains("- here"), "{shown}");
    assert!(render(&errors("const"), "a", "const", true).contains("\u{1b}["));
}

#[test]
fn long_lines_are_cut_around_the_caret() {
    let text = curve(&format!("  A -> {}Q {}", "A ".repeat(1000), "α ".repeat(0) + &"B ".repeat(1000)));
    let shown = shown(&errors(&text), &text);
    assert!(shown.contains("test.burgeon:5:2008"), "{shown}");
    let lines: Vec<&str> = shown.lines().collect();
    assert!(lines.iter().all(|l| l.chars().count() <= 120), "{shown}");
    let caret = lines.iter().position(|l| l.contains('^')).unwrap();
    let column = lines[caret].chars().position(|c| c == '^').unwrap();
    assert_eq!(lines[caret - 1].chars().nth(column), Some('Q'), "{shown}");
}

#[test]
fn any_span_can_be_rendered() {
    let text = "α\tβ\r\n\u{202e}x\n";
    for start in 0..text.len() + 3 {
        for end in 0..text.len() + 3 {
            let diagnostic =
                Diagnostic::error("E0101", Span::new(start, end), "a\nb").label(Span::new(end, start), "l");
            assert!(render(&[diagnostic], "a", text, false).contains("error[E0101]"));
        }
    }
    assert!(render(&errors(""), "a", "", false).is_empty());
}

// What must not break it.

/// Runs it and sees to it that it takes no more than a few seconds, even unoptimized.
fn quickly(what: &str, text: &str) -> Vec<&'static str> {
    let start = Instant::now();
    let codes = codes(text);
    assert!(start.elapsed() < Duration::from_secs(20), "{what}: {:?}", start.elapsed());
    assert!(codes.len() <= MAX_ERRORS + 1, "{what}");
    codes
}

#[test]
fn large_and_deep_files_take_little_time() {
    const MEGA: usize = 1 << 20;
    let deep = 100_000;
    let system = "system s : curve\nmodule A\naxiom: A\nrules:\n  A -> ";
    for (what, text, code) in [
        ("spaces", " ".repeat(10 * MEGA), None),
        ("one name", format!("const x = {}", "x".repeat(10 * MEGA)), None),
        ("one number", format!("const x = {}", "9".repeat(10 * MEGA)), None),
        ("a sum", format!("const x = {}1", "1+".repeat(5 * MEGA)), Some(code::TOO_DEEP)),
        ("fields", format!("const x = a{}", ".x".repeat(MEGA)), Some(code::TOO_DEEP)),
        ("signs", format!("const x = {}1", "-".repeat(5 * MEGA)), Some(code::TOO_DEEP)),
        ("open", format!("const x = {}", "(".repeat(2 * MEGA)), Some(code::UNCLOSED_BRACKET)),
        ("close", ")".repeat(MEGA), Some(code::STRAY_BRACKET)),
        ("mixed", format!("const x = {}", "([{".repeat(MEGA)), Some(code::UNCLOSED_BRACKET)),
        ("crossed", format!("const x = {}", "([)]".repeat(MEGA)), Some(code::UNCLOSED_BRACKET)),
        ("comments", format!("const x = 1\n{}", "/*".repeat(MEGA)), Some(code::BLOCK_COMMENT)),
        ("comment lines", format!("const x = 1\n{}", "/*\n".repeat(MEGA)), Some(code::BLOCK_COMMENT)),
        ("quotes", format!("const x = {}", "\"\n".repeat(MEGA)), Some(code::UNCLOSED_STRING)),
        ("arrows", format!("const x = {}", "-> ".repeat(MEGA)), Some(code::UNEXPECTED)),
        ("nested", format!("const x = {}1{}", "(".repeat(deep), ")".repeat(deep)), Some(code::TOO_DEEP)),
        ("lists", format!("const x = {}1{}", "[".repeat(deep), "]".repeat(deep)), Some(code::TOO_DEEP)),
        ("calls", format!("const x = {}1{}", "f(".repeat(deep), ")".repeat(deep)), Some(code::TOO_DEEP)),
        ("branches", format!("{system}{}A{}", "[ ".repeat(deep), "]".repeat(deep)), Some(code::TOO_DEEP)),
        ("a word", format!("{system}{}", "A ".repeat(MEGA)), None),
        ("unknown symbols", format!("{system}{}", "Q ".repeat(MEGA)), Some(code::UNDECLARED_SYMBOL)),
        ("labels", format!("{system}A\n{}", "p: ".repeat(MEGA)), Some(code::UNDECLARED_SYMBOL)),
        ("open at arrows", format!("{system}{}", "( -> [ ->".repeat(MEGA)), Some(code::UNCLOSED_BRACKET)),
        ("systems", "system s : curve\n".repeat(MEGA / 4), None),
        (
            "unknown names",
            format!(
                "system s : curve\nmodule {}A\naxiom: {}",
                (0..50_000).map(|i| format!("name{i}, ")).collect::<String>(),
                (0..50_000).map(|i| format!("mane{i} ")).collect::<String>(),
            ),
            Some(code::UNDECLARED_SYMBOL),
        ),
        ("conditional", format!("const x = {}", "1 ? ".repeat(MEGA)), Some(code::FOREIGN_OPERATOR)),
    ] {
        let codes = quickly(what, &text);
        match code {
            Some(code) => assert!(codes.contains(&code) || codes.len() > MAX_ERRORS, "{what}: {codes:?}"),
            None => assert!(codes.is_empty(), "{what}: {codes:?}"),
        }
    }
}

#[test]
fn errors_end_after_some() {
    let text = format!("system s : curve\naxiom: F\nrules:\n{}", "  F => F\n".repeat(100_000));
    let codes = quickly("errors", &text);
    assert_eq!(codes.len(), MAX_ERRORS + 1);
    assert_eq!(codes.last(), Some(&code::TOO_MANY_ERRORS));
}

#[test]
fn the_number_of_rules_is_bounded() {
    let text = |n: usize| curve(&"  A -> B\n".repeat(n));
    assert_eq!(rules(&text(MAX_RULES)).len(), MAX_RULES);
    assert_eq!(codes(&text(100_000)), [code::TOO_MANY_RULES]);
}

/// Expressions as the parser can make them.
fn expressions() -> impl Strategy<Value = Expr> {
    let span = Span::default();
    let name = move |text: &str| Name { text: text.into(), span };
    let expr = move |kind| Expr { kind, span };
    let leaf = prop_oneof![
        prop::sample::select(vec!["0", "1.", "2.5", "1e-3"])
            .prop_map(move |n| expr(ExprKind::Number(Number { text: n.into(), span }))),
        prop::sample::select(vec!["a", "_", "until", "F"]).prop_map(move |n| expr(ExprKind::Name(n.into()))),
        any::<bool>().prop_map(move |b| expr(ExprKind::Bool(b))),
    ];
    leaf.prop_recursive(6, 60, 3, move |inner| {
        let ops = prop::sample::select(vec![
            BinaryOp::Or,
            BinaryOp::And,
            BinaryOp::Equal,
            BinaryOp::Less,
            BinaryOp::GreaterEqual,
            BinaryOp::Add,
            BinaryOp::Sub,
            BinaryOp::Mul,
            BinaryOp::Div,
            BinaryOp::Rem,
        ]);
        let boxed = || inner.clone().prop_map(Box::new);
        prop_oneof![
            4 => (ops, boxed(), boxed()).prop_map(move |(op, a, b)| expr(ExprKind::Binary(op, a, b))),
            2 => (any::<bool>(), boxed()).prop_map(move |(neg, a)| {
                expr(ExprKind::Unary(if neg { UnaryOp::Neg } else { UnaryOp::Not }, a))
            }),
            1 => boxed().prop_map(move |a| expr(ExprKind::Field(a, name("x")))),
            1 => (boxed(), boxed()).prop_map(move |(a, b)| expr(ExprKind::Index(a, b))),
            1 => prop::collection::vec(inner.clone(), 0..3)
                .prop_map(move |args| expr(ExprKind::Call(name("f"), args))),
            1 => prop::collection::vec(inner.clone(), 2..4).prop_map(move |v| expr(ExprKind::Vector(v))),
            1 => prop::collection::vec(inner.clone(), 1..3).prop_map(move |v| expr(ExprKind::List(v))),
        ]
    })
}

/// A file in which some words have been left out, doubled or replaced by others of the same file.
fn mutated() -> impl Strategy<Value = String> {
    let texts: Vec<Vec<String>> = files("language").iter().map(|(_, text)| split(text)).collect();
    (prop::sample::select(texts), prop::collection::vec((any::<u32>(), any::<u32>(), 0..4), 1..4)).prop_map(
        |(mut words, changes)| {
            for (at, from, how) in changes {
                let (at, from) = (at as usize % words.len(), from as usize % words.len());
                match how {
                    0 => _ = words.remove(at),
                    1 => words.insert(at, words[from].clone()),
                    2 => words[at] = words[from].clone(),
                    _ => words.swap(at, from),
                }
            }
            words.concat()
        },
    )
}

/// Words, spaces and signs.
fn split(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for c in text.chars() {
        match words.last_mut() {
            Some(word) if c.is_alphanumeric() && word.ends_with(char::is_alphanumeric) => word.push(c),
            _ => words.push(c.into()),
        }
    }
    words
}

fn token() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "system", "module", "const", "param", "query", "template", "axiom", "rules", "place", "run", "eps",
        "let", "at", "on", "file", "with", "curve", "patch", "mesh", "bezier", "derive", "repeat", "if", "A",
        "B", "F", "x", "1", "2.5", "\"t\"", "(", ")", "[", "]", "{", "}", "+", "-", "*", "/", "%", "^", "&",
        "|", "!", "\\", "<", ">", "<=", "==", "=", "->", ",", ";", ":", ".", "..", "@", "?", "#", "\n", "\n",
        "ε", "é", "$",
    ])
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn expressions_round_trip(value in expressions()) {
        let constant = Const {
            name: Name { text: "x".into(), span: Span::default() },
            ty: None,
            value,
            span: Span::default(),
        };
        let file = RuleFile { version: None, items: vec![FileItem::Const(constant)] };
        let printed = print(&file);
        prop_assert_eq!(parsed(&printed), file, "{}", printed);
    }

    #[test]
    fn mutated_files_round_trip(text in mutated()) {
        errors(&text);
        round_trip(&text);
    }

    #[test]
    fn token_soup_is_harmless(tokens in prop::collection::vec(token(), 0..200)) {
        let soup = tokens.join(" ");
        errors(&soup);
        errors(&tokens.concat());
        round_trip(&soup);
        let inside = format!("system s : curve\nmodule A, B\naxiom: A\nrules:\n{soup}");
        errors(&inside);
        round_trip(&inside);
    }

    #[test]
    fn short_soup_round_trips(tokens in prop::collection::vec(token(), 0..8), kind in 0..3) {
        let soup = tokens.join(" ");
        let text = [curve(&format!("A -> {soup}")), patch(&format!("P -> {soup}")), mesh(&format!("A -> {soup}"))];
        round_trip(&text[kind as usize]);
        round_trip(&format!("system s : curve\nmodule A, B\naxiom: {soup}"));
    }

    #[test]
    fn bytes_are_harmless(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        match decode(&bytes) {
            Ok(text) => _ = errors(text),
            Err(error) => _ = shown(&[error], &String::from_utf8_lossy(&bytes)),
        }
        errors(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn text_is_harmless(text in any::<String>()) {
        errors(&text);
    }
}

#[test]
fn letters_of_papers_are_one_mistake_with_its_hint() {
    let with = |rule: &str| curve(&format!("  {rule}"));
    refused(&with("A -> λ"), code::UNKNOWN_CHARACTER, "`eps`");
    refused(&with("A -> B é B"), code::UNKNOWN_CHARACTER, "a to z");
    refused("system s : curve\nmodule A\nω : A\n", code::UNKNOWN_CHARACTER, "`axiom: …`");
    refused(&with("A (50%) -> F"), code::FOREIGN_RULE, "`->(0.5) …`");
}

#[test]
fn a_roll_at_the_end_of_a_line_gets_a_warning() {
    for word in ["\\", "F +(20) \\\n      F", "F \\\n  B -> C", "[ F \\\n    ] B", "F \\ // a comment"] {
        let text = curve(&format!("  A -> {word}"));
        refused(&text, code::ROLL_AT_END, "indented deeper");
        assert!(!parse(&text).has_errors());
        round_trip(&text);
    }
    for word in ["F \\ F", "F \\(20)\n    F", "F [ \\ F ]\n    F"] {
        parsed(&curve(&format!("  A -> {word}")));
    }
}
