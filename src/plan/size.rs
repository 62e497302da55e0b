//! Growth bounds: how many modules a derivation has after each step, before anything runs.
//!
//! For every symbol a rule set offers *outcomes*: the productions that may fire on it, and keeping
//! it where none has to. With h steps to go, a module of symbol s becomes at least
//! min over outcomes Σ L(child, h−1) modules and at most the maximum of the same; the bounds of a
//! word are the sums over its axiom. Where every symbol has one outcome both are exact.
//!
//! The lower bound holds of `derive until terminal` as of so many steps: one that ends early could as
//! well go on keeping every module, and that is one of the ways of which it is the least.

use super::certain::{Certain, Fires};
use super::context::Place;
use super::schedule::{Act, Rewrite};
use super::tables::{MatchRule, RuleSet, Tables};
use crate::language::Span;
use crate::language::expr::Value;

/// Bounds of the number of modules after some step; saturating at `u64::MAX`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    pub least: u64,
    pub most: u64,
}

impl Bounds {
    /// The count is known before anything runs.
    pub fn exact(&self) -> bool {
        self.least == self.most
    }
}

/// After how many steps of a schedule bounds are still worked out; the work is quadratic in it.
pub const HORIZON: usize = 512;

/// Bounds after each of the first `steps` steps, and of the axiom before them (index 0).
///
/// `axiom[s]` is the number of modules of symbol s; `steps` are indices of rule sets. Where the uniforms are
/// not known, none are given.
pub fn growth(tables: &Tables, uniforms: &[Value], axiom: &[u64], steps: &[usize]) -> Vec<Bounds> {
    let outcomes = Outcomes::of_all(tables, uniforms);
    let total = |least: &[u64], most: &[u64]| Bounds {
        least: weighted_sum(axiom, least),
        most: weighted_sum(axiom, most),
    };
    let ones = vec![1u64; tables.symbols.len()];
    let mut bounds = vec![total(&ones, &ones)];
    let steps = &steps[..steps.len().min(HORIZON)];
    for end in 1..=steps.len() {
        let (mut least, mut most) = (ones.clone(), ones.clone());
        for &set in steps[..end].iter().rev() {
            least = outcomes[set].back(&least, u64::min);
            most = outcomes[set].back(&most, u64::max);
        }
        bounds.push(total(&least, &most));
        // A derivation that is sure not to fit is refused at this step; what follows is of no use.
        if bounds[end].least == u64::MAX {
            break;
        }
    }
    bounds
}

/// A word that is sure to be too large.
#[derive(Clone, Debug)]
pub struct Excess {
    /// After this step, of the run or, if that is endless, of the derive; an `until terminal` before it may end earlier.
    pub step: u64,
    pub modules: u64,
    /// Where a `derive until terminal` makes it so large, why that never ends.
    pub endless: Option<Endless>,
}

/// A symbol that is rewritten in every step, and comes of itself again.
#[derive(Clone, Debug)]
pub struct Endless {
    pub symbol: usize,
    pub rule: Span,
    pub derive: Rewrite,
}

/// A rule that fires in every step of a derive, whatever the params are, if the word before it holds one of these symbols;
/// it need not grow.
pub fn without_end(tables: &Tables, rule_set: usize, axiom: &[usize]) -> Option<Span> {
    let outcomes = Outcomes::new(tables, &tables.rule_sets[rule_set], &[]);
    // Symbols of which in each step one is left that fires in the next; those that may not be so fall out.
    let mut lasting = vec![true; tables.symbols.len()];
    loop {
        let lasts = |outcome: &Outcome| outcome.fires && outcome.children.iter().any(|&child| lasting[child]);
        let rest: Vec<bool> =
            outcomes.of.iter().zip(&lasting).map(|(list, &was)| was && list.iter().all(lasts)).collect();
        if rest == lasting {
            break;
        }
        lasting = rest;
    }
    let mut symbol = axiom.iter().copied().find(|&symbol| lasting[symbol])?;
    // From one to the next, until one comes again.
    let mut met = vec![false; lasting.len()];
    while !std::mem::replace(&mut met[symbol], true) {
        let first = outcomes.of[symbol].first()?;
        symbol = first.children.iter().copied().find(|&child| lasting[child])?;
    }
    outcomes.of[symbol].first()?.rule
}

/// How many outcomes and children are looked at before nothing is said to be sure.
const MOST_WORK: u64 = 1 << 25;

