//! Points as rows of numbers with commas between them: two to four coordinates a row.

use super::super::number::write_f32;
use super::super::text::{Element, ParseError, Problem, Token, Wrong};
use super::super::write::WriteError;
use super::Polyline;
use crate::curve::Word;
use crate::language::Value;
use std::io::Write;

/// Reads curves: a point a row, an empty row between curves. A first row that begins with a letter names the columns.
///
/// # Errors
/// A cell that is no finite number, a row of less than two numbers or more than four, or of another number of them than
/// the first.
pub fn parse(text: &[u8]) -> Result<Vec<Polyline>, ParseError> {
    curves(text).map_err(|wrong| wrong.locate(text))
}

fn curves(text: &[u8]) -> Result<Vec<Polyline>, Wrong> {
    let mut curves: Vec<Polyline> = vec![Vec::new()];
    let mut offset = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let (mut columns, mut row) = (None, 0);
    for line in text[offset..].split_inclusive(|&byte| byte == b'\n') {
        let start = offset;
        offset += line.len();
        let cells = line.trim_ascii();
        if cells.is_empty() {
            if curves.last().is_some_and(|curve| !curve.is_empty()) {
                curves.push(Vec::new());
            }
            continue;
        }
        row += 1;
        if row == 1 && cells[0].is_ascii_alphabetic() {
            continue;
        }
        let point = curves.iter().map(Vec::len).sum();
        let mut values = Vec::new();
        let mut at = start;
        for cell in line.split(|&byte| byte == b',') {
            // An empty cell is wrong where it begins, not behind its line break.
            let blank = cell.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(0);
            let token = Token { text: cell.trim_ascii(), offset: at + blank };
            values.push(token.finite(Element::CurveCoordinate { point, axis: values.len().min(3) })?);
            at += cell.len() + 1;
            if values.len() > 4 {
                break;
            }
        }
        let wanted = *columns.get_or_insert(values.len());
        if values.len() != wanted || !(2..=4).contains(&wanted) {
            let problem = Problem::Row { found: values.len(), first: wanted };
            return Err(Wrong { offset: start, problem });
        }
        let mut coordinates = [0.0, 0.0, 0.0, 1.0];
        coordinates[..values.len()].copy_from_slice(&values);
        if let Some(curve) = curves.last_mut() {
            curve.push(coordinates);
        }
    }
    curves.retain(|curve| !curve.is_empty());
    if curves.is_empty() {
        return Err(Wrong {
            offset: text.len(),
            problem: Problem::Missing(Element::CurvePoint { point: 0 }),
        });
    }
    Ok(curves)
}

/// Writes a row for each module: its symbol where there are several, then its parameters, a vector's components in
/// columns of their own; an empty row between words. The first row names the columns of the first module's symbol.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the module.
pub fn write(writer: &mut dyn Write, words: &[&Word]) -> Result<(), WriteError> {
    let mut all = words.iter().flat_map(|word| word.modules.iter().map(move |module| (word, module)));
    let first = all.next();
    let several = all.any(|(_, m)| first.is_some_and(|(_, first)| first.symbol != m.symbol));
    if let Some((word, first)) = first {
        let fields = &word.symbols[first.symbol].fields;
        let mut names: Vec<String> = several.then(|| "symbol".to_string()).into_iter().collect();
        for (field, value) in fields.iter().zip(&first.params) {
            match components(value) {
                1 => names.push(field.name.clone()),
                n => names
                    .extend(["x", "y", "z", "w"][..n].iter().map(|axis| format!("{}.{axis}", field.name))),
            }
        }
        writeln!(writer, "{}", names.join(","))?;
    }
    for (place, word) in words.iter().enumerate() {
        if place > 0 {
            writeln!(writer)?;
        }
        for (n, module) in word.modules.iter().enumerate() {
            let mut row = Vec::new();
            if several {
                row.extend(word.symbols[module.symbol].name.as_bytes());
            }
            for value in &module.params {
                cells(&mut row, value).map_err(|x| {
                    WriteError::not_finite(format_args!("module {n}"), x).of_word(place, words.len())
                })?;
            }
            row.push(b'\n');
            writer.write_all(&row)?;
        }
    }
    Ok(())
}

fn components(value: &Value) -> usize {
    match value {
        Value::Vec2(_) => 2,
        Value::Vec3(_) => 3,
        Value::Vec4(_) => 4,
        _ => 1,
    }
}

/// The cells of a value; the number that is not finite, if there is one.
fn cells(row: &mut Vec<u8>, value: &Value) -> Result<(), f32> {
    let mut put = |text: &dyn Fn(&mut Vec<u8>) -> std::io::Result<()>| {
        if !row.is_empty() {
            row.push(b',');
        }
        // Writing to memory does not fail.
        let _ = text(row);
    };
    let floats: &[f32] = match value {
        Value::Float(x) => std::slice::from_ref(x),
        Value::Vec2(v) => v,
        Value::Vec3(v) => v,
        Value::Vec4(v) => v,
        Value::Int(i) => {
            put(&|row| write!(row, "{i}"));
            return Ok(());
        }
        Value::Bool(b) => {
            put(&|row| write!(row, "{b}"));
            return Ok(());
        }
        Value::List(list) => return list.iter().try_for_each(|v| cells(row, v)),
    };
    match floats.iter().find(|x| !x.is_finite()) {
        Some(&x) => Err(x),
        None => {
            floats.iter().for_each(|&x| put(&|row| write_f32(row, x)));
            Ok(())
        }
    }
}
