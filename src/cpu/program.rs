//! Expressions as flat register programs over blocks of modules.
//!
//! Every node of a [`Graph`] fills one register, a column with a word for each module of the block.

use super::BLOCK;
use crate::language::ops::Cpu;
use crate::plan::graph::{Graph, Node};
use crate::plan::layout::{LATERAL, Layout};
use crate::plan::links::{Linked, NOWHERE};
use crate::plan::step::Clock;
use std::ops::Range;

/// What the passes read of a chunk, beside its nets.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    pub records: &'a [u32],
    /// Of curves the records with those beside the chunk, and which of them is the first of `records`.
    pub window: &'a [u32],
    pub first: usize,
    /// Modules from the first of `records` to the end of the word.
    pub behind: usize,
    pub layout: Layout,
    /// The stage's environment: uniforms, what the host gives, constants, rule table.
    pub environment: &'a [u32],
    /// The values that the host gives.
    pub given: &'a [u32],
    /// The measured attributes, so many words a module.
    pub measured: &'a [u32],
    pub measured_words: usize,
    /// Where the first child of each module of the chunk goes, once that is known; and how many stand before all of
    /// them.
    pub offsets: &'a [u32],
    pub made: u32,
    pub clock: Clock,
    /// Of linked words: all of the word, whose module `first` is the first of `records`.
    pub linked: Option<Linked<'a>>,
    /// Of linked words: for each module of the word what its children hang on outside of it.
    pub hangs: &'a [u32],
}

impl<'a> Input<'a> {
    /// The modules of block `block`.
    pub fn block(&self, block: usize) -> Input<'a> {
        self.part(block * BLOCK..self.len().min((block + 1) * BLOCK))
    }
    /// Some of the modules.
    pub fn part(&self, modules: Range<usize>) -> Input<'a> {
        let words = self.layout.record_words;
        let row = |module: usize| (module * self.measured_words).min(self.measured.len());
        let measured = &self.measured[row(modules.start)..row(modules.end)];
        let records = &self.records[modules.start * words..modules.end * words];
        let behind = self.behind.saturating_sub(modules.start);
        Input { records, first: self.first + modules.start, behind, measured, ..*self }
    }
    /// Modules.
    pub fn len(&self) -> usize {
        self.records.len() / self.layout.record_words
    }
    /// The symbol of a record of the window.
    #[inline]
    pub fn symbol(&self, place: usize) -> u32 {
        self.window[place * self.layout.record_words] & 0xffff
    }
    /// Where the first child of module `i` goes.
    fn offset(&self, i: usize) -> u32 {
        self.offsets[self.first - self.layout.halo() + i]
    }
    /// Where the module stands in the window that is so many places to the right of the first.
    fn place(&self, offset: i32) -> usize {
        (self.first as i64 + i64::from(offset)) as usize
    }
    /// No module at all.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }
    /// The record of module `i`.
    #[inline]
    pub fn record(&self, i: usize) -> &'a [u32] {
        &self.records[i * self.layout.record_words..][..self.layout.record_words]
    }
}

/// The registers of one program over one block.
#[derive(Default)]
pub struct Registers(Vec<u32>);

impl Registers {
    /// The column of a register.
    pub fn column(&self, register: usize) -> &[u32; BLOCK] {
        self.0[register * BLOCK..][..BLOCK].try_into().expect("a register holds a block")
    }
}

/// What the links of the word say of places.
fn each(out: &mut [u32], places: &[u32], block: &Input, of: impl Fn(&Linked, u32) -> u32) {
    let Some(word) = &block.linked else { return };
    out.iter_mut().zip(places).take(block.len()).for_each(|(o, &place)| *o = of(word, place));
}

