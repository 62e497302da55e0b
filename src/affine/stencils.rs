//! All steps of a derivation as one table: each point of the final word as a combination of control points.
//!
//! Rows of a scheme repeat: after k steps of arity c only c^k of them differ but for where they begin, and at the ends of an
//! open word a few more. So a row is 8 bytes, where its control points begin and where its weights do, and equal rows share
//! their weights. Counted for Chaikin's rule, 64 points, 6 steps, 3 weights a row at most: 32 KiB of rows and 0.75 KiB of weights,
//! where rows with indices and weights of their own (28 bytes) take 112 KiB. A frame reads the 8 bytes and
//! writes 16 a point; the weights stay in the caches. Where no row is like another a weight more costs 4 bytes, against 8
//! with its index.

use super::Error;
use super::form::Point;
use super::word::{self, Context, point_field};
use crate::curve::Axiom;
use crate::language::Type;
use crate::language::expr::Value;
use crate::plan::schedule::{self, Act};
use crate::plan::{Options, Plan};
use std::collections::HashMap;

/// A table of weights.
#[derive(Clone, Debug)]
pub struct Stencils {
    /// Control points; at least 1.
    columns: u32,
    rows: Vec<[u32; 2]>,
    weights: Vec<f32>,
    bound: f64,
}

/// Control points that one point may be made of, with those between them, and weights of a table.
pub const MOST_WIDTH: usize = 256;
pub const MOST_WEIGHTS: usize = 1 << 24;

/// Modules of a word that has a table: while it is made each takes some 200 bytes.
pub const MOST_POINTS: usize = 1 << 21;

/// The unit roundoff of single precision.
const UNIT: f64 = 1.0 / (1 << 24) as f64;

impl Stencils {
    /// Of the whole schedule from this axiom on: its points, in order, are the control points.
    ///
    /// # Errors
    /// [`Error::NotAffine`], with the place, where a point is no combination of others or the points decide what happens;
    /// `until terminal`, since what ends it is not known beforehand; a word or a table that is too long.
    pub fn new(plan: &Plan, axiom: &Axiom, options: &Options) -> Result<Stencils, Error> {
        word::refuse_others(plan)?;
        let values = plan.uniforms(&options.set)?;
        Stencils::from_records(plan, &plan.curve_axiom(axiom, &values)?, &values, options.steps)
    }

    /// The same from a word of so many modules, each like the axiom's first that has a point.
    ///
    /// # Errors
    /// As [`Stencils::new`]; a system without points.
    pub fn of_length(plan: &Plan, points: usize, options: &Options) -> Result<Stencils, Error> {
        word::refuse_others(plan)?;
        let values = plan.uniforms(&options.set)?;
        let Some(record) = word::like_the_axiom(plan, &values, None) else {
            return Err(Error::Rules(format!("no module of {} has a point", plan.system.name)));
        };
        Stencils::from_records(plan, &record.repeat(points), &values, options.steps)
    }

    fn from_records(
        plan: &Plan,
        records: &[u32],
        values: &[Value],
        steps: Option<u32>,
    ) -> Result<Stencils, Error> {
        let context = Context::new(plan, values, false);
        let (mut modules, columns) = context.start(records);
        if columns == 0 {
            return Err(Error::Rules("the axiom has no points".to_string()));
        }
        let mut left = steps.unwrap_or(u32::MAX);
        for derive in schedule::unroll(plan, values)?.iter().map(Act::rewrite) {
            if derive.until_terminal {
                let message = "how many steps `until terminal` takes is not known before they are done";
                return Err(Error::Rules(message.to_string()));
            }
            let stage = &plan.tables.rule_sets[derive.rule_set].stages[0];
            for step in 0..derive.count.min(left) {
                modules = context.step(&modules, stage, step, MOST_POINTS)?;
            }
            left -= derive.count.min(left);
        }
        Stencils::of(columns, word::points(plan, modules))
    }

