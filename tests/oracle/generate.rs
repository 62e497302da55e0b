//! Random patch systems as text, each from a seed that reproduces it.
//!
//! Inputs are nets of small integers, so that a few levels are exact in f32. The schedules are
//! drawn until the oracle finds the growth bounded.

use super::halving::Net;
use super::word::{Param, Word};
use super::{Oracle, parse};
use std::fmt::{self, Write};

/// The most modules that a word of a case has.
const MODULES: usize = 3000;
/// The most halvings along u or v: rows and columns stay well within 32 bits.
const HALVINGS: u32 = 30;

/// A system and all that its derivation needs.
#[derive(Clone, Debug)]
pub struct Case {
    /// [`case`] of this seed is this case.
    pub seed: u64,
    pub text: String,
    /// The nets of the file `lattice.bpt`: integers, in homogeneous coordinates.
    pub nets: Vec<Net>,
    /// All coordinates are below 2^bits.
    pub bits: u32,
    /// Params that the host sets before the run.
    pub set: Vec<(String, Param)>,
    /// The limit of steps, as of `--steps`.
    pub steps: Option<usize>,
}

/// What to write beside a failure.
impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "case of seed {}, {:?}, at most {:?} steps:", self.seed, self.set, self.steps)?;
        f.write_str(&self.text)
    }
}

impl Case {
    /// The words that the oracle derives.
    pub fn derive(&self) -> Vec<Word> {
        self.derive_within(usize::MAX).expect("no bounds")
    }

    fn derive_within(&self, modules: usize) -> Option<Vec<Word>> {
        let file = parse(&self.text);
        let nets = |_: &str| self.nets.clone();
        let mut oracle = Oracle::new(&file, None, &nets).steps(self.steps).bounds(modules, HALVINGS);
        for (name, value) in &self.set {
            oracle = oracle.set(name, *value);
        }
        oracle.derive_within()
    }
}

/// The case of a seed.
pub fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    // Small words are cheap to come by: most cases are drawn again until they grow.
    let wanted = *random.pick(&[1, 8, 20, 60, 200]);
    let mut best = draw(seed, random.next());
    for _ in 0..12 {
        if best.1 >= wanted {
            break;
        }
        let other = draw(seed, random.next());
        if other.1 > best.1 {
            best = other;
        }
    }
    best.0
}

/// A case and the most modules that one of its words has.
fn draw(seed: u64, salt: u64) -> (Case, usize) {
    let mut generator = Generator::new(salt);
    let system = generator.system();
    let nets = generator.nets();
    let set = generator.overrides();
    let mut case = Case { seed, text: String::new(), nets, bits: generator.bits, set, steps: None };
    for size in [5, 4, 3, 3, 2, 2, 1] {
        case.text = format!("{system}{}", generator.run(size));
        if let Some(words) = case.derive_within(MODULES) {
            if generator.random.chance(20) {
                case.steps = Some(generator.random.below(words.len()));
            }
            let done = words.iter().take(case.steps.map_or(words.len(), |limit| limit + 1));
            let most = done.map(|word| word.modules.len()).max().unwrap_or(0);
            return (case, most);
        }
    }
    let groups = generator.with();
    case.text = format!("{system}run:\n  derive 1{groups}\n");
    (case, 1)
}

/// The smallest case found by leaving out lines, roots and settings as long as `fails` says yes.
///
/// `fails` also sees texts that are no system any more; it must say no to them before it derives.
pub fn minimise(case: &Case, fails: impl Fn(&Case) -> bool) -> Case {
    let mut best = case.clone();
    loop {
        let Some(smaller) = simplifications(&best).into_iter().find(|c| fails(c)) else { return best };
        best = smaller;
    }
}

