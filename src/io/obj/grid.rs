//! Quads as a grid of rows and columns.

use super::super::text::{Problem, Wrong};
use super::read::Polygons;
use crate::patch::ControlGrid;
use std::collections::HashMap;
use thiserror::Error;

/// Why faces are no grid of control points. Vertices and faces count from 1, as in the file.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GridError {
    #[error("the file has no faces; the control points of a B-spline are a grid of quads")]
    NoFaces,
    #[error("face {face} has {found} corners; the control points of a B-spline are a grid of quads")]
    NotAQuad { face: usize, found: usize },
    #[error("face {face} has vertex {vertex} at two of its corners")]
    Repeated { face: usize, vertex: usize },
    #[error(
        "faces {other} and {face} both run from vertex {from} to vertex {to}; \
         an edge has one face on either side, both wound the same way"
    )]
    Edge { face: usize, other: usize, from: usize, to: usize },
    #[error("vertex {vertex} lies inside and has {faces} faces around it; in a grid it has 4")]
    Inside { vertex: usize, faces: usize },
    #[error(
        "vertex {vertex} lies on the border and has {faces} faces; on the border of a grid it has 1 or 2"
    )]
    Border { vertex: usize, faces: usize },
    #[error("faces meet at vertex {vertex} in that point alone; in a grid they share edges")]
    Pinched { vertex: usize },
    #[error("face {face} hangs together with the first one nowhere; a file holds one grid")]
    Apart { face: usize },
    #[error("the rows and columns do not close: one that begins at face {face} comes back shifted")]
    Shifted { face: usize },
    #[error(
        "the grid has {rows} × {columns} control points; a patch needs 4 along a direction that is open, \
         3 along one that is closed"
    )]
    Small { rows: usize, columns: usize },
}

/// The grid of these faces, whose rows and columns [`super::parse_bspline`] describes.
pub fn control_grid(polygons: &Polygons) -> Result<ControlGrid, Wrong> {
    let quads = Quads::new(polygons)?;
    quads.check_vertices()?;
    let origin = quads.origin()?;
    let (faces, closed) = quads.rows(origin)?;
    quads.check_all_found(&faces)?;
    let [rows, columns] = [faces.len() + usize::from(!closed[0]), faces[0].len() + usize::from(!closed[1])];
    let enough = |points: usize, closed: bool| points >= if closed { 3 } else { 4 };
    if !enough(rows, closed[0]) || !enough(columns, closed[1]) {
        return Err(quads.at_face(origin.face, GridError::Small { rows, columns }));
    }
    // The corners of a face, in the order of its turns: a at (i, j), b at (i + 1, j), and so on.
    let point = |i: usize, j: usize| {
        let (row, last_row) = (i.min(faces.len() - 1), i == faces.len());
        let (column, last_column) = (j.min(faces[0].len() - 1), j == faces[0].len());
        let corner = [[0, 3], [1, 2]][usize::from(last_row)][usize::from(last_column)];
        polygons.vertices[quads.corner(faces[row][column], corner) as usize].point
    };
    let points =
        (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect();
    Ok(ControlGrid { rows, columns, closed, points })
}

/// A face, seen from one of its corners: that one lies at (i, j), the next at (i + 1, j), then
/// (i + 1, j + 1) and (i, j + 1).
#[derive(Clone, Copy, PartialEq)]
struct Place {
    face: usize,
    turn: usize,
}

/// The edge of a face, by the corner where it begins, and with it the direction across it.
#[derive(Clone, Copy)]
enum Across {
    BackV = 0,
    OnU = 1,
    OnV = 2,
    BackU = 3,
}

struct Quads<'a> {
    polygons: &'a Polygons,
    faces: Vec<[u32; 4]>,
    /// The face that runs from one vertex to another, and at which of its corners.
    edges: HashMap<[u32; 2], (usize, usize)>,
}

