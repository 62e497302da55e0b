//! `burgeon compare`.

use super::{Failure, flags};

/// CPU against GPU after every pass.
#[cfg(feature = "gpu")]
pub fn compare(flags: &flags::Compare) -> Result<(), Failure> {
    use super::run::{self, of_gpu, of_plan};
    use burgeon::cpu::Cpu;
    use burgeon::gpu::{Engine, Gpu, Headless, Requirement};
    use burgeon::plan::compare::{Pair, PairError};
    use burgeon::plan::derive;

    let job = super::load::job(&flags.derive)?;
    let requirement = flags.derive.adapter.as_deref().map_or(Requirement::Any, Requirement::Named);
    let device = Headless::new(requirement).map_err(of_gpu)?;
    let engine = Engine::new(&device.device, &device.queue);
    let quiet = |_| {};
    let options = run::options(&flags.derive, &quiet);
    let uniforms = job.plan.uniforms(&options.set).map_err(of_plan)?;
    let cpu = Cpu::new(&job.plan, &uniforms, flags.derive.threads as usize).map_err(of_plan)?;
    let gpu = Gpu::new(&engine, &job.plan, &uniforms).map_err(of_gpu)?;
    let mut pair = Pair::new(cpu, gpu, ["CPU", "GPU"]);
    let failure = |e| match e {
        PairError::Plan(e) | PairError::Left(e) => of_plan(e),
        PairError::Right(e) => of_gpu(e),
        PairError::Difference(d) => Failure::Differ(format!("error: CPU and GPU differ: {d}")),
    };
    let derivation =
        derive::derive(&job.plan, &job.axiom, &uniforms, &options, &mut pair).map_err(failure)?;
    let modules = derivation.steps.last().map_or(job.axiom.roots.len() as u64, |s| s.modules);
    super::print(&format!(
        "{}: {} steps, {modules} modules; {} passes' worth of {} words equal on the CPU and on {} ({:?})\n",
        job.plan.system.name,
        derivation.steps.len(),
        pair.sweeps,
        pair.elements,
        device.info.name,
        device.info.backend,
    ))
}

#[cfg(not(feature = "gpu"))]
pub fn compare(_: &flags::Compare) -> Result<(), Failure> {
    Err(Failure::Device("error: this burgeon was built without the feature gpu".to_string()))
}
