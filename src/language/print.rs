//! The canonical text of a syntax tree.
//!
//! What it prints parses to the same tree. It says everything in one way: one declaration a line,
//! the fewest brackets, `ε` as `eps`; comments are not in the tree and so not in the text.

use super::syntax::*;

/// Rules longer than this are broken before `let`, `:` and `->`.
const WIDTH: usize = 100;

/// Prints a rule file in canonical form.
pub fn print(file: &RuleFile) -> String {
    let mut out = String::new();
    if let Some(version) = &file.version {
        out += &format!("burgeon {}\n", version.text);
    }
    let mut before: Option<&FileItem> = None;
    for item in &file.items {
        let apart = matches!(item, FileItem::System(_)) || matches!(before, Some(FileItem::System(_)));
        if apart && !out.is_empty() {
            out.push('\n');
        }
        match item {
            FileItem::Const(c) => out += &constant(c),
            FileItem::Param(p) => out += &param(p),
            FileItem::System(s) => system(&mut out, s),
        }
        before = Some(item);
    }
    out
}

/// Prints an expression with the fewest brackets.
pub fn print_expr(e: &Expr) -> String {
    let mut out = String::new();
    expr(&mut out, e);
    out
}

/// The texts of all, with `separator` between.
fn joined<T>(list: &[T], separator: &str, text: impl Fn(&T) -> String) -> String {
    list.iter().map(text).collect::<Vec<_>>().join(separator)
}

fn names(list: &[Name], separator: &str) -> String {
    joined(list, separator, |n| n.text.clone())
}

fn system(out: &mut String, s: &System) {
    let kind = match s.kind {
        Kind::Curve => "curve",
        Kind::Patch => "patch",
        Kind::Mesh => "mesh",
    };
    *out += &format!("system {} : {kind}", s.name.text);
    for a in &s.attributes {
        *out += &format!(" {}", attribute(&a.kind));
    }
    out.push('\n');
    for i in &s.items {
        item(out, i);
    }
}

fn attribute(kind: &AttributeKind) -> String {
    match kind {
        AttributeKind::Ring => "ring".into(),
        AttributeKind::Open => "open".into(),
        AttributeKind::Tree => "tree".into(),
        AttributeKind::Bezier(u, None) => format!("bezier {}", u.text),
        AttributeKind::Bezier(u, Some(v)) => format!("bezier {} {}", u.text, v.text),
        AttributeKind::Rational => "rational".into(),
        AttributeKind::Join { c1: true } => "join c1".into(),
        AttributeKind::Join { c1: false } => "join c0".into(),
    }
}

fn item(out: &mut String, item: &Item) {
    match item {
        Item::Const(c) => *out += &constant(c),
        Item::Param(p) => *out += &param(p),
        Item::Modules(list) => *out += &format!("module {}\n", joined(list, ", ", module_decl)),
        Item::Query(q) => *out += &query(q),
        Item::Volume(v) => *out += &volume(v),
        Item::Ignore(symbols) => *out += &format!("ignore {}\n", names(symbols, " ")),
        Item::Template(t) => *out += &template(t),
        Item::Axiom(a) => *out += &axiom(&a.kind),
        Item::Rules(r) => rules(out, r),
        Item::Place(p) => *out += &place(p),
        Item::Run(r) => {
            *out += "run:\n";
            steps(out, &r.steps, 1);
        }
    }
}

fn typed(name: &Name, ty: &Option<Name>) -> String {
    match ty {
        Some(ty) => format!("{}: {}", name.text, ty.text),
        None => name.text.clone(),
    }
}

fn constant(c: &Const) -> String {
    format!("const {} = {}\n", typed(&c.name, &c.ty), print_expr(&c.value))
}

fn param(p: &Param) -> String {
    let range = match &p.range {
        Some((low, high)) => format!(" in {} .. {}", print_expr(low), print_expr(high)),
        None => String::new(),
    };
    format!("param {} = {}{range}\n", typed(&p.name, &p.ty), print_expr(&p.value))
}

fn field(f: &Field) -> String {
    format!("{}: {}", f.name.text, f.ty.text)
}

fn module_decl(m: &ModuleDecl) -> String {
    match m.fields.as_slice() {
        [] => m.symbol.text.clone(),
        fields => format!("{}({})", m.symbol.text, joined(fields, ", ", field)),
    }
}

fn query(q: &Query) -> String {
    let value = q.value.as_ref().map_or(String::new(), |e| format!(" = {}", print_expr(e)));
    format!("query {}({}){value}\n", q.name.text, field(&q.field))
}

