//! How much is tried. `cargo test` tries every kind of thing on a sample of the cases; `BURGEON_TESTS=all cargo test`
//! on all of them: every mutant, every random system, every size of chunk, and OpenGL beside Vulkan.
//!
//! The sample is the same in every run, and no test is left out of it. A test that draws its sample from many kinds of
//! cases says which kinds there are, and fails if one is missing: [`covering`], [`sample`].

use std::env::VarError;

/// Whether all cases are tried.
pub fn is_all() -> bool {
    match std::env::var("BURGEON_TESTS").as_deref() {
        Err(VarError::NotPresent) => false,
        Ok("all") => true,
        other => panic!("BURGEON_TESTS is {other:?}; it may be `all`, or not be set"),
    }
}

/// How many, or which: what the sample has, or what there is in all.
pub fn cases<T>(quick: T, all: T) -> T {
    if is_all() { all } else { quick }
}

/// Those that each are the first of some kind; or all.
pub fn sample<T, K: PartialEq>(list: impl IntoIterator<Item = T>, kinds: impl Fn(&T) -> Vec<K>) -> Vec<T> {
    if is_all() { list.into_iter().collect() } else { firsts(list, kinds) }
}

fn firsts<T, K: PartialEq>(list: impl IntoIterator<Item = T>, kinds: impl Fn(&T) -> Vec<K>) -> Vec<T> {
    let mut seen: Vec<K> = Vec::new();
    let mut is_first = |case: &T| {
        let before = seen.len();
        for kind in kinds(case) {
            if !seen.contains(&kind) {
                seen.push(kind);
            }
        }
        seen.len() > before
    };
    list.into_iter().filter(|case| is_first(case)).collect()
}

/// Cases drawn at random whose texts have all `features` between them: those that each have one which the ones before
/// had not; or all. Fails if a feature is in none.
#[track_caller]
pub fn covering<T>(
    list: impl IntoIterator<Item = T>,
    features: &[impl AsRef<str>],
    text: impl Fn(&T) -> String,
) -> Vec<T> {
    let mut chosen = Vec::new();
    let mut missing = Missing::new(features);
    for case in list {
        if missing.has_less(&text(&case)) || is_all() {
            chosen.push(case);
        }
        if missing.0.is_empty() && !is_all() {
            break;
        }
    }
    missing.assert_none();
    chosen
}

/// Features that were in no text yet.
pub struct Missing<'a>(Vec<&'a str>);

impl<'a> Missing<'a> {
    pub fn new(features: &'a [impl AsRef<str>]) -> Missing<'a> {
        Missing(features.iter().map(AsRef::as_ref).collect())
    }

    /// Looks for them in one more text; whether it has any.
    pub fn has_less(&mut self, text: &str) -> bool {
        let before = self.0.len();
        self.0.retain(|feature| !text.contains(feature));
        self.0.len() < before
    }

    #[track_caller]
    pub fn assert_none(&self) {
        assert!(self.0.is_empty(), "no case has {:?}", self.0);
    }
}

#[test]
fn a_sample_has_every_kind() {
    let list = [("a", 1), ("a", 1), ("b", 1), ("a", 2), ("b", 2)];
    let chosen = firsts(list, |&(name, n)| vec![name.to_string(), n.to_string()]);
    assert_eq!(chosen, [("a", 1), ("b", 1), ("a", 2)]);
}

#[test]
#[should_panic(expected = "no case has [\"tree\"]")]
fn a_feature_that_no_case_has_is_told() {
    covering(["ring", "open"], &["ring", "tree"], |text| text.to_string());
}

/// What `.ci/run` leaves out when it tries all cases has no more of them than a sample.
#[test]
fn modules_that_are_skipped_have_no_tiers() {
    let run = std::fs::read_to_string(".ci/run").expect("the script");
    let mut modules = 0;
    for module in run.split("--skip ").skip(1).filter_map(|rest| rest.split_once("::")).map(|(name, _)| name)
    {
        let folder = std::fs::read_dir(format!("tests/{module}")).into_iter().flatten();
        let inner = folder.map(|entry| entry.expect("an entry").path());
        for path in inner.chain([format!("tests/{module}.rs").into()]).filter(|path| path.is_file()) {
            let text = std::fs::read_to_string(&path).expect("a file");
            let more =
                ["tier::", "device::engines", "mutants::sample"].iter().find(|more| text.contains(**more));
            assert_eq!(more, None, "{}", path.display());
        }
        modules += 1;
    }
    assert!(modules > 5, "{modules} modules are skipped");
}
