//! Half-edges: which faces meet where.

use super::Mesh;
use rayon::prelude::*;
use thiserror::Error;

/// Stands where there is no half-edge or vertex.
pub const NONE: u32 = u32::MAX;

/// Why faces are no mesh that can be subdivided. Vertices and faces are counted from 0.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    #[error("face {face} names vertex {vertex}, and there are {vertices}, counted from 0")]
    Index { face: usize, vertex: u32, vertices: usize },
    #[error("face {face} has {corners} corners; a face has 3 or more")]
    Corners { face: usize, corners: usize },
    #[error("face {face} has vertex {vertex} at two of its corners")]
    Repeated { face: usize, vertex: u32 },
    #[error(
        "faces {} and {} both run from vertex {from} to vertex {to}: an edge has one face on either side, wound the \
         same way", faces[0], faces[1]
    )]
    SameWay { faces: [usize; 2], from: u32, to: u32 },
    #[error("the edge between vertices {} and {} has {faces} faces; in a manifold it has 1 or 2", vertices[0], vertices[1])]
    ManyFaces { vertices: [u32; 2], faces: usize },
    #[error("the faces around vertex {vertex} meet in that point alone; in a manifold they are one fan")]
    Fans { vertex: u32 },
    #[error("{corners} corners of faces are more than 32-bit indices can name")]
    TooLarge { corners: usize },
    #[error("{0} is {1}; a sharpness is a number from 0, and infinite from 10 on")]
    Sharpness(String, f32),
    #[error("a crease is given for vertices {} and {}, and no face has that edge", .0[0], .0[1])]
    NoEdge([u32; 2]),
    #[error("a corner is given for vertex {0}, and there are {1}, counted from 0")]
    NoVertex(u32, usize),
    #[error("face {0} is said to be a hole, and there are {1}, counted from 0")]
    NoFace(u32, usize),
    #[error("{axis} of vertex {vertex} is {value}; coordinates must be finite")]
    NotFinite { vertex: usize, axis: char, value: f32 },
}

/// The half-edges of a manifold: each corner of a face is one, which runs to the next corner. Those of a face follow each
/// other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HalfEdges {
    /// First half-edge of each face, and their number after the last; empty where all faces have [`HalfEdges::arity`].
    starts: Vec<u32>,
    /// Of each half-edge; empty as above.
    faces: Vec<u32>,
    arity: u32,
    /// Where each begins.
    pub vertices: Vec<u32>,
    /// The one that runs the other way along the same edge, or [`NONE`] on a border.
    pub twins: Vec<u32>,
    /// The edge of each. Edges are numbered in the order of their first half-edges: those that a face comes first to follow
    /// each other.
    pub edges: Vec<u32>,
    /// How many edges there are.
    pub edge_count: usize,
    /// For each vertex the half-edge from which the faces around it are walked counter-clockwise: on a border the one that
    /// has no face before it, else the first. [`NONE`] where no face has the vertex.
    pub outgoing: Vec<u32>,
}

impl HalfEdges {
    /// # Errors
    /// What keeps the faces from being a manifold, with a border or without.
    pub fn new(mesh: &Mesh) -> Result<HalfEdges, MeshError> {
        let (faces, count) = (&mesh.faces, mesh.positions.len());
        let corners = faces.vertices().len();
        // Four half-edges come of each in one step.
        if corners > (u32::MAX / 4) as usize || count >= NONE as usize {
            return Err(MeshError::TooLarge { corners: corners.max(count) });
        }
        check_faces(mesh)?;
        let vertices = faces.vertices().to_vec();
        let arity = faces.iter().next().map_or(0, <[u32]>::len);
        let mut halves = match faces.all_have(arity) {
            true => HalfEdges { arity: arity as u32, vertices, ..HalfEdges::default() },
            false => HalfEdges {
                starts: faces.starts().to_vec(),
                faces: faces
                    .iter()
                    .enumerate()
                    .flat_map(|(f, face)| face.iter().map(move |_| f as u32))
                    .collect(),
                vertices,
                ..HalfEdges::default()
            },
        };
        halves.twins = halves.matched(count)?;
        halves.number(count);
        halves.check_fans(count)?;
        Ok(halves)
    }

