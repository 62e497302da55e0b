//! Rules as tables: what a checked patch system becomes before a backend sees it.
//!
//! A rule set holds the rules of one `derive … with …` in order of priority. It runs in *stages*:
//! the first holds the rules as written; a nested block leaves *pending* modules with hidden
//! symbols, which the next stage splits, until none is left. So one kernel that splits a net once
//! serves blocks of any depth, and a nested block halves outermost first.

mod build;

use crate::language::Span;
use crate::language::expr::{Expr, ExprKind, Type};
use crate::language::system::{self, Field, Hang, System};
use crate::plan::code::StageCode;
use crate::plan::context::{Near, Place, Search};
use crate::plan::given::Places;
use crate::plan::kind::{self, WordKind};
use crate::plan::layout::{END, Layout};
use crate::plan::links::{Linked, Links};
use crate::plan::measure::Row;
use crate::plan::program::Program;
use crate::plan::supported::{self, Unsupported};
use crate::plan::turtle::Turtle;
pub(in crate::plan) use build::{Builder, Resolve, successor};
use std::ops::Range;

/// A symbol of the tables: those of the system first, then the hidden ones of nested blocks.
#[derive(Clone, Debug)]
pub struct Symbol {
    pub name: String,
    pub fields: Vec<Field>,
    /// For each field, the word of the record where it begins.
    pub words: Vec<usize>,
    /// Made by the tables for the inside of a nested block.
    pub hidden: bool,
}

impl Symbol {
    /// The words of the record that hold floats.
    pub fn float_words(&self) -> impl Iterator<Item = usize> + '_ {
        let float = |ty: &Type| !matches!(ty, Type::Int | Type::Bool);
        let fields = self.fields.iter().zip(&self.words).filter(move |(f, _)| float(&f.ty));
        fields.flat_map(|(f, &at)| at..at + f.ty.words())
    }
}

/// One module of a successor.
#[derive(Clone, Debug)]
pub struct Successor {
    pub symbol: usize,
    /// One for each field; binders read the predecessor's fields.
    pub args: Vec<Expr>,
    /// In a word: what it hangs on, and its slot.
    pub hang: Hang,
}

impl Successor {
    /// The same in its place in a word.
    pub fn hanging(self, hang: Hang) -> Successor {
        Successor { hang, ..self }
    }
}

/// When one of its productions is drawn.
#[derive(Clone, Debug)]
pub struct MatchRule {
    pub predecessor: usize,
    /// The symbols of the predecessors behind it.
    pub others: Vec<usize>,
    /// What stands around it. Nothing is asked for where it is sure.
    pub context: Vec<Near>,
    /// Fields of modules around it that its expressions read, (place, word of the record): the binders behind those
    /// of the predecessor's own fields.
    pub reads: Vec<(Place, usize)>,
    /// Values that the expressions below and the productions' arguments may read, in order.
    pub lets: Vec<Expr>,
    /// All must hold.
    pub guards: Vec<Expr>,
    /// One a production where the rule has alternatives; else none.
    pub weights: Vec<Expr>,
    /// Its productions, by rule id.
    pub productions: Range<usize>,
    /// Identifies the draw: from its label, or its index in the group.
    pub site: u32,
    pub span: Span,
}

/// What one module becomes; the index in [`Stage::productions`] is the rule id.
#[derive(Clone, Debug)]
pub struct Production {
    /// Index into [`Stage::rules`].
    pub rule: usize,
    pub predecessor: usize,
    /// Modules that it replaces: the predecessor, and those behind it.
    pub length: u32,
    pub becomes: Becomes,
    pub span: Span,
}

/// What a production makes of its predecessor.
#[derive(Clone, Debug)]
pub enum Becomes {
    /// The net's halves.
    Nets {
        /// Which directions are halved: bit 0 u, bit 1 v. 0 with one live cell is a relabelling.
        halves: u32,
        /// By 2·(half of u) + (half of v); what is `None` is erased.
        cells: [Option<Successor>; 4],
    },
    /// A word.
    Word {
        modules: Vec<Successor>,
        /// The module that what hung on the predecessor hangs on; none where nothing of it is left on the axis.
        exit: Option<usize>,
        /// One module is written, which keeps the path.
        relabels: bool,
    },
}

