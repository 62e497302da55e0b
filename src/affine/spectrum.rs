//! Eigenvalues of small matrices, as fractions where they are.

use super::number::{Number, decimal};
use crate::language::rational::Rational;
use nalgebra::{DMatrix, Schur};
use std::fmt;

/// An eigenvalue.
#[derive(Clone, Copy, Debug)]
pub struct Eigenvalue {
    pub re: f64,
    pub im: f64,
    /// The fraction that it is, checked without rounding.
    pub exact: Option<Rational>,
}

impl Eigenvalue {
    /// Its absolute value.
    pub fn modulus(&self) -> f64 {
        self.re.hypot(self.im)
    }
}

impl fmt::Display for Eigenvalue {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.exact {
            Some(x) => write!(f, "{}", Number::Exact(x)),
            None if self.im == 0.0 => f.write_str(&decimal(self.re)),
            None => {
                let sign = if self.im < 0.0 { '-' } else { '+' };
                write!(f, "{} {sign} {}i", decimal(self.re), decimal(self.im.abs()))
            }
        }
    }
}

/// Sweeps of the QR algorithm before it gives up.
const MOST_SWEEPS: usize = 10_000;

/// By absolute value, the greatest first; none where the algorithm does not converge.
pub fn eigenvalues(matrix: &[Vec<Number>]) -> Option<Vec<Eigenvalue>> {
    let n = matrix.len();
    let dense = DMatrix::from_fn(n, n, |r, c| matrix[r][c].to_f64());
    let found = Schur::try_new(dense, f64::EPSILON, MOST_SWEEPS)?.complex_eigenvalues();
    let exact: Option<Vec<Vec<Rational>>> =
        matrix.iter().map(|row| row.iter().map(|x| x.exact()).collect()).collect();
    let value = |z: &nalgebra::Complex<f64>| {
        let fraction = exact.as_ref().and_then(|m| fraction_near(m, z.re, z.im));
        match fraction {
            Some(x) => Eigenvalue { re: x.to_f64(), im: 0.0, exact: Some(x) },
            None => Eigenvalue { re: z.re, im: z.im, exact: None },
        }
    };
    let mut values: Vec<Eigenvalue> = found.iter().map(value).collect();
    values.sort_by(|a, b| {
        b.modulus().total_cmp(&a.modulus()).then(b.re.total_cmp(&a.re)).then(b.im.total_cmp(&a.im))
    });
    Some(values)
}

/// A simple fraction that is an eigenvalue and this near. An eigenvalue that m others meet in one chain comes out of the
/// algorithm wrong by the m-th root of the rounding, so it is looked for in ever wider circles.
fn fraction_near(matrix: &[Vec<Rational>], re: f64, im: f64) -> Option<Rational> {
    let near = [1e-12, 1e-9, 1e-7, 1e-5, 1e-3].into_iter().filter(|within| im.abs() < *within);
    near.filter_map(|within| simplest(re, within)).find(|&x| is_eigenvalue(matrix, x))
}

/// The fraction of the least denominator within a distance.
fn simplest(x: f64, within: f64) -> Option<Rational> {
    let fits = |d: &i128| ((x * *d as f64).round() / *d as f64 - x).abs() <= within;
    let d = (1..=1 << 16).find(fits)?;
    Rational::new((x * d as f64).round() as i128, d)
}

/// Whether the determinant of the matrix less `x` on its diagonal is 0: by elimination, in fractions. No where these become
/// too long.
fn is_eigenvalue(matrix: &[Vec<Rational>], x: Rational) -> bool {
    singular(matrix, x).unwrap_or(false)
}

fn singular(matrix: &[Vec<Rational>], x: Rational) -> Option<bool> {
    let mut m = matrix.to_vec();
    let n = m.len();
    for (r, row) in m.iter_mut().enumerate() {
        row[r] = row[r].checked_sub(x)?;
    }
    for column in 0..n {
        let Some(pivot) = (column..n).find(|&r| !m[r][column].is_zero()) else { return Some(true) };
        m.swap(column, pivot);
        let (above, below) = m.split_at_mut(column + 1);
        let pivot = &above[column];
        for row in below.iter_mut().filter(|row| !row[column].is_zero()) {
            let factor = row[column].checked_div(pivot[column])?;
            for c in column..n {
                row[c] = row[c].checked_sub(factor.checked_mul(pivot[c])?)?;
            }
        }
    }
    Some(false)
}
