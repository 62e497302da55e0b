//! A tessellation, written once: its passes, and what each reads and writes.
//!
//! ```text
//! recall        the leaves of a word that was derived            records → leaves
//! adopt         whether it takes the place of the one before
//! enter         its leaves as the first level, and their table   leaves → nodes, table
//! begin         what is given back of a raised tolerance
//! for each level of the trees
//!   decide      which cells are split                              nodes, nets → counts, marks cleared
//!   scan        where their children go                            counts → offsets
//!   split       the children                                       offsets → nodes, children
//!   advance     where the next level begins
//! mark          which sides have something finer across            nodes, children → marks
//! tally         vertices and triangles that each leaf makes        marks → marks, counts
//! scan, scan    where they go                                      counts → offsets
//! afford        whether they keep to the budget; if not, all again with a larger tolerance
//! finish        the draw's arguments; whether all fits
//! vertices      each vertex once, by the leaf that owns it         nets, marks, offsets → vertices
//! triangles     by the leaf whose side it has                      marks, offsets → indices, cells
//! ```
//!
//! The first three run where rules are derived with the frame: `gpu/run`. Nothing decides an index but a scan; `mark`
//! sets bits, in any order. All counts are on the device, and no pass waits for the host.

use super::lattice::{FULL, NOWHERE, Node, SIDE_CORNERS, along};
use super::topology::{curve_of, side_at};
use super::tree::{Across, LEAF, Tree};

/// Bits of a node's marks: 0–3, something finer lies across the side.
pub const FINER: u32 = 0xf;

/// Bits 4–7: the leaf owns the vertex at the corner.
pub const OWNS: u32 = 4;

/// Bit 8: the leaf has a vertex at its centre, and owns it.
pub const FAN: u32 = 1 << 8;

/// What a tessellation says of itself: how much of each there is to write, whether or not there was room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Status {
    /// Nodes of the trees. Where there was no room some cells stayed coarser, and their children's
    /// children, which nobody counted, are not among these.
    pub nodes: u32,
    pub node_capacity: u32,
    pub vertices: u32,
    pub vertex_capacity: u32,
    pub indices: u32,
    pub index_capacity: u32,
    /// Not 0: vertices or indices did not fit, and those of the frame before still stand.
    pub skipped: u32,
    /// Frames recorded, this one included.
    pub frame: u32,
    /// The tolerance was raised by so many quarters of an octave to keep to the budget of triangles:
    /// [`raised`](super::budget::raised).
    pub coarser: u32,
    /// Where the word is derived with the frame: modules of the longest word on the way, and how many there is room
    /// for. Where there are more, the word of the frame before still stands.
    pub modules: u32,
    pub module_capacity: u32,
    /// Not 0: a cell of the word was halved too often, and the word of the frame before still stands.
    pub too_deep: u32,
}

impl Status {
    /// Whether all that there is to write was written.
    pub fn complete(&self) -> bool {
        let word = self.modules <= self.module_capacity && self.too_deep == 0;
        word && self.nodes <= self.node_capacity && self.skipped == 0
    }
}

/// Arguments of an indexed draw, as WebGPU lays them out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct DrawArgs {
    pub index_count: u32,
    pub instance_count: u32,
    pub first_index: u32,
    pub base_vertex: u32,
    pub first_instance: u32,
}

/// The corners of a cell as its two triangles, counter-clockwise from where S_x × S_y points. Both have the
/// corners 0 and 3; the first has sides 2 and 1, the second 3 and 0.
pub const QUAD: [[u32; 3]; 2] = [[0, 1, 3], [0, 3, 2]];

/// The sides of the two triangles of a cell.
const QUAD_SIDES: [[u32; 2]; 2] = [[2, 1], [3, 0]];

/// The corners of a side in the order in which a triangle of the cell runs along it.
pub const SIDE_AROUND: [[u32; 2]; 4] = [[2, 0], [1, 3], [0, 1], [3, 2]];

/// A triangle, before its vertices have numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Triangle {
    /// One of the two of a cell whose neighbours are no finer.
    Quad(usize),
    /// Side and centre of the leaf.
    Own { side: u32 },
    /// A side of the leaf with the centre of a larger one across it.
    Pushed { side: u32, to: Across },
}

/// A vertex of a triangle, before it has a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// At a lattice point of a root.
    At { root: u32, p: [u32; 2] },
    /// At the centre of a leaf.
    Centre { node: u32 },
}

