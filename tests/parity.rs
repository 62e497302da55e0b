//! CPU = GPU after every pass, oracle = both after every step, however the word is cut into chunks
//! and however many threads there are.

use crate::device;
use crate::oracle::{self, Tolerance};
use crate::papers;
use crate::tier;
use burgeon::codegen::{Mapping, Tuning};
use burgeon::cpu::Cpu;
use burgeon::gpu::{Engine, Gpu};
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{Severity, System, Value, compile};
use burgeon::patch::{Axiom, Net, Word};
use burgeon::plan::compare::Pair;
use burgeon::plan::derive::{Backend, collect, derive};
use burgeon::plan::{Options, Plan};
use std::fmt::Debug;

/// The last system of a text that must check.
#[track_caller]
pub fn system(text: &str) -> System {
    let checked = compile(text, &Vocabulary::default());
    let error = checked.diagnostics.iter().find(|d| d.severity == Severity::Error);
    if let Some(e) = error {
        panic!("{}: {} in\n{text}", e.code, e.message);
    }
    checked.systems.last().expect("a system").clone()
}

/// The oracle's nets as an engine takes them.
fn nets(nets: &[oracle::Net]) -> Vec<Net> {
    let net = |n: &oracle::Net| Net {
        degree: n.degree.map(|d| d as u8),
        points: n.points.iter().map(|p| p.map(|x| x as f32)).collect(),
    };
    nets.iter().map(net).collect()
}

/// A plan with all its files holding these nets.
pub struct Job {
    pub plan: Plan,
    pub axiom: Axiom,
    pub set: Vec<(String, Value)>,
    pub uniforms: Vec<Value>,
}

impl Job {
    #[track_caller]
    pub fn new(text: &str, roots: &[oracle::Net], set: Vec<(String, Value)>) -> Job {
        let system = system(text);
        let plan = Plan::new(&system).unwrap_or_else(|e| panic!("{e} in\n{text}"));
        let axiom = Axiom::load::<String>(&system, &mut |_| Ok(nets(roots))).expect("an axiom");
        let uniforms = plan.uniforms(&set).expect("params");
        Job { plan, axiom, set, uniforms }
    }

    pub fn options(&self, steps: Option<u32>, chunk_modules: Option<usize>) -> Options<'static> {
        Options { set: self.set.clone(), steps, chunk_modules, ..Options::default() }
    }

    /// The word after `steps` steps.
    #[track_caller]
    pub fn word<B: Backend>(&self, backend: &mut B, steps: Option<u32>, chunk: Option<usize>) -> Word
    where
        B::Error: Debug,
    {
        let options = self.options(steps, chunk);
        let derivation = derive(&self.axiom, &options, backend).expect("a derivation");
        collect(backend, &derivation).expect("a word")
    }

    pub fn cpu(&self, threads: usize) -> Cpu {
        Cpu::new(&self.plan, threads).expect("threads")
    }

    pub fn gpu(&self, engine: &Engine) -> Gpu {
        Gpu::new(engine, &self.plan).expect("kernels")
    }
}

/// What the case sets; a param that the system does not read is none of its own.
pub fn settings(case: &oracle::Case) -> Vec<(String, Value)> {
    let system = system(&case.text);
    let value = |p: &oracle::Param| match *p {
        oracle::Param::Int(i) => Value::Int(i),
        oracle::Param::Bool(b) => Value::Bool(b),
        oracle::Param::Float(x) => Value::Float(x as f32),
        other => panic!("no param of a patch system that is drawn at random: {other:?}"),
    };
    let own = |name: &str| system.uniforms.iter().any(|u| u.name == name);
    case.set.iter().filter(|(name, _)| own(name)).map(|(name, p)| (name.clone(), value(p))).collect()
}

/// Seeds of random systems; every one that once failed stays in `KEPT`.
const SEEDS: std::ops::Range<u64> = 0..300;
const SAMPLE: std::ops::Range<u64> = 0..60;
const GPU_SEEDS: std::ops::Range<u64> = 0..12;
const KEPT: [u64; 0] = [];
/// What the random systems that run on devices have between them.
const ON_DEVICES: [&str; 14] = [
    "bezier 3\n",
    "rational",
    "eps",
    "[ [",
    "bool",
    "float",
    "step",
    "with ",
    "until terminal",
    "repeat",
    "chunks of None",
    "chunks of Some(64)",
    "chunks of Some(7)",
    "chunks of Some(1)",
];

