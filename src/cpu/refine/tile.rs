//! A block of a root as a tile: its points with one row around, from one level to the next in the nearest cache.
//!
//! Valence never enters here. The smooth masks run on the whole tile, also where they have nothing to say: then what is on a
//! sharp side is overwritten, and of a special corner the three points at most that its ring has. What is left that is wrong
//! stands across a corner or a border, where nothing reads it.

use crate::mesh::schemes::{QuadScheme, edge_point};
use crate::mesh::{Creases, NONE, Roots, Special, Topology};
use glam::Vec4;

/// Levels that a block of the last one goes through as a tile that grows: what is wider is cut.
pub const GROWS: u32 = 5;

/// Points of the widest tile.
pub const WIDEST: usize = ((1 << GROWS) + 3) * ((1 << GROWS) + 3);

/// Where a tile stands on the grid of its root: `n × n` quads from (x, y), of `s × s`.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub x: usize,
    pub y: usize,
    pub n: usize,
    pub s: usize,
}

impl Place {
    /// Points in a row of the tile.
    fn width(self) -> usize {
        self.n + 3
    }

    /// The same place a level on.
    fn finer(self) -> Place {
        Place { x: 2 * self.x, y: 2 * self.y, n: 2 * self.n, s: 2 * self.s }
    }

    /// Whether the tile ends at side `k` of its root.
    pub fn touches(self, k: usize) -> bool {
        match k {
            0 => self.y == 0,
            1 => self.x + self.n == self.s,
            2 => self.y + self.n == self.s,
            _ => self.x == 0,
        }
    }

    /// The point of side `k` that stands at `at` on its axis.
    pub fn on_side(self, k: usize, at: usize) -> [usize; 2] {
        [[at, 0], [self.s, at], [at, self.s], [0, at]][k]
    }

    /// How far along side `k` in the direction of its edge that is. `forward`: the root runs along the edge.
    pub fn along(self, k: usize, at: usize, forward: bool) -> usize {
        // The last two sides run down their axes.
        if forward == (k >= 2) { self.s - at } else { at }
    }

    /// The points inside side `k` that the tile has, and so many beyond its quads.
    pub fn inside_side(self, k: usize, beyond: usize) -> std::ops::RangeInclusive<usize> {
        let begin = [self.x, self.y, self.x, self.y][k];
        begin.saturating_sub(beyond).max(1)..=(begin + self.n + beyond).min(self.s - 1)
    }

    /// Corner `k` of the root.
    pub fn corner(self, k: usize) -> [usize; 2] {
        [[0, 0], [self.s, 0], [self.s, self.s], [0, self.s]][k]
    }

    /// Whether the tile has corner `k` of its root.
    pub fn has_corner(self, k: usize) -> bool {
        self.touches(k) && self.touches((k + 3) & 3)
    }

    /// Where point (x, y) of the root stands in the tile.
    pub fn index(self, [x, y]: [usize; 2]) -> usize {
        (y + 1 - self.y) * self.width() + x + 1 - self.x
    }
}

/// Two tiles, of a level and of the next.
pub struct Tile {
    pub place: Place,
    pub points: Vec<Vec4>,
    next: Vec<Vec4>,
    faces: Vec<Vec4>,
}

impl Tile {
    pub fn new() -> Tile {
        let first = Place { x: 0, y: 0, n: 1, s: 1 };
        let points = || vec![Vec4::ZERO; WIDEST];
        Tile {
            place: first,
            points: points(),
            next: points(),
            faces: vec![Vec4::ZERO; 2 * ((1 << GROWS) + 3)],
        }
    }

    /// The root itself.
    pub fn begin(
        &mut self,
        topology: &Topology,
        root: usize,
        points: &[Vec4],
        rings: &[Vec4],
        levels: usize,
    ) {
        let roots = &topology.roots;
        self.place = Place { x: 0, y: 0, n: 1, s: 1 };
        for (own, &point) in self.points.iter_mut().zip(&roots.neighbourhoods[root]) {
            *own = points[point as usize];
        }
        if let Some(special) = roots.special(root) {
            corners(special, topology, self.place, 0, levels, rings, &mut self.points);
        }
    }

    /// From `level`, counted from the root, to the next.
    pub fn refine<S: QuadScheme>(
        &mut self,
        topology: &Topology,
        creases: &Creases,
        root: usize,
        level: usize,
        rings: &[Vec4],
    ) {
        smooth::<S>(&self.points, self.place.n, &mut self.next, &mut self.faces);
        let roots = &topology.roots;
        if let Some(special) = roots.special(root) {
            for k in 0..4 {
                if special.creases[k] != NONE && self.place.touches(k) {
                    self.mend::<S>(roots, creases, (root, k), special.creases[k] as usize, level);
                }
            }
            let place = self.place.finer();
            corners(special, topology, place, level + 1, creases.levels(), rings, &mut self.next);
        }
        std::mem::swap(&mut self.points, &mut self.next);
        self.place = self.place.finer();
    }

