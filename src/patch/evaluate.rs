//! Points, derivatives and normals of a Bézier net.
//!
//! Everything is computed in f64 and rounded once to f32. Along each direction the net is collapsed
//! by de Casteljau steps `s·a + t·b` with s = 1 − t, so a curve read backwards at 1 − t gives the
//! same bits, and a point on a side depends on the control points of that side alone: two nets that
//! share a side, whatever their orientation, agree on it bit for bit.

use super::MAX_DEGREE;

/// A homogeneous vector: (xw, yw, zw, w), or a derivative of one.
type Vec4 = [f64; 4];
type Vec3 = [f64; 3];

/// Points along one direction of the largest net.
const MAX_ROW: usize = MAX_DEGREE as usize + 1;

/// A Bézier net that borrows its points.
#[derive(Clone, Copy, Debug)]
pub struct NetRef<'a> {
    degree: [u8; 2],
    points: &'a [[f32; 4]],
}

/// A parameter and its complement, both exact where they can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    t: f64,
    s: f64,
}

impl Parameter {
    /// The parameter `t`, meant to lie in 0..=1.
    pub fn new(t: f64) -> Parameter {
        Parameter { t, s: 1.0 - t }
    }

    /// `i / n`. Unlike `new(i as f64 / n as f64)`, the fraction (n − i) / n is this one exchanged,
    /// bit for bit, whether or not n is a power of two.
    pub fn fraction(i: usize, n: usize) -> Parameter {
        Parameter { t: i as f64 / n as f64, s: (n - i) as f64 / n as f64 }
    }

    /// The parameter itself.
    pub fn value(self) -> f64 {
        self.t
    }

    /// The value at this share of the way from `a` to `b`.
    pub fn between(self, a: f64, b: f64) -> f64 {
        self.s * a + self.t * b
    }

    /// +1 at 0, −1 at 1, else 0: which way is inside when only this direction is at its end.
    fn inward(self) -> f64 {
        f64::from(self.t <= 0.0) - f64::from(self.s <= 0.0)
    }

    /// ±1 towards the middle.
    fn towards_middle(self) -> f64 {
        if self.t <= 0.5 { 1.0 } else { -1.0 }
    }
}

/// What a net is at one parameter pair, in Euclidean space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub position: [f32; 3],
    /// ∂S/∂u, over the net's own unit square.
    pub du: [f32; 3],
    /// ∂S/∂v, over the net's own unit square.
    pub dv: [f32; 3],
    /// Unit length, along S_u × S_v: see [`NetRef::evaluate`].
    pub normal: [f32; 3],
}

impl<'a> NetRef<'a> {
    /// A net of these degrees over `points`, row by row.
    ///
    /// # Panics
    /// When the number of points does not fit the degrees or a degree is not in 1..=8: a mistake of
    /// the caller, since readers refuse such nets.
    pub fn new(degree: [u8; 2], points: &'a [[f32; 4]]) -> NetRef<'a> {
        assert!(degree.iter().all(|d| (1..=MAX_DEGREE).contains(d)), "degree {degree:?} is not in 1..=8");
        assert_eq!(points.len(), super::net_points(degree), "points of a net of degree {degree:?}");
        NetRef { degree, points }
    }

    pub fn degree(&self) -> [u8; 2] {
        self.degree
    }

    /// Row by row.
    pub fn points(&self) -> &'a [[f32; 4]] {
        self.points
    }

    /// Point, derivatives and normal at (u, v), both in 0..=1.
    ///
    /// The normal is S_u × S_v made unit. Where that product vanishes (a side or a corner collapsed
    /// to a point, a cusp) it is the limit from inside the patch: the first term of the Taylor
    /// series of S_u × S_v that does not vanish, going inward at right angles to a side, diagonally
    /// from a corner, and towards the middle from elsewhere. "Vanishes" allows for the rounding of
    /// the control points to f32. Where the surface is a curve or a point there is no normal, and
    /// the answer is (0, 0, 1).
    pub fn evaluate(&self, u: f64, v: f64) -> Sample {
        self.sample(Parameter::new(u), Parameter::new(v))
    }

