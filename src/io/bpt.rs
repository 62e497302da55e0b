//! Files of Bézier nets: `.bpt`.
//!
//! ```text
//! 2            number of patches
//! 3 3          degrees m and n of the first
//! 0 0 0        (m + 1)(n + 1) points `x y z` or, with a weight, `x y z w`; row by row
//! …
//! ```
//!
//! Files hold Euclidean points; memory holds homogeneous ones, (xw, yw, zw, w). A weight of 1 is
//! understood where none is written.
//!
//! Lines may break anywhere, which leaves it open whether a point has three numbers or four. Where
//! every line holds what the form above says, the lines decide, point by point. Otherwise all points
//! of the file have three numbers if that uses up the file exactly, else all have four.

use super::number::{write_f32, write_f64, write_usize};
use super::text::{self, Element, ParseError, Problem, ReadError, Tokens, Wrong};
use super::write::{WriteError, check_point};
use crate::patch::{Net, Word};
use std::io::{self, Write};
use std::path::Path;

/// Reads the nets of a file: [`parse`] with the path in every error.
///
/// # Errors
/// When the file cannot be read or its text is wrong.
pub fn read(path: impl AsRef<Path>, rational: bool) -> Result<Vec<Net>, ReadError> {
    ReadError::in_file(path.as_ref(), |text| parse(text, rational))
}

/// Reads nets of degrees 1 to 8 from text. Unless `rational`, all weights must be 1.
///
/// Memory is taken only for what the text holds: its counts are checked first.
///
/// # Errors
/// The first thing that is wrong. Every coordinate of every net returned is finite and every weight
/// positive.
pub fn parse(text: &[u8], rational: bool) -> Result<Vec<Net>, ParseError> {
    let form = decide(text).map_err(|wrong| wrong.locate(text))?;
    nets(text, form, rational).map_err(|wrong| wrong.locate(text))
}

/// How many numbers a point has.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// As many as there are on its line.
    Lines,
    Always(usize),
}

/// The number of patches, checked against what the text can hold at all.
fn count(tokens: &mut Tokens) -> Result<usize, Wrong> {
    // Two degrees and four points of three numbers, each a digit and a space.
    const SMALLEST_PATCH: usize = 2 * (2 + 4 * 3);
    let token = tokens.expect(Element::Count)?;
    if !token.is_whole() {
        return Err(token.wrong(Problem::NotACount { expected: Element::Count, found: token.shown() }));
    }
    let (bytes, possible) = (tokens.text.len(), tokens.text.len() / SMALLEST_PATCH);
    // A file cut short announces somewhat more than it holds: what is missing says more there. A
    // number too long for usize is too many as well.
    match token.parse() {
        Some(count) if count <= bytes => Ok(count),
        _ => Err(token.wrong(Problem::TooMany { count: token.shown(), bytes, possible })),
    }
}

fn degrees(tokens: &mut Tokens, patch: usize) -> Result<[u8; 2], Wrong> {
    Ok([text::degree(tokens, patch, 0)?, text::degree(tokens, patch, 1)?])
}

/// Which form the text has, or what keeps it from having any.
fn decide(text: &[u8]) -> Result<Form, Wrong> {
    let by_lines = match regular(text) {
        Ok(()) => return Ok(Form::Lines),
        Err(failure) => failure,
    };
    let with_three = match uses_up(text, 3) {
        Ok(()) => return Ok(Form::Always(3)),
        Err(wrong) => wrong,
    };
    let with_four = match uses_up(text, 4) {
        Ok(()) => return Ok(Form::Always(4)),
        Err(wrong) => wrong,
    };
    // Nothing fits. The lines know best if they were regular for a while; else the reading that got
    // further is more likely to be the one that was meant.
    Err(match by_lines {
        Irregular { wrong: Some(wrong), points: 1.. } => wrong,
        _ if with_four.offset > with_three.offset => with_four,
        _ => with_three,
    })
}

/// Where the lines stopped being regular.
struct Irregular {
    /// Absent when only a line break is out of place, before the first point.
    wrong: Option<Wrong>,
    /// Points seen before.
    points: usize,
}

/// Does every line hold one thing: the count, the degrees of a patch, or a point?
fn regular(text: &[u8]) -> Result<(), Irregular> {
    let mut tokens = Tokens::new(text);
    let mut points = 0;
    let mut line = |tokens: &mut Tokens, lengths: &[usize], element: Element| {
        let found = tokens.on_line();
        if lengths.contains(&found) {
            let is_point = matches!(element, Element::Point { .. });
            points += usize::from(is_point);
            return Ok(found);
        }
        let wrong = match (tokens.expect(element), element) {
            (Err(end), _) => Some(end),
            (Ok(token), Element::Point { .. }) => Some(token.wrong(Problem::Line { point: element, found })),
            (Ok(_), _) => None,
        };
        Err(Irregular { wrong, points })
    };
    let fail = |wrong| Irregular { wrong: Some(wrong), points: 0 };

    line(&mut tokens, &[1], Element::Count)?;
    let patches = count(&mut tokens).map_err(fail)?;
    for patch in 0..patches {
        line(&mut tokens, &[2], Element::Degree { patch, direction: 0 })?;
        let degree =
            degrees(&mut tokens, patch).map_err(|wrong| Irregular { wrong: Some(wrong), points: 1 })?;
        for point in 0..crate::patch::net_points(degree) {
            let length = line(&mut tokens, &[3, 4], Element::Point { patch, point })?;
            tokens.nth(length - 1);
        }
    }
    end(&mut tokens, patches).map_err(|wrong| Irregular { wrong: Some(wrong), points: 1 })
}

