//! The values of expressions, as WGSL.

use super::Text;
use crate::language::Span;
use crate::plan::graph::{Graph, Node, NodeId, Scalar};
use std::collections::HashMap;

/// The nodes of a graph as expressions: those used more than once are named.
pub(super) struct Values<'a> {
    graph: &'a Graph,
    texts: Vec<String>,
    /// The records around the module that are read, by their offset.
    near: HashMap<i32, String>,
    /// The names of what searches find.
    found: HashMap<NodeId, String>,
}

impl<'a> Values<'a> {
    /// Writes a `let` for every node that the wanted ones use more than once.
    pub(super) fn new(
        text: &mut Text,
        graph: &'a Graph,
        wanted: impl Iterator<Item = NodeId>,
        indent: &str,
        span: Span,
    ) -> Values<'a> {
        Values::with_near(text, graph, wanted, indent, span, HashMap::new())
    }

    /// The same where some of the records around the module have names already.
    pub(super) fn with_near(
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

    pub(super) fn text(&self, id: NodeId) -> String {
        self.texts[id].clone()
    }

    /// The node as a word of a record.
    pub(super) fn word(&self, id: NodeId) -> String {
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
pub(super) fn lane(at: usize) -> String {
    format!("m.q{}.{}", at / 4, ["x", "y", "z", "w"][at % 4])
}

pub(super) fn from_word(ty: Scalar, word: &str) -> String {
    match ty {
        Scalar::Bool => format!("({word} != 0u)"),
        Scalar::Int => format!("bitcast<i32>({word})"),
        Scalar::Float => format!("bitcast<f32>({word})"),
    }
}

pub(super) fn literal(ty: Scalar, word: u32) -> String {
    match (ty, word as i32) {
        (Scalar::Bool, word) => (word != 0).to_string(),
        // The numeral of the least int would overflow before its sign is seen.
        (Scalar::Int, i32::MIN) => "(-2147483647i - 1i)".to_string(),
        (Scalar::Int, i) if i < 0 => format!("({i}i)"),
        (Scalar::Int, i) => format!("{i}i"),
        (Scalar::Float, _) => format!("bitcast<f32>({word}u)"),
    }
}
