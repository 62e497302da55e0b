//! The conformance suite: whether a device does what the CPU does.
//!
//! Each [`Case`] runs on a device and is compared with the CPU backend after every pass and every
//! buffer, or with a closed form on the host. `burgeon selftest` prints them as a table; a program
//! that embeds the engine can run them on its users' devices:
//!
//! ```no_run
//! use burgeon::conformance::{self, Outcome};
//! use burgeon::gpu::{Engine, Headless, Requirement};
//!
//! let own = Headless::new(Requirement::Any)?;
//! let engine = Engine::new(&own.device, &own.queue);
//! for case in conformance::cases() {
//!     match case.run(&engine, None).outcome {
//!         Outcome::Equal | Outcome::Within(_) => {}
//!         wrong => println!("{}: {wrong}", case.name),
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! What must agree: rules, counts, offsets, nets, addresses, integers and random numbers to the bit;
//! what comes of floats within the [bound](crate::plan::bound) of its expression; elementary functions within the
//! bounds of [`elementary::FUNCTIONS`]. WGSL promises no more than that, even of `+`.
//!
//! The systems are the examples of this crate, some written for the corners of a step, and a frozen
//! set of random ones (`src/conformance/systems`), on which the tests hold the CPU against an
//! interpreter of its own.

pub mod capacity;
pub mod elementary;
pub mod operations;
pub mod random;
pub mod scans;
pub mod systems;
pub mod tessellation;

use crate::gpu::{self, Engine};
use crate::plan::compare::PairError;
use crate::{patch, plan};
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// One thing that is tried on a device.
pub struct Case {
    pub name: String,
    run: Box<Run>,
}

type Run = dyn Fn(&Engine, Stop) -> Result<Compared, Trouble>;

/// What ends a case early, when set.
pub type Stop<'a> = Option<&'a AtomicBool>;

/// What was compared, and how near it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compared {
    /// Derivations, scans or batches of expressions.
    pub runs: u64,
    /// Passes of these.
    pub passes: u64,
    /// 4-byte words.
    pub values: u64,
    /// The greatest distance of two floats, as a part of what is allowed; 0 where all are equal.
    pub rounding: f32,
}

impl Compared {
    fn add(&mut self, other: Compared) {
        self.runs += other.runs;
        self.passes += other.passes;
        self.values += other.values;
        self.rounding = self.rounding.max(other.rounding);
    }
}

/// Why a case did not come to a good end.
#[derive(Debug, thiserror::Error)]
pub enum Trouble {
    /// Where the device gives something else, and what.
    #[error("{0}")]
    Differs(String),
    /// The device, a kernel or the memory failed.
    #[error(transparent)]
    Failed(#[from] gpu::Error),
    #[error("stopped")]
    Stopped,
}

impl From<plan::Error> for Trouble {
    fn from(e: plan::Error) -> Trouble {
        match e {
            plan::Error::Stopped { .. } => Trouble::Stopped,
            e => Trouble::Failed(e.into()),
        }
    }
}

impl From<PairError<plan::Error, gpu::Error>> for Trouble {
    fn from(e: PairError<plan::Error, gpu::Error>) -> Trouble {
        match e {
            PairError::Plan(e) | PairError::Left(e) | PairError::Right(gpu::Error::Plan(e)) => e.into(),
            PairError::Right(e) => Trouble::Failed(e),
            PairError::Difference(d) => Trouble::Differs(d.to_string()),
        }
    }
}

/// What came of a case.
#[derive(Debug)]
pub enum Outcome {
    /// Every value to the bit.
    Equal,
    /// Some floats are apart, at most by this part of what is allowed.
    Within(f32),
    /// Where the device gives something else, and what.
    Differs(String),
    /// The device, a kernel or the memory failed, so that nothing is known.
    Failed(gpu::Error),
    Stopped,
}

/// As in the table of `burgeon selftest`.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Outcome::Equal => f.write_str("equal"),
            Outcome::Within(part) => write!(f, "within {part:.3} of the bound"),
            Outcome::Differs(what) => write!(f, "DIFFERS: {what}"),
            Outcome::Failed(e) => write!(f, "FAILED: {e}"),
            Outcome::Stopped => f.write_str("stopped"),
        }
    }
}

/// A case that was run.
#[derive(Debug)]
pub struct Row {
    pub name: String,
    /// Nothing where the outcome is no agreement.
    pub compared: Compared,
    pub outcome: Outcome,
    pub time: Duration,
}

impl Case {
    fn new(
        name: impl Into<String>,
        run: impl Fn(&Engine, Stop) -> Result<Compared, Trouble> + 'static,
    ) -> Case {
        Case { name: name.into(), run: Box::new(run) }
    }

    /// Runs it. `stop` is looked at between the parts of the case; the outcome is then
    /// [`Outcome::Stopped`].
    pub fn run(&self, engine: &Engine, stop: Stop) -> Row {
        let start = Instant::now();
        let result = (self.run)(engine, stop);
        let time = start.elapsed();
        let (compared, outcome) = match result {
            Ok(c) if c.rounding == 0.0 => (c, Outcome::Equal),
            Ok(c) => (c, Outcome::Within(c.rounding)),
            Err(Trouble::Differs(what)) => (Compared::default(), Outcome::Differs(what)),
            Err(Trouble::Failed(e)) => (Compared::default(), Outcome::Failed(e)),
            Err(Trouble::Stopped) => (Compared::default(), Outcome::Stopped),
        };
        Row { name: self.name.clone(), compared, outcome, time }
    }
}

/// What a set of rows says of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Device and CPU agree in every case.
    Agree,
    /// They disagree in one at least, whatever else failed.
    Differ,
    /// Some case could not be carried out.
    Failed,
    /// Not all cases were run.
    Stopped,
}

/// The worst of the rows.
pub fn verdict(rows: &[Row]) -> Verdict {
    let any = |test: fn(&Outcome) -> bool| rows.iter().any(|r| test(&r.outcome));
    if any(|o| matches!(o, Outcome::Differs(_))) {
        Verdict::Differ
    } else if any(|o| matches!(o, Outcome::Failed(_))) {
        Verdict::Failed
    } else if any(|o| matches!(o, Outcome::Stopped)) {
        Verdict::Stopped
    } else {
        Verdict::Agree
    }
}

/// The whole suite.
pub fn cases() -> Vec<Case> {
    let mut cases = systems::cases();
    cases.extend(scans::cases());
    cases.extend(operations::cases());
    cases.push(Case::new("elementary functions", |engine, _| elementary::compare(engine)));
    cases.push(Case::new("random numbers", |engine, _| random::compare(engine)));
    cases.extend(capacity::cases());
    cases.extend(tessellation::cases());
    cases
}

/// [`Trouble::Stopped`] where that was asked for.
fn check(stop: Stop) -> Result<(), Trouble> {
    if stop.is_some_and(|s| s.load(Ordering::Relaxed)) { Err(Trouble::Stopped) } else { Ok(()) }
}

/// Bicubic nets of small integers that follow no pattern: a few levels of halving are exact.
pub fn lattice(count: usize) -> Vec<patch::Net> {
    let mut state = 0x2545_f491u32;
    let mut number = move || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state % 64) as f32 - 32.0
    };
    let mut net = || {
        let points = (0..16).map(|_| [number(), number(), number(), 1.0]).collect();
        patch::Net { degree: [3, 3], points }
    };
    (0..count).map(|_| net()).collect()
}
