//! Random curve systems as text, each from a seed that reproduces it: rings, open words and trees,
//! contexts of all kinds, erasure, weights, several strict predecessors.
//!
//! Points are small integers and combinations of halves and quarters, and no case has more than
//! [`STEPS`] steps, so that all floats are exact in f32 but those that a turtle writes.

use super::super::curve::{Job, Topology, Word};
use super::expression::{Scope, Type};
use super::shorter;
use super::system::Generator;
use burgeon::language::syntax::ContextPart;
use std::fmt;
use std::fmt::Write;

/// The most modules that a word of a case has.
const MODULES: usize = 1500;
/// The most steps: two binary places each.
const STEPS: usize = 8;

/// A system and all that its derivation needs.
#[derive(Clone, Debug)]
pub struct CurveCase {
    /// [`curve_case`] of this number is this case.
    pub number: u64,
    pub job: Job,
    /// Whether all floats are exact in f32: only a turtle rounds.
    pub exact: bool,
}

/// What to write beside a failure.
impl fmt::Display for CurveCase {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Job { set, seed, steps, points, .. } = &self.job;
        writeln!(
            f,
            "curve case {}, seed {seed:?}, {set:?}, at most {steps:?} steps, {points:?}:",
            self.number
        )?;
        f.write_str(&self.job.text)
    }
}

/// Texts that occur in one case or another.
pub const CONSTRUCTS: [&str; 23] = [
    "eps",
    "ε",
    "until terminal",
    "repeat",
    "if ",
    "with grow",
    "with thin, grow",
    "ignore ",
    "# -> #",
    "trace into",
    "with smooth",
    "shift ",
    "P(_) = file",
    "P(_) = [",
    "rand()",
    "rand(-3, 3)",
    "vec3",
    "p2: ",
    "1/4*",
    "mix(",
    " f",
    "[ [",
    "in 0 .. 3",
];
/// Kinds of rules that fire in one case or another.
pub const KINDS: [&str; 11] =
    ["left", "right", "both", "deep", "end", "branch", "several", "weights", "query", "let", "condition"];

impl CurveCase {
    /// The kinds of its rules that fire, for each rule.
    pub fn fired(&self) -> Vec<&'static str> {
        let mut fired = Vec::new();
        for rule in self.job.fired() {
            let predecessor = &rule.predecessor;
            let right = predecessor.right.as_ref();
            let branch = right.is_some_and(|r| r.parts.iter().any(|p| matches!(p, ContextPart::Branch(_))));
            let left = predecessor.left.as_ref();
            let kinds = [
                ("left", left.is_some()),
                ("right", right.is_some()),
                ("both", left.is_some() && right.is_some()),
                (
                    "deep",
                    left.is_some_and(|l| l.patterns.len() > 1) || right.is_some_and(|r| r.parts.len() > 1),
                ),
                ("end", left.is_some_and(|l| l.end) || right.is_some_and(|r| r.end)),
                ("branch", branch),
                ("several", predecessor.strict.len() > 1),
                ("weights", rule.alternatives.len() > 1),
                ("query", !predecessor.queries.is_empty()),
                ("let", !rule.lets.is_empty()),
                ("condition", rule.condition.is_some()),
            ];
            fired.extend(kinds.iter().filter(|(_, is)| *is).map(|(kind, _)| *kind));
        }
        fired
    }

    /// What [`features`] are looked for in.
    pub fn described(&self) -> String {
        let fired: Vec<String> = self.fired().into_iter().map(fires).collect();
        format!("{}{}", self.job.text, fired.concat())
    }
}

fn fires(kind: &str) -> String {
    format!("fires: {kind}\n")
}

/// All that there is in one case or another.
pub fn features() -> Vec<String> {
    let topologies = ["curve ring", "curve open", "curve tree"];
    let texts = topologies.into_iter().chain(CONSTRUCTS).map(String::from);
    texts.chain(KINDS.into_iter().map(fires)).collect()
}

/// The case of a number.
pub fn curve_case(number: u64) -> CurveCase {
    let mut salts = super::Random::new(number ^ 0xc0_7e5);
    let wanted = *salts.pick(&[2, 8, 20, 60, 200]);
    let mut best = draw(number, salts.next());
    for _ in 0..12 {
        if best.1 >= wanted {
            break;
        }
        let other = draw(number, salts.next());
        if other.1 > best.1 {
            best = other;
        }
    }
    best.0
}

