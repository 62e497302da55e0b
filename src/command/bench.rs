//! `burgeon bench`: CPU and GPU side by side, against what their memory gives.
//!
//! All cases of a call run interleaved, round by round, after one warm-up round on buffers that
//! are used again; a figure is the median of its rounds. Bytes are counted, not measured: what the
//! case must read and write at least.

use super::{Failure, flags, print};
use burgeon::language::Value;
use burgeon::language::check::compile;
use burgeon::language::expr::Expr;
use burgeon::language::vocabulary::Vocabulary;
use burgeon::patch::{self, Axiom, Net, Root};
use burgeon::plan::derive::{self, Backend, StageId};
use burgeon::plan::step::Clock;
use burgeon::plan::{Options, Plan};
use burgeon::{codegen, cpu};
use std::path::Path;
use std::time::{Duration, Instant};

/// The names a call may give.
const NAMES: [&str; 7] = ["copy", "expand", "patch/step", "patch/derive", "scan", "compact", "language"];

/// Counted rounds.
const ROUNDS: usize = 7;

/// One case: how it is run, and what it moves.
struct Case<'a> {
    name: &'static str,
    case: String,
    backend: &'static str,
    threads: usize,
    /// Bytes read and written at least; 0 where bytes are not the measure.
    bytes: u64,
    items: u64,
    run: Box<dyn FnMut() -> Result<Duration, Failure> + 'a>,
    times: Vec<Duration>,
}

impl Case<'_> {
    fn median(&self) -> f64 {
        let mut sorted = self.times.clone();
        sorted.sort_unstable();
        sorted.get(sorted.len() / 2).map_or(0.0, Duration::as_secs_f64)
    }
    fn least(&self) -> f64 {
        self.times.iter().min().map_or(0.0, Duration::as_secs_f64)
    }
    fn bytes_per_second(&self) -> f64 {
        self.bytes as f64 / self.median().max(1e-12)
    }
}

/// Runs `work` and says how long it took.
fn timed<E>(work: impl FnOnce() -> Result<(), E>, fail: impl Fn(E) -> Failure) -> Result<Duration, Failure> {
    let start = Instant::now();
    work().map_err(fail)?;
    Ok(start.elapsed())
}

/// Measures and prints.
pub fn bench(flags: &flags::Bench) -> Result<(), Failure> {
    for name in &flags.names {
        if !NAMES.contains(&name.as_str()) {
            let list = NAMES.join(", ");
            return Err(Failure::Usage(format!("error: there is no bench `{name}`; there are {list}")));
        }
    }
    // The bandwidth is the yardstick of every other case, so it always runs.
    let wanted = |name: &str| {
        flags.names.is_empty() || flags.names.iter().any(|n| n == name) || matches!(name, "copy" | "expand")
    };
    let roots = roots(flags.input.as_deref())?;
    let plans = Plans::new()?;
    let adapter = gpu::Adapter::open(flags.adapter.as_deref())?;
    let mut cases = Vec::new();
    bandwidth_cases(&mut cases);
    if wanted("patch/step") {
        step_cases(&plans, &mut cases)?;
    }
    if wanted("patch/derive") {
        derive_cases(&plans, &roots, flags.levels, &mut cases)?;
    }
    if wanted("scan") || wanted("compact") {
        scan_cases(&mut cases);
        cases.retain(|c| wanted(c.name));
    }
    if wanted("language") {
        language_cases(&mut cases);
    }
    adapter.cases(&plans, &roots, flags.levels, &wanted, &mut cases)?;
    for round in 0..=ROUNDS {
        for case in &mut cases {
            let time = (case.run)()?;
            if round > 0 {
                case.times.push(time);
            }
        }
    }
    print(&if flags.json { json(&adapter, &cases) } else { table(&adapter, &cases) })
}

/// The systems that are measured.
struct Plans {
    /// P -> [ P P ; P P ]
    plain: Plan,
    /// The same with a parameter and a condition: all passes run.
    conditional: Plan,
    levels: Plan,
    /// `plain` for other nets and with a query, each with what they are.
    others: Vec<(String, Plan)>,
    /// Only modules with a positive parameter stay on the frontier.
    frontier: Plan,
}

