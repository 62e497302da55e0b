//! Curves that follow their control points: derived step by step, and by a table of stencils.

use super::kernels::infallible;
use super::systems::Plans;
use super::{Case, Failure, threads};
use crate::command::run::of_plan;
use burgeon::affine::Stencils;
use burgeon::cpu;
use burgeon::curve::Axiom;
use burgeon::plan::derive::{self, Backend};
use burgeon::plan::{Options, Plan};
use std::time::Instant;

/// Chaikin's rule, six steps.
pub(super) const CHAIKIN: &str = "system chaikin : curve ring\nmodule P(v: vec2)\naxiom: file \"p.csv\"\nrules:\n  \
     P(vl) < P(v) > P(vr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\nrun:\n  derive 6\n";

/// Control points.
pub(super) const CONTROL: usize = 4096;

const STEPS: u32 = 6;

/// Points on a flower.
pub(super) fn control() -> Vec<[f32; 4]> {
    let point = |i: usize| {
        let angle = i as f32 * std::f32::consts::TAU / CONTROL as f32;
        let r = 1.0 + 0.2 * (angle * 40.0).cos();
        [r * angle.cos(), r * angle.sin(), 0.0, 1.0]
    };
    (0..CONTROL).map(point).collect()
}

pub(super) fn table(plan: &Plan) -> Result<Stencils, Failure> {
    let table = Stencils::of_length(plan, CONTROL, &Options::default());
    table.map_err(|e| Failure::File(format!("error: {e}")))
}

/// What a frame by a table reads and writes: 8 bytes and 16 a point, and the control points once.
pub(super) fn stencil_case(table: &Stencils, label: (&'static str, usize)) -> Case<'static> {
    Case {
        name: "curve/stencil",
        case: format!("{CONTROL} control points, {STEPS} steps by a table"),
        backend: label.0,
        threads: label.1,
        bytes: 24 * table.len() as u64 + 16 * CONTROL as u64,
        items: table.len() as u64,
        run: Box::new(|| infallible(|| ())),
        times: vec![],
    }
}

/// The same derived: each step reads a record of 16 bytes a module and writes two.
pub(super) fn derived_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let points = control();
    let axiom = Axiom::load::<String>(&plan.system, &mut |_| Ok(vec![points.clone().into()]));
    let axiom = axiom.map_err(|e| Failure::File(format!("error: {e}")))?;
    let items = (CONTROL as u64) << STEPS;
    let run = move || {
        let start = Instant::now();
        let done = derive::derive(&axiom, &Options::default(), &mut backend).map_err(fail)?;
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        done.chunks.into_iter().for_each(|c| backend.recycle(c));
        Ok(time)
    };
    Ok(Case {
        name: "curve/stencil",
        case: format!("{CONTROL} control points, {STEPS} steps derived"),
        backend: label.0,
        threads: label.1,
        bytes: 48 * (items - CONTROL as u64),
        items,
        run: Box::new(run),
        times: vec![],
    })
}

pub(super) fn cpu_cases<'a>(plans: &'a Plans, cases: &mut Vec<Case<'a>>) -> Result<(), Failure> {
    let (plan, threads) = (&plans.smoothed, threads());
    let table = table(plan)?;
    let (control, mut curve) = (control(), vec![[0.0; 4]; table.len()]);
    let case = stencil_case(&table, ("cpu", threads));
    let run = move || infallible(|| cpu::stencil::stencil(&table, &control, &mut curve));
    cases.push(Case { run: Box::new(run), ..case });
    let backend = cpu::Cpu::new(plan, threads).map_err(of_plan)?;
    cases.push(derived_case(plan, backend, ("cpu", threads), of_plan)?);
    Ok(())
}
