//! Values from outside that rules ask for by queries without `=`.

use crate::language::Value;

/// The values of one query.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// One for each root of the axiom, inherited by all that comes of it.
    Roots(Vec<Value>),
    Grid(Grid),
}

/// Values at the points of a box's regular grid, asked for as `E(p)`: linear between the points
/// along each axis, constant beyond the box. Ints and bools are those of the nearest point.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Points along x, y and z, each at least 1.
    pub size: [u32; 3],
    /// Where the first point lies, and the last.
    pub from: [f32; 3],
    pub to: [f32; 3],
    /// x fastest, then y, then z.
    pub values: Vec<Value>,
}