fn simplifications(case: &Case) -> Vec<Case> {
    let lines: Vec<&str> = case.text.lines().collect();
    let mut simpler = Vec::new();
    // Large bites first: halves, quarters … single lines.
    let mut bite = lines.len().div_ceil(2);
    while bite > 0 {
        for start in (0..lines.len()).step_by(bite.div_ceil(2)) {
            let end = (start + bite).min(lines.len());
            let kept: Vec<&str> = [&lines[..start], &lines[end..]].concat();
            simpler.push(Case { text: kept.join("\n") + "\n", ..case.clone() });
        }
        bite /= 2;
    }
    for (open, line) in lines.iter().enumerate().filter(|(_, line)| line.ends_with('{')) {
        // `repeat` and `if` go without their body.
        let indent = line.len() - line.trim_start().len();
        let closing = format!("{}}}", " ".repeat(indent));
        let Some(length) = lines[open..].iter().position(|line| *line == closing) else { continue };
        let body = &lines[open + 1..open + length];
        let kept: Vec<&str> = [&lines[..open], body, &lines[open + length + 1..]].concat();
        simpler.push(Case { text: kept.join("\n") + "\n", ..case.clone() });
    }
    for index in 0..case.set.len() {
        let mut set = case.set.clone();
        set.remove(index);
        simpler.push(Case { set, ..case.clone() });
    }
    if case.nets.len() > 1 {
        simpler.push(Case { nets: case.nets[..1].to_vec(), ..case.clone() });
    }
    simpler
}

/// splitmix64: small, and the same for ever.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 .. n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub fn range(&mut self, low: i32, high: i32) -> i32 {
        low + self.below((high - low + 1) as usize) as i32
    }

    pub fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    Int,
    Bool,
}

#[derive(Clone, Debug)]
struct Symbol {
    name: String,
    fields: Vec<Type>,
}

/// The names that an expression may read.
#[derive(Clone, Debug, Default)]
struct Scope {
    names: Vec<(String, Type)>,
    /// Constant lists of ints.
    lists: Vec<String>,
    /// Constants of type float, for comparisons only.
    ratios: Vec<String>,
}

impl Scope {
    /// The newest binding hides the others.
    fn bind(&mut self, name: &str, ty: Type) {
        let hidden = |n: &String| n == name;
        self.names.retain(|(n, _)| !hidden(n));
        self.lists.retain(|n| !hidden(n));
        self.ratios.retain(|n| !hidden(n));
        self.names.push((name.to_string(), ty));
    }

    fn of(&self, ty: Type) -> Vec<&String> {
        self.names.iter().filter(|(_, t)| *t == ty).map(|(n, _)| n).collect()
    }
}

/// A param, as `overrides` sees it.
#[derive(Clone, Debug)]
struct Slider {
    name: String,
    ty: Type,
    range: Option<(i32, i32)>,
}

/// A piece of an expression.
struct Term {
    text: String,
    /// As of `BinaryOp::precedence`; 6 for signs, 7 for what needs no parentheses.
    precedence: u8,
    /// Whether a name occurs: without one it would be an exact rational, not i32.
    named: bool,
}

impl Term {
    fn atom(text: impl Into<String>, named: bool) -> Term {
        Term { text: text.into(), precedence: 7, named }
    }

    /// In parentheses if it binds less tightly than it must.
    fn at(&self, precedence: u8) -> String {
        if self.precedence < precedence { format!("({})", self.text) } else { self.text.clone() }
    }
}

struct Generator {
    random: Random,
    degree: [usize; 2],
    rational: bool,
    bits: u32,
    symbols: Vec<Symbol>,
    /// Consts and params.
    constants: Scope,
    /// Names of consts and params with a value of 0 to 3, for counts.
    small: Vec<String>,
    /// Params with their range.
    params: Vec<Slider>,
    groups: Vec<Option<String>>,
    /// Rules so far: no two have one label.
    labels: usize,
}

const AWKWARD: [i32; 10] =
    [i32::MIN, i32::MIN + 1, i32::MAX, i32::MAX - 1, 46341, -46341, 65536, 1 << 30, 65535, -(1 << 30)];

