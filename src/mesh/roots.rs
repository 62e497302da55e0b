//! Roots: quads whose refinements are grids, and the closed forms that number what comes of them.
//!
//! At level `d` a root is a grid of `s × s` quads, `s = 2^d`, and (0, 0), (s, 0), (s, s), (0, s) are its corners in order.
//! With `m = s - 1` inner points on a side, and `C[f]`, `E[f]` the corners and the edges owned by the roots before `f`:
//!
//! ```text
//! corner of rank r, owned by o    r + E[o]·m + o·m²
//! edge e, owned by o, its k-th    C[o+1] + e·m + o·m² + k        in the direction of its first half-edge
//! inside f, at (x, y)             C[f+1] + E[f+1]·m + f·m² + (y-1)·m + x-1
//! vertices of the level           C + E·m + F·m²
//! ```
//!
//! A corner is owned by the first root that has it, an edge by that of its first half-edge.

use super::connect::{HalfEdges, NONE};
use super::sharpness::Sharpness;

/// The corners of a root as (x, y) of a grid of one quad.
pub const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// The ways out of a root across its sides.
const OUTWARD: [[isize; 2]; 4] = [[0, -1], [1, 0], [0, 1], [-1, 0]];

/// Points of a root with one row around: 4 × 4, from (-1, -1), row by row.
pub const NEIGHBOURHOOD: usize = 16;

/// What a root is beside a regular grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Special {
    pub corners: [SpecialCorner; 4],
    /// For each side its place among the sharp edges, or [`NONE`].
    pub creases: [u32; 4],
}

/// A corner around which the grid of a root does not go on as a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecialCorner {
    /// Its ring, or [`NONE`] for a regular corner.
    pub ring: u32,
    /// Which points of the ring stand beside the corner outside the root: across the side that begins there, and across the
    /// one that ends there. [`NONE`] on a border.
    pub beside: [u32; 2],
}

const REGULAR: SpecialCorner = SpecialCorner { ring: NONE, beside: [NONE; 2] };

/// The roots of a mesh, in the order in which their vertices are numbered.
#[derive(Clone, Debug, Default)]
pub struct Roots {
    pub halves: HalfEdges,
    pub sharpness: Sharpness,
    /// Roots that are no holes; these come first.
    pub solid: usize,
    /// For each root the points of its neighbourhood. Where a border or a special corner leaves none, any point stands.
    pub neighbourhoods: Vec<[u32; NEIGHBOURHOOD]>,
    /// For each root its place in [`Roots::special`], or [`NONE`] for a regular one.
    pub special_of: Vec<u32>,
    pub special: Vec<Special>,
    /// Corners and edges owned by the roots before each, and by all.
    pub corners: Vec<u32>,
    pub edges: Vec<u32>,
    /// For each vertex its place among the corners, or [`NONE`] if no face has it.
    pub rank: Vec<u32>,
    corner_owner: Vec<u32>,
    edge_owner: Vec<u32>,
    /// For each edge its place among the sharp ones, or [`NONE`]; and which edges these are.
    pub crease_of: Vec<u32>,
    pub creases: Vec<u32>,
}

impl Roots {
    /// Roots in this order, of which the first `solid` are drawn.
    pub fn new(halves: HalfEdges, sharpness: Sharpness, solid: usize) -> Roots {
        let count = halves.face_count();
        let vertices = halves.outgoing.len();
        let mut roots = Roots {
            solid,
            neighbourhoods: Vec::with_capacity(count),
            special_of: vec![NONE; count],
            corners: Vec::with_capacity(count + 1),
            edges: Vec::with_capacity(count + 1),
            rank: vec![NONE; vertices],
            corner_owner: vec![NONE; vertices],
            edge_owner: vec![NONE; halves.edge_count],
            crease_of: vec![NONE; halves.edge_count],
            halves,
            sharpness,
            ..Roots::default()
        };
        let (mut corners, mut edges) = (0, 0);
        for root in 0..count as u32 {
            roots.corners.push(corners);
            roots.edges.push(edges);
            for half in 4 * root..4 * root + 4 {
                let vertex = roots.halves.origin(half) as usize;
                if roots.rank[vertex] == NONE {
                    (roots.rank[vertex], roots.corner_owner[vertex]) = (corners, root);
                    corners += 1;
                }
                if roots.halves.is_first(half) {
                    roots.edge_owner[roots.halves.edge(half) as usize] = root;
                    edges += 1;
                }
            }
            roots.neighbourhoods.push(roots.neighbourhood(root));
        }
        roots.corners.push(corners);
        roots.edges.push(edges);
        for edge in 0..roots.halves.edge_count {
            if roots.sharpness.edges[edge] > 0.0 {
                roots.crease_of[edge] = roots.creases.len() as u32;
                roots.creases.push(edge as u32);
            }
        }
        for root in 0..count {
            let creases =
                std::array::from_fn(|k| roots.crease_of[roots.halves.edge((4 * root + k) as u32) as usize]);
            if creases != [NONE; 4] {
                roots.special_at(root).creases = creases;
            }
        }
        roots
    }

    /// How many roots there are, holes with them.
    pub fn len(&self) -> usize {
        self.neighbourhoods.len()
    }

