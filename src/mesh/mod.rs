//! Polygon meshes and their subdivision surfaces.
//!
//! A [`Mesh`] is what is subdivided: faces of any number of corners, borders, holes, creases and corners, semi-sharp or
//! sharp. Its half-edges are found once ([`HalfEdges`]), with an error that names the edge or the vertex where the faces are
//! no manifold.
//!
//! # Roots and grids
//!
//! After one step of a scheme all faces are quads, or stay triangles. So the faces that a refinement begins with, its
//! *roots*, are the faces of the mesh itself or, where the scheme wants quads and the mesh has others, the quads of level 1.
//! A root refined `d` times is a grid of `s × s` quads, `s = 2^d`, and nothing else ever is: connectivity is neither stored
//! nor refined, since the index of every vertex is a closed form ([`Topology`]). What is not regular is around the corners of
//! roots and along their sharp sides: a vertex of another valence, on a border, or with sharp edges has a *ring*, its
//! neighbours refined with it, which is as large at every level.
//!
//! Vertices of a level are numbered root by root: the corners that it owns, the inner points of the edges that it owns, its
//! own inner points. So a range of roots is a range of vertices at every level.
//!
//! The rules are those of Catmull and Clark (1978) and Loop (1987), the creases those of DeRose, Kass and Truong (1998) as
//! OpenSubdiv has them.

mod connect;
mod explicit;
mod model;
mod options;
mod rings;
mod roots;
pub mod schemes;
mod sharpness;
mod topology;

pub use connect::{HalfEdges, MeshError, NONE};
pub use model::{Corner, Crease, Faces, Mesh};
pub use options::{Boundary, Creasing, Options, OptionsError};
pub use rings::{Creases, Ring, Rings};
pub use roots::{Roots, Special};
pub use schemes::Scheme;
pub use sharpness::{INFINITE, Rule};
pub use topology::{Counts, FaceParent, FirstPoints, Topology, TopologyError, VertexParent};
