//! Polygons with their tags: a mesh to be subdivided.

use super::super::notes::{Noted, Tally};
use super::super::text::{Element, ParseError, Problem, ReadError, Token, Tokens, Wrong};
use super::read::{corner, is_passed_over, joined, statements, unread, vertex};
use crate::mesh::{Corner, Crease, Faces, Mesh};
use std::path::Path;

/// Reads the polygons of a file: [`parse_mesh`] with the path in every error.
///
/// # Errors
/// When the file cannot be read, or its text is wrong.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<Noted<Mesh>, ReadError> {
    ReadError::in_file(path.as_ref(), parse_mesh)
}

/// Reads polygons of any number of corners, with the tags that OpenSubdiv's files have: `t crease 2/1/0 V W S` for the edge
/// between vertices V and W, `t corner 1/1/0 V S` for a vertex, `t hole 1/0/0 F` for a face; S is a sharpness, vertices and
/// faces of tags are counted from 0. A fourth number of a vertex is a weight, which is passed over, as a colour is.
///
/// Lines, points and what is of free form is skipped, and a note counts it.
///
/// # Errors
/// The first thing that is wrong in the text. Whether the faces are a manifold is for
/// [`Topology::new`](crate::mesh::Topology::new) to say.
pub fn parse_mesh(text: &[u8]) -> Result<Noted<Mesh>, ParseError> {
    let joined = joined(text);
    polygons(&joined).map_err(|wrong| wrong.locate(text))
}

fn polygons(text: &[u8]) -> Result<Noted<Mesh>, Wrong> {
    let lines = || statements(text).filter_map(|mut tokens| Some((tokens.next()?, tokens)));
    let count = lines().filter(|(keyword, _)| keyword.text == b"v").count();
    let mut mesh = Mesh { positions: Vec::with_capacity(count), ..Mesh::default() };
    let (mut faces, mut corners, mut skipped) = (Faces::default(), Vec::new(), Tally::default());
    for (keyword, rest) in lines() {
        match keyword.text {
            b"v" => {
                let (point, _) = vertex(&keyword, rest, mesh.positions.len() + 1)?;
                mesh.positions.push([0, 1, 2].map(|k| point[k] as f32));
            }
            b"f" => {
                let face = Element::Face { face: faces.len() + 1 };
                corners.clear();
                for token in rest {
                    corners.push(corner(&token, face, mesh.positions.len(), count)?);
                }
                faces.push(corners.iter().copied());
            }
            b"t" => tag(&keyword, rest, &mut mesh)?,
            b"l" => skipped.add("line"),
            b"p" => skipped.add("point"),
            b"vt" => skipped.add("texture coordinate"),
            other => match unread(other) {
                Some(kind) => skipped.add(kind),
                None if is_passed_over(other) => {}
                None => return Err(keyword.wrong(Problem::Statement { found: keyword.shown() })),
            },
        }
    }
    if faces.is_empty() {
        let offset = text.trim_ascii_end().len();
        return Err(Wrong { offset, problem: Problem::Missing(Element::Face { face: 1 }) });
    }
    mesh.faces = faces;
    Ok(Noted { value: mesh, notes: skipped.note().into_iter().collect() })
}

/// `t KIND COUNTS NUMBERS`: what of it is read stands in the same places in every such file.
fn tag(keyword: &Token, rest: Tokens, mesh: &mut Mesh) -> Result<(), Wrong> {
    let tokens: Vec<Token> = rest.collect();
    let wrong = |token: &Token| token.wrong(Problem::Tag { found: token.shown() });
    let index = |token: &Token| token.parse::<u32>().ok_or_else(|| wrong(token));
    let number = |token: &Token| token.parse::<f32>().ok_or_else(|| wrong(token));
    let kind = tokens.first().ok_or_else(|| wrong(keyword))?;
    match (kind.text, &tokens[1..]) {
        (b"crease", [_, a, b, s]) => {
            mesh.creases.push(Crease { vertices: [index(a)?, index(b)?], sharpness: number(s)? });
        }
        (b"corner", [_, vertex, s]) => {
            mesh.corners.push(Corner { vertex: index(vertex)?, sharpness: number(s)? });
        }
        (b"hole", [_, face]) => mesh.holes.push(index(face)?),
        (b"crease" | b"corner" | b"hole", _) => return Err(wrong(kind)),
        // Options of other programs: a scheme, a boundary rule.
        _ => {}
    }
    Ok(())
}