const PLAIN: &str = "system plain : patch bezier 3\nmodule P\naxiom: P = file \"roots.bpt\"\nrules:\n  \
                     P -> [ P P ; P P ]\nrun:\n  derive 1\n";
const CONDITIONAL: &str = "system conditional : patch bezier 3\nmodule P(l: int)\naxiom: P(0) = file \"roots.bpt\"\n\
     rules:\n  P(l) : l < 9 -> [ P(l+1) P(l+1) ; P(l+1) P(l+1) ]\nrun:\n  derive 1\n";

/// Flatness decides: the nets are read once more.
const QUERY: &str = "system flat : patch bezier 3\nmodule P(l: int)\nquery F(f: float) = flatness\naxiom: P(0) = file \"roots.bpt\"\n\
     rules:\n  ?F(f) P(l) : f > 0.0001 && l < 9 -> [ P(l+1) P(l+1) ; P(l+1) P(l+1) ]\nrun:\n  derive 1\n";
/// A module relabels itself until its parameter is 0, and its net is copied at each step.
const FRONTIER: &str = "system frontier : patch bezier 3\nmodule P(l: int)\naxiom: P(0) = file \"roots.bpt\"\n\
     rules:\n  P(l) : l > 0 -> P(l-1)\nrun:\n  derive 20\n";

/// Nets of other degrees, and those with weights: these move the same bytes.
const OTHERS: [&str; 6] = ["bezier 3 rational", "bezier 1", "bezier 2", "bezier 4", "bezier 8", "bezier 3 1"];

impl Plans {
    fn new() -> Result<Plans, Failure> {
        let levels = PLAIN.replace("derive 1", "derive 16");
        let nets = OTHERS.map(|nets| (format!("closed form, `{nets}`"), PLAIN.replace("bezier 3", nets)));
        let query = ("flatness query: all passes".to_string(), QUERY.to_string());
        let others = nets.into_iter().chain([query]).map(|(what, text)| Ok((what, plan(&text)?)));
        Ok(Plans {
            plain: plan(PLAIN)?,
            conditional: plan(CONDITIONAL)?,
            levels: plan(&levels)?,
            others: others.collect::<Result<_, Failure>>()?,
            frontier: plan(FRONTIER)?,
        })
    }
}

fn plan(text: &str) -> Result<Plan, Failure> {
    let checked = compile(text, &Vocabulary::default());
    let system = checked.systems.first();
    let system = system.ok_or_else(|| Failure::File("a bench's own system does not check".to_string()))?;
    Plan::new(system).map_err(|e| Failure::File(format!("error: {e}")))
}

/// 32 patches of a file, or as many made ones.
fn roots(input: Option<&Path>) -> Result<Vec<Net>, Failure> {
    let Some(path) = input else { return Ok(made(32, [3, 3], false)) };
    burgeon::io::read_nets(path, Default::default()).map_err(|e| Failure::File(format!("error: {e}")))
}

/// Hilly nets.
fn made(count: usize, degree: [u8; 2], rational: bool) -> Vec<Net> {
    let columns = degree[1] as usize + 1;
    let point = |net: usize, k: usize| {
        let (i, j) = ((k / columns) as f32, (k % columns) as f32);
        let height = ((net * 31 + k * 17) % 11) as f32 / 8.0;
        [i, height, j, if rational { 1.0 + height / 4.0 } else { 1.0 }]
    };
    let net = |n| Net { degree, points: (0..patch::net_points(degree)).map(|k| point(n, k)).collect() };
    (0..count).map(net).collect()
}

fn axiom(plan: &Plan, nets: &[Net]) -> Axiom {
    let args = match &plan.system.axiom {
        burgeon::language::system::Axiom::Patches(starts) => starts[0].args.clone(),
        _ => Vec::new(),
    };
    Axiom { roots: nets.iter().map(|net| Root { symbol: 0, args: args.clone(), net: net.clone() }).collect() }
}

/// vec4s that `copy` and `expand` read: 16 MiB, and 64 MiB for the copy of the same traffic.
const ELEMENTS: usize = 1 << 20;
/// Control points of `patch/step`, as nets of whatever degree: 65,536 bicubic ones.
const STEP_POINTS: usize = 1 << 20;
/// Elements of `scan` and `compact`.
const SCAN_ELEMENTS: usize = 1 << 24;

