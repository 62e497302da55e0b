//! Derivations that are recorded without a wait: the words of the ones that wait, to the bit.

mod curves;

use crate::oracle;
use crate::parity::{Job, settings};
use crate::{device, mutants, tier};
use burgeon::gpu::run::{Options, Run};
use burgeon::gpu::{Engine, Error};
use burgeon::language::{System, Value};
use burgeon::patch::{Axiom, Net, Word};
use burgeon::plan::derive::Start;
use burgeon::plan::turns::{MOST_TURNS, Progress};
use burgeon::plan::{self, Plan};

/// The seeds of random systems.
const SEEDS: std::ops::Range<u64> = 0..12;
const SAMPLE: std::ops::Range<u64> = 0..4;

/// Conditions, parameters, alternatives by chance, erasure, nested blocks, a derive that ends of itself in each of
/// two turns, and rules that name what the ones before left alone.
const MANY: &str = "\
system many : patch bezier 3
param most: int = 3 in 0 .. 6
param chance: float = 0.5 in 0 .. 1
param rounds: int = 2 in 0 .. 3
module P(n: int), Q(n: int), R
axiom: P(most - 1) = file \"sheet.bpt\"
rules grow:
  P(n) : n > 0 -> [ P(n - 1) Q(n) ; [ P(n - 1) | Q(n) ] P(n - 2) ]
rules weed:
  Q(n) : n > 1 -> (chance) [ Q(n - 1) eps ; R R ] -> (1 - chance) [ Q(n - 1) | R ]
  P(n) : level > 2 -> R
rules last:
  R : rand() < chance -> [ R ; R ]
run:
  repeat rounds {
    derive until terminal max 5 with grow
    derive until terminal max 4 with weed
  }
  derive 1 with last
";

/// Growth as a closed form.
const CLOSED: &str = "\
system closed : patch bezier 3
module P
axiom: P = file \"sheet.bpt\"
rules:
  P -> [ P P ; eps P ]
run:
  derive 4
";

/// A step in which but the first of two sweeps has something to do, and rules that would fire again after a derive
/// has come to its end.
const ENDING: &str = "\
system ending : patch bezier 3
module P(n: int), Q
axiom: P(5) = file \"sheet.bpt\"
rules:
  P(n) : n > 3 -> [ [ P(n - 1) | Q ] P(n - 2) ; Q P(n - 1) ]
  P(n) : n > 0 -> P(n - 1)
  Q : step > 6 -> [ Q | Q ]
rules once:
  Q : rand() < 0.5 -> [ Q ; Q ]
run:
  derive until terminal max 9
  derive 1 with once
";

/// No sweep at all.
const NOTHING: &str = "\
system nothing : patch bezier 3
module P
axiom: P = file \"sheet.bpt\"
rules:
  P -> [ P | P ]
run:
  derive 0
";

fn submitted<S: Start + Clone>(engine: &Engine, run: &mut Run<S>) {
    let mut encoder = engine.device().create_command_encoder(&Default::default());
    run.encode(&mut encoder);
    engine.queue().submit([encoder.finish()]);
}

fn submit<S: Start + Clone>(engine: &Engine, run: &mut Run<S>) -> (Progress, S::Word) {
    submitted(engine, run);
    run.read().expect("a word")
}

fn sheet() -> Vec<Net> {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/sheet.bpt");
    burgeon::io::bpt::read(data, false).expect("a sheet")
}

fn of(text: &str) -> (Plan, Axiom) {
    let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&system).unwrap_or_else(|e| panic!("{e}"));
    let axiom = Axiom::load::<String>(&system, &mut |_| Ok(sheet())).expect("an axiom");
    (plan, axiom)
}

fn waited(engine: &Engine, plan: &Plan, axiom: &Axiom, options: &Options) -> Word {
    let Options { set, bind, view, seed } = options.clone();
    let options = plan::Options { set, bind, view, seed, ..plan::Options::default() };
    burgeon::gpu::derive(engine, plan, axiom, &options).expect("a word").0
}

fn params(most: i32, chance: f32, rounds: i32) -> Vec<(String, Value)> {
    let named = |name: &str, value| (name.to_string(), value);
    vec![
        named("most", Value::Int(most)),
        named("chance", Value::Float(chance)),
        named("rounds", Value::Int(rounds)),
    ]
}

