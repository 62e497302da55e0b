//! Rings: vertices around which no grid goes on, refined with their neighbours, and how sharp edges soften level by level.

use super::connect::{HalfEdges, NONE};
use super::explicit::step;
use super::options::Creasing;
use super::roots::{Roots, SpecialCorner};
use super::schemes::{Scheme, Step, ring_weights};
use super::sharpness::{INFINITE, Rule, blend, edge_weight, falls, halves};

/// A vertex that is not regular: of another valence than four, on a border, or with something sharp. Its points are itself,
/// the other ends of its edges counter-clockwise, then the opposite corners of its faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    pub vertex: u32,
    /// Its first point, among those of all rings at one level.
    pub first: u32,
    pub faces: u32,
    /// As many as faces, or one more on a border.
    pub edges: u32,
    /// Its place among the rings where something is sharp, or [`NONE`].
    pub sharp: u32,
    /// Of a smooth vertex, see [`QuadScheme::ring`](super::schemes::QuadScheme::ring).
    pub weights: [f32; 2],
    /// Which of its faces is the root that owns the vertex.
    pub owner: u32,
}

impl Ring {
    /// Points at a level.
    pub fn len(&self) -> usize {
        (1 + self.edges + self.faces) as usize
    }

    pub fn is_empty(&self) -> bool {
        false
    }
}

/// All rings of some roots.
#[derive(Clone, Debug, Default)]
pub struct Rings {
    pub rings: Vec<Ring>,
    /// The points of all rings at level 0, as numbers of the points of the roots.
    pub points: Vec<u32>,
    /// For each edge of a ring where something is sharp the crease along it, or [`NONE`], and whether the vertex is where
    /// that crease begins.
    edges: Vec<(u32, bool)>,
    /// For each such ring its first edge there.
    first_edges: Vec<u32>,
}

impl Rings {
    /// Finds the rings, and tells the roots which of their corners have one.
    pub fn new(roots: &mut Roots, scheme: Scheme) -> Rings {
        let mut found = Rings::default();
        let mut seen = vec![false; roots.halves.outgoing.len()];
        for half in 0..roots.halves.len() as u32 {
            let vertex = roots.halves.origin(half);
            if !std::mem::replace(&mut seen[vertex as usize], true) {
                found.look_at(roots, scheme, vertex, half);
            }
        }
        found
    }

    fn look_at(&mut self, roots: &mut Roots, scheme: Scheme, vertex: u32, owner: u32) {
        let (around, sharp) = {
            let halves = &roots.halves;
            let sharp = !roots.sharpness.is_smooth_at(halves, vertex);
            if !sharp && is_regular(halves, vertex) {
                return;
            }
            (halves.edges_around(vertex).collect::<Vec<(u32, bool)>>(), sharp)
        };
        let halves = &roots.halves;
        let faces = around.iter().filter(|(_, leaves)| *leaves).count();
        let edges = around.len();
        let at = self.rings.len() as u32;
        let place = around.iter().position(|&(half, _)| half == owner).unwrap_or(0);
        let mut ring = Ring {
            vertex,
            first: self.points.len() as u32,
            faces: faces as u32,
            edges: edges as u32,
            sharp: NONE,
            weights: ring_weights(scheme, faces),
            owner: place as u32,
        };
        self.points.push(vertex);
        let other =
            |&(half, leaves): &(u32, bool)| if leaves { halves.end(half) } else { halves.origin(half) };
        self.points.extend(around.iter().map(other));
        self.points
            .extend(around[..faces].iter().map(|&(half, _)| halves.origin(half & !3 | (half + 2) & 3)));
        if sharp {
            ring.sharp = self.first_edges.len() as u32;
            self.first_edges.push(self.edges.len() as u32);
            self.edges.extend(around.iter().map(|&(half, leaves)| {
                let along = halves.is_first(half) == leaves;
                (roots.crease_of[halves.edge(half) as usize], along)
            }));
        }
        self.rings.push(ring);
        for (i, &(half, _)) in around[..faces].iter().enumerate() {
            let border = edges > faces;
            let before = if border { i.checked_sub(1) } else { Some((i + faces - 1) % faces) };
            let after = if border { Some(i + 2).filter(|&i| i < edges) } else { Some((i + 2) % faces) };
            let point = |edge: Option<usize>| edge.map_or(NONE, |edge| 1 + edge as u32);
            roots.special_at((half / 4) as usize).corners[(half & 3) as usize] =
                SpecialCorner { ring: at, beside: [point(before), point(after)] };
        }
    }

    /// Rings where something is sharp.
    pub fn sharp_count(&self) -> usize {
        self.first_edges.len()
    }
}

