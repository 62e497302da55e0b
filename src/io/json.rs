//! Words of patches as `.json`: the exact word, in its order, the interface for other programs.
//!
//! ```json
//! {"version":1,"kind":"patch","system":"sierpinski","steps":3,"rational":false,"modules":[
//! {"symbol":"A","params":[3],"root":0,"cell":[2,2,1,3],"net":{"degree":[3,3],"points":[[0.0,0.0,0.0,1.0],…]}}
//! ]}
//! ```
//!
//! One module stands on a line. `cell` is du, dv, i, j; points are homogeneous, (xw, yw, zw, w), flat
//! and row by row. Floats always have a point or an exponent and read back to the same f32, −0.0
//! included; int parameters have neither, so the type of a parameter shows.

use super::number::Number;
use super::text::{ParseError, Problem, ReadError};
use super::write::WriteError;
use crate::language::Value;
use crate::language::system::Field;
use crate::patch::{Cell, Module, Net, Symbol, Word, WordError, net_points};
use crate::word::Params;
use serde::ser::{Serialize, Serializer};
use serde::{Deserialize, Serialize as DeriveSerialize};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use thiserror::Error;

/// Why a text is no word.
#[derive(Debug, Error)]
pub enum WordReadError {
    /// Its text names line and column.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    #[error("this is version {0} of the format; version 1 is wanted")]
    Version(u32),
    #[error("the word is of kind `{0}`; `patch` is wanted")]
    Kind(String),
    #[error("parameter {parameter} of module {module} is `{found}`; {expected}")]
    Parameter { module: usize, parameter: usize, found: String, expected: &'static str },
    #[error("{0}")]
    Word(#[from] WordError),
    #[error("point {point} of module {module} has the weight {weight}; the nets wanted are polynomial")]
    Rational { module: usize, point: usize, weight: f32 },
}

/// What the file says of one module.
#[derive(DeriveSerialize)]
struct Written<'a> {
    symbol: &'a str,
    params: Vec<Parameter<'a>>,
    root: u32,
    cell: [u32; 4],
    net: WrittenNet<'a>,
}

#[derive(DeriveSerialize)]
struct WrittenNet<'a> {
    degree: [u8; 2],
    points: Points<'a>,
}

struct Points<'a>(&'a [[f32; 4]]);

impl Serialize for Points<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(|point| point.map(Number)))
    }
}

struct Parameter<'a>(&'a Value);

impl Serialize for Parameter<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Value::Bool(b) => b.serialize(serializer),
            Value::Int(i) => i.serialize(serializer),
            Value::Float(x) => Number(*x).serialize(serializer),
            Value::Vec2(v) => v.map(Number).serialize(serializer),
            Value::Vec3(v) => v.map(Number).serialize(serializer),
            Value::Vec4(v) => v.map(Number).serialize(serializer),
            Value::List(list) => serializer.collect_seq(list.iter().map(Parameter)),
        }
    }
}

