//! What differs between kinds of systems, and nothing else does: a new kind is a file here, with its axiom, its layout, what
//! its successors become, the passes that run, and the words that come of it.
//!
//! Backends and codegen ask for no kind: they see columns ([`super::columns`]), programs ([`super::program`]) and tables.

mod curve;
mod patch;

use super::layout::Layout;
use super::program::Program;
use super::supported::Unsupported;
use super::tables::{Becomes, Builder, Resolve, RulesOf, Stage};
use crate::language::system::{self, Rule, Successor, System};
use std::fmt::Debug;

/// A kind of system as plans treat it.
pub(in crate::plan) trait WordKind: Debug + Sync {
    /// As messages name it.
    fn name(&self) -> &'static str;

    /// Whether rules of this shape are derived: their contexts, queries, predecessors and successors.
    ///
    /// # Errors
    /// What is not, by name.
    fn supports(&self, rule: &Rule, system: &System) -> Result<(), Unsupported>;

    /// Where a module's record holds what, where the parameters of no symbol take more than `param_words`. `several`:
    /// words that are derived at once.
    ///
    /// # Errors
    /// What cannot be derived so, by name.
    fn layout(
        &self,
        system: &System,
        rules: &[RulesOf],
        param_words: usize,
        several: bool,
    ) -> Result<Layout, Unsupported>;

    /// A module on which no rule can fire any more may be [retired](super::derive): no other reads it.
    fn retires(&self) -> bool;

    /// What a successor makes of a predecessor; `resolve` writes its expressions in terms of the record.
    fn becomes(
        &self,
        builder: &mut Builder,
        predecessor: usize,
        successor: &Successor,
        resolve: Resolve,
    ) -> Becomes;

    /// The passes of a stage. `ignoring`: contexts look past some symbols.
    fn program(&self, stage: &Stage, layout: &Layout, ignoring: bool) -> Program;

    /// The symbols with which a word begins, as far as the rule file says.
    fn first_symbols(&self, axiom: &system::Axiom) -> Vec<usize>;

    /// What the words of a record are before its parameters, for messages.
    fn header(&self, layout: &Layout) -> Vec<&'static str>;
}

/// That of a system.
///
/// # Errors
/// A kind that this version does not derive, by name.
pub(in crate::plan) fn of(system: &System) -> Result<&'static dyn WordKind, Unsupported> {
    match system.kind {
        system::Kind::Patch { .. } => Ok(&patch::Patch),
        system::Kind::Curve(_) => Ok(&curve::Curve),
        system::Kind::Mesh => Err(Unsupported::new("mesh systems", system.source.kind_span)),
    }
}
