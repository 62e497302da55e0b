//! The `run:` block, its counts read: a flat list of acts.

use super::tables::RulesOf;
use super::{Error, Plan, Settings};
use crate::language::expr::{Expr, Value};
use crate::language::system::{Step, StepKind};
use crate::language::{Span, eval};

/// One act of the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// `derive`: steps of the system's rules.
    Rewrite(Rewrite),
    /// `trace`: one step of rules that the tables hold for it, after which a word without modules is the point, of the
    /// symbol `into`, at which its turtle starts.
    Trace { by: Rewrite, into: usize },
}

impl Act {
    /// The steps that it takes.
    pub fn rewrite(&self) -> &Rewrite {
        match self {
            Act::Rewrite(rewrite) | Act::Trace { by: rewrite, .. } => rewrite,
        }
    }
}

/// Steps of one rule set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rewrite {
    /// Index into [`Tables::rule_sets`](super::Tables::rule_sets).
    pub rule_set: usize,
    /// Steps; the most there may be with `until_terminal`.
    pub count: u32,
    /// Ends before the first step in which no rule fires.
    pub until_terminal: bool,
    /// The step of `run:`.
    pub span: Span,
}

/// Acts a schedule may unroll to, and steps one of them may ask for.
pub const MOST_ACTS: usize = 1 << 16;
pub const MOST_STEPS: u32 = 1_000_000;

/// Unrolls `repeat` and `if` with the values of the uniforms.
pub fn unroll(plan: &Plan, uniforms: &[Value]) -> Result<Vec<Act>, Error> {
    let mut list = Vec::new();
    let mut turns = 0;
    for step in &plan.system.run {
        steps(plan, uniforms, std::slice::from_ref(step), &mut list, &mut turns).map_err(|e| match e {
            // It is the outermost `repeat` that has too many.
            Error::Value(message, None) => Error::Value(message, Some(step.span)),
            e => e,
        })?;
    }
    Ok(list)
}

/// The one schedule of several words.
///
/// # Errors
/// Also where a word, counted from 0, has another one than the first.
pub fn of_all(plan: &Plan, first: &Settings, others: &[Settings]) -> Result<Vec<Act>, Error> {
    let list = unroll(plan, &first.uniforms)?;
    for (n, values) in others.iter().enumerate() {
        if unroll(plan, &values.uniforms)? != list {
            let n = n + 1;
            let message = format!(
                "word {n} has another schedule than word 0: the params in the counts of `run:` must be the same"
            );
            return Err(Error::Value(message, plan.system.run.first().map(|step| step.span)));
        }
    }
    Ok(list)
}

fn steps(
    plan: &Plan,
    uniforms: &[Value],
    run: &[Step],
    list: &mut Vec<Act>,
    turns: &mut usize,
) -> Result<(), Error> {
    for step in run {
        *turns += 1;
        if *turns > MOST_ACTS {
            let message = format!("the schedule unrolls to more than {MOST_ACTS} steps of `run:`");
            return Err(Error::Value(message, None));
        }
        match &step.kind {
            StepKind::Derive { count, until_terminal, groups } => {
                let count = number(count, uniforms, "derive")?;
                let rule_set = rule_set(plan, &RulesOf::Groups(groups.clone()))?;
                let until_terminal = *until_terminal;
                list.push(Act::Rewrite(Rewrite { rule_set, count, until_terminal, span: step.span }));
            }
            StepKind::Trace { into } => {
                let rule_set = rule_set(plan, &RulesOf::Trace(*into))?;
                let by = Rewrite { rule_set, count: 1, until_terminal: false, span: step.span };
                list.push(Act::Trace { by, into: *into });
            }
            StepKind::Repeat { count, body } => {
                for _ in 0..number(count, uniforms, "repeat")? {
                    steps(plan, uniforms, body, list, turns)?;
                }
            }
            StepKind::If { condition, body } => {
                if value(condition, uniforms)? == Value::Bool(true) {
                    steps(plan, uniforms, body, list, turns)?;
                }
            }
            // It moves the vertices of a tessellation; the word stays as it is.
            StepKind::Place(_) => {}
            other @ (StepKind::Subdivide { .. }
            | StepKind::Mark { .. }
            | StepKind::Crease { .. }
            | StepKind::Deposit) => {
                return Err(super::Unsupported::new(format!("`{}`", other.word()), step.span).into());
            }
        }
    }
    Ok(())
}

fn rule_set(plan: &Plan, of: &RulesOf) -> Result<usize, Error> {
    plan.tables.rule_set(of).ok_or_else(|| {
        Error::Value("a derive of the schedule names rules that were not compiled".to_string(), None)
    })
}

fn number(e: &Expr, uniforms: &[Value], what: &str) -> Result<u32, Error> {
    let wrong = |message: String| Err(Error::Value(message, Some(e.span)));
    match value(e, uniforms)? {
        Value::Int(n) if n >= 0 && n as u32 <= MOST_STEPS => Ok(n as u32),
        Value::Int(n) => wrong(format!("`{what} {n}`: the count lies outside 0 .. {MOST_STEPS}")),
        other => wrong(format!("`{what}`: the count is of type {}, not int", other.ty())),
    }
}

fn value(e: &Expr, uniforms: &[Value]) -> Result<Value, Error> {
    eval::eval(e, uniforms).map_err(|why| Error::Value(format!("run: {why}"), Some(e.span)))
}
