//! The buffers of a tessellation. All are made when it is prepared, none while frames are recorded.

use super::super::buffers as making;
use super::super::{Engine, Error};
use super::Capacity;
use super::slab::{Drawn, Section, Slab};
use crate::plan::step::Extent;
use crate::tessellate::budget::Budget;
use crate::tessellate::lattice::{MAX_DEPTH, Node};
use crate::tessellate::level::Target;
use crate::tessellate::passes::{DrawArgs, Status};
use crate::tessellate::vertex::{Format, Outputs};
use crate::tessellate::word::{MOST_SHAPES, SLOTS, slots_for};
use wgpu::BufferUsages;

/// Levels that may be split: from the roots down to the deepest.
pub(super) const LEVELS: u32 = MAX_DEPTH + 1;

/// The range of all nodes, behind those of the levels and of the one that the last would make.
pub(super) const ALL: u32 = LEVELS + 1;

/// Uniforms of a buffer of several begin at multiples of this.
pub(super) const SLOT: u64 = 256;

/// Bytes of a range: count, first, level, needed, and what else an extent has, which the scan reads it as.
pub(super) const RANGE_BYTES: u64 = size_of::<Extent>() as u64;

/// Bytes of the workgroups of a range: those for its nodes, then, 16 bytes on, those for their scan.
pub(super) const DISPATCH_BYTES: u64 = 32;

/// What of counts and offsets a pass works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    Vertices,
    Triangles,
}

/// How the kernels see the sizes: `Sizes` of `wgsl/tessellate/shared/lattice.wgsl`.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Sizes {
    pub nodes: u32,
    pub vertices: u32,
    pub indices: u32,
    pub section: u32,
    pub first_index: u32,
    pub base_vertex: u32,
    pub all: u32,
    pub tile: u32,
    /// Words from what is bound to the first index, and to the draw's arguments.
    pub index_word: u32,
    pub draw_word: u32,
    pub reserved: [u32; 2],
}

/// What does not depend on capacities.
pub(super) struct Input<'a> {
    pub nets: &'a [[f32; 4]],
    pub topology: &'a [u32],
    pub table: &'a [u32],
    pub start: &'a [Node],
    pub format: &'a Format,
    /// Where vertices, indices and the draw's arguments go, if the caller has a place for them.
    pub slab: Option<&'a Slab>,
    /// Where the word is derived each frame.
    pub derived: Option<Derived>,
}

/// How a derivation says what it made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derived {
    /// vec4u of a record.
    pub quads: u32,
    /// The symbol of erased cells.
    pub hole: u32,
    /// Modules that there is room for.
    pub modules: u32,
}

/// The buffers of a word that is derived each frame.
pub(super) struct Words {
    pub source: wgpu::Buffer,
    pub leaves: wgpu::Buffer,
    pub shapes: wgpu::Buffer,
    pub too_deep: wgpu::Buffer,
    pub adopted: wgpu::Buffer,
    /// Slots of the table.
    pub slots: u32,
}

pub(super) struct Buffers {
    /// What there is room for; modules are the derivation's own.
    pub capacity: Capacity,
    pub nets: wgpu::Buffer,
    pub topology: wgpu::Buffer,
    /// Of the placement.
    pub environment: wgpu::Buffer,
    pub table: wgpu::Buffer,
    pub target: wgpu::Buffer,
    pub outputs: wgpu::Buffer,
    pub sizes: wgpu::Buffer,
    /// For each level its number.
    pub turns: wgpu::Buffer,
    pub ranges: wgpu::Buffer,
    pub dispatches: wgpu::Buffer,
    /// The workgroups of `vertices` and `triangles`.
    pub last: wgpu::Buffer,
    pub nodes: wgpu::Buffer,
    /// For each leaf of a word that is derived, the node that had its cell in the frame before.
    pub leaves_before: wgpu::Buffer,
    pub words: Option<Words>,
    /// Of this frame and of the one before, in turn.
    pub children: [wgpu::Buffer; 2],
    pub marks: wgpu::Buffer,
    pub counts: wgpu::Buffer,
    pub offsets: wgpu::Buffer,
    pub sums: wgpu::Buffer,
    pub vertices: Section,
    pub indices: Section,
    pub cells: wgpu::Buffer,
    pub draw: Section,
    pub slab: Option<Slab>,
    /// [`Budget`].
    pub budget: wgpu::Buffer,
    pub status: wgpu::Buffer,
    section: u64,
}

