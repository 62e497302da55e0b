//! The triangles: two of each leaf without finer neighbours, fans of the others, and what leaves add to the
//! fans of larger ones.
//!
//! A triangle writes 12 bytes of indices and 4 of its cell, and reads nodes along a few paths.

use super::tally::extra;
use super::{BLOCK, Trees};
use crate::tessellate::passes::{Corner, FAN, OWNS};
use crate::tessellate::tree::Tree;
use rayon::prelude::*;

/// Writes indices and cells.
pub fn triangles(tree: &Tree, trees: &Trees, indices: &mut [u32], cells: &mut [u32]) {
    let (mut rest, mut rest_cells) = (indices, cells);
    let mut blocks = Vec::new();
    for start in (0..tree.nodes.len()).step_by(BLOCK) {
        let end = tree.nodes.len().min(start + BLOCK);
        let count = (trees.triangle_offsets[end] - trees.triangle_offsets[start]) as usize;
        let (indices, behind) = rest.split_at_mut(3 * count);
        let (cells, cells_behind) = rest_cells.split_at_mut(count);
        (rest, rest_cells) = (behind, cells_behind);
        blocks.push((start..end, indices, cells));
    }
    blocks.into_par_iter().for_each(|(nodes, indices, cells)| {
        let mut out = indices.chunks_exact_mut(3).zip(cells);
        for node in nodes.map(|n| n as u32).filter(|&n| tree.is_leaf(n)) {
            let marks = trees.marks[node as usize];
            let mut own = trees.offsets[node as usize]
                + (marks >> OWNS & 15).count_ones()
                + u32::from(marks & FAN != 0);
            tree.triangles(node, marks, |triangle| {
                let (corners, cell) = tree.corners(node, triangle);
                let extra = extra(tree, node, triangle);
                let mut index: [u32; 3] = std::array::from_fn(|k| match extra.get(k) {
                    Some(true) => {
                        own += 1;
                        own - 1
                    }
                    _ => index(tree, trees, corners[k]),
                });
                if tree.orientation(tree.nodes[cell as usize].root).mirrors() {
                    index.swap(1, 2);
                }
                if let Some((out, out_cell)) = out.next() {
                    out.copy_from_slice(&index);
                    *out_cell = cell;
                }
            });
        }
    });
}

/// The number of a vertex; 0 for one that no leaf owns.
fn index(tree: &Tree, trees: &Trees, corner: Corner) -> u32 {
    let of = |node: u32, below: u32| {
        let owned = trees.marks[node as usize] >> OWNS & 15;
        trees.offsets[node as usize] + (owned & ((1 << below) - 1)).count_ones()
    };
    match corner {
        Corner::Centre { node } => of(node, 4),
        Corner::At { root, p } => tree.owner(root, p).map_or(0, |(node, corner)| of(node, corner)),
    }
}
