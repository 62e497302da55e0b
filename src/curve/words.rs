//! Several words at once: independent derivations of one system in one run.

use super::Axiom;
use crate::language::Value;
use std::sync::Arc;

/// Words that are derived together, each as if it were alone: contexts never cross, and each has params and a seed of
/// its own. A [`Plan::of_words`](crate::plan::Plan::of_words) takes them.
///
/// Schedules must be the same: params that stand in the counts of `run:` must be equal in all. `until terminal` goes on
/// until no rule fires in any word.
///
/// ```
/// use burgeon::cpu;
/// use burgeon::curve::{Axiom, Words};
/// use burgeon::language::{System, Value};
/// use burgeon::plan::{Options, Plan};
///
/// let system = System::parse(
///     "system corners : curve ring
///      param w: float = 1/4
///      module P(v: vec2)
///      axiom: P((0, 0)) P((4, 0)) P((4, 3))
///      rules:
///        P(a) < P(v) > P(b) -> P(w*a + (1 - w)*v) P((1 - w)*v + w*b)
///      run:
///        derive 3",
/// )?;
/// let axiom = Axiom::load::<String>(&system, &mut |file| Err(format!("{file} is not there")))?;
/// let starts = Words::sweep(&axiom, "w", [0.0, 0.25, 0.5].map(Value::Float));
///
/// let plan = Plan::of_words(&system)?;
/// let (words, _) = cpu::derive(&plan, &starts, &Options::default(), 0)?; // or gpu::derive
/// assert!(words.iter().all(|word| word.modules.len() == 24));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Words {
    pub words: Vec<Start>,
}

/// One of several words.
#[derive(Clone, Debug)]
pub struct Start {
    /// Shared by the words that begin alike.
    pub axiom: Arc<Axiom>,
    /// Params by name, in place of those of the run's [`Options`](crate::plan::Options).
    pub set: Vec<(String, Value)>,
    /// What its random numbers begin with, in place of the seed of the options; see there for none.
    pub seed: Option<u32>,
}

impl Words {
    /// The same axiom once for each value of a param, all with the seed of the options.
    pub fn sweep(axiom: &Axiom, param: &str, values: impl IntoIterator<Item = Value>) -> Words {
        let axiom = Arc::new(axiom.clone());
        let start = |value| Start { axiom: axiom.clone(), set: vec![(param.to_string(), value)], seed: None };
        Words { words: values.into_iter().map(start).collect() }
    }

    /// The same axiom once for each seed.
    pub fn seeds(axiom: &Axiom, seeds: impl IntoIterator<Item = u32>) -> Words {
        let axiom = Arc::new(axiom.clone());
        let start = |seed| Start { axiom: axiom.clone(), set: Vec::new(), seed: Some(seed) };
        Words { words: seeds.into_iter().map(start).collect() }
    }
}
