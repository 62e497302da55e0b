//! Lines: the curves of a text.

use super::super::notes::{Noted, Tally};
use super::super::number::{write_each, write_usize};
use super::super::text::{Element, ParseError, Problem, Token, Wrong};
use super::super::write::{WriteError, one_line, write_in_blocks};
use super::chain::{Chain, chains};
use super::read::{is_passed_over, joined, statements, unread, vertex};
use crate::curve::Word;
use crate::io::curves::{self, Polyline};
use std::io::Write;

/// Reads a curve for each `l`; where there is none, all vertices in their order are one. Lines that share an end are
/// one, in whatever order and direction they stand, as where each edge is a line; where three edges meet, lines end. A
/// line that ends at its first vertex has it once and is closed. A fourth number of a vertex is its fourth coordinate,
/// and a weight to nothing here. Faces, points,
/// curves and surfaces of free form and calls of other files are skipped, and a note counts them.
///
/// # Errors
/// A vertex that is none, a line of fewer than two vertices or that names one that is not there, a text without vertices.
pub fn parse(text: &[u8]) -> Result<Noted<Vec<Polyline>>, ParseError> {
    curves(&joined(text)).map_err(|wrong| wrong.locate(text))
}

fn curves(text: &[u8]) -> Result<Noted<Vec<Polyline>>, Wrong> {
    let mut vertices: Vec<[f32; 4]> = Vec::new();
    let mut lines: Vec<Vec<usize>> = Vec::new();
    let mut skipped = Tally::default();
    let all = || statements(text).filter_map(|mut tokens| Some((tokens.next()?, tokens)));
    let count = all().filter(|(keyword, _)| keyword.text == b"v").count();
    for (keyword, rest) in all() {
        match keyword.text {
            b"v" => vertices.push(vertex(&keyword, rest, vertices.len() + 1)?.0.map(|x| x as f32)),
            b"l" => {
                let element = Element::Line { line: lines.len() + 1 };
                let line: Result<Vec<usize>, Wrong> =
                    rest.map(|token| index(&token, element, vertices.len(), count)).collect();
                let line = line?;
                if line.len() < 2 {
                    return Err(keyword.wrong(Problem::ShortLine { line: element, found: line.len() }));
                }
                lines.push(line);
            }
            b"f" => skipped.add("face"),
            b"p" => skipped.add("point"),
            other if is_passed_over(other) => {}
            other => match unread(other) {
                Some(kind) => skipped.add(kind),
                None => return Err(keyword.wrong(Problem::Statement { found: keyword.shown() })),
            },
        }
    }
    if vertices.is_empty() {
        let offset = text.trim_ascii_end().len();
        return Err(Wrong { offset, problem: Problem::Missing(Element::Vertex { vertex: 1 }) });
    }
    let all = lines.len();
    lines.retain(|line| line.iter().any(|&vertex| vertex != line[0]));
    (lines.len()..all).for_each(|_| skipped.add("line from a vertex to itself"));
    let curves = if all == 0 {
        vec![vertices.into()]
    } else {
        let curve = |chain: Chain| {
            let points = chain.vertices.into_iter().map(|place| vertices[place]).collect();
            Polyline { points, closed: Some(chain.closed) }
        };
        chains(lines, count).into_iter().map(curve).collect()
    };
    Ok(Noted { value: curves, notes: skipped.note().into_iter().collect() })
}

/// The vertex that a line names, from 0. Negative ones count back from those `before` the line.
fn index(token: &Token, line: Element, before: usize, count: usize) -> Result<usize, Wrong> {
    // `v/vt` is allowed here, too.
    let index = token.text.split(|&byte| byte == b'/').next().unwrap_or_default();
    let index = std::str::from_utf8(index).ok().and_then(|text| text.parse::<i64>().ok());
    let index = index
        .filter(|&i| i != 0)
        .ok_or_else(|| token.wrong(Problem::Corner { face: line, found: token.shown() }))?;
    let place = if index > 0 { Some(index - 1) } else { (before as i64).checked_add(index) };
    match place.and_then(|place| usize::try_from(place).ok()).filter(|&place| place < count) {
        Some(place) => Ok(place),
        None => {
            let (face, found) = (line, index.to_string());
            Err(token.wrong(Problem::NoVertex { face, found, vertices: count }))
        }
    }
}

/// Writes the curves of some words: an `o` for each word, a `v` for each point, an `l` for each curve, which ends at its
/// first vertex where it closes.
///
/// # Errors
/// What the writer reports; a coordinate that is not finite, naming the point.
pub fn write(writer: &mut dyn Write, words: &[&Word]) -> Result<(), WriteError> {
    let mut first = 1;
    for (n, word) in words.iter().enumerate() {
        let number = if words.len() > 1 { format!("_{n}") } else { String::new() };
        writeln!(writer, "o {}{number}", one_line(&word.system))?;
        for line in curves::lines(word) {
            write_line(writer, &line, first).map_err(|e| e.of_word(n, words.len()))?;
            first += line.points.len();
        }
    }
    Ok(())
}

/// A curve whose first vertex has this number.
fn write_line(writer: &mut dyn Write, line: &curves::Line, first: usize) -> Result<(), WriteError> {
    let curves::Line { points, closed, .. } = line;
    write_in_blocks(writer, points.len(), |n, text| {
        if let Some(&x) = points[n].iter().find(|x| !x.is_finite()) {
            return Err(WriteError::not_finite(format_args!("point {n}"), x));
        }
        text.push(b'v');
        write_each(text, b" ", &points[n])?;
        text.push(b'\n');
        Ok(())
    })?;
    if points.len() > 1 {
        write!(writer, "l")?;
        write_in_blocks(writer, points.len(), |n, text| {
            text.push(b' ');
            Ok(write_usize(text, first + n)?)
        })?;
        if *closed {
            write!(writer, " {first}")?;
        }
        writeln!(writer)?;
    }
    Ok(())
}
