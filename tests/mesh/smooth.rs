//! What the surfaces are: bicubic B-splines where the mesh is regular, and everywhere what the levels come near to.

use super::laws::kept;
use super::surface::distance;
use super::{limits, positions, topology};
use crate::oracle::Random;
use crate::oracle::mesh::Point;
use burgeon::cpu::refine::{Limits, Refiner, quads};
use burgeon::mesh::{Boundary, Crease, Mesh, Options, Scheme, Topology, VertexParent};
use std::collections::BTreeMap;
use std::sync::Arc;

fn wide(points: &[[f32; 3]]) -> Vec<Point> {
    points.iter().map(|p| p.map(f64::from)).collect()
}

/// A grid of so many quads, closed along both ways or along none, with points that are not quite its own.
fn grid([m, n]: [u32; 2], is_closed: bool, random: &mut Random) -> Mesh {
    let [across, up] = if is_closed { [m, n] } else { [m + 1, n + 1] };
    let mut near = |x: f64| (x + 0.6 * (random.unit() - 0.5)) as f32;
    let turn = |k: u32, all: u32| f64::from(k) * std::f64::consts::TAU / f64::from(all);
    let mut positions = Vec::new();
    for (j, i) in (0..up).flat_map(|j| (0..across).map(move |i| (j, i))) {
        let (a, b) = (turn(i, m), turn(j, n));
        let out = 4.0 + 1.5 * b.cos();
        positions.push(match is_closed {
            true => [near(out * a.cos()), near(out * a.sin()), near(1.5 * b.sin())],
            false => [near(f64::from(i)), near(f64::from(j)), near(0.0)],
        });
    }
    let at = |i: u32, j: u32| (j % up) * across + i % across;
    let face = |i: u32, j: u32| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
    Mesh::new(positions, (0..n).flat_map(|j| (0..m).map(move |i| face(i, j))).collect())
}

/// The control points of a uniform cubic B-spline of which each span is cut in two: all that these points determine.
fn inserted(points: &[Point]) -> Vec<Point> {
    let sum = |terms: &[(f64, Point)]| [0, 1, 2].map(|k| terms.iter().map(|(w, p)| w * p[k]).sum());
    let middle = |w: &[Point]| sum(&[(0.5, w[0]), (0.5, w[1])]);
    let own = |w: &[Point]| sum(&[(0.125, w[0]), (0.75, w[1]), (0.125, w[2])]);
    let mut all = vec![middle(&points[..2])];
    for three in points.windows(3) {
        all.extend([own(three), middle(&three[1..])]);
    }
    all
}

fn transposed(rows: &[Vec<Point>]) -> Vec<Vec<Point>> {
    (0..rows[0].len()).map(|i| rows.iter().map(|row| row[i]).collect()).collect()
}

#[test]
fn regular_faces_are_bicubic_b_splines() {
    let [m, n] = [6, 5];
    let mesh = grid([m, n], false, &mut Random::new(7));
    let topology = topology(&mesh, &Options::default());
    let mut control: Vec<Vec<Point>> =
        wide(&mesh.positions).chunks(m as usize + 1).map(<[Point]>::to_vec).collect();
    for level in 1..=6 {
        let rows: Vec<Vec<Point>> = control.iter().map(|row| inserted(row)).collect();
        let columns: Vec<Vec<Point>> = transposed(&rows).iter().map(|column| inserted(column)).collect();
        control = transposed(&columns);
        // The first that is known is there at this place of the level.
        let (s, begin) = ((1u32 << level) as f32, (1usize << level) - 1);
        let mut compared = 0;
        for (v, point) in wide(&positions(&mesh, &topology, level)).iter().enumerate() {
            let place = |v: u32| [v % (m + 1), v / (m + 1)].map(|x| x as f32 * s);
            let at = match topology.vertex_parent(level, v as u32) {
                VertexParent::Vertex(v) => place(v),
                VertexParent::Edge { vertices: [a, b], at } => {
                    let (a, b) = (place(a), place(b));
                    [0, 1].map(|k| a[k] + (b[k] - a[k]) * at)
                }
                VertexParent::Face { face, uv: [u, v], .. } => {
                    [(face % m) as f32 * s + u * s, (face / m) as f32 * s + v * s]
                }
            };
            let [x, y] = at.map(|x| (x as usize).wrapping_sub(begin));
            if let Some(expected) = control.get(y).and_then(|row| row.get(x)) {
                let off = distance(expected, point);
                assert!(off < 1e-6 * f64::from(mesh.size()), "level {level}, {at:?} is off by {off}");
                compared += 1;
            }
        }
        assert_eq!(compared, control.len() * control[0].len());
    }
}

