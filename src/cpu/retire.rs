//! Retired modules, copied once to where they stay.

use super::BLOCK;
use super::program::Input;
use rayon::prelude::*;

/// Copies the modules with these indices, in this order.
pub fn retire(input: &Input, nets: &[[f32; 4]], retired: &[u32], records: &mut [u32], out: &mut [[f32; 4]]) {
    let (words, points) = (input.layout.record_words, input.layout.net_points());
    let records = records[..retired.len() * words].par_chunks_mut(BLOCK * words);
    let out = out[..retired.len() * points].par_chunks_mut(BLOCK * points);
    retired.par_chunks(BLOCK).zip(records).zip(out).for_each(|((indices, records), out)| {
        let places = records.chunks_exact_mut(words).zip(out.chunks_exact_mut(points));
        for (&i, (record, net)) in indices.iter().zip(places) {
            record.copy_from_slice(input.record(i as usize));
            net.copy_from_slice(&nets[i as usize * points..][..points]);
        }
    });
}