/// A case and how lively it is: the most modules that one of its words has, nothing if it never changes.
fn draw(number: u64, salt: u64) -> (CurveCase, usize) {
    let mut curves = Curves::new(salt);
    let system = curves.system();
    let points = curves.points();
    let set = curves.base.overrides();
    let seed = curves.base.random.chance(50).then(|| curves.base.random.next() as u32);
    let job = |run: &str| Job {
        text: format!("{system}{run}"),
        points: points.clone(),
        set: set.clone(),
        seed,
        ..Job::default()
    };
    for size in [5, 4, 3, 3, 2, 2, 1] {
        let run = curves.run(size);
        let exact = !run.contains("trace");
        let mut job = job(&run);
        let Some(words) = job.derive_within(MODULES).filter(|words| words.len() <= STEPS + 1) else {
            continue;
        };
        if curves.base.random.chance(10) {
            job.steps = Some(curves.base.random.below(words.len()));
        }
        let done = &words[..words.len().min(job.steps.map_or(usize::MAX, |limit| limit + 1))];
        let changes = done.windows(2).any(|w| w[0].tokens != w[1].tokens);
        let most = done.iter().map(Word::len).max().unwrap_or(0);
        return (CurveCase { number, job, exact }, if changes { most } else { 0 });
    }
    let run = format!("run:\n  derive 0{}\n", curves.base.with());
    (CurveCase { number, job: job(&run), exact: true }, 0)
}

/// The smallest case found by leaving out lines, points and settings as long as `fails` says yes.
///
/// `fails` also sees texts that are no system any more; it must say no to them before it derives.
pub fn minimise_curve(case: &CurveCase, fails: impl Fn(&CurveCase) -> bool) -> CurveCase {
    let mut best = case.clone();
    loop {
        let with = |job: Job| CurveCase { job, ..best.clone() };
        let mut simpler: Vec<CurveCase> =
            shorter(&best.job.text).into_iter().map(|text| with(Job { text, ..best.job.clone() })).collect();
        for index in 0..best.job.set.len() {
            let mut set = best.job.set.clone();
            set.remove(index);
            simpler.push(with(Job { set, ..best.job.clone() }));
        }
        let half = best.job.points.len() / 2;
        if half > 0 {
            simpler.push(with(Job { points: best.job.points[..half].to_vec(), ..best.job.clone() }));
        }
        let Some(smaller) = simpler.into_iter().find(|c| fails(c)) else { return best };
        best = smaller;
    }
}

/// The type of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Field {
    Scalar(Type),
    /// A vector of so many components.
    Vector(usize),
}

#[derive(Clone, Debug)]
struct Symbol {
    name: String,
    fields: Vec<Field>,
}

/// The names that a rule binds, and what it may call.
#[derive(Clone)]
struct Names {
    scope: Scope,
    vectors: Vec<(String, usize)>,
    /// Names bound by patterns, for a second time.
    bound: Vec<(String, Field)>,
    random: bool,
}

struct Curves {
    base: Generator,
    topology: Topology,
    symbols: Vec<Symbol>,
    /// Turtle symbols that occur in words.
    turtle: Vec<&'static str>,
    /// What the turtle writes, with `V` for the position.
    trace: &'static str,
    query: bool,
    labels: usize,
}

impl Curves {
    fn new(seed: u64) -> Curves {
        let mut base = Generator::new(seed);
        let topology = *base.random.pick(&[Topology::Ring, Topology::Open, Topology::Tree]);
        Curves { base, topology, symbols: Vec::new(), turtle: Vec::new(), trace: "", query: false, labels: 0 }
    }

    fn chance(&mut self, percent: usize) -> bool {
        self.base.random.chance(percent)
    }

    fn pick<T: Clone>(&mut self, items: &[T]) -> T {
        self.base.random.pick(items).clone()
    }

