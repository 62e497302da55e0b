//! The first step of faces that are no quads: every face becomes as many quads as it has corners.

use super::connect::{HalfEdges, NONE};
use super::options::{Creasing, Options};
use super::schemes::{Combination, QuadScheme, Step, Visit, edge_point, vertex_point};
use super::sharpness::{Rule, Sharpness, blend, edge_weight, falls, halves};
use rayon::prelude::*;

/// The quads that come of faces, and their points as combinations of the points there were: first those of the vertices,
/// then of the faces, then of the edges.
pub struct FirstStep {
    pub halves: HalfEdges,
    pub sharpness: Sharpness,
    pub points: Vec<Combination>,
}

/// Quad `h` lies at the corner where half-edge `h` begins: from there it goes to the middle of that edge, of the face, and
/// of the edge before.
pub fn first_step(old: &HalfEdges, sharp: &Sharpness, options: &Options) -> FirstStep {
    let halves = quads(old);
    let sharpness = sharpness_of(old, sharp, &halves, options.creasing);
    let points = options.scheme.visit(Points { old, sharp, new: &halves, new_sharp: &sharpness });
    FirstStep { halves, sharpness, points }
}

fn quads(old: &HalfEdges) -> HalfEdges {
    let (vertices, faces) = (old.outgoing.len() as u32, old.face_count() as u32);
    let count = 4 * old.len();
    let (mut origins, mut twins) = (vec![0; count], vec![0; count]);
    let rows = origins.par_chunks_exact_mut(4).zip(twins.par_chunks_exact_mut(4)).with_min_len(4096);
    rows.enumerate().for_each(|(half, (origins, twins))| {
        let half = half as u32;
        let (before, next) = (old.previous(half), old.next(half));
        let edge = |h: u32| vertices + faces + old.edge(h);
        origins.copy_from_slice(&[old.origin(half), edge(half), vertices + old.face(half), edge(before)]);
        twins.copy_from_slice(&[
            old.twin(half).map_or(NONE, |twin| 4 * old.next(twin) + 3),
            4 * next + 2,
            4 * before + 1,
            old.twin(before).map_or(NONE, |twin| 4 * twin),
        ]);
    });
    let points = vertices as usize + faces as usize + old.edge_count;
    HalfEdges::of_twins(4, origins, twins, points)
}

/// The new half-edge along an old edge from one of its ends, given an old half-edge along it and whether that one leaves
/// this end.
fn half_at((half, leaves): (u32, bool), old: &HalfEdges) -> u32 {
    if leaves { 4 * half } else { 4 * old.next(half) + 3 }
}

fn sharpness_of(old: &HalfEdges, sharp: &Sharpness, new: &HalfEdges, creasing: Creasing) -> Sharpness {
    let mut out = Sharpness { edges: vec![0.0; new.edge_count], vertices: vec![0.0; new.outgoing.len()] };
    let (mut own, mut after) = (Vec::new(), Vec::new());
    for vertex in 0..old.outgoing.len() as u32 {
        out.vertices[vertex as usize] = falls(sharp.vertices[vertex as usize]);
        own.clear();
        own.extend(old.edges_around(vertex).map(|(half, _)| sharp.edges[old.edge(half) as usize]));
        halves(&own, creasing, &mut after);
        for (at, &s) in old.edges_around(vertex).zip(&after) {
            out.edges[new.edge(half_at(at, old)) as usize] = s;
        }
    }
    out
}

struct Points<'a> {
    old: &'a HalfEdges,
    sharp: &'a Sharpness,
    new: &'a HalfEdges,
    new_sharp: &'a Sharpness,
}

impl Visit for Points<'_> {
    type Output = Vec<Combination>;

    fn quads<S: QuadScheme>(self) -> Vec<Combination> {
        let faces: Vec<Combination> =
            (0..self.old.face_count()).into_par_iter().map(|face| self.face::<S>(face)).collect();
        let firsts = self.old.firsts();
        let edges: Vec<Combination> = firsts.par_iter().map(|&half| self.edge::<S>(half, &faces)).collect();
        let vertices = (0..self.old.outgoing.len() as u32).into_par_iter();
        let mut points: Vec<Combination> = vertices.map(|vertex| self.vertex::<S>(vertex, &faces)).collect();
        points.extend(faces);
        points.extend(edges);
        points
    }
}

