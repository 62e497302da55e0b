//! What this version derives. A system that uses more parses and checks, but is not run: the
//! construct is named, and nothing is derived in part.

use super::kind::WordKind;
use crate::language::Span;
use crate::language::expr::{Expr, ExprKind};
use crate::language::system::{Rule, Step, StepKind, Successor, System};

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

/// Whether these steps of a schedule are derived in systems of this kind.
pub(super) fn steps(run: &[Step], kind: &dyn WordKind) -> Result<(), Unsupported> {
    for step in run {
        match &step.kind {
            // That a placement stands last the checker has seen to.
            StepKind::Derive { .. } | StepKind::Place(_) | StepKind::Trace { .. } => {}
            StepKind::Repeat { body, .. } | StepKind::If { body, .. } => steps(body, kind)?,
            other @ (StepKind::Subdivide { .. }
            | StepKind::Mark { .. }
            | StepKind::Crease { .. }
            | StepKind::Deposit) => {
                let (word, kind) = (other.word(), kind.name());
                return Err(Unsupported::new(format!("`{word}` in a {kind} system"), step.span));
            }
        }
    }
    Ok(())
}

/// The most modules of a successor.
pub const MOST_CELLS: usize = 255;

/// The most modules that one rule replaces.
pub const MOST_STRICT: usize = 8;

/// Whether every part of the rule is derived.
pub(super) fn rule(rule: &Rule, system: &System, kind: &dyn WordKind) -> Result<(), Unsupported> {
    kind.supports(rule, system)?;
    for alternative in &rule.alternatives {
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
        Successor::Word(word) => word.modules.iter().try_for_each(visit),
        // They are refused whole.
        Successor::Surface(_) | Successor::Face(_) => Ok(()),
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