#[test]
fn oracle_and_cpu_agree_after_every_step_of_random_systems() {
    let mut missing = tier::Missing::new(&oracle::CONSTRUCTS);
    for seed in tier::cases(SAMPLE, SEEDS).chain(KEPT) {
        let case = oracle::case(seed);
        missing.has_less(&case.text);
        let words = case.derive();
        let job = Job::new(&case.text, &case.nets, settings(&case));
        let tolerance = Tolerance::Lattice { bits: case.bits, c: 4.0 };
        for (step, expected) in words.iter().enumerate() {
            let word = job.word(&mut job.cpu(2), Some(step as u32), None);
            if let Err(e) = oracle::compare(expected, &word, tolerance) {
                panic!("{case}\nafter step {step}: {e}");
            }
            assert_eq!(word.steps as usize, step, "{case}");
        }
        let all = job.word(&mut job.cpu(1), case.steps.map(|s| s as u32), None);
        assert_eq!(all.steps as usize, words.len() - 1, "{case}\nsteps of the whole schedule");
    }
    missing.assert_none();
}

#[test]
fn cpu_gives_the_same_bytes_however_it_is_cut_and_shared_out() {
    // K17
    for seed in SEEDS.step_by(5) {
        let case = oracle::case(seed);
        let job = Job::new(&case.text, &case.nets, settings(&case));
        let steps = case.steps.map(|s| s as u32);
        let whole = job.word(&mut job.cpu(1), steps, None);
        for (threads, chunk) in [(2, None), (3, Some(64)), (1, Some(7)), (2, Some(1))] {
            if chunk == Some(1) && whole.modules.len() > 300 {
                continue;
            }
            let word = job.word(&mut job.cpu(threads), steps, chunk);
            assert!(word == whole, "{case}\n{threads} threads, chunks of {chunk:?}");
        }
    }
}

#[test]
fn gpu_and_cpu_agree_after_every_pass_of_random_systems() {
    let chunk_of = |case: &oracle::Case| {
        let chunk = [None, Some(64), Some(7), Some(1)][case.seed as usize % 4];
        chunk.filter(|c| *c > 1 || case.derive().iter().all(|w| w.modules.len() < 60))
    };
    let described = |case: &oracle::Case| format!("{}chunks of {:?}", case.text, chunk_of(case));
    let cases = tier::covering(GPU_SEEDS.chain(KEPT).map(oracle::case), &ON_DEVICES, described);
    for (name, engine) in device::engines() {
        for case in &cases {
            let job = Job::new(&case.text, &case.nets, settings(case));
            let chunk = chunk_of(case);
            let mut pair = Pair::new(job.cpu(2), job.gpu(&engine), ["CPU", "GPU"]);
            let options = job.options(case.steps.map(|s| s as u32), chunk);
            let result = derive(&job.axiom, &options, &mut pair);
            if let Err(e) = result.and_then(|d| collect(&mut pair, &d)) {
                panic!("{name}, chunks of {chunk:?}: {e}\n{case}");
            }
        }
    }
}

/// The papers' numbers on a backend of the engine.
fn papers_on<B: Backend>(backend: &dyn Fn(&Job) -> B)
where
    B::Error: Debug,
{
    let derive = |text: &str, roots: &[oracle::Net]| {
        let job = Job::new(text, roots, Vec::new());
        let mut backend = backend(&job);
        let mut words = Vec::new();
        loop {
            let next = job.word(&mut backend, Some(words.len() as u32), None);
            // The schedule has ended when fewer steps were done than were asked for.
            if next.steps as usize != words.len() {
                return words;
            }
            words.push(papers::seen_by_engine(&next));
        }
    };
    let backend = papers::Backend { derive: &derive, tolerance: 1e-6 };
    for check in papers::DERIVED {
        check(&backend);
    }
}

#[test]
fn papers_numbers_hold_on_the_cpu() {
    papers_on(&|job| job.cpu(2));
}

#[test]
fn papers_numbers_hold_on_the_gpu() {
    for (_, engine) in device::engines() {
        papers_on(&|job| job.gpu(&engine));
    }
}

#[test]
fn every_tuning_gives_the_same_words() {
    let Some(headless) = device::headless() else { return };
    let mappings = [Mapping::NetPerInvocation, Mapping::PointPerInvocation, Mapping::LinePerInvocation];
    for (mapping, seed) in
        mappings.into_iter().flat_map(|m| tier::cases(100..102, 100..106).map(move |seed| (m, seed)))
    {
        let tuning = Tuning { mapping, ..Tuning::GPU };
        let engine = Engine::with_tuning(&headless.device, &headless.queue, tuning);
        let case = oracle::case(seed);
        let job = Job::new(&case.text, &case.nets, settings(&case));
        let steps = case.steps.map(|s| s as u32);
        let expected = job.word(&mut job.cpu(2), steps, None);
        assert!(job.word(&mut job.gpu(&engine), steps, None) == expected, "{case}\n{tuning:?}");
    }
}
