//! Symbols: as many as 16 bits name, but for the mark of a word's end.

use super::one_group;
use crate::parity::system;
use burgeon::conformance;
use burgeon::language::{Vocabulary, compile};
use burgeon::plan::{Options, Plan};
use burgeon::{cpu, curve, patch};

#[test]
fn more_symbols_than_a_record_can_name_are_refused() {
    let names = |count: usize| (0..count).map(|n| format!("S{n}")).collect::<Vec<_>>().join(", ");
    let refused = |text: &str, symbol: &str| {
        let checked = compile(text, &Vocabulary::default());
        let found: Vec<_> = checked.diagnostics.iter().map(|d| (d.code, d.message.as_str())).collect();
        let message = format!("more than 65534 symbols in one system: `{symbol}` is one too many");
        assert_eq!(found, [("E0272", message.as_str())]);
    };
    let text = |count: usize, rule: &str| one_group(&names(count), "S0 = file \"x\"", rule, "derive 1");
    let split = "S0 -> [ S65533 | eps ]";
    let full = system(&text(65_534, split));
    let (plan, with_holes) = (Plan::new(&full).expect("a plan"), Plan::keeping_holes(&full).expect("a plan"));
    assert_eq!(with_holes.hole, Some(65_534));
    refused(&text(65_535, split), "S65534");
    // The inside of a nested block has a symbol of its own.
    let nested = |depth: usize| format!("S0 -> {}S1{}", "[ eps | ".repeat(depth), " ]".repeat(depth));
    assert!(Plan::new(&system(&text(65_534, &nested(2)))).is_ok());
    for refused in [
        Plan::new(&system(&text(65_534, &nested(3)))),
        Plan::keeping_holes(&system(&text(65_534, &nested(2)))),
    ] {
        let error = refused.expect_err("a record has 16 bits for the symbol").to_string();
        assert!(error.contains("65535 symbols"), "{error}");
    }
    // The turtle's symbols count where they occur.
    let curve = |count: usize, axiom: &str| {
        let last = count - 1;
        format!(
            "system s : curve open\nmodule {}\naxiom: {axiom} S{last} S{last}\nrules:\n  # < S{last} -> S0 S{last}\n  \
             S{last} > # -> S1\nrun:\n  derive 2\n",
            names(count)
        )
    };
    refused(&curve(65_534, "F"), "F");
    refused(&curve(65_533, "F +"), "+");
    assert!(Plan::new(&system(&curve(65_533, "F"))).is_ok());
    // The last symbol that there may be is no end of a word.
    let curve = system(&curve(65_534, ""));
    let axiom = curve::Axiom::load::<String>(&curve, &mut |_| Ok(vec![])).expect("an axiom");
    let curve = Plan::new(&curve).expect("a plan");
    let symbols = |word: curve::Word| word.modules.iter().map(|m| m.symbol).collect::<Vec<_>>();
    let words = |word: curve::Word| assert_eq!(symbols(word), [0, 65_533, 1]);
    words(cpu::derive(&curve, &axiom, &Options::default(), 1).expect("a word").0);
    let nets = conformance::lattice(1);
    let roots = patch::Axiom::load::<String>(&full, &mut |_| Ok(nets.clone())).expect("an axiom");
    let ends = |plan: &Plan, word: patch::Word| {
        let found: Vec<usize> = word.modules.iter().map(|m| m.symbol).collect();
        assert!(found == if plan.hole.is_some() { vec![65_533, 65_534] } else { vec![65_533] }, "{found:?}");
    };
    for plan in [&plan, &with_holes] {
        ends(plan, cpu::derive(plan, &roots, &Options::default(), 1).expect("a word").0);
    }
}