/// Writes a word, module by module.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the module.
pub fn write(writer: &mut dyn Write, word: &Word) -> Result<(), WriteError> {
    write!(writer, r#"{{"version":1,"kind":"patch","system":"#)?;
    to_json(writer, &word.system)?;
    write!(writer, r#","steps":{},"rational":{},"modules":["#, word.steps, word.rational)?;
    for (index, module) in word.modules.iter().enumerate() {
        writer.write_all(if index == 0 { b"\n" } else { b",\n" })?;
        write_module(writer, word, index, module)?;
    }
    writer.write_all(if word.modules.is_empty() { b"]}\n" } else { b"\n]}\n" })?;
    Ok(())
}

fn write_module(
    writer: &mut dyn Write,
    word: &Word,
    index: usize,
    module: &Module,
) -> Result<(), WriteError> {
    let Some(symbol) = word.symbols.get(module.symbol) else {
        return Err(WriteError::Unsupported(format!("module {index} has no symbol")));
    };
    let points = word.net(index);
    let params = word.params(index).to_vec();
    for (parameter, value) in params.iter().enumerate() {
        if let Some(value) = floats(value).into_iter().find(|x| !x.is_finite()) {
            let element = format_args!("parameter {parameter} of module {index} ({})", symbol.name);
            return Err(WriteError::not_finite(element, value));
        }
    }
    for (point, coordinates) in points.iter().enumerate() {
        if let Some(&value) = coordinates.iter().find(|x| !x.is_finite()) {
            let element = format_args!("point {point} of module {index} ({})", symbol.name);
            return Err(WriteError::not_finite(element, value));
        }
    }
    let Cell { du, dv, i, j } = module.cell;
    let written = Written {
        symbol: &symbol.name,
        params: params.iter().map(Parameter).collect(),
        root: module.root,
        cell: [du.into(), dv.into(), i, j],
        net: WrittenNet { degree: word.degree, points: Points(points) },
    };
    to_json(writer, &written)
}

fn to_json(writer: &mut dyn Write, value: &impl Serialize) -> Result<(), WriteError> {
    serde_json::to_writer(writer, value).map_err(|error| WriteError::Io(error.into()))
}

fn floats(value: &Value) -> Vec<f32> {
    match value {
        Value::Bool(_) | Value::Int(_) => Vec::new(),
        Value::Float(x) => vec![*x],
        Value::Vec2(v) => v.to_vec(),
        Value::Vec3(v) => v.to_vec(),
        Value::Vec4(v) => v.to_vec(),
        Value::List(list) => list.iter().flat_map(floats).collect(),
    }
}

#[derive(Deserialize)]
struct ReadFile {
    system: String,
    steps: u32,
    rational: bool,
    modules: Vec<ReadModule>,
}

#[derive(Deserialize)]
struct ReadModule {
    symbol: String,
    params: Vec<serde_json::Value>,
    root: u32,
    cell: (u8, u8, u32, u32),
    net: ReadNet,
}

#[derive(Deserialize)]
struct ReadNet {
    degree: [u8; 2],
    points: Vec<[f32; 4]>,
}

/// Just enough to tell what a file is.
#[derive(Deserialize)]
struct ReadHead {
    version: u32,
    kind: String,
}

/// Reads the nets of the word in a file, in its order; symbols and parameters are left out. Unless
/// `rational`, all weights must be 1.
///
/// # Errors
/// When the file cannot be read, or as [`parse`] says; [`WordReadError::Rational`].
pub fn read_nets(path: impl AsRef<Path>, rational: bool) -> Result<Vec<Net>, ReadError> {
    let path = path.as_ref();
    let text = ReadError::bytes(path)?;
    let word = parse(&text).map_err(|error| match error {
        WordReadError::Json(error) => ReadError::Text { path: path.into(), error: place(&text, &error) },
        error => ReadError::Word { path: path.into(), error: Box::new(error) },
    })?;
    match word.nets.iter().position(|point| !rational && point[3] != 1.0) {
        Some(index) => {
            let (module, point) = (index / word.net_points(), index % word.net_points());
            let error = WordReadError::Rational { module, point, weight: word.nets[index][3] };
            Err(ReadError::Word { path: path.into(), error: Box::new(error) })
        }
        None => {
            let nets = word.nets.chunks(word.net_points());
            Ok(nets.map(|points| Net { degree: word.degree, points: points.to_vec() }).collect())
        }
    }
}

/// An error of the JSON reader, which counts columns in bytes and says the place behind its words.
pub(super) fn place(text: &[u8], error: &serde_json::Error) -> ParseError {
    let (line, column) = (error.line().max(1), error.column().max(1));
    let said = error.to_string();
    let problem = said.rsplit_once(" at line ").map_or(said.as_str(), |(problem, _)| problem);
    let bytes = text.split(|&byte| byte == b'\n').nth(line - 1).unwrap_or_default();
    let before = &bytes[..(column - 1).min(bytes.len())];
    let column = String::from_utf8_lossy(before).chars().count() + 1;
    ParseError { line, column, problem: Problem::Json(problem.into()) }
}

/// Reads a word that [`write()`] wrote, or another program.
///
/// What the file does not say is made up: the symbols are those that occur, in order of appearance,
/// their fields named `p0`, `p1` …; the key of a module counts the modules of its root, which keeps
/// the order but is no path; a word without modules has the degrees 3 and 3.
///
/// # Errors
/// When the text is no such word, or the word does not hold together ([`Word::validate`]).
pub fn parse(text: &[u8]) -> Result<Word, WordReadError> {
    let head: ReadHead = serde_json::from_slice(text)?;
    if head.version != 1 {
        return Err(WordReadError::Version(head.version));
    }
    if head.kind != "patch" {
        return Err(WordReadError::Kind(head.kind));
    }
    let file: ReadFile = serde_json::from_slice(text)?;
    let degree = file.modules.first().map_or([3, 3], |module| module.net.degree);
    let mut word = Word {
        system: file.system,
        steps: file.steps,
        symbols: Vec::new(),
        degree,
        rational: file.rational,
        modules: Vec::with_capacity(file.modules.len()),
        params: Params::default(),
        nets: Vec::new(),
    };
    let mut symbols = BTreeMap::new();
    let mut keys = BTreeMap::new();
    for (index, module) in file.modules.into_iter().enumerate() {
        check_net(index, &module.net, degree)?;
        word.nets.extend_from_slice(&module.net.points);
        let params = parameters(index, &module.params)?;
        let symbol = *symbols.entry(module.symbol).or_insert_with_key(|name| {
            let symbol = symbol(name, &params);
            word.params.add_symbol(&symbol.fields);
            word.symbols.push(symbol);
            word.symbols.len() - 1
        });
        let next_key = keys.entry(module.root).or_insert(0u64);
        let key = *next_key;
        *next_key += 1;
        let (du, dv, i, j) = module.cell;
        let cell = Cell { du, dv, i, j };
        let row = word.params.push(symbol, &params);
        let row = row.map_err(|e| WordError::of_params(index, &word.symbols[symbol], e))?;
        word.modules.push(Module { symbol, row, root: module.root, key, cell });
    }
    word.validate()?;
    Ok(word)
}

fn check_net(module: usize, net: &ReadNet, degree: [u8; 2]) -> Result<(), WordError> {
    if net.degree != degree {
        return Err(WordError::MixedDegrees { module, first: degree, found: net.degree });
    }
    let (found, expected) = (net.points.len(), net_points(degree));
    if found != expected { Err(WordError::Points { module, found, expected }) } else { Ok(()) }
}

fn symbol(name: &str, params: &[Value]) -> Symbol {
    let field = |(index, value): (usize, &Value)| Field { name: format!("p{index}"), ty: value.ty() };
    Symbol { name: name.into(), fields: params.iter().enumerate().map(field).collect() }
}

fn parameters(module: usize, params: &[serde_json::Value]) -> Result<Vec<Value>, WordReadError> {
    let read = |(parameter, found): (usize, &serde_json::Value)| {
        self::parameter(found).map_err(|expected| WordReadError::Parameter {
            module,
            parameter,
            found: found.to_string(),
            expected,
        })
    };
    params.iter().enumerate().map(read).collect()
}

/// A parameter by its look, or what is wrong with it.
fn parameter(found: &serde_json::Value) -> Result<Value, &'static str> {
    const KINDS: &str = "true, false, a number or an array of 2, 3 or 4 numbers is wanted";
    match found {
        serde_json::Value::Bool(b) => Ok(Value::Bool(*b)),
        serde_json::Value::Number(number) if number.is_f64() => float(found).map(Value::Float),
        serde_json::Value::Number(number) => {
            let int = number.as_i64().and_then(|i| i32::try_from(i).ok());
            int.map(Value::Int).ok_or("an int has 32 bits")
        }
        serde_json::Value::Array(elements) => {
            let floats = elements.iter().map(float).collect::<Result<Vec<f32>, _>>()?;
            match floats[..] {
                [x, y] => Ok(Value::Vec2([x, y])),
                [x, y, z] => Ok(Value::Vec3([x, y, z])),
                [x, y, z, w] => Ok(Value::Vec4([x, y, z, w])),
                _ => Err(KINDS),
            }
        }
        _ => Err(KINDS),
    }
}

fn float(found: &serde_json::Value) -> Result<f32, &'static str> {
    let x = found.as_f64().ok_or("a number is wanted")? as f32;
    if x.is_finite() { Ok(x) } else { Err("a number in the range of 32-bit floats is wanted") }
}
