//! Cases of one kernel by itself: the machine's bandwidth, scans; and of the language.

use super::systems::{CONDITIONAL, PLAIN, plan};
use super::{Case, Failure, threads};
use burgeon::plan::derive::StageId;
use burgeon::{codegen, cpu};
use std::time::{Duration, Instant};

/// vec4s that `copy` and `expand` read: 16 MiB, and 64 MiB for the copy of the same traffic.
pub(super) const ELEMENTS: usize = 1 << 20;
/// Elements of `scan` and `compact`.
pub(super) const SCAN_ELEMENTS: usize = 1 << 24;

pub(super) fn bandwidth_cases(cases: &mut Vec<Case>) {
    let threads = threads();
    let source = vec![[0.5f32; 4]; 4 * ELEMENTS];
    let mut out = vec![[1.0f32; 4]; 4 * ELEMENTS];
    let input = source.clone();
    cases.push(Case {
        name: "copy",
        case: "64 MiB".to_string(),
        backend: "cpu",
        threads,
        bytes: 2 * 64 * ELEMENTS as u64,
        items: 4 * ELEMENTS as u64,
        run: Box::new(move || infallible(|| cpu::copy::copy(&input, &mut out))),
        times: vec![],
    });
    let mut out = vec![[1.0f32; 4]; 4 * ELEMENTS];
    cases.push(Case {
        name: "expand",
        case: "16 MiB to 64 MiB".to_string(),
        backend: "cpu",
        threads,
        bytes: 80 * ELEMENTS as u64,
        items: ELEMENTS as u64,
        run: Box::new(move || infallible(|| cpu::expand::expand(&source[..ELEMENTS], &mut out))),
        times: vec![],
    });
}

/// Chains of a product and a sum in four lanes, on all threads: what arithmetic gives. Items are flops.
pub(super) fn flops_case(cases: &mut Vec<Case>) {
    const CHAINS: usize = 12;
    const STEPS: u32 = 1 << 20;
    let threads = threads();
    let chains = move || {
        let mut sums = [glam::Vec4::ONE; CHAINS];
        let (a, b) = (std::hint::black_box(glam::Vec4::splat(0.999)), glam::Vec4::splat(0.001));
        for _ in 0..STEPS {
            for sum in &mut sums {
                *sum = *sum * a + b;
            }
        }
        std::hint::black_box(sums);
    };
    cases.push(Case {
        name: "flops",
        case: "products and sums, items are flops".to_string(),
        backend: "cpu",
        threads,
        bytes: 0,
        items: threads as u64 * CHAINS as u64 * u64::from(STEPS) * 8,
        run: Box::new(move || {
            infallible(|| {
                std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(chains))));
            })
        }),
        times: vec![],
    });
}

pub(super) fn infallible(work: impl FnOnce()) -> Result<Duration, Failure> {
    let start = Instant::now();
    work();
    Ok(start.elapsed())
}

pub(super) fn scan_source() -> Vec<u32> {
    (0..SCAN_ELEMENTS as u32).map(|i| i.wrapping_mul(2_654_435_769) >> 30).collect()
}

pub(super) fn scan_cases(cases: &mut Vec<Case>) {
    let (threads, n) = (threads(), SCAN_ELEMENTS as u64);
    let source = scan_source();
    let mut offsets = vec![0; SCAN_ELEMENTS + 1];
    let input = source.clone();
    cases.push(Case {
        name: "scan",
        case: format!("{n} u32"),
        backend: "cpu",
        threads,
        bytes: 12 * n,
        items: n,
        run: Box::new(move || infallible(|| cpu::scan::scan(&input, &mut offsets))),
        times: vec![],
    });
    let mut indices = Vec::new();
    let kept = source.iter().filter(|s| **s == 1).count() as u64;
    cases.push(Case {
        name: "compact",
        case: format!("{n} u32, a quarter kept"),
        backend: "cpu",
        threads,
        bytes: 8 * n + 4 * kept,
        items: n,
        run: Box::new(move || infallible(|| cpu::compact::compact(&source, 1, &mut indices))),
        times: vec![],
    });
}

/// Text to checked, linked and validated WGSL.
pub(super) fn language_cases(cases: &mut Vec<Case>) {
    for (name, text) in [("plain", PLAIN), ("conditional", CONDITIONAL), ("sierpinski2", SIERPINSKI)] {
        let run = move || {
            let start = Instant::now();
            let plan = plan(text)?;
            let tuning = codegen::Tuning::CPU_DRIVER;
            let fail = |e: codegen::Error| Failure::Device(format!("error: {e}"));
            for stage in 0..plan.tables.rule_sets[0].stages.len() {
                codegen::stage(&plan, StageId { rule_set: 0, stage }, &tuning).map_err(fail)?;
            }
            codegen::shared(&plan, &tuning).map_err(fail)?;
            Ok(start.elapsed())
        };
        cases.push(Case {
            name: "language",
            case: format!("{name}: text to validated WGSL"),
            backend: "cpu",
            threads: 1,
            bytes: 0,
            items: text.len() as u64,
            run: Box::new(run),
            times: vec![],
        });
    }
}

pub(super) const SIERPINSKI: &str = include_str!("../../../examples/sierpinski2.burgeon");
