//! What an expression may see at the place where it stands.

use super::affine::Form;
use crate::language::expr::Expr;
use crate::language::syntax::Span;
use crate::language::system::{Binder, Kind, Let, PointField};
use crate::language::vocabulary::Owner;
use std::collections::HashMap;

/// The place of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Where {
    /// The value of a const.
    Const,
    /// The default or range of a param.
    Param,
    /// The axiom's arguments: only consts and params.
    Axiom,
    /// Counts and conditions of `run:`.
    Run,
    Rule,
    Query,
    Place,
    Mark,
    Crease,
}

impl Where {
    /// Whether attributes of that owner have a value here.
    pub fn sees(self, owner: Owner, kind: Kind, in_slot: bool) -> bool {
        let modules = match kind {
            Kind::Patch { .. } => owner == Owner::Patch,
            Kind::Mesh => owner == Owner::Face,
            Kind::Curve(_) => false,
        };
        match self {
            _ if owner == Owner::Slot => in_slot,
            Where::Const | Where::Param | Where::Axiom | Where::Run => false,
            Where::Rule | Where::Query => owner == Owner::Rule || modules,
            Where::Place if matches!(kind, Kind::Patch { .. }) => owner == Owner::Displacement,
            Where::Place => owner == Owner::Place,
            Where::Mark => owner == Owner::Face,
            Where::Crease => owner == Owner::Edge,
        }
    }

    /// Whether random numbers are drawn here.
    pub fn is_random(self) -> bool {
        matches!(self, Where::Rule | Where::Place | Where::Mark)
    }

    pub fn describe(self) -> &'static str {
        match self {
            Where::Const => "a const",
            Where::Param => "a param's default or range",
            Where::Axiom => "the axiom",
            Where::Run => "a count or condition of `run:`",
            Where::Rule => "a rule",
            Where::Query => "a query",
            Where::Place => "`place`",
            Where::Mark => "`mark`",
            Where::Crease => "`crease`",
        }
    }
}

/// A name bound in a rule.
#[derive(Clone, Copy, Debug)]
pub(super) enum Local {
    Binder(usize),
    Let(usize),
    /// Its meaning is broken and has been reported.
    Broken,
}

/// The names of one rule or other place, and what has been found in it so far.
#[derive(Debug)]
pub(super) struct Scope<'a> {
    pub place: Where,
    pub in_slot: bool,
    /// Inside a condition or weight: a float here decides.
    pub decides: bool,
    pub binders: Vec<Binder>,
    pub lets: Vec<Let>,
    pub tests: Vec<Expr>,
    pub locals: HashMap<&'a str, (Local, Span)>,
    /// Lets that are constant sums of points.
    pub forms: HashMap<&'a str, Form>,
    /// The fields of a curve's points. Where there are some, nothing else is bound.
    pub fields: Vec<PointField>,
    /// Calls of `rand` and `randn` so far, in the order of the text.
    pub sites: usize,
}

impl<'a> Scope<'a> {
    pub fn new(place: Where) -> Scope<'a> {
        Scope {
            place,
            in_slot: false,
            decides: false,
            binders: Vec::new(),
            lets: Vec::new(),
            tests: Vec::new(),
            locals: HashMap::new(),
            forms: HashMap::new(),
            fields: Vec::new(),
            sites: 0,
        }
    }
}
