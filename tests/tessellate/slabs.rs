//! Output into buffers of the caller's, and vertices as a pipeline reads them.

use super::device::{ROOM, made, submit};
use super::{file, kernels};
use crate::device;
use burgeon::gpu::tessellate::{Capacity, Frame, Slab, Tessellator, VertexLayout};
use burgeon::gpu::{Engine, Error, run};
use burgeon::language::System;
use burgeon::patch::Axiom;
use burgeon::tessellate::vertex::{Format, Normal};
use burgeon::tessellate::{Level, Options};
use wgpu::{BufferUsages, VertexFormat};

const CANARY: u32 = 0xc0ff_ee00;

fn buffer(engine: &Engine, words: usize, usage: BufferUsages) -> wgpu::Buffer {
    let usage = usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    let size = words as u64 * 4;
    let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
    let buffer = engine.device().create_buffer(&descriptor);
    engine.queue().write_buffer(&buffer, 0, bytemuck::cast_slice(&vec![CANARY; words]));
    buffer
}

const STORAGE: BufferUsages = BufferUsages::STORAGE;

/// Room for 4,000 vertices of 12 bytes, 20,000 indices and three draws, in buffers of their own.
fn slab(engine: &Engine) -> Slab {
    Slab {
        vertices: buffer(engine, 4_000 * 3, STORAGE | BufferUsages::VERTEX),
        first_vertex: 0,
        indices: buffer(engine, 20_000, STORAGE | BufferUsages::INDEX),
        first_index: 0,
        draws: buffer(engine, 15, STORAGE | BufferUsages::INDIRECT),
        draw_offset: 0,
    }
}

fn bare() -> Options {
    let format = Format { normal: None, uv: None, ..Format::default() };
    Options { format, seams: false }
}

/// What lies between two places is the frame's, and what the draw says is where it lies.
fn holds(engine: &Engine, slab: &Slab, plain: &Frame) {
    let (vertices, indices, draws) = (
        device::words(engine, &slab.vertices),
        device::words(engine, &slab.indices),
        device::words(engine, &slab.draws),
    );
    let [first, index] = [slab.first_vertex as usize * 3, slab.first_index as usize];
    assert_eq!(vertices[first..first + plain.vertices.len()], plain.vertices);
    assert_eq!(indices[index..index + plain.indices.len()], plain.indices);
    let draw = slab.draw_offset as usize / 4;
    let expected = [plain.draw.index_count, 1, slab.first_index, slab.first_vertex, 0];
    assert_eq!(draws[draw..draw + 5], expected);
}

/// Of what a slab holds from what it should hold, with its ranges in odd places.
pub fn difference(engine: &Engine) -> Option<String> {
    let (options, level) = (bare(), Level::world(0.15));
    let nets = file("teapot.bpt", false);
    let mut gpu = Tessellator::new(engine, &nets, &level, &options, &ROOM).expect("a set");
    let plain = submit(engine, &mut gpu);
    let slab = Slab { first_vertex: 101, first_index: 301, draw_offset: 24, ..slab(engine) };
    gpu.set_slab(&slab, &Capacity::of(&plain.status)).expect("a slab");
    submit(engine, &mut gpu);
    let indices = device::words(engine, &slab.indices)[301..301 + plain.indices.len()].to_vec();
    let draw = device::words(engine, &slab.draws)[6..11].to_vec();
    let expected = [plain.indices.len() as u32, 1, 301, 101, 0];
    (draw != expected || indices != plain.indices).then(|| format!("{draw:?} or an index"))
}