fn volume(v: &Volume) -> String {
    let [x, y, z] = &v.size;
    let (from, to) = (print_expr(&v.from), print_expr(&v.to));
    format!("volume {}: {}({}, {}, {}) from {from} to {to}\n", v.name.text, v.ty.text, x.text, y.text, z.text)
}

fn place(p: &Place) -> String {
    let on = if p.on.is_empty() { String::new() } else { format!(" on {}", names(&p.on, ", ")) };
    format!("place {}{on} = {}\n", p.name.text, print_expr(&p.value))
}

fn quoted(t: &Text) -> String {
    format!("\"{}\"", t.text)
}

// Templates.

fn template(t: &Template) -> String {
    let body = match &t.body {
        TemplateBody::File(path) => format!("= {}", quoted(path)),
        TemplateBody::Inline(lines) => {
            format!("{{\n{}}}", lines.iter().map(template_line).collect::<String>())
        }
    };
    let base = if t.base.is_empty() { String::new() } else { format!(" base {}", names(&t.base, " ")) };
    format!("template {} {body}{base}\n", t.name.text)
}

fn template_line(line: &TemplateLine) -> String {
    match &line.kind {
        TemplateLineKind::Vertex([x, y, z]) => format!("  v {} {} {}\n", signed(x), signed(y), signed(z)),
        TemplateLineKind::Crease(a, b, sharpness) => {
            format!("  e {} {} {}\n", a.text, b.text, signed(sharpness))
        }
        TemplateLineKind::Face(name, vertices) => {
            format!("  f {}: {}\n", name.text, joined(vertices, " ", |v| v.text.clone()))
        }
    }
}

fn signed(n: &SignedNumber) -> String {
    format!("{}{}", if n.negative { "-" } else { "" }, n.number.text)
}

// Axioms.

fn axiom(kind: &AxiomKind) -> String {
    // Each start on a line of its own, so that nothing of one is read as part of the other.
    const NEXT: &str = "\n       ";
    let text = match kind {
        AxiomKind::Word(w) => word(w),
        AxiomKind::Source(s) => source(s),
        AxiomKind::Starts(starts) => {
            joined(starts, NEXT, |s| format!("{} = {}", module(&s.module), source(&s.source)))
        }
        AxiomKind::Meshes(meshes) => joined(meshes, NEXT, mesh_start),
    };
    format!("axiom: {text}\n")
}

fn mesh_start(m: &MeshStart) -> String {
    let at = if m.at.is_empty() { String::new() } else { format!(" at {}", transforms(&m.at)) };
    format!("{}{at}{}", source(&m.source), slots(&m.slots))
}

fn source(s: &Source) -> String {
    let kind = match &s.kind {
        SourceKind::File(path, None) => format!("file {}", quoted(path)),
        SourceKind::File(path, Some(index)) => format!("file {} [{}]", quoted(path), index.text),
        SourceKind::List(list) => list_source(list),
        SourceKind::Named(name, list) => name.text.clone() + &args(list),
    };
    let shift = s.shift.as_ref().map_or(String::new(), |e| format!(" shift {}", print_expr(e)));
    kind + &shift
}

/// A list that cannot be taken for a branch: without a comma, what it begins with must tell.
fn list_source(list: &Expr) -> String {
    match &list.kind {
        ExprKind::List(parts) if parts.len() == 1 => match &parts[0].kind {
            ExprKind::List(_) => format!("[{}]", list_source(&parts[0])),
            ExprKind::Vector(_) | ExprKind::Number(_) => print_expr(list),
            _ => format!("[({})]", print_expr(&parts[0])),
        },
        _ => print_expr(list),
    }
}

// Words.

fn args(list: &Option<Vec<Expr>>) -> String {
    match list {
        Some(list) => format!("({})", joined(list, ", ", print_expr)),
        None => String::new(),
    }
}

fn module(m: &ModuleUse) -> String {
    let tag = match m.tag.as_deref() {
        None => String::new(),
        Some([one]) if is_plain_tag(one) => format!("@{}", print_expr(one)),
        Some(parts) => format!("@({})", joined(parts, ", ", print_expr)),
    };
    format!("{}{}{tag}", m.symbol.text, args(&m.args))
}

/// A tag that needs no brackets.
fn is_plain_tag(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Number(n) => n.text.bytes().all(|b| b.is_ascii_digit()),
        ExprKind::Name(_) | ExprKind::Bool(_) => true,
        _ => false,
    }
}

fn word(w: &[Element]) -> String {
    joined(w, " ", |element| match element {
        Element::Eps(_) => "eps".into(),
        Element::Module(m) => module(m),
        Element::Branch(inner, _) => format!("[ {} ]", word(inner)),
        Element::Block(b) => block(b),
    })
}

