//! The oracle's own tests: small systems whose words are worked out by hand.

use super::super::generate::curve::{CONSTRUCTS, KINDS};
use super::super::lots;
use super::super::{CurveCase, Random, curve_case, minimise_curve};
use super::*;
use crate::tier;
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{Severity, compile};

/// Every word, as it is written.
#[track_caller]
fn history(text: &str) -> Vec<String> {
    Job::new(text).derive().iter().map(Word::to_string).collect()
}

#[track_caller]
fn of(topology: &str, body: &str) -> Vec<String> {
    history(&format!("system s : curve {topology}\n{body}"))
}

/// The word after one step, without spaces.
#[track_caller]
fn next(topology: &str, axiom: &str, rules: &[&str]) -> String {
    let rules: String = rules.iter().map(|rule| format!("  {rule}\n")).collect();
    let body = format!("module A, B, C, D, E, X\naxiom: {axiom}\nrules:\n{rules}");
    of(topology, &body)[1].replace(' ', "")
}

// --- steps -------------------------------------------------------------------------------------

#[test]
fn first_rule_that_matches_fires_and_others_keep() {
    let body = "module A(n: int), B\naxiom: A(0) B\nrules:\n  A(n) : n < 2 -> A(n + 1)\n\
        A(n) -> A(n + 10) B\nrun:\n  derive 3\n";
    assert_eq!(of("open", body), ["A(0) B", "A(1) B", "A(2) B", "A(12) B B"]);
}

#[test]
fn keep_does_not_count_as_fired() {
    let body = "module A(k: int)\naxiom: A(2) A(0)\nrules:\n  A(k) -> A(max(k - 1, 0))\nrun:\n\
        derive until terminal max 9\n";
    assert_eq!(of("ring", body), ["A(2) A(0)", "A(1) A(0)", "A(0) A(0)"]);
    // Vectors and floats count bit by bit: −0 is not 0.
    let body = "module A(v: vec2)\naxiom: A((0, 1))\nrules:\n  A(v) : v.y > 0 -> A((-v.x, v.y))\nrun:\n\
        derive until terminal max 3\n";
    assert_eq!(of("open", body).len(), 4);
    let body = "module A\naxiom: A\nrules:\n  A -> A A\nrun:\n  derive until terminal max 3\n  derive 0\n";
    assert_eq!(of("open", body).len(), 4);
    // `derive n` counts idle steps.
    assert_eq!(of("tree", "module A\naxiom: A\nrun:\n  derive 2\n").len(), 3);
}

#[test]
fn groups_schedules_params() {
    let head = "param n: int = 1 in 0 .. 5\nmodule A(k: int)\naxiom: A(n)\nrules:\n\
        A(k) -> A(k + step + 1)\n\
                rules a:\n  A(2) -> A(100)\nrules b:\n  A(2) -> A(200)\n  A(k) -> A(k - 1)\nrun:\n";
    let run = |steps: &str| of("open", &format!("{head}{steps}")).join(" ");
    assert_eq!(run("  derive 3\n"), "A(1) A(2) A(4) A(7)");
    assert_eq!(run("  repeat 2 {\n    derive 1\n  }\n  derive n with b, a\n"), "A(1) A(2) A(3) A(2)");
    assert_eq!(run("  derive 1\n  if n == 1 {\n    derive 1 with a, b\n  }\n"), "A(1) A(2) A(100)");
    let text = format!("system s : curve\n{head}  derive n\n");
    let job = Job::new(&text).set("n", Param::Int(3));
    assert_eq!(job.derive().last().map(Word::to_string), Some("A(9)".to_string()));
    assert_eq!(Job { steps: Some(1), ..job }.derive().len(), 2);
}

#[test]
fn erasure_may_empty_a_word() {
    let body = "module A, B\naxiom: A A\nrules:\n  A > A -> eps\n  B -> A\nrun:\n  derive 3\n";
    assert_eq!(of("ring", body), ["A A", "", "", ""]);
    assert_eq!(next("open", "A B A", &["A -> eps", "# -> #", "B -> A eps B"]), "AB");
}

#[test]
fn patterns() {
    let body = "module A(k: int, v: vec2), B(k: int, x: float)\n\
        axiom: A(1, (2, 3)) A(2, (2, 3)) B(2, 2) A(5, (2, 3)) B(-1, 0)\nrules:\n  \
                A(_, v) < A(k, v) > B(k, k) -> B(k, v.x)\n  B(-1, _) -> B(0, 0.5)\n\
                A(5, v) > B(_, 0) -> A(6, v/2)\n";
    assert_eq!(of("open", body)[1], "A(1, (2, 3)) B(2, 2) B(2, 2) A(6, (1, 1.5)) B(0, 0.5)");
    let body = "module A(k: int)\nquery Q(n: int) = step + 2\naxiom: A(1) A(2)\nrules:\n\
        ?Q(n) A(n) > # let m = n * n : m > 3 -> A(m)\n";
    assert_eq!(of("open", body)[1], "A(1) A(4)");
}

