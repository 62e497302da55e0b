//! The conformance suite itself: its systems against the oracle, its cases on the devices, and that
//! it sees a kernel that is broken.

use crate::device;
use crate::limits::lattice;
use crate::oracle::{self, Tolerance};
use crate::tier;
use burgeon::codegen::{Edit, GENERATED as GENERATED_CODE};
use burgeon::conformance::systems::{GENERATED, Nets, Subject};
use burgeon::conformance::{self, Case, Outcome, Row, Verdict, operations, random, verdict};
use burgeon::cpu;
use burgeon::plan::Options;

/// `burgeon selftest` holds a device against the CPU; here the CPU is held against the oracle, over
/// the very same systems.
#[test]
fn oracle_and_cpu_agree_on_every_frozen_system() {
    let mut modules = 0;
    for subject in GENERATED {
        let Nets::Lattice(roots) = subject.nets else { panic!("{}: frozen with lattices", subject.name) };
        let words = oracle::derive(subject.text, &lattice(roots));
        for (step, expected) in words.iter().enumerate() {
            let word = cpu_word(subject, Some(step as u32));
            if let Err(e) = oracle::compare(expected, &word, Tolerance::Lattice { bits: 6, c: 4.0 }) {
                panic!("{}, after step {step}: {e}\n{}", subject.name, subject.text);
            }
            modules += word.modules.len();
        }
        assert_eq!(cpu_word(subject, None).steps as usize, words.len() - 1, "{}", subject.name);
    }
    assert!(modules > 5000, "{modules} modules say little");
}

fn cpu_word(subject: &Subject, steps: Option<u32>) -> burgeon::patch::Word {
    let job = subject.job();
    let options = Options { steps, ..Options::default() };
    cpu::derive(&job.plan, &job.axiom, &options, 1).expect("a word").0
}

/// Cases that say most for their time; `burgeon selftest` runs all.
fn chosen() -> Vec<Case> {
    let names = [
        "every",
        "values",
        "random 07",
        "scan, compact: 16 × 64",
        "operations on int and bool",
        "operations on float",
        "infinities and NaN",
        "operations on vec2",
        "operations on vec3",
        "operations on vec4",
        "elementary functions",
        "random numbers",
        "tessellation camera",
        "tessellation of rules",
        "tessellation displaced",
    ];
    let cases: Vec<Case> =
        conformance::cases().into_iter().filter(|c| names.contains(&c.name.as_str())).collect();
    assert_eq!(cases.len(), names.len());
    cases
}

#[test]
fn the_suite_passes() {
    for (n, (name, engine)) in device::both().into_iter().enumerate() {
        let mut cases = chosen();
        // The second engine compiles the same kernels by another way.
        cases.retain(|case| n == 0 || tier::is_all() || case.name == "every");
        let rows: Vec<Row> = cases.iter().map(|case| case.run(&engine, None)).collect();
        for row in &rows {
            println!("{:>6} ms  {}: {}", row.time.as_millis(), row.name, row.outcome);
            assert!(row.compared.values > 0 && row.compared.runs > 0, "{name}: {row:?}");
        }
        assert_eq!(verdict(&rows), Verdict::Agree, "{name}: {rows:?}");
    }
}

/// The case, run with a kernel broken on purpose, and what it says then.
#[track_caller]
fn broken(case: &str, file: &'static str, find: &'static str, replace: &'static str) -> String {
    let headless = device::headless().expect("an adapter");
    let engine = burgeon::gpu::Engine::new(&headless.device, &headless.queue);
    let engine = engine.with_edit(Edit { file, find, replace });
    let case = conformance::cases().into_iter().find(|c| c.name == case).expect("a case");
    let row = case.run(&engine, None);
    assert_eq!(verdict(std::slice::from_ref(&row)), Verdict::Differ, "{file}: `{find}`: {row:?}");
    match row.outcome {
        Outcome::Differs(what) => what,
        other => panic!("{other}"),
    }
}

#[test]
fn a_broken_kernel_is_seen_where_it_is() {
    if device::headless().is_none() {
        return;
    }
    let cases = [
        ("every", "match_modules", "if rule < KEEP", "if rule <= KEEP", "match_modules, "),
        ("every", "count", "& 255u", "& 3u", "count, "),
        ("every", "halving", "(p1 + p2) * 0.5", "(p1 + p2) * 0.25", "emit, "),
        ("every", "retire", "nets[i * POINTS + p]", "nets[k * POINTS + p]", "retire, "),
        (
            "every",
            "scan",
            "offsets[k] = base + before[k - own.start]",
            "offsets[k] = base + before[0]",
            "scan, ",
        ),
        ("scan, compact: 16 × 64", "compact", "hit << (k & 31u)", "hit << (k & 15u)", "compact of "),
        ("operations on float", GENERATED_CODE, "whole_part(", "whole_below(", "emit, float % float"),
        ("operations on int and bool", "ops", "return 0i;", "return 1i;", "emit, int % int"),
        ("elementary functions", "elementary", "0.16666655", "0.1666", "emit: sin("),
        ("random numbers", "elementary", "h >> 13u", "h >> 14u", "emit: number 0 of module 0 is frozen"),
        (
            "buffers too small, uneven",
            "children",
            "end > extent.capacity",
            "end >= extent.capacity",
            "modules into",
        ),
    ];
    for (case, file, find, replace, said) in cases {
        let what = broken(case, file, find, replace);
        assert!(what.contains(said), "{case}, {file}: {what}");
    }
}

#[test]
fn a_lost_device_is_a_failure_and_no_difference() {
    for (name, engine) in device::engines() {
        engine.device().destroy();
        for case in chosen() {
            let row = case.run(&engine, None);
            assert!(matches!(row.outcome, Outcome::Failed(_)), "{name}: {row:?}");
            assert_eq!(verdict(&[row]), Verdict::Failed);
        }
    }
}

#[test]
fn a_case_stops_when_asked() {
    let stop = std::sync::atomic::AtomicBool::new(true);
    let Some(headless) = device::headless() else { return };
    let engine = burgeon::gpu::Engine::new(&headless.device, &headless.queue);
    let case = conformance::cases().into_iter().find(|c| c.name == "example teapot").expect("a case");
    assert_eq!(verdict(&[case.run(&engine, Some(&stop))]), Verdict::Stopped);
}

/// A remainder jumps where a quotient is whole; a device may round that quotient either way.
#[test]
fn no_quotient_is_nearly_whole() {
    for x in operations::DIVIDENDS {
        for y in operations::DIVISORS {
            let quotient = f64::from(x) / f64::from(y);
            let apart = (quotient - quotient.round()).abs();
            assert!(
                quotient.abs() < 0.5 || apart > 4.0 * quotient.abs() * f64::from(f32::EPSILON),
                "{x} / {y}"
            );
        }
    }
}

#[test]
fn random_numbers_are_frozen() {
    let values = random::expressions().on_cpu(random::CLOCK, &random::modules()).expect("values");
    let bits: Vec<Vec<u32>> =
        values.iter().map(|m| m.iter().map(|v| v.words()[0]).collect::<Vec<u32>>()).collect();
    assert_eq!(bits, random::FROZEN.map(|m| m.to_vec()));
}
