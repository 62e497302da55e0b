//! Where vertices go in the limit, and which way the surface lies there.

use super::Rule;

/// A vertex at the level from which it goes to the limit.
#[derive(Clone, Copy, Debug)]
pub struct Limit<'a> {
    pub rule: Rule,
    /// Faces around it.
    pub faces: usize,
    /// Edges around it: as many, or one more on a border.
    pub edges: usize,
    /// Sharpness of the edges, counter-clockwise.
    pub sharp: &'a [f32],
    /// The face whose sector between sharp edges the tangents are for: face k lies between edges k and k + 1.
    pub face: usize,
}

/// Weights of the vertex, of the other end of each of its edges, of the opposite corner of each of its faces: first for
/// the position, then for two tangents, the second counter-clockwise from the first.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitMasks {
    pub vertex: [f64; 3],
    pub edges: Vec<[f64; 3]>,
    pub faces: Vec<[f64; 3]>,
}

impl LimitMasks {
    pub(super) fn zero(limit: &Limit) -> LimitMasks {
        LimitMasks {
            vertex: [0.0; 3],
            edges: vec![[0.0; 3]; limit.edges],
            faces: vec![[0.0; 3]; limit.faces],
        }
    }

    /// Position and tangents, from the points of a ring in this order.
    pub fn apply(&self, points: impl Iterator<Item = [f32; 4]>) -> [[f64; 3]; 3] {
        let mut sums = [[0.0f64; 3]; 3];
        let weights = std::iter::once(&self.vertex).chain(&self.edges).chain(&self.faces);
        for (weights, point) in weights.zip(points) {
            for (sum, w) in sums.iter_mut().zip(weights) {
                for (sum, x) in sum.iter_mut().zip(point) {
                    *sum += w * f64::from(x);
                }
            }
        }
        sums
    }
}

/// A vertex that stays where it is: its tangents run along the edges of the face.
pub(super) fn corner(limit: &Limit) -> LimitMasks {
    let mut masks = LimitMasks::zero(limit);
    masks.vertex = [1.0, -1.0, -1.0];
    masks.edges[limit.face][1] += 1.0;
    masks.edges[(limit.face + 1) % limit.edges][2] += 1.0;
    masks
}

/// A vertex on a crease, which is a cubic B-spline. `across` gives the weights of the tangent across it in a sector of k
/// faces, two or more: of the vertex, of both ends of the crease, of the edges within, and of the faces.
pub(super) fn crease(limit: &Limit, across: impl Fn(usize) -> (f64, f64, Vec<f64>, Vec<f64>)) -> LimitMasks {
    let mut masks = LimitMasks::zero(limit);
    let edges = limit.edges;
    let mut sharp = (0..edges).filter(|&i| limit.sharp[i] > 0.0);
    let (Some(first), Some(second)) = (sharp.next(), sharp.next()) else { return corner(limit) };
    // Counter-clockwise from a to b around the sector that holds the face.
    let inside = limit.faces < edges || first <= limit.face && limit.face < second;
    let (a, b) = if inside { (first, second) } else { (second, first) };
    let k = (b + edges - a) % edges;
    masks.vertex[0] = 2.0 / 3.0;
    for (end, along) in [(a, 0.5), (b, -0.5)] {
        masks.edges[end] = [1.0 / 6.0, along, 0.0];
    }
    if k == 1 {
        masks.vertex[2] = -6.0;
        (masks.edges[a][2], masks.edges[b][2]) = (3.0, 3.0);
        return masks;
    }
    let (own, ends, within, faces) = across(k);
    masks.vertex[2] = own;
    (masks.edges[a][2], masks.edges[b][2]) = (ends, ends);
    for (i, weight) in within.into_iter().enumerate() {
        masks.edges[(a + 1 + i) % edges][2] = weight;
    }
    for (i, weight) in faces.into_iter().enumerate() {
        masks.faces[(a + i) % limit.faces.max(edges)][2] = weight;
    }
    masks
}
