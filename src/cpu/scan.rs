//! Exclusive prefix sum: reduce tiles, scan the sums, scan the tiles. Sums wrap at 2^32.

use super::tiles::{TILE, befores};
use rayon::prelude::*;

/// Fills `offsets`, which is one longer than `counts`: the last entry is the total.
pub fn scan(counts: &[u32], offsets: &mut [u32]) {
    let sum = |tile: &[u32]| tile.iter().fold(0u32, |s, &c| s.wrapping_add(c));
    let (sums, total) = befores((counts, 1), 0, sum, |a, b| a.wrapping_add(*b));
    let (last, body) = offsets.split_last_mut().expect("offsets are one longer than counts");
    *last = total;
    body.par_chunks_mut(TILE).zip(counts.par_chunks(TILE)).zip(&sums).for_each(|((out, tile), &base)| {
        let mut running = base;
        for (o, &c) in out.iter_mut().zip(tile) {
            *o = running;
            running = running.wrapping_add(c);
        }
    });
}
