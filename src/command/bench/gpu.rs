//! The cases on a device.

use super::kernels::{ELEMENTS, SCAN_ELEMENTS, scan_source};
use super::meshes::{self, Subject};
use super::patches::{FRONTIERS, derive_case, frontier_case, last_step_case, step_case};
use super::systems::Plans;
use super::tessellation::{self, frame_bytes};
use super::{Case, Failure, curves, timed};
use crate::command::run::of_gpu;
use burgeon::codegen::{Mapping, Tuning};
use burgeon::gpu::refine::Refiner;
use burgeon::gpu::tessellate::{Capacity, Part, Tessellator};
use burgeon::gpu::{Bandwidth, Engine, Gpu, Headless, Measure, Requirement, Scans, Stencil};
use burgeon::patch::Net;
use burgeon::plan::Plan;
use burgeon::tessellate::{Level, Options};
use burgeon::wgpu;

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
        crowd: &[Net],
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
        super::words::cases(plans, |plan| backend(&engine, plan), wanted, ("gpu", 0), of_gpu, cases)?;
        if wanted("curve/stencil") {
            stencils(&engine, &plans.smoothed, cases)?;
        }
        if wanted("mesh/frame") {
            meshes(&engine, cases)?;
        }
        if wanted("tessellate") {
            tessellations(&engine, roots, crowd, cases)?;
        }
        scans(&engine, wanted, cases)
    }
}

/// Frames of meshes, in which the vertices move.
fn meshes(engine: &Engine, cases: &mut Vec<Case<'_>>) -> Result<(), Failure> {
    for Subject { name, mesh, level } in meshes::subjects() {
        let topology = meshes::topology(&mesh)?;
        let refiner = Refiner::new(engine, &topology, &[level]).map_err(of_gpu)?;
        let vertices = topology.counts(level).vertices;
        let device = engine.clone();
        let run = move || {
            timed(
                || {
                    refiner.set(&mesh.positions).map_err(of_gpu)?;
                    submit(&device, |encoder| refiner.encode(encoder))
                },
                |e| e,
            )
        };
        cases.push(Case {
            name: "mesh/frame",
            case: name.to_string(),
            backend: "gpu",
            threads: 0,
            bytes: 12 * vertices,
            items: vertices,
            run: Box::new(run),
            times: Vec::new(),
        });
    }
    Ok(())
}

/// Submits what is recorded, and waits for it.
fn submit(engine: &Engine, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<(), Failure> {
    let mut encoder = engine.device().create_command_encoder(&Default::default());
    record(&mut encoder);
    engine.queue().submit([encoder.finish()]);
    let lost = |_| Failure::Device("error: the device was lost".to_string());
    engine.device().poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(lost)
}

fn stencils<'a>(engine: &Engine, plan: &'a Plan, cases: &mut Vec<Case<'a>>) -> Result<(), Failure> {
    let table = curves::table(plan)?;
    let stencil = Stencil::new(engine, &table).map_err(of_gpu)?;
    let control = curves::control();
    let device = engine.clone();
    let run = move || {
        timed(
            || {
                stencil.set(&control).map_err(of_gpu)?;
                submit(&device, |encoder| stencil.encode(encoder))
            },
            |e| e,
        )
    };
    cases.push(Case { run: Box::new(run), ..curves::stencil_case(&table, ("gpu", 0)) });
    cases.push(curves::derived_case(plan, backend(engine, plan)?, ("gpu", 0), of_gpu)?);
    Ok(())
}

fn tessellations<'a>(
    engine: &Engine,
    roots: &[Net],
    crowd: &[Net],
    cases: &mut Vec<Case<'a>>,
) -> Result<(), Failure> {
    let prepare = |nets: &[Net], level: &Level| {
        let options = Options::default();
        let target = level.target().map_err(|e| of_gpu(e.into()))?;
        let mut cpu =
            burgeon::cpu::tessellate::Tessellator::new(nets, &options).map_err(|e| of_gpu(e.into()))?;
        cpu.run(&target);
        let s = *cpu.status();
        // A moving camera wants some more.
        let more = |n: u32| n + n / 4;
        let room = Capacity {
            nodes: more(s.nodes),
            vertices: more(s.vertices),
            indices: more(s.indices),
            modules: 0,
        };
        let made = Tessellator::new(engine, nets, level, &options, &room).map_err(of_gpu)?;
        Ok::<_, Failure>((made, s))
    };
    let frame = |engine: &Engine, t: &mut Tessellator, part: Option<Part>| {
        submit(engine, |encoder| match part {
            None => t.encode(encoder),
            Some(part) => t.encode_part(encoder, part),
        })
    };
    let level = Level::world(tessellation::TOLERANCE);
    let (mut first, s) = prepare(roots, &level)?;
    frame(engine, &mut first, None)?;
    let (nodes, vertices, triangles) = (s.nodes.into(), s.vertices.into(), u64::from(s.indices) / 3);
    let parts = [
        ("a frame, items are triangles", None, frame_bytes(nodes, vertices, triangles), triangles),
        ("refine, nodes", Some(Part::Refine), nodes * 28, nodes),
        ("stitch, nodes", Some(Part::Stitch), nodes * 32, nodes),
        ("vertices of 32 bytes", Some(Part::Vertices), 32 * vertices + 24 * nodes, vertices),
        ("triangles", Some(Part::Triangles), 16 * triangles + 24 * nodes, triangles),
    ];
    // One set of buffers for all: a part works on what the others left.
    let shared = std::rc::Rc::new(std::cell::RefCell::new(first));
    for (case, part, bytes, items) in parts {
        let (shared, engine) = (shared.clone(), engine.clone());
        let run = move || timed(|| frame(&engine, &mut shared.borrow_mut(), part), |e| e);
        cases.push(Case {
            name: "tessellate",
            case: case.to_string(),
            backend: "gpu",
            threads: 0,
            bytes,
            items,
            run: Box::new(run),
            times: vec![],
        });
    }
    let (mut fine, s) = prepare(roots, &Level::world(tessellation::FINE))?;
    frame(engine, &mut fine, None)?;
    let device = engine.clone();
    cases.push(Case {
        name: "tessellate",
        case: tessellation::FINE_VERTICES.to_string(),
        backend: "gpu",
        threads: 0,
        bytes: 32 * u64::from(s.vertices) + 24 * u64::from(s.nodes),
        items: s.vertices.into(),
        run: Box::new(move || timed(|| frame(&device, &mut fine, Some(Part::Vertices)), |e| e)),
        times: vec![],
    });
    if crowd.is_empty() {
        return Ok(());
    }
    let (mut t, s) = prepare(crowd, &tessellation::moving(0))?;
    let (nodes, vertices, triangles) = (s.nodes.into(), s.vertices.into(), u64::from(s.indices) / 3);
    let (engine, mut round) = (engine.clone(), 0);
    let run = move || {
        round += 1;
        t.set_level(&tessellation::moving(round)).map_err(of_gpu)?;
        timed(|| frame(&engine, &mut t, None), |e| e)
    };
    cases.push(Case {
        name: "tessellate",
        case: format!("{} patches, moving camera, 1 pixel", crowd.len()),
        backend: "gpu",
        threads: 0,
        bytes: frame_bytes(nodes, vertices, triangles),
        items: triangles,
        run: Box::new(run),
        times: vec![],
    });
    Ok(())
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

fn backend(engine: &Engine, plan: &Plan) -> Result<Gpu, Failure> {
    let mut gpu = Gpu::new(engine, plan).map_err(of_gpu)?;
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