/// Is the text used up exactly when every point has this many numbers?
fn uses_up(text: &[u8], numbers: usize) -> Result<(), Wrong> {
    let mut tokens = Tokens::new(text);
    let patches = count(&mut tokens)?;
    for patch in 0..patches {
        let degree = degrees(&mut tokens, patch)?;
        for point in 0..crate::patch::net_points(degree) {
            for axis in 0..numbers {
                tokens.expect(Element::Coordinate { patch, point, axis })?;
            }
        }
    }
    end(&mut tokens, patches)
}

fn end(tokens: &mut Tokens, patches: usize) -> Result<(), Wrong> {
    match tokens.next() {
        Some(token) => Err(token.wrong(Problem::Trailing { patches, found: token.shown() })),
        None => Ok(()),
    }
}

/// The nets of a text whose counts are known to be right.
fn nets(text: &[u8], form: Form, rational: bool) -> Result<Vec<Net>, Wrong> {
    let mut tokens = Tokens::new(text);
    let patches = count(&mut tokens)?;
    let mut nets = Vec::with_capacity(patches);
    for patch in 0..patches {
        let degree = degrees(&mut tokens, patch)?;
        let mut points = Vec::with_capacity(crate::patch::net_points(degree));
        for point in 0..crate::patch::net_points(degree) {
            let numbers = match form {
                Form::Always(numbers) => numbers,
                Form::Lines => tokens.on_line(),
            };
            points.push(homogeneous_point(&mut tokens, patch, point, numbers, rational)?);
        }
        nets.push(Net { degree, points });
    }
    Ok(nets)
}

fn homogeneous_point(
    tokens: &mut Tokens,
    patch: usize,
    point: usize,
    numbers: usize,
    rational: bool,
) -> Result<[f32; 4], Wrong> {
    let element = |axis| Element::Coordinate { patch, point, axis };
    let mut read = [None; 3];
    let mut homogeneous = [1.0; 4];
    for (axis, token) in read.iter_mut().enumerate() {
        let found = tokens.expect(element(axis))?;
        homogeneous[axis] = found.finite(element(axis))?;
        *token = Some(found);
    }
    if numbers < 4 {
        return Ok(homogeneous);
    }
    let token = tokens.expect(element(3))?;
    let weight = token.weight(element(3), rational)?;
    if weight != 1.0 {
        for (axis, token) in read.into_iter().enumerate() {
            let Some(token) = token else { continue };
            let exact = token.parse::<f64>().unwrap_or(f64::NAN);
            homogeneous[axis] = weighted(exact, weight);
            if !homogeneous[axis].is_finite() {
                let found = format!("{} times {weight}", token.shown());
                return Err(token.wrong(Problem::Overflow { element: element(axis), found }));
            }
        }
        homogeneous[3] = weight;
    }
    Ok(homogeneous)
}

/// A coordinate times a weight, from the decimal as written and rounded once: so that a writer can
/// say every f32 product exactly.
fn weighted(coordinate: f64, weight: f32) -> f32 {
    (coordinate * f64::from(weight)) as f32
}

/// Writes the nets of a word, with weights if the word is rational. Reading them back gives the same
/// f32, bit for bit.
///
/// # Errors
/// What the writer reports; a number that is not finite or a weight that is not positive, naming
/// module and point.
pub fn write(writer: &mut dyn Write, word: &Word) -> Result<(), WriteError> {
    write_usize(writer, word.modules.len())?;
    let [m, n] = word.degree;
    for index in 0..word.modules.len() {
        write!(writer, "\n{m} {n}")?;
        for (point, homogeneous) in word.net(index).iter().enumerate() {
            check_point(index, point, homogeneous)?;
            write_point(writer, homogeneous, word.rational)?;
        }
    }
    writer.write_all(b"\n")?;
    Ok(())
}

fn write_point(writer: &mut dyn Write, homogeneous: &[f32; 4], rational: bool) -> io::Result<()> {
    let weight = homogeneous[3];
    for (axis, &x) in homogeneous[..3].iter().enumerate() {
        writer.write_all(if axis == 0 { b"\n" } else { b" " })?;
        if weight == 1.0 {
            write_f32(writer, x)?;
        } else {
            write_quotient(writer, x, weight)?;
        }
    }
    if rational {
        writer.write_all(b" ")?;
        write_f32(writer, weight)?;
    }
    Ok(())
}

/// Writes x / weight so that reading, which multiplies by the weight, finds x again: with the digits
/// of an f32 where they suffice, else with those of an f64, which always do.
fn write_quotient(writer: &mut dyn Write, x: f32, weight: f32) -> io::Result<()> {
    let quotient = f64::from(x) / f64::from(weight);
    let mut short = Vec::with_capacity(16);
    write_f32(&mut short, quotient as f32)?;
    let read = std::str::from_utf8(&short).ok().and_then(|text| text.parse::<f64>().ok());
    match read {
        Some(read) if weighted(read, weight).to_bits() == x.to_bits() => writer.write_all(&short),
        _ => write_f64(writer, quotient),
    }
}
