//! Elementary functions and hashes that are the same on every backend.
//!
//! The functions of drivers and of the standard library differ in their last bits, or in many
//! more. These are polynomials over operations that every device rounds alike; `wgsl/shared/
//! elementary.wgsl` holds the same text in WGSL. What is left is what a compiler of shaders may
//! reorder or fuse. Of what is not a number they give the same, and so do angles that are infinite. The hashes are integers and equal to the bit. Errors are relative to the true
//! result in units in the last place (ulp), measured over the ranges named by the tests.

use super::numbers::{NAN, clamped};
use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, LN_2, LOG2_E, PI};

/// Quarter turns and the rest, in −π/4 … π/4 for |x| up to 8192; beyond, the rest loses its meaning
/// but stays in range.
fn quarter_turns(x: f32) -> (f32, f32) {
    let n = (x * FRAC_2_PI).round_ties_even();
    let r = ((x - n * 1.5703125) - n * 0.000_483_751_3) - n * 7.549_79e-8;
    let quadrant = n - 4.0 * (n * 0.25).floor();
    (quadrant, r.clamp(-0.79, 0.79))
}

fn sin_of_rest(r: f32) -> f32 {
    let z = r * r;
    ((-0.00019515296 * z + 0.008332161) * z - 0.16666655) * z * r + r
}

fn cos_of_rest(r: f32) -> f32 {
    let z = r * r;
    // Not a sum of two products with one factor: compilers take it out.
    1.0 - z * (0.5 - z * ((0.000024433157 * z - 0.0013887316) * z + 0.041666646))
}

/// Sine; within 2 ulp of 1 for |x| ≤ 8192.
pub fn sin(x: f32) -> f32 {
    if !x.is_finite() {
        return NAN;
    }
    let (q, r) = quarter_turns(x);
    if q == 0.0 {
        sin_of_rest(r)
    } else if q == 1.0 {
        cos_of_rest(r)
    } else if q == 2.0 {
        -sin_of_rest(r)
    } else {
        -cos_of_rest(r)
    }
}

/// Cosine; as [`sin`].
pub fn cos(x: f32) -> f32 {
    if !x.is_finite() {
        return NAN;
    }
    let (q, r) = quarter_turns(x);
    if q == 0.0 {
        cos_of_rest(r)
    } else if q == 1.0 {
        -sin_of_rest(r)
    } else if q == 2.0 {
        -cos_of_rest(r)
    } else {
        sin_of_rest(r)
    }
}

/// Tangent: [`sin`] / [`cos`].
pub fn tan(x: f32) -> f32 {
    if !x.is_finite() {
        return NAN;
    }
    sin(x) / cos(x)
}

/// 2^n for a whole n in −126 … 127.
fn power_of_two(n: f32) -> f32 {
    f32::from_bits(((n as i32 + 127) << 23) as u32)
}

/// e^r · 2^n for |r| ≤ ln 2 / 2 and a whole n in −126 … 128.
fn exp_of_rest(n: f32, r: f32) -> f32 {
    let p = ((((0.00019875691 * r + 0.0013981999) * r + 0.008333452) * r + 0.041665796) * r + 0.16666665) * r
        + 0.5;
    let y = (p * r * r + r) + 1.0;
    let half = (n * 0.5).floor();
    (y * power_of_two(half)) * power_of_two(n - half)
}

/// e^x, within 2 ulp; x is clamped to −87 … 88.
pub fn exp(x: f32) -> f32 {
    if x.is_nan() {
        return NAN;
    }
    let x = clamped(x, -87.0, 88.0);
    let n = (x * LOG2_E).round_ties_even();
    let r = (x - n * 0.693_359_4) - n * -0.00021219444;
    exp_of_rest(n, r)
}

/// 2^x, within 2 ulp; x is clamped to −126 … 127.
pub fn exp2(x: f32) -> f32 {
    if x.is_nan() {
        return NAN;
    }
    let x = clamped(x, -126.0, 127.0);
    let n = x.round_ties_even();
    exp_of_rest(n, (x - n) * LN_2)
}

/// Natural logarithm, within 2 ulp of its greater part; of 0 and less the least float, of infinity infinity.
pub fn log(x: f32) -> f32 {
    if x.is_nan() || x == f32::INFINITY {
        return x;
    }
    if x <= 0.0 {
        return f32::MIN;
    }
    let bits = x.to_bits();
    let mut e = (bits >> 23) as f32 - 126.0;
    let mut m = f32::from_bits((bits & 0x007f_ffff) | 0x3f00_0000);
    if m < 0.70710677 {
        e -= 1.0;
        m += m;
    }
    let m = m - 1.0;
    let z = m * m;
    let p = ((((((((0.070376836 * m - 0.115_146_1) * m + 0.11676998) * m - 0.12420141) * m + 0.14249323)
        * m
        - 0.16668057)
        * m
        + 0.20000714)
        * m
        - 0.24999994)
        * m
        + 0.333_333_3)
        * m
        * z;
    let y = (p + e * -0.00021219444) - 0.5 * z;
    (m + y) + e * 0.693_359_4
}

/// Logarithm to base 2; of 0 and less the least float, of infinity infinity.
pub fn log2(x: f32) -> f32 {
    let natural = log(x);
    if natural.abs() < f32::MAX { natural * LOG2_E } else { natural }
}

