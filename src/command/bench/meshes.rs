//! Meshes: tables once, then frames in which the vertices move.

use super::{Case, Failure, threads};
use burgeon::cpu::refine::{Limits, Refiner, quads_into};
use burgeon::mesh::{Crease, Faces, Mesh, Options, Topology};
use std::f32::consts::TAU;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A mesh, and the level that it is refined to.
pub struct Subject {
    pub name: &'static str,
    pub mesh: Mesh,
    pub level: u32,
}

pub fn subjects() -> Vec<Subject> {
    let subject = |name, mesh, level| Subject { name, mesh, level };
    vec![
        subject("torus 64×64, level 4", torus(64), 4),
        subject("torus 256×256, level 4", torus(256), 4),
        subject("poked torus, 7,220 poles, level 4", poked(&torus(38)), 4),
        subject("creased box 8×8×8, level 5", creased_box(8), 5),
        subject("cube, level 9", creased_box(1), 9),
    ]
}

/// Cases of the CPU backend.
pub fn cpu_cases(wanted: &dyn Fn(&str) -> bool, cases: &mut Vec<Case>) -> Result<(), Failure> {
    if !["mesh/first", "mesh/frame", "mesh/levels", "mesh/limit"].iter().any(|name| wanted(name)) {
        return Ok(());
    }
    let mut counts = vec![1];
    if threads() > 1 {
        counts.push(threads());
    }
    for subject in subjects() {
        let Subject { name, mesh, level } = subject;
        let mesh = Arc::new(mesh);
        let topology = topology(&mesh)?;
        let counted = topology.counts(level);
        let (vertices, faces) = (counted.vertices, counted.faces);
        let all: Vec<u64> = (1..=level).map(|level| topology.counts(level).vertices).collect();
        for &threads in &counts {
            let pool = Arc::new(pool(threads)?);
            let case = |name_of: &'static str, bytes: u64, run: Run| Case {
                name: name_of,
                case: format!(
                    "{name}{}",
                    if threads > 1 { format!(", {threads} threads") } else { String::new() }
                ),
                backend: "cpu",
                threads,
                bytes,
                items: vertices,
                run,
                times: Vec::new(),
            };
            if wanted("mesh/first") {
                let (pool, mesh) = (pool.clone(), mesh.clone());
                // Tables, positions and indices: what a mesh costs that was never seen before.
                let mut out = vec![[0.0f32; 3]; vertices as usize];
                let mut quads = vec![[0u32; 4]; faces as usize];
                let run = move || {
                    pool.install(|| {
                        let start = Instant::now();
                        first(&mesh, level, &mut out, &mut quads)?;
                        Ok(start.elapsed())
                    })
                };
                cases.push(case("mesh/first", 12 * vertices + 16 * faces, Box::new(run)));
            }
            if wanted("mesh/frame") {
                let (pool, mesh) = (pool.clone(), mesh.clone());
                let mut refiner = refiner(&topology, level)?;
                let mut out = vec![[0.0f32; 3]; vertices as usize];
                let run = move || pool.install(|| timed(|| refiner.refine(&mesh.positions, &mut out)));
                cases.push(case("mesh/frame", 12 * vertices, Box::new(run)));
            }
            if wanted("mesh/levels") {
                let (pool, mesh) = (pool.clone(), mesh.clone());
                let mut refiner = refiner(&topology, level)?;
                let mut out: Vec<Vec<[f32; 3]>> = all.iter().map(|&n| vec![[0.0; 3]; n as usize]).collect();
                let run = move || {
                    let mut levels: Vec<(u32, &mut [[f32; 3]])> =
                        out.iter_mut().zip(1..).map(|(out, level)| (level, &mut out[..])).collect();
                    pool.install(|| timed(|| refiner.refine_levels(&mesh.positions, &mut levels)))
                };
                cases.push(case("mesh/levels", 12 * all.iter().sum::<u64>(), Box::new(run)));
            }
            if wanted("mesh/limit") {
                let (pool, mesh) = (pool.clone(), mesh.clone());
                let mut refiner = refiner(&topology, level)?;
                let mut out = [0, 1].map(|_| vec![[0.0f32; 3]; vertices as usize]);
                let run = move || {
                    let [positions, normals] = &mut out;
                    let mut limits = Limits { positions, normals, tangents: None };
                    pool.install(|| timed(|| refiner.refine_limit(&mesh.positions, &mut limits)))
                };
                cases.push(case("mesh/limit", 24 * vertices, Box::new(run)));
            }
        }
    }
    Ok(())
}

