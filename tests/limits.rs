//! Nothing is lost silently: full buffers, full addresses, full memory, lost devices, and words of
//! every odd size.

mod bindings;
mod symbols;

use crate::device;
use crate::oracle::{self, Tolerance};
use crate::parity::{Job, settings, system};
use crate::small::Small;
use crate::tier;
use burgeon::codegen::{Mapping, Tuning};
use burgeon::conformance::capacity::{self, UNEVEN};
use burgeon::conformance::{self, systems::Nets};
use burgeon::gpu::{self, Engine, Gpu, Measure, Scans};
use burgeon::patch::Word;
use burgeon::plan::derive::{Backend, Derivation, bounds, collect, derive};
use burgeon::plan::{self, Options, Plan, schedule};
use std::cell::Cell;
use std::fmt::Debug;

/// Bytes of a module without parameters, or with up to two words of them.
const MODULE: u64 = 32 + 256;

/// The suite's nets as the oracle takes them.
pub fn lattice(count: usize) -> Vec<oracle::Net> {
    let net = |n: burgeon::patch::Net| {
        let points = n.points.iter().map(|p| p.map(f64::from)).collect();
        oracle::Net::new(n.degree.map(usize::from), points)
    };
    conformance::lattice(count).into_iter().map(net).collect()
}

fn job(text: &str, roots: usize) -> Job {
    Job::new(text, &lattice(roots), Vec::new())
}

/// A system of one unnamed group.
fn one_group(modules: &str, axiom: &str, rules: &str, run: &str) -> String {
    format!("system s : patch bezier 3\nmodule {modules}\naxiom: {axiom}\nrules:\n  {rules}\nrun:\n  {run}\n")
}

/// Full splits.
fn closed(steps: u32) -> String {
    one_group("P", "P = file \"x\"", "P -> [ P P ; P P ]", &format!("derive {steps}"))
}

/// The same behind a condition that always holds.
fn conditional(steps: u32) -> String {
    let rule = "P(n) : n < 99 -> [ P(n + 1) P(n + 1) ; P(n + 1) P(n + 1) ]";
    one_group("P(n: int)", "P(0) = file \"x\"", rule, &format!("derive {steps}"))
}

type Run<B> = Result<(Word, Derivation<<B as Backend>::Chunk, Word>), <B as Backend>::Error>;

/// Derives and reads.
fn run<B: Backend>(job: &Job, backend: &mut B, options: &Options) -> Run<B> {
    let derivation = derive(&job.axiom, options, backend)?;
    Ok((collect(backend, &derivation)?, derivation))
}

/// Why it fails; whatever the backend, it is the plan that says so.
#[track_caller]
fn refusal<B: Backend>(job: &Job, backend: &mut B, options: &Options) -> plan::Error
where
    B::Error: Debug + IntoPlan,
{
    match run(job, backend, options) {
        Ok((word, _)) => panic!("{} modules came of it", word.modules.len()),
        Err(e) => e.into_plan(),
    }
}

trait IntoPlan {
    fn into_plan(self) -> plan::Error;
}
impl IntoPlan for plan::Error {
    fn into_plan(self) -> plan::Error {
        self
    }
}
impl IntoPlan for gpu::Error {
    #[track_caller]
    fn into_plan(self) -> plan::Error {
        match self {
            gpu::Error::Plan(e) => e,
            other => panic!("{other:?}"),
        }
    }
}

/// The oracle's last word, compared with that of both backends.
#[track_caller]
fn assert_oracle(job: &Job, text: &str, roots: usize, chunk: Option<usize>) {
    let words = oracle::derive(text, &lattice(roots));
    let expected = words.last().expect("the axiom at least");
    let tolerance = Tolerance::Lattice { bits: 6, c: 4.0 };
    let check = |name: &str, word: Word| {
        if let Err(e) = oracle::compare(expected, &word, tolerance) {
            panic!("{name}, chunks of {chunk:?}: {e}\n{text}");
        }
        assert_eq!(word.steps as usize, words.len() - 1, "{name}\n{text}");
    };
    check("CPU", job.word(&mut job.cpu(2), None, chunk));
    for (name, engine) in device::engines() {
        check(&name, job.word(&mut job.gpu(&engine), None, chunk));
    }
}