// --- contexts ----------------------------------------------------------------------------------

#[test]
fn ends() {
    let rules = ["# < A > # -> X", "# < A -> B", "A > # -> C", "# A < A -> D", "A > A # -> E"];
    assert_eq!(next("open", "A A A A A A", &rules), "BDAAEC");
    assert_eq!(next("open", "A", &rules), "X");
    assert_eq!(next("ring", "A A A", &rules), "AAA");
    assert_eq!(next("tree", "A A [ A A A ] A [ A ] [ A A ] A", &rules), "BD[AEC]E[C][EC]C");
    // Two ends on one side are one.
    assert_eq!(next("open", "B A", &["# B < A > # -> C"]), "BC");
}

#[test]
fn ignored_symbols_are_skipped_in_contexts_only() {
    let body = |topology: &str, axiom: &str, rules: &str| {
        let body = format!("module A, B, C, D, X\nignore X D\naxiom: {axiom}\nrules:\n{rules}");
        of(topology, &body)[1].replace(' ', "")
    };
    assert_eq!(body("open", "A X D B X", "  A < B > # -> C\n"), "AXDCX");
    assert_eq!(body("open", "X A", "  # < A -> C\n"), "XC");
    // As a strict predecessor it is not skipped, and its own contexts are read.
    assert_eq!(body("open", "A X B", "  A < X > B -> C\n  A B -> D\n"), "ACB");
    // What is ignored never matches in a context.
    assert_eq!(body("open", "X A X", "  X < A -> C\n  A > X -> C\n"), "XAX");
    // A ring of one that is seen sees itself; of none nothing.
    assert_eq!(body("ring", "X A D", "  A < A > A A -> C\n  A < X > A -> B\n  X < D -> C\n"), "BCD");
    assert_eq!(body("ring", "X D", "  X < D -> C\n  D < X -> C\n"), "XD");
    // In a tree as if it were erased: its branches hang on what it hangs on.
    assert_eq!(body("tree", "A X [ B ] [ D ] C", "  A > [ B # ] C -> X\n  A < B -> D\n"), "XX[D][D]C");
    assert_eq!(body("tree", "A [ X [ B ] C ]", "  A > [ B ] [ C ] # -> D\n"), "D[X[B]C]");
    assert_eq!(body("tree", "A [ X ] X", "  A > # -> B\n"), "B[X]X");
}

#[test]
fn brackets_match_different_branches_in_order() {
    let fires =
        |axiom: &str, right: &str| next("tree", axiom, &[&format!("X > {right} -> E")]).starts_with('E');
    assert!(fires("X [ A ] [ B ] C", "[ A ]") && fires("X [ A ] [ B ] C", "[ B ] C"));
    assert!(fires("X [ A ] [ B ] C", "[ A ] [ B ]") && !fires("X [ A ] [ B ] C", "[ B ] [ A ]"));
    assert!(!fires("X [ A ] C", "[ A ] [ A ]") && fires("X [ A ] [ C ] [ A ] C", "[ A ] [ A ] C #"));
    assert!(fires("X [ A B ] [ A C ]", "[ A C ]") && !fires("X [ A B ] [ A C ]", "[ A # ]"));
    assert!(fires("X [ A [ B ] [ C ] D ] E", "[ A [ C ] D # ] E #"));
    // The place of a bracket is where it stands.
    assert!(fires("X [ A ] C [ B ] D", "C [ B ] D") && !fires("X [ A ] C [ B ] D", "C [ A ]"));
    assert!(!fires("X [ A ] C", "A") && !fires("X A", "[ A ]"));
    // A bracket that begins with one is two, in words as in contexts.
    assert!(fires("X [ [ A ] B ] C", "[ A ] [ B ] C") && fires("X [ A ] [ B ] C", "[ [ A ] B ] C"));
    assert!(!fires("X [ A ]", "[ # ]"));
}

