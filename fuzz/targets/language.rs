//! Text to diagnostics, tree, tables and WGSL.
#![no_main]

use burgeon::codegen::{self, Tuning};
use burgeon::language::print::print;
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{compile, diagnostic, parse};
use burgeon::plan::Plan;
use burgeon::plan::derive::StageId;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let parsed = parse::parse(text);
    if parsed.diagnostics.is_empty() {
        let printed = print(&parsed.file);
        let again = parse::parse(&printed);
        assert!(again.diagnostics.is_empty() && again.file == parsed.file, "printed:\n{printed}");
    }
    let checked = compile(text, &Vocabulary::default());
    diagnostic::render(&checked.diagnostics, "fuzz.burgeon", text, false);
    if checked.has_errors() {
        return;
    }
    for plan in checked.systems.iter().filter_map(|system| Plan::new(system).ok()) {
        let sets = plan.tables.rule_sets.iter().enumerate();
        let ids = sets.flat_map(|(rule_set, s)| (0..s.stages.len()).map(move |stage| StageId { rule_set, stage }));
        for id in ids.take(4) {
            codegen::stage(&plan, id, &Tuning::CPU_DRIVER).expect("naga accepts what the tables say");
        }
    }
});
