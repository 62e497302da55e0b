//! What the rules say, as WGSL: which rule matches, and each successor's symbol and parameters.

use crate::language::Span;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::plan::Plan;
use crate::plan::layout::Layout;
use crate::plan::tables::{Production, Stage, Successor};

/// Lines of WGSL, each with the rule it says.
#[derive(Clone, Debug, Default)]
pub struct Text {
    pub lines: Vec<(String, Option<Span>)>,
}

impl Text {
    fn line(&mut self, line: impl Into<String>) {
        self.lines.push((line.into(), None));
    }
    fn of_rule(&mut self, line: impl Into<String>, span: Span) {
        self.lines.push((line.into(), Some(span)));
    }
    /// Puts `other` behind.
    pub fn append(&mut self, other: Text) {
        self.lines.extend(other.lines);
    }
}

/// The record as the registers of an invocation, and how it is read and written.
pub fn record(layout: &Layout, writes: bool) -> Text {
    let quads = layout.record_words / 4;
    let list = |f: &dyn Fn(usize) -> String| (0..quads).map(f).collect::<Vec<_>>().join(", ");
    let mut text = Text::default();
    text.line(format!("struct Record {{ {} }}", list(&|q| format!("q{q}: vec4u"))));
    text.line("fn read_record(i: u32) -> Record {");
    text.line("  let b = i * QUADS;");
    text.line(format!("  return Record({});", list(&|q| format!("records[b + {q}u]"))));
    text.line("}");
    if writes {
        text.line("fn write_record(at: u32, r: Record) {");
        text.line("  let b = at * QUADS;");
        for q in 0..quads {
            text.line(format!("  next_records[b + {q}u] = r.q{q};"));
        }
        text.line("}");
    }
    text
}

/// `matching_rule(m)`: the rule that fires on a module.
pub fn matching(plan: &Plan, stage: &Stage) -> Text {
    let generator = Generator::new(plan);
    let mut text = Text::default();
    text.line("fn matching_rule(m: Record) -> u32 {");
    text.line("  switch symbol_of(m) {");
    for (symbol, ids) in stage.by_symbol.iter().enumerate() {
        let idle = stage.idle(symbol);
        if ids.is_empty() {
            continue;
        }
        text.line(format!("    case {symbol}u: {{"));
        let mut decided = false;
        for &id in ids {
            let p = &stage.productions[id];
            generator.try_rule(&mut text, p, id, idle);
            if p.guards.is_empty() {
                decided = true;
                break;
            }
        }
        if !decided {
            text.line(format!("      return {idle}u;"));
        }
        text.line("    }");
    }
    // The other symbols have no rules in this stage.
    let other = stage.without_rules();
    text.line(format!("    default: {{ return {other}u; }}"));
    text.line("  }");
    text.line("}");
    text
}

/// `successor(rule, c, m)`: symbol and parameters of cell c; the module itself where it is kept.
pub fn successors(plan: &Plan, stage: &Stage) -> Text {
    let generator = Generator::new(plan);
    let mut text = Text::default();
    text.line("fn successor(rule: u32, c: u32, m: Record) -> Record {");
    text.line("  var r = Record();");
    text.line("  switch rule * 4u + c {");
    for (id, p) in stage.productions.iter().enumerate() {
        for (c, cell) in p.cells.iter().enumerate() {
            if let Some(successor) = cell {
                text.of_rule(format!("    case {}u: {{", id * 4 + c), p.span);
                generator.child(&mut text, p, successor);
                text.line("    }");
            }
        }
    }
    text.line("    default: { r = m; }");
    text.line("  }");
    text.line("  return r;");
    text.line("}");
    text
}

struct Generator<'a> {
    plan: &'a Plan,
    uniforms: Vec<usize>,
}

impl<'a> Generator<'a> {
    fn new(plan: &'a Plan) -> Self {
        Generator { plan, uniforms: plan.environment_layout().0 }
    }

    fn try_rule(&self, text: &mut Text, p: &Production, id: usize, idle: u32) {
        let fields = &self.plan.tables.symbols[p.predecessor].words;
        let mut indent = "      ".to_string();
        let guarded = !p.guards.is_empty();
        if guarded {
            let guards: Vec<String> = p.guards.iter().map(|g| self.expr(g, fields)).collect();
            text.of_rule(format!("{indent}if {} {{", guards.join(" && ")), p.span);
            indent.push_str("  ");
        }
        if p.relabels_itself() {
            let args = p.cells[0].iter().flat_map(|c| &c.args);
            let same = args.zip(fields).map(|(a, &at)| format!("{} == {}", self.word(a, fields), lane(at)));
            let same: Vec<String> = same.collect();
            let same = if same.is_empty() { "true".to_string() } else { same.join(" && ") };
            text.of_rule(format!("{indent}return select({id}u, {idle}u, {same});"), p.span);
        } else {
            text.of_rule(format!("{indent}return {id}u;"), p.span);
        }
        if guarded {
            text.line("      }");
        }
    }

    fn child(&self, text: &mut Text, p: &Production, successor: &Successor) {
        let fields = &self.plan.tables.symbols[p.predecessor].words;
        let places = &self.plan.tables.symbols[successor.symbol].words;
        text.of_rule(format!("      r.q0.x = {}u;", successor.symbol), p.span);
        for (arg, &at) in successor.args.iter().zip(places) {
            let target = lane(at).replacen('m', "r", 1);
            text.of_rule(format!("      {target} = {};", self.word(arg, fields)), p.span);
        }
    }

    /// The expression as a word of a record.
    fn word(&self, e: &Expr, fields: &[usize]) -> String {
        let text = self.expr(e, fields);
        match e.ty {
            Type::Bool => format!("select(0u, 1u, {text})"),
            _ => format!("bitcast<u32>({text})"),
        }
    }

    fn expr(&self, e: &Expr, fields: &[usize]) -> String {
        match &e.kind {
            ExprKind::Literal(value) => literal(value),
            ExprKind::Binder(n) => from_word(&e.ty, &lane(fields[*n])),
            ExprKind::Uniform(n) => from_word(&e.ty, &format!("uniform_word({}u)", self.uniforms[*n])),
            ExprKind::Attribute("step") => "i32(extent.step)".to_string(),
            ExprKind::Attribute(_) => "i32(level_of(m))".to_string(),
            ExprKind::Call(op, args) => {
                let row = op.row();
                let args = args.iter().map(|a| self.expr(a, fields));
                // One argument after the other: an argument's own text may hold braces of no template.
                fill(row.wgsl, &args.collect::<Vec<_>>())
            }
            // `plan::supported` has refused all others.
            _ => "0".to_string(),
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

fn from_word(ty: &Type, word: &str) -> String {
    match ty {
        Type::Bool => format!("({word} != 0u)"),
        Type::Int => format!("bitcast<i32>({word})"),
        _ => format!("bitcast<f32>({word})"),
    }
}

fn literal(value: &Value) -> String {
    match value {
        Value::Bool(b) => b.to_string(),
        // The numeral of the least int would overflow before its sign is seen.
        Value::Int(i32::MIN) => "(-2147483647i - 1i)".to_string(),
        Value::Int(i) if *i < 0 => format!("({i}i)"),
        Value::Int(i) => format!("{i}i"),
        other => format!("bitcast<f32>({}u)", other.words().first().copied().unwrap_or(0)),
    }
}