/// Of several ways to match, one that agrees with all that is bound; of those the first.
#[test]
fn any_branch_may_match() {
    let body = |right: &str, successor: &str| {
        let axiom = "X [ A(1) ] [ A(2) ] [ B(2) ] [ A(3) ] [ B(3) ] C";
        let body = format!(
            "module X, A(k: int), B(k: int), C, D(k: int)\naxiom: {axiom}\nrules:\n\
                X > {right} -> {successor}\n"
        );
        of("tree", &body)[1].split(' ').next().expect("a word").to_string()
    };
    assert_eq!(body("[ A(k) ]", "D(k)"), "D(1)");
    assert_eq!(body("[ A(2) ]", "D(2)"), "D(2)");
    assert_eq!(body("[ A(k) ] [ B(k) ]", "D(k)"), "D(2)");
    assert_eq!(body("[ A(_) ] [ A(k) ] [ B(k) ]", "D(k)"), "D(2)");
    assert_eq!(body("[ B(_) ] [ A(k) ] [ B(k) ] C", "D(k)"), "D(3)");
    // The condition is asked of the way that was found, and finds no other.
    assert_eq!(body("[ A(k) ] : k > 1", "D(k)"), "X");
}

/// The links of a word are what its brackets mean, whatever vanishes.
#[test]
fn what_hangs_on_the_vanished() {
    let erased = |axiom: &str| next("tree", axiom, &["E -> eps"]);
    assert_eq!(erased("A E [ B ] C"), "A[B]C");
    assert_eq!(erased("A [ E [ B ] C ] D"), "A[[B]C]D");
    assert_eq!(erased("A [ E [ E ] ] E [ E ]"), "A");
    assert_eq!(erased("E [ A ] B"), "[A]B");
    let links = |axiom: &str| {
        let body =
            format!("system s : curve tree\nmodule A, B, C, D, E\naxiom: {axiom}\nrules:\n  E -> eps\n");
        let link = |l: Link| (l.parent, l.lateral);
        Job::new(body).derive()[1].links().into_iter().map(link).collect::<Vec<_>>()
    };
    let expected = [(None, false), (Some(0), true), (Some(0), true), (Some(0), false)];
    for axiom in ["A [ E [ B ] C ] D", "A [ B ] [ C ] D", "A E [ B ] E [ C ] D", "A [ [ B ] [ C ] ] E D"] {
        assert_eq!(links(axiom), expected, "{axiom}");
    }
    assert_eq!(links("E [ A B ] C"), [(None, true), (Some(0), false), (None, false)]);
    // A successor's branch stands where its predecessor stood.
    assert_eq!(next("tree", "A [ B ] C", &["A -> A [ D E ]", "B -> [ X ] B"]), "A[DE][[X]B]C");
}

/// ABOP's way to look for contexts in a string with brackets finds the same.
#[test]
fn contexts_as_a_scan_of_the_string() {
    let mut random = Random::new(18);
    let (mut fired, mut missed) = (0, 0);
    for _ in 0..400 {
        let mut axiom = String::new();
        grow(&mut random, &mut axiom, 0);
        let context = |random: &mut Random| -> Vec<char> {
            (0..random.below(4)).map(|_| *random.pick(&['A', 'B', 'C'])).collect()
        };
        let (left, right) = (context(&mut random), context(&mut random));
        let spaced = |symbols: &[char]| symbols.iter().map(char::to_string).collect::<Vec<_>>().join(" ");
        let mut rule = "A -> X".to_string();
        if !right.is_empty() {
            rule = rule.replace("A ->", &format!("A > {} ->", spaced(&right)));
        }
        if !left.is_empty() {
            rule = format!("{} < {rule}", spaced(&left));
        }
        let string: Vec<char> = axiom.chars().filter(|c| *c != ' ').collect();
        let scan =
            |at: usize| string[at] == 'A' && scan_left(&string, at, &left) && scan_right(&string, at, &right);
        let expected: String = (0..string.len()).map(|at| if scan(at) { 'X' } else { string[at] }).collect();
        fired += expected.matches('X').count();
        missed += expected.matches('A').count();
        assert_eq!(next("tree", &axiom, &[&rule]), expected, "{rule}");
    }
    assert!(fired > 200 && missed > 500, "{fired} {missed}");
}

/// A random string whose branches do not begin with branches and are not empty.
fn grow(random: &mut Random, text: &mut String, depth: usize) {
    for _ in 0..random.range(1, 5) {
        text.push_str(random.pick::<&str>(&["A ", "A ", "B ", "C "]));
        while depth < 3 && random.chance(30) {
            text.push_str("[ ");
            grow(random, text, depth + 1);
            text.push_str("] ");
        }
    }
}

fn scan_left(string: &[char], at: usize, context: &[char]) -> bool {
    let (mut at, mut skip) = (at, 0);
    context.iter().rev().all(|wanted| {
        while at > 0 {
            at -= 1;
            match string[at] {
                ']' => skip += 1,
                '[' if skip > 0 => skip -= 1,
                '[' => {}
                found if skip == 0 => return found == *wanted,
                _ => {}
            }
        }
        false
    })
}

