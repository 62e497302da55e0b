//! The eight ways to lay a patch down, and the one that its tessellation is made in.
//!
//! Files give a patch with either side first and from either end. Halving along u then v and along v
//! then u differ in the last bit inside a patch, so what must not depend on the file is computed in
//! one orientation: the smallest of the eight by the bits of its points, read row by row.

use super::lattice::FULL;
use crate::patch::Net;

/// How the canonical frame lies in the file's: bit 0 turns the file's u round, bit 1 its v, bit 2
/// lays x along the file's v in place of u.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Orientation(pub u8);

impl Orientation {
    /// The orientation in which a net is smallest. Nets of unequal degrees are never transposed,
    /// since all nets of a set have the same.
    pub fn canonical(net: &Net) -> Orientation {
        let [m, n] = net.degree;
        let all = (0..if m == n { 8 } else { 4 }).map(Orientation);
        let key = |o: Orientation| points(net.degree, o).map(|at| net.points[at].map(bits));
        all.min_by(|a, b| key(*a).cmp(key(*b))).unwrap_or_default()
    }

    /// Whether a direction of the file is turned round.
    #[inline]
    pub fn flips(self, direction: usize) -> bool {
        self.0 >> direction & 1 != 0
    }

    /// Whether x lies along the file's v.
    #[inline]
    pub fn transposes(self) -> bool {
        self.0 & 4 != 0
    }

    /// Whether normals and the sense of triangles turn over.
    #[inline]
    pub fn mirrors(self) -> bool {
        self.0.count_ones() & 1 != 0
    }

    /// The file's (row, column) of the canonical (row, column), or its (u, v) of (x, y), each from 0
    /// to its end in `most`, which is the file's.
    #[inline]
    pub fn to_file<T>(self, [x, y]: [T; 2], most: [T; 2]) -> [T; 2]
    where
        T: Copy + std::ops::Sub<Output = T>,
    {
        let [a, b] = if self.transposes() { [y, x] } else { [x, y] };
        let turn = |value: T, direction: usize| match self.flips(direction) {
            true => most[direction] - value,
            false => value,
        };
        [turn(a, 0), turn(b, 1)]
    }

    /// The other way.
    pub fn from_file<T>(self, [u, v]: [T; 2], most: [T; 2]) -> [T; 2]
    where
        T: Copy + std::ops::Sub<Output = T>,
    {
        let turn = |value: T, direction: usize| match self.flips(direction) {
            true => most[direction] - value,
            false => value,
        };
        let [a, b] = [turn(u, 0), turn(v, 1)];
        if self.transposes() { [b, a] } else { [a, b] }
    }

    /// The file's halvings, row and column of a cell as canonical ones.
    pub fn cell_from_file(self, depth: [u32; 2], cell: [u32; 2]) -> ([u32; 2], [u32; 2]) {
        let last = depth.map(|d| (1u32 << d) - 1);
        let depth = if self.transposes() { [depth[1], depth[0]] } else { depth };
        (depth, self.from_file(cell, last))
    }

    /// The file's (u, v) of a lattice point.
    pub fn uv(self, point: [u32; 2]) -> [f32; 2] {
        self.to_file(point, [FULL; 2]).map(|x| x as f32 / FULL as f32)
    }
}

/// Where the points of the canonical net stand in the file's, row by row.
pub fn points([m, n]: [u8; 2], orientation: Orientation) -> impl Iterator<Item = usize> {
    let (m, n) = (m as usize, n as usize);
    let (rows, columns) = if orientation.transposes() { (n, m) } else { (m, n) };
    (0..=rows).flat_map(move |i| {
        (0..=columns).map(move |j| {
            let [a, b] = orientation.to_file([i, j], [m, n]);
            a * (n + 1) + b
        })
    })
}

/// The bits of a coordinate, +0 for −0.
pub fn bits(x: f32) -> u32 {
    (x + 0.0).to_bits()
}
