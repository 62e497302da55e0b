//! How a mesh is subdivided.

use super::Scheme;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// How a mesh is subdivided; names and meanings are OpenSubdiv's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    pub scheme: Scheme,
    pub boundary: Boundary,
    pub creasing: Creasing,
}

/// What a border does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// Its edges are sharp: a border is a curve of its own (VTX_BOUNDARY_EDGE_ONLY).
    #[default]
    Edge,
    /// And so are its vertices that have one face alone (VTX_BOUNDARY_EDGE_AND_CORNER).
    Corner,
}

/// How the sharpness of a semi-sharp edge goes on to its halves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Creasing {
    /// Each has one less than the edge.
    #[default]
    Uniform,
    /// Averaged along the crease first, as Chaikin's curves are.
    Chaikin,
}

/// A word that names none of the options.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("`{found}` is no {what}; it is {}", known.join(" or "))]
pub struct OptionsError {
    what: &'static str,
    found: String,
    known: Vec<&'static str>,
}

/// Reads one of a list of words.
pub(super) fn word<T: Copy>(
    what: &'static str,
    all: &[(&'static str, T)],
    found: &str,
) -> Result<T, OptionsError> {
    let known = all.iter().find(|(name, _)| *name == found);
    known.map(|(_, value)| *value).ok_or_else(|| OptionsError {
        what,
        found: found.to_string(),
        known: all.iter().map(|(name, _)| *name).collect(),
    })
}

const BOUNDARIES: [(&str, Boundary); 2] = [("edge", Boundary::Edge), ("corner", Boundary::Corner)];
const CREASINGS: [(&str, Creasing); 2] = [("uniform", Creasing::Uniform), ("chaikin", Creasing::Chaikin)];

impl FromStr for Boundary {
    type Err = OptionsError;

    fn from_str(found: &str) -> Result<Boundary, OptionsError> {
        word("boundary interpolation", &BOUNDARIES, found)
    }
}

impl FromStr for Creasing {
    type Err = OptionsError;

    fn from_str(found: &str) -> Result<Creasing, OptionsError> {
        word("creasing", &CREASINGS, found)
    }
}

impl fmt::Display for Boundary {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(BOUNDARIES[*self as usize].0)
    }
}

impl fmt::Display for Creasing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(CREASINGS[*self as usize].0)
    }
}
