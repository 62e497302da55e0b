//! From text to a checked [`System`].
pub mod check;
pub mod diagnostic;
pub mod elementary;
pub mod eval;
pub mod expr;
pub mod lex;
pub mod ops;
pub mod parse;
pub mod print;
pub mod rational;
pub mod syntax;
pub mod system;
pub mod vocabulary;

pub use check::{Checked, check, compile};
pub use diagnostic::{Diagnostic, Severity};
pub use expr::{Expr, Type, Value};
pub use parse::{Parsed, decode, parse};
pub use syntax::Span;
pub use system::System;
pub use vocabulary::Vocabulary;
