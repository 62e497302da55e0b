//! What a module is in memory. Read this first.
//!
//! A module of a patch word is a *record* of 4-byte words and, beside it in a buffer of its own, a
//! *net* of homogeneous control points (vec4, row by row). The stride of a record is a multiple of
//! 16 bytes, so that kernels read it as `vec4u`:
//!
//! | word | holds |
//! |---|---|
//! | 0 | symbol (bits 0–15), halvings along u (16–23), along v (24–31) |
//! | 1 | root: index in the axiom |
//! | 2, 3 | order key, high and low word |
//! | 4, 5 | row i and column j of the net at its level |
//! | 6 … | parameters in order of declaration, each in [`Type::words`](crate::language::Type::words) words |
//!
//! A module of a curve has no net. Its record holds the symbol in the low half of word 0, then, where the system
//! draws random numbers, its path (high and low word), then its parameters. A chunk has [`HALO`] records
//! of its neighbours on either side, so that contexts read across its ends; beyond the end of an open word the symbol is
//! [`END`].
//!
//! Where neighbours do not stand side by side (trees, symbols that contexts ignore, several curves or words at once)
//! words are *linked*: behind the path stands what a module hangs on, the index of the module before it on its axis
//! or, with [`LATERAL`], of the one at which its branch begins; [`NONE`] for the first of a curve; in a ring the
//! first hangs on the last. Where several words are derived at once the index of its word follows. A linked word is in
//! one chunk, with nothing beside it but other words.
//!
//! **Order key**: the children taken since the root, left-aligned: two bits for a 2×2 block
//! (row, column), one for 1×2 and 2×1. The modules of a word are leaves of one derivation tree, so
//! sorting by (root, key) is its depth-first order, and (root, key) names a module for ever.
//! At most [`MAX_HALVINGS`] halvings each way fit (62 key bits, and i and j within a word).

use super::columns::{Content, Shape, Stored};
use crate::patch::Cell;
use std::ops::Range;

/// Halvings along u, and along v, that an address can hold.
pub const MAX_HALVINGS: u8 = 31;

/// Words of the record of a patch module before its parameters.
pub const HEADER_WORDS: usize = 6;

/// Modules that a chunk of a curve's word holds beside its own on either side: a context is 8 deep and may end the word,
/// and on the right it stands behind up to 8 strict predecessors, the first of which is the module itself.
pub const HALO: usize = 16;

/// The symbol that stands beyond the ends of an open word.
pub const END: u32 = 0xffff;

/// In a link: the module is the first of a branch.
pub const LATERAL: u32 = 1 << 31;

/// A link to nothing, with or without [`LATERAL`].
pub const NONE: u32 = LATERAL - 1;

/// Sizes of one module in memory, the same for all symbols of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// 4-byte words a record: a multiple of 4.
    pub record_words: usize,
    /// Words before the parameters.
    pub header_words: usize,
    /// The words that name a module for ever, in which random numbers begin; none where none are drawn and they are not
    /// kept.
    pub identity: &'static [usize],
    /// Words 1 and 2 are a path, which is made of the parent's.
    pub paths: bool,
    /// The words of the record that hold its link and the index of its word, where it has them.
    pub link: Option<usize>,
    pub word: Option<usize>,
    /// Modules beside a chunk's own, on either side.
    halo: usize,
    /// The last module of a word is followed by the first.
    pub ring: bool,
    /// Degrees along u and v of nets, 1..=8 each, where modules have nets.
    pub net: Option<[u8; 2]>,
}

/// What the records of a curve hold before their parameters, besides the symbol.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CurveHeader {
    pub paths: bool,
    pub links: bool,
    pub words: bool,
    /// Not held by a record: the last module of a word is followed by the first.
    pub ring: bool,
}

impl Layout {
    /// The layout of patch modules with at most `param_words` words of parameters.
    pub fn new(param_words: usize, degree: [u8; 2]) -> Layout {
        Layout {
            record_words: (HEADER_WORDS + param_words).next_multiple_of(4),
            header_words: HEADER_WORDS,
            identity: &[1, 2, 3],
            paths: false,
            link: None,
            word: None,
            halo: 0,
            ring: false,
            net: Some(degree),
        }
    }

    /// The layout of a curve's modules, which have a path only where random numbers hang on it: so points of up
    /// to three coordinates take 16 bytes.
    pub fn of_curve(param_words: usize, has: CurveHeader) -> Layout {
        let mut header_words = if has.paths { 3 } else { 1 };
        let mut next = |there: bool| {
            let at = there.then_some(header_words);
            header_words += usize::from(there);
            at
        };
        let (link, word) = (next(has.links), next(has.words));
        Layout {
            record_words: (header_words + param_words).next_multiple_of(4),
            header_words,
            identity: if has.paths { &[1, 2] } else { &[] },
            paths: has.paths,
            link,
            word,
            halo: if link.is_none() { HALO } else { 0 },
            ring: has.ring,
            net: None,
        }
    }