impl Becomes {
    /// A word of no module.
    pub fn nothing() -> Becomes {
        Becomes::Word { modules: Vec::new(), exit: None, relabels: false }
    }
}

impl Production {
    /// Which directions of a net are halved.
    pub fn halves(&self) -> u32 {
        match self.becomes {
            Becomes::Nets { halves, .. } => halves,
            Becomes::Word { .. } => 0,
        }
    }
    /// Where a module may be written: the cells of a net, or the places of a word.
    pub fn cells(&self) -> usize {
        match &self.becomes {
            Becomes::Nets { cells, .. } => cells.len(),
            Becomes::Word { modules, .. } => modules.len(),
        }
    }
    /// The module of a cell; none of one that is erased.
    pub fn successor(&self, cell: usize) -> Option<&Successor> {
        match &self.becomes {
            Becomes::Nets { cells, .. } => cells.get(cell)?.as_ref(),
            Becomes::Word { modules, .. } => modules.get(cell),
        }
    }
    /// The modules that are written, in order, with their cells.
    pub fn successors(&self) -> impl Iterator<Item = (usize, &Successor)> {
        (0..self.cells()).filter_map(|cell| Some((cell, self.successor(cell)?)))
    }
    /// The module of a word that what hung on the predecessor hangs on.
    pub fn exit(&self) -> Option<usize> {
        match self.becomes {
            Becomes::Nets { .. } => None,
            Becomes::Word { exit, .. } => exit,
        }
    }
    /// How many modules come of one.
    pub fn count(&self) -> u32 {
        self.successors().count() as u32
    }
    /// Keeps the net and the symbol: then unchanged parameters mean that nothing fired.
    pub fn relabels_itself(&self) -> bool {
        let one = self.halves() == 0 && self.count() == 1 && self.length == 1;
        one && self.successor(0).is_some_and(|c| c.symbol == self.predecessor && !c.hang.lateral)
    }
    /// Its word in the environment buffer: bits 0–1 which directions are halved, 4–7 the first four cells that live, 8–15
    /// how many do, 16–18 how many modules it claims behind its predecessor, 24–31 its exit or [`NO_EXIT`].
    pub fn word(&self) -> u32 {
        let live = self.successors().filter(|(cell, _)| *cell < 4).fold(0, |m, (cell, _)| m | 1 << cell);
        let exit = self.exit().map_or(NO_EXIT, |cell| cell as u32);
        self.halves() | live << 4 | self.count() << 8 | (self.length - 1) << 16 | exit << 24
    }
}

/// Where a rule's word says that nothing is left on the axis.
pub const NO_EXIT: u32 = 255;

/// A word of the rule table.
pub fn rule_word(halves: u32, live: u32) -> u32 {
    let exit = if live == 0 { NO_EXIT } else { 0 };
    halves | live << 4 | live.count_ones() << 8 | exit << 24
}

/// The rules that run in one sweep of the passes.
#[derive(Clone, Debug)]
pub struct Stage {
    /// By priority.
    pub rules: Vec<MatchRule>,
    pub productions: Vec<Production>,
    /// For each symbol its rules, by priority.
    pub by_symbol: Vec<Vec<usize>>,
    /// For each symbol: a module on which no rule fires now never sees one fire in this derivation.
    pub retires: Vec<bool>,
    /// Every module that can occur has this many successors, by its symbol alone.
    pub closed: Option<u32>,
    /// Holds the rules as written, not what nested blocks left.
    pub first: bool,
    /// What it writes are roots: the points of a turtle.
    pub roots: bool,
    /// No module is read by another, so that those on which nothing can fire any more may be retired.
    pub alone: bool,
    /// The attributes of nets that its rules read.
    pub row: Row,
    /// The rules' expressions as graphs; made when all symbols are known.
    pub code: StageCode,
    /// The passes that it runs; made then, too.
    pub program: Program,
}

impl Stage {
    fn new(rules: Vec<(MatchRule, Vec<Production>)>, first: bool, alone: bool) -> Stage {
        let (rules, productions): (Vec<MatchRule>, Vec<Vec<Production>>) = rules.into_iter().unzip();
        let mut stage = Stage {
            rules,
            productions: Vec::new(),
            by_symbol: Vec::new(),
            retires: Vec::new(),
            closed: None,
            first,
            roots: false,
            alone,
            row: Row::default(),
            code: StageCode::default(),
            program: Program::default(),
        };
        for (rule, list) in productions.into_iter().enumerate() {
            let start = stage.productions.len();
            stage.productions.extend(list.into_iter().map(|p| Production { rule, ..p }));
            stage.rules[rule].productions = start..stage.productions.len();
        }
        stage
    }