/// Runs a graph over a block of at most [`BLOCK`] modules: node n fills register n.
pub fn run(graph: &Graph, block: &Input, registers: &mut Registers) {
    registers.0.resize(graph.nodes.len().max(1) * BLOCK, 0);
    for (n, node) in graph.nodes.iter().enumerate() {
        let (before, rest) = registers.0.split_at_mut(n * BLOCK);
        let out = &mut rest[..BLOCK];
        let arg = |r: usize| &before[r * BLOCK..][..BLOCK];
        let words = block.layout.record_words;
        match *node {
            Node::Literal(_, word) | Node::Held(word) => out.fill(word),
            Node::Uniform(_, at) => out.fill(block.environment[at]),
            Node::Step => out.fill(block.clock.step),
            Node::RunStep => out.fill(block.clock.run_step),
            Node::Seed => out.fill(block.clock.seed),
            Node::Field(_, at) => {
                let column = block.records.iter().skip(at).step_by(words);
                out.iter_mut().zip(column).for_each(|(o, w)| *o = *w);
            }
            Node::Near(_, offset, at) => {
                let column = block.window.iter().skip(block.place(offset) * words + at).step_by(words);
                out.iter_mut().zip(column).take(block.len()).for_each(|(o, w)| *o = *w);
            }
            Node::Behind => {
                let left = (0..=block.behind).rev().chain(std::iter::repeat(0));
                out.iter_mut().zip(left).for_each(|(o, left)| *o = left as u32);
            }
            Node::Number(slot) => {
                // Each of several words counts by itself.
                let words = block.linked.filter(|_| block.layout.word.is_some());
                for (i, o) in out.iter_mut().enumerate().take(block.len()) {
                    let before = words.map_or(block.made, |words| {
                        let first = words.first_of((block.first + i) as u32);
                        block.offsets[first as usize].wrapping_neg()
                    });
                    *o = before.wrapping_add(block.offset(i) + slot);
                }
            }
            Node::NearSymbol(offset) => {
                let column = block.window.iter().skip(block.place(offset) * words).step_by(words);
                out.iter_mut().zip(column).take(block.len()).for_each(|(o, w)| *o = *w & 0xffff);
            }
            Node::Previous => {
                let before = |i: u32| block.linked.map_or(NOWHERE, |word| word.previous(i));
                out.iter_mut().zip(block.first as u32..).take(block.len()).for_each(|(o, i)| *o = before(i));
            }
            Node::Index => out.iter_mut().zip(block.first as u32..).for_each(|(o, i)| *o = i),
            Node::Beside(places) => {
                let beside = |i: u32| block.linked.map_or(NOWHERE, |word| word.beside(i, places));
                out.iter_mut().zip(block.first as u32..).for_each(|(o, i)| *o = beside(i));
            }
            Node::Up(n) => each(out, arg(n), block, |word, i| word.up(i)),
            Node::Down(n) => each(out, arg(n), block, |word, i| word.down(i)),
            Node::Search(search) => {
                let Some(word) = &block.linked else { continue };
                let mut found = Vec::new();
                for i in 0..block.len() {
                    word.search((block.first + i) as u32, &word.searches[search], &mut found);
                    found.iter().enumerate().for_each(|(step, &there)| rest[step * BLOCK + i] = there);
                }
            }
            // Its search has filled it.
            Node::Found { .. } => {}
            Node::At(_, n, at) => each(out, arg(n), block, |word, i| word.word(i, at)),
            Node::SymbolAt(n) => each(out, arg(n), block, |word, i| word.symbol(i)),
            Node::Link { cell, lateral } => {
                let flag = if lateral { LATERAL } else { 0 };
                for (i, o) in out.iter_mut().enumerate().take(block.len()) {
                    let outside = || block.hangs[block.first + i];
                    *o = flag | cell.map_or_else(outside, |cell| block.offset(i) + cell);
                }
            }
            Node::Measured(_, at) => {
                let column = block.measured.iter().skip(at).step_by(block.measured_words);
                out.iter_mut().zip(column).for_each(|(o, w)| *o = *w);
            }
            Node::Given(_, index) => {
                let last = block.given.len().saturating_sub(1);
                let word = |i: u32| block.given.get((i as usize).min(last)).copied().unwrap_or(0);
                out.iter_mut().zip(arg(index)).for_each(|(o, i)| *o = word(*i));
            }
            Node::Level => {
                let heads = block.records.iter().step_by(words);
                out.iter_mut().zip(heads).for_each(|(o, w)| *o = (w >> 16 & 0xff).max(w >> 24));
            }
            Node::Element { base, stride, length, index, .. } => {
                let last = length.saturating_sub(1) as i32;
                let place = |i: u32| base + stride * (i as i32).clamp(0, last) as usize;
                out.iter_mut().zip(arg(index)).for_each(|(o, i)| *o = block.environment[place(*i)]);
            }
            Node::Call(op, [a, b, c]) => match op.row().cpu {
                Some(Cpu::One(f)) => f(arg(a), out),
                Some(Cpu::Two(f)) => f(arg(a), arg(b), out),
                Some(Cpu::Three(f)) => f(arg(a), arg(b), arg(c), out),
                None => out.fill(0),
            },
        }
    }
}
