//! Cases of patch words, on any backend: steps and derivations.

use super::systems::{Plans, axiom, made};
use super::{Case, Failure, threads};
use crate::command::counted;
use burgeon::cpu;
use burgeon::language::Value;
use burgeon::language::expr::Expr;
use burgeon::patch::{self, Net};
use burgeon::plan::derive::{self, Backend, StageId};
use burgeon::plan::step::Clock;
use burgeon::plan::{Options, Plan};
use std::time::Instant;

/// Control points of `patch/step`, as nets of whatever degree: 65,536 bicubic ones.
const STEP_POINTS: usize = 1 << 20;

/// Bytes that a 2×2 step over `nets` modules must move.
pub(super) fn step_bytes(plan: &Plan, nets: u64) -> u64 {
    let layout = plan.tables.layout;
    // What is measured is read from the nets, written, and read by match and emit.
    let row = plan.tables.rule_sets[0].stages[0].row.words as u64 * 4;
    let measured = if row > 0 { layout.net_bytes() + 3 * row } else { 0 };
    nets * (5 * layout.module_bytes() + measured)
}

/// Nets of the frontier's cases in all, and of the frontier.
pub(super) const FRONTIER_NETS: usize = 1 << 16;
pub(super) const FRONTIERS: [usize; 3] = [10_000, 20_000, 40_000];
pub(super) const FRONTIER_STEPS: u32 = 20;

/// A derivation in which so many nets stay on the frontier to the end, and the others retire at once.
pub(super) fn frontier_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    frontier: usize,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let mut roots = axiom(plan, &made(FRONTIER_NETS, [3, 3], false));
    for root in &mut roots.roots[..frontier] {
        let span = root.args[0].span;
        root.args[0] = Expr::literal(Value::Int(FRONTIER_STEPS as i32), span);
    }
    // The first step is the one that sees all nets; the others are timed.
    let first = Options { steps: Some(1), max_bytes: u64::MAX, ..Options::default() };
    let whole = Options { steps: None, ..first.clone() };
    let run = move || {
        let mut time = |options: &Options| {
            let start = Instant::now();
            let derived = derive::derive(&roots, options, &mut backend).map_err(fail)?;
            backend.finish().map_err(fail)?;
            let time = start.elapsed();
            derived.chunks.into_iter().for_each(|c| backend.recycle(c));
            Ok::<_, Failure>(time)
        };
        let one = time(&first)?;
        Ok(time(&whole)?.saturating_sub(one))
    };
    let moved = u64::from(FRONTIER_STEPS - 1) * frontier as u64;
    Ok(Case {
        name: "patch/derive",
        case: format!("frontier of {frontier} of {FRONTIER_NETS}, {} steps", FRONTIER_STEPS - 1),
        backend: label.0,
        threads: label.1,
        bytes: 2 * moved * plan.tables.layout.module_bytes(),
        items: moved,
        run: Box::new(run),
        times: vec![],
    })
}

/// A step over the same chunk again and again, its result recycled.
pub(super) fn step_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    label: (&'static str, usize, &str),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let uniforms = plan.uniforms(&[]).map_err(crate::command::run::of_plan)?;
    let layout = plan.tables.layout;
    let count = STEP_POINTS / layout.net_points();
    let nets = made(count, layout.net.unwrap_or_default(), plan.rational());
    let content = plan.axiom(&axiom(plan, &nets), &uniforms).map_err(crate::command::run::of_plan)?;
    let chunk = backend.upload(content).map_err(fail)?;
    let (backend_name, threads, what) = label;
    let id = StageId { rule_set: 0, stage: 0 };
    let run = move || {
        let start = Instant::now();
        let outcome = backend.step(id, Clock::default(), &chunk, u64::MAX).map_err(fail)?;
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        match outcome {
            derive::Outcome::Done { next: Some(next), .. } => backend.recycle(next),
            _ => return Err(Failure::Device("error: patch/step made no modules".to_string())),
        }
        Ok(time)
    };
    Ok(Case {
        name: "patch/step",
        case: format!("{count} nets, {what}"),
        backend: backend_name,
        threads,
        bytes: step_bytes(plan, count as u64),
        items: 4 * count as u64,
        run: Box::new(run),
        times: vec![],
    })
}

