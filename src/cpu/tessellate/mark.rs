//! Which sides of leaves have something finer across: said by the finer one, whatever the order.

use super::BLOCK;
use crate::tessellate::tree::Tree;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Marks of all nodes, in the room of `old`.
pub fn mark(tree: &Tree, old: Vec<u32>) -> Vec<AtomicU32> {
    let mut marks: Vec<AtomicU32> = old.into_iter().map(AtomicU32::new).collect();
    marks.iter_mut().for_each(|m| *m.get_mut() = 0);
    marks.resize_with(tree.nodes.len(), AtomicU32::default);
    (0..tree.nodes.len() as u32).into_par_iter().with_min_len(BLOCK).for_each(|node| {
        if tree.is_leaf(node) {
            tree.larger(node, |larger, side| {
                marks[larger as usize].fetch_or(1 << side, Ordering::Relaxed);
            });
        }
    });
    marks
}
