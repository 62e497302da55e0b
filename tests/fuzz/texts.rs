//! Texts that are nearly right, made from bytes and from right ones.

use arbitrary::{Result, Unstructured};

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

pub fn corpus(folders: &[&str], extensions: &[&str]) -> Vec<String> {
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
pub fn nearly_right(u: &mut Unstructured, corpus: &[String]) -> Result<String> {
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

/// One of the texts with some of its words changed for others of their kind: most still check.
pub fn otherwise_right(u: &mut Unstructured, corpus: &[String]) -> Result<String> {
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
