//! Curve systems on both backends against the naive oracle: the papers' numbers, and random systems.

use crate::oracle::curve::papers::{self, Backend};
use crate::oracle::curve::{self, Job, Link, Seen, SeenModule, Tolerance};
use crate::oracle::{Param, curve_case};
use burgeon::cpu::Cpu;
use burgeon::curve::{Axiom, Word};
use burgeon::language::system::Topology;
use burgeon::language::{System, Value, Vocabulary, compile};
use burgeon::plan::derive::{self, collect_curve};
use burgeon::plan::{Error, Options, Plan};

/// A job of the oracle as the engine takes it.
struct Engine {
    plan: Plan,
    axiom: Axiom,
    uniforms: Vec<Value>,
    options: Options<'static>,
}

fn value(param: &Param) -> Value {
    let narrow = |x: &f64| *x as f32;
    match param {
        Param::Int(i) => Value::Int(*i),
        Param::Bool(b) => Value::Bool(*b),
        Param::Float(x) => Value::Float(*x as f32),
        Param::Vec2(v) => Value::Vec2(v.each_ref().map(narrow)),
        Param::Vec3(v) => Value::Vec3(v.each_ref().map(narrow)),
        Param::Vec4(v) => Value::Vec4(v.each_ref().map(narrow)),
    }
}

fn param(value: &Value) -> Param {
    match value {
        Value::Int(i) => Param::Int(*i),
        Value::Bool(b) => Param::Bool(*b),
        Value::Float(x) => Param::Float(f64::from(*x)),
        Value::Vec2(v) => Param::Vec2(v.map(f64::from)),
        Value::Vec3(v) => Param::Vec3(v.map(f64::from)),
        Value::Vec4(v) => Param::Vec4(v.map(f64::from)),
        Value::List(_) => panic!("no field is a list"),
    }
}

fn seen(word: &Word, paths: bool) -> Seen {
    let ring = word.topology == Topology::Ring;
    let module = |m: &burgeon::curve::Module| SeenModule {
        symbol: word.symbols[m.symbol].name.clone(),
        params: m.params.iter().map(param).collect(),
        link: (!ring).then_some(Link { parent: m.parent, lateral: m.lateral }),
        path: paths.then_some([(m.path >> 32) as u32, m.path as u32]),
    };
    Seen { modules: word.modules.iter().map(module).collect() }
}

impl Engine {
    fn new(job: &Job) -> Engine {
        let checked = compile(&job.text, &Vocabulary::default());
        let systems = &checked.systems;
        assert!(!systems.is_empty(), "{:?}\n{}", checked.diagnostics, job.text);
        let wanted = |s: &&System| job.system.as_ref().is_none_or(|name| *name == s.name);
        let system = systems.iter().rfind(wanted).expect("the system");
        let plan = Plan::new(system).unwrap_or_else(|e| panic!("{e}\n{}", job.text));
        let coordinate = |p: &[f64], n: usize| p.get(n).map_or(if n == 3 { 1.0 } else { 0.0 }, |x| *x as f32);
        let points: Vec<[f32; 4]> =
            job.points.iter().map(|p| std::array::from_fn(|n| coordinate(p, n))).collect();
        let axiom = Axiom::load::<String>(system, &mut |_| Ok(vec![points.clone()])).expect("an axiom");
        // What stands above the system and is not used by it is no param of its own.
        let known = |name: &String| system.uniforms.iter().any(|u| u.name == *name);
        let set = job.set.iter().filter(|(name, _)| known(name));
        let set: Vec<_> = set.map(|(name, p)| (name.clone(), value(p))).collect();
        let uniforms = plan.uniforms(&set).unwrap_or_else(|e| panic!("{e}\n{}", job.text));
        let seed = job.seed.unwrap_or_else(|| plan.seed(&set));
        let steps = job.steps.map(|n| n as u32);
        Engine { plan, axiom, uniforms, options: Options { set, seed, steps, ..Options::default() } }
    }

