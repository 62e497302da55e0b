//! Words whose points are combinations of control points, rewritten by the tables that both backends run.
//!
//! Conditions on what is not a point, contexts, ends and several strict predecessors decide which rule fires, so a word of
//! any curve system goes through, as long as no decision depends on where its points are.

use super::Error;
use super::form::{Form, Point, Scope, evaluate};
use crate::language::expr::{Expr, Type, Value};
use crate::language::system::{self, CurveStart, Field, Kind, System, Topology, UniformKind};
use crate::language::{Span, eval};
use crate::plan::Plan;
use crate::plan::context::{Near, Place};
use crate::plan::layout::END;
use crate::plan::tables::{MatchRule, Stage, Successor};

/// A module and its fields.
#[derive(Clone, Debug)]
pub struct Module {
    pub symbol: usize,
    pub fields: Vec<Form>,
}

/// What all steps of a word have in common.
pub struct Context<'a> {
    pub plan: &'a Plan,
    uniforms: Vec<Form>,
    exact: bool,
    ring: bool,
}

/// The field that is a module's point: its first vector.
pub fn point_field(fields: &[Field]) -> Option<usize> {
    fields.iter().position(|f| matches!(f.ty, Type::Vec2 | Type::Vec3 | Type::Vec4))
}

impl<'a> Context<'a> {
    /// With fractions for coefficients wherever that is possible, or with what the backends have.
    pub fn new(plan: &'a Plan, values: &[Value], exact: bool) -> Context<'a> {
        let mut uniforms: Vec<Form> = Vec::with_capacity(values.len());
        for (uniform, value) in plan.system.uniforms.iter().zip(values) {
            let form = match &uniform.kind {
                // A fraction of fractions is one, though the backends have it rounded.
                UniformKind::Derived(e) if exact => {
                    match evaluate(e, &Scope { uniforms: &uniforms, fields: &[], lets: &[], step: 0, exact })
                    {
                        Form::Known(_, number) => Form::Known(value.clone(), number),
                        _ => Form::known(value.clone(), exact),
                    }
                }
                _ => Form::known(value.clone(), exact),
            };
            uniforms.push(form);
        }
        let ring = plan.system.kind == Kind::Curve(Topology::Ring);
        Context { plan, uniforms, exact, ring }
    }

    /// The word of these records, the n-th of its points being control point n; and how many these are.
    pub fn start(&self, records: &[u32]) -> (Vec<Module>, u32) {
        let tables = &self.plan.tables;
        let mut points = 0;
        let module = |record: &[u32]| {
            let symbol = (record[0] & 0xffff) as usize;
            let s = &tables.symbols[symbol];
            let point = point_field(&s.fields);
            let field = |(n, (field, &at)): (usize, (&Field, &usize))| {
                if point == Some(n) {
                    points += 1;
                    return Form::Point(Point::control(points - 1));
                }
                Form::known(Value::from_words(&field.ty, &record[at..]), self.exact)
            };
            Module { symbol, fields: s.fields.iter().zip(&s.words).enumerate().map(field).collect() }
        };
        let modules = records.chunks_exact(tables.layout.record_words).map(module).collect();
        (modules, points)
    }

    /// The word after one step, of `most` modules at most.
    ///
    /// # Errors
    /// [`Error::NotAffine`] where a rule makes a point that is no combination of points, or where the points decide which
    /// rule fires; [`Error::TooLong`].
    pub fn step(&self, word: &[Module], stage: &Stage, step: u32, most: usize) -> Result<Vec<Module>, Error> {
        // Before a long word is made for nothing.
        if stage.closed.is_some_and(|growth| word.len().saturating_mul(growth as usize) > most) {
            return Err(Error::TooLong { most });
        }
        let mut next = Vec::new();
        let mut at = 0;
        while at < word.len() {
            match self.fires(word, at, stage, step)? {
                None => {
                    next.push(word[at].clone());
                    at += 1;
                }
                Some((rule, scope)) => {
                    let production = &stage.productions[rule.productions.start];
                    for (_, cell) in production.successors() {
                        next.push(self.module(cell, &scope.borrow(self, step), rule.span)?);
                    }
                    at += production.length as usize;
                }
            }
            if next.len() > most {
                return Err(Error::TooLong { most });
            }
        }
        Ok(next)
    }

    fn fires<'s>(
        &self,
        word: &[Module],
        at: usize,
        stage: &'s Stage,
        step: u32,
    ) -> Result<Option<(&'s MatchRule, Names)>, Error> {
        for &id in &stage.by_symbol[word[at].symbol] {
            let rule = &stage.rules[id];
            let Some(names) = self.matches(word, at, rule, step) else { continue };
            let scope = names.borrow(self, step);
            let mut holds = true;
            for guard in &rule.guards {
                match evaluate(guard, &scope) {
                    Form::Known(Value::Bool(value), _) => holds &= value,
                    Form::Other(what, span) => return Err(Error::NotAffine { what, span }),
                    _ => return Err(Error::not_affine("a condition depends on the points", guard.span)),
                }
                if !holds {
                    break;
                }
            }
            if holds && !rule.weights.is_empty() {
                return Err(Error::not_affine("the successor is drawn at random", rule.span));
            }
            if holds {
                return Ok(Some((rule, names)));
            }
        }
        Ok(None)
    }

