//! What this version derives. A system that uses more parses and checks, but is not run: the
//! construct is named, and nothing is derived in part.

use crate::language::Span;
use crate::language::expr::{Expr, ExprKind};

use crate::language::system::{Kind, Rule, Step, StepKind, Successor, System};

/// A construct that this version checks but does not derive.
#[derive(Clone, Debug, thiserror::Error)]
#[error("this version does not derive {construct}")]
pub struct Unsupported {
    /// What it is, as a noun phrase.
    pub construct: String,
    pub span: Span,
}

impl Unsupported {
    pub fn new(construct: impl Into<String>, span: Span) -> Unsupported {
        Unsupported { construct: construct.into(), span }
    }
}

/// The degree of a patch system that this version derives.
pub fn degree(system: &System) -> Result<[u8; 2], Unsupported> {
    let span = system.source.kind_span;
    let degree = match system.kind {
        Kind::Curve(_) => return Err(Unsupported::new("curve systems", span)),
        Kind::Mesh => return Err(Unsupported::new("mesh systems", span)),
        Kind::Patch { degree, .. } => degree,
    };
    steps(&system.run)?;
    Ok(degree)
}

fn steps(run: &[Step]) -> Result<(), Unsupported> {
    for step in run {
        match &step.kind {
            // That a placement stands last the checker has seen to.
            StepKind::Derive { .. } | StepKind::Place(_) => {}
            StepKind::Repeat { body, .. } | StepKind::If { body, .. } => steps(body)?,
            StepKind::Other(name) => {
                return Err(Unsupported::new(format!("`{name}` in a patch system"), step.span));
            }
        }
    }
    Ok(())
}

/// Whether every part of the rule is derived.
pub fn rule(rule: &Rule) -> Result<(), Unsupported> {
    if let Some(context) = rule.left.as_ref().or(rule.right.as_ref()) {
        return Err(Unsupported::new("contexts in patch systems", context.span));
    }
    if rule.strict.len() != 1 {
        return Err(Unsupported::new("several strict predecessors in patch systems", rule.span));
    }
    for alternative in &rule.alternatives {
        if let Successor::Modules(_) = alternative.successor {
            return Err(Unsupported::new("brackets in patch systems", alternative.span));
        }
        alternative.weight.iter().try_for_each(expr)?;
        modules(&alternative.successor, &mut |m| m.args.iter().try_for_each(expr))?;
    }
    let lets = rule.lets.iter().map(|l| &l.value);
    lets.chain(&rule.tests).chain(&rule.condition).try_for_each(expr)
}

fn modules(
    successor: &Successor,
    visit: &mut dyn FnMut(&crate::language::system::Module) -> Result<(), Unsupported>,
) -> Result<(), Unsupported> {
    use crate::language::system::{Block, Cell};
    fn block(
        b: &Block,
        visit: &mut dyn FnMut(&crate::language::system::Module) -> Result<(), Unsupported>,
    ) -> Result<(), Unsupported> {
        b.cells.iter().try_for_each(|c| match c {
            Cell::Eps => Ok(()),
            Cell::Module(m) => visit(m),
            Cell::Block(b) => block(b, visit),
        })
    }
    match successor {
        Successor::Erase => Ok(()),
        Successor::Relabel(m) => visit(m),
        Successor::Split(b) => block(b, visit),
        Successor::Modules(list) => list.iter().try_for_each(visit),
    }
}

/// Whether the expression is made of what this version evaluates.
fn expr(e: &Expr) -> Result<(), Unsupported> {
    let mut found = Ok(());
    e.walk(&mut |e| {
        if found.is_ok() {
            found = node(e);
        }
    });
    found
}

fn node(e: &Expr) -> Result<(), Unsupported> {
    let refuse = |what: String| Err(Unsupported::new(what, e.span));
    match &e.kind {
        ExprKind::Call(op, _) if op.row().name == "frame *" => {
            refuse(format!("`{}` in rules", op.row().name))
        }
        _ => Ok(()),
    }
}
