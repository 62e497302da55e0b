//! Which sides and corners of a set of patches are the same curve and the same point.
//!
//! Two sides are one *curve* if their control points are equal to the bit, read one way or the other;
//! two corners are one if their positions are. Nothing is guessed: sides that nearly meet do not, and
//! a side that lies on part of another one is a border. Any number of patches may share a curve.
//!
//! Kernels read it as 4-byte words: for each root a row of [`ROOT_WORDS`], then records.
//!
//! | word of a row | holds |
//! |---|---|
//! | 0 – 3 | for each side the record of its curve, or [`NOWHERE`] if it is collapsed to a point |
//! | 4 – 7 | for each corner the record of its point |
//! | 8 | orientation (bits 0–7), halvings that the root needs at least (8–15), whether each side runs against its curve (16–19), whether the root is but a point (20) |
//!
//! A record is a count and as many entries: of a curve root · 8 + side · 2 + 1 if it runs against the
//! curve's direction; of a point root · 4 + corner. Entries are in the order of the roots.

use super::lattice::{FULL, NOWHERE, Node, SIDE_CORNERS, along};
use super::orientation::{self, Orientation, bits};
use crate::patch::{Net, NetError};
use std::collections::HashMap;
use thiserror::Error;

/// Words of a root's row.
pub const ROOT_WORDS: usize = 9;

/// The most roots: entries hold their index in 29 bits.
pub const MOST_ROOTS: usize = (1 << 29) - 1;

/// The greatest coordinate, where sums of a few are still finite.
pub const MOST_COORDINATE: f32 = 1e37;

/// How the patches of a set meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology {
    words: Vec<u32>,
    roots: usize,
    report: Report,
}

/// Why patches are no set to be tessellated.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Error {
    #[error("patch {patch}: {error}")]
    Net { patch: usize, error: NetError },
    #[error("patch {patch} has the degrees {found:?}, those before it {first:?}; take sets of one kind")]
    Degrees { patch: usize, found: [u8; 2], first: [u8; 2] },
    #[error("patch {patch}: a coordinate of {found:e} is beyond {MOST_COORDINATE:e}")]
    Far { patch: usize, found: f64 },
    #[error("{patches} patches are more than {MOST_ROOTS}")]
    TooMany { patches: usize },
}

/// What was found of a set of patches.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Curves on which one patch ends: the borders of the surface.
    pub borders: usize,
    /// Curves with a patch on both sides.
    pub inner: usize,
    /// Curves on which more than two patches meet.
    pub crowded: usize,
    /// Sides that are a point.
    pub collapsed: usize,
    /// Patches that are a point: nothing is made of them.
    pub void: usize,
    /// Different points where corners lie.
    pub corners: usize,
    /// Borders that are half of another border, as (root, side) of both: the longer side first. Such
    /// patches meet without being joined; split the one with the longer side. Sides are those of the canonical
    /// orientation: [`Topology::file_side`] says which ones of the file they are.
    pub partial: Vec<[(u32, u32); 2]>,
}

/// The bits of a curve's control points, in the direction in which they are smaller.
type CurveKey = Vec<[u32; 4]>;

impl Topology {
    /// The topology of these nets, in order.
    ///
    /// # Errors
    /// When they have not all the same degrees, one does not hold together or is farther off than
    /// [`MOST_COORDINATE`], or there are too many.
    pub fn new(nets: &[Net]) -> Result<Topology, Error> {
        if nets.len() > MOST_ROOTS {
            return Err(Error::TooMany { patches: nets.len() });
        }
        let mut build = Build::default();
        for (patch, net) in nets.iter().enumerate() {
            net.validate(true).map_err(|error| Error::Net { patch, error })?;
            if net.degree != nets[0].degree {
                return Err(Error::Degrees { patch, found: net.degree, first: nets[0].degree });
            }
            let far = |p: &[f32; 4]| {
                let [x, y, z, w] = p.map(f64::from);
                x.abs().max(y.abs()).max(z.abs()) / w
            };
            let found = net.points.iter().map(far).fold(0.0, f64::max);
            if found > MOST_COORDINATE.into() {
                return Err(Error::Far { patch, found });
            }
            build.add(patch as u32, net);
        }
        Ok(build.finish())
    }

