//! Every reader: nets, curves, words, values; and every writer of what was read.
#![no_main]

#[path = "../../tests/fuzz/checks.rs"]
#[allow(dead_code)]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::check_files(bytes);
    checks::check_curves(bytes);
    checks::check_values(bytes);
});