/// The first step of a schedule after which the word is sure to have more modules than `limit`.
pub fn excess(
    tables: &Tables,
    uniforms: &[Value],
    axiom: &[u64],
    schedule: &[Act],
    most_steps: u64,
    limit: u64,
) -> Option<Excess> {
    by_symbols(tables, uniforms, axiom, schedule, most_steps, limit)
        .or_else(|| of_one_symbol(tables, uniforms, axiom, schedule, most_steps, limit))
}

/// Where the word never holds more than one symbol, rules that look around fire nearly everywhere.
fn of_one_symbol(
    tables: &Tables,
    uniforms: &[Value],
    axiom: &[u64],
    schedule: &[Act],
    most_steps: u64,
    limit: u64,
) -> Option<Excess> {
    let mut present = (0..axiom.len()).filter(|&symbol| axiom[symbol] > 0);
    let (Some(symbol), None) = (present.next(), present.next()) else { return None };
    let (mut modules, mut step, mut work) = (axiom[symbol], 0, 0);
    for derive in schedule.iter().map(Act::rewrite) {
        let alone = Alone::new(symbol, tables, &tables.rule_sets[derive.rule_set], uniforms)?;
        let end = (step + u64::from(derive.count)).min(most_steps);
        let start = step;
        while step < end {
            let after = alone.after(modules);
            // Where nothing is sure to fire, it may end.
            if after == modules {
                step = end;
                break;
            }
            (modules, step, work) = (after, step + 1, work + 1);
            if modules > limit {
                let endless = Endless { symbol, rule: alone.rule, derive: *derive };
                let endless = derive.until_terminal.then_some(endless);
                let step = if endless.is_some() { step - start } else { step };
                return Some(Excess { step, modules, endless });
            }
            if work > MOST_WORK {
                return None;
            }
        }
    }
    None
}

/// The rule that a word of one symbol alone is sure to be rewritten by.
struct Alone {
    rule: Span,
    /// Modules that it replaces, and the least that come of them, which are no fewer.
    length: u64,
    children: u64,
    /// Modules at the ends of the word that it may not fire on, as what it looks for may be missing there.
    ends: u64,
    /// What is sure to come of one that it does not fire on, 1 at most.
    left: u64,
}

impl Alone {
    fn new(symbol: usize, tables: &Tables, set: &RuleSet, uniforms: &[Value]) -> Option<Alone> {
        let layout = &tables.layout;
        // Where words have branches, or are several, what comes next in the word is not always what stands beside it.
        if layout.halo() == 0 {
            return None;
        }
        let stage = set.stages.first()?;
        let mut found: Option<Alone> = None;
        for &id in &stage.by_symbol[symbol] {
            let rule = &stage.rules[id];
            let certain = Certain::new(rule, uniforms);
            if certain.fires(&[]) == Fires::Never {
                continue;
            }
            let mut children = u64::MAX;
            for (n, production) in stage.productions[rule.productions.clone()].iter().enumerate() {
                if production.successors().any(|(_, cell)| cell.symbol != symbol || cell.hang.lateral) {
                    return None;
                }
                if !certain.is_never_drawn(n) {
                    children = children.min(u64::from(production.count()));
                }
            }
            match &mut found {
                Some(alone) => alone.left = alone.left.min(children),
                None => {
                    let length = 1 + rule.others.len() as u64;
                    let same = rule.others.iter().all(|&other| other == symbol);
                    let ends = ends(rule, symbol)?;
                    if !same || !certain.holds_in_place() || children < length {
                        return None;
                    }
                    found = Some(Alone { rule: rule.span, length, children, ends, left: 1 });
                }
            }
        }
        found
    }

    /// The least that comes of so many modules, and of more.
    fn after(&self, modules: u64) -> u64 {
        let fires = modules.saturating_sub(self.ends) / self.length;
        let left = (modules - fires * self.length) * self.left;
        fires.saturating_mul(self.children).saturating_add(left)
    }
}

/// How many modules of a word of one symbol the contexts of a rule may leave out; none where they look for another.
fn ends(rule: &MatchRule, symbol: usize) -> Option<u64> {
    let (mut before, mut behind) = (0, 0);
    for near in &rule.context {
        if near.symbol as usize != symbol {
            return None;
        }
        match near.place {
            Place::Strict(_) => {}
            Place::Before(steps) => before = before.max(steps),
            Place::Behind { steps, .. } => behind = behind.max(steps),
            Place::Previous | Place::Found { .. } => return None,
        }
    }
    Some(u64::from(before) + u64::from(behind))
}