fn block(b: &Block) -> String {
    // A block of one row is known by its `|`.
    let separator = if b.rows.len() == 1 { " | " } else { " " };
    let rows = joined(&b.rows, " ; ", |row| {
        joined(row, separator, |cell| match cell {
            Cell::Eps(_) => "eps".into(),
            Cell::Module(m) => module(m),
            Cell::Block(b) => block(b),
        })
    });
    format!("[ {rows} ]")
}

fn transforms(list: &[Transform]) -> String {
    joined(list, " ", |t| t.name.text.clone() + &args(&t.args))
}

/// With a space before, if there are any.
fn slots(list: &Option<Vec<Slot>>) -> String {
    match list.as_deref() {
        None => String::new(),
        Some([]) => " { }".into(),
        Some(list) => {
            let slots = joined(list, "; ", |s| {
                let fill = match &s.fill {
                    SlotFill::Eps(_) => "eps".into(),
                    SlotFill::Module(m) => module(m),
                };
                format!("{}: {fill}", names(&s.names, ", "))
            });
            format!(" {{ {slots} }}")
        }
    }
}

fn template_use(t: &TemplateUse) -> String {
    let place = match &t.place {
        None => String::new(),
        Some(p) => format!(" {} {}", if p.on { "on" } else { "at" }, transforms(&p.transforms)),
    };
    format!("{}{}{place}{}", t.name.text, args(&t.args), slots(&t.slots))
}

// Rules.

fn rules(out: &mut String, r: &Rules) {
    match &r.group {
        Some(group) => *out += &format!("rules {}:\n", group.text),
        None => *out += "rules:\n",
    }
    for r in &r.rules {
        rule(out, r);
    }
}

fn rule(out: &mut String, r: &Rule) {
    let label = r.label.as_ref().map_or(String::new(), |l| format!("{}: ", l.text));
    let mut parts = vec![label + &predecessor(&r.predecessor)];
    if !r.lets.is_empty() {
        let lets = joined(&r.lets, ", ", |(name, value)| format!("{} = {}", name.text, print_expr(value)));
        parts.push(format!("let {lets}"));
    }
    parts.extend(r.condition.as_ref().map(|c| format!(": {}", print_expr(c))));
    parts.extend(r.alternatives.iter().map(alternative));
    let length: usize = parts.iter().map(|p| p.len() + 1).sum();
    let separator = if r.alternatives.len() > 1 || length > WIDTH { "\n    " } else { " " };
    *out += &format!("  {}\n", parts.join(separator));
}

fn alternative(a: &Alternative) -> String {
    let weight = a.weight.as_ref().map_or(String::new(), |w| format!("({})", print_expr(w)));
    let successor = match &a.successor {
        Successor::Word(w) => word(w),
        Successor::Template(t) => template_use(t),
    };
    format!("->{weight} {successor}")
}

fn predecessor(p: &Predecessor) -> String {
    let mut parts: Vec<String> =
        p.queries.iter().map(|q| format!("?{}({})", q.query.text, q.binder.text)).collect();
    if let Some(left) = &p.left {
        parts.extend(left.end.then(|| "#".to_owned()));
        parts.extend(left.patterns.iter().map(pattern));
        parts.push("<".into());
    }
    parts.push(joined(&p.strict, if p.joined { " & " } else { " " }, pattern));
    if let Some(right) = &p.right {
        parts.push(">".into());
        parts.push(right_context(right));
    }
    parts.join(" ")
}

fn right_context(r: &RightContext) -> String {
    let mut parts: Vec<String> = r
        .parts
        .iter()
        .map(|part| match part {
            ContextPart::Pattern(p) => pattern(p),
            ContextPart::Branch(inner) => format!("[ {} ]", right_context(inner)),
        })
        .collect();
    parts.extend(r.end.then(|| "#".to_owned()));
    parts.join(" ")
}

fn pattern(p: &Pattern) -> String {
    let args = match &p.args {
        None => String::new(),
        Some(args) => {
            let args = joined(args, ", ", |a| match a {
                PatternArg::Bind(name) => name.text.clone(),
                PatternArg::Any(_) => "_".into(),
                PatternArg::Number(n) => signed(n),
                PatternArg::Bool(b, _) => b.to_string(),
            });
            format!("({args})")
        }
    };
    let tag = match &p.tag {
        None => String::new(),
        Some(PatternTag::Bind(name)) => format!("@{}", name.text),
        Some(PatternTag::Number(n)) => format!("@{}", n.text),
    };
    format!("{}{args}{tag}", p.symbol.text)
}

// Steps.

fn steps(out: &mut String, list: &[Step], level: usize) {
    for s in list {
        *out += &"  ".repeat(level);
        step(out, &s.kind, level);
        out.push('\n');
    }
}

