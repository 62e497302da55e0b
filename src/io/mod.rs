//! Files in and out; sees only the containers.
//!
//! Readers are strict and name the place of what is wrong; writers stream, and [`write_atomically`]
//! sees to it that a failed run leaves no partial file behind.

pub mod bpt;
pub mod json;
mod number;
pub mod obj;
pub mod png;
pub mod values;
mod write;

pub use number::write_f32;
pub use write::{FileError, WriteError, write_atomically};
