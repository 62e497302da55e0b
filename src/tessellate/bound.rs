//! How far a cell's triangles can be from its surface: a bound that is proved.
//!
//! Let M₁, M₂, M₃ bound |S_xx|, |S_xy|, |S_yy| over a cell of unit size. Any triangle with its vertices on the
//! surface, inside the cell, is nowhere farther from the surface point of the same parameter than
//! (M₁ + 2 M₂ + M₃)/8. (Taylor's theorem about a point x = Σ λᵢvᵢ of the triangle: the linear terms cancel; Σ λᵢ dxᵢ² is the
//! variance of a variable on an interval of length 1, at most ¼ by Popoviciu, and the mixed term as much by
//! Cauchy and Schwarz. The constant is Filip's, and z = x² attains it.) So it holds for both triangles of a
//! cell and for every fan.
//!
//! For a Bézier net of m + 1 by n + 1 points S_xx is m(m − 1) times a convex combination of second
//! differences, and so on: M₁ = m(m − 1) max |Δ²ₓ|, M₂ = m n max |ΔₓΔᵧ|, M₃ = n(n − 1) max |Δ²ᵧ|.
//!
//! A rational net p/w is bounded in homogeneous space. Let b be p/w with the origin moved to the middle of
//! its box, r = max |b|, and L the linear interpolant: p/w − Lp/Lw = ((p − Lp) − (Lp/Lw)(w − Lw))/w and |Lp/Lw| ≤ r, so
//! the error is at most (K(p) + r K(w))/(8 min w) with K = M₁ + 2 M₂ + M₃. Differences of p and w have the same Bernstein
//! weights, so |Δp| + r |Δw| may be bounded together. A surface seen through a camera is such a net in two
//! dimensions, with the depth for w: that bounds the error in pixels, and nothing is assumed of the surface's
//! distance.
//!
//! Each halving of both directions divides the differences by 4 or more, so the bound falls at least so fast.

//!
//! What rounding adds is no part of it: halving a cell makes that no smaller, so it must not be what splits one. A
//! root's points are taken about its own place ([`super::surface::Place`]), so it is less than 8 · 2⁻²⁴ of the root's
//! size, and half of the spacing of floats where a vertex lies ([`rounding`]).

use super::surface::{Control, dot, length};
use glam::{Vec3, Vec4};

/// How far a vertex of a root of this size, with coordinates up to `far`, may be from where exact arithmetic has it:
/// half of the spacing of floats there along each of three axes, and what arithmetic does to the root itself.
pub fn rounding(size: f32, far: f32) -> f32 {
    4.0 * f32::EPSILON * size + 0.5 * 3f32.sqrt() * spacing(far)
}

/// How far apart floats are at `x`.
pub fn spacing(x: f32) -> f32 {
    let exponent = x.abs().max(f32::MIN_POSITIVE).to_bits() & 0x7f80_0000;
    f32::from_bits(exponent) * f32::EPSILON
}

/// The bound for a net, in units of its place's size. `projective`: weights differ, else all are 1.
#[inline]
pub fn error(net: &Control, projective: bool) -> f32 {
    error_on(net, projective, Vec3::ONE)
}

/// The same of a projective net where lengths along each axis count so much: as pixels of a picture do.
#[inline]
pub fn error_on(net: &Control, projective: bool, unit: Vec3) -> f32 {
    match (net.rows, net.columns) {
        // With all of it known the compiler unrolls it.
        (4, 4) if projective => bound(&net.points[..16], 4, 4, true, unit),
        (4, 4) => bound(&net.points[..16], 4, 4, false, unit),
        (rows, columns) => bound(&net.points[..rows * columns], rows, columns, projective, unit),
    }
}

#[inline(always)]
fn bound(points: &[Vec4], rows: usize, columns: usize, projective: bool, unit: Vec3) -> f32 {
    let (mut middle, mut r, mut least) = (Vec3::ZERO, 0.0, 1.0);
    if projective {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        least = f32::INFINITY;
        for p in points {
            let here = p.truncate() / p.w;
            low = low.min(here);
            high = high.max(here);
            least = least.min(p.w);
        }
        (middle, r) = ((low + high) * 0.5, length((high - low) * 0.5 * unit));
    }
    // Or its square where weights are all 1: of the largest square one root is taken.
    let size = |d: Vec4| match projective {
        false => dot(d.truncate(), d.truncate()),
        // What is common to all differences is multiplied last: compilers take it out of sums.
        true => length((d.truncate() - middle * d.w) * unit) + r * d.w.abs(),
    };
    let at = |i: usize, j: usize| points[i * columns + j];
    let (mut xx, mut xy, mut yy) = (0.0f32, 0.0f32, 0.0f32);
    for i in 0..rows {
        for j in 0..columns {
            if i + 2 < rows {
                xx = xx.max(size((at(i + 2, j) + at(i, j)) - 2.0 * at(i + 1, j)));
            }
            if i + 1 < rows && j + 1 < columns {
                xy = xy.max(size((at(i, j) + at(i + 1, j + 1)) - (at(i, j + 1) + at(i + 1, j))));
            }
            if j + 2 < columns {
                yy = yy.max(size((at(i, j + 2) + at(i, j)) - 2.0 * at(i, j + 1)));
            }
        }
    }
    if !projective {
        [xx, xy, yy] = [xx, xy, yy].map(f32::sqrt);
    }
    let (m, n) = (rows as f32 - 1.0, columns as f32 - 1.0);
    let k = m * (m - 1.0) * xx + 2.0 * m * n * xy + n * (n - 1.0) * yy;
    k * 0.125 / least
}
