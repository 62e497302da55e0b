//! What a derivation has made, read back as words.

use super::columns::Content;
use super::derive::{Backend, Derivation};
use super::layout::{Header, LATERAL, NONE};
use super::tables::Symbol;
use super::{Error, Plan};
use crate::language::expr::Value;
use crate::language::system::Kind;
use crate::{curve, patch};
use std::sync::Arc;

/// A word, or several, as a derivation is read back.
pub trait Collected: Sized {
    /// What these chunks hold, in order, after so many steps; `words` are derived at once, or 0 where it is one alone.
    ///
    /// # Errors
    /// Where a device is not right.
    fn of(plan: &Plan, steps: u32, words: usize, chunks: Vec<Content>) -> Result<Self, Error>;
}

/// Reads what was derived: a [`patch::Word`] from the axiom of a patch system, a [`curve::Word`] from that of a curve,
/// and one for each of [`curve::Words`].
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

/// Modules in the order of the derivation tree.
impl Collected for patch::Word {
    fn of(plan: &Plan, steps: u32, _: usize, chunks: Vec<Content>) -> Result<Self, Error> {
        word(plan, steps, whole(chunks))
    }
}

/// In their order; those of which nothing is left are empty.
impl Collected for Vec<curve::Word> {
    fn of(plan: &Plan, steps: u32, words: usize, chunks: Vec<Content>) -> Result<Self, Error> {
        let layout = plan.tables.layout;
        let Some(at) = layout.word else { return Ok(vec![]) };
        let (mut all, mut first) = (vec![Vec::new(); words], vec![0; words]);
        for content in chunks {
            for (n, record) in content.records().chunks_exact(layout.record_words).enumerate() {
                let word = record[at] as usize;
                let Some(own) = all.get_mut(word) else {
                    let what = format!("module {n} is of no word: the device is not right");
                    return Err(Error::Value(what));
                };
                if own.is_empty() {
                    first[word] = n;
                }
                own.extend(record);
            }
        }
        all.iter().zip(first).map(|(records, first)| curve_word(plan, steps, records, first)).collect()
    }
}

impl Collected for curve::Word {
    fn of(plan: &Plan, steps: u32, _: usize, chunks: Vec<Content>) -> Result<Self, Error> {
        curve_word(plan, steps, whole(chunks).records(), 0)
    }
}

/// What chunks hold, one after the other.
fn whole(chunks: Vec<Content>) -> Content {
    let mut content = Content::default();
    chunks.into_iter().for_each(|chunk| content.append(chunk));
    content
}

/// The word of these records, the first of which others hang on by the number `first`.
fn curve_word(plan: &Plan, steps: u32, records: &[u32], first: usize) -> Result<curve::Word, Error> {
    let layout = plan.tables.layout;
    let Kind::Curve(topology) = plan.system.kind else {
        return Err(Error::Axiom(format!("{} is no curve system", plan.system.name)));
    };
    let module = |(at, record): (usize, &[u32])| {
        let symbol = (record[0] & 0xffff) as usize;
        let table = table_of(plan, symbol, at)?;
        let (parent, lateral) = match layout.link.map(|word| record[word]) {
            None => (at.checked_sub(1), false),
            Some(link) => {
                let parent = ((link & NONE) as usize).checked_sub(first);
                (parent.filter(|&parent| parent < at), link & LATERAL != 0)
            }
        };
        let params = table.fields.iter().zip(&table.words);
        Ok(curve::Module {
            symbol,
            params: params.map(|(f, &at)| Value::from_words(&f.ty, &record[at..])).collect(),
            path: if layout.has_paths() { u64::from(record[1]) << 32 | u64::from(record[2]) } else { 0 },
            parent,
            lateral,
        })
    };
    let modules = records.chunks_exact(layout.record_words).enumerate().map(module);
    let modules = modules.collect::<Result<_, Error>>()?;
    let symbols = plan.tables.symbols.iter();
    Ok(curve::Word {
        system: plan.system.name.clone(),
        steps,
        topology,
        symbols: symbols.map(|s| patch::Symbol { name: s.name.clone(), fields: s.fields.clone() }).collect(),
        modules,
    })
}

/// The symbol of a module of the word.
fn table_of(plan: &Plan, symbol: usize, module: usize) -> Result<&Symbol, Error> {
    plan.tables.symbols.get(symbol).ok_or_else(|| {
        Error::Value(format!("module {module} of the word has no symbol: the device is not right"))
    })
}

/// The word of these modules, in the order of the derivation tree.
fn word(plan: &Plan, steps: u32, content: Content) -> Result<patch::Word, Error> {
    let layout = &plan.tables.layout;
    let records = content.records();
    let headers: Vec<Header> = records.chunks_exact(layout.record_words).map(Header::read).collect();
    let place = |h: &Header| (h.root, h.key);
    let sorted = headers.is_sorted_by_key(place);
    let mut order: Vec<u32> = (0..headers.len() as u32).collect();
    if !sorted {
        order.sort_unstable_by_key(|&i| place(&headers[i as usize]));
    }
    let module = |&i: &u32| {
        let header = &headers[i as usize];
        let symbol = table_of(plan, header.symbol as usize, i as usize)?;
        let record = &records[i as usize * layout.record_words..][..layout.record_words];
        let params = symbol.fields.iter().zip(&symbol.words);
        Ok(patch::Module {
            symbol: header.symbol as usize,
            params: params.map(|(f, &at)| Value::from_words(&f.ty, &record[at..])).collect(),
            root: header.root,
            key: header.key,
            cell: header.cell,
        })
    };
    let modules = order.iter().map(module).collect::<Result<_, Error>>()?;
    let points = layout.net_points();
    let net = |&i: &u32| &content.nets()[i as usize * points..][..points];
    let nets = match sorted {
        false => order.iter().flat_map(net).copied().collect(),
        true => content.into_nets(),
    };
    let visible = plan.tables.symbols.iter().filter(|s| !s.hidden);
    Ok(patch::Word {
        system: plan.system.name.clone(),
        steps,
        symbols: visible.map(|s| patch::Symbol { name: s.name.clone(), fields: s.fields.clone() }).collect(),
        degree: layout.degree,
        rational: plan.rational(),
        modules,
        nets,
    })
}
