//! Leaves to triangles: the pure definitions.

pub mod bound;
pub mod budget;
pub mod grid;
pub mod lattice;
pub mod level;
pub mod orientation;
pub mod passes;
pub mod placement;
pub mod surface;
pub mod topology;
pub mod tree;
pub mod vertex;
pub mod vertices;
pub mod word;

use lattice::Node;
use passes::Status;
use rayon::prelude::*;
use std::collections::HashMap;
use std::hash::Hash;

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

    /// The edges of all triangles, each once, as pairs of vertices: a wireframe.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let around = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
        let mut edges: Vec<[u32; 2]> =
            self.triangles().flat_map(around).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.par_sort_unstable();
        edges.dedup();
        edges
    }

    /// The same triangles, where a vertex that triangles of different keys share is there once for each of the
    /// keys; and the key of each vertex. So colours can end sharply at an edge.
    pub fn parted<K: Copy + Eq + Hash>(&self, key_of_triangle: impl Fn(usize) -> K) -> (Mesh, Vec<K>) {
        let (mut mesh, mut keys) = (Mesh::default(), Vec::new());
        let mut known: HashMap<(u32, K), u32> = HashMap::with_capacity(self.positions.len());
        mesh.indices.reserve(self.indices.len());
        for (triangle, corners) in self.triangles().enumerate() {
            let key = key_of_triangle(triangle);
            for corner in corners {
                let index = *known.entry((corner, key)).or_insert_with(|| {
                    let (vertex, next) = (corner as usize, keys.len() as u32);
                    mesh.positions.push(self.positions[vertex]);
                    mesh.normals.push(self.normals[vertex]);
                    mesh.uvs.push(self.uvs[vertex]);
                    keys.push(key);
                    next
                });
                mesh.indices.push(index);
            }
        }
        (mesh, keys)
    }
}

/// A watertight tessellation on the host.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Complete {
    pub mesh: Mesh,
    /// Root and symbol of the leaf whose surface each triangle is; the symbol is 0 where there is no word.
    pub sources: Vec<[u32; 2]>,
    /// The most halvings that the cell of a triangle has along one direction.
    pub deepest: u32,
    pub status: Status,
}

impl Complete {
    /// From the nodes, and the node of each triangle.
    pub(crate) fn new(mesh: Mesh, nodes: &[Node], cells: &[u32], status: Status) -> Complete {
        let leaf = |&cell: &u32| nodes[cell as usize];
        let sources = cells.iter().map(leaf).map(|node| [node.root, node.symbol()]).collect();
        let deepest = cells.iter().map(leaf).map(|node| node.depth()[0].max(node.depth()[1])).max();
        Complete { mesh, sources, deepest: deepest.unwrap_or(0), status }
    }
}

/// A mesh of vertices in [`Format::default`]: 8 words each.
pub(crate) fn mesh_of(vertices: &[u32], indices: Vec<u32>) -> Mesh {
    let vertices: &[[f32; 8]] = bytemuck::cast_slice(vertices);
    Mesh {
        positions: vertices.iter().map(|v| [v[0], v[1], v[2]]).collect(),
        normals: vertices.iter().map(|v| [v[3], v[4], v[5]]).collect(),
        uvs: vertices.iter().map(|v| [v[6], v[7]]).collect(),
        indices,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of a square.
    fn square() -> Mesh {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        Mesh {
            normals: vec![[0.0, 0.0, 1.0]; 4],
            uvs: positions.iter().map(|p| [p[0], p[1]]).collect(),
            positions,
            indices: vec![0, 1, 2, 0, 2, 3],
        }
    }

    #[test]
    fn every_edge_comes_once() {
        assert_eq!(square().edges(), [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
        assert!(Mesh::default().edges().is_empty());
    }

    #[test]
    fn parting_keeps_triangles_and_doubles_what_keys_share() {
        let (mesh, keys) = square().parted(|triangle| triangle);
        assert_eq!((keys, &mesh.indices[..]), (vec![0, 0, 0, 1, 1, 1], &[0, 1, 2, 3, 4, 5][..]));
        let places =
            |mesh: &Mesh| mesh.indices.iter().map(|&i| mesh.positions[i as usize]).collect::<Vec<_>>();
        assert_eq!(places(&mesh), places(&square()));
        assert_eq!(square().parted(|_| 7), (square(), vec![7; 4]));
    }
}