/// The same, where each module is looked at by itself.
fn by_symbols(
    tables: &Tables,
    uniforms: &[Value],
    axiom: &[u64],
    schedule: &[Act],
    most_steps: u64,
    limit: u64,
) -> Option<Excess> {
    let ones = vec![1u64; tables.symbols.len()];
    let modules = weighted_sum(axiom, &ones);
    if modules > limit {
        return Some(Excess { step: 0, modules, endless: None });
    }
    let outcomes = Outcomes::of_all(tables, uniforms);
    let (mut step, mut work, mut counted) = (0, 0, 0);
    for (at, derive) in schedule.iter().map(Act::rewrite).enumerate() {
        let mut least = ones.clone();
        let (start_of_derive, end) = (counted, (step + u64::from(derive.count)).min(most_steps));
        while step < end {
            step += 1;
            counted += 1;
            let before = outcomes[derive.rule_set].back(&least, u64::min);
            let settled = before == least;
            least = before;
            work += outcomes[derive.rule_set].work;
            let mut start = least.clone();
            for earlier in schedule[..at].iter().rev().map(Act::rewrite) {
                work += outcomes[earlier.rule_set].back_all(&mut start, earlier.count);
            }
            let modules = weighted_sum(axiom, &start);
            if modules > limit {
                let endless = derive.until_terminal.then(|| {
                    let symbol = grown(&outcomes, axiom, &schedule[..at], &least)?;
                    outcomes[derive.rule_set].endless(symbol, &least, *derive)
                });
                let endless = endless.flatten();
                let step = if endless.is_some() { counted - start_of_derive } else { counted };
                return Some(Excess { step, modules, endless });
            }
            if work > MOST_WORK {
                return None;
            }
            if settled {
                // Of `until terminal` nobody knows how many more steps there are.
                counted += if derive.until_terminal { 0 } else { end - step };
                step = end;
            }
        }
    }
    None
}

fn weighted_sum(counts: &[u64], values: &[u64]) -> u64 {
    counts.iter().zip(values).fold(0, |sum: u64, (c, v)| sum.saturating_add(c.saturating_mul(*v)))
}

/// What the module of the axiom that becomes most has become, among others, after some derives: always the child that
/// becomes most. `values` are the bounds behind them. None where the way there is too long to tell.
fn grown(outcomes: &[Outcomes], axiom: &[u64], schedule: &[Act], values: &[u64]) -> Option<usize> {
    // For each derive the bounds behind it, then those before each of its steps, the last first, until they settle.
    let mut all: Vec<Vec<Vec<u64>>> = Vec::with_capacity(schedule.len());
    let mut values = values.to_vec();
    for derive in schedule.iter().rev().map(Act::rewrite) {
        let mut list = vec![values];
        while list.len() <= derive.count as usize {
            let before = outcomes[derive.rule_set].back(&list[list.len() - 1], u64::min);
            if before == list[list.len() - 1] {
                break;
            }
            list.push(before);
            if list.len() > HORIZON {
                return None;
            }
        }
        values = list[list.len() - 1].clone();
        all.push(list);
    }
    let mut symbol = most(&values, (0..axiom.len()).filter(|&symbol| axiom[symbol] > 0))?;
    for (derive, list) in schedule.iter().map(Act::rewrite).zip(all.iter().rev()) {
        let settled = list.len() - 1;
        // Where they have settled, as many steps as there are symbols lead wherever more would.
        let steps = (derive.count as usize).min(settled + axiom.len());
        for left in (0..steps).rev() {
            let values = &list[left.min(settled)];
            symbol = most(values, outcomes[derive.rule_set].least(symbol, values)?.children.iter().copied())?;
        }
    }
    Some(symbol)
}

/// The symbol that becomes most.
fn most(values: &[u64], symbols: impl Iterator<Item = usize>) -> Option<usize> {
    symbols.max_by_key(|&symbol| values[symbol])
}

/// What may come of a module.
struct Outcome {
    /// Hidden symbols resolved.
    children: Vec<usize>,
    /// None where the module is kept, or claimed.
    rule: Option<Span>,
    /// It counts as fired: a module that becomes itself may be unchanged.
    fires: bool,
}

/// For every symbol what may come of it.
struct Outcomes {
    of: Vec<Vec<Outcome>>,
    /// Of one step.
    work: u64,
}