#[test]
fn a_recorded_derivation_is_the_one_that_waits() {
    for (name, engine) in device::engines() {
        let (plan, axiom) = of(MANY);
        let mut run =
            Run::new(&engine, &plan, &axiom, &Options { seed: Some(7), ..Options::default() }, 5000)
                .expect("a run");
        // The same run, with other params each time, a longer schedule and none at all among them.
        for (most, chance, rounds) in
            [(3, 0.5, 2), (5, 0.25, 3), (2, 1.0, 1), (5, 0.0, 0), (0, 0.5, 2), (6, 0.75, 3)]
        {
            run.set(&params(most, chance, rounds)).expect("params");
            let what = format!("{most} {chance} {rounds} on {name}");
            let expected = waited(&engine, &plan, &axiom, run.options());
            let (progress, word) = submit(&engine, &mut run);
            assert!(progress.complete(), "{what}: {progress:?}");
            assert_eq!((word.steps, word.modules.len()), (expected.steps, expected.modules.len()), "{what}");
            assert_eq!(word, expected, "{what}");
            // And again, from what it left.
            assert_eq!(submit(&engine, &mut run).1, expected, "{what}");
        }
    }
}

#[test]
fn random_systems_are_the_same_recorded() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    for seed in tier::cases(SAMPLE, SEEDS) {
        let case = oracle::case(seed);
        let job = Job::new(&case.text, &case.nets, settings(&case));
        let options = Options { set: job.set.clone(), ..Options::default() };
        let mut run = Run::new(&engine, &job.plan, &job.axiom, &options, 1 << 15).expect("a run");
        let (progress, word) = submit(&engine, &mut run);
        assert!(progress.complete(), "{case}: {progress:?}");
        assert_eq!(word, waited(&engine, &job.plan, &job.axiom, &options), "{case}");
    }
}

#[test]
fn a_word_without_room_is_none_and_says_what_it_wanted() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (plan, axiom) = of(MANY);
    let options = Options::default();
    let expected = waited(&engine, &plan, &axiom, &options);
    let mut run = Run::new(&engine, &plan, &axiom, &options, 5000).expect("a run");
    let needed = submit(&engine, &mut run).0.needed;
    assert!(needed as usize >= expected.modules.len());
    run.set_capacity(needed).expect("room");
    let (progress, word) = submit(&engine, &mut run);
    assert_eq!((progress.needed, progress.capacity), (needed, needed));
    assert_eq!(word, expected);
    run.set_capacity(needed - 1).expect("room");
    let (progress, word) = submit(&engine, &mut run);
    assert!(!progress.complete() && progress.modules == 0 && progress.needed > needed - 1, "{progress:?}");
    assert!(word.modules.is_empty());
    // Not even the axiom's own room can be taken away.
    run.set_capacity(0).expect("room");
    assert_eq!(run.capacity() as usize, axiom.roots.len());
    assert!(!submit(&engine, &mut run).0.complete());
}

#[test]
fn what_cannot_be_recorded_is_refused_and_changes_nothing() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (plan, axiom) = of(MANY);
    let mut run = Run::new(&engine, &plan, &axiom, &Options::default(), 5000).expect("a run");
    let expected = submit(&engine, &mut run).1;
    for (wrong, says) in [
        (("most", Value::Int(7)), "lies outside 0 .. 6"),
        (("chances", Value::Float(0.1)), "no param of many"),
        (("most", Value::Float(0.1)), "of type int"),
    ] {
        let error = run.set(&[(wrong.0.to_string(), wrong.1)]).expect_err(says);
        assert!(error.to_string().contains(says), "{error}");
    }
    let values = burgeon::patch::Values::Roots(vec![Value::Int(1)]);
    assert!(matches!(run.bind("nothing", values), Err(Error::Plan(plan::Error::Bind(_)))));
    assert_eq!(submit(&engine, &mut run).1, expected);
    let long = "system long : patch bezier 3\nmodule P\naxiom: P = file \"sheet.bpt\"\nrules:\n  P -> [ P | P ]\n\
                run:\n  derive 5000\n";
    let (plan, axiom) = of(long);
    match Run::new(&engine, &plan, &axiom, &Options::default(), 10) {
        Err(e) => assert!(e.to_string().contains(&MOST_TURNS.to_string()), "{e}"),
        Ok(_) => panic!("5000 steps were recorded"),
    }
    // 32 halvings along one direction.
    let deep = long.replace("5000", "32").replace("P -> [ P | P ]", "P -> [ P | eps ]");
    let (plan, axiom) = of(&deep);
    let mut run = Run::new(&engine, &plan, &axiom, &Options::default(), 10).expect("a run");
    let progress = submit(&engine, &mut run).0;
    assert!(progress.too_deep != 0 && progress.modules == 0, "{progress:?}");
}

