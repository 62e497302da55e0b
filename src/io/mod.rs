//! Files in and out; sees only the containers.
//!
//! Readers are strict and name the place of what is wrong; writers stream, and [`write_atomically`]
//! sees to it that a failed run leaves no partial file behind.

pub mod bpt;
pub mod bv;
pub mod curves;
pub mod glb;
pub mod json;
mod nets;
mod notes;
mod number;
pub mod obj;
pub mod ply;
pub mod png;
pub mod stl;
mod text;
pub mod values;
mod write;

pub use nets::{NetOptions, read_nets};
pub use notes::Noted;
pub use number::write_f32;
pub use text::{Element, ParseError, Problem, ReadError};
pub use write::{FileError, WriteError, write_atomically};