impl Outcomes {
    fn of_all(tables: &Tables, uniforms: &[Value]) -> Vec<Outcomes> {
        tables.rule_sets.iter().map(|set| Outcomes::new(tables, set, uniforms)).collect()
    }

    fn new(tables: &Tables, set: &RuleSet, uniforms: &[Value]) -> Outcomes {
        let of: Vec<Vec<Outcome>> =
            (0..tables.symbols.len()).map(|symbol| outcomes_of(symbol, set, uniforms)).collect();
        let work = of.iter().flatten().map(|outcome| 1 + outcome.children.len() as u64).sum();
        Outcomes { of, work }
    }

    /// The bounds one step earlier.
    fn back(&self, values: &[u64], choose: fn(u64, u64) -> u64) -> Vec<u64> {
        let sum = |outcome: &Outcome| outcome.sum(values);
        let outcomes = self.of.iter().enumerate();
        outcomes.map(|(s, list)| list.iter().map(sum).reduce(choose).unwrap_or(values[s])).collect()
    }

    /// The lower bounds so many steps earlier; what that took.
    fn back_all(&self, values: &mut Vec<u64>, steps: u32) -> u64 {
        for step in 0..steps {
            let before = self.back(values, u64::min);
            if before == *values {
                return u64::from(step + 1) * self.work;
            }
            *values = before;
        }
        u64::from(steps) * self.work
    }

    /// The outcome that becomes least.
    fn least(&self, symbol: usize, values: &[u64]) -> Option<&Outcome> {
        self.of[symbol].iter().min_by_key(|outcome| outcome.sum(values))
    }

    /// The symbol behind the growth: from one always to the child that becomes most, until one comes again.
    fn endless(&self, mut symbol: usize, values: &[u64], derive: Rewrite) -> Option<Endless> {
        let mut path: Vec<(usize, &Outcome)> = Vec::new();
        let circle = loop {
            if let Some(start) = path.iter().position(|(earlier, _)| *earlier == symbol) {
                break &path[start..];
            }
            let least = self.least(symbol, values)?;
            path.push((symbol, least));
            symbol = most(values, least.children.iter().copied())?;
        };
        let (symbol, outcome) = circle.iter().find(|(_, outcome)| outcome.children.len() > 1)?;
        Some(Endless { symbol: *symbol, rule: outcome.rule?, derive })
    }
}

impl Outcome {
    fn sum(&self, values: &[u64]) -> u64 {
        self.children.iter().fold(0u64, |n, &child| n.saturating_add(values[child]))
    }
}

fn outcomes_of(symbol: usize, set: &RuleSet, uniforms: &[Value]) -> Vec<Outcome> {
    let kept = || Outcome { children: vec![symbol], rule: None, fires: false };
    let Some(first) = set.stages.first() else { return vec![kept()] };
    let mut list = Vec::new();
    // Claimed by a rule that begins before it.
    let claims = |rule: &MatchRule| rule.others.contains(&symbol);
    list.extend(first.rules.iter().any(claims).then(|| Outcome {
        children: Vec::new(),
        rule: None,
        fires: false,
    }));
    let mut earlier = Vec::new();
    for &id in &first.by_symbol[symbol] {
        let rule = &first.rules[id];
        let certain = Certain::new(rule, uniforms);
        let fires = certain.fires(&earlier);
        if fires == Fires::Never {
            continue;
        }
        for (n, production) in first.productions[rule.productions.clone()].iter().enumerate() {
            if certain.is_never_drawn(n) {
                continue;
            }
            let mut children = Vec::new();
            for (_, cell) in production.successors() {
                resolve(set, cell.symbol, &mut children);
            }
            list.push(Outcome { children, rule: Some(rule.span), fires: !production.relabels_itself() });
        }
        // Nothing behind it is ever tried; one that may leave the module unchanged has the same count either way.
        if fires == Fires::Always {
            return list;
        }
        earlier.push(certain);
    }
    list.push(kept());
    list
}

/// The visible symbols that come of `symbol` within the step.
fn resolve(set: &RuleSet, symbol: usize, children: &mut Vec<usize>) {
    let hidden =
        set.stages[1..].iter().find_map(|stage| Some(&stage.productions[stage.first_production(symbol)?]));
    match hidden {
        None => children.push(symbol),
        Some(p) => p.successors().for_each(|(_, c)| resolve(set, c.symbol, children)),
    }
}
