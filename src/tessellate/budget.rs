//! How far a tolerance is raised to keep to a budget of triangles.
//!
//! A round of a frame makes the trees and counts; if there are more triangles than the budget, the next round has a
//! larger tolerance, by as much as they are too many: on a surface they go with its inverse. A frame has
//! [`ROUNDS`] of them. What was raised stays for the next frame, which gives back what it has room for, so that
//! a camera that moves on needs one round. Tolerances go in quarters of an octave, integers, so that every
//! device raises them alike.

/// Rounds of a frame.
pub const ROUNDS: u32 = 4;

/// Quarters of an octave that a tolerance is raised at most.
pub const MOST_RAISED: u32 = 120;

/// What is known of the budget from frame to frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Budget {
    /// The tolerance is [`raised`] by so much.
    pub coarser: u32,
    /// Not 0: this frame keeps to the budget.
    pub fits: u32,
    /// Triangles of the round that ran last.
    pub triangles: u32,
    pub reserved: u32,
}

/// 2^(quarters / 4), with one rounding.
#[inline]
pub fn raised(quarters: u32) -> f32 {
    // f32 of 2^(1/4), 2^(1/2) and 2^(3/4), a little below, so that a budget is kept.
    let part = [1.0, 1.189_207_1, 1.414_213_5, 1.681_792_8][quarters as usize & 3];
    part * (1u32 << (quarters >> 2)) as f32
}
