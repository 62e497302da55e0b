//! Points and derivatives of a net at several parameters at once: sums of Bernstein weights, a lane each.

// Loops over lanes count them, so that the compiler takes them together.
#![allow(clippy::needless_range_loop)]

use super::MOST;
use crate::tessellate::lattice::FULL;
use glam::Vec4;

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

#[inline(always)]
pub(super) fn wide_length<const L: usize>(v: &Wide<L>) -> [f32; L] {
    each(|l| (v[0][l] * v[0][l] + v[1][l] * v[1][l] + v[2][l] * v[2][l]).sqrt())
}

#[inline(always)]
pub(super) fn wide_cross<const L: usize>(a: &Wide<L>, b: &Wide<L>) -> Wide<L> {
    [
        each(|l| a[1][l] * b[2][l] - a[2][l] * b[1][l]),
        each(|l| a[2][l] * b[0][l] - a[0][l] * b[2][l]),
        each(|l| a[0][l] * b[1][l] - a[1][l] * b[0][l]),
    ]
}

/// A number for each of L lanes. A plain loop, which the compiler makes one of vectors.
#[inline(always)]
pub(in crate::tessellate) fn each<const L: usize, T: Copy + Default>(of: impl Fn(usize) -> T) -> [T; L] {
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
pub(super) fn parameter(x: u32) -> f32 {
    x as i32 as f32 / FULL as f32
}

/// Points and derivatives. One coordinate after the other, so that what is summed stays in registers. Of a bicubic
/// net these are 48 flops for the weights, 168 along u and 63 along v.
#[inline(always)]
pub(super) fn sum<const L: usize>(
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
pub(super) fn sums<const L: usize>(
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
