//! Points of a root's surface in f32, as a tessellation computes them.
//!
//! A vertex is computed once, so nothing hangs on how it rounds, but for one thing: a point on a root's
//! side is computed from that side's control points alone, by midpoints, which are the same read either way.
//! So meshes whose vertices are not shared between patches still have none apart. Points inside are sums of
//! Bernstein weights. [`crate::patch::evaluate`] is the same in f64, from leaves.

// Loops over lanes count them, so that the compiler takes them together.
#![allow(clippy::needless_range_loop)]

use super::lattice::{FULL, LEVELS, NOWHERE, Node, along};
use super::orientation::{self, Orientation};
use super::topology::side_at;
use crate::patch::MAX_DEGREE;
use glam::{Vec3, Vec4};
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
    pub points: [Vec4; MOST * MOST],
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
        let mut far = 0.0f32;
        for (point, &at) in net.points.iter_mut().zip(order) {
            *point = Vec4::from_array(points[at]);
            far = far.max(point.truncate().abs().max_element() / point.w);
        }
        (net.rows, net.columns, net.root, net.noise) = (rows, columns, root, NOISE * far);
        net.rational = self.rational;
    }
}

/// Lattice points that are computed at once.
pub const LANES: usize = 8;

/// Lattice points along each side of a tile.
pub const TILE: usize = 4;

/// x, y and z of L vectors.
pub type Wide<const L: usize> = [[f32; L]; 3];

/// Points and their derivatives: x, y and z of each as a row of L lanes.
#[derive(Clone, Copy, Debug)]
pub struct Points<const L: usize> {
    pub position: Wide<L>,
    pub du: Wide<L>,
    pub dv: Wide<L>,
}

impl<const L: usize> Default for Points<L> {
    fn default() -> Points<L> {
        let zero = [[0.0; L]; 3];
        Points { position: zero, du: zero, dv: zero }
    }
}

/// The same, and unit normals.
#[derive(Clone, Copy, Debug)]
pub struct Samples<const L: usize> {
    pub points: Points<L>,
    pub normal: Wide<L>,
}

