//! What contexts see around the modules of a linked word, and what its modules come to hang on.
//!
//! The kernel jumps along links, since it knows no order; here parents stand before what hangs on them, and one
//! walk through the word does. Only the first module of a ring hangs on one behind it.

use crate::plan::layout::{LATERAL, Layout, NONE};
use crate::plan::links::{Linked, Links, NOWHERE, link_of};
use crate::plan::tables::NO_EXIT;

/// Fills `links`; the ends of what hangs on a module only where `branches` are looked into.
pub fn link(layout: &Layout, records: &[u32], ignored: &[bool], branches: bool, links: &mut Links) {
    let n = records.len() / layout.record_words;
    let record = |i: usize| &records[i * layout.record_words..][..layout.record_words];
    let parent =
        |i: usize| Some((link_of(layout, record(i)) & NONE) as usize).filter(|&p| p != NONE as usize);
    let is_ignored = |i: usize| ignored[(record(i)[0] & 0xffff) as usize];
    // Around a ring from an ignored module to one that is not, if there is any.
    let past = |from: usize, step: &dyn Fn(usize) -> Option<usize>| {
        let mut seen = step(from);
        while let Some(i) = seen.filter(|&i| i != from && is_ignored(i)) {
            seen = step(i);
        }
        seen.filter(|&i| i != from).map_or(NOWHERE, |i| i as u32)
    };
    let Links { up, down, end } = links;
    up.clear();
    for i in 0..n {
        let before = match parent(i) {
            None => NOWHERE,
            Some(p) if !is_ignored(p) => p as u32,
            Some(p) if p < i => up[p],
            Some(p) => past(p, &parent),
        };
        up.push(before);
    }
    let mut next = vec![None; n];
    for i in 0..n {
        if let Some(p) = parent(i).filter(|_| link_of(layout, record(i)) & LATERAL == 0) {
            next[p] = Some(i);
        }
    }
    down.clear();
    down.resize(n, NOWHERE);
    for i in (0..n).rev() {
        down[i] = match next[i] {
            None => NOWHERE,
            Some(c) if !is_ignored(c) => c as u32,
            Some(c) if c > i => down[c],
            Some(c) => past(c, &|i| next[i]),
        };
    }
    end.clear();
    if branches {
        end.extend(1..=n as u32);
        for i in (0..n).rev() {
            if let Some(p) = parent(i).filter(|&p| p < i) {
                end[p] = end[p].max(end[i]);
            }
        }
    }
}

/// For each module what its children hang on: the exit of what its parent becomes, or, where that leaves nothing
/// on the axis, of what the parent hangs on. With `start` all that hangs on nothing hangs on the first child of its
/// word's first module: the point at which a turtle starts.
pub fn rehang(word: &Linked, words: &[u32], rules: &[u32], offsets: &[u32], start: bool, out: &mut Vec<u32>) {
    let exit = |i: u32| match words[rules[i as usize] as usize] >> 24 {
        NO_EXIT => None,
        cell => Some(offsets[i as usize] + cell),
    };
    // The first module of each word, as the walk goes on.
    let mut first = 0;
    out.clear();
    for i in 0..rules.len() as u32 {
        if word.previous(i) == NOWHERE {
            first = i;
        }
        let (mut lateral, mut at) = (0, i);
        let hangs = loop {
            let link = word.link(at);
            lateral |= link & LATERAL;
            at = link & NONE;
            if at == NONE {
                break if start { offsets[first as usize] } else { NONE };
            }
            if let Some(child) = exit(at) {
                break child;
            }
            if at < i {
                lateral |= out[at as usize] & LATERAL;
                break out[at as usize] & NONE;
            }
            // A ring of which nothing is left.
            if at == i {
                break NONE;
            }
        };
        out.push(hangs | lateral);
    }
}
