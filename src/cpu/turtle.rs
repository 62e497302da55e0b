//! Where the turtle stands at each module: a scan of rigid motions, by tiles as `scan` sums.

use super::motion::{Motion, STILL};
use super::tiles::{TILE, befores};
use crate::plan::layout::Layout;
use crate::plan::turtle::{ROW_WORDS, Turtle};
use rayon::prelude::*;

/// Fills `out`, a row a module; `entered` is the state before the first. Returned is that behind the last.
pub fn turtle(turtle: &Turtle, layout: &Layout, records: &[u32], entered: Motion, out: &mut [u32]) -> Motion {
    let words = layout.record_words;
    let of_tile = |tile: &[u32]| {
        tile.chunks_exact(words).fold(STILL, |motion, record| motion.then_module(turtle, record))
    };
    let (motions, last) = befores((records, words), entered, of_tile, Motion::then);
    let tiles = out.par_chunks_mut(TILE * ROW_WORDS).zip(records.par_chunks(TILE * words));
    tiles.zip(&motions).for_each(|((rows, tile), &before)| {
        let mut state = before;
        for (row, record) in rows.chunks_exact_mut(ROW_WORDS).zip(tile.chunks_exact(words)) {
            let next = state.then_module(turtle, record);
            if turtle.before { state } else { next }.write(row);
            state = next;
        }
    });
    last
}
