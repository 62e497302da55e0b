//! What there is to write, and the arguments of the draw.

use super::Trees;
use crate::tessellate::passes::{DrawArgs, Status};

/// Fills both from the totals of the scans. Vectors grow, so all fits here.
pub fn finish(trees: &Trees, coarser: u32, status: &mut Status, draw: &mut DrawArgs) {
    let nodes = trees.nodes.len() as u32;
    let vertices = *trees.offsets.last().unwrap_or(&0);
    let indices = 3 * *trees.triangle_offsets.last().unwrap_or(&0);
    *status = Status {
        nodes,
        node_capacity: nodes,
        vertices,
        vertex_capacity: vertices,
        indices,
        index_capacity: indices,
        skipped: 0,
        frame: status.frame.wrapping_add(1),
        coarser,
        ..Status::default()
    };
    *draw = DrawArgs { index_count: indices, instance_count: 1, ..DrawArgs::default() };
}