type Run = Box<dyn FnMut() -> Result<Duration, Failure>>;

fn timed(work: impl FnOnce()) -> Result<Duration, Failure> {
    let start = Instant::now();
    work();
    Ok(start.elapsed())
}

fn first(mesh: &Mesh, level: u32, out: &mut [[f32; 3]], quads: &mut [[u32; 4]]) -> Result<(), Failure> {
    let topology = topology(mesh)?;
    quads_into(&topology, level, quads);
    refiner(&topology, level)?.refine(&mesh.positions, out);
    Ok(())
}

pub fn topology(mesh: &Mesh) -> Result<Arc<Topology>, Failure> {
    Ok(Arc::new(Topology::new(mesh, &Options::default()).map_err(|e| Failure::Device(e.to_string()))?))
}

fn refiner(topology: &Arc<Topology>, level: u32) -> Result<Refiner, Failure> {
    Refiner::new(topology.clone(), level).map_err(|e| Failure::Device(e.to_string()))
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Failure::Device(format!("error: {e}")))
}

/// A torus of n × n quads.
fn torus(n: u32) -> Mesh {
    let at = |i: u32| i as f32 / n as f32 * TAU;
    let point = |i: u32, j: u32| {
        let (u, v) = (at(i), at(j));
        [(2.0 + v.cos()) * u.cos(), (2.0 + v.cos()) * u.sin(), v.sin()]
    };
    let index = |i: u32, j: u32| i % n * n + j % n;
    let cells = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = cells().map(|(i, j)| [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]);
    Mesh::new(cells().map(|(i, j)| point(i, j)).collect(), Faces::from_iter(faces))
}

/// Each face as triangles around its middle.
fn poked(mesh: &Mesh) -> Mesh {
    let mut out = Mesh { positions: mesh.positions.clone(), ..Mesh::default() };
    for face in mesh.faces.iter() {
        let middle = out.positions.len() as u32;
        let mean =
            |k: usize| face.iter().map(|&v| mesh.positions[v as usize][k]).sum::<f32>() / face.len() as f32;
        out.positions.push([0, 1, 2].map(mean));
        for (i, &a) in face.iter().enumerate() {
            out.faces.push([a, face[(i + 1) % face.len()], middle]);
        }
    }
    out
}

/// A box of n × n quads a side, whose edges are creases of different sharpness where there are more than one.
fn creased_box(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut known = std::collections::HashMap::new();
    for axis in 0..3 {
        for end in [0, n] {
            for i in 0..n {
                for j in 0..n {
                    let mut corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
                    if end == 0 {
                        corners.reverse();
                    }
                    let face = corners.map(|[a, b]| {
                        let mut p = [0; 3];
                        (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (end, a, b);
                        *known.entry(p).or_insert_with(|| {
                            mesh.positions.push(p.map(|x| x as f32 / n as f32));
                            mesh.positions.len() as u32 - 1
                        })
                    });
                    mesh.faces.push(face);
                }
            }
        }
    }
    if n > 1 {
        for axis in 0..3 {
            for (k, [a, b]) in [[0, 0], [0, n], [n, 0], [n, n]].into_iter().enumerate() {
                for i in 0..n {
                    let at = |i: u32| {
                        let mut p = [0; 3];
                        (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (i, a, b);
                        known[&p]
                    };
                    let sharpness = 0.7 + k as f32 * 1.1;
                    mesh.creases.push(Crease { vertices: [at(i), at(i + 1)], sharpness });
                }
            }
        }
    }
    mesh
}
