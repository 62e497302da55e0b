//! The parser: examples, round trips, refusals, robustness.
use burgeon::language::parse::parse;

#[test]
fn examples_parse() {
    for entry in std::fs::read_dir("tests/data/language").unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let parsed = parse(&text);
        assert!(parsed.diagnostics.is_empty(), "{}: {:#?}", path.display(), parsed.diagnostics);
        assert!(!parsed.file.items.is_empty());
    }
}