    /// What depends on the symbols of all rule sets.
    fn complete(
        &mut self,
        symbols: &[Symbol],
        searches: &[Search],
        places: &Environment,
        layout: &Layout,
        (kind, ignoring): (&dyn WordKind, bool),
    ) {
        self.by_symbol = vec![Vec::new(); symbols.len()];
        for (id, rule) in self.rules.iter().enumerate() {
            self.by_symbol[rule.predecessor].push(id);
        }
        self.retires = self
            .by_symbol
            .iter()
            .map(|ids| {
                self.first && self.alone && !ids.iter().any(|id| self.changes_by_itself(&self.rules[*id]))
            })
            .collect();
        // Links are made of what the scan says.
        self.closed = if layout.one_piece() { None } else { closed_growth(self, symbols) };
        self.row = Row::of_stage(self);
        self.code = StageCode::new(self, symbols, searches, places, layout);
        self.program = kind.program(self, layout, ignoring);
    }

    /// Whether the rule may fire later on a module on which it does not fire now.
    fn changes_by_itself(&self, rule: &MatchRule) -> bool {
        let productions = &self.productions[rule.productions.clone()];
        let args = productions.iter().flat_map(|p| p.successors().flat_map(|(_, c)| &c.args));
        let own = rule.lets.iter().chain(&rule.guards).chain(&rule.weights);
        !rule.weights.is_empty() || own.chain(args).any(changes_with_step)
    }

    /// The rule id that says: kept as it is, still to be looked at in the next step.
    pub fn keep(&self) -> u32 {
        self.productions.len() as u32
    }
    /// The rule id that says: no rule can ever fire on it again in this derivation. Of curves: another one has
    /// claimed it, and it becomes nothing.
    pub fn retired(&self) -> u32 {
        self.productions.len() as u32 + 1
    }
    /// The rule id of a module of this symbol on which no rule fires.
    pub fn idle(&self, symbol: usize) -> u32 {
        if self.retires[symbol] { self.retired() } else { self.keep() }
    }
    /// The rule id of a module whose symbol has no rules here: retired, but for the stages that
    /// only split pending modules.
    pub fn without_rules(&self) -> u32 {
        if self.first && self.alone { self.retired() } else { self.keep() }
    }
    /// The rule table: a word for each production, then keep and retired.
    pub fn rule_words(&self) -> Vec<u32> {
        let keep = rule_word(0, 1);
        self.productions.iter().map(Production::word).chain([keep, rule_word(0, 0)]).collect()
    }
    /// The word of the environment where the rule table begins.
    pub fn rule_table(&self) -> usize {
        let constants = &self.code.constants;
        (constants.base + constants.words.len()).next_multiple_of(4)
    }
    /// The most modules that one can become.
    pub fn max_count(&self) -> u32 {
        self.productions.iter().map(Production::count).max().unwrap_or(1).max(1)
    }
    /// The first production of the rule of this symbol that is tried first. Where the stage is closed no other fires, and
    /// nothing is matched.
    pub fn first_production(&self, symbol: usize) -> Option<usize> {
        Some(self.rules[*self.by_symbol[symbol].first()?].productions.start)
    }
    /// The rule that fires on every module of this symbol, if the symbol alone decides.
    pub fn unconditional(&self, symbol: usize) -> Option<usize> {
        let rule = &self.rules[*self.by_symbol[symbol].first()?];
        let sure = rule.context.is_empty()
            && rule.others.is_empty()
            && rule.guards.is_empty()
            && rule.weights.is_empty();
        let first = rule.productions.start;
        (sure && !self.productions[first].relabels_itself()).then_some(first)
    }
    /// Some rule replaces several modules.
    pub fn claims(&self) -> bool {
        self.rules.iter().any(|rule| !rule.others.is_empty())
    }
    /// Some production leaves nothing on the axis, so that what hung on its predecessor hangs on what that hung on.
    pub fn unhangs(&self) -> bool {
        self.claims() || self.productions.iter().any(|p| p.exit().is_none())
    }
    /// Some rule looks into branches.
    pub fn sees_branches(&self) -> bool {
        let in_branch = |near: &Near| matches!(near.place, Place::Found { .. });
        self.rules.iter().any(|rule| rule.context.iter().any(in_branch))
    }
    /// Some module may be retired.
    pub fn may_retire(&self) -> bool {
        self.closed.is_none() && self.retires.iter().any(|&r| r)
    }
}

