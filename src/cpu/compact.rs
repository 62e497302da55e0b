//! The indices of the elements that equal `wanted`, in ascending order.

use super::tiles::{TILE, befores};
use rayon::prelude::*;

/// Replaces `indices`.
pub fn compact(source: &[u32], wanted: u32, indices: &mut Vec<u32>) {
    let found = |tile: &[u32]| tile.iter().filter(|&&s| s == wanted).count();
    let (starts, total) = befores((source, 1), 0, found, |a, b| a + b);
    indices.clear();
    indices.resize(total, 0);
    let mut rest = indices.as_mut_slice();
    let mut tiles = Vec::with_capacity(starts.len());
    for (start, end) in starts.iter().zip(starts.iter().skip(1).chain([&total])) {
        let (out, tail) = rest.split_at_mut(end - start);
        rest = tail;
        tiles.push(out);
    }
    tiles.into_par_iter().zip(source.par_chunks(TILE)).enumerate().for_each(|(n, (out, tile))| {
        let hits = tile.iter().enumerate().filter(|(_, s)| **s == wanted);
        out.iter_mut().zip(hits).for_each(|(o, (i, _))| *o = (n * TILE + i) as u32);
    });
}
