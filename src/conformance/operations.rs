//! Every row of the table of operations over awkward numbers.

use super::{Case, Compared, Trouble};
use crate::codegen::Tuning;
use crate::cpu::Cpu;
use crate::gpu::{Engine, Gpu};
use crate::language::ops::{Row, TABLE};
use crate::language::{System, Type, Value};
use crate::plan::bound::{self, Known};
use crate::plan::columns::Content;
use crate::plan::derive::{Backend, Outcome, StageId};
use crate::plan::layout::Header;
use crate::plan::step::Clock;
use crate::plan::{Given, Plan};
use std::fmt::Write;

/// Expressions over the parameters of a module, as a system of one rule.
pub struct Expressions {
    plan: Plan,
    /// The expressions and their types.
    pub list: Vec<(String, Type)>,
}

impl Expressions {
    /// `fields` as they are declared, `x: float`, each with the name alone.
    ///
    /// # Panics
    /// Where they do not check: a fault of this crate's, which its tests look for.
    pub fn new(fields: &[(&str, Type)], list: Vec<(String, Type)>) -> Expressions {
        let declared: Vec<String> = fields.iter().map(|(name, ty)| format!("{name}: {ty}")).collect();
        let names: Vec<&str> = fields.iter().map(|f| f.0).collect();
        let results: Vec<String> =
            list.iter().enumerate().map(|(n, (_, ty))| format!("r{n}: {ty}")).collect();
        let values: Vec<&str> = list.iter().map(|e| e.0.as_str()).collect();
        let text = format!(
            "system expressions : patch bezier 3\nmodule P({})\nmodule Q({})\nrules:\n  P({}) -> Q({})\n",
            declared.join(", "),
            results.join(", "),
            names.join(", "),
            values.join(", ")
        );
        let plan = System::parse(&text).map_err(|e| e.to_string());
        let plan = plan.and_then(|system| Plan::new(&system).map_err(|e| e.to_string()));
        match plan {
            Ok(plan) => Expressions { plan, list },
            Err(e) => panic!("{e}"),
        }
    }

    /// The records of modules of these parameters.
    fn records(&self, modules: &[Vec<Value>]) -> Vec<u32> {
        let tables = &self.plan.tables;
        let words = tables.layout.record_words;
        let mut records = vec![0; modules.len() * words];
        for (n, (record, values)) in records.chunks_exact_mut(words).zip(modules).enumerate() {
            Header { root: n as u32, ..Header::default() }.write(record);
            for (value, &at) in values.iter().zip(&tables.symbols[0].words) {
                let words = value.words();
                record[at..at + words.len()].copy_from_slice(&words);
            }
        }
        records
    }

    /// The values of all expressions for each module of these parameters.
    fn evaluate<B: Backend>(
        &self,
        backend: &mut B,
        clock: Clock,
        modules: &[Vec<Value>],
    ) -> Result<Vec<Vec<Value>>, B::Error> {
        let tables = &self.plan.tables;
        let layout = tables.layout;
        let records = self.records(modules);
        let nets = vec![[0.0; 4]; modules.len() * layout.net_points()];
        let chunk = backend.upload(Content::of_nets(records, nets))?;
        let outcome = backend.step(StageId { rule_set: 0, stage: 0 }, clock, &chunk, u64::MAX)?;
        // Whatever else comes is no value at all, which no comparison takes for one.
        let Outcome::Done { next: Some(next), .. } = outcome else { return Ok(Vec::new()) };
        let content = backend.read(&next)?;
        let types = self.list.iter().map(|e| &e.1).zip(&tables.symbols[1].words);
        let values =
            |record: &[u32]| types.clone().map(|(ty, &at)| Value::from_words(ty, &record[at..])).collect();
        Ok(content.records().chunks_exact(layout.record_words).map(values).collect())
    }

    /// The values on the CPU.
    pub fn on_cpu(
        &self,
        clock: Clock,
        modules: &[Vec<Value>],
    ) -> Result<Vec<Vec<Value>>, crate::plan::Error> {
        self.evaluate(&mut Cpu::new(&self.plan, 1)?, clock, modules)
    }

    /// The values on the CPU and on the device.
    pub fn both(&self, engine: &Engine, clock: Clock, modules: &[Vec<Value>]) -> Result<Both, Trouble> {
        let cpu = self.on_cpu(clock, modules)?;
        // Nets are not what this is about: the mapping that drivers compile faster.
        let engine = engine.retuned(Tuning::GPU);
        let gpu = self.evaluate(&mut Gpu::new(&engine, &self.plan)?, clock, modules)?;
        if gpu.len() != cpu.len() {
            let what = format!("emit: {} modules on the CPU and {} on the GPU", cpu.len(), gpu.len());
            return Err(Trouble::Differs(what));
        }
        Ok(Both { cpu, gpu, known: self.known(clock, modules) })
    }

