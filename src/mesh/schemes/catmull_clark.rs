//! Catmull and Clark, *Recursively generated B-spline surfaces on arbitrary topological meshes* (1978).

use super::limits::{corner, crease};
use super::{Limit, LimitMasks, QuadScheme, Rule, Vector};
use std::f64::consts::PI;

/// See [`Scheme::CatmullClark`](super::Scheme::CatmullClark).
pub struct CatmullClark;

impl QuadScheme for CatmullClark {
    #[inline(always)]
    fn face<V: Vector>([a, b, c, d]: [V; 4]) -> V {
        ((a + c) + (b + d)) * 0.25
    }

    #[inline(always)]
    fn edge<V: Vector>([a, b]: [V; 2], [f, g]: [V; 2]) -> V {
        ((a + b) + (f + g)) * 0.25
    }

    #[inline(always)]
    fn vertex<V: Vector>(vertex: V, [a, b, c, d]: [V; 4], [f, g, h, i]: [V; 4]) -> V {
        let (edges, faces) = ((a + b) + (c + d), (f + g) + (h + i));
        vertex * 0.5 + (edges + faces) * 0.0625
    }

    /// The rule `(F + 2R + (n - 3) P) / n`, where R is the mean of the middles of the edges.
    fn ring(valence: usize) -> [f64; 2] {
        let n = valence as f64;
        [(n - 2.0) / n, 1.0 / (n * n)]
    }

    #[inline(always)]
    fn column<V: Vector>([up, middle, down]: [V; 3]) -> [V; 2] {
        [(up.clone() + down.clone()) + middle * 4.0, down - up]
    }

    #[inline(always)]
    fn row<V: Vector>([[a, b], [c, d], [e, f]]: [[V; 2]; 3]) -> [V; 3] {
        [((a.clone() + e.clone()) + c * 4.0) * (1.0 / 36.0), e - a, (b + f) + d * 4.0]
    }

    /// Smooth: Halstead, Kass and DeRose, *Efficient, Fair Interpolation using Catmull-Clark Surfaces* (1993); the tangents
    /// are the eigenvectors of the subdominant eigenvalue.
    fn limit(limit: &Limit) -> LimitMasks {
        match limit.rule {
            Rule::Smooth if limit.faces == limit.edges && limit.faces > 2 => {
                let mut masks = LimitMasks::zero(limit);
                let n = limit.faces as f64;
                let others = 1.0 / (n * (n + 5.0));
                masks.vertex[0] = n / (n + 5.0);
                let a = 2.0 * PI / n;
                let eigenvalue = (5.0 + a.cos() + (a / 2.0).cos() * (2.0 * (9.0 + a.cos())).sqrt()) / 16.0;
                let face = 1.0 / (4.0 * eigenvalue - 1.0);
                for i in 0..limit.faces {
                    let around = |k: usize| (k as f64 * a).sin_cos();
                    let ((s0, c0), (s1, c1)) = (around(i), around(i + 1));
                    masks.edges[i] = [4.0 * others, 4.0 * c0, 4.0 * s0];
                    masks.faces[i] = [others, face * (c0 + c1), face * (s0 + s1)];
                }
                masks
            }
            Rule::Crease => crease(limit, |k| {
                // Of a sector of k faces, across the crease.
                let t = PI / k as f64;
                let (s, c) = t.sin_cos();
                let by = 1.0 / (k as f64 * (3.0 + c));
                let r = (c + 1.0) / s;
                let edge = |i: usize| 4.0 * (i as f64 * t).sin() * by;
                let face = |i: usize| ((i as f64 * t).sin() + ((i + 1) as f64 * t).sin()) * by;
                let (own, ends) = (4.0 * r * (c - 1.0) * by, -r * (1.0 + 2.0 * c) * by);
                (own, ends, (1..k).map(edge).collect(), (0..k).map(face).collect())
            }),
            _ => corner(limit),
        }
    }
}
