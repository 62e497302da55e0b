//! The same on devices: CPU = GPU in every column, room that runs out, and frames that only record.

use super::far::{mapped, on_lattice};
use super::{derived, file, tessellated};
use crate::tessellate::sets::{book, torus};
use crate::{device, tier};
use burgeon::conformance::tessellation::compare;
use burgeon::cpu::tessellate::Tessellator as Cpu;
use burgeon::gpu::tessellate::{Capacity, Frame, Tessellator};
use burgeon::gpu::{Engine, Error};
use burgeon::patch::Net;
use burgeon::tessellate::vertex::{Format, Position, Tangent};
use burgeon::tessellate::{Camera, Level, Options};

pub const ROOM: Capacity = Capacity { nodes: 60_000, vertices: 60_000, indices: 240_000, modules: 20_000 };

pub fn submit(engine: &Engine, tessellator: &mut Tessellator) -> Frame {
    let mut encoder = engine.device().create_command_encoder(&Default::default());
    tessellator.encode(&mut encoder);
    engine.queue().submit([encoder.finish()]);
    tessellator.read().expect("a frame")
}

/// What is not the same.
pub fn difference(cpu: &Cpu, gpu: &Frame) -> Option<String> {
    compare(cpu, gpu).err().map(|e| e.to_string())
}

fn same(cpu: &Cpu, gpu: &Frame, what: &str) {
    assert_eq!(difference(cpu, gpu), None, "{what}");
}

/// Buffers, bind groups, pipelines, shaders and textures that there are.
pub fn made(engine: &Engine) -> [isize; 5] {
    let hal = engine.device().get_internal_counters().hal;
    [&hal.buffers, &hal.bind_groups, &hal.compute_pipelines, &hal.shader_modules, &hal.textures]
        .map(|c| c.read())
}

fn far_off([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x + 5000.0, y - 3000.0, z]
}

#[test]
fn cpu_and_gpu_make_the_same_mesh() {
    for (n, (name, engine)) in device::both().into_iter().enumerate() {
        let mut sets: Vec<(&str, Vec<Net>, f32)> = vec![
            ("teapot", file("teapot.bpt", false), 0.01),
            ("torus of rational nets", file("torus.bpt", true), 0.01),
            ("sphere", file("sphere.bpt", true), 0.01),
            ("random torus", torus(2, 1, 7), 0.1),
            ("book", book(5, 3), 0.05),
            ("teapot far off", mapped(&on_lattice(&file("teapot.bpt", false)), far_off), 0.05),
            ("sphere far off", mapped(&file("sphere.bpt", true), far_off), 0.05),
        ];
        // The second engine compiles the same kernels by another way.
        sets.retain(|(set, ..)| n == 0 || tier::is_all() || *set == "book");
        for (set, nets, tolerance) in sets {
            let what = format!("{set} on {name}");
            for seams in [false, true] {
                let (level, options) = (Level::world(tolerance), Options { seams, ..Options::default() });
                let cpu = tessellated(&nets, &level, &options);
                let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect(&what);
                same(&cpu, &submit(&engine, &mut gpu), &what);
            }
        }
    }
}

/// Room for nothing is made room for all, in a few frames, and the mesh is that of the CPU.
#[test]
fn a_mesh_is_made_once_from_a_guess_that_is_far_too_small() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let nets = file("teapot.bpt", false);
    let (level, options) = (Level::world(0.01), Options::default());
    let cpu = tessellated(&nets, &level, &options).complete();
    for room in [Capacity::default(), Capacity::for_vertices(1000), ROOM] {
        let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &room).expect("a tessellator");
        let found = gpu.complete().expect("a mesh");
        assert!(found.status.complete());
        assert_eq!(found.mesh.indices, cpu.mesh.indices);
        assert_eq!((&found.sources, found.deepest), (&cpu.sources, cpu.deepest));
        for (a, b) in found.mesh.positions.iter().zip(&cpu.mesh.positions) {
            assert!((0..3).all(|k| (a[k] - b[k]).abs() <= 1e-6 * b[k].abs().max(1.0)), "{a:?} and {b:?}");
        }
        // And again, now that there is room.
        let frames = found.status.frame;
        assert_eq!(gpu.complete().expect("a mesh").status.frame, frames + 1);
    }
    let level = Level { depth: 12..=12, ..level };
    let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect("a tessellator");
    assert!(matches!(gpu.complete(), Err(Error::Binding { .. })));
    let other = Options { format: Format { uv: None, ..Format::default() }, ..options };
    let mut gpu = Tessellator::new(&engine, &nets, &Level::world(1.0), &other, &ROOM).expect("a tessellator");
    assert!(matches!(gpu.complete(), Err(Error::Format)));
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

