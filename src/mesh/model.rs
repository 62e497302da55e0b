//! The mesh that is subdivided: what a file or a program says of it.

/// A control mesh: polygons with what their subdivision needs to know. Vertices, faces and values are counted from 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub positions: Vec<[f32; 3]>,
    pub faces: Faces,
    /// Edges that are not smooth; of two that name the same edge the sharper one holds.
    pub creases: Vec<Crease>,
    /// Vertices that are not smooth; of two that name the same vertex the sharper one holds.
    pub corners: Vec<Corner>,
    /// Faces that are there for their neighbours and not drawn.
    pub holes: Vec<u32>,
}

/// The vertices of polygons, counter-clockwise as seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Faces {
    starts: Vec<u32>,
    vertices: Vec<u32>,
}

/// An edge that stays sharp for so many levels; forever from [`INFINITE`](super::INFINITE) on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    pub vertices: [u32; 2],
    pub sharpness: f32,
}

/// A vertex that stays sharp for so many levels; forever from [`INFINITE`](super::INFINITE) on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    pub vertex: u32,
    pub sharpness: f32,
}

impl Default for Faces {
    fn default() -> Faces {
        Faces { starts: vec![0], vertices: Vec::new() }
    }
}

impl Faces {
    /// Adds a face.
    pub fn push(&mut self, vertices: impl IntoIterator<Item = u32>) {
        self.vertices.extend(vertices);
        self.starts.push(self.vertices.len() as u32);
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices of a face.
    pub fn get(&self, face: usize) -> &[u32] {
        &self.vertices[self.starts[face] as usize..self.starts[face + 1] as usize]
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.len()).map(|face| self.get(face))
    }

    /// Where the corners of each face begin in [`Faces::vertices`], and their number after the last.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The corners of all faces, one face after the other.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// All have so many corners.
    pub fn all_have(&self, corners: usize) -> bool {
        self.starts.windows(2).all(|w| (w[1] - w[0]) as usize == corners)
    }
}

impl<F: IntoIterator<Item = u32>> FromIterator<F> for Faces {
    fn from_iter<I: IntoIterator<Item = F>>(faces: I) -> Faces {
        let mut all = Faces::default();
        faces.into_iter().for_each(|face| all.push(face));
        all
    }
}

impl Mesh {
    /// A mesh without tags.
    pub fn new(positions: Vec<[f32; 3]>, faces: Faces) -> Mesh {
        Mesh { positions, faces, ..Mesh::default() }
    }

    /// The diagonal of the box around its vertices: what errors are measured by.
    pub fn size(&self) -> f32 {
        let (mut low, mut high) = ([f32::MAX; 3], [f32::MIN; 3]);
        for p in &self.positions {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        match self.positions.is_empty() {
            true => 0.0,
            false => (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f32>().sqrt(),
        }
    }
}
