//! What the rules say, as WGSL: which rule matches, and each successor's symbol and parameters.

use crate::language::Span;
use crate::plan::code::{ChildCode, RuleCode};
use crate::plan::context::{Equal, Go, Operand, Place};
use crate::plan::graph::{Graph, Node, NodeId, Scalar};
use crate::plan::layout::Layout;
use crate::plan::measure::{MEASURES, Row};
use crate::plan::placement::Placement;
use crate::plan::tables::{MatchRule, Production, Stage, Tables};
use crate::plan::turtle::Turtle;
use std::collections::HashMap;

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

/// `matching_rule(m)`: the rule that fires on a module.
pub fn matching(stage: &Stage) -> Text {
    let mut text = Text::default();
    text.line("fn matching_rule(m: Record) -> u32 {");
    if stage.closed.is_some() && stage.productions.len() == 1 {
        text.line("  return 0u;");
        text.line("}");
        return text;
    }
    text.line("  switch symbol_of(m) {");
    for (symbol, ids) in stage.by_symbol.iter().enumerate() {
        let idle = stage.idle(symbol);
        if ids.is_empty() {
            continue;
        }
        text.line(format!("    case {symbol}u: {{"));
        let mut decided = false;
        for &id in ids {
            let rule = &stage.rules[id];
            try_rule(&mut text, rule, &stage.code.rules[id], idle);
            decided = stage.code.rules[id].guards.is_empty();
            if decided {
                break;
            }
        }
        if !decided {
            text.line(format!("      return {idle}u;"));
        }
        text.line("    }");
    }
    // The other symbols have no rules in this stage.
    text.line(format!("    default: {{ return {}u; }}", stage.without_rules()));
    text.line("  }");
    text.line("}");
    text
}

fn try_rule(text: &mut Text, rule: &MatchRule, code: &RuleCode, idle: u32) {
    let args = code.unchanged.iter().flatten().flatten().map(|u| u.0);
    let used = args.chain(code.guards.iter().copied()).chain(code.choice);
    let values = Values::new(text, &code.graph, used, "      ", rule.span);
    let guarded = !code.guards.is_empty();
    let mut indent = "      ".to_string();
    if guarded {
        let guards: Vec<String> = code.guards.iter().map(|&g| values.text(g)).collect();
        text.of_rule(format!("{indent}if {} {{", guards.join(" && ")), rule.span);
        indent.push_str("  ");
    }
    let first = rule.productions.start;
    let drawn = code.choice.map(|choice| values.text(choice));
    let id = match &drawn {
        None => format!("{first}u"),
        Some(drawn) => format!("{first}u + u32({drawn})"),
    };
    let unchanged = code.unchanged.iter().enumerate();
    let idle_if: Vec<String> = unchanged
        .filter_map(|(n, args)| {
            let same =
                args.as_ref()?.iter().map(|&(node, at)| format!("{} == {}", values.word(node), lane(at)));
            let drawn = drawn.iter().map(|drawn| format!("{drawn} == {n}i"));
            let all: Vec<String> = drawn.chain(same).collect();
            Some(if all.is_empty() { "true".to_string() } else { format!("({})", all.join(" && ")) })
        })
        .collect();
    match idle_if.is_empty() {
        true => text.of_rule(format!("{indent}return {id};"), rule.span),
        false => {
            let line = format!("{indent}return select({id}, {idle}u, {});", idle_if.join(" || "));
            text.of_rule(line, rule.span);
        }
    }
    if guarded {
        text.line("      }");
    }
}

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

/// The nodes of a graph as expressions: those used more than once are named.
struct Values<'a> {
    graph: &'a Graph,
    texts: Vec<String>,
    /// The records around the module that are read, by their offset.
    near: HashMap<i32, String>,
    /// The names of what searches find.
    found: HashMap<NodeId, String>,
}

