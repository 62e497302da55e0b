//! Walking the links of a word: what contexts see around a module.

use super::context::{Equal, Go, Operand, Place, Search};
use super::graph::Scalar;
use super::layout::{END, LATERAL, Layout, NONE};
use std::ops::Range;

/// No module.
pub const NOWHERE: u32 = u32::MAX;

/// What the pass `link` finds of every module.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Links {
    /// The nearest module before it, on its axis and those that it branches off, that is not ignored.
    pub up: Vec<u32>,
    /// The nearest behind it on its axis that is not ignored.
    pub down: Vec<u32>,
    /// Where the modules that hang on it end, directly or not; empty where nobody looks into branches.
    pub end: Vec<u32>,
}

/// A linked word with its links.
#[derive(Clone, Copy)]
pub struct Linked<'a> {
    pub records: &'a [u32],
    pub layout: Layout,
    pub links: &'a Links,
    /// For each symbol whether contexts look past it.
    pub ignored: &'a [bool],
    pub searches: &'a [Search],
}

/// The word of a record that holds its link.
pub fn link_of(layout: &Layout, record: &[u32]) -> u32 {
    layout.link.map_or(NONE, |word| record[word])
}

/// The word of the first of these records.
pub fn first_word(records: &[u32], layout: &Layout) -> Option<usize> {
    records.get(layout.word?).map(|&word| word as usize)
}

/// The records of these words, with this one for each of which there is none.
pub fn with_starts(records: &[u32], layout: &Layout, start: &[u32], words: Range<usize>) -> Vec<u32> {
    let (Some(word), Some(link)) = (layout.word, layout.link) else { return records.to_vec() };
    let mut all = Vec::with_capacity(records.len());
    let (mut next, mut added) = (words.start, 0);
    let begin = |all: &mut Vec<u32>, empty: usize| {
        let at = all.len();
        all.extend(start);
        all[at + word] = empty as u32;
        if start[link] & NONE != NONE {
            all[at + link] += (at / layout.record_words) as u32;
        }
    };
    for record in records.chunks_exact(layout.record_words) {
        let own = record[word] as usize;
        for empty in next..own {
            begin(&mut all, empty);
            added += 1;
        }
        next = own + 1;
        let at = all.len();
        all.extend(record);
        if record[link] & NONE != NONE {
            all[at + link] += added;
        }
    }
    (next..words.end).for_each(|empty| begin(&mut all, empty));
    all
}

/// Several words in two parts, about as long; none where it is one.
pub fn halves(records: &[u32], layout: &Layout) -> Option<[Vec<u32>; 2]> {
    let (word, link, words) = (layout.word?, layout.link?, layout.record_words);
    let count = records.len() / words;
    let begins = |&n: &usize| records[n * words + word] != records[(n - 1) * words + word];
    let before = (1..=count / 2).rev().find(begins);
    let behind = (count / 2 + 1..count).find(begins);
    let at = [before, behind].into_iter().flatten().min_by_key(|n| n.abs_diff(count / 2))?;
    let (first, second) = records.split_at(at * words);
    let mut second = second.to_vec();
    for record in second.chunks_exact_mut(words) {
        if record[link] & NONE != NONE {
            record[link] -= at as u32;
        }
    }
    Some([first.to_vec(), second])
}