    /// All of the text but the schedule.
    fn system(&mut self) -> String {
        let mut text = String::new();
        let shared = self.base.random.below(2);
        text.extend((0..shared).map(|index| self.base.constant(index)));
        let attribute = match self.topology {
            Topology::Ring => " ring",
            Topology::Tree => " tree",
            // The default.
            Topology::Open => self.pick(&[" open", ""]),
        };
        writeln!(text, "system random : curve{attribute}").expect("a string takes all");

        let count = self.base.random.range(0, 3) as usize;
        let mut items: Vec<String> =
            (shared..shared + count).map(|index| self.base.constant(index)).collect();
        self.draw_symbols();
        items.push(self.modules());
        if self.chance(15) {
            self.query = true;
            let scope = self.base.constants.clone();
            items.push(format!("query Q(q: int) = step + {}\n", self.base.int(&scope, 1).at(5)));
        }
        if self.chance(30) {
            let all: Vec<String> = self.names_of_symbols();
            let ignored: Vec<String> = (0..self.base.random.range(1, 2)).map(|_| self.pick(&all)).collect();
            items.push(format!("ignore {}\n", ignored.join(" ")));
        }
        items.push(self.axiom());
        self.base.groups = self.pick(&[
            vec![None],
            vec![None, Some("grow".to_string())],
            vec![Some("grow".to_string()), Some("thin".to_string())],
            vec![None, Some("grow".to_string()), Some("thin".to_string())],
        ]);
        for group in self.base.groups.clone() {
            items.push(self.group(group.as_deref()));
        }
        if !self.turtle.is_empty() {
            items.push(self.smooth());
        }
        // Declarations stand in any order.
        if self.chance(30) {
            self.base.random.shuffle(&mut items);
        }
        text.extend(items);
        text
    }

    fn draw_symbols(&mut self) {
        let scalars = [Type::Int, Type::Int, Type::Bool, Type::Float].map(Field::Scalar);
        let all = [&scalars[..], &[Field::Vector(2), Field::Vector(3)]].concat();
        for name in ["A", "B", "P", "D"].iter().take(self.base.random.range(1, 4) as usize) {
            let count = self.pick(&[0, 0, 1, 1, 2, 3]);
            let fields = match *name {
                // One that holds a point and nothing else.
                "P" => vec![self.pick(&[Field::Vector(2), Field::Vector(3)])],
                _ => (0..count).map(|_| self.pick(&all)).collect(),
            };
            self.symbols.push(Symbol { name: name.to_string(), fields });
        }
        if self.chance(35) {
            self.turtle = vec!["F", "+", "-"];
            if self.topology != Topology::Ring && self.chance(50) {
                self.turtle.push("f");
            }
            if self.chance(40) {
                self.turtle.extend(["&", "^", "\\", "/", "|", "!"]);
            }
        }
    }

    fn names_of_symbols(&self) -> Vec<String> {
        let own = self.symbols.iter().map(|s| s.name.clone());
        own.chain(self.turtle.iter().map(|s| s.to_string())).collect()
    }

    fn modules(&mut self) -> String {
        let declare = |symbol: &Symbol| {
            let ty = |field: &Field| match field {
                Field::Scalar(Type::Int) => "int".to_string(),
                Field::Scalar(Type::Bool) => "bool".to_string(),
                Field::Scalar(Type::Float) => "float".to_string(),
                Field::Vector(n) => format!("vec{n}"),
            };
            let fields = symbol.fields.iter().enumerate().map(|(i, field)| format!("f{i}: {}", ty(field)));
            let fields: Vec<String> = fields.collect();
            if fields.is_empty() {
                symbol.name.clone()
            } else {
                format!("{}({})", symbol.name, fields.join(", "))
            }
        };
        let all: Vec<String> = self.symbols.iter().map(declare).collect();
        let (fields, written) = self.pick(&[
            ("v: vec2", "Trace(V)"),
            ("v: vec3, r: float", "Trace(V, 2.5)"),
            ("r: float, v: vec3", "Trace(0.5, V)"),
        ]);
        self.trace = written;
        format!("module {}, Trace({fields})\n", all.join(", "))
    }

    // --- axioms --------------------------------------------------------------------------------

    fn axiom(&mut self) -> String {
        let names = Names {
            scope: self.base.constants.clone(),
            vectors: Vec::new(),
            bound: Vec::new(),
            random: false,
        };
        let point = self.symbols.iter().find(|s| s.name == "P").cloned();
        match (point, self.base.random.below(10)) {
            // The one module that holds a point; `Trace` may be another.
            (Some(_), 0 | 1) => format!("axiom: P(_) = file \"points.csv\"{}\n", self.shift()),
            (Some(point), 2) => {
                let Field::Vector(n) = point.fields[0] else { unreachable!("P holds a point") };
                let points: Vec<String> =
                    (0..self.base.random.range(1, 9)).map(|_| self.literal_point(n)).collect();
                format!("axiom: P(_) = [{}]{}\n", points.join(", "), self.shift())
            }
            _ => {
                let count = self.pick(&[1, 1, 2, 3, 4, 5, 8, 13]);
                let word: Vec<String> = (0..count).map(|_| self.start(&names, 0)).collect();
                format!("axiom: {}\n", word.join(" "))
            }
        }
    }

