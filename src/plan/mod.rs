//! What will run: layout, rule tables, schedule, growth, and the derivation itself.
//!
//! Start with [`layout`] (what a module is in memory), then [`step`] (one step, written once).

pub mod bound;
pub mod certain;
pub mod code;
pub mod collect;
pub mod columns;
pub mod compare;
pub mod context;
pub mod derive;
pub mod edges;
pub mod given;
pub mod graph;
pub mod holes;
mod kind;
pub mod layout;
pub mod links;
pub mod measure;
pub mod placement;
pub mod program;
mod ranges;
pub mod schedule;
pub mod size;
pub mod start;
pub mod step;
pub mod supported;
pub mod tables;
pub mod turns;
pub mod turtle;

use crate::language::expr::Value;
use crate::language::system::{Kind, System, UniformKind};
use crate::language::{Span, Type, eval};
use std::sync::Arc;

pub use columns::{Content, Domain, Stored};
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
    /// An expression of the axiom or the schedule has no value, or one that is out of range; and where it stands, if it
    /// stands somewhere.
    #[error("{0}")]
    Value(String, Option<Span>),
    /// The axiom and the system do not fit together.
    #[error("{0}")]
    Axiom(String),
    #[error(
        "the word would hold at least {needed} bytes ({modules} modules) after step {step}; \
         the memory budget is {budget} bytes: derive fewer steps or raise it"
    )]
    Memory { needed: u64, modules: u64, step: u32, budget: u64 },
    /// The same, at a step of a `derive until terminal`, where that makes the word so large since nothing ever ends it.
    #[error(
        "this never becomes terminal: `{symbol}` is rewritten in every step, and leads to `{symbol}` again; \
         step {step} of the derive would need at least {needed} bytes ({modules} modules), the memory budget is {budget} bytes"
    )]
    Endless { symbol: String, rule: Span, derive: Span, needed: u64, modules: u64, step: u32, budget: u64 },
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

/// A system made ready for any backend. A clone shares the tables.
#[derive(Clone, Debug)]
pub struct Plan {
    pub system: Arc<System>,
    pub tables: Arc<Tables>,
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
            tables: Arc::new(Tables::new(system)?),
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

    /// The same for several independent words of a curve system at once ([`Words`](crate::curve::Words)).
    ///
    /// # Errors
    /// Also where the system is none of curves, or has `until terminal` beside random numbers or `step`: alone, each word
    /// would end after steps of its own.
    pub fn of_words(system: &System) -> Result<Plan, Unsupported> {
        if !matches!(system.kind, Kind::Curve(_)) {
            return Err(Unsupported::new(
                "several words of a system without curves",
                system.source.kind_span,
            ));
        }
        Ok(Plan {
            tables: Arc::new(Tables::of_words(system)?),
            placement: None,
            system: Arc::new(system.clone()),
            hole: None,
        })
    }

    /// All stages.
    pub fn stages(&self) -> Vec<derive::StageId> {
        let sets = self.tables.rule_sets.iter().enumerate();
        let of_set = |(rule_set, set): (usize, &tables::RuleSet)| {
            (0..set.stages.len()).map(move |stage| derive::StageId { rule_set, stage })
        };
        sets.flat_map(of_set).collect()
    }

    /// Whether the last module of a curve is followed by the first.
    pub fn is_ring(&self) -> bool {
        self.tables.layout.ring
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

    /// What a backend begins with. Where a const has no value with these, the derivation says so that binds them.
    pub(crate) fn defaults(&self) -> Vec<Value> {
        self.uniforms(&[]).unwrap_or_default()
    }

    /// A `derive until terminal` that begins the run and makes all its steps, whatever the params are: the rule that
    /// fires in each of them, and the derive.
    pub fn without_end(&self) -> Option<(Span, Span)> {
        let first = *schedule::unroll(self, &self.defaults()).ok()?.first()?.rewrite();
        let axiom = self.tables.kind.first_symbols(&self.system.axiom);
        let rule = size::without_end(&self.tables, first.rule_set, &axiom)?;
        (first.until_terminal && first.count > 0).then_some((rule, first.span))
    }

    /// What a derivation with these params runs with; without a seed of its own the one that the params say.
    ///
    /// # Errors
    /// As [`Plan::uniforms`].
    pub fn settings(&self, set: &[(String, Value)], seed: Option<u32>) -> Result<Settings, Error> {
        Settings::new(&self.system, set, seed)
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
}

/// What a derivation runs with, beside what is bound and seen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Of all uniforms: see [`Plan::uniforms`].
    pub uniforms: Vec<Value>,
    /// What random numbers begin with.
    pub seed: u32,
}

impl Settings {
    /// See [`Plan::settings`].
    fn new(system: &System, set: &[(String, Value)], seed: Option<u32>) -> Result<Settings, Error> {
        let uniforms = uniforms(system, set)?;
        let named = system.uniforms.iter().zip(&uniforms).find(|(uniform, _)| uniform.name == "seed");
        let seed = seed.unwrap_or(match named {
            Some((_, Value::Int(seed))) => *seed as u32,
            _ => 0,
        });
        Ok(Settings { uniforms, seed })
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
            UniformKind::Derived(e) => eval::eval(e, &values)
                .map_err(|e| Error::Value(format!("const {}: {e}", uniform.name), Some(uniform.span)))?,
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
    let params: Vec<&str> = system.params().map(|param| param.name).collect();
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
            Err(Error::Set(format!("param {name} = {value} lies outside {low} .. {high}")))
        }
        _ => Ok(value),
    }
}