    /// As kernels read it.
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    pub fn roots(&self) -> usize {
        self.roots
    }

    pub fn report(&self) -> &Report {
        &self.report
    }

    pub fn orientation(&self, root: u32) -> Orientation {
        orientation_of(&self.words, root)
    }

    /// Whether a root is but a point.
    pub fn is_void(&self, root: u32) -> bool {
        self.words[root as usize * ROOT_WORDS + 8] >> 20 & 1 != 0
    }

    /// Each root as one cell.
    pub fn start(&self) -> Vec<Node> {
        let root = |root| Node::new(root, [0; 2], [0; 2], 0, self.is_void(root));
        (0..self.roots as u32).map(root).collect()
    }

    /// What a side of a root is in the orientation of its file: the direction that is constant there, `u`
    /// or `v`, and whether it is 0 or 1.
    pub fn file_side(&self, root: u32, side: u32) -> (char, u32) {
        let mut middle = [FULL / 2; 2];
        middle[1 - along(side)] = if side & 1 == 0 { 0 } else { FULL };
        match self.orientation(root).to_file(middle, [FULL; 2]) {
            [u @ (0 | FULL), _] => ('u', u / FULL),
            [_, v] => ('v', v / FULL),
        }
    }

    /// Whether a side of a root is one point.
    pub fn is_collapsed(&self, root: u32, side: u32) -> bool {
        curve_of(&self.words, root, side) == NOWHERE
    }
}

/// The orientation of a root in the words of a topology.
#[inline]
pub fn orientation_of(words: &[u32], root: u32) -> Orientation {
    Orientation(words[root as usize * ROOT_WORDS + 8] as u8)
}

/// Halvings that cells of a root need at least, for its edges to be told apart.
#[inline]
pub fn least_depth(words: &[u32], root: u32) -> u32 {
    words[root as usize * ROOT_WORDS + 8] >> 8 & 0xff
}

/// The record of a root's side, or [`NOWHERE`].
#[inline]
pub fn curve_of(words: &[u32], root: u32, side: u32) -> u32 {
    words[root as usize * ROOT_WORDS + side as usize]
}

/// Whether a root's side runs against its curve.
#[inline]
pub fn reversed(words: &[u32], root: u32, side: u32) -> bool {
    words[root as usize * ROOT_WORDS + 8] >> (16 + side) & 1 != 0
}

/// The record of a root's corner.
#[inline]
pub fn point_of(words: &[u32], root: u32, corner: u32) -> u32 {
    words[root as usize * ROOT_WORDS + 4 + corner as usize]
}

/// The entries of a record.
#[inline]
pub fn entries(words: &[u32], record: u32) -> &[u32] {
    let at = record as usize;
    &words[at + 1..][..words[at] as usize]
}

/// Root and side of an entry, and whether it runs against the curve.
#[inline]
pub fn incidence(entry: u32) -> (u32, u32, bool) {
    (entry >> 3, entry >> 1 & 3, entry & 1 != 0)
}

/// A place along a side as one along its curve, or the other way.
#[inline]
pub fn turned(t: u32, reversed: bool) -> u32 {
    if reversed { FULL - t } else { t }
}

/// A row being made: curves and points by index.
struct Row {
    orientation: Orientation,
    curves: [Option<usize>; 4],
    /// Whether each side runs against its curve, by bits.
    reversed: u32,
    points: [usize; 4],
    /// All control points lie in one place.
    void: bool,
}

