//! `burgeon run`.

use super::load::{self, Job, size};
use super::progress::Bar;
use super::source::Loaded;
use super::tessellate::{self, Work};
use super::{Failure, counted, flags, kinds, output, say, stop};
use burgeon::cpu::Cpu;
use burgeon::language::system::Kind;
use burgeon::patch::{self, Net};
use burgeon::plan::derive::{self, StepStats};
use burgeon::plan::{self, Options, Plan, Progress, holes};
use std::time::Instant;

/// Derives and writes. The file is read and compiled once, and what is wrong with it comes before any flag.
pub fn run(flags: &flags::Run) -> Result<(), Failure> {
    let start = Instant::now();
    let loaded = Loaded::read(&flags.derive.system)?;
    match loaded.system.kind {
        Kind::Curve(_) => super::curve::run(flags, loaded, start),
        Kind::Patch { .. } | Kind::Mesh => patches(flags, loaded, start),
    }
}

fn patches(flags: &flags::Run, loaded: Loaded, start: Instant) -> Result<(), Failure> {
    let watertight = flags.fineness.tolerance.is_some();
    // A mesh needs to know where holes are.
    let plan = loaded.plan(if watertight { Plan::keeping_holes } else { Plan::new })?;
    kinds::check_run(flags, &loaded.system)?;
    let targets = output::targets(&flags.out, flags.format, &output::PATCHES)?;
    if let (false, Some(flag)) = (watertight, tessellate::depth_flag(&flags.fineness)) {
        return Err(Failure::Usage(format!(
            "error: {flag} is for the mesh that --tolerance makes; give both"
        )));
    }
    let job = load::job(loaded, plan, &flags.derive)?;
    job.say_notes();
    if let (false, Some(placement)) = (watertight, &job.plan.placement) {
        say(&format!(
            "note: `place {}` displaces the mesh that --tolerance makes; without it nothing is displaced",
            placement.name
        ));
    }
    let nets: Vec<Net> = if watertight { job.nets() } else { Vec::new() };
    let level = tessellate::level(&flags.fineness, &flags.derive.view, flags.drawing.up, &nets)?;
    stop::watch();
    let bar = Bar::new();
    let progress = |p: Progress| bar.step(p);
    let options = options(&flags.derive, &job, &progress);
    let mut derived = derive(flags, &job, &options, &bar)?;
    let device = derived.device.as_ref();
    let mut surface = watertight.then(|| {
        let hole = job.plan.hole;
        let placement = Some((&job.plan, &options));
        let work = Work { nets: &nets, word: Some((&derived.word, hole)), placement, level: &level };
        tessellate::make(&work, device, &flags.derive.machine, &bar)
    });
    if let Some(hole) = job.plan.hole {
        derived.word = holes::dropped(&derived.word, hole);
    }
    let word = &derived.word;
    let shape = match &mut surface {
        Some(Ok(surface)) => Ok(tessellate::shape(surface, flags.by_symbol, &targets)),
        Some(Err(why)) => Err(why.clone()),
        None if output::need_mesh(&targets) => {
            output::diced(word, flags.grid, flags.by_symbol, options.max_bytes, &bar)
        }
        None => Ok(output::Shape::default()),
    };
    let look =
        output::Look { drawing: &flags.drawing, device, adapter: flags.derive.machine.adapter.as_deref() };
    let written = output::write(&targets, word, &shape, &look, &bar);
    bar.clear();
    written?;
    let surface = surface.and_then(Result::ok);
    if flags.stats {
        return output::report(&targets, &stats(&derived, surface.as_ref(), start).to_string());
    }
    let (steps, modules) = (word.steps as u64, word.modules.len() as u64);
    let mesh = surface.map_or(String::new(), |surface| format!(", {}", surface.counts()));
    let (steps, modules) = (counted(steps, "step"), counted(modules, "module"));
    output::report(&targets, &format!("{}: {steps}, {modules}{mesh}", word.system))
}

