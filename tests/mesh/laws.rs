//! What holds of every mesh, whatever the schemes are: which levels are kept, how many threads there are, how vertices are
//! named and where they are do not matter.

use super::surface::{Surface, distance};
use super::{cases, positions, topology};
use crate::oracle::mesh::{Level, Point, ends};
use crate::oracle::{MeshCase, Random};
use burgeon::cpu::refine::{self, Refiner, quads, triangles};
use burgeon::mesh::{
    Boundary, Corner, Crease, Creasing, Faces, Mesh, Options, Scheme, Topology, VertexParent,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The points of so many levels, refined at once by a refiner up to level `last`.
pub fn kept<const N: usize>(
    topology: &Arc<Topology>,
    last: u32,
    levels: &[u32],
    mesh: &[[f32; N]],
) -> Vec<Vec<[f32; N]>> {
    let mut refiner = Refiner::new(topology.clone(), last).unwrap_or_else(|e| panic!("{e}"));
    // What is not written shows.
    let empty = |&level: &u32| vec![[f32::NAN; N]; topology.counts(level).vertices as usize];
    let mut out: Vec<Vec<[f32; N]>> = levels.iter().map(empty).collect();
    let mut wanted: Vec<refine::Level<N>> =
        levels.iter().copied().zip(out.iter_mut().map(|level| &mut level[..])).collect();
    refiner.refine_levels(mesh, &mut wanted);
    out
}

fn bits<const N: usize>(points: &[[f32; N]]) -> Vec<[u32; N]> {
    points.iter().map(|p| p.map(f32::to_bits)).collect()
}

/// The first point that has other bits.
#[track_caller]
fn assert_same_bits<const N: usize>(expected: &[[f32; N]], found: &[[f32; N]], what: impl Fn() -> String) {
    assert_eq!(expected.len(), found.len(), "{}", what());
    let (expected, found) = (bits(expected), bits(found));
    if let Some(v) = (0..found.len()).find(|&v| expected[v] != found[v]) {
        let [a, b] = [expected[v], found[v]].map(|p| p.map(f32::from_bits));
        panic!("vertex {v} is at {b:?}, not {a:?}: {}", what());
    }
}

fn options(scheme: Scheme, boundary: Boundary, creasing: Creasing) -> Options {
    Options { scheme, boundary, creasing }
}

/// Meshes of few faces for many levels, with sharpness that ends at late levels, or in the middle of one.
fn small() -> Vec<(&'static str, Mesh, Options)> {
    let corner = |n: u32| [n & 1, n >> 1 & 1, n >> 2].map(|bit| bit as f32 + 0.07 * (n * n % 5) as f32);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let cube = Mesh::new((0..8).map(corner).collect(), Faces::from_iter(faces));
    let crease = |vertices: [u32; 2], sharpness: f32| Crease { vertices, sharpness };
    let mut creased = cube.clone();
    creased.creases = vec![
        crease([0, 1], 6.4),
        crease([1, 3], 5.0),
        crease([3, 2], 2.3),
        crease([4, 5], 10.0),
        crease([5, 7], 10.0),
        crease([7, 6], 7.5),
    ];
    creased.corners = vec![Corner { vertex: 2, sharpness: 5.7 }, Corner { vertex: 6, sharpness: 0.5 }];
    let mut quad = Mesh::new((0..4).map(corner).collect(), Faces::from_iter([[0, 1, 3, 2]]));
    quad.corners = vec![Corner { vertex: 1, sharpness: 6.3 }, Corner { vertex: 2, sharpness: 1.5 }];
    let mut tetrahedron = Mesh::new(
        (0..4).map(corner).collect(),
        Faces::from_iter([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]),
    );
    tetrahedron.creases = vec![crease([0, 1], 6.5), crease([1, 2], 10.0), crease([2, 0], 3.1)];
    let mut holed = creased.clone();
    holed.holes = vec![0, 3];
    let (smooth, flat) = (Scheme::CatmullClark, Scheme::Bilinear);
    let (uniform, chaikin) = (Creasing::Uniform, Creasing::Chaikin);
    vec![
        ("quad", quad.clone(), options(smooth, Boundary::Edge, uniform)),
        ("quad", quad, options(smooth, Boundary::Corner, chaikin)),
        ("cube", cube, options(smooth, Boundary::Edge, uniform)),
        ("creased cube", creased.clone(), options(smooth, Boundary::Edge, uniform)),
        ("creased cube", creased.clone(), options(smooth, Boundary::Edge, chaikin)),
        ("creased cube", creased, options(flat, Boundary::Edge, uniform)),
        ("cube with holes", holed, options(smooth, Boundary::Edge, chaikin)),
        ("tetrahedron", tetrahedron, options(smooth, Boundary::Edge, chaikin)),
    ]
}

/// Random meshes under one set of options each, all in turn.
fn each() -> impl Iterator<Item = (MeshCase, Options)> {
    let all = super::random::all_options();
    cases().into_iter().enumerate().map(move |(k, case)| (case, all[k % all.len()]))
}

#[test]
fn levels_that_are_kept_are_those_refined_alone() {
    for (case, options) in each() {
        let (mesh, topology) = (&case.mesh, topology(&case.mesh, &options));
        let alone = |level: u32| positions(mesh, &topology, level);
        for levels in [&[0, 1, 2, 3, 4][..], &[4, 2], &[1, 3], &[0, 3]] {
            let last = levels.iter().copied().max().expect("a level");
            let all = kept(&topology, last, levels, &mesh.positions);
            for (&level, found) in levels.iter().zip(&all) {
                assert_same_bits(&alone(level), found, || format!("level {level} of {levels:?}\n{case}"));
            }
        }
    }
}

#[test]
fn so_they_are_beyond_the_fifth_level() {
    for (name, mesh, options) in small() {
        let topology = topology(&mesh, &options);
        let alone: Vec<_> = (0..=8).map(|level| positions(&mesh, &topology, level)).collect();
        let all: [&[u32]; 6] =
            [&[0, 1, 2, 3, 4, 5, 6, 7, 8], &[8, 0, 5], &[3, 7], &[6, 2, 1], &[6, 7], &[4, 3]];
        for (levels, last) in all.into_iter().zip([8, 8, 7, 6, 8, 8]) {
            let found = kept(&topology, last, levels, &mesh.positions);
            for (&level, found) in levels.iter().zip(&found) {
                let what = || format!("level {level} of {levels:?} up to {last}, {name}, {options:?}");
                assert_same_bits(&alone[level as usize], found, what);
            }
        }
    }
}

/// Sharpness of 6.4 ends at the seventh level, in rows of blocks.
#[test]
fn levels_beyond_the_fifth_are_the_oracles() {
    for (name, mesh, options) in small() {
        let topology = topology(&mesh, &options);
        let last = if mesh.faces.len() == 1 { 7 } else { 6 };
        let mut naive = Level::refined(&mesh, &options, 5);
        for level in 6..=last {
            naive = naive.refine(&options);
            let found = Surface::refined(&topology, level, &positions(&mesh, &topology, level));
            let within = 1e-6 * f64::from(mesh.size());
            let compared = Surface::naive(&naive).compare(&found, within);
            compared.unwrap_or_else(|e| panic!("level {level} of the {name}, {options:?}: {e}"));
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let pools = [1, 2, 3].map(pool);
    let assert_same = |mesh: &Mesh, options: &Options, levels: &[u32], what: &dyn Fn() -> String| {
        let topology = topology(mesh, options);
        let last = levels.iter().copied().max().expect("a level");
        let run = || {
            let faces: Vec<_> = levels.iter().map(|&level| quads(&topology, level)).collect();
            (kept(&topology, last, levels, &mesh.positions), faces)
        };
        let expected = pools[0].install(run);
        for pool in &pools[1..] {
            let found = pool.install(run);
            assert!(found.1 == expected.1, "{}", what());
            for (expected, found) in expected.0.iter().zip(&found.0) {
                assert_same_bits(expected, found, what);
            }
        }
    };
    for (case, options) in each() {
        assert_same(&case.mesh, &options, &[1, 3], &|| case.to_string());
    }
    for (name, mesh, options) in small() {
        assert_same(&mesh, &options, &[2, 6, 8], &|| name.to_string());
    }
}

#[test]
fn a_refiner_may_run_again_with_other_points() {
    for (case, options) in each().take(6) {
        let topology = topology(&case.mesh, &options);
        let moved: Vec<[f32; 3]> = case.mesh.positions.iter().map(|[x, y, z]| [y + 1.0, z * x, -x]).collect();
        let mut refiner = Refiner::new(topology.clone(), 3).unwrap_or_else(|e| panic!("{e}"));
        let mut out = vec![[f32::NAN; 3]; topology.counts(3).vertices as usize];
        for points in [&case.mesh.positions, &moved, &case.mesh.positions] {
            refiner.refine(points, &mut out);
            assert_same_bits(&kept(&topology, 3, &[3], points)[0], &out, || case.to_string());
        }
    }
}

#[test]
fn faces_name_vertices_that_are_there_and_all_of_them() {
    let check = |mesh: &Mesh, options: &Options, level: u32, what: &dyn Fn() -> String| {
        let topology = topology(mesh, options);
        let quads = quads(&topology, level);
        let count = topology.counts(level).vertices as usize;
        let mut used = vec![false; count];
        for &v in quads.iter().flatten() {
            assert!((v as usize) < count, "vertex {v} of {count} at level {level}: {}", what());
            used[v as usize] = true;
        }
        if mesh.holes.is_empty() {
            assert_eq!(used.iter().position(|used| !used), None, "level {level}: {}", what());
        }
        let halves = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        assert!(triangles(&topology, level).into_iter().eq(halves), "level {level}: {}", what());
    };
    for (case, options) in each() {
        let first = u32::from(!case.mesh.faces.all_have(4));
        (first..=3).for_each(|level| check(&case.mesh, &options, level, &|| case.to_string()));
    }
    for (name, mesh, options) in small() {
        (4..=8).for_each(|level| check(&mesh, &options, level, &|| name.to_string()));
    }
}

#[test]
fn scaling_and_swapping_axes_are_exact() {
    let maps: [fn([f32; 3]) -> [f32; 3]; 5] = [
        |p| p.map(|x| x * 32.0),
        |p| p.map(|x| x / 1024.0),
        |[x, y, z]| [z, x, y],
        |[x, y, z]| [-x, z, -y],
        |[x, y, z]| [0.25 * y, 8.0 * x, z],
    ];
    for (case, options) in each() {
        let topology = topology(&case.mesh, &options);
        let plain = &kept(&topology, 3, &[3], &case.mesh.positions)[0];
        for (k, map) in maps.iter().enumerate() {
            let moved: Vec<[f32; 3]> = case.mesh.positions.iter().map(|&p| map(p)).collect();
            let found = &kept(&topology, 3, &[3], &moved)[0];
            let expected: Vec<[f32; 3]> = plain.iter().map(|&p| map(p)).collect();
            // Not their bits: −0 is 0.
            assert!(&expected == found, "map {k}\n{case}");
        }
    }
}

#[test]
fn affine_maps_are_the_same_before_and_after() {
    let rows = [[0.3, -1.1, 0.4, 1.7], [0.9, 0.2, -0.6, -2.4], [-0.5, 0.8, 1.2, 0.6]];
    let map = |p: Point| rows.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
    for (case, options) in each() {
        let topology = topology(&case.mesh, &options);
        let wide = |points: &[[f32; 3]]| points.iter().map(|p| p.map(f64::from)).collect::<Vec<Point>>();
        let mapped = wide(&case.mesh.positions).into_iter().map(|p| map(p).map(|x| x as f32)).collect();
        let moved = Mesh { positions: mapped, ..case.mesh.clone() };
        let (plain, found) = (positions(&case.mesh, &topology, 3), positions(&moved, &topology, 3));
        let within = 1e-6 * (f64::from(moved.size() + case.mesh.size()) + 3.0);
        for (v, (p, found)) in wide(&plain).into_iter().zip(wide(&found)).enumerate() {
            assert!(distance(&map(p), &found) < within, "vertex {v}: {found:?}, not {:?}\n{case}", map(p));
        }
    }
}

/// The same mesh with its vertices and faces in another order, and its faces from another corner on.
fn relabelled(mesh: &Mesh, random: &mut Random) -> Mesh {
    let shuffled = |count: usize, random: &mut Random| {
        let mut order: Vec<usize> = (0..count).collect();
        random.shuffle(&mut order);
        order
    };
    // Where each goes.
    let to = shuffled(mesh.positions.len(), random);
    let mut positions = mesh.positions.clone();
    to.iter().enumerate().for_each(|(old, &new)| positions[new] = mesh.positions[old]);
    let vertex = |v: u32| to[v as usize] as u32;
    // Where each comes from.
    let from = shuffled(mesh.faces.len(), random);
    let mut turned = |&face: &usize| {
        let mut face: Vec<u32> = mesh.faces.get(face).iter().map(|&v| vertex(v)).collect();
        let by = random.below(face.len());
        face.rotate_left(by);
        face
    };
    let faces = from.iter().map(&mut turned).collect();
    let crease = |c: &Crease| Crease { vertices: c.vertices.map(vertex), sharpness: c.sharpness };
    let corner = |c: &Corner| Corner { vertex: vertex(c.vertex), sharpness: c.sharpness };
    let hole = |&hole: &u32| from.iter().position(|&face| face == hole as usize).expect("a face") as u32;
    Mesh {
        positions,
        faces,
        creases: mesh.creases.iter().rev().map(crease).collect(),
        corners: mesh.corners.iter().rev().map(corner).collect(),
        holes: mesh.holes.iter().rev().map(hole).collect(),
    }
}

#[test]
fn names_of_vertices_and_faces_do_not_matter() {
    let mut random = Random::new(5);
    for (case, options) in each() {
        let other = relabelled(&case.mesh, &mut random);
        let surface = |mesh: &Mesh| {
            let topology = topology(mesh, &options);
            Surface::refined(&topology, 3, &positions(mesh, &topology, 3))
        };
        let compared = surface(&case.mesh).compare(&surface(&other), 1e-6 * f64::from(case.mesh.size()));
        compared.unwrap_or_else(|e| panic!("{options:?}: {e}\n{case}"));
    }
}

#[test]
fn one_to_four_numbers_a_point_have_the_same_values() {
    fn assert_columns<const N: usize>(topology: &Arc<Topology>, numbers: &[[f32; 4]], expected: &[[f32; 4]]) {
        for first in 0..=4 - N {
            let columns = |p: &[f32; 4]| std::array::from_fn(|k| p[first + k]);
            let mesh: Vec<[f32; N]> = numbers.iter().map(columns).collect();
            let expected: Vec<[f32; N]> = expected.iter().map(columns).collect();
            assert_same_bits(&expected, &kept(topology, 3, &[3], &mesh)[0], || format!("{N} from {first}"));
        }
    }
    for (case, options) in each() {
        let topology = topology(&case.mesh, &options);
        let four = |p: &[f32; 3]| [p[0], p[1], p[2], p[0] * p[1] + 0.1];
        let numbers: Vec<[f32; 4]> = case.mesh.positions.iter().map(four).collect();
        let expected = &kept(&topology, 3, &[3], &numbers)[0];
        assert_columns::<1>(&topology, &numbers, expected);
        assert_columns::<2>(&topology, &numbers, expected);
        assert_columns::<3>(&topology, &numbers, expected);
    }
}

/// The point of the flat mesh at a place in a face.
fn on_face(mesh: &Mesh, face: u32, corner: Option<u32>, [u, v]: [f32; 2]) -> Point {
    let corners: Vec<Point> =
        mesh.faces.get(face as usize).iter().map(|&v| mesh.positions[v as usize].map(f64::from)).collect();
    let n = corners.len();
    let quad = match corner {
        None => <[Point; 4]>::try_from(corners).expect("a quad"),
        Some(c) => {
            let c = c as usize;
            let centre = [0, 1, 2].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / n as f64);
            let [after, before] = [(c + 1) % n, (c + n - 1) % n].map(|k| along(corners[c], corners[k], 0.5));
            [corners[c], after, centre, before]
        }
    };
    let (u, v) = (f64::from(u), f64::from(v));
    along(along(quad[0], quad[1], u), along(quad[3], quad[2], u), v)
}

fn along(a: Point, b: Point, at: f64) -> Point {
    [0, 1, 2].map(|k| a[k] * (1.0 - at) + b[k] * at)
}

#[test]
fn parents_are_where_bilinear_refinement_puts_children() {
    for case in cases() {
        let mesh = &case.mesh;
        let topology = topology(mesh, &Options { scheme: Scheme::Bilinear, ..Options::default() });
        let within = 1e-6 * f64::from(mesh.size());
        for level in u32::from(!mesh.faces.all_have(4))..=3 {
            let points: Vec<Point> =
                positions(mesh, &topology, level).iter().map(|p| p.map(f64::from)).collect();
            // What the vertices of the mesh and its edges have, along each from its lower end on.
            let mut vertices = vec![0; mesh.positions.len()];
            let mut edges: BTreeMap<[usize; 2], Vec<f64>> = BTreeMap::new();
            for (v, point) in points.iter().enumerate() {
                let parent = topology.vertex_parent(level, v as u32);
                let expected = match parent {
                    VertexParent::Vertex(v) => {
                        vertices[v as usize] += 1;
                        mesh.positions[v as usize].map(f64::from)
                    }
                    VertexParent::Edge { vertices: [a, b], at } => {
                        let at = f64::from(at);
                        let own = edges.entry(ends(a as usize, b as usize)).or_default();
                        own.push(if a < b { at } else { 1.0 - at });
                        let [a, b] = [a, b].map(|v| mesh.positions[v as usize].map(f64::from));
                        along(a, b, at)
                    }
                    VertexParent::Face { face, corner, uv } => on_face(mesh, face, corner, uv),
                };
                let off = distance(&expected, point);
                assert!(off < within, "level {level}, vertex {v}: {parent:?} is off by {off}\n{case}");
            }
            assert!(vertices.iter().all(|&count| count == 1), "level {level}\n{case}");
            let pieces = 1 << level;
            let middles: Vec<f64> = (1..pieces).map(|k| f64::from(k) / f64::from(pieces)).collect();
            let all = Level::new(mesh, &Options::default()).edges.len();
            assert_eq!(edges.len(), if level == 0 { 0 } else { all }, "level {level}\n{case}");
            for (edge, mut own) in edges {
                own.sort_by(f64::total_cmp);
                assert_eq!(own, middles, "level {level}, edge {edge:?}\n{case}");
            }

            let mut drawn = vec![0.0; mesh.faces.len()];
            for (f, quad) in quads(&topology, level).into_iter().enumerate() {
                let parent = topology.face_parent(level, f as u32);
                let [[u, v], [u1, v1]] = parent.uv;
                for (uv, corner) in [[u, v], [u1, v], [u1, v1], [u, v1]].into_iter().zip(quad) {
                    let expected = on_face(mesh, parent.face, parent.corner, uv);
                    let off = distance(&expected, &points[corner as usize]);
                    assert!(off < within, "level {level}, face {f}: {parent:?} is off by {off}\n{case}");
                }
                drawn[parent.face as usize] += f64::from((u1 - u) * (v1 - v));
            }
            // The parts of a face are as large as the face.
            for (f, area) in drawn.into_iter().enumerate() {
                let quads = if mesh.faces.all_have(4) { 1 } else { mesh.faces.get(f).len() };
                let expected = if mesh.holes.contains(&(f as u32)) { 0 } else { quads };
                assert_eq!(area, expected as f64, "level {level}, face {f}\n{case}");
            }
        }
    }
}
