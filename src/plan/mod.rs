//! What will run: layout, rule tables, schedule, growth, and the derivation itself.
//!
//! Start with [`layout`] (what a module is in memory), then [`step`] (one step, written once).

pub mod bound;
pub mod code;
pub mod compare;
pub mod context;
pub mod derive;
pub mod edges;
pub mod given;
pub mod graph;
pub mod holes;
pub mod layout;
pub mod links;
pub mod measure;
pub mod placement;
pub mod schedule;
pub mod size;
pub mod step;
pub mod supported;
pub mod tables;
pub mod turns;
pub mod turtle;

use crate::language::expr::Value;
use crate::language::system::{Kind, System, Topology, UniformKind};
use crate::language::{Type, eval};
use crate::{curve, patch};
use std::sync::Arc;

pub use derive::{Backend, Derivation, Options, Progress};
pub use given::{Given, View};
pub use placement::{Displacement, Placement};
pub use supported::Unsupported;
pub use tables::Tables;

/// Why a derivation could not be planned or carried out, whatever the backend.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    /// A value of `set` does not fit.
    #[error("{0}")]
    Set(String),
    /// What is bound to a query does not fit it.
    #[error("{0}")]
    Bind(String),
    /// An attribute of the screen, and no view.
    #[error("the rules read `{attribute}`, which is seen through a view, and none is given")]
    View { attribute: &'static str },
    /// An expression of the axiom or the schedule has no value.
    #[error("{0}")]
    Value(String),
    /// The axiom and the system do not fit together.
    #[error("{0}")]
    Axiom(String),
    #[error(
        "the word would hold at least {needed} bytes ({modules} modules) after step {step}; \
         the memory budget is {budget} bytes: derive fewer steps or raise it"
    )]
    Memory { needed: u64, modules: u64, step: u32, budget: u64 },
    /// A word with branches, or with symbols that contexts ignore, is one buffer.
    #[error(
        "the word would hold {modules} modules after step {step}; with branches or `ignore` it is one buffer, which holds {most}"
    )]
    TooLong { modules: u64, most: u64, step: u32 },
    #[error(
        "a net was halved more than {} times along one direction, more than an address can hold (step {step})",
        layout::MAX_HALVINGS
    )]
    TooDeep { step: u32 },
    #[error("the derivation was stopped after {steps} steps")]
    Stopped { steps: u32 },
}

/// A system made ready for any backend.
#[derive(Clone, Debug)]
pub struct Plan {
    pub system: Arc<System>,
    pub tables: Tables,
    /// The symbol of erased cells, where they are kept.
    pub hole: Option<usize>,
    /// The `place` that ends the run: what a tessellation of the word is displaced by. The word is the same
    /// with it or without.
    pub placement: Option<Placement>,
}

impl Plan {
    /// Builds the tables, or names what this version does not derive.
    pub fn new(system: &System) -> Result<Plan, Unsupported> {
        Ok(Plan {
            tables: Tables::new(system)?,
            placement: Placement::new(system)?,
            system: Arc::new(system.clone()),
            hole: None,
        })
    }

    /// The same with erased cells kept in the word, as modules of the symbol [`Plan::hole`]: what a
    /// tessellation of the word wants. All other modules are the same.
    pub fn keeping_holes(system: &System) -> Result<Plan, Unsupported> {
        let (system, hole) = holes::kept(system);
        Ok(Plan { hole: Some(hole), ..Plan::new(&system)? })
    }

    /// The same for several independent words of a curve system at once ([`curve::Words`]).
    ///
    /// # Errors
    /// Also where the system is none of curves.
    pub fn of_words(system: &System) -> Result<Plan, Unsupported> {
        if !matches!(system.kind, Kind::Curve(_)) {
            return Err(Unsupported::new(
                "several words of a system without curves",
                system.source.kind_span,
            ));
        }
        Ok(Plan {
            tables: Tables::of_words(system)?,
            placement: None,
            system: Arc::new(system.clone()),
            hole: None,
        })
    }

    /// Whether control points have weights.
    pub fn rational(&self) -> bool {
        matches!(self.system.kind, Kind::Patch { rational: true, .. })
    }

    /// The values of all uniforms: the params' defaults, replaced by `set`, and what derives from them.
    ///
    /// # Errors
    /// [`Error::Set`] for a name that is no param, a value of another type, or one out of its range.
    pub fn uniforms(&self, set: &[(String, Value)]) -> Result<Vec<Value>, Error> {
        uniforms(&self.system, set)
    }

    /// What random numbers begin with: the param `seed`, if the system has one of type int, else 0.
    pub fn seed(&self, set: &[(String, Value)]) -> u32 {
        let values = self.uniforms(set).unwrap_or_default();
        let named = self.system.uniforms.iter().zip(values).find(|(u, _)| u.name == "seed");
        match named {
            Some((_, Value::Int(seed))) => seed as u32,
            _ => 0,
        }
    }