fn scan_right(string: &[char], at: usize, context: &[char]) -> bool {
    let (mut at, mut skip) = (at, 0);
    context.iter().all(|wanted| {
        while at + 1 < string.len() {
            at += 1;
            match string[at] {
                '[' => skip += 1,
                ']' if skip == 0 => return false,
                ']' => skip -= 1,
                found if skip == 0 => return found == *wanted,
                _ => {}
            }
        }
        false
    })
}

// --- several strict predecessors ---------------------------------------------------------------

#[test]
fn pairs_from_left_to_right() {
    let pair = "A B -> C";
    assert_eq!(next("open", "A B A A B B", &[pair, "A -> D", "B -> E"]), "CDCE");
    // At a position the first listed wins, and a single rule takes its module from the pair.
    assert_eq!(next("open", "A B A A B B", &["A -> D", pair, "B -> E"]), "DEDDEE");
    assert_eq!(next("open", "A B A A B B", &["B -> E", pair]), "CACE");
    assert_eq!(next("open", "A A A A A", &["A A -> B"]), "BBA");
    assert_eq!(next("open", "A A A A A", &["A A A -> B", "A -> C"]), "BCC");
    // Never across the start of a ring; contexts go around it, and into what others take.
    assert_eq!(next("ring", "B A", &[pair]), "BA");
    assert_eq!(next("ring", "A A A A", &["A A < A A > A A -> B"]), "BB");
    assert_eq!(next("open", "A A A A", &["A A > A -> B", "A A -> C"]), "BC");
    assert_eq!(next("open", "A B A B", &["A B > # -> eps"]), "AB");
}

#[test]
fn pairs_in_trees() {
    assert_eq!(next("tree", "A [ A B ] B", &["A B -> C"]), "A[C]B");
    assert_eq!(next("tree", "A B [ A ] B", &["A B -> C [ D ]"]), "C[D][A]B");
    // The context behind is that of the last, before that of the first.
    assert_eq!(next("tree", "X A B [ D ] C", &["X < A B > [ D ] C -> E"]), "XE[D]C");
    assert_eq!(next("tree", "A [ B A ]", &["A < B A -> E"]), "A[E]");
}

// --- axioms ------------------------------------------------------------------------------------

#[test]
fn axioms_of_points() {
    let points = vec![vec![0.0, 1.0], vec![2.0, 3.0], vec![4.0, 5.0]];
    let axiom = |topology: &str, module: &str, axiom: &str| {
        let text =
            format!("system s : curve {topology}\nmodule {module}\naxiom: {axiom}\nrun:\n  derive 0\n");
        Job::new(text).points(&points).derive()[0].to_string()
    };
    assert_eq!(axiom("ring", "P(v: vec2)", "file \"x\""), "P((0, 1)) P((2, 3)) P((4, 5))");
    assert_eq!(axiom("ring", "P(v: vec2)", "file \"x\" shift 1"), "P((2, 3)) P((4, 5)) P((0, 1))");
    assert_eq!(axiom("ring", "P(v: vec2)", "file \"x\" shift -4"), "P((4, 5)) P((0, 1)) P((2, 3))");
    assert_eq!(axiom("open", "P(v: vec3)", "file \"x\""), "P((0, 1, 0)) P((2, 3, 0)) P((4, 5, 0))");
    assert_eq!(
        axiom("ring", "P(k: int, v: vec2)", "P(7, _) = [(1, 2), (3, 4)] shift 1"),
        "P(7, (3, 4)) P(7, (1, 2))"
    );
}

#[test]
fn an_earlier_system_as_axiom() {
    let text = "param n: int = 2\nsystem a : curve\nmodule A(k: int)\naxiom: A(0)\nrules:\n\
        A(k) -> A(k) A(k + 1)\nrun:\n  derive n\n\
                system b : curve ring\nmodule A(k: int)\naxiom: a\nrules:\n  A(k) -> A(k * 10)\n";
    assert_eq!(history(text), ["A(0) A(1) A(1) A(2)", "A(0) A(10) A(10) A(20)"]);
    let turned = text.replace("axiom: a", "axiom: a shift 3");
    assert_eq!(Job::new(turned).set("n", Param::Int(1)).derive()[0].to_string(), "A(1) A(0)");
}

// --- random numbers ----------------------------------------------------------------------------