    /// Faces that all have so many corners, whose twins are known.
    pub(super) fn of_twins(arity: u32, vertices: Vec<u32>, twins: Vec<u32>, count: usize) -> HalfEdges {
        let mut halves = HalfEdges { arity, vertices, twins, ..HalfEdges::default() };
        halves.number(count);
        halves
    }

    /// How many half-edges there are.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// Corners of every face; none where faces differ.
    pub fn arity(&self) -> Option<usize> {
        self.faces.is_empty().then_some(self.arity as usize)
    }

    pub fn face_count(&self) -> usize {
        match self.arity {
            0 => self.starts.len().saturating_sub(1),
            arity => self.len() / arity as usize,
        }
    }

    /// The half-edges of a face.
    pub fn of_face(&self, face: usize) -> std::ops::Range<u32> {
        match self.arity {
            0 => self.starts[face]..self.starts[face + 1],
            arity => arity * face as u32..arity * (face as u32 + 1),
        }
    }

    pub fn face(&self, half: u32) -> u32 {
        match self.arity {
            0 => self.faces[half as usize],
            arity => half / arity,
        }
    }

    /// The next one around its face.
    pub fn next(&self, half: u32) -> u32 {
        if self.arity == 4 {
            return half & !3 | (half + 1) & 3;
        }
        let own = self.of_face(self.face(half) as usize);
        if half + 1 == own.end { own.start } else { half + 1 }
    }

    /// The one before it around its face.
    pub fn previous(&self, half: u32) -> u32 {
        if self.arity == 4 {
            return half & !3 | (half + 3) & 3;
        }
        let own = self.of_face(self.face(half) as usize);
        if half == own.start { own.end - 1 } else { half - 1 }
    }

    /// Where it begins.
    pub fn origin(&self, half: u32) -> u32 {
        self.vertices[half as usize]
    }

    /// Where it ends.
    pub fn end(&self, half: u32) -> u32 {
        self.vertices[self.next(half) as usize]
    }

    pub fn twin(&self, half: u32) -> Option<u32> {
        Some(self.twins[half as usize]).filter(|&twin| twin != NONE)
    }

    pub fn edge(&self, half: u32) -> u32 {
        self.edges[half as usize]
    }

    /// Its edge is numbered by it, and runs as it does.
    pub fn is_first(&self, half: u32) -> bool {
        half < self.twins[half as usize]
    }

    /// For each edge its first half-edge.
    pub fn firsts(&self) -> Vec<u32> {
        let mut firsts = Vec::with_capacity(self.edge_count);
        firsts.extend((0..self.len() as u32).filter(|&half| self.is_first(half)));
        firsts
    }

    /// The half-edges that leave a vertex, counter-clockwise.
    pub fn around(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let start = self.outgoing[vertex as usize];
        let mut next = start;
        std::iter::from_fn(move || {
            let half = next;
            if half == NONE {
                return None;
            }
            next = self.twins[self.previous(half) as usize];
            if next == start {
                next = NONE;
            }
            Some(half)
        })
    }

    /// The edges at a vertex, counter-clockwise: for each the half-edge along it, and whether that one leaves the vertex. On
    /// a border the last is the one that only arrives.
    pub fn edges_around(&self, vertex: u32) -> impl Iterator<Item = (u32, bool)> {
        let mut last = None;
        let mut around = self.around(vertex);
        std::iter::from_fn(move || match around.next() {
            Some(half) => {
                last = Some(half);
                Some((half, true))
            }
            None => {
                let arriving = self.previous(last.take()?);
                self.twin(arriving).is_none().then_some((arriving, false))
            }
        })
    }

    fn matched(&self, count: usize) -> Result<Vec<u32>, MeshError> {
        let buckets = Buckets::new(self, count);
        let twin = |half: u32| {
            let (from, to) = (self.origin(half), self.end(half));
            let (same, other) = (buckets.find(from, to), buckets.find(to, from));
            if same.1 == 1 && other.1 <= 1 {
                return Ok(other.0);
            }
            let faces = same.1 + other.1;
            if faces > 2 {
                return Err(MeshError::ManyFaces { vertices: [from, to], faces });
            }
            let both = (0..self.len() as u32).filter(|&h| self.origin(h) == from && self.end(h) == to);
            let mut both = both.map(|h| self.face(h) as usize);
            let faces = [both.next().unwrap_or(0), both.next().unwrap_or(0)];
            Err(MeshError::SameWay { faces, from, to })
        };
        let halves = (0..self.len() as u32).into_par_iter().with_min_len(4096);
        let twins: Result<Vec<u32>, MeshError> = halves.map(twin).collect();
        // Of several wrong edges always the same one is named.
        twins.map_err(|any| (0..self.len() as u32).find_map(|half| twin(half).err()).unwrap_or(any))
    }

