//! The oracle of curve systems: words as strings with their brackets, rules tried one after the other.
//!
//! An engine keeps links where this keeps brackets; [`Word::links`] says what links a string means,
//! and contexts are read along them.

mod compare;
mod context;
mod derive;
pub mod papers;
mod step;
mod tests;
mod turtle;
mod word;

pub use compare::{Seen, SeenModule, Tolerance, assert_same, compare, see};
pub use derive::Oracle;
pub use word::{Link, Module, Token, Topology, Word};

use super::word::Param;
use burgeon::language::syntax::Rule;

/// A derivation and all that it needs.
#[derive(Clone, Debug, Default)]
pub struct Job {
    pub text: String,
    /// The system to derive; else the last one.
    pub system: Option<String>,
    /// What all files of the text hold.
    pub points: Vec<Vec<f64>>,
    /// Params that the host sets before the run.
    pub set: Vec<(String, Param)>,
    /// As of `--seed`; else the param `seed`, else 0.
    pub seed: Option<u32>,
    /// The limit of steps, as of `--steps`.
    pub steps: Option<usize>,
}

impl Job {
    pub fn new(text: impl Into<String>) -> Job {
        Job { text: text.into(), ..Job::default() }
    }

    pub fn system(mut self, name: &str) -> Job {
        self.system = Some(name.to_string());
        self
    }

    pub fn points(mut self, points: &[Vec<f64>]) -> Job {
        self.points = points.to_vec();
        self
    }

    pub fn set(mut self, name: &str, value: Param) -> Job {
        self.set.push((name.to_string(), value));
        self
    }

    /// The words of the system: the axiom and the word after every step.
    #[track_caller]
    pub fn derive(&self) -> Vec<Word> {
        self.derive_within(usize::MAX).expect("no bounds")
    }

    /// As [`derive`](Self::derive); `None` if a word has more modules.
    #[track_caller]
    pub fn derive_within(&self, modules: usize) -> Option<Vec<Word>> {
        self.with(|oracle| oracle.bound(modules).derive_within())
    }

    /// The rules that fire at all.
    pub fn fired(&self) -> Vec<Rule> {
        self.with(|oracle| oracle.fired())
    }

    fn with<T>(&self, ask: impl FnOnce(Oracle) -> T) -> T {
        let file = super::parse(&self.text);
        let points = |_: &str, _: Option<u32>| self.points.clone();
        let oracle = Oracle::new(&file, self.system.as_deref(), &points).seed(self.seed).steps(self.steps);
        ask(self.set.iter().fold(oracle, |oracle, (name, value)| oracle.set(name, *value)))
    }
}
