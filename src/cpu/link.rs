//! What contexts see around the modules of a linked word, and what its modules come to hang on.
//!
//! The kernel jumps along links, since it knows no order; here parents stand before what hangs on them, and one
//! walk through the word does. Only the first module of a ring hangs on one behind it.

use crate::plan::layout::{LATERAL, Layout, NONE};
use crate::plan::links::{Links, NOWHERE, link_of};
use crate::plan::tables::NO_EXIT;

/// Fills `links`; the ends of what hangs on a module only where `branches` are looked into.
pub fn link(layout: &Layout, records: &[u32], ignored: &[bool], branches: bool, links: &mut Links) {
    let n = records.len() / layout.record_words;
    let record = |i: usize| &records[i * layout.record_words..][..layout.record_words];
    let parent =
        |i: usize| Some((link_of(layout, record(i)) & NONE) as usize).filter(|&p| p != NONE as usize);
    let is_ignored = |i: usize| ignored[(record(i)[0] & 0xffff) as usize];
    let Links { up, down, end } = links;
    up.clear();
    for i in 0..n {
        let before = match parent(i) {
            None => NOWHERE,
            Some(p) if !is_ignored(p) => p as u32,
            Some(p) if p < i => up[p],
            Some(p) => {
                let mut seen = Some(p);
                for _ in 0..n {
                    seen = seen.filter(|&p| is_ignored(p)).map_or(seen, parent);
                }
                seen.filter(|&p| !is_ignored(p)).map_or(NOWHERE, |p| p as u32)
            }
        };
        up.push(before);
    }
    let mut next = vec![NOWHERE; n];
    for i in 0..n {
        if let Some(p) = parent(i).filter(|_| link_of(layout, record(i)) & LATERAL == 0) {
            next[p] = i as u32;
        }
    }
    down.clear();
    down.resize(n, NOWHERE);
    for i in (0..n).rev() {
        let mut seen = next[i];
        if seen != NOWHERE && is_ignored(seen as usize) {
            if seen as usize > i {
                seen = down[seen as usize];
            } else {
                for _ in 0..n {
                    if seen != NOWHERE && is_ignored(seen as usize) {
                        seen = next[seen as usize];
                    }
                }
                seen = if seen != NOWHERE && is_ignored(seen as usize) { NOWHERE } else { seen };
            }
        }
        down[i] = seen;
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
/// on the axis, of what the parent hangs on.
pub fn rehang(
    layout: &Layout,
    records: &[u32],
    words: &[u32],
    rules: &[u32],
    offsets: &[u32],
    out: &mut Vec<u32>,
) {
    let n = records.len() / layout.record_words;
    let link = |i: usize| link_of(layout, &records[i * layout.record_words..][..layout.record_words]);
    let exit = |i: usize| match words[rules[i] as usize] >> 24 {
        NO_EXIT => None,
        cell => Some(offsets[i] + cell),
    };
    out.clear();
    for i in 0..n {
        let (mut lateral, mut at) = (link(i) & LATERAL, link(i) & NONE);
        for _ in 0..n {
            if at == NONE || exit(at as usize).is_some() {
                break;
            }
            if (at as usize) < i {
                lateral |= out[at as usize] & LATERAL;
                at = out[at as usize] & NONE;
                out.push(at | lateral);
                break;
            }
            lateral |= link(at as usize) & LATERAL;
            at = link(at as usize) & NONE;
        }
        if out.len() > i {
            continue;
        }
        let there = if at == NONE { None } else { exit(at as usize) };
        out.push(there.unwrap_or(NONE) | lateral);
    }
}
