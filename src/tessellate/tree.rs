//! The cells of all roots as trees, and who is whose neighbour.
//!
//! Every question here is answered with integers: which leaf covers a lattice point, which leaves
//! touch one, which lie across a side. A leaf is found by walking down from its root. The kernels ask
//! the same questions in `wgsl/tessellate/shared/tree.wgsl`.
//!
//! **Why the mesh has no cracks.** The polygon of a leaf has as vertices all corners of leaves that lie
//! on its border, from either side and from every patch of a curve. On one line, or one curve, let S be
//! the set of these corners. All leaves that border on a piece of it list exactly the points of S there,
//! so two neighbouring points of S bound one edge in each, and no point of S is inside an edge. Intervals
//! of cells are dyadic: of two on one line one holds the other, or they are apart. So a leaf needs
//! to know only whether something finer lies across a side, and each finer leaf makes the one triangle
//! that its side adds to the larger one's fan.
//!
//! Cells that rules erased stay in the tree as holes: they bound their neighbours like any other, and
//! have no surface.

use super::lattice::{FULL, LEVELS, NOWHERE, Node, along, side_corner};
use super::topology::{curve_of, entries, incidence, point_of, reversed, side_at, turned};

/// The first child of a node that has none. No node has node 0 as a child.
pub const LEAF: u32 = 0;

/// Trees over roots, as the passes make them.
#[derive(Clone, Copy)]
pub struct Tree<'a> {
    /// [`Topology::words`](super::topology::Topology::words).
    pub topology: &'a [u32],
    pub nodes: &'a [Node],
    /// For each node the first of its four quarters, or [`LEAF`].
    pub children: &'a [u32],
    /// Where leaves of a word are found; none where each root is one node of the same index.
    pub word: Option<&'a super::word::Table>,
    /// Whether patches share the vertices on their curves.
    pub shared: bool,
}

/// A leaf that covers a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    pub root: u32,
    pub node: u32,
    /// Halvings along x and y.
    pub depth: [u32; 2],
}

/// A leaf that touches a lattice point, and its corner there, if the point is one of its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touching {
    pub node: u32,
    pub corner: Option<u32>,
}

/// A leaf across a side: the nearest to a place on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Across {
    pub root: u32,
    pub node: u32,
    /// The side of it that lies there.
    pub side: u32,
    /// Its halvings along that side.
    pub depth: u32,
    /// It is the leaf that was asked about, on its own root's side.
    pub itself: bool,
    /// Whether places run the other way along its side.
    pub turned: bool,
}