pub(super) fn step_cases<'a>(plans: &'a Plans, cases: &mut Vec<Case<'a>>) -> Result<(), Failure> {
    let threads = threads();
    for (plan, what) in plans.steps() {
        let backend = cpu::Cpu::new(plan, threads).map_err(crate::command::run::of_plan)?;
        cases.push(step_case(plan, backend, ("cpu", threads, what), crate::command::run::of_plan)?);
    }
    Ok(())
}

/// The whole derivation; and its last step alone, from the word before it.
pub(super) fn derive_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    roots: &[Net],
    levels: u32,
    parts: usize,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let pieces: Vec<patch::Axiom> =
        roots.chunks(roots.len().div_ceil(parts).max(1)).map(|nets| axiom(plan, nets)).collect();
    let modules: u64 = roots.len() as u64 * 4u64.pow(levels);
    let module = plan.tables.layout.module_bytes();
    // Every level is read once and written once, but for the first and the last.
    let bytes = (1..=levels).map(|l| 5 * roots.len() as u64 * 4u64.pow(l - 1) * module).sum();
    let run = move || {
        let options = Options { steps: Some(levels), max_bytes: u64::MAX, ..Options::default() };
        let start = Instant::now();
        let mut all = Vec::new();
        for piece in &pieces {
            all.push(derive::derive(piece, &options, &mut backend).map_err(fail)?);
        }
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        all.into_iter().flat_map(|d| d.chunks).for_each(|c| backend.recycle(c));
        Ok(time)
    };
    let pieces = if parts == 1 { "one chunk".to_string() } else { format!("{parts} chunks") };
    Ok(Case {
        name: "patch/derive",
        case: format!("{} to depth {levels}, {pieces}", counted(roots.len() as u64, "root")),
        backend: label.0,
        threads: label.1,
        bytes,
        items: modules,
        run: Box::new(run),
        times: vec![],
    })
}

/// The last step of the derivation by itself.
pub(super) fn last_step_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    roots: &[Net],
    levels: u32,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let options = Options { steps: Some(levels - 1), max_bytes: u64::MAX, ..Options::default() };
    let before = derive::derive(&axiom(plan, roots), &options, &mut backend).map_err(fail)?;
    let before_last = roots.len() as u64 * 4u64.pow(levels - 1);
    let run = move || {
        let start = Instant::now();
        let mut made = Vec::new();
        for chunk in &before.chunks {
            let id = StageId { rule_set: 0, stage: 0 };
            match backend.step(id, Clock::default(), chunk, u64::MAX).map_err(fail)? {
                derive::Outcome::Done { next: Some(next), .. } => made.push(next),
                _ => return Err(Failure::Device("error: patch/derive made no modules".to_string())),
            }
        }
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        made.into_iter().for_each(|c| backend.recycle(c));
        Ok(time)
    };
    Ok(Case {
        name: "patch/derive",
        case: format!("{}, step {levels} alone", counted(roots.len() as u64, "root")),
        backend: label.0,
        threads: label.1,
        bytes: step_bytes(plan, before_last),
        items: 4 * before_last,
        run: Box::new(run),
        times: vec![],
    })
}

pub(super) fn derive_cases<'a>(
    plans: &'a Plans,
    roots: &[Net],
    levels: u32,
    cases: &mut Vec<Case<'a>>,
) -> Result<(), Failure> {
    let threads = threads();
    let plan = &plans.levels;
    let backend = || cpu::Cpu::new(plan, threads).map_err(crate::command::run::of_plan);
    let fail = crate::command::run::of_plan;
    cases.push(derive_case(plan, backend()?, roots, levels, 1, ("cpu", threads), fail)?);
    cases.push(derive_case(plan, backend()?, roots, levels, 2, ("cpu", threads), fail)?);
    cases.push(last_step_case(plan, backend()?, roots, levels, ("cpu", threads), fail)?);
    let plan = &plans.frontier;
    for frontier in FRONTIERS {
        let backend = cpu::Cpu::new(plan, threads).map_err(fail)?;
        cases.push(frontier_case(plan, backend, frontier, ("cpu", threads), fail)?);
    }
    Ok(())
}