    fn number(&mut self, count: usize) {
        self.edges = vec![0; self.len()];
        self.outgoing = vec![NONE; count];
        for half in 0..self.len() {
            let twin = self.twins[half];
            self.edges[half] = match (twin as usize) < half {
                true => self.edges[twin as usize],
                false => {
                    self.edge_count += 1;
                    self.edge_count as u32 - 1
                }
            };
            let out = &mut self.outgoing[self.vertices[half] as usize];
            if *out == NONE || twin == NONE && self.twins[*out as usize] != NONE {
                *out = half as u32;
            }
        }
    }

    fn check_fans(&self, count: usize) -> Result<(), MeshError> {
        let mut faces = vec![0u32; count];
        self.vertices.iter().for_each(|&v| faces[v as usize] += 1);
        let whole = |&vertex: &u32| self.around(vertex).count() == faces[vertex as usize] as usize;
        match (0..count as u32).find(|vertex| !whole(vertex)) {
            Some(vertex) => Err(MeshError::Fans { vertex }),
            None => Ok(()),
        }
    }
}

fn check_faces(mesh: &Mesh) -> Result<(), MeshError> {
    let vertices = mesh.positions.len();
    for (vertex, position) in mesh.positions.iter().enumerate() {
        if let Some(k) = position.iter().position(|x| !x.is_finite()) {
            let axis = ['x', 'y', 'z'][k];
            return Err(MeshError::NotFinite { vertex, axis, value: position[k] });
        }
    }
    let mut sorted = Vec::new();
    for (face, corners) in mesh.faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
            return Err(MeshError::Index { face, vertex, vertices });
        }
        if corners.len() < 3 {
            return Err(MeshError::Corners { face, corners: corners.len() });
        }
        // A face may have thousands of corners.
        sorted.clear();
        sorted.extend_from_slice(corners);
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(MeshError::Repeated { face, vertex: pair[0] });
        }
    }
    Ok(())
}

/// The half-edges by the vertex that they leave.
struct Buckets {
    starts: Vec<u32>,
    /// Where each ends, and which it is.
    halves: Vec<(u32, u32)>,
}

impl Buckets {
    /// Longer ones are sorted, so that a vertex of any valence costs no more than its faces.
    const SHORT: usize = 16;

    fn new(mesh: &HalfEdges, count: usize) -> Buckets {
        let mut starts = vec![0u32; count + 1];
        mesh.vertices.iter().for_each(|&v| starts[v as usize + 1] += 1);
        (0..count).for_each(|v| starts[v + 1] += starts[v]);
        let mut at = starts.clone();
        let mut halves = vec![(0u32, 0u32); mesh.len()];
        for half in 0..mesh.len() as u32 {
            let at = &mut at[mesh.origin(half) as usize];
            halves[*at as usize] = (mesh.end(half), half);
            *at += 1;
        }
        for bounds in starts.windows(2) {
            let own = &mut halves[bounds[0] as usize..bounds[1] as usize];
            if own.len() > Buckets::SHORT {
                own.sort_unstable();
            }
        }
        Buckets { starts, halves }
    }

    /// A half-edge that runs so, or [`NONE`], and how many there are.
    fn find(&self, from: u32, to: u32) -> (u32, usize) {
        let from = from as usize;
        let own = &self.halves[self.starts[from] as usize..self.starts[from + 1] as usize];
        let own = match own.len() > Buckets::SHORT {
            true => {
                &own[own.partition_point(|&(end, _)| end < to)..own.partition_point(|&(end, _)| end <= to)]
            }
            false => own,
        };
        let mut found = (NONE, 0);
        for &(end, half) in own {
            if end == to {
                found = (half, found.1 + 1);
            }
        }
        found
    }
}
