//! Meshes refined naively, one level after the other, straight from the definitions: Catmull and Clark (1978), and the
//! creases of DeRose, Kass and Truong (1998) as OpenSubdiv has them.
//!
//! Faces are lists of vertices and edges are found by their ends. Nothing is quick, nothing is shared with `src/` but the
//! mesh and its options.

use burgeon::mesh::{Boundary, Creasing, Mesh, Options, Scheme};
use std::collections::BTreeMap;

pub type Point = [f64; 3];

/// The ends of an edge, the lower first.
pub type Ends = [usize; 2];

/// From which sharpness on nothing becomes smooth.
const INFINITE: f64 = 10.0;

/// A mesh, as it is or refined.
#[derive(Clone, Debug)]
pub struct Level {
    pub points: Vec<Point>,
    pub faces: Vec<Vec<usize>>,
    /// Whether a face is there for its neighbours alone.
    pub holes: Vec<bool>,
    pub edges: BTreeMap<Ends, Edge>,
    /// Of the vertices.
    pub sharpness: Vec<f64>,
    /// What of the level before each vertex comes of; of the mesh itself, the vertex.
    pub vertex_parents: Vec<Parent>,
    /// The face of the level before; of the mesh itself, the face.
    pub face_parents: Vec<usize>,
}

#[derive(Clone, Debug, Default)]
pub struct Edge {
    /// One on a border, else two.
    pub faces: Vec<usize>,
    pub sharpness: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parent {
    Vertex(usize),
    Edge(Ends),
    Face(usize),
}

/// The rule of a vertex.
#[derive(Clone, Debug, PartialEq)]
enum Rule {
    /// With no sharp edge, or a single one.
    Smooth,
    /// With the other ends of its two sharp edges.
    Crease(Ends),
    Corner,
}

/// What meets at a vertex.
#[derive(Clone, Debug, Default)]
pub struct Star {
    /// The other ends of its edges.
    pub ends: Vec<usize>,
    pub faces: Vec<usize>,
}

pub fn ends(a: usize, b: usize) -> Ends {
    [a.min(b), a.max(b)]
}

/// The sides of a polygon, each from one corner to the next.
pub fn sides(face: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]])
}

fn is_sharp(sharpness: f64) -> bool {
    sharpness > 0.0
}

fn is_semi_sharp(sharpness: f64) -> bool {
    is_sharp(sharpness) && sharpness < INFINITE
}

/// What is left of a sharpness in the next level.
fn less(sharpness: f64) -> f64 {
    if sharpness >= INFINITE { sharpness } else { (sharpness - 1.0).max(0.0) }
}

fn sum(points: impl IntoIterator<Item = Point>) -> Point {
    points.into_iter().fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
}

fn scaled(point: Point, by: f64) -> Point {
    point.map(|x| x * by)
}

/// Points, each with its weight.
fn blended(terms: &[(Point, f64)]) -> Point {
    sum(terms.iter().map(|&(p, w)| scaled(p, w)))
}

fn middle(a: Point, b: Point) -> Point {
    blended(&[(a, 0.5), (b, 0.5)])
}

impl Level {
    /// The mesh itself, with all that its tags and its borders say.
    pub fn new(mesh: &Mesh, options: &Options) -> Level {
        let faces: Vec<Vec<usize>> =
            mesh.faces.iter().map(|face| face.iter().map(|&v| v as usize).collect()).collect();
        let mut sharpness = vec![0.0f64; mesh.positions.len()];
        for corner in &mesh.corners {
            let own = &mut sharpness[corner.vertex as usize];
            *own = own.max(f64::from(corner.sharpness));
        }
        let mut level = Level {
            points: mesh.positions.iter().map(|p| p.map(f64::from)).collect(),
            holes: (0..faces.len() as u32).map(|face| mesh.holes.contains(&face)).collect(),
            edges: edges_of(&faces),
            sharpness,
            vertex_parents: (0..mesh.positions.len()).map(Parent::Vertex).collect(),
            face_parents: (0..faces.len()).collect(),
            faces,
        };
        for crease in &mesh.creases {
            let [a, b] = crease.vertices.map(|v| v as usize);
            let edge = level.edges.get_mut(&ends(a, b)).expect("an edge");
            edge.sharpness = edge.sharpness.max(f64::from(crease.sharpness));
        }
        for edge in level.edges.values_mut().filter(|edge| edge.faces.len() == 1) {
            edge.sharpness = INFINITE;
        }
        if options.boundary == Boundary::Corner {
            for (vertex, star) in level.stars().iter().enumerate() {
                if star.faces.len() == 1 {
                    level.sharpness[vertex] = INFINITE;
                }
            }
        }
        level
    }

