//! Random patch systems as text, each from a seed that reproduces it; curve systems; meshes.
//!
//! Inputs are nets of small integers, so that a few levels are exact in f32. The schedules are
//! drawn until the oracle finds the growth bounded.

pub mod curve;
mod expression;
pub mod mesh;
mod random;
mod system;

use super::halving::Net;
use super::word::{Param, Word};
use super::{Oracle, parse};
pub use random::Random;
use std::fmt;
use system::Generator;

/// The most modules that a word of a case has.
const MODULES: usize = 3000;
/// The most halvings along u or v: rows and columns stay well within 32 bits.
const HALVINGS: u32 = 30;

/// A system and all that its derivation needs.
#[derive(Clone, Debug)]
pub struct Case {
    /// [`case`] of this seed is this case.
    pub seed: u64,
    pub text: String,
    /// The nets of the file `lattice.bpt`: integers, in homogeneous coordinates.
    pub nets: Vec<Net>,
    /// All coordinates are below 2^bits.
    pub bits: u32,
    /// Params that the host sets before the run.
    pub set: Vec<(String, Param)>,
    /// The limit of steps, as of `--steps`.
    pub steps: Option<usize>,
}

/// What to write beside a failure.
impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "case of seed {}, {:?}, at most {:?} steps:", self.seed, self.set, self.steps)?;
        f.write_str(&self.text)
    }
}

impl Case {
    /// The words that the oracle derives.
    pub fn derive(&self) -> Vec<Word> {
        self.derive_within(usize::MAX).expect("no bounds")
    }

    fn derive_within(&self, modules: usize) -> Option<Vec<Word>> {
        let file = parse(&self.text);
        let nets = |_: &str| self.nets.clone();
        let mut oracle = Oracle::new(&file, None, &nets).steps(self.steps).bounds(modules, HALVINGS);
        for (name, value) in &self.set {
            oracle = oracle.set(name, *value);
        }
        oracle.derive_within()
    }
}

/// Texts that occur in one case or another.
pub const CONSTRUCTS: [&str; 25] = [
    "eps",
    "ε",
    "until terminal",
    "repeat",
    "if ",
    "with grow",
    "with thin, grow",
    "let x",
    "_",
    "level",
    "step",
    "[0]",
    "rational",
    "-2147483648",
    "% 2",
    "clamp(",
    "bool",
    " in ",
    "1/2",
    "bezier 3 ",
    "p2: ",
    "→",
    "≤",
    " | ",
    "[ [",
];

/// The case of a seed: of what the oracle knows, which the engine derives.
pub fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    // Small words are cheap to come by: most cases are drawn again until they grow.
    let wanted = *random.pick(&[1, 8, 20, 60, 200]);
    let mut best = draw(seed, random.next());
    for _ in 0..12 {
        if best.1 >= wanted {
            break;
        }
        let other = draw(seed, random.next());
        if other.1 > best.1 {
            best = other;
        }
    }
    best.0
}

/// A case and the most modules that one of its words has.
fn draw(seed: u64, salt: u64) -> (Case, usize) {
    let mut generator = Generator::new(salt);
    let system = generator.system();
    let nets = generator.nets();
    let set = generator.overrides();
    let mut case = Case { seed, text: String::new(), nets, bits: generator.bits, set, steps: None };
    for size in [5, 4, 3, 3, 2, 2, 1] {
        case.text = format!("{system}{}", generator.run(size));
        if let Some(words) = case.derive_within(MODULES) {
            if generator.random.chance(20) {
                case.steps = Some(generator.random.below(words.len()));
            }
            let done = words.iter().take(case.steps.map_or(words.len(), |limit| limit + 1));
            let most = done.map(|word| word.modules.len()).max().unwrap_or(0);
            return (case, most);
        }
    }
    let groups = generator.with();
    case.text = format!("{system}run:\n  derive 1{groups}\n");
    (case, 1)
}

/// The smallest case found by leaving out lines, roots and settings as long as `fails` says yes.
///
/// `fails` also sees texts that are no system any more; it must say no to them before it derives.
pub fn minimise(case: &Case, fails: impl Fn(&Case) -> bool) -> Case {
    let mut best = case.clone();
    loop {
        let Some(smaller) = simplifications(&best).into_iter().find(|c| fails(c)) else { return best };
        best = smaller;
    }
}

fn simplifications(case: &Case) -> Vec<Case> {
    let texts = shorter(&case.text).into_iter();
    let mut simpler: Vec<Case> = texts.map(|text| Case { text, ..case.clone() }).collect();
    for index in 0..case.set.len() {
        let mut set = case.set.clone();
        set.remove(index);
        simpler.push(Case { set, ..case.clone() });
    }
    if case.nets.len() > 1 {
        simpler.push(Case { nets: case.nets[..1].to_vec(), ..case.clone() });
    }
    simpler
}

/// The text without some of its lines.
fn shorter(text: &str) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let mut shorter = Vec::new();
    // Large bites first: halves, quarters … single lines.
    let mut bite = lines.len().div_ceil(2);
    while bite > 0 {
        for start in (0..lines.len()).step_by(bite.div_ceil(2)) {
            let end = (start + bite).min(lines.len());
            let kept: Vec<&str> = [&lines[..start], &lines[end..]].concat();
            shorter.push(kept.join("\n") + "\n");
        }
        bite /= 2;
    }
    for (open, line) in lines.iter().enumerate().filter(|(_, line)| line.ends_with('{')) {
        // `repeat` and `if` go without their body.
        let indent = line.len() - line.trim_start().len();
        let closing = format!("{}}}", " ".repeat(indent));
        let Some(length) = lines[open..].iter().position(|line| *line == closing) else { continue };
        let body = &lines[open + 1..open + length];
        let kept: Vec<&str> = [&lines[..open], body, &lines[open + length + 1..]].concat();
        shorter.push(kept.join("\n") + "\n");
    }
    shorter
}
