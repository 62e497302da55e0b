//! The indices of the elements that equal `wanted`, in ascending order.

use super::tiles::TILE;
use rayon::prelude::*;

/// Replaces `indices`.
pub fn compact(source: &[u32], wanted: u32, indices: &mut Vec<u32>) {
    let found = |tile: &[u32]| tile.iter().filter(|&&s| s == wanted).count();
    let counts: Vec<usize> = source.par_chunks(TILE).map(found).collect();
    indices.clear();
    indices.resize(counts.iter().sum(), 0);
    let mut rest = indices.as_mut_slice();
    let mut tiles = Vec::with_capacity(counts.len());
    for (n, &count) in counts.iter().enumerate() {
        let (out, tail) = rest.split_at_mut(count);
        rest = tail;
        tiles.push((n, out));
    }
    tiles.into_par_iter().for_each(|(n, out)| {
        let start = n * TILE;
        let tile = &source[start..source.len().min(start + TILE)];
        let hits = tile.iter().enumerate().filter(|(_, s)| **s == wanted);
        out.iter_mut().zip(hits).for_each(|(o, (i, _))| *o = (start + i) as u32);
    });
}