#[derive(Default)]
struct Build {
    rows: Vec<Row>,
    curves: Vec<Vec<u32>>,
    /// The control points of each curve, in its own direction.
    shapes: Vec<CurveKey>,
    curve_by_key: HashMap<CurveKey, usize>,
    points: Vec<Vec<u32>>,
    point_by_key: HashMap<[u32; 3], usize>,
    collapsed: usize,
}

impl Build {
    fn add(&mut self, root: u32, net: &Net) {
        let orientation = Orientation::canonical(net);
        let points: Vec<[f32; 4]> =
            orientation::points(net.degree, orientation).map(|at| net.points[at]).collect();
        let [m, n] = net.degree.map(usize::from);
        let at = |i: usize, j: usize| points[i * (n + 1) + j];
        let corners = [at(0, 0), at(m, 0), at(0, n), at(m, n)];
        let void = points.iter().all(|&p| position(p) == position(points[0]));
        let mut row = Row { orientation, curves: [None; 4], reversed: 0, points: [0; 4], void };
        for (corner, point) in corners.into_iter().enumerate() {
            let known = self.points.len();
            let id = *self.point_by_key.entry(position(point)).or_insert(known);
            if id == known {
                self.points.push(Vec::new());
            }
            self.points[id].push(root << 2 | corner as u32);
            row.points[corner] = id;
        }
        let down = |j: usize| (0..=m).map(|i| at(i, j)).collect::<Vec<_>>();
        let across = |i: usize| (0..=n).map(|j| at(i, j)).collect::<Vec<_>>();
        for (side, curve) in [across(0), across(m), down(0), down(n)].into_iter().enumerate() {
            if curve.iter().all(|&p| position(p) == position(curve[0])) {
                self.collapsed += 1;
                continue;
            }
            let (key, reversed) = key_of(&curve);
            let known = self.curves.len();
            let id = *self.curve_by_key.entry(key.clone()).or_insert(known);
            if id == known {
                self.curves.push(Vec::new());
                self.shapes.push(key);
            }
            self.curves[id].push(root << 3 | (side as u32) << 1 | u32::from(reversed));
            row.curves[side] = Some(id);
            row.reversed |= u32::from(reversed) << side;
        }
        self.rows.push(row);
    }

    fn finish(self) -> Topology {
        let depths = self.least_depths();
        let mut words = vec![0; self.rows.len() * ROOT_WORDS];
        let mut record = |entries: &Vec<u32>| {
            let at = words.len() as u32;
            words.push(entries.len() as u32);
            words.extend(entries);
            at
        };
        let curves: Vec<u32> = self.curves.iter().map(&mut record).collect();
        let points: Vec<u32> = self.points.iter().map(&mut record).collect();
        for ((row, depth), out) in self.rows.iter().zip(depths).zip(words.chunks_exact_mut(ROOT_WORDS)) {
            for side in 0..4 {
                out[side] = row.curves[side].map_or(NOWHERE, |id| curves[id]);
                out[4 + side] = points[row.points[side]];
            }
            out[8] =
                u32::from(row.orientation.0) | depth << 8 | row.reversed << 16 | u32::from(row.void) << 20;
        }
        let with = |few: fn(usize) -> bool| self.curves.iter().filter(|c| few(c.len())).count();
        let report = Report {
            borders: with(|n| n == 1),
            inner: with(|n| n == 2),
            crowded: with(|n| n > 2),
            collapsed: self.collapsed,
            void: self.rows.iter().filter(|row| row.void).count(),
            corners: self.points.len(),
            partial: self.partial(),
        };
        Topology { words, roots: self.rows.len(), report }
    }

