//! The papers' checks and random systems: the oracle, the CPU and the GPU derive the same words, step by step.

#[cfg(feature = "gpu")]
use crate::device;
use crate::oracle::curve::papers::{self, Backend as Deriver};
use crate::oracle::curve::{self, Job, Link, Seen, SeenModule, Tolerance};
use crate::oracle::{self, CurveCase, Param};
use crate::tier;
use burgeon::cpu::Cpu;
use burgeon::curve::{Axiom, Word};
use burgeon::language::system::Topology;
use burgeon::language::{Value, Vocabulary, compile};
use burgeon::plan::derive::{Backend, collect, derive};
use burgeon::plan::{Options, Plan};
use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What an engine needs for a job of the oracle.
pub struct Prepared {
    pub plan: Plan,
    pub axiom: Axiom,
    pub options: Options<'static>,
    /// The limit of the job.
    steps: u32,
}

#[track_caller]
pub fn prepare(job: &Job) -> Prepared {
    let checked = compile(&job.text, &Vocabulary::default());
    assert!(!checked.has_errors(), "{}", job.text);
    let wanted = |s: &&burgeon::language::System| job.system.as_ref().is_none_or(|name| s.name == *name);
    let system = checked.systems.iter().rfind(wanted).expect("a system of that name");
    let plan = Plan::new(system).unwrap_or_else(|e| panic!("{e}\n{}", job.text));
    let point = |p: &Vec<f64>| {
        let at = |k: usize| p.get(k).map(|&x| x as f32);
        [at(0).unwrap_or(0.0), at(1).unwrap_or(0.0), at(2).unwrap_or(0.0), at(3).unwrap_or(1.0)]
    };
    let points: Vec<[f32; 4]> = job.points.iter().map(point).collect();
    let axiom = Axiom::load::<String>(system, &mut |_| Ok(vec![points.clone().into()])).expect("an axiom");
    // A param of the file that the system does not read is none of its own.
    let own = |name: &str| plan.system.uniforms.iter().any(|u| u.name == name);
    let set = job.set.iter().filter(|(name, _)| own(name));
    let set: Vec<_> = set.map(|(name, value)| (name.clone(), of_param(value))).collect();
    let seed = job.seed;
    let steps = job.steps.map_or(u32::MAX, |steps| steps as u32);
    Prepared { plan, axiom, options: Options { set, seed, ..Options::default() }, steps }
}

fn of_param(param: &Param) -> Value {
    let floats: Vec<f32> = param.floats().iter().map(|&x| x as f32).collect();
    match (*param, floats.as_slice()) {
        (Param::Int(i), _) => Value::Int(i),
        (Param::Bool(b), _) => Value::Bool(b),
        (_, &[x]) => Value::Float(x),
        (_, &[x, y]) => Value::Vec2([x, y]),
        (_, &[x, y, z]) => Value::Vec3([x, y, z]),
        (other, _) => panic!("no param: {other:?}"),
    }
}

fn to_param(value: &Value) -> Param {
    match value {
        Value::Int(i) => Param::Int(*i),
        Value::Bool(b) => Param::Bool(*b),
        Value::Float(x) => Param::Float((*x).into()),
        Value::Vec2(v) => Param::Vec2(v.map(f64::from)),
        Value::Vec3(v) => Param::Vec3(v.map(f64::from)),
        Value::Vec4(v) => Param::Vec4(v.map(f64::from)),
        Value::List(_) => panic!("a module holds no list"),
    }
}

impl Prepared {
    /// The word as the oracle sees it. Words tell paths only where random numbers hang on them.
    fn seen(&self, word: &Word) -> Seen {
        let paths = self.plan.tables.layout.paths;
        let ring = word.topology == Topology::Ring;
        let module = |(n, m): (usize, &burgeon::curve::Module)| SeenModule {
            symbol: word.symbols[m.symbol].name.clone(),
            params: word.params(n).iter().map(|value| to_param(&value)).collect(),
            link: (!ring).then_some(Link { parent: m.parent, lateral: m.lateral }),
            path: paths.then_some([(m.path >> 32) as u32, m.path as u32]),
        };
        Seen { modules: word.modules.iter().enumerate().map(module).collect() }
    }

    /// The axiom and the word after every step.
    fn words<B: Backend>(&self, backend: &mut B, chunk: Option<usize>) -> Vec<Seen>
    where
        B::Error: Debug,
    {
        let mut words = Vec::new();
        for steps in 0..=self.steps {
            let options = Options { steps: Some(steps), chunk_modules: chunk, ..self.options.clone() };
            let derived = derive(&self.axiom, &options, backend).expect("a word");
            let word = collect(backend, &derived).expect("a word");
            if word.steps < steps {
                break;
            }
            words.push(self.seen(&word));
        }
        words
    }

    fn on_cpu(&self, chunk: Option<usize>) -> Vec<Seen> {
        self.words(&mut Cpu::new(&self.plan, 2).expect("threads"), chunk)
    }

