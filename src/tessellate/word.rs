//! The leaves of a word as the nodes that a tessellation begins with, and the table in which they are
//! found by the place they cover.
//!
//! A word's cells may be halved along one direction more often than along the other, so no single walk
//! finds them. The table is a hash of (root, shape, i, j) with open addressing, and a list of the shapes
//! that occur: a place is looked up once a shape, the commonest first.

use super::lattice::{LEVELS, MAX_DEPTH, Node};
use super::topology::{self, Topology};
use crate::patch::Word;
use thiserror::Error;

/// Shapes there can be: halvings along x times halvings along y.
pub const MOST_SHAPES: usize = (LEVELS * LEVELS) as usize;

/// Where the slots begin: behind the number of shapes, the mask of the slots, and the shapes.
pub const SLOTS: usize = 2 + MOST_SHAPES;

/// Slots for so many leaves: they are full by half at most.
pub fn slots_for(leaves: usize) -> usize {
    (2 * leaves).next_power_of_two().max(2)
}

/// Leaves of a word by the places that they cover.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// As kernels read it: the number of shapes, the mask of the slots, the shapes, the slots: 0, or a
    /// node plus 1.
    words: Vec<u32>,
}

/// Why a word cannot be tessellated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Error {
    #[error(transparent)]
    Patches(#[from] topology::Error),
    #[error(
        "module {module} was halved {halvings} times along one direction; a tessellation resolves {MAX_DEPTH}"
    )]
    TooDeep { module: usize, halvings: u32 },
    #[error(
        "a cell of the word was halved more than {MAX_DEPTH} times along one direction; a tessellation resolves no more"
    )]
    Halvings,
    #[error("module {module} belongs to root {root}, and there are {roots}")]
    Root { module: usize, root: u32, roots: usize },
    #[error(
        "the modules of root {root} do not cover it once; derive the word with its holes kept \
         (Plan::keeping_holes)"
    )]
    Cover { root: u32 },
}

/// The nodes of a word, in its order and in the canonical orientation of each root. `hole` is the
/// symbol of erased cells, if any are kept.
///
/// # Errors
/// When a module is too deep or of no root, or the modules of a root do not cover it exactly once.
pub fn nodes(word: &Word, topology: &Topology, hole: Option<usize>) -> Result<Vec<Node>, Error> {
    let mut cells = vec![Vec::new(); topology.roots()];
    let mut list = Vec::with_capacity(word.modules.len());
    for (module, m) in word.modules.iter().enumerate() {
        let Some(cells) = cells.get_mut(m.root as usize) else {
            return Err(Error::Root { module, root: m.root, roots: topology.roots() });
        };
        let depth = [m.cell.du, m.cell.dv].map(u32::from);
        let halvings = depth[0].max(depth[1]);
        if halvings > MAX_DEPTH {
            return Err(Error::TooDeep { module, halvings });
        }
        if (0..2).any(|k| [m.cell.i, m.cell.j][k] >> depth[k] != 0) {
            return Err(Error::Cover { root: m.root });
        }
        let (depth, cell) = topology.orientation(m.root).cell_from_file(depth, [m.cell.i, m.cell.j]);
        let erased = hole == Some(m.symbol) || topology.is_void(m.root);
        let node = Node::new(m.root, depth, cell, m.symbol as u32, erased);
        cells.push(node);
        list.push(node);
    }
    match cells.into_iter().position(|cells| !is_cut_from(Node::default(), cells)) {
        Some(root) => Err(Error::Cover { root: root as u32 }),
        None => Ok(list),
    }
}