fn bandwidth_cases(cases: &mut Vec<Case>) {
    let threads = rayon_threads();
    let source = vec![[0.5f32; 4]; 4 * ELEMENTS];
    let mut out = vec![[1.0f32; 4]; 4 * ELEMENTS];
    let input = source.clone();
    cases.push(Case {
        name: "copy",
        case: "64 MiB".to_string(),
        backend: "cpu",
        threads,
        bytes: 2 * 64 * ELEMENTS as u64,
        items: 4 * ELEMENTS as u64,
        run: Box::new(move || infallible(|| cpu::copy::copy(&input, &mut out))),
        times: vec![],
    });
    let mut out = vec![[1.0f32; 4]; 4 * ELEMENTS];
    cases.push(Case {
        name: "expand",
        case: "16 MiB to 64 MiB".to_string(),
        backend: "cpu",
        threads,
        bytes: 80 * ELEMENTS as u64,
        items: ELEMENTS as u64,
        run: Box::new(move || infallible(|| cpu::expand::expand(&source[..ELEMENTS], &mut out))),
        times: vec![],
    });
}

fn infallible(work: impl FnOnce()) -> Result<Duration, Failure> {
    let start = Instant::now();
    work();
    Ok(start.elapsed())
}

fn rayon_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Bytes that a 2×2 step over `nets` modules must move.
fn step_bytes(plan: &Plan, nets: u64) -> u64 {
    let layout = plan.tables.layout;
    // What is measured is read from the nets, written, and read by match and emit.
    let row = plan.tables.rule_sets[0].stages[0].row.words as u64 * 4;
    let measured = if row > 0 { layout.net_bytes() + 3 * row } else { 0 };
    nets * (5 * layout.module_bytes() + measured)
}

/// Nets of the frontier's cases in all, and of the frontier.
const FRONTIER_NETS: usize = 1 << 16;
const FRONTIERS: [usize; 3] = [10_000, 20_000, 40_000];
const FRONTIER_STEPS: u32 = 20;

/// A derivation in which so many nets stay on the frontier to the end, and the others retire at once.
fn frontier_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    frontier: usize,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let mut roots = axiom(plan, &made(FRONTIER_NETS, [3, 3], false));
    for root in &mut roots.roots[..frontier] {
        let span = root.args[0].span;
        root.args[0] = Expr::literal(Value::Int(FRONTIER_STEPS as i32), span);
    }
    let uniforms = plan.uniforms(&[]).map_err(super::run::of_plan)?;
    // The first step is the one that sees all nets; the others are timed.
    let first = Options { steps: Some(1), max_bytes: u64::MAX, ..Options::default() };
    let whole = Options { steps: None, ..first.clone() };
    let run = move || {
        let mut time = |options: &Options| {
            let start = Instant::now();
            let derived = derive::derive(plan, &roots, &uniforms, options, &mut backend).map_err(fail)?;
            backend.finish().map_err(fail)?;
            let time = start.elapsed();
            derived.chunks.into_iter().for_each(|c| backend.recycle(c));
            Ok::<_, Failure>(time)
        };
        let one = time(&first)?;
        Ok(time(&whole)?.saturating_sub(one))
    };
    let moved = u64::from(FRONTIER_STEPS - 1) * frontier as u64;
    Ok(Case {
        name: "patch/derive",
        case: format!("frontier of {frontier} of {FRONTIER_NETS}, {} steps", FRONTIER_STEPS - 1),
        backend: label.0,
        threads: label.1,
        bytes: 2 * moved * plan.tables.layout.module_bytes(),
        items: moved,
        run: Box::new(run),
        times: vec![],
    })
}