#[test]
fn the_hash_is_frozen() {
    let hashes = [lots::hash(0, 0), lots::hash(1, 2), lots::hash(0xffff_ffff, 0x1234_5678)];
    assert_eq!(hashes, [0x9bb3_1115, 0x01e9_5d13, 0xe53a_dcfd]);
    assert_eq!(lots::rule_site(Some("a"), 7), 0xe40c_292c);
    assert_eq!(lots::number("rand", &[], u32::MAX), 1.0 - 0.5f64.powi(24));
    assert_eq!(lots::number("rand", &[-1.0, 3.0], 0x8000_0000), 1.0);
}

#[test]
fn paths_are_hashes_of_slots() {
    let text = "system s : curve tree\nmodule A, B, C\naxiom: A [ B ] C A\nrules:\n\
        A > [ B ] -> A eps [ B C ] eps C\n  B -> C\n  C A -> B eps\n";
    let word = &Job::new(text).derive()[1];
    assert_eq!(word.to_string().replace(' ', ""), "A[BC]C[C]B");
    let paths: Vec<lots::Path> = word.modules().map(|m| m.path).collect();
    let slot = |root: usize, slot: u32| lots::child(lots::root(root), slot);
    let expected = [slot(0, 0), slot(0, 2), slot(0, 3), slot(0, 5), lots::root(1), slot(2, 0)];
    assert_eq!(paths, expected);
    assert_eq!(lots::root(5), [0, 5]);
    assert_eq!(lots::child([3, 4], 9), [lots::hash(3, 9), lots::hash(4, lots::hash(3, 9))]);
}

#[test]
fn numbers_follow_from_seed_step_path_and_site() {
    let text = "param seed: int = 5\nsystem s : curve\nmodule A(x: float), B(x: float, y: float)\n\
        axiom: A(0) B(0, 0)\nrules:\n  A(x) -> A(rand())\n  \
                named: B(x, y) let z = rand(1, 3) : randn() < 100 -> B(rand(), z)\nrun:\n  derive 2\n";
    let words = Job::new(text).derive();
    let value = |step: usize, index: usize, field: usize| {
        words[step].modules().nth(index).expect("a module").params[field].floats()[0]
    };
    for step in [0, 1] {
        let unit = |root: usize, site: u32, call: u32| {
            f64::from(lots::draw(5, step, lots::root(root), site, call) >> 8) / 16_777_216.0
        };
        let named = lots::rule_site(Some("named"), 1);
        assert_eq!(value(step as usize + 1, 0, 0), unit(0, lots::rule_site(None, 0), 0));
        assert_eq!(value(step as usize + 1, 1, 0), unit(1, named, 2));
        assert_eq!(value(step as usize + 1, 1, 1), 1.0 + 2.0 * unit(1, named, 0));
    }
    let other = Job { seed: Some(6), ..Job::new(text) }.derive();
    assert_ne!(other[1], words[1]);
    assert_eq!(Job { seed: Some(5), ..Job::new(text) }.derive(), words);
}

#[test]
fn an_edit_in_one_branch_rolls_that_branch_alone() {
    let text = "system s : curve tree\nmodule R, A(x: float), B(x: float)\naxiom: R\nrules:\n\
        R -> [ A(0) ] [ B(0) ]\n  \
                a: A(x) -> A(rand()) [ A(rand()) ]\n  b: B(x) -> B(rand()) B(rand())\nrun:\n  derive 4\n";
    let edited = text.replace("b: B(x) -> B(rand()) B(rand())", "b: B(x) ->(1) B(rand()) ->(2) eps");
    let of_a = |text: &str| {
        let word = Job::new(text).derive().pop().expect("a word");
        let modules: Vec<Module> = word.modules().filter(|m| m.symbol == "A").cloned().collect();
        modules
    };
    assert_eq!(of_a(text).len(), 8);
    assert_eq!(of_a(text), of_a(&edited));
    let mut paths: Vec<_> = of_a(text).iter().map(|m| m.path).collect();
    paths.sort_unstable();
    paths.dedup();
    assert_eq!(paths.len(), 8);
}

#[test]
fn weights_are_drawn_in_proportion() {
    let text = "system s : curve ring\nmodule P, A, B, C\naxiom: P\nrules grow:\n  P -> P P\nrules draw:\n  \
                P ->(1) A\n    ->(2) B\n    ->(if(step > 0, 1, -1)) C\n    ->(5) eps\nrun:\n\
                derive 14 with grow\n  derive 1 with draw\n";
    let word = Job { seed: Some(3), ..Job::new(text) }.derive().pop().expect("a word");
    let share = |symbol: &str| word.modules().filter(|m| m.symbol == symbol).count() as f64 / 16384.0;
    assert!(
        (share("A") - 0.125).abs() < 0.01 && (share("B") - 0.25).abs() < 0.015,
        "{} {}",
        share("A"),
        share("B")
    );
    assert_eq!(share("C"), 0.0);
    // All 0: the rule does not match, and the next one is tried.
    let body = "module A(k: int)\naxiom: A(0) A(1)\nrules:\n  A(k) ->(k) A(5) ->(2*k) A(5)\n  A(k) -> A(9)\n";
    assert_eq!(of("open", body)[1], "A(9) A(5)");
}

