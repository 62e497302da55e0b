//! Rules as tables: what a checked patch system becomes before a backend sees it.
//!
//! A rule set holds the rules of one `derive … with …` in order of priority. It runs in *stages*:
//! the first holds the rules as written; a nested block leaves *pending* modules with hidden
//! symbols, which the next stage splits, until none is left. So one kernel that splits a net once
//! serves blocks of any depth, and a nested block halves outermost first.

use super::layout::{HEADER_WORDS, Layout};
use super::supported::{self, Unsupported};
use crate::language::expr::{Expr, ExprKind, Type};
use crate::language::system::{self, BinderPlace, Field, Rule, System};
use crate::language::{Span, eval};

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

/// One module of a successor.
#[derive(Clone, Debug)]
pub struct Successor {
    pub symbol: usize,
    /// One for each field; binders read the predecessor's fields.
    pub args: Vec<Expr>,
}

/// One rule of a stage.
#[derive(Clone, Debug)]
pub struct Production {
    pub predecessor: usize,
    /// All must hold.
    pub guards: Vec<Expr>,
    /// Which directions are halved: bit 0 u, bit 1 v. 0 with one live cell is a relabelling.
    pub halves: u32,
    /// By 2·(half of u) + (half of v); what is `None` is erased.
    pub cells: [Option<Successor>; 4],
    pub label: String,
    pub span: Span,
}

impl Production {
    /// How many modules come of one.
    pub fn count(&self) -> u32 {
        self.cells.iter().flatten().count() as u32
    }
    /// Keeps the net and the symbol: then unchanged parameters mean that nothing fired.
    pub fn relabels_itself(&self) -> bool {
        self.halves == 0 && self.cells[0].as_ref().is_some_and(|c| c.symbol == self.predecessor)
    }
    /// Its word in the environment buffer: bits 0–1 `halves`, 4–7 the live cells, 8–10 their number.
    pub fn word(&self) -> u32 {
        let live = (0..4).filter(|&c| self.cells[c].is_some()).fold(0, |m, c| m | 1 << c);
        rule_word(self.halves, live)
    }
}

/// A word of the rule table.
pub fn rule_word(halves: u32, live: u32) -> u32 {
    halves | live << 4 | live.count_ones() << 8
}

/// The rules that run in one sweep of the passes.
#[derive(Clone, Debug)]
pub struct Stage {
    /// By priority; the index is the rule id.
    pub productions: Vec<Production>,
    /// For each symbol its productions, by priority.
    pub by_symbol: Vec<Vec<usize>>,
    /// For each symbol: a module on which no rule fires now never sees one fire in this derivation.
    pub retires: Vec<bool>,
    /// Every module that can occur has this many successors, by its symbol alone.
    pub closed: Option<u32>,
    /// Holds the rules as written, not what nested blocks left.
    pub first: bool,
}

impl Stage {
    fn new(productions: Vec<Production>, symbols: usize, first: bool) -> Stage {
        let mut by_symbol = vec![Vec::new(); symbols];
        for (id, p) in productions.iter().enumerate() {
            by_symbol[p.predecessor].push(id);
        }
        let reads_step = |id: &usize| {
            productions[*id].guards.iter().any(changes_with_step)
                || productions[*id].cells.iter().flatten().flat_map(|c| &c.args).any(changes_with_step)
        };
        let retires = by_symbol.iter().map(|ids| first && !ids.iter().any(reads_step)).collect();
        Stage { productions, by_symbol, retires, closed: None, first }
    }

    /// The rule id that says: kept as it is, still to be looked at in the next step.
    pub fn keep(&self) -> u32 {
        self.productions.len() as u32
    }
    /// The rule id that says: no rule can ever fire on it again in this derivation.
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
        if self.first { self.retired() } else { self.keep() }
    }
    /// The rule table: a word for each production, then keep and retired.
    pub fn rule_words(&self) -> Vec<u32> {
        let keep = rule_word(0, 1);
        self.productions.iter().map(Production::word).chain([keep, rule_word(0, 0)]).collect()
    }
    /// The most modules that one can become.
    pub fn max_count(&self) -> u32 {
        self.productions.iter().map(Production::count).max().unwrap_or(1).max(1)
    }
    /// The rule that fires on every module of this symbol, if the symbol alone decides.
    pub fn unconditional(&self, symbol: usize) -> Option<usize> {
        let first = *self.by_symbol[symbol].first()?;
        let p = &self.productions[first];
        (p.guards.is_empty() && !p.relabels_itself()).then_some(first)
    }
    /// Some module may be retired.
    pub fn may_retire(&self) -> bool {
        self.closed.is_none() && self.retires.iter().any(|&r| r)
    }
}

fn changes_with_step(e: &Expr) -> bool {
    let mut found = false;
    e.walk(&mut |e| found |= matches!(e.kind, ExprKind::Attribute("step")));
    found
}

