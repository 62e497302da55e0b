//! The control points of a part of a net.

use super::{Control, MOST};
use crate::tessellate::lattice::Node;
use glam::Vec4;

/// The control points of a cell, written over `cell`: those of its root, by the weights that the cell's ends along x
/// give, then by those along y. It takes as long at any depth: see `decide.wgsl`.
#[inline]
pub fn restrict(root: &Control, node: &Node, cell: &mut Control) {
    (cell.rows, cell.columns, cell.place) = (root.rows, root.columns, root.place);
    match (root.rows, root.columns, root.rational) {
        (4, 4, false) => restricted(&root.points, 4, 4, false, node, &mut cell.points),
        (rows, columns, rational) => {
            restricted(&root.points, rows, columns, rational, node, &mut cell.points);
        }
    }
}

#[inline(always)]
fn restricted(
    root: &[Vec4; MOST * MOST],
    rows: usize,
    columns: usize,
    rational: bool,
    node: &Node,
    cell: &mut [Vec4; MOST * MOST],
) {
    let [du, dv] = node.depth();
    let mut w = [[0.0; MOST]; MOST];
    // Where all weights are 1 they are no sum.
    let weighed = |p: Vec4| if rational { p } else { p.truncate().extend(1.0) };
    shares(rows, du, node.i, &mut w);
    for k in 0..rows {
        for c in 0..columns {
            let mut sum = w[k][0] * root[c];
            for r in 1..rows {
                sum += w[k][r] * root[r * columns + c];
            }
            cell[k * columns + c] = weighed(sum);
        }
    }
    shares(columns, dv, node.j, &mut w);
    for r in 0..rows {
        let mut p = [Vec4::ZERO; MOST];
        p[..columns].copy_from_slice(&cell[r * columns..][..columns]);
        for k in 0..columns {
            let mut sum = w[k][0] * p[0];
            for c in 1..columns {
                sum += w[k][c] * p[c];
            }
            cell[r * columns + k] = weighed(sum);
        }
    }
}

/// How much each control point of a part of a curve has of those of the whole. The part is the nth after so many
/// halvings; its point k is the blossom at where it begins, and k times at where it ends.
#[inline(always)]
fn shares(points: usize, depth: u32, n: u32, shares: &mut [[f32; MOST]; MOST]) {
    // Exact, as are both ends.
    let size = f32::from_bits((127 - depth) << 23);
    let ends = [n as f32 * size, (n + 1) as f32 * size];
    for (k, share) in shares.iter_mut().enumerate().take(points) {
        let mut w = [0.0; MOST];
        w[0] = 1.0;
        for n in 1..points {
            let t = ends[usize::from(n + k >= points)];
            let s = 1.0 - t;
            for i in (1..points).rev() {
                w[i] = s * w[i] + t * w[i - 1];
            }
            w[0] *= s;
        }
        *share = w;
    }
}
