//! The four quarters of every cell that is split, behind the nodes that are there.

use super::{BLOCK, Trees};
use crate::tessellate::lattice::{NOWHERE, Node};
use crate::tessellate::tree::LEAF;
use rayon::prelude::*;

/// Writes the children of the level and where they stand.
pub fn split(children_before: &[u32], trees: &mut Trees) {
    let (start, end) = (trees.level, trees.nodes.len());
    let total = *trees.offsets.last().unwrap_or(&0) as usize;
    trees.children.resize(end, LEAF);
    trees.nodes.resize(end + 4 * total, Node::default());
    trees.before.resize(end + 4 * total, NOWHERE);
    let (old_nodes, mut new_nodes) = trees.nodes.split_at_mut(end);
    let (old_before, mut new_before) = trees.before.split_at_mut(end);
    let (old_nodes, old_before) = (&old_nodes[start..], &old_before[start..]);
    let (counts, offsets) = (&trees.counts, &trees.offsets);
    let mut blocks = Vec::with_capacity(counts.len().div_ceil(BLOCK));
    for (block, children) in trees.children[start..].chunks_mut(BLOCK).enumerate() {
        let first = block * BLOCK;
        let count = 4 * (offsets[first + children.len()] - offsets[first]) as usize;
        let (nodes, rest) = new_nodes.split_at_mut(count);
        let (before, rest_before) = new_before.split_at_mut(count);
        (new_nodes, new_before) = (rest, rest_before);
        blocks.push((first, children, nodes, before));
    }
    blocks.into_par_iter().for_each(|(first, children, nodes, before)| {
        let mut at = 0;
        for (k, child) in children.iter_mut().enumerate() {
            let n = first + k;
            if counts[n] == 0 {
                *child = LEAF;
                continue;
            }
            *child = (end + 4 * offsets[n] as usize) as u32;
            let known = match old_before[n] {
                NOWHERE => LEAF,
                old => children_before[old as usize],
            };
            for c in 0..4 {
                nodes[at] = old_nodes[n].quarter(c);
                before[at] = if known == LEAF { NOWHERE } else { known + c };
                at += 1;
            }
        }
    });
}
