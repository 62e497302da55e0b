//! Cells of a root, and the lattice that their corners lie on.
//!
//! Topology is decided by integers alone. A root's square is a lattice of [`FULL`] steps along each
//! side; a cell halved du and dv times is FULL / 2^du steps long and FULL / 2^dv wide, and its
//! corners and its centre are lattice points. Coordinates are those of the root's
//! [canonical orientation](super::orientation): x runs with its rows, y with its columns.
//!
//! A *node* is a cell of the tree that a tessellation refines: four words, as kernels read it.
//!
//! | word | holds |
//! |---|---|
//! | 0 | root |
//! | 1 | halvings along x (bits 0–7), along y (8–15), symbol (16–30), 1 for a hole (31) |
//! | 2, 3 | row and column of the cell at its level |

/// Halvings that the lattice resolves: parameters of its points are exact in f32.
pub const LEVELS: u32 = 24;

/// Lattice steps along a side of a root.
pub const FULL: u32 = 1 << LEVELS;

/// Halvings that a cell may have along one direction, one less than the lattice has: its centre is a
/// point, too.
pub const MAX_DEPTH: u32 = LEVELS - 1;

/// No node, no curve.
pub const NOWHERE: u32 = u32::MAX;

/// A cell of a root: a leaf of a word, or what came of one by refinement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Node {
    pub root: u32,
    pub shape: u32,
    pub i: u32,
    pub j: u32,
}

impl Node {
    /// The cell (i, j) of a root after so many halvings along x and y.
    pub fn new(root: u32, [du, dv]: [u32; 2], [i, j]: [u32; 2], symbol: u32, hole: bool) -> Node {
        Node { root, shape: du | dv << 8 | symbol << 16 | u32::from(hole) << 31, i, j }
    }

    /// Halvings along x and y.
    #[inline]
    pub fn depth(&self) -> [u32; 2] {
        [self.shape & 0xff, self.shape >> 8 & 0xff]
    }

    /// Lattice steps along x and y.
    #[inline]
    pub fn size(&self) -> [u32; 2] {
        self.depth().map(|d| FULL >> d)
    }

    /// Its corner nearest to the origin.
    #[inline]
    pub fn low(&self) -> [u32; 2] {
        let [width, height] = self.size();
        [self.i * width, self.j * height]
    }

    /// Corner c: bit 0 of c is its end along x, bit 1 along y.
    #[inline]
    pub fn corner(&self, c: u32) -> [u32; 2] {
        let ([x, y], [width, height]) = (self.low(), self.size());
        [x + (c & 1) * width, y + (c >> 1) * height]
    }

    #[inline]
    pub fn centre(&self) -> [u32; 2] {
        let ([x, y], [width, height]) = (self.low(), self.size());
        [x + width / 2, y + height / 2]
    }

    /// A cell that rules erased: it bounds its neighbours, and has no surface.
    #[inline]
    pub fn is_hole(&self) -> bool {
        self.shape >> 31 != 0
    }

    /// The symbol of the module that it came of.
    pub fn symbol(&self) -> u32 {
        self.shape >> 16 & 0x7fff
    }

    /// Quarter c of it, numbered like corners.
    #[inline]
    pub fn quarter(&self, c: u32) -> Node {
        Node { root: self.root, shape: self.shape + 0x101, i: 2 * self.i + (c & 1), j: 2 * self.j + (c >> 1) }
    }
}

/// Side s of a cell or a root: 0 at the low end of x, 1 at its high end, 2 and 3 of y.
///
/// The coordinate that runs along the side: 1 (y) for sides 0 and 1, 0 (x) for 2 and 3.
#[inline]
pub fn along(side: u32) -> usize {
    usize::from(side < 2)
}

/// The corners at the ends of a side, the one nearer to the origin first.
pub const SIDE_CORNERS: [[u32; 2]; 4] = [[0, 2], [1, 3], [0, 1], [2, 3]];

/// The corner at the end of a root's side: `end` 0 or 1.
#[inline]
pub fn side_corner(side: u32, end: u32) -> u32 {
    SIDE_CORNERS[side as usize][end as usize]
}