impl Generator {
    fn new(seed: u64) -> Generator {
        let mut random = Random::new(seed);
        let cubic = random.chance(60);
        let degree = if cubic { [3, 3] } else { [random.range(1, 8) as usize, random.range(1, 8) as usize] };
        Generator {
            degree,
            rational: random.chance(25),
            bits: random.range(2, 6) as u32,
            symbols: Vec::new(),
            constants: Scope::default(),
            small: Vec::new(),
            params: Vec::new(),
            groups: Vec::new(),
            labels: 0,
            random,
        }
    }

    /// All of the text but the schedule.
    fn system(&mut self) -> String {
        let mut text = String::new();
        if self.random.chance(20) {
            text.push_str("burgeon 1\n");
        }
        let shared = self.random.below(2);
        text.extend((0..shared).map(|index| self.constant(index)));
        let [m, n] = self.degree;
        let degree = if m == n && self.random.chance(80) { format!("{m}") } else { format!("{m} {n}") };
        let rational = if self.rational { " rational" } else { "" };
        writeln!(text, "system random : patch bezier {degree}{rational}").unwrap();

        let count = self.random.range(0, 5) as usize;
        let mut items: Vec<String> = (shared..shared + count).map(|index| self.constant(index)).collect();
        self.draw_symbols();
        items.extend(self.modules());
        items.push(self.axiom());
        self.groups = vec![None, Some("grow".to_string()), Some("thin".to_string())];
        let missing = self.random.below(6);
        if missing < 3 {
            self.groups.remove(missing);
        } else {
            self.groups.truncate(1 + self.random.below(3));
        }
        for group in self.groups.clone() {
            items.push(self.group(group.as_deref()));
        }
        // Declarations stand in any order.
        if self.random.chance(30) {
            self.random.shuffle(&mut items);
        }
        text.extend(items);
        text
    }

    // --- consts and params -------------------------------------------------------------------

    fn constant(&mut self, index: usize) -> String {
        let name = ["alpha", "beta", "gamma", "delta", "eta", "zeta"][index].to_string();
        match self.random.below(10) {
            0 | 1 => self.small_constant(name),
            2..=4 => self.param(name),
            5 => {
                let scope = self.constants.clone();
                let value = self.bool(&scope, 1);
                self.constants.bind(&name, Type::Bool);
                format!("const {name} = {}\n", value.text)
            }
            6 => {
                let items: Vec<String> = (0..self.random.range(1, 4)).map(|_| self.literal()).collect();
                self.constants.lists.push(name.clone());
                format!("const {name} = [{}]\n", items.join(", "))
            }
            7 => {
                let (numerator, denominator) = (2 * self.random.range(-3, 6) + 1, 2 << self.random.below(2));
                self.constants.ratios.push(name.clone());
                format!("const {name} = {numerator}/{denominator}\n")
            }
            _ => {
                let scope = self.constants.clone();
                let value = self.int(&scope, 2);
                let ty = if self.random.chance(30) { ": int" } else { "" };
                self.constants.bind(&name, Type::Int);
                format!("const {name}{ty} = {}\n", value.text)
            }
        }
    }

    fn small_constant(&mut self, name: String) -> String {
        self.constants.bind(&name, Type::Int);
        self.small.push(name.clone());
        let value = self.random.range(0, 3);
        if self.random.chance(50) {
            return format!("const {name} = {value}\n");
        }
        self.params.push(Slider { name: name.clone(), ty: Type::Int, range: Some((0, 3)) });
        format!("param {name}: int = {value} in 0 .. 3\n")
    }

    fn param(&mut self, name: String) -> String {
        if self.random.chance(25) {
            self.constants.bind(&name, Type::Bool);
            self.params.push(Slider { name: name.clone(), ty: Type::Bool, range: None });
            return format!("param {name}: bool = {}\n", self.random.chance(50));
        }
        self.constants.bind(&name, Type::Int);
        let range = self.random.chance(50).then_some((-4, 6));
        self.params.push(Slider { name: name.clone(), ty: Type::Int, range });
        match range {
            Some((low, high)) => {
                let value = self.random.range(low, high);
                format!("param {name}: int = {value} in {low} .. {high}\n")
            }
            None => format!("param {name} = {}\n", self.literal()),
        }
    }

