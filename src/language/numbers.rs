//! What operations give of infinities and of what is not a number (NaN).
//!
//! The values are those of IEEE 754, but that there is one NaN, whose bits are [`NAN`]'s. WGSL lets a driver assume
//! that there are no such numbers, so `wgsl/shared/numbers.wgsl` spells them out by their bits; here the processor
//! gives them.

/// The only one that operations give.
pub const NAN: f32 = f32::from_bits(0x7fc0_0000);

/// A result, with the one NaN.
#[inline]
pub fn plain(x: f32) -> f32 {
    if x.is_nan() { NAN } else { x }
}

/// The lesser; the first where one is not a number.
#[inline]
pub fn least(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// The greater; the first where one is not a number.
#[inline]
pub fn greatest(a: f32, b: f32) -> f32 {
    if a < b { b } else { a }
}

/// At least `low` and at most `high`, which may lie the wrong way round; NaN stays.
#[inline]
pub fn clamped(x: f32, low: f32, high: f32) -> f32 {
    least(greatest(x, low), high)
}

/// Towards zero; beyond i32 the nearest that both f32 and i32 hold. NaN gives 0.
#[inline]
pub fn to_int(x: f32) -> i32 {
    clamped(x, -2147483648.0, 2147483520.0) as i32
}
