//! Right contexts with branches: what stands where.

use super::Text;
use super::values::{from_word, literal};
use crate::plan::context::{Equal, Go, Operand, Place};
use crate::plan::graph::Scalar;
use crate::plan::tables::Tables;

/// `search_n(own)`: what the steps of a search find behind a module, the first way that meets all demands. A step is a
/// block inside that of the one before; one that looks for a branch is a loop.
pub fn searches(tables: &Tables) -> Text {
    let mut text = Text::default();
    for (n, search) in tables.searches.iter().enumerate() {
        let count = search.steps.len();
        text.line(format!("fn search_{n}(own: u32) -> array<u32, {count}> {{"));
        text.line(format!("  let first = beside(own, {}u);", search.last));
        let from = |step: Option<usize>| step.map_or("first".to_string(), |step| format!("s{step}"));
        let indent = |depth: usize| "  ".repeat(depth + 1);
        for (k, step) in search.steps.iter().enumerate() {
            let pad = indent(k);
            match step.go {
                Go::On(at) => text.line(format!("{pad}let s{k} = down_of({});", from(at))),
                Go::Branch { at, after } => {
                    let after = after.map_or("NOWHERE".to_string(), |after| format!("s{after}"));
                    let next = format!("next_branch({}, {after})", from(at));
                    text.line(format!(
                        "{pad}for (var s{k} = {next}; s{k} != NOWHERE; s{k} = next_branch({}, s{k})) {{",
                        from(at)
                    ));
                }
            }
            let symbol = format!("symbol_at(s{k}) == {}u", step.symbol);
            let tests: Vec<String> = std::iter::once(symbol).chain(step.tests.iter().map(equal)).collect();
            text.line(format!("{pad}if {} {{", tests.join(" && ")));
        }
        let found: Vec<String> = (0..count).map(|k| format!("s{k}")).collect();
        text.line(format!("{}return array<u32, {count}>({});", indent(count), found.join(", ")));
        for (k, step) in search.steps.iter().enumerate().rev() {
            let ends = if matches!(step.go, Go::Branch { .. }) { "} }" } else { "}" };
            text.line(format!("{}{ends}", indent(k)));
        }
        text.line(format!("  return array<u32, {count}>({});", vec!["NOWHERE"; count].join(", ")));
        text.line("}");
    }
    text
}

fn equal(test: &Equal) -> String {
    let float = test.a.scalar() == Scalar::Float || test.b.scalar() == Scalar::Float;
    let side = |operand: Operand| {
        let value = match operand {
            Operand::Literal(ty, word) => literal(ty, word),
            Operand::Word(ty, place, word) => {
                from_word(ty, &format!("word_at({}, {word}u)", place_text(place)))
            }
        };
        if float && operand.scalar() != Scalar::Float { format!("f32({value})") } else { value }
    };
    let (a, b) = (side(test.a), side(test.b));
    if float { format!("is_equal({a}, {b})") } else { format!("{a} == {b}") }
}

/// A place as the body of a search names it.
fn place_text(place: Place) -> String {
    match place {
        Place::Found { step, .. } => format!("s{step}"),
        Place::Previous => "previous(own)".to_string(),
        Place::Strict(n) => format!("beside(own, {n}u)"),
        Place::Before(n) => (0..n).fold("own".to_string(), |text, _| format!("up_of({text})")),
        Place::Behind { last, steps } => {
            (0..steps).fold(format!("beside(own, {last}u)"), |text, _| format!("down_of({text})"))
        }
    }
}
