//! The oracle of curve systems: words as strings with their brackets, rules tried one after the other.
//!
//! An engine keeps links where this keeps brackets; [`Word::links`] says what links a string means,
//! and contexts are read along them.

mod compare;
mod context;
mod derive;
mod step;
mod tests;
mod turtle;
mod word;

pub use compare::{Seen, SeenModule, Tolerance, assert_same, compare, see};
pub use derive::Oracle;
pub use word::{Link, Module, Token, Topology, Word};

use super::word::Param;

/// A derivation and all that it needs.
#[derive(Clone, Debug, Default)]
pub struct Job {
    pub text: String,
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

    pub fn points(mut self, points: &[Vec<f64>]) -> Job {
        self.points = points.to_vec();
        self
    }

    pub fn set(mut self, name: &str, value: Param) -> Job {
        self.set.push((name.to_string(), value));
        self
    }

    /// The words of the last system: the axiom and the word after every step.
    #[track_caller]
    pub fn derive(&self) -> Vec<Word> {
        self.derive_within(usize::MAX).expect("no bounds")
    }

    /// As [`derive`](Self::derive); `None` if a word has more modules.
    #[track_caller]
    pub fn derive_within(&self, modules: usize) -> Option<Vec<Word>> {
        let file = super::parse(&self.text);
        let points = |_: &str, _: Option<u32>| self.points.clone();
        let mut oracle = Oracle::new(&file, None, &points).seed(self.seed).steps(self.steps).bound(modules);
        for (name, value) in &self.set {
            oracle = oracle.set(name, *value);
        }
        oracle.derive_within()
    }
}