    fn overrides(&mut self) -> Vec<(String, Param)> {
        let mut set = Vec::new();
        for Slider { name, ty, range } in self.params.clone() {
            if !self.random.chance(40) {
                continue;
            }
            let value = match (ty, range) {
                (Type::Bool, _) => Param::Bool(self.random.chance(50)),
                (Type::Int, Some((low, high))) => Param::Int(self.random.range(low, high)),
                (Type::Int, None) => Param::Int(self.integer()),
            };
            set.push((name, value));
        }
        set
    }

    // --- symbols and axiom -------------------------------------------------------------------

    fn draw_symbols(&mut self) {
        for name in ["A", "B", "Leaf_1", "D", "E2"].iter().take(self.random.range(1, 5) as usize) {
            let count = *self.random.pick(&[0, 1, 1, 2, 2, 3, 4]);
            let fields = (0..count).map(|_| *self.random.pick(&[Type::Int, Type::Int, Type::Bool])).collect();
            self.symbols.push(Symbol { name: name.to_string(), fields });
        }
    }

    fn modules(&mut self) -> Vec<String> {
        let declare = |symbol: &Symbol| {
            let field = |(index, ty): (usize, &Type)| match ty {
                Type::Int => format!("f{index}: int"),
                Type::Bool => format!("f{index}: bool"),
            };
            let fields: Vec<String> = symbol.fields.iter().enumerate().map(field).collect();
            if fields.is_empty() {
                symbol.name.clone()
            } else {
                format!("{}({})", symbol.name, fields.join(", "))
            }
        };
        let all: Vec<String> = self.symbols.iter().map(declare).collect();
        if self.random.chance(50) {
            vec![format!("module {}\n", all.join(", "))]
        } else {
            all.iter().map(|one| format!("module {one}\n")).collect()
        }
    }

    fn axiom(&mut self) -> String {
        let mut text = "axiom:".to_string();
        for start in 0..self.random.range(1, 2) {
            let scope = self.constants.clone();
            let symbol = self.random.pick(&self.symbols).clone();
            let args: Vec<String> = symbol.fields.iter().map(|ty| self.start_arg(&scope, *ty)).collect();
            let args = if args.is_empty() { String::new() } else { format!("({})", args.join(", ")) };
            let source = match self.random.below(4) {
                0 if !self.rational => self.inline(),
                1 => "file \"lattice.bpt\" [0]".to_string(),
                _ => "file \"lattice.bpt\"".to_string(),
            };
            let space = if start > 0 && self.random.chance(50) { "\n  " } else { " " };
            write!(text, "{space}{}{args} = {source}", symbol.name).unwrap();
        }
        text + "\n"
    }

    /// Mostly small, so that the conditions of the rules bite.
    fn start_arg(&mut self, scope: &Scope, ty: Type) -> String {
        match ty {
            Type::Int if self.random.chance(70) => self.random.range(0, 3).to_string(),
            Type::Int => self.int(scope, 1).text,
            Type::Bool => self.bool(scope, 0).text,
        }
    }

    /// A net written out.
    fn inline(&mut self) -> String {
        let mut rows = Vec::new();
        for _ in 0..=self.degree[0] {
            let row: Vec<String> = (0..=self.degree[1])
                .map(|_| format!("({}, {}, {})", self.coordinate(), self.coordinate(), self.coordinate()))
                .collect();
            rows.push(format!("[{}]", row.join(", ")));
        }
        format!("[{}]", rows.join(",\n    "))
    }

    fn coordinate(&mut self) -> i32 {
        let greatest = (1 << self.bits) - 1;
        self.random.range(-greatest, greatest)
    }

