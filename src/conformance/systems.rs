//! Whole derivations: CPU and device in lockstep over the same system.

use super::{Case, Compared, Stop, Trouble, check, lattice};
use crate::codegen::{Mapping, Tuning};
use crate::cpu::Cpu;
use crate::gpu::{Engine, Gpu};
use crate::io::bpt;
use crate::language::{System, Value};
use crate::patch::{Axiom, Grid, Values};
use crate::plan::compare::Pair;
use crate::plan::derive::{collect, derive};
use crate::plan::{self, Options, Plan, View};

/// A system of the suite.
#[derive(Clone, Copy, Debug)]
pub struct Subject {
    pub name: &'static str,
    /// The rule file.
    pub text: &'static str,
    pub nets: Nets,
    /// Stop after this many steps in all.
    pub steps: Option<u32>,
    /// The derivation is refused at this step, since an address would not fit.
    pub too_deep: Option<u32>,
    /// What the host gives: values for its queries, and a view.
    pub given: Option<fn() -> Gifts>,
}

/// Values by query, and a view.
pub type Gifts = (Vec<(String, Values)>, View);

/// What all files of an axiom hold.
#[derive(Clone, Copy, Debug)]
pub enum Nets {
    /// A `.bpt` file.
    File(&'static str),
    /// So many of [`lattice`].
    Lattice(usize),
}

const SHEET: Nets = Nets::File(include_str!("../../examples/data/sheet.bpt"));
const CYLINDER: Nets = Nets::File(include_str!("../../examples/data/cylinder.bpt"));
const SPHERE: Nets = Nets::File(include_str!("../../examples/data/sphere.bpt"));
const TORUS: Nets = Nets::File(include_str!("../../examples/data/torus.bpt"));
const HILL: Nets = Nets::File(include_str!("../../examples/data/hill.bpt"));
const TEAPOT: Nets = Nets::File(include_str!("../../examples/data/teapot.bpt"));

macro_rules! example {
    ($name:literal, $nets:expr, $steps:literal) => {
        Subject {
            name: concat!("example ", $name),
            text: include_str!(concat!("../../examples/", $name, ".burgeon")),
            nets: $nets,
            steps: Some($steps),
            too_deep: None,
            given: None,
        }
    };
}

/// The examples of this crate, a few steps of each.
pub const EXAMPLES: &[Subject] = &[
    example!("adaptive", HILL, 4),
    example!("cylinder", CYLINDER, 3),
    example!("fractal", SHEET, 5),
    example!("holes", SHEET, 4),
    example!("sierpinski", SHEET, 5),
    example!("sierpinski2", SHEET, 5),
    example!("sphere", SPHERE, 2),
    example!("teapot", TEAPOT, 2),
    example!("teapot_lace", TEAPOT, 3),
    example!("torus", TORUS, 3),
];

macro_rules! written {
    ($name:literal, $roots:literal, $too_deep:expr) => {
        written!($name, $roots, $too_deep, None)
    };
    ($name:literal, $roots:literal, $too_deep:expr, $given:expr) => {
        Subject {
            name: $name,
            text: include_str!(concat!("systems/", $name, ".burgeon")),
            nets: Nets::Lattice($roots),
            steps: None,
            too_deep: $too_deep,
            given: $given,
        }
    };
}

/// Systems written for the corners of a step.
pub const WRITTEN: &[Subject] = &[
    written!("every", 2, None),
    written!("closed", 1, None),
    written!("mixed", 1, None),
    written!("values", 3, None),
    written!("lots", 3, None),
    written!("measures", 3, None, Some(given)),
    written!("deep", 2, Some(32)),
    written!("deep_closed", 1, Some(32)),
];

/// Values for the queries of `measures`, and a viewer in the midst of its nets.
fn given() -> Gifts {
    let number = |n: u32| Value::Float((n * 37 % 11) as f32);
    let heat = Values::Roots((0..3).map(number).collect());
    let (from, to) = ([-9.0; 3], [9.0; 3]);
    let field = Values::Grid(Grid { size: [3, 2, 4], from, to, values: (0..24).map(number).collect() });
    let view = View::looking([0.0; 3], [5.0, 1.0, 0.0], [0.0, 0.0, 1.0], 60.0, [640.0, 480.0]);
    (vec![("Heat".to_string(), heat), ("Field".to_string(), field)], view)
}

/// More invocations than one dimension of workgroups holds.
pub const WIDE: Subject = written!("wide", 40_000, None);

macro_rules! generated {
    ($($name:literal)*) => {
        &[$(Subject {
            name: concat!("random ", $name),
            text: include_str!(concat!("systems/generated/", $name, ".burgeon")),
            nets: Nets::Lattice(4),
            steps: None,
            too_deep: None,
            given: None,
        }),*]
    };
}

/// Random systems, frozen.
pub const GENERATED: &[Subject] = generated!(
    "00" "01" "02" "03" "04" "05" "06" "07" "08" "09" "10" "11"
    "12" "13" "14" "15" "16" "17" "18" "19" "20" "21" "22" "23"
);

/// All mappings of emit, and other sizes of workgroups; the mapping that drivers compile faster has
/// more of them.
pub const TUNINGS: [Tuning; 4] = [
    Tuning::CPU_DRIVER,
    Tuning::GPU,
    Tuning { workgroup: 32, scan_workgroup: 32, scan_items: 32, mapping: Mapping::PointPerInvocation },
    Tuning { workgroup: 128, scan_workgroup: 128, scan_items: 64, mapping: Mapping::LinePerInvocation },
];

/// Modules a chunk before every step.
pub const CHUNKS: [Option<usize>; 4] = [None, Some(64), Some(7), Some(1)];

/// Chunks that a step may be cut into, since each costs a few round trips to the device.
const MOST_CHUNKS: u64 = 30;

/// A subject, ready to be derived.
pub struct Job {
    pub plan: Plan,
    pub axiom: Axiom,
    pub uniforms: Vec<Value>,
}

impl Job {
    /// # Errors
    /// Where the text does not check, or is not derived: it is none of the suite then.
    pub fn new(text: &str, nets: Nets) -> Result<Job, Box<dyn std::error::Error>> {
        let system = System::parse(text)?;
        let plan = Plan::new(&system)?;
        let mut read = |_: &str| match nets {
            Nets::File(text) => bpt::parse(text.as_bytes(), plan.rational()).map_err(|e| e.to_string()),
            Nets::Lattice(count) => Ok(lattice(count)),
        };
        let axiom = Axiom::load(&system, &mut read)?;
        let uniforms = plan.uniforms(&[])?;
        Ok(Job { plan, axiom, uniforms })
    }