/// The rules of one `derive … with …`.
#[derive(Clone, Debug)]
pub struct RuleSet {
    /// Indices of the groups, by priority.
    pub groups: Vec<usize>,
    pub stages: Vec<Stage>,
}

/// A system as tables.
#[derive(Clone, Debug)]
pub struct Tables {
    pub symbols: Vec<Symbol>,
    pub layout: Layout,
    pub rule_sets: Vec<RuleSet>,
}

impl Tables {
    /// Builds the tables of a patch system, or names what this version does not derive.
    pub fn new(system: &System) -> Result<Tables, Unsupported> {
        let degree = supported::degree(system)?;
        let mut builder = Builder { system, symbols: Vec::new(), pending: Vec::new() };
        for s in &system.symbols {
            builder.add_symbol(s.name.clone(), s.fields.clone(), false);
        }
        let mut rule_sets = Vec::new();
        for groups in derived_groups(&system.run) {
            rule_sets.push(builder.rule_set(groups)?);
        }
        let symbols = builder.symbols;
        if symbols.len() > MOST_SYMBOLS {
            let what = format!("more than {MOST_SYMBOLS} symbols, those inside nested blocks among them");
            return Err(Unsupported::new(what, system.source.kind_span));
        }
        let param_words = symbols.iter().map(words_of).max().unwrap_or(0);
        for set in &mut rule_sets {
            for stage in &mut set.stages {
                // Symbols of later rule sets did not exist when this stage was built.
                stage.by_symbol.resize(symbols.len(), Vec::new());
                stage.retires.resize(symbols.len(), stage.first);
                stage.closed = closed_growth(stage, &symbols);
            }
        }
        Ok(Tables { layout: Layout::new(param_words, degree), symbols, rule_sets })
    }

    /// The rule set of these groups.
    pub fn rule_set(&self, groups: &[usize]) -> Option<usize> {
        self.rule_sets.iter().position(|s| s.groups == groups)
    }
}

/// Symbols that the 16 bits of a record can name.
const MOST_SYMBOLS: usize = 1 << 16;

fn words_of(symbol: &Symbol) -> usize {
    symbol.fields.iter().map(|f| f.ty.words()).sum()
}