impl<const L: usize> Default for Samples<L> {
    fn default() -> Samples<L> {
        Samples { points: Points::default(), normal: [[0.0; L]; 3] }
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
            (Some(side), _) => project(self.on_side(side, p[along(side)])),
            (_, Some(side)) => project(self.on_side(side, p[along(side)])),
            _ => inside,
        };
        // +0 for −0: which of them comes depends on the way along the curve.
        position + Vec3::ZERO
    }

    /// The point at t / FULL of a side, by midpoints alone.
    #[inline]
    fn on_side(&self, side: u32, t: u32) -> Vec4 {
        let (first, step, n) = match side {
            0 => (0, 1, self.columns),
            1 => ((self.rows - 1) * self.columns, 1, self.columns),
            2 => (0, self.columns, self.rows),
            _ => (self.columns - 1, self.columns, self.rows),
        };
        let mut curve = [Vec4::ZERO; MOST];
        for (k, point) in curve.iter_mut().enumerate().take(n) {
            *point = self.points[first + k * step];
        }
        match t {
            0 => return curve[0],
            FULL => return curve[n - 1],
            _ => {}
        }
        match n {
            // With the number known the compiler unrolls it.
            4 => halve_towards(&mut curve, 4, t),
            n => halve_towards(&mut curve, n, t),
        }
    }

    /// Point and derivatives at (u, v), both in 0..=1.
    #[inline]
    pub fn sample(&self, [u, v]: [f32; 2]) -> Sample {
        let mut found = Points::<1>::default();
        match (self.rows, self.columns, self.rational) {
            // With the sizes known the compiler unrolls it.
            (4, 4, false) => sum(&self.points, 4, 4, false, [[u], [v]], &mut found),
            (rows, columns, rational) => sum(&self.points, rows, columns, rational, [[u], [v]], &mut found),
        };
        let one = |v: [[f32; 1]; 3]| Vec3::new(v[0][0], v[1][0], v[2][0]);
        Sample { position: one(found.position), du: one(found.du), dv: one(found.dv) }
    }

    /// The same at several lattice points, and what [`Control::normal`] says of them.
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

    /// The normals of points that are there.
    #[inline(always)]
    fn normals<const L: usize>(&self, found: &mut Samples<L>, at: impl Fn(usize) -> [u32; 2]) {
        let Points { du, dv, .. } = &found.points;
        let product = wide_cross(du, dv);
        let (n, u, v) = (wide_length(&product), wide_length(du), wide_length(dv));
        for k in 0..3 {
            found.normal[k] = each(|l| product[k][l] / n[l]);
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
        let sample = self.sample(at);
        let product = cross(sample.du, sample.dv);
        let noise = self.noise;
        if let Some(normal) = direction(product, noise * length(sample.du) + noise * length(sample.dv)) {
            return (normal, sample);
        }
        for nudge in NUDGES {
            let near = self.sample(at.map(|x| x + (0.5 - x) * nudge));
            let product = cross(near.du, near.dv);
            if let Some(normal) = direction(product, noise * length(near.du) + noise * length(near.dv)) {
                return (normal, sample);
            }
        }
        (Vec3::Z, sample)
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

#[inline(always)]
fn wide_length<const L: usize>(v: &Wide<L>) -> [f32; L] {
    each(|l| (v[0][l] * v[0][l] + v[1][l] * v[1][l] + v[2][l] * v[2][l]).sqrt())
}

#[inline(always)]
fn wide_cross<const L: usize>(a: &Wide<L>, b: &Wide<L>) -> Wide<L> {
    [
        each(|l| a[1][l] * b[2][l] - a[2][l] * b[1][l]),
        each(|l| a[2][l] * b[0][l] - a[0][l] * b[2][l]),
        each(|l| a[0][l] * b[1][l] - a[1][l] * b[0][l]),
    ]
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

/// A number for each of L lanes. A plain loop, which the compiler makes one of vectors.
#[inline(always)]
pub(super) fn each<const L: usize, T: Copy + Default>(of: impl Fn(usize) -> T) -> [T; L] {
    let mut all = [T::default(); L];
    for l in 0..L {
        all[l] = of(l);
    }
    all
}

/// Bernstein weights of a degree, or their derivatives, each for L parameters.
type Weights<const L: usize> = [[f32; L]; MOST];

/// The Bernstein weights of a degree at t, and their derivatives, written where they are read: as a result
/// they would be copied.
#[inline(always)]
fn bernstein<const L: usize>(points: usize, t: [f32; L], w: &mut Weights<L>, slopes: &mut Weights<L>) {
    let s: [f32; L] = each(|l| 1.0 - t[l]);
    w[0] = [1.0; L];
    for n in 1..points {
        if n + 1 == points {
            let mut before = [0.0; L];
            for k in 0..points {
                slopes[k] = each(|l| n as f32 * (before[l] - w[k][l]));
                before = w[k];
            }
        }
        let mut before = w[0];
        w[0] = each(|l| before[l] * s[l]);
        for k in 1..n {
            let here = w[k];
            w[k] = each(|l| s[l] * here[l] + t[l] * before[l]);
            before = here;
        }
        w[n] = each(|l| t[l] * before[l]);
    }
}

/// A lattice coordinate as a parameter: exact.
#[inline(always)]
fn parameter(x: u32) -> f32 {
    x as i32 as f32 / FULL as f32
}

/// Points and derivatives. One coordinate after the other, so that what is summed stays in registers. Of a bicubic
/// net these are 48 flops for the weights, 168 along u and 63 along v.
#[inline(always)]
fn sum<const L: usize>(
    points: &[Vec4; MOST * MOST],
    rows: usize,
    columns: usize,
    rational: bool,
    [u, v]: [[f32; L]; 2],
    found: &mut Points<L>,
) {
    let (mut bu, mut su, mut bv, mut sv) =
        ([[0.0; L]; MOST], [[0.0; L]; MOST], [[0.0; L]; MOST], [[0.0; L]; MOST]);
    bernstein(rows, u, &mut bu, &mut su);
    bernstein(columns, v, &mut bv, &mut sv);
    let mut w = [[1.0; L]; 3];
    for k in coordinates(rational) {
        let (mut value, mut slope) = ([[0.0; L]; MOST], [[0.0; L]; MOST]);
        along_u(points, [rows, columns], k, [&bu, &su], [&mut value, &mut slope]);
        let sums = along_v(columns, [&value, &slope], [&bv, &sv]);
        put(k, sums, rational, &mut w, found);
    }
}

/// The same at all crossings of L places along either direction: what is summed along u is read again for each place
/// along v. Of a bicubic net these are 12 + 42 + 63 flops for a point of a tile of 4 by 4.
#[inline(always)]
fn sums<const L: usize>(
    points: &[Vec4; MOST * MOST],
    rows: usize,
    columns: usize,
    rational: bool,
    [u, v]: [[f32; L]; 2],
    found: &mut [Samples<L>; L],
) {
    let (mut bu, mut su, mut bv, mut sv) =
        ([[0.0; L]; MOST], [[0.0; L]; MOST], [[0.0; L]; MOST], [[0.0; L]; MOST]);
    bernstein(rows, u, &mut bu, &mut su);
    bernstein(columns, v, &mut bv, &mut sv);
    let (mut values, mut slopes) = ([[[0.0; L]; MOST]; 4], [[[0.0; L]; MOST]; 4]);
    for k in coordinates(rational) {
        along_u(points, [rows, columns], k, [&bu, &su], [&mut values[k], &mut slopes[k]]);
    }
    for (r, found) in found.iter_mut().enumerate() {
        let (mut b, mut s) = ([[0.0; L]; MOST], [[0.0; L]; MOST]);
        for j in 0..columns {
            (b[j], s[j]) = ([bv[j][r]; L], [sv[j][r]; L]);
        }
        let mut w = [[1.0; L]; 3];
        for k in coordinates(rational) {
            let sums = along_v(columns, [&values[k], &slopes[k]], [&b, &s]);
            put(k, sums, rational, &mut w, &mut found.points);
        }
    }
}

/// x, y and z, and before them the weight, if there is one.
#[inline(always)]
fn coordinates(rational: bool) -> impl Iterator<Item = usize> {
    (usize::from(!rational)..4).map(|n| (n + 3) % 4)
}

/// One coordinate of each column of points at a place along u, and its derivative.
#[inline(always)]
fn along_u<const L: usize>(
    points: &[Vec4; MOST * MOST],
    [rows, columns]: [usize; 2],
    k: usize,
    [weights, slopes]: [&Weights<L>; 2],
    [value, slope]: [&mut Weights<L>; 2],
) {
    for j in 0..columns {
        for i in 0..rows {
            let p = points[i * columns + j][k];
            value[j] = first_or_sum(i, &value[j], |l| weights[i][l] * p);
            slope[j] = first_or_sum(i, &slope[j], |l| slopes[i][l] * p);
        }
    }
}

/// The coordinate and its derivatives at a place along v.
#[inline(always)]
fn along_v<const L: usize>(
    columns: usize,
    [value, slope]: [&Weights<L>; 2],
    [weights, slopes]: [&Weights<L>; 2],
) -> [[f32; L]; 3] {
    let (mut point, mut du, mut dv) = ([0.0; L], [0.0; L], [0.0; L]);
    for j in 0..columns {
        point = first_or_sum(j, &point, |l| weights[j][l] * value[j][l]);
        du = first_or_sum(j, &du, |l| weights[j][l] * slope[j][l]);
        dv = first_or_sum(j, &dv, |l| slopes[j][l] * value[j][l]);
    }
    [point, du, dv]
}

/// Keeps a coordinate and its derivatives; those of the weight come first, and divide the others.
#[inline(always)]
fn put<const L: usize>(
    k: usize,
    sums: [[f32; L]; 3],
    rational: bool,
    weight: &mut [[f32; L]; 3],
    found: &mut Points<L>,
) {
    if k == 3 {
        *weight = sums;
        return;
    }
    let ([mut point, mut du, mut dv], [w, wu, wv]) = (sums, &*weight);
    if rational {
        point = each(|l| point[l] / w[l]);
        du = each(|l| (du[l] - point[l] * wu[l]) / w[l]);
        dv = each(|l| (dv[l] - point[l] * wv[l]) / w[l]);
    }
    (found.position[k], found.du[k], found.dv[k]) = (point, du, dv);
}

/// The sum with one more term; the first begins it, since 0 + x costs an addition, which rounds -0.
#[inline(always)]
fn first_or_sum<const L: usize>(n: usize, sum: &[f32; L], term: impl Fn(usize) -> f32) -> [f32; L] {
    if n == 0 { each(term) } else { each(|l| sum[l] + term(l)) }
}

/// The control points of a cell, written over `cell`: those of its root, by the weights that the cell's ends along x
/// give, then by those along y. It takes as long at any depth: see `decide.wgsl`.
#[inline]
pub fn restrict(root: &Control, node: &Node, cell: &mut Control) {
    (cell.rows, cell.columns) = (root.rows, root.columns);
    match (root.rows, root.columns, root.rational) {
        (4, 4, false) => restricted(&root.points, 4, 4, false, node, &mut cell.points),
        (rows, columns, rational) => {
            restricted(&root.points, rows, columns, rational, node, &mut cell.points);
        }
    }
}

#[inline(always)]
fn restricted(
    root: &[Vec4; MOST * MOST],
    rows: usize,
    columns: usize,
    rational: bool,
    node: &Node,
    cell: &mut [Vec4; MOST * MOST],
) {
    let [du, dv] = node.depth();
    let mut w = [[0.0; MOST]; MOST];
    // Where all weights are 1 they are no sum.
    let weighed = |p: Vec4| if rational { p } else { p.truncate().extend(1.0) };
    shares(rows, du, node.i, &mut w);
    for k in 0..rows {
        for c in 0..columns {
            let mut sum = w[k][0] * root[c];
            for r in 1..rows {
                sum += w[k][r] * root[r * columns + c];
            }
            cell[k * columns + c] = weighed(sum);
        }
    }
    shares(columns, dv, node.j, &mut w);
    for r in 0..rows {
        let mut p = [Vec4::ZERO; MOST];
        p[..columns].copy_from_slice(&cell[r * columns..][..columns]);
        for k in 0..columns {
            let mut sum = w[k][0] * p[0];
            for c in 1..columns {
                sum += w[k][c] * p[c];
            }
            cell[r * columns + k] = weighed(sum);
        }
    }
}

/// How much each control point of a part of a curve has of those of the whole. The part is the nth after so many
/// halvings; its point k is the blossom at where it begins, and k times at where it ends.
#[inline(always)]
fn shares(points: usize, depth: u32, n: u32, shares: &mut [[f32; MOST]; MOST]) {
    // Exact, as are both ends.
    let size = f32::from_bits((127 - depth) << 23);
    let ends = [n as f32 * size, (n + 1) as f32 * size];
    for (k, share) in shares.iter_mut().enumerate().take(points) {
        let mut w = [0.0; MOST];
        w[0] = 1.0;
        for n in 1..points {
            let t = ends[usize::from(n + k >= points)];
            let s = 1.0 - t;
            for i in (1..points).rev() {
                w[i] = s * w[i] + t * w[i - 1];
            }
            w[0] *= s;
        }
        *share = w;
    }
}

const _: () = assert!(LEVELS <= 24, "parameters of lattice points are exact in f32");