    fn nets(&mut self) -> Vec<Net> {
        let points = (self.degree[0] + 1) * (self.degree[1] + 1);
        let mut net = || {
            let mut point = || {
                let weight = if self.rational { self.random.range(1, 3) } else { 1 };
                [self.coordinate(), self.coordinate(), self.coordinate(), weight].map(f64::from)
            };
            (0..points).map(|_| point()).collect()
        };
        let all: Vec<Vec<[f64; 4]>> = (0..3).map(|_| net()).collect();
        let count = self.random.range(1, 3) as usize;
        all.into_iter().take(count).map(|points| Net::new(self.degree, points)).collect()
    }

    // --- rules -------------------------------------------------------------------------------

    fn group(&mut self, name: Option<&str>) -> String {
        let mut text = name.map_or("rules:\n".to_string(), |name| format!("rules {name}:\n"));
        let mut rules = Vec::new();
        for symbol in self.symbols.clone() {
            for _ in 0..*self.random.pick(&[0, 1, 1, 2, 2, 3]) {
                rules.push(self.rule(&symbol));
            }
        }
        if self.random.chance(30) {
            self.random.shuffle(&mut rules);
        }
        if self.random.chance(15) {
            text.push_str("  // the rules 1 to n\n");
        }
        text.extend(rules);
        text
    }

    fn rule(&mut self, symbol: &Symbol) -> String {
        let mut scope = self.constants.clone();
        scope.bind("level", Type::Int);
        scope.bind("step", Type::Int);
        self.labels += 1;
        let label = if self.random.chance(10) { format!("p{}: ", self.labels) } else { String::new() };
        let pattern = self.pattern(symbol, &mut scope);
        // A statement goes on before `let`, `:` and `->`.
        let gap = if self.random.chance(10) { "\n      " } else { " " };
        let mut text = format!("  {label}{pattern}");
        if self.random.chance(15) {
            let value = self.int(&scope, 2);
            scope.bind("x", Type::Int);
            write!(text, "{gap}let x = {}", value.text).unwrap();
            if self.random.chance(30) {
                let value = self.bool(&scope, 1);
                scope.bind("y", Type::Bool);
                write!(text, ", y = {}", value.text).unwrap();
            }
        }
        if self.random.chance(70) {
            write!(text, "{gap}: {}", self.condition(&scope)).unwrap();
        }
        let arrow = if self.random.chance(5) { "→" } else { "->" };
        let successor = self.successor(symbol, &scope);
        text + &format!("{gap}{arrow} {successor}\n")
    }

    fn pattern(&mut self, symbol: &Symbol, scope: &mut Scope) -> String {
        if symbol.fields.is_empty() || self.random.chance(10) {
            return symbol.name.clone();
        }
        let mut args = Vec::new();
        let mut bound: Vec<(String, Type)> = Vec::new();
        for ty in symbol.fields.clone() {
            let again: Vec<String> = bound.iter().filter(|(_, t)| *t == ty).map(|(n, _)| n.clone()).collect();
            let arg = match self.random.below(100) {
                0..8 => "_".to_string(),
                8..18 => match ty {
                    Type::Int => self.random.range(-1, 3).to_string(),
                    Type::Bool => self.random.chance(50).to_string(),
                },
                18..38 if !again.is_empty() => self.random.pick(&again).clone(),
                _ => {
                    let name = self.binder(bound.len(), ty);
                    // The binder may hide a const or an attribute; never another binder.
                    if bound.iter().any(|(n, _)| *n == name) {
                        "_".to_string()
                    } else {
                        scope.bind(&name, ty);
                        bound.push((name.clone(), ty));
                        name
                    }
                }
            };
            args.push(arg);
        }
        format!("{}({})", symbol.name, args.join(", "))
    }

    fn binder(&mut self, index: usize, ty: Type) -> String {
        let odd = ["level", "step", "alpha", "beta", "f0"];
        if self.random.chance(8) {
            return self.random.pick(&odd).to_string();
        }
        match ty {
            Type::Int => ["k", "n", "m", "i"][index],
            Type::Bool => ["p", "q", "r", "s"][index],
        }
        .to_string()
    }

