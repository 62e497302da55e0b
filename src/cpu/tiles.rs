//! Scans by tiles, as `wgsl/shared/compositions.wgsl` has them: what each tile is, in parallel; then what stands before each.

use rayon::prelude::*;
use std::mem::replace;

/// Elements of one tile.
pub const TILE: usize = 1 << 14;

/// What stands before each tile of a column of so many words an element, and after the last: `of` says what a tile is,
/// `then` how two become one, the first one first, and `entered` what stands before them all.
pub fn befores<T: Send>(
    (column, words): (&[u32], usize),
    entered: T,
    of: impl Fn(&[u32]) -> T + Sync + Send,
    then: impl Fn(&T, &T) -> T,
) -> (Vec<T>, T) {
    let mut tiles: Vec<T> = column.par_chunks(TILE * words).map(of).collect();
    let mut state = entered;
    for tile in &mut tiles {
        let next = then(&state, tile);
        *tile = replace(&mut state, next);
    }
    (tiles, state)
}
