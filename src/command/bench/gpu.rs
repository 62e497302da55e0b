//! The cases on a device.

use super::kernels::{ELEMENTS, SCAN_ELEMENTS, scan_source};
use super::patches::{FRONTIERS, derive_case, frontier_case, last_step_case, step_case};
use super::systems::Plans;
use super::{Case, Failure, timed};
use crate::command::run::of_gpu;
use burgeon::codegen::{Mapping, Tuning};
use burgeon::gpu::{Bandwidth, Engine, Gpu, Headless, Measure, Requirement, Scans};
use burgeon::patch::Net;
use burgeon::plan::Plan;

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
