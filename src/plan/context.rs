//! What stands around a module: the places that a rule looks at, and what it asks for there.
//!
//! In words whose modules stand side by side a place is so many records to the left or right. In linked words
//! ([`super::layout`]) it is found along links: ancestors, and the module that goes on. A right context with branches
//! is a [`Search`]: which branch is meant may hang on what follows.

use super::graph::Scalar;
use super::layout::END;
use super::tables::Symbol;
use crate::language::expr::{Expr, ExprKind};
use crate::language::system::{Binder, BinderPlace, ContextPart, Kind, Rule, System, Topology};

/// A place that a rule looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    /// The predecessor, or of several the one so many behind the first.
    Strict(u32),
    /// So many modules before the predecessor; in a tree ancestors.
    Before(u32),
    /// The record before, whatever hangs on what: of the first of all there is none.
    Previous,
    /// So many modules behind the last of the predecessors, on its axis.
    Behind { last: u32, steps: u32 },
    /// What a search found in this step.
    Found { search: usize, step: usize },
}

impl Place {
    /// Places to the right of the predecessor, where the modules of a word stand side by side.
    pub fn offset(self) -> i32 {
        match self {
            Place::Strict(n) => n as i32,
            Place::Before(n) => -(n as i32),
            Place::Previous => -1,
            Place::Behind { last, steps } => (last + steps) as i32,
            // Only trees have branches.
            Place::Found { .. } => 0,
        }
    }
}

/// In place of a symbol: one that stands nowhere.
const NEVER: u32 = 1 << 16;

/// A module that a rule asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Near {
    pub place: Place,
    /// The symbol that must stand there, or [`END`].
    pub symbol: u32,
}

/// A right context with branches: step by step in the order written, of several ways the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Search {
    /// The last of the predecessors, where it begins.
    pub last: u32,
    pub steps: Vec<Step>,
}

/// A module of a search, and what it must be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    pub go: Go,
    /// The symbol that must stand there, or [`END`].
    pub symbol: u32,
    /// Demands of literals, and of names that are bound twice.
    pub tests: Vec<Equal>,
}

/// Where a step leads; from the predecessor, or from what an earlier step has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Go {
    /// To the module that goes on.
    On(Option<usize>),
    /// To the first of a branch, one behind that of step `after`.
    Branch { at: Option<usize>, after: Option<usize> },
}

/// Two numbers that must be equal; where one is a float, as floats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Equal {
    pub a: Operand,
    pub b: Operand,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    Literal(Scalar, u32),
    /// A word of the record at a place.
    Word(Scalar, Place, usize),
}

impl Operand {
    /// What it is.
    pub fn scalar(self) -> Scalar {
        match self {
            Operand::Literal(ty, _) | Operand::Word(ty, ..) => ty,
        }
    }
}

/// What a rule asks for around its predecessor, and where its binders stand.
pub struct Surroundings {
    pub context: Vec<Near>,
    /// Fields of modules around the predecessor that its expressions read: (place, word of the record).
    pub reads: Vec<(Place, usize)>,
    /// For each binder that is none of the predecessor's own fields the index of its read.
    pub binders: Vec<Option<usize>>,
}