    /// The mesh refined so many times.
    pub fn refined(mesh: &Mesh, options: &Options, times: u32) -> Level {
        (0..times).fold(Level::new(mesh, options), |level, _| level.refine(options))
    }

    /// What meets at each vertex.
    pub fn stars(&self) -> Vec<Star> {
        let mut stars = vec![Star::default(); self.points.len()];
        for &[a, b] in self.edges.keys() {
            stars[a].ends.push(b);
            stars[b].ends.push(a);
        }
        for (f, face) in self.faces.iter().enumerate() {
            face.iter().for_each(|&vertex| stars[vertex].faces.push(f));
        }
        stars
    }

    pub fn edge_sharpness(&self, a: usize, b: usize) -> f64 {
        self.edges[&ends(a, b)].sharpness
    }

    /// V − E + F.
    pub fn euler(&self) -> i64 {
        let used = self.stars().iter().filter(|star| !star.faces.is_empty()).count();
        used as i64 - self.edges.len() as i64 + self.faces.len() as i64
    }

    /// The faces that are drawn.
    pub fn drawn(&self) -> impl Iterator<Item = &Vec<usize>> {
        self.faces.iter().zip(&self.holes).filter(|(_, hole)| !**hole).map(|(face, _)| face)
    }

    /// The next level. Vertices that no face has are left out.
    pub fn refine(&self, options: &Options) -> Level {
        let stars = self.stars();
        let used: Vec<usize> = (0..self.points.len()).filter(|&v| !stars[v].faces.is_empty()).collect();
        let centres: Vec<Point> = self.faces.iter().map(|face| self.centre(face)).collect();
        // The sharpness of the half of an edge that begins at a vertex, by the vertex and the edge's other end.
        let mut halves: BTreeMap<[usize; 2], f64> = BTreeMap::new();
        for &vertex in &used {
            for &other in &stars[vertex].ends {
                halves.insert([vertex, other], self.half_sharpness(vertex, other, &stars[vertex], options));
            }
        }

        let mut next = Level {
            points: Vec::new(),
            faces: Vec::new(),
            holes: Vec::new(),
            edges: BTreeMap::new(),
            sharpness: Vec::new(),
            vertex_parents: Vec::new(),
            face_parents: Vec::new(),
        };
        let mut of_vertices = vec![usize::MAX; self.points.len()];
        for &vertex in &used {
            let point = self.vertex_point(vertex, &stars[vertex], &centres, &halves, options);
            of_vertices[vertex] = next.add(point, less(self.sharpness[vertex]), Parent::Vertex(vertex));
        }
        let of_faces: Vec<usize> =
            centres.iter().enumerate().map(|(f, &centre)| next.add(centre, 0.0, Parent::Face(f))).collect();
        let mut of_edges: BTreeMap<Ends, usize> = BTreeMap::new();
        for (&[a, b], edge) in &self.edges {
            let point = self.edge_point([a, b], edge, &centres, &halves, options);
            of_edges.insert([a, b], next.add(point, 0.0, Parent::Edge([a, b])));
        }

        for (f, face) in self.faces.iter().enumerate() {
            let n = face.len();
            for k in 0..n {
                let (before, own, after) = (face[(k + n - 1) % n], face[k], face[(k + 1) % n]);
                let (from, to) = (of_edges[&ends(before, own)], of_edges[&ends(own, after)]);
                next.faces.push(vec![of_vertices[own], to, of_faces[f], from]);
                next.holes.push(self.holes[f]);
                next.face_parents.push(f);
            }
        }
        next.edges = edges_of(&next.faces);
        for (&[vertex, other], &sharpness) in &halves {
            let half = ends(of_vertices[vertex], of_edges[&ends(vertex, other)]);
            next.edges.get_mut(&half).expect("half an edge").sharpness = sharpness;
        }
        next
    }

    fn add(&mut self, point: Point, sharpness: f64, parent: Parent) -> usize {
        self.points.push(point);
        self.sharpness.push(sharpness);
        self.vertex_parents.push(parent);
        self.points.len() - 1
    }

    fn centre(&self, face: &[usize]) -> Point {
        scaled(sum(face.iter().map(|&v| self.points[v])), 1.0 / face.len() as f64)
    }