/// How the library is to run.
pub fn options<'a>(flags: &flags::Derive, job: &Job, progress: &'a dyn Fn(Progress)) -> Options<'a> {
    Options {
        set: job.set.clone(),
        bind: job.bind.clone(),
        view: job.view,
        seed: flags.seed,
        steps: flags.steps,
        max_bytes: flags.machine.max_memory.unwrap_or_else(load::half_of_memory),
        chunk_modules: None,
        stop: Some(&stop::STOP),
        progress: Some(progress),
    }
}

/// A word, and how it came about.
struct Derived {
    word: patch::Word,
    backend: &'static str,
    adapter: String,
    compile_ms: f64,
    steps: Vec<StepStats>,
    peak_bytes: u64,
    device: Option<Device>,
}

#[cfg(feature = "gpu")]
pub use burgeon::gpu::Headless as Device;
#[cfg(not(feature = "gpu"))]
pub enum Device {}

fn derive(flags: &flags::Run, job: &Job, options: &Options, bar: &Bar) -> Result<Derived, Failure> {
    match device(flags.backend, &flags.derive.machine, bar)? {
        #[cfg(feature = "gpu")]
        Some(device) => on_gpu(job, options, device, bar),
        #[cfg(not(feature = "gpu"))]
        Some(device) => match device {},
        None => {
            bar.doing("deriving");
            on_cpu(job, options, flags.derive.machine.threads as usize)
        }
    }
}

/// The device that the flags ask for; none for the CPU backend. Which it is, is said where it was not asked for.
#[cfg(feature = "gpu")]
pub fn device(
    backend: flags::Backend,
    machine: &flags::Machine,
    bar: &Bar,
) -> Result<Option<Device>, Failure> {
    use burgeon::gpu::Requirement;
    let requirement = match (backend, machine.adapter.as_deref()) {
        (flags::Backend::Cpu, _) => return Ok(None),
        (_, Some(name)) => Requirement::Named(name),
        (flags::Backend::Gpu, None) => Requirement::Any,
        (flags::Backend::Auto, None) => Requirement::Hardware,
    };
    match (Device::new(requirement), requirement) {
        (Ok(device), _) => {
            bar.say(&format!("note: on {}", super::devices::label(&device.info)));
            Ok(Some(device))
        }
        (Err(e), Requirement::Hardware) => {
            bar.say(&format!("note: on the CPU: {e}"));
            Ok(None)
        }
        (Err(e), _) => Err(Failure::Device(format!("error: {e}"))),
    }
}

#[cfg(not(feature = "gpu"))]
pub fn device(backend: flags::Backend, _: &flags::Machine, _: &Bar) -> Result<Option<Device>, Failure> {
    match backend {
        flags::Backend::Gpu => {
            Err(Failure::Device("error: this burgeon was built without the feature gpu".to_string()))
        }
        _ => Ok(None),
    }
}

#[cfg(feature = "gpu")]
fn on_gpu(job: &Job, options: &Options, device: Device, bar: &Bar) -> Result<Derived, Failure> {
    use burgeon::gpu::{Engine, Gpu};
    let engine = Engine::new(&device.device, &device.queue);
    let failure = |e| match e {
        burgeon::gpu::Error::Plan(e) => job.failure(e),
        e => of_gpu(e),
    };
    bar.doing("compiling kernels");
    let start = Instant::now();
    let mut gpu = Gpu::new(&engine, &job.plan).map_err(failure)?;
    gpu.compile().map_err(failure)?;
    let compile_ms = milliseconds(start);
    bar.doing("deriving");
    let derivation = derive::derive(job.axiom.patches().map_err(|e| job.failure(e))?, options, &mut gpu)
        .map_err(failure)?;
    let word = derive::collect(&mut gpu, &derivation).map_err(failure)?;
    drop(gpu);
    Ok(Derived {
        word,
        backend: "gpu",
        adapter: device.info.name.clone(),
        compile_ms,
        steps: derivation.steps,
        peak_bytes: derivation.peak_bytes,
        device: Some(device),
    })
}