/// What the kernel between the sweeps says, broken on purpose.
const MUTANTS: &[mutants::Mutant] = &[
    ("proceed", "extents[0];\n  progress.capacity", "0u;\n  progress.capacity"),
    ("proceed", "progress.steps = 0u", "progress.steps += 1u"),
    ("proceed", "turn.growth * count", "turn.growth"),
    ("proceed", "fired = atomicLoad(&status.fired)", "fired = 1u"),
    ("proceed", "total = offsets[count]", "total = offsets[count - 1u]"),
    ("proceed", "progress.needed > progress.capacity ||", ""),
    ("proceed", "progress.fired |= fired", "progress.fired = fired"),
    ("proceed", "atomicStore(&status.fired, 0u);\n  if", "if"),
    ("proceed", "progress.halted = 1u", "progress.halted = 0u"),
    ("proceed", "if progress.halted == 0u", "if progress.halted <= 1u"),
    ("proceed", "progress.fired = 0u;\n  }\n  if", "}\n  if"),
    ("proceed", "(turn.flags & ENDS_DERIVE) != 0u", "false"),
    ("proceed", "RUN_STEP] = progress.steps", "RUN_STEP] = turn.index"),
    ("proceed", "HALTED] = progress.halted", "HALTED] = 0u"),
    ("proceed", "workgroups(total, turn.children)", "workgroups(total / 2u, turn.children)"),
    ("progress", "modules: u32,\n  needed: u32", "needed: u32,\n  modules: u32"),
    ("progress", "steps: u32,\n  frame: u32", "frame: u32,\n  steps: u32"),
    ("match_modules", "extent.halted == 0u", "true"),
    ("workgroups", "invocations + workgroup - 1u", "invocations"),
    ("workgroups", "min(groups, ALONG_X)", "min(groups, 1u)"),
];

#[test]
fn every_mutant_of_the_recording_is_seen() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let all = [
        (of(MANY), params(3, 0.5, 2)),
        (of(MANY), params(6, 0.75, 3)),
        (of(CLOSED), vec![]),
        (of(ENDING), vec![]),
        (of(NOTHING), vec![]),
    ];
    let options = |set: &Vec<_>| Options { set: set.clone(), ..Options::default() };
    let expected: Vec<Word> =
        all.iter().map(|((plan, axiom), set)| waited(&engine, plan, axiom, &options(set))).collect();
    // Twice each, then without room.
    let differs = |engine: &Engine| {
        for (((plan, axiom), set), expected) in all.iter().zip(&expected) {
            let mut run = Run::new(engine, plan, axiom, &options(set), 5000).expect("a run");
            let most = expected.modules.len() as u32;
            for _ in 0..2 {
                submitted(engine, &mut run);
                // What comes of a broken kernel may be no word.
                let Ok((progress, word)) = run.read() else { return true };
                if word != *expected || !progress.complete() || progress.needed < most {
                    return true;
                }
            }
            if most < 2 {
                continue;
            }
            run.set_capacity(most / 2).expect("room");
            submitted(engine, &mut run);
            let Ok((progress, _)) = run.read() else { return true };
            if progress.complete() || progress.modules != 0 {
                return true;
            }
        }
        false
    };
    assert!(!differs(&engine), "without a mutant");
    let difference = |engine: &Engine| differs(engine).then(|| "differs".to_string());
    let sample = mutants::sample(MUTANTS);
    mutants::assert_seen(sample.iter().filter_map(|&mutant| mutants::unseen(&engine, mutant, difference)));
}

/// How many mutants of a file are here.
pub fn mutants_of(file: &str) -> usize {
    MUTANTS.iter().filter(|m| m.0 == file).count() + curves::mutants_of(file)
}
