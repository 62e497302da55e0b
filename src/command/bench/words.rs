//! Cases of curves' words, on any backend: Chaikin's ring, and symbols in their contexts.

use super::systems::Plans;
use super::{Case, Failure, threads};
use crate::command::run::of_plan;
use burgeon::cpu::Cpu;
use burgeon::curve::{Axiom, Words};
use burgeon::language::Value;
use burgeon::plan::columns::Content;
use burgeon::plan::derive::{self, Backend, Outcome, StageId};
use burgeon::plan::step::Clock;
use burgeon::plan::{Options, Plan};
use std::time::{Duration, Instant};

/// Records of 16 bytes: a symbol and three coordinates.
pub(super) const CHAIKIN: &str = "system chaikin : curve ring\nmodule P(v: vec3)\naxiom: file \"points.csv\"\nrules:\n  \
     P(vl) < P(v) > P(vr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\nrun:\n  derive 24\n";

/// How far corners are cut is a param.
pub(super) const CORNERS: &str = "system corners : curve ring\nparam w: float = 1/4\nmodule P(v: vec3)\naxiom: file \"points.csv\"\nrules:\n  \
     P(vl) < P(v) > P(vr) -> P(w*vl + (1 - w)*v) P((1 - w)*v + w*vr)\nrun:\n  derive 2\n";

/// Words that are derived at once, and points of each.
const WORDS: usize = 10_000;
const WORD_LENGTH: usize = 100;

/// benches/passes.rs measures the same beside another program.
pub(super) const SYMBOLS: &str = include_str!("symbols.burgeon");

/// Points of the ring before the first step, and how many steps make 2²⁴ of them.
const ROOTS: usize = 16;
const STEPS: u32 = 20;

/// Modules before the last step, for how time grows with them.
const LENGTHS: [usize; 4] = [10_000, 100_000, 1_000_000, 10_000_000];

/// Modules of the word of symbols.
const SYMBOLS_LENGTH: usize = 3 << 19;

fn points(count: usize) -> Vec<[f32; 4]> {
    (0..count).map(|i| [i as f32, (i * i % 17) as f32, (i % 5) as f32, 1.0]).collect()
}

fn axiom(plan: &Plan, count: usize) -> Result<Axiom, Failure> {
    let axiom = Axiom::load::<String>(&plan.system, &mut |_| Ok(vec![points(count).into()]));
    axiom.map_err(|e| Failure::File(format!("error: {e}")))
}

/// The whole derivation of 2²⁴ points.
fn derive_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let (axiom, options) = (axiom(plan, ROOTS)?, Options { steps: Some(STEPS), ..Options::default() });
    let before_last = (ROOTS as u64) << (STEPS - 1);
    let run = move || {
        let start = Instant::now();
        let derived = derive::derive(&axiom, &options, &mut backend).map_err(fail)?;
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        derived.chunks.into_iter().for_each(|c| backend.recycle(c));
        Ok(time)
    };
    Ok(Case {
        name: "curve/derive",
        case: format!("Chaikin, {ROOTS} points to 2^24 in {STEPS} steps"),
        backend: label.0,
        threads: label.1,
        // The steps before the last are as much again, but for its first word.
        bytes: 48 * (2 * before_last - ROOTS as u64),
        items: 2 * before_last,
        run: Box::new(run),
        times: vec![],
    })
}

/// A sweep: as many words as values of the param, two steps of each.
fn starts(plan: &Plan) -> Result<Words, Failure> {
    let value = |n: usize| Value::Float(n as f32 / (2 * WORDS) as f32);
    Ok(Words::sweep(&axiom(plan, WORD_LENGTH)?, "w", (0..WORDS).map(value)))
}

fn words_case<'a>(
    how: &str,
    label: (&'static str, usize),
    record_bytes: u64,
    run: Box<dyn FnMut() -> Result<Duration, Failure> + 'a>,
) -> Case<'a> {
    let points = (WORDS * WORD_LENGTH) as u64;
    Case {
        name: "curve/words",
        case: format!("{WORDS} rings of {WORD_LENGTH} points, each of a param, {how}"),
        backend: label.0,
        threads: label.1,
        // Read and written in the two steps.
        bytes: (3 + 6) * points * record_bytes,
        items: 4 * points,
        run,
        times: vec![],
    }
}

/// All words in one derivation.
fn at_once<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let starts = starts(plan)?;
    let run = move || {
        let start = Instant::now();
        let derived = derive::derive(&starts, &Options::default(), &mut backend).map_err(fail)?;
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        derived.chunks.into_iter().for_each(|c| backend.recycle(c));
        Ok(time)
    };
    Ok(words_case("at once", label, plan.tables.layout.record_bytes(), Box::new(run)))
}

