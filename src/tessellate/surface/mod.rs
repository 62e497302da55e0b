//! Points of a root's surface in f32, as a tessellation computes them.
//!
//! A vertex is computed once, so nothing hangs on how it rounds, but for one thing: a point on a root's
//! side is computed from that side's control points alone, by midpoints, which are the same read either way.
//! So meshes whose vertices are not shared between patches still have none apart. Points inside are sums of
//! Bernstein weights. [`crate::patch::evaluate`] is the same in f64, from leaves.

mod lanes;
mod place;
mod restrict;

pub(super) use lanes::each;
pub use lanes::{LANES, Points, Samples, TILE, Wide};
pub use place::Place;
pub use restrict::restrict;

use super::lattice::{FULL, LEVELS, NOWHERE, along};
use super::orientation::{self, Orientation};
use super::topology::side_at;
use crate::patch::MAX_DEGREE;
use glam::{Vec3, Vec4};
use lanes::{parameter, sum, sums, wide_cross, wide_length};
use std::cmp::Ordering;

/// Points along one direction of the largest net.
const MOST: usize = MAX_DEGREE as usize + 1;

/// The control points of all roots, as the caller gave them.
#[derive(Clone, Copy)]
pub struct Patches<'a> {
    pub degree: [u8; 2],
    pub rational: bool,
    pub nets: &'a [[f32; 4]],
    /// Of [`orders`].
    pub orders: &'a [Vec<usize>; 8],
}

/// For each orientation where the points of a canonical net stand in the file's.
pub fn orders(degree: [u8; 2]) -> [Vec<usize>; 8] {
    let transposable = degree[0] == degree[1];
    std::array::from_fn(|o| match o {
        4.. if !transposable => Vec::new(),
        o => orientation::points(degree, Orientation(o as u8)).collect(),
    })
}

/// A root's control points in its canonical orientation, row by row.
#[derive(Clone)]
pub struct Control {
    pub rows: usize,
    pub columns: usize,
    pub rational: bool,
    /// As they lie about the root's own place, in units of its size.
    pub points: [Vec4; MOST * MOST],
    /// As the file has them.
    file: [Vec4; MOST * MOST],
    pub place: Place,
    /// The root.
    root: u32,
    /// Below so much of a derivative's length a product of two is rounding.
    pub(super) noise: f32,
}

impl Default for Control {
    /// Of no root.
    fn default() -> Control {
        Control {
            rows: 0,
            columns: 0,
            rational: false,
            points: [Vec4::ZERO; MOST * MOST],
            file: [Vec4::ZERO; MOST * MOST],
            place: Place::default(),
            root: NOWHERE,
            noise: 0.0,
        }
    }
}

impl Patches<'_> {
    /// The canonical net of a root.
    pub fn control(&self, root: u32, orientation: Orientation) -> Control {
        let mut net = Control::default();
        self.load(&mut net, root, orientation);
        net
    }

    /// The same, in the place of another; nothing is done where it is there already.
    #[inline]
    pub fn load(&self, net: &mut Control, root: u32, orientation: Orientation) {
        if net.root == root {
            return;
        }
        let [rows, columns] = self.degree.map(|d| d as usize + 1);
        let n = rows * columns;
        let points = &self.nets[root as usize * n..][..n];
        let order = &self.orders[orientation.0 as usize];
        for (point, &at) in net.file.iter_mut().zip(order) {
            *point = Vec4::from_array(points[at]);
        }
        net.place = Place::of(&net.file[..n], self.rational, &mut net.points[..n]);
        let far = |p: &Vec4| p.truncate().abs().max_element() / p.w;
        net.noise = NOISE * net.points[..n].iter().map(far).fold(0.0, f32::max);
        (net.rows, net.columns, net.root) = (rows, columns, root);
        net.rational = self.rational;
    }
}

/// A point and its derivatives, in space.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub position: Vec3,
    pub du: Vec3,
    pub dv: Vec3,
}

impl Control {
    /// The point at a lattice point.
    pub fn position(&self, p: [u32; 2]) -> Vec3 {
        self.position_of(p, self.sample(p.map(|x| x as f32 / FULL as f32)).position)
    }

