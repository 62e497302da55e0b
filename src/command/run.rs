//! `burgeon run`.

use super::load::{self, Job};
use super::{Failure, STOP, flags, output, print, say};
use burgeon::plan::derive::StepStats;
use burgeon::plan::{self, Options, Progress};
use burgeon::{cpu, patch};
use indicatif::{HumanBytes, HumanCount, ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Instant;

/// Derives and writes.
pub fn run(flags: &flags::Run) -> Result<(), Failure> {
    let start = Instant::now();
    let targets = output::targets(&flags.out)?;
    let job = load::job(&flags.derive)?;
    let bar = bar(flags.derive.steps);
    let progress = |p: Progress| {
        bar.set_length(p.of as u64);
        bar.set_position(p.step as u64);
        bar.set_message(format!("{} modules, {}", HumanCount(p.modules), HumanBytes(p.bytes)));
    };
    let options = options(&flags.derive, &progress);
    let derived = derive(flags, &job, &options);
    bar.finish_and_clear();
    let derived = derived?;
    output::write(&targets, &derived.word, flags, derived.device.as_ref())?;
    if flags.stats {
        return print(&format!("{}\n", stats(&derived, start)));
    }
    let Derived { word, .. } = &derived;
    let steps = if word.steps == 1 { "step" } else { "steps" };
    print(&format!("{}: {} {steps}, {} modules\n", word.system, word.steps, word.modules.len()))
}

/// How the library is to run.
pub fn options<'a>(flags: &flags::Derive, progress: &'a dyn Fn(Progress)) -> Options<'a> {
    Options {
        set: flags.set.clone(),
        seed: 0,
        steps: flags.steps,
        max_bytes: flags.max_memory.unwrap_or_else(load::half_of_memory),
        chunk_modules: None,
        stop: Some(&STOP),
        progress: Some(progress),
    }
}

fn bar(steps: Option<u32>) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(steps.unwrap_or(0) as u64);
    if let Ok(style) = ProgressStyle::with_template("step {pos}/{len} [{bar:30}] {msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
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

fn derive(flags: &flags::Run, job: &Job, options: &Options) -> Result<Derived, Failure> {
    match device(flags)? {
        #[cfg(feature = "gpu")]
        Some(device) => on_gpu(job, options, device),
        #[cfg(not(feature = "gpu"))]
        Some(device) => match device {},
        None => on_cpu(job, options, flags.derive.threads as usize),
    }
}

/// The device that the flags ask for; none for the CPU backend.
#[cfg(feature = "gpu")]
fn device(flags: &flags::Run) -> Result<Option<Device>, Failure> {
    use burgeon::gpu::Requirement;
    if flags.backend == flags::Backend::Cpu {
        return Ok(None);
    }
    let requirement = flags.derive.adapter.as_deref().map_or(Requirement::Any, Requirement::Named);
    let asked_for = flags.backend == flags::Backend::Gpu || flags.derive.adapter.is_some();
    match Device::new(requirement) {
        Ok(device) => {
            if flags.backend == flags::Backend::Auto {
                say(&format!("on {} ({:?})", device.info.name, device.info.backend));
            }
            Ok(Some(device))
        }
        Err(e) if asked_for => Err(Failure::Device(format!("error: {e}"))),
        Err(e) => {
            say(&format!("on the CPU: {e}"));
            Ok(None)
        }
    }
}

#[cfg(not(feature = "gpu"))]
fn device(flags: &flags::Run) -> Result<Option<Device>, Failure> {
    match flags.backend {
        flags::Backend::Gpu => {
            Err(Failure::Device("error: this burgeon was built without the feature gpu".to_string()))
        }
        _ => Ok(None),
    }
}

#[cfg(feature = "gpu")]
fn on_gpu(job: &Job, options: &Options, device: Device) -> Result<Derived, Failure> {
    use burgeon::gpu::{Engine, Gpu};
    let engine = Engine::new(&device.device, &device.queue);
    let uniforms = job.plan.uniforms(&options.set).map_err(of_plan)?;
    let start = Instant::now();
    let mut gpu = Gpu::new(&engine, &job.plan, &uniforms).map_err(of_gpu)?;
    gpu.compile().map_err(of_gpu)?;
    let compile_ms = milliseconds(start);
    let derivation =
        plan::derive::derive(&job.plan, &job.axiom, &uniforms, options, &mut gpu).map_err(of_gpu)?;
    let word = plan::derive::collect(&job.plan, &mut gpu, &derivation).map_err(of_gpu)?;
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
    let (word, derivation) = cpu::derive(&job.plan, &job.axiom, options, threads).map_err(of_plan)?;
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

/// An error of the plan by whose fault it is.
pub fn of_plan(e: plan::Error) -> Failure {
    let text = format!("error: {e}");
    match e {
        plan::Error::Set(_) => Failure::Usage(text),
        plan::Error::Memory { .. } | plan::Error::TooDeep { .. } => Failure::Device(text),
        plan::Error::Stopped { .. } => Failure::Stopped(text),
        plan::Error::Unsupported(_) | plan::Error::Value(_) | plan::Error::Axiom(_) => Failure::File(text),
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

fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn stats(derived: &Derived, start: Instant) -> serde_json::Value {
    let steps: Vec<_> = derived
        .steps
        .iter()
        .map(|s| serde_json::json!({ "modules": s.modules, "ms": s.time.as_secs_f64() * 1e3 }))
        .collect();
    serde_json::json!({
        "backend": derived.backend,
        "adapter": derived.adapter,
        "compile_ms": derived.compile_ms,
        "steps": steps,
        "total_ms": milliseconds(start),
        "peak_bytes": derived.peak_bytes,
    })
}