    #[cfg(feature = "gpu")]
    fn on_gpu(&self, engine: &burgeon::gpu::Engine) -> Vec<Seen> {
        let mut gpu = burgeon::gpu::Gpu::new(engine, &self.plan).expect("kernels");
        self.words(&mut gpu, None)
    }
}

/// A coordinate of size 1 may be off by some units in the last place of f32, level after level.
const ROUNDED: f64 = 2e-6;

/// What the papers say of lines, of words that a turtle traces, and of trees.
fn papers_hold(derive: &dyn Fn(&Job) -> Vec<Seen>) {
    let deriver = Deriver { derive, tolerance: ROUNDED };
    let all = [papers::LINES, papers::TRACED, papers::TREES];
    all.iter().copied().flatten().for_each(|(_, check)| check(&deriver));
}

/// S2 to S5, S7, S8, S10 to S15, S17 to S22, E10, E12, E14: see the names of the checks.
#[test]
fn the_papers_numbers_hold_on_the_cpu() {
    papers_hold(&|job| prepare(job).on_cpu(None));
    papers_hold(&|job| prepare(job).on_cpu(Some(5)));
}

#[cfg(feature = "gpu")]
#[test]
fn the_papers_numbers_hold_on_the_gpu() {
    let Some(headless) = device::headless() else { return };
    let engine = burgeon::gpu::Engine::new(&headless.device, &headless.queue).keeping_kernels();
    papers_hold(&|job| prepare(job).on_gpu(&engine));
}

/// Eight modules, eight on either side of them, and both ends of the word.
#[test]
fn contexts_are_as_deep_as_they_may_be() {
    let eight = "A ".repeat(8);
    let job = |count: usize| {
        let axiom = "A ".repeat(count);
        let rule = format!("# {eight}< {eight}> {eight}# -> B");
        Job::new(format!("system s : curve open\nmodule A, B\naxiom: {axiom}\nrules:\n  {rule}\n"))
    };
    for (count, left) in [(23, 23), (24, 17), (25, 25)] {
        let prepared = prepare(&job(count));
        let on_cpu = prepared.on_cpu(None);
        assert_eq!(on_cpu[1].modules.len(), left);
        assert_eq!(prepared.on_cpu(Some(1)), on_cpu);
        #[cfg(feature = "gpu")]
        if let Some(headless) = device::headless() {
            let engine = burgeon::gpu::Engine::new(&headless.device, &headless.queue);
            assert_eq!(prepared.on_gpu(&engine), on_cpu);
        }
    }
}

/// Random systems of the oracle's generator; those that once failed stay in `KEPT`.
const SEEDS: std::ops::Range<u64> = 0..1200;
const SAMPLE: std::ops::Range<u64> = 0..100;
#[cfg(feature = "gpu")]
const GPU_SEEDS: std::ops::Range<u64> = 0..100;
const KEPT: [u64; 7] = [90, 138, 270, 290, 464, 901, 1144];

/// Asks `words` for the words of a random system, all of which must be the oracle's.
fn agree(case: &CurveCase, words: impl Fn(&Prepared) -> Vec<Seen>) {
    let prepared = prepare(&case.job);
    let found = catch_unwind(AssertUnwindSafe(|| words(&prepared)));
    let (expected, found) = (case.job.derive(), found.unwrap_or_else(|_| panic!("{case}\nis not derived")));
    assert_eq!(found.len(), expected.len(), "{case}\nsteps of the whole schedule");
    let tolerance = if case.exact { Tolerance::Exact } else { Tolerance::Near { c: 64.0 } };
    for (step, (expected, found)) in expected.iter().zip(&found).enumerate() {
        if let Err(e) = curve::compare(expected, found, tolerance) {
            panic!("{case}\nafter step {step}: {e}");
        }
    }
}

#[test]
fn oracle_and_cpu_agree_after_every_step_of_random_curves() {
    let features = oracle::curve_features();
    let mut missing = tier::Missing::new(&features);
    for seed in tier::cases(SAMPLE, SEEDS).chain(KEPT) {
        let case = oracle::curve_case(seed);
        agree(&case, |p| p.on_cpu(None));
        // Linked words are one chunk.
        agree(&case, |p| p.on_cpu(Some([1, 3, 7, 64][seed as usize % 4])));
        missing.has_less(&case.described());
    }
    missing.assert_none();
}

#[cfg(feature = "gpu")]
#[test]
fn oracle_and_gpu_agree_after_every_step_of_random_curves() {
    let Some(headless) = device::headless() else { return };
    let engine = burgeon::gpu::Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let cases = KEPT.into_iter().chain(GPU_SEEDS).map(oracle::curve_case);
    let cases = tier::covering(cases, &oracle::curve_features(), CurveCase::described);
    cases.iter().for_each(|case| agree(case, |p| p.on_gpu(&engine)));
}