    fn condition(&mut self, scope: &Scope) -> String {
        let Some(name) = self.int_name(scope).map(|name| name.text) else {
            return self.bool(scope, 2).text;
        };
        let text = match self.random.below(8) {
            0 => format!("{name} < {}", self.random.range(1, 4)),
            1 => {
                let other = self.int(scope, 0);
                format!("({name} + {}) % 2 == {}", other.at(5), self.random.below(2))
            }
            2 if scope.of(Type::Int).iter().any(|n| *n == "step") => {
                format!("step == {}", self.random.below(3))
            }
            3 => format!("{name} <= {}", self.fraction(scope)),
            4 => format!("{name} > {} && {name} != {}", self.random.range(-2, 1), self.literal()),
            _ => self.bool(scope, 2).text,
        };
        if self.random.chance(10) {
            text.replace("<=", "≤").replace(">=", "≥").replace("!=", "≠")
        } else {
            text
        }
    }

    /// A number that is not whole but dyadic: compared with an int it is exact in f32 too.
    fn fraction(&mut self, scope: &Scope) -> String {
        if !scope.ratios.is_empty() && self.random.chance(60) {
            return self.random.pick(&scope.ratios).clone();
        }
        self.random.pick(&["1/2", "5/2", "2.5", "-3/4", "7/2", "(1/2 + 1/4)", "1.25"]).to_string()
    }

    fn successor(&mut self, symbol: &Symbol, scope: &Scope) -> String {
        match self.random.below(100) {
            0..7 => self.random.pick(&["eps", "ε"]).to_string(),
            // One that often changes nothing, so that `until terminal` may end.
            7..14 => self.module(symbol, scope),
            14..28 => self.any_module(scope),
            _ => self.block(scope, 1),
        }
    }

    fn any_module(&mut self, scope: &Scope) -> String {
        let symbol = self.random.pick(&self.symbols).clone();
        self.module(&symbol, scope)
    }

    fn module(&mut self, symbol: &Symbol, scope: &Scope) -> String {
        if symbol.fields.is_empty() {
            return symbol.name.clone();
        }
        let args: Vec<String> = symbol.fields.iter().map(|ty| self.arg(scope, *ty)).collect();
        format!("{}({})", symbol.name, args.join(", "))
    }

    fn arg(&mut self, scope: &Scope, ty: Type) -> String {
        let names: Vec<String> = scope.of(ty).into_iter().cloned().collect();
        let Some(name) = (!names.is_empty()).then(|| self.random.pick(&names).clone()) else {
            return self.bool(scope, 1).text;
        };
        match (ty, self.random.below(10)) {
            (_, 0..=2) => name,
            (Type::Int, 3..=5) => format!("{name} + 1"),
            (Type::Int, 6) => format!("max({name} - 1, 0)"),
            (Type::Int, 7) => self.literal(),
            (Type::Int, _) => self.int(scope, 2).text,
            (Type::Bool, 3..=5) => format!("!{name}"),
            (Type::Bool, _) => self.bool(scope, 1).text,
        }
    }

    /// A 2×2, 1×2 or 2×1 block, nested up to three deep.
    fn block(&mut self, scope: &Scope, depth: usize) -> String {
        let (rows, columns) = *self.random.pick(&[(2, 2), (2, 2), (1, 2), (2, 1)]);
        let bar = rows == 1 || self.random.chance(30);
        let mut lines = Vec::new();
        for _ in 0..rows {
            let cells: Vec<String> = (0..columns).map(|_| self.cell(scope, depth)).collect();
            lines.push(cells.join(if bar { " | " } else { " " }));
        }
        // Inside brackets a newline ends nothing.
        let between = if self.random.chance(5) { " ;\n       " } else { " ; " };
        format!("[ {} ]", lines.join(between))
    }

    fn cell(&mut self, scope: &Scope, depth: usize) -> String {
        match self.random.below(100) {
            0..18 => "eps".to_string(),
            18..26 if depth < 3 => self.block(scope, depth + 1),
            _ => self.any_module(scope),
        }
    }

