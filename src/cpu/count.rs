//! How many modules come of each: a look into the rule table.

use super::BLOCK;
use rayon::prelude::*;

/// Fills `counts` from the rule table's words.
pub fn count(words: &[u32], rules: &[u32], counts: &mut [u32]) {
    counts.par_chunks_mut(BLOCK).zip(rules.par_chunks(BLOCK)).for_each(|(counts, rules)| {
        counts.iter_mut().zip(rules).for_each(|(c, &r)| *c = words[r as usize] >> 8 & 255);
    });
}
