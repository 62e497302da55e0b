//! Nearly right texts: rule files and files of nets and values whose words were deleted, doubled,
//! swapped or replaced. Nothing panics, nothing hangs, places lie inside the text, what parses prints
//! to what parses to the same, and what a reader accepts is whole.
//!
//! An input is made from bytes by [`arbitrary`], and the bytes from its number, so that a failure
//! names what repeats it.

mod checks;
mod texts;

use crate::oracle::Random;
use crate::tier;
use arbitrary::{Result, Unstructured};
use checks::{check_curves, check_files, check_rules, check_values};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use texts::{corpus, nearly_right, otherwise_right};

/// Inputs of each test.
fn inputs() -> u64 {
    tier::cases(600, 6_000)
}
/// No input may take longer, on a busy machine and without optimisation.
const LIMIT: Duration = Duration::from_secs(5);

/// From bytes and some texts to another.
type Make = fn(&mut Unstructured, &[String]) -> Result<String>;

/// Runs `check` on so many texts; a failure names the number and shows the text. Returns the sum of
/// what `check` counts: how often it came to the end.
fn fuzz(corpus: &[String], salt: u64, make: Make, check: impl Fn(&str) -> u64) -> u64 {
    let mut sum = 0;
    for n in 0..inputs() {
        let mut random = Random::new(n ^ salt);
        let bytes: Vec<u8> = (0..128).flat_map(|_| random.next().to_le_bytes()).collect();
        let text = make(&mut Unstructured::new(&bytes), corpus).expect("bytes enough");
        let start = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| check(&text))) {
            Ok(count) => sum += count,
            Err(_) => panic!("input {n} of {salt:#x}:\n{text}"),
        }
        assert!(start.elapsed() < LIMIT, "input {n} of {salt:#x} took {:?}:\n{text}", start.elapsed());
    }
    sum
}

#[test]
fn rules_that_are_nearly_right() {
    let folders = ["examples", "tests/data/language", "tests/data/refused", "tests/data/warned"];
    fuzz(&corpus(&folders, &["burgeon"]), 0x5eed_0001, nearly_right, check_rules);
}

#[test]
fn rules_that_are_right_but_for_a_word_are_derived() {
    let texts =
        corpus(&["examples", "src/conformance/systems", "src/conformance/systems/generated"], &["burgeon"]);
    let derived = fuzz(&texts, 0x5eed_0004, otherwise_right, check_rules);
    assert!(derived > inputs() / 10, "only {derived} words of {} texts", inputs());
}

const BV: &str = "Group 1 quarter\n8\n2 1\n1 0 0 1\n1 0 2 1\n0.7 0.7 0 0.7\n0.7 0.7 1.4 0.7\n0 1 0 1\n0 1 2 1\n\
    4\n1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n5\n1 2\n0 0 0\n0 1 0\n0 2 0\n1 0 0\n1 1 0\n1 2 0\n";

#[test]
fn files_of_nets_that_are_nearly_right() {
    let mut texts = corpus(&["examples/data", "tests/data/bpt", "tests/data/bv"], &["bpt", "bv", "obj"]);
    texts.push(BV.to_string());
    // Most of a long file says the same again and again.
    texts.iter_mut().for_each(|t| t.truncate(t.floor_char_boundary(3000)));
    let whole = fuzz(&texts, 0x5eed_0002, nearly_right, |text| check_files(text.as_bytes()));
    assert!(whole > inputs() / 20, "only {whole} files of {} texts", inputs());
}

#[test]
fn curves_that_are_nearly_right() {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 9 9\">\n<g transform=\"translate(1 2) scale(3)\">\n\
        <path d=\"M 1 1 L 2 1 H 3 v 4 Z m 2 2 l 1e3 -.5\"/>\n<polygon points=\"1,1 3,1 3,2 1,2\" id=\"a\"/> \
        <rect x=\"1\" y=\"2\" width=\"3\" height=\"4\" />\n</g>\n<line x2=\"3\" transform=\"rotate(45)\" /> \
        <circle r=\"2\"/>\n</svg>\n";
    let styled = "<svg width=\"9cm\" height=\"90%\"><style>.a, #b > path { display: none !important } g{visibility:hidden}</style>\n\
        <switch systemLanguage=\"en\"><g style=\"transform: rotate(10deg) translate(1px, 2%)\" id=\"b\"><rect rx=\".5\" width=\"2\" \
        height=\"3\" visibility=\"visible\"/> <path class=\"a\" d=\"m 0 0 a 1 2 3 0 1 0.5 .25 q 1 1 2 2 t 3 1 s 1 2 3 4 z\"/></g></switch>\n\
        <symbol id=\"s\" viewBox=\"0 0 2 3\"><ellipse rx=\"2\" ry=\"1\"/></symbol> <use href=\"#s\" x=\"1\" width=\"4\" height=\"4\" /> \
        <use href=\"#b\"/> <svg x=\"1\" viewBox=\"0 0 1 1\"><line x2=\"1\" /> </svg> </svg>\n";
    let obj = "v 0 0 0\nv 1 0 0.5 1\nv 2 1 0\nl 1 2 3\nl 1 3 -1 1\n";
    let edges = "v 0 0 0\nv 1 0 0\nv 1 1 \\\n 0\nl 1 2\nl 3 2\nl 3 1\nf 1 2 3\nl -1 2 1\n";
    let texts =
        [svg, styled, obj, edges, "x,y\n1,2\n3,4\n\n5,6\n", "1,2,3\n4,5,6\n-1e3,0,.5\n"].map(String::from);
    let whole = fuzz(&texts, 0x5eed_0005, nearly_right, |text| check_curves(text.as_bytes()));
    assert!(whole > inputs() / 20, "only {whole} files of {} texts", inputs());
}

#[test]
fn words_and_values_that_are_nearly_right() {
    let word = r#"{"version": 1, "kind": "patch", "system": "s", "steps": 1, "rational": false, "modules": [
      {"symbol": "A", "params": [3, true, 0.5, [1, 2]], "root": 0, "cell": [1, 0, 1, 0],
       "net": {"degree": [1, 1], "points": [[0, 0, 0, 1], [0, -0.0, 1, 1], [1, 0, 0, 1], [1, 0, 1, 1]]}}]}"#;
    let grid = r#"{"size": [2, 1, 2], "from": [0, 0, 0], "to": [1, 0, 1], "values": [1, 0.5, [1, 2], true]}"#;
    let texts = [word, grid, "0.5\n1\n-2e3\n", "1,2,3\n4,5,6\n", "true\nfalse\n"].map(String::from);
    let whole = fuzz(&texts, 0x5eed_0003, nearly_right, |text| check_values(text.as_bytes()));
    assert!(whole > inputs() / 20, "only {whole} files of {} texts", inputs());
}
