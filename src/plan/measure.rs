//! What a stage's rules read of their modules' nets: the attributes, and where their values stand.
//!
//! The pass `measure` writes them before anything is matched, a row of 4-byte words a module, so
//! that `match_modules` and `emit` read one value and never two that rounding made different. Only
//! attributes that the stage reads have a place.

use super::tables::Stage;
use super::turtle;
use crate::language::expr::{Expr, ExprKind};

/// An attribute that is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measure {
    /// As rules name it.
    pub name: &'static str,
    /// Words of its value.
    pub words: usize,
    /// The prologue's constant that says where it stands.
    pub place: &'static str,
}

/// All of them, in the order in which they stand.
pub const MEASURES: [Measure; 8] = [
    Measure { name: "centroid", words: 3, place: "CENTROID" },
    Measure { name: "flatness", words: 1, place: "FLATNESS" },
    Measure { name: "bend_u", words: 1, place: "BEND_U" },
    Measure { name: "bend_v", words: 1, place: "BEND_V" },
    Measure { name: "area", words: 1, place: "AREA" },
    Measure { name: "bbox_px", words: 1, place: "BBOX_PX" },
    Measure { name: "area_px", words: 1, place: "AREA_PX" },
    Measure { name: "uv", words: 2, place: "UV" },
];

/// Which attributes a stage reads, and where in a module's row each begins.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// The row is the turtle's: [`turtle::ROW_WORDS`], which the pass `turtle` writes.
    pub turtle: bool,
    /// For each of [`MEASURES`].
    pub places: [Option<usize>; MEASURES.len()],
    /// Words a module.
    pub words: usize,
}

impl Row {
    /// What these expressions read.
    pub fn of<'e>(expressions: impl Iterator<Item = &'e Expr>) -> Row {
        let mut read = [false; MEASURES.len()];
        let mut row = Row::default();
        for e in expressions {
            e.walk(&mut |e| {
                if let ExprKind::Attribute(name) = e.kind {
                    row.turtle |= turtle::place(name).is_some();
                    if let Some(n) = index(name) {
                        read[n] = true;
                    }
                }
            });
        }
        if row.turtle {
            row.words = turtle::ROW_WORDS;
            return row;
        }
        for (n, measure) in MEASURES.iter().enumerate().filter(|(n, _)| read[*n]) {
            row.places[n] = Some(row.words);
            row.words += measure.words;
        }
        row
    }

    /// What the rules of a stage read.
    pub fn of_stage(stage: &Stage) -> Row {
        let rules = stage.rules.iter().flat_map(|r| r.lets.iter().chain(&r.guards).chain(&r.weights));
        let cells = stage.productions.iter().flat_map(|p| p.successors().map(|(_, cell)| cell));
        Row::of(rules.chain(cells.flat_map(|c| &c.args)))
    }

    /// Where an attribute begins.
    pub fn place(&self, name: &str) -> Option<usize> {
        if self.turtle {
            return turtle::place(name);
        }
        self.places[index(name)?]
    }

    /// Whether the net is looked at, and not its address alone.
    pub fn reads_nets(&self) -> bool {
        self.places.iter().zip(MEASURES).any(|(place, measure)| place.is_some() && measure.name != "uv")
    }
}

fn index(name: &str) -> Option<usize> {
    MEASURES.iter().position(|m| m.name == name)
}

/// Whether the attribute is one of the screen, which wants a [`View`](super::given::View).
pub fn of_the_screen(name: &str) -> bool {
    matches!(name, "bbox_px" | "area_px")
}