fn changes_with_step(e: &Expr) -> bool {
    let mut found = false;
    e.walk(&mut |e| found |= matches!(e.kind, ExprKind::Attribute("step") | ExprKind::Random { .. }));
    found
}

/// Where the rules of a step come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RulesOf {
    /// `derive … with …`: indices of the groups, by priority.
    Groups(Vec<usize>),
    /// `trace into …`, this symbol: [`crate::plan::turtle::rules`].
    Trace(usize),
}

/// The rules of one kind of step.
#[derive(Clone, Debug)]
pub struct RuleSet {
    pub of: RulesOf,
    pub stages: Vec<Stage>,
}

/// A system as tables.
#[derive(Clone, Debug)]
pub struct Tables {
    pub(in crate::plan) kind: &'static dyn WordKind,
    pub symbols: Vec<Symbol>,
    pub layout: Layout,
    /// Where the environment holds what the host gives.
    pub given: Places,
    pub rule_sets: Vec<RuleSet>,
    /// Right contexts with branches.
    pub searches: Vec<Search>,
    /// For each symbol whether contexts look past it.
    pub ignored: Vec<bool>,
    pub turtle: Turtle,
}

/// Where the words of the environment stand that are the same for all stages.
pub struct Environment {
    /// For each uniform the word where it begins.
    pub uniforms: Vec<usize>,
    /// Words of all uniforms.
    pub uniform_words: usize,
    pub given: Places,
    /// For each query the words of a value.
    pub queries: Vec<usize>,
}

impl Tables {
    /// Builds the tables of a system, or names what this version does not derive.
    pub fn new(system: &System) -> Result<Tables, Unsupported> {
        Tables::build(system, false)
    }

    /// The same for several words at once of a curve system.
    pub fn of_words(system: &System) -> Result<Tables, Unsupported> {
        Tables::build(system, true)
    }

    fn build(system: &System, words: bool) -> Result<Tables, Unsupported> {
        let kind = kind::of(system)?;
        supported::steps(&system.run, kind)?;
        let visible = system.symbols.iter().map(|s| s.fields.iter().map(|f| f.ty.words()).sum());
        let rules = rules_of(&system.run);
        let draft = kind.layout(system, &rules, visible.max().unwrap_or(0), words)?;
        let mut builder = Builder::new(system, kind, draft.header_words);
        for s in &system.symbols {
            builder.add_symbol(s.name.clone(), s.fields.clone(), false);
        }
        let mut rule_sets = Vec::new();
        for of in &rules {
            rule_sets.push(builder.rule_set(of.clone())?);
        }
        let Builder { symbols, searches, .. } = builder;
        if symbols.len() > MOST_SYMBOLS {
            let what = format!(
                "more than {MOST_SYMBOLS} symbols, those inside nested blocks and of erased cells among them"
            );
            return Err(Unsupported::new(what, system.source.kind_span));
        }
        // What nested blocks carry along takes room, too.
        let param_words = symbols.iter().map(words_of).max().unwrap_or(0);
        let layout = kind.layout(system, &rules, param_words, words)?;
        let places = environment(system);
        for stage in rule_sets.iter_mut().flat_map(|set| &mut set.stages) {
            let of = (kind, !system.ignored.is_empty());
            stage.complete(&symbols, &searches, &places, &layout, of);
        }
        let ignored = (0..symbols.len()).map(|symbol| system.ignored.contains(&symbol)).collect();
        let turtle = Turtle::new(system, &symbols);
        Ok(Tables { kind, layout, symbols, given: places.given, rule_sets, searches, ignored, turtle })
    }

    /// Lays modules out otherwise, and makes the programs anew: for tests.
    #[doc(hidden)]
    pub fn lay_out(&mut self, layout: Layout) {
        let ignoring = self.ignored.contains(&true);
        self.layout = layout;
        for stage in self.rule_sets.iter_mut().flat_map(|set| &mut set.stages) {
            stage.program = self.kind.program(stage, &layout, ignoring);
        }
    }