// --- capacity ------------------------------------------------------------------------------------

/// Every engine with every mapping of emit.
fn all_engines() -> Vec<(String, Engine)> {
    let with = |(name, engine): (String, Engine)| {
        let mappings = [Mapping::NetPerInvocation, Mapping::PointPerInvocation, Mapping::LinePerInvocation];
        mappings.map(|mapping| {
            let tuning = Tuning { mapping, ..*engine.tuning() };
            (format!("{name}, {mapping:?}"), Engine::with_tuning(engine.device(), engine.queue(), tuning))
        })
    };
    device::engines().into_iter().flat_map(with).collect()
}

#[test]
fn a_buffer_too_small_is_named_and_nothing_is_written_behind_its_end() {
    for (text, roots) in [(capacity::CLOSED, 9), (UNEVEN, 3)] {
        let job = conformance::systems::Job::new(text, Nets::Lattice(roots)).expect("a system");
        for (name, engine) in all_engines() {
            capacity::compare(&engine, &job).unwrap_or_else(|e| panic!("{name}: {e}"));
        }
    }
}

// --- lost devices --------------------------------------------------------------------------------

#[derive(Clone, Copy, Debug, PartialEq)]
enum Moment {
    BeforeTheBackend,
    BeforeTheRun,
    BetweenSteps,
    BeforeReading,
}

/// A derivation whose device goes away.
fn run_and_lose(job: &Job, engine: &Engine, moment: Moment) -> Result<Word, gpu::Error> {
    let lose = |now: Moment| {
        if now == moment {
            engine.device().destroy();
        }
    };
    lose(Moment::BeforeTheBackend);
    let mut gpu = Gpu::new(engine, &job.plan)?;
    lose(Moment::BeforeTheRun);
    let progress = |_: plan::Progress| lose(Moment::BetweenSteps);
    let options = Options { progress: Some(&progress), ..Options::default() };
    let derivation = derive(&job.axiom, &options, &mut gpu)?;
    lose(Moment::BeforeReading);
    collect(&mut gpu, &derivation)
}

#[test]
fn a_device_that_is_lost_is_an_error_and_no_panic() {
    use Moment::*;
    for text in [closed(3), conditional(3), UNEVEN.to_string()] {
        let job = job(&text, 2);
        for moment in [BeforeTheBackend, BeforeTheRun, BetweenSteps, BeforeReading] {
            for (name, engine) in device::engines() {
                match run_and_lose(&job, &engine, moment) {
                    Err(gpu::Error::Lost { .. }) => {}
                    Err(e) => panic!("{name}, {moment:?}: {e:?}"),
                    Ok(word) => panic!("{name}, {moment:?}: {} modules", word.modules.len()),
                }
            }
        }
    }
}

#[test]
fn scans_on_a_lost_device_are_an_error_and_no_panic() {
    for (name, engine) in device::engines() {
        let scans = Scans::new(&engine).expect("kernels");
        let buffers = scans.prepare(Measure::Scan, &[1, 2, 3]).expect("buffers");
        engine.device().destroy();
        let result = scans.run(Measure::Scan, &buffers).and_then(|()| scans.read(Measure::Scan, &buffers));
        assert!(matches!(result, Err(gpu::Error::Lost { .. })), "{name}: {result:?}");
        assert!(
            scans.prepare(Measure::Scan, &[1]).and_then(|b| scans.read(Measure::Scan, &b)).is_err(),
            "{name}"
        );
    }
}

// --- addresses -----------------------------------------------------------------------------------

/// Symbols that go down along v, along u, and along both; every one of growth 1.
fn down(start: &str, condition: bool, steps: u32) -> String {
    let rule = |symbol: &str, block: &str| match condition {
        true => format!("{symbol}(n) : n < 99 -> {}\n", block.replace(symbol, &format!("{symbol}(n + 1)"))),
        false => format!("{symbol}(n) -> {}\n", block.replace(symbol, &format!("{symbol}(n)"))),
    };
    let rules = [
        ("V", "[ eps | V ]"),
        ("U", "[ U ; eps ]"),
        ("B", "[ eps eps ; B eps ]"),
        ("W", "[ W eps ; eps eps ]"),
    ]
    .map(|(symbol, block)| rule(symbol, block))
    .join("  ");
    let modules = "V(n: int), U(n: int), B(n: int), W(n: int)";
    one_group(modules, &format!("{start}(0) = file \"x\""), &rules, &format!("derive {steps}"))
}

