//! The same on devices: CPU = GPU in every column, room that runs out, and frames that only record.

use super::{derived, file, tessellated};
use crate::device;
use crate::tessellate::sets::{book, torus};
use burgeon::cpu::tessellate::Tessellator as Cpu;
use burgeon::gpu::tessellate::{Capacity, Frame, Tessellator};
use burgeon::gpu::{Engine, Error};
use burgeon::patch::Net;
use burgeon::tessellate::vertex::{Format, Normal, Position, Tangent, Uv};
use burgeon::tessellate::{Camera, Level, Options};

const ROOM: Capacity = Capacity { nodes: 60_000, vertices: 60_000, indices: 240_000 };

fn submit(engine: &Engine, tessellator: &mut Tessellator) -> Frame {
    let mut encoder = engine.device().create_command_encoder(&Default::default());
    tessellator.encode(&mut encoder);
    engine.queue().submit([encoder.finish()]);
    tessellator.read().expect("a frame")
}

/// Integers are equal, floats as near as their terms' rounding.
fn same(cpu: &Cpu, gpu: &Frame, what: &str) {
    let t = cpu.trees();
    assert_eq!(gpu.nodes, t.nodes, "{what}: nodes");
    assert_eq!(gpu.children, t.children, "{what}: children");
    let leaf = |n: usize| t.children[n] == 0;
    for n in (0..t.nodes.len()).filter(|&n| leaf(n)) {
        assert_eq!(gpu.marks[n], t.marks[n], "{what}: marks of node {n}, {:?}", t.nodes[n]);
    }
    assert_eq!(gpu.offsets, t.offsets, "{what}: offsets of vertices");
    assert_eq!(gpu.triangle_offsets, t.triangle_offsets, "{what}: offsets of triangles");
    assert_eq!(gpu.indices, cpu.out().indices, "{what}: indices");
    assert_eq!(gpu.cells, cpu.out().cells, "{what}: cells");
    assert_eq!(gpu.status.vertices, cpu.status().vertices, "{what}");
    assert_eq!((gpu.status.nodes, gpu.status.skipped), (cpu.status().nodes, 0), "{what}");
    assert_eq!(&gpu.draw, cpu.draw_args());
    assert_eq!(gpu.vertices.len(), cpu.out().vertices.len(), "{what}: words of vertices");
    let far = t.nodes.len() as f32;
    assert!(far > 0.0);
    for (k, (&a, &b)) in gpu.vertices.iter().zip(&cpu.out().vertices).enumerate() {
        let (a, b) = (f32::from_bits(a), f32::from_bits(b));
        assert!((a - b).abs() <= 1e-5 * b.abs().max(1.0), "{what}: word {k} of the vertices: {a} and {b}");
    }
}

fn engines() -> Vec<(String, Engine)> {
    device::engines()
}

#[test]
fn cpu_and_gpu_make_the_same_mesh() {
    for (name, engine) in engines() {
        let sets: Vec<(&str, Vec<Net>, f32)> = vec![
            ("teapot", file("teapot.bpt", false), 0.01),
            ("torus of rational nets", file("torus.bpt", true), 0.01),
            ("sphere", file("sphere.bpt", true), 0.01),
            ("random torus", torus(2, 1, 7), 0.1),
            ("book", book(5, 3), 0.05),
        ];
        for (set, nets, tolerance) in sets {
            let what = format!("{set} on {name}");
            for seams in [false, true] {
                let (level, options) = (Level::world(tolerance), Options { seams, ..Options::default() });
                let cpu = tessellated(&nets, &level, &options);
                let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect(&what);
                same(&cpu, &submit(&engine, &mut gpu), &what);
                // And again, over the buffers of the frame before.
                same(&cpu, &submit(&engine, &mut gpu), &what);
            }
        }
    }
}

#[test]
fn words_are_the_same_on_cpu_and_gpu() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    for name in ["sierpinski", "holes", "fractal"] {
        let (plan, word, nets) = derived(name, &[]);
        let (level, options) = (Level::world(0.02), Options::default());
        let mut cpu = Cpu::of_word(&nets, &word, plan.hole, &options).expect(name);
        cpu.run(&level.target().expect("a level"));
        let gpu = Tessellator::of_word(&engine, &nets, &word, plan.hole, &level, &options, &ROOM);
        same(&cpu, &submit(&engine, &mut gpu.expect(name)), name);
    }
}
