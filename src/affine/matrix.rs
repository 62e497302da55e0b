//! The subdivision matrix of a group of rules: new points over old ones, one row a new point.

use super::Error;
use super::form::Row;
use super::number::Number;
use super::properties::Scheme;
use super::word::{self, Context, point_field};
use crate::language::expr::{Expr, Value};
use crate::language::system::{Kind, Step, StepKind, System, Topology};
use crate::plan::Plan;

/// A sparse matrix.
#[derive(Clone, Debug)]
pub struct Matrix {
    pub columns: usize,
    pub rows: Vec<Row>,
}

impl Matrix {
    /// The entry of a row and a column, from 0.
    pub fn get(&self, row: usize, column: usize) -> Number {
        let entries = &self.rows[row];
        entries.binary_search_by_key(&(column as u32), |e| e.0).map_or(Number::ZERO, |n| entries[n].1)
    }

    /// Whether row r + `height` is row r moved `width` columns on, around the end; if not, the first row and column where
    /// it is not, from 0.
    pub fn repeats(&self, height: usize, width: usize) -> Result<(), (usize, usize)> {
        let (n, m) = (self.rows.len(), self.columns);
        for row in 0..n {
            let next = (row + height) % n;
            let moved = |column: usize| self.get(row, (column + m - width % m) % m);
            if let Some(column) = (0..m).find(|&c| !self.get(next, c).is(moved(c))) {
                return Err((next, column));
            }
        }
        Ok(())
    }
}

/// The rules of some groups of a curve system, with values for its params.
pub struct Rules {
    plan: Plan,
    values: Vec<Value>,
    symbol: usize,
}

/// Modules that a matrix is made of at most.
const MOST: usize = 1 << 20;

/// Points of the ring on which a rule's period is looked for: a multiple of any number of predecessors, and far wider than
/// what a rule sees.
const WIDE: usize = 840;

impl Rules {
    /// The rules of these groups, in order of priority; where none is named those of the unnamed one, or of the first
    /// `derive`.
    ///
    /// # Errors
    /// A system that is no curve, that this version does not derive, or without rules on a module with a point; an unknown
    /// group; a param that cannot be set so.
    pub fn new(system: &System, with: &[&str], set: &[(String, Value)]) -> Result<Rules, Error> {
        if !matches!(system.kind, Kind::Curve(_)) {
            return Err(word::no_curve(system));
        }
        let groups = groups(system, with)?;
        let rules = groups.iter().flat_map(|&g| &system.groups[g].rules);
        let mut symbols = rules.filter_map(|rule| rule.strict.first());
        let has_point = |s: &&usize| point_field(&system.symbols[**s].fields).is_some();
        let Some(&symbol) = symbols.find(has_point) else {
            let message =
                format!("no rule of {} rewrites a module with a point (a vec2, vec3 or vec4)", system.name);
            return Err(Error::Rules(message));
        };
        let span = system.source.name.span;
        let count = Expr::literal(Value::Int(1), span);
        let derive = StepKind::Derive { count, until_terminal: false, groups };
        let plan = Plan::new(&System { run: vec![Step { kind: derive, span }], ..system.clone() })?;
        word::refuse_others(&plan)?;
        Ok(Rules { values: plan.uniforms(set)?, plan, symbol })
    }

    /// Whether the word is closed.
    pub fn is_ring(&self) -> bool {
        self.plan.system.kind == Kind::Curve(Topology::Ring)
    }

    /// The matrix on so many points, at this step of a `derive`. What is no point in their modules is as in the axiom's
    /// first of them, else 0.
    ///
    /// # Errors
    /// [`Error::NotAffine`], with the place; [`Error::TooLong`].
    pub fn matrix(&self, points: usize, step: u32) -> Result<Matrix, Error> {
        let context = Context::new(&self.plan, &self.values, true);
        let record = word::like_the_axiom(&self.plan, &self.values, Some(self.symbol)).unwrap_or_default();
        let (start, columns) = context.start(&record.repeat(points));
        let next = context.step(&start, &self.plan.tables.rule_sets[0].stages[0], step, MOST)?;
        let rows = word::points(&self.plan, next).into_iter().map(|p| p.row).collect();
        Ok(Matrix { columns: columns as usize, rows })
    }

    /// What repeats in the matrix of a ring, however many points it has.
    ///
    /// # Errors
    /// Those of [`Rules::matrix`]; a matrix in which nothing repeats.
    pub fn scheme(&self, step: u32) -> Result<Scheme, Error> {
        let matrix = self.matrix(WIDE, step)?;
        let new = matrix.rows.len();
        let fits = |width: &usize| WIDE.is_multiple_of(*width) && (new * width).is_multiple_of(WIDE);
        let found = (1..=8).filter(fits).find(|width| matrix.repeats(new * width / WIDE, *width).is_ok());
        match found {
            Some(width) if new > 0 => Ok(Scheme::of(&matrix, new * width / WIDE, width)),
            _ => Err(Error::Rules("the matrix of the rules repeats nowhere, so it has no mask".to_string())),
        }
    }
}

/// The indices of the groups of these names.
fn groups(system: &System, with: &[&str]) -> Result<Vec<usize>, Error> {
    let index = |name: &&str| system.groups.iter().position(|g| g.name == *name);
    if with.is_empty() {
        let derived = system.run.iter().find_map(first_derive).map(<[usize]>::to_vec);
        return match index(&"") {
            Some(unnamed) => Ok(vec![unnamed]),
            None => derived.ok_or_else(|| Error::Rules(format!("{} has no rules", system.name))),
        };
    }
    let group = |name: &&str| {
        index(name).ok_or_else(|| {
            let names: Vec<&str> =
                system.groups.iter().map(|g| g.name.as_str()).filter(|n| !n.is_empty()).collect();
            let has = if names.is_empty() {
                "has no named groups".into()
            } else {
                format!("has {}", names.join(", "))
            };
            Error::Rules(format!("there are no rules `{name}`; {} {has}", system.name))
        })
    };
    with.iter().map(group).collect()
}

fn first_derive(step: &Step) -> Option<&[usize]> {
    match &step.kind {
        StepKind::Derive { groups, .. } => Some(groups),
        StepKind::Repeat { body, .. } | StepKind::If { body, .. } => body.iter().find_map(first_derive),
        _ => None,
    }
}