impl Tree<'_> {
    /// The leaf that covers the lattice cell at `p`, whose coordinates are below [`FULL`].
    pub fn locate(&self, root: u32, p: [u32; 2]) -> Found {
        let (mut node, mut depth) = match self.word {
            None => (root, [0, 0]),
            Some(table) => table.find(self.nodes, root, p),
        };
        loop {
            let first = self.children[node as usize];
            if first == LEAF {
                return Found { root, node, depth };
            }
            depth = depth.map(|d| d + 1);
            let bit = |k: usize| p[k] >> (LEVELS - depth[k]) & 1;
            node = first + (bit(0) | bit(1) << 1);
        }
    }

    /// The leaves around a lattice point of a root, in an order that depends on the point alone, until
    /// `see` says false. A leaf may come twice.
    pub fn around(&self, root: u32, p: [u32; 2], mut see: impl FnMut(Touching) -> bool) {
        match (side_at(p[0], 0), side_at(p[1], 1)) {
            (Some(x), Some(y)) => {
                self.around_point(root, point_of(self.topology, root, (x & 1) | (y & 1) << 1), see);
            }
            (Some(side), None) | (None, Some(side)) => {
                let curve = curve_of(self.topology, root, side);
                if curve == NOWHERE {
                    let point = point_of(self.topology, root, side_corner(side, 0));
                    return self.around_point(root, point, see);
                }
                let t = turned(p[along(side)], reversed(self.topology, root, side));
                for &entry in entries(self.topology, curve) {
                    let (r, s, turn) = incidence(entry);
                    if !self.shared && (r, s) != (root, side) {
                        continue;
                    }
                    let t = turned(t, turn);
                    for first in [turn, !turn] {
                        // Just before t along the curve, then just behind.
                        let touching = self.at_side(r, s, t, t - u32::from(!first));
                        if !see(touching) {
                            return;
                        }
                    }
                }
            }
            (None, None) => {
                for q in 0..4 {
                    let place = [p[0] - 1 + (q & 1), p[1] - 1 + (q >> 1)];
                    let found = self.locate(root, place);
                    let end = |k: usize| end_at(place[k], found.depth[k], p[k]);
                    let corner = end(0).zip(end(1)).map(|(x, y)| x | y << 1);
                    if !see(Touching { node: found.node, corner }) {
                        return;
                    }
                }
            }
        }
    }

    fn around_point(&self, root: u32, record: u32, mut see: impl FnMut(Touching) -> bool) {
        for &entry in entries(self.topology, record) {
            let (r, corner) = (entry >> 2, entry & 3);
            if !self.shared && r != root {
                continue;
            }
            let last = |bit: u32| bit * (FULL - 1);
            let found = self.locate(r, [last(corner & 1), last(corner >> 1)]);
            if !see(Touching { node: found.node, corner: Some(corner) }) {
                return;
            }
        }
    }

    /// The leaf at a root's side that covers `place` along it, as one that touches the point `t`.
    fn at_side(&self, root: u32, side: u32, t: u32, place: u32) -> Touching {
        let found = self.locate(root, beside(side, place));
        let corner = end_at(place, found.depth[along(side)], t).map(|end| side_corner(side, end));
        Touching { node: found.node, corner }
    }

    /// The leaves across a side of a leaf, until `see` says false: in the order of the curve's patches if it
    /// lies on one, itself among them then. Of several across a side inside a root the one at its lower end comes, and so
    /// for each patch of a curve: if it is finer, nothing but that is said of it.
    pub fn across(&self, node: u32, side: u32, mut see: impl FnMut(Across) -> bool) {
        let cell = &self.nodes[node as usize];
        let k = along(side);
        let (low, size) = (cell.low(), cell.size());
        let border = low[1 - k] + (side & 1) * size[1 - k];
        match side_at(border, 1 - k) {
            None => {
                let mut place = low;
                // Just beyond the border.
                place[1 - k] = if side & 1 == 0 { border - 1 } else { border };
                let Found { root, node, depth } = self.locate(cell.root, place);
                see(Across { root, node, side: side ^ 1, depth: depth[k], itself: false, turned: false });
            }
            Some(side) => {
                let curve = curve_of(self.topology, cell.root, side);
                if curve == NOWHERE {
                    return;
                }
                let own = reversed(self.topology, cell.root, side);
                for &entry in entries(self.topology, curve) {
                    let (r, s, turn) = incidence(entry);
                    let turned = turn != own;
                    let place = if turned { FULL - low[k] - size[k] } else { low[k] };
                    let found = self.locate(r, beside(s, place));
                    let depth = found.depth[along(s)];
                    let itself = (r, s) == (cell.root, side);
                    if !see(Across { root: r, node: found.node, side: s, depth, itself, turned }) {
                        return;
                    }
                }
            }
        }
    }

    /// The leaf that owns the vertex at a lattice point, and its corner there: the first around it
    /// that has a corner there. None if none has, as in a fan's centre.
    pub fn owner(&self, root: u32, p: [u32; 2]) -> Option<(u32, u32)> {
        let mut owner = None;
        self.around(root, p, |touching| {
            owner = touching.corner.map(|corner| (touching.node, corner));
            owner.is_none()
        });
        owner
    }
}

/// The lattice cell at a root's side, at `place` along it.
fn beside(side: u32, place: u32) -> [u32; 2] {
    let across = (side & 1) * (FULL - 1);
    if along(side) == 1 { [across, place] } else { [place, across] }
}

/// Which end of the cell that covers `place` after `depth` halvings lies at `t`: 0, 1 or none.
fn end_at(place: u32, depth: u32, t: u32) -> Option<u32> {
    let size = FULL >> depth;
    let low = place & !(size - 1);
    match t {
        t if t == low => Some(0),
        t if t == low + size => Some(1),
        _ => None,
    }
}
