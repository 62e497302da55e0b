//! Scans by tiles, as `wgsl/shared/compositions.wgsl` has them: what each tile is, in parallel; then what stands before each.

/// Elements of one tile.
pub const TILE: usize = 1 << 14;

/// Makes each tile what stands before it, beginning with `entered`. Returned is what stands after the last.
pub fn befores<T: Clone>(tiles: &mut [T], entered: T, then: impl Fn(&T, &T) -> T) -> T {
    tiles.iter_mut().fold(entered, |state, tile| {
        let next = then(&state, tile);
        *tile = state;
        next
    })
}