    /// For each module and expression, what each word may be on another machine.
    fn known(&self, clock: Clock, modules: &[Vec<Value>]) -> Vec<Vec<Vec<Known>>> {
        let tables = &self.plan.tables;
        let stage = &tables.rule_sets[0].stages[0];
        let environment = self.plan.environment(stage, &[], &Given::default());
        let code = &stage.code.children[0];
        let of_module = |record: &[u32]| {
            let (environment, given, measured, spread) = (environment.as_slice(), &[][..], &[][..], &[][..]);
            let module = bound::Module {
                record,
                window: &[],
                at: 0,
                behind: 0,
                environment,
                given,
                measured,
                spread,
                clock,
                linked: None,
                index: 0,
            };
            let nodes = bound::evaluate(&code.graph, &module);
            // The words of the results stand in their order.
            let mut words = code.args[0].iter().map(|&(node, _)| nodes[node]);
            self.list.iter().map(|(_, ty)| words.by_ref().take(ty.words()).collect()).collect()
        };
        self.records(modules).chunks_exact(tables.layout.record_words).map(of_module).collect()
    }
}

/// For each module the values of all expressions.
pub struct Both {
    pub cpu: Vec<Vec<Value>>,
    pub gpu: Vec<Vec<Value>>,
    /// What each of their words may be elsewhere.
    known: Vec<Vec<Vec<Known>>>,
}

const INTS: [i32; 16] =
    [i32::MIN, i32::MAX, 0, -1, 1, 7, -5, 46341, -65536, 65537, 2, -2, 1_000_000_007, -3, 31, 0x5555_5555];

/// Of all sizes, but none so small that a product is denormal or so large that it is infinite: what
/// a device makes of those is its own affair.
const FLOATS: [f32; 16] = [
    0.0,
    0.5,
    1.5,
    -2.5,
    0.1,
    -0.33333334,
    16777216.0,
    -3.7,
    1e18,
    -1e18,
    1e-15,
    2147483648.0,
    -2147483648.0,
    123456.79,
    -0.75,
    7.0,
];

/// Of everyday size, for functions that lose their meaning far out. No quotient of a [`DIVIDENDS`]
/// and a [`DIVISORS`] is near a whole number, where a remainder jumps.
pub const DIVIDENDS: [f32; 16] =
    [0.37, -0.3, 1.7, -7.25, 23.1, -41.9, 88.3, 0.061, 2.9, -1.13, 5.57, -13.7, 63.3, -0.83, 9.41, 31.7];
pub const DIVISORS: [f32; 16] =
    [1.09, -2.3, 0.71, 3.37, -5.9, 17.3, -0.43, 7.9, 0.19, -11.9, 29.3, -71.3, 4.7, 0.97, -1.61, 53.9];

/// For arc sines.
const UNITS: [f32; 16] =
    [-1.0, 1.0, 0.0, 0.5, -0.5, 0.999, -0.999, 1e-3, 0.1, -0.1, 0.72, -0.72, 0.25, 0.9, -0.3, 0.6];

/// For logarithms.
const POSITIVE: [f32; 16] =
    [1e-6, 1e-3, 0.1, 0.37, 0.5, 0.71, 0.999, 1.0, 1.001, 2.0, 2.75, 7.3, 100.0, 4096.0, 1e6, 12345.678];

/// Modules: all pairs of the numbers above.
const MODULES: usize = 256;

/// What is infinite, not a number, or makes it of others, and some that do not.
const SPECIALS: [f32; 16] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::MAX,
    f32::MIN,
    2.5,
    -0.3,
    8388609.0,
    -2147483648.0,
    4294967296.0,
    -1e20,
    1e-20,
];

/// Parameters of the module of [`specials`].
const SPECIAL_FIELDS: [(&str, Type); 5] =
    [("f", Type::Bool), ("a", Type::Int), ("x", Type::Float), ("y", Type::Float), ("z", Type::Float)];

fn specials(n: usize) -> Vec<Value> {
    let (i, j) = (n / 16, n % 16);
    let mut values = vec![Value::Bool((i ^ j) & 1 == 1), Value::Int(INTS[i])];
    values.extend([i, j, (7 * i + 3 * j + 5) % 16].map(|k| Value::Float(SPECIALS[k])));
    values
}

/// Parameters of the module whose rows take scalars.
const SCALARS: [(&str, Type); 14] = [
    ("a", Type::Int),
    ("b", Type::Int),
    ("c", Type::Int),
    ("f", Type::Bool),
    ("g", Type::Bool),
    ("h", Type::Bool),
    ("u", Type::Float),
    ("v", Type::Float),
    ("w", Type::Float),
    ("x", Type::Float),
    ("y", Type::Float),
    ("z", Type::Float),
    ("s", Type::Float),
    ("t", Type::Float),
];

