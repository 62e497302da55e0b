//! What a derivation starts from: axioms as columns.

use super::collect::Collected;
use super::columns::Content;
use super::derive::Options;
use super::layout::{self, Layout, NONE};
use super::{Error, Plan, Settings};
use crate::language::eval;
use crate::language::expr::{Expr, Value};
use crate::{curve, patch};

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

impl Start for patch::Axiom {
    type Word = patch::Word;

    fn content(&self, plan: &Plan, values: &Settings, _: &[Settings]) -> Result<Content, Error> {
        plan.axiom(self, &values.uniforms)
    }
    fn roots(&self) -> usize {
        self.roots.len()
    }
    fn reads_params(&self) -> bool {
        self.roots.iter().any(|root| !root.args.is_empty())
    }
}

impl Start for curve::Words {
    type Word = Vec<curve::Word>;

    fn content(&self, plan: &Plan, _: &Settings, each: &[Settings]) -> Result<Content, Error> {
        let Layout { link: Some(link), word: Some(word), record_words, .. } = plan.tables.layout else {
            return Err(Error::Axiom("several words need a plan of words: Plan::of_words".to_string()));
        };
        let mut records: Vec<u32> = Vec::new();
        for (n, (start, values)) in self.words.iter().zip(each).enumerate() {
            let first = (records.len() / record_words) as u32;
            let at = records.len();
            records.extend(plan.curve_axiom(&start.axiom, &values.uniforms)?);
            for record in records[at..].chunks_exact_mut(record_words) {
                record[word] = n as u32;
                if record[link] & NONE != NONE {
                    record[link] += first;
                }
            }
        }
        Ok(Content::of_records(records))
    }
    fn roots(&self) -> usize {
        self.words.iter().map(|start| start.axiom.len()).sum()
    }
    fn reads_params(&self) -> bool {
        self.words.iter().any(|start| start.axiom.reads_params())
    }
    fn each(&self, plan: &Plan, options: &Options) -> Result<Vec<Settings>, Error> {
        let values = |start: &curve::Start| {
            let seed = start.seed.or(options.seed);
            match options.set.as_slice() {
                [] => plan.settings(&start.set, seed),
                // Of two values of a param the last holds.
                shared => plan.settings(&[shared, &start.set].concat(), seed),
            }
        };
        self.words.iter().map(values).collect()
    }
}

impl Start for curve::Axiom {
    type Word = curve::Word;

    fn content(&self, plan: &Plan, values: &Settings, _: &[Settings]) -> Result<Content, Error> {
        if plan.tables.layout.word.is_some() {
            return Err(Error::Axiom("a plan of words takes several of them: curve::Words".to_string()));
        }
        Ok(Content::of_records(plan.curve_axiom(self, &values.uniforms)?))
    }
    fn roots(&self) -> usize {
        self.len()
    }
    fn reads_params(&self) -> bool {
        self.parts
            .iter()
            .any(|part| part.shift.is_some() || part.modules.iter().any(|module| !module.args.is_empty()))
    }
}

impl Plan {
    /// The word of the axiom: each root a module.
    ///
    /// # Errors
    /// [`Error::Axiom`] for a net of another degree, or one that does not hold together
    /// ([`patch::Net::validate`]); [`Error::Value`] for an argument without a value.
    pub fn axiom(&self, axiom: &patch::Axiom, uniforms: &[Value]) -> Result<Content, Error> {
        let layout = &self.tables.layout;
        if layout.is_curve() {
            let message = format!("{} is a curve system, and begins with points, not nets", self.system.name);
            return Err(Error::Axiom(message));
        }
        let mut records = Vec::with_capacity(axiom.roots.len() * layout.record_words);
        let mut nets = Vec::with_capacity(axiom.roots.len() * layout.net_points());
        for (root, start) in axiom.roots.iter().enumerate() {
            if start.net.degree != layout.degree {
                let ([u, v], [m, n]) = (start.net.degree, layout.degree);
                return Err(Error::Axiom(format!(
                    "patch {root} of the axiom has degree {u}×{v}; {} rewrites nets of degree {m}×{n}",
                    self.system.name
                )));
            }
            start
                .net
                .validate(self.rational())
                .map_err(|e| Error::Axiom(format!("patch {root} of the axiom: {e}")))?;
            let mut record = vec![0u32; layout.record_words];
            layout::Header { symbol: start.symbol as u16, root: root as u32, ..Default::default() }
                .write(&mut record);
            self.write_root(start.symbol, &start.args, uniforms, &mut record)?;
            records.extend(record);
            nets.extend(&start.net.points);
        }
        Ok(Content::of_nets(records, nets))
    }

    /// Writes the parameters of a module of the axiom, which may be one of another system.
    fn write_root(
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
            let value = eval::eval(arg, uniforms)
                .map_err(|e| Error::Value(format!("axiom, argument of {}: {e}", symbol.name)))?;
            if value.ty() != field.ty {
                return Err(other());
            }
            let words = value.words();
            record[at..at + words.len()].copy_from_slice(&words);
        }
        Ok(())
    }

    /// The word of a curve's axiom as records.
    ///
    /// # Errors
    /// [`Error::Value`] for an argument without a value, or a float that is not finite; [`Error::Axiom`] for a part
    /// without a module.
    pub fn curve_axiom(&self, axiom: &curve::Axiom, uniforms: &[Value]) -> Result<Vec<u32>, Error> {
        let layout = &self.tables.layout;
        if !layout.is_curve() {
            let message = format!("{} is a patch system, and begins with nets, not points", self.system.name);
            return Err(Error::Axiom(message));
        }
        if axiom.is_empty() {
            return Err(Error::Axiom(format!("the axiom of {} has no module", self.system.name)));
        }
        let mut records = Vec::with_capacity(axiom.len() * layout.record_words);
        // What the next part hangs on.
        let mut axis = layout::NONE;
        for part in &axiom.parts {
            let n = part.modules.len();
            let first = (records.len() / layout.record_words) as u32;
            let shift = match &part.shift {
                None => 0,
                Some(e) => match eval::eval(e, uniforms).map_err(|e| Error::Value(format!("shift: {e}")))? {
                    Value::Int(by) if n > 0 => (by as i64).rem_euclid(n as i64) as usize,
                    _ => 0,
                },
            };
            for (at, root) in part.modules.iter().cycle().skip(shift).take(n).enumerate() {
                let mut record = vec![0u32; layout.record_words];
                record[0] = root.symbol as u32;
                if layout.has_paths() {
                    record[2] = (records.len() / layout.record_words) as u32;
                }
                if let Some(word) = layout.link {
                    // Only rings are shifted: each of their modules hangs on the one before.
                    let on = if shift > 0 { at.checked_sub(1) } else { root.hang.on };
                    let lateral = if root.hang.lateral { layout::LATERAL } else { 0 };
                    record[word] = on.map_or(axis, |on| first + on as u32) | lateral;
                }
                self.write_root(root.symbol, &root.args, uniforms, &mut record)?;
                records.extend(record);
            }
            axis = part.exit.map_or(axis, |exit| first + exit as u32);
        }
        if let (Some(word), true) = (layout.link, self.is_ring()) {
            records[word] = axis;
        }
        Ok(records)
    }
}