/// A step over the same chunk again and again, its result recycled.
fn step_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    label: (&'static str, usize, &str),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let uniforms = plan.uniforms(&[]).map_err(super::run::of_plan)?;
    let layout = plan.tables.layout;
    let count = STEP_POINTS / layout.net_points();
    let nets = made(count, layout.degree, plan.rational());
    let (records, nets) = plan.axiom(&axiom(plan, &nets), &uniforms).map_err(super::run::of_plan)?;
    let chunk = backend.upload(records, nets).map_err(fail)?;
    let (backend_name, threads, what) = label;
    let id = StageId { rule_set: 0, stage: 0 };
    let run = move || {
        let start = Instant::now();
        let outcome = backend.step(id, Clock::default(), &chunk, u64::MAX).map_err(fail)?;
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        match outcome {
            derive::Outcome::Done { next: Some(next), .. } => backend.recycle(next),
            _ => return Err(Failure::Device("error: patch/step made no modules".to_string())),
        }
        Ok(time)
    };
    Ok(Case {
        name: "patch/step",
        case: format!("{count} nets, {what}"),
        backend: backend_name,
        threads,
        bytes: step_bytes(plan, count as u64),
        items: 4 * count as u64,
        run: Box::new(run),
        times: vec![],
    })
}

const PLAIN_CASE: &str = "closed form: emit only";
const CONDITIONAL_CASE: &str = "parameter and condition: all passes";

impl Plans {
    /// The systems of `patch/step`, with what they are.
    fn steps(&self) -> impl Iterator<Item = (&Plan, &str)> {
        let bicubic = [(&self.plain, PLAIN_CASE), (&self.conditional, CONDITIONAL_CASE)];
        bicubic.into_iter().chain(self.others.iter().map(|(what, plan)| (plan, what.as_str())))
    }
}

fn step_cases<'a>(plans: &'a Plans, cases: &mut Vec<Case<'a>>) -> Result<(), Failure> {
    let threads = rayon_threads();
    for (plan, what) in plans.steps() {
        let uniforms = plan.uniforms(&[]).map_err(super::run::of_plan)?;
        let backend = cpu::Cpu::new(plan, &uniforms, threads).map_err(super::run::of_plan)?;
        cases.push(step_case(plan, backend, ("cpu", threads, what), super::run::of_plan)?);
    }
    Ok(())
}

/// The whole derivation; and its last step alone, from the word before it.
fn derive_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    roots: &[Net],
    levels: u32,
    parts: usize,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let pieces: Vec<patch::Axiom> =
        roots.chunks(roots.len().div_ceil(parts).max(1)).map(|nets| axiom(plan, nets)).collect();
    let uniforms = plan.uniforms(&[]).map_err(super::run::of_plan)?;
    let modules: u64 = roots.len() as u64 * 4u64.pow(levels);
    let module = plan.tables.layout.module_bytes();
    // Every level is read once and written once, but for the first and the last.
    let bytes = (1..=levels).map(|l| 5 * roots.len() as u64 * 4u64.pow(l - 1) * module).sum();
    let run = move || {
        let options = Options { steps: Some(levels), max_bytes: u64::MAX, ..Options::default() };
        let start = Instant::now();
        let mut all = Vec::new();
        for piece in &pieces {
            all.push(derive::derive(plan, piece, &uniforms, &options, &mut backend).map_err(fail)?);
        }
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        all.into_iter().flat_map(|d| d.chunks).for_each(|c| backend.recycle(c));
        Ok(time)
    };
    let pieces = if parts == 1 { "one chunk".to_string() } else { format!("{parts} chunks") };
    Ok(Case {
        name: "patch/derive",
        case: format!("{} roots to depth {levels}, {pieces}", roots.len()),
        backend: label.0,
        threads: label.1,
        bytes,
        items: modules,
        run: Box::new(run),
        times: vec![],
    })
}

/// The last step of the derivation by itself.
fn last_step_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    roots: &[Net],
    levels: u32,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let uniforms = plan.uniforms(&[]).map_err(super::run::of_plan)?;
    let options = Options { steps: Some(levels - 1), max_bytes: u64::MAX, ..Options::default() };
    let before =
        derive::derive(plan, &axiom(plan, roots), &uniforms, &options, &mut backend).map_err(fail)?;
    let before_last = roots.len() as u64 * 4u64.pow(levels - 1);
    let run = move || {
        let start = Instant::now();
        let mut made = Vec::new();
        for chunk in &before.chunks {
            let id = StageId { rule_set: 0, stage: 0 };
            match backend.step(id, Clock::default(), chunk, u64::MAX).map_err(fail)? {
                derive::Outcome::Done { next: Some(next), .. } => made.push(next),
                _ => return Err(Failure::Device("error: patch/derive made no modules".to_string())),
            }
        }
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        made.into_iter().for_each(|c| backend.recycle(c));
        Ok(time)
    };
    Ok(Case {
        name: "patch/derive",
        case: format!("{} roots, step {levels} alone", roots.len()),
        backend: label.0,
        threads: label.1,
        bytes: step_bytes(plan, before_last),
        items: 4 * before_last,
        run: Box::new(run),
        times: vec![],
    })
}