fn scalars(n: usize) -> Vec<Value> {
    let (i, j) = (n / 16, n % 16);
    let k = (7 * i + 3 * j + 5) % 16;
    let nonzero = |x: f32| if x == 0.0 { 1.0 } else { x };
    let mut values: Vec<Value> = [i, j, k].map(|i| Value::Int(INTS[i])).to_vec();
    values.extend([i & 1, j & 1, (i >> 1) & 1].map(|bit| Value::Bool(bit == 1)));
    let floats = [
        FLOATS[i],
        nonzero(FLOATS[j]),
        FLOATS[k],
        DIVIDENDS[i],
        DIVISORS[j],
        DIVIDENDS[k],
        UNITS[i],
        POSITIVE[j],
    ];
    values.extend(floats.map(Value::Float));
    values
}

/// Parameters of the module whose rows take vectors of this type.
fn vector_fields(ty: &Type) -> [(&'static str, Type); 5] {
    [("f", Type::Bool), ("x", Type::Float), ("p", ty.clone()), ("q", ty.clone()), ("r", ty.clone())]
}

fn vectors(ty: &Type, n: usize) -> Vec<Value> {
    let (i, j) = (n / 16, n % 16);
    let vector = |values: &[f32; 16], start: usize, stride: usize| {
        let words: Vec<u32> = (0..4).map(|c| values[(start + c * stride) % 16].to_bits()).collect();
        Value::from_words(ty, &words)
    };
    vec![
        Value::Bool((i ^ j) & 1 == 1),
        Value::Float(DIVISORS[(i + j) % 16]),
        vector(&DIVIDENDS, i, 5),
        vector(&DIVISORS, j, 3),
        vector(&DIVIDENDS, i + 7 * j, 11),
    ]
}

/// The parameter that stands for the `k`th argument of this type.
fn argument(row: &Row, ty: &Type, k: usize) -> &'static str {
    match (ty, row.name) {
        (Type::Int, _) => ["a", "b", "c"][k],
        (Type::Bool, _) => ["f", "g", "h"][k],
        (Type::Float, _) if vector_of(row).is_some() => "x",
        (Type::Float, "asin" | "acos") => "s",
        (Type::Float, "log" | "log2" | "sqrt") => "t",
        (Type::Float, "pow") => ["t", "s"][k],
        (Type::Float, "sin" | "cos" | "tan" | "exp" | "exp2" | "atan" | "atan2") => ["x", "y"][k],
        (Type::Float, "%" | "mix" | "smoothstep") => ["x", "y", "z"][k],
        (Type::Float, _) => ["u", "v", "w"][k],
        _ => ["p", "q", "r"][k],
    }
}

/// The type of vectors that the row takes.
fn vector_of(row: &Row) -> Option<&Type> {
    row.args.iter().find(|ty| matches!(ty, Type::Vec2 | Type::Vec3 | Type::Vec4))
}

/// The same where all floats are [`SPECIALS`].
fn special_argument(_: &Row, ty: &Type, k: usize) -> &'static str {
    match ty {
        Type::Bool => "f",
        Type::Int => "a",
        _ => ["x", "y", "z"][k],
    }
}

/// What stands for the `k`th argument of a type.
type Argument = fn(&Row, &Type, usize) -> &'static str;

/// The row, called: `pow(t, s)`, and the parameters that stand in it.
fn call(row: &Row, argument: Argument) -> (String, Vec<&'static str>) {
    let mut names = Vec::new();
    for (n, ty) in row.args.iter().enumerate() {
        let before = row.args[..n].iter().filter(|other| *other == ty).count();
        names.push(argument(row, ty, before));
    }
    let text = match names.as_slice() {
        [a] if row.is_operator() => format!("({}{a})", row.name),
        [a, b] if row.is_operator() => format!("({a} {} {b})", row.name),
        names => format!("{}({})", row.name, names.join(", ")),
    };
    (text, names)
}

/// Whether rules can name it. What they cannot stands behind `rand`, `randn`, draws and `noise(p)`.
fn named(row: &Row) -> bool {
    !row.name.ends_with('#') && !row.name.ends_with(" *")
}

