//! Meshes refined on a device, frame by frame.
//!
//! A frame is recorded into the caller's encoder: the points of the roots where faces are no quads, the rings, the roots'
//! tiles, then two levels a dispatch. Nothing is read back and nothing allocated; what does not depend on where vertices are
//! was uploaded once.

mod build;
mod tables;

use super::kernels::{Binding, Bound, Kernel, groups};
use super::{Engine, Error, buffers, warm};
use crate::codegen;
use crate::mesh::Topology;
use build::Builder;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use wgpu::BufferUsages;

/// Refines a mesh whose vertices move.
///
/// ```no_run
/// use burgeon::gpu::refine::{Faces, Refiner};
/// use burgeon::gpu::{Engine, Headless, Requirement};
/// use burgeon::mesh::{Mesh, Options, Topology};
/// # let mesh = Mesh::default();
///
/// let own = Headless::new(Requirement::Any)?; // or the device and queue of your renderer
/// let engine = Engine::new(&own.device, &own.queue);
/// let topology = Topology::new(&mesh, &Options::default())?;
/// let refiner = Refiner::new(&engine, &topology, &[4])?;
/// let indices = refiner.faces(4, Faces::Triangles)?; // once
///
/// refiner.set(&mesh.positions)?; // each frame, or a kernel of yours writes refiner.points()
/// let mut encoder = own.device.create_command_encoder(&Default::default());
/// refiner.encode(&mut encoder);
/// own.queue.submit([encoder.finish()]);
/// let vertices = refiner.vertices(4); // three floats a vertex, ready to draw
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Refiner {
    engine: Engine,
    topology: Arc<Topology>,
    points: wgpu::Buffer,
    levels: BTreeMap<u32, wgpu::Buffer>,
    dispatches: Vec<Dispatch>,
}

/// The faces of a level, as indices into its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Faces {
    /// Four a face.
    Quads,
    /// Six a face: it is parted from its first corner to the opposite one.
    Triangles,
}

#[derive(Debug)]
struct Dispatch {
    kernel: Kernel,
    group: wgpu::BindGroup,
    groups: [u32; 2],
}

/// What `wgsl/refine` is told of a dispatch.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Params {
    count: u32,
    zero: u32,
    n: u32,
    level: u32,
    first: u32,
    chunk: u32,
    fine: u32,
    coarse: u32,
}

impl Refiner {
    /// For these levels, all of which a frame writes.
    ///
    /// # Errors
    /// A level of more vertices than 32-bit indices can name, or than the device holds in one buffer; what the device says.
    pub fn new(engine: &Engine, topology: &Topology, levels: &[u32]) -> Result<Refiner, Error> {
        Refiner::in_chunks(engine, topology, levels, usize::MAX)
    }

    /// The same, where at most so many roots are refined at once: no result depends on it.
    ///
    /// # Errors
    /// As [`Refiner::new`].
    pub fn in_chunks(
        engine: &Engine,
        topology: &Topology,
        levels: &[u32],
        most_roots: usize,
    ) -> Result<Refiner, Error> {
        let topology = Arc::new(topology.clone());
        engine
            .checked("preparing a refinement", || Builder::new(engine, &topology, levels)?.build(most_roots))
    }

    /// Writes where the vertices of the mesh are.
    ///
    /// # Errors
    /// [`Error::Vertices`] if they are not as many as the mesh has.
    pub fn set(&self, positions: &[[f32; 3]]) -> Result<(), Error> {
        let expected = self.topology.mesh_vertices();
        if positions.len() != expected {
            return Err(Error::Vertices { found: positions.len(), expected });
        }
        let points: Vec<[f32; 4]> = positions.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect();
        self.engine.queue.write_buffer(&self.points, 0, bytemuck::cast_slice(&points));
        Ok(())
    }

    /// The vertices of the mesh, a vec4 each, of which the last number says nothing: storage that kernels and copies may
    /// write.
    pub fn points(&self) -> &wgpu::Buffer {
        &self.points
    }