    // --- expressions -------------------------------------------------------------------------

    fn integer(&mut self) -> i32 {
        if self.random.chance(20) { *self.random.pick(&AWKWARD) } else { self.random.range(-3, 7) }
    }

    /// A numeral; some are written as an exact rational that is whole.
    fn literal(&mut self) -> String {
        if self.random.chance(6) {
            return self.random.pick(&["6/2", "1/3*3", "2*3", "(7 - 7)", "5/4 + 3/4"]).to_string();
        }
        self.integer().to_string()
    }

    fn literal_term(&mut self) -> Term {
        let text = self.literal();
        let precedence = if text.contains(" + ") {
            4
        } else if text.starts_with('(') {
            7
        } else if text.contains(['/', '*']) {
            5
        } else if text.starts_with('-') {
            6
        } else {
            7
        };
        Term { text, precedence, named: false }
    }

    fn int_name(&mut self, scope: &Scope) -> Option<Term> {
        let names = scope.of(Type::Int);
        (!names.is_empty()).then(|| Term::atom(self.random.pick(&names).as_str(), true))
    }

    fn int(&mut self, scope: &Scope, depth: usize) -> Term {
        if depth == 0 || self.random.chance(25) {
            let name = if self.random.chance(75) { self.int_name(scope) } else { None };
            return name.unwrap_or_else(|| self.literal_term());
        }
        match self.random.below(100) {
            0..60 => self.arithmetic(scope, depth),
            60..68 => match self.int_name(scope) {
                Some(name) => Term { text: format!("-{}", name.text), precedence: 6, named: true },
                None => self.literal_term(),
            },
            68..76 => {
                let condition = self.bool(scope, depth - 1);
                let (a, b) = (self.int(scope, depth - 1), self.int(scope, depth - 1));
                let named = a.named || b.named;
                self.call("if", &[condition, a, b], named)
            }
            76..80 => self.list_element(scope),
            _ => {
                let (name, count) = *self.random.pick(&[("min", 2), ("max", 2), ("abs", 1), ("clamp", 3)]);
                let args: Vec<Term> = (0..count).map(|_| self.int(scope, depth - 1)).collect();
                let named = args.iter().any(|a| a.named);
                self.call(name, &args, named)
            }
        }
    }

    fn call(&mut self, name: &str, args: &[Term], named: bool) -> Term {
        let args: Vec<&str> = args.iter().map(|a| a.text.as_str()).collect();
        Term::atom(format!("{name}({})", args.join(", ")), named)
    }

    /// The index is read from a name; a constant one outside the list would be an error.
    fn list_element(&mut self, scope: &Scope) -> Term {
        let free = |name: &&String| !self.constants.names.iter().any(|(n, _)| n == *name);
        let indices: Vec<&String> = scope.of(Type::Int).into_iter().filter(free).collect();
        if scope.lists.is_empty() || indices.is_empty() {
            return self.literal_term();
        }
        let (list, index) = (self.random.pick(&scope.lists), self.random.pick(&indices));
        Term::atom(format!("{list}[{index}]"), true)
    }

    fn arithmetic(&mut self, scope: &Scope, depth: usize) -> Term {
        let (operator, precedence) = *self.random.pick(&[("+", 4), ("-", 4), ("*", 5), ("/", 5), ("%", 5)]);
        let (a, mut b) = (self.int(scope, depth - 1), self.int(scope, depth - 1));
        if !a.named && !b.named {
            match self.int_name(scope) {
                Some(name) => b = name,
                None => return a,
            }
        }
        // Operators of one precedence go from left to right.
        let text = format!("{} {operator} {}", a.at(precedence), b.at(precedence + 1));
        Term { text, precedence, named: true }
    }

