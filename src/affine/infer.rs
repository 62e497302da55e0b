//! From a subdivision matrix to the rule that has it (section 5 of the paper).
//!
//! With arity c and shift d the children of P(i) are the new points c·i + d to c·i + d + c − 1, counted from 0, so the
//! production is read from these rows as combinations of what stands around P(i). Another shift gives another rule, of
//! the same curve turned. A matrix that is k times as wide as high makes one point of k; its rule replaces k.

use super::form::Row;
use super::matrix::Matrix;
use super::number::Number;
use crate::language::rational::Rational;
use crate::language::{Severity, Vocabulary, compile};
use std::fmt::Write;

/// Why a matrix has no rule. Rows and columns count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InferError {
    #[error("the matrix is empty")]
    Empty,
    #[error("row {row}, column {column}: `{text}` is no number and no fraction such as 3/4")]
    Entry { row: usize, column: usize, text: String },
    #[error("row {row} ends at column {found}, row 1 at column {first}")]
    Ragged { row: usize, found: usize, first: usize },
    #[error("{rows} rows and {columns} columns: neither number is a multiple of the other")]
    Size { rows: usize, columns: usize },
    #[error(
        "row {row}, column {column}: not periodic: {found} stands here, and {expected} one module before, in row {above}, \
         column {left}"
    )]
    Period { row: usize, column: usize, found: String, expected: String, above: usize, left: usize },
    #[error("row {row}, column {column}: not banded: the rows of one module have entries in every column")]
    Band { row: usize, column: usize },
    #[error(
        "row {row}, column {column}: this entry asks for a context {depth} deep on the {side}; \
         contexts are at most {MOST_DEPTH} deep"
    )]
    Deep { row: usize, column: usize, depth: i64, side: &'static str },
    #[error("the matrix is {times} times as {way}; a rule {does} at most {most} points")]
    Long { times: usize, way: &'static str, does: &'static str, most: usize },
    #[error("`{0}` cannot be the name of a system")]
    Name(String),
    #[error("the rule that was found does not check: {0}")]
    Rule(String),
}

/// How deep contexts can be.
const MOST_DEPTH: i64 = 8;

/// Points that a rule can replace, and make.
const MOST_STRICT: usize = 8;
const MOST_CHILDREN: usize = 255;

/// Reads a matrix: a row a line, its entries with commas between, numbers or fractions as `-1/16`. Empty lines are skipped.
///
/// # Errors
/// [`InferError::Empty`], [`InferError::Entry`], [`InferError::Ragged`].
pub fn parse(text: &str) -> Result<Matrix, InferError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut columns = None;
    let mut rows = Vec::new();
    for (n, line) in text.lines().filter(|line| !line.trim().is_empty()).enumerate() {
        let mut row = Row::new();
        let mut found = 0;
        for cell in line.split(',') {
            found += 1;
            let wrong = || {
                let text = cell.trim().chars().take(40).collect();
                InferError::Entry { row: n + 1, column: found, text }
            };
            let x = fraction(cell.trim()).ok_or_else(wrong)?;
            if !x.is_zero() {
                row.push((found as u32 - 1, Number::Exact(x)));
            }
        }
        let first = *columns.get_or_insert(found);
        if found != first {
            return Err(InferError::Ragged { row: n + 1, found, first });
        }
        rows.push(row);
    }
    columns.map(|columns| Matrix { columns, rows }).ok_or(InferError::Empty)
}

