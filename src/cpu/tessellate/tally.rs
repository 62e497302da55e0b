//! How many vertices and triangles each leaf makes, and which vertices it owns.

use super::BLOCK;
use crate::tessellate::passes::{FAN, OWNS, Triangle, on_border};
use crate::tessellate::tree::Tree;
use rayon::prelude::*;
use std::sync::atomic::AtomicU32;

/// Completes the marks, and counts.
pub fn tally(
    tree: &Tree,
    marks: Vec<AtomicU32>,
    vertex_counts: &mut Vec<u32>,
    triangle_counts: &mut Vec<u32>,
) -> Vec<u32> {
    let mut marks: Vec<u32> = marks.into_iter().map(AtomicU32::into_inner).collect();
    vertex_counts.resize(marks.len(), 0);
    triangle_counts.resize(marks.len(), 0);
    let counts = vertex_counts.par_chunks_mut(BLOCK).zip(triangle_counts.par_chunks_mut(BLOCK));
    marks.par_chunks_mut(BLOCK).zip(counts).enumerate().for_each(
        |(block, (marks, (vertices, triangles)))| {
            let counts = vertices.iter_mut().zip(triangles);
            for (k, (mark, (vertices, triangles))) in marks.iter_mut().zip(counts).enumerate() {
                let node = (block * BLOCK + k) as u32;
                (*vertices, *triangles) = (0, 0);
                if !tree.is_leaf(node) {
                    continue;
                }
                *mark |= tree.owned(node, *mark);
                tree.triangles(node, *mark, |triangle| {
                    *triangles += 1;
                    *vertices += extra(tree, node, triangle).map(u32::from).iter().sum::<u32>();
                });
                *vertices += (*mark >> OWNS & 15).count_ones() + u32::from(*mark & FAN != 0);
            }
        },
    );
    marks
}

/// Which of its first two vertices a triangle brings of its own: where patches do not share them, the ends
/// of a side that is pushed to another patch, but for those at the corners of the leaf there.
pub fn extra(tree: &Tree, node: u32, triangle: Triangle) -> [bool; 2] {
    match triangle {
        Triangle::Pushed { side, to } if !tree.shared && on_border(&tree.nodes[node as usize], side) => {
            let ends = tree.foreign(&tree.nodes[node as usize], side, to);
            let of = &tree.nodes[to.node as usize];
            ends.map(|p| !(0..4).any(|c| of.corner(c) == p))
        }
        _ => [false; 2],
    }
}