/// One derivation after the other, on the CPU.
fn one_by_one(plan: &Plan) -> Result<Case<'_>, Failure> {
    let starts = starts(plan)?;
    let run = move || {
        let start = Instant::now();
        for word in &starts.words {
            let options = Options { set: word.set.clone(), ..Options::default() };
            // A pool of threads for each word would take longer than the word.
            let mut cpu = Cpu::new(plan, 1).map_err(of_plan)?;
            derive::derive(&*word.axiom, &options, &mut cpu).map_err(of_plan)?;
        }
        Ok(start.elapsed())
    };
    Ok(words_case("one by one", ("cpu", 1), plan.tables.layout.record_bytes(), Box::new(run)))
}

/// One step of these chunks, again and again.
fn step_case<'a, B: Backend + 'a>(
    plan: &'a Plan,
    mut backend: B,
    chunks: Vec<B::Chunk>,
    (name, what): (&'static str, String),
    label: (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
) -> Result<Case<'a>, Failure> {
    let id = StageId { rule_set: 0, stage: 0 };
    let most = backend.most_modules() / id.of(plan).max_count() as usize;
    let mut pieces = Vec::new();
    for chunk in chunks {
        match backend.len(&chunk) > most {
            true => pieces.extend(backend.split(chunk, most).map_err(fail)?),
            false => pieces.push(chunk),
        }
    }
    let chunks = backend.join(pieces, plan.is_ring()).map_err(fail)?;
    let modules: u64 = chunks.iter().map(|chunk| backend.len(chunk) as u64).sum();
    let mut once = move || {
        let start = Instant::now();
        let mut made = Vec::new();
        for chunk in &chunks {
            match backend.step(id, Clock::default(), chunk, u64::MAX).map_err(fail)? {
                Outcome::Done { next: Some(next), .. } => made.push(next),
                _ => return Err(Failure::Device("error: a step made no modules".to_string())),
            }
        }
        backend.finish().map_err(fail)?;
        let time = start.elapsed();
        let new: u64 = made.iter().map(|chunk| backend.len(chunk) as u64).sum();
        made.into_iter().for_each(|c| backend.recycle(c));
        Ok((time, new))
    };
    let (_, new) = once()?;
    Ok(Case {
        name,
        case: what,
        backend: label.0,
        threads: label.1,
        bytes: (modules + new) * plan.tables.layout.record_bytes(),
        items: new,
        run: Box::new(move || once().map(|(time, _)| time)),
        times: vec![],
    })
}

/// All cases of a backend, each with one of its own.
pub(super) fn cases<'a, B: Backend + 'a>(
    plans: &'a Plans,
    backend: impl Fn(&'a Plan) -> Result<B, Failure>,
    wanted: &dyn Fn(&str) -> bool,
    (name, threads): (&'static str, usize),
    fail: impl Fn(B::Error) -> Failure + Copy + 'a,
    cases: &mut Vec<Case<'a>>,
) -> Result<(), Failure> {
    let Plans { chaikin, symbols, words, .. } = plans;
    if wanted("curve/words") {
        cases.push(at_once(words, backend(words)?, (name, threads), fail)?);
    }
    if wanted("curve/derive") {
        cases.push(derive_case(chaikin, backend(chaikin)?, (name, threads), fail)?);
    }
    if wanted("curve/step") {
        let mut step = |what: String, points, steps| {
            let mut backend = backend(chaikin)?;
            let (from, options) =
                (axiom(chaikin, points)?, Options { steps: Some(steps), ..Options::default() });
            let before = derive::derive(&from, &options, &mut backend).map_err(fail)?;
            let what = ("curve/step", what);
            cases.push(step_case(chaikin, backend, before.chunks, what, (name, threads), fail)?);
            Ok::<_, Failure>(())
        };
        step("Chaikin, the last step to 2^24 points".to_string(), ROOTS, STEPS - 1)?;
        for length in LENGTHS {
            step(format!("Chaikin, a step from {length} points"), length, 0)?;
        }
    }
    if wanted("word/context") {
        let mut backend = backend(symbols)?;
        let words = symbols.tables.layout.record_words;
        let record = |n: usize| (0..words).map(move |word| if word == 0 { n as u32 % 3 } else { 0 });
        let records = (0..SYMBOLS_LENGTH).flat_map(record).collect();
        let chunk = backend.upload(Content::of_records(records)).map_err(fail)?;
        let what = ("word/context", format!("{SYMBOLS_LENGTH} symbols by both neighbours"));
        cases.push(step_case(symbols, backend, vec![chunk], what, (name, threads), fail)?);
    }
    Ok(())
}

/// Those of the CPU.
pub(super) fn cpu_cases<'a>(
    plans: &'a Plans,
    wanted: &dyn Fn(&str) -> bool,
    list: &mut Vec<Case<'a>>,
) -> Result<(), Failure> {
    let backend = |plan: &'a Plan| Cpu::new(plan, threads()).map_err(of_plan);
    if wanted("curve/words") {
        list.push(one_by_one(&plans.word)?);
    }
    cases(plans, backend, wanted, ("cpu", threads()), of_plan, list)
}
