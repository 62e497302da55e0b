//! Files of Bézier nets: `.bv`, the format of
//! [BezierView](https://www.cise.ufl.edu/research/SurfLab/bview/) (SurfLab, University of Florida).
//!
//! ```text
//! Group 0 P    optional: from here on patches belong to this group, a number (its colour) and, if it has one, a name
//! 4            kind of the patch: 4 one degree, 5 two degrees, 8 two degrees and weights
//! 3            degree along u and v; for kinds 5 and 8 both, `m n`
//! 0 0 0        (m + 1)(n + 1) points `x y z` or, for kind 8, `xw yw zw w`; row by row
//! …
//! ```
//!
//! Row index = u, column = v, and the normal is S_u × S_v, as everywhere here. Lines may break
//! anywhere; what stands on the line of a group after its number is passed over, as BezierView does.
//! Groups say nothing that a net could hold: they are read and dropped, and written one a symbol.
//!
//! The documentation leaves open what the four numbers of kind 8 are. BezierView divides them by the
//! fourth before it draws, and its torus (`tor.bv`) has them homogeneous: (xw, yw, zw, w), what memory
//! holds. So every f32 comes back as it was.
//!
//! The other kinds are 1 (polyhedron), 3 (triangular patch), 6 (trimming curve), 7 (B-spline), 9 (PN
//! triangle) and 10 (PN quad); they are no tensor-product Bézier patches, or have normals of their
//! own. Beside patches they are skipped, and a note counts them; how long 6 and 7 are is not documented, so that all up
//! to the next group goes with them. A file of nothing else is refused.

use super::notes::{Noted, Tally};
use super::number::{write_f32, write_usize};
use super::text::{self, Element, ParseError, Problem, ReadError, Token, Tokens, Wrong};
use super::write::{WriteError, check_point, write_in_blocks};
use crate::patch::{Net, Word, net_points};
use std::io::{self, Write};
use std::path::Path;

/// Reads the nets of a file: [`parse`] with the path in every error.
///
/// # Errors
/// When the file cannot be read or its text is wrong.
pub fn read(path: impl AsRef<Path>, rational: bool) -> Result<Noted<Vec<Net>>, ReadError> {
    ReadError::in_file(path.as_ref(), |text| parse(text, rational))
}

/// Reads nets of degrees 1 to 8 from text. Unless `rational`, all weights must be 1.
///
/// Memory is taken only for what the text holds.
///
/// # Errors
/// The first thing that is wrong; a text with neither patch nor group, or of other kinds alone. Every coordinate of every net
/// returned is finite and every weight positive.
pub fn parse(text: &[u8], rational: bool) -> Result<Noted<Vec<Net>>, ParseError> {
    nets(text, rational).map_err(|wrong| wrong.locate(text))
}

/// What can stand before the points of a patch.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    OneDegree,
    TwoDegrees,
    Rational,
    /// A kind that is not read.
    Other(u32, &'static str),
}

fn nets(text: &[u8], rational: bool) -> Result<Noted<Vec<Net>>, Wrong> {
    let mut tokens = Tokens::new(text);
    let mut nets = Vec::new();
    let mut skipped = Tally::default();
    let (mut first_skipped, mut unreadable) = (None, None);
    // A file that holds nothing at all was meant to hold something.
    tokens.clone().expect(Element::Kind { patch: 0 })?;
    while let Some((token, kind)) = kind(&mut tokens, nets.len())? {
        match kind {
            Kind::Other(number, name) => {
                let kind = token.shown();
                first_skipped
                    .get_or_insert_with(|| token.wrong(Problem::Kind { patch: nets.len(), kind, name }));
                skipped.add(&format!("{name} (kind {number})"));
                let before = tokens.clone();
                let left_out = skip(&mut tokens, number);
                if let Err(wrong) = left_out {
                    // A file that is of other kinds from its beginning is wrong in that, unless there is more behind.
                    if !nets.is_empty() {
                        return Err(unreadable.unwrap_or(wrong));
                    }
                    unreadable.get_or_insert(wrong);
                    tokens = before;
                    to_group(&mut tokens);
                }
            }
            kind => nets.push(net(&mut tokens, kind, nets.len(), rational)?),
        }
    }
    match (first_skipped.filter(|_| nets.is_empty()), unreadable) {
        (Some(wrong), _) | (None, Some(wrong)) => Err(wrong),
        (None, None) => Ok(Noted { value: nets, notes: skipped.note().into_iter().collect() }),
    }
}

/// The kind of the next patch, after the groups before it; `None` at the end.
fn kind<'a>(tokens: &mut Tokens<'a>, patch: usize) -> Result<Option<(Token<'a>, Kind)>, Wrong> {
    while let Some(token) = tokens.next() {
        if is_group(&token) {
            group(tokens)?;
            continue;
        }
        let kind = match token.parse::<u32>().filter(|_| token.is_whole()) {
            Some(4) => Kind::OneDegree,
            Some(5) => Kind::TwoDegrees,
            Some(8) => Kind::Rational,
            Some(1) => Kind::Other(1, "polyhedron"),
            Some(3) => Kind::Other(3, "triangular patch"),
            Some(6) => Kind::Other(6, "trimming curve"),
            Some(7) => Kind::Other(7, "B-spline"),
            Some(9) => Kind::Other(9, "PN triangle"),
            Some(10) => Kind::Other(10, "PN quad"),
            _ => return Err(token.wrong(Problem::NotAKind { patch, found: token.shown() })),
        };
        return Ok(Some((token, kind)));
    }
    Ok(None)
}

