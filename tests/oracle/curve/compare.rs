//! Comparison of an engine's word with the oracle's, over a plain struct that an adapter fills in.

use super::super::lots::Path;
use super::super::word::Param;
use super::word::{Link, Topology, Word};

/// A word as it is seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    pub modules: Vec<SeenModule>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SeenModule {
    pub symbol: String,
    pub params: Vec<Param>,
    /// Of open words and trees; `None` in rings, and where the engine tells none.
    pub link: Option<Link>,
    /// `None` where the engine tells none.
    pub path: Option<Path>,
}

/// The oracle's word, seen.
pub fn see(word: &Word) -> Seen {
    let links = word.links();
    let ring = word.topology == Topology::Ring;
    let modules = word.modules().zip(links).map(|(module, link)| SeenModule {
        symbol: module.symbol.clone(),
        params: module.params.clone(),
        link: (!ring).then_some(link),
        path: Some(module.path),
    });
    Seen { modules: modules.collect() }
}

/// How near an engine's floats must come.
#[derive(Clone, Copy, Debug)]
pub enum Tolerance {
    /// Equal as numbers: where nothing is rounded.
    Exact,
    /// Within `c · ε` of the greatest float of the word, ε that of f32.
    Near { c: f64 },
}

/// Panics unless the engine's word is the oracle's word after `step` steps, module by module.
#[track_caller]
pub fn assert_same(step: usize, oracle: &Word, engine: &Seen, tolerance: Tolerance) {
    if let Err(difference) = compare(oracle, engine, tolerance) {
        panic!("after step {step}: {difference}");
    }
}

/// The first difference, in words.
pub fn compare(oracle: &Word, engine: &Seen, tolerance: Tolerance) -> Result<(), String> {
    let ours = see(oracle);
    let size = ours.modules.iter().flat_map(|m| &m.params).flat_map(Param::floats);
    let size = size.fold(0.0, |a: f64, x| a.max(x.abs()));
    let allowed = match tolerance {
        Tolerance::Exact => 0.0,
        Tolerance::Near { c } => c * f64::from(f32::EPSILON) * size,
    };
    for (index, (ours, theirs)) in ours.modules.iter().zip(&engine.modules).enumerate() {
        compare_modules(ours, theirs, allowed)
            .map_err(|what| format!("module {index}: {what}\n  oracle: {ours:?}\n  engine: {theirs:?}"))?;
    }
    let (here, there) = (ours.modules.len(), engine.modules.len());
    if here == there {
        return Ok(());
    }
    let extra = if here > there { &ours.modules[there] } else { &engine.modules[here] };
    Err(format!("the oracle has {here} modules, the engine {there}; the next is {extra:?}"))
}

fn compare_modules(ours: &SeenModule, theirs: &SeenModule, allowed: f64) -> Result<(), String> {
    if ours.symbol != theirs.symbol {
        return Err("the symbols differ".to_string());
    }
    if theirs.path.is_some_and(|path| ours.path != Some(path)) {
        return Err("the paths differ".to_string());
    }
    if theirs.link.is_some_and(|link| ours.link != Some(link)) {
        return Err("the links differ".to_string());
    }
    if ours.params.len() != theirs.params.len() {
        return Err("the numbers of parameters differ".to_string());
    }
    for (index, (a, b)) in ours.params.iter().zip(&theirs.params).enumerate() {
        if !near(a, b, allowed) {
            return Err(format!("parameter {index} is {a:?} and {b:?}, {allowed:e} allowed"));
        }
    }
    Ok(())
}

fn near(a: &Param, b: &Param, allowed: f64) -> bool {
    match (a, b) {
        (Param::Int(_) | Param::Bool(_), _) | (_, Param::Int(_) | Param::Bool(_)) => a == b,
        (a, b) => {
            // Written so that a NaN of the engine is a difference.
            let close = |(x, y): (&f64, &f64)| x == y || (x - y).abs() <= allowed;
            a.floats().len() == b.floats().len() && a.floats().iter().zip(b.floats()).all(close)
        }
    }
}