    /// The most words of attributes that a stage measures of a module.
    pub fn most_measured(&self) -> usize {
        self.rule_sets.iter().flat_map(|s| &s.stages).map(|s| s.row.words).max().unwrap_or(0)
    }

    /// A word as its links are walked, if it has any.
    pub fn linked<'a>(&'a self, records: &'a [u32], links: &'a Links) -> Option<Linked<'a>> {
        let Tables { layout, ignored, searches, .. } = self;
        layout.link.map(|_| Linked { records, layout: *layout, links, ignored, searches })
    }

    /// The rule set of these rules.
    pub fn rule_set(&self, of: &RulesOf) -> Option<usize> {
        self.rule_sets.iter().position(|s| s.of == *of)
    }
}

/// Where the environment of any expression of the system holds what is the same for all.
pub(in crate::plan) fn environment(system: &System) -> Environment {
    let mut at = 0;
    let starts = system.uniforms.iter().map(|u| {
        at += u.ty.words();
        at - u.ty.words()
    });
    let uniforms = starts.collect();
    let queries = system.queries.iter().map(|q| q.ty.words()).collect();
    Environment { uniforms, uniform_words: at, given: Places::new(at), queries }
}

/// Symbols that the 16 bits of a record can name; [`END`] is none.
const MOST_SYMBOLS: usize = END as usize;

fn words_of(symbol: &Symbol) -> usize {
    symbol.fields.iter().map(|f| f.ty.words()).sum()
}

/// The distinct rules that the schedule derives with.
fn rules_of(steps: &[system::Step]) -> Vec<RulesOf> {
    fn collect(steps: &[system::Step], found: &mut Vec<RulesOf>) {
        for step in steps {
            let of = match &step.kind {
                system::StepKind::Derive { groups, .. } => RulesOf::Groups(groups.clone()),
                system::StepKind::Trace { into } => RulesOf::Trace(*into),
                system::StepKind::Repeat { body, .. } | system::StepKind::If { body, .. } => {
                    collect(body, found);
                    continue;
                }
                _ => continue,
            };
            if !found.contains(&of) {
                found.push(of);
            }
        }
    }
    let mut found = Vec::new();
    collect(steps, &mut found);
    found
}

/// c, if every visible symbol is rewritten by its symbol alone into c modules, c the same for all.
fn closed_growth(stage: &Stage, symbols: &[Symbol]) -> Option<u32> {
    let mut growth = None;
    for (id, symbol) in symbols.iter().enumerate() {
        if symbol.hidden {
            continue;
        }
        let count = stage.productions[stage.unconditional(id)?].count();
        if count == 0 || growth.is_some_and(|g| g != count) {
            return None;
        }
        growth = Some(count);
    }
    growth
}

/// Whether rules draw random numbers.
pub(in crate::plan) fn draws(system: &System) -> bool {
    let rules = || system.groups.iter().flat_map(|group| &group.rules);
    rules().any(|rule| rule.alternatives.len() > 1)
        || any_in_rules(system, &|e| matches!(e.kind, ExprKind::Random { .. }))
}

/// Whether an expression of a rule is one of these.
fn any_in_rules(system: &System, is: &dyn Fn(&Expr) -> bool) -> bool {
    let mut found = false;
    for rule in system.groups.iter().flat_map(|group| &group.rules) {
        crate::plan::given::of_rule(rule, &mut |e| e.walk(&mut |e| found |= is(e)));
    }
    found
}

/// The step of the schedule before whose end some word of several could do other things than alone: derived together all
/// go on until no rule fires in any, and what was terminal may not be so in the next step.
pub(in crate::plan) fn ends_apart(system: &System) -> Option<Span> {
    fn of_steps(steps: &[system::Step]) -> Option<Span> {
        steps.iter().find_map(|step| match &step.kind {
            system::StepKind::Derive { until_terminal: true, .. } => Some(step.span),
            system::StepKind::Repeat { body, .. } | system::StepKind::If { body, .. } => of_steps(body),
            _ => None,
        })
    }
    let steps_matter = draws(system) || any_in_rules(system, &changes_with_step);
    of_steps(&system.run).filter(|_| steps_matter)
}

/// FNV-1a.
pub(in crate::plan) fn fnv(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811c_9dc5, |h, b| (h ^ *b as u32).wrapping_mul(0x0100_0193))
}
