//! Nearly right texts: rule files and files of nets and values whose words were deleted, doubled,
//! swapped or replaced. Nothing panics, nothing hangs, places lie inside the text, what parses prints
//! to what parses to the same, and what a reader accepts is whole.
//!
//! An input is made from bytes by [`arbitrary`], and the bytes from its number, so that a failure
//! names what repeats it.

use crate::oracle::Random;
use arbitrary::{Result, Unstructured};
use burgeon::language::expr::Type;
use burgeon::language::print::print;
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{Span, System, compile, diagnostic, parse};
use burgeon::patch::{self, Axiom, Net, Word};
use burgeon::plan::{Options, Plan};
use burgeon::{cpu, io};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Inputs of each test.
const INPUTS: u64 = 6_000;
/// No input may take longer, on a busy machine and without optimisation.
const LIMIT: Duration = Duration::from_secs(5);

/// Words that some reader may stumble over.
const AWKWARD: [&str; 40] = [
    "",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ";",
    "|",
    "->",
    "→",
    ":",
    ",",
    "&&",
    "#",
    "@",
    "?E(d)",
    "eps",
    "ε",
    "system",
    "rules:",
    "derive until terminal max",
    "0",
    "-1",
    "4294967296",
    "1e999",
    "1e-999",
    "nan",
    "inf",
    "-0.0",
    "99999999999999999999",
    "0.1",
    "\"",
    "//",
    "\u{feff}",
    "\r",
    "\u{0}",
    "𝛆",
    "((((((((((((((((",
    "if(a, b, c)",
];

fn corpus(folders: &[&str], extensions: &[&str]) -> Vec<String> {
    let mut texts = Vec::new();
    for folder in folders {
        let mut paths: Vec<_> =
            std::fs::read_dir(folder).expect(folder).flatten().map(|e| e.path()).collect();
        paths.sort();
        let fits =
            |p: &&std::path::PathBuf| p.extension().is_some_and(|e| extensions.iter().any(|x| e == *x));
        let small = |text: &String| text.len() < 20_000;
        texts.extend(paths.iter().filter(fits).filter_map(|p| std::fs::read_to_string(p).ok()).filter(small));
    }
    assert!(!texts.is_empty(), "nothing of {extensions:?} in {folders:?}");
    texts
}

/// Words, runs of spaces, and single signs.
fn words(text: &str) -> Vec<String> {
    let kind = |c: char| match c {
        c if c.is_alphanumeric() || c == '_' || c == '.' => 0,
        ' ' | '\t' => 1,
        c => c as u32 + 2,
    };
    let mut list: Vec<String> = Vec::new();
    let mut last = None;
    for c in text.chars() {
        match list.last_mut() {
            Some(word) if last == Some(kind(c)) && kind(c) < 2 => word.push(c),
            _ => list.push(c.to_string()),
        }
        last = Some(kind(c));
    }
    list
}

/// One of the texts with some words changed.
fn nearly_right(u: &mut Unstructured, corpus: &[String]) -> Result<String> {
    let mut list = words(u.choose(corpus)?);
    // Mostly few: what is far from right is refused at once.
    for _ in 0..*u.choose(&[1, 1, 1, 2, 2, 3, 6])? {
        if list.is_empty() {
            break;
        }
        let at = u.choose_index(list.len())?;
        let other = u.choose_index(list.len())?;
        match u.int_in_range(0..=6)? {
            0 => drop(list.remove(at)),
            1 => list.insert(at, list[other].clone()),
            2 => list.swap(at, other),
            3 => list[at] = u.choose(&AWKWARD)?.to_string(),
            4 => list.insert(at, u.choose(&AWKWARD)?.to_string()),
            5 => list.truncate(at),
            // A run of words, again and again.
            _ => {
                let run: Vec<String> = list[at.min(other)..at.max(other).min(at.min(other) + 12)].to_vec();
                for _ in 0..u.int_in_range(1..=40)? {
                    list.splice(at..at, run.iter().cloned());
                }
            }
        }
    }
    Ok(list.concat())
}

