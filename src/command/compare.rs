//! `burgeon compare`.

use super::{Failure, flags};

/// CPU against GPU after every pass.
#[cfg(feature = "gpu")]
pub fn compare(flags: &flags::Compare) -> Result<(), Failure> {
    use super::axiom::Beginning;
    use super::run::{self, of_gpu};
    use super::{counted, devices, progress, stop};
    use burgeon::gpu::{Engine, Gpu, Headless, Requirement};
    use burgeon::plan::compare::{Pair, PairError};
    use burgeon::plan::{Plan, Progress, derive};

    let loaded = super::source::Loaded::read(&flags.derive.system)?;
    let plan = loaded.plan(Plan::new)?;
    super::kinds::check(&flags.derive, &loaded.system)?;
    let job = super::load::job(loaded, plan, &flags.derive, false)?;
    job.say_notes();
    let requirement = flags.derive.machine.adapter.as_deref().map_or(Requirement::Any, Requirement::Named);
    let device = Headless::new(requirement).map_err(of_gpu)?;
    let engine = Engine::new(&device.device, &device.queue);
    stop::watch();
    let bar = progress::Bar::new();
    let progress = |p: Progress| bar.step(p);
    let options = run::options(&flags.derive, &job, &progress);
    let cpu = run::cpu(&job, flags.derive.machine.threads as usize)?;
    let gpu = Gpu::new(&engine, &job.plan).map_err(of_gpu)?;
    let mut pair = Pair::new(cpu, gpu, ["CPU", "GPU"]);
    let steps = match &job.axiom {
        Beginning::Nets(axiom) => derive::derive(axiom, &options, &mut pair).map(|d| d.steps),
        Beginning::Points(axiom) => derive::derive(axiom, &options, &mut pair).map(|d| d.steps),
    };
    bar.clear();
    let steps = steps.map_err(|e| match e {
        PairError::Plan(e) | PairError::Left(e) => job.failure(e),
        PairError::Right(e) => of_gpu(e),
        PairError::Difference(d) => Failure::Differ(format!("error: CPU and GPU differ: {d}")),
    })?;
    let modules = steps.last().map_or(job.axiom.roots() as u64, |s| s.modules);
    super::print(&format!(
        "{}: {}, {}: equal on the CPU and on {} after every pass ({} compared{})\n",
        job.plan.system.name,
        counted(steps.len() as u64, "step"),
        counted(modules, "module"),
        devices::label(&device.info),
        counted(pair.elements, "word"),
        match pair.replayed {
            0 => String::new(),
            n => format!("; {} too near to a condition's threshold to be told apart", counted(n, "module")),
        },
    ))
}

#[cfg(not(feature = "gpu"))]
pub fn compare(_: &flags::Compare) -> Result<(), Failure> {
    Err(Failure::Device("error: this burgeon was built without the feature gpu".to_string()))
}
