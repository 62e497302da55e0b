//! What is measured: systems, and the nets they start from.

use super::{Failure, words};
use burgeon::language::System;
use burgeon::language::check::compile;
use burgeon::language::vocabulary::Vocabulary;
use burgeon::patch::{self, Axiom, Net, Root};
use burgeon::plan::{Plan, Unsupported};
use std::path::Path;

/// The systems that are measured.
pub(super) struct Plans {
    /// P -> [ P P ; P P ]
    pub(super) plain: Plan,
    /// The same with a parameter and a condition: all passes run.
    pub(super) conditional: Plan,
    pub(super) levels: Plan,
    /// `plain` for other nets and with a query, each with what they are.
    pub(super) others: Vec<(String, Plan)>,
    /// Only modules with a positive parameter stay on the frontier.
    pub(super) frontier: Plan,
    /// Curves.
    pub(super) chaikin: Plan,
    /// Of which tables of stencils are made.
    pub(super) smoothed: Plan,
    pub(super) symbols: Plan,
    /// `chaikin` with a param, for many words at once and for one.
    pub(super) words: Plan,
    pub(super) word: Plan,
}

pub(super) const PLAIN: &str = "system plain : patch bezier 3\nmodule P\naxiom: P = file \"roots.bpt\"\nrules:\n  \
                     P -> [ P P ; P P ]\nrun:\n  derive 1\n";
pub(super) const CONDITIONAL: &str = "system conditional : patch bezier 3\nmodule P(l: int)\naxiom: P(0) = file \"roots.bpt\"\n\
     rules:\n  P(l) : l < 9 -> [ P(l+1) P(l+1) ; P(l+1) P(l+1) ]\nrun:\n  derive 1\n";

/// Flatness decides: the nets are read once more.
pub(super) const QUERY: &str = "system flat : patch bezier 3\nmodule P(l: int)\nquery F(f: float) = flatness\naxiom: P(0) = file \"roots.bpt\"\n\
     rules:\n  ?F(f) P(l) : f > 0.0001 && l < 9 -> [ P(l+1) P(l+1) ; P(l+1) P(l+1) ]\nrun:\n  derive 1\n";
/// A module relabels itself until its parameter is 0, and its net is copied at each step.
pub(super) const FRONTIER: &str = "system frontier : patch bezier 3\nmodule P(l: int)\naxiom: P(0) = file \"roots.bpt\"\n\
     rules:\n  P(l) : l > 0 -> P(l-1)\nrun:\n  derive 20\n";

/// Nets of other degrees, and those with weights: these move the same bytes.
pub(super) const OTHERS: [&str; 6] =
    ["bezier 3 rational", "bezier 1", "bezier 2", "bezier 4", "bezier 8", "bezier 3 1"];

impl Plans {
    pub(super) fn new() -> Result<Plans, Failure> {
        let levels = PLAIN.replace("derive 1", "derive 16");
        let nets = OTHERS.map(|nets| (format!("closed form, `{nets}`"), PLAIN.replace("bezier 3", nets)));
        let query = ("flatness query: all passes".to_string(), QUERY.to_string());
        let others = nets.into_iter().chain([query]).map(|(what, text)| Ok((what, plan(&text)?)));
        Ok(Plans {
            plain: plan(PLAIN)?,
            conditional: plan(CONDITIONAL)?,
            levels: plan(&levels)?,
            others: others.collect::<Result<_, Failure>>()?,
            frontier: plan(FRONTIER)?,
            chaikin: plan(words::CHAIKIN)?,
            smoothed: plan(super::curves::CHAIKIN)?,
            symbols: plan(words::SYMBOLS)?,
            words: of(words::CORNERS, Plan::of_words)?,
            word: plan(words::CORNERS)?,
        })
    }
}

pub(super) fn plan(text: &str) -> Result<Plan, Failure> {
    of(text, Plan::new)
}

fn of(text: &str, plan: fn(&System) -> Result<Plan, Unsupported>) -> Result<Plan, Failure> {
    let checked = compile(text, &Vocabulary::default());
    let system = checked.systems.first();
    let system = system.ok_or_else(|| Failure::File("a bench's own system does not check".to_string()))?;
    plan(system).map_err(|e| Failure::File(format!("error: {e}")))
}

/// 32 patches of a file, or as many made ones.
pub(super) fn roots(input: Option<&Path>) -> Result<Vec<Net>, Failure> {
    let Some(path) = input else { return Ok(made(32, [3, 3], false)) };
    let read = burgeon::io::read_nets(path, Default::default());
    read.map(|read| read.value).map_err(|e| Failure::File(format!("error: {e}")))
}

/// Hilly nets.
pub(super) fn made(count: usize, degree: [u8; 2], rational: bool) -> Vec<Net> {
    let columns = degree[1] as usize + 1;
    let point = |net: usize, k: usize| {
        let (i, j) = ((k / columns) as f32, (k % columns) as f32);
        let height = ((net * 31 + k * 17) % 11) as f32 / 8.0;
        [i, height, j, if rational { 1.0 + height / 4.0 } else { 1.0 }]
    };
    let net = |n| Net { degree, points: (0..patch::net_points(degree)).map(|k| point(n, k)).collect() };
    (0..count).map(net).collect()
}

pub(super) fn axiom(plan: &Plan, nets: &[Net]) -> Axiom {
    let args = match &plan.system.axiom {
        burgeon::language::system::Axiom::Patches(starts) => starts[0].args.clone(),
        _ => Vec::new(),
    };
    Axiom { roots: nets.iter().map(|net| Root { symbol: 0, args: args.clone(), net: net.clone() }).collect() }
}

pub(super) const PLAIN_CASE: &str = "closed form: emit only";
pub(super) const CONDITIONAL_CASE: &str = "parameter and condition: all passes";

impl Plans {
    /// The systems of `patch/step`, with what they are.
    pub(super) fn steps(&self) -> impl Iterator<Item = (&Plan, &str)> {
        let bicubic = [(&self.plain, PLAIN_CASE), (&self.conditional, CONDITIONAL_CASE)];
        bicubic.into_iter().chain(self.others.iter().map(|(what, plan)| (plan, what.as_str())))
    }
}