/// Whether cells are what comes of one by halving it again and again: then they cover it, each place once.
fn is_cut_from(whole: Node, cells: Vec<Node>) -> bool {
    let depth = whole.depth();
    if let [cell] = cells.as_slice()
        && cell.depth() == depth
    {
        return true;
    }
    // Along a direction in which all are halved more often each lies in one half. Which direction is taken first is
    // all the same.
    let along = |k: usize| !cells.is_empty() && cells.iter().all(|cell| cell.depth()[k] > depth[k]);
    let Some(k) = (0..2).find(|&k| along(k)) else { return false };
    let upper = |cell: &Node| [cell.i, cell.j][k] >> (cell.depth()[k] - depth[k] - 1) & 1 != 0;
    let (upper, lower): (Vec<Node>, Vec<Node>) = cells.into_iter().partition(upper);
    let half = Node { shape: whole.shape + (1 << (8 * k)), ..whole };
    is_cut_from(half, lower) && is_cut_from(half, upper)
}

/// Whether the nodes are the roots themselves, one each in order, so that no table is needed.
pub fn are_roots(nodes: &[Node]) -> bool {
    nodes.iter().enumerate().all(|(n, node)| node.root as usize == n && node.shape & 0xffff == 0)
}

impl Table {
    /// The table of these nodes.
    pub fn new(nodes: &[Node]) -> Table {
        let mut counts = vec![0u32; MOST_SHAPES];
        for node in nodes {
            let [du, dv] = node.depth();
            counts[(du * LEVELS + dv) as usize] += 1;
        }
        let mut shapes: Vec<usize> = (0..MOST_SHAPES).filter(|&s| counts[s] > 0).collect();
        shapes.sort_by_key(|&s| std::cmp::Reverse(counts[s]));
        let slots = slots_for(nodes.len());
        let mut words = vec![0; SLOTS + slots];
        words[0] = shapes.len() as u32;
        words[1] = slots as u32 - 1;
        for (word, shape) in words[2..].iter_mut().zip(shapes) {
            *word = (shape as u32 / LEVELS) | ((shape as u32 % LEVELS) << 8);
        }
        let mut table = Table { words };
        for (n, node) in nodes.iter().enumerate() {
            let mut slot = hash(node.root, node.shape & 0xffff, node.i, node.j) & table.words[1];
            while table.words[SLOTS + slot as usize] != 0 {
                slot = (slot + 1) & table.words[1];
            }
            table.words[SLOTS + slot as usize] = n as u32 + 1;
        }
        table
    }

    /// As kernels read it.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// The leaf of the word that is this cell.
    #[inline]
    pub fn leaf(&self, nodes: &[Node], root: u32, shape: u32, [i, j]: [u32; 2]) -> Option<u32> {
        let mut slot = hash(root, shape, i, j) & self.words[1];
        loop {
            let n = self.words[SLOTS + slot as usize].checked_sub(1)?;
            let node = &nodes[n as usize];
            if (node.root, node.shape & 0xffff, node.i, node.j) == (root, shape, i, j) {
                return Some(n);
            }
            slot = (slot + 1) & self.words[1];
        }
    }

    /// The node that covers a lattice cell, and its halvings.
    #[inline]
    pub(super) fn find(&self, nodes: &[Node], root: u32, p: [u32; 2]) -> (u32, [u32; 2]) {
        for &shape in &self.words[2..2 + self.words[0] as usize] {
            let depth = [shape & 0xff, shape >> 8];
            let cell = [p[0] >> (LEVELS - depth[0]), p[1] >> (LEVELS - depth[1])];
            if let Some(n) = self.leaf(nodes, root, shape, cell) {
                return (n, depth);
            }
        }
        unreachable!("the leaves of root {root} cover it")
    }
}

fn hash(root: u32, shape: u32, i: u32, j: u32) -> u32 {
    let mut h = root
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add(shape.wrapping_mul(0x27d4_eb2f))
        .wrapping_add(i.wrapping_mul(0x85eb_ca77))
        .wrapping_add(j.wrapping_mul(0xc2b2_ae3d));
    h ^= h >> 15;
    h = h.wrapping_mul(0x2c1b_3c6d);
    h ^ h >> 13
}
