//! What a derivation has made, read back. Each kind says what its words are: `src/plan/kind`.

use super::columns::Content;
use super::derive::{Backend, Derivation};
use super::{Error, Plan};
use crate::word::Symbol;
use std::sync::Arc;

/// A word, or several, as a derivation is read back.
pub trait Collected: Sized {
    /// What these chunks hold, in order, after so many steps; `words` are derived at once, or 0 where it is one alone.
    ///
    /// # Errors
    /// Where a device is not right.
    fn of(plan: &Plan, steps: u32, words: usize, chunks: Vec<Content>) -> Result<Self, Error>;
}

/// Reads what was derived: a [`patch::Word`](crate::patch::Word) from the axiom of a patch system, a
/// [`curve::Word`](crate::curve::Word) from that of a curve, and one for each of [`curve::Words`](crate::curve::Words).
///
/// # Errors
/// [`Error::Axiom`] for a backend of another plan than the one that derived it; what the backend says.
pub fn collect<W: Collected, B: Backend>(
    backend: &mut B,
    derivation: &Derivation<B::Chunk, W>,
) -> Result<W, B::Error> {
    let plan = backend.plan().clone();
    if !Arc::ptr_eq(&plan.tables, &derivation.tables) {
        let message = "a derivation is read by a backend of the plan that derived it; this one has another";
        return Err(Error::Axiom(message.to_string()).into());
    }
    let chunks = derivation.chunks.iter().map(|chunk| backend.read(chunk));
    let chunks = chunks.collect::<Result<_, B::Error>>()?;
    Ok(W::of(&plan, derivation.steps.len() as u32, derivation.words, chunks)?)
}

/// What chunks hold, one after the other.
pub(super) fn whole(chunks: Vec<Content>) -> Content {
    let mut content = Content::default();
    chunks.into_iter().for_each(|chunk| content.append(chunk));
    content
}

/// The symbols that a word may hold.
pub(super) fn symbols(plan: &Plan) -> Vec<Symbol> {
    let visible = plan.tables.symbols.iter().filter(|s| !s.hidden);
    visible.map(|s| Symbol { name: s.name.clone(), fields: s.fields.clone() }).collect()
}

/// Where the record of a module of this symbol holds its parameters.
pub(super) fn words_of(plan: &Plan, symbol: usize, module: usize) -> Result<&[usize], Error> {
    let table = plan.tables.symbols.get(symbol).filter(|s| !s.hidden);
    table.map(|table| &table.words[..]).ok_or_else(|| {
        Error::Value(format!("module {module} of the word has no symbol: the device is not right"), None)
    })
}
