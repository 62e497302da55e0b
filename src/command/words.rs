//! Several words in one run: sweeps over params, seeds, the curves of a file.

use super::flags;
use super::load::{self, Job};
use super::source::no_such_param;
use super::values::number;
use super::{Failure, counted};
use burgeon::curve::{self, Words};
use burgeon::language::Value;
use burgeon::language::expr::Type;
use burgeon::plan;
use burgeon::plan::schedule::{self, Act};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What a flag `--sweep` says.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    pub name: String,
    from: Value,
    to: Value,
    /// How many values; else all ints.
    count: Option<u32>,
}

/// Words of one run.
const MOST: usize = 1 << 20;

impl Sweep {
    /// `NAME=FROM..TO/N`.
    pub fn parse(text: &str) -> Result<Sweep, String> {
        let form = "write NAME=FROM..TO/N, as in w=0..0.125/6, or of ints NAME=FROM..TO";
        let (name, range) = text.split_once('=').ok_or(form)?;
        let (range, count) = match range.rsplit_once('/') {
            None => (range, None),
            Some((range, count)) => match count.trim().parse::<u32>() {
                Ok(count) if count > 1 => (range, Some(count)),
                _ => return Err(format!("`{count}` is no number of values; {form}, with N 2 or more")),
            },
        };
        let (from, to) = range.split_once("..").ok_or(form)?;
        if name.trim().is_empty() {
            return Err("the name before = is missing".to_string());
        }
        let name = name.trim().to_string();
        Ok(Sweep { name, from: number(from.trim())?, to: number(to.trim())?, count })
    }

    /// Its values, for a param of this type.
    fn values(&self, ty: &Type) -> Result<Vec<Value>, String> {
        let name = &self.name;
        if let (Type::Int, &Value::Int(from), &Value::Int(to)) = (ty, &self.from, &self.to) {
            let (from, to) = (i64::from(from), i64::from(to));
            let gaps = self.count.map_or(from.abs_diff(to), |n| u64::from(n) - 1) as i64;
            if gaps != 0 && (to - from) % gaps != 0 {
                let n = gaps + 1;
                return Err(format!(
                    "{name} is of type int, and {n} ints do not stand evenly from {from} to {to}"
                ));
            }
            let step = (to - from).checked_div(gaps).unwrap_or(0);
            self.limit(gaps as usize + 1)?;
            return Ok((0..=gaps).map(|k| Value::Int((from + k * step) as i32)).collect());
        }
        let floats = |value: &Value| match (ty, value) {
            (Type::Float, Value::Int(i)) => Some(vec![*i as f32]),
            (Type::Float, Value::Float(_)) | (Type::Vec2, Value::Vec2(_)) => Some(as_floats(value)),
            (Type::Vec3, Value::Vec3(_)) | (Type::Vec4, Value::Vec4(_)) => Some(as_floats(value)),
            _ => None,
        };
        let (Some(from), Some(to)) = (floats(&self.from), floats(&self.to)) else {
            return Err(format!("{name} is of type {ty}; both ends must be of it"));
        };
        let Some(count) = self.count else {
            return Err(format!("{name} is of type {ty}; say how many values: FROM..TO/N"));
        };
        self.limit(count as usize)?;
        let between = |k: u32| {
            let at = f64::from(k) / f64::from(count - 1);
            let mixed = from.iter().zip(&to).map(|(&a, &b)| {
                let x = f64::from(a) * (1.0 - at) + f64::from(b) * at;
                (x as f32).to_bits()
            });
            Value::from_words(ty, &mixed.collect::<Vec<u32>>())
        };
        Ok((0..count).map(between).collect())
    }

    fn limit(&self, count: usize) -> Result<(), String> {
        if count <= MOST { Ok(()) } else { Err(format!("{} takes more than {MOST} values", self.name)) }
    }
}

fn as_floats(value: &Value) -> Vec<f32> {
    value.words().into_iter().map(f32::from_bits).collect()
}