    /// Records of this size without nets or neighbours, such as those of vertices.
    pub fn of_records(record_words: usize, header_words: usize) -> Layout {
        Layout { record_words, header_words, net: None, ..Layout::new(0, [1, 1]) }
    }

    /// Whether a word is one chunk, since its modules name each other by their index.
    pub fn one_piece(&self) -> bool {
        self.link.is_some()
    }

    /// Modules beside a chunk's own, on either side.
    pub fn halo(&self) -> usize {
        self.halo
    }

    /// Rows and columns of a net; none where modules have no nets.
    pub fn net_sides(&self) -> [usize; 2] {
        self.net.map_or([0; 2], |degree| degree.map(|d| d as usize + 1))
    }

    /// Control points a net: rows × columns.
    pub fn net_points(&self) -> usize {
        let [rows, columns] = self.net_sides();
        rows * columns
    }

    /// Modules of a chunk, the widest column of which takes so many bytes.
    pub fn most_modules(&self, bytes: u64) -> u64 {
        let modules = |shape: Shape| (bytes / shape.bytes()).saturating_sub(2 * shape.halo as u64);
        self.columns().map(|column| modules(self.shape(column))).min().unwrap_or(0)
    }

    /// Modules of which there are columns.
    pub fn modules(&self, content: &Content) -> usize {
        content.records().len() / self.record_words
    }

    /// The columns of some modules.
    pub fn part(&self, content: &Content, modules: Range<usize>) -> Content {
        let mut part = Content::default();
        for column in self.columns() {
            let words = self.shape(column).words;
            part[column] = content[column][modules.start * words..modules.end * words].to_vec();
        }
        part
    }

    /// Bytes of a record.
    pub fn record_bytes(&self) -> u64 {
        self.record_words as u64 * 4
    }

    /// How wide a column is; no words of those that the word has not.
    pub fn shape(&self, column: Stored) -> Shape {
        match column {
            Stored::Records => Shape { words: self.record_words, halo: self.halo() },
            Stored::Nets => Shape { words: 4 * self.net_points(), halo: 0 },
        }
    }

    /// The columns of a word.
    pub fn columns(&self) -> impl Iterator<Item = Stored> + use<> {
        let layout = *self;
        Stored::ALL.into_iter().filter(move |&column| layout.shape(column).words > 0)
    }

    /// Bytes of a net.
    pub fn net_bytes(&self) -> u64 {
        self.net_points() as u64 * 16
    }

    /// Bytes of a module: its record and its net.
    pub fn module_bytes(&self) -> u64 {
        self.record_bytes() + self.net_bytes()
    }
}

/// The header of a record, unpacked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Header {
    pub symbol: u16,
    pub root: u32,
    pub key: u64,
    pub cell: Cell,
}

impl Header {
    /// Reads words 0..6 of a record.
    #[inline]
    pub fn read(record: &[u32]) -> Header {
        let w: &[u32; HEADER_WORDS] = record[..HEADER_WORDS].try_into().expect("a record holds a header");
        Header {
            symbol: w[0] as u16,
            root: w[1],
            key: (w[2] as u64) << 32 | w[3] as u64,
            cell: Cell { du: (w[0] >> 16) as u8, dv: (w[0] >> 24) as u8, i: w[4], j: w[5] },
        }
    }

    /// Writes words 0..6 of a record.
    #[inline]
    pub fn write(&self, record: &mut [u32]) {
        record[..HEADER_WORDS].copy_from_slice(&[
            self.symbol as u32 | (self.cell.du as u32) << 16 | (self.cell.dv as u32) << 24,
            self.root,
            (self.key >> 32) as u32,
            self.key as u32,
            self.cell.i,
            self.cell.j,
        ]);
    }

    /// The header of child (`hu`, `hv`) when `halves` says which directions are halved
    /// (bit 0: u, bit 1: v); `None` where the address is full.
    #[inline]
    pub fn child(&self, halves: u32, hu: u32, hv: u32) -> Option<Header> {
        let (su, sv) = (halves & 1, halves >> 1 & 1);
        let Cell { du, dv, i, j } = self.cell;
        let (next_du, next_dv) = (du + su as u8, dv + sv as u8);
        if next_du > MAX_HALVINGS || next_dv > MAX_HALVINGS {
            return None;
        }
        let (next_i, next_j) = (i << su | hu, j << sv | hv);
        // The new bits stand behind the du + dv that are there: row bit first.
        let bits = (hu << sv | hv) as u64;
        let used = next_du as u32 + next_dv as u32;
        let key = if used == 0 { self.key } else { self.key | bits << (64 - used) };
        Some(Header { key, cell: Cell { du: next_du, dv: next_dv, i: next_i, j: next_j }, ..*self })
    }
}