impl<'a> Quads<'a> {
    fn new(polygons: &'a Polygons) -> Result<Quads<'a>, Wrong> {
        if polygons.faces.is_empty() {
            return Err(Wrong { offset: polygons.end, problem: Problem::Grid(GridError::NoFaces) });
        }
        let count = polygons.faces.len();
        let mut quads =
            Quads { polygons, faces: Vec::with_capacity(count), edges: HashMap::with_capacity(4 * count) };
        for (index, face) in polygons.faces.iter().enumerate() {
            let face = &polygons.corners[face.range.clone()];
            let Ok(corners) = <[u32; 4]>::try_from(face) else {
                return Err(quads.at_face(index, GridError::NotAQuad { face: index + 1, found: face.len() }));
            };
            if let Some(i) = (1..4).find(|&i| corners[..i].contains(&corners[i])) {
                let vertex = corners[i] as usize + 1;
                return Err(quads.at_face(index, GridError::Repeated { face: index + 1, vertex }));
            }
            for i in 0..4 {
                let (from, to) = (corners[i], corners[(i + 1) % 4]);
                if let Some((other, _)) = quads.edges.insert([from, to], (index, i)) {
                    let (other, face) = (other + 1, index + 1);
                    let (from, to) = (from as usize + 1, to as usize + 1);
                    return Err(quads.at_face(index, GridError::Edge { face, other, from, to }));
                }
            }
            quads.faces.push(corners);
        }
        Ok(quads)
    }

    fn at_face(&self, face: usize, error: GridError) -> Wrong {
        Wrong { offset: self.polygons.faces[face].offset, problem: Problem::Grid(error) }
    }

    /// Four faces around every vertex inside, one or two at the border.
    fn check_vertices(&self) -> Result<(), Wrong> {
        let vertices = self.polygons.vertices.len();
        let (mut around, mut borders) = (vec![0usize; vertices], vec![0usize; vertices]);
        for corners in &self.faces {
            for i in 0..4 {
                let (from, to) = (corners[i], corners[(i + 1) % 4]);
                around[from as usize] += 1;
                borders[from as usize] += usize::from(!self.edges.contains_key(&[to, from]));
            }
        }
        for (index, (&faces, &borders)) in around.iter().zip(&borders).enumerate() {
            let vertex = index + 1;
            let error = match (borders, faces) {
                (0, 0 | 4) | (1, 1 | 2) => continue,
                (0, _) => GridError::Inside { vertex, faces },
                (1, _) => GridError::Border { vertex, faces },
                _ => GridError::Pinched { vertex },
            };
            let offset = self.polygons.vertices[index].offset;
            return Err(Wrong { offset, problem: Problem::Grid(error) });
        }
        Ok(())
    }

    fn corner(&self, place: Place, corner: usize) -> u32 {
        self.faces[place.face][(place.turn + corner) % 4]
    }

    fn step(&self, place: Place, across: Across) -> Option<Place> {
        let edge = across as usize;
        let (from, to) = (self.corner(place, edge), self.corner(place, edge + 1));
        let &(face, corner) = self.edges.get(&[to, from])?;
        // What is this edge here lies on the opposite side there.
        Some(Place { face, turn: (corner + 6 - edge) % 4 })
    }

    /// All places from `start` on in one direction, and whether they come back to it.
    fn walk(&self, start: Place, across: Across) -> Result<(Vec<Place>, bool), Wrong> {
        let mut places = vec![start];
        let mut place = start;
        while let Some(next) = self.step(place, across) {
            if next == start {
                return Ok((places, true));
            }
            if places.len() == self.faces.len() {
                return Err(self.at_face(start.face, GridError::Shifted { face: start.face + 1 }));
            }
            places.push(next);
            place = next;
        }
        Ok((places, false))
    }

    /// Back from the first face along both directions, as far as there are faces.
    fn origin(&self) -> Result<Place, Wrong> {
        let mut place = Place { face: 0, turn: 0 };
        for across in [Across::BackU, Across::BackV] {
            let (places, closed) = self.walk(place, across)?;
            if let (false, Some(&last)) = (closed, places.last()) {
                place = last;
            }
        }
        Ok(place)
    }

    /// The faces row by row, and whether they come back to the first along u and along v.
    fn rows(&self, origin: Place) -> Result<(Vec<Vec<Place>>, [bool; 2]), Wrong> {
        let (starts, closed_u) = self.walk(origin, Across::OnU)?;
        let (mut rows, mut found) = (Vec::with_capacity(starts.len()), 0);
        let mut closed_v = false;
        for &start in &starts {
            let (row, closed) = self.walk(start, Across::OnV)?;
            found += row.len();
            let first = rows.first().map_or(row.len(), Vec::len);
            if row.len() != first || found > self.faces.len() {
                return Err(self.at_face(start.face, GridError::Shifted { face: start.face + 1 }));
            }
            closed_v = closed;
            rows.push(row);
        }
        Ok((rows, [closed_u, closed_v]))
    }

    fn check_all_found(&self, rows: &[Vec<Place>]) -> Result<(), Wrong> {
        let mut found = vec![false; self.faces.len()];
        for (i, row) in rows.iter().enumerate() {
            for (j, &place) in row.iter().enumerate() {
                let next =
                    self.step(place, Across::OnU).is_none_or(|next| next == rows[(i + 1) % rows.len()][j]);
                if std::mem::replace(&mut found[place.face], true) || !next {
                    return Err(self.at_face(place.face, GridError::Shifted { face: place.face + 1 }));
                }
            }
        }
        match found.iter().position(|found| !found) {
            Some(face) => Err(self.at_face(face, GridError::Apart { face: face + 1 })),
            None => Ok(()),
        }
    }
}
