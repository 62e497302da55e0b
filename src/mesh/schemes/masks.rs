//! The algebra that masks are written in, and the masks that follow from a scheme's own.

use super::{QuadScheme, Rule, Step};
use glam::Vec4;
use std::ops::{Add, Mul, Sub};

/// What masks work on: a point, or what stands for one.
pub trait Vector: Clone + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self> {}

impl Vector for Vec4 {}

/// A linear combination of points, by their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Combination {
    /// In order of the numbers, none twice.
    pub terms: Vec<(u32, f64)>,
}

impl Combination {
    /// The point of this number.
    pub fn point(number: u32) -> Combination {
        Combination { terms: vec![(number, 1.0)] }
    }

    fn merged(self, other: Combination, sign: f64) -> Combination {
        let mut terms = Vec::with_capacity(self.terms.len() + other.terms.len());
        let (mut a, mut b) = (self.terms.into_iter().peekable(), other.terms.into_iter().peekable());
        loop {
            match (a.peek(), b.peek()) {
                (Some(x), Some(y)) if x.0 == y.0 => {
                    let (number, w) = *x;
                    terms.push((number, w + sign * y.1));
                    a.next();
                    b.next();
                }
                (Some(x), Some(y)) if x.0 < y.0 => terms.extend(a.next()),
                (_, Some(_)) => terms.extend(b.next().map(|(number, w)| (number, sign * w))),
                (Some(_), None) => terms.extend(a.next()),
                (None, None) => return Combination { terms },
            }
        }
    }

    /// The same, exactly as often.
    pub fn scaled(mut self, by: f64) -> Combination {
        self.terms.iter_mut().for_each(|term| term.1 *= by);
        self
    }
}

impl Add for Combination {
    type Output = Combination;
    fn add(self, other: Combination) -> Combination {
        self.merged(other, 1.0)
    }
}

impl Sub for Combination {
    type Output = Combination;
    fn sub(self, other: Combination) -> Combination {
        self.merged(other, -1.0)
    }
}

impl Mul<f32> for Combination {
    type Output = Combination;
    fn mul(self, by: f32) -> Combination {
        self.scaled(f64::from(by))
    }
}

impl Vector for Combination {}

/// What two rules make of a point, where the second counts so much.
fn blended<V: Vector>(new: V, old: V, weight: f32) -> V {
    new * (1.0 - weight) + old * weight
}

/// The new point of an edge of which the middle counts so much; `smooth` gives the point of a smooth edge.
pub fn edge_point<V: Vector>(ends: [V; 2], weight: f32, smooth: impl FnOnce() -> V) -> V {
    let middle = |[a, b]: [V; 2]| (a + b) * 0.5;
    match weight {
        1.0 => middle(ends),
        w if w <= 0.0 => smooth(),
        w => blended(smooth(), middle(ends), w),
    }
}

/// The new point of a vertex, from itself, the other ends of its edges and the new points of its faces, both in order
/// around it; `weights` are those of [`QuadScheme::ring`].
pub fn vertex_point<S: QuadScheme, V: Vector>(
    vertex: &V,
    step: &Step,
    weights: [f32; 2],
    edges: &[V],
    faces: &[V],
) -> V {
    let mask = |rule: Rule, [a, b]: [u32; 2]| match rule {
        Rule::Corner => vertex.clone(),
        Rule::Crease => S::crease(vertex.clone(), [edges[a as usize].clone(), edges[b as usize].clone()]),
        Rule::Smooth => smooth_vertex::<S, V>(vertex, weights, edges, faces),
    };
    let [new, old] = step.rules;
    match new == old {
        true => mask(old, step.ends[1]),
        false => blended(mask(new, step.ends[0]), mask(old, step.ends[1]), step.weight),
    }
}

/// A smooth vertex of any valence.
pub fn smooth_vertex<S: QuadScheme, V: Vector>(vertex: &V, weights: [f32; 2], edges: &[V], faces: &[V]) -> V {
    if let ([e0, e1, e2, e3], [f0, f1, f2, f3]) = (edges, faces) {
        let (edges, faces) = ([e0, e2, e1, e3], [f0, f2, f1, f3]);
        return S::vertex(vertex.clone(), edges.map(V::clone), faces.map(V::clone));
    }
    // Not the sum over an iterator, which would begin with a zero that not every algebra has.
    let sum = |all: &[V]| all[1..].iter().fold(all[0].clone(), |sum, x| sum + x.clone());
    let [own, others] = weights;
    vertex.clone() * own + (sum(edges) + sum(faces)) * others
}
