//! Comparison of an engine's word with the oracle's.

use super::word::{Cell, Module, Param, Word};
use burgeon::language::Value;
use burgeon::language::system::Field;
use burgeon::word::{Params, Symbol};

/// How near an engine's floats must come.
#[derive(Clone, Copy, Debug)]
pub enum Tolerance {
    /// Equal as numbers.
    Exact,
    /// Within `c · ε · (du + dv) · Σ|w p|`, ε that of f32; equal where nothing was halved.
    Carried { c: f64 },
    /// Equal as long as `bits + m·du + n·dv` of a net of degree m × n fit into the 24 bits of f32,
    /// for roots of integers below 2^bits; beyond that as `Carried`.
    Lattice { bits: u32, c: f64 },
}

impl Tolerance {
    /// The c of `Carried` where rounding is allowed for this module, else `None`.
    fn carried(self, module: &Module) -> Option<f64> {
        match self {
            Tolerance::Exact => None,
            Tolerance::Carried { c } => Some(c),
            Tolerance::Lattice { bits, c } => {
                (lattice_bits(module, bits) > f32::MANTISSA_DIGITS).then_some(c)
            }
        }
    }
}

/// How many bits the points of a module need whose root has integers below 2^bits: a halving of
/// degree m adds m binary places.
pub fn lattice_bits(module: &Module, bits: u32) -> u32 {
    let cell = module.cell();
    bits + module.net.degree[0] as u32 * cell.du + module.net.degree[1] as u32 * cell.dv
}

/// Panics unless the engine's word is the oracle's word after `step` steps, module by module.
#[track_caller]
pub fn assert_same(step: usize, oracle: &Word, engine: &burgeon::patch::Word, tolerance: Tolerance) {
    if let Err(difference) = compare(oracle, engine, tolerance) {
        panic!("after step {step} of `{}`: {difference}", engine.system);
    }
    assert_eq!(step, engine.steps as usize, "the steps that the engine says it has done");
}

/// The first difference, in words.
pub fn compare(oracle: &Word, engine: &burgeon::patch::Word, tolerance: Tolerance) -> Result<(), String> {
    for (index, module) in oracle.modules.iter().enumerate().take(engine.modules.len()) {
        compare_module(oracle, module, engine, index, tolerance).map_err(|what| {
            let (here, there) = (describe(module), describe_engine(engine, index));
            format!("module {index}: {what}\n  oracle: {here}\n  engine: {there}")
        })?;
    }
    let (here, there) = (oracle.modules.len(), engine.modules.len());
    if here == there {
        return Ok(());
    }
    let extra = if here > there {
        format!("the oracle's next is {}", describe(&oracle.modules[there]))
    } else {
        format!("the engine's next is {}", describe_engine(engine, here))
    };
    Err(format!("the oracle has {here} modules, the engine {there}; {extra}"))
}

fn compare_module(
    word: &Word,
    module: &Module,
    engine: &burgeon::patch::Word,
    index: usize,
    tolerance: Tolerance,
) -> Result<(), String> {
    let other = &engine.modules[index];
    let cell = module.cell();
    let same_cell = (cell.du, cell.dv) == (other.cell.du as u32, other.cell.dv as u32)
        && (cell.i, cell.j) == (other.cell.i as u64, other.cell.j as u64);
    let checks = [
        ("symbols", module.symbol == engine.symbols[other.symbol].name),
        ("roots", module.root == other.root as usize),
        ("order keys", module.key() == other.key),
        ("cells", same_cell),
        ("degrees", module.net.degree == engine.degree.map(usize::from)),
    ];
    if let Some((what, _)) = checks.iter().find(|(_, same)| !same) {
        return Err(format!("the {what} differ"));
    }
    compare_params(module, &engine.params(index).to_vec(), tolerance)?;
    compare_nets(word, module, engine.net(index), tolerance)
}

fn compare_params(module: &Module, others: &[Value], tolerance: Tolerance) -> Result<(), String> {
    // What is measured of a net is off by roundings of its coordinates.
    let measured = match tolerance {
        Tolerance::Carried { c } => {
            c * module.net.points.iter().flatten().fold(0.0, |a: f64, x| a.max(x.abs()))
        }
        _ => 0.0,
    };
    if module.params.len() != others.len() {
        return Err("the numbers of parameters differ".to_string());
    }
    for (index, (param, other)) in module.params.iter().zip(others).enumerate() {
        let same = match (param, other) {
            (Param::Int(a), Value::Int(b)) => a == b,
            (Param::Bool(a), Value::Bool(b)) => a == b,
            // The oracle's floats are f64: a few roundings of f32 are granted.
            (Param::Float(a), Value::Float(b)) => {
                let b = *b as f64;
                *a == b || (a - b).abs() <= f32::EPSILON as f64 * measured.max(16.0 * a.abs().max(b.abs()))
            }
            _ => false,
        };
        if !same {
            return Err(format!("parameter {index} is {param:?} and {other:?}"));
        }
    }
    Ok(())
}

