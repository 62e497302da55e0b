//! What stands beside the chunks of a curve's word, so that contexts read across their ends.

use super::layout::HALO;

/// A record beside a chunk: which module of which chunk it is a copy of; none beyond the end of an open word.
pub type Edge = Option<(usize, usize)>;

/// For each chunk, by their lengths and in their order, the [`HALO`] records on its left, then those on its right. A
/// ring goes round as often as it takes (reading E14: contexts of short rings wrap).
pub fn edges(lengths: &[usize], ring: bool) -> Vec<[Edge; 2 * HALO]> {
    let whole: usize = lengths.iter().sum();
    let starts: Vec<usize> = lengths
        .iter()
        .scan(0, |at, n| {
            *at += n;
            Some(*at - n)
        })
        .collect();
    let module = |place: isize| -> Edge {
        let place = match ring {
            true if whole > 0 => place.rem_euclid(whole as isize) as usize,
            _ => usize::try_from(place).ok().filter(|&place| place < whole)?,
        };
        // Empty chunks begin where the next one does.
        let chunk = starts.partition_point(|&start| start <= place) - 1;
        Some((chunk, place - starts[chunk]))
    };
    let of_chunk = |chunk: usize| {
        let (start, end) = (starts[chunk] as isize, (starts[chunk] + lengths[chunk]) as isize);
        std::array::from_fn(|k| match k < HALO {
            true => module(start - HALO as isize + k as isize),
            false => module(end + (k - HALO) as isize),
        })
    };
    (0..lengths.len()).map(of_chunk).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_reach_over_short_chunks_and_end_where_the_word_does() {
        let [first, second, last] = &edges(&[3, 1, 40], false)[..] else { panic!("three chunks") };
        assert_eq!(first[..HALO], [None; HALO]);
        assert_eq!(first[HALO..HALO + 3], [Some((1, 0)), Some((2, 0)), Some((2, 1))]);
        assert_eq!(second[HALO - 4..HALO], [None, Some((0, 0)), Some((0, 1)), Some((0, 2))]);
        assert_eq!(last[HALO - 2..HALO], [Some((0, 2)), Some((1, 0))]);
        assert_eq!(last[HALO..], [None; HALO]);
    }

    #[test]
    fn a_ring_goes_round_as_often_as_it_takes() {
        let [one] = &edges(&[3], true)[..] else { panic!("one chunk") };
        let numbers = |edges: &[Edge]| -> Vec<usize> { edges.iter().flatten().map(|e| e.1).collect() };
        let around: Vec<usize> = (0..HALO).map(|k| k % 3).collect();
        assert_eq!(numbers(&one[HALO..]), around);
        assert_eq!(numbers(&one[..HALO]), around.iter().rev().map(|k| 2 - k).collect::<Vec<_>>());
        let [a, b] = &edges(&[1, 2], true)[..] else { panic!("two chunks") };
        assert_eq!(a[HALO - 1], Some((1, 1)));
        assert_eq!(b[HALO..HALO + 2], [Some((0, 0)), Some((1, 0))]);
        assert!(edges(&[], true).is_empty());
    }
}