// --- the turtle --------------------------------------------------------------------------------

/// The points traced from a word, rounded, with its brackets.
fn traced(topology: &str, word: &str) -> String {
    let body = format!("module P(v: vec3), X\naxiom: {word}\nrun:\n  trace into P\n");
    let words = Job::new(format!("system s : curve {topology}\n{body}")).derive();
    let round = |p: &Param| {
        let whole = |x: &f64| format!("{}", (x * 10.0).round() / 10.0 + 0.0);
        p.floats().iter().map(whole).collect::<Vec<_>>().join(" ")
    };
    let token = |token: &Token| match token {
        Token::Module(module) => round(&module.params[0]),
        other => other.to_string(),
    };
    words[1].tokens.iter().map(token).collect::<Vec<_>>().join("; ")
}

#[test]
fn turns() {
    let end = |turns: &str| traced("open", &format!("{turns} F")).split_off("0 0 0; ".len());
    assert_eq!(traced("open", "X"), "0 0 0");
    assert_eq!(end(""), "0 1 0");
    // Left is −x, up is +z.
    assert_eq!([end("+"), end("-"), end("|")], ["-1 0 0", "1 0 0", "0 -1 0"]);
    assert_eq!([end("^"), end("&")], ["0 0 1", "0 0 -1"]);
    // Rolled to the left, left points down; rolled to the right, up.
    assert_eq!([end("\\ +"), end("/ +")], ["0 0 -1", "0 0 1"]);
    assert_eq!([end("\\ ^"), end("/ ^")], ["-1 0 0", "1 0 0"]);
    // Turned to the left, pitching up still goes up; the axes are the turtle's own.
    assert_eq!([end("+ ^"), end("^ +"), end("^ ^")], ["0 0 1", "-1 0 0", "0 -1 0"]);
    assert_eq!([end("+(30)"), end("-(-30)"), end("|(90)")], ["-0.5 0.9 0", "-0.5 0.9 0", "-1 0 0"]);
    let body = "const angle = 60\nmodule P(v: vec2)\naxiom: F(2) + F + | F(0.5)\nrun:\n  trace into P\n";
    let word = Job::new(format!("system s : curve\n{body}")).derive().pop().expect("a word");
    let flat: Vec<i64> = word
        .modules()
        .flat_map(|m| m.params[0].floats().to_vec())
        .map(|x| (x * 100.0).round() as i64)
        .collect();
    assert_eq!(flat, [0, 0, 0, 200, -87, 250, -43, 275]);
}

#[test]
fn curves_and_branches_of_the_turtle() {
    assert_eq!(traced("open", "F f F"), "0 0 0; 0 1 0; ,; 0 2 0; 0 3 0");
    assert_eq!(traced("ring", "F + F + F + F"), "0 0 0; 0 1 0; -1 1 0; -1 0 0");
    assert_eq!(traced("ring", "X"), "0 0 0");
    assert_eq!(traced("tree", "F [ + F F ] [ - X ] F"), "0 0 0; 0 1 0; [; -1 1 0; -2 1 0; ]; 0 2 0");
    assert_eq!(traced("tree", "F [ f F ] F"), "0 0 0; 0 1 0; [; ,; 0 2 0; 0 3 0; ]; 0 2 0");
    let words = Job::new(
        "system s : curve tree\nmodule P(r: float, v: vec2), Q(v: vec2)\n\
        axiom: F !(0.5) [ ! (2) F ! F ] F f F\n\
        rules:\n  # < P(r, v) -> Q(v)\n  Q < P(r, v) > # -> Q(v)\nrun:\n  trace into P\n  derive 1\n"
            .replace("! (2)", "!(2)"),
    )
    .derive();
    let widths: Vec<f64> = words[1].modules().map(|m| m.params[0].floats()[0]).collect();
    assert_eq!(widths, [1.0, 1.0, 2.0, 1.0, 0.5, 0.5, 0.5]);
    let links: Vec<(Option<usize>, bool)> = words[1].links().iter().map(|l| (l.parent, l.lateral)).collect();
    let expected = [
        (None, false),
        (Some(0), false),
        (Some(1), true),
        (Some(2), false),
        (Some(1), false),
        (None, false),
        (Some(5), false),
    ];
    assert_eq!(links, expected);
    // Each curve has ends of its own.
    let symbols: String =
        words[2].tokens.iter().map(|t| t.to_string().chars().next().expect("a token")).collect();
    assert_eq!(symbols, "QP[PP]P,QP");
    // A trace is a step of the run, and its points are roots.
    assert_eq!(words.len(), 3);
    assert!(words[1].modules().enumerate().all(|(i, m)| m.path == lots::root(i)));
}

