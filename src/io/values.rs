//! Values that are bound to a query: `.csv`, one for each root, or a `.json` grid.
//!
//! A line of the `.csv` is a value: a number, `true` or `false`, or the two to four components of a
//! vector with commas between them. The grid is an object: `size` (points along x, y, z), `from` and
//! `to` (where the first and the last of them lie), `values` (x fastest, then y, then z; a vector is
//! an array).

use super::json;
use super::text::{ParseError, Problem, ReadError};
use crate::language::Value;
use crate::language::expr::Type;
use crate::patch::{Grid, Values};
use serde::Deserialize;
use std::path::Path;

/// Reads values of this type.
///
/// # Errors
/// When the file cannot be read, or is not what the page above says.
pub fn read(path: impl AsRef<Path>, ty: &Type) -> Result<Values, ReadError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let refuse = "values are read from .csv (one for each patch) and .json (a grid)";
    let parse: fn(&[u8], &Type) -> Result<Values, Wrong> = match extension.as_ref().and_then(|e| e.to_str()) {
        Some("csv") => |text, ty| Ok(Values::Roots(parse_csv(text, ty)?)),
        Some("json") => |text, ty| Ok(Values::Grid(parse_json(text, ty)?)),
        _ => return Err(ReadError::Format { path: path.into(), help: refuse }),
    };
    let text = ReadError::bytes(path)?;
    parse(&text, ty).map_err(|wrong| match wrong {
        Wrong::Text(error) => ReadError::Text { path: path.into(), error },
        Wrong::Value(message) => ReadError::Values { path: path.into(), message },
    })
}

/// What is wrong with values.
#[derive(Debug)]
pub enum Wrong {
    Text(ParseError),
    /// A value of a grid, named in the message.
    Value(String),
}

/// One value a line; lines that are empty at the end do not count.
///
/// # Errors
/// The first line that holds no value of the type.
pub fn parse_csv(text: &[u8], ty: &Type) -> Result<Vec<Value>, Wrong> {
    let text = String::from_utf8_lossy(text);
    let one = |(n, line): (usize, &str)| {
        let wrong = |column, problem| Wrong::Text(ParseError { line: n + 1, column, problem });
        let mut column = 1;
        let mut parts = Vec::new();
        for cell in line.split(',') {
            let start = column + cell.chars().take_while(|c| c.is_whitespace()).count();
            let found = cell.trim();
            // Spreadsheets may put all into quotes.
            let found =
                found.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')).map_or(found, str::trim);
            let part =
                entry(found).ok_or_else(|| wrong(start, Problem::NotAValue { found: found.into() }))?;
            parts.push(part);
            column += cell.chars().count() + 1;
        }
        let entry = if parts.len() == 1 { parts.swap_remove(0) } else { Entry::list(parts) };
        let other = || wrong(1, Problem::OtherType { ty: ty.clone(), wanted: wanted(ty) });
        entry.value(ty).ok_or_else(other)
    };
    text.trim_end().lines().enumerate().map(one).collect()
}

fn entry(cell: &str) -> Option<Entry> {
    match cell {
        "true" => Some(Entry::Bool(true)),
        "false" => Some(Entry::Bool(false)),
        _ => cell.parse::<f64>().ok().filter(|x| x.is_finite()).map(Entry::Number),
    }
}

/// A value as either file writes it.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Entry {
    Bool(bool),
    Number(f64),
    Vector(Vec<f64>),
}

impl Entry {
    fn list(parts: Vec<Entry>) -> Entry {
        let number = |e| match e {
            Entry::Number(x) => x,
            // No component: then no type has a value like this.
            _ => f64::NAN,
        };
        Entry::Vector(parts.into_iter().map(number).collect())
    }

    /// As a value of the type, if it is one; floats are rounded once.
    fn value(&self, ty: &Type) -> Option<Value> {
        let float = |x: f64| Some(x as f32).filter(|x| x.is_finite());
        let vector = |v: &[f64]| v.iter().map(|&x| float(x)).collect::<Option<Vec<f32>>>();
        match (ty, self) {
            (Type::Bool, Entry::Bool(b)) => Some(Value::Bool(*b)),
            (Type::Int, Entry::Number(x)) if *x as i32 as f64 == *x => Some(Value::Int(*x as i32)),
            (Type::Float, Entry::Number(x)) => Some(Value::Float(float(*x)?)),
            (Type::Vec2, Entry::Vector(v)) => Some(Value::Vec2(vector(v)?.try_into().ok()?)),
            (Type::Vec3, Entry::Vector(v)) => Some(Value::Vec3(vector(v)?.try_into().ok()?)),
            (Type::Vec4, Entry::Vector(v)) => Some(Value::Vec4(vector(v)?.try_into().ok()?)),
            _ => None,
        }
    }
}

fn wanted(ty: &Type) -> &'static str {
    match ty {
        Type::Bool => "write true or false",
        Type::Int => "write a whole number of 32 bits",
        Type::Float => "write one number within the range of 32-bit floats",
        Type::Vec2 => "write two numbers",
        Type::Vec3 => "write three numbers",
        Type::Vec4 => "write four numbers",
        Type::List(..) => "lists are constants",
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    size: [u32; 3],
    from: [f32; 3],
    to: [f32; 3],
    values: Vec<Entry>,
}

/// A grid. Whether there are as many values as points is looked at when it is bound.
///
/// # Errors
/// Text that is no such object; a value that is not of the type.
pub fn parse_json(text: &[u8], ty: &Type) -> Result<Grid, Wrong> {
    let file: File = serde_json::from_slice(text).map_err(|e| {
        let mut error = json::place(text, &e);
        let help = "a grid is {\"size\": [x, y, z], \"from\": [x, y, z], \"to\": [x, y, z], \"values\": […]}";
        error.problem = Problem::Json(format!("{}; {help}", error.problem));
        Wrong::Text(error)
    })?;
    let value = |(n, entry): (usize, &Entry)| {
        let wrong = || Wrong::Value(format!("value {n} is no {ty}: {}", wanted(ty)));
        entry.value(ty).ok_or_else(wrong)
    };
    let values = file.values.iter().enumerate().map(value).collect::<Result<_, _>>()?;
    Ok(Grid { size: file.size, from: file.from, to: file.to, values })
}