/// Parts of a vertex as floats, of a format.
fn decoded(words: &[u32], format: &Format, capacity: u32, vertex: usize) -> Vec<f32> {
    let short = |w: u32| [w as u16 as i16, (w >> 16) as i16].map(|x| f32::from(x) / 32767.0);
    let mut values = Vec::new();
    for (attribute, place) in format.places(capacity).iter().enumerate() {
        let Some(place) = place else { continue };
        let at = (place.offset + vertex as u64 * place.stride) as usize / 4;
        let words = &words[at..at + place.bytes as usize / 4];
        match (attribute, place.bytes) {
            (0, 8) | (1, 4) => values.extend(words.iter().flat_map(|&w| short(w))),
            (2, 4) => values.extend(words[0].to_le_bytes().map(|b| f32::from(b as i8) / 127.0)),
            (3, 4) => values.extend([words[0] & 0xffff, words[0] >> 16].map(|x| x as f32 / 65535.0)),
            (4, _) => values.extend(words.iter().map(|&w| w as f32)),
            _ => values.extend(words.iter().map(|&w| f32::from_bits(w))),
        }
    }
    values
}

#[test]
fn every_format_holds_the_same_vertices() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (nets, level) = (file("teapot.bpt", false), Level::world(0.1));
    for format in super::kernels::formats() {
        for separate in [false, true] {
            let format = Format { separate, ..format };
            let options = Options { format, seams: false };
            let cpu = tessellated(&nets, &level, &options);
            let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect("a tessellation");
            let frame = submit(&engine, &mut gpu);
            assert_eq!(frame.indices, cpu.out().indices);
            let count = cpu.status().vertices;
            for v in 0..count as usize {
                let a = decoded(&frame.vertices, &format, ROOM.vertices, v);
                let b = decoded(&cpu.out().vertices, &format, count, v);
                let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-5 * b.abs().max(1.0) + steps(&format);
                assert!(a.iter().zip(&b).all(near), "vertex {v} of {format:?}: {a:?} and {b:?}");
            }
        }
    }
}

/// One step of the coarsest packed attribute.
fn steps(format: &Format) -> f32 {
    if format.tangent == Some(Tangent::Snorm8) { 1.0 / 127.0 } else { 0.0 }
}

#[test]
fn packed_vertices_are_the_floats_within_their_steps() {
    let (nets, level) = (file("teapot.bpt", false), Level::world(0.1));
    let [whole, packed, _] = super::kernels::formats();
    let whole = tessellated(&nets, &level, &Options { format: whole, seams: false });
    let small = tessellated(&nets, &level, &Options { format: packed, seams: false });
    let Position::Snorm16 { middle, extent } = packed.position else { panic!("packed") };
    let count = whole.status().vertices;
    for v in 0..count as usize {
        let a = decoded(&whole.out().vertices, whole.format(), count, v);
        let b = decoded(&small.out().vertices, small.format(), count, v);
        for k in 0..3 {
            let position = middle[k] + extent[k] * b[k];
            assert!((position - a[k]).abs() <= extent[k] / 32767.0, "{position} for {}", a[k]);
            assert!((b[6 + k] - a[6 + k]).abs() <= 1.0 / 127.0);
        }
        assert_eq!(b[3], 1.0);
        let (x, y) = (b[4], b[5]);
        let z = 1.0 - x.abs() - y.abs();
        let (x, y) =
            if z < 0.0 { ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)) } else { (x, y) };
        let length = (x * x + y * y + z * z).sqrt();
        let cosine = (x * a[3] + y * a[4] + z * a[5]) / length;
        assert!(cosine > 1.0 - 1e-6, "normal {v}: {cosine}");
        // Tangents are at right angles, and uv within a step.
        assert!((a[3] * a[6] + a[4] * a[7] + a[5] * a[8]).abs() < 1e-5);
        assert!((a[10] - b[10]).abs() <= 1.0 / 65535.0 && (a[11] - b[11]).abs() <= 1.0 / 65535.0);
    }
}

fn words_of<T: bytemuck::Pod>(values: &[T]) -> &[u32] {
    bytemuck::cast_slice(values)
}

