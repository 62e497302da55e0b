//! The points of a curve from its control points, each by its row of a table.

use super::BLOCK;
use crate::affine::Stencils;
use rayon::prelude::*;

/// Applies the table to control points, as many as it has columns; `curve` is as long as the table.
pub fn stencil(table: &Stencils, control: &[[f32; 4]], curve: &mut [[f32; 4]]) {
    let (rows, weights, columns) = (table.rows(), table.weights(), table.columns());
    curve.par_chunks_mut(BLOCK).zip(rows.par_chunks(BLOCK)).for_each(|(curve, rows)| {
        for (point, [first, packed]) in curve.iter_mut().zip(rows) {
            let (begin, width) = ((packed & 0xff_ffff) as usize, (packed >> 24) as usize + 1);
            let mut at = *first as usize;
            let mut sum = [0.0; 4];
            for weight in &weights[begin..begin + width] {
                for (sum, x) in sum.iter_mut().zip(control[at]) {
                    *sum += weight * x;
                }
                at += 1;
                if at == columns {
                    at = 0;
                }
            }
            *point = sum;
        }
    });
}
