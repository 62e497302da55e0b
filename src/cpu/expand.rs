//! Reads one element and writes four: the traffic of a 2×2 split without its arithmetic.

use rayon::prelude::*;

/// `out` is four times as long as `source`; element i goes to 4i … 4i + 3.
pub fn expand(source: &[[f32; 4]], out: &mut [[f32; 4]]) {
    out.par_chunks_mut(4 << 14).zip(source.par_chunks(1 << 14)).for_each(|(out, source)| {
        out.chunks_exact_mut(4).zip(source).for_each(|(four, s)| four.fill(*s));
    });
}