impl Linked<'_> {
    fn record(&self, i: u32) -> Option<&[u32]> {
        let words = self.layout.record_words;
        self.records.get((i as usize).checked_mul(words)?..)?.get(..words)
    }

    /// What a module hangs on.
    pub fn link(&self, i: u32) -> u32 {
        self.record(i).map_or(NONE, |record| link_of(&self.layout, record))
    }

    /// A word of a record; 0 of nowhere.
    pub fn word(&self, i: u32, at: usize) -> u32 {
        self.record(i).map_or(0, |record| record[at])
    }

    /// The symbol of a module; of nowhere [`END`].
    pub fn symbol(&self, i: u32) -> u32 {
        self.record(i).map_or(END, |record| record[0] & 0xffff)
    }

    /// The module that contexts see before another.
    pub fn up(&self, i: u32) -> u32 {
        self.links.up.get(i as usize).copied().unwrap_or(NOWHERE)
    }

    /// The one that goes on.
    pub fn down(&self, i: u32) -> u32 {
        self.links.down.get(i as usize).copied().unwrap_or(NOWHERE)
    }

    /// The module so many behind another in the word, if each hangs on the one before and begins no branch.
    pub fn beside(&self, i: u32, places: u32) -> u32 {
        let follows = |n: u32| self.record(i + n).is_some() && self.link(i + n) == i + n - 1;
        if i == NOWHERE {
            return NOWHERE;
        }
        if (1..=places).all(follows) { i + places } else { NOWHERE }
    }

    /// The module before in memory, if it is of the same word.
    pub fn previous(&self, i: u32) -> u32 {
        let word = |i: u32| self.layout.word.map(|word| self.word(i, word));
        match i.checked_sub(1) {
            Some(before) if word(before) == word(i) => before,
            _ => NOWHERE,
        }
    }

    /// The first module of a module's word: words stand one after the other.
    pub fn first_of(&self, i: u32) -> u32 {
        let Some(word) = self.layout.word else { return 0 };
        let own = self.word(i, word);
        let (mut low, mut high) = (0, i);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.word(middle, word) < own {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// A place that is no search's.
    fn place(&self, own: u32, place: Place) -> u32 {
        match place {
            Place::Strict(n) => self.beside(own, n),
            Place::Before(n) => (0..n).fold(own, |i, _| self.up(i)),
            Place::Behind { last, steps } => (0..steps).fold(self.beside(own, last), |i, _| self.down(i)),
            Place::Previous | Place::Found { .. } => NOWHERE,
        }
    }

    /// What the steps of a search find behind module `own`: the first way that meets all demands, or all nowhere.
    pub fn search(&self, own: u32, search: &Search, found: &mut Vec<u32>) -> bool {
        found.clear();
        let met = self.step(own, search, found);
        if !met {
            found.resize(search.steps.len(), NOWHERE);
        }
        met
    }

    /// What one of its steps finds.
    pub fn found(&self, own: u32, search: usize, step: usize) -> u32 {
        let mut found = Vec::new();
        self.search(own, &self.searches[search], &mut found);
        found[step]
    }

    fn step(&self, own: u32, search: &Search, found: &mut Vec<u32>) -> bool {
        let Some(step) = search.steps.get(found.len()) else { return true };
        let from =
            |step: Option<usize>| step.map_or_else(|| self.beside(own, search.last), |step| found[step]);
        match step.go {
            Go::On(at) => self.goes_on(own, search, self.down(from(at)), found),
            Go::Branch { at, after } => {
                let at = from(at);
                let mut branch = self.next_branch(at, after.map(|after| found[after]));
                while branch != NOWHERE && !self.goes_on(own, search, branch, found) {
                    branch = self.next_branch(at, Some(branch));
                }
                branch != NOWHERE
            }
        }
    }

    /// Whether the next step may find `here`, and those behind it what they want.
    fn goes_on(&self, own: u32, search: &Search, here: u32, found: &mut Vec<u32>) -> bool {
        let n = found.len();
        let step = &search.steps[n];
        found.push(here);
        let read = |operand: Operand| match operand {
            Operand::Literal(_, word) => word,
            Operand::Word(_, Place::Found { step, .. }, word) => self.word(found[step], word),
            Operand::Word(_, place, word) => self.word(self.place(own, place), word),
        };
        let number = |ty: Scalar, word: u32| match ty {
            Scalar::Float => f32::from_bits(word),
            _ => word as i32 as f32,
        };
        let equal = |test: &Equal| match (test.a.scalar(), test.b.scalar()) {
            (a, b) if a == Scalar::Float || b == Scalar::Float => {
                number(a, read(test.a)) == number(b, read(test.b))
            }
            _ => read(test.a) == read(test.b),
        };
        let met = self.symbol(here) == step.symbol && step.tests.iter().all(equal);
        if met && self.step(own, search, found) {
            return true;
        }
        found.truncate(n);
        false
    }

    /// What hangs on an ignored module counts as hanging on what that hangs on.
    fn next_branch(&self, at: u32, after: Option<u32>) -> u32 {
        let end = |i: u32| self.links.end.get(i as usize).copied().unwrap_or(0);
        let mut i = after.map_or(at.wrapping_add(1), end);
        while i < end(at) {
            if self.ignored[self.symbol(i) as usize] {
                i += 1;
            } else if self.branches_off(i, at) {
                return i;
            } else {
                i = end(i);
            }
        }
        NOWHERE
    }

    /// Whether a branch begins on the way from a module to one that it hangs on.
    fn branches_off(&self, mut i: u32, from: u32) -> bool {
        while i != from && i != NONE {
            let link = self.link(i);
            if link & LATERAL != 0 {
                return true;
            }
            i = link & NONE;
        }
        false
    }
}
