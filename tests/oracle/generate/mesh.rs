//! Random meshes, each from a seed that reproduces it: always manifold, with every vertex used.

use super::Random;
use crate::oracle::mesh::{Ends, Level, Point, ends, sides};
use burgeon::mesh::{Corner, Crease, Faces, Mesh, Options};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A mesh and what it has of [`MESH_FEATURES`].
#[derive(Clone, Debug)]
pub struct MeshCase {
    /// [`mesh_case`] of this seed is this case.
    pub seed: u64,
    pub mesh: Mesh,
    pub features: String,
}

/// What to write beside a failure.
impl fmt::Display for MeshCase {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Mesh { positions, faces, creases, corners, holes } = &self.mesh;
        writeln!(f, "mesh of seed {}: {}", self.seed, self.features)?;
        if positions.len() > 60 {
            return Ok(());
        }
        writeln!(f, "positions {positions:?}\nfaces {:?}", faces.iter().collect::<Vec<_>>())?;
        let creases: Vec<_> = creases.iter().map(|crease| (crease.vertices, crease.sharpness)).collect();
        let corners: Vec<_> = corners.iter().map(|corner| (corner.vertex, corner.sharpness)).collect();
        writeln!(f, "creases {creases:?}\ncorners {corners:?}\nholes {holes:?}")
    }
}

/// What occurs in one case or another.
pub const MESH_FEATURES: [&str; 36] = [
    "[quads alone]",
    "[triangles alone]",
    "[triangles and quads]",
    "[five corners or more]",
    "[closed]",
    "[border]",
    "[two borders]",
    "[two pieces]",
    "[torus]",
    "[a single face]",
    "[corner of one face]",
    "[inner vertex of two faces]",
    "[faces with two common edges]",
    "[pole of 3]",
    "[pole of 5]",
    "[pole of 8 to 12]",
    "[pole of 360]",
    "[hole]",
    "[hole at a crease]",
    "[vertex that holes alone have]",
    "[dart]",
    "[crease]",
    "[crease at a pole]",
    "[three creases]",
    "[crease that meets a border]",
    "[crease given twice]",
    "[border with a crease of its own]",
    "[sharp vertex]",
    "[sharp vertex on a crease]",
    "[sharp vertex on a border]",
    "[sharpness 0.3]",
    "[sharpness 0.7]",
    "[sharpness 1]",
    "[sharpness 1.5]",
    "[sharpness 2.6]",
    "[sharpness 10]",
];

/// What is drawn of; 0 is as good as not given.
const SHARPNESS: [f32; 7] = [0.0, 0.3, 0.7, 1.0, 1.5, 2.6, 10.0];

/// The mesh of a seed.
pub fn mesh_case(seed: u64) -> MeshCase {
    let mut random = Random::new(seed);
    let mut shape = Shape::any(&mut random);
    if random.chance(10) {
        shape.add(Shape::any(&mut random));
    }
    let changes = *random.pick(&[0, 0, 1, 2, 4, 8]);
    for _ in 0..changes {
        shape.change(&mut random);
    }
    if random.chance(30) {
        shape.faces.iter_mut().for_each(|face| face.reverse());
    }
    let mesh = tagged(shape, &mut random);
    let features = features(&mesh);
    MeshCase { seed, mesh, features }
}

/// Points about as far apart as 1, and faces.
#[derive(Clone, Debug)]
struct Shape {
    points: Vec<Point>,
    faces: Vec<Vec<usize>>,
}

impl Shape {
    fn any(random: &mut Random) -> Shape {
        match random.below(9) {
            0 => Shape::grid([random.below(5) + 1, random.below(5) + 1], [false, false]),
            1 => Shape::grid([random.below(3) + 3, random.below(4) + 1], [true, false]),
            2 => Shape::grid([random.below(4) + 3, random.below(3) + 3], [true, true]),
            3 | 4 => Shape::block([0; 3].map(|_| random.below(2) + 1)),
            5 | 6 => {
                let valence = if random.chance(4) { 360 } else { random.below(10) + 3 };
                Shape::pole(valence, random.below(4))
            }
            7 => Shape::pillow(random.below(4) + 3),
            _ => Shape::pole(random.below(4) + 3, 2),
        }
    }