    pub fn is_empty(&self) -> bool {
        self.neighbourhoods.is_empty()
    }

    /// The points of a root that has no special corner, with one row around it.
    fn neighbourhood(&self, root: u32) -> [u32; NEIGHBOURHOOD] {
        let halves = &self.halves;
        let place = |corner: usize, out: &[usize]| {
            let [mut x, mut y] = CORNERS[corner].map(|c| c as isize);
            for &side in out {
                (x, y) = (x + OUTWARD[side][0], y + OUTWARD[side][1]);
            }
            ((y + 1) * 4 + x + 1) as usize
        };
        let of_quad = |half: u32, k: u32| halves.origin(half & !3 | (half + k) & 3);
        let mut points = [halves.origin(4 * root); NEIGHBOURHOOD];
        for k in 0..4 {
            let half = 4 * root + k as u32;
            points[place(k, &[])] = halves.origin(half);
            let Some(twin) = halves.twin(half) else { continue };
            points[place(k, &[k])] = of_quad(twin, 2);
            points[place((k + 1) & 3, &[k])] = of_quad(twin, 3);
            if let Some(across) = halves.twin(halves.next(twin)) {
                points[place(k, &[k, (k + 3) & 3])] = of_quad(across, 3);
            }
        }
        points
    }

    /// What is said of a root that is not regular.
    pub(super) fn special_at(&mut self, root: usize) -> &mut Special {
        if self.special_of[root] == NONE {
            self.special_of[root] = self.special.len() as u32;
            self.special.push(Special { corners: [REGULAR; 4], creases: [NONE; 4] });
        }
        &mut self.special[self.special_of[root] as usize]
    }

    /// What a root is beside a regular grid.
    pub fn special(&self, root: usize) -> Option<&Special> {
        self.special.get(self.special_of[root] as usize)
    }

    /// Vertices before those of a root, on grids of `s × s` quads; of all roots for their number.
    pub fn base(&self, root: usize, s: usize) -> usize {
        let m = s - 1;
        self.corners[root] as usize + self.edges[root] as usize * m + root * m * m
    }

    /// The same in 64 bits, for any level.
    pub fn count(&self, root: usize, level: u32) -> u128 {
        let m = (1u128 << level) - 1;
        u128::from(self.corners[root]) + u128::from(self.edges[root]) * m + root as u128 * m * m
    }

    /// Whether the root owns its corner `k`.
    pub fn owns_corner(&self, root: usize, k: usize) -> bool {
        self.corner_owner[self.halves.origin((4 * root + k) as u32) as usize] == root as u32
    }

    /// Whether the root owns its side `k`.
    pub fn owns_side(&self, root: usize, k: usize) -> bool {
        self.halves.is_first((4 * root + k) as u32)
    }

    /// The place of a vertex among the corners, and the root that owns it.
    pub fn corner_place(&self, vertex: u32) -> (u32, u32) {
        (self.rank[vertex as usize], self.corner_owner[vertex as usize])
    }

    /// The root that owns an edge.
    pub fn edge_place(&self, edge: u32) -> u32 {
        self.edge_owner[edge as usize]
    }

    /// The number of a vertex of the roots at a level.
    pub fn corner(&self, vertex: u32, s: usize) -> u32 {
        let (owner, m) = (self.corner_owner[vertex as usize], s as u32 - 1);
        self.rank[vertex as usize] + self.edges[owner as usize] * m + owner * m * m
    }

    /// The first inner vertex of an edge at a level, in the direction of the edge.
    pub fn edge(&self, edge: u32, s: usize) -> u32 {
        let (owner, m) = (self.edge_owner[edge as usize], s as u32 - 1);
        self.corners[owner as usize + 1] + edge * m + owner * m * m
    }

    /// The vertex at (1, 1) of a root at a level.
    pub fn inside(&self, root: usize, s: usize) -> u32 {
        let m = s as u32 - 1;
        self.corners[root + 1] + self.edges[root + 1] * m + root as u32 * m * m
    }

    /// The first inner vertex of a side as its root runs along it, and the step from one to the next.
    pub fn side(&self, half: u32, s: usize) -> (u32, i32) {
        let first = self.edge(self.halves.edge(half), s);
        match self.halves.is_first(half) {
            true => (first, 1),
            false => (first + s as u32 - 2, -1),
        }
    }

    /// The vertex at (x, y) of a root, both in 0 ..= s.
    pub fn vertex(&self, root: usize, x: usize, y: usize, s: usize) -> u32 {
        let corner = |k: usize| self.corner(self.halves.origin((4 * root + k) as u32), s);
        let on = |k: usize, t: usize| {
            let (first, step) = self.side((4 * root + k) as u32, s);
            (first as i32 + step * (t as i32 - 1)) as u32
        };
        match (x, y) {
            (0, 0) => corner(0),
            (x, 0) if x == s => corner(1),
            (x, y) if x == s && y == s => corner(2),
            (0, y) if y == s => corner(3),
            (x, 0) => on(0, x),
            (x, y) if x == s => on(1, y),
            (x, y) if y == s => on(2, s - x),
            (0, y) => on(3, s - y),
            (x, y) => self.inside(root, s) + ((y - 1) * (s - 1) + x - 1) as u32,
        }
    }
}