/// The distinct lists of groups that the schedule derives with.
fn derived_groups(steps: &[system::Step]) -> Vec<Vec<usize>> {
    fn collect(steps: &[system::Step], found: &mut Vec<Vec<usize>>) {
        for step in steps {
            match &step.kind {
                system::StepKind::Derive { groups, .. } if !found.contains(groups) => {
                    found.push(groups.clone())
                }
                system::StepKind::Repeat { body, .. } | system::StepKind::If { body, .. } => {
                    collect(body, found)
                }
                _ => {}
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

/// A block that waits for the next stage, under its hidden symbol.
struct Pending {
    symbol: usize,
    block: system::Block,
    label: String,
}

struct Builder<'a> {
    system: &'a System,
    symbols: Vec<Symbol>,
    pending: Vec<Pending>,
}

impl Builder<'_> {
    fn add_symbol(&mut self, name: String, fields: Vec<Field>, hidden: bool) -> usize {
        let mut at = HEADER_WORDS;
        let words = fields
            .iter()
            .map(|f| {
                at += f.ty.words();
                at - f.ty.words()
            })
            .collect();
        self.symbols.push(Symbol { name, fields, words, hidden });
        self.symbols.len() - 1
    }

    fn rule_set(&mut self, groups: Vec<usize>) -> Result<RuleSet, Unsupported> {
        let mut productions = Vec::new();
        for &g in &groups {
            for rule in &self.system.groups[g].rules {
                supported::rule(self.system, rule)?;
                let production = self.production(rule)?;
                productions.push(production);
            }
        }
        let mut stages = vec![Stage::new(productions, self.symbols.len(), true)];
        while !self.pending.is_empty() {
            let waiting = std::mem::take(&mut self.pending);
            let productions = waiting.into_iter().map(|p| self.split_pending(p)).collect();
            stages.push(Stage::new(productions, self.symbols.len(), false));
        }
        Ok(RuleSet { groups, stages })
    }

    fn production(&mut self, rule: &Rule) -> Result<Production, Unsupported> {
        let predecessor = rule.strict[0];
        let label = match &rule.label {
            Some(label) => label.clone(),
            None => format!("rule {} of {}", rule.index + 1, self.system.symbols[predecessor].name),
        };
        let resolve = |e: &Expr| by_field(e, rule);
        let (halves, cells) = match &rule.alternatives[0].successor {
            system::Successor::Erase => (0, Default::default()),
            system::Successor::Relabel(m) => (0, [Some(successor(m, &resolve)), None, None, None]),
            system::Successor::Split(b) => self.block(predecessor, b, &resolve, &label),
            system::Successor::Modules(_) => {
                return Err(Unsupported::new("a successor of several modules without a block", rule.span));
            }
        };
        let guards = rule.tests.iter().chain(&rule.condition).map(resolve).collect();
        Ok(Production { predecessor, guards, halves, cells, label, span: rule.span })
    }

    /// The cells of a block; a block inside it becomes a pending module with the predecessor's
    /// parameters, since its expressions read these.
    fn block(
        &mut self,
        predecessor: usize,
        block: &system::Block,
        resolve: &dyn Fn(&Expr) -> Expr,
        label: &str,
    ) -> (u32, [Option<Successor>; 4]) {
        let halves = (block.rows == 2) as u32 | ((block.columns == 2) as u32) << 1;
        let mut cells: [Option<Successor>; 4] = Default::default();
        for (n, cell) in block.cells.iter().enumerate() {
            let (row, column) = (n / block.columns, n % block.columns);
            cells[2 * row + column] = match cell {
                system::Cell::Eps => None,
                system::Cell::Module(m) => Some(successor(m, resolve)),
                system::Cell::Block(inner) => {
                    let mut inner = map_block(inner, resolve);
                    let name = format!("{}'{}", self.symbols[predecessor].name, self.symbols.len());
                    let mut fields = self.symbols[predecessor].fields.clone();
                    let mut args: Vec<Expr> =
                        (0..fields.len()).map(|f| field(f, &fields[f].ty, inner.span)).collect();
                    // `level` is the predecessor's, not that of the pending module.
                    if let Some(level) = find_level(&inner) {
                        let carried = field(fields.len(), &level.ty, level.span);
                        fields.push(Field { name: "level".to_string(), ty: level.ty.clone() });
                        args.push(level);
                        inner =
                            map_block(&inner, &|e| map_expr(e, &|e| is_level(e).then(|| carried.clone())));
                    }
                    let symbol = self.add_symbol(name, fields, true);
                    self.pending.push(Pending { symbol, block: inner, label: label.to_string() });
                    Some(Successor { symbol, args })
                }
            };
        }
        (halves, cells)
    }

    fn split_pending(&mut self, pending: Pending) -> Production {
        let Pending { symbol, block, label } = pending;
        let span = block.span;
        let (halves, cells) = self.block(symbol, &block, &|e| e.clone(), &label);
        Production { predecessor: symbol, guards: Vec::new(), halves, cells, label, span }
    }
}

fn successor(module: &system::Module, resolve: &dyn Fn(&Expr) -> Expr) -> Successor {
    Successor { symbol: module.symbol, args: module.args.iter().map(resolve).collect() }
}

/// In the tables, binder n is field n of the predecessor.
fn field(n: usize, ty: &Type, span: Span) -> Expr {
    Expr { ty: ty.clone(), kind: ExprKind::Binder(n), span }
}

fn by_field(e: &Expr, rule: &Rule) -> Expr {
    map_expr(e, &|e| match e.kind {
        ExprKind::Binder(b) => match rule.binders[b].place {
            BinderPlace::Strict { field: f, .. } => Some(field(f, &e.ty, e.span)),
            // `supported::rule` has refused contexts, queries and tags.
            _ => None,
        },
        _ => None,
    })
}

/// Rebuilds an expression, `replace` first.
fn map_expr(e: &Expr, replace: &dyn Fn(&Expr) -> Option<Expr>) -> Expr {
    if let Some(new) = replace(e) {
        return new;
    }
    let ExprKind::Call(op, args) = &e.kind else { return e.clone() };
    let args: Vec<Expr> = args.iter().map(|a| map_expr(a, replace)).collect();
    // WGSL refuses constant expressions that overflow; at run time they wrap. So none are left.
    let literals = args.iter().map(|a| match &a.kind {
        ExprKind::Literal(value) => Some(value.clone()),
        _ => None,
    });
    let literals: Option<Vec<_>> = literals.collect();
    let kind = match literals.and_then(|values| eval::apply(*op, &values)) {
        Some(value) => ExprKind::Literal(value),
        None => ExprKind::Call(*op, args),
    };
    Expr { ty: e.ty.clone(), kind, span: e.span }
}

fn is_level(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Attribute("level"))
}

/// The attribute `level`, if an expression of the block reads it.
fn find_level(block: &system::Block) -> Option<Expr> {
    block.cells.iter().find_map(|cell| match cell {
        system::Cell::Eps => None,
        system::Cell::Block(inner) => find_level(inner),
        system::Cell::Module(m) => {
            let mut found = None;
            m.args
                .iter()
                .for_each(|a| a.walk(&mut |e| found = found.take().or(is_level(e).then(|| e.clone()))));
            found
        }
    })
}

fn map_block(block: &system::Block, resolve: &dyn Fn(&Expr) -> Expr) -> system::Block {
    let cells = block
        .cells
        .iter()
        .map(|c| match c {
            system::Cell::Eps => system::Cell::Eps,
            system::Cell::Module(m) => system::Cell::Module(system::Module {
                args: m.args.iter().map(resolve).collect(),
                ..m.clone()
            }),
            system::Cell::Block(b) => system::Cell::Block(map_block(b, resolve)),
        })
        .collect();
    system::Block { cells, ..*block }
}