fn derive_cases<'a>(
    plans: &'a Plans,
    roots: &[Net],
    levels: u32,
    cases: &mut Vec<Case<'a>>,
) -> Result<(), Failure> {
    let threads = rayon_threads();
    let plan = &plans.levels;
    let uniforms = plan.uniforms(&[]).map_err(super::run::of_plan)?;
    let backend = || cpu::Cpu::new(plan, &uniforms, threads).map_err(super::run::of_plan);
    let fail = super::run::of_plan;
    cases.push(derive_case(plan, backend()?, roots, levels, 1, ("cpu", threads), fail)?);
    cases.push(derive_case(plan, backend()?, roots, levels, 2, ("cpu", threads), fail)?);
    cases.push(last_step_case(plan, backend()?, roots, levels, ("cpu", threads), fail)?);
    let plan = &plans.frontier;
    for frontier in FRONTIERS {
        let backend = cpu::Cpu::new(plan, &[], threads).map_err(fail)?;
        cases.push(frontier_case(plan, backend, frontier, ("cpu", threads), fail)?);
    }
    Ok(())
}

fn scan_source() -> Vec<u32> {
    (0..SCAN_ELEMENTS as u32).map(|i| i.wrapping_mul(2_654_435_769) >> 30).collect()
}

fn scan_cases(cases: &mut Vec<Case>) {
    let (threads, n) = (rayon_threads(), SCAN_ELEMENTS as u64);
    let source = scan_source();
    let mut offsets = vec![0; SCAN_ELEMENTS + 1];
    let input = source.clone();
    cases.push(Case {
        name: "scan",
        case: format!("{n} u32"),
        backend: "cpu",
        threads,
        bytes: 12 * n,
        items: n,
        run: Box::new(move || infallible(|| cpu::scan::scan(&input, &mut offsets))),
        times: vec![],
    });
    let mut indices = Vec::new();
    let kept = source.iter().filter(|s| **s == 1).count() as u64;
    cases.push(Case {
        name: "compact",
        case: format!("{n} u32, a quarter kept"),
        backend: "cpu",
        threads,
        bytes: 8 * n + 4 * kept,
        items: n,
        run: Box::new(move || infallible(|| cpu::compact::compact(&source, 1, &mut indices))),
        times: vec![],
    });
}

/// Text to checked, linked and validated WGSL.
fn language_cases(cases: &mut Vec<Case>) {
    for (name, text) in [("plain", PLAIN), ("conditional", CONDITIONAL), ("sierpinski2", SIERPINSKI)] {
        let run = move || {
            let start = Instant::now();
            let plan = plan(text)?;
            let tuning = codegen::Tuning::CPU_DRIVER;
            let fail = |e: codegen::Error| Failure::Device(format!("error: {e}"));
            for stage in 0..plan.tables.rule_sets[0].stages.len() {
                codegen::stage(&plan, StageId { rule_set: 0, stage }, &tuning).map_err(fail)?;
            }
            codegen::shared(&plan.tables.layout, &tuning).map_err(fail)?;
            Ok(start.elapsed())
        };
        cases.push(Case {
            name: "language",
            case: format!("{name}: text to validated WGSL"),
            backend: "cpu",
            threads: 1,
            bytes: 0,
            items: text.len() as u64,
            run: Box::new(run),
            times: vec![],
        });
    }
}

const SIERPINSKI: &str = include_str!("../../examples/sierpinski2.burgeon");

fn of<'c, 'a>(cases: &'c [Case<'a>], name: &str, backend: &str) -> Option<&'c Case<'a>> {
    cases.iter().find(|c| c.name == name && c.backend == backend)
}