#[test]
fn two_sets_share_a_slab_and_write_nothing_beside_theirs() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (options, level) = (bare(), Level::world(0.15));
    let mut all = slab(&engine);
    let mut both = Vec::new();
    // Neither range begins where storage may be bound.
    for (name, first_vertex, first_index, draw_offset) in
        [("teapot.bpt", 7, 11, 4), ("sheet.bpt", 2_501, 13_003, 24)]
    {
        let nets = file(name, false);
        let mut plain = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect("a set");
        let plain = submit(&engine, &mut plain);
        let room = Capacity::of(&plain.status);
        all = Slab { first_vertex, first_index, draw_offset, ..all };
        let mut gpu =
            Tessellator::new(&engine, &nets, &level, &options, &Capacity::default()).expect("a set");
        gpu.set_slab(&all, &room).expect("a slab");
        let frame = submit(&engine, &mut gpu);
        assert!(frame.status.complete(), "{:?}", frame.status);
        assert_eq!((&frame.vertices, &frame.indices), (&plain.vertices, &plain.indices), "{name}");
        assert_eq!(
            (gpu.vertices(), gpu.indices(), gpu.draw_args()),
            (&all.vertices, &all.indices, &all.draws)
        );
        both.push((all.clone(), plain));
    }
    let mut left = [&all.vertices, &all.indices, &all.draws].map(|b| device::words(&engine, b));
    for (slab, plain) in &both {
        holds(&engine, slab, plain);
        let (v, i) = (slab.first_vertex as usize * 3, slab.first_index as usize);
        left[0][v..v + plain.vertices.len()].fill(CANARY);
        left[1][i..i + plain.indices.len()].fill(CANARY);
        left[2][slab.draw_offset as usize / 4..][..5].fill(CANARY);
    }
    assert!(left.iter().flatten().all(|&word| word == CANARY));
}

#[test]
fn a_slab_without_room_is_left_and_a_grown_one_is_filled() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (options, level) = (bare(), Level::world(0.15));
    let nets = file("teapot.bpt", false);
    let mut plain = Tessellator::new(&engine, &nets, &level, &options, &ROOM).expect("a set");
    let plain = submit(&engine, &mut plain);
    let exact = Capacity::of(&plain.status);
    let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &exact).expect("a set");
    let slab = Slab { first_vertex: 100, first_index: 300, draw_offset: 20, ..slab(&engine) };
    for room in
        [Capacity { vertices: exact.vertices - 1, ..exact }, Capacity { indices: exact.indices - 1, ..exact }]
    {
        gpu.set_slab(&slab, &room).expect("a slab");
        let frame = submit(&engine, &mut gpu);
        assert_eq!((frame.status.skipped, frame.draw.index_count), (1, 0));
        assert!(device::words(&engine, &slab.vertices).iter().all(|&word| word == CANARY));
        assert!(device::words(&engine, &slab.indices).iter().all(|&word| word == CANARY));
        let mut draws = device::words(&engine, &slab.draws);
        assert_eq!(draws[5..10], [0; 5], "nothing is drawn");
        draws[5..10].fill(CANARY);
        assert_eq!(draws, [CANARY; 15]);
    }
    // More of the same slab: what is drawn stays until a frame has run.
    gpu.set_slab(&slab, &exact).expect("a slab");
    submit(&engine, &mut gpu);
    holds(&engine, &slab, &plain);
    let more = Capacity { vertices: exact.vertices + 50, indices: exact.indices + 60, ..exact };
    gpu.set_capacity(&more).expect("room");
    holds(&engine, &slab, &plain);
    let before = made(&engine);
    let mut encoder = engine.device().create_command_encoder(&Default::default());
    gpu.encode(&mut encoder);
    assert_eq!(before, made(&engine));
    engine.queue().submit([encoder.finish()]);
    holds(&engine, &slab, &plain);
}

#[test]
fn wrong_slabs_are_refused_and_the_old_buffers_stay() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (options, level) = (bare(), Level::world(0.15));
    let nets = file("teapot.bpt", false);
    let room = Capacity { nodes: 2_000, vertices: 2_000, indices: 12_000, modules: 0 };
    let mut gpu = Tessellator::new(&engine, &nets, &level, &options, &room).expect("a set");
    let expected = submit(&engine, &mut gpu).indices;
    let good = slab(&engine);
    let read_only = buffer(&engine, 12_000, BufferUsages::VERTEX);
    let wrong = [
        (
            Slab { first_vertex: 2_001, ..good.clone() },
            "vertices are those from 2001 to 4001; its buffer holds 4000",
        ),
        (
            Slab { first_index: 8_001, ..good.clone() },
            "indices are those from 8001 to 20001; its buffer holds 20000",
        ),
        (
            Slab { draw_offset: 44, ..good.clone() },
            "words of draws are those from 11 to 16; its buffer holds 15",
        ),
        (Slab { draw_offset: 2, ..good.clone() }, "no multiple of 4"),
        (Slab { vertices: read_only, ..good.clone() }, "vertices want the usage STORAGE beside"),
    ];
    for (slab, says) in wrong {
        let error = gpu.set_slab(&slab, &room).expect_err(says).to_string();
        assert!(error.contains(says), "{error}");
        assert_eq!(submit(&engine, &mut gpu).indices, expected);
    }
    // More than the slab holds, once it is there.
    gpu.set_slab(&good, &room).expect("a slab");
    assert!(matches!(gpu.set_capacity(&Capacity { vertices: 4_001, ..room }), Err(Error::Slab(_))));
    assert_eq!(submit(&engine, &mut gpu).indices, expected);
    let apart = Options { format: Format { separate: true, ..Format::default() }, ..options };
    let mut gpu = Tessellator::new(&engine, &nets, &level, &apart, &room).expect("a set");
    assert!(gpu.set_slab(&good, &room).expect_err("sections").to_string().contains("cannot be separate"));
}

