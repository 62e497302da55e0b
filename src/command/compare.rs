//! `burgeon compare`.

use super::{Failure, flags};

/// CPU against GPU after every pass.
#[cfg(feature = "gpu")]
pub fn compare(flags: &flags::Compare) -> Result<(), Failure> {
    use super::run::{self, of_gpu};
    use super::{counted, devices, progress, stop};
    use burgeon::gpu::{Engine, Gpu, Headless, Requirement};
    use burgeon::plan::compare::{Pair, PairError};
    use burgeon::plan::derive::Start;
    use burgeon::plan::{Plan, Progress, derive};

    let job = super::load::job(&flags.derive, Plan::new)?;
    job.say_notes();
    let requirement = flags.derive.machine.adapter.as_deref().map_or(Requirement::Any, Requirement::Named);
    let device = Headless::new(requirement).map_err(of_gpu)?;
    let engine = Engine::new(&device.device, &device.queue);
    stop::watch();
    let bar = progress::Bar::new();
    let progress = |p: Progress| bar.step(p);
    let options = run::options(&flags.derive, &job, &progress);
    let cpu = run::cpu(&job, flags.derive.machine.threads as usize)?;
    let gpu = Gpu::new(&engine, &job.plan, &job.uniforms).map_err(of_gpu)?;
    let mut pair = Pair::new(&job.plan, cpu, gpu, ["CPU", "GPU"]);
    let derivation = derive::derive(&job.plan, &job.axiom, &job.uniforms, &options, &mut pair);
    bar.clear();
    let derivation = derivation.map_err(|e| match e {
        PairError::Plan(e) | PairError::Left(e) => job.failure(e),
        PairError::Right(e) => of_gpu(e),
        PairError::Difference(d) => Failure::Differ(format!("error: CPU and GPU differ: {d}")),
    })?;
    let modules = derivation.steps.last().map_or(job.axiom.roots() as u64, |s| s.modules);
    super::print(&format!(
        "{}: {}, {}: equal on the CPU and on {} after every pass ({} compared{}{})\n",
        job.plan.system.name,
        counted(derivation.steps.len() as u64, "step"),
        counted(modules, "module"),
        devices::label(&device.info),
        counted(pair.elements, "word"),
        match pair.replayed {
            0 => String::new(),
            n => format!("; {} too near to a condition's threshold to be told apart", counted(n, "module")),
        },
        match pair.unbounded {
            0 => String::new(),
            n => format!("; {} differ without a bound to hold them to", counted(n, "word")),
        },
    ))
}

#[cfg(not(feature = "gpu"))]
pub fn compare(_: &flags::Compare) -> Result<(), Failure> {
    Err(Failure::Device("error: this burgeon was built without the feature gpu".to_string()))
}
