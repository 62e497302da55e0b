//! What the rules say, as WGSL: which rule matches, and each successor's symbol and parameters.

mod matching;
mod searches;
mod successors;
mod values;

pub use matching::matching;
pub use searches::searches;
pub use successors::{cells, only_children, only_production, successors};

use crate::language::Span;
use crate::plan::layout::Layout;
use crate::plan::measure::{MEASURES, Row};
use crate::plan::placement::Placement;
use crate::plan::tables::Tables;
use crate::plan::turtle::Turtle;
use values::{Values, lane};

/// Lines of WGSL, each with the rule it says.
#[derive(Clone, Debug, Default)]
pub struct Text {
    pub lines: Vec<(String, Option<Span>)>,
}

impl Text {
    pub fn line(&mut self, line: impl Into<String>) {
        self.lines.push((line.into(), None));
    }
    fn of_rule(&mut self, line: impl Into<String>, span: Span) {
        self.lines.push((line.into(), Some(span)));
    }
}

/// The record as the registers of an invocation, and how it is read.
pub fn record(layout: &Layout) -> Text {
    let quads = layout.record_words / 4;
    let list = |f: &dyn Fn(usize) -> String| (0..quads).map(f).collect::<Vec<_>>().join(", ");
    let mut text = Text::default();
    // With the number of the module in the chunk, by which its attributes are found.
    text.line(format!("struct Record {{ {}, index: u32 }}", list(&|q| format!("q{q}: vec4u"))));
    text.line("fn read_record(i: u32) -> Record {");
    text.line("  let b = (i + HALO) * QUADS;");
    text.line(format!("  return Record({}, i);", list(&|q| format!("records[b + {q}u]"))));
    text.line("}");
    text
}

/// How a record is written.
pub fn write_record(layout: &Layout) -> Text {
    let mut text = Text::default();
    text.line("fn write_record(at: u32, r: Record) {");
    text.line("  let b = (at + HALO) * QUADS;");
    for q in 0..layout.record_words / 4 {
        text.line(format!("  next_records[b + {q}u] = r.q{q};"));
    }
    text.line("}");
    text
}

/// Where the row of a module holds each attribute.
pub fn measures(row: &Row) -> Text {
    let mut text = Text::default();
    for (place, measure) in row.places.iter().zip(MEASURES) {
        let place = place.map_or("NOWHERE".to_string(), |at| format!("{at}u"));
        text.line(format!("const {} = {place};", measure.place));
    }
    text
}

/// `ignored(symbol)`: whether contexts look past it.
pub fn ignored(tables: &Tables) -> Text {
    let mut text = Text::default();
    let ignored = tables.ignored.iter().enumerate().filter(|(_, ignored)| **ignored);
    let tests: Vec<String> = ignored.map(|(symbol, _)| format!("symbol == {symbol}u")).collect();
    let any = if tests.is_empty() { "false".to_string() } else { tests.join(" || ") };
    text.line(format!("fn ignored(symbol: u32) -> bool {{ return {any}; }}"));
    text
}

/// `command_of(symbol)`, `argument_of(m)` and `link_of(m)`: what the turtle reads of a module.
pub fn commands(turtle: &Turtle, layout: &Layout) -> Text {
    let mut text = Text::default();
    text.line("fn command_of(symbol: u32) -> u32 {");
    text.line("  switch symbol {");
    for (symbol, command) in turtle.commands.iter().enumerate() {
        if let Some(command) = command {
            text.line(format!("    case {symbol}u: {{ return {}u; }}", command.code()));
        }
    }
    text.line("    default: { return 0u; }");
    text.line("  }");
    text.line("}");
    text.line(format!("fn argument_of(m: Record) -> u32 {{ return {}; }}", lane(turtle.argument)));
    if let Some(link) = layout.link {
        text.line(format!("fn link_of(m: Record) -> u32 {{ return {}; }}", lane(link)));
    }
    text
}

/// `placement(m)`: what is added to the smooth position of a record, and `placed_symbol`: the leaves between which vertices are
/// moved. Without a placement nobody asks.
pub fn placement(placement: Option<&Placement>) -> Text {
    let mut text = Text::default();
    text.line("fn placement(m: Record) -> vec3f {");
    match placement {
        None => text.line("  return vec3f(0.0);"),
        Some(p) => {
            let values = Values::new(&mut text, &p.graph, p.offset.into_iter(), "  ", p.span);
            let [x, y, z] = p.offset.map(|id| values.text(id));
            text.of_rule(format!("  return vec3f({x}, {y}, {z});"), p.span);
        }
    }
    text.line("}");
    let on = placement.map_or(&[][..], |p| &p.on);
    let tests: Vec<String> = on.iter().map(|symbol| format!("symbol == {symbol}u")).collect();
    let any = if tests.is_empty() { "true".to_string() } else { tests.join(" || ") };
    text.line(format!("fn placed_symbol(symbol: u32) -> bool {{ return {any}; }}"));
    text
}
