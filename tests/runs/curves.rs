//! The same of curves: contexts, ends and rings, claims, trees, traces, several words at once.

use super::{submit, submitted};
use crate::curves::engines::prepare;
use crate::oracle;
use crate::{device, mutants, tier};
use burgeon::curve::{Axiom, Word, Words};
use burgeon::gpu::Engine;
use burgeon::gpu::run::{Options, Run};
use burgeon::language::{System, Value};
use burgeon::plan::derive::Start;
use burgeon::plan::turns::Progress;
use burgeon::plan::{self, Plan};
use std::fmt::Debug;

/// The seeds of random systems, and those of the sample.
const SEEDS: std::ops::Range<u64> = 0..40;
const SAMPLE: std::ops::Range<u64> = 0..8;

/// A ring whose points are made of both neighbours, by a param.
const RING: &str = "\
system ring : curve ring
param most: int = 4 in 0 .. 6
param ratio: float = 0.25 in 0 .. 1
module P(v: vec2)
axiom: P((0, 0)) P((ratio, 0)) P((1, 1))
rules:
  P(a) < P(v) > P(b) -> P(ratio * a + (1 - ratio) * v) P((1 - ratio) * v + ratio * b)
run:
  derive most
";

/// Both ends of the word, rules of several predecessors, chance, erasure, an end of itself.
const OPEN: &str = "\
system open : curve open
param most: int = 3 in 0 .. 6
param ratio: float = 0.5 in 0 .. 1
module A(n: int), B, C(v: vec3)
axiom: A(most) B A(most + 1) C((0, 0, 1)) A(2)
rules grow:
  # < A(n) : n > 0 -> A(n - 1) B B
  A(n) B : n > 0 -> B A(n - 1) C((n, ratio, 0)) A(n - 2)
  B < B > B : rand() < ratio -> eps
  C(v) > # -> C(v + (1, 0, 0)) B
  A(n) > A(m) : n > m -> (ratio) A(n - 1) A(m) -> (1 - ratio) B
rules last:
  C(v) : step < 1 -> C(2 * v) A(0)
run:
  derive until terminal max 7 with grow
  derive 1 with last
";

/// Branches, contexts that look past symbols, and a turtle whose points are rewritten.
const TREE: &str = "\
system tree : curve tree
param most: int = 4 in 0 .. 6
param ratio: float = 0.7 in 0 .. 1
module A(l: float), S, P(v: vec3, r: float)
ignore + - &
axiom: F(1) A(1)
rules grow:
  A(l) -> F(l) [ +(30) A(l * ratio) ] [ -(25) &(40) S A(l * ratio) ] F(l * 0.5)
  S < A(l) : l > 0.2 -> F(0.1) A(l)
  F(l) > S -> F(l) S
rules thicken:
  P(v, r) > P(w, _) -> P(v, r) P((v + w) / 2, r * ratio)
run:
  derive most with grow
  trace into P
  derive 1 with thicken
";

/// A word of which all is erased, and then the point at which a turtle starts.
const NOTHING: &str = "\
system nothing : curve open
param most: int = 1 in 0 .. 6
param ratio: float = 0.5 in 0 .. 1
module A, P(v: vec2)
axiom: A F A
rules:
  A -> eps
  F : step < most -> eps
run:
  derive 2
  trace into P
";

/// Moves without drawing: several curves in a word.
const MOVES: &str = "\
system moves : curve open
param most: int = 3 in 0 .. 6
param ratio: float = 0.5 in 0 .. 1
module A, P(v: vec2)
axiom: A
rules:
  A -> F(ratio) +(60) A f(1) -(30) A F
run:
  derive most
  trace into P
";

/// A ring in which rules of several predecessors may not go across its start.
const PAIRS: &str = "\
system pairs : curve ring
param most: int = 3 in 0 .. 6
param ratio: float = 0.5 in 0 .. 1
module A, B
axiom: A B A
rules:
  A B -> B A A
  B A -> (ratio) A B B -> (1 - ratio) A
