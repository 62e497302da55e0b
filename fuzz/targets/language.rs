//! Text to diagnostics, tree, printed text, tables, WGSL and a few steps.
#![no_main]

#[path = "../../tests/fuzz/checks.rs"]
#[allow(dead_code)]
mod checks;

libfuzzer_sys::fuzz_target!(|text: &str| {
    checks::check_rules(text);
});