impl Points<'_> {
    fn face<S: QuadScheme>(&self, face: usize) -> Combination {
        let corners: Vec<u32> = self.old.of_face(face).map(|half| self.old.origin(half)).collect();
        match corners[..] {
            [a, b, c, d] => S::face([a, b, c, d].map(Combination::point)),
            _ => {
                let weight = 1.0 / corners.len() as f64;
                let mut terms: Vec<(u32, f64)> = corners.into_iter().map(|corner| (corner, weight)).collect();
                terms.sort_unstable_by_key(|term| term.0);
                Combination { terms }
            }
        }
    }

    fn edge<S: QuadScheme>(&self, half: u32, faces: &[Combination]) -> Combination {
        let old = self.old;
        let ends = || [old.origin(half), old.end(half)].map(Combination::point);
        let sharp = self.sharp.edges[old.edge(half) as usize];
        let new = [(half, true), (half, false)].map(|at| self.new.edge(half_at(at, old)) as usize);
        let weight = edge_weight(sharp, new.map(|edge| self.new_sharp.edges[edge]));
        edge_point(ends(), weight, || {
            // A border is sharp: an edge that is not has a face on either side.
            let both = [Some(half), old.twin(half)].map(|h| h.map_or(0, |h| old.face(h)) as usize);
            S::edge(ends(), both.map(|face| faces[face].clone()))
        })
    }

    fn vertex<S: QuadScheme>(&self, vertex: u32, faces: &[Combination]) -> Combination {
        let (old, own) = (self.old, Combination::point(vertex));
        let around: Vec<(u32, bool)> = old.edges_around(vertex).collect();
        if around.is_empty() {
            return own;
        }
        let before: Vec<f32> = around.iter().map(|&(h, _)| self.sharp.edges[old.edge(h) as usize]).collect();
        let after: Vec<f32> =
            around.iter().map(|&at| self.new_sharp.edges[self.new.edge(half_at(at, old)) as usize]).collect();
        let [sharp, fallen] = [&self.sharp, &self.new_sharp].map(|s| s.vertices[vertex as usize]);
        let step = step([sharp, fallen], &before, &after);
        let other = |&(h, leaves): &(u32, bool)| if leaves { old.end(h) } else { old.origin(h) };
        let edges: Vec<Combination> = around.iter().map(|at| Combination::point(other(at))).collect();
        let own_faces = around.iter().filter(|(_, leaves)| *leaves).map(|&(h, _)| old.face(h) as usize);
        let own_faces: Vec<Combination> = own_faces.map(|face| faces[face].clone()).collect();
        let weights = S::ring(own_faces.len());
        // The weights as they are, not as 32-bit floats have them.
        if step.rules == [Rule::Smooth; 2] && own_faces.len() != 4 {
            let sum = edges.into_iter().chain(own_faces).reduce(|sum, x| sum + x).unwrap_or_default();
            return own.scaled(weights[0]) + sum.scaled(weights[1]);
        }
        vertex_point::<S, _>(&own, &step, weights.map(|w| w as f32), &edges, &own_faces)
    }
}

/// How a vertex goes from a level to the next, from its sharpness at both and that of its edges.
pub fn step(vertex: [f32; 2], before: &[f32], after: &[f32]) -> Step {
    let rules = [Rule::of(vertex[1], after.iter().copied()), Rule::of(vertex[0], before.iter().copied())];
    let ends = |rule: Rule, sharp: &[f32]| {
        let mut two = (0..sharp.len() as u32).filter(|&i| sharp[i as usize] > 0.0);
        match (rule, two.next(), two.next()) {
            (Rule::Crease, Some(a), Some(b)) => [a, b],
            _ => [0, 0],
        }
    };
    Step {
        rules,
        weight: if rules[0] == rules[1] { 1.0 } else { blend(vertex[0], before, after) },
        ends: [ends(rules[0], after), ends(rules[1], before)],
    }
}
