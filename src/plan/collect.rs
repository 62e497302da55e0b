//! What a derivation has made, read back as words.

use super::derive::{Backend, Derivation};
use super::layout::{Header, LATERAL, Layout, NONE};
use super::{Error, Plan};
use crate::language::expr::Value;
use crate::language::system::Kind;
use crate::{curve, patch};

/// Reads all chunks and puts the modules in the order of the derivation tree.
pub fn collect<B: Backend>(
    plan: &Plan,
    backend: &mut B,
    derivation: &Derivation<B::Chunk>,
) -> Result<patch::Word, B::Error> {
    let layout = plan.tables.layout;
    let (mut records, mut nets) = (Vec::new(), Vec::new());
    for chunk in &derivation.chunks {
        let (r, n) = backend.read(chunk)?;
        if records.is_empty() {
            (records, nets) = (r, n);
        } else {
            records.extend(r);
            nets.extend(n);
        }
    }
    Ok(word(plan, &layout, derivation.steps.len() as u32, &records, nets))
}

/// Reads several words that were derived at once; those of which nothing is left are empty.
pub fn collect_words<B: Backend>(
    plan: &Plan,
    backend: &mut B,
    derivation: &Derivation<B::Chunk>,
    count: usize,
) -> Result<Vec<curve::Word>, B::Error> {
    let layout = plan.tables.layout;
    let Some(at) = layout.word else {
        return Err(Error::Axiom("only a plan of words has several: Plan::of_words".to_string()).into());
    };
    let (mut all, mut first) = (vec![Vec::new(); count], vec![0; count]);
    for chunk in &derivation.chunks {
        let (records, _) = backend.read(chunk)?;
        for (n, record) in records.chunks_exact(layout.record_words).enumerate() {
            let word = record[at] as usize;
            let Some(own) = all.get_mut(word) else {
                let what = format!("module {n} is of no word: the device is not right");
                return Err(Error::Value(what).into());
            };
            if own.is_empty() {
                first[word] = n;
            }
            own.extend(record);
        }
    }
    let words = all
        .iter()
        .zip(first)
        .map(|(records, first)| curve_word(plan, derivation.steps.len(), records, first));
    Ok(words.collect::<Result<_, Error>>()?)
}

/// Reads all chunks of a curve's word.
pub fn collect_curve<B: Backend>(
    plan: &Plan,
    backend: &mut B,
    derivation: &Derivation<B::Chunk>,
) -> Result<curve::Word, B::Error> {
    let mut records = Vec::new();
    for chunk in &derivation.chunks {
        let (read, _) = backend.read(chunk)?;
        if records.is_empty() {
            records = read;
        } else {
            records.extend(read);
        }
    }
    Ok(curve_word(plan, derivation.steps.len(), &records, 0)?)
}

/// The word of these records, the first of which others hang on by the number `first`.
fn curve_word(plan: &Plan, steps: usize, records: &[u32], first: usize) -> Result<curve::Word, Error> {
    let layout = plan.tables.layout;
    let Kind::Curve(topology) = plan.system.kind else {
        return Err(Error::Axiom(format!("{} is no curve system", plan.system.name)));
    };
    let module = |(at, record): (usize, &[u32])| {
        let symbol = (record[0] & 0xffff) as usize;
        let Some(table) = plan.tables.symbols.get(symbol) else {
            return Err(Error::Value(format!(
                "module {at} of the word has no symbol: the device is not right"
            )));
        };
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
    let symbols = plan.tables.symbols.iter();
    Ok(curve::Word {
        system: plan.system.name.clone(),
        steps: steps as u32,
        topology,
        symbols: symbols.map(|s| patch::Symbol { name: s.name.clone(), fields: s.fields.clone() }).collect(),
        modules: modules.collect::<Result<_, _>>()?,
    })
}

/// The word of these modules, in the order of the derivation tree.
pub fn word(plan: &Plan, layout: &Layout, steps: u32, records: &[u32], nets: Vec<[f32; 4]>) -> patch::Word {
    let headers: Vec<Header> = records.chunks_exact(layout.record_words).map(Header::read).collect();
    let place = |h: &Header| (h.root, h.key);
    let sorted = headers.is_sorted_by_key(place);
    let mut order: Vec<u32> = (0..headers.len() as u32).collect();
    if !sorted {
        order.sort_unstable_by_key(|&i| place(&headers[i as usize]));
    }
    let module = |&i: &u32| {
        let header = &headers[i as usize];
        let symbol = &plan.tables.symbols[header.symbol as usize];
        let record = &records[i as usize * layout.record_words..][..layout.record_words];
        let params = symbol.fields.iter().zip(&symbol.words);
        patch::Module {
            symbol: header.symbol as usize,
            params: params.map(|(f, &at)| Value::from_words(&f.ty, &record[at..])).collect(),
            root: header.root,
            key: header.key,
            cell: header.cell,
        }
    };
    let points = layout.net_points();
    let modules = order.iter().map(module).collect();
    let nets = if sorted {
        nets
    } else {
        order.iter().flat_map(|&i| &nets[i as usize * points..][..points]).copied().collect()
    };
    let visible = plan.tables.symbols.iter().filter(|s| !s.hidden);
    patch::Word {
        system: plan.system.name.clone(),
        steps,
        symbols: visible.map(|s| patch::Symbol { name: s.name.clone(), fields: s.fields.clone() }).collect(),
        degree: layout.degree,
        rational: plan.rational(),
        modules,
        nets,
    }
}