#[test]
fn thirty_one_halvings_fit_an_address_and_one_more_is_refused() {
    let engines = all_engines();
    for (condition, start) in [false, true].into_iter().flat_map(|c| ["V", "U", "B", "W"].map(|s| (c, s))) {
        let text = down(start, condition, 31);
        let job31 = job(&text, 1);
        assert_eq!(job31.plan.tables.rule_sets[0].stages[0].closed.is_some(), !condition);
        let expected = oracle::derive(&text, &lattice(1)).pop().expect("words");
        let tolerance = Tolerance::Lattice { bits: 6, c: 4.0 };
        let one_more = job(&down(start, condition, 32), 1);
        let too_deep = |e: plan::Error, name: &str| {
            assert!(matches!(e, plan::Error::TooDeep { step: 32 }), "{name}: {e}\n{text}");
        };
        oracle::assert_same(31, &expected, &job31.word(&mut job31.cpu(1), None, None), tolerance);
        too_deep(refusal(&one_more, &mut one_more.cpu(1), &Options::default()), "CPU");
        for (name, engine) in &engines {
            oracle::assert_same(31, &expected, &job31.word(&mut job31.gpu(engine), None, None), tolerance);
            too_deep(refusal(&one_more, &mut one_more.gpu(engine), &Options::default()), name);
        }
    }
}

#[test]
fn nested_blocks_count_every_level_of_an_address() {
    // 16 steps of two halvings each, along v.
    let rules = "V -> [ eps | [ eps | V ] ]";
    let text = |steps: u32| one_group("V", "V = file \"x\"", rules, &format!("derive {steps}"));
    assert_oracle(&job(&text(15), 1), &text(15), 1, None);
    let one_more = job(&text(16), 1);
    let refused = |e: plan::Error| assert!(matches!(e, plan::Error::TooDeep { step: 16 }), "{e}");
    refused(refusal(&one_more, &mut one_more.cpu(1), &Options::default()));
    for (_, engine) in device::engines() {
        refused(refusal(&one_more, &mut one_more.gpu(&engine), &Options::default()));
    }
}

#[test]
fn a_retired_module_may_stand_at_the_bottom() {
    let rules = "V(n) : n < 31 -> [ V(n + 1) | Q ]\n  U(n) : n < 40 -> [ U(n + 1) ; eps ]";
    let text =
        one_group("V(n: int), U(n: int), Q", "V(0) = file \"x\"", rules, "derive until terminal max 60");
    assert_oracle(&job(&text, 1), &text, 1, None);
}

// --- memory --------------------------------------------------------------------------------------

fn within(max_bytes: u64) -> Options<'static> {
    Options { max_bytes, ..Options::default() }
}

/// Derives with some options: the word and the most bytes that were in use.
type Deriving<'d> = dyn FnMut(&Options) -> Result<(Word, u64), plan::Error> + 'd;

/// The same check on the CPU and on every device.
fn on_all(job: &Job, check: &dyn Fn(&str, &mut Deriving)) {
    let mut cpu = job.cpu(2);
    check("CPU", &mut |options| run(job, &mut cpu, options).map(|(word, d)| (word, d.peak_bytes)));
    for (name, engine) in device::engines() {
        let mut gpu = job.gpu(&engine);
        let mut derive = |options: &Options| match run(job, &mut gpu, options) {
            Ok((word, d)) => Ok((word, d.peak_bytes)),
            Err(e) => Err(e.into_plan()),
        };
        check(&name, &mut derive);
    }
}

#[test]
fn what_is_sure_not_to_fit_is_refused_before_anything_runs() {
    for text in [closed(9), one_group("P", "P = file \"x\"", "P -> [ P [ P P ; P P ] ; eps P ]", "derive 9")]
    {
        let job = job(&text, 1);
        let ran = Cell::new(0);
        let progress = |_: plan::Progress| ran.set(ran.get() + 1);
        on_all(&job, &|name, derive| {
            let error =
                derive(&Options { progress: Some(&progress), ..within(1000 * MODULE) }).expect_err(name);
            let plan::Error::Memory { needed, modules, step, budget } = error else {
                panic!("{name}: {error}")
            };
            assert_eq!((needed, budget), (modules * MODULE, 1000 * MODULE), "{name}");
            // The first step whose word is too large.
            let growth = if text.contains("[ P P ; P P ]\n") { 4u64 } else { 6 };
            assert!(growth.pow(step) == modules && growth.pow(step - 1) <= 1000 && modules > 1000, "{name}");
            assert_eq!(ran.get(), 0, "{name}");
        });
    }
}