/// Words, and the runs that they take.
pub struct Several {
    pub words: Words,
    /// Those of one schedule are one run.
    pub runs: Vec<Vec<usize>>,
    /// Combinations of params and seeds; the words of each curve have them in the same order.
    pub combinations: usize,
    /// Combinations of each row in a picture, where they are of several kinds.
    pub columns: Option<usize>,
}

/// All combinations, if they are not too many.
fn within_limit(a: usize, b: usize) -> Result<usize, Failure> {
    match a.saturating_mul(b) {
        count if count <= MOST => Ok(count),
        count => {
            let count = counted(count as u64, "curve");
            Err(Failure::Usage(format!("error: these are {count}; one run takes {MOST} at most")))
        }
    }
}

/// The words that the flags ask for: for each curve, then each combination of params, then each seed.
pub fn several(flags: &flags::Run, job: &Job) -> Result<Several, Failure> {
    let system = &job.plan.system;
    let usage = |text: String| Failure::Usage(format!("error: {text}"));
    let mut sets = vec![job.set.clone()];
    let mut names = BTreeSet::new();
    let mut sizes = Vec::new();
    for sweep in &flags.words.sweep {
        let name = &sweep.name;
        let Some(uniform) = system.uniforms.iter().find(|u| u.name == *name && u.is_param()) else {
            return Err(usage(no_such_param(system, "--sweep", name)));
        };
        if job.set.iter().any(|(set, _)| set == name) || !names.insert(name) {
            return Err(usage(format!("--sweep {name}: the param is given twice")));
        }
        let values = sweep.values(&uniform.ty).map_err(|e| usage(format!("--sweep {name}: {e}")))?;
        sizes.push(values.len());
        within_limit(sets.len(), values.len())?;
        let with = |set: &Vec<(String, Value)>| {
            let set = set.clone();
            let one = |value: &Value| [&set[..], &[(name.clone(), value.clone())]].concat();
            values.iter().map(one).collect::<Vec<_>>()
        };
        sets = sets.iter().flat_map(with).collect();
    }
    let axioms = match flags.words.each {
        true => job.each.clone(),
        false => vec![job.axiom.curve().map_err(|e| job.failure(e))?.clone()],
    };
    let axioms: Vec<Arc<curve::Axiom>> = axioms.into_iter().map(Arc::new).collect();
    let seeds = flags.words.seeds.unwrap_or(1);
    sizes.extend(flags.words.seeds.map(|seeds| seeds as usize));
    let count = within_limit(within_limit(axioms.len(), sets.len())?, seeds as usize)?;
    // All stand in memory at once before the first step.
    let combinations = sets.len() * seeds as usize;
    let modules = axioms.iter().map(|axiom| axiom.len() as u64).sum::<u64>() * combinations as u64;
    let needed = modules * job.plan.tables.layout.module_bytes();
    let budget = flags.derive.machine.max_memory.unwrap_or_else(load::half_of_memory);
    if needed > budget {
        return Err(job.failure(plan::Error::Memory { needed, modules, step: 0, budget }));
    }
    let mut words = Vec::with_capacity(count);
    for axiom in &axioms {
        for set in &sets {
            let first = job.plan.settings(set, flags.derive.seed).map_err(|e| job.failure(e))?.seed;
            let start = |seed| curve::Start { axiom: axiom.clone(), set: set.clone(), seed: Some(seed) };
            words.extend((0..seeds).map(|n| start(first.wrapping_add(n))));
        }
    }
    let mut runs: Vec<(Vec<Act>, Vec<usize>)> = Vec::new();
    for (n, start) in words.iter().enumerate() {
        let uniforms = job.plan.uniforms(&start.set).map_err(|e| job.failure(e))?;
        let own = schedule::unroll(&job.plan, &uniforms).map_err(|e| job.failure(e))?;
        match runs.iter_mut().find(|(schedule, _)| *schedule == own) {
            Some((_, run)) => run.push(n),
            None => runs.push((own, vec![n])),
        }
    }
    let columns = sizes.last().copied().filter(|&n| sizes.len() > 1 && n > 1);
    let runs = runs.into_iter().map(|(_, run)| run).collect();
    Ok(Several { words: Words { words }, runs, combinations, columns })
}
