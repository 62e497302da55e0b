//! The columns that a word is kept in from step to step.
//!
//! A word has elements of one or more *domains*; those of a patch or a curve are its modules. A column holds as many
//! 4-byte words for every element of its domain, and of some columns a chunk holds a few elements of its neighbours too,
//! its *halo*. [`Layout`](super::layout::Layout) says which columns a system's words have, and how wide they are. All that
//! moves words about (upload, read, split, join, pools) loops over the columns, whatever they hold.

use bytemuck::allocation::try_cast_vec;
use bytemuck::cast_slice;
use std::ops::{Index, IndexMut};

/// What a word has several of. Elements of a domain are numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Modules: what rules rewrite.
    Module,
}

/// A column of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stored {
    /// Symbols, addresses or links, parameters: [`super::layout`]. Every word has it.
    Records,
    /// Control points, four floats each, of patches.
    Nets,
}

impl Stored {
    /// How many there are.
    pub const COUNT: usize = 2;
    /// All of them, in their order.
    pub const ALL: [Stored; Stored::COUNT] = [Stored::Records, Stored::Nets];

    /// What it has an element for.
    pub fn domain(self) -> Domain {
        match self {
            Stored::Records | Stored::Nets => Domain::Module,
        }
    }

    /// As messages name it.
    pub fn name(self) -> &'static str {
        match self {
            Stored::Records => "records",
            Stored::Nets => "nets",
        }
    }
}

/// How wide a column is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// 4-byte words an element.
    pub words: usize,
    /// Elements of its neighbours on either side of a chunk's own.
    pub halo: usize,
}

impl Shape {
    /// Words of so many elements and the halo.
    pub fn chunk_words(&self, elements: usize) -> usize {
        (elements + 2 * self.halo) * self.words
    }
    /// Bytes of so many elements and the halo.
    pub fn chunk_bytes(&self, elements: u64) -> u64 {
        (elements + 2 * self.halo as u64) * self.bytes()
    }
    /// Bytes an element.
    pub fn bytes(&self) -> u64 {
        self.words as u64 * 4
    }
    /// Bytes before a chunk's own elements.
    pub fn halo_bytes(&self) -> u64 {
        self.halo as u64 * self.bytes()
    }
}

/// The columns of some elements on the host, without what stands beside them. Columns that the word has not are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Content([Vec<u32>; Stored::COUNT]);

impl Content {
    /// Modules without nets.
    pub fn of_records(records: Vec<u32>) -> Content {
        Content([records, Vec::new()])
    }

    /// Modules with nets.
    pub fn of_nets(records: Vec<u32>, nets: Vec<[f32; 4]>) -> Content {
        let words = try_cast_vec(nets).unwrap_or_else(|(_, nets)| cast_slice(&nets).to_vec());
        Content([records, words])
    }

    pub fn records(&self) -> &[u32] {
        &self[Stored::Records]
    }

    /// Control points, net by net.
    pub fn nets(&self) -> &[[f32; 4]] {
        cast_slice(&self[Stored::Nets])
    }

    /// The same without the rest.
    pub fn into_nets(self) -> Vec<[f32; 4]> {
        let [_, words] = self.0;
        try_cast_vec(words).unwrap_or_else(|(_, words)| cast_slice(&words).to_vec())
    }

    /// Puts other elements after these.
    pub fn append(&mut self, other: Content) {
        for (all, more) in self.0.iter_mut().zip(other.0) {
            match all.is_empty() {
                true => *all = more,
                false => all.extend(more),
            }
        }
    }
}

impl Index<Stored> for Content {
    type Output = Vec<u32>;
    fn index(&self, column: Stored) -> &Vec<u32> {
        &self.0[column as usize]
    }
}

impl IndexMut<Stored> for Content {
    fn index_mut(&mut self, column: Stored) -> &mut Vec<u32> {
        &mut self.0[column as usize]
    }
}
