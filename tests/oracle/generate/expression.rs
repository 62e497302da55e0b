//! Random expressions: awkward integers, precedence, names that hide one another.

use super::system::Generator;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    Int,
    Bool,
    /// Multiples of a quarter, so that f32 and f64 compute the same.
    Float,
}

/// The names that an expression may read.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    pub names: Vec<(String, Type)>,
    /// Constant lists of ints.
    pub lists: Vec<String>,
    /// Constants of type float, for comparisons only.
    pub ratios: Vec<String>,
}

impl Scope {
    /// The newest binding hides the others.
    pub fn bind(&mut self, name: &str, ty: Type) {
        let hidden = |n: &String| n == name;
        self.names.retain(|(n, _)| !hidden(n));
        self.lists.retain(|n| !hidden(n));
        self.ratios.retain(|n| !hidden(n));
        self.names.push((name.to_string(), ty));
    }

    pub fn of(&self, ty: Type) -> Vec<&String> {
        self.names.iter().filter(|(_, t)| *t == ty).map(|(n, _)| n).collect()
    }
}

/// A piece of an expression.
pub struct Term {
    pub text: String,
    /// As of `BinaryOp::precedence`; 6 for signs, 7 for what needs no parentheses.
    pub precedence: u8,
    /// Whether a name occurs: without one it would be an exact rational, not i32.
    pub named: bool,
}

impl Term {
    fn atom(text: impl Into<String>, named: bool) -> Term {
        Term { text: text.into(), precedence: 7, named }
    }

    /// In parentheses if it binds less tightly than it must.
    pub fn at(&self, precedence: u8) -> String {
        if self.precedence < precedence { format!("({})", self.text) } else { self.text.clone() }
    }
}

const AWKWARD: [i32; 10] =
    [i32::MIN, i32::MIN + 1, i32::MAX, i32::MAX - 1, 46341, -46341, 65536, 1 << 30, 65535, -(1 << 30)];

impl Generator {
    pub fn integer(&mut self) -> i32 {
        if self.random.chance(20) { *self.random.pick(&AWKWARD) } else { self.random.range(-3, 7) }
    }

    /// A numeral; some are written as an exact rational that is whole.
    pub fn literal(&mut self) -> String {
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

    pub fn int_name(&mut self, scope: &Scope) -> Option<Term> {
        let names = scope.of(Type::Int);
        (!names.is_empty()).then(|| Term::atom(self.random.pick(&names).as_str(), true))
    }

    pub fn int(&mut self, scope: &Scope, depth: usize) -> Term {
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

    pub fn bool(&mut self, scope: &Scope, depth: usize) -> Term {
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

    /// Quarters stay quarters: sums, halves of whole numbers, and what chooses.
    pub fn float(&mut self, scope: &Scope, depth: usize) -> Term {
        let names = scope.of(Type::Float);
        if depth == 0 || self.random.chance(25) {
            if !names.is_empty() && self.random.chance(75) {
                return Term::atom(self.random.pick(&names).as_str(), true);
            }
            let text = *self.random.pick(&["0.25", "-1.5", "2.75", "0.5", "7.25"]);
            let precedence = if text.starts_with('-') { 6 } else { 7 };
            return Term { text: text.to_string(), precedence, named: false };
        }
        match self.random.below(10) {
            0..=3 => {
                let (a, b) = (self.float(scope, depth - 1), self.float(scope, depth - 1));
                let operator = self.random.pick(&["+", "-"]);
                let text = format!("{} {operator} {}", a.at(4), b.at(5));
                Term { text, precedence: 4, named: a.named || b.named }
            }
            4 => {
                let a = self.float(scope, depth - 1);
                Term { text: format!("floor({}) * 0.5", a.text), precedence: 5, named: a.named }
            }
            5 => {
                let condition = self.bool(scope, depth - 1);
                let (a, b) = (self.float(scope, depth - 1), self.float(scope, depth - 1));
                let named = a.named || b.named;
                self.call("if", &[condition, a, b], named)
            }
            6 => {
                let a = self.int(scope, depth - 1);
                Term::atom(format!("float(clamp({}, -9, 9))", a.text), true)
            }
            7 => {
                let a = self.float(scope, depth - 1);
                Term::atom(format!("clamp({}, -2.5, 9.25)", a.text), a.named)
            }
            8 => {
                let a = self.float(scope, depth - 1);
                let named = a.named;
                self.call("abs", &[a], named)
            }
            _ => {
                let (a, b) = (self.float(scope, depth - 1), self.float(scope, depth - 1));
                let (name, named) = (*self.random.pick(&["min", "max"]), a.named || b.named);
                self.call(name, &[a, b], named)
            }
        }
    }

    fn comparison(&mut self, scope: &Scope, depth: usize) -> Term {
        if !scope.of(Type::Float).is_empty() && self.random.chance(25) {
            let (a, b) = (self.float(scope, depth - 1), self.float(scope, depth - 1));
            let operator = self.random.pick(&["<", "<=", ">", ">=", "==", "!="]);
            let text = format!("{} {operator} {}", a.at(4), b.at(4));
            return Term { text, precedence: 3, named: a.named || b.named };
        }
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
}
