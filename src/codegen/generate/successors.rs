//! What modules become: the symbol and the parameters of each child.

use super::Text;
use super::values::{Values, lane};
use crate::plan::code::ChildCode;
use crate::plan::graph::Node;
use crate::plan::layout::Layout;
use crate::plan::tables::{Production, Stage};

/// Cases of one switch: drivers that make it a chain of branches lose those behind some eighty (Mesa's llvmpipe).
const MOST_CASES: usize = 64;

/// `successor(rule, c, m)`: symbol and parameters of cell c; the module itself where it is kept.
pub fn successors(stage: &Stage, layout: &Layout) -> Text {
    let mut text = Text::default();
    text.line("fn successor(rule: u32, c: u32, m: Record) -> Record {");
    text.line("  var r = Record();");
    let cells = cells(stage);
    let kept = match layout.link {
        None => "return m;".to_string(),
        Some(word) => format!("r = m; {} = hang_of(m.index); return r;", lane(word).replacen('m', "r", 1)),
    };
    text.line(format!("  if rule >= {}u {{ {kept} }}", stage.keep()));
    let all: usize = stage.productions.iter().map(Production::cells).sum();
    let case = |text: &mut Text, (id, p): (usize, &Production), c: usize, label: usize| {
        if let Some(successor) = p.successor(c) {
            text.of_rule(format!("    case {label}u: {{"), p.span);
            child(text, p, &stage.code.children[id], c, successor.symbol);
            text.line("    }");
        }
    };
    if all <= MOST_CASES {
        text.line("  switch rule * CELLS + c {");
        for (id, p) in stage.productions.iter().enumerate() {
            (0..p.cells()).for_each(|c| case(&mut text, (id, p), c, id * cells + c));
        }
        text.line("    default: {}");
        text.line("  }");
    } else {
        for (id, p) in stage.productions.iter().enumerate() {
            for first in (0..p.cells()).step_by(MOST_CASES / 2) {
                let end = p.cells().min(first + MOST_CASES / 2);
                text.line(format!("  if rule == {id}u && c >= {first}u && c < {end}u {{"));
                text.line("  switch c {");
                (first..end).for_each(|c| case(&mut text, (id, p), c, c));
                text.line("    default: {}");
                text.line("  }");
                text.line("  }");
            }
        }
    }
    text.line("  return r;");
    text.line("}");
    text
}

/// `write_children(base)`: the children of modules from `base` on, `items` of them, where one production fires on all.
/// What several of them read is read once. Other stages have none.
pub fn only_children(stage: &Stage, items: usize) -> Text {
    let mut text = Text::default();
    text.line("fn write_children(base: u32) {");
    if let Some(production) = only_production(stage) {
        let code = &stage.code.children[0];
        let growth = production.cells();
        // The records that any of the modules reads, by their places behind `base`.
        let offset = |node: &Node| match node {
            Node::Near(_, offset, _) | Node::NearSymbol(offset) => *offset,
            _ => 0,
        };
        let offsets = || code.graph.nodes.iter().map(offset).chain([0]);
        let (low, high) = (offsets().min().unwrap_or(0), offsets().max().unwrap_or(0));
        let name = |place: i32| format!("w{}", place - low);
        for place in low..high + items as i32 {
            let sign = if place < 0 { "-" } else { "+" };
            let read = format!("read_record(base {sign} {}u)", place.unsigned_abs());
            text.line(format!("  let {} = {read};", name(place)));
        }
        for item in 0..items as i32 {
            text.line(format!("  if base + {item}u < extent.count {{"));
            text.line(format!("    let m = {};", name(item)));
            let used = code.args.iter().flatten().map(|arg| arg.0);
            let near = (low..=high).map(|offset| (offset, name(item + offset))).collect();
            let values = Values::with_near(&mut text, &code.graph, used, "    ", production.span, near);
            for (c, successor) in production.successors() {
                let args = &code.args[c];
                text.line(format!("    var r{c} = Record();"));
                text.of_rule(format!("    r{c}.q0.x = {}u;", successor.symbol), production.span);
                for &(node, at) in args {
                    let target = lane(at).replacen('m', &format!("r{c}"), 1);
                    text.of_rule(format!("    {target} = {};", values.word(node)), production.span);
                }
                let place = item as usize * growth + c;
                text.line(format!("    write_record(base * CLOSED + {place}u, r{c});"));
            }
            text.line("  }");
        }
    }
    text.line("}");
    text
}

/// The production that fires on every module, if it is the same for all.
pub fn only_production(stage: &Stage) -> Option<&Production> {
    stage.productions.first().filter(|_| stage.closed.is_some() && stage.productions.len() == 1)
}

/// The most cells of a production.
pub fn cells(stage: &Stage) -> usize {
    stage.productions.iter().map(Production::cells).max().unwrap_or(1).max(1)
}

fn child(text: &mut Text, p: &Production, code: &ChildCode, cell: usize, symbol: usize) {
    let args = &code.args[cell];
    let values = Values::new(text, &code.graph, args.iter().map(|a| a.0), "      ", p.span);
    text.of_rule(format!("      r.q0.x = {symbol}u;"), p.span);
    for &(node, at) in args {
        let target = lane(at).replacen('m', "r", 1);
        text.of_rule(format!("      {target} = {};", values.word(node)), p.span);
    }
}
