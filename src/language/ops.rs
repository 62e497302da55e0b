//! The table of pure operations.
//!
//! One row an operation feeds the type checker, the host's evaluator, the CPU's register program,
//! the WGSL generator and the reference page.

/// Index of a row of [`TABLE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Op(pub u16);