    /// The same, where it is known what it would be inside.
    #[inline]
    pub(crate) fn position_of(&self, p: [u32; 2], inside: Vec3) -> Vec3 {
        let position = match (side_at(p[0], 0), side_at(p[1], 1)) {
            (Some(side), _) => self.on_side(side, p[along(side)]),
            (_, Some(side)) => self.on_side(side, p[along(side)]),
            _ => inside,
        };
        // +0 for −0: which of them comes depends on the way along the curve.
        position + Vec3::ZERO
    }

    /// The point at t / FULL of a side, by midpoints alone; far off they are taken about one of its ends, the same one
    /// from either side.
    #[inline]
    fn on_side(&self, side: u32, t: u32) -> Vec3 {
        let (first, step, n) = match side {
            0 => (0, 1, self.columns),
            1 => ((self.rows - 1) * self.columns, 1, self.columns),
            2 => (0, self.columns, self.rows),
            _ => (self.columns - 1, self.columns, self.rows),
        };
        let mut curve = [Vec4::ZERO; MOST];
        for (k, point) in curve.iter_mut().enumerate().take(n) {
            *point = self.file[first + k * step];
        }
        match t {
            0 => return project(curve[0]),
            FULL => return project(curve[n - 1]),
            _ => {}
        }
        let origin = place::origin_of_curve(&curve[..n], self.rational);
        for point in &mut curve[..n] {
            *point = place::about(*point, origin, self.rational);
        }
        let point = match n {
            // With the number known the compiler unrolls it.
            4 => halve_towards(&mut curve, 4, t),
            n => halve_towards(&mut curve, n, t),
        };
        project(point) + origin
    }

    /// Point and derivatives at (u, v), both in 0..=1.
    #[inline]
    pub fn sample(&self, at: [f32; 2]) -> Sample {
        self.in_space(self.own_sample(at))
    }

    /// From units of the root about its place.
    #[inline]
    fn in_space(&self, sample: Sample) -> Sample {
        let Place { origin, size } = self.place;
        Sample { position: sample.position * size + origin, du: sample.du * size, dv: sample.dv * size }
    }

    #[inline]
    fn own_sample(&self, [u, v]: [f32; 2]) -> Sample {
        let mut found = Points::<1>::default();
        match (self.rows, self.columns, self.rational) {
            // With the sizes known the compiler unrolls it.
            (4, 4, false) => sum(&self.points, 4, 4, false, [[u], [v]], &mut found),
            (rows, columns, rational) => sum(&self.points, rows, columns, rational, [[u], [v]], &mut found),
        };
        let one = |v: [[f32; 1]; 3]| Vec3::new(v[0][0], v[1][0], v[2][0]);
        Sample { position: one(found.position), du: one(found.du), dv: one(found.dv) }
    }

    /// The points at several lattice points, and what [`Control::normal`] says of them; derivatives are in units of the
    /// root's size.
    #[inline]
    pub fn samples(&self, points: &[[u32; 2]; LANES], found: &mut Samples<LANES>) {
        let u = each(|l| parameter(points[l][0]));
        let v = each(|l| parameter(points[l][1]));
        match (self.rows, self.columns, self.rational) {
            (4, 4, false) => sum(&self.points, 4, 4, false, [u, v], &mut found.points),
            (rows, columns, rational) => {
                sum(&self.points, rows, columns, rational, [u, v], &mut found.points)
            }
        }
        self.normals(found, |l| points[l]);
    }

    /// The same for all points of a tile, a row for each place along y.
    #[inline]
    pub fn tile(&self, x: &[u32; TILE], y: &[u32; TILE], found: &mut [Samples<TILE>; TILE]) {
        let uv = [each(|l| parameter(x[l])), each(|l| parameter(y[l]))];
        match (self.rows, self.columns, self.rational) {
            (4, 4, false) => sums(&self.points, 4, 4, false, uv, found),
            (rows, columns, rational) => sums(&self.points, rows, columns, rational, uv, found),
        }
        for (row, &y) in found.iter_mut().zip(y) {
            self.normals(row, |l| [x[l], y]);
        }
    }