    fn bool(&mut self, scope: &Scope, depth: usize) -> Term {
        let names = scope.of(Type::Bool);
        if depth == 0 || self.random.chance(15) {
            if !names.is_empty() && self.random.chance(80) {
                return Term::atom(self.random.pick(&names).as_str(), true);
            }
            if depth == 0 {
                return Term::atom(self.random.chance(60).to_string(), false);
            }
        }
        match self.random.below(10) {
            0..=5 => self.comparison(scope, depth),
            6 => {
                let inner = self.bool(scope, depth - 1);
                Term { text: format!("!{}", inner.at(7)), precedence: 6, named: inner.named }
            }
            7 => {
                // Comparisons do not chain: on both sides they stand in parentheses.
                let (a, b) = (self.bool(scope, depth - 1), self.bool(scope, depth - 1));
                let operator = self.random.pick(&["==", "!="]);
                let text = format!("{} {operator} {}", a.at(4), b.at(4));
                Term { text, precedence: 3, named: a.named || b.named }
            }
            _ => {
                let (a, b) = (self.bool(scope, depth - 1), self.bool(scope, depth - 1));
                let (operator, precedence) = *self.random.pick(&[("&&", 2), ("||", 1)]);
                let text = format!("{} {operator} {}", a.at(precedence), b.at(precedence + 1));
                Term { text, precedence, named: a.named || b.named }
            }
        }
    }

    fn comparison(&mut self, scope: &Scope, depth: usize) -> Term {
        let mut a = self.int(scope, depth - 1);
        if !a.named && self.random.chance(80) {
            a = self.int_name(scope).unwrap_or(a);
        }
        let b = if self.random.chance(15) {
            let text = self.fraction(scope);
            Term { precedence: if text.contains('/') { 5 } else { 6 }, text, named: false }
        } else {
            self.int(scope, depth - 1)
        };
        let operator = self.random.pick(&["<", "<=", ">", ">=", "==", "!="]);
        let text = format!("{} {operator} {}", a.at(4), b.at(4));
        Term { text, precedence: 3, named: a.named || b.named }
    }

    // --- schedule ----------------------------------------------------------------------------

    fn run(&mut self, size: i32) -> String {
        if self.groups.contains(&None) && self.random.chance(10) {
            return String::new();
        }
        let mut text = "run:\n".to_string();
        for _ in 0..self.random.range(1, 3) {
            text += &self.step(size, 1);
        }
        text
    }

    fn step(&mut self, size: i32, depth: usize) -> String {
        let indent = "  ".repeat(depth);
        let count = self.count(size);
        match self.random.below(10) {
            0..=4 => format!("{indent}derive {count}{}\n", self.with()),
            5 | 6 => format!("{indent}derive until terminal max {count}{}\n", self.with()),
            kind if depth < 3 => {
                let head = if kind == 7 {
                    let scope = self.constants.clone();
                    format!("if {}", self.bool(&scope, 1).text)
                } else {
                    format!("repeat {}", self.count(2))
                };
                let body: String =
                    (0..self.random.range(1, 2)).map(|_| self.step((size / 2).max(1), depth + 1)).collect();
                format!("{indent}{head} {{\n{body}{indent}}}\n")
            }
            _ => format!("{indent}derive 1{}\n", self.with()),
        }
    }

    fn count(&mut self, size: i32) -> String {
        let least = i32::from(self.random.chance(90));
        let literal = self.random.range(least, size);
        if self.small.is_empty() || self.random.chance(70) {
            return literal.to_string();
        }
        let name = self.random.pick(&self.small).clone();
        if self.random.chance(50) { name } else { format!("{name} + {}", literal.min(2)) }
    }

    /// ` with a, b` of the groups that there are; nothing for the unnamed one.
    fn with(&mut self) -> String {
        let mut named: Vec<String> = self.groups.iter().flatten().cloned().collect();
        let unnamed = self.groups.contains(&None);
        if named.is_empty() || unnamed && self.random.chance(40) {
            return String::new();
        }
        self.random.shuffle(&mut named);
        named.truncate(1 + self.random.below(named.len()));
        format!(" with {}", named.join(", "))
    }
}
