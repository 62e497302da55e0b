//! Everything that a mesh's subdivision needs and that does not depend on where its vertices are.

use super::connect::{HalfEdges, MeshError, NONE};
use super::explicit::first_step;
use super::rings::{Creases, Rings};
use super::roots::Roots;
use super::schemes::Combination;
use super::sharpness::Sharpness;
use super::{Mesh, Options};
use thiserror::Error;

/// A mesh made ready to be subdivided, once for any number of frames in which its vertices move.
#[derive(Clone, Debug)]
pub struct Topology {
    pub options: Options,
    pub roots: Roots,
    pub rings: Rings,
    /// Where faces are no quads: what the points of the roots are made of, from those of the mesh.
    pub first: Option<FirstPoints>,
    /// For each root the face that it comes of, and at which of the face's corners, or [`NONE`] where it is the face.
    sources: Vec<[u32; 2]>,
    mesh: HalfEdges,
    /// The first half-edge of each edge of the mesh, where the roots have points of edges.
    firsts: Vec<u32>,
}

/// Points as combinations of others, a row each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FirstPoints {
    pub starts: Vec<u32>,
    pub points: Vec<u32>,
    pub weights: Vec<f32>,
}

impl FirstPoints {
    fn new(rows: &[Combination]) -> FirstPoints {
        let mut all = FirstPoints { starts: vec![0], ..FirstPoints::default() };
        for row in rows {
            all.points.extend(row.terms.iter().map(|term| term.0));
            all.weights.extend(row.terms.iter().map(|term| term.1 as f32));
            all.starts.push(all.points.len() as u32);
        }
        all
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The points of a row with their weights.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (u32, f32)> {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        self.points[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }
}

/// The most levels that are counted: then there are more vertices than 64 bits can say, wherever there are any.
const DEEPEST: u32 = 47;

/// How much there is of a level. Vertices of no face are only in level 0 of a mesh whose faces are not all quads, which is
/// the mesh as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// With those that only holes have.
    pub vertices: u64,
    pub edges: u64,
    /// Without holes.
    pub faces: u64,
}

/// Why a mesh is not subdivided so far.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TopologyError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(
        "level {level} is too fine: level {} would have {vertices} vertices and {faces} faces, more than 32-bit \
         indices can name; level {most} is the last that has fewer", (*.most + 1).min(*.level)
    )]
    TooFine { level: u32, vertices: u128, faces: u128, most: u32 },
}

/// Where a face of a level comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceParent {
    /// The face of the mesh.
    pub face: u32,
    /// The corner of the face whose quad it lies in, where the mesh has faces that are no quads.
    pub corner: Option<u32>,
    /// Its rectangle in the unit square of the face, or of that quad: (0, 0) is the face's first corner or the corner, u
    /// runs along the edge that begins there.
    pub uv: [[f32; 2]; 2],
}

/// Where a vertex of a level comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VertexParent {
    Vertex(u32),
    /// Between two vertices of the mesh, so far along.
    Edge {
        vertices: [u32; 2],
        at: f32,
    },
    /// Inside a face: as in [`FaceParent`].
    Face {
        face: u32,
        corner: Option<u32>,
        uv: [f32; 2],
    },
}

impl Topology {
    /// # Errors
    /// What is wrong with the mesh, by its faces, edges and vertices.
    pub fn new(mesh: &Mesh, options: &Options) -> Result<Topology, TopologyError> {
        let halves = HalfEdges::new(mesh)?;
        let sharpness = Sharpness::new(mesh, &halves, options)?;
        let faces = halves.face_count();
        let mut hole = vec![false; faces];
        for &face in &mesh.holes {
            *hole.get_mut(face as usize).ok_or(MeshError::NoFace(face, faces))? = true;
        }
        let quads = halves.arity() == Some(4);
        let (own, sharp, first, sources) = match quads {
            true => (halves.clone(), sharpness, None, (0..faces as u32).map(|face| [face, NONE]).collect()),
            false => {
                let step = first_step(&halves, &sharpness, options);
                let source = |half: u32| {
                    let face = halves.face(half);
                    [face, half - halves.of_face(face as usize).start]
                };
                let sources = (0..halves.len() as u32).map(source).collect();
                (step.halves, step.sharpness, Some(FirstPoints::new(&step.points)), sources)
            }
        };
        let sources: Vec<[u32; 2]> = sources;
        let order = order(&own, &sharp, |root| hole[sources[root as usize][0] as usize]);
        let solid = order.iter().filter(|&&root| !hole[sources[root as usize][0] as usize]).count();
        let (own, sharp) = reordered(&own, &sharp, &order);
        let mut roots = Roots::new(own, sharp, solid);
        let rings = Rings::new(&mut roots, options.scheme);
        let sources = order.iter().map(|&root| sources[root as usize]).collect();
        let firsts = if quads { Vec::new() } else { halves.firsts() };
        Ok(Topology { options: *options, roots, rings, first, sources, mesh: halves, firsts })
    }