fn is_group(token: &Token) -> bool {
    token.text.eq_ignore_ascii_case(b"group")
}

/// Number and name, of which the name may be missing: what stands on the next line is none.
fn group(tokens: &mut Tokens) -> Result<(), Wrong> {
    let mut rest = tokens.clone();
    rest.skip_line();
    let number = tokens.expect(Element::Group)?;
    if number.offset >= rest.offset || number.parse::<i64>().is_none() {
        return Err(number.wrong(Problem::NotACount { expected: Element::Group, found: number.shown() }));
    }
    tokens.skip_line();
    Ok(())
}

/// Leaves out a patch of this kind.
fn skip(tokens: &mut Tokens, kind: u32) -> Result<(), Wrong> {
    let element = Element::Skipped;
    let count = |tokens: &mut Tokens| {
        let token = tokens.expect(element)?;
        let wrong = || token.wrong(Problem::NotACount { expected: element, found: token.shown() });
        token.parse::<u32>().map(u64::from).ok_or_else(wrong)
    };
    let numbers = |tokens: &mut Tokens, count: u64| {
        (0..count).try_for_each(|_| tokens.expect(element)?.finite(element).map(drop))
    };
    let triangle = |degree: u64| ((degree + 1).saturating_mul(degree + 2) / 2).saturating_mul(3);
    let grid = |m: u64, n: u64| (3 * (m + 1)).saturating_mul(n + 1);
    match kind {
        1 => {
            let (vertices, faces) = (count(tokens)?, count(tokens)?);
            numbers(tokens, 3 * vertices)?;
            for _ in 0..faces {
                let corners = count(tokens)?;
                numbers(tokens, corners)?;
            }
        }
        3 => {
            let degree = count(tokens)?;
            numbers(tokens, triangle(degree))?;
        }
        9 => {
            let degrees = [count(tokens)?, count(tokens)?];
            numbers(tokens, triangle(degrees[0]).saturating_add(triangle(degrees[1])))?;
        }
        10 => {
            let [m, n, p, q] = [count(tokens)?, count(tokens)?, count(tokens)?, count(tokens)?];
            numbers(tokens, grid(m, n).saturating_add(grid(p, q)))?;
        }
        _ => to_group(tokens),
    }
    Ok(())
}

/// Leaves out what is left before the next group.
fn to_group(tokens: &mut Tokens) {
    let mut ahead = tokens.clone();
    while ahead.next().is_some_and(|token| !is_group(&token)) {
        *tokens = ahead.clone();
    }
}

fn net(tokens: &mut Tokens, kind: Kind, patch: usize, rational: bool) -> Result<Net, Wrong> {
    let m = text::degree(tokens, patch, 0)?;
    let n = if kind == Kind::OneDegree { m } else { text::degree(tokens, patch, 1)? };
    let mut points = Vec::with_capacity(net_points([m, n]));
    for point in 0..net_points([m, n]) {
        let mut homogeneous = [1.0; 4];
        for (axis, x) in homogeneous[..3].iter_mut().enumerate() {
            let element = Element::Coordinate { patch, point, axis };
            *x = tokens.expect(element)?.finite(element)?;
        }
        if kind == Kind::Rational {
            let element = Element::Coordinate { patch, point, axis: 3 };
            homogeneous[3] = tokens.expect(element)?.weight(element, rational)?;
        }
        points.push(homogeneous);
    }
    Ok(Net { degree: [m, n], points })
}

/// Writes the nets of a word, of kind 8 if the word is rational, else of kind 4 or 5; a group begins
/// where the symbol changes. Reading them back gives the same f32, bit for bit.
///
/// # Errors
/// What the writer reports; a number that is not finite or a weight that is not positive, naming
/// module and point.
pub fn write(writer: &mut dyn Write, word: &Word) -> Result<(), WriteError> {
    if word.modules.is_empty() {
        // Without patches a group alone tells the file from one that was cut off.
        write_group(writer, 0, &word.system)?;
    }
    write_in_blocks(writer, word.modules.len(), |index, text| {
        let symbol = word.modules[index].symbol;
        if index == 0 || word.modules[index - 1].symbol != symbol {
            let name = word.symbols.get(symbol).map_or("", |symbol| &symbol.name);
            write_group(text, symbol, name)?;
        }
        match (word.rational, word.degree) {
            (true, [m, n]) => writeln!(text, "8\n{m} {n}")?,
            (false, [m, n]) if m == n => writeln!(text, "4\n{m}")?,
            (false, [m, n]) => writeln!(text, "5\n{m} {n}")?,
        }
        for (point, homogeneous) in word.net(index).iter().enumerate() {
            check_point(index, point, homogeneous)?;
            write_point(text, homogeneous, word.rational)?;
        }
        Ok(())
    })
}

/// A name has no spaces: they and control characters become `_`.
fn write_group<W: Write + ?Sized>(writer: &mut W, number: usize, name: &str) -> io::Result<()> {
    let name: String =
        name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
    writer.write_all(b"Group ")?;
    write_usize(writer, number)?;
    writeln!(writer, " {}", if name.is_empty() { "_" } else { &name })
}

fn write_point(text: &mut Vec<u8>, homogeneous: &[f32; 4], rational: bool) -> io::Result<()> {
    let numbers = if rational { 4 } else { 3 };
    for (axis, &x) in homogeneous[..numbers].iter().enumerate() {
        if axis > 0 {
            text.push(b' ');
        }
        write_f32(text, x)?;
    }
    text.push(b'\n');
    Ok(())
}