    /// [`evaluate`](Self::evaluate) at parameters that come with their complements.
    pub fn sample(&self, u: Parameter, v: Parameter) -> Sample {
        let noise = self.noise();
        let euclidean = self.strip(u).at(v).euclidean();
        let normal = euclidean.normal(self, noise, u, v);
        Sample {
            position: round(euclidean.position),
            du: round(euclidean.du),
            dv: round(euclidean.dv),
            normal,
        }
    }

    /// The curve S(u, ·) with its derivative by u: the net collapsed along u.
    pub(crate) fn strip(&self, u: Parameter) -> Strip {
        let [rows, columns] = self.degree.map(|d| d as usize + 1);
        let mut strip = Strip { values: [[0.0; 4]; MAX_ROW], slopes: [[0.0; 4]; MAX_ROW], len: columns };
        let mut column = [[0.0; 4]; MAX_ROW];
        for j in 0..columns {
            for (i, point) in column[..rows].iter_mut().enumerate() {
                *point = self.points[i * columns + j].map(f64::from);
            }
            (strip.values[j], strip.slopes[j]) = de_casteljau(&column[..rows], u);
        }
        strip
    }

    /// Below this length S_u × S_v is nothing but the rounding of the control points.
    pub(crate) fn noise(&self) -> f64 {
        let [rows, columns] = self.degree.map(|d| d as usize + 1);
        let point = |i: usize, j: usize| {
            let [x, y, z, w] = self.points[i * columns + j].map(f64::from);
            [x / w, y / w, z / w]
        };
        let (mut step_u, mut step_v, mut far) = (0.0f64, 0.0f64, 0.0f64);
        for i in 0..rows {
            for j in 0..columns {
                let here = point(i, j);
                far = here.iter().fold(far, |m, x| m.max(x.abs()));
                if i > 0 {
                    step_u = step_u.max(distance_squared(here, point(i - 1, j)));
                }
                if j > 0 {
                    step_v = step_v.max(distance_squared(here, point(i, j - 1)));
                }
            }
        }
        let [m, n] = self.degree.map(f64::from);
        let (step_u, step_v) = (step_u.sqrt(), step_v.sqrt());
        let rounding = f64::from(f32::EPSILON) * far;
        m * n * (rounding * (step_u + step_v) + 1e-7 * step_u * step_v)
    }
}

/// A net collapsed along u: the control points of a curve in v, and of its derivative by u.
pub(crate) struct Strip {
    values: [Vec4; MAX_ROW],
    slopes: [Vec4; MAX_ROW],
    len: usize,
}

impl Strip {
    pub(crate) fn at(&self, v: Parameter) -> Homogeneous {
        let (point, dv) = de_casteljau(&self.values[..self.len], v);
        let (du, _) = de_casteljau(&self.slopes[..self.len], v);
        Homogeneous { point, du, dv }
    }
}

/// A point and its derivatives before the division by the weight.
pub(crate) struct Homogeneous {
    point: Vec4,
    du: Vec4,
    dv: Vec4,
}

impl Homogeneous {
    /// The quotient rule: (A/w)' = (A' − (A/w)·w') / w. With weights of 1 it changes nothing.
    pub(crate) fn euclidean(&self) -> Euclidean {
        let w = self.point[3];
        let position: Vec3 = std::array::from_fn(|k| self.point[k] / w);
        let slope = |d: &Vec4| std::array::from_fn(|k| (d[k] - position[k] * d[3]) / w);
        Euclidean { position, du: slope(&self.du), dv: slope(&self.dv) }
    }
}

pub(crate) struct Euclidean {
    position: Vec3,
    du: Vec3,
    dv: Vec3,
}

