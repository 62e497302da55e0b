//! Points as rows of numbers with commas between them: two to four coordinates a row.

use super::super::number::write_f32;
use super::super::text::{Element, ParseError, Problem, Token, Wrong};
use super::super::write::WriteError;
use super::Polyline;
use crate::curve::Word;
use crate::language::{Type, Value};
use std::io::Write;

/// Reads curves: a point a row, an empty row between curves, `coordinates` (2 to 4) columns at most. Cells may stand in
/// quotes, numbers too. A first row without a number names the columns, of which there are as many as of each row; where it
/// names one of x, y, z and w, or `NAME.x` and so on, they must stand in this order.
/// A curve of four rows or more that ends in its first point has it once and is closed; of others the file does not say
/// whether they are.
///
/// # Errors
/// A cell that is no finite number, a row of fewer than two or of too many columns, or of another number than the first.
pub fn parse(text: &[u8], coordinates: usize) -> Result<Vec<Polyline>, ParseError> {
    curves(text, coordinates.clamp(2, 4)).map_err(|wrong| wrong.locate(text))
}

/// The columns that are taken.
fn wanted(coordinates: usize) -> &'static str {
    ["x,y", "x,y or x,y,z", "x,y or x,y,z or x,y,z,w"][coordinates - 2]
}

fn curves(text: &[u8], coordinates: usize) -> Result<Vec<Polyline>, Wrong> {
    let mut curves: Vec<Vec<[f32; 4]>> = vec![Vec::new()];
    let mut offset = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let (mut columns, mut names, mut row, mut points) = (None, None, 0, 0);
    for line in text[offset..].split_inclusive(|&byte| byte == b'\n') {
        let start = offset;
        offset += line.len();
        if line.trim_ascii().is_empty() {
            if curves.last().is_some_and(|curve| !curve.is_empty()) {
                curves.push(Vec::new());
            }
            continue;
        }
        row += 1;
        let cells = || cells_of(line, start);
        if row == 1 && is_header(cells()) {
            check_names(cells(), coordinates)?;
            names = Some(cells().take(MOST_COLUMNS).count());
            continue;
        }
        // A row may be as long as the file.
        let found = cells().take(MOST_COLUMNS).count();
        let first = *columns.get_or_insert(found);
        if !(2..=coordinates).contains(&found) && found == first {
            let found = match found {
                1 => "1 column".to_string(),
                MOST_COLUMNS => format!("{found} columns or more"),
                _ => format!("{found} columns"),
            };
            return Err(Wrong {
                offset: start,
                problem: Problem::Columns { found, wanted: wanted(coordinates) },
            });
        }
        // A name too few or too many: which column is which, nobody knows.
        if let Some(names) = names.filter(|&names| names != first) {
            return Err(Wrong { offset: start, problem: Problem::Names { found, names } });
        }
        let mut point = [0.0, 0.0, 0.0, 1.0];
        for (axis, (value, cell)) in point.iter_mut().zip(cells()).enumerate() {
            let element = coordinate(points, axis);
            if has_decimal_comma(&cell) {
                return Err(cell.wrong(Problem::DecimalComma { expected: element, found: cell.shown() }));
            }
            *value = cell.finite(element)?;
        }
        if found != first {
            return Err(Wrong { offset: start, problem: Problem::Row { found, first } });
        }
        if let Some(curve) = curves.last_mut() {
            curve.push(point);
        }
        points += 1;
    }
    curves.retain(|curve| !curve.is_empty());
    if curves.is_empty() {
        return Err(Wrong {
            offset: text.len(),
            problem: Problem::Missing(Element::CurvePoint { point: 0 }),
        });
    }
    Ok(curves.into_iter().map(ended).collect())
}

/// Columns that are counted.
const MOST_COLUMNS: usize = 100;

fn coordinate(point: usize, axis: usize) -> Element {
    Element::CurveCoordinate { point, axis }
}

/// The cells of a line without the quotes around them, in which commas are no ends of cells.
fn cells_of(line: &[u8], start: usize) -> impl Iterator<Item = Token<'_>> {
    let mut rest = Some((line, start));
    std::iter::from_fn(move || {
        let (line, at) = rest?;
        // An empty cell is wrong where it begins, not after its line break.
        let blank = line.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(0);
        let quoted = closing_quote(&line[blank..]).map_or(0, |close| blank + close + 1);
        let length = line[quoted..].iter().position(|&byte| byte == b',').map(|comma| quoted + comma);
        rest = length.map(|length| (&line[length + 1..], at + length + 1));
        let cell = line[..length.unwrap_or(line.len())].trim_ascii();
        // What stands behind the quotes is a part of the cell, as they are then.
        let text = match cell {
            [b'"', inner @ .., b'"'] if quoted == blank + cell.len() => inner.trim_ascii(),
            _ => cell,
        };
        Some(Token { text, offset: at + blank })
    })
}

