//! Uniform bicubic B-splines as Bézier nets.

use super::Net;

/// The control points of a uniform bicubic B-spline.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlGrid {
    /// Points along u.
    pub rows: usize,
    /// Points along v.
    pub columns: usize,
    /// Whether the last point is followed by the first, along u and along v.
    pub closed: [bool; 2],
    /// Row by row, homogeneous: (xw, yw, zw, w).
    pub points: Vec<[f64; 4]>,
}

impl ControlGrid {
    /// The Bézier nets of the surface, row by row (u), one for each 4 × 4 points that follow one
    /// another: `rows - 3` along u, or `rows` where it is closed, and so along v. The surface ends
    /// where the points still suffice; no end is clamped.
    ///
    /// Along a line of points …, a, b, c, d, … the Bézier points between b and c are (a + 4b + c)/6,
    /// (2b + c)/3, (b + 2c)/3 and (b + 4c + d)/6, first along u, then along v, in f64 and rounded
    /// once. Nets that meet share the points of their border bit for bit.
    ///
    /// A grid with fewer points than 4, or 3 along a closed direction, has no nets.
    ///
    /// # Panics
    /// When `points` does not hold rows × columns points.
    pub fn nets(&self) -> Vec<Net> {
        assert_eq!(self.points.len(), self.rows * self.columns, "rows × columns points");
        let [m, n] = [self.spans(self.rows, self.closed[0]), self.spans(self.columns, self.closed[1])];
        (0..m).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| self.net(i, j)).collect()
    }

    fn spans(&self, points: usize, closed: bool) -> usize {
        match closed {
            true if points < 3 => 0,
            true => points,
            false => points.saturating_sub(3),
        }
    }

    fn net(&self, i: usize, j: usize) -> Net {
        let point =
            |k: usize, l: usize| self.points[(i + k) % self.rows * self.columns + (j + l) % self.columns];
        let along_u: [[[f64; 4]; 4]; 4] =
            std::array::from_fn(|l| bezier([point(0, l), point(1, l), point(2, l), point(3, l)]));
        let points = (0..4).flat_map(|k| bezier(along_u.map(|column| column[k])));
        Net { degree: [3, 3], points: points.map(|point| point.map(|x| x as f32)).collect() }
    }
}

/// The Bézier points of the middle span.
fn bezier([a, b, c, d]: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let corner = |a: f64, b: f64, c: f64| (a + c + 4.0 * b) / 6.0;
    let inner = |a: f64, b: f64| (2.0 * a + b) / 3.0;
    [
        std::array::from_fn(|k| corner(a[k], b[k], c[k])),
        std::array::from_fn(|k| inner(b[k], c[k])),
        std::array::from_fn(|k| inner(c[k], b[k])),
        std::array::from_fn(|k| corner(b[k], c[k], d[k])),
    ]
}