impl Tree<'_> {
    /// The vertices of a triangle that `node` makes, counter-clockwise in the canonical orientation of the
    /// root that it belongs to, and the leaf whose surface it is.
    pub fn corners(&self, node: u32, triangle: Triangle) -> ([Corner; 3], u32) {
        let cell = &self.nodes[node as usize];
        let at = |corner: u32| Corner::At { root: cell.root, p: cell.corner(corner) };
        match triangle {
            Triangle::Quad(k) => (QUAD[k].map(at), node),
            Triangle::Own { side } => {
                let [a, b] = SIDE_AROUND[side as usize].map(at);
                ([a, b, Corner::Centre { node }], node)
            }
            Triangle::Pushed { side, to } => {
                let [a, b] = self.foreign(cell, side, to).map(|p| Corner::At { root: to.root, p });
                ([a, b, Corner::Centre { node: to.node }], to.node)
            }
        }
    }

    /// The ends of a side, as points of the root across it, in the order in which its leaf runs round.
    pub fn foreign(&self, cell: &Node, side: u32, to: Across) -> [[u32; 2]; 2] {
        let (low, size) = (cell.low()[along(side)], cell.size()[along(side)]);
        let low = if to.turned { FULL - low - size } else { low };
        let other = &self.nodes[to.node as usize];
        let k = along(to.side);
        let end = |high: bool| {
            let mut p = other.corner(SIDE_CORNERS[to.side as usize][0]);
            p[k] = low + if high { size } else { 0 };
            p
        };
        // Sides 0 and 3 are run along from their high end.
        let falls = matches!(to.side, 0 | 3);
        [end(falls), end(!falls)]
    }

    /// Whether this side of a leaf lies on a side of its root that is one point.
    fn collapsed(&self, node: &Node, side: u32) -> bool {
        on_border(node, side) && curve_of(self.topology, node.root, side) == NOWHERE
    }

    /// Tells each larger leaf across a side of this one, and which of its sides it is.
    pub fn larger(&self, node: u32, mut see: impl FnMut(u32, u32)) {
        let depth = self.nodes[node as usize].depth();
        for side in 0..4 {
            let own = depth[along(side)];
            self.across(node, side, |across| {
                if across.depth < own {
                    see(across.node, across.side);
                }
                true
            });
        }
    }

    /// The triangles that a leaf with these marks makes, in order.
    pub fn triangles(&self, node: u32, marks: u32, mut see: impl FnMut(Triangle)) {
        let cell = &self.nodes[node as usize];
        let collapsed: [bool; 4] = std::array::from_fn(|side| self.collapsed(cell, side as u32));
        let finer = |side: u32| marks >> side & 1 != 0;
        if !cell.is_hole() {
            if marks & FINER == 0 {
                // Three of its corners are one point where two neighbouring sides are.
                let nothing = (collapsed[0] || collapsed[1]) && (collapsed[2] || collapsed[3]);
                for (k, sides) in QUAD_SIDES.iter().enumerate() {
                    if !nothing && !sides.iter().any(|&s| collapsed[s as usize]) {
                        see(Triangle::Quad(k));
                    }
                }
            } else {
                for side in (0..4).filter(|&s| !finer(s) && !collapsed[s as usize]) {
                    see(Triangle::Own { side });
                }
            }
        }
        for side in (0..4).filter(|&s| !finer(s)) {
            let own = cell.depth()[along(side)];
            // Of the leaves with this very side the first on the curve makes the triangles.
            let mut first = true;
            let mut before_itself = true;
            self.across(node, side, |across| {
                if across.itself {
                    before_itself = false;
                } else if before_itself && across.depth == own && on_border(cell, side) {
                    first = false;
                }
                first
            });
            if !first {
                continue;
            }
            self.across(node, side, |to| {
                if to.depth < own && !self.nodes[to.node as usize].is_hole() {
                    see(Triangle::Pushed { side, to });
                }
                true
            });
        }
    }

    /// Which vertices a leaf owns, as the bits [`OWNS`] and [`FAN`]. A vertex is there if a leaf that is
    /// no hole touches it.
    pub fn owned(&self, node: u32, marks: u32) -> u32 {
        let cell = &self.nodes[node as usize];
        let mut owned = 0;
        for corner in 0..4 {
            let (mut first, mut seen) = (true, !cell.is_hole());
            let mut own = false;
            self.around(cell.root, cell.corner(corner), |touching| {
                if !own {
                    match touching.corner {
                        Some(c) if (touching.node, c) == (node, corner) => own = true,
                        Some(_) => first = false,
                        None => {}
                    }
                }
                seen |= !self.nodes[touching.node as usize].is_hole();
                first && !(own && seen)
            });
            if first && seen {
                owned |= 1 << (OWNS + corner);
            }
        }
        let fan = !cell.is_hole() && marks & FINER != 0;
        owned | if fan { FAN } else { 0 }
    }

    pub fn is_leaf(&self, node: u32) -> bool {
        self.children[node as usize] == LEAF
    }
}

/// Whether a side of a cell lies on a side of its root.
#[inline]
pub fn on_border(node: &Node, side: u32) -> bool {
    let across = 1 - along(side);
    side_at(node.corner(SIDE_CORNERS[side as usize][0])[across], across).is_some()
}
