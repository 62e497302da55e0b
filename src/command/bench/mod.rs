//! `burgeon bench`: CPU and GPU side by side, against what their memory gives.
//!
//! All cases of a call run interleaved, round by round, after one warm-up round on buffers that
//! are used again; a figure is the median of its rounds. Bytes are counted, not measured: what the
//! case must read and write at least.

mod curves;
#[cfg(feature = "gpu")]
mod gpu;
#[cfg(not(feature = "gpu"))]
#[path = "no_gpu.rs"]
mod gpu;
mod kernels;
mod measured;
mod meshes;
mod patches;
mod report;
mod systems;
mod tessellation;
mod words;

use super::{Failure, flags, print};
use gpu::Adapter;
use kernels::{bandwidth_cases, flops_case, language_cases, scan_cases};
use patches::{derive_cases, step_cases};
use std::time::{Duration, Instant};
use systems::{Plans, roots};

/// The names a call may give.
const NAMES: [&str; 19] = [
    "copy",
    "expand",
    "flops",
    "patch/step",
    "patch/derive",
    "curve/derive",
    "curve/step",
    "curve/words",
    "word/context",
    "curve/stencil",
    "mesh/first",
    "mesh/frame",
    "mesh/levels",
    "mesh/limit",
    "scan",
    "compact",
    "tessellate",
    "tessellate/crowd",
    "language",
];

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

/// Threads of the CPU backend.
fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Runs `work` and says how long it took.
#[cfg_attr(not(feature = "gpu"), expect(dead_code))]
fn timed<E>(work: impl FnOnce() -> Result<(), E>, fail: impl Fn(E) -> Failure) -> Result<Duration, Failure> {
    let start = Instant::now();
    work().map_err(fail)?;
    Ok(start.elapsed())
}

/// A name, or what stands before its `/`.
fn asks_for(given: &str, name: &str) -> bool {
    name.strip_prefix(given).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Measures and prints.
pub fn bench(flags: &flags::Bench) -> Result<(), Failure> {
    for name in &flags.names {
        if !NAMES.iter().any(|n| asks_for(name, n)) {
            let list = NAMES.join(", ");
            return Err(Failure::Usage(format!("error: there is no bench `{name}`; there are {list}")));
        }
    }
    // The bandwidth is the yardstick of every other case, so it always runs.
    let wanted = |name: &str| {
        flags.names.is_empty()
            || flags.names.iter().any(|n| asks_for(n, name))
            || matches!(name, "copy" | "expand")
    };
    let roots = roots(flags.input.as_deref())?;
    let plans = Plans::new()?;
    let adapter = Adapter::open(flags.adapter.as_deref())?;
    let mut cases = Vec::new();
    bandwidth_cases(&mut cases);
    if wanted("patch/step") {
        step_cases(&plans, &mut cases)?;
    }
    if wanted("patch/derive") {
        derive_cases(&plans, &roots, flags.levels, &mut cases)?;
    }
    words::cpu_cases(&plans, &wanted, &mut cases)?;
    if wanted("curve/stencil") {
        curves::cpu_cases(&plans, &mut cases)?;
    }
    meshes::cpu_cases(&wanted, &mut cases)?;
    if wanted("scan") || wanted("compact") {
        scan_cases(&mut cases);
        cases.retain(|c| wanted(c.name));
    }
    // The crowd takes a minute and a gigabyte, so it must be asked for.
    let crowd = match flags.names.iter().any(|n| n == "tessellate/crowd") {
        true => tessellation::crowd(&roots),
        false => Vec::new(),
    };
    let tessellate = wanted("tessellate") || !crowd.is_empty();
    if tessellate {
        flops_case(&mut cases);
        tessellation::cpu_cases(&roots, &crowd, &mut cases)?;
    }
    let wanted = |name: &str| wanted(name) || (name == "tessellate" && tessellate);
    if wanted("language") {
        language_cases(&mut cases);
    }
    adapter.cases(&plans, &roots, &crowd, flags.levels, &wanted, &mut cases)?;
    for round in 0..=ROUNDS {
        for case in &mut cases {
            let time = (case.run)()?;
            if round > 0 {
                case.times.push(time);
            }
        }
    }
    print(&if flags.json { report::json(&adapter, &cases) } else { report::table(&adapter, &cases) })
}
