//! Random declarations, rules and schedules.

use super::super::halving::Net;
use super::super::word::Param;
use super::expression::{Scope, Type};
use super::random::Random;
use std::fmt::Write;

#[derive(Clone, Debug)]
struct Symbol {
    name: String,
    fields: Vec<Type>,
}

/// A param, as `overrides` sees it.
#[derive(Clone, Debug)]
struct Slider {
    name: String,
    ty: Type,
    range: Option<(i32, i32)>,
}

pub struct Generator {
    pub random: Random,
    degree: [usize; 2],
    rational: bool,
    pub bits: u32,
    symbols: Vec<Symbol>,
    /// Consts and params.
    pub constants: Scope,
    /// Names of consts and params with a value of 0 to 3, for counts.
    small: Vec<String>,
    /// Params with their range.
    params: Vec<Slider>,
    pub(super) groups: Vec<Option<String>>,
    /// Rules so far: no two have one label.
    labels: usize,
}

impl Generator {
    pub fn new(seed: u64) -> Generator {
        let mut random = Random::new(seed);
        let cubic = random.chance(50);
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
    pub fn system(&mut self) -> String {
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

    pub(super) fn constant(&mut self, index: usize) -> String {
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

    pub fn overrides(&mut self) -> Vec<(String, Param)> {
        let mut set = Vec::new();
        for Slider { name, ty, range } in self.params.clone() {
            if !self.random.chance(40) {
                continue;
            }
            let value = match (ty, range) {
                (Type::Bool, _) => Param::Bool(self.random.chance(50)),
                (Type::Int, Some((low, high))) => Param::Int(self.random.range(low, high)),
                (Type::Int, None) => Param::Int(self.integer()),
                (Type::Float, _) => Param::Float(0.25),
            };
            set.push((name, value));
        }
        set
    }

    // --- symbols and axiom -------------------------------------------------------------------

    fn draw_symbols(&mut self) {
        for name in ["A", "B", "Leaf_1", "D", "E2"].iter().take(self.random.range(1, 5) as usize) {
            let count = *self.random.pick(&[0, 1, 1, 2, 2, 3, 4]);
            let fields = (0..count)
                .map(|_| *self.random.pick(&[Type::Int, Type::Int, Type::Bool, Type::Float]))
                .collect();
            self.symbols.push(Symbol { name: name.to_string(), fields });
        }
    }

    fn modules(&mut self) -> Vec<String> {
        let declare = |symbol: &Symbol| {
            let field = |(index, ty): (usize, &Type)| match ty {
                Type::Int => format!("f{index}: int"),
                Type::Bool => format!("f{index}: bool"),
                Type::Float => format!("f{index}: float"),
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
                0 => self.inline(),
                1 => "file \"lattice.bpt\" [0]".to_string(),
                _ => "file \"lattice.bpt\"".to_string(),
            };
            let space = if start > 0 && self.random.chance(50) { "\n  " } else { " " };
            write!(text, "{space}{}{args} = {source}", symbol.name).unwrap();
        }
        text + "\n"
    }

    /// Mostly small, so that the conditions of the rules bite.
    pub(super) fn start_arg(&mut self, scope: &Scope, ty: Type) -> String {
        match ty {
            Type::Int if self.random.chance(70) => self.random.range(0, 3).to_string(),
            Type::Int => self.int(scope, 1).text,
            Type::Bool => self.bool(scope, 0).text,
            Type::Float => self.float(scope, 0).text,
        }
    }

    /// A net written out, of points as files hold them.
    fn inline(&mut self) -> String {
        let weighted = self.rational && self.random.chance(80);
        let mut rows = Vec::new();
        for _ in 0..=self.degree[0] {
            let row: Vec<String> = (0..=self.degree[1]).map(|_| self.inline_point(weighted)).collect();
            rows.push(format!("[{}]", row.join(", ")));
        }
        format!("[{}]", rows.join(",\n    "))
    }

    /// Times its weight it is still below 2^bits.
    fn inline_point(&mut self, weighted: bool) -> String {
        let weight = if weighted { self.random.range(1, 3) } else { 1 };
        let [x, y, z] = [0; 3].map(|_| self.coordinate() / weight);
        if weighted { format!("({x}, {y}, {z}, {weight})") } else { format!("({x}, {y}, {z})") }
    }

    fn coordinate(&mut self) -> i32 {
        let greatest = (1 << self.bits) - 1;
        self.random.range(-greatest, greatest)
    }

    pub fn nets(&mut self) -> Vec<Net> {
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
                    Type::Float => "_".to_string(),
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
            Type::Float => ["u", "v", "w", "t"][index],
        }
        .to_string()
    }

    fn condition(&mut self, scope: &Scope) -> String {
        let Some(name) = self.int_name(scope).map(|name| name.text) else {
            return self.bool(scope, 2).text;
        };
        if self.random.chance(15) {
            return self.measured();
        }
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

    /// What is measured of a net against a number that no net of integers meets.
    fn measured(&mut self) -> String {
        let names = ["flatness", "bend_u", "bend_v", "area", "centroid.x", "centroid.z", "uv.y"];
        let (name, sign) = (*self.random.pick(&names), *self.random.pick(&["<", ">", ">="]));
        format!("{name} {sign} {}", self.random.pick(&["0.37", "1.73", "5.3", "31.7", "-0.9"]))
    }

    /// A number that is not whole but dyadic: compared with an int it is exact in f32 too.
    pub fn fraction(&mut self, scope: &Scope) -> String {
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

    pub(super) fn arg(&mut self, scope: &Scope, ty: Type) -> String {
        let names: Vec<String> = scope.of(ty).into_iter().cloned().collect();
        let Some(name) = (!names.is_empty()).then(|| self.random.pick(&names).clone()) else {
            return if ty == Type::Float { self.float(scope, 1).text } else { self.bool(scope, 1).text };
        };
        match (ty, self.random.below(10)) {
            (_, 0..=2) => name,
            (Type::Int, 3..=5) => format!("{name} + 1"),
            (Type::Int, 6) => format!("max({name} - 1, 0)"),
            (Type::Int, 7) => self.literal(),
            (Type::Int, _) => self.int(scope, 2).text,
            (Type::Bool, 3..=5) => format!("!{name}"),
            (Type::Bool, _) => self.bool(scope, 1).text,
            (Type::Float, 3..=5) => format!("{name} + 0.25"),
            (Type::Float, _) => self.float(scope, 2).text,
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

    // --- schedule ----------------------------------------------------------------------------

    pub fn run(&mut self, size: i32) -> String {
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
    pub fn with(&mut self) -> String {
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