impl<'a> Values<'a> {
    /// Writes a `let` for every node that the wanted ones use more than once.
    fn new(
        text: &mut Text,
        graph: &'a Graph,
        wanted: impl Iterator<Item = NodeId>,
        indent: &str,
        span: Span,
    ) -> Values<'a> {
        Values::with_near(text, graph, wanted, indent, span, HashMap::new())
    }

    /// The same where some of the records around the module have names already.
    fn with_near(
        text: &mut Text,
        graph: &'a Graph,
        wanted: impl Iterator<Item = NodeId>,
        indent: &str,
        span: Span,
        near: HashMap<i32, String>,
    ) -> Values<'a> {
        let mut uses = vec![0usize; graph.nodes.len()];
        wanted.for_each(|id| uses[id] += 1);
        for id in (0..graph.nodes.len()).rev() {
            if uses[id] > 0 {
                graph.args(id).into_iter().for_each(|a| uses[a] += 1);
            }
        }
        let texts = Vec::with_capacity(graph.nodes.len());
        let mut values = Values { graph, texts, near, found: HashMap::new() };
        for (id, node) in graph.nodes.iter().enumerate() {
            if let (true, Node::Near(_, offset, _) | Node::NearSymbol(offset)) = (uses[id] > 0, *node)
                && !values.near.contains_key(&offset)
            {
                let name = format!("near{}_{}", text.lines.len(), values.near.len());
                let sign = if offset < 0 { "-" } else { "+" };
                let record = format!("read_record(m.index {sign} {}u)", offset.unsigned_abs());
                text.of_rule(format!("{indent}let {name} = {record};"), span);
                values.near.insert(offset, name);
            }
        }
        for (id, node) in graph.nodes.iter().enumerate() {
            if let (true, Node::Search(_)) = (uses[id] > 0, node) {
                let name = format!("found{}_{id}", text.lines.len());
                text.of_rule(format!("{indent}var {name} = {};", values.node(node)), span);
                values.texts.push(format!("bitcast<i32>({name}[0])"));
                values.found.insert(id, name);
                continue;
            }
            let mut value = if uses[id] == 0 { String::new() } else { values.node(node) };
            if uses[id] > 1
                && matches!(
                    node,
                    Node::Call(..)
                        | Node::Element { .. }
                        | Node::Measured(..)
                        | Node::Given(..)
                        | Node::Beside(_)
                        | Node::Up(_)
                        | Node::Down(_)
                        | Node::SymbolAt(_)
                )
            {
                // Not written twice: a chain of sharing nodes would double at each.
                let name = format!("v{}_{id}", text.lines.len());
                text.of_rule(format!("{indent}let {name} = {value};"), span);
                value = name;
            }
            values.texts.push(value);
        }
        values
    }

    fn text(&self, id: NodeId) -> String {
        self.texts[id].clone()
    }

    /// The node as a word of a record.
    fn word(&self, id: NodeId) -> String {
        match (self.graph.nodes[id], self.graph.scalar(id)) {
            // No constant of WGSL may be infinite or not a number.
            (Node::Literal(Scalar::Float, word), _) => format!("{word}u"),
            (_, Scalar::Bool) => format!("select(0u, 1u, {})", self.texts[id]),
            _ => format!("bitcast<u32>({})", self.texts[id]),
        }
    }

    /// The node as an index of the word.
    fn place(&self, id: NodeId) -> String {
        format!("bitcast<u32>({})", self.texts[id])
    }

    fn node(&self, node: &Node) -> String {
        match *node {
            Node::Literal(ty, word) => literal(ty, word),
            Node::Held(word) => literal(Scalar::Float, word),
            Node::Field(ty, at) => from_word(ty, &lane(at)),
            Node::Near(ty, offset, at) => {
                from_word(ty, &lane(at).replacen('m', self.near.get(&offset).map_or("m", String::as_str), 1))
            }
            Node::NearSymbol(offset) => {
                format!("i32({}.q0.x & 0xffffu)", self.near.get(&offset).map_or("m", String::as_str))
            }
            Node::Behind => "i32(extent.behind - m.index)".to_string(),
            Node::Previous => "bitcast<i32>(previous(m.index))".to_string(),
            Node::Index => "bitcast<i32>(m.index)".to_string(),
            Node::Beside(places) => format!("bitcast<i32>(beside(m.index, {places}u))"),
            Node::Up(n) => format!("bitcast<i32>(up_of({}))", self.place(n)),
            Node::Down(n) => format!("bitcast<i32>(down_of({}))", self.place(n)),
            Node::Search(search) => format!("search_{search}(m.index)"),
            Node::Found { search, step } => format!("bitcast<i32>({}[{step}])", self.found[&search]),
            Node::At(ty, n, at) => from_word(ty, &format!("word_at({}, {at}u)", self.place(n))),
            Node::SymbolAt(n) => format!("i32(symbol_at({}))", self.place(n)),
            Node::Link { cell, lateral } => {
                let on = match cell {
                    None => "hang_of(m.index)".to_string(),
                    Some(cell) => format!("(offsets[m.index] + {cell}u)"),
                };
                format!("bitcast<i32>({on}{})", if lateral { " | LATERAL" } else { "" })
            }
            Node::Uniform(ty, at) => from_word(ty, &format!("uniform_word({at}u)")),
            Node::Measured(ty, at) => from_word(ty, &format!("measured_word(m, {at}u)")),
            Node::Given(ty, index) => from_word(ty, &format!("given_word({})", self.texts[index])),
            Node::Number(slot) => format!("bitcast<i32>(number_before(m.index) + {slot}u)"),
            Node::Step => "i32(extent.step)".to_string(),
            Node::RunStep => "bitcast<i32>(extent.run_step)".to_string(),
            Node::Seed => "bitcast<i32>(extent.seed)".to_string(),
            Node::Level => "i32(level_of(m))".to_string(),
            Node::Element { ty, base, stride, length, index } => {
                let last = length.saturating_sub(1);
                let index = format!("u32(clamp({}, 0i, {last}i))", self.texts[index]);
                from_word(ty, &format!("uniform_word({base}u + {stride}u * {index})"))
            }
            Node::Call(op, args) => {
                let row = op.row();
                // One argument after the other: its own text may hold braces of no template.
                let args: Vec<String> = args[..row.args.len()].iter().map(|&a| self.text(a)).collect();
                fill(row.wgsl, &args)
            }
        }
    }
}

