//! Values that are bound to a query: `.csv`, one for each root, or a `.json` grid.
//!
//! A line of the `.csv` is a value: a number, `true` or `false`, or the two to four components of a
//! vector with commas between them. The grid is an object: `size` (points along x, y, z), `from` and
//! `to` (where the first and the last of them lie), `values` (x fastest, then y, then z; a vector is
//! an array).

use crate::language::Value;
use crate::language::expr::Type;
use crate::patch::{Grid, Values};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Why no values came of a file.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("cannot read {path}: {source}")]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{path}:{line}:{column}: {message}")]
    Text { path: PathBuf, line: usize, column: usize, message: String },
    #[error("{path}: {message}")]
    Value { path: PathBuf, message: String },
    #[error("cannot read {path}: values are read from .csv (one for each patch) and .json (a grid)")]
    Extension { path: PathBuf },
}

/// Reads values of this type.
///
/// # Errors
/// When the file cannot be read, or is not what the page above says.
pub fn read(path: impl AsRef<Path>, ty: &Type) -> Result<Values, ReadError> {
    let path = path.as_ref();
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let parse: fn(&str, &Type) -> Result<Values, Wrong> = match extension.as_ref().and_then(|e| e.to_str()) {
        Some("csv") => |text, ty| Ok(Values::Roots(parse_csv(text, ty)?)),
        Some("json") => |text, ty| Ok(Values::Grid(parse_json(text, ty)?)),
        _ => return Err(ReadError::Extension { path: path.into() }),
    };
    let text = std::fs::read_to_string(path).map_err(|source| ReadError::Io { path: path.into(), source })?;
    parse(text.trim_start_matches('\u{feff}'), ty).map_err(|wrong| {
        let path = path.into();
        match wrong.place {
            Some((line, column)) => ReadError::Text { path, line, column, message: wrong.message },
            None => ReadError::Value { path, message: wrong.message },
        }
    })
}

/// What is wrong with a text, and where: line and column from 1.
#[derive(Debug)]
pub struct Wrong {
    pub place: Option<(usize, usize)>,
    pub message: String,
}

/// One value a line; lines that are empty at the end do not count.
///
/// # Errors
/// The first line that holds no value of the type.
pub fn parse_csv(text: &str, ty: &Type) -> Result<Vec<Value>, Wrong> {
    let one = |(n, line): (usize, &str)| {
        let mut column = 1;
        let mut parts = Vec::new();
        for cell in line.split(',') {
            let place = Some((n + 1, column + cell.len() - cell.trim_start().len()));
            parts.push(entry(cell.trim()).map_err(|message| Wrong { place, message })?);
            column += cell.chars().count() + 1;
        }
        let entry = if parts.len() == 1 { parts.swap_remove(0) } else { Entry::list(parts) };
        let message = || format!("this line is no {ty}: {}", wanted(ty));
        entry.value(ty).ok_or_else(|| Wrong { place: Some((n + 1, 1)), message: message() })
    };
    text.trim_end().lines().enumerate().map(one).collect()
}

fn entry(cell: &str) -> Result<Entry, String> {
    match cell {
        "true" => Ok(Entry::Bool(true)),
        "false" => Ok(Entry::Bool(false)),
        _ => match cell.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Entry::Number(x)),
            _ => Err(format!("`{cell}` stands where a number, true or false should")),
        },
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
pub fn parse_json(text: &str, ty: &Type) -> Result<Grid, Wrong> {
    let file: File = serde_json::from_str(text).map_err(|e| {
        let message = e.to_string();
        let message = message.split(" at line ").next().unwrap_or(&message);
        let help = "a grid is {\"size\": [x, y, z], \"from\": [x, y, z], \"to\": [x, y, z], \"values\": […]}";
        Wrong { place: Some((e.line(), e.column())), message: format!("{message}; {help}") }
    })?;
    let value = |(n, entry): (usize, &Entry)| {
        let message = || format!("value {n} is no {ty}: {}", wanted(ty));
        entry.value(ty).ok_or_else(|| Wrong { place: None, message: message() })
    };
    let values = file.values.iter().enumerate().map(value).collect::<Result<_, _>>()?;
    Ok(Grid { size: file.size, from: file.from, to: file.to, values })
}