    fn shift(&mut self) -> String {
        if self.topology == Topology::Ring && self.chance(50) {
            format!(" shift {}", self.base.random.range(-3, 7))
        } else {
            String::new()
        }
    }

    fn literal_point(&mut self, n: usize) -> String {
        let parts: Vec<String> = (0..n).map(|_| self.base.random.range(-31, 31).to_string()).collect();
        format!("({})", parts.join(", "))
    }

    fn points(&mut self) -> Vec<Vec<f64>> {
        let count = self.pick(&[1, 2, 3, 4, 6, 11]);
        let n = self.pick(&[2, 3]);
        let mut coordinate = || f64::from(self.base.random.range(-31, 31));
        (0..count).map(|_| (0..n).map(|_| coordinate()).collect()).collect()
    }

    fn start(&mut self, names: &Names, depth: usize) -> String {
        let module = self.any_module(names, true);
        if self.topology == Topology::Tree && depth < 3 && self.chance(45) {
            let count = self.base.random.range(1, 3);
            let branch: Vec<String> = (0..count).map(|_| self.start(names, depth + 1)).collect();
            return format!("{module} [ {} ]", branch.join(" "));
        }
        module
    }

    // --- rules ---------------------------------------------------------------------------------

    fn group(&mut self, name: Option<&str>) -> String {
        let mut text = name.map_or("rules:\n".to_string(), |name| format!("rules {name}:\n"));
        if self.chance(5) && self.topology != Topology::Ring {
            text += "  # -> #\n";
        }
        // In one group one length beside single rules.
        let several = if self.chance(30) { self.base.random.range(2, 3) as usize } else { 1 };
        for _ in 0..self.base.random.range(1, 6) {
            let strict = if several > 1 && self.chance(50) { several } else { 1 };
            text += &self.rule(strict);
        }
        text
    }

    /// Rules for what the turtle has written: its curves have ends, its trees branches.
    fn smooth(&mut self) -> String {
        let mut rules = vec![
            "# < P(v) > P(b) -> N(v) N(1/2*v + 1/2*b)",
            "P(a) < P(v) > P(b) -> N(1/4*a + 3/4*v) N(3/4*v + 1/4*b)",
            "P(a) < P(v) > # -> N(3/4*v + 1/4*a)",
            "P(v) > # -> eps",
            "P(a) P(b) > P(c) -> N(1/2*a + 1/2*b)",
            "# P(a) < P(v) -> eps",
        ];
        if self.topology == Topology::Tree {
            rules.push("P(v) > [ P(b) ] -> N(v) [ N(1/2*v + 1/2*b) ]");
            rules.push("P(v) > [ P(b) # ] P(c) -> N(1/2*b + 1/2*c)");
        }
        self.base.random.shuffle(&mut rules);
        rules.truncate(self.base.random.range(2, 4) as usize);
        // A pattern binds the position and takes any width.
        let pattern = self.trace.replace("2.5", "_").replace("0.5", "_");
        let mut text = "rules smooth:\n".to_string();
        for rule in rules {
            let mut rule = rule.to_string();
            for (short, long) in [("P(", pattern.as_str()), ("N(", self.trace)] {
                while let Some(at) = rule.find(short) {
                    let close = at + rule[at..].find(')').expect("a closing parenthesis");
                    let module = long.replace('V', &rule[at + 2..close]);
                    rule.replace_range(at..=close, &module);
                }
            }
            writeln!(text, "  {rule}").expect("a string takes all");
        }
        text
    }

    fn rule(&mut self, strict: usize) -> String {
        let mut names = Names {
            scope: self.base.constants.clone(),
            vectors: Vec::new(),
            bound: Vec::new(),
            random: true,
        };
        names.scope.bind("step", Type::Int);
        self.labels += 1;
        let label = if self.chance(10) { format!("p{}: ", self.labels) } else { String::new() };
        let mut text = format!("  {label}");
        if self.query && self.chance(20) {
            text += "?Q(q0) ";
            names.scope.bind("q0", Type::Int);
        }
        let ends = if self.topology == Topology::Ring { 2 } else { 20 };
        if self.chance(45) {
            let depth = self.depth();
            let end = self.chance(ends);
            let mut left: Vec<String> = (0..depth).map(|_| self.pattern(&mut names)).collect();
            if end || left.is_empty() {
                left.insert(0, "#".to_string());
            }
            write!(text, "{} < ", left.join(" ")).expect("a string takes all");
        }
        let patterns: Vec<String> = (0..strict).map(|_| self.pattern(&mut names)).collect();
        text += &patterns.join(" ");
        if self.chance(45) {
            let depth = self.depth();
            let right = self.right(&mut names, depth, ends, 0);
            write!(text, " > {right}").expect("a string takes all");
        }
        if self.chance(15) {
            let value = self.base.int(&names.scope, 2);
            names.scope.bind("y0", Type::Int);
            write!(text, " let y0 = {}", value.text).expect("a string takes all");
        }
        if self.chance(40) {
            write!(text, " : {}", self.condition(&names)).expect("a string takes all");
        }
        if self.chance(15) {
            for _ in 0..self.base.random.range(2, 3) {
                let weight = self.weight(&names);
                write!(text, "\n    ->({weight}) {}", self.successor(&names)).expect("a string takes all");
            }
            return text + "\n";
        }
        format!("{text} -> {}\n", self.successor(&names))
    }