/// Reads the contexts of a rule; a search is put behind `searches`.
pub fn surroundings(
    rule: &Rule,
    system: &System,
    symbols: &[Symbol],
    searches: &mut Vec<Search>,
) -> Surroundings {
    let last = rule.strict.len() as u32 - 1;
    let mut context: Vec<Near> = Vec::new();
    let mut ask = |place: Place, symbol: usize| context.push(Near { place, symbol: symbol as u32 });
    rule.strict.iter().enumerate().skip(1).for_each(|(n, &symbol)| ask(Place::Strict(n as u32), symbol));
    let depth = rule.left.as_ref().map_or(0, |c| c.symbols.len());
    let before = |module: usize| Place::Before((depth - module) as u32);
    if let Some(left) = &rule.left {
        left.symbols.iter().enumerate().for_each(|(n, &symbol)| ask(before(n), symbol));
        if left.end {
            ask(Place::Before(depth as u32 + 1), END as usize);
        }
    }
    let right = rule.right.as_ref();
    let search = right.filter(|c| c.parts.iter().any(|part| matches!(part, ContextPart::Branch(..))));
    let mut places = Vec::new();
    if let Some(c) = search {
        let mut found = Found { symbols: &c.symbols, steps: Vec::new(), of_module: vec![0; c.symbols.len()] };
        found.axis(&c.parts, c.end, None);
        let search = searches.len();
        places.extend(found.of_module.iter().map(|&step| Place::Found { search, step }));
        let first = found.of_module[0];
        ask(Place::Found { search, step: first }, c.symbols[0]);
        searches.push(Search { last, steps: found.steps });
    } else if let Some(c) = right {
        let behind = |n: usize| Place::Behind { last, steps: n as u32 + 1 };
        places.extend((0..c.symbols.len()).map(behind));
        places.iter().zip(&c.symbols).for_each(|(&place, &symbol)| ask(place, symbol));
        if c.end {
            ask(behind(c.symbols.len()), END as usize);
        }
    }
    // A ring has no ends, though all of it may be ignored.
    if system.kind == Kind::Curve(Topology::Ring) {
        let ends = context.iter_mut().filter(|near| near.symbol == END);
        ends.for_each(|near| near.symbol = NEVER);
    }
    // In a ring of one symbol every module has that one around it.
    if system.kind == Kind::Curve(Topology::Ring) && symbols.len() == 1 && system.ignored.is_empty() {
        context.retain(|near| near.symbol == NEVER || matches!(near.place, Place::Strict(_)));
    }

    // For each binder its place and the word of the record there.
    let of_binder = |binder: &Binder| {
        let (place, symbol, field) = match binder.place {
            BinderPlace::Left { module, field } => {
                (before(module), rule.left.as_ref()?.symbols[module], field)
            }
            BinderPlace::Strict { module, field } => {
                (Place::Strict(module as u32), *rule.strict.get(module)?, field)
            }
            BinderPlace::Right { module, field } => (places[module], right?.symbols[module], field),
            _ => return None,
        };
        Some((place, symbols[symbol].words[field]))
    };
    let stands: Vec<Option<(Place, usize)>> = rule.binders.iter().map(of_binder).collect();
    if search.is_some()
        && let Some(search) = searches.last_mut()
    {
        demand(rule, &stands, search);
    }
    let mut reads = Vec::new();
    let mut read = |stands: &Option<(Place, usize)>| {
        let (place, word) = (*stands)?;
        (place != Place::Strict(0)).then(|| {
            reads.push((place, word));
            reads.len() - 1
        })
    };
    let binders = stands.iter().map(&mut read).collect();
    Surroundings { context, reads, binders }
}

/// Gives each test of the rule to the step of the search that finds the last of what it reads.
fn demand(rule: &Rule, stands: &[Option<(Place, usize)>], search: &mut Search) {
    for test in &rule.tests {
        let ExprKind::Call(_, args) = &test.kind else { continue };
        let [Some(a), Some(b)] = [0, 1].map(|n| args.get(n).and_then(|arg| operand(arg, stands))) else {
            continue;
        };
        let step = |operand: Operand| match operand {
            Operand::Word(_, Place::Found { step, .. }, _) => Some(step),
            _ => None,
        };
        if let Some(step) = step(a).max(step(b)) {
            search.steps[step].tests.push(Equal { a, b });
        }
    }
}

/// A side of an equality: a literal, or a number that a pattern binds.
fn operand(e: &Expr, stands: &[Option<(Place, usize)>]) -> Option<Operand> {
    match &e.kind {
        ExprKind::Literal(value) => Some(Operand::Literal(Scalar::of(&e.ty), value.words()[0])),
        ExprKind::Binder(n) => {
            let (place, word) = stands[*n]?;
            Some(Operand::Word(Scalar::of(&e.ty), place, word))
        }
        ExprKind::Component(v, component) => match operand(v, stands)? {
            Operand::Word(ty, place, word) => Some(Operand::Word(ty, place, word + component)),
            literal => Some(literal),
        },
        // An int beside a float.
        ExprKind::Call(_, args) if args.len() == 1 => operand(&args[0], stands),
        _ => None,
    }
}

/// A right context with branches as it is read.
struct Found<'a> {
    symbols: &'a [usize],
    steps: Vec<Step>,
    /// For each module as written the step that finds it.
    of_module: Vec<usize>,
}

impl Found<'_> {
    fn step(&mut self, go: Go, symbol: u32) -> usize {
        self.steps.push(Step { go, symbol, tests: Vec::new() });
        self.steps.len() - 1
    }

    fn module(&mut self, go: Go, module: usize) -> usize {
        let step = self.step(go, self.symbols[module] as u32);
        self.of_module[module] = step;
        step
    }

    /// Along an axis behind step `at`, and into the branches on the way.
    fn axis(&mut self, parts: &[ContextPart], end: bool, mut at: Option<usize>) {
        let mut after = None;
        for part in parts {
            match part {
                ContextPart::Module(module) => {
                    at = Some(self.module(Go::On(at), *module));
                    after = None;
                }
                ContextPart::Branch(inner, end) => {
                    // It begins with a module: the checker has seen to it.
                    let [ContextPart::Module(first), rest @ ..] = &inner[..] else { continue };
                    let step = self.module(Go::Branch { at, after }, *first);
                    after = Some(step);
                    self.axis(rest, *end, Some(step));
                }
            }
        }
        if end {
            self.step(Go::On(at), END);
        }
    }
}