fn on_cpu(job: &Job, options: &Options, threads: usize) -> Result<Derived, Failure> {
    let mut cpu = cpu(job, threads)?;
    let failure = |e| job.failure(e);
    let derivation = derive::derive(job.axiom.patches().map_err(|e| job.failure(e))?, options, &mut cpu)
        .map_err(failure)?;
    let word = derive::collect(&mut cpu, &derivation).map_err(failure)?;
    Ok(Derived {
        word,
        backend: "cpu",
        adapter: "CPU".to_string(),
        compile_ms: 0.0,
        steps: derivation.steps,
        peak_bytes: derivation.peak_bytes,
        device: None,
    })
}

/// The CPU backend of a job. Threads are all that it can lack.
pub fn cpu(job: &Job, threads: usize) -> Result<Cpu, Failure> {
    Cpu::new(&job.plan, threads).map_err(|e| Failure::Device(format!("error: {e}")))
}

/// An error of the plan by whose fault it is.
pub fn of_plan(e: plan::Error) -> Failure {
    let text = format!("error: {e}");
    match e {
        plan::Error::Set(_) => Failure::Usage(text),
        plan::Error::Bind(_) => {
            Failure::Usage(format!("{text}\nhelp: --bind QUERY=FILE binds a query's values"))
        }
        plan::Error::View { .. } => {
            Failure::Usage(format!("{text}\nhelp: --eye X,Y,Z says where the viewer stands"))
        }
        plan::Error::Memory { needed, modules, step, budget } => {
            let who = if step == 0 { "the axiom alone".to_string() } else { format!("step {step}") };
            let help = if step == 0 { "raise" } else { "derive fewer steps (--steps, --set) or raise" };
            let (modules, needed, budget) = (counted(modules, "module"), size(needed), size(budget));
            let what = format!("{who} needs at least {needed} for {modules}; the memory budget is {budget}");
            Failure::Device(format!("error: {what}\nhelp: {help} --max-memory"))
        }
        plan::Error::TooDeep { .. } | plan::Error::TooLong { .. } => {
            Failure::Device(format!("{text}\nhelp: derive fewer steps (--steps)"))
        }
        plan::Error::Stopped { steps } => {
            let steps = counted(steps as u64, "step");
            Failure::Stopped(format!("error: stopped by Ctrl-C after {steps}; nothing was written"))
        }
        plan::Error::Unsupported(_)
        | plan::Error::Value(_)
        | plan::Error::Axiom(_)
        | plan::Error::Endless { .. } => Failure::File(text),
    }
}

/// An error of the engine by whose fault it is.
#[cfg(feature = "gpu")]
pub fn of_gpu(e: burgeon::gpu::Error) -> Failure {
    match e {
        burgeon::gpu::Error::Plan(e) => of_plan(e),
        e => Failure::Device(format!("error: {e}")),
    }
}

pub fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn stats(derived: &Derived, surface: Option<&tessellate::Surface>, start: Instant) -> serde_json::Value {
    let steps: Vec<_> = derived
        .steps
        .iter()
        .map(|s| serde_json::json!({ "modules": s.modules, "ms": s.time.as_secs_f64() * 1e3 }))
        .collect();
    let mut stats = serde_json::json!({
        "backend": derived.backend,
        "adapter": derived.adapter,
        "compile_ms": derived.compile_ms,
        "steps": steps,
        "total_ms": milliseconds(start),
        "peak_bytes": derived.peak_bytes,
    });
    if let Some(surface) = surface {
        stats["vertices"] = surface.vertices().into();
        stats["triangles"] = surface.triangles().into();
        stats["tessellate_ms"] = surface.ms.into();
    }
    stats
}