#[test]
fn a_curve_that_is_erased_leaves_no_break() {
    let body = "module P(v: vec2)\naxiom: F f F f F\nrules:\n  P(v) : v.y == 2 || v.y == 3 -> eps\n\
        rules first:\n  P(v) : v.y < 2 -> eps\n\
                run:\n  trace into P\n  derive 1\n  derive 1 with first\n";
    let words = of("open", body);
    assert_eq!(words[2], "P((0, 0)) P((0, 1)) , P((0, 4)) P((0, 5))");
    assert_eq!(words[3], "P((0, 4)) P((0, 5))");
}

// --- the comparison ----------------------------------------------------------------------------

#[test]
fn every_difference_is_found_and_named() {
    let text = "system s : curve tree\nmodule A(k: int, b: bool), B(x: float, v: vec2)\n\
        axiom: A(1, true) [ B(0, (1, 2)) ] A(2, false)\nrules:\n  \
                A(k, b) > [ B ] -> A(k, b) B(k/3, (k, 0.1))\n";
    let word = Job::new(text).derive().pop().expect("a word");
    let good = see(&word);
    let error = |break_it: &dyn Fn(&mut Seen)| {
        let mut bad = good.clone();
        break_it(&mut bad);
        compare(&word, &bad, Tolerance::Exact).expect_err("a difference")
    };
    assert_eq!(compare(&word, &good, Tolerance::Exact), Ok(()));
    assert!(error(&|w| w.modules[1].symbol = "A".into()).contains("module 1: the symbols differ"));
    assert!(error(&|w| w.modules[0].params[0] = Param::Int(0)).contains("parameter 0 is Int(1) and Int(0)"));
    assert!(error(&|w| w.modules[0].params[0] = Param::Float(1.0)).contains("parameter 0"));
    assert!(error(&|w| w.modules[0].params[1] = Param::Bool(false)).contains("parameter 1"));
    assert!(error(&|w| w.modules[1].params[1] = Param::Vec2([1.0, 0.2])).contains("parameter 1"));
    assert!(error(&|w| w.modules[1].params[1] = Param::Vec3([1.0, 0.1, 0.0])).contains("parameter 1"));
    assert!(error(&|w| w.modules[1].params[0] = Param::Float(f64::NAN)).contains("NaN"));
    assert!(error(&|w| w.modules[1].params.truncate(1)).contains("numbers of parameters"));
    assert!(error(&|w| w.modules[2].path = Some([1, 1])).contains("module 2: the paths differ"));
    let moved = Link { parent: Some(0), lateral: true };
    assert!(error(&|w| w.modules[2].link = Some(moved)).contains("module 2: the links differ"));
    let fewer = error(&|w| w.modules.truncate(2));
    assert!(
        fewer.contains("the oracle has 4 modules, the engine 2; the next is SeenModule { symbol: \"B\""),
        "{fewer}"
    );
    let extra: &SeenModule = &good.modules[0];
    assert!(error(&|w| w.modules.push(extra.clone())).contains("the engine 5"));
    // What an engine does not tell is not compared; what it rounds may be near.
    let mut near = good.clone();
    near.modules.iter_mut().for_each(|m| (m.path, m.link) = (None, None));
    assert_eq!(compare(&word, &near, Tolerance::Exact), Ok(()));
    near.modules[1].params[1] = Param::Vec2([1.0, f64::from(0.1f32)]);
    assert!(compare(&word, &near, Tolerance::Exact).is_err());
    assert_eq!(compare(&word, &near, Tolerance::Near { c: 1.0 }), Ok(()));
}

#[test]
#[should_panic(expected = "after step 1: the oracle has 1 modules, the engine 0")]
fn a_missing_module_stops_the_test() {
    let words = Job::new("system s : curve\nmodule A\naxiom: A\n").derive();
    assert_same(1, &words[1], &Seen { modules: Vec::new() }, Tolerance::Exact);
}

// --- the generator -----------------------------------------------------------------------------

#[test]
fn a_number_is_a_case() {
    for number in 0..30 {
        let (a, b) = (curve_case(number), curve_case(number));
        assert_eq!(a.to_string(), b.to_string());
    }
}