    /// A sheet of quads, closed along one side or both: a plane, a tube, a torus.
    fn grid(cells: [usize; 2], closed: [bool; 2]) -> Shape {
        let [m, n] = cells;
        let [across, up] = [0, 1].map(|k| if closed[k] { cells[k] } else { cells[k] + 1 });
        let turn = |k: usize, cells: usize| std::f64::consts::TAU * k as f64 / cells as f64;
        let point = |i: usize, j: usize| {
            let (x, y) = (i as f64, j as f64);
            match closed {
                [false, _] => [x, y, 0.1 * (x - 0.3 * y).powi(2)],
                [true, false] => [turn(i, m).cos(), turn(i, m).sin(), y],
                [true, true] => {
                    let out = 2.0 + turn(j, n).cos();
                    [out * turn(i, m).cos(), out * turn(i, m).sin(), turn(j, n).sin()]
                }
            }
        };
        let points = (0..up).flat_map(|j| (0..across).map(move |i| point(i, j))).collect();
        let at = |i: usize, j: usize| (j % up) * across + i % across;
        let face = |i, j| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        Shape { points, faces: (0..n).flat_map(|j| (0..m).map(move |i| face(i, j))).collect() }
    }

    /// The surface of a block of cubes.
    fn block(cubes: [usize; 3]) -> Shape {
        let mut numbers: BTreeMap<[usize; 3], usize> = BTreeMap::new();
        let mut shape = Shape { points: Vec::new(), faces: Vec::new() };
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for far in [false, true] {
                for (i, j) in (0..cubes[u]).flat_map(|i| (0..cubes[v]).map(move |j| (i, j))) {
                    let mut face: Vec<usize> = Vec::new();
                    for (du, dv) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                        let mut at = [0; 3];
                        (at[axis], at[u], at[v]) = (if far { cubes[axis] } else { 0 }, i + du, j + dv);
                        let number = *numbers.entry(at).or_insert_with(|| {
                            shape.points.push(at.map(|x| x as f64));
                            shape.points.len() - 1
                        });
                        face.push(number);
                    }
                    if !far {
                        face.reverse();
                    }
                    shape.faces.push(face);
                }
            }
        }
        shape
    }

    /// A vertex with so many faces around it: triangles, alone, above a polygon or above others; or quads.
    fn pole(valence: usize, kind: usize) -> Shape {
        let quads = kind == 3;
        let around = if quads { 2 * valence } else { valence };
        let radius = (around as f64 / 6.0).max(1.0);
        let mut points = vec![[0.0, 0.0, 0.4 * radius]];
        points.extend((0..around).map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / around as f64;
            [radius * angle.cos(), radius * angle.sin(), 0.0]
        }));
        let at = |k: usize| 1 + k % around;
        let mut faces: Vec<Vec<usize>> = match quads {
            true => (0..valence).map(|k| vec![0, at(2 * k), at(2 * k + 1), at(2 * k + 2)]).collect(),
            false => (0..valence).map(|k| vec![0, at(k), at(k + 1)]).collect(),
        };
        match kind {
            1 => faces.push((1..=around).rev().collect()),
            2 => {
                points.push([0.0, 0.0, -0.5 * radius]);
                faces.extend((0..valence).map(|k| vec![around + 1, at(k + 1), at(k)]));
            }
            _ => {}
        }
        Shape { points, faces }
    }

    /// Two faces, back to back.
    fn pillow(corners: usize) -> Shape {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / corners as f64;
        let points = (0..corners).map(|k| [angle(k).cos(), angle(k).sin(), 0.0]).collect();
        Shape { points, faces: vec![(0..corners).collect(), (0..corners).rev().collect()] }
    }

    /// Another beside it.
    fn add(&mut self, other: Shape) {
        let by = self.points.len();
        self.points.extend(other.points.iter().map(|p| [p[0] + 5.0, p[1] + 1.0, p[2] - 2.0]));
        self.faces.extend(other.faces.iter().map(|face| face.iter().map(|v| v + by).collect::<Vec<_>>()));
    }

    /// One change of the faces, if what comes of it is a manifold.
    fn change(&mut self, random: &mut Random) {
        let mut changed = self.clone();
        let is_done = match random.below(6) {
            0 => changed.poke(random),
            1 => changed.split_edge(random),
            2 | 3 => changed.merge(random),
            4 => changed.truncate(random),
            _ => changed.remove(random),
        };
        if is_done && changed.is_manifold() {
            changed.drop_unused();
            *self = changed;
        }
    }

    fn centre(&self, vertices: &[usize]) -> Point {
        let n = vertices.len() as f64;
        [0, 1, 2].map(|k| vertices.iter().map(|&v| self.points[v][k]).sum::<f64>() / n)
    }

    fn between(&self, a: usize, b: usize, at: f64) -> Point {
        [0, 1, 2].map(|k| self.points[a][k] * (1.0 - at) + self.points[b][k] * at)
    }

    fn add_point(&mut self, point: Point) -> usize {
        self.points.push(point);
        self.points.len() - 1
    }

    /// A face becomes triangles around its centre.
    fn poke(&mut self, random: &mut Random) -> bool {
        let face = self.faces.swap_remove(random.below(self.faces.len()));
        let centre = self.add_point(self.centre(&face));
        self.faces.extend(sides(&face).map(|[a, b]| vec![a, b, centre]));
        true
    }

    /// An edge has a vertex in its middle.
    fn split_edge(&mut self, random: &mut Random) -> bool {
        let [a, b] = self.any_edge(random);
        let middle = self.add_point(self.between(a, b, 0.5));
        for face in &mut self.faces {
            let side = sides(face).position(|side| side == [a, b] || side == [b, a]);
            if let Some(side) = side {
                face.insert(side + 1, middle);
            }
        }
        true
    }

    /// Two faces become one, if they have nothing but an edge in common.
    fn merge(&mut self, random: &mut Random) -> bool {
        let [a, b] = self.any_edge(random);
        let of =
            |from: usize, to: usize| self.faces.iter().position(|face| sides(face).any(|s| s == [from, to]));
        let (Some(f), Some(g)) = (of(a, b), of(b, a)) else { return false };
        if self.faces[f].iter().filter(|v| self.faces[g].contains(v)).count() != 2 {
            return false;
        }
        // From b around to a, and then from a to b around the other.
        let from = |face: &[usize], first: usize| {
            let at = face.iter().position(|&v| v == first).expect("a corner");
            [&face[at..], &face[..at]].concat()
        };
        let mut merged = from(&self.faces[f], b);
        merged.pop();
        merged.extend(from(&self.faces[g], a));
        merged.pop();
        self.faces[f] = merged;
        self.faces.swap_remove(g);
        true
    }

    /// A face stands for a vertex inside.
    fn truncate(&mut self, random: &mut Random) -> bool {
        let vertex = random.below(self.points.len());
        let mut cut: BTreeMap<usize, usize> = BTreeMap::new();
        // The cap runs the other way around than the faces: from the edge before to the edge after.
        let mut next: BTreeMap<usize, usize> = BTreeMap::new();
        for f in 0..self.faces.len() {
            let face = self.faces[f].clone();
            let Some(at) = face.iter().position(|&v| v == vertex) else { continue };
            let n = face.len();
            let [into, out] = [face[(at + n - 1) % n], face[(at + 1) % n]]
                .map(|end| *cut.entry(end).or_insert_with(|| self.add_point(self.between(vertex, end, 0.3))));
            self.faces[f].splice(at..=at, [into, out]);
            next.insert(out, into);
        }
        let first = *next.keys().next().expect("a face");
        let mut cap = vec![first];
        while let Some(&after) = next.get(cap.last().expect("a vertex")).filter(|&&after| after != first) {
            cap.push(after);
        }
        let is_inside = cap.len() == cut.len() && next.len() == cut.len() && cap.len() > 2;
        self.faces.push(cap);
        is_inside
    }

    fn remove(&mut self, random: &mut Random) -> bool {
        self.faces.swap_remove(random.below(self.faces.len()));
        !self.faces.is_empty()
    }

    fn any_edge(&self, random: &mut Random) -> [usize; 2] {
        let face = random.pick(&self.faces);
        let at = random.below(face.len());
        [face[at], face[(at + 1) % face.len()]]
    }

    fn is_manifold(&self) -> bool {
        let all: Vec<[usize; 2]> = self.faces.iter().flat_map(|face| sides(face)).collect();
        let mut seen = BTreeSet::new();
        if !all.iter().all(|side| seen.insert(*side)) {
            return false;
        }
        let is_face =
            |face: &Vec<usize>| face.len() > 2 && face.iter().collect::<BTreeSet<_>>().len() == face.len();
        self.faces.iter().all(is_face) && (0..self.points.len()).all(|v| self.is_fan(v))
    }

    /// The faces at a vertex follow each other.
    fn is_fan(&self, vertex: usize) -> bool {
        let mut next: BTreeMap<usize, usize> = BTreeMap::new();
        for face in &self.faces {
            let Some(at) = face.iter().position(|&v| v == vertex) else { continue };
            let n = face.len();
            next.insert(face[(at + 1) % n], face[(at + n - 1) % n]);
        }
        // On a border, from the first edge, which comes after none.
        let Some(&any) = next.keys().next() else { return true };
        let first = next.keys().copied().find(|end| !next.values().any(|after| after == end)).unwrap_or(any);
        let (mut at, mut faces) = (first, 0);
        while let Some(&after) = next.get(&at) {
            (at, faces) = (after, faces + 1);
            if at == first {
                break;
            }
        }
        faces == next.len()
    }

    fn drop_unused(&mut self) {
        let used: BTreeSet<usize> = self.faces.iter().flatten().copied().collect();
        let numbers: BTreeMap<usize, usize> = used.iter().enumerate().map(|(new, &old)| (old, new)).collect();
        self.points = used.iter().map(|&old| self.points[old]).collect();
        self.faces.iter_mut().flatten().for_each(|v| *v = numbers[v]);
    }
}

