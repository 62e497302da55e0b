//! Rule files of the examples and the conformance suite with words changed, as `tests/fuzz.rs` changes
//! them: what the coverage steers is the choice of changes, so most texts are derived.
#![no_main]

#[path = "../../tests/fuzz/checks.rs"]
#[allow(dead_code)]
mod checks;
#[path = "../../tests/fuzz/texts.rs"]
mod texts;

use arbitrary::Unstructured;
use std::sync::LazyLock;

static RULES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../");
    let folders = ["examples", "src/conformance/systems", "src/conformance/systems/generated"];
    let folders = folders.map(|folder| format!("{root}{folder}"));
    texts::corpus(&folders.each_ref().map(String::as_str), &["burgeon"])
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut u = Unstructured::new(bytes);
    let make = if u.ratio(1, 4).unwrap_or(false) { texts::nearly_right } else { texts::otherwise_right };
    if let Ok(text) = make(&mut u, &RULES) {
        checks::check_rules(&text);
    }
});
