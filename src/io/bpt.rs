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
use super::write::WriteError;
use crate::patch::{MAX_DEGREE, Net, Word};
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a `.bpt` file could not be read.
#[derive(Debug, Error)]
pub enum ReadError {
    #[error("cannot read {}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}:{error}", path.display())]
    Text { path: PathBuf, error: ParseError },
}

/// What is wrong with the text of a `.bpt` file, and where. Lines and columns (in characters) count
/// from 1; what is missing at the end of the text lies just behind its last character.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{line}:{column}: {problem}")]
pub struct ParseError {
    pub line: usize,
    pub column: usize,
    pub problem: Problem,
}

/// What is wrong, and what would be right. Patches and points count from 0.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Problem {
    #[error("the file ends where {0} should stand")]
    Missing(Element),
    #[error("`{found}` stands where {expected} should: a whole number is needed")]
    NotACount { expected: Element, found: String },
    #[error(
        "{count} patches are announced, but a file of {bytes} bytes cannot hold more than {possible}: \
         the number of patches comes first"
    )]
    TooMany { count: String, bytes: usize, possible: usize },
    #[error("{degree} is `{found}`; degrees are from 1 to 8")]
    Degree { degree: Element, found: String },
    #[error("`{found}` stands where {expected} should: a number is needed")]
    NotANumber { expected: Element, found: String },
    #[error("{element} is `{found}`; coordinates must be finite")]
    NotFinite { element: Element, found: String },
    #[error("{element} is `{found}`, beyond the range of 32-bit floats (3.4e38)")]
    Overflow { element: Element, found: String },
    #[error("{element} is `{found}`; weights must be positive")]
    NotPositive { element: Element, found: String },
    #[error("{element} is `{found}`, but the nets wanted are polynomial: weights must be 1 or left out")]
    NotOne { element: Element, found: String },
    #[error("{found} numbers on this line where {point} should stand: write `x y z` or `x y z w`")]
    Line { point: Element, found: usize },
    #[error("`{found}` follows after the last of {patches} patches: nothing may")]
    Trailing { patches: usize, found: String },
}

/// Something that the file names or should name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    Count,
    /// Direction 0 is u (rows), 1 is v (columns).
    Degree {
        patch: usize,
        direction: usize,
    },
    Point {
        patch: usize,
        point: usize,
    },
    /// Axis 0..=2 is x, y, z; 3 is the weight.
    Coordinate {
        patch: usize,
        point: usize,
        axis: usize,
    },
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Element::Count => f.write_str("the number of patches"),
            Element::Degree { patch, direction } => {
                write!(f, "the degree along {} of patch {patch}", ["u", "v"][direction])
            }
            Element::Point { patch, point } => write!(f, "point {point} of patch {patch}"),
            Element::Coordinate { patch, point, axis } => {
                write!(f, "{} of point {point} of patch {patch}", ["x", "y", "z", "the weight"][axis])
            }
        }
    }
}

/// Reads the nets of a file: [`parse`] with the path in every error.
///
/// # Errors
/// When the file cannot be read or its text is wrong.
pub fn read(path: impl AsRef<Path>, rational: bool) -> Result<Vec<Net>, ReadError> {
    let path = path.as_ref();
    let text = std::fs::read(path).map_err(|source| ReadError::Io { path: path.into(), source })?;
    parse(&text, rational).map_err(|error| ReadError::Text { path: path.into(), error })
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

/// A problem at a byte of the text.
struct Wrong {
    offset: usize,
    problem: Problem,
}

impl Wrong {
    fn locate(self, text: &[u8]) -> ParseError {
        let before = &text[..self.offset.min(text.len())];
        let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        ParseError {
            line: before.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: String::from_utf8_lossy(&before[start..]).chars().count() + 1,
            problem: self.problem,
        }
    }
}

/// A run of bytes between white space.
#[derive(Clone, Copy)]
struct Token<'a> {
    text: &'a [u8],
    offset: usize,
}

impl Token<'_> {
    /// As messages show it: cut short, since a token may be as long as the file.
    fn shown(&self) -> String {
        let text = String::from_utf8_lossy(self.text);
        match text.char_indices().nth(40) {
            Some((end, _)) => format!("{}…", &text[..end]),
            None => text.into_owned(),
        }
    }

    fn parse<T: std::str::FromStr>(&self) -> Option<T> {
        std::str::from_utf8(self.text).ok()?.parse().ok()
    }

    fn wrong(&self, problem: Problem) -> Wrong {
        Wrong { offset: self.offset, problem }
    }
}