/// What names a vertex at every level at which it is.
type Name = (u8, [u32; 2], [u32; 2]);

fn names(topology: &Topology, level: u32) -> BTreeMap<Name, usize> {
    let name = |v: usize| match topology.vertex_parent(level, v as u32) {
        VertexParent::Vertex(v) => (0, [v, 0], [0, 0]),
        VertexParent::Edge { vertices: [a, b], at } if a < b => (1, [a, b], [at.to_bits(), 0]),
        VertexParent::Edge { vertices: [a, b], at } => (1, [b, a], [(1.0 - at).to_bits(), 0]),
        VertexParent::Face { face, corner, uv } => (2, [face, corner.unwrap_or(9)], uv.map(f32::to_bits)),
    };
    let names: BTreeMap<Name, usize> =
        (0..topology.counts(level).vertices as usize).map(|v| (name(v), v)).collect();
    assert_eq!(names.len() as u64, topology.counts(level).vertices);
    names
}

fn block() -> Mesh {
    // Two cubes side by side, from which a block of ten faces comes.
    let point = |n: u32| [n % 3, n / 3 % 2, n / 6].map(|x| x as f32 + 0.06 * (n * n % 7) as f32);
    let at = |x: u32, y: u32, z: u32| x + 3 * y + 6 * z;
    let mut faces: Vec<[u32; 4]> = Vec::new();
    for x in 0..2 {
        faces.push([at(x, 0, 0), at(x, 1, 0), at(x + 1, 1, 0), at(x + 1, 0, 0)]);
        faces.push([at(x, 0, 1), at(x + 1, 0, 1), at(x + 1, 1, 1), at(x, 1, 1)]);
        faces.push([at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, 0, 1), at(x, 0, 1)]);
        faces.push([at(x, 1, 0), at(x, 1, 1), at(x + 1, 1, 1), at(x + 1, 1, 0)]);
    }
    faces.push([at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)]);
    faces.push([at(2, 0, 0), at(2, 1, 0), at(2, 1, 1), at(2, 0, 1)]);
    Mesh::new((0..12).map(point).collect(), faces.into_iter().collect())
}

/// A fan of triangles around a vertex, closed by a polygon or not.
fn pole(valence: u32, is_closed: bool) -> Mesh {
    let angle = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(valence);
    let mut points = vec![[0.1, 0.0, 0.8]];
    points
        .extend((0..valence).map(|k| [angle(k).cos() as f32, angle(k).sin() as f32, 0.05 * (k % 3) as f32]));
    let mut faces: Vec<Vec<u32>> = (0..valence).map(|k| vec![0, 1 + k, 1 + (k + 1) % valence]).collect();
    if is_closed {
        faces.push((1..=valence).rev().collect());
    }
    Mesh::new(points, faces.into_iter().collect())
}

