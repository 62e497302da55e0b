//! From text to a checked [`System`]: the rule language, and its reference.
//!
#![doc = include_str!("reference.md")]
pub mod check;
pub mod diagnostic;
pub mod elementary;
pub mod eval;
pub mod expr;
pub mod lex;
mod load;
pub mod numbers;
pub mod ops;
mod params;
pub mod parse;
pub mod print;
pub mod rational;
pub mod syntax;
pub mod system;
pub mod vocabulary;

// Pages that stand beside the reference; nothing is in them but text.
#[cfg(doc)]
pub mod codes {
    #![doc = include_str!("codes.md")]
}
#[cfg(doc)]
pub mod names {
    #![doc = include_str!("names.md")]
}
#[cfg(doc)]
pub mod operations {
    #![doc = include_str!("operations.md")]
}

pub use check::{Checked, check, compile};
pub use diagnostic::{Diagnostic, Severity};
pub use expr::{Expr, Type, Value};
pub use load::Diagnostics;
pub use params::Param;
pub use parse::{Parsed, decode, parse};
pub use syntax::Span;
pub use system::System;
pub use vocabulary::Vocabulary;