    /// Keeps the quad of this tile that block (x, y) of `2^finer` times finer quads lies in.
    pub fn cut(&mut self, [x, y]: [usize; 2], finer: u32) {
        let place = self.place;
        let inner = Place { x: x >> finer, y: y >> finer, n: 1, s: place.s };
        let from = (inner.y - place.y) * place.width() + inner.x - place.x;
        for row in 0..4 {
            self.next[4 * row..4 * row + 4].copy_from_slice(&self.points[from + row * place.width()..][..4]);
        }
        std::mem::swap(&mut self.points, &mut self.next);
        self.place = inner;
    }

    /// The points of a sharp side that the next level has in this tile.
    fn mend<S: QuadScheme>(
        &mut self,
        roots: &Roots,
        creases: &Creases,
        (root, k): (usize, usize),
        crease: usize,
        level: usize,
    ) {
        let (place, next) = (self.place, self.place.finer());
        let forward = roots.owns_side(root, k);
        for at in next.inside_side(k, 1) {
            let weight = creases.weight(crease, level, next.along(k, at, forward) - 1);
            if weight <= 0.0 {
                continue;
            }
            // As the tile runs, not as the root does: masks are the same both ways.
            let old = |at: usize| self.points[place.index(place.on_side(k, at))];
            let out = &mut self.next[next.index(next.on_side(k, at))];
            *out = match (at / 2, at & 1) {
                (i, 1) => edge_point([old(i), old(i + 1)], weight, || *out),
                (i, _) => {
                    let sharp = S::crease(old(i), [old(i - 1), old(i + 1)]);
                    if weight == 1.0 { sharp } else { *out * (1.0 - weight) + sharp * weight }
                }
            };
        }
    }
}

/// What the rings of special corners have of a tile at a level.
fn corners(
    special: &Special,
    topology: &Topology,
    place: Place,
    level: usize,
    levels: usize,
    rings: &[Vec4],
    tile: &mut [Vec4],
) {
    let width = place.width() as isize;
    for (k, corner) in special.corners.iter().enumerate() {
        if corner.ring == NONE || !place.has_corner(k) {
            continue;
        }
        let ring = &topology.rings.rings[corner.ring as usize];
        let own = &rings[ring.first as usize * (levels + 1) + level * ring.len()..][..ring.len()];
        let at = place.index(place.corner(k));
        tile[at] = own[0];
        let outward = |k: usize| [-width, 1, width, -1][k & 3];
        for (beside, step) in corner.beside.into_iter().zip([outward(k), outward(k + 3)]) {
            if beside != NONE {
                tile[(at as isize + step) as usize] = own[beside as usize];
            }
        }
    }
}

/// The smooth masks on a tile of n × n quads. Sizes that are known when this is compiled are faster.
fn smooth<S: QuadScheme>(points: &[Vec4], n: usize, next: &mut [Vec4], faces: &mut [Vec4]) {
    match n {
        1 => sized::<S, 1>(points, n, next, faces),
        2 => sized::<S, 2>(points, n, next, faces),
        4 => sized::<S, 4>(points, n, next, faces),
        8 => sized::<S, 8>(points, n, next, faces),
        16 => sized::<S, 16>(points, n, next, faces),
        _ => sized::<S, 0>(points, n, next, faces),
    }
}

#[inline(never)]
fn sized<S: QuadScheme, const N: usize>(points: &[Vec4], n: usize, next: &mut [Vec4], faces: &mut [Vec4]) {
    let n = if N > 0 { N } else { n };
    let (width, wide) = (n + 3, 2 * n + 3);
    let (points, next) = (&points[..width * width], &mut next[..wide * wide]);
    let (above, below) = faces[..2 * (n + 2)].split_at_mut(n + 2);
    let (mut above, mut below) = (above, below);
    let row_of_faces = |out: &mut [Vec4], p: &[Vec4], q: &[Vec4]| {
        for ((out, p), q) in out.iter_mut().zip(p.windows(2)).zip(q.windows(2)) {
            *out = S::face([p[0], p[1], q[1], q[0]]);
        }
    };
    for (y, rows) in next.chunks_mut(2 * wide).enumerate() {
        // The faces between rows y and y + 1, then that row with the faces above and below it.
        let (p, q) = (&points[y * width..][..width], &points[(y + 1) * width..][..width]);
        row_of_faces(below, p, q);
        let (row, rest) = rows.split_at_mut(wide);
        row[0] = below[0];
        let pairs = row[1..].chunks_exact_mut(2);
        for ((out, f), (p, q)) in pairs.zip(below.windows(2)).zip(p[1..].iter().zip(&q[1..])) {
            out[0] = S::edge([*p, *q], [f[0], f[1]]);
            out[1] = f[1];
        }
        if rest.is_empty() {
            break;
        }
        std::mem::swap(&mut above, &mut below);
        let r = &points[(y + 2) * width..][..width];
        row_of_faces(below, q, r);
        rest[0] = S::edge([q[0], q[1]], [above[0], below[0]]);
        let pairs = rest[1..].chunks_exact_mut(2);
        let beside = q.windows(3).zip(p[1..].iter().zip(&r[1..]));
        for ((out, (f, g)), (q, (up, down))) in pairs.zip(above.windows(2).zip(below.windows(2))).zip(beside)
        {
            out[0] = S::vertex(q[1], [q[0], q[2], *up, *down], [f[0], g[1], f[1], g[0]]);
            out[1] = S::edge([q[1], q[2]], [f[1], g[1]]);
        }
    }
}