    /// The word after every step, the axiom first.
    fn words<B: derive::Backend>(
        &self,
        backend: &mut B,
        chunk: Option<usize>,
    ) -> Result<Vec<Seen>, B::Error> {
        let mut words = Vec::new();
        loop {
            let steps = words.len() as u32;
            if self.options.steps.is_some_and(|most| steps > most) {
                return Ok(words);
            }
            let options = Options { steps: Some(steps), chunk_modules: chunk, ..self.options.clone() };
            let derivation = derive::derive(&self.plan, &self.axiom, &self.uniforms, &options, backend)?;
            if derivation.steps.len() < steps as usize {
                return Ok(words);
            }
            let word = collect_curve(&self.plan, backend, &derivation)?;
            words.push(seen(&word, self.plan.tables.layout.has_paths()));
            derivation.chunks.into_iter().for_each(|chunk| backend.recycle(chunk));
        }
    }

    fn on_cpu(&self, chunk: Option<usize>) -> Result<Vec<Seen>, Error> {
        let mut cpu = Cpu::new(&self.plan, &self.uniforms, 2)?;
        self.words(&mut cpu, chunk)
    }

    #[cfg(feature = "gpu")]
    fn on_gpu(&self, engine: &burgeon::gpu::Engine) -> Vec<Seen> {
        let mut gpu = burgeon::gpu::Gpu::new(engine, &self.plan, &self.uniforms).expect("kernels");
        self.words(&mut gpu, None).unwrap_or_else(|e| panic!("{e}"))
    }
}

/// How far a coordinate of size 1 may be off in f32, over the papers' few steps.
const TOLERANCE: f64 = 1e-5;

fn every_paper(derive: &dyn Fn(&Job) -> Vec<Seen>, lists: &[&[(&str, fn(&Backend))]]) {
    let backend = Backend { derive, tolerance: TOLERANCE };
    lists.iter().copied().flatten().for_each(|(_, check)| check(&backend));
}

const ALL: &[&[(&str, fn(&Backend))]] = &[papers::LINES, papers::TRACED, papers::TREES];

#[test]
fn the_papers_numbers_on_the_cpu() {
    every_paper(&|job| Engine::new(job).on_cpu(None).unwrap_or_else(|e| panic!("{e}")), ALL);
}

#[cfg(feature = "gpu")]
#[test]
fn the_papers_numbers_on_the_gpu() {
    let Some(headless) = crate::device::headless() else { return };
    let engine = burgeon::gpu::Engine::new(&headless.device, &headless.queue);
    every_paper(&|job| Engine::new(job).on_gpu(&engine), ALL);
}

/// What the oracle and the engine make of a case, where the engine derives it.
fn differs(number: u64, derive: &dyn Fn(&Engine) -> Vec<Seen>) -> Result<(), String> {
    let case = curve_case(number);
    let (engine, words) = (Engine::new(&case.job), case.job.derive());
    let theirs = derive(&engine);
    if words.len() != theirs.len() {
        return Err(format!("{} words of the oracle, {} of the engine\n{case}", words.len(), theirs.len()));
    }
    let tolerance = if case.exact { Tolerance::Exact } else { Tolerance::Near { c: 64.0 } };
    for (step, (word, seen)) in words.iter().zip(&theirs).enumerate() {
        curve::compare(word, seen, tolerance).map_err(|e| format!("step {step}: {e}\n{case}"))?;
    }
    Ok(())
}

fn random_systems(numbers: std::ops::Range<u64>, derive: &dyn Fn(&Engine) -> Vec<Seen>) {
    numbers.for_each(|number| differs(number, derive).unwrap_or_else(|e| panic!("{e}")));
}

#[test]
fn random_curve_systems_on_the_cpu() {
    random_systems(0..300, &|engine| engine.on_cpu(None).unwrap_or_else(|e| panic!("{e}")));
}

#[test]
fn chunks_of_random_curve_systems_are_not_seen() {
    for chunk in [1, 7, 64] {
        random_systems(300..340, &|engine| engine.on_cpu(Some(chunk)).unwrap_or_else(|e| panic!("{e}")));
    }
}

#[cfg(feature = "gpu")]
#[test]
fn random_curve_systems_on_the_gpu() {
    let Some(headless) = crate::device::headless() else { return };
    let device = burgeon::gpu::Engine::new(&headless.device, &headless.queue);
    random_systems(0..40, &|engine| engine.on_gpu(&device));
}