    fn depth(&mut self) -> usize {
        self.pick(&[0, 1, 1, 1, 1, 1, 2, 2, 3, 8])
    }

    fn right(&mut self, names: &mut Names, depth: usize, ends: usize, nesting: usize) -> String {
        let mut parts = Vec::new();
        let branches = if self.topology == Topology::Tree && nesting < 2 { 35 } else { 0 };
        // In trees short, so that with its branches it is at most 8 deep.
        let depth = if self.topology == Topology::Tree { depth.min(3) } else { depth };
        for place in 0..=depth {
            if self.chance(branches) {
                for _ in 0..self.pick(&[1, 1, 1, 2]) {
                    let depth = self.pick(&[1, 1, 1, 2]);
                    parts.push(format!("[ {} ]", self.right(names, depth, 10, nesting + 1)));
                }
            }
            if place < depth {
                parts.push(self.pattern(names));
            }
        }
        if parts.is_empty() || self.chance(ends) {
            parts.push("#".to_string());
        }
        parts.join(" ")
    }

    fn pattern(&mut self, names: &mut Names) -> String {
        if !self.turtle.is_empty() && self.chance(20) {
            // `&` between two patterns would join them.
            let turtle: Vec<&str> = self.turtle.iter().copied().filter(|s| *s != "&").collect();
            let symbol = self.pick(&turtle);
            return if self.chance(30) {
                format!("{symbol}({})", self.binder(names, Field::Scalar(Type::Float)))
            } else {
                symbol.to_string()
            };
        }
        let symbols = self.symbols.clone();
        let symbol = self.pick(&symbols);
        if symbol.fields.is_empty() || self.chance(25) {
            return symbol.name;
        }
        let args: Vec<String> = symbol.fields.iter().map(|field| self.pattern_arg(names, *field)).collect();
        format!("{}({})", symbol.name, args.join(", "))
    }

    fn pattern_arg(&mut self, names: &mut Names, field: Field) -> String {
        match (self.base.random.below(100), field) {
            (0..12, _) => "_".to_string(),
            (12..18, Field::Scalar(Type::Int)) => self.base.random.range(-1, 3).to_string(),
            (12..18, Field::Scalar(Type::Bool)) => self.chance(50).to_string(),
            (12..18, Field::Scalar(Type::Float)) => self.pick(&["0.25", "-1.5", "1"]).to_string(),
            (18..26, _) => {
                let number = |f: &Field| matches!(f, Field::Scalar(Type::Int | Type::Float));
                let alike = |(_, f): &&(String, Field)| *f == field || number(f) && number(&field);
                let again: Vec<String> =
                    names.bound.iter().filter(alike).map(|(name, _)| name.clone()).collect();
                if again.is_empty() { self.binder(names, field) } else { self.pick(&again) }
            }
            _ => self.binder(names, field),
        }
    }

    fn binder(&mut self, names: &mut Names, field: Field) -> String {
        let index = names.bound.len();
        let letter = match field {
            Field::Scalar(Type::Int) => "k",
            Field::Scalar(Type::Bool) => "b",
            Field::Scalar(Type::Float) => "x",
            Field::Vector(_) => "v",
        };
        let name = format!("{letter}{index}");
        match field {
            Field::Scalar(ty) => names.scope.bind(&name, ty),
            Field::Vector(n) => names.vectors.push((name.clone(), n)),
        }
        names.bound.push((name.clone(), field));
        name
    }