/// The shape with its points moved a little, and with creases, sharp vertices and holes.
fn tagged(shape: Shape, random: &mut Random) -> Mesh {
    let moved = |p: &Point, random: &mut Random| p.map(|x| (x + 0.3 * (random.unit() - 0.5)) as f32);
    let positions = shape.points.iter().map(|p| moved(p, random)).collect();
    let faces: Faces = shape.faces.iter().map(|face| face.iter().map(|&v| v as u32)).collect();
    let mut mesh = Mesh::new(positions, faces);
    let level = Level::new(&mesh, &Options::default());
    let stars = level.stars();
    for _ in 0..*random.pick(&[0, 1, 2, 3, 5]) {
        let steady = random.chance(50).then(|| *random.pick(&SHARPNESS));
        let mut at = random.below(stars.len());
        let mut path: BTreeSet<Ends> = BTreeSet::new();
        for _ in 0..random.below(8) + 1 {
            let free: Vec<usize> =
                stars[at].ends.iter().copied().filter(|&end| !path.contains(&ends(at, end))).collect();
            if free.is_empty() {
                break;
            }
            let end = *random.pick(&free);
            let sharpness = steady.unwrap_or_else(|| *random.pick(&SHARPNESS));
            mesh.creases.push(Crease { vertices: [at as u32, end as u32], sharpness });
            path.insert(ends(at, end));
            at = end;
        }
    }
    for _ in 0..*random.pick(&[0, 0, 1, 2, 4]) {
        let of_path = mesh.creases.get(random.below(mesh.creases.len() + 2)).map(|crease| crease.vertices[0]);
        let vertex = of_path.unwrap_or(random.below(stars.len()) as u32);
        mesh.corners.push(Corner { vertex, sharpness: *random.pick(&SHARPNESS) });
    }
    if random.chance(40) {
        for _ in 0..random.below(4) + 1 {
            mesh.holes.push(random.below(shape.faces.len()) as u32);
        }
    }
    mesh
}

