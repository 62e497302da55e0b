//! What a derivation starts from. Each kind says how its axiom becomes columns: `src/plan/kind`.

use super::collect::Collected;
use super::columns::Content;
use super::derive::Options;
use super::{Error, Plan, Settings};
use crate::language::eval;
use crate::language::expr::{Expr, Value};

/// What a derivation starts from: the axiom of a patch system or of a curve, or several words at once. It also says what
/// is read back, so that a word of one kind is never taken for one of another.
pub trait Start {
    /// What [`collect`](super::derive::collect) makes of it.
    type Word: Collected;

    /// Its modules; `each` is what [`Start::each`] says.
    ///
    /// # Errors
    /// Where they do not fit the plan, or an argument has no value.
    fn content(&self, plan: &Plan, values: &Settings, each: &[Settings]) -> Result<Content, Error>;
    /// Roots, each of which may be bound a value of its own.
    fn roots(&self) -> usize;
    /// Whether other params make other modules.
    fn reads_params(&self) -> bool;
    /// Of several words at once what each runs with; else none.
    ///
    /// # Errors
    /// As [`Plan::settings`].
    fn each(&self, _: &Plan, _: &Options) -> Result<Vec<Settings>, Error> {
        Ok(Vec::new())
    }
}

impl Plan {
    /// Writes the parameters of a module of the axiom, which may be one of another system.
    pub(super) fn write_root(
        &self,
        symbol: usize,
        args: &[Expr],
        uniforms: &[Value],
        record: &mut [u32],
    ) -> Result<(), Error> {
        let other = || {
            let name = &self.system.name;
            Error::Axiom(format!("the axiom is of another system: its modules are none of {name}"))
        };
        let symbol = self.tables.symbols.get(symbol).ok_or_else(other)?;
        if symbol.hidden || args.len() != symbol.fields.len() {
            return Err(other());
        }
        for ((arg, field), &at) in args.iter().zip(&symbol.fields).zip(&symbol.words) {
            let value = eval::eval(arg, uniforms).map_err(|e| {
                Error::Value(format!("axiom, argument of {}: {e}", symbol.name), Some(arg.span))
            })?;
            if value.ty() != field.ty {
                return Err(other());
            }
            let words = value.words();
            record[at..at + words.len()].copy_from_slice(&words);
        }
        Ok(())
    }
}