/// Meshes whose masks in the limit are exact: no darts, no sharpness that ends, and no inner vertex of two faces alone, which
/// OpenSubdiv leaves where it is.
fn exact() -> Vec<(&'static str, Mesh, Options)> {
    let mut random = Random::new(3);
    let (edge, corner) = (Options::default(), Options { boundary: Boundary::Corner, ..Options::default() });
    let creased = |edges: &[[u32; 2]]| {
        let mut mesh = block();
        mesh.creases = edges.iter().map(|&vertices| Crease { vertices, sharpness: 10.0 }).collect();
        mesh
    };
    let all_edges: Vec<[u32; 2]> = {
        let sides = |face: &[u32]| (0..4).map(|k| [face[k], face[(k + 1) % 4]]).collect::<Vec<_>>();
        block().faces.iter().flat_map(sides).filter(|[a, b]| a < b).collect()
    };
    vec![
        ("block", block(), edge),
        ("torus", grid([7, 5], true, &mut random), edge),
        ("pole of 3", pole(3, true), edge),
        ("pole of 5", pole(5, true), edge),
        ("pole of 7", pole(7, true), edge),
        ("pole of 30", pole(30, true), edge),
        ("ring of creases", creased(&[[0, 1], [1, 2], [2, 5], [5, 4], [4, 3], [3, 0]]), edge),
        ("ring of creases at regular vertices", creased(&[[1, 4], [4, 10], [10, 7], [7, 1]]), edge),
        ("all edges creased", creased(&all_edges), edge),
        ("two rings", creased(&[[0, 3], [3, 9], [9, 6], [6, 0], [0, 1], [1, 4], [4, 3]]), edge),
        ("sheet", grid([3, 2], false, &mut random), edge),
        ("sheet with corners", grid([3, 2], false, &mut random), corner),
        ("quad", grid([1, 1], false, &mut random), edge),
        ("quad with corners", grid([1, 1], false, &mut random), corner),
        ("open fan", pole(5, false), edge),
        ("open fan with corners", pole(5, false), corner),
    ]
}

/// How much nearer to its limit a vertex is with each level: in a regular mesh a quarter of the way before is left, and at a
/// smooth vertex of n faces x, where x² − (¾ − 7/4n) x + (1 − 3/n)/16 = 0. That is what is left of the characteristic
/// polynomial of the step from a vertex, the mean of its neighbours and that of the corners opposite to the next, without
/// the 1 that all steps have.
fn rate(mesh: &Mesh) -> f64 {
    let valence = |v: usize| mesh.faces.vertices().iter().filter(|&&own| own as usize == v).count() as f64;
    let polygons = mesh.faces.iter().map(|face| face.len() as f64);
    let of = |n: f64| {
        let (sum, product) = (0.75 - 1.75 / n, (1.0 - 3.0 / n) / 16.0);
        sum / 2.0 + (sum * sum / 4.0 - product).max(0.0).sqrt()
    };
    (0..mesh.positions.len()).map(valence).chain(polygons).map(of).fold(0.25, f64::max)
}

/// The limit of a level's vertices is that of the same vertices at other levels, and what the levels come near to.
#[test]
fn limits_are_what_deep_levels_come_near_to() {
    for (name, mesh, options) in exact() {
        let topology = topology(&mesh, &options);
        let size = f64::from(mesh.size());
        let first = topology.first_level();
        let deep = if mesh.faces.len() > 10 { 5 } else { 6 } + first;
        let (at_first, in_the_limit) = (names(&topology, first), wide(&limits(&mesh, &topology, first).0));
        let near = wide(&positions(&mesh, &topology, deep));
        let deep_names = names(&topology, deep);
        let within = size * (0.5 * rate(&mesh).powi((deep - first) as i32) + 1e-6);
        for (name_of, &v) in &at_first {
            let off = distance(&in_the_limit[v], &near[deep_names[name_of]]);
            assert!(off < within, "{name}: vertex {v} is off by {:e} of the size", off / size);
        }
        for level in [first + 1, first + 3] {
            let finer = wide(&limits(&mesh, &topology, level).0);
            let names = names(&topology, level);
            for (name_of, &v) in &at_first {
                let off = distance(&in_the_limit[v], &finer[names[name_of]]);
                assert!(off < 1e-6 * size, "{name}, level {level}: vertex {v} is off by {:e}", off / size);
            }
        }
    }
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Point {
    let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / length)
}

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Tangents, normals and positions of the same run; tangents may be left out.
fn frames(mesh: &Mesh, topology: &Arc<Topology>, level: u32) -> (Vec<Point>, [Vec<Point>; 2]) {
    let count = topology.counts(level).vertices as usize;
    let [mut positions, mut normals, mut along, mut across] = [(); 4].map(|()| vec![[0.0; 3]; count]);
    let tangents = Some([&mut along[..], &mut across[..]]);
    let mut out = Limits { positions: &mut positions, normals: &mut normals, tangents };
    let mut refiner = Refiner::new(topology.clone(), level).unwrap_or_else(|e| panic!("{e}"));
    refiner.refine_limit(&mesh.positions, &mut out);
    assert_eq!(limits(mesh, topology, level), (positions, normals.clone()));
    (wide(&normals), [wide(&along), wide(&across)])
}