    fn condition(&mut self, names: &Names) -> String {
        match (self.base.random.below(10), self.base.int_name(&names.scope)) {
            (0, _) => format!("rand() < {}", self.pick(&["0.25", "0.5", "0.75"])),
            (1, _) => format!("step == {}", self.base.random.below(3)),
            (2..=4, Some(name)) => format!("{} < {}", name.text, self.base.random.range(1, 4)),
            (5, Some(name)) => format!("{} % 2 == {}", name.text, self.base.random.below(2)),
            (6, Some(name)) => format!("{} > rand(-3, 3)", name.text),
            _ => self.base.bool(&names.scope, 2).text,
        }
    }

    /// A constant one must be positive; what is bound may be anything.
    fn weight(&mut self, names: &Names) -> String {
        let ints: Vec<String> = names
            .bound
            .iter()
            .filter(|(_, f)| *f == Field::Scalar(Type::Int))
            .map(|(n, _)| n.clone())
            .collect();
        if ints.is_empty() || self.chance(60) {
            return self.pick(&["1", "2", "0.5", "1/3", "7"]).to_string();
        }
        let name = self.pick(&ints);
        self.pick(&["NAME", "NAME - 1", "if(NAME > 1, 1, 0)", "0.25*NAME", "rand() * NAME"])
            .replace("NAME", &name)
    }

    fn successor(&mut self, names: &Names) -> String {
        match self.base.random.below(100) {
            0..14 => self.pick(&["eps", "ε"]).to_string(),
            14..22 => format!("eps {}", self.elements(names, 1, 0)),
            _ => {
                let count = self.pick(&[1, 1, 1, 2, 2, 2, 3, 4]);
                self.elements(names, count, 0)
            }
        }
    }

    fn elements(&mut self, names: &Names, count: usize, depth: usize) -> String {
        let mut elements = Vec::new();
        for _ in 0..count {
            if self.topology == Topology::Tree && depth < 3 && self.chance(30) {
                let count = self.pick(&[1, 1, 2]);
                elements.push(format!("[ {} ]", self.elements(names, count, depth + 1)));
            } else if self.chance(4) {
                elements.push("eps".to_string());
            } else {
                elements.push(self.any_module(names, false));
            }
        }
        elements.join(" ")
    }

    fn any_module(&mut self, names: &Names, start: bool) -> String {
        if !self.turtle.is_empty() && self.chance(25) {
            let turtle = self.turtle.clone();
            let symbol = self.pick(&turtle);
            return if self.chance(20) {
                format!("{symbol}({})", self.base.float(&names.scope, 1).text)
            } else {
                symbol.to_string()
            };
        }
        let symbols = self.symbols.clone();
        let symbol = self.pick(&symbols);
        let args: Vec<String> = symbol.fields.iter().map(|field| self.arg(names, *field, start)).collect();
        if args.is_empty() { symbol.name } else { format!("{}({})", symbol.name, args.join(", ")) }
    }

    fn arg(&mut self, names: &Names, field: Field, start: bool) -> String {
        match field {
            Field::Scalar(ty) if start => self.base.start_arg(&names.scope, ty),
            Field::Scalar(Type::Int) if names.random && self.chance(6) => "int(4 * rand())".to_string(),
            Field::Scalar(ty) => self.base.arg(&names.scope, ty),
            Field::Vector(n) => self.vector(names, n),
        }
    }

    /// A point between points, or near one: what stays exact for some steps.
    fn vector(&mut self, names: &Names, n: usize) -> String {
        let fitting: Vec<String> =
            names.vectors.iter().filter(|(_, m)| *m == n).map(|(name, _)| name.clone()).collect();
        if fitting.is_empty() {
            return self.literal_point(n);
        }
        let (a, b, c) = (self.pick(&fitting), self.pick(&fitting), self.pick(&fitting));
        match self.base.random.below(10) {
            0..=2 => a,
            3 | 4 => format!("1/4*{a} + 3/4*{b}"),
            5 | 6 => format!("1/2*{a} + 1/2*{b}"),
            7 => format!("1/4*{a} + 1/2*{b} + 1/4*{c}"),
            8 => format!("mix({a}, {b}, 0.5)"),
            _ => format!("{a} + {}", self.literal_point(n)),
        }
    }

    // --- schedule ------------------------------------------------------------------------------

    fn run(&mut self, size: i32) -> String {
        let run = self.base.run(size);
        if self.turtle.is_empty() || run.is_empty() || self.chance(60) {
            return run;
        }
        if self.chance(40) {
            return format!("{run}  trace into Trace\n");
        }
        format!("{run}  trace into Trace\n  derive {} with smooth\n", self.base.random.range(1, 2))
    }
}