fn rounded(param: &Param) -> Param {
    match *param {
        Param::Float(x) => Param::Float(f64::from(x as f32)),
        Param::Vec2(v) => Param::Vec2(v.map(|x| f64::from(x as f32))),
        Param::Vec3(v) => Param::Vec3(v.map(|x| f64::from(x as f32))),
        other => other,
    }
}

/// Every construct occurs, in rules that fire; texts check, words are bounded and exact in f32.
#[test]
fn cases_are_varied_and_bounded() {
    let count: u64 = tier::cases(100, 400);
    let mut text = String::new();
    let mut fired = std::collections::BTreeMap::<&str, usize>::new();
    let (mut alive, mut grown, mut ignored, mut topologies) = (0, 0, 0, [0; 3]);
    for number in 0..count {
        let case = curve_case(number);
        let checked = compile(&case.job.text, &Vocabulary::default());
        let error = checked.diagnostics.iter().find(|d| d.severity == Severity::Error);
        assert!(error.is_none(), "{error:?} in {case}");
        let words = case.job.derive();
        assert!(words.len() <= 9 && words.iter().all(|w| w.len() <= 1500), "{case}");
        for module in words.iter().flat_map(Word::modules).filter(|_| case.exact) {
            assert!(module.params.iter().all(|p| *p == rounded(p)), "{module} in {case}");
        }
        alive += u32::from(words.windows(2).any(|w| w[0].tokens != w[1].tokens));
        grown += u32::from(words.iter().any(|w| w.len() >= 4 * words[0].len().max(2)));
        topologies[words[0].topology as usize] += 1;
        if let Some(line) = case.job.text.lines().find(|line| line.starts_with("ignore ")) {
            let seen =
                Job { text: case.job.text.replace(line, ""), ..case.job.clone() }.derive_within(20_000);
            ignored += u32::from(seen.as_ref() != Some(&words));
        }
        for kind in case.fired() {
            *fired.entry(kind).or_default() += 1;
        }
        text += &case.job.text;
    }
    let part = |of_400: u64| (of_400 * count / 400) as u32;
    assert!(alive > part(350) && grown > part(150) && ignored > part(20), "{alive} {grown} {ignored}");
    assert!(topologies.iter().all(|n| *n > tier::cases(10, 80)), "{topologies:?}");
    assert_eq!(fired.len(), KINDS.len(), "{fired:?}");
    assert!(fired.values().all(|n| *n >= part(8) as usize), "{fired:?}");
    for construct in CONSTRUCTS {
        assert!(text.contains(construct), "no case has `{construct}`");
    }
}

#[test]
fn a_case_shrinks_to_what_fails() {
    let parses = |text: &str| burgeon::language::parse::parse(text).diagnostics.is_empty();
    let large = (0..).map(curve_case).find(|c| c.job.text.matches("derive").count() > 2).expect("a case");
    let fails = |c: &CurveCase| parses(&c.job.text) && c.job.text.contains("derive");
    let small = minimise_curve(&large, fails);
    assert!(small.job.text.lines().count() <= 4, "{}", small.job.text);
}

/// All curve systems of the test data derive.
#[test]
fn the_files_derive() {
    let files = [
        include_str!("../../data/language/chaikin.burgeon"),
        include_str!("../../data/language/chaikin_open.burgeon"),
        include_str!("../../data/language/cubic.burgeon"),
        include_str!("../../data/language/dlg.burgeon"),
        include_str!("../../data/language/dragon.burgeon"),
        include_str!("../../data/language/elevate.burgeon"),
        include_str!("../../data/language/four_point_open.burgeon"),
        include_str!("../../data/language/hilbert3d.burgeon"),
        include_str!("../../data/language/koch.burgeon"),
        include_str!("../../data/language/kolam.burgeon"),
        include_str!("../../data/language/lane_riesenfeld.burgeon"),
        include_str!("../../data/language/ternary.burgeon"),
        include_str!("../../data/language/twig.burgeon"),
        include_str!("../../data/language/unchaikin.burgeon"),
    ];
    let points: Vec<Vec<f64>> =
        (0..16).map(|i| vec![f64::from(i * i % 11), f64::from(i * 5 % 7), 1.0]).collect();
    for text in files {
        let names = text.lines().filter_map(|line| line.strip_prefix("system ")?.split(' ').next());
        for name in names {
            let words = Job::new(text).system(name).points(&points).derive();
            assert!(words.len() > 3 && words.windows(2).all(|w| w[0] != w[1]), "{name}");
            let size =
                |w: &Word| w.modules().flat_map(|m| &m.params).flat_map(Param::floats).all(|x| x.is_finite());
            assert!(words.iter().all(size), "{name}");
        }
    }
}