    /// What the rule's names mean at this place, if what stands around it is what the rule asks for.
    fn matches(&self, word: &[Module], at: usize, rule: &MatchRule, step: u32) -> Option<Names> {
        let near = |place: Place| {
            let place = at as i64 + i64::from(place.offset());
            let wrapped = if self.ring { place.rem_euclid(word.len() as i64) } else { place };
            usize::try_from(wrapped).ok().and_then(|n| word.get(n))
        };
        // Replaced modules never reach across the start of a ring.
        if at + rule.others.len() >= word.len() {
            return None;
        }
        let stands = |n: &Near| near(n.place).map_or(END, |m| m.symbol as u32) == n.symbol;
        if !rule.context.iter().all(stands) {
            return None;
        }
        let mut fields = word[at].fields.clone();
        for &(place, record_word) in &rule.reads {
            let module = near(place)?;
            let words = &self.plan.tables.symbols[module.symbol].words;
            let field = words.iter().position(|&w| w == record_word)?;
            fields.push(module.fields[field].clone());
        }
        let mut names = Names { fields, lets: Vec::with_capacity(rule.lets.len()) };
        for value in &rule.lets {
            let form = evaluate(value, &names.borrow(self, step));
            names.lets.push(form);
        }
        Some(names)
    }

    fn module(&self, cell: &Successor, scope: &Scope, rule: Span) -> Result<Module, Error> {
        let fields = &self.plan.tables.symbols[cell.symbol].fields;
        let point = point_field(fields);
        let field = |(n, arg): (usize, &Expr)| {
            let form = evaluate(arg, scope);
            if point != Some(n) {
                return Ok(form);
            }
            let span = if arg.span.start == arg.span.end { rule } else { arg.span };
            match form.into_point(span) {
                Ok(point) => Ok(Form::Point(point)),
                Err((what, span)) => Err(Error::NotAffine { what, span }),
            }
        };
        let fields = cell.args.iter().enumerate().map(field).collect::<Result<_, _>>()?;
        Ok(Module { symbol: cell.symbol, fields })
    }
}

/// Refuses all but curves whose neighbours stand side by side: contexts of a linked word are found along its links
/// ([`crate::plan::layout`]), which are not followed here.
pub fn refuse_others(plan: &Plan) -> Result<(), Error> {
    let (layout, name) = (plan.tables.layout, &plan.system.name);
    if layout.net.is_some() {
        return Err(no_curve(&plan.system));
    }
    if layout.one_piece() || layout.word.is_some() {
        let what = "words with branches, ignored symbols or several curves have no matrix in this version";
        return Err(Error::Rules(format!("{name}: {what}")));
    }
    Ok(())
}

/// The error of a system of another kind.
pub fn no_curve(system: &System) -> Error {
    Error::Rules(format!("{} is no curve system; only their rules have a matrix", system.name))
}

/// The record of a module with a point, of this symbol if one is named, as the axiom has its first; where it has none, all 0.
pub fn like_the_axiom(plan: &Plan, uniforms: &[Value], symbol: Option<usize>) -> Option<Vec<u32>> {
    let tables = &plan.tables;
    let wanted = |s: usize| match symbol {
        Some(symbol) => s == symbol,
        None => point_field(&tables.symbols[s].fields).is_some(),
    };
    let args = |start: &'_ CurveStart| match start {
        CurveStart::Word(word) => {
            let module = word.modules.iter().find(|m| wanted(m.symbol))?;
            Some((module.symbol, module.args.iter().cloned().map(Some).collect()))
        }
        CurveStart::Points { symbol, args, .. } if wanted(*symbol) => Some((*symbol, args.clone())),
        _ => None,
    };
    let written: Option<(usize, Vec<Option<Expr>>)> = match &plan.system.axiom {
        system::Axiom::Curve(starts) => starts.iter().find_map(args),
        _ => None,
    };
    let (symbol, args) = match written {
        Some(written) => written,
        None => ((0..tables.symbols.len()).find(|&s| wanted(s))?, Vec::new()),
    };
    let mut record = vec![0; tables.layout.record_words];
    record[0] = symbol as u32;
    for (arg, &at) in args.iter().zip(&tables.symbols[symbol].words) {
        if let Some(Ok(value)) = arg.as_ref().map(|arg| eval::eval(arg, uniforms)) {
            let words = value.words();
            record[at..at + words.len()].copy_from_slice(&words);
        }
    }
    Some(record)
}

/// What the names of a rule mean at one place.
struct Names {
    fields: Vec<Form>,
    lets: Vec<Form>,
}

impl Names {
    fn borrow<'a>(&'a self, context: &'a Context, step: u32) -> Scope<'a> {
        Scope {
            uniforms: &context.uniforms,
            fields: &self.fields,
            lets: &self.lets,
            step,
            exact: context.exact,
        }
    }
}

/// The points of a word in order.
pub fn points(plan: &Plan, word: Vec<Module>) -> Vec<Point> {
    let point = |mut module: Module| {
        let field = point_field(&plan.tables.symbols[module.symbol].fields)?;
        match module.fields.swap_remove(field) {
            Form::Point(point) => Some(point),
            _ => None,
        }
    };
    word.into_iter().filter_map(point).collect()
}
