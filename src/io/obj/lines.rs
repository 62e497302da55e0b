//! Lines: the curves of a text.

use super::super::number::{write_each, write_usize};
use super::super::text::{Element, ParseError, Problem, Wrong};
use super::super::write::{WriteError, one_line, write_in_blocks};
use super::read::{statements, vertex};
use crate::curve::Word;
use crate::io::curves::{self, Polyline};
use std::io::Write;

/// Reads a curve for each `l`; where there is none, all vertices in their order are one. A line that ends at its first
/// vertex has it once.
///
/// # Errors
/// A vertex that is none, a line that names a vertex that is not there, a text without vertices.
pub fn parse(text: &[u8]) -> Result<Vec<Polyline>, ParseError> {
    curves(text).map_err(|wrong| wrong.locate(text))
}

fn curves(text: &[u8]) -> Result<Vec<Polyline>, Wrong> {
    let mut vertices: Polyline = Vec::new();
    let mut lines: Vec<Vec<usize>> = Vec::new();
    let all = || statements(text).filter_map(|mut tokens| Some((tokens.next()?, tokens)));
    let count = all().filter(|(keyword, _)| keyword.text == b"v").count();
    for (keyword, rest) in all() {
        match keyword.text {
            b"v" => vertices.push(vertex(&keyword, rest, vertices.len() + 1, true)?.map(|x| x as f32)),
            b"l" => {
                let mut line = Vec::new();
                for token in rest {
                    // `v/vt` is allowed here, too.
                    let index = token.text.split(|&byte| byte == b'/').next().unwrap_or_default();
                    let index = std::str::from_utf8(index).ok().and_then(|text| text.parse::<i64>().ok());
                    let element = Element::Line { line: lines.len() + 1 };
                    let found = || token.shown();
                    let index = index
                        .filter(|&i| i != 0)
                        .ok_or_else(|| token.wrong(Problem::Corner { face: element, found: found() }))?;
                    let place = if index > 0 { index - 1 } else { vertices.len() as i64 + index };
                    match usize::try_from(place).ok().filter(|&place| place < count) {
                        Some(place) => line.push(place),
                        None => {
                            let (face, found) = (element, index.to_string());
                            return Err(token.wrong(Problem::NoVertex { face, found, vertices: count }));
                        }
                    }
                }
                lines.push(line);
            }
            b"vt" | b"vn" | b"vp" | b"g" | b"o" | b"s" | b"f" | b"p" | b"t" | b"usemtl" | b"mtllib" => {}
            _ => return Err(keyword.wrong(Problem::Statement { found: keyword.shown() })),
        }
    }
    if vertices.is_empty() {
        let offset = text.trim_ascii_end().len();
        return Err(Wrong { offset, problem: Problem::Missing(Element::Vertex { vertex: 1 }) });
    }
    if lines.is_empty() {
        return Ok(vec![vertices]);
    }
    Ok(lines
        .into_iter()
        .map(|mut line| {
            if line.len() > 1 && line.first() == line.last() {
                line.pop();
            }
            line.into_iter().map(|place| vertices[place]).collect()
        })
        .collect())
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