fn table(adapter: &gpu::Adapter, cases: &[Case]) -> String {
    let mut text = format!("{}; {} threads; medians of {ROUNDS} rounds\n\n", adapter.name(), rayon_threads());
    text.push_str(&format!(
        "{:13} {:44} {:7} {:>10} {:>8} {:>11} {:>8}\n",
        "name", "case", "backend", "ms", "GB/s", "M items/s", "of copy"
    ));
    for c in cases {
        let copy = of(cases, "copy", c.backend).map_or(0.0, Case::bytes_per_second);
        let (rate, share) = match c.bytes {
            0 => (String::new(), String::new()),
            _ => (
                format!("{:.2}", c.bytes_per_second() / 1e9),
                format!("{:.0} %", 100.0 * c.bytes_per_second() / copy.max(1.0)),
            ),
        };
        text.push_str(&format!(
            "{:13} {:44} {:7} {:>10.3} {:>8} {:>11.2} {:>8}\n",
            c.name,
            c.case,
            c.backend,
            c.median() * 1e3,
            rate,
            c.items as f64 / c.median().max(1e-12) / 1e6,
            share,
        ));
    }
    text
}

fn json(adapter: &gpu::Adapter, cases: &[Case]) -> String {
    let copy = |backend| of(cases, "copy", backend).map(|c| c.bytes_per_second() / 1e9);
    let results: Vec<_> = cases
        .iter()
        .map(|c| {
            serde_json::json!({
                "name": c.name, "case": c.case, "backend": c.backend, "threads": c.threads,
                "median_ms": c.median() * 1e3, "min_ms": c.least() * 1e3, "runs": c.times.len(),
                "bytes": c.bytes, "items": c.items,
            })
        })
        .collect();
    let all = serde_json::json!({
        "adapter": adapter.name(),
        "copy_gb_s": { "cpu": copy("cpu"), "gpu": copy("gpu") },
        "results": results,
    });
    format!("{all}\n")
}

/// The same cases on a device.
#[cfg(feature = "gpu")]
mod gpu {
    use super::*;
    use crate::command::run::of_gpu;
    use burgeon::codegen::{Mapping, Tuning};
    use burgeon::gpu::{Bandwidth, Engine, Gpu, Headless, Measure, Requirement, Scans};

    /// The device; none where there is no adapter, and then only the CPU is measured.
    pub struct Adapter(Option<Headless>);

    impl Adapter {
        pub fn open(name: Option<&str>) -> Result<Adapter, Failure> {
            match (Headless::new(name.map_or(Requirement::Any, Requirement::Named)), name) {
                (Ok(device), _) => Ok(Adapter(Some(device))),
                (Err(e), Some(_)) => Err(of_gpu(e)),
                (Err(e), None) => {
                    crate::command::say(&format!("the CPU only: {e}"));
                    Ok(Adapter(None))
                }
            }
        }

        pub fn name(&self) -> String {
            match &self.0 {
                Some(d) => format!("{} ({:?})", d.info.name, d.info.backend),
                None => "no adapter".to_string(),
            }
        }

