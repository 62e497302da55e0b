//! Curve rules as matrices: what of a rule is linear in the points, and what follows from it.
//!
//! A rule whose points are combinations of the points around, with coefficients that do not depend on where these are,
//! is a subdivision scheme: P. Prusinkiewicz, F. Samavati, C. Smith, R. Karwowski, *L-system description of subdivision
//! curves*, section 3. Here it becomes its [`Matrix`] (equations 9–12), the properties of its [`Scheme`], a table of
//! [`Stencils`] that takes control points to the curve in one go, and a matrix becomes a rule again: [`infer`](mod@infer)
//! (section 5).
//!
//! ```
//! use burgeon::affine::{Rules, Stencils, infer};
//! use burgeon::language::System;
//! use burgeon::plan::{Options, Plan};
//!
//! let system = System::parse(
//!     "system chaikin : curve ring\nmodule P(v: vec2)\naxiom: [(0, 0), (1, 0), (1, 1)]\nrules:\n  \
//!      P(vl) < P(v) > P(vr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\nrun:\n  derive 5\n",
//! )?;
//! let rules = Rules::new(&system, &[], &[])?;
//! let scheme = rules.scheme(0)?;
//! assert_eq!((scheme.generates(), scheme.reproduces()), (Some(2), Some(1)));
//! let left = infer(&rules.matrix(8, 0)?, -1, "left")?;
//! assert!(left.contains("P(vl) < P(v) -> P(3/4*vl + 1/4*v) P(1/4*vl + 3/4*v)"));
//!
//! // Five steps at once, of 100 points wherever they are.
//! let table = Stencils::of_length(&Plan::new(&system)?, 100, &Options::default())?;
//! let (control, mut curve) = (vec![[1.0, 2.0, 0.0, 1.0]; 100], vec![[0.0; 4]; table.len()]);
//! burgeon::cpu::stencil::stencil(&table, &control, &mut curve);
//! assert_eq!((curve.len(), curve[0]), (3200, control[0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod form;
pub mod infer;
pub mod matrix;
pub mod number;
pub mod properties;
mod spectrum;
pub mod stencils;
pub mod word;

pub use infer::infer;
pub use matrix::{Matrix, Rules};
pub use number::Number;
pub use properties::Scheme;
pub use spectrum::Eigenvalue;
pub use stencils::Stencils;

use crate::language::Span;
use crate::plan::{self, Unsupported};

/// Why a rule has no matrix.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A point is no combination of points, or the points decide what happens.
    #[error("not an affine subdivision rule: {what}")]
    NotAffine { what: String, span: Span },
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    #[error(transparent)]
    Plan(#[from] plan::Error),
    /// Rules of another kind, a group that is not there, no point to begin with.
    #[error("{0}")]
    Rules(String),
    #[error("the word has more than {most} modules")]
    TooLong { most: usize },
    /// A table that its layout cannot hold.
    #[error("{0}")]
    Table(String),
}

impl Error {
    fn not_affine(what: &str, span: Span) -> Error {
        Error::NotAffine { what: what.to_string(), span }
    }
}