/// A vertex with four faces around it.
pub fn is_regular(halves: &HalfEdges, vertex: u32) -> bool {
    let mut all = halves.edges_around(vertex).take(5);
    let four = all.by_ref().take(4).filter(|(_, leaves)| *leaves).count() == 4;
    four && all.next().is_none()
}

/// How the sharp edges of some roots soften, level by level.
#[derive(Clone, Debug, Default)]
pub struct Creases {
    levels: usize,
    rows: Vec<Row>,
    /// See [`Creases::weight`].
    weights: Vec<f32>,
    /// See [`Creases::sharpness`].
    sharpness: Vec<f32>,
    /// For each ring where something is sharp, `levels` of each.
    pub steps: Vec<Step>,
    /// How much the middles of a ring's edges count in their points: a ring after the other, level by level.
    pub edge_weights: Vec<f32>,
    /// For each such ring its first edge among those of all.
    firsts: Vec<u32>,
    /// Sharpness of these edges at the last level, and of the rings' vertices.
    edges: Vec<f32>,
    vertices: Vec<f32>,
}

/// Where one crease has its numbers. All pieces of it are equally sharp, or each has numbers of its own.
#[derive(Clone, Copy, Debug)]
struct Row {
    weights: u32,
    sharpness: u32,
    uniform: bool,
}

impl Creases {
    /// Through so many levels.
    pub fn new(roots: &Roots, rings: &Rings, creasing: Creasing, levels: usize) -> Creases {
        let mut creases = Creases { levels, ..Creases::default() };
        for &edge in &roots.creases {
            let s = roots.sharpness.edges[edge as usize];
            let uniform = creasing == Creasing::Uniform || s >= INFINITE;
            let row = Row {
                weights: creases.weights.len() as u32,
                sharpness: creases.sharpness.len() as u32,
                uniform,
            };
            creases.rows.push(row);
            let [weights, pieces] = match uniform {
                true => [levels, levels + 1],
                false => [(2 << levels) - 2 - levels, (2 << levels) - 1],
            };
            creases.weights.resize(creases.weights.len() + weights, 0.0);
            creases.sharpness.resize(creases.sharpness.len() + pieces, 0.0);
            creases.sharpness[row.sharpness as usize] = s;
        }
        let sharp = || rings.rings.iter().filter(|ring| ring.sharp != NONE);
        creases.vertices = sharp().map(|ring| roots.sharpness.vertices[ring.vertex as usize]).collect();
        creases.firsts = rings.first_edges.clone();
        creases.edges = vec![0.0; rings.edges.len()];
        creases.steps = vec![Step::default(); rings.sharp_count() * levels];
        creases.edge_weights = vec![0.0; rings.edges.len() * levels];
        for level in 0..levels {
            creases.soften(rings, creasing, level);
        }
        sharp().for_each(|ring| creases.note_sharpness(rings, ring, levels));
        creases
    }

