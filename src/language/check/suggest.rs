//! The nearest name to one that does not exist.

/// A hint that names the candidate nearest to `name`, if one is near enough to be meant.
pub(super) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let allowed = match name.chars().count() {
        0..=2 => 1,
        3..=5 => 2,
        _ => 3,
    };
    let found = candidates
        .into_iter()
        .filter(|c| *c != name && !c.is_empty())
        .map(|c| (distance(name, c), c))
        .filter(|(d, c)| *d <= allowed && *d < name.chars().count().max(c.chars().count()))
        .min();
    found.map(|(_, c)| format!("did you mean `{c}`?"))
}

/// How many letters to insert, leave out, replace or swap with their neighbour; case is free of
/// charge but for a last bit, so that `p` is nearer to `P` than to `q`.
fn distance(a: &str, b: &str) -> usize {
    let fold = |s: &str| s.chars().take(64).flat_map(char::to_lowercase).collect::<Vec<_>>();
    let (a, b) = (fold(a), fold(b));
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + (a[i - 1] != b[j - 1]) as usize;
            let mut least = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
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