/// A template with `{0}` … `{2}` filled in.
fn fill(template: &str, args: &[String]) -> String {
    let mut out = String::new();
    let mut rest = template;
    while let Some(open) = rest.find('{') {
        out.push_str(&rest[..open]);
        let n = rest.as_bytes().get(open + 1).map_or(0, |b| b.wrapping_sub(b'0') as usize);
        out.push_str(args.get(n).map_or("", String::as_str));
        rest = rest.get(open + 3..).unwrap_or("");
    }
    out + rest
}

/// Word `at` of the record in registers.
fn lane(at: usize) -> String {
    format!("m.q{}.{}", at / 4, ["x", "y", "z", "w"][at % 4])
}

fn from_word(ty: Scalar, word: &str) -> String {
    match ty {
        Scalar::Bool => format!("({word} != 0u)"),
        Scalar::Int => format!("bitcast<i32>({word})"),
        Scalar::Float => format!("bitcast<f32>({word})"),
    }
}

fn literal(ty: Scalar, word: u32) -> String {
    match (ty, word as i32) {
        (Scalar::Bool, word) => (word != 0).to_string(),
        // The numeral of the least int would overflow before its sign is seen.
        (Scalar::Int, i32::MIN) => "(-2147483647i - 1i)".to_string(),
        (Scalar::Int, i) if i < 0 => format!("({i}i)"),
        (Scalar::Int, i) => format!("{i}i"),
        (Scalar::Float, _) => format!("bitcast<f32>({word}u)"),
    }
}