        pub fn cases<'a>(
            &self,
            plans: &'a Plans,
            roots: &[Net],
            levels: u32,
            wanted: &dyn Fn(&str) -> bool,
            cases: &mut Vec<Case<'a>>,
        ) -> Result<(), Failure> {
            let Some(device) = &self.0 else { return Ok(()) };
            let engine = Engine::new(&device.device, &device.queue);
            bandwidth(&engine, cases)?;
            if wanted("patch/step") {
                for (plan, what) in plans.steps() {
                    cases.push(step_case(plan, backend(&engine, plan)?, ("gpu", 0, what), of_gpu)?);
                }
                let plan = &plans.plain;
                for (other, what) in other_mappings(&engine) {
                    cases.push(step_case(plan, backend(&other, plan)?, ("gpu", 0, what), of_gpu)?);
                }
            }
            if wanted("patch/derive") {
                let plan = &plans.levels;
                for parts in [1, 2] {
                    let backend = backend(&engine, plan)?;
                    cases.push(derive_case(plan, backend, roots, levels, parts, ("gpu", 0), of_gpu)?);
                }
                cases.push(last_step_case(plan, backend(&engine, plan)?, roots, levels, ("gpu", 0), of_gpu)?);
                for frontier in FRONTIERS {
                    let plan = &plans.frontier;
                    cases.push(frontier_case(plan, backend(&engine, plan)?, frontier, ("gpu", 0), of_gpu)?);
                }
            }
            scans(&engine, wanted, cases)
        }
    }

    /// The other mappings of emit, side by side with the one that is taken.
    fn other_mappings(engine: &Engine) -> Vec<(Engine, &'static str)> {
        let all = [
            (Mapping::NetPerInvocation, "closed form, net per invocation"),
            (Mapping::PointPerInvocation, "closed form, point per invocation"),
            (Mapping::LinePerInvocation, "closed form, line per invocation"),
        ];
        let others = all.into_iter().filter(|(mapping, _)| *mapping != engine.tuning().mapping);
        let with = |mapping| {
            let tuning = Tuning { mapping, ..*engine.tuning() };
            Engine::with_tuning(engine.device(), engine.queue(), tuning)
        };
        others.map(|(mapping, what)| (with(mapping), what)).collect()
    }

    fn backend<'a>(engine: &Engine, plan: &'a Plan) -> Result<Gpu<'a>, Failure> {
        let uniforms = plan.uniforms(&[]).map_err(crate::command::run::of_plan)?;
        let mut gpu = Gpu::new(engine, plan, &uniforms).map_err(of_gpu)?;
        gpu.compile().map_err(of_gpu)?;
        Ok(gpu)
    }

    fn bandwidth(engine: &Engine, cases: &mut Vec<Case>) -> Result<(), Failure> {
        let copy = Bandwidth::new(engine, 4 * ELEMENTS as u64, 1).map_err(of_gpu)?;
        cases.push(Case {
            name: "copy",
            case: "64 MiB".to_string(),
            backend: "gpu",
            threads: 0,
            bytes: 2 * 64 * ELEMENTS as u64,
            items: 4 * ELEMENTS as u64,
            run: Box::new(move || timed(|| copy.copy(), of_gpu)),
            times: vec![],
        });
        let expand = Bandwidth::new(engine, ELEMENTS as u64, 4).map_err(of_gpu)?;
        cases.push(Case {
            name: "expand",
            case: "16 MiB to 64 MiB".to_string(),
            backend: "gpu",
            threads: 0,
            bytes: 80 * ELEMENTS as u64,
            items: ELEMENTS as u64,
            run: Box::new(move || timed(|| expand.expand(), of_gpu)),
            times: vec![],
        });
        Ok(())
    }

    fn scans(engine: &Engine, wanted: &dyn Fn(&str) -> bool, cases: &mut Vec<Case>) -> Result<(), Failure> {
        let n = SCAN_ELEMENTS as u64;
        let source = scan_source();
        let kept = source.iter().filter(|s| **s == 1).count() as u64;
        for (name, what, bytes, case) in [
            ("scan", Measure::Scan, 12 * n, format!("{n} u32")),
            ("compact", Measure::Compact { wanted: 1 }, 8 * n + 4 * kept, format!("{n} u32, a quarter kept")),
        ] {
            if !wanted(name) {
                continue;
            }
            let scans = Scans::new(engine).map_err(of_gpu)?;
            let buffers = scans.prepare(what, &source).map_err(of_gpu)?;
            cases.push(Case {
                name,
                case,
                backend: "gpu",
                threads: 0,
                bytes,
                items: n,
                run: Box::new(move || timed(|| scans.run(what, &buffers), of_gpu)),
                times: vec![],
            });
        }
        Ok(())
    }
}

#[cfg(not(feature = "gpu"))]
mod gpu {
    use super::*;

    /// There is no device in this build.
    pub struct Adapter;

    impl Adapter {
        pub fn open(_: Option<&str>) -> Result<Adapter, Failure> {
            Ok(Adapter)
        }
        pub fn name(&self) -> String {
            "no adapter".to_string()
        }
        pub fn cases(
            &self,
            _: &Plans,
            _: &[Net],
            _: u32,
            _: &dyn Fn(&str) -> bool,
            _: &mut Vec<Case>,
        ) -> Result<(), Failure> {
            Ok(())
        }
    }
}