/// How far apart two values are as a part of what is allowed; infinitely where nothing is known of them,
/// since the arguments are such that something is.
fn distance(known: &[Known], cpu: &Value, gpu: &Value) -> f32 {
    let apart = known.iter().zip(cpu.words()).zip(gpu.words()).map(|((known, a), b)| match *known {
        _ if a == b => 0.0,
        Known::Near { radius, .. } if radius.is_finite() => {
            match bound::distance(f32::from_bits(a), f32::from_bits(b)) {
                // Equal but for the sign of zero, or the bits of what is not a number.
                0.0 => 0.0,
                apart => apart / radius,
            }
        }
        Known::Between { .. } if known.allows(b) => 1.0,
        _ => f32::INFINITY,
    });
    apart.fold(0.0, f32::max)
}

/// Compares these rows, some at a time.
fn compare(
    engine: &Engine,
    (fields, argument): (&[(&str, Type)], Argument),
    rows: &[&Row],
    modules: &[Vec<Value>],
) -> Result<Compared, Trouble> {
    /// Words of results a module.
    const WORDS: usize = 48;
    let mut all = Compared::default();
    let mut rest = rows;
    while !rest.is_empty() {
        let mut words = 0;
        let fits = |row: &&&Row| {
            words += row.result.words();
            words <= WORDS
        };
        let (batch, behind) = rest.split_at(rest.iter().take_while(fits).count().max(1));
        rest = behind;
        let calls: Vec<_> = batch.iter().map(|row| call(row, argument)).collect();
        let list = calls.iter().zip(batch).map(|(c, row)| (c.0.clone(), row.result.clone())).collect();
        let both = Expressions::new(fields, list).both(engine, Clock::default(), modules)?;
        for (n, (cpu, gpu)) in both.cpu.iter().zip(&both.gpu).enumerate() {
            for (k, row) in batch.iter().enumerate() {
                let place = |name: &str| fields.iter().position(|f| f.0 == name).unwrap_or(0);
                let args: Vec<&Value> = calls[k].1.iter().map(|name| &modules[n][place(name)]).collect();
                let apart = distance(&both.known[n][k], &cpu[k], &gpu[k]);
                if apart.is_nan() || apart > 1.0 {
                    let mut what = format!("emit, {row}: `{}` with", calls[k].0);
                    for (name, value) in calls[k].1.iter().zip(&args) {
                        let _ = write!(what, " {name} = {},", show(value));
                    }
                    let _ = write!(what, " is {} on the CPU and {} on the GPU", show(&cpu[k]), show(&gpu[k]));
                    return Err(Trouble::Differs(what));
                }
                let values = row.result.words() as u64;
                all.add(Compared { runs: 0, passes: 0, values, rounding: apart });
            }
        }
        all.add(Compared { runs: 1, passes: 1, ..Compared::default() });
    }
    Ok(all)
}

fn show(value: &Value) -> String {
    match value {
        Value::Int(i) => i.to_string(),
        Value::Bool(b) => b.to_string(),
        Value::Float(x) => format!("{x:?}"),
        vector => {
            let parts: Vec<String> =
                vector.words().iter().map(|w| format!("{:?}", f32::from_bits(*w))).collect();
            format!("({})", parts.join(", "))
        }
    }
}

/// The rows of a case, by what they take.
type Chosen = fn(&Row) -> bool;

pub(super) fn cases() -> Vec<Case> {
    fn takes_floats(row: &Row) -> bool {
        vector_of(row).is_none() && (row.args.contains(&Type::Float) || row.result == Type::Float)
    }
    fn takes_integers(row: &Row) -> bool {
        vector_of(row).is_none() && !takes_floats(row)
    }
    let of_scalars = |name: &str, chosen: Chosen| {
        Case::new(name, move |engine, _| {
            let rows: Vec<&Row> = TABLE.iter().filter(|r| named(r) && chosen(r)).collect();
            let modules: Vec<_> = (0..MODULES).map(scalars).collect();
            compare(engine, (&SCALARS, argument), &rows, &modules)
        })
    };
    let of_vectors = |ty: Type| {
        Case::new(format!("operations on {ty}"), move |engine, _| {
            let rows: Vec<&Row> = TABLE.iter().filter(|r| named(r) && vector_of(r) == Some(&ty)).collect();
            let modules: Vec<_> = (0..MODULES).map(|n| vectors(&ty, n)).collect();
            compare(engine, (&vector_fields(&ty), argument), &rows, &modules)
        })
    };
    vec![
        of_scalars("operations on int and bool", takes_integers),
        of_scalars("operations on float", takes_floats),
        Case::new("infinities and NaN", |engine, _| {
            let rows: Vec<&Row> = TABLE.iter().filter(|r| named(r) && takes_floats(r)).collect();
            let modules: Vec<_> = (0..MODULES).map(specials).collect();
            compare(engine, (&SPECIAL_FIELDS, special_argument), &rows, &modules)
        }),
        of_vectors(Type::Vec2),
        of_vectors(Type::Vec3),
        of_vectors(Type::Vec4),
    ]
}
