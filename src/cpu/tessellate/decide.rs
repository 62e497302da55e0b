//! Which cells of a level are split.
//!
//! A cell's control points are made from its root's, which no buffer then has to hold: 16·R·C bytes read, mostly from
//! caches, and about 1,360 flops for a cell of a bicubic net, at any depth: see `wgsl/tessellate/decide.wgsl`.

use super::{BLOCK, Trees};
use crate::tessellate::lattice::{NOWHERE, Node};
use crate::tessellate::level::Target;
use crate::tessellate::surface::{self, Control, Patches};
use crate::tessellate::topology::{least_depth, orientation_of};
use crate::tessellate::tree::LEAF;
use rayon::prelude::*;

/// Counts 1 for every cell of the level that is split.
pub fn decide(
    patches: &Patches,
    topology: &[u32],
    target: &Target,
    coarser: u32,
    children_before: &[u32],
    trees: &mut Trees,
) {
    let (nodes, before) = (&trees.nodes[trees.level..], &trees.before[trees.level..]);
    let splits = |[root, cell]: &mut [Control; 2], node: &Node, before: u32| {
        if let Some(splits) = target.by_address(node, least_depth(topology, node.root)) {
            return splits;
        }
        patches.load(root, node.root, orientation_of(topology, node.root));
        surface::restrict(root, node, cell);
        let was_split = before != NOWHERE && children_before[before as usize] != LEAF;
        target.splits(cell, patches.rational, was_split, coarser)
    };
    trees.counts.resize(nodes.len(), 0);
    let blocks = nodes.par_chunks(BLOCK).zip(before.par_chunks(BLOCK));
    let nets = || [Control::default(), Control::default()];
    trees.counts.par_chunks_mut(BLOCK).zip(blocks).for_each_init(nets, |nets, (counts, (nodes, before))| {
        for ((count, node), &before) in counts.iter_mut().zip(nodes).zip(before) {
            *count = u32::from(splits(nets, node, before));
        }
    });
}