    /// As many steps as leave every one within [`MOST_CHUNKS`] chunks of so many modules.
    fn steps_in_chunks(&self, options: &Options, chunk: usize) -> Result<u32, plan::Error> {
        let mut cpu = Cpu::new(&self.plan, 1)?;
        let whole = derive(&self.axiom, options, &mut cpu)?;
        let few = |modules: u64| modules <= MOST_CHUNKS * chunk as u64;
        if !few(self.axiom.roots.len() as u64) {
            return Ok(0);
        }
        Ok(1 + whole.steps.iter().take_while(|s| few(s.modules)).count() as u32)
    }
}

impl Subject {
    /// Parses and plans it.
    ///
    /// # Panics
    /// Where it is no system that is derived: a fault of this crate's, which its tests look for.
    pub fn job(&self) -> Job {
        match Job::new(self.text, self.nets) {
            Ok(job) => job,
            Err(e) => panic!("{}: {e}", self.name),
        }
    }

    /// Derives it on the CPU and on the engine, once for each size of chunks, and compares every pass.
    pub fn compare(
        &self,
        engine: &Engine,
        chunks: &[Option<usize>],
        stop: Stop,
    ) -> Result<Compared, Trouble> {
        let job = self.job();
        let cpu = Cpu::new(&job.plan, 1)?;
        let gpu = Gpu::new(engine, &job.plan)?;
        let mut pair = Pair::new(cpu, gpu, ["CPU", "GPU"]);
        for &chunk in chunks {
            check(stop)?;
            let mut options = Options { seed: Some(5), steps: self.steps, stop, ..Options::default() };
            if let Some(given) = self.given {
                let (bind, view) = given();
                options.bind = bind;
                options.view = Some(view);
            }
            if let (Some(chunk), None) = (chunk, self.too_deep) {
                options.steps =
                    Some(job.steps_in_chunks(&options, chunk)?.min(self.steps.unwrap_or(u32::MAX)));
                options.chunk_modules = Some(chunk);
            }
            let derived = derive(&job.axiom, &options, &mut pair);
            let result = derived.and_then(|d| collect(&mut pair, &d)).map_err(Trouble::from);
            match (result, self.too_deep) {
                (Ok(_), None) => {}
                (Ok(_), Some(step)) => {
                    let what = format!(
                        "match_modules, step {step}: more halvings than an address holds are accepted"
                    );
                    return Err(Trouble::Differs(what));
                }
                (Err(Trouble::Failed(crate::gpu::Error::Plan(plan::Error::TooDeep { step }))), Some(s))
                    if step == s => {}
                (Err(e), _) => return Err(e),
            }
        }
        let (sweeps, values, rounding) = (pair.sweeps as u64, pair.elements, pair.rounding);
        Ok(Compared { runs: chunks.len() as u64, passes: sweeps, values, rounding })
    }