/// x^y for x ≥ 0 as e^(y·log x): its relative error grows with |y·log x|. Of 0 and less: 0, or 1 if y = 0.
/// Beyond the range of [`exp`] it is clamped, as it is of infinities.
pub fn pow(x: f32, y: f32) -> f32 {
    if y == 0.0 {
        return 1.0;
    }
    if x.is_nan() || y.is_nan() {
        return NAN;
    }
    if x <= 0.0 {
        return 0.0;
    }
    if x == 1.0 {
        return 1.0;
    }
    if x.is_infinite() || y.is_infinite() {
        return exp(if (x > 1.0) == (y > 0.0) { 88.0 } else { -87.0 });
    }
    exp(y * log(x))
}

/// Arc tangent, within 2 ulp.
pub fn atan(x: f32) -> f32 {
    if x.is_nan() {
        return NAN;
    }
    if x.is_infinite() {
        return FRAC_PI_2.copysign(x);
    }
    let a = x.abs();
    let mut base = 0.0;
    let mut t = a;
    if a > 2.414_213_7 {
        base = FRAC_PI_2;
        t = -1.0 / a;
    } else if a > 0.414_213_57 {
        base = FRAC_PI_4;
        t = (a - 1.0) / (a + 1.0);
    }
    let z = t * t;
    let p = (((0.08053744 * z - 0.13877686) * z + 0.19977711) * z - 0.333_329_5) * z * t + t;
    let y = base + p;
    if x < 0.0 { -y } else { y }
}

/// The angle of the point (x, y), in −π … π; of the origin 0. Where a coordinate is infinite the direction is that of a
/// point so far off: only such coordinates count, and two of them are as long.
pub fn atan2(y: f32, x: f32) -> f32 {
    if y.is_nan() || x.is_nan() {
        return NAN;
    }
    let far = |c: f32| if c.is_infinite() { 1f32.copysign(c) } else { 0.0 };
    let (y, x) = if y.is_infinite() || x.is_infinite() { (far(y), far(x)) } else { (y, x) };
    if x == 0.0 {
        return if y > 0.0 {
            FRAC_PI_2
        } else if y < 0.0 {
            -FRAC_PI_2
        } else {
            0.0
        };
    }
    let a = atan(y / x);
    if x > 0.0 {
        return a;
    }
    if y < 0.0 { a - PI } else { a + PI }
}

/// Arc sine; x is clamped to −1 … 1.
pub fn asin(x: f32) -> f32 {
    if x.is_nan() {
        return NAN;
    }
    let x = clamped(x, -1.0, 1.0);
    atan2(x, ((1.0 - x) * (1.0 + x)).sqrt())
}

/// Arc cosine; x is clamped to −1 … 1.
pub fn acos(x: f32) -> f32 {
    if x.is_nan() {
        return NAN;
    }
    let x = clamped(x, -1.0, 1.0);
    atan2(((1.0 - x) * (1.0 + x)).sqrt(), x)
}

/// Mixes a word into a hash: the finaliser of MurmurHash3 over their difference.
pub fn hash(state: u32, word: u32) -> u32 {
    let mut h = (state ^ word).wrapping_mul(0x9e37_79b1).wrapping_add(0x85eb_ca77);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ h >> 16
}

/// The upper word of a · b: a spread over 0 … b − 1.
pub fn scale(a: u32, b: u32) -> u32 {
    let (ah, al, bh, bl) = (a >> 16, a & 0xffff, b >> 16, b & 0xffff);
    let middle = ah * bl + ((al * bl) >> 16);
    let other = al * bh + (middle & 0xffff);
    ah * bh + (middle >> 16) + (other >> 16)
}

/// The upper 24 bits as a number in [0, 1).
pub fn unit(h: u32) -> f32 {
    (h >> 8) as f32 * 5.960_464_5e-8
}

fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// One of twelve directions to the edges of a cube, at a lattice point, times (x, y, z).
fn gradient(i: [f32; 3], x: f32, y: f32, z: f32) -> f32 {
    let word = |f: f32| f as i32 as u32;
    let h = hash(hash(hash(0, word(i[0])), word(i[1])), word(i[2])) & 15;
    let u = if h < 8 { x } else { y };
    let v = if h < 4 {
        y
    } else if h == 12 || h == 14 {
        x
    } else {
        z
    };
    let first = if h & 1 == 0 { u } else { -u };
    first + if h & 2 == 0 { v } else { -v }
}

fn between(a: f32, b: f32, t: f32) -> f32 {
    a + t * (b - a)
}

/// Gradient noise (Perlin 2002), −1 … 1, 0 at whole points; coordinates are clamped to ±2^20.
pub fn noise(x: f32, y: f32, z: f32) -> f32 {
    if x.is_nan() || y.is_nan() || z.is_nan() {
        return NAN;
    }
    let p = [x, y, z].map(|c| clamped(c, -1048576.0, 1048576.0));
    let c = p.map(f32::floor);
    let d = [p[0] - c[0], p[1] - c[1], p[2] - c[2]];
    let t = d.map(fade);
    let corner =
        |i: f32, j: f32, k: f32| gradient([c[0] + i, c[1] + j, c[2] + k], d[0] - i, d[1] - j, d[2] - k);
    let edge = |j: f32, k: f32| between(corner(0.0, j, k), corner(1.0, j, k), t[0]);
    let side = |k: f32| between(edge(0.0, k), edge(1.0, k), t[1]);
    between(side(0.0), side(1.0), t[2])
}
