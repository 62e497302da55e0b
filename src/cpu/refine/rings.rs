//! The rings of special vertices, level by level.

use crate::mesh::schemes::{QuadScheme, Step, edge_point, vertex_point};
use crate::mesh::{Creases, NONE, Ring, Topology};
use glam::Vec4;
use rayon::prelude::*;

/// Rings that are done in one piece.
const BLOCK: usize = 256;

/// All levels of all rings: of each ring its levels one after the other.
pub fn refine<S: QuadScheme>(topology: &Topology, creases: &Creases, points: &[Vec4], out: &mut [Vec4]) {
    let levels = creases.levels();
    let rings = &topology.rings;
    let mut rest = out;
    let mut blocks = Vec::with_capacity(rings.rings.len().div_ceil(BLOCK));
    for own in rings.rings.chunks(BLOCK) {
        let size: usize = own.iter().map(|ring| ring.len() * (levels + 1)).sum();
        let (here, after) = rest.split_at_mut(size);
        blocks.push((own, here));
        rest = after;
    }
    blocks.into_par_iter().for_each(|(own, mut out)| {
        let mut faces = Vec::new();
        for ring in own {
            let size = ring.len();
            let (here, after) = out.split_at_mut(size * (levels + 1));
            out = after;
            for (own, &point) in here.iter_mut().zip(&rings.points[ring.first as usize..]).take(size) {
                *own = points[point as usize];
            }
            for level in 0..levels {
                let (old, new) = here[level * size..][..2 * size].split_at_mut(size);
                next::<S>(ring, creases, level, old, new, &mut faces);
            }
        }
    });
}

fn next<S: QuadScheme>(
    ring: &Ring,
    creases: &Creases,
    level: usize,
    old: &[Vec4],
    new: &mut [Vec4],
    faces: &mut Vec<Vec4>,
) {
    let (edges, count) = (ring.edges as usize, ring.faces as usize);
    let (vertex, ends, corners) = (old[0], &old[1..=edges], &old[1 + edges..]);
    faces.clear();
    let after = |i: usize| if i + 1 == edges { 0 } else { i + 1 };
    faces.extend((0..count).map(|i| S::face([vertex, ends[i], corners[i], ends[after(i)]])));
    let smooth = Step::default();
    let (step, weights): (&Step, &[f32]) = match ring.sharp {
        NONE => (&smooth, &[]),
        _ => creases.ring(ring, level),
    };
    for i in 0..edges {
        let weight = weights.get(i).copied().unwrap_or(0.0);
        new[1 + i] = edge_point([vertex, ends[i]], weight, || {
            S::edge(
                [vertex, ends[i]],
                [faces[if i == 0 { count - 1 } else { i - 1 }], faces[if i < count { i } else { 0 }]],
            )
        });
    }
    new[0] = vertex_point::<S, Vec4>(&vertex, step, ring.weights, ends, faces);
    new[1 + edges..].copy_from_slice(faces);
}
