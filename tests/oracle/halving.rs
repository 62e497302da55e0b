//! Bézier halving as the paper prints it: dense products with the matrices L and R.

/// A control net: row index = u, column = v, points (xw, yw, zw, w).
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// Rows − 1, columns − 1.
    pub degree: [usize; 2],
    /// Row by row.
    pub points: Vec<[f64; 4]>,
}

/// A square matrix, row by row.
pub type Matrix = Vec<Vec<f64>>;

/// Which half of a direction a child takes; `Whole` where the block does not split it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Whole,
    First,
    Second,
}

/// L of equation 4 for any degree: row i holds the Bernstein coefficients of degree i at 1/2.
pub fn left(degree: usize) -> Matrix {
    let row = |i| (0..=degree).map(|k| binomial(i, k) / 2f64.powi(i as i32)).collect();
    (0..=degree).map(row).collect()
}

/// R of equation 5: L with its rows reversed both ways.
pub fn right(degree: usize) -> Matrix {
    let reversed = |row: &Vec<f64>| row.iter().rev().copied().collect();
    left(degree).iter().rev().map(reversed).collect()
}

fn identity(degree: usize) -> Matrix {
    let row = |i| (0..=degree).map(|k| if i == k { 1.0 } else { 0.0 }).collect();
    (0..=degree).map(row).collect()
}

/// The matrix that takes a net to that part of it, along a direction of that degree.
pub fn matrix(degree: usize, part: Part) -> Matrix {
    match part {
        Part::Whole => identity(degree),
        Part::First => left(degree),
        Part::Second => right(degree),
    }
}

/// C(n, k), 0 for k > n. Exact: the degrees are at most 8.
pub fn binomial(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

impl Net {
    pub fn new(degree: [usize; 2], points: Vec<[f64; 4]>) -> Net {
        assert_eq!(points.len(), (degree[0] + 1) * (degree[1] + 1), "a net of degree {degree:?}");
        Net { degree, points }
    }

    pub fn point(&self, row: usize, column: usize) -> [f64; 4] {
        self.points[row * (self.degree[1] + 1) + column]
    }

    /// `rows · P · columnsᵀ` (reading E1: the last factor is the transposed matrix).
    pub fn product(&self, rows: &Matrix, columns: &Matrix) -> Net {
        let mut points = Vec::with_capacity(self.points.len());
        // P · columnsᵀ first, each entry once: (P Cᵀ)[k][c] = Σ_l C[c][l] P[k][l].
        let halfway: Vec<Vec<[f64; 4]>> = (0..=self.degree[0])
            .map(|k| columns.iter().map(|weights| weigh(weights, |l| self.point(k, l))).collect())
            .collect();
        for weights in rows {
            points.extend((0..columns.len()).map(|c| weigh(weights, |k| halfway[k][c])));
        }
        Net { degree: [rows.len() - 1, columns.len() - 1], points }
    }

    /// The child of a block that takes these parts along u and v.
    pub fn child(&self, u: Part, v: Part) -> Net {
        self.product(&matrix(self.degree[0], u), &matrix(self.degree[1], v))
    }

    /// The surface at (u, v), in homogeneous coordinates, from the Bernstein polynomials.
    pub fn evaluate(&self, u: f64, v: f64) -> [f64; 4] {
        let (rows, columns) = (bernstein(self.degree[0], u), bernstein(self.degree[1], v));
        self.product(&vec![rows], &vec![columns]).points[0]
    }

    /// The net with every coordinate replaced by its absolute value.
    pub fn absolute(&self) -> Net {
        Net { degree: self.degree, points: self.points.iter().map(|p| p.map(f64::abs)).collect() }
    }

    /// Rows become columns.
    pub fn transposed(&self) -> Net {
        let [m, n] = self.degree;
        let points = (0..=n).flat_map(|c| (0..=m).map(move |r| self.point(r, c))).collect();
        Net { degree: [n, m], points }
    }
}

/// The n + 1 Bernstein polynomials of degree n at t.
pub fn bernstein(degree: usize, t: f64) -> Vec<f64> {
    let term = |k: usize| binomial(degree, k) * t.powi(k as i32) * (1.0 - t).powi((degree - k) as i32);
    (0..=degree).map(term).collect()
}

fn weigh(weights: &[f64], point: impl Fn(usize) -> [f64; 4]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for (i, weight) in weights.iter().enumerate() {
        let p = point(i);
        for axis in 0..4 {
            sum[axis] += weight * p[axis];
        }
    }
    sum
}