fn fraction(text: &str) -> Option<Rational> {
    let (negative, text) = match text.strip_prefix(['-', '−']) {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let numeral = |text: &str| {
        let text = text.trim();
        text.starts_with(|c: char| c.is_ascii_digit() || c == '.').then_some(())?;
        text.contains(|c: char| c.is_ascii_digit()).then(|| Rational::parse(text))?
    };
    let value = match text.split_once('/') {
        Some((n, d)) => numeral(n)?.checked_div(numeral(d)?)?,
        None => numeral(text)?,
    };
    if negative { value.checked_neg() } else { Some(value) }
}

/// A rule file of this name whose matrix on a ring this is, with the shift d. Its axiom is a regular polygon of as many
/// points as the matrix has columns.
///
/// # Errors
/// A matrix that is not periodic or not banded, with row and column; one that no rule can have.
pub fn infer(matrix: &Matrix, shift: i64, name: &str) -> Result<String, InferError> {
    check_name(name)?;
    let production = Production::of(matrix, shift)?;
    let (rows, columns) = (matrix.rows.len(), matrix.columns);
    let mut text = format!("// Of a subdivision matrix of {rows} × {columns}, with shift {shift}.\n");
    // Writing to a string does not fail.
    let _ = writeln!(text, "system {name} : curve ring\nmodule P(v: vec2)\naxiom: [");
    for i in 0..columns {
        let angle = std::f64::consts::TAU * i as f64 / columns as f64;
        let round = |x: f64| (x * 1e4).round() / 1e4 + 0.0;
        let comma = if i + 1 < columns { "," } else { "" };
        let _ = writeln!(text, "  ({}, {}){comma}", round(angle.cos()), round(angle.sin()));
    }
    let _ = write!(text, "]\nrules:\n  {}\nrun:\n  derive 1\n", production.text());
    let checked = compile(&text, &Vocabulary::default());
    match checked.diagnostics.iter().find(|d| d.severity == Severity::Error) {
        Some(error) => Err(InferError::Rule(error.message.clone())),
        None => Ok(text),
    }
}

fn check_name(name: &str) -> Result<(), InferError> {
    let plain = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let checked = compile(&format!("system {name} : curve ring\nmodule P\n"), &Vocabulary::default());
    match plain && !checked.diagnostics.iter().any(|d| d.severity == Severity::Error) {
        true => Ok(()),
        false => Err(InferError::Name(name.to_string())),
    }
}

/// What is made of some points that stand side by side.
struct Production {
    /// How many are replaced.
    width: usize,
    /// The first and last place, from that of the first replaced, that is read.
    low: i64,
    high: i64,
    /// For each new point its coefficients, by place.
    rows: Vec<Vec<(i64, Number)>>,
}

impl Production {
    fn of(matrix: &Matrix, shift: i64) -> Result<Production, InferError> {
        let (n, m) = (matrix.rows.len(), matrix.columns);
        let (height, width) = match (n, m) {
            (0, _) | (_, 0) => return Err(InferError::Empty),
            _ if n.is_multiple_of(m) => (n / m, 1),
            _ if m.is_multiple_of(n) => (1, m / n),
            _ => return Err(InferError::Size { rows: n, columns: m }),
        };
        if width > MOST_STRICT {
            let (way, does) = ("wide as high", "replaces");
            return Err(InferError::Long { times: width, way, does, most: MOST_STRICT });
        }
        if height > MOST_CHILDREN {
            let (way, does) = ("high as wide", "makes");
            return Err(InferError::Long { times: height, way, does, most: MOST_CHILDREN });
        }
        if let Err((row, column)) = matrix.repeats(height, width) {
            let (above, left) = ((row + n - height) % n, (column + m - width % m) % m);
            return Err(InferError::Period {
                row: row + 1,
                column: column + 1,
                found: matrix.get(row, column).to_string(),
                expected: matrix.get(above, left).to_string(),
                above: above + 1,
                left: left + 1,
            });
        }
        let lines: Vec<usize> =
            (0..height as i64).map(|j| (j + shift).rem_euclid(n as i64) as usize).collect();
        // Where the new points stand among the old ones.
        let middle = (shift as f64 + (height as f64 - 1.0) / 2.0) * width as f64 / height as f64
            + (width as f64 - 1.0) / 2.0;
        let (low, high) = band(matrix, &lines, middle)?;
        let wide = high - low + 1;
        let place = |column: u32| low + (i64::from(column) - low).rem_euclid(m as i64);
        let row = |&line: &usize| {
            let mut row: Vec<(i64, Number)> = matrix.rows[line].iter().map(|&(c, x)| (place(c), x)).collect();
            row.sort_by_key(|e| e.0);
            row
        };
        let rows: Vec<_> = lines.iter().map(row).collect();
        debug_assert!(rows.iter().flatten().all(|e| e.0 < low + wide));
        let production = Production { width, low, high, rows };
        let deep = |place: i64, depth: i64, side| {
            let holds = |&j: &usize| production.rows[j].iter().any(|e| e.0 == place);
            let row = lines[(0..height).find(holds).unwrap_or(0)] + 1;
            let column = place.rem_euclid(m as i64) as usize + 1;
            InferError::Deep { row, column, depth, side }
        };
        match (-low, high - width as i64 + 1) {
            (left, _) if left > MOST_DEPTH => Err(deep(low, left, "left")),
            (_, right) if right > MOST_DEPTH => Err(deep(high, right, "right")),
            _ => Ok(production),
        }
    }

    /// As the language writes it, with the paper's names.
    fn text(&self) -> String {
        let width = self.width as i64;
        // A point of no weights at all is none of the first.
        let nothing = self.rows.iter().any(|row| row.is_empty());
        let read = |place: i64| place == 0 && nothing || self.rows.iter().flatten().any(|e| e.0 == place);
        let name = |place: i64| match place {
            ..0 => format!("v{}", "l".repeat(place.unsigned_abs() as usize)),
            0 if width == 1 => "v".to_string(),
            _ if place < width => format!("v{}", char::from(b'a' + place as u8)),
            _ => format!("v{}", "r".repeat((place - width + 1) as usize)),
        };
        let pattern =
            |place: i64| if read(place) { format!("P({})", name(place)) } else { "P(_)".to_string() };
        let patterns = |places: std::ops::Range<i64>| places.map(pattern).collect::<Vec<_>>().join(" ");
        let mut text = String::new();
        if self.low < 0 {
            text += &format!("{} < ", patterns(self.low..0));
        }
        text += &patterns(0..width);
        if self.high >= width {
            text += &format!(" > {}", patterns(width..self.high + 1));
        }
        text += " ->";
        for row in &self.rows {
            let mut sum = String::new();
            for &(place, x) in row {
                let negative = x.to_f64() < 0.0;
                let sign = match (sum.is_empty(), negative) {
                    (true, true) => "-",
                    (true, false) => "",
                    (false, true) => " - ",
                    (false, false) => " + ",
                };
                let size = if negative { -x } else { x };
                let factor = match size.exact() {
                    Some(Rational::ONE) => String::new(),
                    Some(x) => format!("{x}*"),
                    None => format!("{}*", size.to_f64()),
                };
                sum += &format!("{sign}{factor}{}", name(place));
            }
            if sum.is_empty() {
                sum = format!("0*{}", name(0));
            }
            text += &format!(" P({sum})");
        }
        text
    }
}

/// The first and last place, around the end of the ring, between which these rows have all their entries, and as near to
/// `middle` as can be.
fn band(matrix: &Matrix, lines: &[usize], middle: f64) -> Result<(i64, i64), InferError> {
    let m = matrix.columns;
    let mut used = vec![false; m];
    for &(column, _) in lines.iter().flat_map(|&line| &matrix.rows[line]) {
        used[column as usize] = true;
    }
    let from_middle = |low: i64, high: i64| ((low + high) as f64 / 2.0 - middle).abs();
    let turned = |low: i64, high: i64| {
        let turns = ((middle - (low + high) as f64 / 2.0) / m as f64).round() as i64 * m as i64;
        (low + turns, high + turns)
    };
    // Behind each run of empty columns a band begins, and before it one ends.
    let begins = (0..m).filter(|&c| used[c] && !used[(c + m - 1) % m]);
    let bands = begins.map(|low| {
        let gap = (1..=m).take_while(|k| !used[(low + m - k) % m]).count();
        turned(low as i64, (low + m - gap) as i64 - 1)
    });
    let best = bands.min_by(|a, b| {
        (a.1 - a.0).cmp(&(b.1 - b.0)).then(from_middle(a.0, a.1).total_cmp(&from_middle(b.0, b.1)))
    });
    match best {
        Some(band) => Ok(band),
        None if used.contains(&true) && m > 1 => {
            let far = (middle + m as f64 / 2.0).round().rem_euclid(m as f64) as usize % m;
            let holds = |line: &&usize| matrix.rows[**line].iter().any(|e| e.0 as usize == far);
            let row = lines.iter().find(holds).map_or(1, |line| line + 1);
            Err(InferError::Band { row, column: far + 1 })
        }
        None => Ok((0, 0)),
    }
}