impl Euclidean {
    /// Rounded to f32, with +0 for −0: which zero comes out depends on the direction of travel.
    pub(crate) fn position(&self) -> [f32; 3] {
        round(self.position)
    }

    /// The unit normal of `net` here; `noise` is [`NetRef::noise`].
    pub(crate) fn normal(&self, net: &NetRef, noise: f64, u: Parameter, v: Parameter) -> [f32; 3] {
        let normal = cross(self.du, self.dv);
        let length = norm(normal);
        if length > noise && length.is_finite() {
            return round(normal.map(|x| x / length));
        }
        round(limit_normal(net, noise, u, v, self.position))
    }
}

/// Collapses a row of control points to its point and its derivative at `p`.
fn de_casteljau(row: &[Vec4], p: Parameter) -> (Vec4, Vec4) {
    // The usual lengths by name, so that the compiler unrolls them.
    match *row {
        [a, b] => collapse([a, b], p),
        [a, b, c] => collapse([a, b, c], p),
        [a, b, c, d] => collapse([a, b, c, d], p),
        _ => {
            let mut copy = [[0.0; 4]; MAX_ROW];
            copy[..row.len()].copy_from_slice(row);
            collapse_first(&mut copy, row.len(), p)
        }
    }
}

#[inline(always)]
fn collapse<const N: usize>(mut row: [Vec4; N], p: Parameter) -> (Vec4, Vec4) {
    collapse_first(&mut row, N, p)
}

/// Of a row with `len` points in use.
#[inline(always)]
fn collapse_first(row: &mut [Vec4], len: usize, p: Parameter) -> (Vec4, Vec4) {
    for last in (2..len).rev() {
        for k in 0..last {
            row[k] = lerp(row[k], row[k + 1], p);
        }
    }
    let slope = std::array::from_fn(|k| (len - 1) as f64 * (row[1][k] - row[0][k]));
    (lerp(row[0], row[1], p), slope)
}

#[inline(always)]
fn lerp(a: Vec4, b: Vec4, p: Parameter) -> Vec4 {
    std::array::from_fn(|k| p.between(a[k], b[k]))
}

/// The limit of the unit normal at (u, v) from inside, where S_u × S_v itself says nothing.
#[cold]
fn limit_normal(net: &NetRef, noise: f64, u: Parameter, v: Parameter, position: Vec3) -> Vec3 {
    let taylor = Taylor::new(net, u, v, position);
    let (a, b) = (u.towards_middle(), v.towards_middle());
    let mut first = (u.inward(), v.inward());
    if first == (0.0, 0.0) {
        first = (a, b);
    }
    // The others in turn, should the product vanish all along the first.
    let directions = [first, (a, b), (a, 0.0), (0.0, b)];
    let above = |least: f64| {
        let mut terms = directions.iter().flat_map(|&direction| taylor.normals(direction));
        terms.find(|&term| norm(term) > least)
    };
    match above(noise).or_else(|| above(0.0)) {
        Some(term) if norm(term).is_finite() => {
            let length = norm(term);
            term.map(|x| x / length)
        }
        _ => [0.0, 0.0, 1.0],
    }
}

/// The Taylor coefficients of a net about a point, with the origin moved to the surface there.
struct Taylor {
    /// `[a][b]`: of (Δu)^a (Δv)^b.
    coefficients: Vec<Vec<Vec4>>,
}

impl Taylor {
    fn new(net: &NetRef, u: Parameter, v: Parameter, origin: Vec3) -> Taylor {
        let [rows, columns] = net.degree.map(|d| d as usize + 1);
        let centred = |point: [f32; 4]| {
            let [x, y, z, w] = point.map(f64::from);
            [x - origin[0] * w, y - origin[1] * w, z - origin[2] * w, w]
        };
        let by_column: Vec<Vec<Vec4>> = (0..columns)
            .map(|j| expand((0..rows).map(|i| centred(net.points[i * columns + j])).collect(), u))
            .collect();
        let coefficients =
            (0..rows).map(|a| expand(by_column.iter().map(|column| column[a]).collect(), v)).collect();
        Taylor { coefficients }
    }

