//! burgeon: GPU compute subdivision as parallel rewriting.
#![forbid(unsafe_code)]
pub mod codegen;
pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod io;
pub mod language;
pub mod patch;
pub mod plan;
#[cfg(feature = "gpu")]
pub mod render;
pub mod tessellate;
