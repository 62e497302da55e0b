//! All integration tests, in one binary so that linking stays cheap.
mod affine;
mod arrows;
mod check;
#[cfg(feature = "cli")]
mod command;
#[cfg(feature = "gpu")]
mod conformance;
mod curves;
#[cfg(feature = "gpu")]
mod degrees;
#[cfg(feature = "gpu")]
mod device;
mod embedding;
mod endless;
#[cfg(feature = "gpu")]
mod expressions;
mod fuzz;
mod grid;
mod io;
#[cfg(feature = "gpu")]
mod limits;
mod lowering;
mod mesh;
#[cfg(feature = "gpu")]
mod mutants;
#[cfg(feature = "gpu")]
mod mutation;
mod oracle;
mod papers;
#[cfg(feature = "gpu")]
mod parity;
mod parse;
#[cfg(feature = "gpu")]
mod queries;
mod reference;
#[cfg(feature = "gpu")]
mod render;
#[cfg(feature = "gpu")]
mod runs;
#[cfg(feature = "gpu")]
mod scan;
mod shaders;
mod small;
mod tessellate;
mod tier;
mod turtle;