fn compare_nets(
    word: &Word,
    module: &Module,
    other: &[[f32; 4]],
    tolerance: Tolerance,
) -> Result<(), String> {
    let slack = tolerance.carried(module).map(|c| {
        let factor = c * f32::EPSILON as f64 * module.key_bits() as f64;
        word.magnitude(module).points.into_iter().map(|p| p.map(|x| x * factor)).collect::<Vec<_>>()
    });
    for (index, (ours, theirs)) in module.net.points.iter().zip(other).enumerate() {
        for axis in 0..4 {
            let allowed = slack.as_ref().map_or(0.0, |slack| slack[index][axis]);
            let off = (ours[axis] - theirs[axis] as f64).abs();
            // Written so that a NaN of the engine is a difference.
            if off <= allowed {
                continue;
            }
            let (row, column) = (index / (module.net.degree[1] + 1), index % (module.net.degree[1] + 1));
            let name = ["xw", "yw", "zw", "w"][axis];
            return Err(format!(
                "{name} of point ({row}, {column}) is {:?} and {:?}, {off:e} apart, {allowed:e} allowed",
                ours[axis], theirs[axis]
            ));
        }
    }
    Ok(())
}

fn describe(module: &Module) -> String {
    let cell = module.cell();
    let cell = [cell.du as u64, cell.dv as u64, cell.i, cell.j];
    let (symbol, params) = (&module.symbol, &module.params);
    format!("{symbol}{params:?} root {} key {:#018x} cell {cell:?}", module.root, module.key())
}

fn describe_engine(word: &burgeon::patch::Word, index: usize) -> String {
    let module = &word.modules[index];
    let cell = [module.cell.du as u32, module.cell.dv as u32, module.cell.i, module.cell.j];
    let symbol = word.symbols.get(module.symbol).map_or("?", |s| s.name.as_str());
    let params = word.params(index).to_vec();
    format!("{symbol}{params:?} root {} key {:#018x} cell {cell:?}", module.root, module.key)
}

/// What an engine would hand back that rounds each coordinate once: the oracle's word in the engine's containers.
pub fn engine_word(word: &Word, steps: usize) -> burgeon::patch::Word {
    let mut symbols: Vec<Symbol> = Vec::new();
    let mut params = Params::default();
    let mut modules = Vec::new();
    let mut nets = Vec::new();
    for module in &word.modules {
        let value = |p: &Param| match *p {
            Param::Int(i) => Value::Int(i),
            Param::Bool(b) => Value::Bool(b),
            Param::Float(x) => Value::Float(x as f32),
            Param::Vec2(v) => Value::Vec2(v.map(|x| x as f32)),
            Param::Vec3(v) => Value::Vec3(v.map(|x| x as f32)),
            Param::Vec4(v) => Value::Vec4(v.map(|x| x as f32)),
        };
        let values: Vec<Value> = module.params.iter().map(value).collect();
        let symbol = symbols.iter().position(|s| s.name == module.symbol).unwrap_or_else(|| {
            let field = |(n, value): (usize, &Value)| Field { name: format!("p{n}"), ty: value.ty() };
            let fields: Vec<Field> = values.iter().enumerate().map(field).collect();
            params.add_symbol(&fields);
            symbols.push(Symbol { name: module.symbol.clone(), fields });
            symbols.len() - 1
        });
        let Cell { du, dv, i, j } = module.cell();
        modules.push(burgeon::patch::Module {
            symbol,
            row: params.push(symbol, &values).expect("types of the first"),
            root: module.root as u32,
            key: module.key(),
            cell: burgeon::patch::Cell { du: du as u8, dv: dv as u8, i: i as u32, j: j as u32 },
        });
        nets.extend(module.net.points.iter().map(|p| p.map(|x| x as f32)));
    }
    let degree = word.roots[0].degree.map(|d| d as u8);
    burgeon::patch::Word {
        system: "s".into(),
        steps: steps as u32,
        symbols,
        degree,
        rational: false,
        modules,
        params,
        nets,
    }
}
