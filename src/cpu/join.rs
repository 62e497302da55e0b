//! What stands beside the chunks of a word, copied to them: see [`crate::plan::edges`].

use super::Chunk;
use crate::plan::columns::Stored;
use crate::plan::edges;
use crate::plan::layout::{END, Layout};

/// Gives chunks that follow each other the records beside them, and their places in the word.
pub fn join(layout: &Layout, mut chunks: Vec<Chunk>, ring: bool) -> Vec<Chunk> {
    let (words, halo) = (layout.record_words, layout.halo());
    let lengths: Vec<usize> = chunks.iter().map(|chunk| chunk.len).collect();
    for (n, edges) in edges::edges(&lengths, ring).into_iter().enumerate() {
        for (k, edge) in edges.into_iter().enumerate().filter(|_| halo > 0) {
            let mut record = vec![0; words];
            match edge {
                Some((chunk, module)) => {
                    let records = chunks[chunk].own(layout, Stored::Records);
                    record.copy_from_slice(&records[module * words..][..words]);
                }
                None => record[0] = END,
            }
            let at = if k < halo { k } else { lengths[n] + k };
            chunks[n].columns[Stored::Records as usize][at * words..][..words].copy_from_slice(&record);
        }
        chunks[n].before = lengths[..n].iter().sum();
        chunks[n].behind = lengths[n..].iter().sum();
    }
    chunks
}