run:
  derive most
";

const ALL: [&str; 6] = [RING, OPEN, TREE, NOTHING, MOVES, PAIRS];

fn of(text: &str) -> (System, Axiom) {
    let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let axiom = Axiom::load::<String>(&system, &mut |_| Ok(vec![])).expect("an axiom");
    (system, axiom)
}

fn params(most: i32, ratio: f32) -> Vec<(String, Value)> {
    vec![("most".to_string(), Value::Int(most)), ("ratio".to_string(), Value::Float(ratio))]
}

fn waited<S: Start>(engine: &Engine, plan: &Plan, start: &S, options: &Options) -> S::Word {
    let Options { set, bind, view, seed } = options.clone();
    let options = plan::Options { set, bind, view, seed, ..plan::Options::default() };
    burgeon::gpu::derive(engine, plan, start, &options).expect("a word").0
}

/// Records with some params after the other, twice each: what differs from the derivation that waits.
fn difference<S: Start + Clone>(
    engine: &Engine,
    plan: &Plan,
    start: &S,
    expected: &[S::Word],
) -> Option<String>
where
    S::Word: PartialEq + Debug,
{
    let options = Options { seed: Some(11), ..Options::default() };
    let mut run = match Run::new(engine, plan, start, &options, 3000) {
        Ok(run) => run,
        Err(e) => return Some(e.to_string()),
    };
    for (params, expected) in TURNS.map(|(most, ratio)| params(most, ratio)).iter().zip(expected) {
        run.set(params).expect("params");
        for again in [false, true] {
            submitted(engine, &mut run);
            let (progress, word): (Progress, S::Word) = match run.read() {
                Ok(read) => read,
                Err(e) => return Some(e.to_string()),
            };
            if !progress.complete() || word != *expected {
                return Some(format!(
                    "{params:?}, again: {again}: {progress:?}, {} modules",
                    progress.modules
                ));
            }
        }
    }
    None
}

const TURNS: [(i32, f32); 5] = [(3, 0.5), (5, 0.25), (0, 1.0), (4, 0.75), (1, 0.5)];

/// What the derivation that waits makes with each of [`TURNS`].
fn expected<S: Start>(engine: &Engine, plan: &Plan, start: &S) -> Vec<S::Word> {
    let options = |(most, ratio)| Options { set: params(most, ratio), seed: Some(11), ..Options::default() };
    TURNS.map(|turn| waited(engine, plan, start, &options(turn))).into()
}

#[test]
fn curves_are_the_same_recorded() {
    for (name, engine) in device::engines() {
        for text in ALL {
            let (system, axiom) = of(text);
            let plan = Plan::new(&system).unwrap_or_else(|e| panic!("{e}"));
            let expected = expected(&engine, &plan, &axiom);
            assert!(expected.iter().any(|word| !word.modules.is_empty()), "{text}");
            if let Some(what) = difference(&engine, &plan, &axiom, &expected) {
                panic!("{name}: {}: {what}", system.name);
            }
        }
    }
}

#[test]
fn several_words_are_the_same_recorded() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    for text in [RING, TREE, MOVES] {
        let (system, axiom) = of(text);
        let plan = Plan::of_words(&system).unwrap_or_else(|e| panic!("{e}"));
        let words = Words::sweep(&axiom, "ratio", (1..7).map(|n| Value::Float(n as f32 / 8.0)));
        let options = Options { set: params(3, 0.0), ..Options::default() };
        let expected = waited(&engine, &plan, &words, &options);
        let mut run = Run::new(&engine, &plan, &words, &options, 20_000).expect("a run");
        for _ in 0..2 {
            let (progress, found) = submit(&engine, &mut run);
            assert!(progress.complete(), "{}: {progress:?}", system.name);
            assert_eq!(found.len(), expected.len());
            assert!(found == expected, "{}", system.name);
        }
    }
    // Of a word of several the trace of nothing is none of the device's.
    let (system, axiom) = of(NOTHING);
    let plan = Plan::of_words(&system).expect("a plan");
    let words = Words::sweep(&axiom, "ratio", [Value::Float(0.5)]);
    match Run::new(&engine, &plan, &words, &Options::default(), 100) {
        Err(e) => assert!(e.to_string().contains("a recorded trace of several words"), "{e}"),
        Ok(_) => panic!("it was recorded"),
    }
}