/// Where the quotes close that this text begins with; two in a row are one inside.
fn closing_quote(text: &[u8]) -> Option<usize> {
    let mut at = usize::from(text.first() == Some(&b'"'));
    while at > 0 {
        at += text[at..].iter().position(|&byte| byte == b'"')?;
        if text.get(at + 1) != Some(&b'"') {
            return Some(at);
        }
        at += 2;
    }
    None
}

/// Two whole numbers with a comma between, as spreadsheets write decimals in half of the world: quotes hold it together.
fn has_decimal_comma(cell: &Token) -> bool {
    cell.text.contains(&b',') && {
        let text: Vec<u8> = cell.text.iter().map(|&byte| if byte == b',' { b'.' } else { byte }).collect();
        Token { text: &text, ..*cell }.parse::<f64>().is_some()
    }
}

/// Names of columns: no cell is a number, of which NaN is one, and the first begins as a name does.
fn is_header<'a>(mut cells: impl Iterator<Item = Token<'a>>) -> bool {
    let name =
        |cell: &Token| matches!(cell.text.first(), Some(b'_' | b'#' | b'a'..=b'z' | b'A'..=b'Z' | 0x80..));
    let number = |cell: &Token| cell.parse::<f64>().is_some();
    let first = cells.next();
    first.is_some_and(|cell| name(&cell) && !number(&cell)) && !cells.any(|cell| number(&cell))
}

/// Where one of the names is that of a coordinate, all are, in their order.
fn check_names<'a>(cells: impl Iterator<Item = Token<'a>>, coordinates: usize) -> Result<(), Wrong> {
    const AXES: [&str; 4] = ["x", "y", "z", "w"];
    let names: Vec<(Token, String)> = cells.take(MOST_COLUMNS).map(|cell| (cell, axis_of(&cell))).collect();
    let known = |name: &str| AXES.contains(&name);
    let wrong = names.iter().enumerate().find(|(n, (_, name))| AXES.get(*n).is_none_or(|axis| axis != name));
    match wrong {
        Some((_, (cell, _))) if names.iter().any(|(_, name)| known(name)) => {
            let found = names.iter().take(8).map(|(cell, _)| cell.shown()).collect::<Vec<_>>().join(",");
            Err(cell.wrong(Problem::ColumnNames { found, wanted: wanted(coordinates) }))
        }
        _ => Ok(()),
    }
}

/// The axis that a name of a column ends in, as in `v.x`, `"X"` and `x [mm]`.
fn axis_of(cell: &Token) -> String {
    let name = String::from_utf8_lossy(cell.text).to_ascii_lowercase();
    let name = name.trim_matches(|c: char| c == '"' || c == '#' || c.is_whitespace());
    let name = name.split_whitespace().next().unwrap_or_default();
    name.rsplit('.').next().unwrap_or_default().to_string()
}

fn ended(mut points: Vec<[f32; 4]>) -> Polyline {
    if points.len() > 3 && points.first() == points.last() {
        points.pop();
        return Polyline { points, closed: Some(true) };
    }
    points.into()
}

/// Writes a row for each module: its symbol where there are several or a module has no parameters, then its parameters, a vector's components in
/// columns of their own; an empty row between words. The first row names the columns of the first module's symbol.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the module.
pub fn write(writer: &mut dyn Write, words: &[&Word]) -> Result<(), WriteError> {
    let mut all = words.iter().flat_map(|word| word.modules.iter().map(move |m| (word, m.symbol)));
    let first = all.next();
    let without = |(word, symbol): (&&Word, usize)| word.symbols[symbol].fields.is_empty();
    // A module without parameters would be an empty row.
    let several = first.is_some_and(&without)
        || all.any(|other| first.is_some_and(|first| first.1 != other.1) || without(other));
    if let Some((word, first)) = first {
        let fields = &word.symbols[first].fields;
        let mut names: Vec<String> = several.then(|| "symbol".to_string()).into_iter().collect();
        for field in fields {
            match components(&field.ty) {
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
            for value in word.params(n).iter() {
                cells(&mut row, &value).map_err(|x| {
                    WriteError::not_finite(format_args!("module {n}"), x).of_word(place, words.len())
                })?;
            }
            row.push(b'\n');
            writer.write_all(&row)?;
        }
    }
    Ok(())
}

fn components(ty: &Type) -> usize {
    match ty {
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 => 4,
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
