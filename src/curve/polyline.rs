//! Curves as files hold them, and what an axiom makes of those that fit its word only in part.

use crate::language::Type;
use crate::language::system::{Axiom, CurveSource, CurveStart, Field, Kind, System, Topology};
use std::fmt;

/// A curve of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    /// x, y, z and a fourth coordinate, 1 where the file has none.
    pub points: Vec<[f32; 4]>,
    /// Whether its last point is followed by its first, which stands there once. `None` where the file does not say: a
    /// ring takes it as closed, other words as open.
    pub closed: Option<bool>,
}

impl From<Vec<[f32; 4]>> for Polyline {
    fn from(points: Vec<[f32; 4]>) -> Polyline {
        Polyline { points, closed: None }
    }
}

impl Polyline {
    /// Its points in a word: what is closed comes back to its first point, unless the word does so itself.
    pub(super) fn into_word(mut self, kind: &Kind) -> Vec<[f32; 4]> {
        if *kind != Kind::Curve(Topology::Ring) && self.closed == Some(true) && self.points.len() > 1 {
            self.points.extend(self.points.first().copied());
        }
        self.points
    }
}

/// What an axiom does to the curves of a file, where that is not plain from them.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// All of them are one part of a word.
    Joined { curves: usize },
    /// A ring goes on from the last point of an open curve to its first.
    Closed { open: usize, curves: usize },
    /// A coordinate, by its index, that the module does not hold.
    LeftOut { axis: usize, points: usize, module: String, ty: Type },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Note::Joined { curves } => {
                write!(f, "{curves} curves are joined to one, each from the end of the one before")
            }
            Note::Closed { open: 1, curves: 1 } => {
                write!(f, "the curve is open; a ring joins its last point to its first")
            }
            Note::Closed { open, curves } => {
                let are = if *open == 1 { "is" } else { "are" };
                let joins = "a ring joins the last point of each to its first";
                write!(f, "{open} of {curves} curves {are} open; {joins}")
            }
            Note::LeftOut { axis, points, module, ty } => {
                let axis = ["x", "y", "z", "the weight"][*axis];
                let points = if *points == 1 { "1 point".to_string() } else { format!("{points} points") };
                write!(f, "{axis} of {points} is left out: {module} holds a {ty}")
            }
        }
    }
}

/// What is to be said of these curves of a file where a system reads them; `joined` if as one part of its word.
pub fn notes(system: &System, file: &str, curves: &[Polyline], joined: bool) -> Vec<Note> {
    let mut notes = Vec::new();
    if joined && curves.len() > 1 {
        notes.push(Note::Joined { curves: curves.len() });
    } else if system.kind == Kind::Curve(Topology::Ring) && starts(system).len() == 1 {
        let open = curves.iter().filter(|c| c.closed == Some(false) && c.points.len() > 1).count();
        if open > 0 {
            notes.push(Note::Closed { open, curves: curves.len() });
        }
    }
    let Some((module, field)) = taken(system, file) else { return notes };
    let points = || curves.iter().flat_map(|curve| &curve.points);
    for (axis, usual) in [(2, 0.0), (3, 1.0)].into_iter().skip(dimension(&field.ty).saturating_sub(2)) {
        let points = points().filter(|point| point[axis] != usual).count();
        if points > 0 {
            let (module, ty) = (module.to_string(), field.ty.clone());
            notes.push(Note::LeftOut { axis, points, module, ty });
        }
    }
    notes
}

/// How many coordinates a vector has; 4 of anything else.
fn dimension(ty: &Type) -> usize {
    match ty {
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        _ => 4,
    }
}

/// How many coordinates of a point the axiom takes from this file: 2 to 4.
pub fn coordinates(system: &System, file: &str) -> usize {
    taken(system, file).map_or(4, |(_, field)| dimension(&field.ty))
}

/// The module, and its field, that holds most of a point of this file.
fn taken<'a>(system: &'a System, file: &str) -> Option<(&'a str, &'a Field)> {
    let field = |start: &'a CurveStart| match start {
        CurveStart::Points { symbol, args, source: CurveSource::File { path, .. }, .. } if path == file => {
            let symbol = &system.symbols[*symbol];
            let (field, _) = symbol.fields.iter().zip(args).find(|(_, arg)| arg.is_none())?;
            Some((symbol.name.as_str(), field))
        }
        _ => None,
    };
    starts(system).iter().filter_map(field).max_by_key(|(_, field)| dimension(&field.ty))
}

fn starts(system: &System) -> &[CurveStart] {
    match &system.axiom {
        Axiom::Curve(starts) => starts,
        _ => &[],
    }
}
