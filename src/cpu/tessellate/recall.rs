//! Which nodes of the frame before had the cells of a word's leaves.

use crate::tessellate::lattice::{NOWHERE, Node};
use crate::tessellate::word::Table;

/// For each leaf its node among those that the frame before began with, whose table this is; roots have none.
pub fn recall(table: Option<&Table>, nodes: &[Node], leaves: &[Node]) -> Vec<u32> {
    let known = |leaf: &Node| match table {
        Some(table) => table.leaf(nodes, leaf.root, leaf.shape & 0xffff, [leaf.i, leaf.j]),
        None => (leaf.depth() == [0, 0] && (leaf.root as usize) < nodes.len()).then_some(leaf.root),
    };
    leaves.iter().map(|leaf| known(leaf).unwrap_or(NOWHERE)).collect()
}