    /// The edges of a sharp ring, each with its crease.
    fn edges_of<'a>(rings: &'a Rings, ring: &Ring) -> &'a [(u32, bool)] {
        &rings.edges[rings.first_edges[ring.sharp as usize] as usize..][..ring.edges as usize]
    }

    fn note_sharpness(&mut self, rings: &Rings, ring: &Ring, level: usize) {
        let at = self.firsts[ring.sharp as usize] as usize;
        for (i, &(crease, begins)) in Creases::edges_of(rings, ring).iter().enumerate() {
            let piece = if begins { 0 } else { (1 << level) - 1 };
            self.edges[at + i] =
                if crease == NONE { 0.0 } else { self.sharpness(crease as usize, level, piece) };
        }
    }

    /// From one level to the next.
    fn soften(&mut self, rings: &Rings, creasing: Creasing, level: usize) {
        let mut after = Vec::new();
        let pieces = 1usize << level;
        // Along the creases, but for their ends.
        for at in 0..self.rows.len() {
            match self.rows[at].uniform {
                true => {
                    let s = falls(self.sharpness(at, level, 0));
                    *self.sharpness_mut(at, level + 1, 0) = s;
                }
                false => {
                    for i in 1..pieces {
                        let two = [i - 1, i].map(|i| self.sharpness(at, level, i));
                        halves(&two, creasing, &mut after);
                        *self.sharpness_mut(at, level + 1, 2 * i - 1) = after[0];
                        *self.sharpness_mut(at, level + 1, 2 * i) = after[1];
                    }
                }
            }
        }
        for ring in rings.rings.iter().filter(|ring| ring.sharp != NONE) {
            self.note_sharpness(rings, ring, level);
            let at = self.firsts[ring.sharp as usize] as usize;
            let before = &self.edges[at..][..ring.edges as usize];
            halves(before, creasing, &mut after);
            let vertex = &mut self.vertices[ring.sharp as usize];
            let fallen = falls(*vertex);
            self.steps[ring.sharp as usize * self.levels + level] = step([*vertex, fallen], before, &after);
            *vertex = fallen;
            for (&(crease, begins), &s) in Creases::edges_of(rings, ring).iter().zip(&after) {
                if crease != NONE && !self.rows[crease as usize].uniform {
                    let piece = if begins { 0 } else { 2 * pieces - 1 };
                    *self.sharpness_mut(crease as usize, level + 1, piece) = s;
                }
            }
        }
        for at in 0..self.rows.len() {
            let uniform = self.rows[at].uniform;
            for t in 0..if uniform { 1 } else { 2 * pieces - 1 } {
                let (first, second) = (t / 2, t / 2 + t % 2);
                let old = [first, second].map(|i| self.sharpness(at, level, i));
                let weight = match t % 2 {
                    0 => edge_weight(old[0], [t, t + 1].map(|i| self.sharpness(at, level + 1, i))),
                    _ => on_crease(old, [t, t + 1].map(|i| self.sharpness(at, level + 1, i))),
                };
                *self.weight_mut(at, level, t) = weight;
            }
        }
        for ring in rings.rings.iter().filter(|ring| ring.sharp != NONE) {
            let to = self.weights_of(ring, level);
            for (i, &(crease, begins)) in Creases::edges_of(rings, ring).iter().enumerate() {
                let t = if begins { 0 } else { 2 * pieces - 2 };
                self.edge_weights[to + i] =
                    if crease == NONE { 0.0 } else { self.weight(crease as usize, level, t) };
            }
        }
    }

    fn weight_at(&self, crease: usize, level: usize, t: usize) -> usize {
        let row = self.rows[crease];
        row.weights as usize + if row.uniform { level } else { (2 << level) - 2 - level + t }
    }

    fn weight_mut(&mut self, crease: usize, level: usize, t: usize) -> &mut f32 {
        let at = self.weight_at(crease, level, t);
        &mut self.weights[at]
    }

    fn sharpness_at(&self, crease: usize, level: usize, piece: usize) -> usize {
        let row = self.rows[crease];
        row.sharpness as usize + if row.uniform { level } else { (1 << level) - 1 + piece }
    }

    fn sharpness_mut(&mut self, crease: usize, level: usize, piece: usize) -> &mut f32 {
        let at = self.sharpness_at(crease, level, piece);
        &mut self.sharpness[at]
    }

    /// How much the sharp mask counts in the points inside a crease that come after a level: point `t + 1` of twice as many
    /// pieces, in the direction of its edge.
    pub fn weight(&self, crease: usize, level: usize, t: usize) -> f32 {
        self.weights[self.weight_at(crease, level, t)]
    }

    /// Of a piece of a crease at a level.
    pub fn sharpness(&self, crease: usize, level: usize, piece: usize) -> f32 {
        self.sharpness[self.sharpness_at(crease, level, piece)]
    }

    /// All weights, and where those of a crease begin among them; whether one a level serves all of its points.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// See [`Creases::weights`].
    pub fn row(&self, crease: usize) -> (u32, bool) {
        (self.rows[crease].weights, self.rows[crease].uniform)
    }

    /// Where the weights of a sharp ring at a level begin.
    fn weights_of(&self, ring: &Ring, level: usize) -> usize {
        self.firsts[ring.sharp as usize] as usize * self.levels + level * ring.edges as usize
    }

    /// How the vertex of a sharp ring goes on from a level, and how much the middles of its edges count in their points.
    pub fn ring(&self, ring: &Ring, level: usize) -> (&Step, &[f32]) {
        let step = &self.steps[ring.sharp as usize * self.levels + level];
        (step, &self.edge_weights[self.weights_of(ring, level)..][..ring.edges as usize])
    }

    /// The rule of a ring's vertex at the last level, and the sharpness of its edges there.
    pub fn last(&self, ring: &Ring) -> (Rule, &[f32]) {
        let edges = &self.edges[self.firsts[ring.sharp as usize] as usize..][..ring.edges as usize];
        (Rule::of(self.vertices[ring.sharp as usize], edges.iter().copied()), edges)
    }

    /// Levels it goes through.
    pub fn levels(&self) -> usize {
        self.levels
    }
}

/// How much the crease rule counts in a vertex between two pieces of a crease.
fn on_crease(before: [f32; 2], after: [f32; 2]) -> f32 {
    let is = |s: [f32; 2]| s[0] > 0.0 && s[1] > 0.0;
    match (is(before), is(after)) {
        (true, true) => 1.0,
        (true, false) => blend(0.0, &before, &after),
        _ => 0.0,
    }
}
