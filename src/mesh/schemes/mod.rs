//! Schemes: masks, and nothing else. A new scheme is a file here and a line in the list below.

mod bilinear;
mod catmull_clark;
mod limits;
mod masks;

pub use bilinear::Bilinear;
pub use catmull_clark::CatmullClark;
pub use limits::{Limit, LimitMasks};
pub use masks::{Combination, Vector, edge_point, vertex_point};

use super::options::{OptionsError, word};
use super::sharpness::Rule;
use std::fmt;
use std::str::FromStr;

/// The masks of a scheme that makes four quads of one, as expressions: they run on points, on the lanes of a kernel, and on
/// [`Combination`]s, which tells the weights.
///
/// Sums are grouped so that no turn and no reflection of a quad changes them, and weights of regular masks are powers of
/// two: so a product and a sum may be fused or not, and no bit changes.
pub trait QuadScheme {
    /// The middle of a quad, from its corners in their order.
    fn face<V: Vector>(corners: [V; 4]) -> V;

    /// The new point of a smooth edge, from its ends and the new points of the faces on both sides.
    fn edge<V: Vector>(ends: [V; 2], faces: [V; 2]) -> V;

    /// A smooth vertex of four quads, from itself, the other ends of its edges and the new points of its faces: of both
    /// first two that are opposite, then the two others.
    fn vertex<V: Vector>(vertex: V, edges: [V; 4], faces: [V; 4]) -> V;

    /// Of a smooth vertex of `valence` faces the weight of itself, then that of the sum of the other ends of its edges and
    /// the new points of its faces.
    fn ring(valence: usize) -> [f64; 2];

    /// Position and tangents of a vertex in the limit, from itself, the other ends of its edges and the opposite corners of
    /// its faces at the same level.
    fn limit(limit: &Limit) -> LimitMasks;

    /// For the limit at a vertex of four quads, which is a tensor product: what its three rows make of a column of points.
    fn column<V: Vector>(column: [V; 3]) -> [V; 2];

    /// Position and tangents in the limit, along the row and along the column, from [`QuadScheme::column`] of the column
    /// before, its own and the one after it.
    fn row<V: Vector>(columns: [[V; 2]; 3]) -> [V; 3];

    /// A vertex on a crease, from itself and the other ends of its two sharp edges. Written so that its weights are powers
    /// of two.
    fn crease<V: Vector>(vertex: V, ends: [V; 2]) -> V {
        let [a, b] = ends;
        vertex.clone() * 0.5 + ((vertex.clone() + vertex) + (a + b)) * 0.125
    }
}

/// What is done for a scheme that is known when the program runs.
pub trait Visit {
    type Output;
    fn quads<S: QuadScheme>(self) -> Self::Output;
}

macro_rules! schemes {
    ($($(#[$about:meta])* $scheme:ident $name:literal $split:ident;)*) => {
        /// How faces are split and where new points go.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum Scheme {
            $($(#[$about])* $scheme,)*
        }

        impl Scheme {
            /// All there are, by the names that the language and the command have for them.
            pub const ALL: &[(&str, Scheme)] = &[$(($name, Scheme::$scheme)),*];

            /// Calls the visitor with the masks of the scheme.
            pub fn visit<V: Visit>(self, visit: V) -> V::Output {
                match self {
                    $(Scheme::$scheme => visit.$split::<$scheme>(),)*
                }
            }
        }
    };
}

schemes! {
    /// Catmull and Clark (1978): bicubic B-splines where four quads meet at each vertex.
    #[default]
    CatmullClark "catmull_clark" quads;
    /// Every new point is the middle of what it comes of: finer quads of the same shape.
    Bilinear "bilinear" quads;
}

impl FromStr for Scheme {
    type Err = OptionsError;

    fn from_str(found: &str) -> Result<Scheme, OptionsError> {
        word("scheme", Scheme::ALL, found)
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let name = Scheme::ALL.iter().find(|(_, scheme)| scheme == self).map_or("", |(name, _)| name);
        f.write_str(name)
    }
}

/// The weights of a smooth vertex of so many faces, as kernels take them.
pub fn ring_weights(scheme: Scheme, valence: usize) -> [f32; 2] {
    struct Weights(usize);
    impl Visit for Weights {
        type Output = [f64; 2];
        fn quads<S: QuadScheme>(self) -> [f64; 2] {
            S::ring(self.0)
        }
    }
    scheme.visit(Weights(valence)).map(|w| w as f32)
}

/// The masks of a vertex in the limit.
pub fn limit_masks(scheme: Scheme, limit: &Limit) -> LimitMasks {
    struct Masks<'a>(&'a Limit<'a>);
    impl Visit for Masks<'_> {
        type Output = LimitMasks;
        fn quads<S: QuadScheme>(self) -> LimitMasks {
            S::limit(self.0)
        }
    }
    scheme.visit(Masks(limit))
}

/// How a vertex goes from one level to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// Its rule at the next level, and at this one.
    pub rules: [Rule; 2],
    /// How much the rule of this level counts, where they differ.
    pub weight: f32,
    /// The sharp edges of a crease, by their places around the vertex, for each of the rules.
    pub ends: [[u32; 2]; 2],
}
