//! The vertices and faces of a text.

use super::super::text::{Element, Problem, Token, Tokens, Wrong};
use std::borrow::Cow;
use std::ops::Range;

/// Vertices and faces in the order of the text.
pub struct Polygons {
    pub vertices: Vec<Vertex>,
    /// Indices from 0, one face after the other.
    pub corners: Vec<u32>,
    pub faces: Vec<Face>,
    /// Just behind the last character.
    pub end: usize,
}

pub struct Vertex {
    /// Homogeneous, with the decimals as written.
    pub point: [f64; 4],
    /// Where it stands in the text.
    pub offset: usize,
}

pub struct Face {
    /// Of the corners.
    pub range: Range<usize>,
    /// Where it stands in the text.
    pub offset: usize,
}

/// Reads the text line by line. Unless `rational`, all weights must be 1.
pub fn polygons(text: &[u8], rational: bool) -> Result<Polygons, Wrong> {
    let lines = || statements(text).filter_map(|mut tokens| Some((tokens.next()?, tokens)));
    let count = lines().filter(|(keyword, _)| keyword.text == b"v").count();
    let mut read = Polygons {
        vertices: Vec::with_capacity(count),
        corners: Vec::new(),
        faces: Vec::new(),
        end: text.trim_ascii_end().len(),
    };
    for (keyword, rest) in lines() {
        match keyword.text {
            b"v" => {
                let number = read.vertices.len() + 1;
                let (point, weight) = vertex(&keyword, rest, number)?;
                let point = match weight {
                    Some(weight) => weighted(&keyword, point, &weight, number, rational)?,
                    None => point,
                };
                read.vertices.push(Vertex { point, offset: keyword.offset });
            }
            b"f" => {
                let (first, face) = (read.corners.len(), Element::Face { face: read.faces.len() + 1 });
                for token in rest {
                    read.corners.push(corner(&token, face, read.vertices.len(), count)?);
                }
                read.faces.push(Face { range: first..read.corners.len(), offset: keyword.offset });
            }
            b"l" | b"p" => {}
            other if is_passed_over(other) || unread(other).is_some() => {}
            _ => return Err(keyword.wrong(Problem::Statement { found: keyword.shown() })),
        }
    }
    Ok(read)
}

/// Statements that say nothing of points, lines and faces, and those that belong to curves and surfaces of free form.
pub(super) fn is_passed_over(keyword: &[u8]) -> bool {
    const PASSED_OVER: [&str; 32] = [
        "vt",
        "vn",
        "vp",
        "g",
        "o",
        "s",
        "mg",
        "usemtl",
        "mtllib",
        "usemap",
        "maplib",
        "shadow_obj",
        "trace_obj",
        "lod",
        "bevel",
        "c_interp",
        "d_interp",
        "ctech",
        "stech",
        "csh",
        "t",
        "cstype",
        "deg",
        "bmat",
        "step",
        "parm",
        "trim",
        "hole",
        "scrv",
        "sp",
        "end",
        "con",
    ];
    PASSED_OVER.iter().any(|known| known.as_bytes() == keyword)
}

/// What a statement draws that is not read: of free form, or in another file.
pub(super) fn unread(keyword: &[u8]) -> Option<&'static str> {
    match keyword {
        b"curv" => Some("curve of free form"),
        b"curv2" => Some("curve of free form on a surface"),
        b"surf" => Some("surface of free form"),
        b"call" => Some("call of another file"),
        _ => None,
    }
}

/// The lines, each up to its comment.
pub(super) fn statements(text: &[u8]) -> impl Iterator<Item = Tokens<'_>> {
    let mut start = Tokens::new(text).offset;
    std::iter::from_fn(move || {
        let rest = text.get(start..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let shown = rest[..length].iter().position(|&byte| byte == b'#').unwrap_or(length);
        let line = Tokens { text: &text[..start + shown], offset: start };
        start += length + 1;
        Some(line)
    })
}

/// The text in which a line that ends in `\\` goes on in the next one: the break is blank, so that every place stays where
/// it is. A comment ends with its line.
pub(super) fn joined(text: &[u8]) -> Cow<'_, [u8]> {
    let mut joined = Cow::Borrowed(text);
    let mut start = 0;
    for line in text.split_inclusive(|&byte| byte == b'\n') {
        let end = start + line.trim_ascii_end().len();
        let last = start + line.len();
        if line.ends_with(b"\n") && text[start..end].ends_with(b"\\") && !line.contains(&b'#') {
            joined.to_mut()[end - 1..last].fill(b' ');
        }
        start = last;
    }
    joined
}

/// The numbers of a vertex as they are written, 1 for a fourth that is not there, and the token of the fourth.
pub(super) fn vertex<'a>(
    keyword: &Token,
    rest: Tokens<'a>,
    vertex: usize,
) -> Result<([f64; 4], Option<Token<'a>>), Wrong> {
    let found = rest.clone().count();
    if !matches!(found, 3 | 4 | 6) {
        return Err(keyword.wrong(Problem::Vertex { vertex: Element::Vertex { vertex }, found }));
    }
    let (mut point, mut fourth) = ([0.0, 0.0, 0.0, 1.0], None);
    for (axis, token) in rest.take(if found == 4 { 4 } else { 3 }).enumerate() {
        token.finite(Element::VertexCoordinate { vertex, axis })?;
        point[axis] = token.parse().unwrap_or(f64::NAN);
        fourth = (axis == 3).then_some(token);
    }
    Ok((point, fourth))
}

/// A control point of a rational surface: its weight is no factor of what the file holds, but of what a net does.
fn weighted(
    keyword: &Token,
    [x, y, z, _]: [f64; 4],
    weight: &Token,
    vertex: usize,
    rational: bool,
) -> Result<[f64; 4], Wrong> {
    let weight = f64::from(weight.weight(Element::VertexCoordinate { vertex, axis: 3 }, rational)?);
    let point = [x * weight, y * weight, z * weight, weight];
    match point.iter().position(|&x| !(x as f32).is_finite()) {
        None => Ok(point),
        Some(axis) => {
            let (element, found) = (Element::VertexCoordinate { vertex, axis }, format!("{:e}", point[axis]));
            Err(keyword.wrong(Problem::Overflow { element, found }))
        }
    }
}

/// The index of a corner, from 0. Negative ones count back from the vertices `before` the face.
pub(super) fn corner(token: &Token, face: Element, before: usize, vertices: usize) -> Result<u32, Wrong> {
    let wrong = || token.wrong(Problem::Corner { face, found: token.shown() });
    let mut parts = token.text.split(|&byte| byte == b'/').map(|text| Token { text, offset: token.offset });
    let index: i64 = parts.next().and_then(|part| part.parse()).filter(|&i| i != 0).ok_or_else(wrong)?;
    let others: Vec<Token> = parts.collect();
    let is_index = |part: &Token| part.text.is_empty() || part.parse::<i64>().is_some_and(|i| i != 0);
    if others.len() > 2 || !others.iter().all(is_index) || others.last().is_some_and(|t| t.text.is_empty()) {
        return Err(wrong());
    }
    let from_zero = if index > 0 { index - 1 } else { before as i64 + index };
    match u32::try_from(from_zero) {
        Ok(corner) if (corner as usize) < vertices => Ok(corner),
        _ => Err(token.wrong(Problem::NoVertex { face, found: index.to_string(), vertices })),
    }
}
