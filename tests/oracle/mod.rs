//! The oracle: a naive f64 interpreter of patch and curve systems, straight from the syntax tree.
//!
//! It is written from the requirement alone and shares nothing with `src/` beyond the parser and
//! the tree: words are lists, blocks are recursion, nets are dense products with the paper's
//! matrices. Where an engine and the oracle differ, the requirement is read again. Curve systems have
//! an oracle of their own, [`curve`], and so has the refinement of meshes, [`mesh`].
//!
//! What it does not know (lots of patch systems, host-bound queries, systems of meshes) it refuses with a panic.

mod attributes;
mod compare;
pub mod curve;
mod derive;
pub mod expression;
mod generate;
mod halving;
pub mod lots;
pub mod mesh;
mod pattern;
mod tests;
pub mod value;
mod word;
mod written;

pub use compare::{Tolerance, assert_same, compare, engine_word, lattice_bits};
pub use derive::Oracle;
pub use generate::curve::{CurveCase, curve_case, features as curve_features, minimise_curve};
pub use generate::mesh::{MESH_FEATURES, MeshCase, mesh_case};
pub use generate::{CONSTRUCTS, Case, Random, case, minimise};
pub use halving::{Net, left, right};
pub use word::{Cell, Module, Param, Word};

/// The tree of a rule file, which must have no errors.
#[track_caller]
pub fn parse(text: &str) -> burgeon::language::syntax::RuleFile {
    let parsed = burgeon::language::parse::parse(text);
    let error = parsed.diagnostics.iter().find(|d| d.severity == burgeon::language::Severity::Error);
    if let Some(error) = error {
        panic!("{}: {} in\n{text}", error.code, error.message);
    }
    parsed.file
}

/// The words of the last system of `text`, all of whose files hold `nets`.
#[track_caller]
pub fn derive(text: &str, nets: &[Net]) -> Vec<Word> {
    Oracle::new(&parse(text), None, &|_| nets.to_vec()).derive()
}