    /// The series of w⁴ · S_u × S_v along (u, v) + τ·direction, by powers of τ. The factor is
    /// positive, so the first term that does not vanish points along the limit of the normal.
    fn normals(&self, direction: (f64, f64)) -> Vec<Vec3> {
        let (point, du, dv) = self.along(direction);
        cross_series(&numerator(&point, &du), &numerator(&point, &dv))
    }

    /// The point and its derivatives by u and v along a direction, by powers of τ.
    fn along(&self, (du, dv): (f64, f64)) -> (Vec<Vec4>, Vec<Vec4>, Vec<Vec4>) {
        let (rows, columns) = (self.coefficients.len(), self.coefficients[0].len());
        let zero = vec![[0.0; 4]; rows + columns - 1];
        let (mut point, mut slope_u, mut slope_v) = (zero.clone(), zero.clone(), zero);
        let power = |x: f64, k: usize| x.powi(k as i32);
        for (a, row) in self.coefficients.iter().enumerate() {
            for (b, term) in row.iter().enumerate() {
                add_scaled(&mut point[a + b], term, power(du, a) * power(dv, b));
                if a > 0 {
                    add_scaled(&mut slope_u[a - 1 + b], term, a as f64 * power(du, a - 1) * power(dv, b));
                }
                if b > 0 {
                    add_scaled(&mut slope_v[a + b - 1], term, b as f64 * power(du, a) * power(dv, b - 1));
                }
            }
        }
        (point, slope_u, slope_v)
    }
}

/// The Taylor coefficients of a Bézier curve about `p`: of order k, C(n, k) times the k-th
/// differences collapsed n − k times.
fn expand(mut row: Vec<Vec4>, p: Parameter) -> Vec<Vec4> {
    let degree = row.len() - 1;
    let mut binomial = 1.0;
    (0..=degree)
        .map(|order| {
            let mut level = row.clone();
            for last in (1..level.len()).rev() {
                for k in 0..last {
                    level[k] = lerp(level[k], level[k + 1], p);
                }
            }
            let coefficient = level[0].map(|x| binomial * x);
            row = row.windows(2).map(|pair| std::array::from_fn(|k| pair[1][k] - pair[0][k])).collect();
            binomial = binomial * (degree - order) as f64 / (order + 1) as f64;
            coefficient
        })
        .collect()
}

/// The series of w·A' − A·w', the numerator of the derivative of A/w.
fn numerator(point: &[Vec4], slope: &[Vec4]) -> Vec<Vec3> {
    let mut product = vec![[0.0; 3]; point.len() + slope.len() - 1];
    for (i, p) in point.iter().enumerate() {
        for (j, d) in slope.iter().enumerate() {
            for (k, sum) in product[i + j].iter_mut().enumerate() {
                *sum += p[3] * d[k] - p[k] * d[3];
            }
        }
    }
    product
}

fn cross_series(a: &[Vec3], b: &[Vec3]) -> Vec<Vec3> {
    let mut product = vec![[0.0; 3]; a.len() + b.len() - 1];
    for (i, &p) in a.iter().enumerate() {
        for (j, &q) in b.iter().enumerate() {
            let term = cross(p, q);
            for (sum, x) in product[i + j].iter_mut().zip(term) {
                *sum += x;
            }
        }
    }
    product
}

fn add_scaled(sum: &mut Vec4, term: &Vec4, factor: f64) {
    for (s, x) in sum.iter_mut().zip(term) {
        *s += factor * x;
    }
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: Vec3) -> f64 {
    distance_squared(a, [0.0; 3]).sqrt()
}

fn distance_squared(a: Vec3, b: Vec3) -> f64 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

/// To f32, with +0 for −0.
fn round(a: Vec3) -> [f32; 3] {
    a.map(|x| x as f32 + 0.0)
}