/// The tokens from a place on. Cheap to copy: looking ahead is reading a copy.
#[derive(Clone)]
struct Tokens<'a> {
    text: &'a [u8],
    offset: usize,
}

impl<'a> Tokens<'a> {
    fn new(text: &'a [u8]) -> Tokens<'a> {
        // Some editors open every file with this mark.
        let offset = if text.starts_with("\u{feff}".as_bytes()) { 3 } else { 0 };
        Tokens { text, offset }
    }

    /// The next token, which should be `element`.
    fn expect(&mut self, element: Element) -> Result<Token<'a>, Wrong> {
        let end = self.text.trim_ascii_end().len();
        self.next().ok_or(Wrong { offset: end, problem: Problem::Missing(element) })
    }

    /// How many tokens are left on the line of the next one.
    fn on_line(&self) -> usize {
        let Some(next) = self.clone().next() else { return 0 };
        let line = self.text[next.offset..].split(|&byte| byte == b'\n').next().unwrap_or_default();
        Tokens { text: line, offset: 0 }.count()
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        let rest = &self.text[self.offset..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &rest[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let offset = self.offset + start;
        self.offset = offset + length;
        Some(Token { text: &rest[..length], offset })
    }
}

/// The number of patches, checked against what the text can hold at all.
fn count(tokens: &mut Tokens) -> Result<usize, Wrong> {
    // Two degrees and four points of three numbers, each a digit and a space.
    const SMALLEST_PATCH: usize = 2 * (2 + 4 * 3);
    let token = tokens.expect(Element::Count)?;
    let digits = !token.text.is_empty() && token.text.iter().all(u8::is_ascii_digit);
    if !digits {
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

/// The degrees of a patch, which bound its points to 81.
fn degrees(tokens: &mut Tokens, patch: usize) -> Result<[u8; 2], Wrong> {
    let mut degree = [0; 2];
    for (direction, value) in degree.iter_mut().enumerate() {
        let element = Element::Degree { patch, direction };
        let token = tokens.expect(element)?;
        *value = match token.parse::<u8>() {
            Some(degree) if (1..=MAX_DEGREE).contains(&degree) => degree,
            _ => return Err(token.wrong(Problem::Degree { degree: element, found: token.shown() })),
        };
    }
    Ok(degree)
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
        homogeneous[axis] = finite(found, element(axis))?;
        *token = Some(found);
    }
    if numbers < 4 {
        return Ok(homogeneous);
    }
    let token = tokens.expect(element(3))?;
    let weight = finite(token, element(3))?;
    if weight <= 0.0 {
        return Err(token.wrong(Problem::NotPositive { element: element(3), found: token.shown() }));
    }
    if weight != 1.0 {
        if !rational {
            return Err(token.wrong(Problem::NotOne { element: element(3), found: token.shown() }));
        }
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

fn finite(token: Token, element: Element) -> Result<f32, Wrong> {
    let found = || token.shown();
    let Some(value) = token.parse::<f32>() else {
        return Err(token.wrong(Problem::NotANumber { expected: element, found: found() }));
    };
    // Rust reads `inf` and `nan` as numbers; a number with digits that is infinite was too large.
    let digits = token.text.iter().any(u8::is_ascii_digit);
    match value.is_finite() {
        true => Ok(value),
        false if digits => Err(token.wrong(Problem::Overflow { element, found: found() })),
        false => Err(token.wrong(Problem::NotFinite { element, found: found() })),
    }
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
            check(index, point, homogeneous)?;
            write_point(writer, homogeneous, word.rational)?;
        }
    }
    writer.write_all(b"\n")?;
    Ok(())
}

fn check(module: usize, point: usize, &[x, y, z, weight]: &[f32; 4]) -> Result<(), WriteError> {
    // A weight that is NaN is found as such, not as one that is not positive.
    if weight <= 0.0 {
        return Err(WriteError::Unsupported(format!(
            "point {point} of module {module} has the weight {weight}; a file of patches holds positive ones"
        )));
    }
    match [x / weight, y / weight, z / weight, weight].into_iter().find(|x| !x.is_finite()) {
        Some(value) => Err(WriteError::not_finite(format_args!("point {point} of module {module}"), value)),
        None => Ok(()),
    }
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