#[test]
fn room_that_is_one_too_small_is_told_and_nothing_is_written_past_it() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (nets, options) = (torus(3, 3, 11), Options::default());
    let (coarse, fine) = (Level::world(0.3), Level::world(0.05));
    let wanted = *tessellated(&nets, &fine, &options).status();
    let exact = Capacity::of(&wanted);
    for (what, room) in [
        ("vertices", Capacity { vertices: exact.vertices - 1, ..exact }),
        ("indices", Capacity { indices: exact.indices - 1, ..exact }),
    ] {
        let mut gpu = Tessellator::new(&engine, &nets, &coarse, &options, &room).expect(what);
        let before = submit(&engine, &mut gpu);
        assert!(before.status.complete(), "{what}: {:?}", before.status);
        gpu.set_level(&fine).expect("a level");
        let after = submit(&engine, &mut gpu);
        assert!(!after.status.complete(), "{what}");
        assert_eq!(
            (after.status.vertices, after.status.indices),
            (wanted.vertices, wanted.indices),
            "{what}"
        );
        // The frame before is still there to be drawn.
        assert_eq!((after.draw, &after.indices, &after.cells), (before.draw, &before.indices, &before.cells));
        assert_eq!(after.vertices[..before.vertices.len()], before.vertices, "{what}");
        assert!(after.vertices[before.vertices.len()..].iter().all(|&w| w == 0), "{what}");
        gpu.set_capacity(&Capacity::of(&after.status)).expect("room");
        assert_eq!(gpu.status(), None, "a status of the old room");
        let grown = submit(&engine, &mut gpu);
        assert!(grown.status.complete(), "{what}: {:?}", grown.status);
        assert_eq!(grown.status.frame, 3, "{what}");
    }
    // Without room for nodes some cells stay whole, and the mesh is still closed.
    let mut room = Capacity { nodes: exact.nodes - 1, ..exact };
    let mut gpu = Tessellator::new(&engine, &nets, &fine, &options, &room).expect("nodes");
    let first = submit(&engine, &mut gpu);
    assert_eq!((first.status.nodes, first.status.node_capacity), (exact.nodes, exact.nodes - 1));
    assert!(!first.status.complete() && first.status.skipped == 0);
    assert!(first.nodes.len() <= room.nodes as usize);
    closed(&first);
    room.nodes = nets.len() as u32 + 4;
    let mut gpu = Tessellator::new(&engine, &nets, &fine, &options, &room).expect("nodes");
    let mut rounds = 0;
    loop {
        let frame = submit(&engine, &mut gpu);
        closed(&frame);
        if frame.status.complete() {
            assert_eq!(frame.nodes.len(), exact.nodes as usize);
            break;
        }
        rounds += 1;
        assert!(rounds < 12, "{:?}", frame.status);
        gpu.set_capacity(&Capacity { nodes: frame.status.nodes, ..exact }).expect("room");
    }
    // No patch at all has no triangle.
    let mut nothing = Tessellator::new(&engine, &[], &fine, &options, &exact).expect("an empty set");
    let frame = submit(&engine, &mut nothing);
    assert_eq!((frame.status.vertices, frame.draw.index_count, frame.nodes.len()), (0, 0, 0));
    // And a set that does not fit the device at all is refused by name.
    let huge = Capacity { nodes: 1 << 28, ..exact };
    match Tessellator::new(&engine, &nets, &fine, &options, &huge) {
        Err(Error::Binding { buffer, needed, most }) => assert!(needed > most, "{buffer}"),
        other => panic!("{:?}", other.err()),
    }
}

/// Every edge has two triangles, or what is wrong, of a frame with too little room for nodes.
pub fn try_closed(engine: &Engine, gpu: &mut Tessellator, room: u32) -> Option<String> {
    let frame = submit(engine, gpu);
    if frame.nodes.len() > room as usize {
        return Some(format!("{} nodes in room for {room}", frame.nodes.len()));
    }
    (!is_closed(&frame)).then(|| "an open mesh".to_string())
}

fn closed(frame: &Frame) {
    assert!(is_closed(frame));
}

/// Every edge has two triangles.
fn is_closed(frame: &Frame) -> bool {
    let mut edges = std::collections::HashMap::new();
    for t in frame.indices.chunks(3) {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    !edges.is_empty() && edges.values().all(|&n| n == 2)
}

pub fn camera(eye: [f32; 3]) -> Camera {
    Camera::looking(eye, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], 40.0, [960.0, 720.0], 0.05)
}