#[test]
fn random_curves_are_the_same_recorded() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    for seed in tier::cases(SAMPLE, SEEDS) {
        let case = oracle::curve_case(seed);
        let prepared = prepare(&case.job);
        let plan::Options { set, seed, .. } = prepared.options.clone();
        let options = Options { set, seed, ..Options::default() };
        let expected = waited(&engine, &prepared.plan, &prepared.axiom, &options);
        let mut run = Run::new(&engine, &prepared.plan, &prepared.axiom, &options, 1 << 15)
            .unwrap_or_else(|e| panic!("{case}\n{e}"));
        let (progress, word) = submit(&engine, &mut run);
        assert!(progress.complete(), "{case}\n{progress:?}");
        assert!(word == expected, "{case}\n{} for {}", word.modules.len(), expected.modules.len());
    }
}

#[test]
fn points_that_move_on_the_device_are_refined_anew() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (system, axiom) = of(RING);
    let plan = Plan::new(&system).expect("a plan");
    let mut run = Run::new(&engine, &plan, &axiom, &Options::default(), 3000).expect("a run");
    let before: Word = submit(&engine, &mut run).1;
    // The x of the first point, behind what stands beside the word.
    let layout = plan.tables.layout;
    let at = layout.shape(plan::Stored::Records).halo_bytes() + 4 * layout.header_words as u64;
    let records = run.axiom_column(plan::Stored::Records).expect("records");
    engine.queue().write_buffer(records, at, bytemuck::bytes_of(&5f32));
    let after = submit(&engine, &mut run).1;
    let moved = RING.replace("P((0, 0))", "P((5, 0))");
    let (system, axiom) = of(&moved);
    let plan = Plan::new(&system).expect("a plan");
    let expected = waited(&engine, &plan, &axiom, &Options::default());
    assert!(after == expected && after != before);
}

/// What recorded curves need besides, broken on purpose.
const MUTANTS: &[mutants::Mutant] = &[
    ("join", "select(n + k, k, before)", "select(n + HALO + k, k, before)"),
    ("join", "!RING || n == 0u", "n == 0u"),
    ("join", "!RING || n == 0u", "true"),
    ("join", "(n - (HALO - k) % n) % n", "(n - (HALO - k - 1u) % n) % n"),
    ("join", "(k - HALO) % n", "(k - HALO + 1u) % n"),
    ("join", "select(0u, END, q == 0u)", "0u"),
    ("start_word", "HALO * QUADS + q", "q"),
    ("start_word", "= start[q]", "= vec4u()"),
    ("proceed", "total == 0u && (turn.flags & STARTS) != 0u", "false"),
    ("proceed", "BEHIND] = total", "BEHIND] = 0u"),
];

#[test]
fn every_mutant_of_recorded_curves_is_seen() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let all = [RING, OPEN, NOTHING, PAIRS].map(|text| {
        let (system, axiom) = of(text);
        let plan = Plan::new(&system).expect("a plan");
        let expected = expected(&engine, &plan, &axiom);
        (plan, axiom, expected)
    });
    let difference = |engine: &Engine| {
        all.iter().find_map(|(plan, axiom, expected)| difference(engine, plan, axiom, expected))
    };
    assert_eq!(difference(&engine), None, "without a mutant");
    let sample = mutants::sample(MUTANTS);
    mutants::assert_seen(sample.iter().filter_map(|&mutant| mutants::unseen(&engine, mutant, difference)));
}

/// How many mutants of a file are here.
pub fn mutants_of(file: &str) -> usize {
    MUTANTS.iter().filter(|m| m.0 == file).count()
}
