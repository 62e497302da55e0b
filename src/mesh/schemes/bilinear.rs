//! Middles, and nothing moves.

use super::limits::corner;
use super::{Limit, LimitMasks, QuadScheme, Vector};

/// See [`Scheme::Bilinear`](super::Scheme::Bilinear).
pub struct Bilinear;

impl QuadScheme for Bilinear {
    #[inline(always)]
    fn face<V: Vector>([a, b, c, d]: [V; 4]) -> V {
        ((a + c) + (b + d)) * 0.25
    }

    #[inline(always)]
    fn edge<V: Vector>([a, b]: [V; 2], _: [V; 2]) -> V {
        (a + b) * 0.5
    }

    #[inline(always)]
    fn vertex<V: Vector>(vertex: V, _: [V; 4], _: [V; 4]) -> V {
        vertex
    }

    fn ring(_: usize) -> [f64; 2] {
        [1.0, 0.0]
    }

    fn crease<V: Vector>(vertex: V, _: [V; 2]) -> V {
        vertex
    }

    #[inline(always)]
    fn column<V: Vector>([up, middle, down]: [V; 3]) -> [V; 2] {
        [middle, down - up]
    }

    #[inline(always)]
    fn row<V: Vector>([[a, _], [c, d], [e, _]]: [[V; 2]; 3]) -> [V; 3] {
        [c, e - a, d]
    }

    /// The vertex itself; its tangents run along the sides of a face.
    fn limit(limit: &Limit) -> LimitMasks {
        corner(limit)
    }
}
