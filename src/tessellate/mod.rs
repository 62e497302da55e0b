//! Leaves to triangles: the pure definitions.

pub mod bound;
pub mod grid;
pub mod lattice;
pub mod level;
pub mod orientation;
pub mod passes;
pub mod surface;
pub mod topology;
pub mod tree;
pub mod vertex;
pub mod word;

pub use grid::{Error, dice, grid_for, per_vertex};
pub use level::{Camera, Level, LevelError, Measure};
pub use topology::Topology;
pub use vertex::Format;

/// How the vertices of a watertight tessellation are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    pub format: Format,
    /// Vertices on the curves between patches are made for each patch, with its own uv and normal, equal
    /// to the bit in position; else all patches of a curve share them, with the uv of one.
    pub seams: bool,
}

/// Which axis of a model points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// The front is seen from +z.
    #[default]
    Y,
    /// The front is seen from −y.
    Z,
}

/// An indexed triangle mesh. Positions, normals and uvs run in parallel, one of each a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub positions: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// In the unit square of the root that the vertex comes from.
    pub uvs: Vec<[f32; 2]>,
    /// Three a triangle, counter-clockwise seen from the side that the normals point to.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// The triangles as index triples.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [u32; 3]> + '_ {
        self.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]])
    }
}