fn step(out: &mut String, kind: &StepKind, level: usize) {
    let mut body = |head: String, list: &[Step]| {
        *out += &format!("{head} {{\n");
        steps(out, list, level + 1);
        *out += &"  ".repeat(level);
        out.push('}');
    };
    let text = match kind {
        StepKind::Repeat { count, body: list } => {
            return body(format!("repeat {}", print_expr(count)), list);
        }
        StepKind::If { condition, body: list } => {
            return body(format!("if {}", print_expr(condition)), list);
        }
        StepKind::Derive { count, groups } => derive(count, groups),
        StepKind::Subdivide { scheme, levels, place } => {
            let place = place.as_ref().map_or(String::new(), |p| format!(" place {}", p.text));
            format!("subdivide {} {}{place}", scheme.text, print_expr(levels))
        }
        StepKind::Place(name) => format!("place {}", name.text),
        StepKind::Mark { module: m, condition, isolated } => {
            let isolated = if *isolated { " isolated" } else { "" };
            format!("mark {} : {}{isolated}", module(m), print_expr(condition))
        }
        StepKind::Crease { sharpness, condition } => {
            format!("crease {} : {}", print_expr(sharpness), print_expr(condition))
        }
        StepKind::Deposit { pattern: p, into, condition } => {
            let condition = condition.as_ref().map_or(String::new(), |c| format!(" : {}", print_expr(c)));
            format!("deposit {} into {}{condition}", pattern(p), into.text)
        }
        StepKind::Trace { into } => format!("trace into {}", into.text),
    };
    *out += &text;
}

fn derive(count: &DeriveCount, groups: &[Name]) -> String {
    let count = match count {
        DeriveCount::Steps(n) => print_expr(n),
        DeriveCount::UntilTerminal { max: None } => "until terminal".into(),
        DeriveCount::UntilTerminal { max: Some(n) } => format!("until terminal max {}", print_expr(n)),
    };
    let with = if groups.is_empty() { String::new() } else { format!(" with {}", names(groups, ", ")) };
    format!("derive {count}{with}")
}

// Expressions.

fn expr(out: &mut String, e: &Expr) {
    match &e.kind {
        ExprKind::Number(n) => *out += &n.text,
        ExprKind::Bool(b) => *out += if *b { "true" } else { "false" },
        ExprKind::Name(name) => *out += name,
        ExprKind::Call(name, args) => {
            *out += &name.text;
            list(out, "(", args, ")");
        }
        ExprKind::Vector(parts) => list(out, "(", parts, ")"),
        ExprKind::List(parts) => list(out, "[", parts, "]"),
        ExprKind::Field(base, name) => {
            // `1.x` would be a numeral and a name.
            let number = matches!(base.kind, ExprKind::Number(_));
            bracketed_if(out, base, number || is_operation(base));
            out.push('.');
            *out += &name.text;
        }
        ExprKind::Index(base, index) => {
            bracketed_if(out, base, is_operation(base));
            out.push('[');
            expr(out, index);
            out.push(']');
        }
        ExprKind::Unary(op, operand) => {
            out.push(match op {
                UnaryOp::Neg => '-',
                UnaryOp::Not => '!',
            });
            bracketed_if(out, operand, matches!(operand.kind, ExprKind::Binary(..)));
        }
        ExprKind::Binary(op, left, right) => binary(out, *op, left, right),
    }
}

fn list(out: &mut String, open: &str, parts: &[Expr], close: &str) {
    *out += open;
    for (i, part) in parts.iter().enumerate() {
        if i > 0 {
            *out += ", ";
        }
        expr(out, part);
    }
    *out += close;
}

fn is_operation(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Unary(..) | ExprKind::Binary(..))
}

fn bracketed_if(out: &mut String, e: &Expr, brackets: bool) {
    if brackets {
        out.push('(');
    }
    expr(out, e);
    if brackets {
        out.push(')');
    }
}

fn binary(out: &mut String, op: BinaryOp, left: &Expr, right: &Expr) {
    let tightness = |e: &Expr| match &e.kind {
        ExprKind::Binary(op, ..) => op.precedence(),
        _ => u8::MAX,
    };
    let comparison = op.precedence() == BinaryOp::Less.precedence();
    // Operators of one precedence group to the left; comparisons do not group at all.
    let left_least = if comparison { op.precedence() + 1 } else { op.precedence() };
    bracketed_if(out, left, tightness(left) < left_least);
    let spaced = op.precedence() < BinaryOp::Mul.precedence();
    *out += &if spaced { format!(" {} ", op.token()) } else { op.token().to_owned() };
    bracketed_if(out, right, tightness(right) <= op.precedence());
}