#[test]
fn normals_are_those_of_deep_faces() {
    for (name, mesh, options) in exact() {
        let topology = topology(&mesh, &options);
        let first = topology.first_level();
        let (normals, tangents) = frames(&mesh, &topology, first + 1);
        for (v, &normal) in normals.iter().enumerate() {
            assert!((dot(normal, normal) - 1.0).abs() < 1e-5, "{name}: {normal:?} of vertex {v}");
            let own = unit(cross(tangents[0][v], tangents[1][v]));
            assert!(dot(own, normal) > 1.0 - 1e-5, "{name}: {normal:?} of vertex {v}, not {own:?}");
        }
        // Where no edge is sharp, the faces around a vertex turn into one plane.
        if !name.starts_with("block") && !name.starts_with("torus") && !name.starts_with("pole") {
            continue;
        }
        let deep = first + if mesh.faces.len() > 10 { 6 } else { 7 };
        let points = wide(&kept(&topology, deep, &[deep], &mesh.positions)[0]);
        let mut sums = vec![[0.0; 3]; points.len()];
        for quad in quads(&topology, deep) {
            let [a, b, c, d] = quad.map(|v| points[v as usize]);
            let area = cross([0, 1, 2].map(|k| c[k] - a[k]), [0, 1, 2].map(|k| d[k] - b[k]));
            for v in quad {
                sums[v as usize] = [0, 1, 2].map(|k| sums[v as usize][k] + area[k]);
            }
        }
        let deep_names = names(&topology, deep);
        for (name_of, v) in names(&topology, first + 1) {
            let expected = unit(sums[deep_names[&name_of]]);
            let cosine = dot(expected, normals[v]);
            assert!(
                cosine > 1.0 - 1e-4,
                "{name}: {:?} of vertex {v}, not {expected:?}: {cosine}",
                normals[v]
            );
        }
    }
}

/// Faces of the bilinear scheme stay as they are.
#[test]
fn bilinear_limits_are_the_points() {
    for (name, mesh, options) in exact() {
        let topology = topology(&mesh, &Options { scheme: Scheme::Bilinear, ..options });
        let level = topology.first_level() + 1;
        let (found, expected) = (limits(&mesh, &topology, level).0, positions(&mesh, &topology, level));
        for (v, (found, expected)) in wide(&found).iter().zip(wide(&expected)).enumerate() {
            let off = distance(found, &expected);
            assert!(off < 1e-6 * f64::from(mesh.size()), "{name}: vertex {v} is off by {off}");
        }
    }
}

/// The limit of a vertex inside a border is on the border's own spline: a sixth, two thirds and a sixth.
#[test]
fn borders_are_cubic_splines() {
    let mesh = grid([5, 2], false, &mut Random::new(11));
    let topology = topology(&mesh, &Options::default());
    let (points, spline) = (wide(&limits(&mesh, &topology, 0).0), wide(&mesh.positions));
    let names = names(&topology, 0);
    for v in 1..5u32 {
        let [a, b, c] = [v - 1, v, v + 1].map(|v| spline[v as usize]);
        let expected = [0, 1, 2].map(|k| (a[k] + 4.0 * b[k] + c[k]) / 6.0);
        let found = points[names[&(0, [v, 0], [0, 0])]];
        assert!(distance(&expected, &found) < 1e-6 * f64::from(mesh.size()), "vertex {v}");
    }
}