    /// Records a frame.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("burgeon refinement"),
            timestamp_writes: None,
        });
        for Dispatch { kernel, group, groups } in &self.dispatches {
            kernel.record(&mut pass, group, &[*groups]);
        }
    }

    /// Dispatches of a frame.
    pub fn dispatches(&self) -> usize {
        self.dispatches.len()
    }

    /// Has the driver compile the kernels, and waits for them; else it may in the first frame.
    ///
    /// # Errors
    /// What the device says.
    pub fn warm_up(&self) -> Result<(), Error> {
        warm::warm(&self.engine, |encoder| self.encode(encoder))
    }

    /// The vertices of a level that is kept, three floats each: vertices, storage, and a source of copies.
    pub fn vertices(&self, level: u32) -> Option<&wgpu::Buffer> {
        self.levels.get(&level)
    }

    /// The vertices of a level that is kept, on the host. Waits for all that was submitted.
    ///
    /// # Errors
    /// [`Error::Lost`], or what the device says.
    pub fn read(&self, level: u32) -> Result<Vec<[f32; 3]>, Error> {
        let Some(buffer) = self.levels.get(&level) else { return Ok(Vec::new()) };
        let bytes = 12 * self.topology.counts(level).vertices;
        buffers::read(&self.engine, "reading a level", buffer, bytes)
    }

    /// The faces of a level without those of holes, made on the device, once a topology: an index buffer.
    ///
    /// # Errors
    /// More than the device holds in one buffer; what the device says.
    pub fn faces(&self, level: u32, faces: Faces) -> Result<wgpu::Buffer, Error> {
        let engine = &self.engine;
        engine.checked("numbering faces", || {
            let topology = &self.topology;
            let count = topology.counts(level).faces;
            let depth = level.saturating_sub(topology.first_level());
            let corners: u64 = if faces == Faces::Quads { 4 } else { 6 };
            let usage = BufferUsages::STORAGE | BufferUsages::INDEX;
            let out = large(engine, "burgeon faces", 4 * corners * count, usage)?;
            let kernels = codegen::refinement(topology.options.scheme, &engine.tuning, engine.edit.as_ref())?;
            let shader = if faces == Faces::Quads { &kernels.quads } else { &kernels.triangles };
            let bound = [Bound::Slot, Bound::Read, Bound::Read, Bound::Written];
            let kernel = Kernel::with_bindings(engine, shader, &bound, &["number_faces"]);
            let (sides, owned) = tables::sides(&topology.roots);
            let sides = uploaded(engine, "burgeon sides of roots", bytemuck::cast_slice(&sides))?;
            let owned = uploaded(engine, "burgeon corners of roots", bytemuck::cast_slice(&owned))?;
            // As many roots at once as one binding holds faces of.
            let a_root = (4 * corners) << (2 * depth);
            let most = engine.device.limits().max_storage_buffer_binding_size / a_root;
            let chunk = (most.max(1) as usize).next_power_of_two().min(1 << 24) / 2;
            let solid = topology.roots.solid;
            let label = wgpu::CommandEncoderDescriptor { label: Some("burgeon faces") };
            let mut encoder = engine.device.create_command_encoder(&label);
            for first in (0..solid).step_by(chunk.max(1)) {
                let roots = chunk.max(1).min(solid - first);
                let count = (roots as u64) << (2 * depth);
                let params = [count as u32, 1 << depth, first as u32, 0];
                let params = buffers::uniform(engine, "burgeon parameters", &params)?;
                let part = Part::of(a_root * first as u64..a_root * (first + roots) as u64, engine);
                let bindings = [
                    Binding::whole(&params),
                    Binding::whole(&sides),
                    Binding::whole(&owned),
                    part.bind(&out),
                ];
                let group = kernel.bind(engine, &bindings);
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                kernel.record(&mut pass, &group, &[groups(count, engine.tuning.workgroup)]);
            }
            engine.queue.submit([encoder.finish()]);
            Ok(out)
        })
    }
}

/// A buffer that may be larger than what is bound of it at once.
fn large(
    engine: &Engine,
    label: &'static str,
    bytes: u64,
    usage: BufferUsages,
) -> Result<wgpu::Buffer, Error> {
    let size = bytes.max(16).next_multiple_of(256);
    let most = engine.device.limits().max_buffer_size;
    if size > most {
        return Err(Error::Binding { buffer: label, needed: size, most });
    }
    Ok(engine.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}

fn uploaded(engine: &Engine, label: &'static str, bytes: &[u8]) -> Result<wgpu::Buffer, Error> {
    let buffer = buffers::storage(engine, label, bytes.len() as u64)?;
    engine.queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

/// A range of a large buffer, which is bound from a multiple of what the device asks for on.
struct Part {
    offset: u64,
    bytes: u64,
}

impl Part {
    fn of(range: Range<u64>, engine: &Engine) -> Part {
        let step = u64::from(engine.device.limits().min_storage_buffer_offset_alignment).max(4);
        let offset = range.start / step * step;
        Part { offset, bytes: (range.end - offset).max(16).next_multiple_of(4) }
    }

    fn bind<'a>(&self, buffer: &'a wgpu::Buffer) -> Binding<'a> {
        Binding { buffer, offset: self.offset, bytes: self.bytes.min(buffer.size() - self.offset) }
    }
}