    /// Of the half of an edge that begins at `vertex`.
    fn half_sharpness(&self, vertex: usize, other: usize, star: &Star, options: &Options) -> f64 {
        let own = self.edge_sharpness(vertex, other);
        if options.creasing == Creasing::Chaikin && is_semi_sharp(own) {
            let others = star.ends.iter().filter(|&&end| end != other);
            let others: Vec<f64> =
                others.map(|&end| self.edge_sharpness(vertex, end)).filter(|&s| is_semi_sharp(s)).collect();
            if !others.is_empty() {
                let mean = others.iter().sum::<f64>() / others.len() as f64;
                return less((3.0 * own + mean) / 4.0);
            }
        }
        less(own)
    }

    fn edge_point(
        &self,
        [a, b]: Ends,
        edge: &Edge,
        centres: &[Point],
        halves: &BTreeMap<[usize; 2], f64>,
        options: &Options,
    ) -> Point {
        let sharp = middle(self.points[a], self.points[b]);
        let [f, g] = match edge.faces[..] {
            [f, g] if options.scheme == Scheme::CatmullClark => [f, g],
            _ => return sharp,
        };
        let smooth = middle(sharp, middle(centres[f], centres[g]));
        match edge.sharpness {
            s if !is_sharp(s) => smooth,
            _ if is_sharp(halves[&[a, b]]) && is_sharp(halves[&[b, a]]) => sharp,
            s => blended(&[(sharp, s), (smooth, 1.0 - s)]),
        }
    }

    fn vertex_point(
        &self,
        vertex: usize,
        star: &Star,
        centres: &[Point],
        halves: &BTreeMap<[usize; 2], f64>,
        options: &Options,
    ) -> Point {
        if options.scheme == Scheme::Bilinear {
            return self.points[vertex];
        }
        let before = |end: usize| self.edge_sharpness(vertex, end);
        let after = |end: usize| halves[&[vertex, end]];
        let own = self.sharpness[vertex];
        let rules = [rule(own, star, before), rule(less(own), star, after)];
        let [first, second] = rules.clone().map(|rule| self.by_rule(vertex, star, centres, &rule));
        // Smooth it stays; and what lies on a crease or is a corner, and goes on so, is so in full.
        if rules[0] == Rule::Smooth || rules[0] == rules[1] {
            return first;
        }
        // The sharpness that ends here.
        let ending = star.ends.iter().map(|&end| (before(end), after(end))).chain([(own, less(own))]);
        let ending: Vec<f64> =
            ending.filter(|&(s, left)| is_sharp(s) && !is_sharp(left)).map(|s| s.0).collect();
        let weight = (ending.iter().sum::<f64>() / ending.len() as f64).min(1.0);
        blended(&[(first, weight), (second, 1.0 - weight)])
    }

    fn by_rule(&self, vertex: usize, star: &Star, centres: &[Point], rule: &Rule) -> Point {
        let own = self.points[vertex];
        match rule {
            Rule::Corner => own,
            Rule::Crease([a, b]) => {
                blended(&[(own, 0.75), (self.points[*a], 0.125), (self.points[*b], 0.125)])
            }
            Rule::Smooth => {
                // (Q + 2R + (n − 3) S) / n: Q the mean of the face points, R that of the middles of the edges.
                let n = star.faces.len() as f64;
                assert_eq!(star.faces.len(), star.ends.len(), "a smooth vertex has faces all around");
                let q = scaled(sum(star.faces.iter().map(|&f| centres[f])), 1.0 / n);
                let r = scaled(sum(star.ends.iter().map(|&end| middle(own, self.points[end]))), 1.0 / n);
                scaled(blended(&[(q, 1.0), (r, 2.0), (own, n - 3.0)]), 1.0 / n)
            }
        }
    }
}

/// Of a vertex of this sharpness, whose edges have the sharpness that is said by their other ends.
fn rule(own: f64, star: &Star, edge: impl Fn(usize) -> f64) -> Rule {
    let sharp: Vec<usize> = star.ends.iter().copied().filter(|&end| is_sharp(edge(end))).collect();
    match sharp[..] {
        _ if is_sharp(own) => Rule::Corner,
        [] | [_] => Rule::Smooth,
        [a, b] => Rule::Crease([a, b]),
        _ => Rule::Corner,
    }
}

fn edges_of(faces: &[Vec<usize>]) -> BTreeMap<Ends, Edge> {
    let mut edges: BTreeMap<Ends, Edge> = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        sides(face).for_each(|[a, b]| edges.entry(ends(a, b)).or_default().faces.push(f));
    }
    edges
}
