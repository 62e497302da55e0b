//! Where the turtle stands at each module of a word with links: parents stand before their children, so from the first
//! to the last each state is that of the module's parent and its own motion.

use super::motion::{Motion, STILL};
use crate::plan::layout::{LATERAL, Layout};
use crate::plan::turtle::{ROW_WORDS, Turtle};

/// Fills `out`, a row a module. What hangs on nothing before it begins at the origin.
pub fn turtle_linked(turtle: &Turtle, layout: &Layout, records: &[u32], out: &mut [u32]) {
    let Some(link) = layout.link else { return };
    let mut states: Vec<Motion> = Vec::with_capacity(records.len() / layout.record_words);
    for (record, row) in records.chunks_exact(layout.record_words).zip(out.chunks_exact_mut(ROW_WORDS)) {
        let parent = (record[link] & !LATERAL) as usize;
        let before = states.get(parent).copied().unwrap_or(STILL);
        let state = before.then_module(turtle, record);
        if turtle.before { before } else { state }.write(row);
        states.push(state);
    }
}