fn features(mesh: &Mesh) -> String {
    let level = Level::new(mesh, &Options::default());
    let stars = level.stars();
    let arity = |wanted: fn(usize) -> bool| level.faces.iter().any(|face| wanted(face.len()));
    let (triangles, quads, more) = (arity(|n| n == 3), arity(|n| n == 4), arity(|n| n > 4));
    let border: Vec<bool> = stars.iter().map(|star| star.faces.len() < star.ends.len()).collect();
    let is_border_edge = |e: &Ends| level.edges[e].faces.len() == 1;
    let given: Vec<Ends> = mesh
        .creases
        .iter()
        .filter(|c| c.sharpness > 0.0)
        .map(|c| ends(c.vertices[0] as usize, c.vertices[1] as usize))
        .collect();
    let at_vertex = |v: usize| stars[v].ends.iter().filter(|&&end| given.contains(&ends(v, end))).count();
    let inner = |v: usize| !border[v];
    let valence = |low: usize, high: usize| {
        (0..stars.len()).any(|v| inner(v) && (low..=high).contains(&stars[v].faces.len()))
    };
    let sharp: Vec<usize> =
        mesh.corners.iter().filter(|c| c.sharpness > 0.0).map(|c| c.vertex as usize).collect();
    let any = |test: &dyn Fn(usize) -> bool| (0..stars.len()).any(test);
    let shared = || {
        let mut pairs: BTreeMap<&[usize], usize> = BTreeMap::new();
        level
            .edges
            .values()
            .filter(|e| e.faces.len() == 2)
            .for_each(|e| *pairs.entry(&e.faces).or_default() += 1);
        pairs.values().any(|&edges| edges > 1)
    };
    let is_torus = level.edges.values().all(|e| e.faces.len() == 2) && level.euler() == 0;
    let list = [
        ("quads alone", !triangles && quads && !more),
        ("triangles alone", triangles && !quads && !more),
        ("triangles and quads", triangles && quads),
        ("five corners or more", more),
        ("closed", !border.contains(&true)),
        ("border", border.contains(&true)),
        ("two borders", loops(&level) > 1),
        ("two pieces", pieces(&level) > 1),
        ("torus", is_torus && pieces(&level) == 1),
        ("a single face", level.faces.len() == 1),
        ("corner of one face", stars.iter().any(|star| star.faces.len() == 1)),
        ("inner vertex of two faces", valence(2, 2)),
        ("faces with two common edges", shared()),
        ("pole of 3", valence(3, 3)),
        ("pole of 5", valence(5, 5)),
        ("pole of 8 to 12", valence(8, 12)),
        ("pole of 360", valence(360, 360)),
        ("hole", !mesh.holes.is_empty()),
        ("hole at a crease", given.iter().any(|e| level.edges[e].faces.iter().any(|&f| level.holes[f]))),
        ("vertex that holes alone have", stars.iter().any(|star| star.faces.iter().all(|&f| level.holes[f]))),
        ("dart", any(&|v| inner(v) && at_vertex(v) == 1)),
        ("crease", any(&|v| inner(v) && at_vertex(v) == 2)),
        ("crease at a pole", any(&|v| inner(v) && at_vertex(v) == 2 && stars[v].faces.len() != 4)),
        ("three creases", any(&|v| inner(v) && at_vertex(v) > 2)),
        (
            "crease that meets a border",
            any(&|v| {
                !inner(v)
                    && stars[v].ends.iter().any(|&end| {
                        let edge = ends(v, end);
                        given.contains(&edge) && !is_border_edge(&edge)
                    })
            }),
        ),
        ("crease given twice", given.iter().collect::<BTreeSet<_>>().len() < given.len()),
        ("border with a crease of its own", given.iter().any(is_border_edge)),
        ("sharp vertex", !sharp.is_empty()),
        ("sharp vertex on a crease", sharp.iter().any(|&v| at_vertex(v) > 0)),
        ("sharp vertex on a border", sharp.iter().any(|&v| border[v])),
    ];
    let mut text = String::new();
    list.iter().filter(|(_, has)| *has).for_each(|(name, _)| text += &format!("[{name}]"));
    let own: BTreeSet<String> =
        mesh.creases.iter().map(|c| c.sharpness).filter(|&s| s > 0.0).map(|s| s.to_string()).collect();
    own.iter().for_each(|s| text += &format!("[sharpness {s}]"));
    text
}

/// How many sets of things there are, of which those of a pair belong together.
fn sets(all: impl IntoIterator<Item = usize>, pairs: impl IntoIterator<Item = [usize; 2]>) -> usize {
    let mut set: BTreeMap<usize, usize> = all.into_iter().map(|v| (v, v)).collect();
    for [a, b] in pairs {
        let (a, b) = (set[&a], set[&b]);
        set.values_mut().filter(|s| **s == a).for_each(|s| *s = b);
    }
    set.values().collect::<BTreeSet<_>>().len()
}

fn pieces(level: &Level) -> usize {
    sets(0..level.points.len(), level.edges.keys().copied())
}

/// Borders.
fn loops(level: &Level) -> usize {
    let border = || level.edges.iter().filter(|(_, e)| e.faces.len() == 1).map(|(&e, _)| e);
    sets(border().flatten(), border())
}