    /// Levels before the roots: 0, or 1 where faces are no quads.
    pub fn first_level(&self) -> u32 {
        u32::from(self.first.is_some())
    }

    /// How much there is of a level. Level 0 is the mesh.
    pub fn counts(&self, level: u32) -> Counts {
        let roots = &self.roots;
        let Some(depth) = level.checked_sub(self.first_level()) else {
            let holes = self.sources[roots.solid..].iter().filter(|source| source[1] == 0).count();
            return Counts {
                vertices: self.mesh_vertices() as u64,
                edges: self.mesh.edge_count as u64,
                faces: (self.mesh.face_count() - holes) as u64,
            };
        };
        let depth = depth.min(DEEPEST);
        let s = 1u128 << depth;
        let edges = roots.halves.edge_count as u128 * s + 2 * roots.len() as u128 * s * (s - 1);
        let bounded = |n: u128| u64::try_from(n).unwrap_or(u64::MAX);
        Counts {
            vertices: bounded(roots.count(roots.len(), depth)),
            edges: bounded(edges),
            faces: bounded(roots.solid as u128 * s * s),
        }
    }

    /// How its creases go on through the levels up to this one.
    ///
    /// # Errors
    /// A level of more vertices, or corners of faces, than 32-bit indices can name.
    pub fn creases(&self, level: u32) -> Result<Creases, TopologyError> {
        self.check(level)?;
        let depth = level.saturating_sub(self.first_level());
        Ok(Creases::new(&self.roots, &self.rings, self.options.creasing, depth as usize))
    }

    fn check(&self, level: u32) -> Result<(), TopologyError> {
        let sizes = |level: u32| {
            let depth = level.saturating_sub(self.first_level()).min(DEEPEST);
            let faces = (self.roots.len() as u128) << (2 * depth);
            (self.roots.count(self.roots.len(), depth), faces)
        };
        let fits = |level: u32| {
            let (vertices, faces) = sizes(level);
            // Corners of triangles.
            vertices < u128::from(NONE) && 6 * faces < u128::from(NONE)
        };
        if fits(level) && level < 32 {
            return Ok(());
        }
        let most = (0..32).take_while(|&level| fits(level)).last().unwrap_or(0);
        let (vertices, faces) = sizes(level.min(most + 1));
        Err(TopologyError::TooFine { level, vertices, faces, most })
    }

    /// Where face `face` of a level comes from; a level has its faces root after root, row by row.
    pub fn face_parent(&self, level: u32, face: u32) -> FaceParent {
        if level < self.first_level() {
            return FaceParent { face, corner: None, uv: [[0.0; 2], [1.0; 2]] };
        }
        let depth = level.saturating_sub(self.first_level());
        let s = 1u32 << depth;
        let (root, at) = (face >> (2 * depth), face & (s * s - 1));
        let (x, y) = (at & (s - 1), at >> depth);
        let [face, corner] = self.sources[root as usize];
        let by = 1.0 / s as f32;
        let uv = [[x, y], [x + 1, y + 1]].map(|p| p.map(|c| c as f32 * by));
        FaceParent { face, corner: Some(corner).filter(|&c| c != NONE), uv }
    }

    /// Where vertex `vertex` of a level comes from.
    pub fn vertex_parent(&self, level: u32, vertex: u32) -> VertexParent {
        if level < self.first_level() {
            return VertexParent::Vertex(vertex);
        }
        let depth = level.saturating_sub(self.first_level());
        let (roots, s) = (&self.roots, 1usize << depth);
        // The root that owns it is the last whose vertices do not begin after it.
        let (mut low, mut high) = (0, roots.len());
        while high - low > 1 {
            let middle = (low + high) / 2;
            match roots.base(middle, s) <= vertex as usize {
                true => low = middle,
                false => high = middle,
            }
        }
        let (root, mut at) = (low, vertex - roots.base(low, s) as u32);
        for k in (0..4).filter(|&k| roots.owns_corner(root, k)) {
            if at == 0 {
                return self.point_parent(roots.halves.origin((4 * root + k) as u32));
            }
            at -= 1;
        }
        let m = s as u32 - 1;
        for k in (0..4).filter(|&k| roots.owns_side(root, k)) {
            if at < m {
                return self.side_parent((4 * root + k) as u32, (at + 1) as f32 / s as f32);
            }
            at -= m;
        }
        let [face, corner] = self.sources[root];
        let uv = [at % m + 1, at / m + 1].map(|c| c as f32 / s as f32);
        VertexParent::Face { face, corner: Some(corner).filter(|&c| c != NONE), uv }
    }