    /// The normals of points that are there; then where these lie in space.
    #[inline(always)]
    fn normals<const L: usize>(&self, found: &mut Samples<L>, at: impl Fn(usize) -> [u32; 2]) {
        let Points { du, dv, .. } = &found.points;
        let product = wide_cross(du, dv);
        let (n, u, v) = (wide_length(&product), wide_length(du), wide_length(dv));
        for (normal, product) in found.normal.iter_mut().zip(&product) {
            *normal = each(|l| product[l] / n[l]);
        }
        let noise = self.noise;
        let least: [f32; L] = each(|l| noise * u[l] + noise * v[l]);
        let mut certain = true;
        for l in 0..L {
            certain &= n[l] > least[l];
        }
        if !certain {
            // Also where the length is no number.
            for l in (0..L).filter(|&l| n[l].partial_cmp(&least[l]) != Some(Ordering::Greater)) {
                let normal = self.normal(at(l)).0.to_array();
                (0..3).for_each(|k| found.normal[k][l] = normal[k]);
            }
        }
        let Place { origin, size } = self.place;
        for (x, origin) in found.points.position.iter_mut().zip(origin.to_array()) {
            *x = each(|l| x[l] * size + origin);
        }
    }

    /// Point, derivatives and unit normal S_x × S_y at a lattice point. Where the product is nothing but
    /// rounding (a collapsed side, a cusp) it is that of a point a little towards the middle, and (0, 0, 1) where
    /// the surface is a curve or a point.
    #[inline]
    pub fn normal(&self, p: [u32; 2]) -> (Vec3, Sample) {
        self.normal_near(p.map(|x| x as f32 / FULL as f32))
    }

    /// The same at parameters in 0..=1.
    #[inline]
    pub fn normal_near(&self, at: [f32; 2]) -> (Vec3, Sample) {
        let sample = self.own_sample(at);
        let product = cross(sample.du, sample.dv);
        let noise = self.noise;
        if let Some(normal) = direction(product, noise * length(sample.du) + noise * length(sample.dv)) {
            return (normal, self.in_space(sample));
        }
        for nudge in NUDGES {
            let near = self.own_sample(at.map(|x| x + (0.5 - x) * nudge));
            let product = cross(near.du, near.dv);
            if let Some(normal) = direction(product, noise * length(near.du) + noise * length(near.dv)) {
                return (normal, self.in_space(sample));
            }
        }
        (Vec3::Z, self.in_space(sample))
    }
}

/// Rounding of a control point of 1 in a product of derivatives.
pub(super) const NOISE: f32 = 4e-6;

/// How far towards the middle a normal is looked for where there is none.
const NUDGES: [f32; 2] = [1.0 / 1024.0, 1.0 / 32.0];

/// The unit vector, if the vector is longer than this.
#[inline]
fn direction(v: Vec3, least: f32) -> Option<Vec3> {
    let length = length(v);
    (length > least).then(|| v / length)
}

// Spelled out, as in the kernels.
#[inline]
pub fn length(v: Vec3) -> f32 {
    (v.x * v.x + v.y * v.y + v.z * v.z).sqrt()
}

#[inline]
pub fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline]
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

#[inline]
fn project(p: Vec4) -> Vec3 {
    Vec3::new(p.x / p.w, p.y / p.w, p.z / p.w)
}

/// Halves a curve of n points and keeps the half where t / FULL lies, until that is the point between the
/// two.
#[inline(always)]
fn halve_towards(curve: &mut [Vec4; MOST], n: usize, t: u32) -> Vec4 {
    let mut rest = t;
    loop {
        rest *= 2;
        // The upper half grows from the end, the lower one from the beginning.
        let upper = rest >= FULL;
        for level in 1..n {
            for k in 0..n - level {
                let (a, b) = if upper { (k, k + 1) } else { (n - 1 - k, n - 2 - k) };
                curve[a] = (curve[a] + curve[b]) * 0.5;
            }
        }
        if rest == FULL {
            return curve[0];
        }
        if upper {
            rest -= FULL;
        }
    }
}

const _: () = assert!(LEVELS <= 24, "parameters of lattice points are exact in f32");