    fn of(columns: u32, points: Vec<Point>) -> Result<Stencils, Error> {
        let mut stencils =
            Stencils { columns, rows: Vec::with_capacity(points.len()), weights: vec![], bound: 0.0 };
        let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
        for (n, point) in points.iter().enumerate() {
            let (first, weights) = dense(columns, point);
            if weights.len() > MOST_WIDTH {
                let width = weights.len();
                let message = format!(
                    "point {n} of the word hangs on {width} control points in a row; {MOST_WIDTH} is the most"
                );
                return Err(Error::Table(message));
            }
            let width = weights.len() as u32;
            // Weights are rounded, and so are products and sums.
            let own = (f64::from(width) + 2.0) * point.magnitude();
            stencils.bound = stencils.bound.max(point.rounding + own);
            let bits = weights.iter().map(|w| w.to_bits()).collect();
            let next = stencils.weights.len();
            let begin = *known.entry(bits).or_insert(next as u32);
            if begin as usize == next {
                stencils.weights.extend(weights);
            }
            if stencils.weights.len() > MOST_WEIGHTS {
                return Err(Error::Table(format!("more than {MOST_WEIGHTS} different weights")));
            }
            stencils.rows.push([first, begin | (width - 1) << 24]);
        }
        // Second-order terms.
        stencils.bound *= UNIT * 1.01;
        Ok(stencils)
    }

    /// Control points.
    pub fn columns(&self) -> usize {
        self.columns as usize
    }

    /// Points of the curve.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// No point.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// As kernels read it: for each point its first control point; then, in bits 0–23, where its weights begin and, in 24–31,
    /// how many they are, less one. Behind the last control point stands the first.
    pub fn rows(&self) -> &[[u32; 2]] {
        &self.rows
    }

    /// All different weights, row by row.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The control points of a point and their weights, in order.
    pub fn row(&self, point: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let [first, packed] = self.rows[point];
        let (begin, width) = ((packed & 0xff_ffff) as usize, (packed >> 24) as usize + 1);
        let weights = self.weights[begin..begin + width].iter();
        weights.enumerate().map(move |(k, &w)| ((first as usize + k) % self.columns as usize, w))
    }

    /// How far a coordinate of a derived point and of the table's may lie apart, each rounded in its own way, for every unit of
    /// the greatest coordinate among the control points.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// Bytes of the table.
    pub fn bytes(&self) -> usize {
        size_of_val(self.rows.as_slice()) + size_of_val(self.weights.as_slice())
    }

    /// The control points that the axiom itself holds: x, y, z and w, where missing 0 and 1.
    ///
    /// # Errors
    /// An argument without a value.
    pub fn control(plan: &Plan, axiom: &Axiom, options: &Options) -> Result<Vec<[f32; 4]>, Error> {
        word::refuse_others(plan)?;
        let records = plan.curve_axiom(axiom, &plan.uniforms(&options.set)?)?;
        let point = |record: &[u32]| {
            let symbol = &plan.tables.symbols[(record[0] & 0xffff) as usize];
            let field = point_field(&symbol.fields)?;
            let ty: &Type = &symbol.fields[field].ty;
            let value = Value::from_words(ty, &record[symbol.words[field]..]);
            let mut point = [0.0, 0.0, 0.0, 1.0];
            point[..value.components().len()].copy_from_slice(value.components());
            Some(point)
        };
        Ok(records.chunks_exact(plan.tables.layout.record_words).filter_map(point).collect())
    }
}

/// The first control point of a row and its weights, in the shortest run around the end.
fn dense(columns: u32, point: &Point) -> (u32, Vec<f32>) {
    let row = &point.row;
    let Some(last) = row.last() else { return (0, vec![0.0]) };
    // The widest gap stands before the first of the run.
    let before = |n: usize| if n == 0 { last.0 } else { row[n - 1].0 };
    let gap = |n: &usize| (row[*n].0 + columns - before(*n) - 1) % columns;
    let start = (0..row.len()).rev().max_by_key(gap).unwrap_or(0);
    let first = row[start].0;
    let width = (before(start) + columns - first) % columns + 1;
    let mut weights = vec![0.0; width as usize];
    for (column, x) in row {
        weights[((column + columns - first) % columns) as usize] = x.to_f64() as f32;
    }
    (first, weights)
}
