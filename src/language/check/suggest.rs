//! Hints about names, and small matters of wording.

use crate::language::diagnostic;

/// A hint that names the candidate nearest to `name`, if one is near enough to be meant.
pub(super) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let candidates = candidates.into_iter().filter(|c| *c != name && !c.is_empty());
    diagnostic::nearest(name, candidates).map(|c| format!("did you mean `{c}`?"))
}

/// `"CFC"` as `"C F C"`, if each letter is one of `symbols`.
pub(super) fn spaced(name: &str, is_symbol: impl Fn(&str) -> bool) -> Option<String> {
    let mut letters = Vec::new();
    for (at, c) in name.char_indices() {
        letters.push(&name[at..at + c.len_utf8()]);
    }
    let all = letters.len() > 1 && letters.iter().all(|l| is_symbol(l));
    all.then(|| format!("symbols need spaces between them: `{}`", letters.join(" ")))
}

/// `a`, `a and b`, `a, b and c`, each in backquotes.
pub(super) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = names.into_iter().map(|n| format!("`{n}`")).collect();
    match quoted.split_last() {
        None => String::new(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}

/// `one field`, `3 fields`, `no field`.
pub(super) fn count(n: usize, thing: &str) -> String {
    match n {
        0 => format!("no {thing}"),
        1 => format!("one {thing}"),
        n => format!("{n} {thing}s"),
    }
}