/// From bytes and some texts to another.
type Make = fn(&mut Unstructured, &[String]) -> Result<String>;

/// Runs `check` on so many texts; a failure names the number and shows the text. Returns the sum of
/// what `check` counts: how often it came to the end.
fn fuzz(corpus: &[String], salt: u64, make: Make, check: impl Fn(&str) -> u64) -> u64 {
    let mut sum = 0;
    for n in 0..INPUTS {
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

/// One of the texts with some of its words changed for others of their kind: most still check.
fn otherwise_right(u: &mut Unstructured, corpus: &[String]) -> Result<String> {
    const NUMBERS: [&str; 9] = ["0", "1", "2", "3", "7", "0.5", "1/3", "2147483647", "1e9"];
    const SIGNS: [&str; 10] = ["+", "-", "*", "/", "%", "<", ">", "|", ";", "!"];
    let mut list = words(u.choose(corpus)?);
    let is_name = |w: &&String| w.starts_with(|c: char| c.is_alphabetic());
    let names: Vec<String> = list.iter().filter(is_name).cloned().collect();
    for _ in 0..u.int_in_range(1..=3)? {
        let at = u.choose_index(list.len())?;
        // The next word that has others of its kind.
        for word in list.iter_mut().skip(at) {
            let other = match word.chars().next() {
                Some(c) if c.is_ascii_digit() => *u.choose(&NUMBERS)?,
                Some(c) if c.is_alphabetic() => u.choose(&names)?,
                Some(_) if SIGNS.contains(&word.as_str()) => *u.choose(&SIGNS)?,
                _ => continue,
            };
            *word = other.to_string();
            break;
        }
    }
    Ok(list.concat())
}

fn assert_inside(span: Span, text: &str) {
    let (start, end) = (span.start as usize, span.end as usize);
    assert!(start <= end && text.is_char_boundary(start) && text.is_char_boundary(end), "{span:?}");
}

/// Returns how many of its systems were derived.
fn check_rules(text: &str) -> u64 {
    let parsed = parse::parse(text);
    let checked = compile(text, &Vocabulary::default());
    for d in parsed.diagnostics.iter().chain(&checked.diagnostics) {
        assert_inside(d.span, text);
        d.labels.iter().for_each(|(span, _)| assert_inside(*span, text));
    }
    let shown = diagnostic::render(&checked.diagnostics, "fuzz.burgeon", text, false);
    assert_eq!(shown.is_empty(), checked.diagnostics.is_empty());
    if parsed.diagnostics.is_empty() {
        let printed = print(&parsed.file);
        let again = parse::parse(&printed);
        assert!(again.diagnostics.is_empty() && again.file == parsed.file, "printed:\n{printed}");
    }
    if checked.has_errors() {
        return 0;
    }
    // Each is planned, or refused by name.
    let derived = |system: &System| match Plan::new(system) {
        Ok(plan) => derive(system, &plan),
        Err(e) => {
            assert_inside(e.span, text);
            0
        }
    };
    checked.systems.iter().map(derived).sum()
}

/// A few steps on the CPU within little memory: a word that holds together, or an error in words.
/// Returns how many words came.
fn derive(system: &System, plan: &Plan) -> u64 {
    let degree = plan.tables.layout.degree;
    let points = (0..patch::net_points(degree)).map(|k| [k as f32, (k * k % 7) as f32, 1.0, 1.0]).collect();
    let net = Net { degree, points };
    let Ok(axiom) = Axiom::load::<String>(system, &mut |_| Ok(vec![net.clone(); 2])) else { return 0 };
    let options = Options { steps: Some(3), max_bytes: 1 << 18, ..Options::default() };
    match cpu::derive(plan, &axiom, &options, 1) {
        Ok((word, _)) => {
            word.validate().expect("a word holds together");
            1
        }
        Err(e) => {
            assert!(!e.to_string().is_empty());
            0
        }
    }
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
    assert!(derived > INPUTS / 10, "only {derived} words of {INPUTS} texts");
}

/// What a reader accepts is whole, and comes back the same from what is written. Returns 1 if so.
fn check_nets(nets: &[Net]) -> u64 {
    for net in nets {
        assert_eq!(net.points.len(), patch::net_points(net.degree));
        assert!(net.points.iter().flatten().all(|x| x.is_finite()), "{net:?}");
        assert!(net.points.iter().all(|p| p[3] > 0.0), "{net:?}");
    }
    // Nets of several degrees, or too large to be halved, are no word.
    let Ok(word) = Word::from_nets("s", "P", nets) else { return 0 };
    let mut written = Vec::new();
    io::bv::write(&mut written, &word).expect("what is read is written");
    assert_eq!(io::bv::parse(&written, true).expect("and read again"), nets);
    if !word.rational {
        written.clear();
        io::bpt::write(&mut written, &word).expect("what is read is written");
        assert_eq!(io::bpt::parse(&written, false).expect("and read again"), nets);
    }
    u64::from(!nets.is_empty())
}

const BV: &str = "Group 1 quarter\n8\n2 1\n1 0 0 1\n1 0 2 1\n0.7 0.7 0 0.7\n0.7 0.7 1.4 0.7\n0 1 0 1\n0 1 2 1\n\
    4\n1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n5\n1 2\n0 0 0\n0 1 0\n0 2 0\n1 0 0\n1 1 0\n1 2 0\n";

#[test]
fn files_of_nets_that_are_nearly_right() {
    let mut texts = corpus(&["examples/data", "tests/data/bpt", "tests/data/bv"], &["bpt", "bv", "obj"]);
    texts.push(BV.to_string());
    // Most of a long file says the same again and again.
    texts.iter_mut().for_each(|t| t.truncate(t.floor_char_boundary(3000)));
    let whole = fuzz(&texts, 0x5eed_0002, nearly_right, |text| {
        let mut whole = 0;
        for rational in [false, true] {
            for parse in [io::bpt::parse, io::bv::parse, io::obj::parse_bspline] {
                match parse(text.as_bytes(), rational) {
                    Ok(nets) => whole += check_nets(&nets),
                    Err(e) => {
                        assert!(e.line >= 1 && e.line <= text.split('\n').count() && e.column >= 1, "{e}")
                    }
                }
            }
        }
        whole
    });
    assert!(whole > INPUTS / 20, "only {whole} files of {INPUTS} texts");
}

#[test]
fn words_and_values_that_are_nearly_right() {
    let word = r#"{"version": 1, "kind": "patch", "system": "s", "steps": 1, "rational": false, "modules": [
      {"symbol": "A", "params": [3, true, 0.5, [1, 2]], "root": 0, "cell": [1, 0, 1, 0],
       "net": {"degree": [1, 1], "points": [[0, 0, 0, 1], [0, -0.0, 1, 1], [1, 0, 0, 1], [1, 0, 1, 1]]}}]}"#;
    let grid = r#"{"size": [2, 1, 2], "from": [0, 0, 0], "to": [1, 0, 1], "values": [1, 0.5, [1, 2], true]}"#;
    let texts = [word, grid, "0.5\n1\n-2e3\n", "1,2,3\n4,5,6\n", "true\nfalse\n"].map(String::from);
    let whole = fuzz(&texts, 0x5eed_0003, nearly_right, |text| {
        let mut whole = 0;
        if let Ok(word) = io::json::parse(text.as_bytes()) {
            word.validate().expect("what is read holds together");
            let mut written = Vec::new();
            io::json::write(&mut written, &word).expect("what is read is written");
            assert_eq!(io::json::parse(&written).expect("and read again"), word);
            whole += 1;
        }
        for ty in [Type::Bool, Type::Int, Type::Float, Type::Vec2, Type::Vec3] {
            let list = io::values::parse_csv(text.as_bytes(), &ty);
            let grid = io::values::parse_json(text.as_bytes(), &ty).map(|grid| grid.values);
            for values in [list, grid].into_iter().flatten() {
                assert!(values.iter().all(|v| v.ty() == ty), "{values:?}");
                whole += u64::from(!values.is_empty());
            }
        }
        whole
    });
    assert!(whole > INPUTS / 20, "only {whole} files of {INPUTS} texts");
}
