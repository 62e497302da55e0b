//! The checker: examples, refusals, types, folding, lowering, and the table of operations.
use burgeon::language::{Checked, Severity, System, Vocabulary, compile};
use std::path::PathBuf;

/// The findings as a user would read them, for the messages of failed tests.
fn shown(text: &str, checked: &Checked) -> String {
    let place = |start: u32| {
        let before = &text[..start as usize];
        let line = before.matches('\n').count() + 1;
        format!("{line}:{}", before.len() - before.rfind('\n').map_or(0, |i| i + 1) + 1)
    };
    let mut out = String::new();
    for d in &checked.diagnostics {
        out += &format!("{} {}: {}", place(d.span.start), d.code, d.message);
        for (span, label) in &d.labels {
            out += &format!(" [{} {label}]", place(span.start));
        }
        if let Some(hint) = &d.hint {
            out += &format!(" ({hint})");
        }
        out += "\n";
    }
    out
}

fn checked(text: &str) -> Checked {
    compile(text, &Vocabulary::default())
}

/// The one system of a text that has no errors.
fn system(text: &str) -> System {
    let checked = checked(text);
    assert!(!checked.has_errors(), "{}", shown(text, &checked));
    checked.systems.into_iter().next_back().unwrap()
}

fn files(folder: &str) -> Vec<(PathBuf, String)> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    files.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

#[test]
fn examples_check() {
    for (path, text) in files("tests/data/language") {
        let checked = checked(&text);
        if std::env::var_os("SHOW_FINDINGS").is_some() {
            println!("{}\n{}", path.display(), shown(&text, &checked));
        }
        assert!(!checked.has_errors(), "{}\n{}", path.display(), shown(&text, &checked));
        assert_eq!(checked.systems.len(), text.lines().filter(|l| l.starts_with("system ")).count());
    }
}

#[test]
fn severities_follow_codes() {
    for (_, text) in files("tests/data/language") {
        for d in checked(&text).diagnostics {
            assert_eq!(d.severity == Severity::Warning, d.code.starts_with('W'), "{d:?}");
        }
    }
}
