//! The kernels that refine, broken on purpose: each must show against the CPU.

use super::device::{bits, on_cpu, submit};
use super::{cage, topology};
use crate::{device, mutants, tier};
use burgeon::codegen::GENERATED;
use burgeon::cpu::refine::{quads, triangles};
use burgeon::gpu::Engine;
use burgeon::gpu::refine::{Faces, Refiner};
use burgeon::mesh::{Creasing, Faces as Polygons, Mesh, Options};

const MUTANTS: &[mutants::Mutant] = &[
    ("pinned", "1.0 - weight", "weight"),
    ("pinned", "new_point * (1.0 - weight)", "old_point * (1.0 - weight)"),
    ("first", "k < starts[i + 1u]", "k + 1u < starts[i + 1u]"),
    ("first", "bitcast<f32>(term.y)", "1.0"),
    ("rings", "i < r.faces; i++) {\n      let after", "i + 1u < r.faces; i++) {\n      let after"),
    ("rings", "select(i + 1u, 0u, i + 1u == r.edges)", "i"),
    ("rings", "select(i - 1u, r.faces - 1u, i == 0u)", "i"),
    ("rings", "select(i, 0u, i >= r.faces)", "0u"),
    ("rings", "if r.faces == 4u", "if r.faces == 3u"),
    ("rings", "if weight == 1.0 {", "if weight > 0.0 {"),
    ("rings", "if plans[plan] != plans[plan + 1u] {", "if false {"),
    ("rings", "plans[plan + 5u], plans[plan + 6u]", "plans[plan + 3u], plans[plan + 4u]"),
    ("rings", "HEAD + r.edges)", "HEAD)"),
    ("rings", "pin(p * r.own)", "p"),
    ("roots", "const ROOT = 6u", "const ROOT = 5u"),
    ("roots", "first: u32,\n  chunk: u32,", "chunk: u32,\n  first: u32,"),
    ("gather", "array<i32, 4>(-4, 1, 4, -1)", "array<i32, 4>(-4, 1, -1, 4)"),
    ("gather", "array<i32, 4>(5, 6, 10, 9)", "array<i32, 4>(5, 6, 9, 10)"),
    ("gather", "(root - params.chunk)", "root"),
    ("gather", "rings[ring + before]", "rings[ring + after]"),
    ("levels", "(flags & 2u) != 0u", "true"),
    ("levels", "((flags & 1u) != 0u) == (side >= 2u)", "side >= 2u"),
    ("levels", "- 2u - level + t - 1u", "- 2u - level"),
    ("levels", "if weight == 1.0 {", "if weight > 0.0 {"),
    ("levels", "3u * vertex - params.fine", "3u * vertex"),
    ("levels", "3u * vertex - params.coarse", "3u * vertex"),
    ("levels", "countOneBits(own.z & 15u)", "4u"),
    ("levels", "after.y * m + before - m - 1u", "after.y * m + before - m"),
    (GENERATED, "x + 1u == n", "x + 1u > n"),
    (GENERATED, "params.level + 1u) * ring.y", "params.level) * ring.y"),
    (GENERATED, "ring.w != NONE", "ring.z != NONE"),
    (GENERATED, "s - (", "("),
    ("faces", "select(m - t, t - 1u, side.w != 0u)", "t - 1u"),
    ("faces", "c.z * m * m", "c.z * m"),
    ("faces", "on_side(root, 2u, s - x)", "on_side(root, 2u, x)"),
    ("faces", "faces[at + 4u] = c;", "faces[at + 4u] = d;"),
    (
        "faces",
        "faces[at + 1u] = b;\n    faces[at + 2u] = c;\n    faces[at + 3u] = d;",
        "faces[at + 1u] = d;\n    faces[at + 2u] = c;\n    faces[at + 3u] = b;",
    ),
];

/// Of a file of the kernels.
pub fn mutants_of(file: &str) -> usize {
    MUTANTS.iter().filter(|mutant| mutant.0 == file).count()
}

/// A prism with caps of three corners, pinched sides that meet a border, and a crease that dies.
fn prism() -> Mesh {
    let ring = |z: f32| [[0.0, 0.0, z], [1.0, 0.1, z], [0.4, 0.9, z + 0.2]];
    let mut mesh = Mesh::new([ring(0.0), ring(1.0)].concat(), Polygons::default());
    for k in 0..3u32 {
        let next = (k + 1) % 3;
        mesh.faces.push([k, next, 3 + next, 3 + k]);
    }
    mesh.faces.push([3, 4, 5]);
    mesh
}

/// What a device makes of these that is not what the CPU makes.
fn difference(engine: &Engine) -> Option<String> {
    let options = Options { creasing: Creasing::Chaikin, ..Options::default() };
    let small = (prism(), Options::default(), vec![1, 2, 3], usize::MAX);
    let creased = (cage("creases_cube"), options, vec![1, 2, 4], 4);
    let plain = (cage("creases_random_8"), Options::default(), vec![2], 100);
    for (mesh, options, levels, chunk) in [small, creased, plain] {
        let topology = topology(&mesh, &options);
        let last = levels.iter().copied().max().unwrap_or(0);
        let expected = on_cpu(&mesh, &topology, last);
        let found = Refiner::in_chunks(engine, &topology, &levels, chunk).and_then(|refiner| {
            refiner.set(&mesh.positions)?;
            submit(engine, &refiner);
            let read = levels.iter().map(|&level| refiner.read(level)).collect::<Result<Vec<_>, _>>()?;
            let words =
                |faces| Ok::<_, burgeon::gpu::Error>(device::words(engine, &refiner.faces(2, faces)?));
            Ok((read, words(Faces::Quads)?, words(Faces::Triangles)?))
        });
        let (read, own_quads, own_triangles) = match found {
            Ok(found) => found,
            Err(e) => return Some(e.to_string()),
        };
        for (&level, found) in levels.iter().zip(&read) {
            if bits(found) != bits(&expected[level as usize]) {
                return Some(format!("level {level} of {} roots", topology.roots.len()));
            }
        }
        if !own_quads.starts_with(quads(&topology, 2).as_flattened()) {
            return Some("quads".to_string());
        }
        if !own_triangles.starts_with(triangles(&topology, 2).as_flattened()) {
            return Some("triangles".to_string());
        }
    }
    None
}

#[test]
fn every_mutant_is_seen() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    assert_eq!(difference(&engine), None);
    let list = tier::cases(mutants::sample(MUTANTS), MUTANTS.to_vec());
    mutants::assert_seen(list.into_iter().filter_map(|mutant| mutants::unseen(&engine, mutant, difference)));
}

#[test]
fn every_file_has_mutants() {
    for folder in ["wgsl/refine", "wgsl/refine/shared"] {
        for entry in std::fs::read_dir(folder).expect("the kernels") {
            let path = entry.expect("an entry").path();
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let count = mutants_of(&name);
            assert!(path.is_dir() || count >= 2, "{} has {count} mutants", path.display());
        }
    }
}