/// Words of a section: sections begin where storage may be bound.
fn section_words(nodes: u32) -> u64 {
    (u64::from(nodes) + 1).next_multiple_of(64)
}

impl Buffers {
    /// The buffers of a set. Of `before`, if it is given, what does not depend on the room is kept: control
    /// points, topology, level, and how many frames there were.
    pub fn new(
        engine: &Engine,
        input: &Input,
        capacity: &Capacity,
        before: Option<&Buffers>,
    ) -> Result<Buffers, Error> {
        let modules = input.derived.map_or(0, |d| d.modules);
        let nodes = capacity.nodes.max(input.start.len() as u32).max(modules);
        let section = section_words(nodes);
        let tile = engine.tuning().tile();
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let make = |label: &'static str, bytes: u64, usage| making::make(engine, label, bytes, usage);
        let written = storage | BufferUsages::COPY_DST;
        let kept = |of: fn(&Buffers) -> &wgpu::Buffer, label, bytes: u64, usage| match before {
            Some(before) => Ok(of(before).clone()),
            None => make(label, bytes, usage),
        };
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let n = u64::from(nodes);
        let slots = slots_for(modules as usize) as u64;
        let words = |derived: Derived| {
            let source = [derived.quads, derived.hole, slots as u32, 0];
            let buffer = make("burgeon source of the word", 16, uniform)?;
            engine.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&source));
            Ok::<_, Error>(Words {
                source: buffer,
                leaves: make("burgeon leaves", u64::from(modules) * 16, storage)?,
                shapes: make("burgeon shapes", MOST_SHAPES as u64 * 4, storage)?,
                too_deep: make("burgeon depth of the word", 4, storage)?,
                adopted: make("burgeon word adopted", 4, storage)?,
                slots: slots as u32,
            })
        };
        let vertices = u64::from(capacity.vertices) * input.format.stride();
        let indices = u64::from(capacity.indices);
        let drawn = match input.slab {
            Some(slab) => slab.drawn(engine, input.format, capacity.vertices, capacity.indices)?,
            None => Drawn {
                vertices: Section::whole(make("burgeon vertices", vertices, written | BufferUsages::VERTEX)?),
                indices: Section::whole(make("burgeon indices", indices * 4, written | BufferUsages::INDEX)?),
                draw: Section::whole(make(
                    "burgeon draw arguments",
                    size_of::<DrawArgs>() as u64,
                    written | BufferUsages::INDIRECT,
                )?),
            },
        };
        let buffers = Buffers {
            capacity: *capacity,
            nets: kept(|b| &b.nets, "burgeon control points", size_of_val(input.nets) as u64, written)?,
            topology: kept(|b| &b.topology, "burgeon topology", size_of_val(input.topology) as u64, written)?,
            environment: kept(|b| &b.environment, "burgeon environment of the placement", 16, uniform)?,
            table: match input.derived {
                Some(_) => make("burgeon leaves of the word", (SLOTS as u64 + slots) * 4, written)?,
                None => kept(
                    |b| &b.table,
                    "burgeon leaves of the word",
                    size_of_val(input.table) as u64,
                    written,
                )?,
            },
            target: kept(|b| &b.target, "burgeon level", size_of::<Target>() as u64, uniform)?,
            outputs: make("burgeon outputs", size_of::<Outputs>() as u64, uniform)?,
            sizes: make("burgeon sizes", size_of::<Sizes>() as u64, uniform)?,
            turns: make("burgeon levels", u64::from(LEVELS) * SLOT, uniform)?,
            ranges: make("burgeon ranges", u64::from(ALL + 1) * SLOT, written | BufferUsages::UNIFORM)?,
            dispatches: make(
                "burgeon workgroups",
                u64::from(ALL + 1) * DISPATCH_BYTES,
                written | BufferUsages::INDIRECT,
            )?,
            last: make("burgeon last workgroups", 12, storage | BufferUsages::INDIRECT)?,
            nodes: make("burgeon nodes", n * 16, written)?,
            leaves_before: make("burgeon leaves of the frame before", u64::from(modules) * 4, storage)?,
            words: input.derived.map(words).transpose()?,
            children: [
                make("burgeon children", n * 4, storage)?,
                make("burgeon children of the frame before", n * 4, storage)?,
            ],
            marks: make("burgeon marks", n * 4, storage)?,
            counts: make("burgeon counts", 2 * section * 4, storage)?,
            offsets: make("burgeon offsets", 2 * section * 4, storage)?,
            sums: make("burgeon sums", (n.div_ceil(u64::from(tile)) + 1) * 4, storage)?,
            vertices: drawn.vertices,
            indices: drawn.indices,
            draw: drawn.draw,
            slab: input.slab.cloned(),
            cells: make("burgeon cells of triangles", indices / 3 * 4, written)?,
            budget: kept(|b| &b.budget, "burgeon budget", size_of::<Budget>() as u64, storage)?,
            status: kept(|b| &b.status, "burgeon status", size_of::<Status>() as u64, storage)?,
            section: section * 4,
        };
        let queue = &engine.queue;
        let write = |buffer: &wgpu::Buffer, at: u64, bytes: &[u8]| queue.write_buffer(buffer, at, bytes);
        if before.is_none() {
            write(&buffers.nets, 0, bytemuck::cast_slice(input.nets));
            write(&buffers.topology, 0, bytemuck::cast_slice(input.topology));
            write(&buffers.table, 0, bytemuck::cast_slice(input.table));
        }
        if input.derived.is_some() {
            write(&buffers.table, 0, bytemuck::cast_slice(&[0, slots as u32 - 1]));
        }
        write(&buffers.nodes, 0, bytemuck::cast_slice(input.start));
        let mut outputs = input.format.outputs(capacity.vertices);
        outputs.begin_at(buffers.vertices.skipped_words());
        write(&buffers.outputs, 0, bytemuck::bytes_of(&outputs));
        let sizes = Sizes {
            nodes,
            vertices: capacity.vertices,
            indices: capacity.indices,
            section: section as u32,
            first_index: input.slab.map_or(0, |slab| slab.first_index),
            base_vertex: input.slab.map_or(0, |slab| slab.first_vertex),
            all: ALL,
            tile,
            index_word: buffers.indices.skipped_words(),
            draw_word: buffers.draw.skipped_words(),
            reserved: [0; 2],
        };
        write(&buffers.sizes, 0, bytemuck::bytes_of(&sizes));
        for level in 0..LEVELS {
            write(&buffers.turns, u64::from(level) * SLOT, bytemuck::bytes_of(&level));
        }
        let count = input.start.len() as u32;
        write(&buffers.ranges, 0, bytemuck::cast_slice(&[count, 0, 0, 0]));
        let groups = |workgroup| {
            let [x, y] = super::super::kernels::groups(u64::from(count), workgroup);
            [x, y, 1, 0]
        };
        let first = [groups(engine.tuning().workgroup), groups(tile)];
        write(&buffers.dispatches, 0, bytemuck::cast_slice(&first));
        Ok(buffers)
    }

    /// Copies what is drawn from other buffers, if there is room for it here and it would lie the same; in a slab that
    /// is kept it lies already.
    pub fn copy_drawn(&self, encoder: &mut wgpu::CommandEncoder, from: &Buffers, format: &Format) {
        let pairs = [
            (&from.vertices.buffer, &self.vertices.buffer),
            (&from.indices.buffer, &self.indices.buffer),
            (&from.cells, &self.cells),
            (&from.draw.buffer, &self.draw.buffer),
        ];
        let own = self.slab.is_none() && from.slab.is_none();
        if own && !format.separate && pairs.iter().all(|(old, new)| old.size() <= new.size()) {
            for (old, new) in pairs {
                encoder.copy_buffer_to_buffer(old, 0, new, 0, old.size());
            }
        }
    }

    /// Tells kernels of other records, and of another symbol for holes.
    pub fn write_source(&self, engine: &Engine, derived: &Derived) {
        if let Some(words) = &self.words {
            let source = [derived.quads, derived.hole, words.slots, 0];
            engine.queue.write_buffer(&words.source, 0, bytemuck::cast_slice(&source));
        }
    }

    pub fn section_bytes(&self) -> u64 {
        self.section
    }
}
