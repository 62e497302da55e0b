//! What a reader passes over, counted by kind.

use std::fmt;

/// What a file holds, and what is to be said of it: what was passed over is named here and nowhere lost in silence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noted<T> {
    pub value: T,
    /// Sentences without the name of the file.
    pub notes: Vec<String>,
}

impl<T> From<T> for Noted<T> {
    fn from(value: T) -> Noted<T> {
        Noted { value, notes: Vec::new() }
    }
}

/// How many of each kind were passed over, in the order in which the kinds came.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tally(Vec<(String, usize)>);

impl Tally {
    pub fn add(&mut self, kind: &str) {
        match self.0.iter_mut().find(|(known, _)| known == kind) {
            Some((_, count)) => *count += 1,
            None => self.0.push((kind.to_string(), 1)),
        }
    }

    /// One note, or none if nothing was passed over.
    pub fn note(&self) -> Option<String> {
        (!self.0.is_empty()).then(|| format!("skipped {self}"))
    }
}

impl fmt::Display for Tally {
    /// `2 × text, 1 × image`; of many kinds the first.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const SHOWN: usize = 8;
        for (n, (kind, count)) in self.0.iter().take(SHOWN).enumerate() {
            write!(f, "{}{count} × {kind}", if n > 0 { ", " } else { "" })?;
        }
        match self.0.iter().skip(SHOWN).map(|(_, count)| count).sum::<usize>() {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}
