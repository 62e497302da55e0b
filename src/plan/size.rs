//! Growth bounds: how many modules a derivation has after each step, before anything runs.
//!
//! For every symbol a rule set offers *outcomes*: the productions that may fire on it, and keeping
//! it where none has to. With h steps to go, a module of symbol s becomes at least
//! min over outcomes Σ L(child, h−1) modules and at most the maximum of the same; the bounds of a
//! word are the sums over its axiom. Where every symbol has one outcome both are exact.

use super::tables::{RuleSet, Tables};

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
/// `axiom[s]` is the number of modules of symbol s; `steps` are indices of rule sets.
pub fn growth(tables: &Tables, axiom: &[u64], steps: &[usize]) -> Vec<Bounds> {
    let outcomes: Vec<Outcomes> = tables.rule_sets.iter().map(|s| Outcomes::new(tables, s)).collect();
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

fn weighted_sum(counts: &[u64], values: &[u64]) -> u64 {
    counts.iter().zip(values).fold(0, |sum: u64, (c, v)| sum.saturating_add(c.saturating_mul(*v)))
}

/// For every symbol the lists of children that may come of it, hidden symbols resolved.
struct Outcomes(Vec<Vec<Vec<usize>>>);

impl Outcomes {
    fn new(tables: &Tables, set: &RuleSet) -> Outcomes {
        let Some(first) = set.stages.first() else {
            return Outcomes((0..tables.symbols.len()).map(|s| vec![vec![s]]).collect());
        };
        let of_symbol = |symbol: usize| {
            let mut list = Vec::new();
            // Claimed by a rule that begins before it.
            list.extend(first.rules.iter().any(|rule| rule.others.contains(&symbol)).then(Vec::new));
            for &id in &first.by_symbol[symbol] {
                let rule = &first.rules[id];
                for p in &first.productions[rule.productions.clone()] {
                    let mut children = Vec::new();
                    for cell in p.cells.iter().flatten() {
                        resolve(set, cell.symbol, &mut children);
                    }
                    list.push(children);
                }
                // Nothing behind it is ever tried; one that may leave the module unchanged has the
                // same count either way. Weights may all be 0, and then it does not match.
                if rule.context.is_empty()
                    && rule.others.is_empty()
                    && rule.guards.is_empty()
                    && rule.weights.is_empty()
                {
                    return list;
                }
            }
            list.push(vec![symbol]);
            list
        };
        Outcomes((0..tables.symbols.len()).map(of_symbol).collect())
    }

    /// The bounds one step earlier.
    fn back(&self, values: &[u64], choose: fn(u64, u64) -> u64) -> Vec<u64> {
        let sum = |children: &Vec<usize>| children.iter().fold(0u64, |n, &c| n.saturating_add(values[c]));
        self.0
            .iter()
            .enumerate()
            .map(|(s, outcomes)| outcomes.iter().map(sum).reduce(choose).unwrap_or(values[s]))
            .collect()
    }
}

/// The visible symbols that come of `symbol` within the step.
fn resolve(set: &RuleSet, symbol: usize, children: &mut Vec<usize>) {
    let hidden = set.stages[1..].iter().find_map(|stage| {
        Some(&stage.productions[stage.rules[*stage.by_symbol[symbol].first()?].productions.start])
    });
    match hidden {
        None => children.push(symbol),
        Some(p) => p.cells.iter().flatten().for_each(|c| resolve(set, c.symbol, children)),
    }
}
