//! A device refines as the CPU does, to the bit.

use super::{cage, topology};
use crate::{device, tier};
use burgeon::cpu::refine::{self, Level};
use burgeon::gpu::Engine;
use burgeon::gpu::refine::{Faces, Refiner};
use burgeon::mesh::{Creasing, Mesh, Options, Scheme, Topology};

const CAGES: [&str; 6] =
    ["cube", "torus_16", "boundary_grid_3", "creases_cube", "creases_box_8", "creases_random_8"];

/// All levels up to this one on the CPU, level 0 too.
pub fn on_cpu(mesh: &Mesh, topology: &std::sync::Arc<Topology>, last: u32) -> Vec<Vec<[f32; 3]>> {
    let mut refiner = refine::Refiner::new(topology.clone(), last).expect("a refiner");
    let count = |level| topology.counts(level).vertices as usize;
    let mut out: Vec<Vec<[f32; 3]>> = (0..=last).map(|level| vec![[0.0; 3]; count(level)]).collect();
    let mut levels: Vec<Level<3>> = (0..).zip(out.iter_mut().map(|out| &mut out[..])).collect();
    refiner.refine_levels(&mesh.positions, &mut levels);
    out
}

/// Submits a frame.
pub fn submit(engine: &Engine, refiner: &Refiner) {
    let mut encoder = engine.device().create_command_encoder(&Default::default());
    refiner.encode(&mut encoder);
    engine.queue().submit([encoder.finish()]);
}

pub fn bits(points: &[[f32; 3]]) -> Vec<[u32; 3]> {
    points.iter().map(|p| p.map(f32::to_bits)).collect()
}

#[track_caller]
fn assert_same(name: &str, expected: &[[f32; 3]], found: &[[f32; 3]]) {
    let (expected, found) = (bits(expected), bits(found));
    assert_eq!(expected.len(), found.len(), "{name}");
    let differ = expected.iter().zip(&found).filter(|(a, b)| a != b).count();
    let first = expected.iter().zip(&found).position(|(a, b)| a != b);
    assert!(differ == 0, "{name}: {differ} of {} vertices differ, the first is {first:?}", found.len());
}

/// Level by level and two at once, in all chunks.
#[test]
fn every_level_is_that_of_the_cpu() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    for name in CAGES {
        for creasing in [Creasing::Uniform, Creasing::Chaikin] {
            let mesh = cage(name);
            let options = Options { creasing, ..Options::default() };
            let topology = topology(&mesh, &options);
            let expected = on_cpu(&mesh, &topology, 4);
            let all = tier::cases(vec![], vec![(vec![1], 1), (vec![2], 3), (vec![4], usize::MAX)]);
            for (levels, chunk) in [(vec![3], 7), ((0..=4).collect(), 64)].into_iter().chain(all) {
                let chunk = chunk.max(topology.roots.len() / 8);
                let refiner = Refiner::in_chunks(&engine, &topology, &levels, chunk).expect("a refiner");
                refiner.set(&mesh.positions).expect("positions");
                submit(&engine, &refiner);
                for level in levels {
                    let found = refiner.read(level).expect("a level");
                    let what = format!("{name}, {creasing}, level {level} in chunks of {chunk}");
                    assert_same(&what, &expected[level as usize], &found);
                }
            }
        }
    }
}

#[test]
fn bilinear_levels_are_those_of_the_cpu() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let mesh = cage("creases_random_8");
    let topology = topology(&mesh, &Options { scheme: Scheme::Bilinear, ..Options::default() });
    let refiner = Refiner::new(&engine, &topology, &[3]).expect("a refiner");
    refiner.set(&mesh.positions).expect("positions");
    submit(&engine, &refiner);
    let expected = on_cpu(&mesh, &topology, 3);
    assert_same("bilinear", &expected[3], &refiner.read(3).expect("a level"));
}

/// What is regular takes half as many dispatches as levels, and two.
#[test]
fn a_frame_is_few_dispatches() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let mesh = cage("torus_16");
    let topology = topology(&mesh, &Options::default());
    for (level, dispatches) in [(1, 2), (2, 2), (3, 3), (4, 3), (5, 4)] {
        let refiner = Refiner::new(&engine, &topology, &[level]).expect("a refiner");
        assert_eq!(refiner.dispatches(), dispatches, "level {level}");
    }
}

#[test]
fn faces_are_numbered_as_on_the_cpu() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    for name in CAGES {
        let topology = topology(&cage(name), &Options::default());
        for level in 0..=3 {
            let refiner = Refiner::new(&engine, &topology, &[level]).expect("a refiner");
            let words = |faces| {
                let buffer = refiner.faces(level, faces).expect("faces");
                device::words(&engine, &buffer)
            };
            let (quads, triangles) = (refine::quads(&topology, level), refine::triangles(&topology, level));
            assert!(words(Faces::Quads).starts_with(quads.as_flattened()), "{name}, level {level}");
            assert!(words(Faces::Triangles).starts_with(triangles.as_flattened()), "{name}, level {level}");
        }
    }
}

#[test]
fn positions_must_be_as_many_as_vertices() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let topology = topology(&cage("cube"), &Options::default());
    let refiner = Refiner::new(&engine, &topology, &[1]).expect("a refiner");
    let error = refiner.set(&[[0.0; 3]; 7]).expect_err("one too few").to_string();
    assert_eq!(error, "7 positions where the mesh has 8 vertices");
}
