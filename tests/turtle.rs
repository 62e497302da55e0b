//! The turtle: `trace into` on both backends, against the oracle, in chunks of any size, and its mutants.

mod accuracy;
mod linked;

use crate::oracle::Param;
use crate::oracle::curve::{self as oracle, Job, Seen, SeenModule, Tolerance, papers};
use burgeon::cpu::Cpu;
use burgeon::curve::{Axiom, Word};
use burgeon::language::System;
use burgeon::language::expr::Value;
use burgeon::plan::derive::{Backend, Options, collect, derive};
use burgeon::plan::{Plan, Unsupported};
use std::fmt::Debug;

#[cfg(feature = "gpu")]
use crate::{device, mutants};
#[cfg(feature = "gpu")]
use burgeon::gpu::{Engine, Gpu};

/// A job of the oracle's, as the engine takes it.
struct Run {
    plan: Plan,
    axiom: Axiom,
    options: Options<'static>,
    most: Option<usize>,
}

impl Run {
    fn new(job: &Job) -> Result<Run, Unsupported> {
        // The library takes the last system of a text.
        let text = match &job.system {
            None => job.text.clone(),
            Some(name) => {
                let end = job.text.find(&format!("system {name} ")).expect("the system");
                let next = job.text[end + 1..].find("\nsystem ");
                job.text[..next.map_or(job.text.len(), |n| end + 1 + n)].to_string()
            }
        };
        let system = System::parse(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let plan = Plan::new(&system)?;
        let point = |p: &Vec<f64>| {
            let mut point = [0.0, 0.0, 0.0, 1.0];
            point.iter_mut().zip(p).for_each(|(to, x)| *to = *x as f32);
            point
        };
        let points: Vec<[f32; 4]> = job.points.iter().map(point).collect();
        let axiom =
            Axiom::load::<String>(&system, &mut |_| Ok(vec![points.clone().into()])).expect("an axiom");
        // A job may set params of an earlier system.
        let has = |name: &str| system.uniforms.iter().any(|u| u.name == name);
        let set: Vec<(String, Value)> =
            job.set.iter().filter(|(name, _)| has(name)).map(|(name, p)| (name.clone(), value(p))).collect();
        let seed = job.seed;
        let options = Options { set, seed, ..Options::default() };
        Ok(Run { plan, axiom, options, most: job.steps })
    }

    fn cpu(&self) -> Cpu {
        Cpu::new(&self.plan, 2).expect("threads")
    }

    /// The word after so many steps, in chunks of at most so many modules.
    fn word<B: Backend>(&self, backend: &mut B, steps: usize, chunk: Option<usize>) -> Word
    where
        B::Error: Debug,
    {
        let steps = Some(self.most.map_or(steps, |most| most.min(steps)) as u32);
        let options = Options { steps, chunk_modules: chunk, ..self.options.clone() };
        let derivation = derive(&self.axiom, &options, backend).expect("a word");
        collect(backend, &derivation).expect("a word")
    }

    fn last<B: Backend>(&self, mut backend: B, chunk: Option<usize>) -> Word
    where
        B::Error: Debug,
    {
        self.word(&mut backend, 1_000_000, chunk)
    }

    fn seen(&self, word: &Word) -> Seen {
        let paths = self.plan.tables.layout.paths;
        let module = |(n, m): (usize, &burgeon::curve::Module)| SeenModule {
            symbol: word.symbols[m.symbol].name.clone(),
            params: word.params(n).iter().map(|value| param(&value)).collect(),
            link: None,
            path: paths.then_some([(m.path >> 32) as u32, m.path as u32]),
        };
        Seen { modules: word.modules.iter().enumerate().map(module).collect() }
    }

    /// The words after every step, as the oracle's checks want them.
    fn words<B: Backend>(&self, mut backend: B, chunk: Option<usize>) -> Vec<Seen>
    where
        B::Error: Debug,
    {
        let mut words = Vec::new();
        loop {
            let word = self.word(&mut backend, words.len(), chunk);
            if (word.steps as usize) < words.len() {
                return words;
            }
            words.push(self.seen(&word));
        }
    }
}

fn value(param: &Param) -> Value {
    match *param {
        Param::Int(i) => Value::Int(i),
        Param::Bool(b) => Value::Bool(b),
        Param::Float(x) => Value::Float(x as f32),
        Param::Vec2(v) => Value::Vec2(v.map(|x| x as f32)),
        Param::Vec3(v) => Value::Vec3(v.map(|x| x as f32)),
        Param::Vec4(v) => Value::Vec4(v.map(|x| x as f32)),
    }
}

fn param(value: &Value) -> Param {
    match *value {
        Value::Int(i) => Param::Int(i),
        Value::Bool(b) => Param::Bool(b),
        Value::Float(x) => Param::Float(x.into()),
        Value::Vec2(v) => Param::Vec2(v.map(f64::from)),
        Value::Vec3(v) => Param::Vec3(v.map(f64::from)),
        Value::Vec4(v) => Param::Vec4(v.map(f64::from)),
        Value::List(_) => unreachable!("modules hold no lists"),
    }
}

fn run(text: &str) -> Run {
    Run::new(&Job::new(text)).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

const KOLAM: &str = include_str!("data/language/kolam.burgeon");
const HILBERT3: &str = include_str!("data/language/hilbert3d.burgeon");

/// A system whose axiom is traced.
fn traced(topology: &str, module: &str, axiom: &str) -> String {
    format!("system s : curve {topology}\nmodule {module}, X\naxiom: {axiom}\nrun:\n  trace into P\n")
}

/// What the turtle can do, in short words: rings, open words, each turn, widths, no move at all.
fn small() -> Vec<String> {
    let all =
        "F(2) +(30) F &(17) f(0.5) ^(200) F /(33) F(1.5) \\(-61) -(45) F | F(3) X !(0.25) F +(725) F !(4) F";
    // Moves without a line begin a new curve: not yet.
    let all = all.replace("f(", "F(");
    let turns = ["+", "-", "&", "^", "/ + ", "\\ ^", "|", "+(12.5)", "-(-90) &", "+(180) ^", "+(-180) &"];
    let mut list: Vec<String> =
        turns.iter().map(|turn| traced("open", "P(v: vec3)", &format!("F(2) {turn} F + F"))).collect();
    for topology in ["open", "ring"] {
        for module in ["P(v: vec3, r: float)", "P(r: float, v: vec2)", "P(v: vec2)"] {
            list.push(traced(topology, module, &all));
        }
        list.push(traced(topology, "P(v: vec2)", "F + F + F + F"));
        list.push(traced(topology, "P(v: vec2, r: float)", "X !(3) + X"));
        list.push(traced(topology, "P(v: vec2)", "X"));
        list.push(traced(topology, "P(v: vec2)", "F"));
        // The word is gone, or has a point, or several, when it is traced.
        let erased = traced(topology, "P(v: vec3, r: float)", "X X X");
        list.push(erased.replace("run:\n", "rules:\n  X -> eps\nrun:\n  derive 1\n"));
        list.push(traced(topology, "P(v: vec2)", "F").replace("into P\n", "into P\n  trace into P\n"));
        let again = "rules:\n  P(v) -> F(2) +(40) P(v)\nrun:\n  trace into P\n  derive 2\n";
        list.push(traced(topology, "P(v: vec2)", "F + F + F + F").replace("run:\n", again));
        // Random numbers hang on paths, and traced points are roots.
        let drawn = "rules:\n  F -> (1) F + F -> (1) F - X F\n  P(v) : rand() < 0.5 -> P(v) P(v)\n  P(v) -> P(2 * v)\nrun:\n  derive 3\n";
        list.push(
            traced(topology, "P(v: vec2)", "F F F F")
                .replace("run:\n", drawn)
                .replace("into P\n", "into P\n  derive 2\n"),
        );
    }
    list
}

const NEAR: Tolerance = Tolerance::Near { c: 64.0 };

#[track_caller]
fn assert_as_the_oracle(job: &Job, words: &[Seen], of: &str) {
    let wanted = job.derive();
    assert_eq!(wanted.len(), words.len(), "{of}: {}", job.text);
    for (step, (oracle, engine)) in wanted.iter().zip(words).enumerate() {
        if let Err(e) = oracle::compare(oracle, engine, NEAR) {
            panic!("{of}, step {step}: {e}\n{}", job.text);
        }
    }
}

#[test]
fn the_oracle_traces_alike() {
    for text in small() {
        let run = run(&text);
        for chunk in [None, Some(1), Some(3), Some(7)] {
            let words = run.words(run.cpu(), chunk);
            assert_as_the_oracle(&Job::new(&text), &words, &format!("chunks of {chunk:?}"));
        }
    }
}

#[cfg(feature = "gpu")]
#[test]
fn devices_trace_as_the_oracle() {
    for (name, engine) in device::engines() {
        for text in small() {
            let run = run(&text);
            for chunk in [None, Some(3)] {
                let gpu = Gpu::new(&engine, &run.plan).expect("kernels");
                assert_as_the_oracle(&Job::new(&text), &run.words(gpu, chunk), &name);
            }
        }
    }
}

/// The numbers of the papers whose systems trace: S20, S22, Hilbert's curve in space.
fn papers_hold(derive: &dyn Fn(&Job) -> Vec<Seen>) {
    let backend = papers::Backend { derive, tolerance: 2e-6 };
    for (name, check) in papers::TRACED {
        println!("{name}");
        check(&backend);
    }
}

#[test]
fn s20_s22_the_papers_numbers_hold() {
    for chunk in [None, Some(64)] {
        papers_hold(&|job| {
            let run = Run::new(job).expect("a plan");
            run.words(run.cpu(), chunk)
        });
    }
}

#[cfg(feature = "gpu")]
#[test]
fn s20_s22_the_papers_numbers_hold_on_devices() {
    for (_, engine) in device::engines() {
        papers_hold(&|job| {
            let run = Run::new(job).expect("a plan");
            run.words(Gpu::new(&engine, &run.plan).expect("kernels"), None)
        });
    }
}

/// Right angles are traced without rounding, so to the bit in chunks of any size and on any device.
#[test]
fn right_angles_are_exact() {
    let dragon = include_str!("../examples/dragon.burgeon");
    for text in [dragon, include_str!("../examples/hilbert2.burgeon"), HILBERT3] {
        let run = run(text);
        let whole = run.last(run.cpu(), None);
        assert!(whole.points().iter().flatten().all(|x| x.fract() == 0.0), "{}", whole.system);
        for chunk in [7, 64] {
            assert_eq!(run.last(run.cpu(), Some(chunk)), whole, "{}, chunks of {chunk}", whole.system);
        }
        #[cfg(feature = "gpu")]
        for (name, engine) in device::engines() {
            let gpu = Gpu::new(&engine, &run.plan).expect("kernels");
            assert_eq!(run.last(gpu, Some(1000)), whole, "{}, {name}", whole.system);
        }
    }
}

/// CPU and GPU in lockstep: systems that trace, and where they differ.
#[cfg(feature = "gpu")]
fn difference(engine: &Engine) -> Option<String> {
    use burgeon::codegen::Tuning;
    use burgeon::plan::compare::Pair;
    // Tiles so small that states go from one to the next, and over more of them than a workgroup has invocations.
    let small_tiles = engine.retuned(Tuning { scan_workgroup: 4, scan_items: 32, ..*engine.tuning() });
    let long = KOLAM.replace("derive 3", "derive 1");
    let widths = traced("open", "P(v: vec3, r: float)", "F")
        .replace("run:\n", "rules:\n  F(s) -> !(s) F(s/2) +(20) X &(35) F(s) /(15) F(s)\nrun:\n  derive 5\n");
    let angles = small();
    let first =
        [HILBERT3, long.as_str(), widths.as_str()].into_iter().chain(angles.iter().map(String::as_str));
    for text in first {
        let run = run(text);
        let chunks: &[Option<usize>] = if text.len() > 300 { &[None, Some(500)] } else { &[None] };
        for &chunk in chunks {
            let gpu = match Gpu::new(&small_tiles, &run.plan) {
                Ok(gpu) => gpu,
                Err(e) => return Some(e.to_string()),
            };
            let mut pair = Pair::new(run.cpu(), gpu, ["CPU", "GPU"]);
            let options = Options { chunk_modules: chunk, ..run.options.clone() };
            if let Err(e) = derive(&run.axiom, &options, &mut pair) {
                return Some(format!("{}: {e}", run.plan.system.name));
            }
        }
    }
    linked::difference(engine)
}

#[cfg(feature = "gpu")]
#[test]
fn devices_trace_as_the_cpu_pass_by_pass() {
    for (name, engine) in device::engines() {
        assert_eq!(difference(&engine), None, "{name}");
    }
}

#[cfg(feature = "gpu")]
const MUTANTS: &[mutants::Mutant] = &[
    (
        "turtle",
        "motion = then_module(motion, read_record(i))",
        "motion = then_module(motion, read_record(start))",
    ),
    ("compositions", "composed(before, partial[local])", "composed(partial[local], before)"),
    ("compositions", "distance = distance << 1u", "distance = distance << 2u"),
    ("compositions", "return partial[local - 1u];", "return partial[local];"),
    ("turtle", "return still();", "return carried[0];"),
    ("compositions", "element = composed(element, kept(t))", "element = kept(t)"),
    ("turtle", "if extent.before > 0u", "if false"),
    ("compositions", "state = composed(state, here)", "state = here"),
    ("compositions", "leave(composed(first, inclusive))", "leave(inclusive)"),
    ("turtle", "var state = composed(motions[own.tile], before)", "var state = motions[own.tile]"),
    ("turtle", "if BEFORE", "if !BEFORE"),
    ("motion", "return r * 0.5", "return r * vec4f(0.5, 0.5, 0.5, 1.0)"),
    ("motion", "drawn = first.drawn", "drawn = UNSET"),
    ("motion", "drawn = first.width", "drawn = INHERITED"),
    ("motion", "select(motion.width, INHERITED,", "select(motion.width, UNSET,"),
    ("motion", "- q.z * p.y", "+ q.z * p.y"),
    ("motion", "- q.y * p.y - q.z * p.z", "- q.y * p.y + q.z * p.z"),
    ("motion", "+ v * q.w", "- v * q.w"),
    ("motion", "1.0 - (q.x * q.x + q.z * q.z)", "1.0 - (q.x * q.x + q.y * q.y)"),
    ("motion", "(q.w * q.x + q.y * q.z)", "(q.w * q.x - q.y * q.z)"),
    ("motion", "select(next.width, first.width,", "select(first.width, next.width,"),
    ("motion", "degrees - 360.0 *", "degrees - 270.0 *"),
    ("motion", "vec2f(1.0, select(1.0, -1.0,", "vec2f(1.0, select(1.0, 1.0,"),
    ("motion", "return vec2f(0.0, 1.0)", "return vec2f(1.0, 0.0)"),
    ("motion", "rest * 0.008726646", "rest * 0.0087"),
    ("motion", "(command & 1u) == 1u", "(command & 2u) == 2u"),
    ("motion", "half.y, axis == 1u", "half.y, axis == 2u"),
    ("motion", "0x3f800000u", "0u"),
    ("turtle_linked", "& 0x7fffffffu", "& 0xffffffffu"),
    ("turtle_linked", "parent < i)", "parent <= i)"),
    ("turtle_linked", "composed(motions[here + link], motions[here + i])", "motions[here + i]"),
    ("turtle_linked", "links[there + i] = links[here + link]", "links[there + i] = NOWHERE"),
    ("turtle_linked", "follow(i, extent.count, 0u)", "follow(i, 0u, extent.count)"),
    ("turtle_linked", "if !BEFORE", "if BEFORE"),
    ("turtle_linked", "write_row(i, motions[parent])", "write_row(i, motions[i])"),
];

#[cfg(feature = "gpu")]
#[test]
fn every_mutant_of_the_turtle_is_seen() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let sample = mutants::sample(MUTANTS);
    mutants::assert_seen(sample.iter().filter_map(|&mutant| mutants::unseen(&engine, mutant, difference)));
}

/// A plan whose modules have links, and are traced.
pub fn linked_plan() -> Plan {
    linked::linked_plan(false)
}

/// How many mutants of a file are here.
#[cfg(feature = "gpu")]
pub fn mutants_of(file: &str) -> usize {
    MUTANTS.iter().filter(|m| m.0 == file).count()
}