#[test]
fn what_may_not_fit_runs_and_is_refused_when_it_does_not() {
    // It may become 4^12 modules, and does where n starts low enough.
    let text = |start: i32| {
        let rule = "P(n) : n < 3 -> [ P(n + 1) P(n + 1) ; P(n + 1) P(n + 1) ]";
        one_group("P(n: int)", &format!("P({start}) = file \"x\""), rule, "derive 12")
    };
    let small = job(&text(2), 1);
    on_all(&small, &|name, derive| {
        let (word, peak) = derive(&within(20 * MODULE)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(word.modules.len(), 4, "{name}");
        assert!(peak <= 20 * MODULE, "{name}: {peak}");
    });
    let large = job(&text(-9), 1);
    on_all(&large, &|name, derive| {
        let error = derive(&within(1000 * MODULE)).expect_err(name);
        let plan::Error::Memory { needed, modules, step, budget } = error else { panic!("{name}: {error}") };
        assert_eq!(budget, 1000 * MODULE, "{name}");
        assert_eq!(needed, modules * MODULE, "{name}");
        assert!(needed > budget && step == 5, "{name}: {needed} bytes in step {step}");
    });
}

#[test]
fn the_peak_is_the_word_and_what_the_step_writes() {
    for text in [closed(3), conditional(3)] {
        let job = job(&text, 2);
        on_all(&job, &|name, derive| {
            // 32 modules become 128.
            let exact = (32 + 128) * MODULE;
            let (word, peak) = derive(&within(exact)).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!((word.modules.len(), peak), (128, exact), "{name}");
            let error = derive(&within(exact - 1)).expect_err(name);
            let plan::Error::Memory { needed, step, budget, .. } = error else { panic!("{name}: {error}") };
            assert_eq!((needed, step, budget), (exact, 3, exact - 1), "{name}");
        });
    }
}

#[test]
fn a_word_in_pieces_peaks_lower_and_never_above_its_budget() {
    let job = job(&conditional(3), 2);
    on_all(&job, &|name, derive| {
        let cut = Options { chunk_modules: Some(4), ..Options::default() };
        let (whole, peak) = derive(&Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let (word, lower) = derive(&cut).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(word == whole && lower < peak && lower >= 128 * MODULE, "{name}: {lower} of {peak}");
        let (_, again) =
            derive(&Options { max_bytes: lower, ..cut }).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(again, lower, "{name}");
    });
}

// --- growth --------------------------------------------------------------------------------------

fn growth(plan: &Plan, job: &Job) -> Vec<burgeon::plan::size::Bounds> {
    let schedule = schedule::unroll(plan, &job.uniforms).expect("a schedule");
    let content = plan.axiom(&job.axiom, &job.uniforms).expect("an axiom");
    let records = content.records();
    bounds(plan, &job.uniforms, records, &schedule, u64::MAX)
}

#[test]
fn bounds_hold_for_random_systems_and_are_exact_where_they_say_so() {
    let (mut exact, mut open) = (0u64, 0u64);
    let count = tier::cases(60, 300);
    for seed in 0..count {
        let case = oracle::case(seed);
        let job = Job::new(&case.text, &case.nets, settings(&case));
        let words = case.derive();
        for (step, (bounds, word)) in growth(&job.plan, &job).iter().zip(&words).enumerate() {
            let count = word.modules.len() as u64;
            assert!(
                bounds.least <= count && count <= bounds.most,
                "{bounds:?} and {count} after {step}\n{case}"
            );
            if bounds.exact() { exact += 1 } else { open += 1 }
        }
    }
    assert!(exact > count / 3 && open > count / 3, "{exact} exact, {open} open");
}

#[test]
fn bounds_of_the_papers_systems_are_exact() {
    for (file, expected) in [
        ("sierpinski", vec![1, 4, 9, 27, 81, 243, 729]),
        ("sierpinski2", vec![2, 8, 18, 54, 162, 486, 1458]),
        ("teapot", vec![1, 4, 16, 64, 256, 1024, 4096]),
    ] {
        let text = std::fs::read_to_string(format!("examples/{file}.burgeon")).expect("an example");
        let job = job(&text, 1);
        let found = growth(&job.plan, &job);
        assert!(found.iter().all(|b| b.exact()), "{file}: {found:?}");
        // How deep an example goes by default may change.
        let found: Vec<u64> = found.iter().map(|b| b.least).collect();
        assert!(found.len() > 2 && expected.starts_with(&found), "{file}: {found:?}");
    }
}

#[test]
fn bounds_saturate_and_end_before_what_may_never_run() {
    let endless = job(&closed(1000), 1);
    let found = growth(&endless.plan, &endless);
    assert_eq!(found.last().map(|b| b.least), Some(u64::MAX));
    assert_eq!(found.len(), 33, "4^32 is the first that does not fit a u64");
    let text = one_group("P", "P = file \"x\"", "P -> [ P P ; P P ]", "derive until terminal max 40");
    let until = job(&text, 1);
    assert_eq!(growth(&until.plan, &until).len(), 1, "a derivation until terminal may end before any step");
}

// --- schedules -----------------------------------------------------------------------------------

#[test]
fn until_terminal_counts_the_steps_in_which_something_fired() {
    let rules = "P(n) : n > 0 -> [ P(n - 1) | Q ]";
    let text =
        |start: u32, run: &str| one_group("P(n: int), Q", &format!("P({start}) = file \"x\""), rules, run);
    for (start, run, steps) in [
        (3, "derive until terminal max 9", 3),
        (0, "derive until terminal max 9", 0),
        (5, "derive until terminal max 4", 4),
        (3, "derive until terminal max 0", 0),
        (3, "derive until terminal max 9\n  derive until terminal max 9", 3),
        (3, "derive until terminal max 9\n  derive 2", 5),
        (3, "repeat 2 { derive until terminal max 2 }", 3),
    ] {
        let text = text(start, run);
        let job = job(&text, 1);
        assert_oracle(&job, &text, 1, None);
        on_all(&job, &|name, derive| {
            let (word, _) = derive(&Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(word.steps, steps, "{name}\n{text}");
        });
    }
}

#[test]
fn no_step_at_all_gives_the_axiom() {
    for (text, limit) in
        [(closed(0), None), (closed(3), Some(0)), (conditional(0), None), (conditional(2), Some(0))]
    {
        let job = job(&text, 3);
        on_all(&job, &|name, derive| {
            let options = Options { steps: limit, ..Options::default() };
            let (word, peak) = derive(&options).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!((word.modules.len(), word.steps, peak), (3, 0, 3 * MODULE), "{name}");
            let roots: Vec<u32> = word.modules.iter().map(|m| m.root).collect();
            assert_eq!(roots, [0, 1, 2], "{name}");
        });
    }
}

#[test]
fn an_axiom_without_roots_gives_a_word_without_modules() {
    for text in [closed(3), conditional(3), UNEVEN.to_string()] {
        let job = job(&text, 0);
        let steps = schedule::unroll(&job.plan, &job.uniforms)
            .expect("a schedule")
            .iter()
            .map(|act| act.rewrite().count)
            .sum::<u32>();
        on_all(&job, &|name, derive| {
            let (word, peak) = derive(&Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!((word.modules.len(), word.nets.len(), word.steps, peak), (0, 0, steps, 0), "{name}");
        });
    }
}

#[test]
fn a_word_that_dies_out_goes_on_with_no_modules() {
    let text = one_group("P, Q", "P = file \"x\"", "P -> [ eps Q ; Q eps ]\n  Q -> eps", "derive 5");
    assert_oracle(&job(&text, 2), &text, 2, Some(1));
}

// --- chunks --------------------------------------------------------------------------------------

#[test]
fn words_beyond_one_chunk_are_split_and_come_out_the_same() {
    for &seed in tier::cases(&[3, 21][..], &[3, 8, 21, 34, 55]) {
        let case = oracle::case(seed);
        let job = Job::new(&case.text, &case.nets, settings(&case));
        let steps = case.steps.map(|s| s as u32);
        let whole = job.word(&mut job.cpu(1), steps, None);
        for most in [4, 10, 50] {
            let mut small = Small { inner: job.cpu(2), most };
            assert!(job.word(&mut small, steps, None) == whole, "CPU, chunks within {most}\n{case}");
        }
        for (name, engine) in device::engines() {
            let mut small = Small { inner: job.gpu(&engine), most: 20 };
            assert!(job.word(&mut small, steps, None) == whole, "{name}, chunks within 20\n{case}");
            for chunk in [3, 64] {
                let word = job.word(&mut job.gpu(&engine), steps, Some(chunk));
                assert!(word == whole, "{name}, chunks of {chunk}\n{case}");
            }
        }
    }
}

// --- retirement ----------------------------------------------------------------------------------

/// 70 symbols, so that three of them share a bit of the mask of finished chunks.
fn seventy() -> String {
    let names: Vec<String> = (0..70).map(|n| format!("S{n}")).collect();
    format!(
        "system seventy : patch bezier 3\nmodule {}\naxiom: S0 = file \"x\"  S69 = file \"x\"\n\
         rules:\n  S0 -> [ S1 S33 ; S65 S40 ]\n  S69 -> [ S37 | S5 ]\n\
         rules second:\n  S65 -> [ S2 | S34 ]\n  S5 -> [ S66 ; eps ]\n\
         rules third:\n  S34 -> [ S66 | eps ]\n  S1 -> S65\n\
         rules last:\n  S66 -> [ S69 S69 ; S69 S69 ]\n\
         run:\n  derive 2\n  derive 1 with second\n  derive 2 with third\n  derive 1 with second, third\n  derive 3 with last\n",
        names.join(", ")
    )
}

#[test]
fn finished_modules_come_back_when_a_later_group_names_them() {
    let text = seventy();
    let job = job(&text, 2);
    for chunk in [None, Some(1), Some(3)] {
        assert_oracle(&job, &text, 2, chunk);
    }
}

#[test]
fn the_order_of_the_word_does_not_depend_on_what_was_retired_when() {
    let text = "\
system orders : patch bezier 3
module A(n: int), B(n: int), C(n: int)
axiom: C(0) = file \"x\"  A(0) = file \"x\"
rules grow:
  A(n) : n < 2 -> [ B(n) A(n + 1) ; A(n + 1) C(n) ]
rules thin:
  B(n) : n % 2 == 0 -> [ C(n) | A(5) ]
  C(n) : n > 0      -> [ A(0) ; eps ]
rules turn:
  C(n) -> A(n)
run:
  derive 3 with grow
  derive 2 with thin
  derive 2 with grow, thin
  repeat 2 {
    derive until terminal max 3 with grow
    derive 1 with turn
  }
  derive 1 with thin
";
    let job = job(text, 2);
    for chunk in [None, Some(1), Some(5)] {
        assert_oracle(&job, text, 2, chunk);
    }
    let word = job.word(&mut job.cpu(2), None, None);
    assert!(word.modules.is_sorted_by_key(|m| (m.root, m.key)), "depth-first");
    assert!(word.modules.len() > 50, "{}", word.modules.len());
}

/// More workgroups than go in one dimension: 40,000 of one invocation.
#[test]
fn more_workgroups_than_one_dimension_holds_are_all_run() {
    let Some(headless) = device::headless() else { return };
    let text = one_group("P(n: int)", "P(0) = file \"x\"", "P(n) : n < 1 -> [ P(n + 1) | eps ]", "derive 2");
    let job = job(&text, 40_000);
    let expected = job.word(&mut job.cpu(2), None, None);
    for (workgroup, mapping) in [(1, Mapping::NetPerInvocation), (16, Mapping::PointPerInvocation)] {
        let tuning = Tuning { workgroup, mapping, scan_workgroup: 2, scan_items: 32 };
        let engine = Engine::with_tuning(&headless.device, &headless.queue, tuning);
        assert!(job.word(&mut job.gpu(&engine), None, None) == expected, "{tuning:?}");
    }
}

/// It must check, or the tests above say nothing.
#[test]
fn the_systems_of_these_tests_check() {
    assert_eq!(system(&seventy()).symbols.len(), 70);
}