    /// Of a corner of the roots.
    fn point_parent(&self, point: u32) -> VertexParent {
        let (vertices, faces) = (self.mesh.outgoing.len() as u32, self.mesh.face_count() as u32);
        match point {
            _ if self.first.is_none() || point < vertices => VertexParent::Vertex(point),
            _ if point < vertices + faces => {
                let face = point - vertices;
                VertexParent::Face { face, corner: Some(0), uv: [1.0, 1.0] }
            }
            _ => self.edge_parent(self.firsts[(point - vertices - faces) as usize], 0.5),
        }
    }

    /// So far along a half-edge of the mesh.
    fn edge_parent(&self, half: u32, at: f32) -> VertexParent {
        VertexParent::Edge { vertices: [self.mesh.origin(half), self.mesh.end(half)], at }
    }

    /// So far along a side of a root.
    fn side_parent(&self, half: u32, at: f32) -> VertexParent {
        let halves = &self.roots.halves;
        let ends = [halves.origin(half), halves.end(half)];
        if self.first.is_none() {
            return VertexParent::Edge { vertices: ends, at };
        }
        let [face, corner] = self.sources[(half / 4) as usize];
        let corner_half = self.mesh.of_face(face as usize).start + corner;
        // The first side runs along the first half of an edge of the face, the last along the second half of another.
        match half & 3 {
            0 => self.edge_parent(corner_half, 0.5 * at),
            3 => self.edge_parent(self.mesh.previous(corner_half), 0.5 + 0.5 * at),
            side => {
                let uv = if side == 1 { [1.0, at] } else { [1.0 - at, 1.0] };
                VertexParent::Face { face, corner: Some(corner), uv }
            }
        }
    }

    /// The vertices of the mesh, whether a face has them or not.
    pub fn mesh_vertices(&self) -> usize {
        self.mesh.outgoing.len()
    }
}

/// Roots as their vertices are numbered: holes last, and before that those that are regular, those with special corners
/// alone, and those with a sharp side, for each of which kernels have a variant.
fn order(halves: &HalfEdges, sharp: &Sharpness, is_hole: impl Fn(u32) -> bool) -> Vec<u32> {
    let vertices = halves.outgoing.len() as u32;
    let special: Vec<bool> = (0..vertices)
        .map(|v| !super::rings::is_regular(halves, v) || !sharp.is_smooth_at(halves, v))
        .collect();
    let class = |&root: &u32| {
        let own = 4 * root..4 * root + 4;
        let sharp = own.clone().any(|half| sharp.edges[halves.edge(half) as usize] > 0.0);
        let special = own.clone().any(|half| special[halves.origin(half) as usize]);
        (is_hole(root), if sharp { 2 } else { u8::from(special) })
    };
    let mut order: Vec<u32> = (0..halves.face_count() as u32).collect();
    order.sort_by_key(class);
    order
}

/// The same quads in another order.
fn reordered(halves: &HalfEdges, sharp: &Sharpness, order: &[u32]) -> (HalfEdges, Sharpness) {
    let mut place = vec![0u32; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old as usize] = new as u32);
    let old_halves = || order.iter().flat_map(|&root| 4 * root..4 * root + 4);
    let moved = |half: u32| if half == NONE { NONE } else { 4 * place[(half / 4) as usize] + (half & 3) };
    let origins = old_halves().map(|half| halves.origin(half)).collect();
    let twins = old_halves().map(|half| moved(halves.twins[half as usize])).collect();
    let new = HalfEdges::of_twins(4, origins, twins, halves.outgoing.len());
    let mut edges = vec![0.0; new.edge_count];
    for (at, half) in old_halves().enumerate() {
        edges[new.edges[at] as usize] = sharp.edges[halves.edge(half) as usize];
    }
    (new, Sharpness { edges, vertices: sharp.vertices.clone() })
}