#[test]
fn a_pipeline_reads_vertices_as_their_format_lays_them() {
    let whole = kernels::formats()[0];
    let layout = VertexLayout::new(&whole);
    let buffers = layout.buffers();
    let [Some(buffer)] = &buffers[..] else { panic!("{buffers:?}") };
    assert_eq!(buffer.array_stride, whole.stride());
    let locations: Vec<u32> = buffer.attributes.iter().map(|a| a.shader_location).collect();
    assert_eq!(locations, [0, 1, 2, 3, 4]);
    for format in kernels::formats() {
        for separate in [false, true] {
            let format = Format { separate, ..format };
            let layout = VertexLayout::new(&format);
            let places = format.places(100);
            let read = layout.buffers();
            let attributes: Vec<_> = read
                .iter()
                .flatten()
                .flat_map(|buffer| buffer.attributes.iter().map(|a| (*a, buffer.array_stride)))
                .collect();
            assert_eq!(attributes.len(), places.iter().flatten().count());
            assert_eq!(read.len(), if separate { attributes.len() } else { 1 });
            for (attribute, stride) in attributes {
                let place = places[attribute.shader_location as usize].expect("an attribute");
                assert_eq!((attribute.format.size(), stride), (place.bytes, place.stride));
                assert_eq!(attribute.offset, if separate { 0 } else { place.offset });
            }
        }
    }
    let packed = Format { normal: Some(Normal::Octahedral), ..Format::default() };
    let layout = VertexLayout::new(&packed);
    let buffers = layout.buffers();
    let attributes = buffers[0].as_ref().expect("a buffer").attributes;
    assert_eq!((attributes[1].format, attributes[1].offset), (VertexFormat::Snorm16x2, 12));
    assert_eq!((attributes[2].format, attributes[2].offset), (VertexFormat::Float32x2, 16));
}

/// Rules that are loaded anew over other patches write to the slab that was there.
#[test]
fn other_patches_keep_the_slab() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let (options, level) = (bare(), Level::world(0.3));
    let text = "system quarters : patch bezier 3\nmodule P\naxiom: P = file \"teapot.bpt\"\nrules:\n  \
                P -> [ P eps ; P P ]\nrun:\n  derive 2\n";
    let system = System::parse(text).expect("rules");
    let axiom = Axiom::load::<String>(&system, &mut |name| Ok(file(name, false))).expect("an axiom");
    let room = Capacity { nodes: 3_000, vertices: 3_000, indices: 15_000, modules: 1_000 };
    let make = |axiom: &Axiom| {
        let params = run::Options::default();
        Tessellator::of_rules(&engine, &system, axiom, &params, &level, &options, &room).expect("rules")
    };
    let slab = Slab { first_vertex: 7, first_index: 11, draw_offset: 4, ..slab(&engine) };
    let mut gpu = make(&axiom);
    gpu.set_slab(&slab, &room).expect("a slab");
    submit(&engine, &mut gpu);
    holds(&engine, &slab, &submit(&engine, &mut make(&axiom)));
    let mut fewer = axiom.clone();
    fewer.roots.truncate(20);
    gpu.reload(&system, &fewer, &run::Options::default()).expect("fewer patches");
    assert_eq!(gpu.vertices(), &slab.vertices);
    submit(&engine, &mut gpu);
    holds(&engine, &slab, &submit(&engine, &mut make(&fewer)));
}
