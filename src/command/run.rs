//! `burgeon run`.

use super::load::{self, Job, size};
use super::progress::Bar;
use super::source::Loaded;
use super::tessellate;
use super::{Failure, counted, flags, kinds, output, say, stop};
use burgeon::cpu::Cpu;
use burgeon::language::system::Kind;
use burgeon::patch::{self, Net};
use burgeon::plan::derive::{self, Backend, StepStats};
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
    let job = load::job(loaded, plan, &flags.derive, false)?;
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
    let axiom = job.axiom.patches().map_err(|e| job.failure(e))?;
    let mut derived = derive(flags, &job, &OfPatches { axiom, options: &options }, &bar)?;
    let device = derived.device.as_ref();
    let mut surface = watertight.then(|| {
        let hole = job.plan.hole;
        let placement = Some((&job.plan, &options));
        let work =
            tessellate::Work { nets: &nets, word: Some((&derived.made, hole)), placement, level: &level };
        tessellate::make(&work, device, &flags.derive.machine, &bar)
    });
    if let Some(hole) = job.plan.hole {
        derived.made = holes::dropped(&derived.made, hole);
    }
    let word = &derived.made;
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

/// What a backend derives.
pub trait Work {
    type Made;

    /// What is made, the steps, and the most bytes that the word took.
    fn run<B: Backend>(&self, backend: &mut B) -> Result<(Self::Made, Vec<StepStats>, u64), B::Error>;
}

struct OfPatches<'a> {
    axiom: &'a patch::Axiom,
    options: &'a Options<'a>,
}

impl Work for OfPatches<'_> {
    type Made = patch::Word;

    fn run<B: Backend>(&self, backend: &mut B) -> Result<(patch::Word, Vec<StepStats>, u64), B::Error> {
        let derivation = derive::derive(self.axiom, self.options, backend)?;
        let word = derive::collect(backend, &derivation)?;
        Ok((word, derivation.steps, derivation.peak_bytes))
    }
}

/// What was made, and how it came about.
pub struct Derived<M> {
    pub made: M,
    pub steps: Vec<StepStats>,
    backend: &'static str,
    adapter: String,
    compile_ms: f64,
    peak_bytes: u64,
    pub device: Option<Device>,
}

impl<M> Derived<M> {
    /// What `--stats` says of every derivation.
    pub fn stats(&self, start: Instant) -> serde_json::Value {
        let step =
            |s: &StepStats| serde_json::json!({ "modules": s.modules, "ms": s.time.as_secs_f64() * 1e3 });
        serde_json::json!({
            "backend": self.backend,
            "adapter": self.adapter,
            "compile_ms": self.compile_ms,
            "steps": self.steps.iter().map(step).collect::<Vec<_>>(),
            "total_ms": milliseconds(start),
            "peak_bytes": self.peak_bytes,
        })
    }
}

#[cfg(feature = "gpu")]
pub use burgeon::gpu::Headless as Device;
#[cfg(not(feature = "gpu"))]
pub enum Device {}

/// Derives where the flags say.
pub fn derive<W: Work>(
    flags: &flags::Run,
    job: &Job,
    work: &W,
    bar: &Bar,
) -> Result<Derived<W::Made>, Failure> {
    match device(flags.backend, &flags.derive.machine, bar)? {
        #[cfg(feature = "gpu")]
        Some(device) => on_gpu(job, work, device, bar),
        #[cfg(not(feature = "gpu"))]
        Some(device) => match device {},
        None => {
            bar.doing("deriving");
            let mut cpu = cpu(job, flags.derive.machine.threads as usize)?;
            let (made, steps, peak_bytes) = work.run(&mut cpu).map_err(|e| job.failure(e))?;
            let adapter = "CPU".to_string();
            Ok(Derived { made, steps, backend: "cpu", adapter, compile_ms: 0.0, peak_bytes, device: None })
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
fn on_gpu<W: Work>(job: &Job, work: &W, device: Device, bar: &Bar) -> Result<Derived<W::Made>, Failure> {
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
    let (made, steps, peak_bytes) = work.run(&mut gpu).map_err(failure)?;
    drop(gpu);
    let adapter = device.info.name.clone();
    Ok(Derived { made, steps, backend: "gpu", adapter, compile_ms, peak_bytes, device: Some(device) })
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
        | plan::Error::Value(..)
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

fn stats(
    derived: &Derived<patch::Word>,
    surface: Option<&tessellate::Surface>,
    start: Instant,
) -> serde_json::Value {
    let mut stats = derived.stats(start);
    if let Some(surface) = surface {
        stats["vertices"] = surface.vertices().into();
        stats["triangles"] = surface.triangles().into();
        stats["tessellate_ms"] = surface.ms.into();
    }
    stats
}
