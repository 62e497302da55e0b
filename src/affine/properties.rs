//! What a subdivision scheme does to polynomials, read from what repeats in its matrix.
//!
//! A block of `height` new points stands at every `width` old ones: 2 at 1 for a binary scheme, 1 at 2 for the reverse
//! of one. New point r of a block that begins at old point i is Σ a(r, l)·P(i + l).

use super::matrix::Matrix;
use super::number::Number;
use super::spectrum::{self, Eigenvalue};

/// What repeats in a matrix.
#[derive(Clone, Debug)]
pub struct Scheme {
    pub height: usize,
    pub width: usize,
    /// For each new point of a block its coefficients, by the old point's place from the block's first on.
    pub rows: Vec<Vec<(i64, Number)>>,
}

/// Degrees that are looked at: a mask as wide as contexts can be has no more, but for one that only moves points.
pub const MOST_DEGREE: u32 = 32;

impl Scheme {
    /// The first block of a matrix that repeats so.
    pub fn of(matrix: &Matrix, height: usize, width: usize) -> Scheme {
        let n = matrix.columns as i64;
        // Around the end: what is nearer from the left stands there.
        let place =
            |column: u32| if i64::from(column) > n / 2 { i64::from(column) - n } else { column.into() };
        let row = |row: &Vec<(u32, Number)>| {
            let mut row: Vec<(i64, Number)> = row.iter().map(|&(c, x)| (place(c), x)).collect();
            row.sort_by_key(|e| e.0);
            row
        };
        Scheme { height, width, rows: matrix.rows[..height].iter().map(row).collect() }
    }

    /// New points an old one, where that is whole.
    pub fn arity(&self) -> Option<usize> {
        (self.width == 1).then_some(self.height)
    }

    /// The mask, and the index of its first coefficient: new point n is Σ mask(n − arity·l)·P(l). Of a scheme that makes one
    /// point of several, its row. None of other schemes.
    pub fn mask(&self) -> Option<(i64, Vec<Number>)> {
        let arity = self.height as i64;
        let entries: Vec<(i64, Number)> = match (self.width, self.height) {
            (1, _) => {
                let of_row = |(r, row): (usize, &Vec<(i64, Number)>)| {
                    row.iter().map(|&(l, x)| (r as i64 - arity * l, x)).collect::<Vec<_>>()
                };
                self.rows.iter().enumerate().flat_map(of_row).collect()
            }
            (_, 1) => self.rows[0].clone(),
            _ => return None,
        };
        let first = entries.iter().map(|e| e.0).min()?;
        let last = entries.iter().map(|e| e.0).max()?;
        let mut mask = vec![Number::ZERO; (last - first + 1) as usize];
        for (n, x) in entries {
            mask[(n - first) as usize] = x;
        }
        Some((first, mask))
    }

    /// Whether every row sums to 1, so that moving all points moves the curve (equation 1 of the paper).
    pub fn is_affine(&self) -> bool {
        (0..self.height).all(|r| self.moment(r, 0).is(Number::ONE))
    }

    /// Where new points lie, in spacings of the old ones: the first of a block beside the block's first old point, each next
    /// width / height on. It is what makes the scheme reproduce lines, where it does.
    pub fn shift(&self) -> Number {
        self.moment(0, 1)
    }

    /// The greatest degree up to which samples of polynomials at even spacing become samples of polynomials of that degree:
    /// sum rules, or factors 1 + z + … + z^(arity − 1) of the symbol less one. None if rows do not sum to 1; nothing is
    /// asked of a scheme that makes one point a block.
    pub fn generates(&self) -> Option<u32> {
        let alike = |s: u32| (0..self.height).all(|r| self.moment(r, s).is(self.moment(0, s)));
        (self.height > 1 && self.is_affine()).then(|| self.greatest(alike))
    }

    /// The greatest degree up to which these samples are of the same polynomial, at the places of [`Scheme::shift`]
    /// (C. Conti, K. Hormann, *Polynomial reproduction for univariate subdivision schemes of any arity*, 2011). None if
    /// rows do not sum to 1.
    pub fn reproduces(&self) -> Option<u32> {
        let same = |s: u32| (0..self.height).all(|r| self.moment(r, s).is(self.shift().power(s)));
        self.is_affine().then(|| self.greatest(same))
    }

    fn greatest(&self, holds: impl Fn(u32) -> bool) -> u32 {
        (1..=MOST_DEGREE).take_while(|&s| holds(s)).last().unwrap_or(0)
    }

    /// Σ a(r, l)·(l − r·width/height)^s: of places from that of the new point on.
    fn moment(&self, r: usize, s: u32) -> Number {
        let at = Number::whole((r * self.width) as i64) / Number::whole(self.height as i64);
        let term = |&(l, x): &(i64, Number)| x * (Number::whole(l) - at).power(s);
        self.rows[r].iter().map(term).fold(Number::ZERO, |sum, x| sum + x)
    }

    /// The local subdivision matrix: of the fewest neighbouring points that are made of themselves alone. None of schemes
    /// that do not refine.
    pub fn local_matrix(&self) -> Option<Vec<Vec<Number>>> {
        let arity = self.arity().filter(|&a| a > 1)? as i64;
        let (low, mask) = self.mask()?;
        let high = low + mask.len() as i64 - 1;
        // New points n in [−high/(arity − 1), −low/(arity − 1)] are made of old ones l in the same interval.
        let first = -high.div_euclid(arity - 1);
        let last = (-low).div_euclid(arity - 1);
        let entry = |n: i64, l: i64| {
            let at = usize::try_from(n - arity * l - low).ok();
            at.and_then(|at| mask.get(at)).copied().unwrap_or(Number::ZERO)
        };
        let row = |n: i64| (first..=last).map(|l| entry(n, l)).collect();
        (first <= last).then(|| (first..=last).map(row).collect())
    }

    /// The eigenvalues of the local subdivision matrix, the greatest first.
    pub fn eigenvalues(&self) -> Option<Vec<Eigenvalue>> {
        spectrum::eigenvalues(&self.local_matrix()?)
    }
}
