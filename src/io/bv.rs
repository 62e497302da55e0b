//! Files of Bézier nets: `.bv`, the format of
//! [BezierView](https://www.cise.ufl.edu/research/SurfLab/bview/) (SurfLab, University of Florida).
//!
//! ```text
//! Group 0 P    optional: from here on patches belong to this group, a number (its colour) and a name
//! 4            kind of the patch: 4 one degree, 5 two degrees, 8 two degrees and weights
//! 3            degree along u and v; for kinds 5 and 8 both, `m n`
//! 0 0 0        (m + 1)(n + 1) points `x y z` or, for kind 8, `xw yw zw w`; row by row
//! …
//! ```
//!
//! Row index = u, column = v, and the normal is S_u × S_v, as everywhere here. Lines may break
//! anywhere; what stands on the line of a group behind its name is passed over, as BezierView does.
//! Groups say nothing that a net could hold: they are read and dropped, and written one a symbol.
//!
//! The documentation leaves open what the four numbers of kind 8 are. BezierView divides them by the
//! fourth before it draws, and its torus (`tor.bv`) has them homogeneous: (xw, yw, zw, w), what memory
//! holds. So every f32 comes back as it was.
//!
//! The other kinds are 1 (polyhedron), 3 (triangular patch), 6 (trimming curve), 7 (B-spline), 9 (PN
//! triangle) and 10 (PN quad); they are no tensor-product Bézier patches, or have normals of their
//! own, and are refused by name.

use super::number::{write_f32, write_usize};
use super::text::{self, Element, ParseError, Problem, ReadError, Tokens, Wrong};
use super::write::{WriteError, check_point, write_in_blocks};
use crate::patch::{Net, Word, net_points};
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
/// Memory is taken only for what the text holds.
///
/// # Errors
/// The first thing that is wrong; a text with neither patch nor group. Every coordinate of every net
/// returned is finite and every weight positive.
pub fn parse(text: &[u8], rational: bool) -> Result<Vec<Net>, ParseError> {
    nets(text, rational).map_err(|wrong| wrong.locate(text))
}

/// What can stand in front of the points of a patch.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    OneDegree,
    TwoDegrees,
    Rational,
}

fn nets(text: &[u8], rational: bool) -> Result<Vec<Net>, Wrong> {
    let mut tokens = Tokens::new(text);
    let mut nets = Vec::new();
    // A file that holds nothing at all was meant to hold something.
    tokens.clone().expect(Element::Kind { patch: 0 })?;
    while let Some(kind) = kind(&mut tokens, nets.len())? {
        nets.push(net(&mut tokens, kind, nets.len(), rational)?);
    }
    Ok(nets)
}

/// The kind of the next patch, behind the groups before it; `None` at the end.
fn kind(tokens: &mut Tokens, patch: usize) -> Result<Option<Kind>, Wrong> {
    while let Some(token) = tokens.next() {
        if token.text.eq_ignore_ascii_case(b"group") {
            group(tokens)?;
            continue;
        }
        let refuse = |name| Err(token.wrong(Problem::Kind { patch, kind: token.shown(), name }));
        return match token.parse::<u32>().filter(|_| token.is_whole()) {
            Some(4) => Ok(Some(Kind::OneDegree)),
            Some(5) => Ok(Some(Kind::TwoDegrees)),
            Some(8) => Ok(Some(Kind::Rational)),
            Some(1) => refuse("a polyhedron"),
            Some(3) => refuse("a triangular patch"),
            Some(6) => refuse("a trimming curve"),
            Some(7) => refuse("a B-spline"),
            Some(9) => refuse("a PN triangle"),
            Some(10) => refuse("a PN quad"),
            _ => Err(token.wrong(Problem::NotAKind { patch, found: token.shown() })),
        };
    }
    Ok(None)
}

fn group(tokens: &mut Tokens) -> Result<(), Wrong> {
    let number = tokens.expect(Element::Group)?;
    if number.parse::<i64>().is_none() {
        return Err(number.wrong(Problem::NotACount { expected: Element::Group, found: number.shown() }));
    }
    tokens.expect(Element::Group)?;
    tokens.skip_line();
    Ok(())
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