#[test]
fn pixels_are_what_the_camera_sees() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let nets = file("teapot.bpt", false);
    let options = Options::default();
    let level = |eye| Level { depth: 0..=8, ..Level::pixels(1.0, camera(eye)) };
    let mut gpu = Tessellator::new(&engine, &nets, &level([9.0, 4.0, 7.0]), &options, &ROOM).expect("a set");
    let mut cpu = Cpu::new(&nets, &options).expect("a set");
    // From afar, from near, from inside, from behind a wall, and looking away. From none of these places is a cell so near
    // its tolerance that a rounding decides.
    for eye in [[9.0, 4.0, 7.0], [3.1, 2.0, 2.4], [0.3, 1.2, 0.1], [60.0, 10.0, 40.0]] {
        let level = level(eye);
        cpu.run(&level.target().expect("a level"));
        super::check(&cpu, &nets, None);
        gpu.set_level(&level).expect("a level");
        let frame = submit(&engine, &mut gpu);
        assert!(frame.status.complete(), "{:?}", frame.status);
        same(&cpu, &frame, &format!("seen from {eye:?}"));
        super::seen_within(&cpu, &nets, &camera(eye), 1.0, 8);
    }
}

#[test]
fn hysteresis_keeps_what_was_split() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let nets = file("teapot.bpt", false);
    let options = Options::default();
    let level = |tolerance, hysteresis| Level { hysteresis, ..Level::world(tolerance) };
    let mut cpu = Cpu::new(&nets, &options).expect("a set");
    let mut gpu = Tessellator::new(&engine, &nets, &level(0.01, 0.5), &options, &ROOM).expect("a set");
    let mut counts = Vec::new();
    for tolerance in [0.01, 0.013, 0.019, 0.04, 0.01] {
        let level = level(tolerance, 0.5);
        cpu.run(&level.target().expect("a level"));
        gpu.set_level(&level).expect("a level");
        same(&cpu, &submit(&engine, &mut gpu), &format!("tolerance {tolerance}"));
        counts.push(cpu.trees().nodes.len());
    }
    // Up to twice the tolerance nothing is undone.
    assert_eq!((counts[1], counts[2]), (counts[0], counts[0]));
    assert!(counts[3] < counts[0]);
    assert_eq!(counts[4], counts[0]);
}

#[test]
fn a_budget_of_triangles_is_kept_on_the_device() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (nets, options) = (file("teapot.bpt", false), Options::default());
    let level = |budget, tolerance| Level { budget, ..Level::world(tolerance) };
    let mut cpu = Cpu::new(&nets, &options).expect("a set");
    let mut gpu = Tessellator::new(&engine, &nets, &level(None, 0.01), &options, &ROOM).expect("a set");
    let mut seen = Vec::new();
    // Without one, with one that is kept anyway, with smaller and smaller ones, with one that cannot be kept,
    // and back.
    for (budget, tolerance) in [
        (None, 0.01),
        (Some(40_000), 0.01),
        (Some(9_000), 0.01),
        (Some(9_000), 0.001),
        (Some(700), 0.01),
        (Some(60), 0.01),
        (Some(9_000), 0.01),
        (Some(9_000), 0.01),
        (None, 0.01),
    ] {
        let level = level(budget, tolerance);
        cpu.run(&level.target().expect("a level"));
        gpu.set_level(&level).expect("a level");
        let frame = submit(&engine, &mut gpu);
        same(&cpu, &frame, &format!("a budget of {budget:?} at {tolerance}"));
        assert_eq!(frame.status.coarser, cpu.status().coarser);
        super::check(&cpu, &nets, (budget.is_none()).then_some(tolerance));
        seen.push((frame.status.indices / 3, frame.status.coarser));
    }
    let triangles = |n: usize| seen[n].0;
    assert_eq!((triangles(0), seen[0].1, seen[1]), (15_974, 0, seen[0]));
    assert!(triangles(2) <= 9_000 && triangles(2) > 4_000 && seen[2].1 > 0, "{seen:?}");
    assert!(triangles(3) <= 9_000 && triangles(3) > 4_000, "{seen:?}");
    assert!(triangles(4) <= 700, "{seen:?}");
    // Sixty triangles are fewer than the patches have unsplit.
    assert!(triangles(5) > 60 && triangles(5) < 120, "{seen:?}");
    assert!(triangles(7) <= 9_000 && triangles(7) > 4_000, "{seen:?}");
    assert_eq!(seen[8], seen[0]);
}

