//! Creases: which rule a vertex follows, and how sharpness falls from level to level. One place for all schemes.
//!
//! DeRose, Kass and Truong, *Subdivision Surfaces in Character Animation* (1998), as OpenSubdiv has them: an edge or a
//! vertex of sharpness `s` follows the sharp rule for `s` levels and then the smooth one; in the level that uses up a
//! fraction it follows both, blended.

use super::{Boundary, Creasing, HalfEdges, Mesh, MeshError, NONE, Options};
use std::collections::HashMap;

/// A sharpness from which on an edge or a vertex never becomes smooth.
pub const INFINITE: f32 = 10.0;

/// The rule of a vertex at a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
    /// No edge is sharp, or one alone: the end of a crease, a dart.
    #[default]
    Smooth,
    /// Two edges are sharp: the vertex lies on the curve that they make.
    Crease,
    /// The vertex is sharp, or three edges or more are: it stays where it is.
    Corner,
}

impl Rule {
    /// That of a vertex of this sharpness with edges of these.
    pub fn of(vertex: f32, mut edges: impl Iterator<Item = f32>) -> Rule {
        if vertex > 0.0 {
            return Rule::Corner;
        }
        match edges.by_ref().filter(|&s| s > 0.0).take(3).count() {
            0 | 1 => Rule::Smooth,
            2 => Rule::Crease,
            _ => Rule::Corner,
        }
    }
}

/// What is left of a sharpness after a level.
pub fn falls(sharpness: f32) -> f32 {
    if sharpness >= INFINITE { sharpness } else { (sharpness - 1.0).max(0.0) }
}

/// The sharpness of the halves of the edges at a vertex, each on that vertex's side.
pub fn halves(edges: &[f32], creasing: Creasing, out: &mut Vec<f32>) {
    let semi = |s: f32| s > 0.0 && s < INFINITE;
    let count = edges.iter().filter(|&&s| semi(s)).count();
    let sum: f32 = edges.iter().filter(|&&s| semi(s)).sum();
    out.clear();
    out.extend(edges.iter().map(|&s| match semi(s) && creasing == Creasing::Chaikin && count > 1 {
        true => (0.75 * s + 0.25 * ((sum - s) / (count - 1) as f32) - 1.0).max(0.0),
        false => falls(s),
    }));
}

/// How much the rule of the level before counts where that of the level differs: the mean of the sharpness that is used up.
pub fn blend(vertex: f32, before: &[f32], after: &[f32]) -> f32 {
    let (mut sum, mut count) = (0.0, 0u32);
    if vertex > 0.0 && falls(vertex) <= 0.0 {
        (sum, count) = (vertex, 1);
    }
    for (&before, &after) in before.iter().zip(after) {
        if before > 0.0 && after <= 0.0 {
            (sum, count) = (sum + before, count + 1);
        }
    }
    if count == 0 { 1.0 } else { (sum / count as f32).min(1.0) }
}

/// How much its middle counts in the point of an edge, from its sharpness and that of its halves. Where one half alone stays
/// sharp, as Chaikin's rule may have it, this may be more than 1: so it is in OpenSubdiv.
pub fn edge_weight(sharpness: f32, halves: [f32; 2]) -> f32 {
    match sharpness {
        s if s <= 0.0 => 0.0,
        _ if halves[0] > 0.0 && halves[1] > 0.0 => 1.0,
        s => s,
    }
}

/// The sharpness of the edges and the vertices of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sharpness {
    pub edges: Vec<f32>,
    pub vertices: Vec<f32>,
}

impl Sharpness {
    /// What the tags of a mesh and its borders say.
    ///
    /// # Errors
    /// A sharpness that is negative or no number; a tag on an edge or a vertex that is not there.
    pub fn new(mesh: &Mesh, halves: &HalfEdges, options: &Options) -> Result<Sharpness, MeshError> {
        let vertices = mesh.positions.len();
        let mut sharp = Sharpness { edges: vec![0.0; halves.edge_count], vertices: vec![0.0; vertices] };
        let wrong = |what: String, s: f32| Err(MeshError::Sharpness(what, s));
        let edges = if mesh.creases.is_empty() { HashMap::new() } else { edges_by_ends(halves) };
        for crease in &mesh.creases {
            let ([a, b], s) = (crease.vertices, crease.sharpness);
            if s.is_nan() || s < 0.0 {
                return wrong(format!("the sharpness of the crease between vertices {a} and {b}"), s);
            }
            let edge = edges.get(&[a.min(b), a.max(b)]).ok_or(MeshError::NoEdge([a, b]))?;
            let own = &mut sharp.edges[*edge as usize];
            *own = own.max(s);
        }
        for corner in &mesh.corners {
            let s = corner.sharpness;
            if s.is_nan() || s < 0.0 {
                return wrong(format!("the sharpness of vertex {}", corner.vertex), s);
            }
            let own = sharp.vertices.get_mut(corner.vertex as usize);
            let own = own.ok_or(MeshError::NoVertex(corner.vertex, vertices))?;
            *own = own.max(s);
        }
        for (half, &twin) in halves.twins.iter().enumerate() {
            if twin != NONE {
                continue;
            }
            sharp.edges[halves.edges[half] as usize] = INFINITE;
            let (origin, before) = (halves.vertices[half], halves.previous(half as u32));
            if options.boundary == Boundary::Corner && halves.twin(before).is_none() {
                sharp.vertices[origin as usize] = INFINITE;
            }
        }
        Ok(sharp)
    }

    /// Whether a vertex is smooth, with all its edges.
    pub fn is_smooth_at(&self, halves: &HalfEdges, vertex: u32) -> bool {
        self.vertices[vertex as usize] <= 0.0
            && halves.edges_around(vertex).all(|(half, _)| self.edges[halves.edge(half) as usize] <= 0.0)
    }
}

fn edges_by_ends(halves: &HalfEdges) -> HashMap<[u32; 2], u32> {
    let ends = |half: u32| {
        let (a, b) = (halves.origin(half), halves.end(half));
        ([a.min(b), a.max(b)], halves.edge(half))
    };
    halves.firsts().into_iter().map(ends).collect()
}