    /// The same with several tunings.
    fn compare_tuned(
        &self,
        engine: &Engine,
        tunings: &[Tuning],
        chunks: &[Option<usize>],
        stop: Stop,
    ) -> Result<Compared, Trouble> {
        let mut all = Compared::default();
        for (n, tuning) in tunings.iter().enumerate() {
            // Small chunks are slow, and say as much with one size of workgroups as with another.
            let chunks = if n < 2 { chunks } else { &chunks[..1] };
            let tuned = self.compare(&engine.retuned(*tuning), chunks, stop).map_err(|e| e.with(tuning))?;
            all.add(tuned);
        }
        Ok(all)
    }
}

impl Trouble {
    /// Says with which sizes.
    pub(super) fn with(self, tuning: &Tuning) -> Trouble {
        match self {
            Trouble::Differs(what) => {
                let mapping = match tuning.mapping {
                    Mapping::NetPerInvocation => "a net",
                    Mapping::PointPerInvocation => "a point",
                    Mapping::LinePerInvocation => "a line",
                };
                let size = tuning.workgroup;
                Trouble::Differs(format!("{what} (workgroups of {size}, {mapping} an invocation)"))
            }
            other => other,
        }
    }
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for &subject in EXAMPLES.iter().chain(WRITTEN) {
        cases.push(Case::new(subject.name, move |engine, stop| {
            let chunks = if subject.too_deep.is_some() { &CHUNKS[..1] } else { &CHUNKS };
            let tunings = if subject.too_deep.is_some() { &TUNINGS[..2] } else { &TUNINGS };
            subject.compare_tuned(engine, tunings, chunks, stop)
        }));
    }
    for (n, &subject) in GENERATED.iter().enumerate() {
        // One mapping each, mostly the one that drivers compile faster; whole and in chunks.
        let tuning = if n % 8 == 0 { TUNINGS[0] } else { TUNINGS[1] };
        let chunks = [CHUNKS[0], CHUNKS[1 + n % 3]];
        cases.push(Case::new(subject.name, move |engine, stop| {
            subject.compare_tuned(engine, &[tuning], &chunks, stop)
        }));
    }
    cases.push(Case::new("wide dispatches", |engine, stop| {
        let mut all = Compared::default();
        for (workgroup, mapping) in [(1, Mapping::NetPerInvocation), (16, Mapping::PointPerInvocation)] {
            let tuning = Tuning { workgroup, mapping, ..Tuning::CPU_DRIVER };
            let compared = WIDE.compare(&engine.retuned(tuning), &[None], stop);
            all.add(compared.map_err(|e| e.with(&tuning))?);
        }
        Ok(all)
    }));
    cases
}