#[test]
fn frozen_triangles_follow_their_control_points() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let nets = file("teapot.bpt", false);
    let (level, options) = (Level::world(0.02), Options::default());
    let mut cpu = tessellated(&nets, &level, &options);
    let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect("a set");
    let first = submit(&engine, &mut gpu);
    let moved: Vec<[f32; 4]> =
        nets.iter().flat_map(|n| &n.points).map(|&[x, y, z, w]| [x + 0.3 * y, y * 1.5, z, w]).collect();
    gpu.set_points(&moved).expect("as many");
    gpu.freeze(true);
    let frozen = submit(&engine, &mut gpu);
    cpu.set_points(&moved).expect("as many");
    cpu.dice();
    same(&cpu, &frozen, "frozen");
    assert_eq!(first.status.frame, frozen.status.frame);
    assert_ne!(first.vertices, frozen.vertices);
    gpu.freeze(false);
    cpu.run(&level.target().expect("a level"));
    same(&cpu, &submit(&engine, &mut gpu), "thawed");
    assert_ne!(frozen.indices.len(), cpu.out().indices.len());
    match gpu.set_points(&moved[1..]) {
        Err(Error::Points { found, expected }) => assert_eq!(found + 1, expected),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_frame_makes_nothing_and_waits_for_nothing() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (nets, options) = (file("teapot.bpt", false), Options::default());
    let level = |eye| Level::pixels(1.0, camera(eye));
    let mut gpu = Tessellator::new(&engine, &nets, &level([9.0, 4.0, 7.0]), &options, &ROOM).expect("a set");
    let frame = |gpu: &mut Tessellator, n: u32| {
        gpu.set_level(&level([9.0 - 0.1 * n as f32, 4.0, 7.0])).expect("a level");
        let mut encoder = engine.device().create_command_encoder(&Default::default());
        gpu.encode(&mut encoder);
        encoder.finish()
    };
    // The first frames fill wgpu's own pools.
    for n in 0..4 {
        engine.queue().submit([frame(&mut gpu, n)]);
        engine.device().poll(wgpu::PollType::wait_indefinitely()).expect("a device");
    }
    let before = made(&engine);
    assert!(before[0] > 10 && before[1] > 10, "counters are off: {before:?}");
    let mut buffers = Vec::new();
    for n in 4..12 {
        buffers.push(frame(&mut gpu, n));
        let now = made(&engine);
        // `set_level` writes through the queue, which keeps its staging until the submission.
        assert!(now[0] <= before[0] + buffers.len() as isize, "{before:?} {now:?}");
        assert_eq!(now[1..], before[1..]);
    }
    // Recorded, and not yet done: no frame is known that was not submitted.
    let known = gpu.status().expect("earlier frames").frame;
    assert_eq!(known, 4);
    engine.queue().submit(buffers);
    engine.device().poll(wgpu::PollType::wait_indefinitely()).expect("a device");
    // At least one of them found a carrier for its status.
    assert!(gpu.status().expect("a frame").frame > known);
    // A frame that is dropped takes no carrier with it.
    for n in 0..5 {
        drop(frame(&mut gpu, n));
    }
    engine.queue().submit([frame(&mut gpu, 5)]);
    engine.device().poll(wgpu::PollType::wait_indefinitely()).expect("a device");
    let last = gpu.status().expect("a frame");
    assert_eq!(last.frame, 13);
    assert_eq!(last, gpu.read().expect("a frame").status);
}

#[test]
fn a_tessellator_goes_from_thread_to_thread() {
    fn is<T: Send + Sync>() {}
    is::<Tessellator>();
    is::<Cpu>();
}

#[test]
fn a_lost_device_is_an_error() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (nets, level, options) = (torus(2, 2, 1), Level::world(0.1), Options::default());
    let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect("a set");
    let frame = submit(&engine, &mut gpu);
    assert_eq!(words_of(&frame.nodes).len(), 4 * frame.nodes.len());
    headless.device.destroy();
    assert!(matches!(gpu.read(), Err(Error::Lost { .. })));
    assert!(matches!(
        Tessellator::new(&engine, &nets, &level, &options, &ROOM),
        Err(Error::Lost { .. } | Error::Device { .. })
    ));
    assert!(gpu.set_capacity(&ROOM).is_err());
}