    /// Two points joined by two different edges (curves with the same ends, a curve and the diagonal
    /// of an unsplit cell) would become one edge of four triangles, a closed curve one of no length:
    /// such roots are split before anything else.
    fn least_depths(&self) -> Vec<u32> {
        #[derive(Clone, Copy, PartialEq)]
        enum Edge {
            Curve(usize),
            Diagonal(usize),
        }
        let edges = |root: usize, row: &Row| {
            let ends = |[a, b]: [u32; 2]| [row.points[a as usize], row.points[b as usize]];
            let sides = (0..4).filter_map(move |side: usize| {
                Some((ends(SIDE_CORNERS[side]), Edge::Curve(row.curves[side]?)))
            });
            // A cell with a collapsed side is one triangle, without a diagonal.
            let quad = row.curves.iter().all(Option::is_some);
            let diagonal = quad.then(|| (ends([0, 3]), Edge::Diagonal(root)));
            sides.chain(diagonal).collect::<Vec<_>>()
        };
        let mut first: HashMap<[usize; 2], Edge> = HashMap::new();
        let mut doubled: std::collections::HashSet<[usize; 2]> = Default::default();
        let sorted = |[a, b]: [usize; 2]| [a.min(b), a.max(b)];
        for (root, row) in self.rows.iter().enumerate() {
            for (ends, edge) in edges(root, row) {
                if *first.entry(sorted(ends)).or_insert(edge) != edge {
                    doubled.insert(sorted(ends));
                }
            }
        }
        let need = |(ends, edge): ([usize; 2], Edge)| match edge {
            Edge::Curve(_) if ends[0] == ends[1] => 2,
            _ if ends[0] == ends[1] || doubled.contains(&sorted(ends)) => 1,
            _ => 0,
        };
        // With two sides that are points an unsplit cell has no triangle, with four none at depth 1.
        let of_sides = |row: &Row| (row.curves.iter().filter(|c| c.is_none()).count() / 2) as u32;
        let of_root = |(root, row): (usize, &Row)| {
            let of_edges = edges(root, row).into_iter().map(need).max().unwrap_or(0);
            if row.void { 0 } else { of_edges.max(of_sides(row)) }
        };
        self.rows.iter().enumerate().map(of_root).collect()
    }

    /// Borders of which one is half of the other.
    fn partial(&self) -> Vec<[(u32, u32); 2]> {
        let mut found = Vec::new();
        for (id, curve) in self.curves.iter().enumerate().filter(|(_, c)| c.len() == 1) {
            for half in halves(&self.shapes[id]) {
                let Some(&other) = self.curve_by_key.get(&key_of(&half).0) else { continue };
                // Not where a curve is so small that rounding makes its halves what it is.
                if let &[entry] = self.curves[other].as_slice()
                    && other != id
                {
                    found.push([curve[0], entry].map(|e| (e >> 3, e >> 1 & 3)));
                }
            }
        }
        found
    }
}

/// Where a homogeneous point lies, as bits.
fn position([x, y, z, w]: [f32; 4]) -> [u32; 3] {
    [x / w, y / w, z / w].map(bits)
}

/// The key of a curve, and whether it runs against it.
fn key_of(curve: &[[f32; 4]]) -> (CurveKey, bool) {
    let forward: CurveKey = curve.iter().map(|p| p.map(bits)).collect();
    let backward: CurveKey = forward.iter().rev().copied().collect();
    if backward < forward { (backward, true) } else { (forward, false) }
}

/// Both halves of a curve.
fn halves(curve: &CurveKey) -> [Vec<[f32; 4]>; 2] {
    let mut row: Vec<[f32; 4]> = curve.iter().map(|p| p.map(f32::from_bits)).collect();
    let mut first = vec![row[0]];
    for last in (1..row.len()).rev() {
        for k in 0..last {
            row[k] = std::array::from_fn(|c| (row[k][c] + row[k + 1][c]) * 0.5);
        }
        first.push(row[0]);
    }
    [first, row]
}

/// The side of its root that a place lies on where it runs along `along`, if any: see [`along`].
#[inline]
pub fn side_at(across: u32, coordinate: usize) -> Option<u32> {
    let base = if coordinate == 0 { 0 } else { 2 };
    debug_assert_eq!(along(base), 1 - coordinate);
    match across {
        0 => Some(base),
        FULL => Some(base + 1),
        _ => None,
    }
}
