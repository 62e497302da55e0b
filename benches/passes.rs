//! The passes of a step and the language, each by itself, on the CPU: `cargo bench`.
//!
//! For CPU and GPU side by side, against the machine's bandwidth, run `burgeon bench`.

use burgeon::codegen::{self, Tuning};
use burgeon::cpu::{Cpu, compact, scan};
use burgeon::language::compile;
use burgeon::language::vocabulary::Vocabulary;
use burgeon::patch::{Axiom, Net};
use burgeon::plan::derive::{Backend, Outcome, StageId};
use burgeon::plan::step::Clock;
use burgeon::plan::{Content, Plan};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const CONDITIONAL: &str = "system conditional : patch bezier 3\nmodule P(l: int)\n\
    axiom: P(0) = file \"nets.bpt\"\nrules:\n  P(l) : l < 9 -> [ P(l+1) P(l+1) ; P(l+1) P(l+1) ]\n";
const PLAIN: &str = "system plain : patch bezier 3\nmodule P\naxiom: P = file \"nets.bpt\"\n\
    rules:\n  P -> [ P P ; P P ]\n";
const NETS: usize = 1 << 14;
const FIRST: StageId = StageId { rule_set: 0, stage: 0 };

fn plan(text: &str) -> (Plan, Axiom) {
    let system = compile(text, &Vocabulary::default()).systems.remove(0);
    let points = (0..16).map(|k| [(k / 4) as f32, (k * 7 % 5) as f32, (k % 4) as f32, 1.0]).collect();
    let nets = vec![Net { degree: [3, 3], points }; NETS];
    let axiom = Axiom::load::<String>(&system, &mut |_| Ok(nets.clone())).expect("an axiom");
    (Plan::new(&system).expect("a plan"), axiom)
}

fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("patch/step");
    for (name, text) in [("plain", PLAIN), ("conditional", CONDITIONAL)] {
        let (plan, axiom) = plan(text);
        let mut cpu = Cpu::new(&plan, 0).expect("threads");
        let chunk = cpu.upload(plan.axiom(&axiom, &[]).expect("nets")).expect("a chunk");
        group.throughput(Throughput::Bytes(5 * NETS as u64 * plan.tables.layout.module_bytes()));
        group.bench_function(name, |b| {
            b.iter(|| match cpu.step(FIRST, Clock::default(), &chunk, u64::MAX) {
                Ok(Outcome::Done { next: Some(next), .. }) => cpu.recycle(next),
                _ => panic!("the step makes modules"),
            })
        });
    }
    group.finish();
}

/// The same symbols in their contexts, rewritten here and by `symbios`, which works on one thread.
fn words(c: &mut Criterion) {
    const LENGTH: usize = 3 << 16;
    let system = compile(include_str!("../src/command/bench/symbols.burgeon"), &Vocabulary::default());
    let plan = Plan::new(&system.systems[0]).expect("a plan");
    let mut group = c.benchmark_group("word/context");
    group.throughput(Throughput::Elements(LENGTH as u64)).sample_size(10);
    for threads in [1, 2] {
        let mut cpu = Cpu::new(&plan, threads).expect("threads");
        let record = |n: usize| [n as u32 % 3, 0, 0, 0];
        let records = (0..LENGTH).flat_map(record).collect();
        let chunk = cpu.upload(Content::of_records(records)).expect("a chunk");
        let chunk = cpu.join(vec![chunk], false).expect("a word").remove(0);
        group.bench_function(format!("burgeon, {threads} threads"), |b| {
            b.iter(|| match cpu.step(FIRST, Clock::default(), &chunk, u64::MAX) {
                Ok(Outcome::Done { next: Some(next), .. }) => {
                    // The two at the ends keep themselves.
                    assert_eq!(cpu.len(&next), LENGTH / 3 * 5 - 1);
                    cpu.recycle(next);
                }
                _ => panic!("the step makes modules"),
            })
        });
    }
    group.bench_function("symbios", |b| {
        let made = || {
            let mut symbols = symbios::System::new();
            symbols.max_capacity = 4 * LENGTH;
            for rule in ["C < A > B -> A C", "A < B > C -> B A", "B < C > A -> C"] {
                symbols.add_rule(rule).expect("a rule");
            }
            symbols.set_axiom(&"A B C ".repeat(LENGTH / 3)).expect("an axiom");
            symbols
        };
        b.iter_batched_ref(
            made,
            |symbols| {
                symbols.derive(1).expect("a step");
                assert_eq!(symbols.state.len(), LENGTH / 3 * 5 - 1);
            },
            BatchSize::PerIteration,
        )
    });
    group.finish();
}

fn scans(c: &mut Criterion) {
    let source: Vec<u32> = (0..1u32 << 20).map(|i| i.wrapping_mul(2_654_435_769) >> 30).collect();
    let mut offsets = vec![0; source.len() + 1];
    let mut indices = Vec::new();
    let mut group = c.benchmark_group("prefix sums");
    group.throughput(Throughput::Elements(source.len() as u64));
    group.bench_function("scan", |b| b.iter(|| scan::scan(black_box(&source), &mut offsets)));
    group.bench_function("compact", |b| b.iter(|| compact::compact(black_box(&source), 1, &mut indices)));
    group.finish();
}

fn language(c: &mut Criterion) {
    c.bench_function("language/text to validated WGSL", |b| {
        b.iter(|| {
            let system = compile(black_box(CONDITIONAL), &Vocabulary::default()).systems.remove(0);
            let plan = Plan::new(&system).expect("a plan");
            codegen::stage(&plan, FIRST, &Tuning::GPU).expect("kernels")
        })
    });
}

criterion_group!(benches, step, words, scans, language);
criterion_main!(benches);