    /// The environment buffer of a stage: the uniforms' words, what the host gives, the constants of
    /// the stage's expressions, then from a multiple of four the rule table.
    pub fn environment(&self, stage: &tables::Stage, uniforms: &[Value], given: &Given) -> Vec<u32> {
        let mut words: Vec<u32> = uniforms.iter().flat_map(Value::words).collect();
        words.resize(self.tables.given.view(), 0);
        words.extend(&given.environment);
        words.resize(stage.code.constants.base, 0);
        words.extend(&stage.code.constants.words);
        words.resize(words.len().next_multiple_of(4), 0);
        words.extend(stage.rule_words());
        words.resize(words.len().next_multiple_of(4), 0);
        words
    }

    /// The word of the axiom as records and nets: each root a module.
    ///
    /// # Errors
    /// [`Error::Axiom`] for a net of another degree, or one that does not hold together
    /// ([`patch::Net::validate`]); [`Error::Value`] for an argument without a value.
    pub fn axiom(&self, axiom: &patch::Axiom, uniforms: &[Value]) -> Result<derive::Modules, Error> {
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
            let symbol = &self.tables.symbols[start.symbol];
            for (arg, &at) in start.args.iter().zip(&symbol.words) {
                let value = eval::eval(arg, uniforms)
                    .map_err(|e| Error::Value(format!("axiom, argument of {}: {e}", symbol.name)))?;
                for (n, word) in value.words().into_iter().enumerate() {
                    record[at + n] = word;
                }
            }
            records.extend(record);
            nets.extend(&start.net.points);
        }
        Ok((records, nets))
    }
}

impl Plan {
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
                let symbol = &self.tables.symbols[root.symbol];
                for (arg, &at) in root.args.iter().zip(&symbol.words) {
                    let value = eval::eval(arg, uniforms)
                        .map_err(|e| Error::Value(format!("axiom, argument of {}: {e}", symbol.name)))?;
                    let words = value.words();
                    record[at..at + words.len()].copy_from_slice(&words);
                }
                records.extend(record);
            }
            axis = part.exit.map_or(axis, |exit| first + exit as u32);
        }
        if let (Some(word), Kind::Curve(Topology::Ring)) = (layout.link, self.system.kind) {
            records[word] = axis;
        }
        Ok(records)
    }
}

/// See [`Plan::uniforms`].
fn uniforms(system: &System, set: &[(String, Value)]) -> Result<Vec<Value>, Error> {
    for (name, _) in set {
        if !system.uniforms.iter().any(|u| u.name == *name && u.is_param()) {
            return Err(Error::Set(no_such_param(system, name)));
        }
    }
    let mut values: Vec<Value> = Vec::with_capacity(system.uniforms.len());
    for uniform in &system.uniforms {
        let value = match &uniform.kind {
            UniformKind::Derived(e) => {
                eval::eval(e, &values).map_err(|e| Error::Value(format!("const {}: {e}", uniform.name)))?
            }
            UniformKind::Param { default, range } => {
                match set.iter().rev().find(|(name, _)| *name == uniform.name) {
                    None => default.clone(),
                    Some((_, value)) => fit(&uniform.name, &uniform.ty, value, range.as_ref())?,
                }
            }
        };
        values.push(value);
    }
    Ok(values)
}

fn no_such_param(system: &System, name: &str) -> String {
    let params: Vec<&str> =
        system.uniforms.iter().filter(|u| u.is_param()).map(|u| u.name.as_str()).collect();
    match params.as_slice() {
        [] => format!("`{name}` cannot be set: the system {} has no params", system.name),
        list => format!("`{name}` is no param of {}; it has {}", system.name, list.join(", ")),
    }
}

/// The value as the param's type, within its range.
fn fit(name: &str, ty: &Type, value: &Value, range: Option<&(Value, Value)>) -> Result<Value, Error> {
    let value = match (ty, value) {
        (Type::Float, Value::Int(i)) => Value::Float(*i as f32),
        (ty, value) if value.ty() == *ty => value.clone(),
        (ty, value) => return Err(Error::Set(format!("param {name} is of type {ty}, not {}", value.ty()))),
    };
    let inside = |low: &Value, high: &Value| match (&value, low, high) {
        (Value::Int(v), Value::Int(l), Value::Int(h)) => l <= v && v <= h,
        (Value::Float(v), Value::Float(l), Value::Float(h)) => l <= v && v <= h,
        _ => true,
    };
    match range {
        Some((low, high)) if !inside(low, high) => {
            let (low, high) = (show(low), show(high));
            Err(Error::Set(format!("param {name} = {} lies outside {low} .. {high}", show(&value))))
        }
        _ => Ok(value),
    }
}

fn show(value: &Value) -> String {
    match value {
        Value::Int(i) => i.to_string(),
        Value::Float(x) => x.to_string(),
        Value::Bool(b) => b.to_string(),
        other => format!("{other:?}"),
    }
}
